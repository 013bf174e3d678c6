"""Limits of a search, its progress, and the answers of an analysis."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from math import inf
from time import thread_time

from plcopen_sfc.errors import InputError, check_argument, shown
from plcopen_sfc.semantics.simulation import nanoseconds


class Answer(Enum):
    """Yes, no, or unknown. Only YES is true where Python asks for a truth value."""

    YES = "yes"
    NO = "no"
    UNKNOWN = "unknown"

    def __bool__(self) -> bool:
        return self is Answer.YES

    def __str__(self) -> str:
        return self.value


INTERRUPTED = "interrupted"
"""The reason of a search that the user has ended."""

_PROVING = 0.5
"""The part of the time that the search for a proof may take, so that some is left where it finds none."""

_EXPLAINING = 0.5
"""The part of the time that may come on top of it, to find out why something was not reached."""

_PAUSE = 0.1
"""Seconds between two reports of progress."""


def spent() -> float:
    """Return the seconds of processor time that this thread has used.

    Limits count these: by the wall clock a verdict would depend on what else the machine does.
    """
    return thread_time()


@dataclass(frozen=True)
class SearchProgress:
    """Progress of a comparison: `states` that were searched for a proof, or scans that were run without one.

    `reached` of `all` steps were entered, or of assignments of a program without chart. `seconds`: of processor time
    since the start; `limit`: of all there are, if there is a limit.
    """

    proving: bool
    states: int
    reached: int
    all: int
    seconds: float
    limit: float | None

    def __str__(self) -> str:
        doing, what = ("proving", "states") if self.proving else ("searching", "scans")
        return f"{doing}: {self.states:,} {what}, {self.reached} of {self.all} reached"


class SearchWatch:
    """Looks after one comparison. `reached` tells how much was reached, of how much.

    `whole`: the limit of the user, of which other comparisons have left `limit` seconds, or less than nothing.
    """

    def __init__(
        self,
        limit: float | None,
        report: Callable[[SearchProgress], None] | None,
        reached: Callable[[], tuple[int, int]],
        whole: float | None = None,
    ) -> None:
        self._limit = limit
        self._whole = limit if whole is None else whole
        self._report = report
        self._reached = reached
        self._start = spent()
        self._reported = 0.0
        self.proving = True
        self.states = 0

    def look(self, states: int) -> str:
        """Return why the search must end now; empty: it may go on."""
        self.states = states
        if self._limit is None and self._report is None:
            return ""
        passed = spent() - self._start
        if self._report is not None and passed >= self._reported + _PAUSE:
            self._reported = passed
            self._report(SearchProgress(self.proving, states, *self._reached(), passed, self._limit))
        if self._limit is None or passed < self._limit * (_PROVING if self.proving else 1):
            return ""
        share = "half of " * self.proving if self._limit == self._whole else "its share of " * (self._limit > 0)
        return f"{share}the time limit of {self._whole:.3g} s was reached"

    def is_late(self) -> bool:
        """True if no time is left to find out why something was not reached."""
        if self._limit is None:
            return False
        return spent() - self._start >= self._limit + (self._whole or 0) * _EXPLAINING


def seconds(limit: float | str | None) -> float | None:
    """Return a limit in seconds: a number of them, or ``60s``. Raises `InputError`."""
    if limit is None:
        return None
    check_argument(limit, (str, int, float), "a time limit is a number of seconds or a text")
    try:
        is_number = not isinstance(limit, str) or limit.replace(".", "", 1).isdecimal()
        found = float(limit) if is_number else nanoseconds(str(limit)) / 1e9
    except OverflowError:
        found = inf  # a whole number of more than 308 digits
    except InputError as error:
        hint = "Write it as 60s or 2m30s, or as a number of seconds."
        raise InputError(f"{limit!r} is no time limit", hint=hint) from error
    if not found > 0:
        raise InputError(f"the time limit {shown(limit)} is not greater than zero")
    return found
