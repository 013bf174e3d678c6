"""Control of actions: the expression that tells when an action is executed.

`ActionControlCode` is the action control of IEC 61131-3 (6.7.4.6): one block of an action gets all its associations.
`SequentialControlCode` lets the associations act one after the other, as the code of matiec does.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple, TypeAlias

from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.literals import literal_value
from plcopen_sfc.languages.st.nodes import Expression, Operator, Statement
from plcopen_sfc.lowering.code.boolean_logic import (
    FALSE,
    TRUE,
    absorbed,
    assignment,
    call,
    conjunction,
    disjunction,
    is_constant,
    negation,
)
from plcopen_sfc.lowering.code.code_memory import Memory
from plcopen_sfc.lowering.code.lowered_code import TIME, StepValue
from plcopen_sfc.lowering.reading.chart_source import ActionSource, ActionUse, ChartSource
from plcopen_sfc.lowering.reading.step_variables import StepTimers
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.chart_settings import SfcFlag
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.types import DerivedType
from plcopen_sfc.semantics.net import Net

Q = Qualifier
_PART = n.Name("part")
_STORED = {Q.S, Q.SD, Q.DS, Q.SL}
EarlierSteps: TypeAlias = "Callable[[Sequence[int]], Expression | None]"
"""Expression for when one of some steps was active in the last scan; None where the code does not keep that."""


def unknown_before(steps: Sequence[int]) -> None:
    """Return None: the code does not keep the situation of the last scan."""


TimeOver: TypeAlias = "Callable[[int, Expression], n.Operation | None]"
"""Comparison that is TRUE if a step has been active for a time; None where only a timer of the action can tell."""


def unmeasured(step: int, time: Expression) -> None:
    """Return None: the code does not measure times of steps for actions."""


class ActionControlCode:
    """Action control of one action after the other. `active` gives the flag of a step by its index in the net.

    `ending`: a condition that ends stored actions besides R. `is_over`: when a step has been active for a time, if the
    code measures that anyway.
    """

    def __init__(
        self,
        memory: Memory,
        active: StepValue,
        ending: Expression = FALSE,
        was_active: EarlierSteps = unknown_before,
        is_over: TimeOver = unmeasured,
    ) -> None:
        self.memory = memory
        self._active = active
        self._time_is_over = is_over
        self._ending = ending
        self._was_active = was_active

    def plain(self, action: ActionSource) -> tuple[Expression, Expression] | None:
        """Return when an action is executed that its steps alone decide on, and when it was in the last scan.

        None for all others, and where the code does not keep the situation of the last scan: they need a memory.
        """
        return self._steps_alone(action.uses)

    def _steps_alone(
        self, uses: Sequence[ActionUse], qualifier: Qualifier = Q.N
    ) -> tuple[Expression, Expression] | None:
        if not uses or not all(
            use.qualifier is qualifier and not use.inverted and is_constant(use.condition, TRUE) for use in uses
        ):
            return None
        steps = list(dict.fromkeys(step for use in uses for step in use.steps))
        before = self._was_active(steps)
        return (disjunction(map(self._active, steps)), before) if before is not None else None

    def drive(self, action: ActionSource, into: list[Statement]) -> Expression:
        """Return the output Q of the action control, with its pulses P1 and P0: TRUE while the action is active."""
        reset = self._input(action, Q.R, Q.R0)
        terms = [*self._lasting(action, reset, into), *self._single(action, into)]
        return self._unless(reset, terms, action)

    def set_and_reset(self, action: ActionSource) -> tuple[Expression, Expression] | None:
        """Return the set and reset conditions of an action that is only stored; None for all others."""
        if not {Q.S} <= {use.qualifier for use in action.uses} <= {Q.S, Q.R, Q.R0}:
            return None
        return self._input(action, Q.S), disjunction([self._input(action, Q.R, Q.R0), self._ending])

    def never_ends(self, action: ActionSource) -> bool:
        """True if an action that was executed once is executed in all later scans: code behind it would be dead."""
        lasting = {use.qualifier for use in action.uses}
        return bool(lasting) and lasting <= {Q.S, Q.SD, Q.DS} and is_constant(self._ending, FALSE)

    def outputs(self, action: ActionSource, into: list[Statement]) -> tuple[Expression, Expression]:
        """Return Q in two parts: one that lasts, after whose end an action is executed once more, and P1 and P0."""
        reset = self._input(action, Q.R, Q.R0)
        lasting = self._unless(reset, self._lasting(action, reset, into), action)
        single = conjunction([disjunction(self._single(action, into)), negation(reset)])
        return lasting, single

    def _unless(self, reset: Expression, terms: list[Expression], action: ActionSource) -> Expression:
        """Return any of the terms, without reset: flip-flops and all that depends on them have had it already."""
        # reset dominates in each flip-flop already; a second NOT R would only make the text longer
        if {use.qualifier for use in action.uses} <= _STORED | {Q.R, Q.R0}:
            return absorbed(disjunction(terms))
        return conjunction([absorbed(disjunction(terms)), negation(reset)])

    def _lasting(self, action: ActionSource, reset: Expression, into: list[Statement]) -> list[Expression]:
        # `ending` acts on what is stored only: a restart makes all other steps inactive anyway
        reset = disjunction([reset, self._ending])
        found = [self._input(action, Q.N)]
        for qualifier in (Q.S, Q.L, Q.D, Q.P, Q.SD, Q.DS, Q.SL):
            value = self._input(action, qualifier)
            part = conjunction([value, _PART])
            if qualifier in (Q.L, Q.D, Q.P) and absorbed(disjunction([found[0], part])) == found[0]:
                continue  # it is a part of the time in which N executes the action
            if not is_constant(value, FALSE):
                found.append(self._term(qualifier, action, value, reset, into))
        return found

    def _term(
        self, qualifier: Qualifier, action: ActionSource, value: Expression, reset: Expression, into: list[Statement]
    ) -> Expression:
        """Return when an action is active by its associations with a qualifier, whose steps are active by `value`."""
        memory, name = self.memory, f"{action.name}_{qualifier}"
        if qualifier is Q.P:
            return self._edge(qualifier, action, value, into)
        times = [use.duration for use in action.uses if use.qualifier is qualifier and use.duration is not None]
        if qualifier in (Q.L, Q.SL) and all(is_constant(_is_positive(time), FALSE) for time in times):
            return FALSE  # its time is over at once
        if qualifier in (Q.S, Q.SD, Q.SL):
            value = memory.latch(name, value, reset, into)
        if qualifier is Q.S:
            return value
        if (over := self._late(action, qualifier)) is not None:
            return conjunction([value, over if qualifier is Q.D else n.Operation(Operator.LESS, over.operands)])
        timer = name if qualifier in (Q.L, Q.D) else f"{name}_T"
        late = memory.delayed(timer, value, self._time(action, qualifier, into), into)
        if qualifier is Q.DS:
            return memory.latch(name, late, reset, into)
        return late if qualifier in (Q.D, Q.SD) else conjunction([value, negation(late)])

    def _single(self, action: ActionSource, into: list[Statement]) -> list[Expression]:
        values = ((qualifier, self._input(action, qualifier)) for qualifier in (Q.P1, Q.P0))
        return [self._edge(q, action, value, into) for q, value in values if not is_constant(value, FALSE)]

    def _edge(self, qualifier: Qualifier, action: ActionSource, value: Expression, into: list[Statement]) -> Expression:
        """Return a pulse when the first of the steps becomes active; with P0 when the last one no longer is."""
        alone = self._steps_alone([use for use in action.uses if use.qualifier is qualifier], qualifier)
        if alone is None:
            edge = self.memory.falling if qualifier is Q.P0 else self.memory.rising
            return edge(f"{action.name}_{qualifier}", value, into)
        now, before = alone
        return conjunction([negation(now), before] if qualifier is Q.P0 else [now, negation(before)])

    def _input(self, action: ActionSource, *qualifiers: Qualifier) -> Expression:
        """Return the input of the action control for these qualifiers: the steps with such associations."""
        return disjunction(self._of(use) for use in action.uses if use.qualifier in qualifiers)

    def _of(self, use: ActionUse) -> Expression:
        active = disjunction(self._active(step) for step in use.steps)
        return absorbed(conjunction([negation(active) if use.inverted else active, use.condition]))

    def _late(self, action: ActionSource, qualifier: Qualifier) -> n.Operation | None:
        """Return when the time of a step that decides alone is over; None where a timer of the action tells that."""
        found = _alone(action, qualifier) if qualifier in (Q.D, Q.L) else None
        return self._time_is_over(*found) if found is not None else None

    def _time(self, action: ActionSource, qualifier: Qualifier, into: list[Statement]) -> Expression:
        """Return the time of the first use that is on. Where it can change it is kept in a variable."""
        uses = [use for use in action.uses if use.qualifier is qualifier and use.duration is not None]
        times = [use.duration for use in uses if use.duration is not None]
        kept = qualifier in (Q.SD, Q.SL) and not isinstance(times[0], n.Literal)  # their timers go on without the step
        if all(time == times[0] for time in times) and not kept:
            return times[0]
        chosen = self.memory.code.declare(
            self.memory.code.texts.with_suffix(f"{action.name}_{qualifier}", "time"), TIME
        )
        # the last assignment wins: in reverse order that is the time of the first active association
        for use, time in reversed(list(zip(uses, times, strict=True))):
            into += self.memory.conditional("", self._of(use), [assignment(chosen, time)])
        return chosen


def _alone(action: ActionSource, qualifier: Qualifier) -> tuple[int, n.Literal] | None:
    """Return the step and time of the only D or L of an action, if nothing but the step decides on it."""
    uses = [use for use in action.uses if use.qualifier is qualifier]
    if len(uses) != 1 or uses[0].inverted or len(uses[0].steps) != 1 or not is_constant(uses[0].condition, TRUE):
        return None
    time = uses[0].duration
    return (uses[0].steps[0], time) if isinstance(time, n.Literal) else None


def timed_alone(source: ChartSource) -> set[int]:
    """Return the steps that decide alone on a D or L, as the time of the step is that of the action."""
    # SFCQuitError sets back the times of steps only, a transition from a step to itself too
    if SfcFlag.QUIT_ERROR in source.flags:
        return set()
    found = [_alone(action, qualifier) for action in source.actions for qualifier in (Q.D, Q.L)]
    again = {step for each in source.net.transitions for step in set(each.sources) & set(each.targets)}
    return {step for each in found if each is not None and (step := each[0]) not in again}


class Decision(NamedTuple):
    """Conditions under which a value becomes TRUE and FALSE: never both; in other scans it stays."""

    on: Expression
    off: Expression

    def then(self, later: Decision) -> Decision:
        """Return this decision, unless a later one is made."""
        on = disjunction([later.on, conjunction([self.on, negation(later.off)])])
        off = disjunction([later.off, conjunction([self.off, negation(later.on)])])
        return Decision(on, off)


_UNDECIDED = Decision(FALSE, FALSE)


def stepwise_timed(source: ChartSource) -> list[int]:
    """Return the steps whose times this control asks for."""
    timed = [use for action in source.actions for use in action.uses if use.qualifier in (Q.D, Q.L)]
    return sorted({step for use in timed for step in use.steps})


class SequentialControlCode:
    """Control of one action after the other. `active` gives the flag of a step by its index in the net.

    `ending`: a condition that ends stored actions besides R. `entered`: the start is an activation of the initial
    steps. `reentered`: the steps whose time can begin again while they are active. Raises `LoweringError` for times
    that cannot be measured so.
    """

    def __init__(
        self,
        net: Net,
        memory: Memory,
        times: StepTimers,
        *,
        active: StepValue,
        ending: Expression,
        entered: bool,
        reentered: frozenset[int],
        was_active: EarlierSteps,
    ) -> None:
        self._was_active, self._reentered = was_active, reentered
        self._net, self._code, self.memory, self._active = net, memory.code, memory, active
        self._times, self._ending, self._entered = times, ending, entered
        self._before: dict[tuple[int, ...], n.Name] = {}

    def outputs(self, action: ActionSource, into: list[Statement]) -> tuple[Expression, Expression]:
        """Return when an action with a body is executed; the second part, pulses of other controls, is FALSE."""
        decided = self._decided(action)
        set_, reset = self._set_and_reset(action, into)
        if is_constant(set_, FALSE):
            return decided.on, FALSE
        stored = self.memory.latch(f"{action.name}_S", set_, reset, into)
        return disjunction([decided.on, stored]), FALSE

    def decision(self, action: ActionSource, into: list[Statement]) -> Decision:
        """Return when a Boolean variable is written."""
        set_, reset = self._set_and_reset(action, into)
        return self._decided(action).then(Decision(conjunction([set_, negation(reset)]), reset))

    def remember(self) -> list[Statement]:
        """Return the statements behind all that this control made: the flags of steps for the next scan."""
        return [assignment(before, self._is_active(steps)) for steps, before in self._before.items()]

    def never_ends(self, _: ActionSource) -> bool:
        """True if nothing ends an action: that is not known."""
        return False

    def never_holds(self, action: ActionSource) -> bool:
        """Return True if a variable is FALSE in every scan in which nothing decides on it, if nothing else writes it.

        A D whose time changes, or begins again, can decide on TRUE, and not at all in the next scan.
        """
        delayed = [use for use in action.uses if use.qualifier is Q.D]
        lasting = all(isinstance(use.duration, n.Literal) and self._reentered.isdisjoint(use.steps) for use in delayed)
        return lasting and not any(use.qualifier in _STORED for use in action.uses)

    # -- what associations decide

    def _decided(self, action: ActionSource) -> Decision:
        """Return the joint decision of the associations without memory."""
        found = _UNDECIDED
        for use in action.uses:
            found = found.then(self._decides(action, use))
        return found

    def _decides(self, action: ActionSource, use: ActionUse) -> Decision:
        qualifier = use.qualifier
        if qualifier in (Q.P, Q.P1):
            begins = self._begins(use)
            return Decision(begins, negation(begins))
        if qualifier is Q.P0:
            ends = self._ends(use)
            return Decision(ends, negation(ends))
        if qualifier not in (Q.N, Q.L, Q.D):
            return _UNDECIDED
        # the code of matiec writes TRUE while a step acts and FALSE when it ends, association after association; in
        # other scans it writes nothing
        active = conjunction([self._acts(use), use.condition])
        off = [self._ends(use), conjunction([self._acts(use), negation(use.condition)])]
        if qualifier is Q.N:
            return Decision(active, disjunction(off))
        late = self._is_late(action, use)
        if qualifier is Q.D:
            return Decision(conjunction([active, late]), disjunction(off))
        return Decision(conjunction([active, negation(late)]), disjunction([*off, conjunction([active, late])]))

    def _is_active(self, steps: Sequence[int]) -> Expression:
        return disjunction(self._active(step) for step in steps)

    def _acts(self, use: ActionUse) -> Expression:
        active = self._is_active(use.steps)
        return negation(active) if use.inverted else active

    def plain(self, action: ActionSource) -> None:
        """Return None: in this control decisions of the scan before are no memory."""

    def _acted(self, use: ActionUse) -> Expression:
        known = self._was_active(use.steps)
        if known is not None:
            return negation(known) if use.inverted else known
        if use.steps not in self._before:
            name = "_".join(self._net.steps[step].path for step in use.steps[:1])
            # at the start an initial step counts as active before, unless its activation is an event under the profile
            initial = not self._entered and any(self._net.initial >> step & 1 for step in use.steps)
            self._before[use.steps] = self._code.declare(
                self._code.texts.with_suffix(name, "before"), initial="TRUE" if initial else None
            )
        before = self._before[use.steps]
        return negation(before) if use.inverted else before

    def _begins(self, use: ActionUse) -> Expression:
        return conjunction([self._acts(use), use.condition, negation(self._acted(use))])

    def _ends(self, use: ActionUse) -> Expression:
        return conjunction([negation(self._acts(use)), self._acted(use)])

    def _is_late(self, action: ActionSource, use: ActionUse) -> Expression:
        """Return an expression that is TRUE if the step has been active for the time of a D or L."""
        if use.inverted or len(use.steps) != 1 or use.duration is None:
            raise LoweringError(
                f"{use.qualifier} is measured by the time of one step while that is active",
                location=Location(path=f"action {action.name}"),
                hint="Give each step an action of its own for it, that is not negated.",
            )
        return n.Operation(Operator.GREATER_OR_EQUAL, (self._times.elapsed(use.steps[0]), use.duration))

    # -- what is stored

    def _set_and_reset(self, action: ActionSource, into: list[Statement]) -> tuple[Expression, Expression]:
        """Return the set and reset conditions of a stored action in this scan."""
        uses = {q: [use for use in action.uses if use.qualifier is q] for q in Q}
        stored = any(uses[q] for q in _STORED)
        set_ = [conjunction([self._acts(use), use.condition]) for use in uses[Q.S]]
        set_ += [self._begins(use) for use in uses[Q.SL]]
        reset = [conjunction([self._acts(use), use.condition]) for use in (*uses[Q.R], *uses[Q.R0])]
        reset += [self._ending] if stored else []
        delayed = [use for use in action.uses if use.qualifier in (Q.SD, Q.DS)]
        if delayed:
            set_ = [self._timer(f"{action.name}_SD", delayed, disjunction(set_), into)]
        if uses[Q.SL]:
            reset = [self._timer(f"{action.name}_SL", uses[Q.SL], disjunction(reset), into)]
        return disjunction(set_), disjunction(reset)

    def _timer(self, name: str, uses: Sequence[ActionUse], also: Expression, into: list[Statement]) -> Expression:
        """Return when the time since the last activation of a step is over; `also` ends the time too.

        A time of zero never ends in the code of matiec. The time is that of the scan of the activation.
        """
        running = self._code.declare(self._suffixed(name, "on"))
        timer = self._code.declare(name, DerivedType(name="TON"))
        times = [use.duration for use in uses if use.duration is not None]
        time: Expression = times[0]
        if not isinstance(time, n.Literal) or any(each != time for each in times):
            time = self._code.declare(f"{name}_PT", TIME)
        # the first call asks if the time is over, the second one starts it in the scan of the activation: one call
        # alone would begin a scan late
        into.append(call(timer, IN=running, PT=time))
        # a variable: the second call changes the output of the timer
        ended = self._code.declare(self._suffixed(name, "over"))
        into.append(assignment(ended, disjunction([n.Member(timer, n.Name("Q")), also])))
        goes_on: Expression = running
        starts: list[Expression] = []
        for use, duration in zip(uses, times, strict=True):
            positive = _is_positive(duration)
            begins = conjunction([self._begins(use), positive])
            if not is_constant(begins, FALSE):
                begins = self.memory.named(self._suffixed(name, "start"), begins, into)
            if time is not duration and time != duration:
                into += self.memory.conditional("", begins, [assignment(time, duration)])
            starts.append(begins)
            # a time of zero starts nothing, but the activation ends what was running
            if not is_constant(positive, TRUE):
                goes_on = conjunction([goes_on, negation(self._begins(use))])
            goes_on = disjunction([begins, goes_on])
            # DS needs the step for its time, SD and SL do not
            if use.qualifier is Q.DS:
                goes_on = conjunction([goes_on, negation(self._ends(use))])
        into.append(assignment(running, conjunction([goes_on, negation(ended)])))
        into += self.memory.conditional("", disjunction(starts), [call(timer, IN=FALSE, PT=time)])
        into.append(call(timer, IN=running, PT=time))
        return ended

    def _suffixed(self, name: str, suffix: str) -> str:
        return self._code.texts.with_suffix(name, suffix)


def _is_positive(duration: Expression) -> Expression:
    """Return an expression that is TRUE if a time is longer than zero; of a literal that is known here."""
    if isinstance(duration, n.Literal):
        return TRUE if literal_value(duration, Dialect.IEC).value else FALSE
    return n.Operation(Operator.GREATER, (duration, n.Literal("T#0s")))
