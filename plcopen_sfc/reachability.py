"""What can be reached from something by going on from one thing to the next."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from typing import TypeVar

_Thing = TypeVar("_Thing", bound=Hashable)


def reached(starts: Iterable[_Thing], following: Callable[[_Thing], Iterable[_Thing]]) -> set[_Thing]:
    """Return what can be reached from `starts`, these included; `following` tells what one thing leads to."""
    found: set[_Thing] = set()
    waiting = [*starts]
    while waiting:
        thing = waiting.pop()
        if thing not in found:
            found.add(thing)
            waiting += following(thing)
    return found
