"""The interlock, the supervision and the times of steps of S7-GRAPH as code."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.literals import LiteralError, LiteralKind, literal_value, time_literal
from plcopen_sfc.languages.st.nodes import Expression, Operator, Statement
from plcopen_sfc.lowering.code.boolean_logic import (
    FALSE,
    TRUE,
    assignment,
    call,
    conjunction,
    disjunction,
    is_constant,
    names_in,
    negation,
    when,
)
from plcopen_sfc.lowering.code.lowered_code import TIME, LoweredCode, StepValue
from plcopen_sfc.lowering.code_texts import SUFFIXES, Texts
from plcopen_sfc.lowering.graph.sequencer_source import AskedStepData, CyclePhase, GraphSource, StepNames
from plcopen_sfc.lowering.reading.step_variables import FOREVER
from plcopen_sfc.model.types import DerivedType

INTERLOCK = ("LS", "LA", "L1", "L0")
SUPERVISION = ("VS", "VA", "V1", "V0", "A1")

Resolve = Callable[[Any, CyclePhase], Any]
"""Gives a text with variables of the code in the place of step data."""


@dataclass(frozen=True)
class CheckedStep:
    """Step with checks: its names in code, and the results (`needed`) that any code asks for.

    `comment` is that of a variable of them.
    """

    sign: StepNames
    needed: set[str]
    questions: AskedStepData
    comment: Callable[[str], str]


class SupervisionChecks:
    """Checks of one step. `early`: they are evaluated before the step change."""

    def __init__(self, source: GraphSource, step: int, code: LoweredCode, asked: CheckedStep) -> None:
        needed, questions = asked.needed, asked.questions
        self._flag = asked.sign.active
        self._interlock = source.interlocks.get(step)
        self._supervision = source.supervisions.get(step)
        self._must_acknowledge = source.acknowledged
        self._remembers = self._supervision is not None and (source.acknowledged or "A1" in needed)
        stated = [c for c in (self._interlock, self._supervision) if c is not None]
        # checks are behind the step change where that makes no difference: one evaluation there, two if they come
        # before, as the steps that are entered must be checked too
        asked_early = (step, "U") in questions or questions.asked(
            step, {*INTERLOCK, *SUPERVISION}, CyclePhase.CHECK, CyclePhase.SWITCH
        )
        self.early = (
            self._remembers
            or (asked_early and bool(stated))
            or any(c.preparation or questions.asks(c.value) for c in stated)
            or not source.prepared_names.isdisjoint(names_in(*(c.value for c in stated)))
        )
        kept = self._kept_of_interlock(needed) | self._kept_of_supervision(needed)
        self._asked_between = questions.asked(step, _EVENTS, CyclePhase.CHECK)
        self._variables = {
            name: code.declare(_called(name, asked.sign.name, code.texts), comment=asked.comment(name))
            for name in _ORDER
            if name in kept
        }

    def _kept_of_interlock(self, needed: set[str]) -> set[str]:
        """Return the results of the interlock that have variables; the events compare with LA of the last cycle."""
        if self._interlock is None:
            return set()
        kept = needed & {*INTERLOCK}
        if kept or (self.early and self._interlock.preparation):
            kept |= {"LS"}
        return kept | {"LA"} if kept & {"L1", "L0"} else kept

    def _kept_of_supervision(self, needed: set[str]) -> set[str]:
        """Return the results of the supervision with variables; the events compare `fault` with VS, the last one."""
        if self._supervision is None:
            return set()
        kept = needed & {*SUPERVISION}
        if self._remembers:
            kept |= {"VS", "VA", "acknowledged"}
        if kept & {"V1", "V0"}:
            kept |= {"VS", "fault"}
        # without acknowledgement the error is there as long as its condition: one variable for both
        if "VA" in kept and not self._remembers:
            kept = kept - {"VA"} | {"VS"}
        return kept | {"VS"} if self.early else kept

    def value(self, quantity: str) -> Expression:
        """Return the expression for a quantity that is needed."""
        if quantity in INTERLOCK and self._interlock is None:
            return self._flag if quantity == "LS" else FALSE
        if quantity in SUPERVISION and self._supervision is None:
            return FALSE
        if quantity == "VA" and not self._remembers:
            quantity = "VS"
        return self._variables[quantity]

    def held(self, resolve: Resolve) -> Expression:
        """Return an expression that is TRUE if the supervision keeps the step from being left."""
        if self._supervision is None:
            return FALSE
        if self.early:
            return self.value("VA")
        # checked behind the step change only: the transition evaluates the condition itself
        fault: Expression = resolve(self._supervision.value, CyclePhase.SWITCH)
        return fault

    def disturbed(self) -> Expression:
        """Return an expression that is TRUE if the active step has an error of its interlock or supervision."""
        interlock = conjunction([self._flag, negation(self.value("LS"))]) if self._interlock is not None else FALSE
        return disjunction([interlock, self.value("VA")])

    def cleared(self) -> list[Statement]:
        """Return the end of the events of the last cycle, for checks that read them before they happen again."""
        if not self._asked_between:
            return []
        return [assignment(self._variables[event], FALSE) for event in _EVENTS if event in self._variables]

    def before(self, resolve: Resolve, acknowledge: Expression) -> list[Statement]:
        """Return the checks of the active step before the step change."""
        if not self.early:
            return []
        return [when(self._flag, *self._evaluated(resolve, acknowledge))]

    def forgotten(self, left: Callable[[], Expression]) -> list[Statement]:
        """Return the end of what belongs to a step that is left."""
        if not self.early or not self._variables:
            return []
        kept = (variable for name, variable in self._variables.items() if name != "fault")  # written before it is read
        return [when(left(), *(assignment(variable, FALSE) for variable in kept))]

    def behind(self, resolve: Resolve, entered: Callable[[], Expression]) -> list[Statement]:
        """Return the checks behind the step change."""
        if not self._variables:
            return []
        if not self.early:
            return self._late(resolve)
        return [when(entered(), *self._first_evaluated(resolve))]

    def _evaluated(self, resolve: Resolve, acknowledge: Expression) -> list[Statement]:
        """Return the checks of an active step."""
        into: list[Statement] = []
        if self._interlock is not None and "LS" in self._variables:
            into += [resolve(each, CyclePhase.CHECK) for each in self._interlock.preparation]
            self._interlock_events(resolve(self._interlock.value, CyclePhase.CHECK), into)
        if self._supervision is not None:
            into += [resolve(each, CyclePhase.CHECK) for each in self._supervision.preparation]
            self._supervision_events(resolve(self._supervision.value, CyclePhase.CHECK), into)
            if self._remembers:
                self._remembered(acknowledge, into)
        return into

    def _first_evaluated(self, resolve: Resolve) -> list[Statement]:
        """Return the checks of a step just entered: what they remember is FALSE, so nothing can have ended."""
        into: list[Statement] = []
        for stated, result, follow in (
            (self._interlock, "LS", ("L1", "LA")),
            (self._supervision, "VS", ("V1", "VA")),
        ):
            if stated is None or result not in self._variables:
                continue
            value = self._variables[result]
            into += [resolve(each, CyclePhase.ENTERED) for each in stated.preparation]
            into.append(assignment(value, resolve(stated.value, CyclePhase.ENTERED)))
            self._assign(into, dict.fromkeys(follow, negation(value) if result == "LS" else value))
        return into

    def _late(self, resolve: Resolve) -> list[Statement]:
        into: list[Statement] = []
        for stated, result, events in (
            (self._interlock, "LS", self._interlock_events),
            (self._supervision, "VS", self._supervision_events),
        ):
            if stated is not None and result in self._variables:
                events(conjunction([self._flag, resolve(stated.value, CyclePhase.ACT)]), into)
        return into

    def _assign(self, into: list[Statement], values: Mapping[str, Expression]) -> None:
        """Append the assignments of the results that code asks for."""
        into += [assignment(self._variables[name], value) for name, value in values.items() if name in self._variables]

    def _interlock_events(self, satisfied: Expression, into: list[Statement]) -> None:
        ls, la = (self._variables.get(name, FALSE) for name in ("LS", "LA"))
        guard = [] if self.early else [self._flag]
        gone = {"L1": conjunction([*guard, negation(ls), negation(la)]), "L0": conjunction([ls, la])}
        self._assign(into, {"LS": satisfied, **gone, "LA": conjunction([*guard, negation(ls)])})

    def _supervision_events(self, fault: Expression, into: list[Statement]) -> None:
        vs, now = self._variables["VS"], self._variables.get("fault")
        if now is None:
            into.append(assignment(vs, fault))
            return
        guard = [] if self.early else [self._flag]
        gone = conjunction([*guard, vs, negation(now)])
        # the events compare the new value with the one of the last cycle
        self._assign(into, {"fault": fault, "V1": conjunction([now, negation(vs)]), "V0": gone, "VS": now})

    def _remembered(self, acknowledge: Expression, into: list[Statement]) -> None:
        """Append the memory of an error, which stays until it is gone and acknowledged: then both are forgotten."""
        v = self._variables
        known, event = v["acknowledged"], conjunction([acknowledge, v["VA"]])
        self._assign(into, {"VA": disjunction([v["VS"], v["VA"]]), "A1": conjunction([event, negation(known)])})
        if not is_constant(acknowledge, FALSE):
            into.append(when(v.get("A1", event), assignment(known, TRUE)))
        must = [known] if self._must_acknowledge else []
        ended = [assignment(each, FALSE) for each in (v["VA"], known)]
        into.append(when(conjunction([negation(v["VS"]), *must]), *ended))


_EVENTS = ("L1", "L0", "V1", "V0", "A1")
_ORDER = ("LS", "L1", "L0", "LA", "fault", "V1", "V0", "VS", "VA", "A1", "acknowledged")


def _called(name: str, step: str, texts: Texts) -> str:
    """Return the name of a variable of a step: that of S7-GRAPH, else a word."""
    return texts.with_suffix(step, name) if name in SUFFIXES else f"{step}_{name}"


_NONE = n.Literal("T#0ms")


class StepClock:
    """Times of the steps of one sequencer."""

    def __init__(
        self, source: GraphSource, code: LoweredCode, signs: Sequence[StepNames], questions: AskedStepData
    ) -> None:
        texts = code.texts
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
        """Return True if anything could disturb a step; where nothing does, its times T and U are the same."""
        return step in self._source.interlocks or step in self._source.supervisions

    def _limit(self, step: int, asked: set[str], durations: Sequence[Expression]) -> Expression:
        """Return the time that the timer of a step measures: one that is beyond all that it is compared with."""
        first = durations[0] if durations else None
        # a TON whose PT changes while it runs is another one in every controller
        if not asked and isinstance(first, n.Literal) and all(duration == first for duration in durations):
            return first
        times = [_nanoseconds(duration) for duration in durations]
        times += [_nanoseconds(constant) for constant in self._questions.compared(step, asked)]
        if "U" in asked and self._is_checked(step):
            return FOREVER
        known = [time for time in times if time is not None]
        # ET stops at PT: twice the longest comparison never stops early
        return n.Literal(time_literal(2 * max(known))) if len(known) == len(times) and max(known) > 0 else FOREVER

    def _elapsed(self, step: int) -> Expression:
        return n.Member(self._timers[step], n.Name("ET"))

    def value(self, step: int, quantity: str) -> Expression:
        """Return the time T of a step, or its time without disturbance U."""
        if quantity == "U" and step in self._undisturbed:
            return self._undisturbed[step][0]
        return self._kept.get(step, self._elapsed(step))

    def over(self, step: int, time: Expression) -> Expression:
        """Return an expression that is TRUE if an active step has been so for `time`."""
        if self._limits[step] == time and isinstance(time, n.Literal):
            return n.Member(self._timers[step], n.Name("Q"))
        return n.Operation(Operator.GREATER_OR_EQUAL, (self._elapsed(step), time))

    def calls(self, *, ahead: bool) -> list[Statement]:
        """Return the calls of the timers; `ahead` of the step change only of those that are read there."""
        steps = [i for i in self._timers if not ahead or self._is_read_ahead(i)]
        active = {i: self._signs[i].active for i in steps}
        calls = [call(self._timers[i], IN=active[i], PT=self._limits[i]) for i in steps]
        kept = (when(active[i], assignment(self._kept[i], self._elapsed(i))) for i in steps if i in self._kept)
        return [*calls, *kept]

    def _is_read_ahead(self, step: int) -> bool:
        """Return True if checks or conditions ask for a time of a step; actions do so behind the step change."""
        asked = self._questions.asked(step, {"T", "U"}, CyclePhase.CHECK, CyclePhase.SWITCH)
        # a time that is kept still grows in the cycle in which its step is left
        return asked or step in self._undisturbed or step in self._kept

    def counted(self, checks: Sequence[SupervisionChecks]) -> list[Statement]:
        """Return the times without disturbance, behind the checks of the active steps."""
        found: list[Statement] = []
        for step, (sum_, old) in self._undisturbed.items():
            elapsed = self._elapsed(step)
            # U grows by the time since the last cycle while the step is undisturbed
            passed = n.Operation(Operator.SUBTRACT, (elapsed, old))
            more = assignment(sum_, n.Operation(Operator.ADD, (sum_, n.Parenthesized(passed))))
            calm = conjunction([self._signs[step].active, negation(checks[step].disturbed())])
            found += [when(calm, more), assignment(old, elapsed)]
        return found

    def restarted(self, entered: StepValue) -> list[Statement]:
        """Return the restarts of the times without disturbance of steps that were entered."""
        return [
            when(entered(step), assignment(sum_, _NONE), assignment(old, _NONE))
            for step, (sum_, old) in self._undisturbed.items()
        ]


def _nanoseconds(time: Expression | None) -> int | None:
    """Return a duration that is a constant."""
    if not isinstance(time, n.Literal):
        return None
    try:
        found = literal_value(time.text)
    except LiteralError:
        return None
    return found.value if found.kind is LiteralKind.DURATION and isinstance(found.value, int) else None
