"""Steps that are active together and write the same variable."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

from plcopen_sfc.analysis.checks.action_targets import Manner, assignments, body_named, constant, operand, uses
from plcopen_sfc.analysis.checks.checked_chart import CheckedChart, FindingPlace
from plcopen_sfc.analysis.checks.rule import Finding, Rule
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.languages.st.effects import Path, path_of
from plcopen_sfc.model.actions import ActionKind
from plcopen_sfc.semantics.net import NetStep

_MOST_WRITERS = 40
"""Writers of one variable that are compared with each other."""


@dataclass(frozen=True, eq=False)
class _Write:
    """A step that assigns a value to a variable: the literal, or "" where it is not one."""

    step: NetStep
    place: FindingPlace
    path: Path
    name: str
    value: str
    action: str = ""
    kind: ActionKind | None = None


def _writes(chart: CheckedChart) -> Iterator[_Write]:
    """What steps assign, by associations and in the code of their actions. Continuous actions are joined by OR."""
    of_step: dict[int, list[NetStep]] = {}
    for net_step in chart.net.steps:
        of_step.setdefault(id(net_step.step), []).append(net_step)
    kept = {Manner.SET: "TRUE", Manner.RESET: "FALSE"}
    for use in uses(chart):
        if use.manner in (*kept, Manner.STORED):
            value = kept.get(use.manner) or _literal(use.association.value, chart)
            place = use.sheet.at(use.step, use.association)
            for step in of_step.get(id(use.step), ()):
                yield _Write(step, place, use.path, use.name, value, kind=use.association.kind)
    for sheet in chart.sheets:
        for own in sheet.steps:
            bodies = [(sheet.at(own, a), a.body or body_named(a.target, chart), a.target or "") for a in own.actions]
            main = own.main_action
            bodies.append((sheet.at(own), body_named(main, chart) if isinstance(main, str) else main, ""))
            for place, body, action in bodies:
                for assigned in assignments(body, chart):
                    path = path_of(assigned.target)
                    if path and isinstance(n.bare(assigned.target), n.Name | n.Member | n.Address):
                        name = print_node(assigned.target, chart.dialect)
                        for step in of_step.get(id(own), ()):
                            yield _Write(step, place, path, name, constant(assigned.value), action)


def _literal(value: str | None, chart: CheckedChart) -> str:
    if value is None:
        return "TRUE"
    path = operand(value, chart)
    return "" if path else value.strip().upper()


def _races(chart: CheckedChart) -> Iterator[Finding]:
    by_path: dict[Path, list[_Write]] = {}
    for write in _writes(chart):
        by_path.setdefault(write.path, []).append(write)
    for writes in by_path.values():
        reported: set[tuple[str, str]] = set()
        for first, second in combinations(writes[:_MOST_WRITERS], 2):
            pair = (first.place.path, second.place.path)
            if pair in reported or not _differ(first, second):
                continue
            when = _together(chart, first, second)
            if when:
                reported.add(pair)
                message = f"{second.name} is written here and in step {first.step.path}, {when}"
                yield Finding(second.place, message)


def _differ(first: _Write, second: _Write) -> bool:
    """Whether it makes a difference which of two writes comes last."""
    if first.action and first.action.casefold() == second.action.casefold():
        return False  # one action, which runs once however many steps ask for it
    return not first.value or first.value != second.value


def _together(chart: CheckedChart, first: _Write, second: _Write) -> str:
    """When both are written in one evolution; empty: never, or nobody knows."""
    moment = {ActionKind.ON_ACTIVATION, ActionKind.ON_DEACTIVATION}
    if first.kind in moment and second.kind in moment:
        return _at_once(chart, first, second)
    if first.step is second.step:
        return ""  # in the order in which they stand
    if chart.graph.complete and chart.graph.concurrent(first.step, second.step):
        return "and both can be active together"
    return ""


def _at_once(chart: CheckedChart, first: _Write, second: _Write) -> str:
    """Whether transitions that let both happen can be cleared in one evolution."""
    net = chart.net
    for a in _causes(chart, first):
        for b in _causes(chart, second):
            if a == b:
                return f"and both happen when {net.transitions[a].path} is cleared"
            both = net.transitions[a].pre | net.transitions[b].pre
            apart = not net.transitions[a].pre & net.transitions[b].pre
            if apart and chart.graph.complete and any(not both & ~marking for marking in chart.graph):
                return f"and {net.transitions[a].path} and {net.transitions[b].path} can be cleared together"
    return ""


def _causes(chart: CheckedChart, write: _Write) -> set[int]:
    """The transitions that let a stored action happen, also by activating or leaving an enclosing step."""
    activation = write.kind is ActionKind.ON_ACTIVATION
    beside = chart.net.entering if activation else chart.net.leaving
    found: set[int] = set()
    waiting, seen = [write.step], {write.step.index}
    while waiting:
        step = waiting.pop()
        found.update(beside[step.index])
        for upper in _around(chart, step, activation=activation):
            if upper.index not in seen:
                seen.add(upper.index)
                waiting.append(upper)
    return found


def _around(chart: CheckedChart, step: NetStep, *, activation: bool) -> Iterator[NetStep]:
    """The enclosing steps that deactivate a step when they are left, or activate it when they are entered."""
    partial = chart.sheet_of(step).partial
    if partial is None:
        return
    for upper in chart.net.steps:
        for enclosure in upper.step.encloses or ():
            linked = {name.casefold() for name in enclosure.activated_steps}
            here = enclosure.chart.casefold() == partial.name.casefold()
            if here and (not activation or step.step.name.casefold() in linked):
                yield upper


ACT04 = Rule(
    code="ACT04",
    title="Steps that are active together do not write the same variable",
    why="Which of them comes last decides, and that is the tool's affair: the order of steps in the file, of names, "
    "of network numbers. In GRAFCET all stored actions of one evolution happen at once, those of the step that is "
    "left and those of the step that is entered too (IEC 60848:2013, 4.8).",
    hint="Let one place write the variable; let the steps set variables of their own, and join these.",
    example="""
INITIAL_STEP S1: END_STEP
STEP A: q(S); END_STEP
STEP B: q(R); END_STEP
TRANSITION FROM S1 TO (A, B) := a; END_TRANSITION
TRANSITION FROM (A, B) TO S1 := b; END_TRANSITION
""",
    check=_races,
    severity=Severity.WARNING,
)
