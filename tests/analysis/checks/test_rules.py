"""Every rule: a chart that breaks it, and one beside it that does not."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.analysis.checks import all_rules
from plcopen_sfc.model import (
    Action,
    ActionAssociation,
    ActionEvent,
    ActionKind,
    BodyCondition,
    Dialect,
    Enclosure,
    Expression,
    ForcedSituation,
    ForcingOrder,
    IlBody,
    Macro,
    NamedCondition,
    NamedTransition,
    PartialChart,
    PartialChartKind,
    Pou,
    PouInstance,
    PouKind,
    Project,
    Qualifier,
    Resource,
    Sequence,
    SfcBody,
    SfcNetwork,
    StBody,
    Step,
    Supervised,
    Task,
    Transition,
    Variable,
    VariableSection,
)
from plcopen_sfc.model.drawing import Drawing, Symbol, SymbolKind
from plcopen_sfc.model.network import Connection, InputPin
from plcopen_sfc.refactor.builder import jump
from plcopen_sfc.refactor.builder import step as step_part
from tests.analysis.checks.charts import project_of, ring

Subject = Project | SfcNetwork


class RuleCase(NamedTuple):
    """Charts that break a rule (with the message) and that do not, under a profile."""

    code: str
    breaks: Callable[[], Subject]
    fine: Callable[[], Subject]
    says: str
    profile: str = "iec"


CASES: list[RuleCase] = []


def text(source: str) -> Callable[[], Subject]:
    return lambda: project_of(source)


def steps(first: str = "", second: str = "", *, condition: str = "a", declared: str = "") -> Callable[[], Subject]:
    """Two steps in a ring, with these associations."""
    return text(
        f"{declared}\nINITIAL_STEP S1: {first} END_STEP\nSTEP S2: {second} END_STEP\n"
        f"TRANSITION FROM S1 TO S2 := {condition}; END_TRANSITION\nTRANSITION FROM S2 TO S1 := b; END_TRANSITION"
    )


def selection(first: str, second: str) -> Callable[[], Subject]:
    """A selection of two legs with these conditions."""
    return text(
        f"""
        INITIAL_STEP S1: END_STEP STEP A: END_STEP STEP B: END_STEP
        TRANSITION FROM S1 TO A := {first}; END_TRANSITION
        TRANSITION FROM S1 TO B := {second}; END_TRANSITION
        TRANSITION FROM A TO S1 := x; END_TRANSITION
        TRANSITION FROM B TO S1 := y; END_TRANSITION
        """
    )


def parallel(first: str, second: str, *, more: str = "") -> str:
    """Two simultaneous branches of one step each, with these associations."""
    return f"""
        INITIAL_STEP S1: END_STEP STEP A: {first} END_STEP STEP B: {second} END_STEP
        TRANSITION FROM S1 TO (A, B) := a; END_TRANSITION
        TRANSITION FROM (A, B) TO S1 := b; END_TRANSITION
        {more}
        """


def made(change: Callable[[SfcNetwork], Any], *names: str) -> Callable[[], Subject]:
    """A ring of steps, changed."""

    def make() -> SfcNetwork:
        chart = ring(*(names or ("S1", "S2", "S3")))
        change(chart)
        return chart

    return make


def acting(chart: SfcNetwork, step: str, **fields: Any) -> ActionAssociation:
    """Give a step an association."""
    association = ActionAssociation(id=chart.new_id(), **fields)
    chart.step(step).actions.append(association)
    return association


def drawn(*symbols: tuple[int, SymbolKind, list[int]], jump_to: int | None = None) -> Callable[[], Subject]:
    """A ring of three steps 0, 2, 4 with the transitions 10, 11, 12, and a drawing of these symbols and wires."""

    def make() -> SfcNetwork:
        chart = SfcNetwork(
            steps=[Step(id=i, name=f"S{i}", initial=not i) for i in (0, 2, 4)],
            transitions=[
                Transition(id=10, sources=[0], targets=[2], condition="a"),
                Transition(id=11, sources=[2], targets=[4], condition="b"),
                Transition(id=12, sources=[4], targets=[0], condition="c"),
            ],
        )
        chart.drawing = Drawing(
            symbols=[
                Symbol(
                    id=number,
                    kind=kind,
                    inputs=[InputPin(connections=[Connection(source=source) for source in sources])],
                    target=jump_to if kind is SymbolKind.JUMP else None,
                    name="S0" if kind is SymbolKind.JUMP else None,
                )
                for number, kind, sources in symbols
            ]
        )
        return chart

    return make


def part(name: str, kind: PartialChartKind, *names: str, initial: bool = True) -> PartialChart:
    network = ring(*names)
    network.steps[0].initial = initial
    return PartialChart(name=name, kind=kind, chart=network)


def case(
    code: str, breaks: Callable[[], Subject], fine: Callable[[], Subject], says: str, profile: str = "iec"
) -> None:
    CASES.append(RuleCase(code, breaks, fine, says, profile))


STEP, TRANSITION, JUMP = SymbolKind.STEP, SymbolKind.TRANSITION, SymbolKind.JUMP
PLAIN = [(0, STEP, [12]), (10, TRANSITION, [0]), (2, STEP, [10]), (11, TRANSITION, [2]), (4, STEP, [11])]
LAST = (12, TRANSITION, [4])

# -- structure

case(
    "STR01",
    drawn(*PLAIN[:4], (4, STEP, [2]), LAST),
    drawn(*PLAIN, LAST),
    "step S2 leads to step S4 without a transition between",
)
case(
    "STR01",
    drawn(*PLAIN[:3], (11, TRANSITION, [10]), (4, STEP, [11]), LAST),
    drawn(*PLAIN, LAST, (20, JUMP, [12]), jump_to=0),
    "leads to transition S2 -> S4 without a step between",
)
case("STR01", drawn(*PLAIN, (20, JUMP, [4]), jump_to=0), drawn(*PLAIN, LAST), "step S4 leads to the jump to S0")
case(
    "STR02",
    made(lambda chart: setattr(chart.step("S1"), "initial", False)),
    made(lambda chart: None),
    "no step is initial",
)


def sequences(*initial: str) -> Callable[[], Subject]:
    """Two sequences of a block, of two steps each."""

    def make() -> SfcNetwork:
        chart = SfcNetwork()
        for names in (("A", "B"), ("C", "D")):
            first, second = (chart.add_step(name, initial=name in initial) for name in names)
            chart.add_transition(first, second, "x")
            chart.add_transition(second, first, "y")
            chart.sequences.append(Sequence(steps=[first.id, second.id]))
        return chart

    return make


case("STR02", sequences("A"), sequences("A", "D"), "no step of sequence 2 is initial", "s7graph")
BARS = SymbolKind.SELECTION_DIVERGENCE, SymbolKind.SIMULTANEOUS_DIVERGENCE
case(
    "STR04",
    drawn((0, STEP, []), (20, BARS[1], [0]), (10, TRANSITION, [20]), (12, TRANSITION, [20])),
    drawn((0, STEP, []), (20, BARS[0], [0]), (10, TRANSITION, [20]), (12, TRANSITION, [20])),
    "step S0 stands above a simultaneous divergence, where transitions belong",
)
case(
    "STR04",
    drawn((10, TRANSITION, []), (20, BARS[0], [10]), (2, STEP, [20]), (11, TRANSITION, [20])),
    drawn((10, TRANSITION, []), (20, BARS[1], [10]), (2, STEP, [20]), (4, STEP, [20])),
    "transition S2 -> S4 stands below a selection divergence, where steps belong",
)
case(
    "STR05",
    drawn(*PLAIN, LAST, (20, JUMP, [12])),
    drawn(*PLAIN, LAST, (20, JUMP, [12]), jump_to=0),
    "a jump leads to 'S0', which is no step",
)
case(
    "STR05",
    made(lambda chart: chart.transitions[0].targets.append(999)),
    made(lambda chart: None),
    "leads to a step that does not exist",
)
case(
    "STR06",
    made(lambda chart: chart.add_transition(chart.add_step("Lost"), chart.step("S1"), "x")),
    made(lambda chart: chart.add_transition(chart.step("S1"), chart.step("S3"), "x")),
    "never become active",
)
MERGED = "TRANSITION FROM A TO S1 := c; END_TRANSITION"
case("STR07", text(parallel("", "", more=MERGED)), text(parallel("", "")), "would activate step")
case(
    "STR08",
    text(
        """
        INITIAL_STEP S1: END_STEP STEP A: END_STEP STEP B: END_STEP
        TRANSITION FROM S1 TO A := a; END_TRANSITION
        TRANSITION FROM S1 TO B := NOT a; END_TRANSITION
        TRANSITION FROM (A, B) TO S1 := c; END_TRANSITION
        """
    ),
    text(parallel("", "")),
    "A and B are never active together",
)
case(
    "STR09",
    made(lambda chart: chart.transitions.pop()),
    made(lambda chart: setattr(chart.transitions[-1], "targets", [])),
    "no transition leaves the step",
)
STUCK = "STEP C: END_STEP TRANSITION FROM A TO C := c; END_TRANSITION TRANSITION FROM (C, A) TO S1 := d; END_TRANSITION"
WAITING = STUCK.replace("(C, A)", "(C, B)")
case("STR10", text(parallel("", "", more=STUCK)), text(parallel("", "", more=WAITING)), "nothing leads on from")
case(
    "STR11",
    made(lambda chart: setattr(chart.transitions[1], "sources", [])),
    made(lambda chart: None),
    "no step leads to the transition",
)
case(
    "STR12",
    made(lambda chart: setattr(chart.step("S3"), "initial", True)),
    made(lambda chart: setattr(chart.add_step("Alone"), "initial", True)),
    "a second initial step in one connected chart, besides S1",
)
LEFT_OUT = """
INITIAL_STEP S1: END_STEP STEP A: END_STEP STEP B: END_STEP STEP C: END_STEP STEP D: END_STEP
TRANSITION FROM S1 TO (A, B, C) := a; END_TRANSITION
TRANSITION FROM (A, B) TO D := b; END_TRANSITION
TRANSITION FROM (C, D) TO S1 := c; END_TRANSITION
"""
NESTED = LEFT_OUT.replace("(A, B, C)", "(D, C)").replace("FROM (A, B) TO D", "FROM D TO (A, B)")
NESTED = (
    NESTED.replace("FROM (C, D)", "FROM (C, E)") + "STEP E: END_STEP TRANSITION FROM (A, B) TO E := e; END_TRANSITION"
)
case("STR13", text(LEFT_OUT), text(NESTED), "forked", "codesys")
case("STR13", text(parallel("", "", more=MERGED)), text(parallel("", "")), "branch", "codesys")
case(
    "STR14",
    made(lambda chart: setattr(chart.transitions[-1], "targets", [])),
    made(lambda chart: None),
    "leads nowhere",
)
case(
    "STR15",
    made(lambda chart: setattr(chart.transitions[-1], "targets", [chart.step("S2").id])),
    made(lambda chart: None),
    "from S2 no way leads back to S1",
)


def in_pou(kind: PouKind) -> Callable[[], Subject]:
    """A ring of steps in a POU of this kind."""
    return lambda: Project(pous=[Pou(name="Main", kind=kind, bodies=[SfcBody(chart=ring("S1", "S2", "S3"))])])


case("STR16", in_pou(PouKind.FUNCTION), in_pou(PouKind.FUNCTION_BLOCK), "is a function, and keeps no step")

# -- names

case(
    "NAM01",
    made(lambda chart: setattr(chart.step("S3"), "name", "s2")),
    made(lambda chart: setattr(chart.step("S3"), "name", "s22")),
    "'S2'",
)
case("NAM02", made(lambda chart: None, "S1", "Wait for"), made(lambda chart: None, "S1", "Wait_for"), "no identifier")
case("NAM02", made(lambda chart: None, "S1", "END_IF"), made(lambda chart: None, "S1", "END_I"), "'END_IF'")
case("NAM03", steps(declared="VAR S2 : BOOL; END_VAR"), steps(declared="VAR S3 : BOOL; END_VAR"), "a variable")


def numbered(*numbers: int) -> Callable[[], Subject]:
    def change(chart: SfcNetwork) -> None:
        for step, number in zip(chart.steps, numbers, strict=True):
            step.number = number

    return made(change)


case("NAM04", numbered(1, 2, 2), numbered(1, 2, 3), "another step has the number 2", "s7graph")
case(
    "NAM05",
    made(lambda chart: setattr(chart.transitions[0], "name", "s2")),
    made(lambda chart: setattr(chart.transitions[0], "name", "T1")),
    "has the name 's2'",
    "s7graph",
)

# -- selections

case("SEL01", selection("a", "b"), selection("a", "NOT a AND b"), "it can be true together with S1 -> A", "grafcet")
case("SEL01", selection("n > 3", "n < 5"), selection("n > 5", "n < 5"), "together", "grafcet")
case("SEL02", selection("f(n) > 3", "f(n + 1) < 3"), selection("n > 3", "n < 3"), "it is unknown", "grafcet")
case("SEL03", selection("a OR b", "a"), selection("a", "a OR b"), "one tried before it is", "codesys")


def with_priorities(chart: SfcNetwork) -> None:
    target = chart.step("S3")
    chart.transitions[0].priority = 1
    chart.add_transition(chart.step("S1"), target, "x", priority=2)


case(
    "SEL01",
    made(lambda chart: chart.add_transition(chart.step("S1"), chart.step("S3"), "x")),
    made(with_priorities),
    "together",
)


def prioritised(first: int, second: int) -> Callable[[], Subject]:
    def change(chart: SfcNetwork) -> None:
        chart.transitions[0].priority = first
        chart.add_transition(chart.step("S1"), chart.step("S3"), "x", priority=second)

    return made(change)


case("SEL04", prioritised(2, 2), prioritised(2, 1), "it has the priority 2, as S1 -> S2 has")

# -- conditions

case("CND08", steps(condition="S7.T > T#5s"), steps(condition="S2.T > T#5s"), "a step 'S7'")
case("CND08", steps(condition="S7.x"), steps(condition="m.x", declared="VAR m : Motor; END_VAR"), "S7.x asks")


def typed(condition: str) -> Callable[[], Subject]:
    """A ring with a condition on variables with types."""
    return steps(condition=condition, declared="VAR_INPUT n : INT; u : USINT; x : REAL; END_VAR")


def in_il(source: str) -> Callable[[], Subject]:
    return made(lambda chart: setattr(chart.transitions[0], "condition", BodyCondition(body=IlBody(text=source))))


case("CND01", made(lambda chart: setattr(chart.transitions[0], "condition", None)), made(lambda chart: None), "no cond")
case(
    "CND01", made(lambda chart: setattr(chart.transitions[0], "condition", Expression(text=" "))), in_il("LD a"), "no c"
)
case("CND01", in_il(" "), in_il("LD a"), "the transition has no condition")
case("CND10", typed("n"), typed("n <> 0"), "the condition n is not Boolean: it is of type INT")
case("CND10", typed("n + 1"), typed("n + 1 > u"), "a number or a time")
case("CND02", steps(condition="TRUE"), steps(condition="a"), "the condition TRUE is always true")
case("CND02", steps(condition="a OR NOT a"), steps(condition="a OR NOT c"), "always true")
case("CND03", steps(condition="n > 5 AND n < 5"), steps(condition="n > 5 AND n < 7"), "never true")
case("CND02", typed("u >= 0"), typed("n >= 0"), "u >= 0 is always true")
case("CND02", typed("n <= 10 OR n >= 11"), typed("x <= 10 OR x >= 11"), "always true")
case("CND03", typed("u > 255"), typed("u > 254"), "u > 255 is never true")
case("CND03", typed("n > 10 AND n < 11"), typed("x > 10 AND x < 11"), "never true")
case("CND04", steps(condition="(q := a)"), steps(condition="(q = a)"), "the condition writes q", "codesys")


case("CND04", in_il("LD a\nANDN b\nST q\n"), in_il("LD a\nANDN b\n"), "writes q", "codesys23")
EDGE = "VAR edge : R_TRIG; END_VAR"
case("CND05", steps(condition="edge(CLK := a)", declared=EDGE), steps(condition="edge.Q", declared=EDGE), "calls edge")
case(
    "CND05",
    steps(condition="TON(IN := a, PT := T#1s)"),
    steps(condition="MAX(n, 3) > 5"),
    "calls TON",
    "codesys",
)


def reading(name: str) -> Callable[[], Subject]:
    def change(chart: SfcNetwork) -> None:
        acting(chart, "S2", target="Q1", kind=ActionKind.CONTINUOUS)
        chart.transitions[0].condition = Expression(text=name)

    return made(change)


case("CND06", reading("NOT Q1"), reading("NOT I1"), "reads Q1", "grafcet")


case("CND09", reading("I1 1B2"), reading("I1 * /1B2 + ↑I2 · [n>=3]"), "missing before '1B2'", "grafcet")
case("CND10", reading("I1 + ↑S2"), reading("I1 * I2 + ↑XS2"), "S2 is a step and no value: its flag is XS2", "grafcet")
case("CND09", reading("n > 3 +"), reading("n > 3 + 1"), "cannot be read", "grafcet")


def naming(name: str) -> Callable[[], Subject]:
    def make() -> Project:
        chart = ring("S1", "S2")
        chart.transitions[0].condition = NamedCondition(name="T1")
        named = NamedTransition(name=name, body=StBody(text="a"))
        pou = Pou(name="P", kind=PouKind.PROGRAM, bodies=[SfcBody(chart=chart)], transitions=[named])
        return Project(pous=[pou])

    return make


case("CND07", naming("T2"), naming("t1"), "no transition and no variable 'T1'", "codesys")

# -- actions

case("ACT01", steps("q(L);"), steps("q(L, T#3s);"), "the qualifier L needs a time")
case("ACT02", steps("q(N);", "q(S);"), steps("q(N);", "p(S);"), "q is set here (S), and step S1 writes it")


def grafcet(first: dict[str, Any], second: dict[str, Any]) -> Callable[[], Subject]:
    def change(chart: SfcNetwork) -> None:
        acting(chart, "S1", **first)
        acting(chart, "S2", **second)

    return made(change)


CONTINUOUS = {"target": "Q", "kind": ActionKind.CONTINUOUS}
STORED = {"target": "Q", "kind": ActionKind.ON_ACTIVATION, "value": "1"}
case("ACT02", grafcet(CONTINUOUS, STORED), grafcet(CONTINUOUS, CONTINUOUS), "Q is stored here", "grafcet")
case(
    "ACT02", grafcet(STORED, {**CONTINUOUS, "kind": ActionKind.LIMITED}), grafcet(STORED, STORED), "limited", "grafcet"
)
case("ACT03", steps("q(S);"), steps("q(S);", "q(R);"), "q is set (S), and nothing resets it")
CODE = "ACTION off: q := FALSE; END_ACTION"
case(
    "ACT03",
    steps("q(SD, T#1s);", "p(N);"),
    text(f"INITIAL_STEP S1: q(SD, T#1s); END_STEP STEP S2: off(P); END_STEP {CODE}"),
    "q is set (SD)",
)
RACE = """
VAR_INPUT a, b : BOOL; END_VAR VAR q : BOOL; n : INT; t : TIME; arr : ARRAY [1..3] OF INT; tm : TON; END_VAR
INITIAL_STEP S1: END_STEP STEP PA: %s END_STEP STEP PB: X2(N); END_STEP
TRANSITION FROM S1 TO (PA, PB) := a; END_TRANSITION TRANSITION FROM (PA, PB) TO S1 := b; END_TRANSITION
ACTION X1: %s END_ACTION ACTION X2: %s END_ACTION
"""
for one, other, harmless, told in (
    ("arr[1] := 1;", "arr[1] := 2;", "arr[2] := 2;", "arr[1] is written here and in step PA"),
    ("tm(IN := a);", "tm(IN := b);", "tm(IN := a);", "tm is written here and in step PA"),
    ("FOR n := 1 TO 3 DO q := TRUE; END_FOR", "n := 2;", "arr[n] := 2;", "n is written here and in step PA"),
    ("tm(IN := a, ET => t);", "t := T#2s;", "n := 2;", "t is written here and in step PA"),
    ("arr[n] := 1;", "arr[N] := 2;", "arr[2] := 2;", "arr[N] is written here and in step PA"),
    ("\nLD 1\nST n\n", "\nLD a\nR q\nLD 2\nST n\n", "\nLD 2\nST arr[n]\n", "n is written here and in step PA"),
):
    case("ACT04", text(RACE % ("X1(N);", one, other)), text(RACE % ("X1(N);", one, harmless)), told)
CONSTANT = "VAR%s K : INT := 5; END_VAR ACTION Act: K := 6; END_ACTION"
case(
    "VAR04",
    steps("Act(N);", declared=CONSTANT % " CONSTANT"),
    steps("Act(N);", declared=CONSTANT % ""),
    "K is a constant, and written: K := 6",
)
BESIDE = text(RACE % ("q(N);", "n := 1;", "q := TRUE;"))
case("ACT04", text(RACE % ("q(N);", "n := 1;", "q := FALSE;")), BESIDE, "q is written here and in step PA")
case("ACT04", text(parallel("q(S);", "q(R);")), text(parallel("q(S);", "q(S);")), "both can be active together")
case(
    "ACT04",
    text(parallel("m(N);", "k(N);", more="ACTION m: x := 1; END_ACTION ACTION k: x := 2; END_ACTION")),
    text(parallel("m(N);", "m(N);", more="ACTION m: x := 1; END_ACTION ACTION k: x := 2; END_ACTION")),
    "x is written here and in step A",
)
case("ACT04", text(parallel("q(S);", "q(R);")), steps("q(S);", "q(R);"), "q is written here and in step A")
LEAVING = {"target": "x", "kind": ActionKind.ON_DEACTIVATION, "value": "1"}
ENTERING = {"target": "x", "kind": ActionKind.ON_ACTIVATION, "value": "2"}
case(
    "ACT04",
    grafcet(LEAVING, ENTERING),
    grafcet({**ENTERING, "value": "1"}, {**LEAVING, "value": "2"}),
    "both happen when S1 -> S2 is cleared",
    "grafcet",
)


def enclosed(*links: str) -> Callable[[], Subject]:
    """Two charts in an enclosing step, in which the steps A and C write the same; `links` are activated with it."""

    def change(whole: SfcNetwork) -> None:
        whole.step("S2").encloses = [Enclosure(chart=f"G{n}", activated_steps=[link]) for n, link in enumerate(links)]
        for number, names in enumerate((("A", "B"), ("C", "D"))):
            inner = part(f"G{number}", PartialChartKind.ENCLOSED, *names, initial=False)
            acting(inner.chart, names[0], target="x", kind=ActionKind.ON_ACTIVATION, value=str(number))
            inner.chart.transitions.pop()  # which would activate it once more
            whole.partial_charts.append(inner)

    return made(change)


case("ACT04", enclosed("A", "C"), enclosed("A", "D"), "both happen when S1 -> S2 is cleared", "grafcet")
FORCED = """GRAFCET Plan
CHART G1
    INITIAL STEP 1
    1 -> 2 : a
    STEP 2
        {below}
    2 -> 1 : b
    STEP 3
        ON EVENT ↑b : q := TRUE
