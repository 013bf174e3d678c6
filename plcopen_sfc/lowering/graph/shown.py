"""Data of steps that other blocks ask for (``"Drill_DB".Clamp.X``): lowered blocks show them under the same names."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Sequence

from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.names.declarations import Declaration
from plcopen_sfc.languages.names.pieces import pieces
from plcopen_sfc.languages.names.references import references
from plcopen_sfc.languages.names.uses import Names, Occurrence
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.languages.words import needs_quotes
from plcopen_sfc.lowering.code.logic import assignment
from plcopen_sfc.lowering.code.program import BOOL, Code
from plcopen_sfc.lowering.code.targets import tool_of
from plcopen_sfc.lowering.graph.step_data import QUANTITIES
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import DataType, Elementary, ElementaryType, StructType, Variable
from plcopen_sfc.semantics.net import Net

_WORD = re.compile(r"\w+")
_MEMBER = re.compile(r'"?\s*\.\s*"?(\w+)')
_TYPES = dict.fromkeys(("T", "U", "T_MAX", "T_WARN"), Elementary.TIME) | {"SNO": Elementary.INT}

Asked = tuple[int, str]
"""A step and a quantity of it."""


def asked_outside(project: Project, pou: Pou, net: Net, target: str | None) -> tuple[Asked, ...]:
    """What other blocks of `project` ask of the steps of `pou`.

    Raises `LoweringError` for what is no single quantity, and where `target` has no structures in blocks that others
    could read.
    """
    names = Names(project)
    steps = {step.step.name.casefold(): step for step in net.steps}
    found: dict[Asked, None] = {}
    declarations: dict[int, Declaration] = {}
    for occurrence in _outside(names, pou, steps):
        step = steps[occurrence.reference.name.casefold()]
        if step.index not in declarations:
            declarations[step.index] = names.resolver.original(names.declaration_of(step.step))
        if not occurrence.refers_to(declarations[step.index]):
            continue
        member = _MEMBER.match(occurrence.piece.text, occurrence.reference.span[1])
        quantity = member.group(1).upper() if member is not None else ""
        place = Location(path=occurrence.use.path)
        if quantity not in QUANTITIES:
            raise LoweringError(f"step {step.path} of {pou.name} is used in a way that is not lowered", location=place)
        if tool_of(target, Dialect.SCL) is not Tool.S7:
            raise LoweringError(
                f"{step.path}.{quantity} of {pou.name} is read here, which code for {target} does not show",
                location=place,
                hint="Let the block have an output for it.",
            )
        found[step.index, quantity] = None
    return tuple(found)


def _outside(names: Names, pou: Pou, steps: Collection[str]) -> Iterator[Occurrence]:
    """Every place in other POUs where one of these names (lower case) stands."""
    words = {word for step in steps for word in _WORD.findall(step)}
    for piece in pieces(names.project):
        if piece.site.pou is pou or words.isdisjoint(_WORD.findall(piece.text.casefold())):
            continue
        for reference in references(piece, names.dialect):
            if reference.name.casefold() in steps:
                yield Occurrence(piece, reference, names.resolver.meaning(reference, piece))


def show(asked: Sequence[Asked], values: Sequence[n.Expression], net: Net, code: Code) -> list[n.Statement]:
    """Declare structures that are called as the steps are; gives what writes their members."""
    statements: list[n.Statement] = []
    members: dict[int, list[Variable]] = {}
    for (step, quantity), value in zip(asked, values, strict=True):
        kind: DataType = ElementaryType(name=_TYPES[quantity]) if quantity in _TYPES else BOOL
        members.setdefault(step, []).append(Variable(name=quantity, type=kind))
        name = net.steps[step].step.name
        quoting = n.Quoting.LOCAL_QUOTED if needs_quotes(name) else n.Quoting.LOCAL
        statements.append(assignment(n.Member(n.Name(name, quoting), n.Name(quantity)), value))
    for step, variables in members.items():
        code.declare_as(net.steps[step].step.name, StructType(members=variables))
    return statements
