"""Conditions and events of GRAFCET actions, and times of steps."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.analysis.checks.action_targets import Manner, uses
from plcopen_sfc.analysis.checks.checked_chart import CheckedChart
from plcopen_sfc.analysis.checks.rule import Finding, Rule
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_condition, walk
from plcopen_sfc.languages.st.literals import LiteralError, LiteralKind, literal_value
from plcopen_sfc.model.actions import ActionKind
from plcopen_sfc.model.conditions import BodyCondition, Condition, Expression, NamedCondition, WiredCondition
from plcopen_sfc.model.network import Block, Contact, Edge, InputVariable
from plcopen_sfc.model.types import DerivedType, Elementary, ElementaryType, PointerType

_ARROWS = "↑↓"
_EDGES = frozenset(
    {"R_TRIG", "F_TRIG", "RE", "FE", "R_EDGE", "F_EDGE", "RISING", "FALLING", "RISING_EDGE", "FALLING_EDGE"}
)
_CONDITIONAL = frozenset({ActionKind.CONDITIONAL, ActionKind.DELAYED, ActionKind.LIMITED, ActionKind.CONTINUOUS})


def has_edge(condition: Condition | None, chart: CheckedChart) -> bool:
    """Whether a condition watches for a change: ``↑a``, a call or instance of an edge block, an edge in a network."""
    if isinstance(condition, Expression):
        if any(arrow in condition.text for arrow in _ARROWS):
            return True
        tree = parse_condition(condition.text, chart.dialect).tree
        return isinstance(tree, n.Node) and any(_is_edge(node, chart) for node in walk(tree))
    if isinstance(condition, BodyCondition):
        networks = getattr(condition.body, "networks", ())
        return any(_drawn_edge(node) for network in networks for node in network.nodes)
    return isinstance(condition, WiredCondition | NamedCondition)  # drawn beside the chart or elsewhere: let it be


def _is_edge(node: n.Node, chart: CheckedChart) -> bool:
    if isinstance(node, n.Call) and isinstance(node.callee, n.Name):
        return node.callee.identifier.upper() in _EDGES
    if isinstance(node, n.Member) and isinstance(node.base, n.Name):
        type_ = chart.types.get(node.base.identifier.casefold())
        return isinstance(type_, DerivedType) and type_.name.upper() in _EDGES
    return False


def _drawn_edge(node: object) -> bool:
    if isinstance(node, Contact | InputVariable):
        return node.edge is not Edge.NONE
    return isinstance(node, Block) and node.type_name.upper() in _EDGES


def _no_edge(chart: CheckedChart) -> Iterator[Finding]:
    for sheet in chart.sheets:
        for step, association in sheet.actions():
            if association.kind is ActionKind.ON_EVENT and not has_edge(association.condition, chart):
                message = "the event of the action is no edge" if association.condition else "the action has no event"
                yield Finding(sheet.at(step, association), message)


def _edge(chart: CheckedChart) -> Iterator[Finding]:
    for sheet in chart.sheets:
        for step, association in sheet.actions():
            condition = association.condition
            drawn = isinstance(condition, WiredCondition | NamedCondition)
            if association.kind in _CONDITIONAL and condition is not None and not drawn and has_edge(condition, chart):
                yield Finding(sheet.at(step, association), "the condition of a continuous action is an edge")


def _not_boolean(chart: CheckedChart) -> Iterator[Finding]:
    for use in uses(chart):
        if use.manner in (Manner.STORED, Manner.OTHER) or use.association.body is not None or len(use.path) != 1:
            continue
        type_ = chart.types.get(use.path[0])
        named = chart.pou is not None and chart.pou.find_action(use.path[0]) is not None
        if type_ is None or named or isinstance(type_, DerivedType | PointerType):
            continue
        if not (isinstance(type_, ElementaryType) and type_.name is Elementary.BOOL):
            said = type_.name.value if isinstance(type_, ElementaryType) else type_.kind
            yield Finding(use.sheet.at(use.step, use.association), f"{use.name} is no BOOL but {said}")


ACT11 = Rule(
    code="ACT11",
    title="The event of a stored action is an edge",
    why="An action on event writes its operand once, when the event comes while the step is active (IEC 60848:2013, "
    "4.8). A condition that is just true is no event: it would have to be written all the time, or never.",
    hint="Watch for the change: ↑a instead of a.",
    example="an action on the event a, instead of ↑a",
    check=_no_edge,
    severity=None,
    severities={"grafcet": Severity.ERROR},
)

ACT12 = Rule(
    code="ACT12",
    title="The condition of a continuous action is no edge",
    why="A continuous action is assigned in stable situations, and an edge is over before: it would never be seen "
    "(IEC 60848:2013, 4.8).",
    hint="Use an action on event, or the value itself.",
    example="a continuous action with the condition ↑a",
    check=_edge,
    severity=None,
    severities={"grafcet": Severity.ERROR},
)

ACT13 = Rule(
    code="ACT13",
    title="The operand of an action is Boolean",
    why="A step switches a Boolean variable or runs an action (IEC 61131-3 ed. 3, 6.7.4). Other values are assigned "
    "by stored actions, or in the code of an action.",
    hint="Use a BOOL, or assign the value in an action.",
    example="""
VAR level : INT; END_VAR
INITIAL_STEP S1: level(N); END_STEP
STEP S2: END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S1 := b; END_TRANSITION
""",
    check=_not_boolean,
    severity=Severity.ERROR,
)


def _nanoseconds(text: str | None) -> int | None:
    """A time literal; None for anything else, and for 0, which tools write for no time."""
    if not text:
        return None
    try:
        found = literal_value(text)
    except LiteralError:
        return None
    return found.value if found.kind is LiteralKind.DURATION and isinstance(found.value, int) and found.value else None


def _order(chart: CheckedChart) -> Iterator[Finding]:
    for sheet in chart.sheets:
        for step in sheet.steps:
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
