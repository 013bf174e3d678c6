"""What flows through wires: values as products of factors, so that ladders come out as they are drawn.

In a ladder, contacts behind each other are AND and wires that meet are OR. Two wires that meet have often passed the
same contacts before they parted; those must not be written twice. So a value is kept as the product of all it passed,
each factor with an identity, and where wires meet, what their products begin with in common stays outside the OR.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from itertools import groupby
from typing import NamedTuple

from plcopen_sfc.languages.st.nodes import Expression, Literal, Operation, Operator, Unary, bare

TRUE = Literal("TRUE")


class Factor(NamedTuple):
    """A factor of a product: what it is in the network (equal for the same element only), and its expression."""

    identity: Hashable
    expression: Expression


Product = tuple[Factor, ...]
"""A value as a product; the empty one is TRUE, the value of the left power rail."""


def is_true(expression: Expression) -> bool:
    """Whether it is the literal TRUE."""
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
