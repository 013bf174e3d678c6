"""Charts that rule others: forcing orders and enclosing steps (IEC 60848:2013, 7.1 and 7.3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import reduce
from operator import or_

from plcopen_sfc.errors import ForcingConflictError, Location, UnknownBehaviourError
from plcopen_sfc.model import ActionAssociation, ForcedSituation, PartialChart, SfcNetwork
from plcopen_sfc.semantics.net import Net


@dataclass(frozen=True, slots=True)
class ForcedCharts:
    """While one of `steps` is active, the chart is in the situation `imposed`; None: it stays as it is."""

    path: str
    steps: int
    imposed: int | None


@dataclass(frozen=True, slots=True)
class EnclosingStep:
    """While the step `steps` is active the chart may have active steps; `links` become active with it."""

    steps: int
    links: int


@dataclass(slots=True)
class RuledChart:
    """A chart that others rule: its steps, the orders on it, and the steps that enclose it."""

    name: str
    steps: int
    orders: list[ForcedCharts] = field(default_factory=list)
    enclosures: list[EnclosingStep] = field(default_factory=list)
    masters: set[str] = field(default_factory=set)


class Hierarchy:
    """Forcing orders and enclosures of a chart, applied from the top down in the evolution that activates them."""

    def __init__(self, net: Net, path: str) -> None:
        self._net = net
        self._path = path
        self._charts: dict[str, RuledChart] = {}
        self._partials = {p.name.casefold(): p for p in net.chart.partial_charts}
        for owner, model in net.owned():
            if model.forcing is not None:
                ruled = self._subordinate(model.forcing.chart, owner.path)
                ruled.orders.append(ForcedCharts(owner.path, owner.steps, self._imposed(model, owner.path)))
                ruled.masters |= self._owners(owner.steps)
        for step in net.steps:
            for enclosure in step.step.encloses or ():
                ruled = self._subordinate(enclosure.chart, step.path)
                links = self._named(self._partials[enclosure.chart.casefold()], enclosure.activated_steps, step.path)
                ruled.enclosures.append(EnclosingStep(step.bit, links))
                ruled.masters |= self._owners(step.bit)
        self._ordered = self._from_the_top()

    @property
    def charts(self) -> tuple[RuledChart, ...]:
        """The charts that others rule, each behind those that rule it."""
        return self._ordered

    def __bool__(self) -> bool:
        return bool(self._ordered)

    def _subordinate(self, name: str, where: str) -> RuledChart:
        partial = self._partials.get(name.casefold())
        if partial is None:
            raise UnknownBehaviourError(f"there is no partial chart {name}", location=self._place(where))
        found = self._charts.get(name.casefold())
        if found is None:
            found = self._charts[name.casefold()] = RuledChart(partial.name, self._net.steps_of(partial.chart))
        return found

    def _owners(self, steps: int) -> set[str]:
        return {name for name, partial in self._partials.items() if self._net.steps_of(partial.chart) & steps}

    def _imposed(self, model: ActionAssociation, where: str) -> int | None:
        order = model.forcing
        assert order is not None  # noqa: S101  # the caller has looked
        partial = self._partials[order.chart.casefold()]
        match order.situation:
            case ForcedSituation.CURRENT:
                return None
            case ForcedSituation.EMPTY:
                return 0
            case ForcedSituation.INITIAL:
                return self._initial(partial.chart)
            case ForcedSituation.EXPLICIT:
                return self._named(partial, order.steps, where)

    def _initial(self, chart: SfcNetwork) -> int:
        steps = reduce(or_, (step.bit for step in self._net.steps if step.chart is chart and step.step.initial), 0)
        macros = (macro for macro in self._net.macros if macro.chart is chart and macro.step.initial)
        return reduce(or_, (1 << macro.entry for macro in macros if macro.entry is not None), steps)

    def _named(self, partial: PartialChart, names: Sequence[str], where: str) -> int:
        bits = 0
        for name in names:
            found = [
                step.bit
                for step in self._net.steps
                if step.chart is partial.chart and name.casefold() in (step.step.name.casefold(), str(step.step.number))
            ]
            found += [
                1 << macro.entry
                for macro in self._net.macros
                if macro.chart is partial.chart
                and macro.step.name.casefold() == name.casefold()
                and macro.entry is not None
            ]
            if not found:
                raise UnknownBehaviourError(f"{partial.name} has no step {name}", location=self._place(where))
            bits |= found[0]
        return bits

    def _from_the_top(self) -> tuple[RuledChart, ...]:
        ordered: list[RuledChart] = []
        waiting = dict(self._charts)
        while waiting:
            free = [name for name, chart in waiting.items() if not chart.masters & (waiting.keys() - {name})]
            if not free or any(name in waiting[name].masters for name in free):
                circle = ", ".join(chart.name for chart in waiting.values())
                raise UnknownBehaviourError(
                    f"the partial charts {circle} rule each other: their hierarchy has no top",
                    location=Location(path=self._path),
                )
            ordered += [waiting.pop(name) for name in free]
        return tuple(ordered)

    def _place(self, where: str) -> Location:
        return Location(path=f"{self._path} / step {where}")

    def apply(self, before: int, situation: int) -> int:
        """Return the situation after an evolution, as the charts above want it.

        An enclosing step that is left and entered at once stays active (60848 rule 5), and what it encloses goes on.
        """
        for chart in self._ordered:
            own = situation & chart.steps
            order = self._order(chart, situation)
            if order is not None:
                own = before & chart.steps if order.imposed is None else order.imposed
            elif chart.enclosures:
                opened = [e for e in chart.enclosures if situation & e.steps & ~before]
                if opened:
                    own = reduce(or_, (enclosure.links for enclosure in opened))
                elif not any(situation & e.steps for e in chart.enclosures):
                    own = 0
            situation = situation & ~chart.steps | own
        return situation

    def start(self, situation: int) -> int:
        """Return the first situation: orders of initial steps act at once, also on what the forced steps enclose."""
        alone = situation
        for chart in self._ordered:
            order = self._order(chart, situation)
            if order is not None:
                own = situation & chart.steps if order.imposed is None else order.imposed
            elif chart.enclosures and not any(situation & alone & e.steps for e in chart.enclosures):
                # the net starts an enclosed chart by the steps that are initial in their own charts
                own = reduce(or_, (e.links for e in chart.enclosures if situation & e.steps), 0)
            else:
                continue
            situation = situation & ~chart.steps | own
        return situation

    def held(self, situation: int) -> int:
        """Return the steps of charts that are forced: no transition of them is cleared."""
        forced = (chart.steps for chart in self._ordered if self._order(chart, situation) is not None)
        return reduce(or_, forced, 0)

    def _order(self, chart: RuledChart, situation: int) -> ForcedCharts | None:
        acting = [order for order in chart.orders if situation & order.steps]
        if not acting:
            return None
        if any(order.imposed != acting[0].imposed for order in acting):
            raise ForcingConflictError(
                f"the steps {', '.join(order.path for order in acting)} force {chart.name} into different situations",
                location=self._place(acting[-1].path),
            )
        return acting[0]
