"""What drives an action: the action control of IEC 61131-3, as code.

One control for each action, over all steps that use it (ed. 3, 6.7.4.6): stored and delayed uses are remembered apart,
R dominates all of them.
"""

from __future__ import annotations

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.code.logic import FALSE, assignment, conjunction, disjunction, is_constant, negation
from plcopen_sfc.lowering.code.memory import Memory
from plcopen_sfc.lowering.code.program import TIME, StepValue
from plcopen_sfc.lowering.reading.source import ActionSource, Use
from plcopen_sfc.model.actions import Qualifier

Q = Qualifier
_STORED = {Q.S, Q.SD, Q.DS, Q.SL}


class ActionControl:
    """Makes the control of one action after the other. `active` gives the flag of a step by its index in the net.

    `ending`: what ends stored actions besides R.
    """

    def __init__(self, memory: Memory, active: StepValue, ending: Expression = FALSE) -> None:
        self._memory = memory
        self._active = active
        self._ending = ending

    def drive(self, action: ActionSource, into: list[Statement]) -> Expression:
        """Whether the action is active: the output Q of its action control, with its pulses P1 and P0."""
        reset = self._input(action, Q.R, Q.R0)
        terms = [*self._lasting(action, reset, into), *self._single(action, into)]
        return self._unless(reset, terms, action)

    def outputs(self, action: ActionSource, into: list[Statement]) -> tuple[Expression, Expression]:
        """The same in two parts: what lasts, after whose end an action is executed once more, and P1 and P0."""
        reset = self._input(action, Q.R, Q.R0)
        lasting = self._unless(reset, self._lasting(action, reset, into), action)
        single = conjunction([disjunction(self._single(action, into)), negation(reset)])
        return lasting, single

    def _unless(self, reset: Expression, terms: list[Expression], action: ActionSource) -> Expression:
        """Any of the terms, and no reset, which flip-flops and what hangs on them have seen already."""
        if {use.qualifier for use in action.uses} <= _STORED | {Q.R, Q.R0}:
            return disjunction(terms)
        return conjunction([disjunction(terms), negation(reset)])

    def _lasting(self, action: ActionSource, reset: Expression, into: list[Statement]) -> list[Expression]:
        reset = disjunction([reset, self._ending])
        makers = (self._level, self._stored, self._limited, self._delayed, self._pulse, self._stored_and_timed)
        return [term for make in makers for term in make(action, reset, into)]

    def _single(self, action: ActionSource, into: list[Statement]) -> list[Expression]:
        found: list[Expression] = []
        for qualifier, edge in ((Q.P1, self._memory.rising), (Q.P0, self._memory.falling)):
            value = self._input(action, qualifier)
            if not is_constant(value, FALSE):
                found.append(edge(f"{action.name}_{qualifier}", value, into))
        return found

    def _input(self, action: ActionSource, *qualifiers: Qualifier) -> Expression:
        """The input of the action control for these qualifiers: any step that uses the action with one of them."""
        return disjunction(self._of(use) for use in action.uses if use.qualifier in qualifiers)

    def _of(self, use: Use) -> Expression:
        active = disjunction(self._active(step) for step in use.steps)
        return conjunction([negation(active) if use.inverted else active, use.condition])

    def _level(self, action: ActionSource, _: Expression, __: list[Statement]) -> list[Expression]:
        return [self._input(action, Q.N)]

    def _stored(self, action: ActionSource, reset: Expression, into: list[Statement]) -> list[Expression]:
        set_ = self._input(action, Q.S)
        if is_constant(set_, FALSE):
            return []
        return [self._memory.latch(f"{action.name}_S", set_, reset, into)]

    def _limited(self, action: ActionSource, _: Expression, into: list[Statement]) -> list[Expression]:
        value = self._input(action, Q.L)
        if is_constant(value, FALSE):
            return []
        over = self._memory.delayed(f"{action.name}_L", value, self._time(action, Q.L, into), into)
        return [conjunction([value, negation(over)])]

    def _delayed(self, action: ActionSource, _: Expression, into: list[Statement]) -> list[Expression]:
        value = self._input(action, Q.D)
        if is_constant(value, FALSE):
            return []
        return [self._memory.delayed(f"{action.name}_D", value, self._time(action, Q.D, into), into)]

    def _pulse(self, action: ActionSource, _: Expression, into: list[Statement]) -> list[Expression]:
        value = self._input(action, Q.P)
        return [] if is_constant(value, FALSE) else [self._memory.rising(f"{action.name}_P", value, into)]

    def _stored_and_timed(self, action: ActionSource, reset: Expression, into: list[Statement]) -> list[Expression]:
        found: list[Expression] = []
        stored = self._input(action, Q.SD)
        if not is_constant(stored, FALSE):
            latch = self._memory.latch(f"{action.name}_SD", stored, reset, into)
            found.append(self._memory.delayed(f"{action.name}_SD_T", latch, self._time(action, Q.SD, into), into))
        delayed = self._input(action, Q.DS)
        if not is_constant(delayed, FALSE):
            late = self._memory.delayed(f"{action.name}_DS_T", delayed, self._time(action, Q.DS, into), into)
            found.append(self._memory.latch(f"{action.name}_DS", late, reset, into))
        limited = self._input(action, Q.SL)
        if not is_constant(limited, FALSE):
            latch = self._memory.latch(f"{action.name}_SL", limited, reset, into)
            over = self._memory.delayed(f"{action.name}_SL_T", latch, self._time(action, Q.SL, into), into)
            found.append(conjunction([latch, negation(over)]))
        return found

    def _time(self, action: ActionSource, qualifier: Qualifier, into: list[Statement]) -> Expression:
        """The time of the first use that is on. Where it can change it is kept in a variable."""
        uses = [use for use in action.uses if use.qualifier is qualifier and use.duration is not None]
        times = [use.duration for use in uses if use.duration is not None]
        kept = qualifier in (Q.SD, Q.SL) and not isinstance(times[0], n.Literal)  # their timers go on without the step
        if all(time == times[0] for time in times) and not kept:
            return times[0]
        chosen = self._memory.variable(self._memory.texts.with_suffix(f"{action.name}_{qualifier}", "time"), TIME)
        for use, time in reversed(list(zip(uses, times, strict=True))):
            into += self._memory.conditional("", self._of(use), [assignment(chosen, time)])
        return chosen
