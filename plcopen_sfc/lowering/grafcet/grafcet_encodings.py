"""Encodings of a GRAFCET: a CASE or flip-flops, what an evolution changes in them, and orders of charts above."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TypeAlias

from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.code.boolean_logic import (
    FALSE,
    TRUE,
    assignment,
    conjunction,
    disjunction,
    is_constant,
    negation,
)
from plcopen_sfc.lowering.code.code_memory import Memory
from plcopen_sfc.lowering.code.lowered_code import LoweredCode, StepValue
from plcopen_sfc.lowering.encodings.case_encodings import CaseEncoding, one_step_at_a_time
from plcopen_sfc.lowering.encodings.step_flags import FlipFlopEncoding
from plcopen_sfc.lowering.grafcet.grafcet_evolutions import Concurrency
from plcopen_sfc.lowering.lowering_options import LoweringRules
from plcopen_sfc.lowering.reading.chart_source import ChartSource
from plcopen_sfc.lowering.schedule.scan_schedule import exclude
from plcopen_sfc.semantics.charts.grafcet.partial_charts import RuledChart
from plcopen_sfc.semantics.net import Competing, NetStep, indexes
from plcopen_sfc.semantics.profile import Profile


def no_case(source: ChartSource, profile: Profile) -> str:
    """Return why one CASE cannot hold a GRAFCET; empty if it can."""
    objection = one_step_at_a_time(source)
    if objection:
        return objection
    if source.grafcet is not None and source.grafcet.ruled:
        return "some of its charts force or enclose others"
    for transition in source.net.transitions:
        # the state would not change, so that nothing shows the evolution
        if set(transition.sources) & set(transition.targets):
            return f"transition {transition.path} leads back to its own step"
        for other in transition.competing if profile.competing is not Competing.PRIORITY else ():
            if not exclude(source.conditions[other], source.conditions[transition.index], source.dialect):
                first = source.net.transitions[other].path
                return f"the conditions of {first} and {transition.path} do not exclude each other"
    return ""


class GrafcetCase(CaseEncoding):
    """Encoding of a GRAFCET with one CASE. Raises `LoweringError` for what one CASE cannot hold."""

    def __init__(
        self,
        source: ChartSource,
        code: LoweredCode,
        memory: Memory,
        rules: LoweringRules,
        surroundings: Collection[str] = (),
    ) -> None:
        objection = no_case(source, rules.profile)
        if objection:
            raise LoweringError(
                f"one CASE cannot hold the chart: {objection}",
                location=Location(path=source.pou.name),
                hint="Step bits can.",
            )
        # conditions exclude each other: the order in which they are tried makes no difference
        tried = replace(rules, profile=replace(rules.profile, competing=Competing.PRIORITY))
        super().__init__(source, code, memory, tried, surroundings)


Situation: TypeAlias = Mapping[int, "Expression | None"]
"""For each step of a chart whether it is active; None: as it was before the evolution."""


class ForcingCode:
    """Code of the forcing orders and enclosing steps (IEC 60848:2013, 7.1 and 7.3) that act on one chart.

    `active`: a step is active, `before`: it was so before the evolution, `entered`: a transition has activated a step
    that may have been active before.
    """

    def __init__(self, chart: RuledChart, active: StepValue, before: StepValue, entered: StepValue) -> None:
        self._chart = chart
        self._active, self._before, self._entered = active, before, entered
        self.steps = tuple(indexes(chart.steps))

    def forced(self) -> Expression:
        """Return an expression that is TRUE if an order holds the chart."""
        return disjunction(self._active(i) for order in self._chart.orders for i in indexes(order.steps))

    def situations(self) -> Iterator[tuple[Expression, Situation]]:
        """Yield the situations imposed on the chart with their conditions; the first that is TRUE counts."""
        for order in self._chart.orders:
            acting = disjunction(self._active(i) for i in indexes(order.steps))
            if order.imposed is None:
                yield acting, dict.fromkeys(self.steps)
            else:
                yield acting, {i: TRUE if order.imposed >> i & 1 else FALSE for i in self.steps}
        if self._chart.enclosures:
            yield from self._enclosed()

    def _enclosed(self) -> Iterator[tuple[Expression, Situation]]:
        opened = [
            (
                enclosing.links,
                conjunction([self._active(i), disjunction([negation(self._before(i)), self._entered(i)])]),
            )
            for enclosing in self._chart.enclosures
            for i in indexes(enclosing.steps)
        ]
        # several enclosing steps may become active in one evolution: the chart starts in the steps of all of them
        links = {i: disjunction(when for bits, when in opened if bits >> i & 1) for i in self.steps}
        # the condition of the branch is the same: the values are constants
        if len(opened) == 1:
            links = {i: FALSE if value == FALSE else TRUE for i, value in links.items()}
        yield disjunction(when for _, when in opened), links
        enclosing = [i for each in self._chart.enclosures for i in indexes(each.steps)]
        yield conjunction(negation(self._active(i)) for i in enclosing), dict.fromkeys(self.steps, FALSE)


def forced_assignments(ruling: ForcingCode, flags: Sequence[Expression], before: StepValue) -> Statement:
    """Return the assignment of the situation that is imposed on a chart, if one is."""
    branches = [
        n.Branch(when, tuple(assignment(flags[i], before(i) if value is None else value) for i, value in steps.items()))
        for when, steps in ruling.situations()
    ]
    return n.If(tuple(branches))


class GrafcetFlipFlops(FlipFlopEncoding):
    """Encoding of a GRAFCET with reset-dominant flip-flops, although in GRAFCET activation dominates.

    `ruled` are the charts that others force or enclose, those above first. `first`: TRUE in the first evolution only,
    where a scan can have several of them.
    """

    ruled: Sequence[ForcingCode] = ()
    concurrency: Concurrency
    first: Expression | None = None

    def change_situation(self) -> None:
        """Append a network for each step, those of forced charts behind those of the charts above them."""
        below = {step: ruling for ruling in self.ruled for step in ruling.steps}
        for step in self.net.steps:
            if step.index not in below:
                self._add_ruled(step, None)
        for ruling in self.ruled:
            for index in ruling.steps:
                self._add_ruled(self.net.steps[index], ruling)

    def set_and_reset(self, step: int) -> tuple[list[Expression], list[Expression]]:
        """Return what sets and what resets the flip-flop of a step by transitions."""
        return self.steps.set_and_reset(step, self.concurrency.both_fire)

    def _add_ruled(self, step: NetStep, ruling: ForcingCode | None) -> None:
        set_, reset = self.set_and_reset(step.index)
        if ruling is not None:
            set_, reset = self._ruled(step.index, ruling, set_, reset)
        if self.net.initial & step.bit:
            set_.insert(0, self.first if self.first is not None else self.memory.starting())
        self._add_step(step, set_, reset)

    def _ruled(
        self, step: int, ruling: ForcingCode, set_: list[Expression], reset: list[Expression]
    ) -> tuple[list[Expression], list[Expression]]:
        """Return the inputs of a flip-flop with those of orders and enclosing steps; reset dominates."""
        earlier: list[Expression] = []
        sets: list[Expression] = []
        resets: list[Expression] = []
        locked: list[Expression] = []
        frozen: list[Expression] = []
        for when, situation in ruling.situations():
            # the first order counts, as in the interpreter; orders that contradict each other are a mistake of the
            # chart
            acting = conjunction([when, *(negation(each) for each in earlier)])
            earlier.append(when)
            value = situation[step]
            if value is None:
                frozen.append(acting)
            elif is_constant(value, FALSE):
                resets.append(acting)
            else:
                sets.append(conjunction([acting, value]))
                resets.append(conjunction([acting, negation(value)]))
                # the order sets the step although the transitions reset it
                locked.append(acting)
        free = [negation(each) for each in frozen]
        set_ = [conjunction([disjunction(set_), *free]), *sets]
        reset = [conjunction([disjunction(reset), *free, *(negation(each) for each in locked)]), *resets]
        return set_, reset
