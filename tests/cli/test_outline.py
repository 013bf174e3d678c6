"""The outline of a chart: legs, ways back, meetings, and charts that are wrong."""

from __future__ import annotations

from textwrap import dedent

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.cli.summary import outline
from plcopen_sfc.drawing.wording import Wording
from plcopen_sfc.model import (
    ActionAssociation,
    Connection,
    Expression,
    InputPin,
    NamedCondition,
    Qualifier,
    SfcNetwork,
    Transition,
    WiredCondition,
)


def text(chart: SfcNetwork, *, unicode: bool = False) -> str:
    lines = ("".join(piece for piece, _ in line) for line in outline(chart, unicode=unicode))
    return "\n".join(line.rstrip() for line in lines)


def same(shown: str, wanted: str) -> None:
    assert dedent(shown) == dedent(wanted).strip("\n")


@pytest.fixture
def chart() -> SfcNetwork:
    """``A`` initial, ``B`` to ``F``; no transitions yet."""
    chart = SfcNetwork()
    for name in "ABCDEF":
        chart.add_step(name, initial=name == "A")
    return chart


def connect(chart: SfcNetwork, *arrows: str) -> None:
    """``AB>C`` is a transition from A and B to C whose condition is ``ab_c``."""
    for arrow in arrows:
        sources, targets = arrow.split(">")
        chart.add_transition(
            [chart.step(name) for name in sources],
            [chart.step(name) for name in targets],
            f"{sources}_{targets}".lower(),
        )


def test_a_line_and_the_way_back(chart):
    del chart.steps[2:]
    connect(chart, "A>B", "B>A")
    same(
        text(chart),
        """
        [[A]]
         |  a_b
        [B]
         |  b_a
        -> A
        """,
    )


def test_excluded_elements_and_actions_of_a_grafcet(chart):
    del chart.steps[2:]
    connect(chart, "A>B", "B>A")
    chart.steps[1].exclude = chart.transitions[1].exclude = True
    chart.steps[0].actions = [ActionAssociation(id=9, kind="delayed", duration="T#3s", target="Q", condition="x")]
    same(
        text(chart),
        """
        [[A]]  delayed T#3s Q [x]
         |  a_b
        [B] (excluded)
         |  b_a (excluded)
        -> A
        """,
    )


def test_selection(chart):
    del chart.steps[5:]
    connect(chart, "A>B", "A>C", "B>D", "C>D", "D>E")
    same(
        text(chart),
        """
        [[A]]
         +-- a_b
         |   [B]
         |    |  b_d
         |   -> D
         +-- a_c
             [C]
              |  c_d
             -> D
        [D]
         |  d_e
        [E]
        """,
    )


def test_priorities_order_the_legs(chart):
    del chart.steps[3:]
    connect(chart, "A>B", "A>C")
    chart.transitions[1].priority = 1
    assert text(chart).index("a_c") < text(chart).index("a_b")


def test_nested_selections_meet_where_all_legs_do(chart):
    connect(chart, "A>B", "A>F", "B>C", "B>D", "C>E", "D>E", "F>E", "E>A")
    lines = text(chart).splitlines()
    assert "  [E]" in lines
    assert lines[-1] == "  -> A"
    assert sum("-> E" in line for line in lines) == 3


def test_simultaneous_branch(chart):
    connect(chart, "A>BC", "B>D", "CD>E", "E>F")
    wanted = """
        [[A]]
         |  a_bc
         #== [B]
         #    |  b_d
         #   [D]
         #== [C]
         === C & D
         |  cd_e
        [E]
         |  e_f
        [F]
        """
    same(text(chart), wanted)
    assert "╠═ [B]" in text(chart, unicode=True)
    assert "╚═ [C]" in text(chart, unicode=True)


def test_a_leg_to_nowhere_and_a_transition_from_nowhere(chart):
    del chart.steps[2:]
    chart.transitions.append(Transition(id=50, sources=[0], condition="lost"))
    chart.transitions.append(Transition(id=51, targets=[1], condition=None))
    same(
        text(chart),
        """
        [[A]]
         |  lost
        -> nowhere

        (no step)
         |  (no condition)
        [B]
        """,
    )


def test_steps_that_do_not_exist(chart):
    del chart.steps[1:]
    chart.transitions.append(Transition(id=50, sources=[0, 99], targets=[98], condition="x"))
    shown = text(chart)
    assert "A & (no step)" in shown
    assert "-> (no step)" in shown


