"""Actions that see what others do: all are decided on, then those are executed that have ended, then the others."""

from __future__ import annotations

from random import Random

import pytest

from plcopen_sfc import model as m
from plcopen_sfc.analysis import Verdict, VerdictKind, equivalent
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import Construction, lower
from plcopen_sfc.lowering.construction import construct
from plcopen_sfc.lowering.lowering_options import LoweringRules
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.semantics.profile import PROFILES
from tests.analysis.nets import chart_of
from tests.lowering.charts import act, boolean, pou_with

INT = m.ElementaryType(name=m.Elementary.INT)


def chain(text: str, bodies: dict[str, str] | None = None) -> m.Pou:
    """A chart of transitions c1, c2 .. that has actions A, B .. with these bodies, and variables n, q and r."""
    chart = chart_of(text, "S1")
    for number, transition in enumerate(chart.transitions, 1):
        transition.condition = m.Expression(text=f"c{number}")
    pou = pou_with(chart)
    assert pou.interface is not None
    pou.interface.sections[1].variables += [m.Variable(name="n", type=INT), boolean("q"), boolean("r")]
    pou.actions = [m.Action(name=name, body=m.StBody(text=body)) for name, body in (bodies or {}).items()]
    return pou


def chart(pou: m.Pou) -> m.SfcNetwork:
    assert pou.sfc is not None
    return pou.sfc


def verdict(pou: m.Pou, construction: Construction = Construction.AUTO, profile: str = "iec") -> Verdict:
    rules = LoweringRules(PROFILES[profile], construction=construction)
    made = construct(pou, chart(pou), Dialect.IEC, rules)
    return equivalent(pou, made.pou, profile, step_flags=made.step_flags, cap=3_000, runs=20)


def text_of(pou: m.Pou, profile: str = "iec") -> str:
    made = construct(pou, chart(pou), Dialect.IEC, LoweringRules(PROFILES[profile]))
    assert isinstance(made.pou.body, m.StBody)
    return made.pou.body.text


@pytest.mark.parametrize("profile", ["iec", "codesys"])
@pytest.mark.parametrize("construction", [Construction.AUTO, Construction.FLIPFLOP])
def test_what_has_ended_is_executed_before_what_is_active(construction: Construction, profile: str) -> None:
    pou = chain("S1>S2 S2>S1", {"A": "n := 1;", "B": "n := 2;"})
    act(chart(pou), chart(pou).step("S1"), "A")
    act(chart(pou), chart(pou).step("S2"), "B")
    assert verdict(pou, construction, profile).kind is VerdictKind.PROVEN


@pytest.mark.parametrize("profile", ["iec", "codesys"])
def test_all_actions_are_decided_on_before_any_is_executed(profile: str) -> None:
    pou = chain("S1>S2 S2>S1", {"A": "q := NOT q;"})
    act(chart(pou), chart(pou).step("S1"), "A")
    act(chart(pou), chart(pou).step("S1"), "r", condition="q")
    act(chart(pou), chart(pou).step("S2"), "r", m.Qualifier.S, condition="NOT q")
    assert verdict(pou, profile=profile).kind is VerdictKind.PROVEN


@pytest.mark.parametrize("profile", ["iec", "codesys"])
def test_a_variable_is_not_written_before_all_actions_are_decided_on(profile: str) -> None:
    pou = chain("S1>S2 S2>S1", {"A": "q := NOT q;"})
    act(chart(pou), chart(pou).step("S1"), "A", m.Qualifier.P1)
    act(chart(pou), chart(pou).step("S2"), "q", condition="c1")
    act(chart(pou), chart(pou).step("S2"), "r", m.Qualifier.S, condition="q")
    act(chart(pou), chart(pou).step("S1"), "r", m.Qualifier.R, condition="q")
    assert verdict(pou, profile=profile).kind is VerdictKind.PROVEN


