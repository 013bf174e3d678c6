"""Rules about transitions: missing and constant conditions, what a condition must not do, and competing transitions."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator
from typing import NamedTuple

from plcopen_sfc.analysis.checks.action_targets import continuous_operands, output_operands
from plcopen_sfc.analysis.checks.checked_chart import (
    MOST_TOGETHER,
    CheckedChart,
    CheckedSheet,
    Finding,
    FindingPlace,
    Rule,
    ring,
)
from plcopen_sfc.analysis.exclusivity import Truth, covered
from plcopen_sfc.analysis.search_limits import Answer
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.binding import bind
from plcopen_sfc.languages.binding.compile_mistakes import value_kind
from plcopen_sfc.languages.binding.name_sites import in_tree
from plcopen_sfc.languages.binding.text_sites import Site
from plcopen_sfc.languages.effects import path_of, targets
from plcopen_sfc.languages.expression_types import CALCULATING
from plcopen_sfc.languages.grafcet_conditions import OVERLINE, condition_problem, program_parts, separated
from plcopen_sfc.languages.networks import NetworkExpression
from plcopen_sfc.languages.problems import Problem
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, parse_statements, print_node, walk
from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.model.body import IlBody, StBody
from plcopen_sfc.model.conditions import Expression, NamedCondition, WiredCondition
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.sfc import Body, BodyCondition, Condition, Step, Transition
from plcopen_sfc.model.types import DerivedType, Elementary, ElementaryType, EnumType, StringType, StructType


def _selections(chart: CheckedChart) -> Iterator[tuple[CheckedSheet, Step, list[Transition]]]:
    """Yield each step with several transitions that leave it, in the order in which they are tried."""
    for sheet, step in chart.steps():
        leaving = sheet.leaving.get(step.id, [])
        if len(leaving) > 1:
            yield sheet, step, leaving


class _Pair(NamedTuple):
    """Two competing transitions that only their conditions keep apart, and whether these exclude each other.

    `is_last`: so many others are paired with the second one that more were not looked for.
    """

    sheet: CheckedSheet
    step: Step
    first: Transition
    second: Transition
    answer: Answer
    why: str
    is_last: bool


def _competing(chart: CheckedChart) -> Iterator[_Pair]:
    """Pairs of competing transitions that only their conditions keep apart."""
    seen: set[tuple[int, int]] = set()
    together: Counter[int] = Counter()
    for sheet, step, leaving in _selections(chart):
        for first, second in ((leaving[one], leaving[other]) for one, other in chart.overlaps(sheet, leaving)):
            if first.priority is not None and second.priority is not None and first.priority != second.priority:
                continue
            if (id(first), id(second)) in seen:
                continue
            seen.add((id(first), id(second)))
            found = chart.exclusive(sheet, first, second)
            together[id(second)] += 1
            is_last = together[id(second)] == MOST_TOGETHER
            why = _witness(found.witness) or found.reason
            yield _Pair(sheet, step, first, second, found.answer, why, is_last)


def _witness(witness: object) -> str:
    """Return a situation in words: ``a, NOT b, level = 3``."""
    if not isinstance(witness, dict):
        return ""
    words = [
        (name if value else f"NOT {name}") if isinstance(value, bool) else f"{name} = {value}"
        for name, value in sorted(witness.items())
    ]
    return ", ".join(words)


def _told(chart: CheckedChart, answer: Answer, words: str) -> Iterator[Finding]:
    for pair in _competing(chart):
        if pair.answer is answer and not any(_problem(chart, t.condition) for t in (pair.first, pair.second)):
            message = f"{words} {pair.sheet.label(pair.first)}, which leaves {pair.step.name} too"
            message += f": {chart.as_written(pair.why)}" if pair.why else ""
            message += "; there may be more, which were not looked for" if pair.is_last else ""
            yield Finding(pair.sheet.at(pair.second), message)


def _shadowed(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, step, leaving in _selections(chart):
        overlapping = grouped((other, leaving[one]) for one, other in chart.overlaps(sheet, leaving))
        for place, possible in sorted(overlapping.items()):  # one that excludes another cannot be hidden by it
            later = leaving[place]
            before = [t for t in possible if set(t.sources) <= set(later.sources)]
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
    grafcet_hint="Make the conditions exclude each other: a, /a * b.",
    example="""
