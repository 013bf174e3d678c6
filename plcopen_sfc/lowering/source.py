"""A chart as a lowering sees it: its net, its conditions and its actions as syntax trees."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.networks import condition_expression
from plcopen_sfc.languages.networks.results import NetworkExpression
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, parse_statements, walk
from plcopen_sfc.lowering.logic import TRUE
from plcopen_sfc.model.actions import ActionAssociation, ActionKind, Qualifier
from plcopen_sfc.model.body import Body, FbdBody, LdBody, StBody
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.sfc import SfcNetwork, Step
from plcopen_sfc.semantics.net import Net, NetStep, NetTransition

Change: TypeAlias = Callable[[Any], Any]
"""Makes another node of the same kind of a node."""


@dataclass(frozen=True)
class Use:
    """One association of an action: step `step` (an index of the net) drives it by `qualifier`.

    `condition` is TRUE where there is none, `duration` None.
    """

    step: int
    qualifier: Qualifier
    condition: n.Expression
    duration: n.Expression | None


@dataclass(frozen=True)
class ActionSource:
    """An action: a Boolean variable (`target`), or code (`statements`), with all its uses in the order of the chart."""

    name: str
    target: n.Expression | None
    statements: tuple[n.Statement, ...]
    uses: tuple[Use, ...]


@dataclass(frozen=True)
class ChartSource:
    """What is lowered. `conditions` are those of `net.transitions`; what must run before one stands in `before`."""

    pou: Pou
    dialect: Dialect
    net: Net
    conditions: tuple[n.Expression, ...]
    before: tuple[n.Statement, ...]
    actions: tuple[ActionSource, ...]

    def changed(self, change: Change) -> ChartSource:
        """The same chart with `change` applied to every text but the targets of actions."""

        def used(use: Use) -> Use:
            duration = change(use.duration) if use.duration is not None else None
            return replace(use, condition=change(use.condition), duration=duration)

        actions = [
            replace(
                action,
                statements=tuple(change(statement) for statement in action.statements),
                uses=tuple(used(use) for use in action.uses),
            )
            for action in self.actions
        ]
        return replace(
            self,
            conditions=tuple(change(condition) for condition in self.conditions),
            before=tuple(change(statement) for statement in self.before),
            actions=tuple(actions),
        )

    @property
    def names(self) -> set[str]:
        """Every name that occurs in the POU or in its chart."""
        found = {variable.name for variable in self.pou.interface.variables()} if self.pou.interface else set()
        found |= {self.pou.name, *(action.name for action in self.pou.actions)}
        found |= {step.step.name for step in self.net.steps} | {t.transition.name for t in self.net.transitions}
        trees: list[n.Node] = [*self.conditions, *self.before]
        for action in self.actions:
            trees += [*action.statements, *([action.target] if action.target is not None else [])]
            trees += [use.condition for use in action.uses]
            trees += [use.duration for use in action.uses if use.duration is not None]
        return found | {node.identifier for tree in trees for node in walk(tree) if isinstance(node, n.Name)}


def read_chart(pou: Pou, chart: SfcNetwork, dialect: Dialect) -> ChartSource:
    """Read a chart of `pou`. Raises `LoweringError` for what has no meaning that could be lowered."""
    return _Reader(pou, chart, dialect).source()


class _Reader:
    def __init__(self, pou: Pou, chart: SfcNetwork, dialect: Dialect) -> None:
        self._pou = pou
        self._dialect = dialect
        self._net = Net.of(chart)
        self._before: list[n.Statement] = []

    def source(self) -> ChartSource:
        if self._net.problems:
            problem = self._net.problems[0]
            raise LoweringError(f"the chart is broken: {problem.message}", location=self._at(problem.path))
        if self._net.hierarchy:
            raise LoweringError("enclosing steps and forcing orders are not lowered yet", location=self._at(""))
        conditions = tuple(self._condition(transition) for transition in self._net.transitions)
        actions = tuple(self._actions())
        return ChartSource(self._pou, self._dialect, self._net, conditions, tuple(self._before), actions)

    def _at(self, path: str) -> Location:
        return Location(path=f"{self._pou.name} / {path}" if path else self._pou.name)

    def _condition(self, transition: NetTransition) -> n.Expression:
        found = condition_expression(
            transition.chart, transition.transition, self._dialect, transitions=self._pou.transitions
        )
        return self._expression(found, f"transition {transition.path}")

    def _expression(self, found: NetworkExpression, path: str) -> n.Expression:
        if not found.complete or found.tree is None:
            why = next((problem.message for problem in found.problems), "it has no value")
            raise LoweringError(f"the condition cannot be read: {why}", location=self._at(path))
        if found.helpers:
            raise LoweringError("a condition with blocks that have a state is not lowered yet", location=self._at(path))
        self._before += found.before
        return n.bare(found.tree)

    def _actions(self) -> Iterator[ActionSource]:
        found: dict[str, tuple[NetStep, ActionAssociation, list[Use]]] = {}
        for step in self._net.steps:
            self._refuse_step(step.step, step.path)
            for association in step.step.actions:
                if association.exclude:
                    continue
                path = f"step {step.path} / action {association.target or association.id}"
                self._refuse(association, path)
                key = association.target.casefold() if association.target else f"#{id(association)}"
                _, _, uses = found.setdefault(key, (step, association, []))
                uses.append(self._use(step, association, path))
        for step, association, uses in found.values():
            yield self._action(step, association, tuple(uses))

    def _refuse_step(self, step: Step, path: str) -> None:
        wanting = {
            "an entry action": step.entry_action,
            "an exit action": step.exit_action,
            "a step action": step.main_action,
            "an interlock": step.interlock,
            "a supervision": step.supervision,
            "a minimum time": step.min_time,
        }
        for what, value in wanting.items():
            if value is not None:
                raise LoweringError(f"{what} is not lowered yet", location=self._at(f"step {path}"))

    def _refuse(self, association: ActionAssociation, path: str) -> None:
        if association.event is not None or association.interlock or association.forcing is not None:
            raise LoweringError("events, interlocks and forcing orders are not lowered yet", location=self._at(path))
        if association.kind not in (None, ActionKind.CONTINUOUS, ActionKind.CONDITIONAL):
            raise LoweringError(f"actions of kind {association.kind} are not lowered yet", location=self._at(path))
        if association.negated or association.value is not None or association.indicator is not None:
            raise LoweringError("negations, values and indicators are not lowered yet", location=self._at(path))

    def _use(self, step: NetStep, association: ActionAssociation, path: str) -> Use:
        condition: n.Expression = TRUE
        if association.condition is not None:
            probe = step.chart.transitions[0].model_copy(update={"condition": association.condition})
            found = condition_expression(step.chart, probe, self._dialect, transitions=self._pou.transitions)
            condition = self._expression(found, path)
        duration = self._parsed(association.duration, path) if association.duration else None
        qualifier = Qualifier.N if association.qualifier is Qualifier.NONE else association.qualifier
        if qualifier.needs_duration and duration is None:
            raise LoweringError(f"{qualifier} needs a time", location=self._at(path))
        return Use(step.index, qualifier, condition, duration)

    def _parsed(self, text: str, path: str) -> n.Expression:
        parsed = parse_expression(text, self._dialect)
        if parsed.problems:
            raise LoweringError(f"{text!r}: {parsed.problems[0].message}", location=self._at(path))
        return n.bare(parsed.tree)

    def _action(self, step: NetStep, association: ActionAssociation, uses: tuple[Use, ...]) -> ActionSource:
        path = f"step {step.path} / action {association.target or association.id}"
        name = association.target or f"{step.step.name}_{step.step.actions.index(association) + 1}"
        body = association.body
        if association.target is not None and (action := self._pou.action(association.target)) is not None:
            body = action.body
        elif association.target is not None and body is None:
            return ActionSource(name, self._parsed(association.target, path), (), uses)
        return ActionSource(name, None, self._statements(body, path), uses)

    def _statements(self, body: Body | None, path: str) -> tuple[n.Statement, ...]:
        if body is None:
            return ()
        if isinstance(body, StBody):
            parsed = parse_statements(body.text, self._dialect)
            if parsed.problems:
                raise LoweringError(parsed.problems[0].message, location=self._at(path))
            return parsed.tree.statements
        what = "FBD and LD" if isinstance(body, FbdBody | LdBody) else body.language
        raise LoweringError(f"actions in {what} are not lowered yet", location=self._at(path))