@pytest.mark.parametrize("profile", ["iec", "codesys"])
@pytest.mark.parametrize("body", ["q := TRUE;", "q := FALSE;", "r := q;", "q := NOT q; r := q;"])
def test_variables_that_bodies_share_with_actions(body: str, profile: str) -> None:
    pou = chain("S1>S2 S2>S3 S3>S1", {"M": body})
    for step, target in (("S1", "q"), ("S2", "M"), ("S3", "M"), ("S3", "q")):
        act(chart(pou), chart(pou).step(step), target)
    assert verdict(pou, profile=profile).kind is VerdictKind.PROVEN


@pytest.mark.parametrize("profile", ["iec", "codesys"])
def test_code_in_place_is_executed_where_it_stands_in_the_chart(profile: str) -> None:
    """Where actions go by their names it has none and is the first."""
    pou = chain("S1>S2 S2>S1", {"A": "n := 2;"})
    step = chart(pou).step("S1")
    step.actions.append(
        m.ActionAssociation(id=chart(pou).new_id(), qualifier=m.Qualifier.N, body=m.StBody(text="n := n + 1;"))
    )
    act(chart(pou), step, "A")
    act(chart(pou), chart(pou).step("S2"), "q")
    assert verdict(pou, profile=profile).kind is VerdictKind.PROVEN


@pytest.mark.parametrize("profile", ["iec", "codesys"])
def test_a_pulse_while_an_action_ends_is_executed_once(profile: str) -> None:
    pou = chain("S1>S2 S2>S1", {"A": "q := NOT q;", "B": "r := q;"})
    act(chart(pou), chart(pou).step("S1"), "A")
    act(chart(pou), chart(pou).step("S2"), "A", m.Qualifier.P1)
    act(chart(pou), chart(pou).step("S1"), "B", m.Qualifier.P0)
    assert verdict(pou, profile=profile).kind is VerdictKind.PROVEN


def test_an_output_that_something_else_writes_is_left_alone_in_codesys() -> None:
    """It is written while its action is executed, and once more after that: not in every scan."""
    pou = chain("S1>S2 S2>S3 S3>S1")
    act(chart(pou), chart(pou).step("S1"), "q")
    chart(pou).step("S3").entry_action = m.StBody(text="q := TRUE;")
    assert verdict(pou, profile="codesys").kind is VerdictKind.PROVEN
    started = chain("S1>S2 S2>S1")
    assert started.interface is not None
    started.interface.sections[1].variables[1].initial = m.SimpleValue(text="TRUE")
    act(chart(started), chart(started).step("S2"), "q")
    assert verdict(started, profile="codesys").kind is VerdictKind.PROVEN
    assert verdict(started, profile="iec").kind is VerdictKind.PROVEN


def test_independent_actions_stay_one_after_the_other() -> None:
    pou = chain("S1>S2 S2>S1", {"A": "motor.on := TRUE;", "B": "motor.fast := c1; t(IN := c2, PT := T#1s);"})
    assert pou.interface is not None
    motor = m.StructType(members=[boolean("on"), boolean("fast")])
    pou.interface.sections.append(
        m.VariableSection(
            variables=[m.Variable(name="motor", type=motor), m.Variable(name="t", type=m.DerivedType(name="TON"))]
        )
    )
    act(chart(pou), chart(pou).step("S1"), "A")
    act(chart(pou), chart(pou).step("S2"), "B")
    act(chart(pou), chart(pou).step("S2"), "q")
    assert "Actions that have ended" not in text_of(pou)
    pou.actions[1].body = m.StBody(text="motor.on := c1;")
    assert "Actions that have ended" in text_of(pou)


@pytest.mark.slow
@pytest.mark.parametrize("profile", ["iec", "codesys"])
@pytest.mark.parametrize("others", [{}, {"B": "n := 2;"}])
def test_comments_in_actions_are_kept(others: dict[str, str], profile: str) -> None:
    pou = chain("S1>S2 S2>S1", {"A": "\t(* count *)\n\tn := n + 1; // one more\n", **others})
    act(chart(pou), chart(pou).step("S1"), "A")
    for name in others:
        act(chart(pou), chart(pou).step("S2"), name)
    text = text_of(pou, profile)
    assert "(* count *) n := n + 1; // one more" in " ".join(text.split())
    assert not verdict(pou, profile=profile).different
    pou.actions[0].body = m.StBody(text="// nothing yet")
    assert not verdict(pou, profile=profile).different
    pou.actions[0].body = m.StBody(text="// of the step\nq := S1.X;")
    assert verdict(pou, profile=profile).kind is VerdictKind.PROVEN
    assert "S1.X" not in text_of(pou, profile)


