"""Instances of RS, SR, R_TRIG and F_TRIG in networks of other tools, as TIA Portal has them.

Its flip-flops keep their state in a variable, which stands at the box: so an instance becomes that variable. Edges have
instances there too, but other boxes than those with a variable.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from plcopen_sfc.formats.simaticml.parts import PART_NAME
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.names.pieces import Piece, Reading, pieces
from plcopen_sfc.languages.st import Parsed, parse_condition, parse_statements, render, transform, walk
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.standard_blocks import S7_VERSION
from plcopen_sfc.model.base import Carried
from plcopen_sfc.model.body import FbdBody, LdBody
from plcopen_sfc.model.network import Block, BlockVariable, InputPin
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import DerivedType, Elementary, ElementaryType, Variable
from plcopen_sfc.report import ConversionReport, Outcome

_FLIP_FLOPS = frozenset({"RS", "SR"})
_EDGES = frozenset({"R_TRIG", "F_TRIG"})


def put_operands(project: Project, report: ConversionReport) -> None:
    """Make variables of the instances of flip-flops, and boxes with an instance of edges that have one."""
    own = {pou.name.upper() for pou in project.pous}
    flip_flops, edges = _FLIP_FLOPS - own, _EDGES - own
    texts: dict[int, list[Piece]] = {}
    for piece in pieces(project) if any(_instances(pou, flip_flops) for pou in project.pous) else ():
        if piece.is_program_text and piece.site.pou is not None:
            texts.setdefault(id(piece.site.pou), []).append(piece)
    for pou in project.pous:
        _put_flip_flops(project, pou, _instances(pou, flip_flops), texts.get(id(pou), []), report)
    for _, _, body in project.bodies():
        for block in _blocks(body):
            if block.type_name.upper() in edges and block.instance:
                block.carried = block.carried or Carried()
                marks = {PART_NAME: block.type_name.upper(), "Version": S7_VERSION}
                block.carried.attributes = marks | block.carried.attributes


def _put_flip_flops(
    project: Project,
    pou: Pou,
    instances: Mapping[str, Variable],
    texts: list[Piece],
    report: ConversionReport,
) -> None:
    if not instances:
        return
    texts = [piece for piece in texts if not (isinstance(piece.holder, Block) and piece.key == "instance")]
    parsed = [(piece, _parsed(piece, project.dialect)) for piece in texts]
    kept = {name for _, found in parsed for name in _otherwise_used(found.tree, instances)}
    for name in sorted(kept):
        why = "TIA Portal has no such function block, and the text uses it otherwise than a box could"
        report.add(Outcome.APPROXIMATED, "instance", f"POU {pou.name} / {instances[name].name}", why)
    changed = {name: variable for name, variable in instances.items() if name not in kept}
    for piece, found in parsed:
        new = render(found, transform(found.tree, lambda node: _value(node, changed)))
        if new != piece.text:
            piece.put(new)
    for _, owner, body in project.bodies():
        for block in _blocks(body) if owner is pou else ():
            if _name(block.instance) in changed:
                operand = InputPin(expression=block.instance)
                block.parameters.inputs.append(BlockVariable(name="operand", input=operand))
                block.instance = None
    for variable in changed.values():
        variable.type, variable.initial = ElementaryType(name=Elementary.BOOL), None
        why = "flip-flops of TIA Portal keep their state in a variable of type BOOL"
        report.add(Outcome.TRANSLATED, "instance", f"POU {pou.name} / {variable.name}", why)


def _instances(pou: Pou, types: frozenset[str]) -> dict[str, Variable]:
    derived = ((v, v.type) for v in pou.variables() if isinstance(v.type, DerivedType))
    return {v.name.casefold(): v for v, type_ in derived if type_.name.upper() in types}


def _blocks(body: object) -> Iterator[Block]:
    if isinstance(body, FbdBody | LdBody):
        yield from (node for network in body.networks for node in network.nodes if isinstance(node, Block))


def _name(instance: str | None) -> str:
    return (instance or "").removeprefix("#").strip('"').casefold()


def _parsed(piece: Piece, dialect: Dialect) -> Parsed[Any]:
    if piece.reading is Reading.STATEMENTS:
        return parse_statements(piece.text, dialect)
    return parse_condition(piece.text, dialect)


def _value(node: n.Node, instances: Mapping[str, Variable]) -> n.Node:
    """The variable itself for its output ``Q1``."""
    if isinstance(node, n.Member) and isinstance(node.base, n.Name) and node.name.identifier.upper() in ("Q1", "Q"):
        return node.base if node.base.identifier.casefold() in instances else node
    return node


def _otherwise_used(tree: n.Node, instances: Mapping[str, Variable]) -> Iterator[str]:
    """The instances of which a text asks more than their output."""
    nodes = list(walk(tree))
    fine = {id(node.base) for node in nodes if isinstance(node, n.Member) and _value(node, instances) is not node}
    members = {id(node.name) for node in nodes if isinstance(node, n.Member | n.Argument)}
    for node in nodes:
        if isinstance(node, n.Name) and id(node) not in fine | members and node.identifier.casefold() in instances:
            yield node.identifier.casefold()
