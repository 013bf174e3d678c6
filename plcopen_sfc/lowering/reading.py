"""Reading a chart for lowering: what is not understood completely is refused here, nothing is guessed."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple, NoReturn

from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.networks import Helper, NetworkText, body_statements, chart_statements, condition_expression
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, parse_statements
from plcopen_sfc.lowering.logic import TRUE
from plcopen_sfc.lowering.source import ActionSource, ChartSource, StepCode, Use
from plcopen_sfc.model.actions import ActionAssociation, ActionKind, Qualifier
from plcopen_sfc.model.body import Body, FbdBody, LdBody, StBody
from plcopen_sfc.model.conditions import Condition
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.sfc import SfcNetwork, Step, Transition
from plcopen_sfc.semantics.net import Net, NetTransition, indexes
from plcopen_sfc.semantics.profile import Evolution, Profile


def read_chart(pou: Pou, chart: SfcNetwork, dialect: Dialect, profile: Profile) -> ChartSource:
    """Read a chart of `pou`. Raises `LoweringError` for what has no meaning that could be lowered."""
    return _Reader(pou, chart, dialect, profile).source()


class _Owner(NamedTuple):
    """A step or macro-step with associations: its model, what people call it, and its steps in the net."""

    step: Step
    chart: SfcNetwork
    path: str
    steps: tuple[int, ...]


class _Condition(NamedTuple):
    """A condition, and what must be executed before it is evaluated."""

    value: n.Expression
    preparation: tuple[n.Statement, ...]


class _Reader:
    def __init__(self, pou: Pou, chart: SfcNetwork, dialect: Dialect, profile: Profile) -> None:
        self._pou = pou
        self._chart = chart
        self._dialect = dialect
        self._profile = profile
        self._net = Net.of(chart)
        self._helpers: list[Helper] = []

    def source(self) -> ChartSource:
        """The chart."""
        if self._net.problems:
            self._refuse(f"the chart is broken: {self._net.problems[0].message}", self._net.problems[0].path)
        if self._profile.evolution is Evolution.UNTIL_STABLE:
            self._refuse("the search for stability is not lowered yet", "")
        if self._net.hierarchy or self._profile.graph_parameters:
            self._refuse("enclosing steps, forcing orders and S7-GRAPH are not lowered yet", "")
        if flags := self._flags():
            self._refuse(f"SFC flags are not lowered yet, and the chart uses {', '.join(flags)}", "")
        if self._chart.permanent_pre or self._chart.permanent_post:
            self._refuse("permanent operations are not lowered yet", "")
        logic: tuple[n.Statement, ...] = ()
        if self._chart.logic:
            drawn = chart_statements(self._chart, self._dialect, taken=self._taken())
            self._accept(drawn, "logic of the chart")
            logic = drawn.tree.statements
        conditions = [self._transition(transition) for transition in self._net.transitions]
        actions = tuple(self._actions())
        code = tuple(self._step_code())
        return ChartSource(
            self._pou,
            self._dialect,
            self._net,
            tuple(condition.value for condition in conditions),
            tuple(condition.preparation for condition in conditions),
            logic,
            tuple(self._helpers),
            actions,
            code,
            dict(self._minimum_times()),
        )

    def _refuse(self, message: str, path: str) -> NoReturn:
        place = f"{self._pou.name} / {path}" if path else self._pou.name
        raise LoweringError(message, location=Location(path=place))

    def _flags(self) -> list[str]:
        """The SFC flags of CODESYS that the chart uses: its settings say so, or the POU declares them."""
        declared = {v.name.casefold() for v in self._pou.interface.variables()} if self._pou.interface else set()
        settings = self._chart.settings
        uses = {flag for flag, use in settings.flags.items() if use.use} if settings is not None else set()
        uses |= {flag for flag in self._profile.flags if flag.variable.casefold() in declared}
        return sorted(flag.variable for flag in uses & self._profile.flags)

    def _taken(self) -> list[str]:
        return [helper.name for helper in self._helpers]

    def _accept(self, found: NetworkText, path: str) -> None:
        """Take over the variables that a drawing needs. Refuses what could not be read completely."""
        if not found.complete:
            why = next(problem.message for problem in found.problems)
            self._refuse(f"it cannot be read: {why}", path)
        self._helpers += found.helpers

    # -- conditions

    def _transition(self, transition: NetTransition) -> _Condition:
        return self._condition(transition.chart, transition.transition, f"transition {transition.path}")

    def _condition(self, chart: SfcNetwork, transition: Transition, path: str) -> _Condition:
        found = condition_expression(
            chart, transition, self._dialect, transitions=self._pou.transitions, taken=self._taken()
        )
        self._accept(found, path)
        if found.tree is None:
            self._refuse("the condition has no value", path)
        return _Condition(n.bare(found.tree), found.before)

    # -- actions

    def _owners(self) -> Iterator[_Owner]:
        for step in self._net.steps:
            yield _Owner(step.step, step.chart, step.path, (step.index,))
        for macro in self._net.macros:
            yield _Owner(macro.step, macro.chart, macro.path, tuple(indexes(macro.steps)))

    def _actions(self) -> Iterator[ActionSource]:
        """Associations with the same target are one action, every body in place is one of its own."""
        targets: dict[str, tuple[str, list[Use]]] = {}
        bodies: list[ActionSource] = []
        for owner in self._owners():
            for number, association in enumerate(owner.step.actions, 1):
                if association.exclude:
                    continue
                path = f"step {owner.path} / action {association.target or number}"
                use = self._use(owner, association, path)
                if association.target is not None:
                    targets.setdefault(association.target.casefold(), (association.target, []))[1].append(use)
                if association.body is not None:
                    statements = self._statements(association.body, path)
                    bodies.append(ActionSource(f"{owner.step.name}_{number}", None, statements, (use,)))
        for name, uses in targets.values():
            action = self._pou.action(name)
            if action is None:
                yield ActionSource(name, self._parsed(name, f"action {name}"), (), tuple(uses))
            else:
                yield ActionSource(name, None, self._statements(action.body, f"action {name}"), tuple(uses))
        yield from bodies

    def _use(self, owner: _Owner, association: ActionAssociation, path: str) -> Use:
        if association.event is not None or association.interlock or association.forcing is not None:
            self._refuse("events, interlocks and forcing orders are not lowered yet", path)
        if association.kind not in (None, ActionKind.CONTINUOUS, ActionKind.CONDITIONAL):
            self._refuse(f"actions of kind {association.kind} are not lowered yet", path)
        if association.value is not None:
            self._refuse("assignments as actions are not lowered yet", path)
        qualifier = Qualifier.N if association.qualifier is Qualifier.NONE else association.qualifier
        if qualifier not in self._profile.qualifiers:
            self._refuse(f"the profile {self._profile.name} does not say what {qualifier} does", path)
        duration = self._parsed(association.duration, path) if association.duration else None
        if qualifier.needs_duration and duration is None:
            self._refuse(f"{qualifier} needs a time", path)
        condition = self._guard(owner.chart, association.condition, path)
        return Use(owner.steps, owner.step.negated is not association.negated, qualifier, condition, duration)

    def _guard(self, chart: SfcNetwork, condition: Condition | None, path: str) -> n.Expression:
        if condition is None:
            return TRUE
        found = self._condition(chart, Transition(id=chart.new_id(), condition=condition), path)
        if found.preparation:
            self._refuse("conditions of actions with blocks that have a state are not lowered yet", path)
        return found.value

    # -- what steps execute

    def _step_code(self) -> Iterator[StepCode]:
        for step in self._net.steps:
            model = step.step
            if model.interlock is not None or model.supervision is not None:
                self._refuse("interlocks and supervisions are not lowered yet", f"step {step.path}")
            codes = [
                self._step_action(action, f"step {step.path}")
                for action in (model.entry_action, model.main_action, model.exit_action)
            ]
            if any(codes):
                yield StepCode(step.index, *codes)

    def _step_action(self, action: str | Body | None, path: str) -> tuple[n.Statement, ...]:
        if not isinstance(action, str):
            return self._statements(action, path)
        known = self._pou.action(action)
        if known is not None:
            return self._statements(known.body, f"action {action}")
        return self._read(f"{action}();", path)

    def _minimum_times(self) -> Iterator[tuple[int, n.Expression]]:
        if self._profile.minimum_times:
            for step in self._net.steps:
                if step.step.min_time:
                    yield step.index, self._parsed(step.step.min_time, f"step {step.path}")

    # -- texts

    def _parsed(self, text: str, path: str) -> n.Expression:
        parsed = parse_expression(text, self._dialect)
        if parsed.problems:
            self._refuse(f"{text!r}: {parsed.problems[0].message}", path)
        return n.bare(parsed.tree)

    def _read(self, text: str, path: str) -> tuple[n.Statement, ...]:
        parsed = parse_statements(text, self._dialect)
        if parsed.problems:
            self._refuse(f"{parsed.problems[0].message}", path)
        return parsed.tree.statements

    def _statements(self, body: Body | None, path: str) -> tuple[n.Statement, ...]:
        if body is None:
            return ()
        if isinstance(body, StBody):
            return self._read(body.text, path)
        if not isinstance(body, FbdBody | LdBody):
            self._refuse(f"actions in {body.language} are not lowered", path)
        found = body_statements(body, self._dialect, taken=self._taken())
        self._accept(found, path)
        return found.tree.statements
