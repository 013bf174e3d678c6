"""Types of values while a program runs, how Python holds them, and the frames of variables (IEC 61131-3 ed. 3, 6.4).

BOOL is a `bool`; integers and bit strings are an `int` in the range of their type; REAL and LREAL a `float`, REAL
rounded to single precision; durations an `int` of nanoseconds, dates and times of day an `int` of nanoseconds since
1970-01-01 or midnight; strings and characters a `str`; arrays a flat `list`; structures and instances a `Frame`, whose
slots a `Layout` names.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from enum import Enum, StrEnum
from typing import Any

from plcopen_sfc.languages.st.literals import SECOND, TIME_RANGES
from plcopen_sfc.model.dialect import Dialect

MOST_ELEMENTS = 256
"""Of an array: the time of a comparison grows with them."""


class Family(Enum):
    """Kinds of values of elementary types."""

    BOOL = "bool"
    INTEGER = "integer"
    BITS = "bit string"
    REAL = "real"
    DURATION = "duration"
    DATE = "date"
    TIME_OF_DAY = "time of day"
    DATE_AND_TIME = "date and time"
    STRING = "string"
    SPECIAL = "special"


@dataclass(frozen=True, slots=True)
class Type:
    """Base of all types. `name` is as a person would write it.

    `start` is Python source of the value that variables have whose declaration gives none, "" for the usual one.
    """

    name: str
    start: str = field(default="", compare=False, kw_only=True)


@dataclass(frozen=True, slots=True)
class ScalarType(Type):
    """An elementary type, a subrange or an enumeration of one.

    `least` and `greatest` are the range of the type that values wrap in, `unit` the grain of durations and times in
    nanoseconds; `bits` the width. `length` is that of strings, in characters. `narrowed` are the bounds of a subrange;
    `names` the values of an enumeration by their names in lower case, `spelled` its names as they are declared.
    """

    family: Family
    bits: int = 0
    least: int = 0
    greatest: int = 0
    unit: int = 1
    length: int = 0
    narrowed: tuple[int, int] | None = None
    names: Mapping[str, int] = field(default_factory=dict, compare=False)
    spelled: Mapping[int, str] = field(default_factory=dict, compare=False)

    @property
    def is_ranged(self) -> bool:
        """True if values are integers that wrap."""
        return self.family not in (Family.BOOL, Family.REAL, Family.STRING, Family.SPECIAL)

    @property
    def is_number(self) -> bool:
        """True if one can calculate with it as with a number."""
        return self.family in (Family.INTEGER, Family.BITS, Family.REAL)


@dataclass(frozen=True, slots=True)
class ArrayOf(Type):
    """``ARRAY``: bounds of each dimension, both included. `dimensions` is empty for one of any length."""

    base: Type
    dimensions: tuple[tuple[int, int], ...]

    @property
    def size(self) -> int:
        """Number of its elements."""
        size = 1
        for lower, upper in self.dimensions:
            size *= max(upper - lower + 1, 0)
        return size

    @property
    def whole_size(self) -> int:
        """The same, where each element that is an array counts as its elements."""
        return self.size * (self.base.whole_size if isinstance(self.base, ArrayOf) else 1)


@dataclass(frozen=True, slots=True, eq=False)
class StructureType(Type):
    """A structure, a function block or a program: what has members by name."""

    layout: Layout


@dataclass(frozen=True, slots=True)
class ReferenceType(Type):
    """A reference or pointer to `base`: a `Pointer` or None. `automatic`: it is followed without a sign (CODESYS)."""

    base: Type
    automatic: bool = False


@dataclass(frozen=True, slots=True)
class OpaqueType(Type):
    """A type that the project does not declare. Members of its variables are implicit externals."""


class Direction(StrEnum):
    """Connection of a variable with the outside of its POU."""

    INPUT = "input"
    OUTPUT = "output"
    IN_OUT = "in_out"
    LOCAL = "local"
    TEMP = "temp"
    CONSTANT = "constant"
    EXTERNAL = "external"


@dataclass(slots=True, eq=False, repr=False)
class Frame:
    """The values of a structure, of an instance or of a call. `v` are its slots, by `layout`."""

    layout: Layout
    v: list[Any]


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
    given: bool = False
    """True if it is at an input address that the tool chooses (``AT %I*``)."""
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
        self.is_list = False
        """True if it is of a data block: its members are global variables."""

    def _unlinked(self) -> Frame:
        raise AssertionError(f"{self.name} is used before it is linked")

    def add(self, name: str, type_: Type, direction: Direction = Direction.LOCAL, *, hidden: bool = False) -> Field:
        """Return a new variable. Of several of one name the last one is found."""
        made = Field(name, len(self.fields), type_, direction, hidden=hidden)
        self.fields.append(made)
        self.by_name[name.casefold()] = made
        return made

    def owner(self, slot: int) -> Layout:
        """Return the layout that declares the variable in a slot: this one, or one that it extends."""
        return self.base.owner(slot) if self.base is not None and slot < self.inherited else self

    def find(self, name: str) -> Field | None:
        """Return the variable of this name; case does not matter."""
        return self.by_name.get(name.casefold())


def _integers() -> dict[str, ScalarType]:
    types = {}
    for bits, names in (
        (8, "SINT USINT BYTE"),
        (16, "INT UINT WORD"),
        (32, "DINT UDINT DWORD"),
        (64, "LINT ULINT LWORD"),
    ):
        signed, unsigned, string = names.split()
        half, whole = 1 << bits - 1, 1 << bits
        types[signed] = ScalarType(signed, Family.INTEGER, bits, -half, half - 1)
        types[unsigned] = ScalarType(unsigned, Family.INTEGER, bits, 0, whole - 1)
        types[string] = ScalarType(string, Family.BITS, bits, 0, whole - 1)
    return types


_HALF = 1 << 63
_MILLISECOND = 1_000_000
_DAY = 86_400_000_000_000
BOOL = ScalarType("BOOL", Family.BOOL, 1, 0, 1)
REAL = ScalarType("REAL", Family.REAL, 32)
LREAL = ScalarType("LREAL", Family.REAL, 64)
LTIME = ScalarType("LTIME", Family.DURATION, 64, -_HALF, _HALF - 1)
INSTANT = ScalarType("instant", Family.SPECIAL)
"""Absolute nanoseconds of the controller's clock, or None. In a snapshot it is relative to the present."""
ELAPSED = ScalarType("TIME", Family.DURATION, 64, -_HALF, _HALF - 1, unit=1, length=1)
"""A TIME that may go on growing: a snapshot may clamp it."""
ANY = ScalarType("ANY", Family.SPECIAL)
"""The type of what a supplied function returns: whatever it is."""

