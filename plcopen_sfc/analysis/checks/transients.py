"""Charts that do not come to rest."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.analysis.checks.charts import CheckedChart
from plcopen_sfc.analysis.checks.rules import Finding, Rule
from plcopen_sfc.analysis.exclusivity import Truth
from plcopen_sfc.diagnostics import Severity


def cycles(chart: CheckedChart) -> Iterator[tuple[int, ...]]:
    """Cycles of transitions (indexes) that are always true; one for each set of steps that they connect."""
    always = [t for t in chart.net.transitions if chart.truth(chart.sheet_of(t), t.transition) is Truth.ALWAYS]
    after: dict[int, list[tuple[int, int]]] = {}
    for transition in always:
        if len(transition.sources) == 1:  # a convergence waits for others
            for target in transition.targets:
                after.setdefault(transition.sources[0], []).append((target, transition.index))
    done: set[int] = set()
    for start in sorted(after):
        way: list[int] = []
        at, steps = start, [start]
        while at not in done and at in after:
            target, transition_index = after[at][0]
            way.append(transition_index)
            if target in steps:
                yield tuple(way[steps.index(target) :])
                break
            steps.append(target)
            at = target
        done.update(steps)


def _endless(chart: CheckedChart) -> Iterator[Finding]:
    for cycle in cycles(chart):
        names = ", ".join(chart.net.transitions[i].path for i in cycle)
        yield Finding(chart.place_of(chart.net.transitions[cycle[0]]), f"always true in a circle: {names}")


EVO01 = Rule(
    code="EVO01",
    title="The chart comes to rest",
    why="A circle of transitions that are always true is run through without end: in GRAFCET the search for a stable "
    "situation never ends, elsewhere the chart goes round with every scan.",
    hint="Let one transition of the circle wait for something.",
    example="""
INITIAL_STEP S1: END_STEP
STEP S2: END_STEP
TRANSITION FROM S1 TO S2 := TRUE; END_TRANSITION
TRANSITION FROM S2 TO S1 := a OR NOT a; END_TRANSITION
""",
    check=_endless,
    severity=Severity.INFO,
    severities={"grafcet": Severity.ERROR},
)
