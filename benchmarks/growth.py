"""How the time of every operation grows with its input: three sizes, the exponent of each step, and the worst.

    python -m benchmarks.growth                  files of 1, 2 and 4 MB, charts of 400, 800 and 1600 steps
    python -m benchmarks.growth --scale 2        twice as much of each
    python -m benchmarks.growth --no-gc          without the collector of garbage, whose full passes look at all objects

An operation that is linear has the exponent 1: twice the input takes twice the time. Times are of the processor, the
best of two runs, after a run on the smallest input. `LIMIT` is the greatest exponent that is taken without a reason.
Smaller files have no full pass of the collector while they are read or compared: its first one looks like growth.
"""

from __future__ import annotations

import argparse
import gc
import math
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import plcopen_sfc as sfc
from benchmarks.generate import generate
from plcopen_sfc import model as m

LIMIT = 1.15
_SIZES = (1, 2, 4)
_RUNS = 2


@dataclass(frozen=True)
class MeasuredOperation:
    """An operation that is measured: `prepare` makes its input of a size, `run` is timed."""

    name: str
    prepare: Callable[[int], object]
    run: Callable[..., object]


def ring(steps: int) -> sfc.Project:
    """A chart of so many steps in a circle, each with an action, every tenth with a selection of two."""
    variables = [m.Variable(name=name, type="BOOL") for name in ("x", "y", "valve")]
    places = [
        m.Step(id=number, name=f"S{number}", initial=number == 0, actions=[_action(steps * 3 + number)])
        for number in range(steps)
    ]
    wires = [_transition(steps + number, number, (number + 1) % steps, "x") for number in range(steps)]
    wires += [
        _transition(steps * 2 + number, number, (number + 2) % steps, "NOT x AND y") for number in range(0, steps, 10)
    ]
    pou = m.Pou(
        name="Main",
        kind=m.PouKind.PROGRAM,
        interface=m.Interface(sections=[m.VariableSection(variables=variables)]),
        bodies=[m.SfcBody(chart=m.SfcNetwork(steps=places, transitions=wires))],
    )
    return sfc.Project(name="Growth", pous=[pou])


def _action(number: int) -> m.ActionAssociation:
    return m.ActionAssociation(id=number, qualifier=m.Qualifier.N, target="valve")


def _transition(number: int, source: int, target: int, condition: str) -> m.Transition:
    return m.Transition(id=number, sources=[source], targets=[target], condition=m.Expression(text=condition))


def operations(folder: Path, scale: float) -> list[MeasuredOperation]:
    """Return all operations; files are generated in `folder`."""

    def data(size: int) -> bytes:
        path = folder / f"{size}.xml"
        if not path.exists():
            generate(path, megabytes=size * scale)
        return path.read_bytes()

    def loaded(size: int) -> sfc.Project:
        project = sfc.loads(data(size))
        project.read_all()
        return project

    def chart(size: int) -> sfc.Project:
        return ring(int(400 * size * scale))

    def step_of(project: sfc.Project) -> object:
        found = next(project.charts()).chart
        return found.rename_step(found.steps[-1].name, "Zz9")

    def as_text(size: int) -> bytes:
        return sfc.dumps(chart(size), format="iec-text")

    def long_string(size: int) -> sfc.Project:
        return program(f"s := '{'a' * int(200_000 * size * scale)}';")

    def long_line(size: int) -> sfc.Project:
        return program("x := x + 1; " * int(4_000 * size * scale))

    return [
        MeasuredOperation("load", data, sfc.loads),
        MeasuredOperation("load and read all", data, lambda content: sfc.loads(content).read_all()),
        MeasuredOperation("load text", as_text, lambda content: sfc.loads(content, format="iec-text")),
        MeasuredOperation("check", chart, sfc.check),
        MeasuredOperation("simulate 20 scans", chart, lambda project: sfc.simulate(project, scans=20)),
        MeasuredOperation("convert to CODESYS", chart, lambda project: sfc.dumps(project, format="codesys")),
        MeasuredOperation("convert to text", chart, lambda project: sfc.dumps(project, format="iec-text")),
        MeasuredOperation("long string to SCL", long_string, lambda project: sfc.dumps(project, format="scl")),
        MeasuredOperation("long line to SCL", long_line, lambda project: sfc.dumps(project, format="scl")),
        MeasuredOperation("lower, no proof", chart, lambda project: sfc.lower(project, verify=False)),
        MeasuredOperation("rename a step", loaded, step_of),
        MeasuredOperation("save an edit", lambda size: edited(loaded(size)), sfc.dumps),
        MeasuredOperation("diff", lambda size: (loaded(size), edited(loaded(size))), lambda pair: sfc.diff(*pair)),
    ]


def program(text: str) -> sfc.Project:
    """A program with these statements."""
    source = f"PROGRAM Main\nVAR s : STRING; x : INT; END_VAR\n{text}\nEND_PROGRAM\n"
    return sfc.loads(source.encode(), format="iec-text")


def edited(project: sfc.Project) -> sfc.Project:
    """The project with a comment at the last step of its first chart."""
    next(project.charts()).chart.steps[-1].comment = "edited"
    return project


def measured(operation: MeasuredOperation, *, collecting: bool = True) -> list[float]:
    """Return the seconds of the processor that an operation takes with each size."""
    operation.run(operation.prepare(_SIZES[0]))
    best = []
    for size in _SIZES:
        runs = []
        for _ in range(_RUNS):
            given = operation.prepare(size)
            gc.collect()
            if not collecting:
                gc.disable()
            start = time.process_time()
            operation.run(given)
            runs.append(time.process_time() - start)
            gc.enable()
        best.append(min(runs))
    return best


def exponent(times: list[float]) -> float:
    """Return the growth between the first and the last size."""
    return math.log(times[-1] / times[0]) / math.log(_SIZES[-1] / _SIZES[0])


def main() -> None:
    """Measure and print a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scale", type=float, default=1)
    parser.add_argument("--no-gc", action="store_true", help="switch the collector off while something is measured")
    parser.add_argument("--only", default="", help="operations with this in their name")
    arguments = parser.parse_args()
    print("| operation | seconds | exponent |\n|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for operation in operations(Path(folder), arguments.scale):
            if arguments.only in operation.name:
                times = measured(operation, collecting=not arguments.no_gc)
                shown = " / ".join(f"{each:.3g}" for each in times)
                why = "" if exponent(times) <= LIMIT else " TOO MUCH"
                print(f"| {operation.name} | {shown} | {exponent(times):.2f}{why} |", flush=True)


if __name__ == "__main__":
    main()