ELEMENTARY: dict[str, ScalarType] = _integers() | {
    "BOOL": BOOL,
    "BIT": BOOL,
    "REAL": REAL,
    "LREAL": LREAL,
    "TIME": ScalarType("TIME", Family.DURATION, 64, -_HALF, _HALF - 1),
    "LTIME": LTIME,
    "S5TIME": ScalarType("S5TIME", Family.DURATION, 16, 0, 9_990_000_000_000, unit=10 * _MILLISECOND),
    "DATE": ScalarType("DATE", Family.DATE, 64, -_HALF, _HALF - 1, unit=_DAY),
    "LDATE": ScalarType("LDATE", Family.DATE, 64, -_HALF, _HALF - 1, unit=_DAY),
    "TOD": ScalarType("TOD", Family.TIME_OF_DAY, 32, 0, _DAY - _MILLISECOND, unit=_MILLISECOND),
    "LTOD": ScalarType("LTOD", Family.TIME_OF_DAY, 64, 0, _DAY - 1),
    "DT": ScalarType("DT", Family.DATE_AND_TIME, 64, -_HALF, _HALF - 1),
    "LDT": ScalarType("LDT", Family.DATE_AND_TIME, 64, -_HALF, _HALF - 1),
    "DTL": ScalarType("DTL", Family.DATE_AND_TIME, 64, -_HALF, _HALF - 1),
    "CHAR": ScalarType("CHAR", Family.STRING, 8, length=1),
    "WCHAR": ScalarType("WCHAR", Family.STRING, 16, length=1),
    "STRING": ScalarType("STRING", Family.STRING, 8, length=254),
    "WSTRING": ScalarType("WSTRING", Family.STRING, 16, length=254),
    "TIMER": BOOL,  # what programs read of one is its output
    "COUNTER": ScalarType("COUNTER", Family.INTEGER, 16, 0, 999),
    "XINT": ScalarType("XINT", Family.INTEGER, 64, -_HALF, _HALF - 1),
    "UXINT": ScalarType("UXINT", Family.INTEGER, 64, 0, 2 * _HALF - 1),
    "XWORD": ScalarType("XWORD", Family.BITS, 64, 0, 2 * _HALF - 1),
}
"""The elementary types of IEC 61131-3; TIME there has 64 bits of nanoseconds."""
ELEMENTARY |= {
    "TIME_OF_DAY": ELEMENTARY["TOD"],
    "LTIME_OF_DAY": ELEMENTARY["LTOD"],
    "DATE_AND_TIME": ELEMENTARY["DT"],
    "LDATE_AND_TIME": ELEMENTARY["LDT"],
}
INT, DINT, LINT = ELEMENTARY["INT"], ELEMENTARY["DINT"], ELEMENTARY["LINT"]

