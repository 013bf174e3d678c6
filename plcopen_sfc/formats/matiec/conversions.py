"""Conversions that tools make by themselves and matiec does not: ``DINT := INT``, ``REAL + 1``.

CODESYS and TIA Portal convert where no value can be lost. matiec takes operands of one type only, and literals of the
kind of that type (tried with iec2c).
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace

from plcopen_sfc.languages.st import nodes as n

_SIGNED = ("SINT", "INT", "DINT", "LINT")
_UNSIGNED = ("USINT", "UINT", "UDINT", "ULINT")
_BITS = ("BYTE", "WORD", "DWORD", "LWORD")
_REALS = ("REAL", "LREAL")
_NUMBERS = frozenset({*_SIGNED, *_UNSIGNED, *_BITS, *_REALS})
_COMPARISONS = frozenset(
    {
        n.Operator.EQUAL,
        n.Operator.UNEQUAL,
        n.Operator.LESS,
        n.Operator.GREATER,
        n.Operator.LESS_OR_EQUAL,
        n.Operator.GREATER_OR_EQUAL,
    }
)
_ARITHMETIC = frozenset(
    {n.Operator.ADD, n.Operator.SUBTRACT, n.Operator.MULTIPLY, n.Operator.DIVIDE, n.Operator.MODULO}
)
_LOGIC = frozenset({n.Operator.AND, n.Operator.OR, n.Operator.XOR})
_TYPED = re.compile(r"([A-Z]+)#", re.IGNORECASE)
REAL_LITERAL = re.compile(r"[\d_]+\.[\d_]+(?:[eE][+-]?\d+)?")
_WHOLE = re.compile(r"\d[\d_]*")
_FUNCTION = re.compile(r"[A-Z]+_TO_([A-Z]+)", re.IGNORECASE)

TypeOf = Callable[[n.Expression], str]
"""Gives the name of the elementary type of a variable, empty where it has another or is not known."""


class Converter:
    """Gives operands and assigned values the type that matiec wants; `missing` gets what cannot be converted."""

    def __init__(self, type_of: TypeOf, missing: list[tuple[str, str]]) -> None:
        self._type_of = type_of
        self._missing = missing

    def kind(self, value: n.Expression) -> str:
        """The numeric or bit type of an expression, empty for literals that take any and for what is not known."""
        if isinstance(value, n.Parenthesized):
            return self.kind(value.inner)
        if isinstance(value, n.Unary):
            return self.kind(value.operand)
        if isinstance(value, n.Literal):
            typed = _TYPED.match(value.text)
            found = typed[1].upper() if typed is not None else ""
        elif isinstance(value, n.Operation):
            is_number = value.operator in _ARITHMETIC | _LOGIC
            found = next(filter(None, map(self.kind, value.operands)), "") if is_number else ""
        elif isinstance(value, n.Call):
            name = value.callee.identifier if isinstance(value.callee, n.Name) else ""
            converted = _FUNCTION.fullmatch(name)
            found = converted[1].upper() if converted is not None else self._type_of(value)
        else:
            found = self._type_of(value)
        return found if found in _NUMBERS else ""

    def operation(self, node: n.Operation) -> n.Node:
        """An operation with operands of one type."""
        if node.operator not in _ARITHMETIC | _LOGIC | _COMPARISONS:
            return node
        kinds = [self.kind(operand) for operand in node.operands]
        known = {kind for kind in kinds if kind}
        if known and known.isdisjoint(_REALS) and any(map(_is_real, node.operands)):
            known.add("REAL")
        if node.operator in _LOGIC and not known <= set(_BITS):
            self._missing.append(("operation", f"matiec has no {node.operator.value} of {' and '.join(sorted(known))}"))
            return node
        common = next((kind for kind in sorted(known) if all(_widens(other, kind) for other in known)), "")
        if not known:
            return node
        if not common:
            self._missing.append(("operation", f"matiec does not take {' and '.join(sorted(known))} together"))
            return node
        operands = tuple(_as(common, kind, each) for kind, each in zip(kinds, node.operands, strict=True))
        changed = any(a is not b for a, b in zip(operands, node.operands, strict=True))
        return replace(node, operands=operands) if changed else node

    def assignment(self, node: n.Assignment) -> n.Node:
        """An assignment of a value of the type of its target."""
        target, kind = self.kind(node.target), self.kind(node.value)
        if not target or node.kind is not n.AssignmentKind.ASSIGN:
            return node
        if not kind and target not in _REALS and _is_real(node.value):
            kind = "REAL"
        if kind and not _widens(kind, target):
            self._missing.append(("assignment", f"matiec does not assign {kind} to {target}"))
            return node
        value = _as(target, kind, node.value)
        return node if value is node.value else replace(node, value=value)


def _is_real(value: n.Expression) -> bool:
    """True for a literal with a point and without a type."""
    if isinstance(value, n.Unary):
        return _is_real(value.operand)
    return isinstance(value, n.Literal) and REAL_LITERAL.fullmatch(value.text) is not None


def _widens(kind: str, to: str) -> bool:
    """True if every value of a type is one of another, or CODESYS takes it for one (integers as REAL)."""
    if kind == to:
        return True
    for family in (_SIGNED, _UNSIGNED, _BITS, _REALS):
        if kind in family and to in family:
            return family.index(kind) < family.index(to)
    if to in _REALS:
        return kind in _SIGNED or kind in _UNSIGNED
    return kind in _UNSIGNED and to in _SIGNED and _UNSIGNED.index(kind) < _SIGNED.index(to)


def _as(common: str, kind: str, value: n.Expression) -> n.Expression:
    """An operand as one of the type `common`; literals without a type take any, whole ones but those of REAL."""
    if kind and kind != common:
        return n.Call(n.Name(f"{kind}_TO_{common}"), (n.Argument(_without_parentheses(value)),))
    if kind or common not in _REALS:
        return value
    if isinstance(value, n.Literal) and _WHOLE.fullmatch(value.text):
        return replace(value, text=f"{value.text}.0")
    if isinstance(value, n.Operation) and value.operator in _ARITHMETIC:
        operands = tuple(_as(common, kind, each) for each in value.operands)
        changed = any(a is not b for a, b in zip(operands, value.operands, strict=True))
        return replace(value, operands=operands) if changed else value
    if isinstance(value, n.Unary):
        operand = _as(common, kind, value.operand)
        return value if operand is value.operand else replace(value, operand=operand)
    if isinstance(value, n.Parenthesized):
        inner = _as(common, kind, value.inner)
        return value if inner is value.inner else replace(value, inner=inner)
    return value


def _without_parentheses(value: n.Expression) -> n.Expression:
    return value.inner if isinstance(value, n.Parenthesized) else value
