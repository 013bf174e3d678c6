"""Where charts start: initial steps."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.analysis.checks.charts import CheckedChart, Sheet
from plcopen_sfc.analysis.checks.rules import Finding, Rule
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.model.sfc import PartialChartKind, Step


def _start_by_themselves(chart: CheckedChart) -> Iterator[Sheet]:
    """The networks that are started with the program, not by a macro-step, an enclosing step or a forcing order."""
    forced = {
        association.forcing.chart.casefold()
        for sheet in chart.sheets
        for _, association in sheet.actions()
        if association.forcing is not None
    }
    for sheet in chart.sheets:
        if sheet.macro is None and sheet.steps:
            partial = sheet.partial
            if partial is None or (partial.kind is PartialChartKind.GLOBAL and partial.name.casefold() not in forced):
                yield sheet


def _connected(sheet: Sheet) -> list[list[Step]]:
    """The steps of a network, by the parts of it that no transition joins."""
    above: dict[int, int] = {step.id: step.id for step in sheet.steps}

    def root(number: int) -> int:
        while above[number] != number:
            above[number] = number = above[above[number]]
        return number

    for transition in sheet.transitions:
        beside = [root(i) for i in (*transition.sources, *transition.targets) if i in above]
        for other in beside[1:]:
            above[root(other)] = root(beside[0])
    parts: dict[int, list[Step]] = {}
    for step in sheet.steps:
        parts.setdefault(root(step.id), []).append(step)
    return list(parts.values())


def _none(chart: CheckedChart) -> Iterator[Finding]:
    for sheet in _start_by_themselves(chart):
        if not any(step.initial for step in sheet.steps):
            starts = "it starts with its first step" if chart.family == "s7graph" else "the chart never starts"
            yield Finding(sheet.place, f"no step is initial: {starts}")
            continue
        for number, sequence in enumerate(sheet.chart.sequences, start=1):
            inside = [step for step in sheet.steps if step.id in set(sequence.steps)]
            if inside and not any(step.initial for step in inside):
                message = f"no step of sequence {number} is initial: it starts with its first step"
                yield Finding(sheet.at(inside[0]), message)


def _several(chart: CheckedChart) -> Iterator[Finding]:
    for sheet in chart.sheets:
        for steps in _connected(sheet):
            initial = [step for step in steps if step.initial]
            for step in initial[1:]:
                message = f"a second initial step in one connected chart, besides {initial[0].name}"
                yield Finding(sheet.at(step), message)


_TWO = """
INITIAL_STEP S1: END_STEP
INITIAL_STEP S2: END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S1 := b; END_TRANSITION
"""

STR02 = Rule(
    code="STR02",
    title="A chart has an initial step",
    why="Without one no step is ever active (IEC 61131-3 ed. 3, 6.7.2; IEC 60848:2013, 4). S7-GRAPH then starts with "
    "the first step of the sequence.",
    hint="Mark the step in which the chart starts.",
    example="""
STEP S1: END_STEP
STEP S2: END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S1 := b; END_TRANSITION
""",
    check=_none,
    severity=Severity.ERROR,
    severities={"s7graph": Severity.WARNING},
)

STR12 = Rule(
    code="STR12",
    title="A connected chart has one initial step",
    why="IEC 61131-3 (ed. 3, 6.7.2) wants exactly one in each network; tools refuse the chart, or start with one of "
    "them. GRAFCET and S7-GRAPH allow several.",
    hint="Make the others ordinary steps, and reach them by a simultaneous divergence.",
    example=_TWO,
    check=_several,
    severity=Severity.ERROR,
    severities={"s7graph": None, "grafcet": None},
)
