"""Values that flow through wires, as products of factors, so that ladders come out as they are drawn.

In a ladder, contacts behind each other are AND and wires that meet are OR. Two wires that meet have often passed the
same contacts before they parted; those must not be written twice. So a value is kept as the product of all it passed,
each factor with an identity, and where wires meet, what their products begin with in common stays outside the OR.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Sequence
from itertools import groupby, pairwise
from typing import NamedTuple, TypeVar

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import (
    AssignmentKind,
    Expression,
    Literal,
    Operation,
    Operator,
    Statement,
    Unary,
    bare,
)
from plcopen_sfc.languages.st.walking import transform
from plcopen_sfc.languages.standard_blocks import StandardBlock, standard_block

TRUE = Literal("TRUE")


class Factor(NamedTuple):
    """A factor of a product: what it is in the network (equal for the same element only), and its expression."""

    identity: Hashable
    expression: Expression


Product = tuple[Factor, ...]
"""A value as a product; the empty one is TRUE, the value of the left power rail."""


def is_true(expression: Expression) -> bool:
    """True if it is the literal TRUE."""
    inner = bare(expression)
    return isinstance(inner, Literal) and inner.text.upper() == "TRUE"


def expression_of(product: Product) -> Expression:
    """A product as an expression."""
    return joined(Operator.AND, [factor.expression for factor in product]) if product else TRUE


def joined(operator: Operator, operands: Sequence[Expression]) -> Expression:
    """Operands joined by an associative operator; those that are joined by the same one are taken apart."""
    flat: list[Expression] = []
    for operand in operands:
        inner = bare(operand)
        if isinstance(inner, Operation) and inner.operator is operator:
            flat.extend(inner.operands)
        else:
            flat.append(operand)
    return flat[0] if len(flat) == 1 else Operation(operator, tuple(flat))


def inverted(expression: Expression) -> Expression:
    """NOT of an expression; of one that is inverted already, what is inside."""
    inner = bare(expression)
    if isinstance(inner, Unary) and inner.operator is Operator.NOT:
        return inner.operand
    return Unary(Operator.NOT, expression)


def product_of(products: Sequence[Product]) -> Product:
    """The product of products; what is in several of them counts once."""
    return tuple({factor.identity: factor for product in products for factor in product}.values())


def meeting(products: Sequence[Product], meetings: dict[Hashable, int]) -> Product:
    """The value where wires meet: TRUE if one of them is. `meetings` numbers the meetings of a network."""
    if len(products) == 1:
        return products[0]
    shared = _shared_start(products)
    start, rests = products[0][:shared], [product[shared:] for product in products]
    if not any(rests):
        return start
    alternatives = []
    for _, group in groupby(rests, key=lambda rest: rest[0].identity if rest else None):
        branch = list(group)
        alternatives.append(
            expression_of(branch[0] if len(branch) == 1 or not branch[0] else meeting(branch, meetings))
        )
    identity = tuple(tuple(factor.identity for factor in rest) for rest in rests)
    number = meetings.setdefault(identity, len(meetings))
    return (*start, Factor(number, joined(Operator.OR, alternatives)))


def _shared_start(products: Sequence[Product]) -> int:
    shortest = min(len(product) for product in products)
    for index in range(shortest):
        if len({product[index].identity for product in products}) > 1:
            return index
    return shortest


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
