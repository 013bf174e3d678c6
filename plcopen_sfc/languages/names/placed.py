"""Names that their place gives a meaning: listed steps, nodes of the project tree, declarations as text."""

from __future__ import annotations

from plcopen_sfc.languages.names.declarations import Declaration, Kind, Level
from plcopen_sfc.languages.names.meaning import NOTHING, Meaning
from plcopen_sfc.languages.names.pieces import Piece, Site
from plcopen_sfc.languages.names.references import Reference
from plcopen_sfc.languages.names.scopes import Scopes, variables_in
from plcopen_sfc.model import types as t
from plcopen_sfc.model.project import TreeNode
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.model.variables import VariableSection


def step_of(scopes: Scopes, chart: object, name: str, site: Site) -> Meaning:
    """A step of the chart that something names beside it."""
    if not isinstance(chart, SfcNetwork):
        return Meaning(doubt="there is no chart of this name")
    found = [d for d in scopes.chart(chart, site.pou).named(name) if d.kind is Kind.STEP]
    return Meaning(found[0]) if found else NOTHING


def object_of(scopes: Scopes, nodes: tuple[TreeNode, ...]) -> Meaning:
    """What a node of the project tree stands for: what has its id; without ids, what has its name there."""
    node = nodes[-1]
    around = {outer.name.casefold() for outer in nodes[:-1]}
    alike: list[Declaration] = []
    for declaration in scopes.objects():
        object_id = getattr(declaration.holder, "object_id", None)
        if object_id is not None and object_id == node.object_id:
            return Meaning(declaration)
        same = declaration.name.casefold() == node.name.casefold()
        if object_id is None and same and (declaration.pou is None or declaration.pou.name.casefold() in around):
            alike.append(declaration)
    if len(alike) > 1:
        return Meaning(doubt="several things have this name in the project tree", candidates=tuple(alike))
    return Meaning(alike[0]) if alike else NOTHING


def head_of(scopes: Scopes, piece: Piece) -> Meaning:
    """What a text of declarations declares as a whole."""
    site = piece.site
    if isinstance(piece.owner, VariableSection):
        levels = scopes.outer(site.place)
        lists = [
            d for level in levels for d in level.named(piece.owner.name or "") if id(piece.owner) in map(id, d.holders)
        ]
        return Meaning(lists[0]) if lists else NOTHING
    if site.pou is not None and site.method is not None:
        path = f"{site.pou.name}.{site.method.name}"
        return Meaning(Declaration(Kind.METHOD, path, (site.method,), site.pou))
    return Meaning(Declaration(Kind.POU, site.pou.name, (site.pou,))) if site.pou is not None else NOTHING


def declared(scopes: Scopes, reference: Reference, piece: Piece) -> Meaning:
    """What a text of declarations declares with this name."""
    holder = piece.owner if isinstance(piece.owner, VariableSection) else piece.holder
    within = reference.within
    type_: t.DataType | None = None
    level = Level()
    if isinstance(holder, t.DataTypeDeclaration):
        type_, within = holder.type, within[1:]
    elif isinstance(holder, VariableSection):
        for variable in variables_in(holder):
            level.add(variable)
    else:
        own = scopes.local(piece.site)[len(piece.site.charts) :]
        level = own[0] if own else level
    for name in within:
        if type_ is not None:
            level = _in_place(scopes, type_)
        variables = [d.holder for d in level.named(name)]
        type_ = next((variable.type for variable in variables if isinstance(variable, t.Variable)), None)
        if type_ is None:
            return NOTHING
    if type_ is not None:
        level = _in_place(scopes, type_)
    kinds = (Kind.VARIABLE, Kind.MEMBER, Kind.ENUM_VALUE)
    found = [d for d in level.named(reference.name) if d.kind in kinds]
    return Meaning(found[0]) if found else NOTHING


def _in_place(scopes: Scopes, type_: t.DataType) -> Level:
    """What a type declares itself: the members of a structure, the values of an enumeration."""
    while isinstance(type_, t.ArrayType | t.PointerType):
        type_ = type_.base
    if isinstance(type_, t.EnumType):
        return scopes.enumeration(type_)
    return scopes.structure(type_) if isinstance(type_, t.StructType) else Level()
