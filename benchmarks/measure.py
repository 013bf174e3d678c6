"""Stopwatches: every run in a process of its own, contestants in turn.

What is compared is the processor time of the best run. A machine that does other things at the same time lengthens the
wall time of both sides by chance; wall times are kept beside it. Processes of their own, because the same parse can
take twice the time on a heap that other parses have used before: in one process, who runs first wins.
"""

from __future__ import annotations

import contextlib
import ctypes
import gc
import json
import re
import statistics
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


@dataclass
class Times:
    """Runs of one contestant, in seconds and bytes."""

    cpu: list[float] = field(default_factory=list)
    wall: list[float] = field(default_factory=list)
    memory: list[int] = field(default_factory=list)

    @property
    def best(self) -> float:
        """Processor time of the best run."""
        return min(self.cpu)

    @property
    def best_wall(self) -> float:
        """Wall time of the best run."""
        return min(self.wall)

    @property
    def megabytes(self) -> float:
        """Peak memory on top of what the interpreter had before, in 10^6 bytes."""
        return statistics.median(self.memory) / 1e6


def race(
    contestants: Sequence[str], path: Path, warm: Path, *, rounds: int = 5, seconds: float = 12.0
) -> dict[str, Times]:
    """Run `jobs.JOBS` in turn, so that a disturbance hits all of them; each at least twice, at most `rounds` times.

    A contestant that has used up its `seconds` runs no more. Every interpreter imports the same and has done its job on
    `warm`, a small file, before.
    """
    times = {name: Times() for name in contestants}
    for turn in range(rounds):
        for name, mine in times.items():
            if turn >= 2 and sum(mine.wall) + mine.best_wall > seconds:
                continue
            command = [sys.executable, "-m", "benchmarks.measure", name, str(path), str(warm)]
            done = subprocess.run(command, check=False, capture_output=True, text=True, cwd=ROOT)
            if done.returncode:
                raise RuntimeError(f"{name}: {done.stderr.strip().splitlines()[-1]}")
            found = json.loads(done.stdout)
            mine.cpu.append(found["cpu"])
            mine.wall.append(found["wall"])
            mine.memory.append(found["memory"])
    return times


def process_times(commands: dict[str, Sequence[str]], *, rounds: int = 10) -> dict[str, Times]:
    """Start programs in turn and wait for their end; their processor time is user plus system."""
    import resource  # noqa: PLC0415  # not on Windows; only this needs it

    times = {name: Times() for name in commands}
    for _ in range(rounds):
        for name, command in commands.items():
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            wall = time.perf_counter()
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL, cwd=ROOT)
            times[name].wall.append(time.perf_counter() - wall)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            times[name].cpu.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return times


def peak_memory() -> int:
    """The most memory that this process ever had, or had since `reset_peak`, in bytes.

    Linux hands `ru_maxrss` down from the parent process; the high-water mark in ``/proc`` is the process's own.
    """
    status = Path("/proc/self/status")
    if status.exists() and (mark := re.search(r"VmHWM:\s+(\d+) kB", status.read_text("ascii"))):
        return int(mark[1]) * 1024
    import resource  # noqa: PLC0415

    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit


def reset_peak() -> None:
    """Give unused memory back and begin anew with the peak, where the system can do that (Linux with glibc).

    Else memory that earlier work has freed would be used again, and not be counted.
    """
    gc.collect()
    with contextlib.suppress(OSError, AttributeError):
        ctypes.CDLL(None).malloc_trim(0)
        Path("/proc/self/clear_refs").write_text("5", "ascii")


def _main(name: str, path: str, warm: str) -> None:
    from benchmarks.jobs import JOBS, has_xsdata  # noqa: PLC0415

    has_xsdata()
    prepare, job = JOBS[name]
    job(prepare(Path(warm)))
    prepared = prepare(Path(path))
    reset_peak()
    before = peak_memory()
    wall, cpu = time.perf_counter(), time.process_time()
    result = job(prepared)
    cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
    memory = peak_memory() - before
    del result  # freeing it is not measured
    print(json.dumps({"cpu": cpu, "wall": wall, "memory": memory}))


if __name__ == "__main__":
    _main(*sys.argv[1:4])
