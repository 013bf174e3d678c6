"""Standard functions as they are executed while a program runs."""

from __future__ import annotations

import ctypes
import math
import struct
from collections.abc import Callable
from datetime import date
from typing import Any

from plcopen_sfc.errors import SimulationError
from plcopen_sfc.languages.st.literals import (
    SECOND,
    LiteralKind,
    date_and_time_literal,
    date_literal,
    known_literal,
    time_literal,
    time_of_day_literal,
)
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.semantics.programs.runtime import half_even, truncated
from plcopen_sfc.semantics.programs.runtime_types import Family, ScalarType

_DAY = 86_400 * SECOND
_EPOCH = date(1970, 1, 1).toordinal()


def _defined(name: str, function: Callable[[float], float]) -> Callable[[float], float]:
    """Return a function of real numbers that ends the scan where it has no value."""

    def value(given: float) -> float:
        try:
            return float(function(given))
        except (ValueError, OverflowError, ZeroDivisionError):
            raise SimulationError(f"{name}({given}) is no real number") from None

    return value


sqrt = _defined("SQRT", math.sqrt)
ln = _defined("LN", math.log)
log = _defined("LOG", math.log10)
exp = _defined("EXP", math.exp)
sin = _defined("SIN", math.sin)
cos = _defined("COS", math.cos)
tan = _defined("TAN", math.tan)
asin = _defined("ASIN", math.asin)
acos = _defined("ACOS", math.acos)
atan = math.atan
atan2 = math.atan2
rounded = half_even
is_valid = math.isfinite
length = len


def sqr(value: float) -> float:
    """SQR of S7: the square."""
    return value * value


def frac(value: float) -> float:
    """FRAC of S7: what is behind the decimal point."""
    return math.modf(value)[0]


def ceil(value: float) -> int:
    """CEIL of S7."""
    return math.ceil(value) if math.isfinite(value) else truncated(value)


def floor(value: float) -> int:
    """FLOOR of S7."""
    return math.floor(value) if math.isfinite(value) else truncated(value)


def norm_x(value: float, low: float, high: float) -> float:
    """NORM_X of S7: where a value lies between two others."""
    return (value - low) / (high - low)


def scale_x(value: float, low: float, high: float) -> float:
    """SCALE_X of S7."""
    return value * (high - low) + low


def limit(low: Any, value: Any, high: Any) -> Any:
    """LIMIT: MIN(MAX(IN, MN), MX) (ed. 3, table 32)."""
    return min(max(value, low), high)


def chosen(index: int, count: int) -> int:
    """Return which value MUX takes."""
    if 0 <= index < count:
        return int(index)
    raise SimulationError(f"MUX has no input {index}")


def chosen_or_last(index: int, count: int) -> int:
    """Return which value MUX of CODESYS takes: the last where there are fewer. No source tells of one below zero."""
    if index < 0:
        raise SimulationError(f"MUX has no input {index}")
    return int(min(index, count - 1))


# -- bit strings


def shl(value: int, count: int, least: int, greatest: int) -> int:
    """SHL."""
    bits = (greatest - least).bit_length()
    shifted = (value << _count(count)) & greatest - least if count < bits else 0
    return shifted - (1 << bits) if shifted > greatest else shifted


def shr(value: int, count: int, least: int, greatest: int) -> int:
    """SHR of IEC 61131-3, which has it for bit strings: zeros come from the left, for types with a sign too."""
    bits = (greatest - least).bit_length()
    shifted = (value & greatest - least) >> min(_count(count), bits)
    return shifted - (1 << bits) if shifted > greatest else shifted


def shr_signed(value: int, count: int, least: int, greatest: int) -> int:
    """SHR of a number with a sign: its sign comes from the left.

    CoDeSys 2.3 manual, "SHR", and the help of TIA Portal for S7-1200 and S7-1500; zeros come in S7-300 and S7-400.
    """
    return value >> min(_count(count), (greatest - least).bit_length())


def rol(value: int, count: int, least: int, greatest: int) -> int:
    """ROL."""
    bits = (greatest - least).bit_length()
    turn = count % bits
    word = value & greatest - least
    word = (word << turn | word >> bits - turn) & greatest - least
    return word - (1 << bits) if word > greatest else word


def ror(value: int, count: int, least: int, greatest: int) -> int:
    """ROR."""
    return rol(value, -count, least, greatest)


def _count(count: int) -> int:
    if count < 0:
        raise SimulationError(f"a shift by {count}")
    return count


def swapped(value: int, size: int, signed: bool) -> int:
    """Return a number with its bytes the other way round."""
    return int.from_bytes(value.to_bytes(size, "little", signed=signed), "big", signed=signed)


def of_bcd(value: int) -> int:
    """Return a number in BCD."""
    if not is_valid_bcd(value):
        raise SimulationError(f"16#{value:X} is no number in BCD")
    return int(f"{value:X}")


def to_bcd(value: int) -> int:
    """Return a number as BCD."""
    if not 0 <= value < 10**16:
        raise SimulationError(f"{value} has no BCD")
    return int(str(value), 16)


def is_valid_bcd(value: int) -> bool:
    """IS_VALID_BCD."""
    return f"{value:X}".isdigit()


def bits_of_real(value: float, bits: int) -> int:
    """Return a real number as the bits that hold it."""
    form = ("<f", "<I") if bits == 32 else ("<d", "<Q")
    return int(struct.unpack(form[1], struct.pack(form[0], ctypes.c_float(value).value if bits == 32 else value))[0])


