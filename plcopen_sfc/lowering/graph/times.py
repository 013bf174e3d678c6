"""How long steps have been active: their times T and U, and delays and limits of actions.

One TON for each step whose time anything depends on. It is called at the start of the cycle, as the sequencer brings
times up to date there, and behind the step change, where the time of a step that was entered begins.
"""

from __future__ import annotations

from collections.abc import Sequence

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.literals import LiteralError, LiteralKind, literal_value, time_literal
from plcopen_sfc.languages.st.nodes import Expression, Operator, Statement
from plcopen_sfc.lowering.code.logic import assignment, call, conjunction, negation, when
from plcopen_sfc.lowering.code.program import TIME, Code, StepValue
from plcopen_sfc.lowering.code.times import FOREVER
from plcopen_sfc.lowering.graph.checks import StepChecks
from plcopen_sfc.lowering.graph.source import GraphSource
from plcopen_sfc.lowering.graph.step_data import Questions, StepSign
from plcopen_sfc.lowering.texts import Texts
from plcopen_sfc.model.types import DerivedType

_NONE = n.Literal("T#0ms")


class StepClock:
    """The times of the steps of one sequencer."""

    def __init__(
        self, source: GraphSource, code: Code, signs: Sequence[StepSign], texts: Texts, questions: Questions
    ) -> None:
        self._source, self._signs, self._questions = source, signs, questions
        self._timers: dict[int, n.Name] = {}
        self._limits: dict[int, Expression] = {}
        self._kept: dict[int, n.Name] = {}
        self._undisturbed: dict[int, tuple[n.Name, n.Name]] = {}
        for step in source.net.steps:
            index = step.index
            asked = questions.of(index) & {"T", "U"}
            durations = [row.value for row in source.rows[index] if row.is_coil and row.value is not None]
            if not asked and not durations:
                continue
            self._timers[index] = code.declare(texts.time_name(step.step), DerivedType(name="TON"))
            self._limits[index] = self._limit(index, asked, durations)
            counted = "U" in asked and self._is_checked(index)
            elapsed = asked - {"U"} if counted else asked
            if not all(questions.only_while_active(index, quantity) for quantity in elapsed):
                self._kept[index] = code.declare(f"{signs[index].name}_T", TIME)
            if counted:
                sum_ = code.declare(f"{signs[index].name}_U", TIME)
                before = texts.with_suffix(f"{signs[index].name}_T", "old")
                self._undisturbed[index] = sum_, code.declare(before, TIME)

    def _is_checked(self, step: int) -> bool:
        """Whether anything could disturb a step; where nothing does, its times T and U are the same."""
        return step in self._source.interlocks or step in self._source.supervisions

    def _limit(self, step: int, asked: set[str], durations: Sequence[Expression]) -> Expression:
        """The time that the timer of a step measures: one that is beyond all that it is compared with."""
        first = durations[0] if durations else None
        # a TON whose PT changes while it runs is another one in every controller
        if not asked and isinstance(first, n.Literal) and all(duration == first for duration in durations):
            return first
        times = [_nanoseconds(duration) for duration in durations]
        times += [_nanoseconds(constant) for constant in self._questions.compared(step, asked)]
        if "U" in asked and self._is_checked(step):
            return FOREVER
        known = [time for time in times if time is not None]
        return n.Literal(time_literal(2 * max(known))) if len(known) == len(times) and max(known) > 0 else FOREVER

    def _elapsed(self, step: int) -> Expression:
        return n.Member(self._timers[step], n.Name("ET"))

    def value(self, step: int, quantity: str) -> Expression:
        """The time T of a step, or its time without disturbance U."""
        if quantity == "U" and step in self._undisturbed:
            return self._undisturbed[step][0]
        return self._kept.get(step, self._elapsed(step))

    def over(self, step: int, time: Expression) -> Expression:
        """Whether an active step has been so for `time`."""
        if self._limits[step] == time and isinstance(time, n.Literal):
            return n.Member(self._timers[step], n.Name("Q"))
        return n.Operation(Operator.GREATER_OR_EQUAL, (self._elapsed(step), time))

    def stated(self, text: str | None) -> Expression:
        """A limit that a step states, T_MAX or T_WARN."""
        return n.Literal(text) if text else _NONE

    def calls(self) -> list[Statement]:
        """The calls of the timers."""
        calls = [call(timer, IN=self._signs[i].active, PT=self._limits[i]) for i, timer in self._timers.items()]
        kept = [when(self._signs[i].active, assignment(name, self._elapsed(i))) for i, name in self._kept.items()]
        return [*calls, *kept]

    def counted(self, checks: Sequence[StepChecks]) -> list[Statement]:
        """The times without disturbance, behind the checks of the active steps."""
        found: list[Statement] = []
        for step, (sum_, old) in self._undisturbed.items():
            elapsed = self._elapsed(step)
            passed = n.Operation(Operator.SUBTRACT, (elapsed, old))
            more = assignment(sum_, n.Operation(Operator.ADD, (sum_, n.Parenthesized(passed))))
            calm = conjunction([self._signs[step].active, negation(checks[step].disturbed())])
            found += [when(calm, more), assignment(old, elapsed)]
        return found

    def restarted(self, entered: StepValue) -> list[Statement]:
        """The times without disturbance of steps that were entered begin anew."""
        return [
            when(entered(step), assignment(sum_, _NONE), assignment(old, _NONE))
            for step, (sum_, old) in self._undisturbed.items()
        ]


def _nanoseconds(time: Expression | None) -> int | None:
    """A duration that is a constant."""
    if not isinstance(time, n.Literal):
        return None
    try:
        found = literal_value(time.text)
    except LiteralError:
        return None
    return found.value if found.kind is LiteralKind.DURATION and isinstance(found.value, int) else None
