"""Type and value of literals, and literals for values (IEC 61131-3 ed. 3, 6.3).

Durations and times are integer nanoseconds, so that nothing is lost: 2 ** 53 of them are only 104 days.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from datetime import date, timedelta
from enum import StrEnum
from fractions import Fraction

from plcopen_sfc.errors import ModelError
from plcopen_sfc.languages.st.nodes import Literal
from plcopen_sfc.model.dialect import Dialect


class LiteralError(ModelError):
    """A text that is no literal, a value that does not fit the type, or one that a dialect cannot write."""


class LiteralKind(StrEnum):
    """Kinds of literals, which decide on the type of the value.

    INTEGER: an `int`, also of the types BYTE to LWORD. REAL: a `float`. BOOL: a `bool`. STRING: a `str`, also of the
    types CHAR and WCHAR. DURATION: an `int` of nanoseconds. DATE: a `datetime.date`. TIME_OF_DAY: an `int` of
    nanoseconds since midnight. DATE_AND_TIME: an `int` of nanoseconds since 1970-01-01. ENUMERATED: the `str` of the
    name behind ``#``. POINTER, NULL: the `str` as written.
    """

    INTEGER = "integer"
    REAL = "real"
    BOOL = "bool"
    STRING = "string"
    DURATION = "duration"
    DATE = "date"
    TIME_OF_DAY = "time of day"
    DATE_AND_TIME = "date and time"
    ENUMERATED = "enumerated"
    POINTER = "pointer"
    NULL = "null"


@dataclass(frozen=True, slots=True)
class LiteralValue:
    """Value of a literal. `type`: its type in capitals (``WORD`` for ``W#16#FF``), "" where the literal names none."""

    kind: LiteralKind
    value: int | float | str | date
    type: str = ""


SECOND = 1_000_000_000
"""Nanoseconds of a second."""

INTEGER_RANGES: dict[str, tuple[int, int]] = {
    name: (-(1 << bits - 1), (1 << bits - 1) - 1) if signed else (0, (1 << bits) - 1)
    for bits, names in (
        (8, "SINT USINT BYTE"),
        (16, "INT UINT WORD"),
        (32, "DINT UDINT DWORD"),
        (64, "LINT ULINT LWORD"),
    )
    for name, signed in zip(names.split(), (True, False, False), strict=True)
}
"""The least and the greatest value of the integer and bit string types (table 10)."""

SHORT_TYPES = {"B": "BYTE", "W": "WORD", "DW": "DWORD", "LW": "LWORD", "L": "DINT", "C": "COUNTER"}
"""Prefixes of STEP 7: ``W#16#FF`` is a WORD, ``L#5`` a DINT, ``C#5`` a count in BCD."""

_TIME_TYPES = {
    "T": "TIME",
    "LT": "LTIME",
    "S5T": "S5TIME",
    "D": "DATE",
    "LD": "LDATE",
    "TIME_OF_DAY": "TOD",
    "LTIME_OF_DAY": "LTOD",
    "DATE_AND_TIME": "DT",
    "LDATE_AND_TIME": "LDT",
} | {name: name for name in ("TIME", "LTIME", "S5TIME", "DATE", "LDATE", "TOD", "LTOD", "DT", "LDT", "DTL")}
_DURATIONS = frozenset({"TIME", "LTIME", "S5TIME"})
_CHARACTERS = frozenset({"STRING", "WSTRING", "CHAR", "WCHAR"})
_MANY_DIGITS = re.compile(r"[0-9A-Za-z_.]{400}")
_SHOWN = 20
_INTEGER = re.compile(r"([+-]?)(?:(\d+)#)?([0-9A-Za-z]+(?:_+[0-9A-Za-z]+)*)")
_REAL = re.compile(r"[+-]?\d[\d_]*(?:\.\d[\d_]*)?(?:[eE][+-]?\d+)?")


def known_literal(literal: Literal | str, dialect: Dialect = Dialect.IEC) -> LiteralValue | None:
    """Return the type and value of a literal of any type; None where the text is none."""
    try:
        return literal_value(literal, dialect)
    except LiteralError:
        return None


def duration_of(literal: Literal | str, dialect: Dialect = Dialect.IEC) -> int | None:
    """Return the nanoseconds of a literal of a duration; None for anything else."""
    found = known_literal(literal, dialect)
    is_duration = found is not None and found.kind is LiteralKind.DURATION and isinstance(found.value, int)
    return found.value if is_duration else None  # type: ignore[union-attr,return-value]  # it is an integer


def literal_value(literal: Literal | str, dialect: Dialect = Dialect.IEC) -> LiteralValue:
    """Type and value of a literal of any type. Raises `LiteralError` where the text is none.

    Numbers with a base fill the bits of their type, as S7 and CODESYS have it: ``INT#16#FFFF`` is -1.
    """
    text = (literal.text if isinstance(literal, Literal) else literal).strip()
    if text[:1] in ("'", '"'):
        return _string(text, "", dialect)
    if _MANY_DIGITS.search(text):  # Python converts no more than 4300
        raise LiteralError(f"{text[:_SHOWN]}.. has more digits than any type")
    prefix, mark, body = text.partition("#")
    name = prefix.upper()
    if mark and prefix[:1].isalpha():
        if name == "P":
            return LiteralValue(LiteralKind.POINTER, text, "POINTER")
        if name in _TIME_TYPES:
            return _of_time_type(text, body, _TIME_TYPES[name])
        return _typed(text, body, prefix, dialect)
    if name in ("TRUE", "FALSE"):
        return LiteralValue(LiteralKind.BOOL, name == "TRUE")
    if name == "NULL":
        return LiteralValue(LiteralKind.NULL, text)
    if not mark and re.search(r"[.eE]", text):
        return LiteralValue(LiteralKind.REAL, _float(text, text))
    return LiteralValue(LiteralKind.INTEGER, _integer(text, text, ""))


def _typed(text: str, body: str, prefix: str, dialect: Dialect) -> LiteralValue:
    name = SHORT_TYPES.get(prefix.upper(), prefix.upper())
    if name in _CHARACTERS:
        return _string(body, name, dialect)
    if name == "BOOL":
        values = {"TRUE": True, "1": True, "FALSE": False, "0": False}
        if body.upper() not in values:
            raise LiteralError(f"{text} is no BOOL", hint="TRUE, FALSE, 1 and 0 are")
        return LiteralValue(LiteralKind.BOOL, values[body.upper()], name)
    if name in ("REAL", "LREAL"):
        return LiteralValue(LiteralKind.REAL, _float(text, body), name)
    if re.fullmatch(r"[^\W\d]\w*", body):
        return LiteralValue(LiteralKind.ENUMERATED, body, prefix)
    if not re.match(r"[+-]?\d", body):
        raise LiteralError(f"{text} is no literal")
    return LiteralValue(LiteralKind.INTEGER, _integer(text, body, name), name)


def _integer(text: str, body: str, type: str) -> int:
    found = _INTEGER.fullmatch(body)
    base = int(found[2] or 10) if found is not None else 0
    if found is None or base not in (2, 8, 10, 16):
        raise LiteralError(f"{text} is no integer", hint="bases are 2, 8 and 16")
    try:
        value = int(found[3].replace("_", ""), base)
    except ValueError:
        raise LiteralError(f"{text} has digits that base {base} does not have") from None
    value = -value if found[1] == "-" else value
    least, greatest = INTEGER_RANGES.get(type, (value, value))
    if found[2] and least < 0 and greatest < value <= 2 * greatest + 1:
        value -= 2 * greatest + 2
    if not least <= value <= greatest:
        raise LiteralError(f"{text} does not fit {type}: it goes from {least} to {greatest}")
    return value


def _float(text: str, body: str) -> float:
    if not _REAL.fullmatch(body):
        raise LiteralError(f"{text} is no real number")
    value = float(body.replace("_", ""))
    if not math.isfinite(value):
        raise LiteralError(f"{text} is greater than any LREAL")
    return value


# -- strings ----------------------------------------------------------------------------------------------------------

_ESCAPES = {"$": "$", "'": "'", '"': '"', "L": "\n", "N": "\n", "P": "\f", "R": "\r", "T": "\t"}
_ESCAPED = {"$": "$$", "\n": "$N", "\f": "$P", "\r": "$R", "\t": "$T"}


def _string(text: str, type: str, dialect: Dialect) -> LiteralValue:
    quote = text[:1]
    if len(text) < 2 or quote not in ("'", '"') or text[-1] != quote:
        raise LiteralError(f"{text} is no string in quotes")
    if quote == '"' and dialect is Dialect.SCL and not type:
        raise LiteralError(f"{text} is a name in SCL, no string")
    # without a type, double quotes tell a wide string
    wide = type.startswith("W") or (not type and quote == '"')
    digits = 4 if wide else 2
    found: list[str] = []
    position, end = 1, len(text) - 1
    while position < end:
        character = text[position]
        position += 1
        if character == quote:
            raise LiteralError(f"{text} has a quote inside", hint=f"${quote} stands for it")
        if character == "$":
            code = text[position : min(position + digits, end)]
            if re.fullmatch(rf"[0-9A-Fa-f]{{{digits}}}", code):
                character = chr(int(code, 16))
                position += digits
            else:
                mark = text[position:end][:1].upper()
                if mark not in _ESCAPES:
                    raise LiteralError(f"{text} has a $ that starts nothing", hint="$$ stands for a dollar sign")
                character = "\r\n" if mark == "N" and dialect is Dialect.SCL else _ESCAPES[mark]
                position += 1
        found.append(character)
    value = "".join(found)
    if type in ("CHAR", "WCHAR") and len(value) != 1:
        raise LiteralError(f"{text} is no {type}: it has {len(value)} characters")
    return LiteralValue(LiteralKind.STRING, value, type or ("WSTRING" if wide else "STRING"))


def string_literal(value: str, dialect: Dialect = Dialect.IEC, *, wide: bool = False) -> str:
    """Return a STRING, or with `wide` a WSTRING: in double quotes, in SCL behind ``WSTRING#`` (6.3.3).

    Raises `LiteralError` for characters that the type does not have: a STRING has those up to U+00FF.
    """
    quote = '"' if wide and dialect is not Dialect.SCL else "'"
    text = ""
    for character in value:
        code = ord(character)
        if code > (0xFFFF if wide else 0xFF) or 0xD800 <= code < 0xE000:
            raise LiteralError(f"U+{code:04X} fits no {'WSTRING' if wide else 'STRING'}")
        if character == quote:
            text += f"${quote}"
        elif character == "\n" and dialect is Dialect.SCL:
            text += "$L"  # $N is two characters in S7
        elif character in _ESCAPED:
            text += _ESCAPED[character]
        elif character.isprintable():
            text += character
        else:
            text += f"${code:04X}" if wide else f"${code:02X}"
    return f"{'WSTRING#' if wide and dialect is Dialect.SCL else ''}{quote}{text}{quote}"


# -- durations --------------------------------------------------------------------------------------------------------

_UNITS = {
    "d": 86400 * SECOND,
    "h": 3600 * SECOND,
    "m": 60 * SECOND,
    "s": SECOND,
    "ms": 1_000_000,
    "us": 1000,
    "ns": 1,
}
_PART = re.compile(r"(\d[\d_]*)(\.\d[\d_]*)?(ms|us|ns|d|h|m|s)_?", re.IGNORECASE)
_DAY = _UNITS["d"]
_S5_BASES = (10_000_000, 100_000_000, SECOND, 10 * SECOND)
_S5_DIGITS = 999
_DURATION_PREFIXES = {"TIME": "T", "LTIME": "LTIME", "S5TIME": "S5T"}
TIME_RANGES = {
    (Dialect.CODESYS, "TIME"): (0, 0xFFFF_FFFF * 1_000_000),
    (Dialect.TWINCAT, "TIME"): (0, 0xFFFF_FFFF * 1_000_000),
    (Dialect.SCL, "TIME"): (-0x8000_0000 * 1_000_000, 0x7FFF_FFFF * 1_000_000),
    (Dialect.CODESYS, "LTIME"): (0, 0xFFFF_FFFF_FFFF_FFFF),
    (Dialect.TWINCAT, "LTIME"): (0, 0xFFFF_FFFF_FFFF_FFFF),
}
"""Least and greatest TIME: 32 bits of milliseconds, in CODESYS without and in S7 with a sign. LTIME of CODESYS has none
either (help of CODESYS, "TIME, LTIME"; TwinCAT 3: "like a ULINT")."""


def _of_time_type(text: str, body: str, type: str) -> LiteralValue:
    if type in _DURATIONS:
        return LiteralValue(LiteralKind.DURATION, _duration(text, body, type), type)
    if type.endswith("DATE"):
        return LiteralValue(LiteralKind.DATE, _date(text, body), type)
    if type.endswith("TOD"):
        return LiteralValue(LiteralKind.TIME_OF_DAY, _clock(text, body), type)
    day, _, clock = body.replace("_", "").rpartition("-")
    days = (_date(text, day) - date(1970, 1, 1)).days
    return LiteralValue(LiteralKind.DATE_AND_TIME, days * _DAY + _clock(text, clock), type)


def _duration(text: str, body: str, type: str) -> int:
    sign = body[:1] if body[:1] in ("-", "+") else ""
    position, total, last = len(sign), Fraction(0), 0
    while position < len(body):
        part = _PART.match(body, position)
        if part is None:
            raise LiteralError(f"{text} is no duration", hint="one is T#1d2h3m4s5ms")
        unit = _UNITS[part[3].lower()]
        if last and unit >= last:
            raise LiteralError(f"{text} does not go from greater to smaller units")
        position, last = part.end(), unit
        if part[2] and position < len(body):
            raise LiteralError(f"{text} has a fraction before its last unit")
        total += unit * Fraction((part[1] + (part[2] or "")).replace("_", ""))
    if not last:
        raise LiteralError(f"{text} is no duration: it has no unit")
    if total.denominator != 1:
        raise LiteralError(f"{text} is finer than a nanosecond")
    if type == "S5TIME" and not 0 <= total <= 9990 * SECOND:
        raise LiteralError(f"{text} does not fit S5TIME, which ends at 2h46m30s")
    if type == "S5TIME":
        # three digits of the finest base that holds them, rounded down (STEP 7 help, "Format of S5TIME")
        base = next(each for each in sorted(_S5_BASES) if total // each <= _S5_DIGITS)
        return int(total // base) * base
    return -int(total) if sign == "-" else int(total)


def time_literal(nanoseconds: int, dialect: Dialect = Dialect.IEC, type: str = "TIME") -> str:
    """Return a duration as TIME, LTIME or S5TIME, in whole units: ``T#1d2h3m4s5ms`` (table 8).

    Raises `LiteralError` where the type of the dialect is too coarse or too narrow.
    """
    if type not in _DURATIONS or (type == "S5TIME" and dialect is not Dialect.SCL):
        raise LiteralError(f"{dialect.value} has no durations of the type {type}")
    finest = "ns" if type == "LTIME" or dialect is Dialect.IEC else "ms"
    if nanoseconds % _UNITS[finest]:
        raise LiteralError(f"{nanoseconds} ns cannot be said in whole {finest} of {type}")
    if type == "S5TIME":
        steps = [nanoseconds // base for base in _S5_BASES if nanoseconds % base == 0]
        if nanoseconds < 0 or min(steps, default=1000) > _S5_DIGITS:
            raise LiteralError(f"{nanoseconds} ns does not fit S5TIME: it has three digits, from 10 ms to 2h46m30s")
    least, greatest = TIME_RANGES.get((dialect, type), (nanoseconds, nanoseconds))
    if not least <= nanoseconds <= greatest:
        raise LiteralError(f"{nanoseconds} ns does not fit the {type} of {dialect.value}")
    text, rest = "", abs(nanoseconds)
    for unit, length in _UNITS.items():
        count, rest = divmod(rest, length)
        text += f"{count}{unit}" if count else ""
    return f"{_DURATION_PREFIXES[type]}#{'-' if nanoseconds < 0 else ''}{text or '0s'}"


# -- dates and times of day -------------------------------------------------------------------------------------------


def _date(text: str, body: str) -> date:
    found = re.fullmatch(r"(\d+)-(\d+)-(\d+)", body.replace("_", ""))
    try:
        return date(*map(int, found.groups() if found is not None else ()))
    except (TypeError, ValueError):
        raise LiteralError(f"{text} is no date", hint="one is D#2024-12-31") from None


def _clock(text: str, body: str) -> int:
    found = re.fullmatch(r"(\d+):(\d+)(?::(\d+)(\.\d+)?)?", body.replace("_", ""))
    if found is None:
        raise LiteralError(f"{text} is no time of day", hint="one is TOD#23:59:59.999")
    hours, minutes, seconds = int(found[1]), int(found[2]), int(found[3] or 0)
    fraction = Fraction(found[4] or 0) * SECOND
    if hours > 23 or minutes > 59 or seconds > 59 or fraction.denominator != 1:
        raise LiteralError(f"{text} is no time of day")
    return ((hours * 60 + minutes) * 60 + seconds) * SECOND + int(fraction)


def date_literal(day: date, type: str = "DATE") -> str:
    """Return a DATE or LDATE (table 9)."""
    return f"{'D' if type == 'DATE' else type}#{day.isoformat()}"


def time_of_day_literal(nanoseconds: int, type: str = "TOD") -> str:
    """Return a TOD or LTOD from nanoseconds since midnight (table 9)."""
    if not 0 <= nanoseconds < _DAY:
        raise LiteralError(f"{nanoseconds} ns is no time of a day")
    seconds, fraction = divmod(nanoseconds, SECOND)
    shown = f".{fraction:09}".rstrip("0") if fraction else ""
    return f"{type}#{seconds // 3600:02}:{seconds // 60 % 60:02}:{seconds % 60:02}{shown}"


def date_and_time_literal(nanoseconds: int, type: str = "DT") -> str:
    """Return a DT, LDT or DTL from nanoseconds since 1970-01-01 (table 9)."""
    days, clock = divmod(nanoseconds, _DAY)
    try:
        day = date(1970, 1, 1) + timedelta(days)
    except OverflowError:
        raise LiteralError(f"{nanoseconds} ns since 1970 is in no year that has four digits") from None
    return f"{type}#{day.isoformat()}-{time_of_day_literal(clock).removeprefix('TOD#')}"


# -- any value --------------------------------------------------------------------------------------------------------


def write_literal(literal: LiteralValue, dialect: Dialect = Dialect.IEC) -> str:
    """Return the literal of a value in a dialect. Integers are written with base 10, those of bit strings with base 16.

    Raises `LiteralError` where the dialect has no literals of the type, or none of the value.
    """
    value, type = literal.value, literal.type
    if type in _CODESYS_LACKS and dialect in (Dialect.CODESYS, Dialect.TWINCAT):
        raise LiteralError(f"{dialect.value} has no literals of the type {type}")
    match literal.kind, value:
        case LiteralKind.BOOL, _:
            return f"{type}#{'TRUE' if value else 'FALSE'}".lstrip("#")
        case LiteralKind.REAL, float() | int():
            return f"{type}#{real_literal(float(value))}".lstrip("#")
        case LiteralKind.INTEGER, int():
            least, greatest = INTEGER_RANGES.get(type, (value, value))
            if not least <= value <= greatest:
                raise LiteralError(f"{value} does not fit {type}: it goes from {least} to {greatest}")
            number = f"16#{value:X}" if type in ("BYTE", "WORD", "DWORD", "LWORD") else str(value)
            return f"{'C' if type == 'COUNTER' else type}#{number}".lstrip("#")
        case LiteralKind.STRING, str():
            text = string_literal(value, dialect, wide=type.startswith("W"))
            if type not in ("CHAR", "WCHAR"):
                return text
            if len(value) != 1:
                raise LiteralError(f"{text} is no {type}: it has {len(value)} characters")
            return f"{type}#{text.removeprefix('WSTRING#')}"
        case LiteralKind.DURATION, int():
            return time_literal(value, dialect, type or "TIME")
        case LiteralKind.DATE, date():
            return date_literal(value, type or "DATE")
        case LiteralKind.TIME_OF_DAY, int():
            return time_of_day_literal(value, type or "TOD")
        case LiteralKind.DATE_AND_TIME, int():
            return date_and_time_literal(value, type or "DT")
        case LiteralKind.ENUMERATED, str():
            return f"{type}#{value}"
        case ((LiteralKind.POINTER | LiteralKind.NULL), str()):
            return value
        case _:
            raise LiteralError(f"{value!r} is no value of a {literal.kind.value}")


_CODESYS_LACKS = frozenset({"CHAR", "WCHAR", "DTL", "COUNTER", "S5TIME", "POINTER"})


def real_literal(value: float) -> str:
    """Return a real number, always with a decimal point.

    Raises `LiteralError` for infinity and NaN, which have no literal.
    """
    if not math.isfinite(value):
        raise LiteralError(f"{value} has no literal")
    text = repr(value)
    mantissa, mark, exponent = text.partition("e")
    return (mantissa if "." in mantissa else f"{mantissa}.0") + (f"E{int(exponent)}" if mark else "")
