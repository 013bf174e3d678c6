"""Rules about GRAFCETs: macro-steps, enclosing steps, forcing orders, conditions and events of actions."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import combinations

from plcopen_sfc.analysis.checks.action_targets import Manner, assignments, operand, uses
from plcopen_sfc.analysis.checks.checked_chart import CheckedChart, CheckedSheet, Finding, FindingPlace, Rule, ring
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.effects import path_of
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_condition, parse_expression, print_node, walk
from plcopen_sfc.model.actions import ActionKind, ForcedSituation, ForcingOrder
from plcopen_sfc.model.conditions import Expression, NamedCondition, WiredCondition
from plcopen_sfc.model.network import Block, Contact, Edge, InputVariable
from plcopen_sfc.model.sfc import BodyCondition, Condition, PartialChart, PartialChartKind, Step
from plcopen_sfc.model.types import DerivedType, Elementary, ElementaryType, PointerType
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.reachability import reached
from plcopen_sfc.semantics.charts.grafcet.term_evaluation import TermTexts, is_edge
from plcopen_sfc.semantics.net import NetProblemKind, NetStep

_ARROWS = "↑↓"
_EDGES = frozenset(
    {"R_TRIG", "F_TRIG", "RE", "FE", "R_EDGE", "F_EDGE", "RISING", "FALLING", "RISING_EDGE", "FALLING_EDGE"}
)
_CONDITIONAL = frozenset({ActionKind.CONDITIONAL, ActionKind.DELAYED, ActionKind.LIMITED, ActionKind.CONTINUOUS})


def has_edge(condition: Condition | None, chart: CheckedChart) -> bool:
    """Return True if a condition watches for a change: ``↑a``, an edge block, an edge in a network."""
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
    if isinstance(node, n.Call):
        return node.called.upper() in _EDGES
    if isinstance(node, n.Member) and isinstance(node.base, n.Name):
        type_ = chart.types.get(node.base.identifier.casefold())
        return isinstance(type_, DerivedType) and type_.name.upper() in _EDGES
    return False


def _drawn_edge(node: object) -> bool:
    if isinstance(node, Contact | InputVariable):
        return node.edge is not Edge.NONE
    return isinstance(node, Block) and node.type_name.upper() in _EDGES


_FLAG_EDGE = re.compile(r"(?P<edge>[↑↓])\s*X(?P<step>\w+)")
"""The edge of a step's flag."""


def _own_edge(step: Step, condition: Condition | None) -> str:
    """Return the edge of the step's own flag that an event needs: it comes before or after the step is active."""
    text = condition.text if isinstance(condition, Expression) else ""
    for factor in () if re.search(r"[+∨()\[]|\bX?OR\b", text) else re.split(r"[*·⋅∙•.∧&]|\bAND\b", text):
        found = _FLAG_EDGE.fullmatch(factor.strip())
        if found is not None and found["step"].casefold() in (step.name.casefold(), str(step.number)):
            return found["edge"]
    return ""


