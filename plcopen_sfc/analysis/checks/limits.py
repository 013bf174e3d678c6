"""Limits of tools."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from plcopen_sfc.analysis.checks.charts import CheckedChart
from plcopen_sfc.analysis.checks.rules import Finding, Rule
from plcopen_sfc.diagnostics import Severity

_SEQUENCES = 8
_STEPS = 250
_TRANSITIONS = 250
_BRANCHES = 256
_ALTERNATIVES = 125
_SIMULTANEOUS = 249


def _graph(chart: CheckedChart) -> Iterator[Finding]:
    for sheet in chart.sheets:
        leaving = Counter(source for t in sheet.transitions for source in set(t.sources))
        branches = (
            sum(count > 1 for count in leaving.values())
            + sum(len(t.targets) > 1 for t in sheet.transitions)
            + sum(len(t.sources) > 1 for t in sheet.transitions)
        )
        counts = (
            ("sequences", len(sheet.chart.sequences), _SEQUENCES),
            ("steps", len(sheet.steps), _STEPS),
            ("transitions", len(sheet.transitions), _TRANSITIONS),
            ("branches", branches, _BRANCHES),
        )
        for what, count, most in counts:
            if count > most:
                yield Finding(sheet.place, f"{count} {what}; a block has {most} at most")
        for step in sheet.steps:
            if leaving[step.id] > _ALTERNATIVES:
                message = f"{leaving[step.id]} alternative paths; a branch has {_ALTERNATIVES} at most"
                yield Finding(sheet.at(step), message)
        for transition in sheet.transitions:
            if len(transition.targets) > _SIMULTANEOUS:
                message = f"{len(transition.targets)} simultaneous paths; a branch has {_SIMULTANEOUS} at most"
                yield Finding(sheet.at(transition), message)


LIM01 = Rule(
    code="LIM01",
    title="A block of S7-GRAPH has room for the chart",
    why="A block holds 8 sequences, 250 steps, 250 transitions and 256 branches, with 125 alternative or 249 "
    "simultaneous paths each (S7-GRAPH manual, limits).",
    hint="Divide the chart into several blocks, or take parts of it out into blocks of their own.",
    example="a chart of 251 steps",
    check=_graph,
    severity=None,
    severities={"s7graph": Severity.ERROR},
)
