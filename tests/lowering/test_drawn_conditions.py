"""Conditions of actions with blocks that have a state: executed once in each scan in which their steps act."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import VerdictKind, equivalent
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import lower
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.simulation import simulate
from plcopen_sfc.semantics.subjects import resolve
from tests.lowering.charts import act, boolean, training_chain
from tests.lowering.grafcets import pou_with
from tests.lowering.test_grafcet import ONCE, SHORT
from tests.semantics.charts.rig import chain
from tests.semantics.charts.test_grafcet import action

FORMS = [("flipflop", "FBD"), ("flipflop", "LD"), ("flipflop", "ST"), ("case", "ST"), ("bits", "ST")]
Q = m.Qualifier


def rising(variable: str, edge: m.Edge = m.Edge.RISING) -> m.BodyCondition:
    """A contact for an edge: TRUE in one call only."""
    rail = m.LeftPowerRail(id=1, outputs=[m.OutputPin()])
    contact = m.Contact(id=2, variable=variable, edge=edge, input=pin(1))
    coil = m.Coil(id=3, variable="Asked", input=pin(2))
    return m.BodyCondition(name="Asked", body=m.LdBody(networks=[m.LogicNetwork(nodes=[rail, contact, coil])]))


def falling(variable: str) -> m.BodyCondition:
    """A contact for a falling edge."""
    return rising(variable, m.Edge.FALLING)


def late(variable: str) -> m.BodyCondition:
    """A TON that has no instance: each condition gets one of its own."""
    inputs = [m.BlockVariable(name="IN", input=pin(1)), m.BlockVariable(name="PT", input=pin(2))]
    outputs = [m.BlockVariable(name="Q", output=m.OutputPin())]
    nodes = [
        m.InputVariable(id=1, expression=variable, output=m.OutputPin()),
        m.InputVariable(id=2, expression="T#20ms", output=m.OutputPin()),
        m.Block(id=3, type_name="TON", parameters=m.BlockParameters(inputs=inputs, outputs=outputs)),
        m.OutputVariable(id=4, expression="Asked", input=pin(3, "Q")),
    ]
    return m.BodyCondition(name="Asked", body=m.FbdBody(networks=[m.LogicNetwork(nodes=nodes)]))


def called(variable: str) -> m.BodyCondition:
    """The call of an instance that the POU declares."""
    return m.BodyCondition(
        name="Asked", body=m.StBody(text=f"timer(IN := {variable}, PT := T#20ms); Asked := timer.Q;")
    )


CONDITIONS = {"rising": rising, "falling": falling, "late": late, "called": called}
TIMED = ("late", "called")


def pin(source: int, name: str | None = None) -> m.InputPin:
    return m.InputPin(connections=[m.Connection(source=source, pin=name)])


def project(kind: str, qualifier: m.Qualifier) -> m.Project:
    """The training chain; an action of two steps in it has conditions that remember something."""
    pou = training_chain()
    chart, interface = pou.sfc, pou.interface
    assert chart is not None
    assert interface is not None
    interface.sections[0].variables.append(boolean("a"))
    interface.sections[1].variables.append(boolean("Q9"))
    timer = m.Variable(name="timer", type=m.DerivedType(name="TON"))
    interface.sections.append(m.VariableSection(kind=m.SectionKind.LOCAL, variables=[timer]))
    duration = "T#20ms" if qualifier.needs_duration else None
    act(chart, chart.steps[1], "Q9", qualifier, duration=duration)
    act(chart, chart.steps[2], "Q9", qualifier, duration=duration)
    for step in chart.steps[1:3]:
        step.actions[-1].condition = CONDITIONS[kind]("a")
    act(chart, chart.steps[3], "Q9", Q.R)
    return m.Project(pous=[pou])


def test_blocks_are_executed_once_in_a_scan_while_their_step_is_active() -> None:
    """A pulse asks its condition for what it was and for what it is: the edge is one all the same."""
    original = project("rising", Q.P)
    rows: list[dict[str, object]] = [{"a": True}, {"B1": True}, {"B1": False}, {"a": False}, {"a": True}, {}]
    trace = simulate(original, inputs=lambda scan, _: rows[scan], scans=6, profile="iec")
    assert trace["Q9"] == [False, True, False, False, True, False]


def test_the_first_evaluation_sees_no_falling_edge() -> None:
    """IEC 61131-3: the operand changes from ON to OFF between two evaluations; F_TRIG differs there."""
    original = project("falling", Q.N)
    rows: list[dict[str, object]] = [{"a": False}, {"B1": True}, {"B1": False}, {"a": True}, {"a": False}, {}]
    trace = simulate(original, inputs=lambda scan, _: rows[scan], scans=6, profile="iec")
    assert trace["Q9"] == [False, False, False, False, True, False]
    lowered = lower(original, "case", target="scl")
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN, str(lowered.proof)


def compare(kind: str, original: m.Project, construction: str, **options: str | Profile) -> None:
    """Proven for an edge. A timer that nothing asks runs on for any time: it is tested, with all inputs at first."""
    lowered = lower(original, construction, verify=False, **options)  # type: ignore[arg-type]
    found = equivalent(
        original,
        resolve(lowered.project, "Ablauf"),
        lowered.profile,
        step_flags=lowered.step_flags,
        cap=300 if kind in TIMED else 3_000,
        runs=10,
    )
    assert not found.different, str(found)
    assert found.proven or kind in TIMED


@pytest.mark.slow
@pytest.mark.parametrize("kind", sorted(CONDITIONS))
@pytest.mark.parametrize(("construction", "language"), FORMS)
def test_code_does_what_the_chart_does(construction: str, language: str, kind: str) -> None:
    compare(kind, project(kind, Q.N), construction, language=language)


@pytest.mark.parametrize("profile", ["codesys", "matiec"])
def test_under_other_profiles(profile: str) -> None:
    compare("late", project("late", Q.N), "bits", profile=profile)
    compare("rising", project("rising", Q.S), "flipflop", profile=profile)


@pytest.mark.parametrize("qualifier", [Q.S, Q.L, Q.D, Q.P, Q.P1, Q.P0, Q.SD, Q.DS, Q.SL])
def test_every_qualifier(qualifier: m.Qualifier) -> None:
    compare("rising", project("rising", qualifier), "bits")


@pytest.mark.parametrize("negated", ["step", "association"])
def test_steps_that_are_not_active(negated: str) -> None:
    original = project("rising", Q.N)
    chart = original.pous[0].sfc
    assert chart is not None
    (chart.steps[1] if negated == "step" else chart.steps[1].actions[-1]).negated = True
    lowered = lower(original, "bits")
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN, str(lowered.proof)


@pytest.mark.slow
@pytest.mark.parametrize(("construction", "language"), FORMS)
def test_they_stay_in_the_chain_where_actions_have_a_block_of_their_own(construction: str, language: str) -> None:
    compare("late", project("late", Q.N), construction, language=language, actions="block")


@pytest.mark.slow
@pytest.mark.parametrize("target", ["plcopen-2.01", "codesys", "simaticml", "scl", "iec-text"])
@pytest.mark.parametrize("kind", ["late", "rising"])
def test_they_come_back_from_the_file(kind: str, target: str) -> None:
    original = project(kind, Q.N)
    construction, language = ("bits", "ST") if target in ("scl", "iec-text") else ("flipflop", "FBD")
    lowered = lower(original, construction, language=language, target=target, verify=False)
    again = sfc.loads(sfc.dumps(lowered.project, format=target))
    found = equivalent(original, resolve(again, "Ablauf"), "iec", cap=300, runs=5)
    assert not found.different, str(found)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "condition"),
    [("conditional", "late"), ("limited", "rising"), ("N", "late"), ("S", "rising"), ("P1", "rising")],
)
def test_grafcet(kind: str, condition: str) -> None:
    """Continuous actions ask once a scan, others also in steps that are only passed."""
    chart = chain("1", "2", "3", conditions="↑a;b;↑a")
    if kind in ("conditional", "limited"):
        fields = {"duration": "T#20ms"} if kind == "limited" else {}
        chart.step("2").actions = [action(kind, "Q", condition="a", **fields)]
    else:
        chart.step("2").actions = [m.ActionAssociation(id=90, target="Q", qualifier=Q(kind))]
    chart.step("2").actions[0].condition = CONDITIONS[condition]("b")
    pou = m.Project(pous=[pou_with(chart, "a b", "Q")])
    for profile in (ONCE, SHORT):
        for actions in ("inline", "block"):
            compare(condition, pou, "bits", profile=profile, actions=actions)


def test_a_textbook_case_has_no_place_for_them() -> None:
    with pytest.raises(LoweringError, match="no place for blocks with a state"):
        lower(project("late", Q.N), "case", style="classic")
