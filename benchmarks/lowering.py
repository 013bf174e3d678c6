"""How long lowering takes, how it grows, and how long the proof takes.

    python -m benchmarks.lowering              growth without the proof, and the proof of 1,000 steps
    python -m benchmarks.lowering --quick      growth to 2,500 steps, the proof of 200

The ring has an action in each step, on twenty outputs with all kinds of qualifiers; every second condition has several
comparisons. The nested chart has selections, simultaneous branches and loops. Times are processor times of the best of
two runs, without making the chart; the exponent is that of the last three sizes.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable
from functools import partial

from benchmarks.execution import condition
from benchmarks.nets import best, nested
from plcopen_sfc import model as m
from plcopen_sfc.lowering import lower

SIZES = (1250, 2500, 5000, 10_000)
OUTPUTS = 20
LEVELS = 10
TIMED = {m.Qualifier.L, m.Qualifier.D, m.Qualifier.SD}
QUALIFIERS = [m.Qualifier.N] * 12 + [m.Qualifier.S, m.Qualifier.R, m.Qualifier.P, m.Qualifier.P1, *sorted(TIMED)]
FORMS = (("case", "ST"), ("regions", "ST"), ("bits", "ST"), ("flipflop", "ST"), ("flipflop", "FBD"), ("flipflop", "LD"))


def ring(steps: int) -> m.Project:
    """Steps one after the other, in a circle."""
    return _project(
        m.SfcNetwork(
            steps=[m.Step(id=i, name=f"S{i}", initial=i == 0) for i in range(steps)],
            transitions=[m.Transition(id=steps + i, sources=[i], targets=[(i + 1) % steps]) for i in range(steps)],
        )
    )


def blocks(steps: int) -> m.Project:
    """Nested selections, simultaneous branches and loops."""
    return _project(nested(steps))


def _project(chart: m.SfcNetwork) -> m.Project:
    free = len(chart.steps) + len(chart.transitions)
    for number, transition in enumerate(chart.transitions):
        transition.condition = m.Expression(text=condition(number % 100))
    for number, step in enumerate(chart.steps):
        qualifier = QUALIFIERS[number % len(QUALIFIERS)]
        duration = "T#50ms" if qualifier in TIMED else None
        action = m.ActionAssociation(
            id=free + number, target=f"Q{number % OUTPUTS}", qualifier=qualifier, duration=duration
        )
        step.actions.append(action)
    sections = [
        _section(m.SectionKind.INPUT, [f"In{i}" for i in range(OUTPUTS)] + ["Door"], m.Elementary.BOOL),
        _section(m.SectionKind.INPUT, [f"Level{i}" for i in range(LEVELS)], m.Elementary.INT),
        _section(m.SectionKind.OUTPUT, [f"Q{i}" for i in range(OUTPUTS)], m.Elementary.BOOL),
    ]
    pou = m.Pou(
        name="Main",
        kind=m.PouKind.FUNCTION_BLOCK,
        interface=m.Interface(sections=sections),
        bodies=[m.SfcBody(chart=chart)],
    )
    return m.Project(name="Benchmark", pous=[pou])


def _section(kind: m.SectionKind, names: list[str], type_: m.Elementary) -> m.VariableSection:
    variables = [m.Variable(name=name, type=m.ElementaryType(name=type_)) for name in names]
    return m.VariableSection(kind=kind, variables=variables)


def growth(chart: str, make: Callable[[int], m.Project], sizes: tuple[int, ...]) -> None:
    """Print how long each form takes at each size."""
    for construction, language in FORMS:
        if (construction == "case") != (chart == "ring") and construction in ("case", "regions"):
            continue
        points: list[tuple[int, float]] = []
        for size in sizes:
            work = partial(lower, make(size), construction, language=language, profile="iec", verify=False)
            seconds = best(work, 2)
            points.append((size, seconds))
        (small, first), (large, last) = points[-3 if len(points) > 2 else 0], points[-1]
        exponent = math.log(last / first) / math.log(large / small)
        times = "  ".join(f"{seconds:8.2f}" for _, seconds in points)
        print(f"{chart:<8}{construction:<9}{language:<4}{times}   size^{exponent:.2f}", flush=True)


def proof(steps: int) -> None:
    """Print how long lowering with the proof takes."""
    project = ring(steps)
    for construction, language in FORMS:
        if construction == "regions":
            continue
        start = time.process_time()
        lowered = lower(project, construction, language=language, profile="iec")
        seconds = time.process_time() - start
        print(f"proof of {steps} steps, {construction} {language}: {seconds:.1f} s, {lowered.proof}", flush=True)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true")
    quick = parser.parse_args().quick
    sizes = SIZES[:2] if quick else SIZES
    print("growth to", ", ".join(f"{size:,}" for size in sizes), "steps, seconds")
    growth("ring", ring, sizes)
    growth("nested", blocks, sizes)
    proof(200 if quick else 1000)


if __name__ == "__main__":
    main()
