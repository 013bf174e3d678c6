"""How long steps are active, for code that asks: a timer for each such step."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.code.logic import FALSE, assignment, call, when
from plcopen_sfc.lowering.code.program import Code
from plcopen_sfc.model.types import DerivedType, Elementary, ElementaryType

FOREVER = n.Literal("T#24d")
"""Longer than any step time: TIME of 32 bits ends at 24 days 20 hours."""


class StepTimes:
    """The timers of one chart. `active` gives the flag of a step by its index in the net."""

    def __init__(self, code: Code, active: Callable[[int], Expression], name: Callable[[int], str]) -> None:
        self._code, self._active, self._name = code, active, name
        self._timers: dict[int, n.Name] = {}
        self._limits: dict[int, Expression] = {}
        self._kept: dict[int, n.Name] = {}

    def keep(self, step: int) -> None:
        """Keep the time of a step when it is left, until it is active again (IEC 61131-3 ed. 3, 6.7.2)."""
        kind = ElementaryType(name=Elementary.TIME)
        self._limits[step] = FOREVER
        self._timer(step)
        self._kept[step] = self._code.declare(f"{self._name(step)}_T", kind, initial="T#0s")

    def elapsed(self, step: int) -> Expression:
        """The time for which a step has been active; of one that is not, zero, or what was kept."""
        self._limits[step] = FOREVER
        timer = self._timer(step)
        return self._kept.get(step) or n.Member(timer, n.Name("ET"))

    def is_over(self, step: int, time: Expression) -> Expression:
        """Whether a step has been active for `time`, the same one in all calls."""
        timer = self._timer(step)
        if self._limits.setdefault(step, time) == time:
            return n.Member(timer, n.Name("Q"))
        return n.Operation(n.Operator.GREATER_OR_EQUAL, (self.elapsed(step), time))

    def measures(self, step: int) -> bool:
        """Whether anything asks for the time of a step."""
        return step in self._timers

    def _timer(self, step: int) -> n.Name:
        timer = self._timers.get(step)
        if timer is None:
            timer = self._timers[step] = self._code.declare(self._name(step), DerivedType(name="TON"))
        return timer

    def calls(self) -> list[Statement]:
        """The calls of all timers. They stand where steps have just changed, and where times are read."""
        calls: list[Statement] = []
        for step, timer in self._timers.items():
            calls.append(call(timer, IN=self._active(step), PT=self._limits[step]))
            if step in self._kept:
                elapsed = assignment(self._kept[step], n.Member(timer, n.Name("ET")))
                calls.append(when(self._active(step), elapsed))
        return calls

    def ends(self) -> list[Statement]:
        """The calls that set all timers back."""
        return [call(timer, IN=FALSE, PT=self._limits[i]) for i, timer in self._timers.items()]

    def restarts(self, step: int, reentered: Expression) -> Sequence[Statement]:
        """Lets the time of a step begin anew when it is left and entered at once."""
        timer = self._timers.get(step)
        return () if timer is None else (when(reentered, call(timer, IN=FALSE, PT=self._limits[step])),)
