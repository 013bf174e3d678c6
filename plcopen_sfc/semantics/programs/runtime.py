"""Functions that translated programs call while they run."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import wraps
from inspect import signature
from typing import Any

from plcopen_sfc.errors import SimulationError
from plcopen_sfc.semantics.programs.runtime_types import Family, Frame, ScalarType


class Processor:
    """The clock of a controller and how much it may still do in the scan.

    `now`: nanoseconds since the start. `left`: turns of loops and calls of functions before a scan counts as endless.
    Both for comparisons: `holding`: charts that begin in this scan test no transition in it, if these come first.
    `ahead`: nanoseconds by which transitions that are tested behind the actions see the times of steps ahead, which
    begin with their actions.
    """

    __slots__ = ("ahead", "holding", "left", "now")

    def __init__(self) -> None:
        self.ahead = 0
        self.now = 0
        self.left = 0
        self.holding = False


@dataclass(slots=True, eq=False, repr=False)
class Pointer:
    """Pointer to a variable: a list and an index in it. Equal pointers lead to the same variable."""

    cells: list[Any]
    index: int

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Pointer) and self.cells is other.cells and self.index == other.index

    def __hash__(self) -> int:
        return hash((id(self.cells), self.index))


@dataclass(slots=True, eq=False, repr=False)
class View:
    """An array passed to a parameter of any length, ``ARRAY[*]``: its elements and bounds (ed. 3, 6.5.3)."""

    cells: list[Any]
    bounds: tuple[tuple[int, int], ...]

    def at(self, *indices: int) -> int:
        """Return where the element of these indices is in `cells`."""
        if len(indices) != len(self.bounds):
            raise SimulationError(f"an array of {len(self.bounds)} dimensions has {len(indices)} indices here")
        offset = 0
        for index, (lower, upper) in zip(indices, self.bounds, strict=True):
            if not lower <= index <= upper:
                out_of_bounds(index, lower, upper)
            offset = offset * (upper - lower + 1) + index - lower
        return offset

    def bound(self, dimension: int, which: int) -> int:
        """LOWER_BOUND (`which` 0) or UPPER_BOUND (1)."""
        if not 1 <= dimension <= len(self.bounds):
            raise SimulationError(f"the array has no dimension {dimension}")
        return self.bounds[dimension - 1][which]


class Unread:
    """Stands in the place of a free input that the scan has not asked for yet."""


UNREAD = Unread()


def endless() -> None:
    """Refuse a scan that has done more than it may."""
    raise SimulationError(
        "the scan does not end: a loop, or functions that call each other, go on and on",
        hint="Controller(max_steps=..) allows more",
    )


def fail(error: SimulationError) -> Any:
    """Something that could not be translated was reached."""
    fresh = type(error).__new__(type(error))
    fresh.__dict__.update(error.__dict__)
    fresh.args = error.args
    raise fresh


def divided(dividend: int, divisor: int) -> int:
    """Integer division, towards zero (ed. 3, table 29)."""
    quotient = dividend // divisor
    return quotient + 1 if quotient < 0 and quotient * divisor != dividend else quotient


def remainder(dividend: int, divisor: int) -> int:
    """MOD: it has the sign of the dividend (ed. 3, table 29)."""
    return dividend - divisor * divided(dividend, divisor)


def power(base: float, exponent: float) -> float:
    """EXPT (ed. 3, table 29)."""
    try:
        result = math.pow(base, exponent)
    except (OverflowError, ValueError):
        raise SimulationError(f"{base} ** {exponent} is no real number") from None
    return result


def wrapped(value: int, least: int, greatest: int, unit: int) -> int:
    """Return a value in the range of its type, in whole units."""
    if unit > 1:
        value = divided(value, unit) * unit
    if least <= value <= greatest:
        return value
    return (value - least) % (greatest - least + unit) + least


def single(value: float) -> float:
    """Return a number rounded to single precision."""
    return ctypes.c_float(value).value


def half_even(value: float) -> int:
    """Return a real number as an integer, halves to the even one (ed. 3, 6.6.2.5.3 after IEC 60559)."""
    return round(value) if math.isfinite(value) else _not_finite(value)


def half_away(value: float) -> int:
    """Return a real number as an integer, halves away from zero (CODESYS, REAL_TO_INT)."""
    if not math.isfinite(value):
        return _not_finite(value)
    whole = math.floor(abs(value) + 0.5)
    if whole - abs(value) > 0.5:  # 0.49999999999999994 + 0.5 is 1.0
        whole -= 1
    return whole if value >= 0 else -whole


def truncated(value: float) -> int:
    """Return a real number as an integer, towards zero."""
    return math.trunc(value) if math.isfinite(value) else _not_finite(value)


def _not_finite(value: float) -> int:
    raise SimulationError(f"{value} has no integer")


def out_of_bounds(index: int, lower: int, upper: int) -> int:
    """Return an index that an array does not have."""
    raise SimulationError(f"the index {index} is outside of {lower}..{upper}")


def character_at(text: str, index: int, length: int) -> str:
    """Return a character of a string of S7, from 1; behind its end there is none."""
    if not 1 <= index <= length:
        return str(out_of_bounds(index, 1, length))
    return text[index - 1] if index <= len(text) else "\0"


def code_at(text: str, index: int, length: int) -> int:
    """Return the code of a character of a string of CODESYS, from 0; behind its end there is 0."""
    if not 0 <= index <= length:
        return out_of_bounds(index, 0, length)
    return ord(text[index]) if index < len(text) else 0


def narrow(value: int, least: int, greatest: int) -> int:
    """Return a value of a subrange (ed. 3, 6.4.4.4: it is an error if it is outside)."""
    if least <= value <= greatest:
        return value
    raise SimulationError(f"the value {value} is outside of the subrange {least}..{greatest}")


def assign(target: Frame | list[Any], source: Frame | list[Any]) -> None:
    """Copy a structure or an array into another, which stays the same object."""
    to = target.v if isinstance(target, Frame) else target
    values = source.v if isinstance(source, Frame) else source
    if len(to) != len(values):
        raise SimulationError("structures or arrays of different sizes are assigned")
    for index, value in enumerate(values):
        if type(value) is Frame or type(value) is list:
            assign(to[index], value)
        else:
            to[index] = value


def cloned(value: Any) -> Any:
    """Return a copy of a structure or an array."""
    if type(value) is Frame:
        return Frame(value.layout, [cloned(item) for item in value.v])
    if type(value) is list:
        return [cloned(item) for item in value]
    return value


def preset(frame: Frame, *values: tuple[int, Any]) -> Frame:
    """Return a new frame with other values in some of its slots."""
    for slot, value in values:
        frame.v[slot] = value
    return frame


def checked(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a supplied function, called by parameter names in any case, that must return a value.

    Raises `SimulationError` for any error in it.
    """
    name = getattr(function, "__name__", "")
    parameters = {each.casefold(): each for each in _parameters(function)}

    @wraps(function)
    def call(*arguments: Any, **named: Any) -> Any:
        given = {parameters.get(each.casefold(), each): value for each, value in named.items()}
        try:
            result = function(*arguments, **given)
        except SimulationError:
            raise
        except (Exception, SystemExit) as error:
            told = f"{type(error).__name__}: {error}"
            raise SimulationError(f"the supplied function {name} ends with an error: {told}") from None
        if isinstance(result, bool | int | float | str):
            return result
        raise SimulationError(f"the supplied function {name} gives {result!r}, which is no value")

    return call


