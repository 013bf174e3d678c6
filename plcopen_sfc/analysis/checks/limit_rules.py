"""Limits of step times, of tools and of code: what S7-GRAPH has no room for, and what lowered code does otherwise."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from plcopen_sfc.analysis.checks.checked_chart import CheckedChart, Finding, Rule, ring
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.st.literals import duration_of


def _pairs(chart: CheckedChart) -> Iterator[Finding]:
    net = chart.net
    after = [{target for t in leaving for target in net.transitions[t].targets} for leaving in net.leaving]
    for step in net.steps:
        for other in sorted(after[step.index]):
            if other > step.index and step.index in after[other]:
                message = f"{step.path} and {net.steps[other].path} lead to each other"
                yield Finding(chart.place_of(step), message)


def _loops(chart: CheckedChart) -> Iterator[Finding]:
    for transition in chart.net.transitions:
        if transition.pre & transition.post:
            name = chart.net.names(transition.pre & transition.post)[0]
            yield Finding(chart.place_of(transition), f"the transition leads from {name} to itself")


LOW01 = Rule(
    code="LOW01",
    title="No two steps lead to each other",
    why="In the textbook's chain of reset-dominant flip-flops a step is reset by the step behind it. Where that leads "
    "back, the first step can never be set again: the chain locks. Other lowerings are right.",
    hint="Nothing, unless the chart becomes a classic flip-flop chain: lower it in another way, or insert a step.",
    example=ring(),
    check=_pairs,
    severity=Severity.INFO,
)

LOW02 = Rule(
    code="LOW02",
    title="No transition leads back to its own step",
    why="The step is left and entered at once. Whether its time starts again, its pulses come again and its flip-flop "
    "stays set differs between tools and lowerings.",
    hint="Insert a step, if the step shall be entered again; remove the transition, if not.",
    example="""
INITIAL_STEP S1: END_STEP
STEP S2: END_STEP
STEP S3: END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S2 := r; END_TRANSITION
TRANSITION FROM S2 TO S3 := b; END_TRANSITION
TRANSITION FROM S3 TO S1 := c; END_TRANSITION
""",
    check=_loops,
    severity=Severity.INFO,
)


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


def _nanoseconds(text: str | None) -> int | None:
    """Return a time literal; None for anything else, and for 0, which tools write for no time."""
    return (duration_of(text) or None) if text else None


def _order(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, step in chart.steps():
        greatest = _nanoseconds(step.max_time)
        for what, time in (("minimum", step.min_time), ("warning", step.warning_time)):
            given = _nanoseconds(time)
            if greatest is not None and given is not None and given > greatest:
                message = f"the {what} time {time} is longer than the maximum time {step.max_time}"
                yield Finding(sheet.at(step), message)


TIM01 = Rule(
    code="TIM01",
    title="The maximum time of a step is its longest",
    why="A step that must stay active longer than it may reports an error in every round (CODESYS, minimum and "
    "maximum time); a warning after the error warns of nothing (S7-GRAPH, warning time).",
    hint="Correct one of the times.",
    example="a step with the minimum time T#5s and the maximum time T#3s",
    check=_order,
    severity=Severity.WARNING,
)