@pytest.mark.parametrize("body", ["IF q THEN RETURN; END_IF; n := 1;", "IF q THEN n := 2; RETURN; END_IF;"])
def test_what_leaves_an_action_is_refused(body: str) -> None:
    """Among the code of others it would leave that too."""
    pou = chain("S1>S2 S2>S1", {"A": body})
    act(chart(pou), chart(pou).step("S1"), "A")
    with pytest.raises(LoweringError, match="RETURN and jumps"):
        text_of(pou)
    pou = chain("S1>S2 S2>S1")
    chart(pou).step("S2").exit_action = m.StBody(text=body)
    with pytest.raises(LoweringError, match="RETURN and jumps"):
        text_of(pou)
    pou = chain("S1>S2 S2>S1")
    condition = m.StBody(text="ready := FALSE; IF q THEN RETURN; END_IF; ready := c1;")
    chart(pou).transitions[0].condition = m.BodyCondition(body=condition, name="ready")
    with pytest.raises(LoweringError, match="RETURN and jumps"):
        text_of(pou)


BODIES = ["q := r;", "r := NOT q;", "q := TRUE;", "q := FALSE;", "n := 1;", "n := 2;", "r := n = 1;", "r := FALSE;"]


@pytest.mark.parametrize("profile", ["iec", "codesys"])
@pytest.mark.parametrize("seed", range(8))
def test_random_actions_that_disturb_each_other(seed: int, profile: str) -> None:
    random = Random(seed)  # noqa: S311
    pou = chain("S1>S2 S2>S3 S2>S1 S3>S1", {name: random.choice(BODIES) for name in "ABZ"})
    for step in chart(pou).steps:
        for _ in range(random.randint(1, 3)):
            target = random.choice(["A", "B", "Z", "q", "r"])
            qualifier = random.choice(["N", "N", "S", "R", "P", "P1", "P0"])
            condition = random.choice([None, None, "q", "NOT r", "c1"])
            act(chart(pou), step, target, m.Qualifier(qualifier), condition=condition)
    found = verdict(pou, random.choice([Construction.CASE, Construction.BITS, Construction.FLIPFLOP]), profile)
    assert found.kind is VerdictKind.PROVEN, f"{found}\n{text_of(pou, profile)}"


@pytest.mark.parametrize("profile", ["iec", "codesys"])
def test_an_action_that_does_nothing_has_no_code(profile: str) -> None:
    pou = chain("S1>S2 S2>S1")
    first, second = chart(pou).steps
    first.actions.append(m.ActionAssociation(id=90, body=m.StBody(text=""), qualifier="SD", duration="T#1s"))
    second.actions.append(m.ActionAssociation(id=91, body=m.StBody(text="// nothing yet")))
    project = m.Project(pous=[pou])
    made = lower(project, "bits", profile=profile)
    assert made.proof is not None
    assert made.proof.kind is VerdictKind.PROVEN
    assert isinstance(made.pou.body, m.StBody)
    paragraphs = made.pou.body.text.split("\n\n")
    assert [each for each in paragraphs if "Action" in each] == ["// Action S2_1\n// nothing yet"]
    assert {v.name for v in made.pou.variables()} - {v.name for v in pou.variables()} == {"X1", "X2", "T1_2", "T2_1"}
    drawn = lower(project, "flipflop", language="FBD", profile=profile, verify=False)
    assert isinstance(drawn.pou.body, m.FbdBody)
    assert not any("Action" in str(network.title) for network in drawn.pou.body.networks)
