"""Collecting garbage less often while many objects are made that all live on.

The collector looks through new objects every 700 allocations and through older ones from time to time. While a file of
4 MB is read, nearly all of them live on, and that takes as long as the reading itself. Switching it off would also keep
the garbage of the other threads of a host; with the number of `_ALLOCATIONS` the reading takes the same time.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock

_ALLOCATIONS = 200_000
_YOUNGER = (100, 50)
"""Collections of a generation before the next older one is looked through."""


class _Thresholds:
    """The thresholds of the process, which is what Python has, and how many users want them high."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._users = 0
        self._usual = gc.get_threshold()

    def enter(self) -> None:
        """Raise the thresholds for the first user."""
        with self._lock:
            if not self._users:
                self._usual = gc.get_threshold()
                if 0 < self._usual[0] < _ALLOCATIONS:  # 0: a host has switched the collector off
                    gc.set_threshold(_ALLOCATIONS, *_YOUNGER)
            self._users += 1

    def leave(self) -> None:
        """Put back the thresholds that were there before the first user."""
        with self._lock:
            self._users -= 1
            if not self._users:
                gc.set_threshold(*self._usual)


_THRESHOLDS = _Thresholds()


@contextmanager
def collecting_rarely() -> Iterator[None]:
    """Let the collector look for garbage seldom, in any thread, as long as one of them is inside."""
    _THRESHOLDS.enter()
    try:
        yield
    finally:
        _THRESHOLDS.leave()