CHART G2
    INITIAL STEP 10
    10 -> 11 : c
    STEP 11
        FORCE G1{order}
        {above}
    11 -> 10 : d
"""


def forced(below: str, order: str, above: str) -> Callable[[], Subject]:
    """A chart that an order forces: `below` is an action of its step 2, `above` one beside the order."""
    return lambda: sfc.loads(FORCED.format(below=below, order=f"{{{order}}}", above=above).encode())


EVENT = "ON EVENT ↑b : {} := {}"
case(
    "ACT04",
    forced(EVENT.format("x", "TRUE"), "2", EVENT.format("x", "FALSE")),
    forced(EVENT.format("x", "TRUE"), "INIT", EVENT.format("x", "FALSE")),
    "step G1.2, and both events can come at once",
    "grafcet",
)
case(
    "ACT04",
    forced("x", "3", EVENT.format("q", "FALSE")),
    forced("x", "INIT", EVENT.format("q", "FALSE")),
    "step G1.3, and both events can come at once",
    "grafcet",
)
case(
    "ACT04",
    forced("ON DEACTIVATION x := TRUE", "INIT", "ON ACTIVATION x := FALSE"),
    forced("ON ACTIVATION x := TRUE", "INIT", "ON ACTIVATION x := FALSE"),
    "G2.10 -> 11",
    "grafcet",
)
case(
    "ACT04",
    forced("ON ACTIVATION x := TRUE", "2", "ON ACTIVATION x := FALSE"),
    forced("ON ACTIVATION x := TRUE", "*", "ON DEACTIVATION x := FALSE"),
    "both happen when G2.10 -> 11 is cleared",
    "grafcet",
)
BESIDE_AN_EVENT = """GRAFCET G
CHART G1
    INITIAL STEP 1
    1 -> 2 : a
    STEP 2
        ON EVENT {0} : q := FALSE
    2 -> 3 : ↑b
    STEP 3
        ON ACTIVATION q := TRUE
    3 -> 1 : /a
