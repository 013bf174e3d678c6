"""Ends of charts: steps that nothing leaves, transitions without a step on one side."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.analysis.checks.charts import CheckedChart
from plcopen_sfc.analysis.checks.connections import jumping_nowhere
from plcopen_sfc.analysis.checks.rules import Finding, Rule
from plcopen_sfc.diagnostics import Severity


def _dead_ends(chart: CheckedChart) -> Iterator[Finding]:
    exits = {macro.exit for macro in chart.net.macros}
    for step in chart.net.steps:
        if not chart.net.leaving[step.index] and step.index not in exits:
            alone = len(chart.sheet_of(step).steps) == 1
            if not alone:
                yield Finding(chart.place_of(step), "no transition leaves the step: the chart stays in it")


def _sinks(chart: CheckedChart) -> Iterator[Finding]:
    for sheet in chart.sheets:
        lost = jumping_nowhere(sheet)
        for transition in sheet.transitions:
            if transition.sources and not transition.targets and transition.id not in lost:
                yield Finding(sheet.at(transition), "the transition leads nowhere: what was active before it just ends")


def _sources(chart: CheckedChart) -> Iterator[Finding]:
    for sheet in chart.sheets:
        for transition in sheet.transitions:
            if not transition.sources:
                yield Finding(sheet.at(transition), "no step leads to the transition")


STR09 = Rule(
    code="STR09",
    title="Every step is left",
    why="A chart that comes to a step without a transition stays in it. That may be meant (a chart that runs once); "
    "CODESYS cannot draw it, and S7-GRAPH wants a transition with a sequence end behind every last step.",
    hint="Add the transition that leads on, or a jump to the start.",
    example="""
INITIAL_STEP S1: END_STEP
STEP S2: END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
""",
    check=_dead_ends,
    severity=Severity.WARNING,
    severities={
        "codesys": Severity.ERROR,
        "codesys23": Severity.ERROR,
        "s7graph": Severity.ERROR,
        "grafcet": Severity.INFO,
    },
)

STR11 = Rule(
    code="STR11",
    title="A step leads to every transition",
    why="Without one a transition is never enabled; CODESYS leaves such remains behind branches whose legs all end in "
    "jumps. In GRAFCET it is a source transition, which is always enabled, and legal.",
    hint="Connect it to a step, or remove it with what follows it.",
    example="a transition with no wire above it",
    check=_sources,
    severity=Severity.WARNING,
    severities={"s7graph": Severity.ERROR, "grafcet": None},
)

STR14 = Rule(
    code="STR14",
    title="Every transition leads to a step",
    why="When it fires, the chart just ends: no step is active any more. S7-GRAPH (sequence end) and GRAFCET (sink "
    "transition) have that; IEC 61131-3 and CODESYS do not.",
    hint="Add a step or a jump behind it.",
    example="""
INITIAL_STEP S1: END_STEP
STEP S2: END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 := b; END_TRANSITION
""",
    check=_sinks,
    severity=Severity.ERROR,
    severities={"s7graph": None, "grafcet": None},
)
