"""How long steps have been active: their times T and U, and delays and limits of actions.

One TON for each step whose time anything depends on. It is called at the start of the cycle, as the sequencer brings
times up to date there, and behind the step change, where the time of a step that was entered begins.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.code import Code
from plcopen_sfc.lowering.graph.checks import StepChecks
from plcopen_sfc.lowering.graph.source import GraphSource
from plcopen_sfc.lowering.graph.step_data import Questions
from plcopen_sfc.lowering.logic import assignment, conjunction, negation, when
from plcopen_sfc.lowering.texts import Texts
from plcopen_sfc.lowering.times import StepTimes
from plcopen_sfc.model.types import Elementary, ElementaryType

TIME = ElementaryType(name=Elementary.TIME)
_NONE = n.Literal("T#0ms")


class StepClock:
    """The times of the steps of one sequencer."""

    def __init__(
        self, source: GraphSource, code: Code, flags: Sequence[n.Name], texts: Texts, questions: Questions
    ) -> None:
        self._flags = flags
        self._code = code
        steps = source.net.steps
        self._times = StepTimes(code, flags.__getitem__, lambda i: texts.time_name(steps[i].step))
        self._elapsed: dict[int, Expression] = {}
        self._kept: dict[int, n.Name] = {}
        self._undisturbed: dict[int, tuple[n.Name, n.Name]] = {}
        self._plain: set[int] = set()
        for step in range(len(steps)):
            quantities = questions.of(step)
            checked = step in source.interlocks or step in source.supervisions
            quiet = "U" in quantities and not checked  # nothing could disturb it: it is T
            self._plain |= {step} if quiet else set()
            durations = [row.value for row in source.rows[step] if row.is_coil and row.value is not None]
            simple = len(set(map(repr, durations))) == 1 and isinstance(durations[0], n.Literal)
            if quantities & {"T", "U"} or (durations and not simple):
                self._elapsed[step] = self._times.elapsed(step)
            elif durations:
                self._times.is_over(step, durations[0])
            asked = [q for q in ("T", "U") if q in quantities and (q == "T" or quiet)]
            if not all(questions.only_while_active(step, q) for q in asked):
                self._kept[step] = code.declare(f"{flags[step].identifier}_T", TIME)
            if "U" in quantities and not quiet:
                undisturbed = code.declare(f"{flags[step].identifier}_U", TIME)
                self._undisturbed[step] = undisturbed, code.declare(f"{flags[step].identifier}_T_old", TIME)

    def value(self, step: int, quantity: str) -> Expression:
        """The time T of a step, or its time without disturbance U."""
        if quantity == "U" and step not in self._plain:
            return self._undisturbed[step][0]
        return self._kept.get(step, self._elapsed[step])

    def over(self, step: int, time: Expression) -> Expression:
        """Whether an active step has been so for `time`."""
        return self._times.is_over(step, time)

    def limit(self, step: int, text: str | None) -> Expression:  # noqa: ARG002
        """A limit that a step states."""
        return n.Literal(text) if text else _NONE

    def calls(self) -> list[Statement]:
        """The calls of the timers."""
        return self._times.calls()

    def kept(self) -> list[Statement]:
        """Times that stay when their step is left."""
        return [when(self._flags[step], assignment(name, self._elapsed[step])) for step, name in self._kept.items()]

    def counted(self, checks: Sequence[StepChecks]) -> list[Statement]:
        """The times without disturbance, behind the checks of the active steps."""
        found: list[Statement] = []
        for step, (sum_, old) in self._undisturbed.items():
            elapsed = self._elapsed[step]
            passed = n.Operation(n.Operator.SUBTRACT, (elapsed, old))
            more = assignment(sum_, n.Operation(n.Operator.ADD, (sum_, n.Parenthesized(passed))))
            calm = conjunction([self._flags[step], negation(checks[step].disturbed())])
            found += [when(calm, more), assignment(old, elapsed)]
        return found

    def restarted(self, entered: Callable[[int], Expression]) -> list[Statement]:
        """The times without disturbance of steps that were entered begin anew."""
        return [
            when(entered(step), assignment(sum_, _NONE), assignment(old, _NONE))
            for step, (sum_, old) in self._undisturbed.items()
        ]