"""


def beside_an_event(event: str) -> Callable[[], Subject]:
    return lambda: sfc.loads(BESIDE_AN_EVENT.format(event).encode())


case("ACT04", beside_an_event("↑b"), beside_an_event("↓b"), "the event can come when G1.2 -> 3 is cleared", "grafcet")
BESIDE_ANOTHER = """GRAFCET G
CHART G1
    INITIAL STEP 1
    1 -> 2 : ↑a
    STEP 2
        {0}
    2 -> 1 : {2}
CHART G2
    INITIAL STEP 10
    10 -> 11 : {3}
    STEP 11
        {1}
    11 -> 10 : ↑b
"""


def beside_another(one: str, other: str, forth: str = "a") -> Callable[[], Subject]:
    """Two charts that store q; the second begins by `forth`."""
    return lambda: sfc.loads(BESIDE_ANOTHER.format(one, other, "/a", forth).encode())


case(
    "ACT04",
    beside_another("ON ACTIVATION q := TRUE", "ON ACTIVATION q := FALSE"),
    beside_another("ON ACTIVATION q := TRUE", "ON ACTIVATION q := FALSE", forth="/a"),
    "G1.1 -> 2 and G2.10 -> 11 can be cleared together",
    "grafcet",
)
case(
    "ACT04",
    beside_another("ON ACTIVATION { q := TRUE; }", "ON ACTIVATION { q := FALSE; }"),
    beside_another("ON ACTIVATION { q := TRUE; }", "ON ACTIVATION { q := FALSE; }", forth="X2"),
    "can be cleared together",
    "grafcet",
)
case("ACT05", steps("q(N, T#5s);"), steps("q(N);"), "the time T#5s has no effect")
case("ACT06", steps("q(L, T#5s);", "q(D, T#6s);"), steps("q(L, T#5s);", "q(D, t#5S);"), "another time here")
case("ACT07", steps("q(P1);"), steps("q(N);"), "there is no qualifier P1 here", "s7graph")
case(
    "ACT08",
    made(lambda chart: acting(chart, "S1", qualifier=Qualifier.N)),
    made(lambda chart: acting(chart, "S1", body=StBody(text="x := 1;"))),
    "names no action and no variable",
)


def entering(name: str) -> Callable[[], Subject]:
    def make() -> Project:
        chart = ring("S1", "S2")
        chart.step("S1").entry_action = name
        actions = [Action(name="Start", body=StBody(text="x := 1;"))]
        return Project(pous=[Pou(name="P", kind=PouKind.PROGRAM, bodies=[SfcBody(chart=chart)], actions=actions)])

    return make


case("ACT09", entering("Stop"), entering("start"), "no action 'Stop', the entry action", "codesys")
case("ACT09", entering("Stop"), entering("Motor.Stop"), "'Stop'", "codesys")
case("ACT10", steps("q(R);"), steps("q(R);", "q(S);"), "q is reset, and nothing sets it")


def on_event(condition: str) -> Callable[[], Subject]:
    return made(lambda chart: acting(chart, "S1", target="Q", kind=ActionKind.ON_EVENT, condition=condition))


case("ACT11", on_event("I0"), on_event("↑I0"), "the event of the action is no edge", "grafcet")
case("ACT11", on_event("I0 AND I1"), on_event("RE(I0) AND I1"), "is no edge", "grafcet")


def while_condition(condition: str) -> Callable[[], Subject]:
    return made(lambda chart: acting(chart, "S1", target="Q", kind=ActionKind.CONDITIONAL, condition=condition))


case("ACT12", while_condition("↑I0"), while_condition("I0"), "is an edge", "grafcet")
NUMBER = "VAR n : INT; q : BOOL; END_VAR"
case("ACT13", steps("n(N);", declared=NUMBER), steps("q(N);", declared=NUMBER), "n is no BOOL but INT")


def many(count: int) -> Callable[[], Subject]:
    def change(chart: SfcNetwork) -> None:
        for number in range(count):
            acting(chart, "S2", target=f"q{number}")

    return made(change)


case("ACT14", many(10), many(9), "10 associations", "codesys23")
case("ACT15", steps("q(N);"), steps("", "q(N);"), "the initial step has an association", "codesys23")


def on(**fields: Any) -> Callable[[], Subject]:
    return made(lambda chart: acting(chart, "S1", **fields))


SWITCH = {"qualifier": Qualifier.ON, "target": "S3"}
case("ACT16", on(**SWITCH), on(**SWITCH, event=ActionEvent.S1), "ON needs an event", "s7graph")
case(
    "ACT16",
    on(**{**SWITCH, "target": "S9"}, event=ActionEvent.S1),
    on(qualifier=Qualifier.OFF, target="S_ALL", event=ActionEvent.S1),
    "'S9', which is no step",
    "s7graph",
)


def guarded(supervision: Supervised | None, **fields: Any) -> Callable[[], Subject]:
    def change(chart: SfcNetwork) -> None:
        acting(chart, "S1", target="q", **fields)
        chart.step("S1").supervision = supervision

    return made(change)


case(
    "ACT17",
    guarded(None, event=ActionEvent.V1),
    guarded(Supervised(condition=Expression(text="fault")), event=ActionEvent.V1),
    "the event V1 never comes",
    "s7graph",
)
case("ACT17", guarded(None, interlock=True), guarded(None), "depends on the interlock", "s7graph")

case("ACT18", steps("q(S); q(R);"), steps("q(S);", "q(R);"), "the step sets q (S) and resets it")


def beside_code(actions: str) -> Callable[[], Subject]:
    """A ring of two steps: the code of the first assigns `q`, the second has these associations."""
    return text(
        f"""
        INITIAL_STEP S1: Off(N); END_STEP STEP S2: {actions} END_STEP
        TRANSITION FROM S1 TO S2 := a; END_TRANSITION
        TRANSITION FROM S2 TO S1 := b; END_TRANSITION
        ACTION Off: q := FALSE; END_ACTION
        """
    )


case("ACT19", beside_code("q(S);"), beside_code("lamp(S);"), "q is assigned here, and stored (S) in step S2")
case("ACT19", beside_code("q(DS, T#2s);"), beside_code("q(N);"), "stored (DS) in step S2", "codesys")


def counting(association: str, code: str) -> Callable[[], Subject]:
    """A ring of two steps, the first with an action of this code."""
    return text(
        f"""
        INITIAL_STEP S1: {association} END_STEP STEP S2: END_STEP
        TRANSITION FROM S1 TO S2 := a; END_TRANSITION
        TRANSITION FROM S2 TO S1 := b; END_TRANSITION
        ACTION Count: {code} END_ACTION
        """
    )


LISTED = "\nLD n\nADD 1\nST n\n"
"""An instruction list that counts."""
case("ACT21", counting("Count(P);", "n := n + 1;"), counting("Count(P1);", "n := n + 1;"), "executes n := n + 1 twice")
case("ACT21", counting("Count(P);", LISTED), counting("Count(P);", "n := 1;"), "executes n := n + 1 twice", "codesys23")

# -- evolution, times, limits, lowering

CIRCLE = """
INITIAL_STEP S1: END_STEP STEP S2: END_STEP STEP S3: END_STEP
TRANSITION FROM S1 TO S2 := start; END_TRANSITION
TRANSITION FROM S2 TO S3 := TRUE; END_TRANSITION
TRANSITION FROM S3 TO S2 := %s; END_TRANSITION
"""
ROUND = "always true in a circle: S2 -> S3, S3 -> S2"
case("EVO01", text(CIRCLE % "b OR NOT b"), text(CIRCLE % "b"), ROUND)
case("EVO01", text(CIRCLE % "b OR NOT b"), text(CIRCLE.replace("TRUE", "NOT b") % "b"), ROUND, "grafcet")


RUN = """
INITIAL_STEP S1: END_STEP STEP S2: END_STEP STEP S3: END_STEP
TRANSITION FROM S1 TO S2 := button AND ready; END_TRANSITION
TRANSITION FROM S2 TO S3 := %s; END_TRANSITION
TRANSITION FROM S3 TO S1 := b; END_TRANSITION
"""
case("EVO02", text(RUN % "button"), text(RUN % "button AND x"), "whenever the step is entered", "grafcet")


def timed(least: str, most: str) -> Callable[[], Subject]:
    def change(chart: SfcNetwork) -> None:
        chart.step("S1").min_time = least
        chart.step("S1").max_time = most

    return made(change)


case("TIM01", timed("T#5s", "T#3s"), timed("T#3s", "T#5s"), "longer than the maximum time T#3s", "codesys")
case("TIM01", timed("T#5s", "T#4s"), timed("T#5s", "T#0ms"), "T#5s", "codesys")
case(
    "LIM01",
    made(lambda chart: None, *(f"S{number}" for number in range(251))),
    made(lambda chart: None, *(f"S{number}" for number in range(250))),
    "251 steps; a block has 250 at most",
    "s7graph",
)
case("LOW01", made(lambda chart: None, "S1", "S2"), made(lambda chart: None), "S1 and S2 lead to each other")
case(
    "LOW02",
    made(lambda chart: chart.add_transition(chart.step("S2"), chart.step("S2"), "x")),
    made(lambda chart: None),
    "from S2 to itself",
)

# -- hierarchy


def expanded(*steps_of_it: str, name: str = "M1", back: bool = False) -> Callable[[], Subject]:
    def change(chart: SfcNetwork) -> None:
        chart.step("S2").macro = Macro(expansion="M1")
        inner = part(name, PartialChartKind.EXPANSION, *steps_of_it)
        if not back:
            inner.chart.transitions.pop()
        chart.partial_charts.append(inner)

    return made(change)


case("HIE01", expanded("E", "S", name="M2"), expanded("E", "S"), "macro-step without expansion", "grafcet")
case("HIE01", expanded("E", "S", back=True), expanded("E", "A", "S"), "without exit step", "grafcet")


def enclosing(chart: str, *links: str, initial: bool = True) -> Callable[[], Subject]:
    def change(whole: SfcNetwork) -> None:
        whole.step("S1").encloses = [Enclosure(chart=chart, activated_steps=list(links))]
        whole.partial_charts.append(part("G2", PartialChartKind.ENCLOSED, "A", "B", initial=initial))

    return made(change)


case("HIE02", enclosing("G3", "A"), enclosing("g2", "a"), "no such chart", "grafcet")
case("HIE02", enclosing("G2", "C"), enclosing("G2", "A"), "no step 'C'", "grafcet")
case("HIE02", enclosing("G2"), enclosing("G2", "A", "B"), "activation link", "grafcet")
case("HIE03", enclosing("G2", "A", initial=False), enclosing("G2", "A"), "no initial step", "grafcet")


def forcing(order: ForcingOrder, *, initial: bool = True) -> Callable[[], Subject]:
    def change(whole: SfcNetwork) -> None:
        acting(whole, "S2", kind=ActionKind.FORCING, forcing=order)
        whole.partial_charts.append(part("G2", PartialChartKind.GLOBAL, "A", "B", initial=initial))

    return made(change)


INIT = ForcingOrder(chart="G2", situation=ForcedSituation.INITIAL)
SOME = ForcedSituation.EXPLICIT
case("HIE04", forcing(ForcingOrder(chart="G3", situation=ForcedSituation.EMPTY)), forcing(INIT), "no such", "grafcet")
case("HIE04", forcing(INIT, initial=False), forcing(INIT), "no initial step to force", "grafcet")
case(
    "HIE04",
    forcing(ForcingOrder(chart="G2", situation=SOME, steps=["A", "X"])),
    forcing(ForcingOrder(chart="G2", situation=SOME, steps=["A", "b"])),
    "no step 'X'",
    "grafcet",
)


def ruling(*orders: tuple[str, str], same: bool = True) -> Callable[[], Subject]:
    """Partial charts G1, G2, G3, in which orders rule others: all by the same situation, or by another one each."""

    def change(whole: SfcNetwork) -> None:
        for name in ("G1", "G2", "G3"):
            whole.partial_charts.append(part(name, PartialChartKind.GLOBAL, f"{name}a", f"{name}b"))
        for number, (upper, lower) in enumerate(orders):
            network = next(p.chart for p in whole.partial_charts if p.name == upper)
            situation = list(ForcedSituation)[0 if same else number]
            order = ForcingOrder(chart=lower, situation=situation)
            acting(network, f"{upper}b", kind=ActionKind.FORCING, forcing=order)

    return made(change)


case("HIE05", ruling(("G1", "G2"), ("G2", "G1")), ruling(("G1", "G2"), ("G1", "G3")), "rules itself", "grafcet")
case("HIE05", ruling(("G1", "G1")), ruling(("G1", "G2"), ("G2", "G3")), "rules itself", "grafcet")
OPPOSED = ("G1", "G3"), ("G2", "G3")
case("HIE06", ruling(*OPPOSED, same=False), ruling(*OPPOSED), "rules G3 as well", "grafcet")
case("HIE06", ruling(*OPPOSED, same=False), ruling(("G1", "G3"), ("G1", "G2"), same=False), "rules G3", "grafcet")


def grafcet(text: str) -> Callable[[], Subject]:
    """A chart with a macro-step, as text."""
    return lambda: sfc.loads(f"GRAFCET G\nCHART G1\nINITIAL STEP 1\n{text}".encode())


def of_text(text: str) -> Callable[[], Subject]:
    return lambda: sfc.loads(f"GRAFCET G\n{text}".encode())


ORDERING = """CHART G1
INITIAL STEP 1
1 -> M2 : a
MACRO M2
M2 -> 1 : a
EXPANSION M2 FROM E2 TO S2
STEP E2
E2 -> S2 : a
STEP S2
CHART G3
INITIAL STEP 30
30 -> 31 : a
STEP 31
    FORCE {}