INITIAL_STEP S1: END_STEP
STEP S2: END_STEP
STEP S3: END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S1 TO S3 := b; END_TRANSITION
TRANSITION FROM S2 TO S1 := c; END_TRANSITION
TRANSITION FROM S3 TO S1 := d; END_TRANSITION
""",
    check=lambda chart: _told(chart, Answer.NO, "it can be true together with"),
    severity=None,
    severities={"iec": Severity.INFO, "grafcet": Severity.ERROR, "matiec": Severity.ERROR, "beremiz": Severity.ERROR},
)

SEL02 = Rule(
    code="SEL02",
    title="It can be decided whether the branches of a selection exclude each other",
    why="Conditions with calls or arithmetic are not decided: whether they exclude each other is left to the author.",
    hint="Look at the conditions; write them as comparisons with constants, or give the transitions priorities.",
    grafcet_hint="Look at the conditions; write them as comparisons with constants.",
    example="""
INITIAL_STEP S1: END_STEP
STEP S2: END_STEP
STEP S3: END_STEP
TRANSITION FROM S1 TO S2 := level * 2 > limit; END_TRANSITION
TRANSITION FROM S1 TO S3 := level * 3 < limit; END_TRANSITION
TRANSITION FROM S2 TO S1 := c; END_TRANSITION
TRANSITION FROM S3 TO S1 := d; END_TRANSITION
""",
    check=lambda chart: _told(chart, Answer.UNKNOWN, "it is unknown whether it excludes"),
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


def _missing(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, transition in chart.transitions():
        condition = transition.condition
        unwired = isinstance(condition, WiredCondition) and not (
            condition.input.connections or condition.input.expression
        )
        code = condition.body if isinstance(condition, BodyCondition) else condition
        empty = isinstance(code, Expression | StBody | IlBody) and not code.text.strip()
        if condition is None or unwired or empty:
            yield Finding(sheet.at(transition), "the transition has no condition")


def _no_boolean(chart: CheckedChart) -> Iterator[Finding]:
    names = (step.name.casefold() for _, step in chart.steps())
    steps = {name for name in names if name not in chart.types} if chart.family == "grafcet" else set()
    for sheet in chart.sheets:
        site = Site(chart.pou, charts=(sheet.chart,), place=chart.pou.place if chart.pou is not None else "")
        for place, condition, tree in _conditions(chart, sheet):
            text = " ".join(condition.text.split())
            told = _other_type(n.bare(tree), chart, site) if tree is not None else ""
            if tree is not None and not told and chart.family != "grafcet":
                kind = value_kind(tree, chart.around.named.resolver, site)
                told = kind if kind != "BOOL" else ""
            if told:
                yield Finding(place, f"the condition {text} is not Boolean: it is {told}")
            if chart.family != "grafcet":
                continue
            for name, kind in _joined(tree, chart, site) if tree is not None else ():
                yield Finding(place, f"{name} is {kind}, and the condition takes it as Boolean")
            for name in _calculated(tree, chart, site) if tree is not None else ():
                message = f"{name} is BOOL, and {text} calculates with it"
                yield Finding(place, message, "Write [..] around a comparison: a * [n>3].")
            for name in _names_in(condition.text) if steps else ():
                if name.casefold() in steps:  # in the place of its flag
                    yield Finding(place, f"{name} is a step and no value: its flag is X{name}")


def _conditions(
    chart: CheckedChart, sheet: CheckedSheet
) -> Iterator[tuple[FindingPlace, Expression, n.Expression | None]]:
    """Yield the conditions in text of a network with their places and trees: in a GRAFCET those of actions, too."""
    for transition in sheet.transitions:
        if _problem(chart, transition.condition) is not None:
            continue  # CND09 finds it
        if isinstance(transition.condition, Expression):  # in a GRAFCET * and + join Boolean terms
            yield sheet.at(transition), transition.condition, chart.condition(sheet, transition).tree
    for step, association in sheet.actions() if chart.family == "grafcet" else ():
        if isinstance(association.condition, Expression) and _problem(chart, association.condition) is None:
            yield sheet.at(step, association), association.condition, chart.term(association.condition)


def _problem(chart: CheckedChart, condition: Condition | None) -> Problem | None:
    """Return why the condition of a GRAFCET cannot be read; None where it can, and for other charts."""
    if chart.family != "grafcet" or not isinstance(condition, Expression):
        return None
    return condition_problem(condition.text, chart.dialect)


def _joined(tree: n.Node, chart: CheckedChart, site: Site) -> Iterator[tuple[str, str]]:
    """Yield what a condition joins or negates and is not Boolean, with its type."""
    for node in walk(tree):
        operands = node.operands if isinstance(node, n.Operation) and node.operator in n.CONNECTIVES else ()
        for operand in (node.operand,) if isinstance(node, n.Unary) and node.operator is n.Operator.NOT else operands:
            if kind := _other_type(n.bare(operand), chart, site):
                yield print_node(n.bare(operand)), kind


def _calculated(tree: n.Node, chart: CheckedChart, site: Site) -> list[str]:
    """Return the BOOL variables that a condition calculates with."""
    operations = [each for each in walk(tree) if isinstance(each, n.Operation) and each.operator in CALCULATING]
    operands = {print_node(each): n.bare(each) for operation in operations for each in operation.operands}
    types = {name: chart.around.named.resolver.type_of(operand, site) for name, operand in operands.items()}
    return [name for name, type_ in types.items() if type_ == ElementaryType(name=Elementary.BOOL)]


def _names_in(text: str) -> list[str]:
    """Return the parts of a condition of a GRAFCET that may be names."""
    return [text[start:end].replace(OVERLINE, "") for start, end in program_parts(text)]


def _other_type(tree: n.Node, chart: CheckedChart, site: Site) -> str:
    """Return the type of a value that is certainly not Boolean; empty for all else."""
    if isinstance(tree, n.Operation) and tree.operator in CALCULATING:
        return "a number or a time"
    if isinstance(tree, n.Name | n.Member | n.Index):
        type_ = chart.around.named.resolver.type_of(tree, site)
        if isinstance(type_, ElementaryType) and type_.name not in (Elementary.BOOL, Elementary.ANY):
            return f"of type {type_.name}"
        if isinstance(type_, StructType | StringType | EnumType):
            return _NO_BOOLEANS[type_.kind]
    return ""


_NO_BOOLEANS = {"struct": "a structure", "string": "a string", "enum": "a value of an enumeration"}


def _unreadable(chart: CheckedChart) -> Iterator[Finding]:
    bool_ = ElementaryType(name=Elementary.BOOL)
    steps = {step.name.casefold() for _, step in chart.steps()}
    known = (chart.flags - chart.types.keys()) | {name for name, type_ in chart.types.items() if type_ == bool_}
    for sheet in chart.sheets:
        places = [(sheet.at(transition), transition.condition) for transition in sheet.transitions]
        places += [(sheet.at(step, each), each.condition) for step, each in sheet.actions()]
        for place, condition in places:
            problem = _problem(chart, condition)
            if problem is not None and isinstance(condition, Expression):
                text = " ".join(condition.text.split())
                yield Finding(place, f"the condition {text!r} cannot be read: {problem.message}")
            elif isinstance(condition, Expression) and '"' not in condition.text:
                text = condition.text
                if separated(text, known) != text:
                    shown = " ".join(text.split())
                    message = f"a dot in {shown!r} is that of a member, and a BOOL and a flag have none"
                    yield Finding(place, message, "Write * or AND for the dot, or blanks beside it: a * b, a . b.")
                else:
                    yield from _members_of_bools(place, text, known - steps)
        for step, each in sheet.actions():
            body = each.body.text if isinstance(each.body, StBody) else ""
            target = each.target or ""
            expressions = [(text, parse_expression) for text in (target, each.value or "")]
            if isinstance(parse_expression(target).tree, n.Literal) and target.casefold() not in chart.types:
                message = f"the action writes {target}, which is a number and no name"
                yield Finding(sheet.at(step, each), message, "Give the variable a name that begins with a letter.")
            for text, parse in (*expressions, (body, parse_statements)):
                problems = parse(text, chart.dialect).problems if text.strip() else ()
                if problems:
                    message = f"what the action does, {' '.join(text.split())!r}, cannot be read: {problems[0].message}"
                    yield Finding(sheet.at(step, each), message, _AS_ACTIONS)


def _members_of_bools(place: FindingPlace, text: str, bools: Collection[str]) -> Iterator[Finding]:
    for start, end in program_parts(text):
        for each in in_tree(parse_expression(text[start:end]).tree, Dialect.IEC):
            if each.base is None and each.access and each.name.casefold() in bools:
                hint = "Ask for the flag of a step as X2, for its time as 3s/X2; write AND between BOOLs as a * b."
                yield Finding(place, f"{each.name} is a BOOL: it has no {each.access}", hint)


_AS_ACTIONS = "Write a variable, and values in structured text: a AND b, NOT a, n + 1."


def _constant(chart: CheckedChart, truth: Truth) -> Iterator[tuple[CheckedSheet, Transition]]:
    for sheet, transition in chart.transitions():
        if chart.truth(sheet, transition) is truth:
            yield sheet, transition


def _always(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, transition in _constant(chart, Truth.ALWAYS):
        if len(set(transition.sources)) > 1:
            continue  # it waits for the last of its steps: "1" is how joins are written
        yield Finding(sheet.at(transition), f"the condition {_text(chart, sheet, transition)} is always true")


def _never(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, transition in _constant(chart, Truth.NEVER):
        yield Finding(sheet.at(transition), f"the condition {_text(chart, sheet, transition)} is never true")


def _text(chart: CheckedChart, sheet: CheckedSheet, transition: Transition) -> str:
    if chart.family == "grafcet" and isinstance(transition.condition, Expression):
        return " ".join(transition.condition.text.split())  # as it is written: the tree has names for edges and times
    tree = chart.condition(sheet, transition).tree
    return " ".join(print_node(tree).split()) if tree is not None else ""


def _nodes(found: NetworkExpression) -> Iterator[n.Node]:
    """Yield every node of a condition and of what is executed before it."""
    for statement in found.before:
        yield from walk(statement)
    if found.tree is not None:
        yield from walk(found.tree)


def _assigning(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, transition in chart.transitions():
        found = chart.condition(sheet, transition)
        own = {helper.name.casefold() for helper in found.helpers}
        trees = [*found.before, *([found.tree] if found.tree is not None else [])]
        written = [target for tree in trees for target in targets(tree)]
        names = [
            print_node(target)
            for target in written
            if not (isinstance(target, n.Name) and target.identifier.casefold() in own)
        ]
        names += _stored(chart, transition)
        if names:
            yield Finding(sheet.at(transition), f"the condition writes {', '.join(dict.fromkeys(names))}")


def _body_of(chart: CheckedChart, transition: Transition) -> tuple[Body | None, str]:
    """Return the body of a condition, with the name of the transition object that it belongs to."""
    condition = transition.condition
    if isinstance(condition, BodyCondition):
        return condition.body, condition.name
    if isinstance(condition, NamedCondition) and chart.pou is not None:
        for named in chart.pou.transitions:
            if named.name.casefold() == condition.name.casefold():
                return named.body, named.name
    return None, ""


def _stored(chart: CheckedChart, transition: Transition) -> Iterator[str]:
    """Return the variables that a condition in instruction list stores, but for the condition itself."""
    body, name = _body_of(chart, transition)
    if isinstance(body, IlBody):
        for target in bind(body, chart.dialect).targets():
            text = print_node(target)
            if text.casefold() != name.casefold():
                yield text


def _calling(chart: CheckedChart) -> Iterator[Finding]:
    for sheet, transition in chart.transitions():
        found = chart.condition(sheet, transition)
        called = [print_node(call.callee) for call in _calls(found) if _has_state(call, chart)]
        if called:
            names = ", ".join(dict.fromkeys(called))
            yield Finding(sheet.at(transition), f"the condition calls {names}, which keeps values between calls")


def _calls(found: NetworkExpression) -> Iterator[n.Call]:
    return (node for node in _nodes(found) if isinstance(node, n.Call))


def _has_state(call: n.Call, chart: CheckedChart) -> bool:
    """Return True if a call is one of a function block, or of an instance of one."""
    if not isinstance(call.callee, n.Name):
        return False
    name = call.callee.identifier
    type_ = chart.types.get(name.casefold())
    if isinstance(type_, DerivedType):
        name = type_.name
        if any(pou.name.casefold() == name.casefold() for pou in chart.around.project.pous):
            return True
    block = standard_block(name)
    return block is not None and block.stateful


def _reading_outputs(chart: CheckedChart) -> Iterator[Finding]:
    outputs = output_operands(chart) | continuous_operands(chart)
    for sheet in chart.sheets:
        places = [(sheet.at(each), [*_nodes(chart.condition(sheet, each))]) for each in sheet.transitions]
        for step, association in sheet.actions():
            tree = chart.term(association.condition) if isinstance(association.condition, Expression) else None
            places.append((sheet.at(step, association), [*walk(tree)] if tree is not None else []))
        for place, nodes in places:
            variables = [each for each in nodes if isinstance(each, n.Operand)]
            members = {id(each.name) for each in variables if isinstance(each, n.Member)}  # T1.Q is no output Q
            whole = (each for each in variables if id(each) not in members)
            read = {path: print_node(each) for each in whole if (path := path_of(each)) in outputs}
            addresses = (each.text for each in variables if isinstance(each, n.Address))
            names = [*read.values(), *sorted(each for each in addresses if each[:2].upper() == "%Q")]
            if names:
                yield Finding(place, f"the condition reads {', '.join(names)}, which the chart writes")


def _unknown_name(chart: CheckedChart) -> Iterator[Finding]:
    if chart.pou is None:
        return
    known = {named.name.casefold() for named in chart.pou.transitions} | chart.types.keys()
    for sheet, transition in chart.transitions():
        condition = transition.condition
        named = isinstance(condition, NamedCondition) and condition.name.isidentifier()
        if isinstance(condition, NamedCondition) and named and condition.name.casefold() not in known:
            message = f"the POU has no transition and no variable {condition.name!r}"
            yield Finding(sheet.at(transition), message)


def _unknown_steps(chart: CheckedChart) -> Iterator[Finding]:
    if chart.pou is None:
        return
    known = chart.types.keys() | chart.around.names | chart.steps_of_pou
    for sheet, transition in chart.transitions():
        for node in _nodes(chart.condition(sheet, transition)):
            if isinstance(node, n.Member) and isinstance(node.base, n.Name) and node.name.identifier in _STEP_MEMBERS:
                name = node.base.identifier
                if name.casefold() not in known:
                    shown = print_node(node)
                    yield Finding(sheet.at(transition), f"{shown} asks for a step {name!r}, and there is no such step")


_STEP_MEMBERS = frozenset({"X", "x", "T", "t"})


CND01 = Rule(
    code="CND01",
    title="A transition has a condition",
    why="Tools refuse a transition without one, or take it for TRUE.",
    hint="Add one; TRUE if it shall always fire.",
    grafcet_hint="Add one; 1 if it shall always fire.",
    example="a transition symbol with nothing beside it",
    check=_missing,
    severity=Severity.ERROR,
)

CND02 = Rule(
    code="CND02",
    title="A condition can be false",
    why="The step before it is left at once; a transition with several steps before it waits for all of them, and is "
    "not found. Where one evolution is made in a scan that is a way to write a step for "
    "one scan, and common behind an initial step; in GRAFCET the step is transient: its continuous actions never "
    "happen (IEC 60848:2013, transient evolution).",
    hint="Nothing, if the step is meant for one scan; else correct the condition.",
    grafcet_hint="Nothing, if the step is meant to be passed only; else correct the condition.",
    example=ring(forth="a OR NOT a"),
    check=_always,
    severity=Severity.INFO,
    severities={"grafcet": Severity.WARNING},
)

CND03 = Rule(
    code="CND03",
    title="A condition can be true",
    why="The transition never fires: what follows it is not reached, and the step before it is not left this way.",
    hint="Correct the condition, or remove the transition.",
    example=ring(forth="a AND level < 3 AND level > 5"),
    check=_never,
    severity=Severity.WARNING,
)

CND04 = Rule(
    code="CND04",
    title="A condition writes nothing",
    why="How often a condition is evaluated, and when, is the tool's affair: CODESYS evaluates those of active steps, "
    "S7-GRAPH and GRAFCET all of them in every scan. CoDeSys V2.3 forbids assignments in transitions; instruction "
    "list ends without ST there.",
    hint="Write the variable in an action of the step before.",
    example=ring(forth="(q := a)"),
    check=_assigning,
    severity=Severity.ERROR,
)

CND05 = Rule(
    code="CND05",
    title="A condition calls nothing that keeps values",
    why="An edge or a timer in a condition runs only while the condition is evaluated: in CODESYS while the step "
    "before it is active, so that an edge that comes with the activation is seen a scan late or not at all, and a "
    "timer starts where it stopped. CoDeSys V2.3 allows no programs and function blocks in transitions. S7-GRAPH "
    "evaluates all conditions in every cycle.",
    hint="Call the block in an action, or before the chart, and ask for its output. For times there is the time of "
    "the step.",
    example="VAR edge : R_TRIG; END_VAR" + ring(forth="edge(CLK := a)"),
    check=_calling,
    severity=Severity.WARNING,
    severities={"codesys23": Severity.ERROR, "s7graph": None},
)

CND06 = Rule(
    code="CND06",
    title="A condition reads no output of its chart",
    why="In GRAFCET outputs follow from the situation: continuous actions are assigned when it is stable, and a "
    "condition that reads one of them sees the value of the situation before: that of a transition, of an action, and "
    "an event.",
    hint="Ask for the step (X12) instead of what it writes.",
    example="""
