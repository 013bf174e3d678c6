"""Inputs that once took too long or too much memory, each measured once in a process of its own.

    python -m benchmarks.hard_inputs               all, some minutes
    python -m benchmarks.hard_inputs --only steps  those with this in their name

Seconds are of the processor, behind what makes the input and imports the package; the memory is the peak of the
process in 10^6 bytes, what makes the input included.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import plcopen_sfc as sfc
from benchmarks.generate import generate
from benchmarks.growth import edited, program, ring
from benchmarks.measure import peak_memory
from plcopen_sfc.errors import SfcError

Job = tuple[Callable[[], Any], Callable[[Any], object]]
"""What makes the input, and what is measured with it."""


def _export(megabytes: float) -> Callable[[], bytes]:
    def made() -> bytes:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "export.xml"
            generate(path, megabytes=megabytes)
            return path.read_bytes()

    return made


def _with_pragma() -> bytes:
    text = sfc.dumps(ring(100), format="iec-text")
    return text.replace(b"INITIAL_STEP", b'(*$plcopen_sfc {"unknown": [1, {}]} *)\nINITIAL_STEP', 1)


def _selection(branches: int) -> sfc.Project:
    steps = "".join(
        f"STEP S{n}: END_STEP\nTRANSITION (PRIORITY := {n + 1}) FROM Start TO S{n} := x = {n}; END_TRANSITION\n"
        f"TRANSITION FROM S{n} TO Start := TRUE; END_TRANSITION\n"
        for n in range(branches)
    )
    return sfc.loads(
        f"PROGRAM Main\nVAR x : INT; END_VAR\nINITIAL_STEP Start: END_STEP\n{steps}END_PROGRAM\n".encode(),
        format="iec-text",
    )


def _parallel(branches: int) -> sfc.Project:
    names = [f"B{n}" for n in range(branches)]
    inputs = ", ".join(f"i{n}" for n in range(branches))
    steps = "".join(
        f"STEP {name}: END_STEP\nSTEP {name}e: END_STEP\nTRANSITION FROM {name} TO {name}e := i{n}; END_TRANSITION\n"
        for n, name in enumerate(names)
    )
    both = f"({', '.join(names)})", f"({', '.join(f'{name}e' for name in names)})"
    text = (
        f"PROGRAM Main\nVAR_INPUT {inputs} : BOOL; END_VAR\nINITIAL_STEP Start: END_STEP\n{steps}"
        f"TRANSITION FROM Start TO {both[0]} := TRUE; END_TRANSITION\n"
        f"TRANSITION FROM {both[1]} TO Start := TRUE; END_TRANSITION\nEND_PROGRAM\n"
    )
    return sfc.loads(text.encode(), format="iec-text")


def _doubling() -> sfc.Project:
    text = "PROGRAM Main\nVAR s : STRING[4000000]; END_VAR\ns := CONCAT(s, CONCAT(s, 'a'));\nEND_PROGRAM\n"
    return sfc.loads(text.encode(), format="iec-text")


def _text(statements: str) -> Callable[[], bytes]:
    return lambda: sfc.dumps(program(statements), format="iec-text")


def _loaded(statements: str) -> Callable[[], sfc.Project]:
    return lambda: program(statements)


def _to(form: str) -> Callable[[sfc.Project], bytes]:
    return lambda project: sfc.dumps(project, format=form)


def _run(scans: int) -> Callable[[sfc.Project], object]:
    return lambda project: sfc.simulate(project, scans=scans)


def _edit_and_save(project: sfc.Project) -> bytes:
    return sfc.dumps(edited(project))


_LITERAL = f"s := '{'a' * 1_000_000}';"
_QUOTES = f"s := '{'$$' * 200_000}';".replace("$$", "$'")
_LINE = "x := x + 1; " * 150_000

JOBS: dict[str, Job] = {
    "a pragma that does not fit, 100 steps: load": (_with_pragma, sfc.loads),
    "the same without it: load": (lambda: sfc.dumps(ring(100), format="iec-text"), sfc.loads),
    "TC6 of 54 MB: load": (_export(50), sfc.loads),
    "TC6 of 54 MB: edit and save": (lambda: sfc.loads(_export(50)()), _edit_and_save),
    "TC6 of 108 MB: load": (_export(100), sfc.loads),
    "TC6 of 108 MB: edit and save": (lambda: sfc.loads(_export(100)()), _edit_and_save),
    "10,000 steps: simulate 20 scans": (lambda: ring(10_000), _run(20)),
    "10,000 steps: check": (lambda: ring(10_000), sfc.check),
    "10,000 steps: to CODESYS": (lambda: ring(10_000), _to("codesys")),
    "a selection of 2,000 branches: check": (lambda: _selection(2_000), sfc.check),
    "14 simultaneous branches: lower and compare": (lambda: _parallel(14), sfc.lower),
    "a literal of 1 MB: load": (_text(_LITERAL), sfc.loads),
    "a literal of 1 MB: to SCL": (_loaded(_LITERAL), _to("scl")),
    "a literal of 1 MB: 2 scans": (_loaded(_LITERAL), _run(2)),
    "200,000 quotes: load": (_text(_QUOTES), sfc.loads),
    "200,000 quotes: to SCL": (_loaded(_QUOTES), _to("scl")),
    "a line of 150,000 statements: load": (_text(_LINE), sfc.loads),
    "a line of 150,000 statements: to TC6": (_loaded(_LINE), _to("plcopen")),
    "a line of 150,000 statements: to SCL": (_loaded(_LINE), _to("scl")),
    "a string that doubles in every scan: 40 scans": (_doubling, _run(40)),
}


def _measure(name: str) -> None:
    made, job = JOBS[name]
    given = made()
    start = time.process_time()
    ended = ""
    try:
        job(given)
    except SfcError as error:
        ended = f"{type(error).__name__}: {error}".splitlines()[0]
    seconds = time.process_time() - start
    print(f"| {name} | {seconds:.2g} | {peak_memory() / 1e6:.0f} | {ended} |")


def main() -> None:
    """Measure and print a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="inputs with this in their name")
    parser.add_argument("--one", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.one:
        _measure(arguments.one)
        return
    print("| input | seconds | peak, MB | ended with |\n|---|---|---|---|", flush=True)
    for name in JOBS:
        if arguments.only in name:
            subprocess.run([sys.executable, "-m", "benchmarks.hard_inputs", "--one", name], check=True)


if __name__ == "__main__":
    main()
