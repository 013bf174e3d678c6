"""Selections: transitions that leave the same step."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

from plcopen_sfc.analysis.answers import Answer
from plcopen_sfc.analysis.checks.checked_chart import CheckedChart, Sheet
from plcopen_sfc.analysis.checks.rule import Finding, Rule
from plcopen_sfc.analysis.exclusivity import Truth, covered, exclusive
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.model.sfc import Step, Transition


def _selections(chart: CheckedChart) -> Iterator[tuple[Sheet, Step, list[Transition]]]:
    """Each step with several transitions that leave it, in the order in which they are tried."""
    for sheet in chart.sheets:
        for step in sheet.steps:
            leaving = sheet.leaving.get(step.id, [])
            if len(leaving) > 1:
                yield sheet, step, leaving


def _competing(chart: CheckedChart) -> Iterator[tuple[Sheet, Step, Transition, Transition, Answer, str]]:
    """Pairs of competing transitions that only their conditions keep apart, and whether these exclude each other."""
    seen: set[tuple[int, int]] = set()
    for sheet, step, leaving in _selections(chart):
        for first, second in combinations(leaving, 2):
            if first.priority is not None and second.priority is not None and first.priority != second.priority:
                continue
            if (id(first), id(second)) in seen:
                continue
            seen.add((id(first), id(second)))
            conditions = [chart.condition(sheet, t) for t in (first, second)]
            found = exclusive(*conditions, dialect=chart.dialect, knowledge=chart.knowledge)
            yield sheet, step, first, second, found.answer, _witness(found.witness) or found.reason


def _witness(witness: object) -> str:
    """A situation in words: ``a, NOT b, level = 3``."""
    if not isinstance(witness, dict):
        return ""
    words = [
        (name if value else f"NOT {name}") if isinstance(value, bool) else f"{name} = {value}"
        for name, value in sorted(witness.items())
    ]
    return ", ".join(words)


def _overlapping(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, step, first, second, answer, why in _competing(chart):
        if answer is Answer.NO:
            other = sheet.label(first)
            message = f"it can be true together with {other}, which leaves {step.name} too"
            yield Finding(sheet.at(second), f"{message}: {chart.as_written(why)}" if why else message)


def _undecided(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, step, first, second, answer, why in _competing(chart):
        if answer is Answer.UNKNOWN:
            other = sheet.label(first)
            message = f"nobody can tell whether it excludes {other}, which leaves {step.name} too"
            yield Finding(sheet.at(second), f"{message}: {why}" if why else message)


def _shadowed(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, step, leaving in _selections(chart):
        for place, later in enumerate(leaving[1:], start=1):
            before = [t for t in leaving[:place] if set(t.sources) <= set(later.sources)]
            if not before or chart.truth(sheet, later) is Truth.NEVER:
                continue
            conditions = [chart.condition(sheet, t) for t in (later, *before)]
            if covered(conditions[0], conditions[1:], dialect=chart.dialect, knowledge=chart.knowledge) is Answer.YES:
                names = ", ".join(sheet.label(t) for t in before)
                message = f"whenever its condition is true, one tried before it is: {names} (from {step.name})"
                yield Finding(sheet.at(later), message)


def _same_priority(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, step, leaving in _selections(chart):
        first: dict[int, Transition] = {}
        for transition in leaving:
            if transition.priority is not None and transition.priority in first:
                other = sheet.label(first[transition.priority])
                message = f"it has the priority {transition.priority}, as {other} has, which leaves {step.name} too"
                yield Finding(sheet.at(transition), message)
            elif transition.priority is not None:
                first[transition.priority] = transition


SEL01 = Rule(
    code="SEL01",
    title="The branches of a selection exclude each other",
    why="When two conditions are true at once, GRAFCET and matiec fire both transitions: two steps are active where "
    "one was (IEC 60848:2013, evolution rule 4). IEC 61131-3 takes the left one where no priorities are given, and "
    "older implementations did not. CODESYS and S7-GRAPH always take the left one.",
    hint="Make the conditions exclude each other (a, NOT a AND b), or give the transitions priorities.",
    example="""
INITIAL_STEP S1: END_STEP
STEP S2: END_STEP
STEP S3: END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S1 TO S3 := b; END_TRANSITION
TRANSITION FROM S2 TO S1 := c; END_TRANSITION
TRANSITION FROM S3 TO S1 := d; END_TRANSITION
""",
    check=_overlapping,
    severity=None,
    severities={"iec": Severity.INFO, "grafcet": Severity.ERROR, "matiec": Severity.ERROR, "beremiz": Severity.ERROR},
)

SEL02 = Rule(
    code="SEL02",
    title="It can be decided whether the branches of a selection exclude each other",
    why="Conditions with calls or arithmetic are not decided: whether they exclude each other is left to the author.",
    hint="Look at the conditions; write them as comparisons with constants, or give the transitions priorities.",
    example="""
INITIAL_STEP S1: END_STEP
STEP S2: END_STEP
STEP S3: END_STEP
TRANSITION FROM S1 TO S2 := level * 2 > limit; END_TRANSITION
TRANSITION FROM S1 TO S3 := level * 3 < limit; END_TRANSITION
TRANSITION FROM S2 TO S1 := c; END_TRANSITION
TRANSITION FROM S3 TO S1 := d; END_TRANSITION
""",
    check=_undecided,
    severity=None,
    severities={"grafcet": Severity.WARNING, "matiec": Severity.WARNING, "beremiz": Severity.WARNING},
)

SEL03 = Rule(
    code="SEL03",
    title="No branch of a selection hides another",
    why="Whenever its condition is true, that of a branch which is tried before it is true as well: this branch is "
    "never taken.",
    hint="Change the order, or the condition of the first.",
    example="""
INITIAL_STEP S1: END_STEP
STEP S2: END_STEP
STEP S3: END_STEP
TRANSITION FROM S1 TO S2 := a OR b; END_TRANSITION
TRANSITION FROM S1 TO S3 := a AND c; END_TRANSITION
TRANSITION FROM S2 TO S1 := c; END_TRANSITION
TRANSITION FROM S3 TO S1 := d; END_TRANSITION
""",
    check=_shadowed,
    severity=Severity.WARNING,
    severities={"grafcet": None, "matiec": None, "beremiz": None},
)

SEL04 = Rule(
    code="SEL04",
    title="Competing transitions have different priorities",
    why="Priorities decide which of several transitions is tried first (IEC 61131-3 ed. 3, 6.7.5). Between two with "
    "the same one the order in the file decides, or the tool.",
    hint="Number them in the order in which they shall be tried.",
    example="""
INITIAL_STEP S1: END_STEP
STEP S2: END_STEP
STEP S3: END_STEP
TRANSITION (PRIORITY := 1) FROM S1 TO S2 := a; END_TRANSITION
TRANSITION (PRIORITY := 1) FROM S1 TO S3 := b; END_TRANSITION
TRANSITION FROM S2 TO S1 := c; END_TRANSITION
TRANSITION FROM S3 TO S1 := d; END_TRANSITION
""",
    check=_same_priority,
    severity=Severity.WARNING,
)
