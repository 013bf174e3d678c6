"""The marking graph of a chart: every situation that it can come into, whatever its conditions are.

Conditions are free: any enabled transition may fire or not. What is found to be impossible is impossible for the chart;
what is found to be possible may still be excluded by conditions.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, reduce
from operator import or_

from plcopen_sfc.analysis.answers import Answer
from plcopen_sfc.analysis.exploring import Explored, explore_in_sets, explore_one_by_one
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.semantics.net import Competing, Net, NetStep, NetTransition, indexes

DEFAULT_CAP = 100_000
"""How many markings are visited unless the caller says otherwise: a second or so, and some 20 MB."""


@dataclass(frozen=True)
class Firing:
    """One evolution in a trace: the transitions that fire together, and the marking after it."""

    transitions: tuple[NetTransition, ...]
    marking: int


@dataclass(frozen=True)
class Unsafe:
    """How a step would get a second token: `trace` leads to `marking`, where `transition` enters the active `step`."""

    step: NetStep
    transition: NetTransition
    marking: int
    trace: tuple[Firing, ...]


class MarkingGraph:
    """All markings that can be reached from the initial one. See `marking_graph`.

    Answers are exact where `complete`. Where the cap was hit, what was found stands (a deadlock is a deadlock), and
    whatever would need the rest is `Answer.UNKNOWN` or None.

    As long as no step can get a second token, transitions that fire in one scan can as well fire one after the other,
    and the search does so. Otherwise, and where competing transitions fire together, it tries all sets of transitions
    that can fire in one scan, and a step that is entered while it is active stays active.
    """

    def __init__(self, net: Net, *, competing: Competing = Competing.PRIORITY, cap: int = DEFAULT_CAP) -> None:
        self.net = net
        self.competing = competing
        self.cap = cap

    @cached_property
    def _explored(self) -> Explored:
        found = self._first_search
        if found.unsafe is not None and self.competing is not Competing.ALL:
            return explore_in_sets(self.net, self.competing, self.cap)
        return found

    @cached_property
    def _first_search(self) -> Explored:
        """Explore by single firings, which shows whether the net is safe unless competing transitions fire together."""
        if self.competing is Competing.ALL:
            return explore_in_sets(self.net, self.competing, self.cap)
        return explore_one_by_one(self.net, self.cap)

    @property
    def complete(self) -> bool:
        """Whether every reachable marking was visited."""
        return self._explored.complete

    def __len__(self) -> int:
        """The number of markings that were visited."""
        return len(self._explored.seen)

    def __iter__(self) -> Iterator[int]:
        """The markings, those that need fewer evolutions first."""
        for level in self._explored.levels:
            yield from level

    def __contains__(self, marking: object) -> bool:
        return marking in self._explored.seen

    @property
    def safe(self) -> Answer:
        """Whether no step can ever be entered while it stays active (1-safeness; IEC 61131-3 "unsafe" sequence)."""
        if self._first_search.unsafe is not None:
            return Answer.NO
        return Answer.YES if self._first_search.complete else Answer.UNKNOWN

    @cached_property
    def unsafe(self) -> Unsafe | None:
        """The shortest way to a second token on a step; None where none was found."""
        found = self._first_search.unsafe
        if found is None:
            return None
        marking, index = found
        transition = self.net.transitions[index]
        step = next(indexes(marking & ~transition.pre & transition.post))
        return Unsafe(self.net.steps[step], transition, marking, self._way(self._first_search, marking))

    @cached_property
    def dead_transitions(self) -> tuple[NetTransition, ...] | None:
        """The transitions that can never be enabled; None: unknown."""
        dead = tuple(t for t in self.net.transitions if not self._explored.enabled & t.bit)
        return dead if self.complete or not dead else None

    @cached_property
    def unreachable_steps(self) -> tuple[NetStep, ...] | None:
        """The steps that can never be active; None: unknown."""
        active = reduce(or_, self._explored.seen, 0)
        never = tuple(step for step in self.net.steps if not active & step.bit)
        return never if self.complete or not never else None

    @cached_property
    def deadlocks(self) -> tuple[int, ...]:
        """The markings that were found in which no transition is enabled. The empty marking counts."""
        return tuple(self._explored.blocked())

    @property
    def deadlock_free(self) -> Answer:
        """Whether some transition is enabled in every marking."""
        if self.deadlocks:
            return Answer.NO
        return Answer.YES if self.complete else Answer.UNKNOWN

    @cached_property
    def way_home(self) -> Answer:
        """Whether the initial marking can be reached again from every marking."""
        if not self.complete:
            return Answer.NO if self.deadlocks and self.deadlocks != (self.net.initial,) else Answer.UNKNOWN
        return Answer.YES if self.stranded is None else Answer.NO

    @cached_property
    def stranded(self) -> int | None:
        """A marking from which there is no way to the initial one, as close to it as can be; None: none is known."""
        if not self.complete:
            return None
        home = self._explored.before({self.net.initial})
        return next((m for m in self if m not in home), None)

    @cached_property
    def live(self) -> Answer:
        """Whether every transition can become enabled again, whatever happened, and no step is unreachable."""
        if (self.deadlocks and self.net.transitions) or self.dead_transitions or self.unreachable_steps:
            return Answer.NO
        if not self.complete:
            return Answer.UNKNOWN
        return Answer.YES if self.way_home or all(map(self._stays_alive, self.net.transitions)) else Answer.NO

    def _stays_alive(self, transition: NetTransition) -> bool:
        enabling = {m for m in self if not transition.pre & ~m}
        return len(self._explored.before(enabling)) == len(self)

    @cached_property
    def concurrency(self) -> tuple[int, ...] | None:
        """For each step the steps (bits) that can be active together with it; None: unknown."""
        if not self.complete:
            return None
        together = [0] * len(self.net.steps)
        for marking in self._explored.seen:
            rest = marking
            while rest:
                lowest = rest & -rest
                together[lowest.bit_length() - 1] |= marking
                rest ^= lowest
        return tuple(beside & ~(1 << index) for index, beside in enumerate(together))

    def concurrent(self, a: NetStep, b: NetStep) -> Answer:
        """Whether two steps can be active at the same time."""
        if self.concurrency is not None:
            return Answer.YES if self.concurrency[a.index] & b.bit else Answer.NO
        both = a.bit | b.bit
        return Answer.YES if a is not b and any(m & both == both for m in self) else Answer.UNKNOWN

    def trace(self, marking: int) -> tuple[Firing, ...]:
        """A shortest way from the initial marking to this one. `KeyError` where it was not reached."""
        if marking not in self._explored.seen:
            raise KeyError(marking)
        return self._way(self._explored, marking)

    def _way(self, explored: Explored, marking: int) -> tuple[Firing, ...]:
        return tuple(
            Firing(tuple(self.net.transitions[i] for i in indexes(fired)), after)
            for fired, after in explored.way_to(marking)
        )


def marking_graph(
    chart: SfcNetwork | Net, *, competing: Competing = Competing.PRIORITY, cap: int = DEFAULT_CAP
) -> MarkingGraph:
    """The marking graph of a chart, visited when it is first asked; at most about `cap` markings.

    With `Competing.ALL`, transitions that share a source may fire together; with the others at most one of them does.
    Rules beyond the net (`Net.hierarchy`: forcing orders, enclosing steps) are not obeyed.
    """
    net = chart if isinstance(chart, Net) else Net.of(chart)
    return MarkingGraph(net, competing=competing, cap=cap)
