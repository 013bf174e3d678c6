"""Work on several things at once, in processes of their own or on a cluster of Dask."""

from __future__ import annotations

import os
import pickle
import signal
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from itertools import islice
from multiprocessing import parent_process
from threading import Thread
from typing import Any, TypeVar

from plcopen_sfc.errors import ArgumentError, SfcError

Given = TypeVar("Given")
Made = TypeVar("Made")

_AHEAD = 4
"""Things for each process that are worked on or done, and not yet taken: memory does not grow with their number."""


def results(
    work: Callable[[Given], Made],
    things: Sequence[Given],
    jobs: int = 1,
    *,
    scheduler: str = "",
    lost: Callable[[Given, str], Made] | None = None,
) -> Iterator[Made]:
    """Yield the results of `work` for each thing, in their order, with up to `jobs` processes.

    One job works in this process. In others `work`, the things and what is made of them are pickled copies; that one
    cannot be pickled is an error. A process that ends in the middle (memory, a signal) loses nothing: what it worked on
    is done again, once; then `lost` makes the result from the thing and the reason, or that is an error. `scheduler` is
    the address of a Dask scheduler (``tcp://host:8786``), whose workers take the place of processes; they need the same
    files under the same paths.
    Raises `ArgumentError` where `jobs` is less than one.
    """
    if jobs < 1:
        raise ArgumentError(f"jobs needs a number of processes, not {jobs}", hint="jobs=1 works in this process.")
    if scheduler:
        yield from _on_cluster(work, things, scheduler, lost)
    elif jobs == 1 or len(things) < 2:
        yield from map(work, things)
    else:
        yield from _in_processes(work, things, min(jobs, len(things)), lost)


def _in_processes(
    work: Callable[[Given], Made], things: Sequence[Given], jobs: int, lost: Callable[[Given, str], Made] | None
) -> Iterator[Made]:
    waiting = iter(things)
    given: deque[tuple[Given, Future[Made]]] = deque()
    pool = ProcessPoolExecutor(jobs, initializer=_begin)
    try:
        while True:
            for thing in islice(waiting, jobs * _AHEAD - len(given)):
                given.append((thing, _submitted(pool, work, thing)))
            if not given:
                return
            thing, future = given.popleft()
            try:
                made = future.result()
            except BrokenProcessPool:
                # it is not known whose process has ended: this thing is tried alone, the others start again
                pool.shutdown(cancel_futures=True)
                made = _alone(work, thing, lost)
                pool = ProcessPoolExecutor(jobs, initializer=_begin)
                again = [other for other, _ in given]
                given = deque((other, _submitted(pool, work, other)) for other in again)
            yield made
    finally:
        pool.shutdown(cancel_futures=True)


def _submitted(pool: ProcessPoolExecutor, work: Callable[[Given], Made], thing: Given) -> Future[Made]:
    """Submit work as a pickle: a pool that fails to pickle never ends its processes (seen with CPython 3.11.7)."""
    try:
        pickled = pickle.dumps((work, thing))
    except (pickle.PicklingError, TypeError, AttributeError) as error:
        raise SfcError(
            f"it cannot be sent to another process: {error}", hint="One job works in this process: --jobs 1, jobs=1."
        ) from error
    return pool.submit(_unpickled, pickled)


def _unpickled(pickled: bytes) -> Any:
    work, thing = pickle.loads(pickled)  # noqa: S301  # made by `_submitted`
    # Ctrl-C reaches all processes of a terminal: it ends work, and is no traceback of a process that waits
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        return work(thing)
    finally:
        signal.signal(signal.SIGINT, signal.SIG_IGN)


def _begin() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    Thread(target=_end_with_the_parent, daemon=True).start()


def _end_with_the_parent() -> None:
    """End this process when the one that gives it work is killed: it would wait for more for ever."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _alone(work: Callable[[Given], Made], thing: Given, lost: Callable[[Given, str], Made] | None) -> Made:
    with ProcessPoolExecutor(1, initializer=_begin) as pool:
        try:
            return _submitted(pool, work, thing).result()
        except BrokenProcessPool:
            return _as_lost(thing, "the process that worked on it has ended, twice", lost)


def _as_lost(thing: Given, why: str, lost: Callable[[Given, str], Made] | None) -> Made:
    if lost is None:
        raise SfcError(why, hint="It may need more memory than there is; see the log of the system.")
    return lost(thing, why)


def _on_cluster(
    work: Callable[[Given], Made], things: Sequence[Given], scheduler: str, lost: Callable[[Given, str], Made] | None
) -> Iterator[Made]:
    """Yield the results of workers of Dask, which gives what a worker that has gone worked on to another one."""
    try:
        from distributed import Client, KilledWorker  # noqa: PLC0415  # an extra
    except ImportError:
        hint = "pip install plcopen-sfc[dask], here and where the workers run."
        raise SfcError("a scheduler needs Dask", hint=hint) from None
    try:
        client: Any = Client(scheduler, timeout=_CONNECTING)  # type: ignore[no-untyped-call]
    except OSError as error:
        raise SfcError(f"no Dask scheduler answers at {scheduler}: {error}", hint="Start it: dask scheduler.") from None
    with client:
        waiting = iter(things)
        given: deque[tuple[Given, Any]] = deque()
        while True:
            ahead = _AHEAD * max(2, sum(client.nthreads().values()))
            for thing in islice(waiting, max(0, ahead - len(given))):
                given.append((thing, client.submit(work, thing, pure=False)))
            if not given:
                return
            thing, future = given.popleft()
            try:
                made: Made = future.result()
            except KilledWorker as error:
                made = _as_lost(thing, f"workers of the cluster ended with it: {error}", lost)
            yield made


_CONNECTING = 10
"""Seconds to wait for a scheduler."""
