"""Comparison of the values that both sides take one after another, whatever scan they take them in.

A constant delay of a tool that executes actions first is one for the inputs and times that its actions see, too. So it
does not tell what comes of a time that both an action and a transition wait for: in one tool the action comes first,
in the other one the transition. Here both run as they are. A step may last a scan longer on one side, and what is
behind it comes later: the side that is ahead waits, and the inputs stay until both have taken the same values and rest.
What then differs stays, and is no matter of the scan in which an input came.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any

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
AT_REST = 2
"""Scans without a change for which both are at rest: what a timer does in the next one comes before new inputs."""
_MOST_SCANS = 1000
"""Scans for which two sides that never rest are followed."""
RESTLESS = "what never rests with inputs that stay"


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
        if quiet > AT_REST and rest is not None:
            left.restore(rest[0])
            right.restore(rest[1])
            return ScanEnd()
    return ScanEnd(False, f"{RESTLESS} is left out", SimulationError(RESTLESS))


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
