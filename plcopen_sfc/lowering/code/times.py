"""How long steps are active, for code that asks: a timer for each such step."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.code.logic import FALSE, assignment, call, when
from plcopen_sfc.lowering.code.program import TIME, Code, StepValue
from plcopen_sfc.model.types import DerivedType

FOREVER = n.Literal("T#24d")
"""Longer than any step time: TIME of 32 bits ends at 24 days 20 hours."""


class StepTimes:
    """The timers of one chart. `active` gives the flag of a step by its index in the net.

    A step has a timer for each time that its output ``Q`` is to tell of; one of them has no end, where anything asks
    how long the step has been active.
    """

    def __init__(self, code: Code, active: StepValue, name: Callable[[int], str]) -> None:
        self._code, self._active, self._name = code, active, name
        self._timers: dict[int, dict[Expression, n.Name]] = {}
        self._kept: dict[int, n.Name] = {}

    def keep(self, step: int) -> None:
        """Keep the time of a step when it is left, until it is active again (IEC 61131-3 ed. 3, 6.7.2)."""
        self._timer(step, FOREVER)
        self._kept[step] = self._code.declare(f"{self._name(step)}_T", TIME, initial="T#0s")

    def elapsed(self, step: int) -> Expression:
        """The time for which a step has been active; of one that is not, zero, or what was kept."""
        timer = self._timer(step, FOREVER)
        return self._kept.get(step) or n.Member(timer, n.Name("ET"))

    def is_over(self, step: int, time: Expression) -> Expression:
        """Whether a step has been active for `time`."""
        # the output of a TON stays TRUE when its PT grows
        if FOREVER in self._timers.get(step, {}) or not isinstance(time, n.Literal):
            return n.Operation(n.Operator.GREATER_OR_EQUAL, (self.elapsed(step), time))
        return n.Member(self._timer(step, time), n.Name("Q"))

    def measures(self, step: int) -> bool:
        """Whether anything asks for the time of a step."""
        return step in self._timers

    def _timer(self, step: int, limit: Expression) -> n.Name:
        timers = self._timers.setdefault(step, {})
        if limit not in timers:
            timers[limit] = self._code.declare(self._name(step), DerivedType(name="TON"))
        return timers[limit]

    def calls(self) -> list[Statement]:
        """The calls of all timers. They stand where steps have just changed, and where times are read."""
        calls: list[Statement] = []
        for step, timers in self._timers.items():
            active = self._active(step)
            calls += [call(timer, IN=active, PT=limit) for limit, timer in timers.items()]
            if step in self._kept:
                calls.append(when(active, assignment(self._kept[step], n.Member(timers[FOREVER], n.Name("ET")))))
        return calls

    def ends(self) -> list[Statement]:
        """The calls that set all timers back."""
        return [ended for step in self._timers for ended in self._ended(step)]

    def restarts(self, step: int, reentered: Expression) -> Sequence[Statement]:
        """Lets the time of a step begin anew when it is left and entered at once."""
        return [when(reentered, ended) for ended in self._ended(step)]

    def _ended(self, step: int) -> list[Statement]:
        return [call(timer, IN=FALSE, PT=limit) for limit, timer in self._timers.get(step, {}).items()]
