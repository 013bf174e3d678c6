"""Where variables are kept: frames with slots, and layouts that tell what is in which slot."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Any

from plcopen_sfc.semantics.programs import types as t

if TYPE_CHECKING:
    from plcopen_sfc.semantics.programs.types import Type


class Direction(StrEnum):
    """How a variable is connected with the outside of its POU."""

    INPUT = "input"
    OUTPUT = "output"
    IN_OUT = "in_out"
    LOCAL = "local"
    TEMP = "temp"
    CONSTANT = "constant"
    EXTERNAL = "external"


class Frame:
    """The values of a structure, of an instance or of a call. `v` are its slots, as `layout` says."""

    __slots__ = ("layout", "v")

    def __init__(self, layout: Layout, v: list[Any]) -> None:
        self.layout = layout
        self.v = v


@dataclass(slots=True, eq=False)
class Field:
    """A variable of a layout.

    `initial` is Python source of its first value; `late`: it needs other variables of the frame, which are there
    before. `value` is that of a constant. `hidden`: it is not among the variables that a user sees. `name` may be a
    path for what has no name of its own.
    """

    name: str
    slot: int
    type: Type
    direction: Direction = Direction.LOCAL
    initial: str = "None"
    late: bool = False
    value: Any = None
    hidden: bool = False
    preset: bool = False
    """Whether the declaration gives it another value than that of its type."""
    retained: bool = True
    """Whether a later call can see the value: not of what is temporary."""


class Layout:
    """The variables of a structure or POU by their names."""

    def __init__(self, name: str, base: Layout | None = None) -> None:
        self.name = name
        self.fields: list[Field] = [*base.fields] if base is not None else []
        self.by_name: dict[str, Field] = dict(base.by_name) if base is not None else {}
        self.new: Callable[[], Frame] = self._unlinked
        self.new_name = ""
        self.is_instance = False
        """Whether it is of a POU: a call writes its variables."""

    def _unlinked(self) -> Frame:
        raise AssertionError(f"{self.name} is used before it is linked")

    def add(self, name: str, type_: Type, direction: Direction = Direction.LOCAL, *, hidden: bool = False) -> Field:
        """A new variable. Of several of one name the last one is found."""
        made = Field(name, len(self.fields), type_, direction, hidden=hidden)
        self.fields.append(made)
        self.by_name[name.casefold()] = made
        return made

    def find(self, name: str) -> Field | None:
        """The variable of this name; case does not matter."""
        return self.by_name.get(name.casefold())


@dataclass(slots=True)
class _Part:
    """A variable whose value is no plain one: how it is stored and put back."""

    slot: int
    store: Callable[[Any, int, int | None], Hashable]
    load: Callable[[Any, Hashable, int], Any]
    inside: bool = field(default=True)


class Keeper:
    """Stores and puts back what a frame holds: all that a later scan can see, relative to the present."""

    def __init__(self) -> None:
        self._plans: dict[Layout, tuple[int, list[int], list[_Part]]] = {}

    def store(self, frame: Frame, now: int, limit: int | None, leave_out: frozenset[int] = frozenset()) -> Hashable:
        """What `frame` holds, but for some slots."""
        plain, parts = self._plan(frame.layout)
        v = frame.v
        values: list[Hashable] = [v[slot] for slot in plain if slot not in leave_out]
        values += [part.store(v[part.slot], now, limit) for part in parts if part.slot not in leave_out]
        return tuple(values)

    def load(self, frame: Frame, stored: Any, now: int, leave_out: frozenset[int] = frozenset()) -> None:
        """Put back what `store` gave."""
        plain, parts = self._plan(frame.layout)
        values = iter(stored)
        v = frame.v
        for slot in plain:
            if slot not in leave_out:
                v[slot] = next(values)
        for part in parts:
            if part.slot not in leave_out:
                if part.inside:
                    part.load(v[part.slot], next(values), now)
                else:
                    v[part.slot] = part.load(None, next(values), now)

    def _plan(self, layout: Layout) -> tuple[list[int], list[_Part]]:
        count, plain, parts = self._plans.get(layout, (-1, [], []))
        if count != len(layout.fields):  # layouts of global variables grow
            plain, parts = [], []
            for variable in layout.fields:
                if variable.direction in (Direction.CONSTANT, Direction.IN_OUT) or not variable.retained:
                    continue
                part = self._part(variable.slot, variable.type)
                if part is None:
                    plain.append(variable.slot)
                else:
                    parts.append(part)
            self._plans[layout] = (len(layout.fields), plain, parts)
        return plain, parts

    def _part(self, slot: int, type_: Type) -> _Part | None:
        if isinstance(type_, t.StructureType):
            return _Part(slot, self.store, self.load)
        if type_ is t.INSTANT:
            return _Part(slot, _age, _instant, inside=False)
        if type_ is t.ELAPSED:
            return _Part(slot, _clamped, lambda _, value, __: value, inside=False)
        if isinstance(type_, t.ArrayType):
            return self._array(slot, type_)
        return None

    def _array(self, slot: int, type_: t.ArrayType) -> _Part:
        element = self._part(0, type_.base)
        if element is None:
            return _Part(slot, lambda values, _, __: tuple(values), _load_list)
        inner = element

        def load(values: list[Any], stored: Any, now: int) -> None:
            for index, value in enumerate(stored):
                if inner.inside:
                    inner.load(values[index], value, now)
                else:
                    values[index] = inner.load(None, value, now)

        return _Part(slot, lambda values, now, limit: tuple(inner.store(v, now, limit) for v in values), load)


def _load_list(values: list[Any], stored: Any, _: int) -> None:
    values[:] = stored


def _clamped(value: int, _: int, limit: int | None) -> Hashable:
    return value if limit is None else min(value, limit)


def _age(value: int | None, now: int, limit: int | None) -> Hashable:
    return None if value is None else _clamped(now - value, now, limit)


def _instant(_: Any, age: Any, now: int) -> int | None:
    return None if age is None else now - age


def leaves(frame: Frame, path: str = "") -> Iterator[tuple[str, Field, list[Any], int]]:
    """Every variable of a frame that a user sees with its path, and where its value is; structures are opened."""
    for variable in frame.layout.fields:
        if variable.hidden or frame.layout.by_name.get(variable.name.casefold()) is not variable:
            continue
        name = f"{path}{variable.name}"
        value = frame.v[variable.slot]
        if isinstance(variable.type, t.StructureType) and isinstance(value, Frame):
            yield from leaves(value, f"{name}.")
        else:
            yield name, variable, frame.v, variable.slot