def real_of_bits(value: int, bits: int) -> float:
    """Return the real number that bits hold."""
    form = ("<f", "<I") if bits == 32 else ("<d", "<Q")
    return float(struct.unpack(form[0], struct.pack(form[1], value))[0])


# -- strings; positions count from 1


def left(text: str, count: int) -> str:
    """LEFT."""
    return text[: max(count, 0)]


def right(text: str, count: int) -> str:
    """RIGHT."""
    return text[-count:] if count > 0 else ""


def mid(text: str, count: int, position: int) -> str:
    """MID."""
    return text[max(position - 1, 0) : max(position - 1 + max(count, 0), 0)] if position > 0 else ""


def concat(*texts: str) -> str:
    """CONCAT."""
    size = sum(map(len, texts))
    if size > LONGEST_TEXT:
        raise SimulationError(
            f"a string of {size} characters is longer than the simulator takes ({LONGEST_TEXT})",
            hint="Declare the length of the strings: STRING[80].",
        )
    return "".join(texts)


LONGEST_TEXT = 1_000_000
"""Characters of a string that is made of others: they may double in every scan."""


def insert(text: str, inserted: str, position: int) -> str:
    """INSERT: behind a position."""
    position = max(position, 0)
    return concat(text[:position], inserted, text[position:])


def delete(text: str, count: int, position: int) -> str:
    """DELETE."""
    start = max(position - 1, 0)
    return text[:start] + text[start + max(count, 0) :]


def replace(text: str, by: str, count: int, position: int) -> str:
    """REPLACE."""
    start = max(position - 1, 0)
    return concat(text[:start], by, text[start + max(count, 0) :])


def find(text: str, part: str) -> int:
    """FIND: 0 if it is not in it."""
    return text.find(part) + 1 if part else 0


def to_text(value: Any, type_: ScalarType) -> str:
    """Return a value as a string."""
    try:
        return _shown(value, type_)
    except (ValueError, OverflowError):  # a LiteralError is a ValueError, too
        raise SimulationError(f"{value} as {type_.name} has no text") from None


def _shown(value: Any, type_: ScalarType) -> str:
    family = type_.family
    if family is Family.BOOL:
        return "TRUE" if value else "FALSE"
    if family is Family.REAL:
        return _real_text(value, type_)
    if family is Family.DURATION:
        whole = value if type_.name == "LTIME" else value // 1_000_000 * 1_000_000
        return time_literal(whole, Dialect.IEC, "LTIME" if type_.name == "LTIME" else "TIME")
    if family is Family.DATE:
        return date_literal(date.fromordinal(_EPOCH + value // _DAY), type_.name)
    if family is Family.TIME_OF_DAY:
        return time_of_day_literal(value, type_.name)
    if family is Family.DATE_AND_TIME:
        return date_and_time_literal(value, type_.name)
    return str(value)


def _real_text(value: float, type_: ScalarType) -> str:
    if type_.bits != 32:
        return repr(value)
    for digits in range(1, 10):
        text = f"{value:.{digits}g}"
        if ctypes.c_float(float(text)).value == value:
            return repr(float(text))
    return repr(value)


def of_text(text: str, type_: ScalarType) -> Any:
    """Return the number in a string; 0 where it has none (CODESYS, STRING_TO_INT)."""
    found = known_literal(text.strip())
    if found is None:
        return False if type_.family is Family.BOOL else 0.0 if type_.family is Family.REAL else 0
    value = found.value
    if found.kind is LiteralKind.DATE and isinstance(value, date):
        value = (value.toordinal() - _EPOCH) * _DAY
    if isinstance(value, str | date):
        value = 0
    if type_.family is Family.BOOL:
        return value != 0
    if type_.family is Family.REAL:
        return ctypes.c_float(value).value if type_.bits == 32 else float(value)
    number = math.trunc(value)
    span = type_.greatest - type_.least + 1
    return (number - type_.least) % span + type_.least


def to_character(value: int, bits: int) -> str:
    """Return the character whose code the last bits of a number are: the way back of `of_character`."""
    return chr(value & ((1 << bits) - 1))


def of_character(text: str, type_: ScalarType) -> Any:
    """Return the code of a character."""
    code = ord(text[0]) if text else 0
    return code if type_.family is not Family.BOOL else code != 0


# -- dates


def day_of_week(value: int) -> int:
    """DAY_OF_WEEK: 0 is Sunday (ed. 3, table 37)."""
    return (value // _DAY + 4) % 7


def date_of(year: int, month: int, day: int) -> int:
    """Return a date."""
    try:
        return (date(year, month, day).toordinal() - _EPOCH) * _DAY
    except (ValueError, OverflowError):
        raise SimulationError(f"{year}-{month}-{day} is no date") from None


def time_of(hour: int, minute: int, second: int, millisecond: int) -> int:
    """Return a time of day."""
    if not (0 <= hour < 24 and 0 <= minute < 60 and 0 <= second < 60 and 0 <= millisecond < 1000):
        raise SimulationError(f"{hour}:{minute}:{second}.{millisecond} is no time of day")
    return ((hour * 60 + minute) * 60 + second) * SECOND + millisecond * 1_000_000


def moment_of(year: int, month: int, day: int, *clock: int) -> int:
    """Return a date and time: hour, minute, second and millisecond follow."""
    hour, minute, second, millisecond = clock
    return date_of(year, month, day) + time_of(hour, minute, second, millisecond)