31 -> 30 : /a"""
case("HIE04", of_text(ORDERING.format("M2{E2}")), of_text(ORDERING.format("G1{1}")), "is the expansion", "grafcet")
BEGUN = "CHART G1\n{}1 -> 2 : a\nSTEP 1\nSTEP 2\n2 -> : b"
case("STR02", of_text(BEGUN.format("")), of_text(BEGUN.format("-> 1 : ↑c\n")), "no step is initial", "grafcet")
MEMBER = "INPUTS\n    a\nCHART G1\nINITIAL STEP 1\n1 -> 2 : %s\nSTEP 2\n2 -> 1 : a"
case("VAR01", of_text(MEMBER % "G1.X1"), of_text(MEMBER % "XG1 * X1"), "names nothing", "grafcet")
COUNTED = "INPUTS\n    a\n    C1 : INT\nCHART G1\nINITIAL STEP 1\n1 -> 1 : {}\n"
case("CND10", of_text(COUNTED.format("C1 * a")), of_text(COUNTED.format("[C1>2] * a")), "C1 is of type INT", "grafcet")
case("CND10", of_text(COUNTED.format("/C1")), of_text(COUNTED.format("/a")), "C1 is of type INT", "grafcet")
LOWER = "CHART G1\nINITIAL STEP 1\n1 -> {} : a\n"
TWO_RULERS = LOWER.format("1") + "CHART G2\n{} 10\n    FORCE G1{{INIT}}\n10 -> 10 : a\n"
TWO_RULERS += "CHART G3\n{} 20\n    FORCE G1{{1}}\n20 -> 20 : a\n"
BOTH, ONE = ("INITIAL STEP", "INITIAL STEP"), ("INITIAL STEP", "INITIAL STEP 21\n21 -> 21 : a\nSTEP")
case("HIE06", of_text(TWO_RULERS.format(*BOTH)), of_text(TWO_RULERS.format(*ONE)), "rules G1 as well", "grafcet")
ONE_RULER = LOWER.format("1") + "CHART G2\nINITIAL STEP 10\n    FORCE G1{{INIT}}\n    FORCE {}\n10 -> 10 : a\n"
ONE_RULER += "CHART G3\nINITIAL STEP 20\n20 -> 20 : a\n"
case("HIE06", of_text(ONE_RULER.format("G1{}")), of_text(ONE_RULER.format("G3{}")), "in two ways at once", "grafcet")
LOCKED = (
    LOWER.format("2") + "STEP 2\n2 -> 1 : /a\nCHART G2\nINITIAL STEP 10\n10 -> 11 : {}\nSTEP 11\n    FORCE G1{{2}}\n"
)
LOCKED += "11 -> 10 : /b\nCHART G3\nINITIAL STEP 20\n20 -> 21 : {}\nSTEP 21\n    FORCE G1{{INIT}}\n21 -> 20 : /c\n"
LOCKED += "CHART G4\nINITIAL STEP 40\n40 -> 41 : a\nSTEP 41\n41 -> 40 : b + c\n"
for locked, open_ in (
    (("b * /X21 * /c", "c * /X11 * /b"), ("b * /X21", "c * /X11")),  # both at once
    (("b * /X21", "c * X10 * /b"), ("b * /X21", "c * X10")),
    (("b * /XG3 * X20 + b * /X21", "c * X10 * /b"), ("b * XG3", "c * X10 * /b")),
    (("b * X40 * /X21", "c * X41 * /X11"), ("b * X40", "c * X41")),  # a chart that both look at
    (("↑b * /X21", "↓b * /X11"), ("↑b * /X21", "↑c * /X11")),
    (("3s/X10 * b * /X21", "c * /b * /X11"), ("3s/X10 * b", "c * /b * /X11")),
):
    case("HIE06", of_text(LOCKED.format(*open_)), of_text(LOCKED.format(*locked)), "rules G1 as well", "grafcet")
EXPANDED = LOWER.format("M2") + "MACRO M2\nM2 -> 1 : b\nEXPANSION M2\nSTEP E2\n    FORCE {}\nE2 -> S2 : c\nSTEP S2\n"
EXPANDED += "CHART G2\nINITIAL STEP 10\n10 -> 10 : a\n"
case("HIE05", of_text(EXPANDED.format("G1{INIT}")), of_text(EXPANDED.format("G2{INIT}")), "rules itself", "grafcet")


TABLES = "INPUTS\n    a\n    b\n    n : INT\nOUTPUTS\n    Q\nINTERNALS\n    m : INT\nCHART G1\nINITIAL STEP 1\n    %s\n"
TABLES += "1 -> 2 : ↑a\nSTEP 2\n2 -> 1 : ↑b\n"
for wrong, right, told in (
    ("ON ACTIVATION Q := a * b", "ON ACTIVATION Q := a AND b", "* of BOOL and BOOL: a * b"),
    ("ON ACTIVATION m := m + a", "ON ACTIVATION m := m + 1", "+ of a number and BOOL: m + a"),
    ("ON DEACTIVATION Q := 5", "ON DEACTIVATION Q := 1", "a number is assigned to BOOL: Q := 5"),
    ("ON EVENT ↑a : m := a", "ON EVENT ↑a : m := BOOL_TO_INT(a)", "BOOL is assigned to a number: m := a"),
    ("ON ACTIVATION m := X2", "ON ACTIVATION Q := X2", "BOOL is assigned to a number: m := X2"),
    ("ON ACTIVATION { m := a; }", "ON ACTIVATION { Q := a; }", "BOOL is assigned to a number: m := a"),
):
    case("VAR04", of_text(TABLES % wrong), of_text(TABLES % right), told, "grafcet")
case("CND10", of_text(TABLES % "Q IF n * a"), of_text(TABLES % "Q IF [n>2] * a"), "n is of type INT", "grafcet")
EVENT = "ON EVENT ↑%s : Q := TRUE"
case("CND10", of_text(TABLES % EVENT % "n"), of_text(TABLES % EVENT % "a"), "n is of type INT", "grafcet")
case("CND06", of_text(TABLES % EVENT % "Q"), of_text(TABLES % EVENT % "a"), "reads Q, which the chart", "grafcet")
case("CND06", of_text(TABLES % "R IF Q * b"), of_text(TABLES % "Q IF a * b"), "reads Q, which the chart", "grafcet")
case("CND09", of_text(TABLES % "3s/Q"), of_text(TABLES % "Q AFTER 3s"), "'3s/Q', cannot be read", "grafcet")
case("CND09", of_text(TABLES % "Q IF 2S/a"), of_text(TABLES % "Q IF 2s/a"), "2S is a name, and a time has", "grafcet")
case("CND09", of_text(TABLES % "Q IF [n <>]"), of_text(TABLES % "Q IF [n != 3] * a"), "cannot be read", "grafcet")
case("ACT20", of_text(TABLES % "b"), of_text(TABLES % "Q"), "b is an input, and the action writes it", "grafcet")
case("ACT20", of_text(TABLES % "{ b := a; }"), of_text(TABLES % "{ Q := a; }"), "b is an input, and", "grafcet")
case("VAR01", of_text(TABLES % "Q IF ā"), of_text(TABLES % "Q IF a̅"), "'ā' names nothing", "grafcet")
MIXED = TABLES % "Q" + "CHART G2\nINITIAL STEP 10\n    ON ACTIVATION { %s := TRUE; }\n10 -> 10 : ↑b"
case("ACT02", of_text(MIXED % "Q"), of_text(MIXED % "R"), "Q is stored here (on activation), and step 1", "grafcet")
TWICE = TABLES % "Q" + "CHART G2\nINITIAL STEP %s\n%s -> %s : ↑b"
FINE = of_text(TWICE % (3, 3, 3))
case("NAM01", of_text(TWICE % (2, 2, 2)), FINE, "G1 has a step '2', too: X2 is the flag of both", "grafcet")

MACRO = "MACRO %s EXPANDS M3\n1 -> %s : a\nEXPANSION M3 FROM %s TO S3\nSTEP %s\nSTEP S3"
OWN = "STEP 2\n    ON EVENT %s : Q := TRUE\n1 -> 2 : a\n2 -> 1 : b"
case("ACT11", grafcet(OWN % "↑X2 * a"), grafcet(OWN % "↑X1 * a"), "the event ↑X2 never comes", "grafcet")
case("ACT11", grafcet(OWN % "↓X2"), grafcet(OWN % "↑(X2 * a) + ↑X2"), "the event ↓X2 never comes", "grafcet")
for event in ("↑a + b", "/↑a", "↑a * b + X1"):
    says = "can be TRUE without an edge"
    case("ACT11", grafcet(OWN % event), grafcet(OWN % "(↑a + ↓b) * c + ↑c"), says, "grafcet")
CONTINUOUS = "    %s\n1 -> 1 : a"
case("ACT13", grafcet(CONTINUOUS % "n := n + 1"), grafcet(CONTINUOUS % "n"), "is no continuous action", "grafcet")
case("HIE07", grafcet(MACRO % ("X3", "X3", "E3", "E3")), grafcet(MACRO % ("M3", "M3", "E3", "E3")), "M", "grafcet")
case(
    "HIE07", grafcet(MACRO % ("M3", "M3", "A", "A")), grafcet(MACRO % ("m3", "m3", "e3", "e3")), "entry step", "grafcet"
)
ENDS = "MACRO M3\n1 -> M3 : a\nEXPANSION M3\nSTEP %s\nSTEP %s"
case("HIE07", grafcet(ENDS % ("E3", "31")), grafcet(ENDS % ("E3", "S3")), "named as its exit step: S..", "grafcet")
case("HIE07", grafcet(ENDS % ("30", "S3")), grafcet(ENDS % ("E3", "S3")), "named as its entry step: E..", "grafcet")
case("HIE07", grafcet(ENDS % ("30", "31")), grafcet(ENDS % ("E3", "S3")), "named as its entry step: E..", "grafcet")
RING = "MACRO M3\n1 -> M3 : a\nEXPANSION M3\nSTEP E3\nE3 -> %s : b\nSTEP %s\n%s -> E3 : c"
case("HIE01", grafcet(RING % ("7", "7", "7")), grafcet(RING % ("S3", "S3", "S3")), "without exit step", "grafcet")
case("HIE07", grafcet(ENDS % ("E3", "7")), grafcet(RING % ("7", "7", "7")), "its exit step: S..", "grafcet")
LEFT = "STEP 2\n1 -> 2 : %s"
case("CND02", grafcet(LEFT % "X1/50ms"), grafcet(LEFT % "50ms/X1"), "X1/50ms is always true", "grafcet")
case("CND02", grafcet(LEFT % "b + X1"), grafcet(LEFT % "b + X2"), "b + X1 is always true", "grafcet")
case("CND02", grafcet(LEFT % "1"), grafcet("STEP 2\n1, 2 -> 1 : 1"), "1 is always true", "grafcet")
case("CND03", grafcet(LEFT % "3s/X1 * /X1"), grafcet(LEFT % "3s/X1/2s * /a"), "is never true", "grafcet")
case("CND03", grafcet(LEFT % "3s/↑a"), grafcet(LEFT % "↑a/3s"), "3s/↑a is never true", "grafcet")
case("EVO02", grafcet(LEFT % "b" + "\n2 -> 1 : b"), grafcet(LEFT % "3s/↑a" + "\n2 -> 1 : b"), "is entered", "grafcet")
case("CND09", grafcet(LEFT % "X1.X"), grafcet(LEFT % "X1"), "X1 is a BOOL: it has no X", "grafcet")
case("CND03", grafcet(LEFT % "3s/a * /a"), grafcet(LEFT % "a/3s * /a"), "is never true", "grafcet")
FLAGS = LEFT % "X%s * 3s/X2"
case("VAR01", grafcet(FLAGS % "99"), grafcet(FLAGS % "2"), "'X99' is the flag of a step 99, and there is no", "grafcet")
case("VAR01", grafcet("Q IF XM3"), grafcet("Q IF XM3\nMACRO M3"), "'XM3' is the flag of", "grafcet")


def with_table(condition: str) -> Callable[[], Subject]:
    return lambda: sfc.loads(f"GRAFCET G\nINPUTS\n1B1\nSTART\nC1 : INT\nINITIAL STEP 1\n1 -> 1 : {condition}".encode())


case("CND06", grafcet("    T1\n1 -> 1 : T1"), grafcet("    Q\n1 -> 1 : T1.Q"), "reads T1", "grafcet")
case("CND10", with_table("START * C1>3"), with_table("START * [C1>3]"), "START is BOOL, and START * C1>3", "grafcet")
case("VAR01", with_table("1B1 * /STRT"), with_table("1̅B̅1̅ * START"), "'STRT' names nothing", "grafcet")
case("VAR01", with_table("3s/1B2"), with_table("3s/1B1"), "'1B2' names nothing", "grafcet")
case("VAR01", with_table("START * G"), with_table("START * [C1>3]"), "'G' is the name of the POU", "grafcet")
case("CND09", with_table("1B1 * 1E5"), with_table("1B1 * [C1>1E5]"), "1E5 is no Boolean value", "grafcet")
case(
    "CND09", grafcet("    1E5\n1 -> 1 : a"), grafcet("    1M5\n1 -> 1 : a"), "writes 1E5, which is a number", "grafcet"
)
ENTERED = "1 -> 2 : ↑a\nSTEP 2\n2 -> 3 : %s\nSTEP 3\n3 -> 1 : b"
ENTERED_SAID = "whenever the step is entered, a transition that leaves it is true already"
case("EVO02", grafcet(ENTERED % "a + ↑a"), grafcet(ENTERED % "↑a"), ENTERED_SAID, "grafcet")
ALONE = "STEP 8\nSTEP 9\n8 -> 9 : a\n9 -> 8 : a\n"  # can never become active, which STR06 finds
for code, says in (("EVO01", "a circle fires"), ("EVO02", ENTERED_SAID)):
    case(code, grafcet(ALONE + "1 -> 8 : a"), grafcet(ALONE), says, "grafcet")
EDGED = "1 -> 2 : ↑a * b\n1 -> 3 : %s\nSTEP 2\nSTEP 3"
case("SEL01", grafcet(EDGED % "a * c"), grafcet(EDGED % "c * /a"), "together with 1 -> 2", "grafcet")
case("SEL01", grafcet(EDGED % "↑c"), grafcet(EDGED % "↓a"), "together with 1 -> 2", "grafcet")
TIMED = "1 -> 2 : %s\n1 -> 3 : %s\nSTEP 2\nSTEP 3"
for one, breaking, excluded in (  # a longer delay is over only after the shorter one
    ("3s/a", "/(4s/a) * c", "/(2s/a) * c"),
    ("/(a/5s)", "a/6s", "a/4s"),
    ("2s/(a + b)", "/a", "/a * /b"),
):
    breaks, fine = grafcet(TIMED % (one, breaking)), grafcet(TIMED % (one, excluded))
    case("SEL01", breaks, fine, "together with 1 -> 2", "grafcet")
OTHERS = "\nCHART G2\nINITIAL STEP 5\nSTEP 6\n5 -> 6 : c\n6 -> 5 : /c\nCHART G3\nINITIAL STEP 7\nSTEP 8\n7 -> 8 : c"
for fine in ("X5", "X6"), ("X6 * a", "X5 + X2"):  # steps of one sequence are never active together
    breaks = grafcet(TIMED % ("X5", "X7") + OTHERS)
    case("SEL01", breaks, grafcet(TIMED % fine + OTHERS), "together with 1 -> 2", "grafcet")
AROUND = LOWER.format("2").replace(": a", ": {0}") + "1 -> 3 : {1}\nSTEP 2\n2 -> 1 : b\nSTEP 3\n3 -> 1 : b\n"
AROUND += "CHART G2\nINITIAL STEP 10\n10 -> 11, M12 : d\nSTEP 11 ENCLOSES G3{{31}}\nMACRO M12\n11, M12 -> 10 : c\n"
AROUND += "EXPANSION M12\nSTEP E12\nE12 -> S12 : e\nSTEP S12\n"
AROUND += "ENCLOSED G3\nSTEP 31\n31 -> 32 : e\nSTEP 32\n32 -> 31 : c\n"
for inner, outer in (("X31", "/X11"), ("XE12", "/XM12"), ("↑X32", "X10"), ("5s/X31", "X10"), ("5s/X10", "↑X10")):
    fine = of_text(AROUND.format(inner, outer))
    case("SEL01", of_text(AROUND.format(inner, "e")), fine, "it can be true together with 1 -> 2", "grafcet")
    wrong = of_text(AROUND.format(f"{inner} * {outer}", "e * /a"))
    case("CND03", wrong, of_text(AROUND.format(inner, f"{outer} * a")), "is never true", "grafcet")
case("CND03", of_text(AROUND.format("/XG2", "a")), of_text(AROUND.format("XG2 * a", "/a")), "/XG2 is never", "grafcet")
case("CND03", grafcet("1 -> 2 : X2 * a\nSTEP 2"), grafcet("1 -> 2 : a * /X2\nSTEP 2"), "X2 * a is never", "grafcet")
DONE = "    ON ACTIVATION n := %s\n1 -> 2 : a\nSTEP 2\n    { %s }"
case("CND09", grafcet(DONE % ("n +", "")), grafcet(DONE % ("n + 1", "")), "'n +', cannot be read", "grafcet")
case("CND09", grafcet(DONE % ("1", "q := ;")), grafcet(DONE % ("1", "q := a;")), "'q := ;', cannot be", "grafcet")
case("CND09", grafcet("1 -> 1 : a * IF"), grafcet("1 -> 1 : a * F"), "'IF' is a keyword and no name", "grafcet")
AROUND = "1 -> 2 : a * b\nSTEP 2\n%s2 -> 3 : a\nSTEP 3\n3 -> 1 : %s"
for condition, other in (("a", "a * /b"), ("a + c", "c"), ("1", "↑a"), ("a * X3", "a * X2"), ("b * a", "3s/a")):
    case("EVO01", grafcet(AROUND % ("", condition)), grafcet(AROUND % ("", other)), "a circle fires", "grafcet")
STORED = "    ON ACTIVATION %s := FALSE\n"
case("EVO01", grafcet(AROUND % (STORED % "c", "a")), grafcet(AROUND % (STORED % "a", "a")), "G1.3 -> 1", "grafcet")
case("EVO01", grafcet("1 -> 1 : a"), grafcet("1 -> 1 : ↑a"), "a circle fires without end: G1.1 -> 1", "grafcet")
UNUSED = "EXPANSION M3 FROM E3 TO S3\nSTEP E3\nSTEP S3\nENCLOSED G2\nSTEP 20"
FLAG = "    ON ACTIVATION %s := TRUE\n    X3\nSTEP 2"
case("ACT20", grafcet(FLAG % "X2"), grafcet(FLAG.replace("X3", "X4") % "X5"), "X2 is the flag of a step", "grafcet")
case("STR01", grafcet("-> : a"), grafcet("-> 1 : ↑a"), "leads from no step to no step", "grafcet")
case("HIE08", grafcet(UNUSED), grafcet("MACRO M3\nSTEP 2 ENCLOSES G2{20}\n" + UNUSED), "never active", "grafcet")


# -- names

BOOLS = "VAR_INPUT Start, b : BOOL; END_VAR"
case(
    "VAR01", steps(condition="Strat", declared=BOOLS), steps(condition="Start", declared=BOOLS), "'Strat' names nothing"
)
case("VAR01", steps(condition="Strat", declared=BOOLS), steps(condition="Start", declared=BOOLS), "'Strat' names no")
case(
    "VAR01",
    steps("Strt(N);", condition="b", declared=BOOLS),
    steps("Start(N);", condition="b", declared=BOOLS),
    "'Strt' names nothing",
)


def whole(file: str) -> Callable[[], Subject]:
    """A project that is a whole file of textual IEC 61131-3."""
    return lambda: sfc.loads(file.encode(), format="iec-text")


OF_CODESYS = """{plcopen_sfc format := 1}
{plcopen_sfc project.dialect := 'codesys'}
VAR_GLOBAL g : INT; END_VAR
PROGRAM Main
VAR_INPUT Start : BOOL; END_VAR
VAR p : POINTER TO BOOL; n : UDINT; END_VAR
INITIAL_STEP S1: Take(P); END_STEP
TRANSITION FROM S1 TO S1 := Start; END_TRANSITION
ACTION Take: p := %s(Start); n := SIZEOF(Start); __DELETE(p);
END_ACTION
END_PROGRAM
"""
case("VAR01", whole(OF_CODESYS % "Addr"), whole(OF_CODESYS % "ADR"), "'Addr' names nothing", "codesys")
case("VAR02", steps(condition="Go"), steps(condition="Go", declared="VAR Go, b : BOOL; END_VAR"), "elsewhere: b, Go")


def plant(text: str, *, globals: str = "", actions: str = "Rinse") -> Callable[[], Subject]:
    """A program for CODESYS whose step does `text`, in a project with global variables and actions of these names."""

    def make() -> Project:
        project = Project(name="Plant", dialect=Dialect.CODESYS)
        if globals:
            variables = [Variable(name=name, type="BOOL") for name in globals.split()]
            project.global_variables.append(VariableSection(name="GVL", variables=variables))
        code = [("N Act", text), *(("N " + name, "x := TRUE;") for name in actions.split())]
        pou = project.add_program(
            "Main", step_part("S1", initial=True, actions=code), "b", step_part("S2"), "b", jump("S1")
        )
        pou.add_variable("x")
        return project

    return make


def unused() -> Project:
    project = plant("x := b;")()
    assert isinstance(project, Project)
    pou = project.pou("Main")
    task = Task(name="Main", instances=[PouInstance(name="Main")])
    project.applications.append(Resource(name="Application", tasks=[task]))
    pou.add_action("Flush", "x := FALSE;")
    pou.add_variable("SFCInit")  # a flag: the tool uses it
    return project


case(
    "VAR01", plant("x := GVL.Stat;", globals="State"), plant("x := GVL.State;", globals="State"), "'Stat' is no member"
)
case("VAR01", plant("x := S9.x;", globals="State"), plant("x := S2.x;", globals="State"), "'S9' names no step")
case("VAR01", plant("x := Other;", globals="State"), plant("x := State;", globals="State"), "'Other' names nothing")
case("VAR02", plant("x := GVL.State; y();"), plant("x := GVL.State;", globals="State"), "declared elsewhere: GVL, y")


def unused_variable() -> Project:
    project = plant("x := b;")()
    assert isinstance(project, Project)
    project.pou("Main").add_variable("Spare")
    return project


def part_of_another() -> Project:
    project = plant("x := b;")()
    assert isinstance(project, Project)
    project.pou("Main").add_action("Flush", "x := FALSE;")  # another file may call it
    return project


case("VAR03", unused, plant("x := b;"), "nothing uses the action 'Flush'")
case("VAR03", unused_variable, part_of_another, "nothing uses the variable 'Spare'")
TWICE = "VAR_INPUT b : BOOL; END_VAR VAR %s : INT; END_VAR"
case("VAR05", steps(condition="b", declared=TWICE % "B"), steps(condition="b", declared=TWICE % "n"), "'b' already")
TWO_ACTIONS = TWICE % "n" + " ACTION Fill: n := 1; END_ACTION ACTION %s: n := 2; END_ACTION"
case(
    "VAR05",
    steps(condition="b", declared=TWO_ACTIONS % "fill"),
    steps(condition="b", declared=TWO_ACTIONS % "Empty"),
    "has an action 'Fill' already",
)
case("VAR04", plant("x := 2;"), plant("x := b;"), "a number is assigned to BOOL: x := 2")
OF_PROJECT = "%s VAR_GLOBAL g : BOOL; %s : INT; END_VAR TYPE T1 : STRUCT m : INT; %s : INT; END_STRUCT; END_TYPE "
OF_PROJECT += "FUNCTION_BLOCK F1 VAR_INPUT y : INT; END_VAR END_FUNCTION_BLOCK PROGRAM Main VAR b : BOOL; END_VAR "
OF_PROJECT += "INITIAL_STEP S1: END_STEP TRANSITION FROM S1 TO S1 := b; END_TRANSITION END_PROGRAM"
for added, told in (
    (("FUNCTION_BLOCK f1 END_FUNCTION_BLOCK", "h", "n"), "has a POU 'f1' already"),
    (("TYPE t1 : INT; END_TYPE", "h", "n"), "has a data type 't1' already"),
    (("", "G", "n"), "the list has a variable 'g' already"),
    (("", "h", "M"), "T1 has a member 'm' already"),
):
    case("VAR05", whole(OF_PROJECT % added), whole(OF_PROJECT % ("", "h", "n")), told)

CONSTANTS = "TYPE Pair : STRUCT m : BOOL; END_STRUCT; END_TYPE PROGRAM Main VAR%s K : BOOL; p : Pair; END_VAR "
CONSTANTS += "VAR a, b : BOOL; many : ARRAY [1..2] OF INT; n : INT; END_VAR INITIAL_STEP S1: %s END_STEP "
CONSTANTS += "TRANSITION FROM S1 TO S1 := a; END_TRANSITION ACTION Act: %s END_ACTION END_PROGRAM"
for association, code, told in (
    ("K(N);", "", "K is a constant, and written: K"),
    ("K(S);", "", "K is a constant, and written: K"),
    ("a(N, K);", "", "K is a constant, and written: K"),
    ("Act(N);", "p.m := TRUE;", "p is a constant, and written: p.m := TRUE"),
):
    case(
        "VAR04",
        whole(CONSTANTS % (" CONSTANT", association, code)),
        whole(CONSTANTS % ("", association, code)),
        told,
    )

TYPED = """
TYPE Part : STRUCT Size : INT; END_STRUCT; END_TYPE
FUNCTION_BLOCK Valve
VAR_INPUT Open : BOOL; END_VAR
Open := Open;
END_FUNCTION_BLOCK
PROGRAM Main
VAR b : BOOL; n : INT; s : STRING; w : TIME; d : DATE; t : TON; v : Valve; p : Part; many : ARRAY [0..1] OF TON; END_VAR
VAR x : %s; END_VAR
INITIAL_STEP S1: Act(N); END_STEP
TRANSITION FROM S1 TO S1 := %s; END_TRANSITION
ACTION Act: %s END_ACTION
END_PROGRAM
"""
RING_OF_ONE = """
PROGRAM Main
VAR b : BOOL; END_VAR
INITIAL_STEP S1: b; END_STEP
TRANSITION FROM S1 TO S1 := b; END_TRANSITION
END_PROGRAM
"""
INTS = "VAR n : INT; END_VAR"


def typed(statement: str = "n := 1;", *, condition: str = "b", type: str = "INT") -> Callable[[], Subject]:
    return whole(TYPED % (type, condition, statement))


case("VAR01", typed(type="NoSuchType"), typed(type="Part"), "'NoSuchType' names no type")
case("VAR01", typed(type="ARRAY [0..3] OF Parts"), typed(type="ARRAY [0..3] OF Part"), "'Parts' names no type")
case("VAR01", typed("t(INN := b);"), typed("t(IN := b, Q => b);"), "'INN' is no parameter of t")
case("VAR01", typed("v(Close := b);"), typed("v(Open := b, EN := b);"), "'Close' is no parameter of v")
case("VAR01", typed(condition="t.QQ"), typed(condition="t.Q"), "'QQ' is no member")
case("VAR01", typed("many[1](INN := b);"), typed("many[1](IN := b);"), "'INN' is no parameter of many[1]")
for wrong, right, told in (
    ("n := s;", "n := LEN(s);", "STRING is assigned to a number"),
    ("s := 3;", "s := 'three';", "a number is assigned to STRING"),
    ("b := s = 3;", "b := s = '3';", "STRING and a number: s = 3"),
    ("n := n + s;", "n := n + STRING_TO_INT(s);", "a number and STRING: n + s"),
    ("IF s THEN n := 1; END_IF;", "IF b THEN n := 1; END_IF;", "a condition is STRING: s"),
    ("w := d;", "d := d;", "DATE is assigned to TIME"),
    ("n := p;", "n := p.Size;", "a structure is assigned to a number"),
    ("n := v;", "b := v.Open;", "an instance is assigned to a number"),
    ("n := t.Q;", "w := t.ET;", "BOOL is assigned to a number: n := t.Q"),
    ("n := many;", "b := many[1].Q;", "an array is assigned to a number"),
    ("t(IN := n);", "t(IN := n > 1);", "IN of TON is BOOL, not a number"),
    ("t(PT := 5);", "t(PT := w);", "PT of TON is TIME, not a number"),
    ("t(Q => n);", "t(Q => b);", "Q of TON is BOOL, not a number"),
    ("v(Open := w);", "v(Open := b);", "Open of v is BOOL, not TIME"),
    ("n := LEN(n);", "n := LEN(s);", "IN of LEN is STRING, not a number"),
    ("n := S1.T;", "w := S1.T;", "TIME is assigned to a number: n := S1.T"),
    ("b := S1.T;", "b := S1.X;", "TIME is assigned to BOOL: b := S1.T"),
    ("many := 1;", "b := 1;", "is assigned to an array: many := 1"),
    ("t := n;", "n := n;", "a number is assigned to an instance: t := n"),
    ("n := t;", "w := t.ET;", "an instance is assigned to a number: n := t"),
    ("n := MAX(1, 'x');", "n := MAX(1, n);", "STRING: MAX(1, 'x')"),
    ("n := LEFT(s, 1);", "s := LEFT(s, 1);", "STRING is assigned to a number"),
    ("n := n AND 1.5;", "n := n AND 1;", "AND of REAL: n AND 1.5"),
    ("b := NOT w;", "n := NOT n;", "NOT of TIME: NOT w"),
    ("FOR b := 1 TO 3 DO n := 1; END_FOR", "FOR n := 0 TO 1 DO b := TRUE; END_FOR", "what a FOR counts is BOOL: b"),
    ("FOR n := 1 TO b DO n := 1; END_FOR", "FOR n := 1 TO n DO b := TRUE; END_FOR", "what a FOR counts is BOOL: b"),
    ("CASE n OF TRUE: n := 1; END_CASE", "CASE n OF 0..3: n := 1; END_CASE", "a label of a CASE is BOOL: TRUE"),
    ("many[b](IN := b);", "many[n](IN := b);", "an index is BOOL: b"),
    ("b();", "t();", "BOOL cannot be called: b()"),
    ("n := LEN(s, s, s);", "n := MAX(1, 2, 3);", "LEN has no argument 3: LEN(s, s, s)"),
    ("TON(IN := b);", "t(IN := b);", "TON is a type: an instance of it is called: TON(IN := b)"),
    ("Valve(Open := b);", "v(Open := b);", "Valve is a type: an instance of it is called"),
    ("many[2](IN := b);", "many[1](IN := b);", "the array goes from 0 to 1: many[2]"),
    ("b := many[-1].Q;", "b := many[n].Q;", "the array goes from 0 to 1: many[-1]"),
    ("many[1 + 1].IN := b;", "many[2 - 1].IN := b;", "the array goes from 0 to 1: many[1 + 1]"),
    ("n[1] := 1;", "many[1](IN := b);", "a number has no index: n[1]"),
):
    case("VAR04", typed(wrong), typed(right), told)
for wrong, right, told in (
    ("BOOL := 5", "BOOL := 1", "the initial value of BOOL is a number: 5"),
    ("INT := TRUE", "INT := -1", "the initial value of INT is BOOL: TRUE"),
    ("TIME := 5", "TIME := T#5s", "the initial value of TIME is a number"),
    ("ARRAY [0..2] OF INT := [1, 1(T#1s), 3]", "ARRAY [0..2] OF INT := [1, 2(3)]", "the initial value of INT is TIME"),
    ("Part := (Size := 'a')", "Part := (Size := 3)", "the initial value of INT is STRING: 'a'"),
    ("STRING := 3", "STRING := '3'", "the initial value of STRING is a number"),
):
    case("VAR04", typed(type=wrong), typed(type=right), told)
WITH_GLOBAL = "VAR_GLOBAL g : %s; END_VAR TYPE Size : STRUCT Wide : %s; END_STRUCT; END_TYPE " + RING_OF_ONE
case("VAR04", whole(WITH_GLOBAL % ("INT := TRUE", "INT")), whole(WITH_GLOBAL % ("INT", "INT")), "value of INT is BOOL")
case("VAR04", whole(WITH_GLOBAL % ("INT", "INT := TRUE")), whole(WITH_GLOBAL % ("INT", "INT")), "value of INT is BOOL")
case("VAR01", whole(WITH_GLOBAL % ("INT", "Sizes")), whole(WITH_GLOBAL % ("INT", "INT")), "'Sizes' names no type")
case("VAR04", typed(condition="n > s"), typed(condition="n > 2"), "a number and STRING: n > s")
for wrong, right, told in (
    ("S1.T", "S1.T > T#2s", "TIME"),
    ("t.ET", "t.Q", "TIME"),
    ("t", "many[0].Q", "an instance"),
    ("v", "v.Open", "an instance"),
    ("'x'", "s = 'x'", "STRING"),
    ("LEN(s)", "LEN(s) > 1", "a number"),
    ("NOT n", "NOT S1.X", "a number"),
    ("many", "many[1].Q", "an array"),
):
    case("CND10", typed(condition=wrong), typed(condition=right), f"is not Boolean: it is {told}")
case("VAR04", steps("q(D, n);", declared=INTS), steps("q(D, T#1s);", declared=INTS), "a duration is a number: n")
CIRCLE = (
    "TYPE A : STRUCT inner : %s; END_STRUCT; END_TYPE TYPE B : STRUCT inner : ARRAY [0..1] OF %s; END_STRUCT; END_TYPE"
)
for wrong, told in ((("A", "INT"), "A contains itself"), (("B", "A"), "A contains itself through B")):
    case(
        "VAR07",
        whole(CIRCLE % wrong + TYPED % ("INT", "b", "")),
        whole(CIRCLE % ("B", "INT") + TYPED % ("A", "b", "")),
        told,
    )
OWN = "FUNCTION_BLOCK Own VAR%s other : Own; END_VAR ; END_FUNCTION_BLOCK" + TYPED % ("Own", "b", "")
case("VAR07", whole(OWN % ""), whole(OWN % "_IN_OUT"), "Own contains itself")


def of_library(base: str, type: str) -> Callable[[], Subject]:
    """A program for CODESYS with global variables, and a block that extends `base`."""
    text = f"""{{plcopen_sfc format := 1}}
{{plcopen_sfc project.dialect := 'codesys'}}
VAR_GLOBAL g : INT; END_VAR
FUNCTION_BLOCK Base ; END_FUNCTION_BLOCK
FUNCTION_BLOCK Valve EXTENDS {base} ; END_FUNCTION_BLOCK
PROGRAM Main
VAR v : Valve; b : BOOL; x : {type}; END_VAR
INITIAL_STEP S1: END_STEP
TRANSITION FROM S1 TO S1 := v.Closed; END_TRANSITION
END_PROGRAM
"""
    return whole(text)


case("VAR01", plant("x := SFCErrr;", globals="g"), plant("x := SFCError;", globals="g"), "'SFCErrr' names", "codesys")
case("VAR01", of_library("Base", "Valve"), of_library("LibraryBase", "Valve"), "'Closed' is no member", "codesys")
case("VAR01", of_library("LibraryBase", "Vallve"), of_library("LibraryBase", "BLINK"), "'Vallve' names no", "codesys")
case("VAR02", of_library("LibraryBase", "BLINK"), of_library("LibraryBase", "Valve"), "elsewhere: BLINK", "codesys")
case(
    "VAR01",
    plant("xGateOpen();", actions="xGoteOpen"),
    plant("eGateOpen();", actions="GateOpen"),
    "'xGateOpen' names nothing",
)
case(
    "VAR01",
    plant("xGateOpen();", actions="xGoteOpen"),
    plant("xGateOpen2();", actions="xGateOpen1"),
    "'xGateOpen' names nothing",
)
NAMED = "GRAFCET %s\nINPUTS\n    a\n    %s\nINITIAL STEP 1\n1 -> 2 : a\nSTEP 2\n2 -> 1 : /a\n"
case("VAR06", grafcet(NAMED % ("Not", "b")), grafcet(NAMED % ("Note", "b")), "'Not' is a keyword", "grafcet")
case("VAR06", grafcet(NAMED % ("H", "While")), grafcet(NAMED % ("H", "1B1")), "'While' is a keyword", "grafcet")


def dotted(name: str) -> Callable[[], Subject]:
    data, _ = sfc.convert(sfc.loads((NAMED % ("H", "other")).encode()), "grafcet")
    return lambda: sfc.loads(data.replace(b'"other"', f'"{name}"'.encode()))


case("VAR06", grafcet(NAMED % ("H", "1E5")), grafcet(NAMED % ("H", "1E5B")), "does not read '1E5' as one", "grafcet")
case("VAR06", grafcet(NAMED % ("H", "1_1")), grafcet(NAMED % ("H", "1_1B")), "does not read '1_1' as one", "grafcet")
case("VAR06", dotted("a.b"), dotted("2s/X2"), "does not read 'a.b' as one name", "grafcet")


def remark(comment: str) -> Callable[[], Subject]:
    return made(lambda chart: setattr(chart.step("S2"), "comment", comment))


case("CHK01", remark("plcopen-sfc: ignore STR99"), remark("plcopen-sfc: ignore STR09, ACT"), "suppresses STR99")
case("CHK01", remark("plcopen-sfc: ignore"), remark("nothing to say"), "names no rule")


@pytest.mark.parametrize("each", CASES, ids=[f"{c.code}-{n}" for n, c in enumerate(CASES)])
def test_a_breach_is_found_and_what_is_beside_it_is_not(each: RuleCase) -> None:
    found = sfc.check(each.breaks(), profile=each.profile, select=[each.code])
    assert found, "the breach is not found"
    assert any(each.says in finding.message for finding in found), [finding.message for finding in found]
    assert [str(finding) for finding in sfc.check(each.fine(), profile=each.profile, select=[each.code])] == []


def test_every_rule_has_a_case() -> None:
    assert {rule.code for rule in all_rules()} - {each.code for each in CASES} == set()


def test_whether_legs_exclude_each_other_is_decided_with_their_types() -> None:
    project = project_of("""VAR_INPUT n : INT; a : BOOL; END_VAR
