"""The search through the markings of a net."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import reduce
from operator import or_

from plcopen_sfc.semantics.net import Competing, Net, mask

_FIRINGS_PER_MARKING = 32
"""Sets of transitions that are tried for each marking of the cap, on average, before the search gives up."""


@dataclass
class Explored:
    """What the search saw: the markings by their distance from the initial one.

    `unsafe`: a marking and the transition that would enter an active step there. `enabled`: the transitions that are
    enabled in some marking. `came_from`, only where transitions
    fired in sets: for each marking all markings before it, each with the transitions that fired.
    """

    net: Net
    seen: set[int]
    levels: list[list[int]]
    complete: bool = True
    unsafe: tuple[int, int] | None = None
    enabled: int = 0
    came_from: dict[int, dict[int, int]] | None = None

    def before(self, markings: set[int]) -> set[int]:
        """All markings from which one of these can be reached, themselves included."""
        found = set(markings)
        frontier = found
        while frontier:
            frontier = self._all_before(frontier) - found
            found |= frontier
        return found

    def blocked(self) -> Iterator[int]:
        """The markings in which nothing is enabled."""
        for level in self.levels:
            left = level
            for transition in self.net.transitions:
                pre = transition.pre
                left = [m for m in left if m & pre != pre]
                if not left:
                    break
            yield from left

    def way_to(self, marking: int) -> list[tuple[int, int]]:
        """A shortest way from the initial marking: what fires, and the marking after it."""
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
        for transition in self.net.transitions:
            pre, left, post, touched = (
                transition.pre,
                ~transition.post,
                transition.post,
                transition.pre | transition.post,
            )
            found.update([m & left | pre for m in frontier if m & touched == post])
        return found & self.seen

    def _previous(self, marking: int) -> Iterator[tuple[int, int]]:
        if self.came_from is not None:
            yield from self.came_from[marking].items()
            return
        # in a safe net a transition that led to a marking tells what was there before it
        for transition in self.net.transitions:
            pre, post = transition.pre, transition.post
            if not post & ~marking and not marking & pre & ~post:
                previous = marking & ~post | pre
                if previous in self.seen:
                    yield previous, transition.bit


def explore_one_by_one(net: Net, cap: int) -> Explored:
    """Fire one transition at a time, until more than `cap` markings were seen, or one enters an active step."""
    moves = [(t.pre, ~t.pre, t.post, t.post & ~t.pre, t.index) for t in net.transitions]
    seen = {net.initial}
    levels = [[net.initial]]
    found = Explored(net, seen, levels)
    while levels[-1]:
        frontier = levels[-1]
        active = reduce(or_, frontier)
        fresh: set[int] = set()
        for pre, kept, post, gained, index in moves:
            if pre & ~active:
                continue
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


def explore_in_sets(net: Net, competing: Competing, cap: int) -> Explored:
    """Fire every set of transitions that can fire in one scan, until more than `cap` markings were seen."""
    came_from: dict[int, dict[int, int]] = {net.initial: {}}
    levels = [[net.initial]]
    found = Explored(net, {net.initial}, levels, came_from=came_from)
    budget = _FIRINGS_PER_MARKING * cap
    while levels[-1]:
        fresh: list[int] = []
        for marking in levels[-1]:
            enabled = net.enabled(marking)
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
    """The markings after each set of enabled transitions that can fire together, with the set."""
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