_1990 = 7305 * _DAY
_DEFAULT_LENGTHS = {Dialect.CODESYS: 80, Dialect.TWINCAT: 80}
_TIMES_OF_DIALECTS = {
    (dialect, "TIME"): ScalarType("TIME", Family.DURATION, 32, *TIME_RANGES[dialect, "TIME"], unit=_MILLISECOND)
    for dialect in (Dialect.CODESYS, Dialect.TWINCAT, Dialect.SCL)
}
_TIMES_OF_DIALECTS |= {
    (dialect, "LTIME"): ScalarType("LTIME", Family.DURATION, 64, *TIME_RANGES[dialect, "LTIME"])
    for dialect in (Dialect.CODESYS, Dialect.TWINCAT)
}
_TIMES_OF_DIALECTS |= {
    (dialect, name): replace(ELEMENTARY["DT"], unit=unit, start=start)
    for dialect, unit, start in (
        (Dialect.CODESYS, SECOND, ""),
        (Dialect.TWINCAT, SECOND, ""),
        (Dialect.SCL, _MILLISECOND, str(_1990)),
    )
    for name in ("DT", "DATE_AND_TIME")
}
_TIMES_OF_DIALECTS[Dialect.SCL, "DATE"] = replace(ELEMENTARY["DATE"], start=str(_1990))


def elementary(name: str, dialect: Dialect = Dialect.IEC) -> ScalarType | None:
    """Return the elementary type of this name in a dialect; None if there is none.

    TIME has 32 bits of milliseconds in CODESYS (without a sign) and in S7 (with one), 64 bits of nanoseconds else.
    LTIME has these in all, without a sign in CODESYS. DT has whole seconds in CODESYS, whole milliseconds in S7.
    A STRING without a length has 80 characters in CODESYS, 254 in S7; the same is taken for IEC 61131-3, which leaves
    it open. DATE and DATE_AND_TIME start in 1990 in S7.
    """
    key = name.upper()
    if (dialect, key) in _TIMES_OF_DIALECTS:
        return _TIMES_OF_DIALECTS[dialect, key]
    if key in ("STRING", "WSTRING"):
        return string(key, _DEFAULT_LENGTHS.get(dialect, 254))
    return ELEMENTARY.get(key)


def string(name: str, length: int) -> ScalarType:
    """STRING or WSTRING of a length."""
    return ScalarType(name, Family.STRING, ELEMENTARY[name].bits, length=length)


def default(type_: ScalarType) -> bool | int | float | str | None:
    """Return the value of a variable of an elementary type that has no other (ed. 3, table 10)."""
    if type_.family is Family.BOOL:
        return False
    if type_.family is Family.REAL:
        return 0.0
    if type_.family is Family.STRING:
        return ""
    if type_.family is Family.SPECIAL:
        return None
    least, greatest = type_.narrowed or (min(type_.least, 0), max(type_.greatest, 0))
    if type_.names:
        return next(iter(type_.names.values()))
    return 0 if least <= 0 <= greatest else least


def leaves(frame: Frame, path: str = "") -> Iterator[tuple[str, Field, list[Any], int]]:
    """Yield every variable of a frame that a user sees with its path, and where its value is; structures are opened."""
    for variable in frame.layout.fields:
        if variable.hidden or frame.layout.by_name.get(variable.name.casefold()) is not variable:
            continue
        name = f"{path}{variable.name}"
        value = frame.v[variable.slot]
        if isinstance(variable.type, StructureType) and isinstance(value, Frame):
            yield from leaves(value, f"{name}.")
        else:
            yield name, variable, frame.v, variable.slot
