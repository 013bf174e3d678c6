"""Sequences of S7-GRAPH that charts of other tools cannot hold: ON, OFF, several of them, ends of branches."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import equivalent
from plcopen_sfc import model as m
from plcopen_sfc.model.compare import differences
from plcopen_sfc.pages.page_words import german
from plcopen_sfc.report import Outcome
from tests.conversion.features import Feature, FeatureChart, feature_project, variable
from tests.conversion.matrix import same_behaviour
from tests.conversion.test_sequencers_in_charts import as_file
from tests.sweeps import in_turn

TARGETS = ("codesys", "plcopen-2.01", "twincat", "codesys23")


def _switch(rig: FeatureChart, step: str, qualifier: str, target: str, event: str = "S1") -> None:
    rig.act(step, None, qualifier, event=event).target = target


def _two_sequences(rig: FeatureChart) -> None:
    chart = rig.chart
    rest, turn = chart.add_step("Rest", initial=True), chart.add_step("Turn")
    chart.add_transition(rest, turn, "#g")
    chart.add_transition(turn, rest, "#c")
    rig.act("Turn", "r")
    ids = {step.name: step.id for step in chart.steps}
    names = (("Idle", "Work", "Done"), ("Rest", "Turn"))
    chart.sequences = [m.Sequence(steps=[ids[name] for name in each]) for each in names]


def _on(rig: FeatureChart) -> None:
    rig.chart.add_step("Side")
    rig.go("Side", "Idle", "c")
    _switch(rig, "Work", "ON", "Side")
    rig.act("Side", "r")


def _on_and_off(rig: FeatureChart) -> None:
    _two_sequences(rig)
    _switch(rig, "Work", "ON", "Turn")
    _switch(rig, "Done", "OFF", "Rest")


def _all_off(rig: FeatureChart) -> None:
    _switch(rig, "Done", "OFF", "S_ALL", event="S0")
    _switch(rig, "Work", "OFF", "Done")


def _branches(rig: FeatureChart) -> None:
    """Two simultaneous branches, one of them of two steps, with an alternative end."""
    chart = rig.chart
    side, late = chart.add_step("Side"), chart.add_step("Late")
    chart.transitions[0].targets.append(side.id)
    chart.transitions[1].sources.append(late.id)
    chart.add_transition(side, late, "#c")
    rig.act("Late", "r", "S")
    rig.act("Done", "r", "R")


CASES: dict[str, tuple[Callable[[FeatureChart], None], tuple[str, ...]]] = {
    "ON": (_on, ()),
    "ON and OFF in another sequence": (_on_and_off, ()),
    "OFF of all steps": (_all_off, ()),
    "two initial steps": (lambda rig: setattr(rig.chart.step("Done"), "initial", True), ()),
    "plain": (lambda rig: None, ()),
    "two sequences": (_two_sequences, ()),
    "two sequences that end": (_two_sequences, ("INIT_SQ", "OFF_SQ")),
    "branches that end": (_branches, ("INIT_SQ", "OFF_SQ")),
    "branches that begin again": (_branches, ("INIT_SQ",)),
}


def built(name: str, inputs: tuple[str, ...] = (), outputs: tuple[str, ...] = ()) -> m.Project:
    build, own = CASES[name]

    def whole(rig: FeatureChart) -> None:
        rig.chart.graph_settings = m.GraphSettings(acknowledge_errors_required=False)
        for kind, names in ((m.SectionKind.INPUT, (*own, *inputs)), (m.SectionKind.OUTPUT, outputs)):
            rig.declare(kind, *(variable(each, "INT" if each in ("S_SEL", "S_NO") else "BOOL") for each in names))
        for number, step in enumerate(rig.chart.steps, 1):
            step.number = number
        rig.act("Work", "q")
        build(rig)

    return as_file(feature_project(Feature(name, ("simaticml",), whole), "simaticml"))


@pytest.mark.slow
@pytest.mark.parametrize(("number", "name"), [*enumerate(CASES)])
def test_the_target_does_the_same_and_the_source_comes_back(number: int, name: str) -> None:
    """Two targets for each case, all with PLCOPEN_SFC_FULL."""
    source = built(name)
    for target in {*in_turn(TARGETS[:2], number), *in_turn(TARGETS, number)}:
        data = sfc.dumps(source, format=target, strict=True, limit=8)
        verdict = same_behaviour(source, sfc.loads(data, format=target, as_tool=True), operated=CASES[name][1])
        assert verdict is not None
        assert verdict.proven, (target, verdict)
        if target in TARGETS[:2]:
            assert list(differences(source, as_file(sfc.loads(data, format=target)))) == []


MODES = {
    "inching": ("SW_AUTO", "SW_TAP", "T_PUSH"),
    "automatic or step by step": ("SW_AUTO", "SW_TOP", "T_PUSH"),
    # without SW_AUTO no transition fires any more, and that two steps are active while one could is not disproven
    "manual": ("SW_AUTO", "SW_MAN", "S_ON", "S_OFF", "S_SEL"),
}


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS[:2])
@pytest.mark.parametrize("inputs", MODES.values(), ids=MODES.keys())
def test_operating_modes_are_executed(inputs: tuple[str, ...], target: str) -> None:
    source = built("plain", inputs, ("S_NO", "MAN_ON", "AUTO_ON", "TAP_ON"))
    data = sfc.dumps(source, format=target, strict=True)
    result = sfc.loads(data, format=target, as_tool=True)
    same = same_behaviour(source, result, operated=inputs, outputs=("S_NO", "MAN_ON", "AUTO_ON", "TAP_ON"))
    assert same is not None
    assert same.equal or same.kind.value == "untested", same
    assert same.proven or "S_SEL" in inputs, same
    assert list(differences(source, as_file(sfc.loads(data, format=target)))) == []
    assert sfc.dumps(sfc.loads(data, format=target), format=target) == data


def test_outputs_that_the_tool_of_the_source_writes_are_compared() -> None:
    """`S_NO` is code of the target: it was left out of comparisons, as no other tool than TIA Portal knows the name."""
    source = built("plain", ("INIT_SQ",), ("S_NO", "S_ACTIVE"))
    result = sfc.loads(sfc.dumps(source, format="codesys", strict=True), format="codesys", as_tool=True)
    main = result.pou("Main")
    compared = partial(equivalent, source.pou("Main"), main, ("s7graph", "codesys"), delay="auto", cap=2000)
    same = compared(inputs={"INIT_SQ": "INIT_SQ"})
    assert same.proven, same
    assert {"S_NO", "S_ACTIVE"} <= {*same.compared}
    wrong = next(action.body for action in main.actions if "S_NO := 2" in action.body.text)
    wrong.text = wrong.text.replace("S_NO := 2", "S_NO := 3")
    assert compared(inputs={"INIT_SQ": "INIT_SQ"}).different


@pytest.mark.slow
def test_a_manual_mode_with_a_shown_step_is_compared_whole() -> None:
    """All numbers that S_NEXT and S_PREV lead to are shown with two steps active, which takes S_ON and S_SEL before."""
    inputs = ("SW_AUTO", "SW_MAN", "S_ON", "S_OFF", "S_SEL", "S_NEXT", "S_PREV")
    source = built("plain", inputs, ("S_NO", "S_MORE", "S_ACTIVE"))
    report = sfc.convert(source, "codesys", limit=120).report
    assert not report.untested
    assert report.compared["POU Main"].startswith("equal"), report.compared


ALL_INPUTS = ("INIT_SQ", "OFF_SQ", "SW_AUTO", "SW_MAN", "SW_TAP", "SW_TOP", "T_PUSH", "S_ON", "S_OFF", "S_SEL")


@pytest.mark.parametrize(("target", "longest"), [("codesys", 220), ("plcopen-2.01", 1200)])
def test_conditions_of_a_block_with_all_inputs_can_be_read(target: str, longest: int) -> None:
    """They had seven parentheses in a row, and 3,200 characters in TC6, where conditions read the inputs themselves."""
    source = built("plain", ALL_INPUTS)
    chart = sfc.loads(sfc.dumps(source, format=target), format=target, as_tool=True).pou("Main").chart
    texts = [each.condition.text for each in chart.transitions]
    assert max(map(len, texts)) < longest
    assert not any("((((" in text for text in texts)
    if target == "codesys":
        [text] = [each.condition.text for each in chart.transitions if each.sources == [chart.step("Work").id]]
        assert text.startswith("Work_to_Done AND NOT Idle_to_Work OR SW_MAN_is_on")


def test_what_fires_is_computed_once_behind_all_other_actions() -> None:
    """The conditions around a step had those of all transitions around it: 7,400 characters in a real chart."""
    pou = sfc.loads(sfc.dumps(built("plain", ALL_INPUTS), format="codesys"), format="codesys", as_tool=True).pou("Main")
    computing = max(pou.actions, key=lambda action: action.name.casefold())  # CODESYS executes them by their names
    lines = computing.body.text.splitlines()
    assert "Work_to_Done := Work.x AND (b OR SW_TOP_is_on AND T_PUSH_edge) AND sequence_goes_on;" in lines
    assert len(lines) == 3
    assert pou.chart.initial_steps[0].actions[-1].target == computing.name


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS[:2])
def test_an_edit_of_one_loop_counts_for_all(target: str) -> None:
    source = built("branches that end")
    data = sfc.dumps(source, format=target)
    project = sfc.loads(data, format=target)
    project.pou("Main").chart.rename_step("Done", "Ready")
    edited = sfc.dumps(project, format=target)
    assert len(sfc.loads(edited, format=target).pou("Main").chart.steps) == 5
    assert len(sfc.loads(edited, format=target, as_tool=True).pou("Main").chart.steps) > 9
    chart = sfc.loads(data, format=target, as_tool=True).pou("Main").chart
    [condition] = [each.condition.text for each in chart.transitions if each.sources == [chart.step("Late").id]]
    text = condition.encode()  # edited by a tool that keeps the extension data
    changed = data.replace(text, b"a OR " + text)
    kept = sfc.loads(changed, format=target)
    assert len(kept.pou("Main").chart.steps) == len(chart.steps)
    again = sfc.loads(sfc.dumps(kept, format=target, fresh=True), format=target, as_tool=True)
    same = same_behaviour(sfc.loads(changed, format=target, as_tool=True), again, operated=("INIT_SQ", "OFF_SQ"))
    assert same is not None
    assert same.proven, same


CROSSED = """PROGRAM Main
VAR_INPUT a, b, c, d : BOOL; END_VAR
VAR q, r : BOOL; END_VAR
INITIAL_STEP Init: END_STEP
TRANSITION FROM Init TO (Left, Right) := a; END_TRANSITION
STEP Left: q(N); END_STEP
STEP Right: r(N); END_STEP
TRANSITION FROM (Left, Right) TO {between} := b; END_TRANSITION
{more}
TRANSITION FROM {between} TO (Left, Right) := c; END_TRANSITION
TRANSITION FROM (Left, Right) TO Init := d; END_TRANSITION
END_PROGRAM
"""


@pytest.mark.slow
@pytest.mark.parametrize("target", ["codesys", "twincat", "codesys23"])
@pytest.mark.parametrize(
    ("between", "more"),
    [
        ("Pause", "STEP Pause: END_STEP"),
        ("Pause", "STEP Pause: END_STEP TRANSITION FROM Left TO Init := c; END_TRANSITION"),  # Right is entered again
        ("(Up, Down)", "STEP Up: END_STEP STEP Down: END_STEP"),
    ],
)
def test_branches_that_do_not_end_together_become_loops(between: str, more: str, target: str, tmp_path: Path) -> None:
    """They were not executed in CODESYS, which knows nested branches only (SFC130)."""
    source = sfc.loads(CROSSED.format(between=between, more=more).encode(), format="iec-text")
    report = sfc.save(source, tmp_path / "main", format=target, limit=8)
    assert report.with_outcome(Outcome.NOT_EXECUTED) == []
    assert [item.what for item in report.losses] == ["start of several sequences"]
    assert report.compared["POU Main"].startswith("equal, second 1 scan later (proof")
    if target == "codesys":
        back = sfc.load(tmp_path / "main", format=target)
        assert [step.name for step in back.pou("Main").chart.steps] == [s.name for s in source.pou("Main").chart.steps]
        assert not list(differences(back.pou("Main").chart.transitions, source.pou("Main").chart.transitions))


def test_edits_of_a_converted_file_keep_the_loops() -> None:
    """An edited name put the branches of the source into the file, which CODESYS does not execute."""
    text = CROSSED.format(between="Pause", more="STEP Pause: END_STEP")
    written, report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "codesys")
    assert [item.why for item in report.losses if item.why == german(item.why)] == []
    steps = [step.name for step in sfc.loads(written, as_tool=True).pou("Main").chart.steps]
    assert "Pause_rests" in steps
    project = sfc.loads(written)
    project.rename("Main.a", "begins")
    project.pou("Main").chart.rename_step("Pause", "Waiting")
    tool = sfc.loads(sfc.dumps(project), as_tool=True).pou("Main")
    assert [step.name for step in tool.chart.steps] == [name.replace("Pause", "Waiting") for name in steps]
    assert any("begins" in action.body.text for action in tool.actions)


def test_an_edit_of_one_chart_of_a_file_is_no_reason_for_loops_in_another() -> None:
    """Loops were written for each chart of a file with loops, and such an edit of other files was saved silently."""
    crossed = CROSSED.format(between="Pause", more="STEP Pause: END_STEP")
    own = crossed.replace("PROGRAM Main", "PROGRAM Own").replace("END_PROGRAM", "").partition("TRANSITION FROM (")[0]
    own += "TRANSITION FROM (Left, Right) TO Init := d; END_TRANSITION END_PROGRAM"
    project = sfc.loads(sfc.dumps(sfc.loads((crossed + own).encode(), format="iec-text"), format="codesys"))
    chart = project.pou("Own").chart
    chart.add_step("Pause")
    chart.add_transition(["Left", "Right"], "Pause", "b")
    chart.add_transition("Pause", ["Left", "Right"], "c")
    project.rename("Main.a", "begins")
    with pytest.raises(sfc.LossError, match="SFC130") as refused:
        sfc.dumps(project)
    assert {item.path.partition(" /")[0] for item in refused.value.report.losses} == {"POU Own"}
    tool = sfc.loads(sfc.dumps(project, partial=True), as_tool=True)
    assert ["Pause_rests" in {step.name for step in tool.pou(pou).chart.steps} for pou in ("Main", "Own")] == [
        True,
        False,
    ]


def test_a_step_left_and_entered_at_once_is_in_no_loop() -> None:
    text = CROSSED.format(between="(Left, Right)", more="")
    report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "codesys", partial=True)[1]
    assert {item.why.partition(":")[0] for item in report.with_outcome(Outcome.NOT_EXECUTED)} == {"SFC130"}


def test_a_sequence_without_trouble_keeps_its_form() -> None:
    chart = sfc.loads(sfc.dumps(built("two sequences"), format="codesys"), as_tool=True).pou("Main").chart
    assert [step.name for step in chart.steps] == ["Start", "Idle", "Work", "Done", "Rest", "Turn"]
    assert [transition.targets for transition in chart.transitions if len(transition.targets) > 1] == [
        [chart.step("Idle").id, chart.step("Rest").id]
    ]


DAMAGED = ("7", "{}", '{"transitions": [[0]], "initial": [1]}', '{"transitions": [[0, {"id": "x"}]], "initial": [1]}')


@pytest.mark.parametrize("damage", DAMAGED)
def test_a_damaged_mark_leaves_the_loops_as_they_are(damage: str) -> None:
    data = sfc.dumps(built("branches that end"), format="plcopen-2.01").decode("utf-8")
    start = data.index("instead_of")
    at = data.index("{", start)
    changed = data[:at] + damage + data[at + _length(data[at:]) :]
    found = sfc.loads(changed.encode(), format="plcopen")
    as_tool = sfc.loads(data.encode(), format="plcopen", as_tool=True).pou("Main").chart
    assert [step.name for step in found.pou("Main").chart.steps] == [step.name for step in as_tool.steps]
    assert any("outdated" in each.message for each in found.diagnostics)


def _length(text: str) -> int:
    """The length of the object in braces at the start of a text."""
    depth = 0
    for place, each in enumerate(text):
        depth += {"{": 1, "}": -1}.get(each, 0)
        if not depth:
            return place + 1
    raise AssertionError(text)
