"""Names and numbers of steps and transitions."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.analysis.checks.checked_chart import CheckedChart, Sheet
from plcopen_sfc.analysis.checks.rule import Finding, Rule
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression
from plcopen_sfc.model.sfc import Step, Transition
from plcopen_sfc.model.types import DerivedType


def _duplicates(chart: CheckedChart) -> Iterator[Finding]:
    for sheet in chart.sheets:
        seen: dict[str, str] = {}
        for step in sheet.steps:
            key = step.name.casefold()
            if key in seen and key:
                yield Finding(sheet.at(step), f"another step of the chart is called {seen[key]!r}, too")
            seen.setdefault(key, step.name)


def _identifiers(chart: CheckedChart) -> Iterator[Finding]:
    for sheet in chart.sheets:
        for step in sheet.steps:
            if not _is_identifier(step.name, chart):
                said = f"the name {step.name!r} is no identifier" if step.name.strip() else "the step has no name"
                yield Finding(sheet.at(step), said)


def _is_identifier(name: str, chart: CheckedChart) -> bool:
    """Whether a text is a name on its own: no keyword, no blanks, nothing around it."""
    parsed = parse_expression(name, chart.dialect)
    return not parsed.problems and isinstance(parsed.tree, n.Name) and parsed.tree.identifier == name


def _clashes(chart: CheckedChart) -> Iterator[Finding]:
    if chart.pou is None:
        return
    taken: dict[str, str] = {action.name.casefold(): "an action" for action in chart.pou.actions}
    taken |= {named.name.casefold(): "a transition" for named in chart.pou.transitions}
    for variable in chart.pou.variables():
        type_ = variable.type
        if not (isinstance(type_, DerivedType) and type_.name.upper().startswith(_OF_STEPS)):
            taken[variable.name.casefold()] = "a variable"
    for sheet in chart.sheets:
        for step in sheet.steps:
            if step.name.casefold() in taken:
                yield Finding(sheet.at(step), f"the POU has {taken[step.name.casefold()]} of the same name")


_OF_STEPS = ("G7_", "SFCSTEPTYPE")
"""The types of variables that tools declare for steps and transitions."""


def _numbers(chart: CheckedChart) -> Iterator[Finding]:
    for sheet in chart.sheets:
        groups: list[tuple[str, list[Step] | list[Transition]]] = [
            ("step", list(sheet.steps)),
            ("transition", list(sheet.transitions)),
        ]
        for kind, elements in groups:
            yield from _repeated(sheet, kind, elements)


def _repeated(sheet: Sheet, kind: str, elements: list[Step] | list[Transition]) -> Iterator[Finding]:
    seen: set[int] = set()
    for element in elements:
        if element.number in seen:
            yield Finding(sheet.at(element), f"another {kind} has the number {element.number}, too")
        elif element.number is not None:
            seen.add(element.number)


def _together(chart: CheckedChart) -> Iterator[Finding]:
    """S7-GRAPH declares a variable for each step and transition."""
    for sheet in chart.sheets:
        seen = {step.name.casefold(): "a step" for step in sheet.steps}
        for transition in sheet.transitions:
            key = transition.name.casefold()
            if key in seen:
                yield Finding(sheet.at(transition), f"{seen[key]} of the block has the name {transition.name!r}, too")
            elif key:
                seen[key] = "a transition"


NAM01 = Rule(
    code="NAM01",
    title="Step names are unique in a chart",
    why="Jumps and step variables mean the first of them; tools refuse the chart. Case does not matter.",
    hint="Rename one of them.",
    example="""
INITIAL_STEP S1: END_STEP
STEP Wait: END_STEP
STEP WAIT: END_STEP
TRANSITION FROM S1 TO Wait := a; END_TRANSITION
TRANSITION FROM Wait TO S1 := b; END_TRANSITION
""",
    check=_duplicates,
    severity=Severity.ERROR,
)

NAM02 = Rule(
    code="NAM02",
    title="Step names are identifiers",
    why="A step declares variables of its name (S3.X, S3.T), so that it must be an identifier of IEC 61131-3 and no "
    "keyword. S7-GRAPH allows blanks and parentheses, GRAFCET has numbers.",
    hint="Use letters, digits and underscores, a letter first.",
    example="a step called Wait for part",
    check=_identifiers,
    severity=Severity.ERROR,
    severities={"s7graph": None, "grafcet": None},
)

NAM03 = Rule(
    code="NAM03",
    title="Steps share their names with nothing in the POU",
    why="The step declares a variable of its name; a declared variable, an action or a transition of the same name "
    "hides it, or is hidden by it.",
    hint="Rename one of them.",
    example="""
VAR Fill : BOOL; END_VAR
INITIAL_STEP S1: END_STEP
STEP Fill: END_STEP
TRANSITION FROM S1 TO Fill := a; END_TRANSITION
TRANSITION FROM Fill TO S1 := b; END_TRANSITION
""",
    check=_clashes,
    severity=Severity.ERROR,
    severities={"grafcet": None},
)

NAM04 = Rule(
    code="NAM04",
    title="Numbers are unique",
    why="S7-GRAPH knows steps and transitions by their numbers, and GRAFCET draws steps by them.",
    hint="Renumber one of them.",
    example="two steps with the number 3",
    check=_numbers,
    severity=Severity.WARNING,
    severities={"s7graph": Severity.ERROR},
)

NAM05 = Rule(
    code="NAM05",
    title="Steps and transitions of S7-GRAPH have names of their own",
    why="The block declares a static variable for each of them, in one scope.",
    hint="Rename one of them.",
    example="a transition called Step1 in a block with a step Step1",
    check=_together,
    severity=None,
    severities={"s7graph": Severity.ERROR},
)
