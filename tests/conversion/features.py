"""Charts of one feature each, in the format of each tool that has it: the rows of the behaviour matrix."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

from plcopen_sfc import model as m
from plcopen_sfc.drawing import DrawingStyle, draw
from plcopen_sfc.languages.networks import DrawingRules, draw_fbd, draw_fbd_expression, draw_ld
from plcopen_sfc.languages.st import parse_expression, parse_statements
from plcopen_sfc.model.wiring import Branches

SOURCES = {
    "codesys": m.Dialect.CODESYS,
    "plcopen": m.Dialect.IEC,
    "iec-text": m.Dialect.IEC,
    "simaticml": m.Dialect.SCL,
}
_IEC = ("codesys", "plcopen", "iec-text")
_ALL = (*_IEC, "simaticml")


class FeatureChart(NamedTuple):
    """A chart with the steps Idle, Work and Done in a ring, in a POU with inputs a, b, c, g and outputs q, r, n."""

    project: m.Project
    pou: m.Pou
    chart: m.SfcNetwork

    def name(self, text: str) -> str:
        """A name or an expression of local names as the dialect spells it."""
        if self.project.dialect is not m.Dialect.SCL:
            return text
        words = text.split(" ")
        return " ".join(f"#{w}" if w[0].isalpha() and w not in _WORDS and "#" not in w else w for w in words)

    def act(self, step: str, target: str | None = "q", qualifier: str = "N", **fields: object) -> m.ActionAssociation:
        """Add an action to a step."""
        for each in ("value", "condition"):
            if isinstance(fields.get(each), str):
                fields[each] = self.name(str(fields[each]))
        association = m.ActionAssociation.model_validate(
            {
                "id": self.chart.new_id(),
                "target": self.name(target) if target is not None else None,
                "qualifier": qualifier,
                **fields,
            }
        )
        self.chart.step(step).actions.append(association)
        return association

    def action(self, name: str, body: m.Body) -> None:
        """Add an action to the POU."""
        self.pou.actions.append(m.Action(name=name, body=body))

    def declare(self, kind: m.SectionKind, *variables: m.Variable, **flags: bool) -> None:
        """Add variables."""
        assert self.pou.interface is not None
        section = m.VariableSection.model_validate({"kind": kind, "variables": [*variables], **flags})
        self.pou.interface.sections.append(section)

    def go(self, source: str, target: str, condition: object, **fields: object) -> m.Transition:
        """Add a transition."""
        text = self.name(condition) if isinstance(condition, str) else condition
        chart = self.chart
        made = chart.add_transition(chart.step(source), chart.step(target), text)  # type: ignore[arg-type]
        for name, value in fields.items():
            setattr(made, name, value)
        return made


_WORDS = frozenset("AND OR NOT XOR TRUE FALSE MOD THEN IF END_IF;".split())


@dataclass(frozen=True)
class Feature:
    """A feature: what it is called, the formats whose tools have it, and how a chart gets it."""

    name: str
    sources: tuple[str, ...]
    build: Callable[[FeatureChart], None]


def feature_project(feature: Feature, source: str) -> m.Project:
    """The chart of a feature for the tool of the format `source`."""
    dialect = SOURCES[source]
    chart = m.SfcNetwork()
    for name in ("Idle", "Work", "Done"):
        chart.add_step(name, initial=name == "Idle")
    sections = [
        m.VariableSection(kind=m.SectionKind.INPUT, variables=[variable(name) for name in "abcg"]),
        m.VariableSection(kind=m.SectionKind.OUTPUT, variables=[variable("q"), variable("r"), variable("n", "INT")]),
    ]
    pou = m.Pou(
        name="Main",
        kind=m.PouKind.FUNCTION_BLOCK,
        interface=m.Interface(sections=sections),
        bodies=[m.SfcBody(chart=chart)],
    )
    rig = FeatureChart(m.Project(name="Matrix", dialect=dialect, pous=[pou]), pou, chart)
    for start, end, condition in (("Idle", "Work", "a"), ("Work", "Done", "b"), ("Done", "Idle", "c")):
        rig.go(start, end, condition)
    feature.build(rig)
    return rig.project


def variable(name: str, type_: str = "BOOL", **fields: object) -> m.Variable:
    """A variable of an elementary or derived type."""
    return m.Variable.model_validate({"name": name, "type": type_, **fields})


def st(rig: FeatureChart, text: str) -> m.StBody:
    """A body in structured text."""
    return m.StBody(text="\n".join(f"{rig.name(line)};" for line in text.split("; ")))


# -- the features


def _qualifier(qualifier: str, duration: str | None = None) -> Callable[[FeatureChart], None]:
    def build(rig: FeatureChart) -> None:
        rig.act("Work", "q", qualifier, duration=duration)
        if qualifier in ("S", "SD", "DS", "SL"):
            rig.act("Idle", "q", "R")

    return build


def _reset(rig: FeatureChart) -> None:
    rig.act("Idle", "q", "S")
    rig.act("Work", "q", "R")
    rig.act("Done", "r", "N")


def _program(qualifier: str, language: str = "ST") -> Callable[[FeatureChart], None]:
    def build(rig: FeatureChart) -> None:
        body: m.Body = st(rig, "n := n + 1; r := NOT r")
        if language == "IL":
            body = m.IlBody(text="LD n\nADD 1\nST n\nLD r\nNOT\nST r")
        if language in ("FBD", "LD"):
            body = drawn("r := g;", language)
        rig.action("Count", body)
        rig.act("Work", "Count", qualifier)
        rig.act("Done", "q")

    return build


def drawn(text: str, language: str, dialect: m.Dialect = m.Dialect.IEC) -> m.Body:
    """Statements as a body in FBD or LD."""
    statements = parse_statements(text, dialect).tree.statements
    rules = DrawingRules(dialect=dialect)
    return draw_fbd(statements, rules).body if language == "FBD" else draw_ld(statements, rules).body


def _in_place(rig: FeatureChart) -> None:
    rig.act("Work", None, "N", body=st(rig, "n := n + 1"))
    rig.act("Done", "q")


def _step_action(kind: str) -> Callable[[FeatureChart], None]:
    def build(rig: FeatureChart) -> None:
        rig.action("Count", st(rig, "n := n + 1; r := NOT r"))
        setattr(rig.chart.step("Work"), f"{kind}_action", "Count")
        rig.act("Done", "q")

    return build


def _shared_exit_action(rig: FeatureChart) -> None:
    rig.action("Count", st(rig, "n := n + 1; r := NOT r"))
    for step in ("Work", "Done"):
        rig.chart.step(step).exit_action = "Count"
    rig.act("Done", "q")


def _calls_a_method(rig: FeatureChart) -> None:
    sections = [m.VariableSection(kind=m.SectionKind.INPUT, variables=[variable("more", "INT")])]
    number = m.ElementaryType(name=m.Elementary.INT)
    interface = m.Interface(return_type=number, sections=sections)
    rig.pou.methods = [m.Method(name="Sum", interface=interface, body=m.StBody(text="r := NOT r;\nSum := more;"))]
    rig.action("Count", m.StBody(text="n := Sum(more := 2);"))
    rig.act("Work", "Count")
    rig.act("Done", "q")


def _reads_a_step(rig: FeatureChart) -> None:
    rig.action("Count", m.StBody(text="IF Done.x THEN n := n + 1; END_IF;"))
    rig.act("Work", "Count")
    rig.act("Done", "q")


def _chart_action(rig: FeatureChart) -> None:
    inner = m.SfcNetwork()
    one, two = inner.add_step("One", initial=True), inner.add_step("Two")
    inner.add_transition(one, two, "TRUE")
    inner.add_transition(two, one, "TRUE")
    two.actions.append(m.ActionAssociation(id=inner.new_id(), target="r"))
    rig.action("Inner", m.SfcBody(chart=inner))
    rig.act("Work", "Inner")
    rig.act("Done", "q")


def _calls_an_action(rig: FeatureChart) -> None:
    rig.action("Count", m.StBody(text="n := n + 1;\nIF n > 3 THEN Clear(); END_IF;"))
    rig.action("Clear", m.StBody(text="n := 0;\nr := NOT r;"))
    rig.act("Work", "Count")
    rig.act("Done", "q")


def _priority(rig: FeatureChart) -> None:
    rig.chart.add_step("Other")
    first = rig.chart.transitions[0]
    first.priority = 2
    rig.go("Idle", "Other", "g", priority=1)
    rig.go("Other", "Idle", "c")
    rig.act("Work", "q")
    rig.act("Other", "r")


def _without_priority(rig: FeatureChart) -> None:
    _priority(rig)
    for transition in rig.chart.transitions:
        transition.priority = None


def _step_like_variable(rig: FeatureChart) -> None:
    rig.chart.step("Work").name = "g"
    rig.act("g", "q")
    rig.go("g", "Idle", "c AND NOT b")


def _several_initial_steps(rig: FeatureChart) -> None:
    rig.chart.add_step("Rest", initial=True)
    rig.chart.add_step("Turn")
    rig.go("Rest", "Turn", "g")
    rig.go("Turn", "Rest", "c")
    rig.act("Work", "q")
    rig.act("Turn", "r")


def _parallel(rig: FeatureChart) -> None:
    chart = rig.chart
    left, right = chart.add_step("Left"), chart.add_step("Right")
    chart.transitions[0].targets = [left.id, right.id]
    chart.transitions[1].sources = [left.id, right.id]
    chart.steps = [step for step in chart.steps if step.name != "Work"]
    rig.act("Left", "q")
    rig.act("Right", "r")


def _condition(text: str) -> Callable[[FeatureChart], None]:
    def build(rig: FeatureChart) -> None:
        rig.chart.transition(rig.chart.transitions[1].id).condition = m.Expression(text=rig.name(text))
        rig.act("Work", "q")
        rig.act("Done", "r")

    return build


def _negated_condition(rig: FeatureChart) -> None:
    rig.chart.transitions[1].condition = m.Expression(text="g", negated=True)
    rig.act("Work", "q")


def _named(language: str, text: str = "b AND NOT g", *, negated: bool = False) -> Callable[[FeatureChart], None]:
    def build(rig: FeatureChart) -> None:
        body: m.Body = m.StBody(text=text)
        if language == "IL":
            body = m.IlBody(text="LD b\nANDN g")
        elif language != "ST":
            body = drawn("Ready := b AND NOT g;", language)
        rig.pou.transitions.append(m.NamedTransition(name="Ready", body=body))
        rig.chart.transitions[1].condition = m.NamedCondition(name="Ready", negated=negated)
        rig.act("Work", "q")

    return build


def _wired(rig: FeatureChart) -> None:
    tree = parse_expression("b AND NOT g").tree
    assert tree is not None
    drawing = draw_fbd_expression(tree, first_id=rig.chart.new_id())
    rig.chart.logic = drawing.network.nodes
    pin = m.InputPin(connections=list(drawing.outputs))
    rig.chart.transitions[1].condition = m.WiredCondition(input=pin)
    rig.act("Work", "q")


def _drawn_logic(rig: FeatureChart) -> None:
    drawing = draw_fbd(parse_statements("r := Work.X AND g;").tree.statements, first_id=rig.chart.new_id())
    rig.chart.logic = drawing.body.networks[0].nodes
    rig.act("Work", "q")


def _priority_of_convergence(rig: FeatureChart) -> None:
    chart = rig.chart
    left, right = chart.add_step("Left"), chart.add_step("Right")
    chart.transitions.clear()
    chart.add_transition(chart.step("Idle"), [left, right], "a")
    chart.add_transition([left, right], chart.step("Work"), "b AND c")
    rig.go("Left", "Done", "b")
    rig.go("Work", "Idle", "g")
    rig.go("Done", "Left", "g")
    rig.act("Work", "q")
    rig.act("Done", "r")


def _end(rig: FeatureChart) -> None:
    rig.chart.add_step("Last")
    rig.go("Idle", "Last", "g")
    rig.go("Last", "Idle", "c")
    rig.chart.transitions[-1].targets = []
    rig.act("Work", "q")
    rig.act("Last", "r")


def _minimum(rig: FeatureChart) -> None:
    rig.chart.step("Work").min_time = "T#100ms"
    rig.act("Work", "q")


def _maximum(rig: FeatureChart) -> None:
    rig.chart.step("Work").max_time = "T#50ms"
    rig.declare(m.SectionKind.OUTPUT, variable("SFCError"), variable("SFCEnableLimit", initial="TRUE"))
    rig.chart.settings = settings(m.SfcFlag.ERROR)
    rig.act("Work", "q")


def _quitted(rig: FeatureChart) -> None:
    rig.chart.step("Work").max_time = "T#30ms"
    rig.declare(m.SectionKind.INPUT, variable("SFCQuitError"))
    rig.declare(m.SectionKind.OUTPUT, variable("SFCError"))
    rig.chart.settings = settings(m.SfcFlag.ERROR, m.SfcFlag.QUIT_ERROR)
    rig.act("Work", "q")


def _current_step(rig: FeatureChart) -> None:
    rig.declare(m.SectionKind.OUTPUT, variable("SFCCurrentStep", "STRING"))
    rig.chart.settings = settings(m.SfcFlag.CURRENT_STEP)
    rig.action("Count", m.StBody(text="n := LEN(SFCCurrentStep);"))
    rig.act("Work", "Count")
    rig.act("Done", "q")


def settings(*flags: m.SfcFlag) -> m.SfcSettings:
    """SFC settings in which some flags are in use."""
    return m.SfcSettings(flags={flag: m.FlagUse(use=True, declare=False) for flag in flags})


def _flag(flag: m.SfcFlag) -> Callable[[FeatureChart], None]:
    def build(rig: FeatureChart) -> None:
        rig.declare(m.SectionKind.INPUT, variable(flag.variable))
        rig.chart.settings = settings(flag)
        rig.act("Work", "q")
        rig.act("Done", "r")

    return build


def _initial_value(rig: FeatureChart) -> None:
    rig.declare(m.SectionKind.LOCAL, variable("bound", "INT", initial="3"))
    rig.action("Count", st(rig, "n := n + bound; bound := 5"))  # what nothing writes is an input
    if rig.project.dialect is m.Dialect.SCL:
        rig.pou.actions.clear()
        rig.act("Work", "n", "N", value="bound")
        rig.act("Done", "bound", "N", value="5")
    else:
        rig.act("Work", "Count")
    rig.act("Done", "q")


def _constant(rig: FeatureChart) -> None:
    kind = m.SectionKind.CONSTANT if rig.project.dialect is m.Dialect.SCL else m.SectionKind.LOCAL
    rig.declare(kind, variable("BOUND", "INT", initial="5"), constant=kind is m.SectionKind.LOCAL)
    rig.declare(m.SectionKind.INPUT, variable("level", "INT"))
    _condition("level > BOUND")(rig)


def _address(rig: FeatureChart) -> None:
    name = "%QX4.0" if rig.project.dialect is not m.Dialect.SCL else "%Q4.0"
    if rig.project.dialect is m.Dialect.SCL:
        rig.project.tag_tables.append(m.TagTable(name="Tags", tags=[m.Tag(name="Lamp", type="Bool", address=name)]))
        rig.act("Work", None, "N")
        rig.chart.step("Work").actions[-1].target = '"Lamp"'
    else:
        rig.declare(m.SectionKind.LOCAL, variable("Lamp", address=name))
        rig.act("Work", "Lamp")
    rig.act("Work", "q")


def _globals(rig: FeatureChart) -> None:
    kind, lamp = m.SectionKind.GLOBAL, variable("lamp")
    text = "GVL.lamp"
    if rig.project.dialect is m.Dialect.SCL:
        section = m.VariableSection(kind=m.SectionKind.LOCAL, variables=[lamp])
        rig.project.data_blocks.append(m.DataBlock(name="GVL", interface=m.Interface(sections=[section])))
        text = '"GVL".lamp'
    else:
        rig.project.global_variables.append(m.VariableSection(kind=kind, name="GVL", variables=[lamp]))
    rig.act("Work", None, "S")
    rig.chart.step("Work").actions[-1].target = text
    rig.chart.transitions[1].condition = m.Expression(text=f"{rig.name('b')} AND {text}")
    rig.act("Done", "q")


def _enumeration(rig: FeatureChart) -> None:
    values = [m.EnumValue(name=name) for name in ("Low", "High")]
    rig.project.data_types.append(m.DataTypeDeclaration(name="E_Level", type=m.EnumType(values=values)))
    rig.declare(m.SectionKind.LOCAL, variable("level", "E_Level"))
    rig.action("Raise", m.StBody(text="level := E_Level.High;"))
    rig.act("Work", "Raise")
    rig.chart.transitions[1].condition = m.Expression(text="b AND level = E_Level.High")
    rig.act("Done", "q")


def _excluded(rig: FeatureChart) -> None:
    rig.chart.add_step("Test")
    rig.chart.step("Test").exclude = True
    rig.go("Idle", "Test", "g", exclude=True)
    rig.go("Test", "Idle", "c", exclude=True)
    rig.act("Test", "r")
    rig.act("Work", "q")


def _excluded_branch(rig: FeatureChart) -> None:
    """Excluded as a tool writes it: at the divergence alone, from which its steps and transitions have it."""
    rig.chart.add_step("Test")
    rig.go("Done", "Test", "g")
    rig.go("Test", "Idle", "c")
    rig.act("Test", "r")
    rig.act("Work", "q")
    rig.chart.drawing = draw(rig.chart, DrawingStyle.STRUCTURED)
    (bar,) = (each for each in rig.chart.drawing.symbols if each.kind is m.SymbolKind.SELECTION_DIVERGENCE)
    bar.exclude = True
    held = Branches.of(rig.chart.drawing).held_by(bar.id)
    for thing in (each for group in (rig.chart.steps, rig.chart.transitions) for each in group if each.id in held):
        thing.exclude = True


def _retain(rig: FeatureChart) -> None:
    rig.declare(m.SectionKind.LOCAL, variable("total", "INT"), retain=True)
    rig.action("Count", st(rig, "total := total + 1; n := total"))
    rig.act("Work", "Count", "P1" if rig.project.dialect is m.Dialect.IEC else "P")


def _negated_action(rig: FeatureChart) -> None:
    rig.act("Work", "q", "N", negated=True)


def _macro(rig: FeatureChart) -> None:
    inner = m.SfcNetwork()
    one, two = inner.add_step("One", initial=True), inner.add_step("Two")
    inner.add_transition(one, two, "g")
    two.actions.append(m.ActionAssociation(id=inner.new_id(), target="q"))
    rig.chart.step("Work").macro = m.Macro(body=m.SfcBody(chart=inner))


# -- S7-GRAPH


def _event(event: str, qualifier: str = "N", **fields: object) -> Callable[[FeatureChart], None]:
    def build(rig: FeatureChart) -> None:
        if event in ("V1", "V0", "A1"):
            rig.chart.step("Work").supervision = m.Supervised(condition=m.Expression(text="#g"))
        if event in ("L1", "L0"):
            rig.chart.step("Work").interlock = m.Supervised(condition=m.Expression(text="#g"))
        rig.act("Work", "q", qualifier, event=event, **fields)
        rig.act("Done", "r")

    return build


def _value(value: str, target: str = "n") -> Callable[[FeatureChart], None]:
    def build(rig: FeatureChart) -> None:
        rig.act("Work", target, "N", value=value)
        rig.act("Done", "r")

    return build


def _interlock(qualifier: str, duration: str | None = None) -> Callable[[FeatureChart], None]:
    def build(rig: FeatureChart) -> None:
        rig.chart.step("Work").interlock = m.Supervised(condition=m.Expression(text="#g"))
        rig.act("Work", "q", qualifier, interlock=True, duration=duration)
        rig.act("Idle", "q", "R")

    return build


def _supervision(rig: FeatureChart) -> None:
    rig.chart.step("Work").supervision = m.Supervised(condition=m.Expression(text="#g"))
    rig.act("Work", "q")
    rig.act("Done", "r")


def _permanent(when: str) -> Callable[[FeatureChart], None]:
    def build(rig: FeatureChart) -> None:
        operation = m.PermanentOperation(body=drawn("#r := #g;", "LD", m.Dialect.SCL))
        getattr(rig.chart, f"permanent_{when}").append(operation)
        rig.act("Work", "q")

    return build


def _input(name: str) -> Callable[[FeatureChart], None]:
    def build(rig: FeatureChart) -> None:
        rig.chart.graph_settings = m.GraphSettings(acknowledge_errors_required=False)
        rig.declare(m.SectionKind.INPUT, variable(name))
        rig.act("Work", "q")
        rig.act("Done", "r")

    return build


def _skip(rig: FeatureChart) -> None:
    rig.chart.graph_settings = m.GraphSettings(skip_steps=True)
    rig.act("Work", "q")
    rig.act("Done", "r")


def _second_sequence(rig: FeatureChart) -> None:
    chart = rig.chart
    one, two = chart.add_step("One", initial=True), chart.add_step("Two")
    chart.add_transition(one, two, "#g")
    chart.add_transition(two, one, "#c")
    rig.act("Two", "r")
    rig.act("Work", "q")
    steps = {step.name: step.id for step in chart.steps}
    chart.sequences = [
        m.Sequence(steps=[steps[name] for name in ("Idle", "Work", "Done")]),
        m.Sequence(steps=[steps[name] for name in ("One", "Two")]),
    ]


def _switch(rig: FeatureChart) -> None:
    rig.chart.add_step("Side")
    rig.go("Side", "Idle", "c")
    rig.act("Work", None, "ON", event="S1")
    rig.chart.step("Work").actions[-1].target = "Side"
    rig.act("Side", "r")
    rig.act("Done", "q")


def _of_s5(qualifier: str, condition: str, event: str | None = "S1", **more: str) -> Callable[[FeatureChart], None]:
    """A row of Work that acts on a timer or counter with a tag, which a condition reads, and rows of Idle."""

    def build(rig: FeatureChart) -> None:
        is_timer = qualifier.startswith("T")
        number = ("CU", "CD", "TL", "TD", "TF", "TR").index(qualifier)  # a timer or counter of its own
        kind, address = ("Timer", f"%T{number}") if is_timer else ("Counter", f"%C{number}")
        rig.project.tag_tables.append(m.TagTable(name="Tags", tags=[m.Tag(name="S5", type=kind, address=address)]))
        for step, each in (("Work", qualifier), *(("Idle", each) for each in more.values())):
            start = event if step == "Work" else "S1"
            association = rig.act(step, None, each, event=start, duration="S5T#50ms" if is_timer else None)
            association.target = '"S5"'
            association.value = "3" if each == "CS" else None
        rig.chart.transitions[1].condition = m.Expression(text=condition)
        rig.act("Done", "q")

    return build


def _calls_a_block(rig: FeatureChart) -> None:
    sections = [
        m.VariableSection(kind=m.SectionKind.INPUT, variables=[variable("up")]),
        m.VariableSection(kind=m.SectionKind.OUTPUT, variables=[variable("odd")]),
    ]
    body = m.StBody(text="odd := odd XOR up;")
    block = m.Pou(name="FB_Odd", kind=m.PouKind.FUNCTION_BLOCK, interface=m.Interface(sections=sections), bodies=[body])
    rig.project.pous.append(block)
    rig.declare(m.SectionKind.LOCAL, variable("counter", "FB_Odd"))
    rig.action("Count", m.StBody(text="counter(up := a);\nq := counter.odd;"))
    rig.act("Work", "Count")
    rig.act("Done", "r")


def _calls_a_timer(rig: FeatureChart) -> None:
    rig.declare(m.SectionKind.LOCAL, variable("timer", "TON"))
    rig.action("Wait", m.StBody(text="timer(IN := a, PT := T#30ms);\nIF timer.Q THEN q := TRUE; END_IF;"))
    rig.act("Work", "Wait")
    rig.act("Done", "r")


def _string(rig: FeatureChart) -> None:
    rig.declare(m.SectionKind.LOCAL, variable("text", "STRING"))
    rig.action("Note", m.StBody(text="text := 'abc';\nIF LEN(text) = 3 THEN r := NOT r; END_IF;"))
    rig.act("Work", "Note")
    rig.act("Done", "q")


def _retained_member(rig: FeatureChart) -> None:
    count = variable("count", "INT", attributes={"Remanence": "Retain"})
    rig.declare(m.SectionKind.LOCAL, count, variable("other", "INT"))
    rig.act("Work", "count", value="n")
    rig.act("Done", "q")


def _features() -> Iterator[Feature]:
    for qualifier, duration in (("N", None), ("S", None), ("L", "T#50ms"), ("D", "T#50ms")):
        yield Feature(f"qualifier {qualifier}", _ALL, _qualifier(qualifier, duration))
    yield Feature("qualifier R", _ALL, _reset)
    yield Feature("qualifier P", _IEC, _qualifier("P"))
    for qualifier in ("P1", "P0"):
        yield Feature(f"qualifier {qualifier}", ("plcopen", "iec-text"), _qualifier(qualifier))
    for qualifier in ("SD", "DS", "SL"):
        yield Feature(f"qualifier {qualifier}", _IEC, _qualifier(qualifier, "T#50ms"))
    for language in ("ST", "FBD", "LD", "IL"):
        yield Feature(f"action in {language}", _IEC, _program("N", language))
    yield Feature("action that calls a block", _IEC, _calls_a_block)
    yield Feature("action that calls a timer", _IEC, _calls_a_timer)
    yield Feature("action with a string", _IEC, _string)
    yield Feature("action in ST with S", _IEC, lambda rig: (_program("S")(rig), rig.act("Idle", "Count", "R"), None)[2])
    yield Feature("action in ST with P", _IEC, _program("P"))
    yield Feature("action in place", ("plcopen", "iec-text"), _in_place)
    yield Feature("action that is a chart", ("codesys", "plcopen"), _chart_action)
    yield Feature("action that calls another one", ("codesys",), _calls_an_action)
    yield Feature("action that calls a method", ("codesys",), _calls_a_method)
    yield Feature("action that reads a step flag", ("codesys",), _reads_a_step)
    yield Feature("exit action of two steps", ("codesys",), _shared_exit_action)
    for kind in ("entry", "main", "exit"):
        yield Feature(f"{kind} action", ("codesys",), _step_action(kind))
    yield Feature("priority", _ALL, _priority)
    yield Feature("selection without priorities", _ALL, _without_priority)
    yield Feature("several initial steps", ("plcopen", "iec-text", "simaticml"), _several_initial_steps)
    yield Feature("step named like a variable", ("plcopen", "iec-text"), _step_like_variable)
    yield Feature("simultaneous sequences", _ALL, _parallel)
    yield Feature("priority of a convergence", ("iec-text",), _priority_of_convergence)
    yield Feature("condition: expression", _ALL, _condition("b AND NOT g OR c"))
    yield Feature("condition: negated", ("plcopen",), _negated_condition)
    for language in ("ST", "FBD", "LD", "IL"):
        yield Feature(f"condition: named, {language}", ("codesys", "plcopen"), _named(language))
    yield Feature("condition: named, negated", ("plcopen",), _named("ST", negated=True))
    yield Feature("condition: named, step time", ("codesys", "plcopen"), _named("ST", "Work.T > T#50ms"))
    yield Feature("condition: wired", ("plcopen",), _wired)
    yield Feature("condition: step flag", _ALL, _condition("Work.X AND b"))
    yield Feature("condition: step time", _ALL, _condition("Work.T > T#50ms"))
    yield Feature("end of a sequence", ("plcopen", "iec-text", "simaticml"), _end)
    yield Feature("minimum time", ("codesys",), _minimum)
    yield Feature("maximum time with SFCError", ("codesys",), _maximum)
    yield Feature("SFCQuitError", ("codesys",), _quitted)
    yield Feature("SFCCurrentStep", ("codesys",), _current_step)
    for flag in (m.SfcFlag.INIT, m.SfcFlag.RESET, m.SfcFlag.PAUSE, m.SfcFlag.TIP, m.SfcFlag.TIP_MODE):
        yield Feature(flag.variable, ("codesys",), _flag(flag))
    yield Feature("initial value", _ALL, _initial_value)
    yield Feature("constant", _ALL, _constant)
    yield Feature("address", ("codesys", "plcopen", "simaticml"), _address)
    yield Feature("global variable", ("codesys", "simaticml"), _globals)
    yield Feature("enumeration", ("codesys", "plcopen"), _enumeration)
    yield Feature("excluded element", ("codesys",), _excluded)
    yield Feature("excluded branch", ("codesys",), _excluded_branch)
    yield Feature("retain", ("codesys", "plcopen", "iec-text"), _retain)
    yield Feature("retained member", ("simaticml",), _retained_member)
    yield Feature("negated action", ("plcopen",), _negated_action)
    yield Feature("drawn logic", ("plcopen",), _drawn_logic)
    yield Feature("macro-step", ("plcopen",), _macro)
    for event in ("S1", "S0", "V1", "V0", "L1", "L0", "A1", "R1"):
        yield Feature(f"event {event}", ("simaticml",), _event(event, "S"))
    yield Feature("event S1 with N", ("simaticml",), _event("S1"))
    yield Feature("event S1 with a value", ("simaticml",), lambda rig: (_value("g", "q")(rig), _count(rig), None)[2])
    yield Feature("value: constant", ("simaticml",), _value("7"))
    yield Feature("value: FALSE", ("simaticml",), lambda rig: (_value("FALSE", "q")(rig), _set(rig), None)[2])
    yield Feature("value: variable", ("simaticml",), _value("g", "q"))
    for qualifier, duration in (("N", None), ("S", None), ("L", "T#50ms"), ("D", "T#50ms")):
        yield Feature(f"interlock with {qualifier}", ("simaticml",), _interlock(qualifier, duration))
    yield Feature("supervision", ("simaticml",), _supervision)
    yield Feature("permanent instruction before", ("simaticml",), _permanent("pre"))
    yield Feature("permanent instruction after", ("simaticml",), _permanent("post"))
    for name in ("INIT_SQ", "OFF_SQ"):
        yield Feature(name, ("simaticml",), _input(name))
    yield Feature("SkipSteps", ("simaticml",), _skip)
    yield Feature("two sequences", ("simaticml",), _second_sequence)
    yield Feature("ON", ("simaticml",), _switch)
    yield Feature("counter", ("simaticml",), _of_s5("CU", '#b AND "S5" > 0', idle="CR"))
    yield Feature("counter: CS, CD", ("simaticml",), _of_s5("CD", '#b OR "S5" = 2', idle="CS"))
    for name, condition, event in (("TL", 'NOT "S5"', "S1"), ("TD", '"S5" OR #g', "S1"), ("TF", '#b AND "S5"', None)):
        yield Feature(f"timer of S5: {name}", ("simaticml",), _of_s5(name, condition, event))
    yield Feature("timer of S5: TR", ("simaticml",), _of_s5("TR", '#b AND NOT "S5"', idle="TL"))


def _count(rig: FeatureChart) -> None:
    rig.act("Work", "n", "N", value="n + 1", event="S1")


def _set(rig: FeatureChart) -> None:
    rig.act("Idle", "q", "S")


FEATURES = tuple(_features())
