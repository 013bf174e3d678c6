"""Code of forcing orders and enclosing steps: the situations that charts above impose on a chart."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.languages.st.nodes import Expression
from plcopen_sfc.lowering.code.boolean_logic import FALSE, TRUE, conjunction, disjunction, negation
from plcopen_sfc.lowering.code.lowered_code import StepValue
from plcopen_sfc.lowering.encodings.step_flags import Imposed
from plcopen_sfc.semantics.charts.grafcet.partial_charts import RuledChart
from plcopen_sfc.semantics.net import indexes


class ForcingCode:
    """Code of the forcing orders and enclosing steps (IEC 60848:2013, 7.1 and 7.3) that act on one chart.

    `active`: a step is active, `before`: it was so before the evolution.
    """

    def __init__(self, chart: RuledChart, active: StepValue, before: StepValue) -> None:
        self._chart = chart
        self._active, self._before = active, before
        self.steps = tuple(indexes(chart.steps))

    def forced(self) -> Expression:
        """Return an expression that is TRUE if an order holds the chart."""
        return disjunction(self._active(i) for order in self._chart.orders for i in indexes(order.steps))

    def situations(self) -> Iterator[Imposed]:
        """Yield the situations imposed on the chart with their conditions; the first that is TRUE counts."""
        for order in self._chart.orders:
            acting = disjunction(self._active(i) for i in indexes(order.steps))
            if order.imposed is None:
                yield Imposed(acting, dict.fromkeys(self.steps))
            else:
                yield Imposed(acting, {i: TRUE if order.imposed >> i & 1 else FALSE for i in self.steps})
        if self._chart.enclosures:
            yield from self._enclosed()

    def _enclosed(self) -> Iterator[Imposed]:
        opened = [
            (
                enclosing.links,
                conjunction([self._active(i), negation(self._before(i))]),
            )
            for enclosing in self._chart.enclosures
            for i in indexes(enclosing.steps)
        ]
        # several enclosing steps may become active in one evolution: the chart starts in the steps of all of them
        links = {i: disjunction(when for bits, when in opened if bits >> i & 1) for i in self.steps}
        # the condition of the branch is the same: the values are constants
        if len(opened) == 1:
            links = {i: FALSE if value == FALSE else TRUE for i, value in links.items()}
        yield Imposed(disjunction(when for _, when in opened), links)
        enclosing = [i for each in self._chart.enclosures for i in indexes(each.steps)]
        yield Imposed(conjunction(negation(self._active(i)) for i in enclosing), dict.fromkeys(self.steps, FALSE))
