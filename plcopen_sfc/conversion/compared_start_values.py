"""Start values of variables: the value of every elementary member, from its declaration or from its type."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import groupby, pairwise

from plcopen_sfc.conversion.meaning import Meaning, literal_form
from plcopen_sfc.languages.s7_types import S7Types, number_of
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import (
    ArrayType,
    ArrayValue,
    DataType,
    DerivedType,
    SimpleValue,
    StructType,
    StructValue,
    Value,
    Variable,
)

__all__ = ["StartValues"]

_DEEPEST = 32
"""Structures are not nested more deeply: types that hold themselves are."""
_ZEROS = ((False,), (0,), ("",))


@dataclass(frozen=True, slots=True)
class _Start:
    """Start value: a `literal`, written as `text`, or `parts` by name; nothing: the usual values.

    The parts of an array are its elements from one place on that are alike, with how many they are.
    """

    literal: Hashable = None
    text: str = field(default="", compare=False)
    parts: tuple[tuple[Hashable, _Start], ...] = ()

    def __bool__(self) -> bool:
        return self.literal is not None or bool(self.parts)

    def shown(self, path: str = "") -> Iterator[str]:
        """The values as people read them."""
        if self.literal is not None:
            yield f"{path} = {self.text}" if path else self.text
        for name, part in self.parts:
            if isinstance(name, tuple):
                first, count = name
                inner = f"{path}[{first}]" if count == 1 else f"{path}[{first}..{first + count - 1}]"
            else:
                inner = f"{path}.{name}" if path else str(name)
            yield from part.shown(inner)


class StartValues:
    """The start values of the variables of a project, as `number` resolves the names of constants in them."""

    def __init__(self, project: Project, number: Callable[[str], str | None]) -> None:
        self._types = S7Types(project.data_types)
        self._declared = {each.name.casefold(): each for each in project.data_types}
        self._blocks = {pou.name.casefold(): pou for pou in project.pous}
        self._number = number

    def meaning(self, variable: Variable) -> Meaning | None:
        """Start value of a variable; None for the usual one, and for members that have no other."""
        given = () if variable.initial is None else (variable.initial,)
        found = self._of(variable.type, given, 0)
        return Meaning.of(found, ", ".join(found.shown())) if found else None

    def of_value(self, value: Value | None) -> Meaning | None:
        """A value that counts instead of another, so that the usual one is one too."""
        found = _Start() if value is None else self._plain(value, named=True)
        return Meaning.of(found, ", ".join(found.shown())) if found else None

    def _of(self, type_: DataType, given: Sequence[Value], depth: int) -> _Start:
        """The start of something of a type, of which the declarations say this much, the nearest first."""
        given = [value for value in given if not (isinstance(value, SimpleValue) and not (value.text or "").strip())]
        if depth > _DEEPEST:
            return _Start()
        if isinstance(type_, DerivedType):
            return self._of_named(type_, given, depth)
        if isinstance(type_, StructType):
            return self._of_members(type_.members, given, depth)
        if isinstance(type_, ArrayType):
            return self._of_array(type_, given, depth)
        if not given:
            start = self._types.start(Variable(name="x", type=type_))
            given = [] if start is None else [start]
        return self._plain(given[0]) if given else _Start()

    def _of_named(self, type_: DerivedType, given: Sequence[Value], depth: int) -> _Start:
        key = type_.name.replace('"', "").casefold()
        declared = self._declared.get(key)
        if declared is not None:
            if isinstance(declared.type, StructType | ArrayType | DerivedType):
                own = () if declared.initial is None else (declared.initial,)
                return self._of(declared.type, (*given, *own), depth + 1)
            start = self._types.start(Variable(name="x", type=type_, initial=given[0] if given else None))
            return self._of(declared.type, () if start is None else (start,), depth + 1)
        block = self._blocks.get(key)
        if block is None:
            return self._plain(given[0], named=True) if given else _Start()
        own_values = {variable.name.casefold(): variable for variable in block.variables()}
        parts = []
        for name in sorted({m.member.casefold() for v in given if isinstance(v, StructValue) for m in v.members}):
            variable = own_values.get(name)
            values = _members(given, name)
            if variable is None:
                parts.append((name, self._plain(values[0])))
                continue
            usual = () if variable.initial is None else (variable.initial,)
            found = self._of(variable.type, (*values, *usual), depth + 1)
            if found != self._of(variable.type, usual, depth + 1):
                parts.append((name, found or _Start(0, "0")))
        return _Start(parts=tuple(parts))

    def _of_members(self, members: Sequence[Variable], given: Sequence[Value], depth: int) -> _Start:
        whole = next((value for value in given if isinstance(value, SimpleValue)), None)
        if whole is not None:
            return self._plain(whole)
        parts = []
        for member in members:
            own = () if member.initial is None else (member.initial,)
            start = self._of(member.type, (*_members(given, member.name.casefold()), *own), depth + 1)
            if start:
                parts.append((member.name.casefold(), start))
        return _Start(parts=tuple(sorted(parts, key=lambda part: str(part[0]))))

    def _of_array(self, type_: ArrayType, given: Sequence[Value], depth: int) -> _Start:
        bounds = [(number_of(d.lower), number_of(d.upper)) for d in type_.dimensions]
        size = 1
        for lower, upper in bounds:
            if lower is None or upper is None:
                return self._plain(given[0]) if given else _Start()
            size *= max(upper - lower + 1, 0)
        first = (bounds[0][0] or 0) if len(bounds) == 1 else 0
        if any(isinstance(value, SimpleValue) for value in given):
            return self._plain(given[0])
        layers = [list(_runs(value)) for value in given]
        cuts = {0, size, *(place for layer in layers for place, _, _ in layer)}
        cuts |= {place + count for layer in layers for place, count, _ in layer}
        edges = sorted(place for place in cuts if place <= size)
        found: list[tuple[int, int, _Start]] = []
        for place, end in pairwise(edges):
            values = [v for layer in layers for start, count, v in layer if start <= place < start + count]
            found.append((place, end - place, self._of(type_.base, values, depth + 1)))
        parts: list[tuple[Hashable, _Start]] = []
        for element, group in groupby(found, key=lambda run: run[2]):
            runs = list(group)
            if element:
                parts.append(((first + runs[0][0], sum(count for _, count, _ in runs)), element))
        return _Start(parts=tuple(parts))

    def _plain(self, value: Value, *, named: bool = False) -> _Start:
        """A value as it is written; `named`: of a type that nothing declares, whose usual value nobody knows."""
        if isinstance(value, StructValue):
            members = sorted(value.members, key=lambda each: each.member.casefold())
            parts = tuple((each.member.casefold(), self._plain(each.value, named=True)) for each in members)
            return _Start(parts=tuple(part for part in parts if part[1]))
        if isinstance(value, ArrayValue):
            runs = [(place, count, self._plain(each, named=True)) for place, count, each in _runs(value)]
            return _Start(parts=tuple(((place, count), start) for place, count, start in runs if start))
        text = (value.text or "").strip()
        if not text:
            return _Start()
        text = self._number(text) or text
        literal = literal_form(text)
        return _Start() if literal in _ZEROS and not named else _Start(literal, text)


def _members(given: Sequence[Value], name: str) -> list[Value]:
    """Start value of one member among those of a structure."""
    return [m.value for v in given if isinstance(v, StructValue) for m in v.members if m.member.casefold() == name]


def _runs(value: Value) -> Iterator[tuple[int, int, Value]]:
    """The values of an array: the place of the first, how many, and the value. One value is for the first element."""
    place = 0
    for item in value.items if isinstance(value, ArrayValue) else ():
        count = number_of(item.repetitions) if item.repetitions is not None else 1
        yield place, count or 0, item.value
        place += count or 0