def _parameters(function: Callable[..., Any]) -> Iterable[str]:
    try:
        return signature(function).parameters
    except (TypeError, ValueError):  # one written in C
        return ()


def named(frame: Frame, name: str) -> Any:
    """Return the variable of a call of which it is only known now what was called; `name` is in lower case."""
    return frame.v[frame.layout.by_name[name].slot]


def put(cells: list[Any], index: int, value: Any) -> Any:
    """Return an assignment as an expression."""
    cells[index] = value
    return value


def bit_set(word: int, bit: int, value: bool) -> int:
    """Return a word with one bit changed."""
    return word | 1 << bit if value else word & ~(1 << bit)


def bits_set(word: int, start: int, width: int, value: int) -> int:
    """Return a word with some of its bits changed."""
    mask = (1 << width) - 1
    return word & ~(mask << start) | (value & mask) << start


def coerced(value: Any, type_: ScalarType) -> Any:
    """Return a value that comes from outside as one of `type_`; a `SimulationError` where it is none."""
    family = type_.family
    if family is Family.SPECIAL or type(value) is Unread:
        return value
    if family is Family.STRING:
        if not isinstance(value, str):
            raise SimulationError(f"{value!r} is no {type_.name}")
        return value[: type_.length] if type_.length else value
    if isinstance(value, str) and value.casefold() in type_.names:
        return type_.names[value.casefold()]
    if not isinstance(value, bool | int | float):
        raise SimulationError(f"{value!r} is no {type_.name}")
    if family is Family.BOOL:
        return bool(value)
    if family is Family.REAL:
        return single(value) if type_.bits == 32 else float(value)
    if isinstance(value, float):
        if not value.is_integer():
            raise SimulationError(f"{value!r} is no {type_.name}")
        value = int(value)
    if type_.narrowed is not None:
        return narrow(int(value), *type_.narrowed)
    return wrapped(int(value), type_.least, type_.greatest, type_.unit)