def _no_edge(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, step, association in chart.actions():
        if association.kind is ActionKind.ON_EVENT and (edge := _own_edge(step, association.condition)):
            word = "ON ACTIVATION" if edge == "↑" else "ON DEACTIVATION"
            message = f"the event {edge}X{step.name} never comes while step {step.name} is active"
            yield Finding(sheet.at(step, association), message, f"Write {word} for what this step does then.")
        elif association.kind is ActionKind.ON_EVENT and not has_edge(association.condition, chart):
            message = "the event of the action is no edge" if association.condition else "the action has no event"
            yield Finding(sheet.at(step, association), message)
        elif association.kind is ActionKind.ON_EVENT and _lasts(association.condition):
            message = "the event of the action can be TRUE without an edge"
            yield Finding(sheet.at(step, association), message, "Write an edge on both sides of an OR: ↑a + ↑b.")


def _lasts(condition: Condition | None) -> bool:
    """Return True if an event with edges in it can be TRUE in evolutions in which none of them is."""
    if not isinstance(condition, Expression):
        return False
    terms = TermTexts()
    tree = parse_expression(terms.read(condition.text)).tree
    return bool(terms.edges) and not _needs_edge(tree)


def _needs_edge(node: n.Expression) -> bool:
    node = n.bare(node)
    if isinstance(node, n.Operation) and node.operator is n.Operator.OR:
        return all(map(_needs_edge, node.operands))
    if isinstance(node, n.Operation) and node.operator is n.Operator.AND:
        return any(map(_needs_edge, node.operands))
    return isinstance(node, n.Name) and is_edge(node.identifier)


def _edge(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, step, association in chart.actions():
        condition = association.condition
        drawn = isinstance(condition, WiredCondition | NamedCondition)
        if association.kind in _CONDITIONAL and condition is not None and not drawn and has_edge(condition, chart):
            yield Finding(sheet.at(step, association), "the condition of a continuous action is an edge")


def _assigning(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, step, association in chart.actions():
        if association.kind in _CONDITIONAL and association.value is not None:
            done = f"{association.target} := {association.value}"
            hint = f"Write ON ACTIVATION {done}, which is executed once, or the name of a BOOL alone."
            yield Finding(sheet.at(step, association), f"{done} is no continuous action", hint)


def _not_boolean(chart: CheckedChart) -> Iterator[Finding]:
    yield from _assigning(chart)
    for use in uses(chart):
        if use.manner in (Manner.STORED, Manner.OTHER) or use.association.body is not None or len(use.path) != 1:
            continue
        type_ = chart.types.get(use.path[0])
        named = chart.pou is not None and chart.pou.find_action(use.path[0]) is not None
        if type_ is None or named or isinstance(type_, DerivedType | PointerType):
            continue
        if use.association.kind in _CONDITIONAL and use.association.value is not None:
            continue  # an assignment, which has its own finding
        if not (isinstance(type_, ElementaryType) and type_.name is Elementary.BOOL):
            shown = type_.name.value if isinstance(type_, ElementaryType) else type_.kind
            yield Finding(use.sheet.at(use.step, use.association), f"{use.name} is no BOOL but {shown}")


ACT11 = Rule(
    code="ACT11",
    title="The event of a stored action is an edge",
    why="An action on event writes its operand once, when the event comes while the step is active (IEC 60848:2013, "
    "4.8). A condition that is just true is no event: it would have to be written all the time, or never. Nor is "
    "the edge of the step's own flag: that comes with its activation, or when it is left.",
    hint="Watch for the change: ↑a instead of a.",
    example="""
GRAFCET Example
INITIAL STEP 1
    ON EVENT a : Q1 := TRUE
1 -> 1 : b
""",
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
    example="""
GRAFCET Example
INITIAL STEP 1
    Q1 IF ↑a
1 -> 1 : b
""",
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
    example="VAR level : INT; END_VAR" + ring("level(N);"),
    check=_not_boolean,
    severity=Severity.ERROR,
)


def _inputs_written(chart: CheckedChart) -> Iterator[Finding]:
    if chart.pou is None:
        return
    inputs = {variable.name.casefold() for variable in chart.pou.variables(SectionKind.INPUT)}
    for sheet, step, association in chart.actions():
        written = {print_node(each.target): path_of(each.target) for each in assignments(association.body, chart)}
        if association.target:
            written[association.target] = operand(association.target, chart)
        for name, path in written.items():
            if path and path[0] in inputs:
                yield Finding(sheet.at(step, association), f"{name} is an input, and the action writes it")
            elif path and path[0] in chart.flags - chart.types.keys():
                message = f"{name} is the flag of a step, and the action writes it"
                yield Finding(sheet.at(step, association), message, "Write a variable: transitions change steps.")


ACT20 = Rule(
    code="ACT20",
    title="An action writes no input and no flag of a step",
    why="An input is what the machine tells the chart: nothing that an action writes to it stays, or the machine does "
    "(IEC 60848:2013, 4.8: actions act on outputs and internal variables). A flag belongs to its step: it tells what "
    "transitions have made of it.",
    hint="Declare it among the outputs or internals, or correct the name.",
    example="""
GRAFCET Example
INPUTS
    a
    b
INITIAL STEP 1
    b
1 -> 1 : ↑a
""",
    check=_inputs_written,
    severity=None,
    severities={"grafcet": Severity.WARNING},
)

_MACROS = frozenset(NetProblemKind) - {NetProblemKind.MISSING_SOURCE, NetProblemKind.MISSING_TARGET}


def _partials(chart: CheckedChart) -> dict[str, PartialChart]:
    return {partial.name.casefold(): partial for partial in reversed(chart.chart.partial_charts)}


def _orders(chart: CheckedChart) -> Iterator[tuple[CheckedSheet, Step, FindingPlace, ForcingOrder]]:
    """Yield the forcing orders, with the steps that give them."""
    for sheet, step, association in chart.actions():
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
    for sheet, step, enclosure in chart.enclosures():
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
    for sheet, step, enclosure in chart.enclosures():
        partial = partials.get(enclosure.chart.casefold())
        if step.initial and partial is not None and not partial.chart.initial_steps:
            message = f"the step is initial, and {enclosure.chart}, which it encloses, has no initial step"
            yield Finding(sheet.at(step), message)


def _forced(chart: CheckedChart) -> Iterator[Finding]:
    partials = _partials(chart)
    for sheet, _, place, order in _orders(chart):
        partial = partials.get(order.chart.casefold())
        if partial is None:
            if order.chart or sheet.partial is None:  # an order without a name forces the chart around a partial one
                yield Finding(place, f"the order forces {order.chart!r}, and there is no such chart")
            continue
        if partial.kind is PartialChartKind.EXPANSION:
            yield Finding(place, f"{order.chart} is the expansion of a macro-step, which alone activates it")
        steps = {inner.name.casefold() for inner in partial.chart.steps}
        for name in order.steps:
            if name.casefold() not in steps:
                yield Finding(place, f"{order.chart} has no step {name!r} to force")
        if order.situation is ForcedSituation.INITIAL and not partial.chart.initial_steps:
            yield Finding(place, f"{order.chart} has no initial step to force")
        if order.situation is ForcedSituation.EXPLICIT and not order.steps:
            yield Finding(place, "the order names no steps to force")


def _circles(chart: CheckedChart) -> Iterator[Finding]:
    names = {id(s): s.partial.name.casefold() if s.partial is not None else "" for s in chart.sheets}
    around = {
        step.macro.expansion.casefold(): names[id(sheet)]
        for sheet, step in chart.steps()
        if step.macro is not None and step.macro.expansion
    }

    def owner(sheet: CheckedSheet) -> str:
        """Return the chart that the steps of a sheet are of: an expansion is in that of its macro-step."""
        name, seen = names[id(sheet)], set[str]()
        while name in around and name not in seen:
            seen.add(name)
            name = around[name]
        return name

    below: dict[str, list[tuple[str, FindingPlace]]] = {}
    for sheet, step, enclosure in chart.enclosures():
        below.setdefault(owner(sheet), []).append((enclosure.chart.casefold(), sheet.at(step)))
    for sheet, _, place, order in _orders(chart):
        below.setdefault(owner(sheet), []).append((order.chart.casefold(), place))
    for upper, lower in below.items():
        for name, place in lower:
            if upper in reached([name], lambda ruled: [lower for lower, _ in below.get(ruled, ())]):
                yield Finding(place, "the chart is ruled by one that it rules itself")


def _rulers(chart: CheckedChart) -> Iterator[tuple[NetStep, FindingPlace, str, str]]:
    """Yield the steps that rule a partial chart: what they do to it, by its name."""
    of_step: dict[int, NetStep] = {id(step.step): step for step in chart.net.steps}
    for _, step, place, order in _orders(chart):
        if id(step) in of_step:
            yield of_step[id(step)], place, order.chart.casefold(), f"{order.situation}{sorted(order.steps)}"
    for sheet, step, enclosure in chart.enclosures():
        if id(step) in of_step:
            yield of_step[id(step)], sheet.at(step), enclosure.chart.casefold(), "encloses"


def _at_once(chart: CheckedChart) -> Iterator[Finding]:
    for (first, _, chart_a, what_a), (second, place, chart_b, what_b) in combinations(_rulers(chart), 2):
        if chart_a != chart_b or what_a == what_b:
            continue
        if first is second:
            yield Finding(place, f"the step rules {chart_a.upper()} in two ways at once")
        elif chart.concurrent(first, second):
            message = f"step {first.path} rules {chart_a.upper()} as well, and both can be active together"
            yield Finding(place, message)


HIE01 = Rule(
    code="HIE01",
    title="A macro-step has an expansion with one entry and one exit",
    why="The macro-step activates the entry step of its expansion and is left by its exit step (IEC 60848:2013, 7); "
    "without them the chart comes in but never out, or never in.",
    hint="Name the expansion, and give it an entry step E and an exit step S.",
    example="""
GRAFCET Example
INITIAL STEP 1
1 -> M1 : a
MACRO M1
M1 -> 1 : b
""",
    check=_macros,
    severity=Severity.ERROR,
)

HIE02 = Rule(
    code="HIE02",
    title="Enclosed charts exist, are enclosed once, and can be activated",
    why="An enclosing step activates the steps of the enclosed chart that have an activation link (*), and "
    "deactivates all of them when it is left (IEC 60848:2013, 7.3).",
    hint="Correct the name of the chart or of the step, or mark the steps that shall be activated.",
    example="""
GRAFCET Example
INITIAL STEP 1
1 -> 2 : a
STEP 2 ENCLOSES G2
2 -> 1 : b
ENCLOSED G2
    STEP 10
    10 -> 10 : c
""",
    check=_enclosures,
    severity=Severity.ERROR,
)

HIE03 = Rule(
    code="HIE03",
    title="An initial enclosing step encloses an initial step",
    why="The start of an enclosing step is no activation: the enclosed chart starts with the steps that are initial "
    "in it (IEC 60848:2013, 7.3).",
    hint="Make a step of the enclosed chart initial.",
    example="""
GRAFCET Example
INITIAL STEP 1 ENCLOSES G2{10}
1 -> 1 : a
ENCLOSED G2
    STEP 10
    10 -> 10 : c
""",
    check=_initial_enclosures,
    severity=Severity.ERROR,
)

HIE04 = Rule(
    code="HIE04",
    title="Forcing orders force what is there",
    why="The forced steps belong to the forced chart, and {INIT} needs an initial step (IEC 60848:2013, 7.1). The "
    "expansion of a macro-step is active through its macro-step only (7.4): an order would put a second token into it.",
    hint="Correct the name of the chart or the list of steps.",
    example="""
GRAFCET Example
CHART G1
    INITIAL STEP 1
    1 -> 2 : a
    STEP 2
        FORCE G2{10}
    2 -> 1 : b
CHART G2
    INITIAL STEP 11
    11 -> 11 : c
""",
    check=_forced,
    severity=Severity.ERROR,
)

HIE05 = Rule(
    code="HIE05",
    title="No chart rules one that it is ruled by",
    why="Forcing and enclosing make a hierarchy, which is a partial order: a chart that forces one above it, or "
    "itself, has no situation (IEC 60848:2013, 7.1).",
    hint="Move the order into a chart of its own, above both.",
    example="""
GRAFCET Example
CHART G1
    INITIAL STEP 1
    1 -> 2 : a
    STEP 2
        FORCE G2{INIT}
    2 -> 1 : b
CHART G2
    INITIAL STEP 10
    10 -> 11 : c
    STEP 11
        FORCE G1{INIT}
    11 -> 10 : d
""",
    check=_circles,
    severity=Severity.ERROR,
)

HIE06 = Rule(
    code="HIE06",
    title="One order at a time rules a chart",
    why="Two orders that are given at once force a chart into two situations, and an enclosing step activates what an "
    "order holds (IEC 60848:2013, 7.1). Steps that conditions never let be active together are not meant, whether by "
    "inputs or by the flags of other steps (/X21).",
    hint="Let the steps that give the orders exclude each other.",
    example="""
GRAFCET Example
CHART G1
    INITIAL STEP 1
    1 -> 2, 3 : a
    STEP 2
        FORCE G2{INIT}
    STEP 3
        FORCE G2{}
    2, 3 -> 1 : b
CHART G2
    INITIAL STEP 10
    10 -> 10 : c
""",
    check=_at_once,
    severity=Severity.ERROR,
)


def _macro_names(chart: CheckedChart) -> Iterator[Finding]:
    told = {(id(problem.chart), problem.kind) for problem in chart.net.problems}  # HIE01: no step is taken for it
    for sheet in chart.sheets:
        partial = sheet.partial
        ends: list[tuple[str | None, str, str, NetProblemKind]] = []
        if partial is not None and partial.kind is PartialChartKind.EXPANSION:
            ends.append((partial.entry_step, "entry step", "E", NetProblemKind.NO_ENTRY))
            ends.append((partial.exit_step, "exit step", "S", NetProblemKind.NO_EXIT))
            for name, what, letter, missing in ends:
                if name is None and sheet.steps and (id(sheet.chart), missing) not in told:
                    yield Finding(sheet.place, f"no step of {partial.name} is named as its {what}: {letter}..", _ENDS)
        for step in sheet.steps:
            named = [(what, letter) for name, what, letter, _ in ends if name == step.name]
            for what, letter in [("macro-step", "M")] if step.macro is not None else named:
                if not step.name.upper().startswith(letter):
                    yield Finding(sheet.at(step), f"the name of the {what} does not begin with {letter}")


_ENDS = "Call the step so, or name it behind FROM or TO. A step without a way in or out is taken for it."


def _unused(chart: CheckedChart) -> Iterator[Finding]:
    macros = (step.macro for _, step in chart.steps() if step.macro is not None)
    used = {macro.expansion.casefold() for macro in macros if macro.expansion}
    used |= {enclosure.chart.casefold() for _, _, enclosure in chart.enclosures()}
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
    example="""
GRAFCET Example
INITIAL STEP 1
1 -> 3 : a
MACRO 3 EXPANDS M3
3 -> 1 : b
EXPANSION M3
    STEP E3
    E3 -> S3 : c
    STEP S3
""",
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
    example="""
GRAFCET Example
INITIAL STEP 1
1 -> 1 : a
EXPANSION M9
    STEP E9
    E9 -> S9 : b
    STEP S9
""",
    check=_unused,
    severity=None,
    severities={"grafcet": Severity.WARNING},
)
