"""Things that can be reached by going on from one to the next, and things in the order in which they are needed."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator
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


def needed_first(
    starts: Iterable[_Thing], needs: Callable[[_Thing], Iterable[_Thing]], done: set[_Thing] | None = None
) -> Iterator[_Thing]:
    """Yield `starts` and all that they need, each once and behind what it needs, but for circles.

    Things that are `done` are left out, and those that are begun are put there.
    """
    done = set() if done is None else done
    for start in starts:
        waiting = [(start, False)]
        while waiting:
            thing, is_ready = waiting.pop()
            if is_ready:
                yield thing
            elif thing not in done:
                done.add(thing)
                waiting.append((thing, True))
                waiting += [(each, False) for each in reversed([*needs(thing)])]
