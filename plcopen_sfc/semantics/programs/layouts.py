"""Where variables are kept: frames with slots, and layouts that tell what is in which slot."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Any

from plcopen_sfc.semantics.programs import types as t

if TYPE_CHECKING:
    from plcopen_sfc.semantics.programs.types import Type

MOST_ELEMENTS = 256
"""Of an array: the time of a comparison grows with them."""


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
    """True if the declaration gives it another value than that of its type."""
    declared: bool = False
    """True if the project declares it: not what charts and the simulator bring with them."""
    retained: bool = True
    """True if a later call can see the value: not of what is temporary."""


class Layout:
    """The variables of a structure or POU by their names."""

    def __init__(self, name: str, base: Layout | None = None) -> None:
        self.name = name
        self.base = base
        self.inherited = len(base.fields) if base is not None else 0
        self.fields: list[Field] = [*base.fields] if base is not None else []
        self.by_name: dict[str, Field] = dict(base.by_name) if base is not None else {}
        self.new: Callable[[], Frame] = self._unlinked
        self.new_name = ""
        self.is_instance = False
        """True if it is of a POU: a call writes its variables."""

    def _unlinked(self) -> Frame:
        raise AssertionError(f"{self.name} is used before it is linked")

    def add(self, name: str, type_: Type, direction: Direction = Direction.LOCAL, *, hidden: bool = False) -> Field:
        """A new variable. Of several of one name the last one is found."""
        made = Field(name, len(self.fields), type_, direction, hidden=hidden)
        self.fields.append(made)
        self.by_name[name.casefold()] = made
        return made

    def owner(self, slot: int) -> Layout:
        """The layout that declares the variable in a slot: this one, or one that it extends."""
        return self.base.owner(slot) if self.base is not None and slot < self.inherited else self

    def find(self, name: str) -> Field | None:
        """The variable of this name; case does not matter."""
        return self.by_name.get(name.casefold())


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
