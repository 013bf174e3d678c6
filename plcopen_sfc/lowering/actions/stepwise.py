"""What drives an action where every association acts on its own, as in the code of matiec.

D and L look at the time of their step, P and SD at its activation. R resets what is stored, but nothing else.
"""

from __future__ import annotations

from collections.abc import Sequence

from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Operator, Statement
from plcopen_sfc.lowering.code.logic import FALSE, assignment, call, conjunction, disjunction, is_constant, negation
from plcopen_sfc.lowering.code.memory import Memory
from plcopen_sfc.lowering.code.program import Code, StepValue
from plcopen_sfc.lowering.code.times import StepTimes
from plcopen_sfc.lowering.reading.source import ActionSource, ChartSource, Use
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.types import DerivedType
from plcopen_sfc.semantics.net import Net

Q = Qualifier


def stepwise_timed(source: ChartSource) -> list[int]:
    """The steps whose times this control asks for."""
    timed = [use for action in source.actions for use in action.uses if use.qualifier in (Q.D, Q.L)]
    return sorted({step for use in timed for step in use.steps})


class StepwiseControl:
    """Makes the control of one action after the other. `active` gives the flag of a step by its index in the net.

    `ending`: what ends stored actions besides R. Raises `LoweringError` for what matiec does not define.
    """

    def __init__(
        self, net: Net, code: Code, memory: Memory, times: StepTimes, *, active: StepValue, ending: Expression = FALSE
    ) -> None:
        self._net, self._code, self._memory, self._active = net, code, memory, active
        self._times, self._ending = times, ending
        self._entered: dict[tuple[int, ...], Expression] = {}

    def drive(self, action: ActionSource, into: list[Statement]) -> Expression:
        """Whether the action is executed."""
        lasting, _ = self.outputs(action, into)
        return lasting

    def outputs(self, action: ActionSource, into: list[Statement]) -> tuple[Expression, Expression]:
        """The same in two parts, of which the second one, P1 and P0, is always FALSE."""
        uses = {q: [use for use in action.uses if use.qualifier is q] for q in Q}
        reset = disjunction([*(self._is_on(use) for use in (*uses[Q.R], *uses[Q.R0])), self._ending])
        terms = [self._is_on(use) for use in uses[Q.N]]
        terms += [conjunction([self._is_on(use), self._is_late(action, use)]) for use in uses[Q.D]]
        terms += [conjunction([self._is_on(use), negation(self._is_late(action, use))]) for use in uses[Q.L]]
        terms += [self._starts(use, into) for use in uses[Q.P] if not use.inverted]
        set_ = [self._is_on(use) for use in uses[Q.S]]
        if uses[Q.SD]:
            set_.append(self._delayed(action, uses[Q.SD], reset, into))
        if set_:
            terms.append(self._memory.latch(f"{action.name}_S", disjunction(set_), reset, into))
        return disjunction(terms), FALSE

    def _is_on(self, use: Use) -> Expression:
        active = disjunction(self._active(step) for step in use.steps)
        return conjunction([negation(active) if use.inverted else active, use.condition])

    def _is_late(self, action: ActionSource, use: Use) -> Expression:
        """Whether the step has been active for the time of a D or L."""
        if use.inverted or len(use.steps) != 1 or use.duration is None:
            raise LoweringError(
                f"{use.qualifier} is measured by the time of one step while that is active",
                location=Location(path=f"action {action.name}"),
            )
        return n.Operation(Operator.GREATER_OR_EQUAL, (self._times.elapsed(use.steps[0]), use.duration))

    def _starts(self, use: Use, into: list[Statement]) -> Expression:
        """TRUE in the scan in which the step of a use becomes active; initial steps are from the start."""
        if use.steps not in self._entered:
            active = disjunction(self._active(step) for step in use.steps)
            name = "_".join(self._net.steps[step].path for step in use.steps[:1])
            initial = any(self._net.initial >> step & 1 for step in use.steps)
            before = self._code.declare(
                self._code.texts.with_suffix(name, "before"), initial="TRUE" if initial else None
            )
            self._entered[use.steps] = self._memory.named(
                self._code.texts.with_suffix(name, "entered"), conjunction([active, negation(before)]), into
            )
            into.append(assignment(before, active))
        return conjunction([self._entered[use.steps], use.condition])

    def _delayed(
        self, action: ActionSource, uses: Sequence[Use], reset: Expression, into: list[Statement]
    ) -> Expression:
        """TRUE when the time since the last activation of a step with SD is over, unless R came in between."""
        times = [use.duration for use in uses if use.duration is not None]
        if any(time != times[0] for time in times) or any(use.inverted for use in uses):
            raise LoweringError(
                f"{action.name} has several times for {Q.SD}, of which one timer can have only one",
                location=Location(path=f"action {action.name}"),
            )
        timer = self._code.declare(f"{action.name}_SD", DerivedType(name="TON"))
        running = self._code.declare(self._code.texts.with_suffix(f"{action.name}_SD", "on"))
        into.append(call(timer, IN=running, PT=times[0]))
        over = self._memory.named(
            self._code.texts.with_suffix(f"{action.name}_SD", "over"), n.Member(timer, n.Name("Q")), into
        )
        started = disjunction(self._starts(use, into) for use in uses)
        if not is_constant(started, FALSE):
            started = self._memory.named(self._code.texts.with_suffix(f"{action.name}_SD", "start"), started, into)
        goes_on = disjunction([conjunction([running, negation(over)]), started])
        into.append(assignment(running, conjunction([goes_on, negation(reset)])))
        into += self._memory.conditional("", started, [call(timer, IN=FALSE, PT=times[0])])
        into.append(call(timer, IN=running, PT=times[0]))
        return over
