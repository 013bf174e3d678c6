"""Conditions of sequential function charts as IEC 60848 writes them: ``a * /b``, ``XFill``, ``3s/XFill``."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping

from plcopen_sfc.languages.grafcet_conditions import is_operand
from plcopen_sfc.languages.networks import condition_reader
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_condition, print_node
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.pou import NamedTransition
from plcopen_sfc.model.sfc import ActionAssociation, Condition, SfcNetwork, Step

_SIGNS = {n.Operator.AND: " * ", n.Operator.OR: " + "}
_CONSTANTS = {"TRUE": "1", "FALSE": "0"}
_ONE_UNIT = re.compile(r"(?:T|TIME)#(\d+(?:\.\d+)?(?:ms|s|h|d))", re.IGNORECASE)


def expression_of(
    chart: SfcNetwork, condition: Condition | None, objects: Iterable[NamedTransition]
) -> Expression | None:
    """Return a condition in `chart` as an expression, also one that is drawn; None where no text expresses it.

    `objects` are the transition objects of the POU.
    """
    if condition is None or isinstance(condition, Expression):
        return condition
    found = condition_reader(chart, transitions=objects)(condition)
    if found.tree is None or found.helpers or found.obstacles or found.before:
        return None
    return Expression(text=" ".join(print_node(found.tree).split()))


def with_condition(
    chart: SfcNetwork, step: Step, action: ActionAssociation, objects: Iterable[NamedTransition]
) -> ActionAssociation:
    """Return an action N that acts only with the interlock of its step (NC of S7-GRAPH) as one with a condition."""
    is_continuous = action.qualifier in (Qualifier.N, Qualifier.NONE) and action.event is None and action.value is None
    if not action.interlock or not is_continuous:
        return action
    expression = expression_of(chart, step.conditions.get("interlock"), objects)
    return action if expression is None else action.model_copy(update={"interlock": False, "condition": expression})


def in_notation(condition: Expression, flags: Mapping[str, str], own: Collection[str]) -> str | None:
    """Return a condition in the notation of IEC 60848; None where that has no words for all of it.

    `flags` are those of steps by the names of these in lower case, `own` the steps (lower case) that are active where
    it is asked for.
    """
    parsed = parse_condition(condition.text)
    if parsed.problems or parsed.tree is None:
        return None
    tree = n.Unary(n.Operator.NOT, parsed.tree) if condition.negated else parsed.tree
    return _Notation(flags, own).written(tree)


def flags_of(chart: SfcNetwork, declared: Collection[str]) -> dict[str, str]:
    """Return the flags of steps that are no `declared` variables, all by their names in lower case."""
    named = {step.name.casefold(): f"X{step.name}" for step in chart.steps}
    return {step: flag for step, flag in named.items() if flag.casefold() not in declared}


class _Notation:
    def __init__(self, flags: Mapping[str, str], own: Collection[str]) -> None:
        self._flags, self._own = flags, own

    def written(self, tree: n.Expression) -> str | None:
        """Return a condition in the notation; None where that has no words for it."""
        match tree:
            case n.Parenthesized(inner):
                return self.written(inner)
            case n.Unary(n.Operator.NOT, operand):
                return self._negated(operand)
            case n.Operation(operator, operands) if operator in _SIGNS:
                parts = [self._operand(each, operator) for each in operands]
                return None if None in parts else _SIGNS[operator].join(filter(None, parts))
            case n.Operation(operator, operands) if operator in n.COMPARISONS:
                return self._time(operator, operands) or f"[{print_node(tree)}]"
            case n.Member(n.Name(step), n.Name(quantity)) if quantity.casefold() == "x":
                return self._flags.get(step.casefold(), print_node(tree))
            case n.Name(name, n.Quoting.NONE):
                return _CONSTANTS.get(name.upper(), name) if is_operand(name) else None
            case n.Literal(text):
                return _CONSTANTS.get(text.upper())
            case n.Member() | n.Address():
                return print_node(tree)
        return None

    def _operand(self, tree: n.Expression, operator: n.Operator) -> str | None:
        text = self.written(tree)
        match n.bare(tree):
            case n.Operation(n.Operator.OR) if operator is n.Operator.AND and text is not None:
                return f"({text})"
        return text

    def _negated(self, operand: n.Expression) -> str | None:
        text = self.written(operand)
        bare = n.bare(operand)
        is_compared = isinstance(bare, n.Operation) and bare.operator in n.COMPARISONS  # in brackets, but for a time
        is_one = isinstance(bare, n.Name | n.Member) or (is_compared and (text or "").startswith("["))
        return None if text is None else f"/{text}" if is_one else f"/({text})"

    def _time(self, operator: n.Operator, operands: tuple[n.Expression, ...]) -> str | None:
        """Return ``3s/XFill`` for ``Fill.T >= T#3s`` while that step is active: in other ones its time stands still."""
        match (operator, operands):
            case (n.Operator.GREATER_OR_EQUAL, (n.Member(n.Name(step), n.Name(quantity)), n.Literal(time))):
                found = _ONE_UNIT.fullmatch(time)
                flag = self._flags.get(step.casefold())
                if quantity.casefold() == "t" and step.casefold() in self._own and found and flag:
                    return f"{found[1].lower()}/{flag}"
        return None
