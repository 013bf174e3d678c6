"""Charts that rule others (IEC 60848:2013, 7.1 and 7.3), as code: forcing orders and enclosing steps."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TypeAlias

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.code.logic import FALSE, TRUE, assignment, conjunction, disjunction, negation
from plcopen_sfc.lowering.code.program import StepValue
from plcopen_sfc.semantics.charts.grafcet.hierarchy import RuledChart
from plcopen_sfc.semantics.net import indexes

Situation: TypeAlias = Mapping[int, "Expression | None"]
"""For each step of a chart whether it is active; None: as it was before the evolution."""


class Ruling:
    """What rules one chart. `active` tells whether a step is active, `before` whether it was before the evolution.

    `entered` tells whether a transition has activated a step that may have been active before.
    """

    def __init__(self, chart: RuledChart, active: StepValue, before: StepValue, entered: StepValue) -> None:
        self._chart = chart
        self._active, self._before, self._entered = active, before, entered
        self.steps = tuple(indexes(chart.steps))

    def forced(self) -> Expression:
        """Whether an order holds the chart."""
        return disjunction(self._active(i) for order in self._chart.orders for i in indexes(order.steps))

    def situations(self) -> Iterator[tuple[Expression, Situation]]:
        """What the chart becomes and when; the first that is TRUE counts."""
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
        links = {i: disjunction(when for bits, when in opened if bits >> i & 1) for i in self.steps}
        if len(opened) == 1:
            links = {i: FALSE if value == FALSE else TRUE for i, value in links.items()}
        yield disjunction(when for _, when in opened), links
        enclosing = [i for each in self._chart.enclosures for i in indexes(each.steps)]
        yield conjunction(negation(self._active(i)) for i in enclosing), dict.fromkeys(self.steps, FALSE)


def imposed(ruling: Ruling, flags: Sequence[Expression], before: StepValue) -> Statement:
    """The assignment of the situation that a chart is ruled into, if it is."""
    branches = [
        n.Branch(when, tuple(assignment(flags[i], before(i) if value is None else value) for i, value in steps.items()))
        for when, steps in ruling.situations()
    ]
    return n.If(tuple(branches))
