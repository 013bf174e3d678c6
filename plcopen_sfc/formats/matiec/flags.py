"""Step flags as variables: the converters before matiec write actions before the steps that they name.

matiec knows ``Step.X`` behind the step only. A variable that the step drives with N has the same value: associations
come before the bodies of actions.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from plcopen_sfc.formats.matiec.unit import Unit
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, parse_statements, render, transform
from plcopen_sfc.model.actions import ActionAssociation, Qualifier
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.network import InputVariable
from plcopen_sfc.model.sfc import SfcNetwork, Step


class StepFlags:
    """Puts variables in the place of the flags of steps of a chart; what is added gets `ids`."""

    def __init__(self, unit: Unit, chart: SfcNetwork, ids: Iterator[int]) -> None:
        self._unit = unit
        self._chart = chart
        self._ids = ids
        self._steps = {step.name.casefold(): step for step in chart.steps}
        self._flags: dict[str, str] = {}

    def put(self) -> None:
        """Change actions, drawn logic and conditions; a condition keeps the flags of the steps that it leaves."""
        names = {step.id: step.name.casefold() for step in self._chart.steps}
        for action in self._unit.pou.actions:
            if isinstance(action.body, StBody):
                action.body.text = self._put(action.body.text, statements=True)
        for node in self._chart.logic:
            if isinstance(node, InputVariable):
                node.expression = self._put(node.expression)
        if self._unit.own:
            return  # of those transitions that have numbers, one resets the flag that the next one reads
        for transition in self._chart.transitions:
            if isinstance(transition.condition, Expression):
                left = [names[source] for source in transition.sources if source in names]
                transition.condition.text = self._put(transition.condition.text, keep=left)

    def _put(self, text: str, *, statements: bool = False, keep: Iterable[str] = ()) -> str:
        parsed = (parse_statements if statements else parse_expression)(text, self._unit.dialect)
        if parsed.problems:
            return text
        kept = frozenset(keep)

        def change(node: n.Node) -> n.Node:
            if not isinstance(node, n.Member) or not isinstance(node.base, n.Name):
                return node
            name = node.base.identifier.casefold()
            if name in kept or name not in self._steps or node.name.identifier.upper() != "X":
                return node
            return n.Name(self._flag(self._steps[name]))

        tree = transform(parsed.tree, change)
        return text if tree is parsed.tree else render(parsed, tree)

    def _flag(self, step: Step) -> str:
        name = self._flags.get(step.name.casefold())
        if name is None:
            name = self._flags[step.name.casefold()] = self._unit.declare(f"{step.name}_flag")
            step.actions.insert(0, ActionAssociation(id=next(self._ids), qualifier=Qualifier.N, target=name))
        return name
