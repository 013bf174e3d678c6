"""Meanings of names and paths in translated programs: variables with their place, and things that are no values."""

from __future__ import annotations

from dataclasses import dataclass, replace

from plcopen_sfc.errors import SimulationError
from plcopen_sfc.languages.binding.symbols import Level
from plcopen_sfc.semantics.programs.code_generation import free_token
from plcopen_sfc.semantics.programs.runtime_types import ArrayOf, Direction, Field, ScalarType, StructureType, Type
from plcopen_sfc.semantics.programs.value_code import Code, ranged

ANYWHERE = "*"
"""The key of what a reference leads to: it may be a free input."""


@dataclass(frozen=True, slots=True)
class Place:
    """Place of a variable: `cells` and `index` are Python source of a list and an index in it.

    `path` is its name for a person. `key` names the place the same everywhere (slots with dots between), "" where that
    is not known before the program runs; `root` is the longest part of it that is, `whole` the variable of that key.
    `bits` are the first bit and the number of bits of a part of an integer. `input`: the surroundings may give it its
    value; `freed`: because the user wants it so.
    """

    cells: str
    index: str
    type: Type
    path: str
    key: str = ""
    root: str = ""
    bits: tuple[int, int] | None = None
    word: ScalarType | None = None
    input: bool = False
    freed: bool = False
    field: Field | None = None
    acts: bool = False
    whole: Place | None = None

    @property
    def known(self) -> Place | None:
        """The variable with a key that it is or is a part of; None where only a running program tells."""
        return self if self.key else self.whole

    @property
    def text(self) -> str:
        """Source that reads the whole variable."""
        return f"{self.cells}[{self.index}]"

    def read(self) -> Code:
        """Return the value."""
        field = self.field
        if field is not None and field.direction is Direction.CONSTANT and field.value is not None:
            return Code(repr(field.value), self.type, *_bounds(field.value), field.value, constant=True)
        text = self.value
        if self.bits is not None:
            start, width = self.bits
            if width == 1:
                return Code(f"({text} >> {start} & 1 == 1)", self.type, acts=self.acts)
            return ranged(f"({text} >> {start} & {(1 << width) - 1})", self.type, acts=self.acts)
        return ranged(text, self.type, acts=self.acts)

    @property
    def value(self) -> str:
        """Source of its value, of a part of an integer that of the integer: of a free input it is asked for."""
        text, known = self.text, self.known
        key = known.key if known is not None else ANYWHERE
        if (known is not None and not self.input) or (self.field is not None and self.field.hidden):
            return text
        if isinstance(self.type, StructureType | ArrayOf):
            return free_token(key, text, f"asked({text})")
        if known is not None and isinstance(known.type, ScalarType):
            return free_token(key, text, f"({text} if {text} is not U else fetch({self.cells}, {self.index}))")
        return free_token(key, text, f"fetch({self.cells}, {self.index})")

    def inner(self, cells: str, slot: int, type_: Type, name: str, field: Field | None = None) -> Place:
        """Return a member of it."""
        key = f"{self.key}.{slot}" if self.key else ""
        path = f"{self.path}.{name}"
        # as global variables: what has a start value keeps it until something writes it
        is_list = isinstance(self.type, StructureType) and self.type.layout.is_list
        is_preset = is_list and field is not None and field.preset and not self.freed
        return replace(
            self,
            cells=cells,
            index=str(slot),
            type=type_,
            path=path,
            key=key,
            root=key or self.root,
            input=(self.input and not is_preset) or (field is not None and field.given),
            field=field,
            whole=None if key else self.known,
        )


def _bounds(value: object) -> tuple[int, int]:
    return (value, value) if isinstance(value, int) and not isinstance(value, bool) else (0, 0)


@dataclass(frozen=True, slots=True)
class Space:
    """A thing with members that is no value: a list of global variables, an application, a library."""

    level: Level
    path: str


@dataclass(frozen=True, slots=True)
class Unknown:
    """Something that the project does not declare. Used as a value, it is an implicit external."""

    path: str


@dataclass(frozen=True, slots=True)
class Broken:
    """A variable whose declaration the simulator cannot use."""

    error: SimulationError
