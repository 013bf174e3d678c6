"""S5 timers of actions (TL extended pulse, TD on-delay, TF off-delay, TR reset) as TON and what it does just now."""

from __future__ import annotations

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Operator, Statement
from plcopen_sfc.lowering.code.logic import FALSE, TRUE, assignment, call, conjunction, equal, negation, when
from plcopen_sfc.lowering.code.program import INT, TIME, Code
from plcopen_sfc.lowering.graph.texts import GraphTexts
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.types import DerivedType

_MODES = {Qualifier.TR: "0", Qualifier.TL: "1", Qualifier.TD: "2", Qualifier.TF: "3"}
_STOPPED, _DELAY = n.Literal(_MODES[Qualifier.TR]), n.Literal(_MODES[Qualifier.TD])


class Timer:
    """One timer, whose output is an operand."""

    def __init__(self, name: str, output: Expression, code: Code, texts: GraphTexts) -> None:
        self._output = output
        called = code.texts.with_suffix
        self._timer = code.declare(called(name, "timer"), DerivedType(name="TON"))
        self._mode = code.declare(called(name, "mode"), INT, comment=texts.timer_mode)
        self._runs = code.declare(called(name, "runs"))
        self._starts = code.declare(called(name, "starts"))
        self._time = code.declare(called(name, "time"), TIME)

    def started(self, qualifier: Qualifier, time: Expression | None) -> list[Statement]:
        """What TL, TD and TR do."""
        statements: list[Statement] = [assignment(self._mode, n.Literal(_MODES[qualifier]))]
        if time is not None and qualifier is not Qualifier.TR:
            statements.append(assignment(self._time, time))
            statements += [assignment(self._runs, TRUE), assignment(self._starts, TRUE)]
        return [*statements, assignment(self._output, FALSE)]

    def falls_off(self, time: Expression, *, active: bool) -> list[Statement]:
        """What TF does: its time begins when the step is left."""
        run = [assignment(self._runs, FALSE)] if active else [assignment(self._runs, TRUE)]
        mode = assignment(self._mode, n.Literal(_MODES[Qualifier.TF]))
        return [mode, assignment(self._time, time), *run]

    def runs(self) -> list[Statement]:
        """What happens at the end of each cycle."""
        begins = when(self._starts, call(self._timer, IN=FALSE, PT=self._time), assignment(self._starts, FALSE))
        is_on = n.Operation(Operator.UNEQUAL, (self._mode, _STOPPED))
        over = n.Member(self._timer, n.Name("Q"))
        delays = equal(self._mode, _DELAY)
        value = n.If(
            (n.Branch(delays, (assignment(self._output, over),)),), (assignment(self._output, negation(over)),)
        )
        ends = when(conjunction([over, negation(delays)]), assignment(self._mode, _STOPPED))
        running = call(self._timer, IN=conjunction([self._runs, is_on]), PT=self._time)
        return [begins, running, when(is_on, value, ends)]
