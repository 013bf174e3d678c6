"""Types of recorded variables and of inputs: how their values are written in tables and files, and read again."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import date, timedelta
from enum import Enum
from typing import TypeAlias

from plcopen_sfc.errors import ModelError
from plcopen_sfc.languages.st.literals import (
    INTEGER_RANGES,
    LiteralError,
    LiteralKind,
    LiteralValue,
    literal_value,
    real_literal,
    string_literal,
    time_literal,
    write_literal,
)

Value: TypeAlias = bool | int | float | str
"""The value of a variable. Durations, times and dates are nanoseconds; bit strings and enumerations are integers."""


class SignalKind(Enum):
    """Kinds of values of a signal."""

    BOOL = "bool"
    INTEGER = "integer"
    REAL = "real"
    DURATION = "duration"
    STRING = "string"
    ENUMERATION = "enumeration"


_TRUE = frozenset({"1", "TRUE", "WAHR", "BOOL#TRUE", "BOOL#1"})
_FALSE = frozenset({"0", "FALSE", "FALSCH", "BOOL#FALSE", "BOOL#0"})
_DURATIONS = ("TIME", "LTIME", "S5TIME")
_KINDS = {"BOOL": SignalKind.BOOL, **dict.fromkeys(("REAL", "LREAL"), SignalKind.REAL)}
_KINDS |= dict.fromkeys(_DURATIONS, SignalKind.DURATION)
_CALENDAR = {
    name: kind
    for kind, names in (
        (LiteralKind.DATE, "DATE LDATE"),
        (LiteralKind.TIME_OF_DAY, "TOD LTOD"),
        (LiteralKind.DATE_AND_TIME, "DT LDT DTL"),
    )
    for name in names.split()
}
_LITERALS = {
    SignalKind.REAL: (LiteralKind.REAL, LiteralKind.INTEGER),
    SignalKind.DURATION: (LiteralKind.DURATION,),
    SignalKind.STRING: (LiteralKind.STRING,),
}
_EPOCH = date(1970, 1, 1)
_DAY = 86_400_000_000_000
_TEXTS = ("STRING", "WSTRING", "CHAR", "WCHAR")


@dataclass(frozen=True, slots=True)
class Signal:
    """The type of a variable: its name (``INT``, ``E_Mode``) and, of an enumeration, the names of its values.

    `least` and `greatest` are the bounds of integers and subranges, `unit` is the resolution of durations and times in
    nanoseconds, `length` the most characters of texts, as far as that is known.
    """

    type: str
    kind: SignalKind
    names: Mapping[int, str] = field(default_factory=dict)
    least: int = -(1 << 63)
    greatest: int = (1 << 63) - 1
    unit: int = 1
    length: int = 0

    @classmethod
    def elementary(cls, type_name: str) -> Signal:
        """Return the signal of an elementary type; what is no number, Boolean, duration or text counts as integer."""
        name = type_name.upper()
        if name in _KINDS:
            return cls(name, _KINDS[name])
        if name.startswith(_TEXTS):
            return cls(name, SignalKind.STRING)
        least, greatest = INTEGER_RANGES.get(name, (-(1 << 63), (1 << 64) - 1))
        return cls(name, SignalKind.INTEGER, least=least, greatest=greatest)

    @classmethod
    def enumeration(cls, type_name: str, names: Mapping[int, str]) -> Signal:
        """Return the signal of an enumeration with these values."""
        return cls(type_name, SignalKind.ENUMERATION, dict(names))

    @property
    def default(self) -> Value:
        """The value of a variable that has no other (IEC 61131-3 ed. 3, table 10)."""
        match self.kind:
            case SignalKind.BOOL:
                return False
            case SignalKind.REAL:
                return 0.0
            case SignalKind.STRING:
                return ""
            case SignalKind.ENUMERATION if self.names:
                return next(iter(self.names))
        return min(max(0, self.least), self.greatest)

    @property
    def literals(self) -> tuple[LiteralKind, ...]:
        """The kinds of literals whose values the type has."""
        if self.kind is SignalKind.INTEGER:
            return (_CALENDAR.get(self.type, LiteralKind.INTEGER),)
        return _LITERALS.get(self.kind, ())

    def whole(self, value: int) -> int:
        """Return the nearest value of an integer, duration or time that is not greater, in the bounds of the type."""
        return min(max(value // self.unit * self.unit, self.least), self.greatest)

    @property
    def bits(self) -> int:
        """Number of bits that an integer of the type has."""
        return max(self.greatest.bit_length(), (-self.least - 1).bit_length() + 1 if self.least < 0 else 1)

    def text(self, value: Value) -> str:
        """The value as cells of tables and files have it: ``1``, ``2.5``, ``T#1s500ms``, ``Running``, ``'text'``."""
        match self.kind:
            case SignalKind.BOOL:
                return "1" if value else "0"
            case SignalKind.REAL if isinstance(value, float):
                return real_literal(value) if value - value == 0 else str(value)
            case SignalKind.DURATION if isinstance(value, int):
                return time_literal(value)
            case SignalKind.ENUMERATION if isinstance(value, int):
                return self.names.get(value, str(value))
            case SignalKind.STRING if isinstance(value, str):
                return _quoted(value, wide=self.type.startswith("W"))
            case SignalKind.INTEGER if self.type in _CALENDAR and isinstance(value, int):
                return self._calendar(value)
        return str(value)

    def _calendar(self, value: int) -> str:
        """Return a date or time as a literal, or as its number where no literal has it."""
        kind = _CALENDAR[self.type]
        try:
            shown = _EPOCH + timedelta(value // _DAY) if kind is LiteralKind.DATE else value
            return write_literal(LiteralValue(kind, shown, self.type))
        except (ModelError, OverflowError):
            return str(value)

    def parse(self, text: str) -> Value:
        """Return the value in `text`: a result of `text()`, a literal, or a plain number. Raises `ModelError`."""
        if self.kind is SignalKind.STRING:
            return _unquoted(text)
        word = text.strip()
        match self.kind:
            case SignalKind.BOOL:
                return self._bool(word)
            case SignalKind.REAL:
                return self._real(word)
            case SignalKind.ENUMERATION:
                by_name = {name.casefold(): value for value, name in self.names.items()}
                found = by_name.get(word.rpartition("#")[2].rpartition(".")[2].casefold())
                return found if found is not None else self._number(word)
        return self._number(word)

    def accept(self, value: object) -> Value:
        """Return a value that a Python function gave, checked against the type.

        Texts are parsed. Raises `ModelError`.
        """
        if isinstance(value, date):
            value = (value - _EPOCH).days * _DAY
        if isinstance(value, str):
            return value if self.kind is SignalKind.STRING else self.parse(value)
        if self.kind is SignalKind.BOOL and isinstance(value, int) and value in (0, 1):
            return bool(value)
        if self.kind is SignalKind.REAL and isinstance(value, int | float) and not isinstance(value, bool):
            return self._rounded(float(value))
        integers = (SignalKind.INTEGER, SignalKind.DURATION, SignalKind.ENUMERATION)
        if self.kind in integers and isinstance(value, int) and not isinstance(value, bool):
            return self._within(value, str(value))
        raise ModelError(f"{value!r} is no value of the type {self.type}")

    def _bool(self, word: str) -> bool:
        if word.upper() in _TRUE:
            return True
        if word.upper() in _FALSE:
            return False
        raise ModelError(f"{word!r} is no BOOL", hint="TRUE, FALSE, 1 and 0 are.")

    def _real(self, word: str) -> float:
        if "," in word:
            raise ModelError(f"{word!r} is no {self.type}", hint="Write the decimal sign as a point: 2.5")
        try:
            value = float(word.rpartition("#")[2].replace("_", ""))
        except ValueError:
            raise ModelError(f"{word!r} is no {self.type}") from None
        return self._rounded(value)

    def _rounded(self, value: float) -> float:
        if self.type != "REAL":
            return value
        try:
            return float(struct.unpack("<f", struct.pack("<f", value))[0])
        except OverflowError:
            raise ModelError(f"{value!r} does not fit the type REAL") from None

    def _number(self, word: str) -> int:
        try:
            literal = literal_value(word)
        except LiteralError as error:
            raise ModelError(f"{word!r} is no {self.type}", hint=error.hint) from None
        if isinstance(literal.value, date) and literal.kind in self.literals:
            return self._within((literal.value - _EPOCH).days * _DAY, word)
        if isinstance(literal.value, bool) or not isinstance(literal.value, int):
            raise ModelError(f"{word!r} is no {self.type}")
        is_duration = self.kind is SignalKind.DURATION
        if is_duration is not (literal.kind is LiteralKind.DURATION):
            hint = "Write a duration with its unit: T#500ms" if is_duration else ""
            raise ModelError(f"{word!r} is no {self.type}", hint=hint)
        return self._within(literal.value, word)

    def _within(self, value: int, word: str) -> int:
        if self.kind is SignalKind.ENUMERATION and self.names and value not in self.names:
            names = ", ".join(self.names.values())
            raise ModelError(f"{word} is no value of {self.type}", hint=f"Its values are: {names}")
        if not self.least <= value <= self.greatest:
            raise ModelError(f"{word} does not fit the type {self.type} ({self.least} to {self.greatest})")
        return value


def _quoted(value: str, *, wide: bool) -> str:
    try:
        return string_literal(value, wide=wide)
    except LiteralError:  # characters that no string of a controller has
        return '"' + value.replace("$", "$$").replace('"', '$"') + '"'


def _unquoted(text: str) -> str:
    """Return the value of a literal in quotes; any other text is the value itself."""
    if text[:1] not in ("'", '"'):
        return text
    try:
        return str(literal_value(text).value)
    except LiteralError as error:
        raise ModelError(error.message, hint=error.hint) from None