def test_an_empty_chart():
    same(text(SfcNetwork()), "(empty)")


def test_two_islands(chart):
    connect(chart, "A>B", "C>D", "D>B", "E>F", "F>E")
    shown = text(chart)
    assert [shown.count(f"[{name}]") for name in "ABCDEF"] == [1] * 6


def test_every_step_and_transition_is_told_once(fixtures):
    for file in sorted(fixtures.glob("*/*.xml")):
        try:
            project = sfc.load(file)
        except sfc.SfcError:
            continue
        for chart in project.charts():
            shown = text(chart.chart).splitlines()
            for step in chart.chart.steps:
                heads = [line for line in shown if f"[{step.name}]" in line]
                assert len(heads) == 1, (file, chart.name, step.name)
            conditions = [
                line for line in shown if line.lstrip(" |#").startswith("|") or "+-- " in line or " |  " in line
            ]
            assert len(conditions) >= len(chart.chart.transitions), (file, chart.name)


def test_deep_nesting_ends(chart):
    """Hundreds of selections inside of each other: neither a recursion error nor a missing step."""
    deep = SfcNetwork()
    steps = [deep.add_step(f"S{number}", initial=number == 0) for number in range(600)]
    for number in range(0, 597, 2):
        deep.add_transition(steps[number], steps[number + 1], f"l{number}")
        deep.add_transition(steps[number], steps[number + 2], f"r{number}")
    shown = text(deep)
    assert all(f"[{step.name}]" in shown for step in steps)


def test_words(chart):
    step = chart.step("B")
    words = Wording(chart)
    step.entry_action = "Start"
    step.actions = [
        ActionAssociation(id=90, qualifier=Qualifier.D, duration="T#2s", target="Lamp"),
        ActionAssociation(id=91, qualifier=Qualifier.NONE, target="Horn", negated=True),
    ]
    assert [str(line) for line in words.actions(step)] == ["entry Start", "D T#2s Lamp", "NOT Horn"]
    assert words.condition(None) == ""
    assert words.condition(NamedCondition(name="Ready", negated=True)) == "NOT Ready"
    transition = Transition(id=70, condition="a\n  AND b")
    assert words.condition(transition.condition) == "a AND b"
    assert transition.condition is not None
    transition.condition.negated = True
    assert words.condition(transition.condition) == "NOT (a AND b)"


def test_drawn_logic_in_words(fixtures):
    chart = sfc.load("plcopen/filling_station_2.01.xml").pou("FillingStation").sfc
    assert chart is not None
    words = Wording(chart)
    texts = {words.condition(transition.condition) for transition in chart.transitions}
    assert {"DripTimer.Q, with DripTimer(IN := Drip.X, PT := tDrip)", "LevelOk AND NOT B4_Overflow"} <= texts


def test_an_edge_and_a_negation_in_words(fixtures):
    charts = [chart.chart for chart in sfc.load("plcopen/every_element_2.01.xml").charts()]
    texts = {Wording(chart).condition(transition.condition) for chart in charts for transition in chart.transitions}
    words = Wording(charts[0])
    assert "NOT ((TRUE OR falling edge of B1_LidClosed) AND NOT B2_Empty)" in texts
    assert words.condition(WiredCondition(input=InputPin())) == "(not wired)"
    assert words.condition(WiredCondition(input=InputPin(connections=[Connection(source=999999)]))) == "(logic)"
    assert words.condition(Expression(text="(a) AND (b)", negated=True)) == "NOT ((a) AND (b))"


def test_interlocks_and_supervisions_are_told(fixtures):
    """Outlines had an action with C as if it did not depend on the interlock, and told of no supervision."""
    chart = sfc.load("simaticml/FB_Drill.xml").pou("FB_Drill").sfc
    assert chart is not None
    found = ("".join(piece for piece, _ in line) for line in outline(chart, dialect=sfc.Dialect.SCL))
    lines = [line.strip() for line in found]
    assert "[Clamp part]  C S #Clamp, interlock #GuardClosed" in lines
    (drill,) = (line for line in lines if "[Drill]" in line)
    assert "C N #Spindle" in drill
    assert drill.endswith("supervision #Pressure < #MIN_PRESSURE")
