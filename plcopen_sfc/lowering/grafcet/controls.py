"""What drives the actions of a GRAFCET behind the evolutions of a scan.

Continuous actions of IEC 60848 depend on the situation that is stable. Actions with the qualifiers of IEC 61131-3 do
too, but what these store, and their pulses, also comes from steps that were only passed.
"""

from __future__ import annotations

from collections.abc import Sequence

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.actions.control import ActionControl
from plcopen_sfc.lowering.code.logic import FALSE, assignment, conjunction, disjunction, is_constant, negation
from plcopen_sfc.lowering.code.memory import Memory
from plcopen_sfc.lowering.code.program import Code, StepValue
from plcopen_sfc.lowering.code.times import StepTimes
from plcopen_sfc.lowering.reading.source import ActionSource, Use
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.types import DerivedType

_PASSING = frozenset({Qualifier.S, Qualifier.R, Qualifier.R0, Qualifier.SD, Qualifier.SL})
_PULSES = frozenset({Qualifier.P, Qualifier.P1, Qualifier.P0})


def passed_steps(actions: Sequence[ActionSource]) -> set[int]:
    """The steps of which it matters that a scan has passed them: also where blocks in conditions look at them."""
    uses = (use for action in actions for use in action.uses)
    return {i for use in uses if use.qualifier in _PASSING | _PULSES or use.preparation for i in use.steps}


class PassingControl(ActionControl):
    """The action control of IEC 61131-3. `seen` tells whether a step was active in any evolution of the scan."""

    def __init__(
        self, code: Code, memory: Memory, active: StepValue, seen: StepValue, ending: Expression = FALSE
    ) -> None:
        super().__init__(memory, active, ending)
        self._code, self._stable, self._seen = code, active, seen

    def _input(self, action: ActionSource, *qualifiers: Qualifier) -> Expression:
        return self._asked(self._seen if _PASSING.issuperset(qualifiers) else self._stable, action, *qualifiers)

    def _asked(self, active: StepValue, action: ActionSource, *qualifiers: Qualifier) -> Expression:
        self._active = active
        return super()._input(action, *qualifiers)

    def _pulse(self, action: ActionSource, _: Expression, into: list[Statement]) -> list[Expression]:
        return self._edges(action, into, Qualifier.P)

    def _single(self, action: ActionSource, into: list[Statement]) -> list[Expression]:
        return self._edges(action, into, Qualifier.P1, Qualifier.P0)

    def _edges(self, action: ActionSource, into: list[Statement], *qualifiers: Qualifier) -> list[Expression]:
        """Pulses when a step becomes active or no longer is, also if it is so in between only."""
        found: list[Expression] = []
        for qualifier in qualifiers:
            now, passed = (self._asked(active, action, qualifier) for active in (self._stable, self._seen))
            if is_constant(now, FALSE) and is_constant(passed, FALSE):
                continue
            pulse = self._code.declare(f"{action.name}_{qualifier}")
            before = self._code.declare(self._code.texts.with_suffix(pulse.identifier, "old"))
            falling = conjunction([disjunction([before, passed]), negation(now)])
            rising = conjunction([passed, negation(before)])
            into += [assignment(pulse, falling if qualifier is Qualifier.P0 else rising), assignment(before, now)]
            found.append(pulse)
        return found


class ContinuousControl(ActionControl):
    """Each association acts on its own, with the time of its step (IEC 60848:2013, 4.8.4).

    `timers`: those of macro-steps, with what starts each and its time. Like those of steps (`times`) they are to be
    called behind the evolutions.
    """

    def __init__(
        self, actions: Sequence[ActionSource], code: Code, memory: Memory, active: StepValue, times: StepTimes
    ) -> None:
        super().__init__(memory, active)
        self._code, self._times = code, times
        self.timers: list[tuple[n.Name, Expression, Expression]] = []
        self._driven = {a.name: disjunction(self._of_step(use, a) for use in a.uses) for a in actions}

    def drive(self, action: ActionSource, into: list[Statement]) -> Expression:  # noqa: ARG002
        """Whether any association wants it."""
        return self._driven[action.name]

    def outputs(self, action: ActionSource, into: list[Statement]) -> tuple[Expression, Expression]:  # noqa: ARG002
        """The same; there are no pulses."""
        return self._driven[action.name], FALSE

    def _of_step(self, use: Use, action: ActionSource) -> Expression:
        terms = [self._of(use)]
        if use.duration is not None:
            over = self._is_over(use, use.duration, action)
            terms.append(over if use.qualifier is Qualifier.D else negation(over))
        return conjunction(terms)

    def _is_over(self, use: Use, duration: Expression, action: ActionSource) -> Expression:
        """Whether the step, or any step of the macro-step, has been active for the time."""
        if len(use.steps) == 1:
            if isinstance(duration, n.Literal):
                return self._times.is_over(use.steps[0], duration)
            return n.Operation(n.Operator.GREATER_OR_EQUAL, (self._times.elapsed(use.steps[0]), duration))
        timer = self._code.declare(f"{action.name}_{use.qualifier}", DerivedType(name="TON"))
        self.timers.append((timer, disjunction(self._active(step) for step in use.steps), duration))
        return n.Member(timer, n.Name("Q"))
