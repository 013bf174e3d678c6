"""The marking graph of a chart: every situation that it can come into, whatever its conditions are.

Conditions are free: any enabled transition may fire or not. Anything found impossible is impossible for the chart;
anything found possible may still be excluded by conditions.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property, reduce
from operator import or_

from plcopen_sfc.analysis.search_limits import Answer
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.semantics.net import Competing, Net, NetStep, NetTransition, indexes, mask

_FIRINGS_PER_MARKING = 32
"""Sets of transitions that are tried for each marking of the cap, on average, before the search gives up."""


class _ByStep:
    """Transitions by one of the steps that each of them needs.

    A long chart has few active steps at a time: to look at all of its transitions for each of its situations would take
    the square of its length.
    """

    def __init__(self, needs: Iterable[int]) -> None:
        self._always: list[int] = []
        self._of_step: dict[int, list[int]] = {}
        for index, need in enumerate(needs):
            if need:
                self._of_step.setdefault((need & -need).bit_length() - 1, []).append(index)
            else:
                self._always.append(index)

    def among(self, active: int) -> list[int]:
        """Indexes of the transitions that may be enabled where no other steps than `active` are, in their order."""
        found = [*self._always]
        for step in indexes(active):
            found += self._of_step.get(step, ())
        return sorted(found)


@dataclass
class ExploredMarkings:
    """Markings that a search found, by their distance from the initial one.

    `unsafe`: a marking and the transition that would enter an active step there. `enabled`: the transitions that are
    enabled in some marking. `came_from`, only where transitions fired in sets: for each marking all markings before it,
    each with the transitions that fired.
    """

    net: Net
    seen: set[int]
    levels: list[list[int]]
    complete: bool = True
    unsafe: tuple[int, int] | None = None
    enabled: int = 0
    came_from: dict[int, dict[int, int]] | None = None

    def before(self, markings: set[int]) -> set[int]:
        """Return all markings from which one of these can be reached, themselves included."""
        found = set(markings)
        frontier = found
        while frontier:
            frontier = self._all_before(frontier) - found
            found |= frontier
        return found

    def blocked(self) -> Iterator[int]:
        """Yield the markings in which nothing is enabled."""
        needs = [transition.pre for transition in self.net.transitions]
        leaving = _ByStep(needs)
        for level in self.levels:
            left = level
            for index in leaving.among(reduce(or_, level, 0)):
                pre = needs[index]
                left = [m for m in left if m & pre != pre]
                if not left:
                    break
            yield from left

    def way_to(self, marking: int) -> list[tuple[int, int]]:
        """Return a shortest way from the initial marking: what fires, and the marking after it."""
        way: list[tuple[int, int]] = []
        depth = next(i for i, level in enumerate(self.levels) if marking in level)
        for level in reversed(self.levels[:depth]):
            above = set(level)
            previous, fired = next((p, fired) for p, fired in self._previous(marking) if p in above)
            way.append((fired, marking))
            marking = previous
        return way[::-1]

    def _all_before(self, frontier: set[int]) -> set[int]:
        if self.came_from is not None:
            return {previous for marking in frontier for previous in self.came_from[marking]}
        found: set[int] = set()
        for index in self._entering.among(reduce(or_, frontier)):
            pre, left, post, touched = self._backwards[index]
            found.update([m & left | pre for m in frontier if m & touched == post])
        return found & self.seen

    @cached_property
    def _backwards(self) -> list[tuple[int, int, int, int]]:
        return [(t.pre, ~t.post, t.post, t.pre | t.post) for t in self.net.transitions]

    @cached_property
    def _entering(self) -> _ByStep:
        return _ByStep(transition.post for transition in self.net.transitions)

    def _previous(self, marking: int) -> Iterator[tuple[int, int]]:
        if self.came_from is not None:
            yield from self.came_from[marking].items()
            return
        # in a safe net a transition that led to a marking tells what was there before it
        for index in self._entering.among(marking):
            transition = self.net.transitions[index]
            pre, post = transition.pre, transition.post
            if not post & ~marking and not marking & pre & ~post:
                previous = marking & ~post | pre
                if previous in self.seen:
                    yield previous, transition.bit


def explore_one_by_one(net: Net, cap: int) -> ExploredMarkings:
    """Fire one transition at a time, until more than `cap` markings were seen, or one enters an active step."""
    moves = [(t.pre, ~t.pre, t.post, t.post & ~t.pre) for t in net.transitions]
    leaving = _ByStep(transition.pre for transition in net.transitions)
    seen = {net.initial}
    levels = [[net.initial]]
    found = ExploredMarkings(net, seen, levels)
    while levels[-1]:
        frontier = levels[-1]
        active = reduce(or_, frontier)
        fresh: set[int] = set()
        for index in leaving.among(active):
            pre, kept, post, gained = moves[index]
            enabled = [m for m in frontier if m & pre == pre]
            if not enabled:
                continue
            found.enabled |= 1 << index
            if active & gained and reduce(or_, enabled) & gained:
                found.unsafe = (next(m for m in enabled if m & gained), index)
                return found
            fresh.update([m & kept | post for m in enabled])
        fresh -= seen
        seen |= fresh
        levels.append(list(fresh))
        if len(seen) > cap:
            found.complete = False
            return found
    levels.pop()
    return found


def explore_in_sets(
    net: Net, competing: Competing, cap: int, starts: Collection[int] = (), within: int = -1
) -> ExploredMarkings:
    """Fire every set of transitions that can fire in one scan, until more than `cap` markings were seen.

    `starts`: markings with which it begins, instead of the initial one. `within`: the steps (bits) of a part of the
    chart that no transition connects with others; those of the others are left out.
    """
    came_from: dict[int, dict[int, int]] = {start: {} for start in starts or (net.initial,)}
    levels = [[*came_from]]
    found = ExploredMarkings(net, set(came_from), levels, came_from=came_from)
    budget = _FIRINGS_PER_MARKING * cap
    while levels[-1]:
        fresh: list[int] = []
        for marking in levels[-1]:
            enabled = net.enabled(marking)
            if within != -1:
                enabled = tuple(i for i in enabled if (net.transitions[i].pre | net.transitions[i].post) & within)
            found.enabled |= mask(enabled)
            if found.unsafe is None:
                enters = [i for i in enabled if marking & ~net.transitions[i].pre & net.transitions[i].post]
                found.unsafe = (marking, enters[0]) if enters else None
            for after, fired in _sets(net, competing, marking, enabled):
                budget -= 1
                if after not in came_from:
                    came_from[after] = {}
                    fresh.append(after)
                came_from[after].setdefault(marking, fired)
                if budget < 0 or len(came_from) > cap:
                    found.complete = False
                    break
            if not found.complete:
                break
        levels.append(fresh)
        if not found.complete:
            break
    if not levels[-1]:
        levels.pop()
    found.seen = set(came_from)
    return found


def _sets(net: Net, competing: Competing, marking: int, enabled: tuple[int, ...]) -> Iterator[tuple[int, int]]:
    """Yield the markings after each set of enabled transitions that can fire together, with the set."""
    # Each enabled transition fires or not, as its condition may be TRUE or FALSE. Two that need one token exclude each
    # other, but by rule 4 of IEC 60848.
    waiting = [(0, 0, 0, 0)]
    while waiting:
        position, fired, cleared, entered = waiting.pop()
        if position == len(enabled):
            if fired:
                yield marking & ~cleared | entered, fired
            continue
        transition = net.transitions[enabled[position]]
        waiting.append((position + 1, fired, cleared, entered))
        if competing is Competing.ALL or not transition.pre & cleared:
            waiting.append((position + 1, fired | transition.bit, cleared | transition.pre, entered | transition.post))


DEFAULT_CAP = 100_000
"""Number of markings that are visited unless the caller wants another: a second or so, and some 20 MB."""


@dataclass(frozen=True)
class Firing:
    """One evolution in a trace: the transitions that fire together, and the marking after it."""

    transitions: tuple[NetTransition, ...]
    marking: int


@dataclass(frozen=True)
class Unsafe:
    """Run that gives a step a second token: `trace` leads to `marking`, where `transition` enters the active `step`."""

    step: NetStep
    transition: NetTransition
    marking: int
    trace: tuple[Firing, ...]


class MarkingGraph:
    """All markings that can be reached from the initial one. See `marking_graph`.

    Answers are exact where `complete`. Where the cap was hit, what was found is true (a deadlock is a deadlock), and
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
    def _explored(self) -> ExploredMarkings:
        found = self._first_search
        if found.unsafe is not None and self.competing is not Competing.ALL:
            return explore_in_sets(self.net, self.competing, self.cap)
        return found

    @cached_property
    def _first_search(self) -> ExploredMarkings:
        """Explore by single firings, which decides if the net is safe unless competing transitions fire together."""
        if self.competing is Competing.ALL:
            return explore_in_sets(self.net, self.competing, self.cap)
        return explore_one_by_one(self.net, self.cap)

    @property
    def complete(self) -> bool:
        """True if every reachable marking was visited."""
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
        """True if no step can ever be entered while it stays active (1-safeness; IEC 61131-3 "unsafe" sequence)."""
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
        step = indexes(marking & ~transition.pre & transition.post)[0]
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
        """True if some transition is enabled in every marking."""
        if self.deadlocks:
            return Answer.NO
        return Answer.YES if self.complete else Answer.UNKNOWN

    @cached_property
    def way_home(self) -> Answer:
        """True if the initial marking can be reached again from every marking."""
        if not self.complete:
            # from a deadlock there is no way anywhere, but one that is the initial marking is home
            return Answer.NO if self.deadlocks and self.deadlocks != (self.net.initial,) else Answer.UNKNOWN
        return Answer.YES if self.stranded is None else Answer.NO

    @cached_property
    def stranded(self) -> int | None:
        """A marking from which there is no way to the initial one, as close to it as can be; None: none is known."""
        if not self.complete:
            return None
        # one search backwards from the start, where one forwards from each marking would be quadratic
        home = self._explored.before({self.net.initial})
        return next((m for m in self if m not in home), None)

    @cached_property
    def live(self) -> Answer:
        """True if every transition can become enabled again, whatever happened, and no step is unreachable."""
        if (self.deadlocks and self.net.transitions) or self.dead_transitions or self.unreachable_steps:
            return Answer.NO
        if not self.complete:
            return Answer.UNKNOWN
        # from the start every transition can be enabled, for none is dead: a way back there is enough, and cheaper than
        # the search backwards for each transition; a chart that never returns to its start can still be live
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
                # bit by bit, for a marking has few active steps of many: a loop over all steps takes as long as the
                # chart is large
                lowest = rest & -rest
                together[lowest.bit_length() - 1] |= marking
                rest ^= lowest
        return tuple(beside & ~(1 << index) for index, beside in enumerate(together))

    def concurrent(self, a: NetStep, b: NetStep) -> Answer:
        """Return True if two steps can be active at the same time."""
        if self.concurrency is not None:
            return Answer.YES if self.concurrency[a.index] & b.bit else Answer.NO
        both = a.bit | b.bit
        return Answer.YES if a is not b and any(m & both == both for m in self) else Answer.UNKNOWN

    def trace(self, marking: int) -> tuple[Firing, ...]:
        """Return a shortest way from the initial marking to this one. `KeyError` where it was not reached."""
        if marking not in self._explored.seen:
            raise KeyError(marking)
        return self._way(self._explored, marking)

    def _way(self, explored: ExploredMarkings, marking: int) -> tuple[Firing, ...]:
        return tuple(
            Firing(tuple(self.net.transitions[i] for i in indexes(fired)), after)
            for fired, after in explored.way_to(marking)
        )


def marking_graph(
    chart: SfcNetwork | Net, *, competing: Competing = Competing.PRIORITY, cap: int = DEFAULT_CAP
) -> MarkingGraph:
    """Return the marking graph of a chart, visited when it is first asked; at most about `cap` markings.

    With `Competing.ALL`, transitions that share a source may fire together; with the others at most one of them does.
    Rules beyond the net (`Net.hierarchy`: forcing orders, enclosing steps) are not obeyed.
    """
    net = chart if isinstance(chart, Net) else Net.of(chart)
    return MarkingGraph(net, competing=competing, cap=cap)
