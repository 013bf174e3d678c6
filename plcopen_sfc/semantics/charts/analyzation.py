"""Why a step is still active: what SFCErrorAnalyzation reports (CODESYS, library Analyzation, ``AnalyzeExpression``).

The operands that keep the condition of a transition from being TRUE: of ``a AND (b OR c)``, while only `a` is TRUE,
these are `b` and `c`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression
from plcopen_sfc.model import Expression
from plcopen_sfc.semantics.net import Net
from plcopen_sfc.semantics.programs.layouts import Frame

if TYPE_CHECKING:
    from plcopen_sfc.semantics.programs import Scope


class Reason(NamedTuple):
    """An operand and the value that it has."""

    text: str
    value: bool


Analysis = Callable[[Frame], list[Reason]]
"""What keeps a condition from its value; nothing if it has it."""


def analysis(net: Net, step: int, scope: Scope, where: str) -> Analysis:
    """The analysis of all transitions that leave a step."""
    found: list[Analysis] = []
    for index in net.leaving[step]:
        condition = net.transitions[index].transition.condition
        if isinstance(condition, Expression):
            parsed = parse_expression(condition.text, scope.library.dialect)
            if not parsed.problems:
                found.append(_Texts(scope, condition.text, where).of(parsed.tree, not condition.negated))
    return _all_of(found)


class _Texts:
    def __init__(self, scope: Scope, text: str, where: str) -> None:
        self._scope = scope
        self._text = text
        self._where = where

    def of(self, node: n.Expression, wanted: bool) -> Analysis:
        """What keeps `node` from being `wanted`."""
        match node:
            case n.Parenthesized():
                return self.of(node.inner, wanted)
            case n.Unary(operator=n.Operator.NOT):
                return self.of(node.operand, not wanted)
            case n.Operation(operator=n.Operator.AND | n.Operator.AND_THEN | n.Operator.OR | n.Operator.OR_ELSE):
                conjunction = node.operator in (n.Operator.AND, n.Operator.AND_THEN)
                operands = [self.of(operand, wanted) for operand in node.operands]
                return _all_of(operands) if conjunction is wanted else _any_of(operands)
        return self._leaf(node, wanted)

    def _leaf(self, node: n.Expression, wanted: bool) -> Analysis:
        start, end = node.span or (0, len(self._text))
        text = self._text[start:end]
        value = self._scope.condition(Expression(text=text), self._where)

        def explain(frame: Frame) -> list[Reason]:
            return [] if bool(value(frame)) is wanted else [Reason(text, not wanted)]

        return explain


def _all_of(operands: list[Analysis]) -> Analysis:
    """All operands must have their values: those that have not are the reasons."""
    return lambda frame: [reason for explain in operands for reason in explain(frame)]


def _any_of(operands: list[Analysis]) -> Analysis:
    """One operand would do: if there is none, all are the reasons."""

    def explain(frame: Frame) -> list[Reason]:
        reasons = [explain(frame) for explain in operands]
        return [reason for found in reasons for reason in found] if all(reasons) else []

    return explain
