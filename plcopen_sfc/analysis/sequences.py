"""Comparisons of two sides that do not do the same a constant number of scans later.

`InTurn` compares the values that both take one after another, whatever scan it takes them in. A constant delay of a
tool that executes actions first is one for the inputs and times that its actions see, too. So it does not tell what
comes of a time that both an action and a transition wait for: in one tool the action comes first, in the other one the
transition. Here both run as they are. A step may last a scan longer on one side, and what is behind it comes later: the
side that is ahead waits, and the inputs stay until both have taken the same values and rest. What then differs stays,
and is no matter of the scan in which an input came.

`Settled` compares programs that call charts. What follows from these is later, and what follows from inputs alone is
not, so what both decide together may be decided otherwise. Both run with the same inputs scan by scan, and behind each
scan with those of the last one for as long as it takes until what they do shows: that must be the same.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from typing import Any, Protocol

from plcopen_sfc.analysis.product import (
    InputReader,
    ScanEnd,
    System,
    compare,
    end_of,
    failure_of,
)
from plcopen_sfc.errors import SimulationError

_BEHIND = 4
"""Scans that a side may need to take the values that the other one has taken."""
_AT_REST = 2
"""Scans without a change for which both are at rest: what a timer does in the next one comes before new inputs."""
_MOST_SCANS = 1000
"""Scans for which two sides that never rest are followed."""
_STEPS_RESTLESS = _MOST_SCANS // 10
"""Steps of a search that this takes as long as: sides that rest do so within about ten scans."""
_MOST_SETTLING = 40
"""Scans behind a scan that are looked at for what stays."""
RESTLESS = "what never rests with inputs that stay"


class Joined(Protocol):
    """Two systems that are run and compared together otherwise than scan by scan."""

    @property
    def sides(self) -> tuple[Any, Any]:
        """The systems, with what is kept of them between their scans."""

    @property
    def unseen(self) -> int:
        """Scans at the end of each run that are only looked at."""

    def run(
        self, left: Any, right: Any, read: InputReader, *, first: bool, look: Callable[[], None] = lambda: None
    ) -> ScanEnd:
        """Run both `sides` with the same inputs; `look` is called behind every scan."""

    def differing(self) -> Iterator[tuple[int, Any, Any]]:
        """Yield the places in what is observed that differ behind the last run, with the values of both."""


class InTurn:
    """Two systems that are compared in the values that they take one after another."""

    unseen = _AT_REST

    def __init__(self, left: System, right: System) -> None:
        self.sides = Side(left), Side(right)

    def run(
        self, left: Side, right: Side, read: InputReader, *, first: bool, look: Callable[[], None] = lambda: None
    ) -> ScanEnd:
        """Run both until they rest; see `run_in_turn`."""
        return run_in_turn(left, right, read, first=first, look=look)

    def differing(self) -> Iterator[tuple[int, Any, Any]]:
        """Yield what one side has taken and the other has not."""
        left, right = self.sides
        for place in sorted({*left.ahead, *right.ahead}):
            yield place, left.next_of(place), right.next_of(place)


class Settled:
    """Two systems that are compared in what both come to when the inputs of a scan stay.

    `to_rest`: then both go on from there; else from behind that scan, with inputs that may be others in the next one.
    `differences`: behind the last run, by places in what is observed, the values of both.
    """

    unseen = 0

    def __init__(self, left: System, right: System, *, to_rest: bool) -> None:
        self.sides = left, right
        self.differences: dict[int, tuple[Any, Any]] = {}
        self._to_rest = to_rest

    def run(
        self, left: System, right: System, read: InputReader, *, first: bool, look: Callable[[], None] = lambda: None
    ) -> ScanEnd:
        """Run one scan, then what follows while the inputs stay, until all that is observed rests."""
        self.differences = {}
        failures = [failure_of(each, read, first=first) for each in (left, right)]
        look()
        if (ended := end_of(failures)) is not None:
            return ScanEnd(False, *ended)
        behind = at_rest = left.snapshot(), right.snapshot()
        seen = [left.observed() or (), right.observed() or ()]
        changed: dict[int, int] = {}
        quiet = scan = 0
        most = _MOST_SCANS if self._to_rest else _MOST_SETTLING
        while quiet <= _BEHIND and scan < most:
            scan += 1
            quiet += 1
            for side, system in enumerate((left, right)):
                failures[side] = failures[side] or failure_of(system, read, first=False)
                now = seen[side] if failures[side] else system.observed() or ()
                if places := compare(seen[side], now):
                    changed.update(dict.fromkeys(places, scan))
                    quiet = 0
                seen[side] = now
            if (ended := end_of(failures)) is not None:
                return ScanEnd(False, *ended)
            if not quiet:
                at_rest = left.snapshot(), right.snapshot()
        for which, failure in zip(("first", "second"), failures, strict=True):
            if failure is not None:
                return ScanEnd(True, f"only the {which} fails: {failure}", failure)
        resting = [place for place in compare(*seen) if scan - changed.get(place, 0) > _BEHIND]
        if resting:
            self.differences = {place: (seen[0][place], seen[1][place]) for place in resting}
            return ScanEnd(is_different=True)
        if self._to_rest and quiet <= _BEHIND:
            return ScanEnd(False, f"{RESTLESS} is left out", SimulationError(RESTLESS), _STEPS_RESTLESS)
        for system, state in zip((left, right), at_rest if self._to_rest else behind, strict=True):
            system.restore(state)
        return ScanEnd()

    def differing(self) -> Iterator[tuple[int, Any, Any]]:
        """Yield what both have come to."""
        for place, (left, right) in self.differences.items():
            yield place, left, right


class Side:
    """A system, and the values of it that the other side has not taken yet, by their places in what is observed."""

    def __init__(self, system: System) -> None:
        self.system = system
        self.ahead: dict[int, deque[Any]] = {}
        self.seen: tuple[Any, ...] | None = None
        """What was observed last."""

    def reset(self) -> None:
        """Go to the state before the first scan."""
        self.system.reset()
        self.ahead, self.seen = {}, None

    def snapshot(self) -> Any:
        """Return the state where the other side has taken all values."""
        return self.system.snapshot(), self.seen

    def restore(self, snapshot: Any) -> None:
        """Go back to a state."""
        state, self.seen = snapshot
        self.system.restore(state)

    def scan(self, read: InputReader, *, first: bool) -> None:
        """Run one scan; values that change are ahead of the other side."""
        self.system.scan(read, first=first)
        now = self.system.observed()
        if now is None:
            return
        changed = compare(self.seen, now) if self.seen is not None else range(len(now))
        for place in changed:
            self.ahead.setdefault(place, deque()).append(now[place])
        self.seen = now

    def observed(self) -> tuple[Any, ...] | None:
        """Return what was observed last."""
        return self.seen

    def next_of(self, place: int) -> Any:
        """Return the value at a place that the other side has to take next; the last one where there is none."""
        ahead = self.ahead.get(place)
        return ahead[0] if ahead else (self.seen or ())[place]


def run_in_turn(
    left: Side, right: Side, read: InputReader, *, first: bool, look: Callable[[], None] = lambda: None
) -> ScanEnd:
    """Run two sides with inputs that stay, until both have taken the same values and rest; then as long as a scan more.

    A side that is ahead waits for the other. `look` is called behind every scan.
    """
    left.ahead, right.ahead = {}, {}
    behind = quiet = 0
    rest: tuple[Any, Any] | None = None
    for scan in range(_MOST_SCANS):
        running = [each for each, other in ((left, right), (right, left)) if other.ahead or not each.ahead]
        failures = [
            failure_of(each, read, first=first and not scan) if each in running else None for each in (left, right)
        ]
        look()
        ended = end_of(failures)
        if ended is not None:
            return ScanEnd(False, *ended)
        if not any(failures) and None in (left.seen, right.seen):  # one of them begins later
            continue
        for side, failure in zip(("first", "second"), failures, strict=True):
            if failure is not None:
                return ScanEnd(True, f"only the {side} fails: {failure}", failure)
        is_changed = bool(left.ahead or right.ahead)
        if not _taken(left, right):
            return ScanEnd(is_different=True)
        behind = behind + 1 if left.ahead or right.ahead else 0
        if behind > _BEHIND:
            return ScanEnd(is_different=True)
        quiet = 0 if is_changed else quiet + 1
        if quiet == 1:
            rest = left.snapshot(), right.snapshot()
        if quiet > _AT_REST and rest is not None:
            left.restore(rest[0])
            right.restore(rest[1])
            return ScanEnd()
    return ScanEnd(False, f"{RESTLESS} is left out", SimulationError(RESTLESS), _STEPS_RESTLESS)


def _taken(left: Side, right: Side) -> bool:
    """Strike out the values that both have taken; False where one has taken another value than the other."""
    for place in [*left.ahead]:
        mine, theirs = left.ahead[place], right.ahead.get(place, deque())
        while mine and theirs:
            if compare((mine[0],), (theirs[0],)):
                return False
            mine.popleft()
            theirs.popleft()
        for side in (left, right):
            if not side.ahead.get(place, True):
                del side.ahead[place]
    return True
