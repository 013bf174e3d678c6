"""Macro-steps, enclosing steps and forcing orders."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

from plcopen_sfc.analysis.checks.checked_chart import CheckedChart, FindingPlace, Sheet
from plcopen_sfc.analysis.checks.rule import Finding, Rule
from plcopen_sfc.analysis.regions import Obstacle, Unstructured, find_regions
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.model.actions import ForcedSituation, ForcingOrder
from plcopen_sfc.model.sfc import PartialChart, PartialChartKind, Step
from plcopen_sfc.semantics.net import NetProblemKind, NetStep

_MACROS = frozenset(NetProblemKind) - {NetProblemKind.MISSING_SOURCE, NetProblemKind.MISSING_TARGET}


def _partials(chart: CheckedChart) -> dict[str, PartialChart]:
    return {partial.name.casefold(): partial for partial in reversed(chart.chart.partial_charts)}


def _orders(chart: CheckedChart) -> Iterator[tuple[Sheet, Step, FindingPlace, ForcingOrder]]:
    """The forcing orders, with the steps that give them."""
    for sheet in chart.sheets:
        for step, association in sheet.actions():
            if association.forcing is not None:
                yield sheet, step, sheet.at(step, association), association.forcing


def _macros(chart: CheckedChart) -> Iterator[Finding]:
    places = {id(sheet.chart): sheet for sheet in reversed(chart.sheets)}
    for problem in chart.net.problems:
        if problem.kind in _MACROS:
            sheet = places.get(id(problem.chart))
            if sheet is not None:
                yield Finding(sheet.at(problem.element), problem.message)


def _enclosures(chart: CheckedChart) -> Iterator[Finding]:
    partials = _partials(chart)
    enclosed_by: dict[str, str] = {}
    for sheet in chart.sheets:
        for step in sheet.steps:
            for enclosure in step.encloses or ():
                key = enclosure.chart.casefold()
                partial = partials.get(key)
                if partial is None:
                    yield Finding(sheet.at(step), f"the step encloses {enclosure.chart!r}, and there is no such chart")
                    continue
                if key in enclosed_by:
                    message = f"{enclosure.chart} is enclosed by {enclosed_by[key]}, too"
                    yield Finding(sheet.at(step), message)
                enclosed_by.setdefault(key, step.name)
                steps = {inner.name.casefold() for inner in partial.chart.steps}
                for name in enclosure.activated_steps:
                    if name.casefold() not in steps:
                        yield Finding(sheet.at(step), f"{enclosure.chart} has no step {name!r} to activate")
                if not enclosure.activated_steps:
                    yield Finding(sheet.at(step), f"no step of {enclosure.chart} has an activation link")


def _initial_enclosures(chart: CheckedChart) -> Iterator[Finding]:
    partials = _partials(chart)
    for sheet in chart.sheets:
        for step in sheet.steps:
            for enclosure in step.encloses or () if step.initial else ():
                partial = partials.get(enclosure.chart.casefold())
                if partial is not None and not partial.chart.initial_steps:
                    message = f"the step is initial, and {enclosure.chart}, which it encloses, has no initial step"
                    yield Finding(sheet.at(step), message)


def _forced(chart: CheckedChart) -> Iterator[Finding]:
    partials = _partials(chart)
    for sheet, _, place, order in _orders(chart):
        partial = partials.get(order.chart.casefold())
        if partial is None:
            if not _is_whole(sheet, order):
                yield Finding(place, f"the order forces {order.chart!r}, and there is no such chart")
            continue
        steps = {inner.name.casefold() for inner in partial.chart.steps}
        for name in order.steps:
            if name.casefold() not in steps:
                yield Finding(place, f"{order.chart} has no step {name!r} to force")
        if order.situation is ForcedSituation.INITIAL and not partial.chart.initial_steps:
            yield Finding(place, f"{order.chart} has no initial step to force")
        if order.situation is ForcedSituation.EXPLICIT and not order.steps:
            yield Finding(place, "the order names no steps to force")


def _is_whole(sheet: Sheet, order: ForcingOrder) -> bool:
    """Whether an order in a partial chart forces the chart around it, which has no name in the model."""
    return sheet.partial is not None and not order.chart


def _circles(chart: CheckedChart) -> Iterator[Finding]:
    below: dict[str, list[tuple[str, FindingPlace]]] = {}
    for sheet in chart.sheets:
        own = sheet.partial.name.casefold() if sheet.partial is not None else ""
        for step in sheet.steps:
            for enclosure in step.encloses or ():
                below.setdefault(own, []).append((enclosure.chart.casefold(), sheet.at(step)))
    for sheet, _, place, order in _orders(chart):
        own = sheet.partial.name.casefold() if sheet.partial is not None else ""
        below.setdefault(own, []).append((order.chart.casefold(), place))
    for upper, lower in below.items():
        for name, place in lower:
            if upper in _reached(name, below):
                yield Finding(place, "the chart is ruled by one that it rules itself")


def _reached(start: str, below: dict[str, list[tuple[str, FindingPlace]]]) -> set[str]:
    found: set[str] = set()
    waiting = [start]
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            waiting += [lower for lower, _ in below.get(name, ())]
    return found


def _rulers(chart: CheckedChart) -> Iterator[tuple[NetStep, FindingPlace, str, str]]:
    """The steps that rule a partial chart: what they do to it, by its name."""
    of_step: dict[int, NetStep] = {id(step.step): step for step in chart.net.steps}
    for _, step, place, order in _orders(chart):
        if id(step) in of_step:
            yield of_step[id(step)], place, order.chart.casefold(), f"{order.situation}{sorted(order.steps)}"
    for sheet in chart.sheets:
        for step in sheet.steps:
            for enclosure in step.encloses or ():
                if id(step) in of_step:
                    yield of_step[id(step)], sheet.at(step), enclosure.chart.casefold(), "encloses"


def _at_once(chart: CheckedChart) -> Iterator[Finding]:
    if not chart.graph.complete:
        return
    for (first, _, chart_a, what_a), (second, place, chart_b, what_b) in combinations(_rulers(chart), 2):
        if chart_a == chart_b and what_a != what_b and first is not second and chart.graph.concurrent(first, second):
            message = f"step {first.path} rules {chart_a.upper()} as well, and both can be active together"
            yield Finding(place, message)


HIE01 = Rule(
    code="HIE01",
    title="A macro-step has an expansion with one entry and one exit",
    why="The macro-step activates the entry step of its expansion and is left by its exit step (IEC 60848:2013, 7); "
    "without them the chart comes in but never out, or never in.",
    hint="Name the expansion, and give it an entry step E and an exit step S.",
    example="a macro-step M1 for which there is no chart M1",
    check=_macros,
    severity=Severity.ERROR,
)

HIE02 = Rule(
    code="HIE02",
    title="Enclosed charts exist, are enclosed once, and can be activated",
    why="An enclosing step activates the steps of the enclosed chart that have an activation link (*), and "
    "deactivates all of them when it is left (IEC 60848:2013, 7.3).",
    hint="Correct the name of the chart or of the step, or mark the steps that shall be activated.",
    example="a step that encloses G2, whose steps have no activation link",
    check=_enclosures,
    severity=Severity.ERROR,
)

HIE03 = Rule(
    code="HIE03",
    title="An initial enclosing step encloses an initial step",
    why="The start of an enclosing step is no activation: the enclosed chart starts with the steps that are initial "
    "in it (IEC 60848:2013, 7.3).",
    hint="Make a step of the enclosed chart initial.",
    example="an initial step that encloses G2, which has no initial step",
    check=_initial_enclosures,
    severity=Severity.ERROR,
)

HIE04 = Rule(
    code="HIE04",
    title="Forcing orders force what is there",
    why="The forced steps belong to the forced chart, and {INIT} needs an initial step (IEC 60848:2013, 7.1).",
    hint="Correct the name of the chart or the list of steps.",
    example="the order G2{10} for a chart G2 without a step 10",
    check=_forced,
    severity=Severity.ERROR,
)

HIE05 = Rule(
    code="HIE05",
    title="No chart rules one that it is ruled by",
    why="Forcing and enclosing make a hierarchy, which is a partial order: a chart that forces one above it, or "
    "itself, has no situation (IEC 60848:2013, 7.1).",
    hint="Move the order into a chart of its own, above both.",
    example="a step of G1 forces G2, and a step of G2 forces G1",
    check=_circles,
    severity=Severity.ERROR,
)

HIE06 = Rule(
    code="HIE06",
    title="One order at a time rules a chart",
    why="Two orders that are given at once force a chart into two situations, and an enclosing step activates what an "
    "order holds (IEC 60848:2013, 7.1).",
    hint="Let the steps that give the orders exclude each other.",
    example="two steps of simultaneous branches, one with G2{INIT}, the other with G2{}",
    check=_at_once,
    severity=Severity.ERROR,
)


def _macro_names(chart: CheckedChart) -> Iterator[Finding]:
    for sheet in chart.sheets:
        partial = sheet.partial
        wanted = {}
        if partial is not None and partial.kind is PartialChartKind.EXPANSION:
            wanted = {partial.entry_step: ("entry step", "E"), partial.exit_step: ("exit step", "S")}
        for step in sheet.steps:
            what, letter = ("macro-step", "M") if step.macro is not None else wanted.get(step.name, ("", ""))
            if not step.name.upper().startswith(letter):
                yield Finding(sheet.at(step), f"the name of the {what} does not begin with {letter}")


def _unused(chart: CheckedChart) -> Iterator[Finding]:
    steps = [step for sheet in chart.sheets for step in sheet.steps]
    used = {step.macro.expansion.casefold() for step in steps if step.macro is not None and step.macro.expansion}
    used |= {enclosure.chart.casefold() for step in steps for enclosure in step.encloses or ()}
    for sheet in chart.sheets:
        partial = sheet.partial
        if partial is not None and partial.kind is not PartialChartKind.GLOBAL and partial.name.casefold() not in used:
            yield Finding(sheet.place, f"no step uses the chart {partial.name}: it is never active")


HIE07 = Rule(
    code="HIE07",
    title="Names tell macro-steps, and the entry and exit of expansions",
    why="A macro-step is called M and a number, entry and exit step of its expansion E and S (IEC 60848:2013, 7.4): "
    "that is how people find one from the other, and tools refuse other names.",
    hint="Rename the step.",
    example="a macro-step with the name 3 instead of M3",
    check=_macro_names,
    severity=None,
    severities={"grafcet": Severity.WARNING},
)

HIE08 = Rule(
    code="HIE08",
    title="Every expansion and every enclosed chart is used",
    why="An expansion is active through its macro-step, an enclosed chart through its enclosing step "
    "(IEC 60848:2013, 7). Without one it is dead, or the name in the step is wrong.",
    hint="Name it in a step, or remove it.",
    example="an expansion M9 without a macro-step of this name",
    check=_unused,
    severity=None,
    severities={"grafcet": Severity.WARNING},
)


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
