"""Situations of a GRAFCET under its forcing orders and enclosing steps, whatever its conditions are if not told.

In the marking graph every chart evolves by itself: a step that an order keeps inactive is active beside the order, and
one that only an order activates never is (IEC 60848:2013, 7.1 and 7.3).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import reduce
from operator import or_
from typing import TypeAlias

from plcopen_sfc.errors import ForcingConflictError, UnknownBehaviourError
from plcopen_sfc.semantics.charts.grafcet.partial_charts import Hierarchy
from plcopen_sfc.semantics.net import Net, NetStep, NetTransition

Firings: TypeAlias = Callable[[Sequence[NetTransition], int, int], Iterator[tuple[NetTransition, ...]]]
"""The sets of enabled transitions that may fire together in a situation of some steps: all that it tells of."""


def _one_by_one(enabled: Sequence[NetTransition], _: int, __: int) -> Iterator[tuple[NetTransition, ...]]:
    return ((each,) for each in enabled)


class RuledSituations:
    """The situations that are found with at most `cap` of them, one transition after the other if not told.

    `complete`: there are no others. It is False for a chart whose hierarchy has no meaning too. `part`: the steps that
    are looked at: all, or those of the charts `around` steps (bits), of charts that rule these, and of charts that
    their transitions ask for: `asked` has the steps whose flags each transition reads.
    """

    def __init__(
        self, net: Net, cap: int, *, around: int = -1, asked: Sequence[int] = (), firings: Firings = _one_by_one
    ) -> None:
        self._seen: set[int] = set()
        self.part = around
        self.complete = False
        try:
            self._hierarchy = Hierarchy(net, "")
        except UnknownBehaviourError:
            return
        try:
            first = self._hierarchy.start(net.initial)
        except ForcingConflictError:
            first = net.initial  # the orders of initial steps contradict each other
        self.part = self._ruling(net, around, asked)
        self._explore(net, first & self.part, cap, firings)

    def _ruling(self, net: Net, part: int, asked: Sequence[int]) -> int:
        """Return steps with all that decides if they are active."""
        ends = [each.pre | each.post for each in net.transitions]
        joined = [*zip(ends, ends, strict=True), *zip(ends, asked, strict=False)]
        for chart in self._hierarchy.charts:
            rulers = [each.steps for each in chart.orders] + [each.steps for each in chart.enclosures]
            joined.append((chart.steps, reduce(or_, rulers, chart.steps)))
        while found := reduce(or_, (beside for steps, beside in joined if steps & part), part) & ~part:
            part |= found
        return part

    def _explore(self, net: Net, first: int, cap: int, firings: Firings) -> None:
        inside = [each for each in net.transitions if not (each.pre | each.post) & ~self.part]
        waiting = [first]
        self._seen.add(first)
        while waiting:
            if len(self._seen) > cap:
                return
            before = waiting.pop()
            try:
                held = self._hierarchy.held(before)
            except ForcingConflictError:
                continue
            enabled = [each for each in inside if not (each.pre & ~before or (each.pre | each.post) & held)]
            for fired in firings(enabled, before, self.part):
                after = self._following(before, fired) & self.part
                if after not in self._seen:
                    self._seen.add(after)
                    waiting.append(after)
        self.complete = True

    def after(self, before: int, *fired: NetTransition) -> int | None:
        """Return the situation after transitions fire together; None where they cannot.

        Where orders contradict each other it is the one before they act.
        """
        try:
            held = self._hierarchy.held(before)
        except ForcingConflictError:
            return None
        if any(each.pre & ~before or (each.pre | each.post) & held for each in fired):
            return None
        return self._following(before, fired)

    def _following(self, before: int, fired: Sequence[NetTransition]) -> int:
        sources = reduce(or_, (each.pre for each in fired), 0)
        situation = before & ~sources | reduce(or_, (each.post for each in fired), 0)
        try:
            return self._hierarchy.apply(before, situation)
        except ForcingConflictError:
            return situation

    def __iter__(self) -> Iterator[int]:
        return iter(self._seen)

    def concurrent(self, a: NetStep, b: NetStep) -> bool:
        """Return True if two steps are active together in a situation that was found."""
        both = a.bit | b.bit
        return a is not b and any(situation & both == both for situation in self._seen)
