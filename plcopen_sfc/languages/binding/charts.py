"""Texts of a chart: conditions, targets and values of actions, drawn logic, and the bodies in it."""

from __future__ import annotations

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.networks import Helper, chart_statements, condition_reader
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression
from plcopen_sfc.languages.st.effects import Effects, calls, path_of
from plcopen_sfc.model.body import Body, SfcBody
from plcopen_sfc.model.sfc import SfcNetwork


class ChartTexts:
    """The texts of one chart, without those of the charts in it.

    `trees` are its expressions and statements in no order, `bodies` the actions that are programmed in place.
    `acting` is what naming something as an action does: it is written, or called.
    """

    def __init__(self, chart: SfcNetwork, dialect: Dialect) -> None:
        self.chart = chart
        self._dialect = dialect
        self.trees: list[n.Expression | n.Statement] = []
        self.bodies: list[Body] = []
        self.unknown: list[str] = []
        self.helpers: list[Helper] = []
        self.acting = Effects()
        logic = chart_statements(chart, dialect)
        self.trees += logic.tree.statements
        self.unknown += [problem.message for problem in logic.obstacles]
        self.helpers += logic.helpers
        self._conditions(chart)
        self._actions(chart)

    def _conditions(self, chart: SfcNetwork) -> None:
        read = condition_reader(chart, self._dialect)
        supervised = [each for step in chart.steps for each in (step.interlock, step.supervision) if each is not None]
        conditions = [each.condition for each in chart.transitions]
        conditions += [each.condition for _, each in chart.associations()] + [each.condition for each in supervised]
        for condition in conditions:
            if condition is not None:
                found = read(condition)
                self.trees += found.before if found.tree is None else (*found.before, found.tree)
                self.unknown += [problem.message for problem in found.obstacles]
                self.helpers += found.helpers

    def _actions(self, chart: SfcNetwork) -> None:
        for step in chart.steps:
            for action in (step.entry_action, step.main_action, step.exit_action):
                self._action(action)
            self._values(step.min_time, step.max_time, step.warning_time)
            if step.macro is not None and step.macro.body is not None and not isinstance(step.macro.body, SfcBody):
                self.bodies.append(step.macro.body)
        for _, association in chart.associations():
            self._action(association.target)
            self._action(association.body)
            self._values(association.value, association.duration)
            self._action(association.indicator)
        for operation in (*chart.permanent_pre, *chart.permanent_post):
            self._action(operation.body)

    def _action(self, action: str | Body | None) -> None:
        if isinstance(action, str) and action:
            tree = parse_expression(action, self._dialect).tree
            self.trees.append(tree)
            acting = Effects(writes=frozenset({path_of(tree)}), calls=calls(n.CallStatement(tree)))
            self.acting = Effects.all([self.acting, acting])
        elif action is not None and not isinstance(action, str):
            self.bodies.append(action)

    def _values(self, *texts: str | None) -> None:
        self.trees += [parse_expression(text, self._dialect).tree for text in texts if text]
