"""Collecting garbage less often while many objects are made that all live on.

The collector looks through new objects every 700 allocations and through older ones from time to time. While a file of
4 MB is read, nearly all of them live on, and that takes as long as the reading itself. Switching it off would also keep
the garbage of the other threads of a host; with the number of `_ALLOCATIONS` the reading takes the same time.

When the thresholds are as they were, the collector would look through all that was made, and twice: a twelfth of the
time of reading a chart. These objects become old ones at once instead, which takes no time. All are looked through
when the next ones are to be made, if half of them were not before: what the last file was read into is garbage by then.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from threading import RLock

_ALLOCATIONS = 200_000
_MOST_UNSEEN = 1_000_000
_YOUNGER = (100, 50)
"""Collections of a generation before the next older one is looked through."""


class _Thresholds:
    """The thresholds of the process, which is what Python has, and how many users want them high."""

    def __init__(self) -> None:
        self._lock = RLock()  # the collector may run finalizers of a host, which may come here
        self._users = 0
        self._usual = gc.get_threshold()
        self._unseen, self._most_unseen = 0, _MOST_UNSEEN

    def enter(self) -> None:
        """Raise the thresholds for the first user."""
        with self._lock:
            if not self._users:
                if self._is_plain() and self._unseen > self._most_unseen:
                    self._look_through_all()
                self._usual = gc.get_threshold()
                if 0 < self._usual[0] < _ALLOCATIONS:  # 0: a host has switched the collector off
                    gc.set_threshold(_ALLOCATIONS, *_YOUNGER)
            self._users += 1

    def leave(self) -> None:
        """Put back the thresholds that were there before the first user."""
        with self._lock:
            self._users -= 1
            if not self._users:
                if self._usual[0] and self._is_plain():
                    young, middle, _ = gc.get_count()
                    self._unseen += young + middle * _ALLOCATIONS
                    gc.freeze()
                    gc.unfreeze()
                gc.set_threshold(*self._usual)

    def _look_through_all(self) -> None:
        gc.collect()
        gc.freeze()
        self._unseen, self._most_unseen = 0, max(_MOST_UNSEEN, gc.get_freeze_count())
        gc.unfreeze()

    @staticmethod
    def _is_plain() -> bool:
        """False where a host has its own ways with the collector: it is off, or objects are frozen."""
        return gc.isenabled() and not gc.get_freeze_count()


_THRESHOLDS = _Thresholds()


@contextmanager
def collecting_rarely() -> Iterator[None]:
    """Let the collector look for garbage seldom, in any thread, as long as one of them is inside."""
    _THRESHOLDS.enter()
    try:
        yield
    finally:
        _THRESHOLDS.leave()
