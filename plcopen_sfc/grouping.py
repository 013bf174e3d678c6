"""Things by something that several of them share, or that pairs of them join."""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from typing import Generic, TypeVar

_Key = TypeVar("_Key", bound=Hashable)
_Thing = TypeVar("_Thing")


def grouped(pairs: Iterable[tuple[_Key, _Thing]]) -> dict[_Key, list[_Thing]]:
    """Return what comes with each key, both in the order in which they come."""
    found: dict[_Key, list[_Thing]] = {}
    for key, thing in pairs:
        found.setdefault(key, []).append(thing)
    return found


class Clusters(Generic[_Key]):
    """Things in clusters, at first each in one of its own (union-find)."""

    def __init__(self, things: Iterable[_Key]) -> None:
        self._above = {thing: thing for thing in things}

    def __contains__(self, thing: object) -> bool:
        """Return True if it is one of the things."""
        return thing in self._above

    def root(self, thing: _Key) -> _Key:
        """Return the thing that represents the cluster of another one."""
        above = self._above
        while above[thing] != thing:
            above[thing] = thing = above[above[thing]]
        return thing

    def unite(self, things: Iterable[_Key]) -> None:
        """Put these things into one cluster."""
        roots = [self.root(thing) for thing in things]
        for root in roots:
            self._above[root] = roots[0]

    def members(self) -> dict[_Key, list[_Key]]:
        """Return the things of each cluster by the one that represents it, both in their order."""
        return grouped((self.root(thing), thing) for thing in self._above)
