"""The normal form in which networks and text are the inverse of each other.

A network does not tell everything that a text does (parentheses, ``GT(a, b)`` or ``a > b``), nor a text everything that
a network does (where NOT is drawn, how AND blocks are nested). Two texts with one normal form are drawn alike; what is
drawn from a text and read again has the normal form of that text. Normal is:

- no parentheses, no regions, no lone semicolons;
- AND, OR and XOR hold no operation of their own kind, + and * none as their first operand;
- ``0 - x`` is ``-x``;
- NOT is never doubled; TRUE is no operand of AND, and of OR once at most;
- standard functions that are operators are written as such; the arguments of others are by position, in the order of
  IEC 61131-3, where all are given, else by the names of IEC 61131-3;
- comparisons of more than two are AND of those of two; ``MOVE(x)`` is ``x``;
- ``IF c THEN x := TRUE; END_IF`` is ``x S= c``, with FALSE ``x R= c``;
- TRUE and FALSE are in capitals; a condition that is always TRUE is left out.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from typing import TypeVar

from plcopen_sfc.languages.networks.values import TRUE, inverted, joined
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import AssignmentKind, Expression, Operator, Statement
from plcopen_sfc.languages.st.walking import transform
from plcopen_sfc.languages.standard_blocks import StandardBlock, standard_block

AnyNode = TypeVar("AnyNode", bound=n.Node)


def normal_form(tree: AnyNode) -> AnyNode:
    """The normal form of an expression or of statements."""
    return transform(tree, _normal)


def _normal(node: n.Node) -> n.Node:
    match node:
        case n.Parenthesized(inner):
            return inner
        case n.Literal(text) if text.upper() in ("TRUE", "FALSE"):
            return n.Literal(text.upper())
        case n.Unary(Operator.NOT, operand):
            return inverted(operand)
        case n.Operation():
            return _operation(node.operator, node.operands)
        case n.Call(n.Name(identifier, n.Quoting.NONE)):
            block = standard_block(identifier)
            return _standard_call(node, block) if block is not None and not block.stateful else node
        case n.Statements(statements):
            return n.Statements(tuple(_statements(statements)))
        case n.Branch(condition, statements):
            return n.Branch(condition, tuple(_statements(statements)))
        case n.If():
            return _stored(node)
        case _:
            return node


def _operation(operator: Operator, operands: Sequence[Expression]) -> Expression:
    if operator is Operator.AND:
        operands = [operand for operand in operands if operand != TRUE]
        return joined(operator, operands) if operands else TRUE
    if operator is Operator.OR:
        return _or(joined(operator, operands))
    if operator is Operator.XOR:
        return joined(operator, operands)
    first = operands[0]
    if operator is Operator.SUBTRACT and len(operands) == 2 and first == n.Literal("0"):
        return n.Unary(Operator.NEGATE, operands[1])
    if operator in (Operator.ADD, Operator.MULTIPLY) and isinstance(first, n.Operation) and first.operator is operator:
        operands = (*first.operands, *operands[1:])
    return n.Operation(operator, tuple(operands))


def _or(flat: Expression) -> Expression:
    if not isinstance(flat, n.Operation) or flat.operator is not Operator.OR:
        return flat
    always = [index for index, operand in enumerate(flat.operands) if operand == TRUE]
    return joined(Operator.OR, [o for index, o in enumerate(flat.operands) if index not in always[1:]])


_COMPARISONS = frozenset(
    {
        Operator.EQUAL,
        Operator.LESS,
        Operator.GREATER,
        Operator.LESS_OR_EQUAL,
        Operator.GREATER_OR_EQUAL,
    }
)


def _standard_call(call: n.Call, block: StandardBlock) -> Expression:
    given = [(a.name.identifier if a.name is not None else "", a.value) for a in call.arguments]
    values = [value for _, value in given if value is not None]
    if len(values) < len(given) or any(a.output for a in call.arguments):
        return call
    pins = [pin.name for pin in block.input_pins(len(given))]
    names = [block.input_name(name) or name for name, _ in given]
    if any(names):
        by_name = dict(zip(names, values, strict=True))
        if sorted(pins) != sorted(names):
            arguments = (
                n.Argument(value, n.Name(name) if name else None) for name, value in zip(names, values, strict=True)
            )
            return n.Call(n.Name(block.name), tuple(arguments))
        values = [by_name[pin] for pin in pins]
    if len(values) != len(pins):
        return n.Call(n.Name(block.name), tuple(n.Argument(value) for value in values))
    return _by_position(block, values)


def _by_position(block: StandardBlock, values: Sequence[Expression]) -> Expression:
    operator = block.operator
    if block.name == "MOVE":
        return values[0]
    if operator is Operator.NOT:
        return inverted(values[0])
    if operator in _COMPARISONS and len(values) > 2:
        return joined(Operator.AND, [n.Operation(operator, pair) for pair in pairwise(values)])
    if operator is not None:
        return _operation(operator, values)
    return n.Call(n.Name(block.name), tuple(n.Argument(value) for value in values))


def _statements(statements: Iterable[Statement]) -> Iterator[Statement]:
    for statement in statements:
        if isinstance(statement, n.Region):
            yield from _statements(statement.statements)
        elif isinstance(statement, n.If) and statement.branches[0].condition == TRUE:
            yield from statement.branches[0].statements
        elif not isinstance(statement, n.Empty):
            yield statement


def _stored(statement: n.If) -> Statement:
    branch = statement.branches[0]
    inner = branch.statements[0] if len(branch.statements) == 1 else None
    if len(statement.branches) == 1 and statement.otherwise is None and isinstance(inner, n.Assignment):
        stored = _STORED.get(inner.value.text) if isinstance(inner.value, n.Literal) else None
        if stored is not None and inner.kind is AssignmentKind.ASSIGN:
            return n.Assignment(inner.target, branch.condition, stored)
    return statement


_STORED = {"TRUE": AssignmentKind.SET, "FALSE": AssignmentKind.RESET}
