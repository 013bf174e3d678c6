"""Parts of Boolean expressions, and when they decide: what must be tried of a condition besides its outcome.

A part of OR decides while it is TRUE and all others are FALSE, a part of AND while it is FALSE and all others are TRUE,
and nothing outside of that operation decides already (masking MC/DC).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from plcopen_sfc.languages.networks import normal_form
from plcopen_sfc.languages.networks.values import inverted, joined
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node, walk
from plcopen_sfc.languages.st.nodes import Expression, Operator
from plcopen_sfc.languages.standard_blocks import standard_block

Decision = tuple[str, bool | None, n.Expression]
"""A part of a condition, or empty the whole; the value it is to have, None: it is to decide; and what is TRUE then."""

_AND = (Operator.AND, Operator.AND_THEN)
_OR = (Operator.OR, Operator.OR_ELSE)
COMPARING = frozenset(
    {
        Operator.EQUAL,
        Operator.UNEQUAL,
        Operator.LESS,
        Operator.GREATER,
        Operator.LESS_OR_EQUAL,
        Operator.GREATER_OR_EQUAL,
    }
)


def deciding_parts(
    tree: Expression | None, around: tuple[Expression, ...] = ()
) -> Iterator[tuple[Expression, Expression]]:
    """Yield the parts of a condition that compare, and when they decide it.

    `around` is what must hold for the condition to matter.
    """
    match tree:
        case n.Parenthesized(inner):
            yield from deciding_parts(inner, around)
        case n.Unary(Operator.NOT, operand):
            yield from deciding_parts(operand, around)
        case n.Operation(operator, operands) if operator in _AND or operator in _OR:
            is_or = operator in _OR
            for number, operand in enumerate(operands):
                others = [*operands[:number], *operands[number + 1 :]]
                visible = (*around, *(map(inverted, others) if is_or else others))
                if any(map(compares, walk(operand))):
                    yield operand, joined(Operator.AND, [*visible, operand if is_or else inverted(operand)])
                yield from deciding_parts(operand, visible)


def bounds(tree: Expression | None, around: tuple[Expression, ...] = ()) -> Iterator[tuple[n.Operation, Expression]]:
    """Yield the comparisons by size in a condition, and what must hold for each of them to matter; TRUE: nothing."""
    match tree:
        case n.Parenthesized(inner) | n.Unary(Operator.NOT, inner):
            yield from bounds(inner, around)
        case n.Operation(operator, operands) if operator in _AND or operator in _OR:
            for number, operand in enumerate(operands):
                others = [*operands[:number], *operands[number + 1 :]]
                yield from bounds(operand, (*around, *(map(inverted, others) if operator in _OR else others)))
        case n.Operation(operator) if operator in COMPARING and operator is not Operator.UNEQUAL:
            yield tree, joined(Operator.AND, around) if around else n.Literal("TRUE")


def deciding_booleans(tree: Expression | None) -> Iterator[Expression]:
    """Yield the Booleans that a condition joins, each once."""
    found: dict[str, Expression] = {}
    waiting = list(_operands(tree))
    while waiting:
        node = waiting.pop(0)
        inner = list(_operands(node))
        waiting += inner
        if not inner and not isinstance(node, n.Literal) and not any(map(compares, walk(node))):
            found.setdefault(print_node(node).casefold(), node)
    return iter(found.values())


def decisions(condition: n.Expression, before: Sequence[n.Expression] = ()) -> Iterator[Decision]:
    """Yield the outcomes and parts of a condition; `before` are conditions that must be TRUE for it to be tested."""
    tree = normal_form(condition)
    yield "", True, joined(Operator.AND, [*before, tree])
    yield "", False, joined(Operator.AND, [*before, inverted(tree)])
    for part, value, deciding in parts_that_decide(tree):
        yield part, value, joined(Operator.AND, [*before, deciding])
    for leaf in deciding_booleans(tree):
        for value in (True, False):
            yield print_node(leaf), value, joined(Operator.AND, [*before, leaf if value else inverted(leaf)])


def parts_that_decide(condition: n.Expression) -> Iterator[Decision]:
    """Yield the parts of a condition that decide it."""
    for part, deciding in deciding_parts(normal_form(condition)):
        yield print_node(part), None, deciding


def decided_arguments(node: n.Node) -> Iterator[Expression]:
    """Yield the arguments of calls in a statement or expression that compare: ``SEL(n > 5, a, b)``."""
    for each in walk(node):
        if isinstance(each, n.Argument) and not each.output and each.value is not None and _is_decision(each.value):
            yield each.value


def _is_decision(tree: Expression) -> bool:
    """Return True for a comparison, and for Booleans joined with one."""
    tree = _bare(tree)
    return compares(tree) or any(map(_is_decision, _operands(tree)))


def _operands(tree: Expression | None) -> Sequence[Expression]:
    """Operands that an operation joins; none for a condition that joins nothing."""
    tree = _bare(tree) if tree is not None else None
    if isinstance(tree, n.Operation) and tree.operator in (*_AND, *_OR, Operator.XOR):
        return [_bare(each) for each in tree.operands]
    return ()


def _bare(tree: Expression) -> Expression:
    """An operand without parentheses and NOT."""
    while isinstance(tree, n.Parenthesized) or (isinstance(tree, n.Unary) and tree.operator is Operator.NOT):
        tree = tree.inner if isinstance(tree, n.Parenthesized) else tree.operand
    return tree


def compares(node: n.Node) -> bool:
    """Return True for comparisons of numbers and times, or of what may be some."""
    if not isinstance(node, n.Operation) or node.operator not in COMPARING:
        return False
    return not any(isinstance(each, n.Literal) and each.text in ("TRUE", "FALSE") for each in node.operands)


def may_act(node: n.Node) -> bool:
    """Return True for calls that may do more than give a value."""
    if isinstance(node, n.AssignmentExpression):
        return True
    if not isinstance(node, n.Call):
        return False
    block = standard_block(node.callee.identifier) if isinstance(node.callee, n.Name) else None
    return block is None or block.stateful
