"""Work on several things at once, in processes of their own."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from typing import TypeVar

from plcopen_sfc.errors import ArgumentError

Given = TypeVar("Given")
Made = TypeVar("Made")


def results(work: Callable[[Given], Made], things: Sequence[Given], jobs: int = 1) -> Iterator[Made]:
    """Yield what `work` makes of each thing, in their order, with up to `jobs` processes.

    One job works in this process. In others `work`, the things and what is made of them are pickled copies.
    Raises `ArgumentError` where `jobs` is less than one.
    """
    if jobs < 1:
        raise ArgumentError(f"jobs needs a number of processes, not {jobs}", hint="jobs=1 works in this process.")
    if jobs == 1 or len(things) < 2:
        yield from map(work, things)
        return
    with ProcessPoolExecutor(min(jobs, len(things))) as pool:
        yield from pool.map(work, things)
