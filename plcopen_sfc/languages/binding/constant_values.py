"""Values of constant expressions in declarations: ``K1 * 2 + 1``, where K1 is a constant.

CODESYS and IEC 61131-3 take such expressions for start values, bounds of arrays and lengths of strings. TIA Portal
takes a literal or the name of one constant, and for a user constant a literal only.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from operator import add, mul, sub
from typing import Any

from plcopen_sfc.languages.binding.name_resolution import Resolver
from plcopen_sfc.languages.binding.text_sites import Site, TextSite, ValueOf
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression
from plcopen_sfc.languages.st.literals import (
    INTEGER_RANGES,
    LiteralError,
    LiteralKind,
    LiteralValue,
    known_literal,
    real_literal,
    write_literal,
)
from plcopen_sfc.model import types as t
from plcopen_sfc.model.declaration import Declaration
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.variables import SectionKind

_DEEPEST = 32
_REALS = frozenset({"REAL", "LREAL"})
_DURATIONS = frozenset({"TIME", "LTIME"})
_BITS = frozenset({"BYTE", "WORD", "DWORD", "LWORD"})
_WIDE = frozenset({"LINT", "ULINT", "LWORD"})
_KINDS = frozenset({LiteralKind.BOOL, LiteralKind.INTEGER, LiteralKind.REAL, LiteralKind.DURATION})
_MILLISECOND = 1_000_000
"""Nanoseconds of a millisecond, the resolution of TIME."""


class ConstantValues:
    """Values of the constant expressions in the declarations of a project."""

    def __init__(self, resolver: Resolver) -> None:
        project = resolver.project
        self._resolver = resolver
        sections = [section for each in project.interfaces() for section in each.sections]
        globals_ = [section for section in project.global_sections() if section.constant]
        held = [s for s in sections if s.constant or s.kind is SectionKind.CONSTANT]
        tables = [constant for table in project.tag_tables for constant in table.constants]
        constants = [variable for section in (*globals_, *held) for variable in section.variables] + tables
        self._constants = {id(variable) for variable in constants}
        self.names = frozenset(variable.name for variable in constants)
        users = [variable for section in globals_ for variable in section.variables] + tables
        self._user_values = {id(variable.initial) for variable in users}

    def is_calculated(self, text_site: TextSite) -> bool:
        """True if TIA Portal takes no such text at this place of a declaration."""
        if not isinstance(text_site.holder, t.SimpleValue | t.Dimension | t.StringType | t.EnumValue | t.RepeatedValue):
            return False
        parsed = parse_expression(text_site.text, self._resolver.dialect)
        tree = parsed.tree
        if parsed.problems or isinstance(tree, n.Literal):
            return False
        if isinstance(tree, n.Unary) and tree.operator in (n.Operator.NEGATE, n.Operator.PLUS):
            return not isinstance(tree.operand, n.Literal)
        if not isinstance(tree, n.Name | n.Member):
            return isinstance(tree, n.Unary | n.Operation | n.Parenthesized | n.Call)
        found = self._declaration(tree, text_site.site)
        if found is None or not isinstance(found.holder, t.Variable):
            return False
        is_number = isinstance(text_site.holder, t.EnumValue | t.RepeatedValue)
        return is_number or id(text_site.holder) in self._user_values or id(found.holder) not in self._constants

    def literal(self, text_site: TextSite) -> str | None:
        """Return the literal of the value that an expression at this place has; None where it is not known."""
        value = self._value(parse_expression(text_site.text, self._resolver.dialect).tree, text_site.site, 0)
        wanted = ""
        if isinstance(text_site.owner, ValueOf):
            type_ = self._resolver.type_of_value(text_site.owner, text_site.site)
            while isinstance(type_, t.ArrayType):
                type_ = type_.base
            wanted = _elementary(type_)
            if not wanted:
                return None
        value = _of_type(value, wanted) if wanted else value
        return None if value is None else _literal(value, self._resolver.dialect)

    def number(self, name: n.Name, site: Site) -> int | None:
        """Return the whole number that a constant has; None where it has none, or nothing known."""
        value = self._named(name, site, 0)
        return value.value if value is not None and isinstance(value.value, int) else None

    def _value(self, tree: n.Expression, site: Site, depth: int) -> LiteralValue | None:
        match n.bare(tree):
            case n.Literal() as literal:
                value = known_literal(literal, self._resolver.dialect)
                return value if value is not None and value.kind in _KINDS else None
            case n.Unary(operator, operand):
                inner = self._value(operand, site, depth)
                return None if inner is None else _signed(operator, inner)
            case n.Operation(operator, operands):
                found = [self._value(each, site, depth) for each in operands]
                values = [each for each in found if each is not None]
                if len(values) < len(found):
                    return None
                wide_only = self._resolver.dialect in (Dialect.CODESYS, Dialect.TWINCAT)
                result: LiteralValue | None = values[0]
                for each in values[1:]:
                    result = _calculated(operator, result, each, wide_only=wide_only)
                return result
            case (n.Name() | n.Member()) as name if depth < _DEEPEST:
                return self._named(name, site, depth)
        return None

    def _declaration(self, tree: n.Name | n.Member, site: Site) -> Declaration | None:
        found = self._resolver.declaration_of(tree, site)
        return None if found is None else self._resolver.original(found)

    def _named(self, tree: n.Name | n.Member, site: Site, depth: int) -> LiteralValue | None:
        found = self._declaration(tree, site)
        holder = found.holder if found is not None else None
        if found is None or not isinstance(holder, t.Variable) or id(holder) not in self._constants:
            return None
        if not isinstance(holder.initial, t.SimpleValue) or not holder.initial.text:
            return None
        around = Site(pou=found.pou, place=found.pou.place if found.pou is not None else site.place)
        parsed = parse_expression(holder.initial.text, self._resolver.dialect)
        value = None if parsed.problems else self._value(parsed.tree, around, depth + 1)
        return _of_type(value, _elementary(self._resolver.settled(holder.type, around.place)))


def _elementary(type_: object) -> str:
    if isinstance(type_, t.SubrangeType):
        return _elementary(type_.base)
    return type_.name.value if isinstance(type_, t.ElementaryType) else ""


def _signed(operator: n.Operator, value: LiteralValue) -> LiteralValue | None:
    if operator is n.Operator.NOT:
        return LiteralValue(value.kind, not value.value, value.type) if value.kind is LiteralKind.BOOL else None
    if value.kind not in (LiteralKind.INTEGER, LiteralKind.REAL) or not isinstance(value.value, int | float):
        return None
    if operator is n.Operator.PLUS:
        return value
    is_unsigned = value.type in _BITS or value.type.startswith("U")
    return None if is_unsigned else LiteralValue(value.kind, -value.value, value.type)


def _calculated(
    operator: n.Operator, one: LiteralValue | None, other: LiteralValue, *, wide_only: bool
) -> LiteralValue | None:
    """Return a result that all tools agree on; None for others, such as those that do not fit their type.

    `wide_only`: integers are calculated with 32 bits at least.
    """
    if one is None or not isinstance(one.value, int | float) or not isinstance(other.value, int | float):
        return None
    left, right = one.value, other.value
    kinds, types = {one.kind, other.kind}, {one.type, other.type}
    if kinds == {LiteralKind.BOOL}:
        result = {
            n.Operator.AND: left and right,
            n.Operator.OR: left or right,
            n.Operator.XOR: left != right,
        }.get(operator)
        return None if result is None else LiteralValue(LiteralKind.BOOL, result)
    if kinds == {LiteralKind.INTEGER}:
        return _integer(operator, int(left), int(right), types, wide_only=wide_only)
    if kinds <= {LiteralKind.INTEGER, LiteralKind.REAL}:
        return _real(operator, float(left), float(right), types)
    if one.kind is LiteralKind.DURATION:
        return _duration(operator, int(left), int(right), other.kind, "LTIME" if "LTIME" in types else "TIME")
    is_product = operator is n.Operator.MULTIPLY and other.kind is LiteralKind.DURATION
    return _duration(operator, int(right), int(left), one.kind, other.type) if is_product else None


_PLAIN: dict[n.Operator, Callable[[Any, Any], Any]] = {
    n.Operator.ADD: add,
    n.Operator.SUBTRACT: sub,
    n.Operator.MULTIPLY: mul,
}


def _integer(
    operator: n.Operator, left: int, right: int, operands: set[str], *, wide_only: bool
) -> LiteralValue | None:
    if operator in (n.Operator.DIVIDE, n.Operator.MODULO):
        if not right:
            return None
        quotient = abs(left) // abs(right) * (1 if (left < 0) is (right < 0) else -1)
        result = quotient if operator is n.Operator.DIVIDE else left - quotient * right
    elif operator in _PLAIN:
        result = _PLAIN[operator](left, right)
    else:
        return None
    types = sorted(operands - {""}, key=lambda name: INTEGER_RANGES.get(name, (0, 0))[1])
    widest = types[-1] if types else ""
    if result < 0 and any(name in _BITS or name.startswith("U") for name in types):
        return None
    least, greatest = INTEGER_RANGES["LINT" if widest in _WIDE else "DINT"]
    if widest and not wide_only:
        least, greatest = INTEGER_RANGES.get(widest, (0, 0))
    return LiteralValue(LiteralKind.INTEGER, result, widest) if least <= result <= greatest else None


def _real(operator: n.Operator, left: float, right: float, types: set[str]) -> LiteralValue | None:
    if operator is n.Operator.DIVIDE and not right:
        return None
    if operator is n.Operator.DIVIDE:
        result = left / right
    elif operator in _PLAIN:
        result = _PLAIN[operator](left, right)
    else:
        return None
    narrow = "REAL" in types and not types & {"", "LREAL"}
    return _of_type(LiteralValue(LiteralKind.REAL, result), "REAL" if narrow else "LREAL")


def _duration(operator: n.Operator, left: int, right: int, kind: LiteralKind, type_: str) -> LiteralValue | None:
    """Calculate with a duration of a type, and something of a kind."""
    if kind is LiteralKind.DURATION and operator in (n.Operator.ADD, n.Operator.SUBTRACT):
        result = left + right if operator is n.Operator.ADD else left - right
    elif kind is LiteralKind.INTEGER and operator is n.Operator.MULTIPLY:
        result = left * right
    elif kind is LiteralKind.INTEGER and operator is n.Operator.DIVIDE and right > 0:
        unit = _MILLISECOND if type_ == "TIME" else 1
        result = left // unit // right * unit
    else:
        return None
    return LiteralValue(LiteralKind.DURATION, result, type_) if result >= 0 else None


def _of_type(value: LiteralValue | None, type_: str) -> LiteralValue | None:
    """Return the value that a variable of an elementary type gets; None where it does not fit."""
    if value is None or not isinstance(value.value, int | float):
        return None
    if type_ in _REALS and value.kind in (LiteralKind.REAL, LiteralKind.INTEGER):
        number = float(value.value)
        if not math.isfinite(number):
            return None
        return LiteralValue(LiteralKind.REAL, _single(number) if type_ == "REAL" else number, type_)
    if type_ in INTEGER_RANGES and value.kind is LiteralKind.INTEGER:
        least, greatest = INTEGER_RANGES[type_]
        return LiteralValue(value.kind, value.value, type_) if least <= value.value <= greatest else None
    is_bool = type_ == "BOOL" and value.kind is LiteralKind.BOOL
    if is_bool or (type_ in _DURATIONS and value.kind is LiteralKind.DURATION):
        return LiteralValue(value.kind, value.value, "" if is_bool else type_)
    return None


def _single(number: float) -> float:
    """Return the shortest decimal that means the same REAL of 32 bits."""
    try:
        single = struct.unpack("f", struct.pack("f", number))[0]
    except OverflowError:
        return math.inf
    decimals = (float(f"{single:.{digits}g}") for digits in range(1, 10))
    return next((each for each in decimals if struct.pack("f", each) == struct.pack("f", single)), single)


def _literal(value: LiteralValue, dialect: Dialect) -> str | None:
    """Return the literal without its type, which the declaration has."""
    try:
        if value.kind is LiteralKind.REAL and isinstance(value.value, float):
            return real_literal(value.value)
        if value.kind is LiteralKind.INTEGER:
            return f"16#{value.value:X}" if value.type in _BITS else str(value.value)
        return write_literal(value, dialect)
    except LiteralError:
        return None
