"""Charts of two features in which one changes what the other one does: what a sweep over random pairs has found."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.pages.page_words import german
from plcopen_sfc.report import Item, Outcome
from tests.conversion.features import Feature, FeatureChart, feature_project
from tests.conversion.matrix import judge
from tests.conversion.pairs import is_silent, named

FOUND = [
    ("action in ST + condition: expression", "plcopen", "codesys"),  # r is an action and written by another one
    ("action in ST + condition: expression", "iec-text", "simaticml"),
    ("condition: step flag + action in FBD", "codesys", "simaticml"),
    ("action in IL + excluded element", "codesys", "plcopen-2.01"),  # the variable is no action in the source
    ("qualifier P + action that calls a timer", "iec-text", "simaticml"),
    ("action that is a chart + action in place", "plcopen", "codesys"),  # what is said of one action is not of both
    ("action in FBD + exit action", "codesys", "iec-text"),  # final scans come before P0
    ("action in FBD + exit action", "codesys", "simaticml"),
    ("main action + action in FBD", "codesys", "plcopen-2.01"),
    ("ON + qualifier R", "simaticml", "plcopen-2.01"),  # steps that ON switches are active together
    ("event S1 + ON", "simaticml", "codesys"),
    ("ON + event L0", "simaticml", "codesys"),
    ("SFCInit + minimum time", "codesys", "simaticml"),  # transitions of flags wait for no minimum time
    ("SFCReset + minimum time", "codesys", "simaticml"),
    ("entry action + action that calls another one", "codesys", "plcopen-2.01"),  # an entry action comes first
    ("entry action + action that calls another one", "codesys", "iec-text"),
]


@pytest.mark.slow
@pytest.mark.parametrize(("pair", "source", "target"), FOUND)
def test_no_difference_of_two_features_is_silent(pair: str, source: str, target: str) -> None:
    cell = judge(named(pair), source, target)
    assert not is_silent(cell), cell


@pytest.mark.slow
def test_a_chart_of_s7_graph_that_runs_otherwise_is_compared() -> None:
    """Its profile has no rule for actions before transitions, as CODESYS has."""
    project = feature_project(named("event S1 + ON"), "simaticml")
    report = sfc.convert(project, "codesys", partial=True, limit=5).report
    assert report.compared["POU Main"].startswith("it does something else after")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("pair", "source"), [("INIT_SQ + global variable", "simaticml"), ("SFCReset + retain", "codesys")]
)
def test_a_transition_put_beside_another_between_the_same_steps_is_told_once(pair: str, source: str) -> None:
    """Its path has a number, and which of the two has it depends on the file."""
    report = sfc.convert(feature_project(named(pair), source), "plcopen-2.01").report
    assert report.losses == []
    assert [item.path for item in report.items if item.what == "transition"]


def two_writers(rig: FeatureChart) -> None:
    rig.action("Count", m.StBody(text="r := NOT r;"))
    rig.act("Work", "Count")
    rig.act("Done", "r")


def boolean_actions(source: str, target: str, limit: float = 0) -> list[Item]:
    project = feature_project(Feature("x", (source,), two_writers), source)
    report = sfc.convert(project, target, partial=True, limit=limit).report
    return [item for item in report.items if item.what == "Boolean actions"]


def test_a_variable_that_an_action_is_and_another_one_writes_is_told() -> None:
    (item,) = boolean_actions("plcopen", "codesys")
    assert (item.outcome, item.path) == (Outcome.APPROXIMATED, "POU Main")
    assert item.why == (
        "r: other code writes it, too; the chart does so in every scan in the source, only while its action is "
        "executed in CODESYS"
    )
    assert german(item.why).startswith("r: auch anderer Code schreibt das; die Kette tut es in der Quelle in jedem")
    assert boolean_actions("codesys", "twincat") == []


SHARED = """FUNCTION_BLOCK Main
VAR_INPUT a, b, c : BOOL; END_VAR
VAR_OUTPUT r : BOOL; END_VAR
INITIAL_STEP Idle: END_STEP
TRANSITION FROM Idle TO Work := a; END_TRANSITION
STEP Work: r(%s); END_STEP
TRANSITION FROM Work TO Done := b; END_TRANSITION
STEP Done: END_STEP
TRANSITION FROM Done TO Idle := NOT a AND NOT b; END_TRANSITION
ACTION Follow: r := c; END_ACTION
END_FUNCTION_BLOCK
"""


@pytest.mark.parametrize("qualifier", ["N", "L, T#1s", "D, T#1s"])
def test_tia_portal_writes_the_variable_of_an_action_behind_step_actions_that_do_too(qualifier: str) -> None:
    project = sfc.loads((SHARED % qualifier).encode(), format="iec-text")
    project.dialect = m.Dialect.CODESYS
    chart = project.pou("Main").sfc
    assert chart is not None
    chart.step("Idle").main_action = chart.step("Done").entry_action = "Follow"
    data, report = sfc.convert(sfc.loads(sfc.dumps(project, format="codesys")), "simaticml", limit=5)
    assert not [item for item in report.items if item.what == "Boolean actions"]
    verdict = report.compared["POU Main"]
    assert "the same but for the inputs and times that actions see, and the first scan\nbut for these: equal" in verdict
    back, report = sfc.convert(sfc.loads(data), "codesys")
    assert report.losses == []
    rows = [row for _, row in sfc.loads(back).pou("Main").sfc.associations() if row.target == "r"]
    assert [row.qualifier for row in rows] == [qualifier[0]]


@pytest.mark.parametrize(
    ("target", "told"), [("codesys", True), ("codesys23", True), ("simaticml", True), ("plcopen", False)]
)
def test_a_global_variable_that_two_charts_have_as_action_is_told(target: str, told: bool) -> None:
    text = "".join(
        f"PROGRAM {name}\nVAR_EXTERNAL lamp : BOOL; END_VAR VAR_INPUT a : BOOL; END_VAR\n"
        "INITIAL_STEP Init: END_STEP TRANSITION FROM Init TO Run := a; END_TRANSITION\n"
        "STEP Run: lamp(N); END_STEP TRANSITION FROM Run TO Init := NOT a; END_TRANSITION\nEND_PROGRAM\n"
        for name in ("One", "Two")
    )
    project = sfc.loads(text.encode(), format="iec-text")
    items = sfc.convert(project, target, partial=True).report.items
    assert any(item.what == "Boolean actions" for item in items) is told