INITIAL_STEP S1: END_STEP
STEP S2: END_STEP
STEP S3: END_STEP
TRANSITION FROM S1 TO S2 := n > 5 AND n < 7; END_TRANSITION
TRANSITION FROM S1 TO S3 := n > 6; END_TRANSITION
TRANSITION FROM S2 TO S1 := a; END_TRANSITION
TRANSITION FROM S3 TO S1 := a; END_TRANSITION""")
    assert not {"SEL01", "SEL02"} & {finding.code for finding in sfc.check(project, profile="matiec")}


def test_of_many_branches_that_are_true_together_some_pairs_are_told() -> None:
    """All pairs of 250 took minutes: each branch is told with eight others at most, and that there may be more."""
    count = 20
    steps = "".join(f"STEP T{number}: END_STEP\n" for number in range(count))
    there = "".join(f"TRANSITION FROM S TO T{number} := n >= {number}; END_TRANSITION\n" for number in range(count))
    back = "".join(f"TRANSITION FROM T{number} TO S := a; END_TRANSITION\n" for number in range(count))
    source = (
        f"PROGRAM P\nVAR_INPUT n : INT; a : BOOL; END_VAR\nINITIAL_STEP S: END_STEP\n{steps}{there}{back}END_PROGRAM\n"
    )
    found = sfc.check(sfc.loads(source.encode(), format="iec-text"), profile="matiec", select=["SEL01"])
    told = Counter(finding.location.path for finding in found)
    assert sorted(told.values()) == [*range(1, 8), *[8] * (count - 8)]
    assert sum("there may be more" in finding.message for finding in found) == count - 8


def test_hints_for_a_grafcet_have_its_words() -> None:
    """It has no qualifiers, no priorities, and no TRUE."""
    project = sfc.loads(
        b"GRAFCET G\nINITIAL STEP 1\n    Q\n    ON ACTIVATION Q\n1 -> 2 : a\n1 -> 3 : b\n1 -> 4 : [n > m + 1]\n"
        b"STEP 2\n2 -> 1 : 1\nSTEP 3\n3 -> 1 :\nSTEP 4\n4 -> 1 : Q"
    )
    found = {finding.code: finding for finding in sfc.check(project)}
    hints = {code: found[code].hint for code in ("ACT02", "SEL01", "CND01", "CND02", "CND06")}
    assert all(rule.grafcet_hint == hints[rule.code] for rule in all_rules() if rule.code in hints.keys() - {"CND06"})
    assert "ON ACTIVATION" in hints["ACT02"]
    assert not re.search(r"S and R|priorit|TRUE|scan|\.X", " ".join(hints.values()))
    assert "(on activation)" in found["ACT02"].message


def test_findings_about_a_table_have_the_lines_of_its_variables(tmp_path: Path) -> None:
    text = "GRAFCET G\n\nINPUTS\n    a\n\n    b : FOO\n    IF\nCHART G1\n    INITIAL STEP 1\n    1 -> 1 : ↑a\n"
    (tmp_path / "g.gct").write_text(text, encoding="utf-8")
    found = sfc.check(sfc.load(tmp_path / "g.gct"), select=["VAR"])
    assert [(each.code, each.location.line) for each in found] == [("VAR01", 6), ("VAR06", 7)]


CODE = """TYPE State : (Off, On); END_TYPE
PROGRAM Main
VAR a : BOOL; s : State; n : INT; END_VAR
%s
END_PROGRAM
FUNCTION Twice : INT
VAR_INPUT x : INT; END_VAR
Twice := 2 * x;
END_FUNCTION
"""


@pytest.mark.parametrize(
    ("text", "codes"),
    [
        ("a := s = State#On; n := Twice(x := n);", []),
        ("a := aa;", ["VAR01"]),
        ("a := Twice(y := n) > 0;", ["VAR01"]),
        ("n := a;", ["VAR04"]),
    ],
)
def test_rules_on_names_look_at_code_of_pous_without_charts(text: str, codes: list[str]) -> None:
    project = sfc.loads((CODE % text).encode(), format="iec-text")
    found = sfc.check(project, ignore=["VAR03"])
    assert [each.code for each in found] == codes
    assert {each.location.path for each in found} <= {"POU Main"}
    assert [each.code for each in sfc.check(project.pou("Main"), ignore=["VAR03"])] == codes
    assert not sfc.check(project.pou("Twice"))


def test_a_name_is_found_once_in_charts_and_code() -> None:
    text = CODE % "a := aa;"
    chart = "PROGRAM Chart\nVAR b : BOOL; END_VAR\nINITIAL_STEP S: b(N); END_STEP\n"
    chart += "TRANSITION FROM S TO S := aa; END_TRANSITION\nEND_PROGRAM\n"
    project = sfc.loads((text + chart).encode(), format="iec-text")
    assert [each.location.path for each in sfc.check(project, select=["VAR01"])] == ["POU Main"]
    project.pou("Main").bodies.clear()
    (finding,) = sfc.check(project, select=["VAR01"])
    assert str(finding.location.path).startswith("POU Chart")


def test_function_blocks_of_libraries_of_beremiz_are_declared_elsewhere() -> None:
    project = sfc.loads((CODE % "").encode(), format="iec-text")
    project.pou("Main").add_variable("Lamp", "Led")
    assert [each.code for each in sfc.check(project, select=["VAR01", "VAR02"])] == ["VAR01"]
    project.header.company = "Beremiz"
    assert [each.code for each in sfc.check(project, select=["VAR01", "VAR02"])] == ["VAR02"]


def test_a_name_is_not_suggested_for_itself() -> None:
    """That of a transition was: it is declared, and no variable."""
    text = """PROGRAM P
VAR a, b : BOOL; END_VAR
INITIAL_STEP S1: END_STEP
TRANSITION Weiter FROM S1 TO S1 := a; END_TRANSITION
ACTION A: Weiter := b; END_ACTION
END_PROGRAM
"""
    (found,) = [each for each in sfc.check(sfc.loads(text.encode(), format="iec-text")) if each.code == "VAR01"]
    assert found.message == "'Weiter' names nothing that the project declares"
    assert "Weiter" not in (found.hint or "")


def test_an_input_with_the_name_of_a_step_flag_is_no_step_flag() -> None:
    text = "GRAFCET Main\nINPUTS\n    X1\n    X2\nINITIAL STEP 1\n1 -> 2 : X1\nSTEP 2\n2 -> 1 : X2\n"
    found = {each.code for each in sfc.check(sfc.loads(text.encode(), format="grafcet-text"))}
    assert not found & {"CND02", "EVO01"}
    flags = text.replace("    X1\n    X2\n", "    a\n")
    assert {"CND02", "EVO01"} <= {each.code for each in sfc.check(sfc.loads(flags.encode(), format="grafcet-text"))}
