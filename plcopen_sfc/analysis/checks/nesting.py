"""Simultaneous branches that stand in each other, and jumps that leave them."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.analysis.checks.charts import CheckedChart
from plcopen_sfc.analysis.checks.rules import Finding, Rule
from plcopen_sfc.analysis.regions import Obstacle, Unstructured, find_regions
from plcopen_sfc.diagnostics import Severity

_CROSSING = frozenset(
    {
        Obstacle.JUMP_ACROSS_BORDER,
        Obstacle.BRANCHES_RUN_TOGETHER,
        Obstacle.UNMATCHED_JOIN,
        Obstacle.UNMATCHED_FORK,
    }
)


def _crossing(chart: CheckedChart) -> Iterator[Finding]:
    if chart.net.hierarchy:
        return
    found = find_regions(chart.net)
    if isinstance(found, Unstructured) and found.obstacle in _CROSSING and found.transitions:
        place = chart.place_of(chart.net.transitions[found.transitions[0]])
        yield Finding(place, found.message)


STR13 = Rule(
    code="STR13",
    title="Simultaneous branches are nested, and nothing leads into them or out of them",
    why="What is forked together is joined together. A jump out of a branch leaves the others active, one into a "
    "branch starts it without the others (IEC 61131-3 ed. 3, 6.7.5). CODESYS and S7-GRAPH draw branches in each other "
    "only, but CODESYS lets jumps cross their borders.",
    hint="Let the branches meet in one convergence; where one shall end early, let its last step wait for the others.",
    example="""
INITIAL_STEP S1: END_STEP
STEP A: END_STEP
STEP B: END_STEP
TRANSITION FROM S1 TO (A, B) := a; END_TRANSITION
TRANSITION FROM (A, B) TO S1 := b; END_TRANSITION
TRANSITION FROM A TO S1 := stop; END_TRANSITION
""",
    check=_crossing,
    severity=Severity.WARNING,
    severities={"grafcet": Severity.INFO},
)
