"""Where charts start and end: initial steps, steps that nothing leaves, and those that nothing enters."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.analysis.checks.checked_chart import CheckedChart, Sheet
from plcopen_sfc.analysis.checks.connection_rules import jumping_nowhere
from plcopen_sfc.analysis.checks.rule import Finding, Rule
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
    why="Without one a transition is never enabled; CODESYS leaves such remains behind divergences whose branches all "
    "end in jumps. In GRAFCET it is a source transition, which is always enabled, and legal.",
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
