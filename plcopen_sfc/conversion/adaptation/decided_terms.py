"""Conditions without the terms that others in them decide."""

from __future__ import annotations

from collections.abc import Mapping

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import walk
from plcopen_sfc.languages.st.nodes import Expression, Operator
from plcopen_sfc.lowering.code.boolean_logic import FALSE, TRUE, conjunction, disjunction, negation, simplified


def reduced(tree: Expression) -> Expression:
    """Return the same without terms that others decide: of ``a AND (b OR NOT a)`` remains ``a AND b``.

    Functions would be called less often, so nothing with a call is changed.
    """
    if any(isinstance(node, n.Call) for node in walk(tree)):
        return tree
    found, before = simplified(tree), None
    while found != before:  # what falls away lets others decide more; each turn leaves less
        before, found = found, _decided(found, {})
    return found


def _decided(node: Expression, known: Mapping[Expression, bool]) -> Expression:
    """Return an expression as it is where those in `known` have these values."""
    inner = n.bare(node)
    if inner in known:
        return TRUE if known[inner] else FALSE
    if isinstance(inner, n.Unary) and inner.operator is Operator.NOT:
        return negation(_decided(inner.operand, known))
    if not (isinstance(inner, n.Operation) and inner.operator in (Operator.AND, Operator.OR)):
        return node
    # an operand of AND counts while all others are TRUE, one of OR while all others are FALSE
    is_all = inner.operator is Operator.AND
    operands = [*inner.operands]
    # the longest come first, so that a short term remains and decides in them
    for place in sorted(range(len(operands)), key=lambda at: not _is_joined(operands[at])):
        others = (_valued(each, is_all) for at, each in enumerate(operands) if at != place)
        operands[place] = _decided(operands[place], {**known, **dict(others)})
    return _absorbed((conjunction if is_all else disjunction)(operands), is_all)


def _valued(operand: Expression, value: bool) -> tuple[Expression, bool]:
    """Return what an operand inverts, or itself, and the value of that where the operand has `value`."""
    inner = n.bare(operand)
    if isinstance(inner, n.Unary) and inner.operator is Operator.NOT:
        return _valued(inner.operand, not value)
    return inner, value


def _is_joined(operand: Expression) -> bool:
    found, _ = _valued(operand, True)
    return isinstance(found, n.Operation) and found.operator in (Operator.AND, Operator.OR)


def _absorbed(node: Expression, is_all: bool) -> Expression:
    """Return an expression without operands that others contain: ``a OR a AND b`` is ``a``."""
    if not (isinstance(node, n.Operation) and node.operator is (Operator.AND if is_all else Operator.OR)):
        return node
    other = Operator.OR if is_all else Operator.AND
    parts = [
        frozenset(o.operands) if isinstance(o, n.Operation) and o.operator is other else frozenset((o,))
        for o in map(n.bare, node.operands)
    ]
    kept = [o for at, o in enumerate(node.operands) if not any(each < parts[at] for each in parts)]
    return (conjunction if is_all else disjunction)(kept)
