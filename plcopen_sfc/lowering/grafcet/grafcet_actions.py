"""Actions of a GRAFCET as code: stored ones in the evolution of their event, all others behind the evolutions.

And what charts above impose on others, by forcing orders and enclosing steps.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from typing import NamedTuple

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import walk
from plcopen_sfc.languages.st.nodes import Expression, Node, Statement
from plcopen_sfc.lowering.actions.action_control import ActionControlCode
from plcopen_sfc.lowering.code.boolean_logic import (
    FALSE,
    TRUE,
    assignment,
    conjunction,
    disjunction,
    is_constant,
    names_in,
    negation,
    simplified,
)
from plcopen_sfc.lowering.code.code_memory import Memory
from plcopen_sfc.lowering.code.lowered_code import LoweredCode, StepValue
from plcopen_sfc.lowering.encodings.step_flags import Imposed
from plcopen_sfc.lowering.reading.chart_source import ActionSource, ActionUse, ChartSource, GrafcetSource, StoredAction
from plcopen_sfc.lowering.reading.step_variables import StepTimers
from plcopen_sfc.model.actions import ActionKind, Qualifier
from plcopen_sfc.model.types import DerivedType
from plcopen_sfc.semantics.charts.grafcet.partial_charts import RuledChart
from plcopen_sfc.semantics.net import indexes


class StepViews(NamedTuple):
    """Views of a step: it is `active`, and it was so `before` the present evolution.

    `fresh`: the evolution before this one has activated it.
    """

    active: StepValue
    before: StepValue
    fresh: StepValue


class StoredActionEvent(NamedTuple):
    """Condition that an event happens, and the action that it executes."""

    happens: Expression
    action: StoredAction

    def named(self, memory: Memory, wanted: str, into: list[Statement]) -> StoredActionEvent:
        """Return the same with a variable for the condition."""
        return StoredActionEvent(memory.named(wanted, self.happens, into), self.action)


class StoredActions:
    """Code of the stored actions (IEC 60848:2013, 4.8), each executed in the evolution of its event.

    `bits`: names of BOOL variables, in lower case, that are assigned by logic and not under a condition.
    """

    def __init__(
        self, actions: Sequence[StoredAction], memory: Memory, sights: StepViews, bits: Collection[str] = ()
    ) -> None:
        self._actions, self._memory, self._bits = actions, memory, bits
        self._active, self._before, self._fresh = sights

    def events(self) -> list[StoredActionEvent]:
        """Return the events of active steps, but for the activation itself, and the actions that they execute."""
        found: list[StoredActionEvent] = []
        for action in self._actions:
            if action.event is not None:
                # an edge in the evolution that activates the step does not count: the action begins to listen behind it
                ready = [conjunction([self._active(i), negation(self._fresh(i))]) for i in action.steps]
                found.append(StoredActionEvent(conjunction([disjunction(ready), action.event]), action))
        return found

    def on_events(self, events: Iterable[StoredActionEvent]) -> list[Statement]:
        """Return the statements that events execute."""
        return [statement for event in events for statement in self._executed(*event)]

    def on_changes(self) -> list[Statement]:
        """Return the statements of deactivations, then those of activations."""
        found: list[Statement] = []
        for kind, was, is_ in (
            (ActionKind.ON_DEACTIVATION, self._before, self._active),
            (ActionKind.ON_ACTIVATION, self._active, self._before),
        ):
            for action in self._actions:
                if action.kind is kind:
                    # a macro-step is activated with its first step and deactivated with its last one
                    one = disjunction(was(i) for i in action.steps)
                    none = [negation(is_(i)) for i in action.steps]
                    found += self._executed(conjunction([one, *none]), action)
        return found

    def ended(self, restart: Expression, initial: Iterable[int], booleans: Collection[str]) -> list[Statement]:
        """Return the statements that set the stored Boolean variables back: to FALSE, or to what `initial` steps store.

        `booleans` are names of variables in lower case; others are known by their values.
        """
        started = set(initial)
        values: dict[Expression, Expression] = {}
        for action in self._actions:
            starts = action.kind is ActionKind.ON_ACTIVATION and started.intersection(action.steps)
            for statement in action.statements:
                if not isinstance(statement, n.Assignment):
                    continue
                target, sets = statement.target, is_constant(statement.value, TRUE)
                named = isinstance(target, n.Name) and target.identifier.casefold() in booleans
                if named or sets or is_constant(statement.value, FALSE):
                    values.setdefault(target, FALSE)
                    values[target] = TRUE if starts and sets else values[target]
        done = [assignment(target, value) for target, value in values.items()]
        return self._memory.conditional("", restart, done)

    def at_the_start(self, initial: Iterable[int], starting: Expression) -> list[Statement]:
        """Return the statements of the activation of the initial steps, in the scan that is `starting`."""
        started = set(initial)
        found: list[Statement] = []
        for action in self._actions:
            if action.kind is ActionKind.ON_ACTIVATION and started.intersection(action.steps):
                found += self._executed(starting, action)
        return found

    def _executed(self, condition: Expression, action: StoredAction) -> list[Statement]:
        if len(action.statements) == 1 and isinstance(single := action.statements[0], n.Assignment):
            value = simplified(single.value)
            is_bit = isinstance(single.target, n.Name) and single.target.identifier.casefold() in self._bits
            # networks have no conditional assignment of a BOOL: it is plain logic there
            if is_bit and not is_constant(value, TRUE) and not is_constant(value, FALSE):
                return [written_if(condition, single.target, value)]
        return self._memory.conditional("event", condition, action.statements)


def written_if(condition: Expression, target: Expression, value: Expression) -> Statement:
    """Return the assignment of a BOOL variable under a condition, as plain logic."""
    kept = conjunction([target, negation(condition)])
    return assignment(target, disjunction([conjunction([condition, value]), kept]))


_PASSING = frozenset({Qualifier.S, Qualifier.R, Qualifier.R0, Qualifier.SD, Qualifier.SL})
_PULSES = frozenset({Qualifier.P, Qualifier.P1, Qualifier.P0})


def passed_steps(actions: Sequence[ActionSource]) -> set[int]:
    """Return the steps whose passing within a scan matters: also where blocks in conditions look at them."""
    uses = (use for action in actions for use in action.uses)
    return {i for use in uses if use.qualifier in _PASSING | _PULSES or use.preparation for i in use.steps}


class PassingActionCode(ActionControlCode):
    """Action control of IEC 61131-3. `seen`: a step was active in any evolution of the scan."""

    def __init__(self, memory: Memory, active: StepValue, seen: StepValue, ending: Expression = FALSE) -> None:
        super().__init__(memory, active, ending)
        self._code, self._stable, self._seen = memory.code, active, seen

    def _input(self, action: ActionSource, *qualifiers: Qualifier) -> Expression:
        return self._asked(self._seen if _PASSING.issuperset(qualifiers) else self._stable, action, *qualifiers)

    def _asked(self, active: StepValue, action: ActionSource, *qualifiers: Qualifier) -> Expression:
        self._active = active
        return super()._input(action, *qualifiers)

    def _edge(self, qualifier: Qualifier, action: ActionSource, value: Expression, into: list[Statement]) -> Expression:
        """Return a pulse when a step becomes active or no longer is, also if it is so in between only."""
        passed = self._asked(self._seen, action, qualifier)
        pulse = self._code.declare(f"{action.name}_{qualifier}")
        before = self._code.declare(self._code.texts.with_suffix(pulse.identifier, "old"))
        # `passed` is TRUE where the step was active in between, though two scans never show it
        falling = conjunction([disjunction([before, passed]), negation(value)])
        rising = conjunction([passed, negation(before)])
        into += [assignment(pulse, falling if qualifier is Qualifier.P0 else rising), assignment(before, value)]
        return pulse


class ContinuousActionCode(ActionControlCode):
    """Control in which each association acts on its own, with the time of its step (IEC 60848:2013, 4.8.4).

    `timers`: those of macro-steps in `code`, with the condition and the time of each. Like those of steps (`times`)
    they are to be called behind the evolutions.
    """

    def __init__(
        self, actions: Sequence[ActionSource], code: LoweredCode, memory: Memory, active: StepValue, times: StepTimers
    ) -> None:
        super().__init__(memory, active)
        self._code, self._times = code, times
        self.timers: list[tuple[n.Name, Expression, Expression]] = []
        self._driven = {a.name: disjunction(self._of_step(use, a) for use in a.uses) for a in actions}

    def drive(self, action: ActionSource, into: list[Statement]) -> Expression:  # noqa: ARG002
        """Return an expression that is TRUE if any association wants it."""
        return self._driven[action.name]

    def outputs(self, action: ActionSource, into: list[Statement]) -> tuple[Expression, Expression]:  # noqa: ARG002
        """Return the same; there are no pulses."""
        return self._driven[action.name], FALSE

    def _of_step(self, use: ActionUse, action: ActionSource) -> Expression:
        terms = [self._of(use)]
        if use.duration is not None:
            over = self._is_over(use, use.duration, action)
            terms.append(over if use.qualifier is Qualifier.D else negation(over))
        return conjunction(terms)

    def _is_over(self, use: ActionUse, duration: Expression, action: ActionSource) -> Expression:
        """Return when the step, or any step of the macro-step, has been active for the time."""
        if len(use.steps) == 1:
            if isinstance(duration, n.Literal):
                return self._times.is_over(use.steps[0], duration)
            return n.Operation(n.Operator.GREATER_OR_EQUAL, (self._times.elapsed(use.steps[0]), duration))
        timer = self._code.declare(f"{action.name}_{use.qualifier}", DerivedType(name="TON"))
        self.timers.append((timer, disjunction(self._active(step) for step in use.steps), duration))
        return n.Member(timer, n.Name("Q"))


class ForcingCode:
    """Code of the forcing orders and enclosing steps (IEC 60848:2013, 7.1 and 7.3) that act on one chart.

    `active`: a step is active, `before`: it was so before the evolution.
    """

    def __init__(self, chart: RuledChart, active: StepValue, before: StepValue) -> None:
        self._chart = chart
        self._active, self._before = active, before
        self.steps = tuple(indexes(chart.steps))

    def forced(self) -> Expression:
        """Return an expression that is TRUE if an order holds the chart."""
        return disjunction(self._active(i) for order in self._chart.orders for i in indexes(order.steps))

    def situations(self) -> Iterator[Imposed]:
        """Yield the situations imposed on the chart with their conditions; the first that is TRUE counts."""
        for order in self._chart.orders:
            acting = disjunction(self._active(i) for i in indexes(order.steps))
            if order.imposed is None:
                yield Imposed(acting, dict.fromkeys(self.steps))
            else:
                yield Imposed(acting, {i: TRUE if order.imposed >> i & 1 else FALSE for i in self.steps})
        if self._chart.enclosures:
            yield from self._enclosed()

    def _enclosed(self) -> Iterator[Imposed]:
        opened = [
            (
                enclosing.links,
                conjunction([self._active(i), negation(self._before(i))]),
            )
            for enclosing in self._chart.enclosures
            for i in indexes(enclosing.steps)
        ]
        # several enclosing steps may become active in one evolution: the chart starts in the steps of all of them
        links = {i: disjunction(when for bits, when in opened if bits >> i & 1) for i in self.steps}
        # the condition of the branch is the same: the values are constants
        if len(opened) == 1:
            links = {i: FALSE if value == FALSE else TRUE for i, value in links.items()}
        yield Imposed(disjunction(when for _, when in opened), links)
        enclosing = [i for each in self._chart.enclosures for i in indexes(each.steps)]
        yield Imposed(conjunction(negation(self._active(i)) for i in enclosing), dict.fromkeys(self.steps, FALSE))


def events_asked_early(source: ChartSource, grafcet: GrafcetSource, active: StepValue) -> str:
    """Return why actions on events cannot be executed behind the transitions of their evolution; empty if they can."""
    events = [stored for stored in grafcet.stored if stored.event is not None]
    used = _used(events)
    asked = next((name for name in _identifiers(_conditions(source)) if name.casefold() in used), None)
    if asked is not None:
        return f"conditions of transitions ask for {asked}"
    states = _identifiers(active(step) for step in range(len(source.net.steps)))
    asked = next((name for name in states if name.casefold() in used), None)
    return f"they ask for steps, by {asked}" if asked is not None else ""


def asked_in_between(source: ChartSource, grafcet: GrafcetSource, initial: int) -> bool:
    """Return True if code between an evolution and the outputs reads what stored actions write.

    That is also so where code before the first evolution reads what the `initial` steps store.
    """
    started = set(indexes(initial))
    at_start = [s for s in grafcet.stored if s.kind is ActionKind.ON_ACTIVATION and started.intersection(s.steps)]
    operands = [delay.operand for delay in grafcet.delays]
    edges = [edge.operand for edge in grafcet.edges]
    early = [*_conditions(source), *operands, *edges, *(s.event for s in grafcet.stored if s.event is not None)]
    times = [time for delay in grafcet.delays for time in (delay.first, delay.last) if time is not None]
    actions = (*source.actions, *grafcet.continuous)
    times += [use.duration for action in actions for use in action.uses if use.duration is not None]
    between = set(names_in(*times, *operands))
    return bool(source.step_code or _used(at_start).intersection(names_in(*early)) or between & _used(grafcet.stored))


def _identifiers(trees: Iterable[Node]) -> Iterator[str]:
    return (node.identifier for tree in trees for node in walk(tree) if isinstance(node, n.Name))


def _conditions(source: ChartSource) -> list[Node]:
    before = [statement for statements in source.preparations for statement in statements]
    return [*source.conditions, *before]


def _used(actions: Iterable[StoredAction]) -> set[str]:
    return set(names_in(*(statement for action in actions for statement in action.statements)))