GRAFCET Example
INITIAL STEP 1
1 -> 2 : a
STEP 2
    Q1
2 -> 1 : Q1 * b
""",
    check=_reading_outputs,
    severity=None,
    severities={"grafcet": Severity.WARNING},
)

CND07 = Rule(
    code="CND07",
    title="A named condition exists",
    why="The transition refers to a transition object of its POU, or to a variable, and there is neither.",
    hint="Add the transition object, or correct its name.",
    example="a transition with the condition T1 in a POU that has neither a transition nor a variable T1",
    check=_unknown_name,
    severity=Severity.WARNING,
)

CND08 = Rule(
    code="CND08",
    title="Steps that a condition asks for exist",
    why="A step variable (S3.X, S3.t) of a step that was renamed or removed by hand does not compile, or means "
    "something else.",
    hint="Correct the name.",
    example=ring(forth="S7.T > T#5s"),
    check=_unknown_steps,
    severity=Severity.WARNING,
)

CND09 = Rule(
    code="CND09",
    title="The conditions and actions of a GRAFCET can be read",
    why="A condition is a Boolean term with edges, times and predicates (IEC 60848:2013, 4.6), in one of the notations "
    "that people use for it. Values of stored actions and statements are structured text. Other text cannot be "
    "simulated, lowered or converted.",
    hint="Write a * b, a + b, /a, ↑a, [C1>3] or 3s/X2; a AND b, a OR b, NOT a mean the same.",
    example="""
GRAFCET Example
INITIAL STEP 1
1 -> 2 : START 1B1
STEP 2
2 -> 1 : /START
""",
    check=_unreadable,
    severity=None,
    severities={"grafcet": Severity.ERROR},
)

CND10 = Rule(
    code="CND10",
    title="A condition is Boolean",
    why="A transition fires where its condition is TRUE (IEC 61131-3 ed. 3, 6.7.3): a number, a time, a string, "
    "a structure or an instance does not compile. In GRAFCET the name of a step is no condition either, its flag is "
    "(X2 of step 2).",
    hint="Compare it: n <> 0, t > T#2s.",
    example="VAR n : INT; END_VAR" + ring(forth="n"),
    check=_no_boolean,
    severity=Severity.ERROR,
)
