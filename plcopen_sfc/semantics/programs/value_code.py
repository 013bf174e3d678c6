"""Translated expressions: Python source with the type of its value, and the conversions between types."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from plcopen_sfc.errors import SimulationError
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.semantics.programs import runtime
from plcopen_sfc.semantics.programs.code_generation import Linker
from plcopen_sfc.semantics.programs.runtime_types import (
    ANY,
    ArrayOf,
    Family,
    OpaqueType,
    ReferenceType,
    ScalarType,
    StructureType,
    Type,
)

MS = 1_000_000
SECOND = 1_000_000_000
_DAY = 86_400 * SECOND


@dataclass(frozen=True, slots=True)
class Code:
    """An expression as Python source, which is an atom or in parentheses.

    `low` and `high` bound an integer value; they may go beyond its type until it is settled: sums and products wrap
    the same whether at once or later. `constant`: its value is known, `value` is it. `loose`: a literal without a type,
    which takes that of its surroundings. `acts`: evaluating it calls something of the project.
    """

    text: str
    type: Type
    low: int = 0
    high: int = 0
    value: Any = None
    constant: bool = False
    loose: bool = False
    acts: bool = False


def constant(value: Any, type_: ScalarType, *, loose: bool = False) -> Code:
    """Return a known value."""
    bound = value if isinstance(value, int) and not isinstance(value, bool) else 0
    text = repr(value)
    if text.startswith("-") or text in ("inf", "nan"):
        text = f"({text})" if text.startswith("-") and "inf" not in text else f"float({text!r})"
    return Code(text, type_, bound, bound, value, constant=True, loose=loose)


def ranged(text: str, type_: Type, *, acts: bool = False) -> Code:
    """Source whose value is of a type: in its range."""
    if isinstance(type_, ScalarType) and type_.is_ranged:
        low, high = type_.narrowed or (type_.least, type_.greatest)
        return Code(text, type_, low, high, acts=acts)
    return Code(text, type_, acts=acts)


def settled(code: Code) -> Code:
    """Return the same with a value in the range of its type."""
    type_ = code.type
    if not isinstance(type_, ScalarType) or not type_.is_ranged:
        return code
    if type_.least <= code.low and code.high <= type_.greatest:
        return code
    if code.constant:
        value = runtime.wrapped(code.value, type_.least, type_.greatest, type_.unit)
        return replace(constant(value, type_), loose=code.loose)
    return replace(ranged(wrapping(code.text, type_), type_), acts=code.acts)


def wrapping(text: str, type_: ScalarType) -> str:
    """Source that brings an integer into the range of a type."""
    least, greatest, unit = type_.least, type_.greatest, type_.unit
    span = greatest - least + 1
    if unit == 1 and span & (span - 1) == 0:
        if least == 0:
            return f"({text} & {greatest})"
        return f"(({text} + {-least} & {span - 1}) - {-least})"
    return f"wrapped({text}, {least}, {greatest}, {unit})"


def grained(code: Code, type_: ScalarType) -> Code:
    """Return a duration or time with the grain of another type."""
    if type_.unit == 1 or (isinstance(code.type, ScalarType) and code.type.unit % type_.unit == 0):
        return replace(code, type=type_)
    if code.constant:
        return constant(runtime.divided(code.value, type_.unit) * type_.unit, type_)
    text = f"(divided({code.text}, {type_.unit}) * {type_.unit})"
    return replace(code, text=text, type=type_)


class Converter:
    """Conversions: those that assignments do by themselves, and ``X_TO_Y``."""

    def __init__(self, dialect: Dialect, linker: Linker, *, in_seconds: bool) -> None:
        self._linker = linker
        self._in_seconds = in_seconds
        codesys = dialect in (Dialect.CODESYS, Dialect.TWINCAT)
        self.round = "half_away" if codesys else "half_even"

    def fitted(self, code: Code, target: Type) -> Code:
        """Return a value as a variable of type `target` takes it. Raises `SimulationError` where it does not."""
        if isinstance(target, OpaqueType) or isinstance(code.type, OpaqueType) or target is ANY:
            return code
        if not isinstance(target, ScalarType):
            if code.type is not ANY and not _can_be_copied(code.type, target):
                raise SimulationError(f"{code.type.name} is assigned to {target.name}")
            return code
        if not isinstance(code.type, ScalarType):
            raise SimulationError(f"{code.type.name} is assigned to {target.name}")
        found = self.converted(code, target)
        if target.narrowed is not None:
            least, greatest = target.narrowed
            if found.low < least or found.high > greatest:
                if found.constant:
                    runtime.narrow(found.value, least, greatest)
                found = ranged(f"narrow({found.text}, {least}, {greatest})", target, acts=found.acts)
        return found

    def converted(self, code: Code, target: ScalarType) -> Code:
        """Return a value of one elementary type as one of another."""
        source = code.type
        if not isinstance(source, ScalarType):
            raise SimulationError(f"{source.name} cannot become {target.name}")
        if source is ANY:
            return ranged(f"coerced({code.text}, {self._linker.name(target, 'T')})", target, acts=True)
        if target.family is Family.SPECIAL:
            return code
        if source.family is target.family:
            return self._in_family(code, source, target)
        if code.constant:
            return self._constant(code, source, target)
        text = self._text(code, source, target)
        return settled(replace(Code(text, target, *self._range(code, source, target)), acts=code.acts))

    def _in_family(self, code: Code, source: ScalarType, target: ScalarType) -> Code:
        if target.family is Family.REAL:
            if target.bits == 32 and (source.bits != 32 or code.loose):
                if code.constant:
                    return constant(runtime.single(code.value), target)
                return replace(code, text=f"single({code.text})", type=target)
            return replace(code, type=target, loose=False)
        if target.family is Family.STRING:
            if target.length and (not source.length or source.length > target.length):
                if code.constant:
                    return constant(code.value[: target.length], target)
                return replace(code, text=f"{code.text}[:{target.length}]", type=target)
            return replace(code, type=target)
        if target.family is Family.BOOL:
            return replace(code, type=target)
        if not code.loose:
            code = settled(code)
        if target.unit > source.unit or source.unit % target.unit:
            code = grained(code, target)
        return settled(replace(code, type=target, loose=False))

    def _constant(self, code: Code, source: ScalarType, target: ScalarType) -> Code:
        names = {name: getattr(runtime, name) for name in ("half_even", "half_away", "single", "divided", "wrapped")}
        code = settled(code)
        known = {"__builtins__": {"int": int, "float": float}, **names}
        value = eval(self._text(code, source, target), known)  # noqa: S307  # source that was written here
        return settled(constant(value, target))

    def _range(self, code: Code, source: ScalarType, target: ScalarType) -> tuple[int, int]:
        if not target.is_ranged:
            return 0, 0
        if source.family is Family.BOOL:
            return 0, 1
        if source.family is Family.REAL:
            return target.least - 1, target.greatest + 1
        if {source.family, target.family} <= {Family.INTEGER, Family.BITS}:
            if source.least <= code.low and code.high <= source.greatest:
                return code.low, code.high
            return source.least, source.greatest
        return target.least - 1, target.greatest + 1

    def _text(self, code: Code, source: ScalarType, target: ScalarType) -> str:
        """Source of a conversion between families; the result may still be out of range."""
        if source.is_ranged:
            code = settled(code)
        text = code.text
        to_number = target.family in (Family.INTEGER, Family.BITS)
        if source.family is Family.BOOL:
            if target.family is Family.REAL:
                return f"float({text})"
            if target.is_ranged:
                return f"int({text})" if to_number else f"({text} * {self._count_unit(target)})"
        if target.family is Family.BOOL and source.family is not Family.STRING:
            return f"({text} != 0)"
        if source.family is Family.REAL and target.is_ranged:
            if self.round == "half_away" and not to_number:  # CODESYS: the number becomes a whole one first
                return f"({self.round}({text}) * {self._count_unit(target)})"
            scaled = text if to_number else f"({text} * {self._count_unit(target)})"
            return f"{self.round}({scaled})"
        if target.family is Family.REAL and source.is_ranged:
            scaled = text if source.is_number else f"({text} / {self._count_unit(source)})"
            number = f"float({scaled})"
            return f"single({number})" if target.bits == 32 else number
        if source.is_number and to_number:
            return text
        if source.is_number and target.is_ranged:
            return f"({text} * {self._count_unit(target)})"
        if source.is_ranged and to_number:
            return f"divided({text}, {self._count_unit(source)})"
        if source.family is Family.DATE_AND_TIME and target.family is Family.DATE:
            return f"({text} // {_DAY} * {_DAY})"
        if source.family is Family.DATE_AND_TIME and target.family is Family.TIME_OF_DAY:
            return f"({text} % {_DAY})"
        if source.is_ranged and target.is_ranged:
            return text
        raise SimulationError(f"{source.name} cannot become {target.name}")

    def _count_unit(self, type_: ScalarType) -> int:
        """Return how many nanoseconds one is, when a duration, date or time becomes a number.

        CODESYS has TIME and TOD in milliseconds, DATE and DT in seconds, those of 64 bits in nanoseconds; matiec has
        all in seconds (`Profile.matiec_library`).
        """
        if type_.name.startswith("L"):
            return 1
        return SECOND if self._in_seconds or type_.family in (Family.DATE, Family.DATE_AND_TIME) else MS


def _can_be_copied(source: Type, target: Type) -> bool:
    """True if a value that is not elementary goes into a variable: structures of one type, arrays of one size."""
    if isinstance(target, StructureType):
        return isinstance(source, StructureType) and source.layout is target.layout
    if isinstance(target, ArrayOf):
        if not isinstance(source, ArrayOf) or not source.dimensions or not target.dimensions:
            return False
        alike = source.base == target.base or _can_be_copied(source.base, target.base)
        return alike and source.size == target.size
    return isinstance(target, ReferenceType) and isinstance(source, ReferenceType)


def truth(code: Code) -> Code:
    """Return a value as BOOL."""
    is_other = isinstance(code.type, ScalarType) and code.type.family not in (Family.BOOL, Family.SPECIAL)
    if is_other or isinstance(code.type, StructureType | ArrayOf):
        raise SimulationError(f"a {code.type.name} is where a BOOL must be")
    return code
