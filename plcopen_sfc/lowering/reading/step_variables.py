"""Step variables in texts (``S3.X``, ``X3``, ``S3.T``): the flags and timers that replace them in lowered code."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Protocol, TypeVar

from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.binding import bind
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import transform, walk
from plcopen_sfc.languages.st.literals import LiteralError, LiteralKind, literal_value
from plcopen_sfc.languages.st.nodes import Expression, Node, Operator, Statement
from plcopen_sfc.lowering.code.boolean_logic import (
    FALSE,
    TRUE,
    assignment,
    call,
    conjunction,
    disjunction,
    negation,
    when,
)
from plcopen_sfc.lowering.code.lowered_code import TIME, LoweredCode, StepValue
from plcopen_sfc.lowering.reading.chart_source import ChartSource
from plcopen_sfc.model.body import LdBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.late import models_in
from plcopen_sfc.model.network import Contact
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.sfc import SfcBody, simple_steps
from plcopen_sfc.model.types import DerivedType
from plcopen_sfc.semantics.net import Net, indexes
from plcopen_sfc.semantics.profile import Profile, ScanOrder, StepVariables

_Node = TypeVar("_Node", bound=Node)
FOREVER = n.Literal("T#24d")
"""Longer than any step time: TIME of 32 bits ends at 24 days 20 hours."""


class TimedPart(Protocol):
    """Part of a chart in which one step is active at a time, and whose code tells when that is another one."""

    @property
    def time_name(self) -> str:
        """Name for the time of its active step."""

    def changed(self) -> Expression:
        """Return an expression that is TRUE in a scan in which its active step is another one than in the last."""


class StepTimers:
    """Timers of one chart. `active` gives the flag of a step by its index in the net, `part` the part that it is in.

    A step has a timer for each time that its output ``Q`` is asked for; one timer has no end, where the elapsed time
    itself is asked for. Several steps of a part, whose times are asked for while they are active, have one together.
    """

    def __init__(
        self,
        code: LoweredCode,
        active: StepValue,
        name: Callable[[int], str],
        part: Callable[[int], TimedPart | None] = lambda _: None,
    ) -> None:
        self._code, self._active, self._name, self._part = code, active, name, part
        self._timers: dict[int, dict[Expression, n.Name]] = {}
        self._kept: dict[int, n.Name] = {}
        self._shared: dict[n.Name, TimedPart] = {}
        self.read_ahead: Collection[int] = ()
        """The steps whose times conditions of transitions read."""

    def share(self, steps: Iterable[int]) -> None:
        """Give the steps of a part one timer, if there are several of it."""
        parts: dict[TimedPart, list[int]] = {}
        for step in sorted(steps):
            part = self._part(step)
            if part is not None:
                parts.setdefault(part, []).append(step)
        for part, these in parts.items():
            if len(these) > 1:
                timer = self._code.declare(part.time_name, DerivedType(name="TON"))
                self._shared[timer] = part
                self._timers |= {step: {FOREVER: timer} for step in these}

    def keep(self, step: int) -> None:
        """Keep the time of a step when it is left, until it is active again (IEC 61131-3 ed. 3, 6.7.2)."""
        self._timer(step, FOREVER)
        self._kept[step] = self._code.declare(f"{self._name(step)}_T", TIME, initial="T#0s")

    def elapsed(self, step: int) -> Expression:
        """Return the time for which a step has been active; of one that is not, zero, or what was kept."""
        timer = self._timer(step, FOREVER)
        return self._kept.get(step) or n.Member(timer, n.Name("ET"))

    def is_over(self, step: int, time: Expression) -> Expression:
        """Return an expression that is TRUE if a step has been active for `time`."""
        # the output of a TON stays TRUE when its PT grows
        if FOREVER in self._timers.get(step, {}) or not isinstance(time, n.Literal):
            return n.Operation(n.Operator.GREATER_OR_EQUAL, (self.elapsed(step), time))
        return n.Member(self._timer(step, time), n.Name("Q"))

    def is_over_together(self, step: int, time: Expression) -> n.Operation | None:
        """Return the same of a step that has one timer together with others; None for all others."""
        if self._timers.get(step, {}).get(FOREVER) not in self._shared:
            return None
        return n.Operation(n.Operator.GREATER_OR_EQUAL, (self.elapsed(step), time))

    def measures(self, step: int) -> bool:
        """Return True if anything asks for the time of a step."""
        return step in self._timers

    def _timer(self, step: int, limit: Expression) -> n.Name:
        timers = self._timers.setdefault(step, {})
        if limit not in timers:
            name = self._name(step)
            if timers and isinstance(limit, n.Literal) and limit != FOREVER:
                name = self._code.texts.delay_name([name], limit.text)
            timers[limit] = self._code.declare(name, DerivedType(name="TON"))
        return timers[limit]

    def calls(self, *, changed: bool = True, ahead: bool = False) -> list[Statement]:
        """Return the calls of all timers, for places where times are read. `changed`: steps may just have changed.

        `ahead` of the transitions: those that these read.
        """
        calls: list[Statement] = []
        # a time that is kept still grows in the scan in which its step is left
        needed = {*self.read_ahead, *self._kept} if ahead else self._timers
        called = {step: timers for step, timers in self._timers.items() if step in needed}
        for timer, part in self._shared.items():
            if not any(timer in timers.values() for timers in called.values()):
                continue
            # a TON measures from the scan in which its input rises, which is that of the change
            restart = [when(part.changed(), call(timer, IN=FALSE, PT=FOREVER))] if changed else []
            calls += [*restart, call(timer, IN=TRUE, PT=FOREVER)]
        for step, timers in called.items():
            active = self._active(step)
            own = [(limit, timer) for limit, timer in timers.items() if timer not in self._shared]
            calls += [call(timer, IN=active, PT=limit) for limit, timer in own]
            if step in self._kept:
                calls.append(when(active, assignment(self._kept[step], n.Member(timers[FOREVER], n.Name("ET")))))
        return calls

    def ends(self) -> list[Statement]:
        """Return the calls that set all timers back."""
        return list(dict.fromkeys(ended for step in self._timers for ended in self._ended(step)))

    def restarts(self, step: int, reentered: Expression) -> Sequence[Statement]:
        """Return the calls that restart the time of a step when it is left and entered at once."""
        return [when(reentered, ended) for ended in self._ended(step)]

    def _ended(self, step: int) -> list[Statement]:
        return [call(timer, IN=FALSE, PT=limit) for limit, timer in self._timers.get(step, {}).items()]


MayFire = Callable[[Expression, Expression], Expression]
"""Expression for when a transition may fire, of its condition and of what tells that minimum times have passed."""


def resolve_steps(
    source: ChartSource,
    active: StepValue,
    times: StepTimers,
    profile: Profile,
    may_fire: MayFire,
    *,
    timed: Collection[int] = (),
    shareable: Collection[int] = (),
) -> ChartSource:
    """Return the same chart with `active` and `times` in the place of step variables in its texts.

    Its conditions are those of `may_fire`. `timed` are other steps whose elapsed time is asked for while they are
    active; of those that are `shareable` it is only if they have a timer together with others. Raises `LoweringError`
    for all other data of steps: lowered code does not have them.
    """
    steps = _StepVariables(source, active, times.elapsed, profile)
    asked, outside = _timed_steps(source, steps.timed)
    for step in sorted(outside):
        times.keep(step)
    times.share({*asked, *timed, *shareable} - outside)
    ahead = [*source.conditions, *(each for statements in source.preparations for each in statements)]
    read = (steps.timed(node) for tree in ahead for node in walk(tree))
    times.read_ahead = {*source.minimum_times, *(step for step in read if step is not None)}
    # a step whose elapsed time is read has one timer for all
    for step in (*(watch.step for watch in source.watches), *timed):
        times.elapsed(step)
    resolved = source.changed(lambda tree: transform(steps.within_reach(tree), steps.resolved))
    waited: list[list[Expression]] = [[] for _ in source.net.transitions]
    for step, time in resolved.minimum_times.items():
        over = times.is_over(step, time)
        for transition in source.net.leaving[step]:
            waited[transition].append(over)
    conditions = [
        may_fire(condition, conjunction(over)) for condition, over in zip(resolved.conditions, waited, strict=True)
    ]
    return replace(resolved, conditions=tuple(conditions))


def _timed_steps(source: ChartSource, timed: Callable[[Node], int | None]) -> tuple[set[int], set[int]]:
    """Return the steps whose time is read, and those of which it is read while they are inactive too."""
    asked = {*source.minimum_times, *(watch.step for watch in source.watches)}
    found: set[int] = set()

    def ask(trees: Iterable[Node], while_active: Collection[int] = ()) -> None:
        steps = {step for tree in trees for node in walk(tree) if (step := timed(node)) is not None}
        asked.update(steps)
        found.update(steps.difference(while_active))

    for transition in source.net.transitions:
        ask((source.conditions[transition.index], *source.preparations[transition.index]), transition.sources)
    ask((*source.logic, *source.minimum_times.values()))
    for action in source.actions:
        ask(action.statements)
        for use in action.uses:
            ask([use.condition, *use.preparation], () if use.inverted or len(use.steps) > 1 else use.steps)
            ask([use.duration] if use.duration is not None else [])
    for code in source.step_code:
        ask((*code.entry, *code.main), [code.step])
        ask(code.exit)
    for watch in source.watches:
        ask([watch.time, *(reason.holds for reason in watch.reasons)], [watch.step])
    # all others are read while their step is active only, where ET is the same
    return asked, found


class _StepVariables:
    def __init__(self, source: ChartSource, active: StepValue, elapsed: StepValue, profile: Profile) -> None:
        self._active, self._elapsed = active, elapsed
        self._pou = source.pou.name
        # `_x` changes behind the transitions, where nothing asks for it but drawn logic in the next scan
        announced = profile.order is ScanOrder.ACTIONS_FIRST and not source.logic
        self._quantities = {"x", "_x"} if announced else {"x"}
        declared = {v.name.casefold() for v in source.pou.variables()}
        self._steps = {name: bits for name, (_, bits) in source.net.named().items() if name not in declared}
        self._flags: Mapping[str, int] = {}
        if profile.step_variables is StepVariables.FLAG:
            names = [step.name.casefold() for step in simple_steps([step.step for step in source.net.steps])]
            self._flags = {name: self._steps[name] for name in names if name in self._steps}
        if profile.step_variables is StepVariables.GRAFCET:
            self._flags = {
                name.casefold(): bits for name, bits in source.net.flags.items() if name.casefold() not in declared
            }

    def timed(self, node: Node) -> int | None:
        """Return the step whose time a node is; None for anything else."""
        match node:
            case n.Member(n.Name(step), n.Name(quantity)) if quantity.casefold() == "t":
                bits = self._steps.get(step.casefold(), 0)
                return indexes(bits)[0] if bits.bit_count() == 1 else None
        return None

    def within_reach(self, tree: _Node) -> _Node:
        """Return `tree`. Raises `LoweringError` where it compares the time of a step with one that no timer reaches."""
        for node in walk(tree):
            operands = node.operands if isinstance(node, n.Operation) else ()
            if any(self.timed(operand) is not None for operand in operands):
                for operand in operands:
                    if isinstance(operand, n.Literal) and _is_beyond(operand):
                        raise LoweringError(
                            f"a step time is compared with {operand.text}: timers of lowered code end at 24 days",
                            location=Location(path=self._pou),
                            hint="Count days in a variable of the program.",
                        )
        return tree

    def resolved(self, node: Node) -> Node:
        """Return the expression in the place of a node."""
        match node:
            case n.Member(n.Name(step), n.Name(quantity)) if (bits := self._steps.get(step.casefold())) is not None:
                if quantity.casefold() == "t" and bits.bit_count() == 1:
                    return self._elapsed(indexes(bits)[0])
                if quantity.casefold() not in self._quantities:
                    raise LoweringError(
                        f"{step}.{quantity} is not lowered yet: the code does not keep it",
                        location=Location(path=self._pou),
                        hint="Ask for X or T of the step.",
                    )
                return disjunction(self._active(i) for i in indexes(bits))
            case n.Name(name) if (bits := self._flags.get(name.casefold())) is not None:
                return disjunction(self._active(i) for i in indexes(bits))
            case n.Unary(Operator.NOT, n.Operation() as inner):  # NOT a AND b is never written so: it is NOT (a AND b)
                return negation(inner)
        return node


_LONGEST = 24 * 24 * 3600 * 10**9
"""Nanoseconds of `FOREVER`."""


def _is_beyond(literal: n.Literal) -> bool:
    try:
        value = literal_value(literal, Dialect.IEC)
        return value.kind is LiteralKind.DURATION and isinstance(value.value, int) and value.value > _LONGEST
    except LiteralError:
        return False


def asked_outside(pou: Pou, net: Net, dialect: Dialect) -> bool:
    """Return True if a body of the POU beside a chart may ask for data of its steps (``S3.X``)."""
    own = [step.step.name for step in net.steps]
    names = {name.casefold() for name in own}
    for _, _, body in pou.named_bodies():
        is_chart = isinstance(body, SfcBody) and [step.name for step in body.chart.steps] == own
        uses = () if is_chart else bind(body, dialect).uses
        if any(use.name.casefold() in names and use.access.casefold() in _QUANTITIES for use in uses):
            return True
    return False


_QUANTITIES = frozenset({"x", "_x", "t", "_t"})


def asked_by_contacts(pou: Pou, net: Net) -> frozenset[int]:
    """Return the steps that a contact in a body of the POU asks for: it can read a variable, but not compare."""
    by_name = {f"{step.step.name}.x".casefold(): step.index for step in net.steps}
    drawn = [node for _, _, body in pou.named_bodies() if isinstance(body, LdBody) for node in models_in(body)]
    names = {(node.variable or "").casefold() for node in drawn if isinstance(node, Contact)}
    return frozenset(step for name, step in by_name.items() if name in names)
