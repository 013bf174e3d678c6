"""Rules about variables that several steps write in one evolution, and about code that writes what others keep."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import reduce
from itertools import combinations, product
from operator import or_

from plcopen_sfc.analysis.checks.action_targets import (
    Manner,
    body_named,
    how,
    operand,
    path_of_part,
    uses,
    written,
)
from plcopen_sfc.analysis.checks.checked_chart import CheckedChart, Finding, FindingPlace, Rule, ring
from plcopen_sfc.analysis.exclusivity import exclusive
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.effects import Path
from plcopen_sfc.languages.networks import NetworkExpression
from plcopen_sfc.languages.st import parse_condition, print_node
from plcopen_sfc.languages.st.nodes import Expression
from plcopen_sfc.model.actions import ActionKind
from plcopen_sfc.model.conditions import Expression as ConditionText
from plcopen_sfc.model.sfc import ActionAssociation, Body
from plcopen_sfc.reachability import reached
from plcopen_sfc.semantics.charts.grafcet.grafcet_program import STORED
from plcopen_sfc.semantics.net import NetStep, NetTransition
from plcopen_sfc.semantics.profile import BooleanTargets

_MOST_WRITERS = 40
"""Writers of one variable that are compared with each other."""


@dataclass(frozen=True, eq=False)
class _Write:
    """A step that assigns a value to a variable: the literal, or "" where it is not one.

    `joined`: by a continuous action, which tools join with others by OR.
    """

    step: NetStep
    place: FindingPlace
    path: Path
    name: str
    value: str
    association: ActionAssociation | None
    action: str = ""
    in_code: bool = False
    joined: bool = False

    @property
    def kind(self) -> ActionKind | None:
        """The kind of its action in IEC 60848."""
        return self.association.kind if self.association is not None else None


def _writes(chart: CheckedChart) -> Iterator[_Write]:
    """Return the writes of steps, by associations and in code."""
    of_step = grouped((id(net_step.step), net_step) for net_step in chart.net.steps)
    kept = {Manner.SET: "TRUE", Manner.RESET: "FALSE"}
    for use in uses(chart):
        joined = use.manner is Manner.CONTINUOUS and use.association.kind is None
        path = path_of_part(parse_condition(use.name, chart.dialect).tree)
        if path and (joined or use.manner in (*kept, Manner.STORED)):
            value = "TRUE" if joined else kept.get(use.manner) or _literal(use.association.value, chart)
            place = use.sheet.at(use.step, use.association)
            for step in of_step.get(id(use.step), ()):
                yield _Write(step, place, path, use.name, value, use.association, joined=joined)
    for sheet, own in chart.steps():
        bodies: list[tuple[ActionAssociation | None, Body | None]] = [
            (each, each.body or body_named(each.target, chart)) for each in own.actions
        ]
        main = own.main_action
        bodies.append((None, body_named(main, chart) if isinstance(main, str) else main))
        for each, body in bodies:
            action = each.target or "" if each is not None else ""
            for target, path, value in written(body, chart):
                for step in of_step.get(id(own), ()):
                    name = print_node(target)
                    yield _Write(step, sheet.at(own, each), path, name, value, each, action, in_code=True)


def _overwritten(chart: CheckedChart) -> Iterator[Finding]:
    if chart.profile.boolean_targets is BooleanTargets.WHEN_DECIDED:
        return  # stored actions are coils there
    stored = {use.path: use for use in uses(chart) if use.manner is Manner.SET and use.association.kind is None}
    reported: set[str] = set()
    for write in _writes(chart):
        use = stored.get(write.path)
        if use is None or not write.in_code or write.place.path in reported:
            continue
        reported.add(write.place.path)
        yield Finding(write.place, f"{write.name} is assigned here, and stored ({how(use)}) in step {use.step.name}")


def _literal(value: str | None, chart: CheckedChart) -> str:
    if value is None:
        return "TRUE"
    path = operand(value, chart)
    return "" if path else value.strip().upper()


def _races(chart: CheckedChart) -> Iterator[Finding]:
    for writes in grouped((write.path, write) for write in _writes(chart)).values():
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
    """Return True if it makes a difference which of two writes comes last."""
    if first.action and first.action.casefold() == second.action.casefold():
        return False  # one action, which runs once however many steps ask for it
    if (first.joined and not second.in_code) or (second.joined and not first.in_code):
        return False  # of continuous and stored actions other rules tell
    return not first.value or first.value != second.value


def _together(chart: CheckedChart, first: _Write, second: _Write) -> str:
    """Return when both are written in one evolution; empty: never, or that is not known."""
    if ActionKind.ON_EVENT in (first.kind, second.kind) and first.kind in STORED and second.kind in STORED:
        return _with_event(chart, first, second)
    if first.kind in STORED and second.kind in STORED:
        return _at_once(chart, first, second)
    if first.step is second.step:
        return ""  # in the order of the text
    if chart.concurrent(first.step, second.step):
        return "and both can be active together"
    return ""


def _with_event(chart: CheckedChart, first: _Write, second: _Write) -> str:
    """Return when two stored actions happen of which an event brings at least one."""
    event, other = (first, second) if first.kind is ActionKind.ON_EVENT else (second, first)
    if other.kind is ActionKind.ON_EVENT:
        beside = chart.concurrent(first.step, second.step)  # in one step in the order of the text
        term = _event(chart, other)
        return "and both events can come at once" if beside and (term is None or _meets(chart, event, term)) else ""
    situations = chart.situations if chart.net.hierarchy else chart.graph
    for transition in (chart.net.transitions[cause] for cause in sorted(_causes(chart, other))):
        before = transition.pre | event.step.bit
        beside = any(not before & ~situation for situation in situations) and all(
            source == event.step.index or chart.concurrent(event.step, chart.net.steps[source])
            for source in transition.sources
        )
        if beside and _meets(chart, event, chart.condition(chart.sheet_of(transition), transition.transition)):
            return f"and the event can come when {transition.path} is cleared"
    return ""


def _event(chart: CheckedChart, write: _Write) -> Expression | None:
    """Return the event that brings a stored action; None where it cannot be read."""
    condition = write.association.condition if write.association is not None else None
    return chart.term(condition) if isinstance(condition, ConditionText) else None


def _meets(chart: CheckedChart, event: _Write, condition: NetworkExpression | Expression) -> bool:
    """Return True if an event can come while a condition is TRUE."""
    term = _event(chart, event)
    return term is None or not exclusive(term, condition, dialect=chart.dialect, knowledge=chart.knowledge)


def _at_once(chart: CheckedChart, first: _Write, second: _Write) -> str:
    """Return how transitions that let both happen can be cleared in one evolution; empty if they cannot."""
    of_first, of_second = _causes(chart, first), _causes(chart, second)
    for cause in sorted(of_first & of_second):
        one = chart.net.transitions[cause]
        if not chart.net.hierarchy or _both_happen(chart, (first, second), one):
            return f"and both happen when {one.path} is cleared"
    for a, b in product(sorted(of_first), sorted(of_second)):
        one, other = chart.net.transitions[a], chart.net.transitions[b]
        if a == b or one.pre & other.pre or not chart.fires_with(one, other):
            continue
        if chart.net.hierarchy:
            together = _both_happen(chart, (first, second), one, other)
        else:
            together = chart.graph.complete and any(not (one.pre | other.pre) & ~marking for marking in chart.graph)
        if together:
            return f"and {one.path} and {other.path} can be cleared together"
    return ""


def _both_happen(chart: CheckedChart, writes: tuple[_Write, _Write], *fired: NetTransition) -> bool:
    """Return True if both actions happen when transitions are cleared, as the hierarchy of charts has it."""
    targets = reduce(or_, (transition.post for transition in fired))
    sources = reduce(or_, (transition.pre for transition in fired))
    for before in chart.situations:
        after = chart.situations.after(before, *fired)
        if after is None:
            continue
        activated, left = after & (targets | ~before), before & (sources | ~after)
        if all(w.step.bit & (activated if w.kind is ActionKind.ON_ACTIVATION else left) for w in writes):
            return True
    return False


def _causes(chart: CheckedChart, write: _Write) -> set[int]:
    """Return the transitions that let a stored action happen, also by activating or leaving an enclosing step."""
    activation = write.kind is ActionKind.ON_ACTIVATION
    beside = chart.net.entering if activation else chart.net.leaving
    steps = chart.net.steps
    around = reached(
        [write.step.index], lambda step: [each.index for each in _around(chart, steps[step], activation=activation)]
    )
    found = {cause for step in around for cause in beside[step]}
    orders = (order for step in around for order in _forcing(chart, steps[step]))
    return found.union(cause for order in orders for cause in chart.net.entering[order.index])


def _forcing(chart: CheckedChart, step: NetStep) -> Iterator[NetStep]:
    """Yield the steps with orders that force the chart of a step."""
    partial = chart.sheet_of(step).partial
    if partial is not None:
        for other in chart.net.steps:
            orders = (each.forcing for each in other.step.actions if each.forcing is not None)
            if any(order.chart.casefold() == partial.name.casefold() for order in orders):
                yield other


def _around(chart: CheckedChart, step: NetStep, *, activation: bool) -> Iterator[NetStep]:
    """Yield the enclosing steps that deactivate a step when they are left, or activate it when they are entered."""
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
    "of network numbers. Loops and outputs of calls write too, and a timer, a counter or another standard block that "
    "several steps call with other arguments is written by each. In GRAFCET all stored actions of one evolution happen "
    "at once, those of the step that is left and those of the step that is entered too (IEC 60848:2013, 4.8).",
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


ACT19 = Rule(
    code="ACT19",
    title="Code does not assign what a stored action keeps",
    why="A stored action stays active when its step is left, and writes its variable TRUE in every scan until an R of "
    "the same action (IEC 61131-3 ed. 3, 6.7.4.6; CODESYS V3 does the same). Assignments of code in between are lost, "
    "also FALSE. In S7-GRAPH S is a coil: there the assignment counts.",
    hint="End it with an R, or set it in code too: a P1 action with an assignment.",
    example=ring("Off(N);", "q(S);") + "ACTION Off: q := FALSE; END_ACTION\n",
    check=_overwritten,
    severity=Severity.WARNING,
    severities={"s7graph": None, "grafcet": None, "matiec": None, "beremiz": None},
)
