"""Parts of a program, and which of them a value depends on.

A part is left out only where nothing that is looked at can notice: it writes no variable that a kept part reads, and it
cannot end with an error. Variables of the POU count as a whole, others by all the names of their paths: ``GVL.x`` may
also be written ``x``.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence, Set
from dataclasses import dataclass
from typing import Protocol

from plcopen_sfc.errors import SimulationError
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.effects import ANYTHING, Path, is_standard_call, path_of, reads, writes
from plcopen_sfc.languages.st.walking import walk
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.semantics.programs.addresses import address_of
from plcopen_sfc.semantics.programs.instances import Instance
from plcopen_sfc.semantics.programs.types import ElementaryType, StructureType, Type

__all__ = ["Names", "NotDivisibleError", "Part", "Parts", "Uses", "cone"]

Names = frozenset[str]
"""Names of variables and of members, in lower case."""

_HARMLESS = (
    n.Name,
    n.Literal,
    n.Member,
    n.Parenthesized,
    n.Unary,
    n.Argument,
    n.Assignment,
    n.CallStatement,
    n.If,
    n.Branch,
    n.Case,
    n.CaseBranch,
    n.Range,
    n.Region,
    n.Empty,
)
"""Nodes that cannot end with an error, nor leave the body."""

_HARMLESS_OPERATORS = frozenset(n.Operator) - {
    n.Operator.MULTIPLY,
    n.Operator.DIVIDE,
    n.Operator.MODULO,
    n.Operator.POWER,
}
_HARMLESS_ASSIGNMENTS = frozenset({n.AssignmentKind.ASSIGN, n.AssignmentKind.SET, n.AssignmentKind.RESET})


class NotDivisibleError(Exception):
    """It is not known of which parts a program is made."""


@dataclass(frozen=True)
class Part:
    """What a part reads and writes. `always`: it must be kept whatever is looked at."""

    reads: Names
    writes: Names
    always: bool = False

    def __or__(self, other: Part) -> Part:
        return Part(self.reads | other.reads, self.writes | other.writes, self.always or other.always)


NOTHING = Part(frozenset(), frozenset())


class Parts(Protocol):
    """A program in parts."""

    @property
    def parts(self) -> Sequence[Part]:
        """All parts."""

    def taken(self, kept: Set[int]) -> Pou:
        """The POU with these parts only, by their numbers."""


def cone(parts: Sequence[Part], names: Iterable[str]) -> frozenset[int]:
    """The parts that the values of some variables depend on, by their numbers."""
    needed: set[str] = set()
    kept: set[int] = set()
    writers: dict[str, list[int]] = {}
    for number, part in enumerate(parts):
        for name in part.writes:
            writers.setdefault(name, []).append(number)
    waiting = [number for number, part in enumerate(parts) if part.always]
    asked = set(names)
    while waiting or asked:
        for name in asked - needed:
            waiting += writers.get(name, ())
        needed |= asked
        asked = set()
        while waiting:
            number = waiting.pop()
            if number not in kept:
                kept.add(number)
                asked |= parts[number].reads
    return frozenset(kept)


class Uses:
    """What statements and expressions of a POU read and write. Raises `NotDivisibleError` where that is not known."""

    def __init__(self, instance: Instance) -> None:
        library = instance.controller.library
        fields = [*instance.frame.layout.fields, *library.globals.fields]
        if any(_has_bounds(field.type) for field in fields):
            raise NotDivisibleError("a subrange can be left")
        _check_places(instance)
        self._layout = instance.frame.layout
        self._blocks = {(f.name.casefold(),) for f in fields if _is_block(f.type, instance)}

    def of(self, node: n.Statement | n.Expression) -> Part:
        """A statement or an expression."""
        written = self.names(writes(node, self._blocks))
        harmless = all(self._is_harmless(each) for each in walk(node))
        return Part(self.names(reads(node)), written, always=not harmless)

    def names(self, paths: Iterable[Path]) -> Names:
        """What stands for variables in parts."""
        found: set[str] = set()
        for path in paths:
            if path == ANYTHING:
                raise NotDivisibleError("it uses references, or calls what is not known")
            found.update(path[:1] if self._layout.find(path[0]) is not None else path)
        return frozenset(found)

    def of_all(self, nodes: Iterable[n.Statement | n.Expression]) -> Part:
        """Several together."""
        found = NOTHING
        for node in nodes:
            found |= self.of(node)
        return found

    def _is_harmless(self, node: n.Node) -> bool:
        if isinstance(node, n.Dereference | n.Peripheral | n.Address | n.Goto | n.Label | n.Try | n.Unreadable):
            raise NotDivisibleError("it uses references, addresses or jumps")
        if isinstance(node, n.EmbeddedCode):
            raise NotDivisibleError("it has code in C")
        if isinstance(node, n.Call):
            if is_standard_call(node) and path_of(node.callee) == ("adr",):
                raise NotDivisibleError("it uses references")
            return path_of(node.callee) in self._blocks
        if isinstance(node, n.Operation | n.Unary):
            return node.operator in _HARMLESS_OPERATORS
        if isinstance(node, n.Assignment):
            if node.kind is n.AssignmentKind.REFERENCE:
                raise NotDivisibleError("it uses references")
            return node.kind in _HARMLESS_ASSIGNMENTS
        return isinstance(node, _HARMLESS)


def _has_bounds(type_: Type) -> bool:
    return isinstance(type_, ElementaryType) and type_.narrowed is not None


def _is_block(type_: Type, instance: Instance) -> bool:
    if not isinstance(type_, StructureType):
        return False
    block = instance.controller.library.block_of(type_.layout)
    return block is not None and block.run is not None


def _check_places(instance: Instance) -> None:
    """Variables with addresses may lie over each other."""
    project = instance.controller.project
    interface = instance.unit.pou.interface
    sections = [*project.global_variables, *(interface.sections if interface is not None else ())]
    places = [v.address for section in sections for v in section.variables if v.address and "*" not in v.address]
    try:
        different = {address_of(each, by_bytes=False) for each in places}
    except SimulationError as error:
        raise NotDivisibleError(error.message) from error
    if len(places) != len(different):
        raise NotDivisibleError("two variables have the same address")
