"""Runs of steps are moved into the chart of an action or a function block, and back: the machine does the same."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import hypothesis.strategies as st
import pytest
from hypothesis import HealthCheck, assume, given, settings

import plcopen_sfc as sfc
from plcopen_sfc import jump, selection, simultaneous, step
from plcopen_sfc.errors import ModelError
from plcopen_sfc.languages.binding import Names
from plcopen_sfc.refactor.editor import Editor
from tests.refactor.test_edited_files import random_project
from tests.samples import FIXTURES
from tests.sweeps import examples

RUN = ["Main.Fill", "Main.Mix"]


def plant(dialect: str = "codesys", fill: str = "N Valve", mix: str = "N Motor") -> sfc.Project:
    project = sfc.Project(name="Plant", dialect=sfc.Dialect(dialect))
    pou = project.add_program(
        "Main",
        *(step("Wait", initial=True), "Start"),
        *(step("Fill", actions=[fill, ("N Count", "n := (n + 1) MOD 3;")]), "Full"),
        step("Mix", actions=[mix]),
        selection(["n = 2", step("Drain", actions=["N Outlet"]), "NOT Full"], ["Stop", step("Alarm"), "NOT Stop"]),
        jump("Wait"),
    )
    pou.add_variable("n", "INT")
    return project


def to_action(edit: Editor) -> sfc.Step:
    return edit.move_to_action(RUN, "Prepare", "ACT_Prepare")


def to_block(edit: Editor) -> sfc.Step:
    return edit.move_to_block(RUN, "Prepare", "FB_Prepare")


MOVES: dict[str, Callable[[Editor], sfc.Step]] = {"action": to_action, "block": to_block}


def outlined(project: sfc.Project) -> dict[str, list[str]]:
    """The transitions of each chart, with their conditions."""
    return {
        name: [f"{chart.label(each)}: {each.shown_condition}" for each in chart.transitions]
        for name, _, chart in project.charts()
    }


@pytest.mark.parametrize("dialect", ["codesys", "iec"])
@pytest.mark.parametrize("move", MOVES)
def test_the_machine_does_the_same_in_the_same_scans(move: str, dialect: str) -> None:
    project = plant(dialect)
    before = project.model_dump()
    edit = project.edit(prove=True, limit="60s")
    made = MOVES[move](edit)
    assert [str(each).splitlines()[0] for each in edit.proofs if not each.verdict.proven] == []
    assert len(edit.proofs) > 0
    there = project.model_dump()
    edit.dissolve_chart(made)
    assert all(each.verdict.proven for each in edit.proofs)
    assert sorted(outlined(project)["Main"]) == sorted(outlined(plant(dialect))["Main"])
    assert [each.name for each in project.pous] == ["Main"]
    assert {each.name for each in project.pou("Main").variables()} == {
        each.name for each in plant(dialect).pou("Main").variables()
    }
    assert [each.name for each in project.pou("Main").actions] == ["Count"]
    edit.undo()
    assert project.model_dump() == there
    edit.undo()
    assert project.model_dump() == before


@pytest.mark.parametrize("move", MOVES)
@pytest.mark.parametrize("first", [["Full", "Stop"], ["Stop", "Full"]])
def test_a_run_may_be_left_at_several_steps_where_actions_come_first(move: str, first: list[str]) -> None:
    """The order of transitions that compete, inside and outside of the run, stays."""
    project = sfc.Project(dialect=sfc.Dialect.CODESYS)
    inside = {"Full": ["Full", step("Mix", actions=["N Motor"]), "Done", jump("Wait")], "Stop": ["Stop", jump("Alarm")]}
    project.add_program(
        "Main",
        *(step("Wait", initial=True), "Start", step("Fill", actions=["N Valve"])),
        selection(inside[first[0]], inside[first[1]], ["Never", step("Alarm"), "NOT Stop", jump("Wait")]),
    )
    before = outlined(project)
    edit = project.edit(prove=True, limit="60s")
    made = {"action": edit.move_to_action, "block": edit.move_to_block}[move](RUN, "Prepare", "Moved")
    assert all(each.verdict.proven for each in edit.proofs)
    assert sum("Prepare -> " in each for each in outlined(project)["Main"]) == 3
    edit.dissolve_chart(made)
    assert all(each.verdict.proven for each in edit.proofs)
    assert {name: sorted(lines) for name, lines in outlined(project).items()} == {
        name: sorted(lines) for name, lines in before.items()
    }
    other = plant("iec")
    with pytest.raises(ModelError, match="left at 2"):
        other.edit().move_to_action([*RUN, "Main.Drain"], "A", "B")


@settings(max_examples=examples(20), deadline=None, suppress_health_check=[*HealthCheck])
@given(st.data(), st.sampled_from(["iec", "codesys"]), st.sampled_from(["action", "block"]))
def test_random_runs_do_the_same_in_the_same_scans(data: st.DataObject, dialect: str, move: str) -> None:
    project = random_project(data.draw)
    project.dialect = sfc.Dialect(dialect)
    chart = project.pou("Main").chart
    assert chart is not None
    steps = data.draw(st.lists(st.sampled_from(chart.steps), min_size=1, max_size=3, unique_by=id))
    edit = project.edit()
    before = project.model_copy(deep=True)
    try:
        {"action": edit.move_to_action, "block": edit.move_to_block}[move](steps, "Moved", "Moved_into")
    except ModelError:
        assume(False)  # most random steps are no run
    (proof, *_) = sfc.diff(before, project, prove=True, limit="20s").proofs
    assert proof.equal, str(proof)


def test_the_chart_of_an_action_has_the_form_of_its_tool() -> None:
    project = plant()
    to_action(project.edit())
    assert outlined(project) == {
        "Main": [
            "Wait -> Prepare: Start",
            "Prepare -> Drain: Prepare_end._x",
            "Drain -> Wait: NOT Full",
            "Prepare -> Alarm: Prepare_end_2._x",
            "Alarm -> Wait: NOT Stop",
        ],
        "Main.ACT_Prepare": [
            "Fill -> Mix: Full",
            "Mix -> Prepare_end: n = 2",
            "Mix -> Prepare_end_2: Stop",
            "Prepare_end -> Fill: NOT Prepare.x",
            "Prepare_end_2 -> Fill: NOT Prepare.x",
        ],
    }
    other = plant("iec")
    to_action(other.edit())
    assert outlined(other)["Main"][1] == "Prepare -> Drain: Mix.X AND (n = 2)"
    assert outlined(other)["Main.ACT_Prepare"][1:] == [
        "Prepare_rest -> Fill: Prepare.X",
        "Mix -> Prepare_rest: NOT Prepare.X",
    ]


def test_the_interface_of_a_block_is_what_its_steps_read_and_write() -> None:
    project = plant()
    pou = project.pou("Main")
    pou.add_variable("Timer", "TON")
    pou.add_action("Wait_a_while", "Timer(IN := Fill.x AND Enable, PT := Delay);")
    for name, type_ in (("Enable", "BOOL"), ("Delay", "TIME")):
        pou.add_variable(name, type_)
    chart = pou.chart
    assert chart is not None
    chart.step("Fill").main_action = "Wait_a_while"
    chart.step("Drain").main_action = sfc.StBody(text="Level := Level - 1; IF Timer.Q THEN Ready := TRUE; END_IF")
    chart.step("Mix").main_action = sfc.StBody(text="Level := Level + 1; Ready := FALSE;")
    for name, type_ in (("Level", "INT"), ("Ready", "BOOL")):
        pou.add_variable(name, type_)
    to_block(project.edit())
    block = project.pou("FB_Prepare")
    assert block.interface is not None
    found = {str(each.kind): [v.name for v in each.variables] for each in block.interface.sections}
    assert found == {
        "input": ["Active", "Full", "Stop"],
        "inOut": ["Valve", "Motor", "Timer", "Level", "Ready"],
        "local": ["n", "Enable", "Delay"],
    }
    assert {each.name for each in block.actions} == {"Count", "Wait_a_while"}
    assert [each.name for each in pou.actions] == ["Prepare_run"]
    text = "Prepare_chart(Active := Prepare.x, Full := Full, Stop := Stop, Valve := Valve, Motor := Motor, "
    assert pou.actions[0].body == sfc.StBody(text=f"{text}Timer := Timer, Level := Level, Ready := Ready);")
    assert [each.use for each in Names(project).undeclared()] == []


FORMATS = {"codesys": ("codesys", "codesys-export", "codesys23", "json"), "iec": ("plcopen", "iec-text", "json")}


@pytest.mark.parametrize(("dialect", "kind"), [(dialect, kind) for dialect, kinds in FORMATS.items() for kind in kinds])
@pytest.mark.parametrize("move", MOVES)
def test_files_keep_what_was_moved_and_it_comes_back(move: str, dialect: str, kind: str) -> None:
    project = sfc.loads(sfc.dumps(plant(dialect), format=kind))
    start = sfc.dumps(project)
    edit = project.edit()
    MOVES[move](edit)
    saved = sfc.loads(sfc.dumps(project))
    assert sorted(map(sorted, outlined(saved).values())) == sorted(map(sorted, outlined(project).values()))
    assert [each.use for each in Names(saved).undeclared()] == []
    saved.edit().dissolve_chart("Main.Prepare")
    again = sfc.loads(sfc.dumps(saved))
    assert sorted(outlined(again)["Main"]) == sorted(outlined(sfc.loads(start))["Main"])
    assert [each.name for each in again.pous] == ["Main"]
    edit.undo()
    assert sfc.dumps(project) == start


@pytest.mark.parametrize("move", MOVES)
def test_a_block_gets_a_file_of_its_own_in_a_folder(move: str, tmp_path: Path) -> None:
    sfc.save(plant(), tmp_path, format="twincat")
    project = sfc.load(tmp_path)
    MOVES[move](project.edit())
    sfc.save(project, tmp_path)
    found = sfc.load(tmp_path)
    assert sorted(each.name for each in found.pous) == (["Main"] if move == "action" else ["FB_Prepare", "Main"])
    assert sorted(map(sorted, outlined(found).values())) == sorted(map(sorted, outlined(project).values()))
    found.edit().dissolve_chart("Main.Prepare")
    assert sorted(outlined(found)["Main"]) == sorted(outlined(plant())["Main"])


@pytest.mark.parametrize("move", MOVES)
@pytest.mark.parametrize(
    ("fill", "mix", "message"),
    [
        ("S Count", "N Motor", "Fill has S Count, which goes on when the step was left"),
        ("SD T#2s Valve", "N Motor", "Fill has SD T#2s Valve, which goes on"),
        ("N Outlet", "N Motor", "Drain outside has N Outlet too: both share one action control"),
    ],
)
def test_actions_that_need_the_control_of_the_chart_are_refused(move: str, fill: str, mix: str, message: str) -> None:
    project = plant(fill=fill, mix=mix)
    before = project.model_dump()
    with pytest.raises(ModelError, match=message):
        MOVES[move](project.edit())
    assert project.model_dump() == before


def with_flag(project: sfc.Project) -> None:
    project.pou("Main").add_variable("SFCReset")


def with_text(project: sfc.Project, text: str) -> None:
    chart = project.pou("Main").chart
    assert chart is not None
    chart.step("Wait").main_action = sfc.StBody(text=text)


@pytest.mark.parametrize(
    ("change", "move", "message"),
    [
        (with_flag, to_action, "has the flag SFCReset"),
        (lambda p: with_text(p, "Start := Fill.x;"), to_block, "asks for the step Fill"),
        (lambda p: with_text(p, "Count();"), to_block, "the action Main.Count would move, and .* names it"),
        (lambda p: None, lambda e: e.move_to_action(["Main.Wait"], "A", "B"), "an initial step is among them"),
        (lambda p: None, lambda e: e.move_to_action(RUN, "A", "Count"), "has this name already"),
        (lambda p: None, lambda e: e.move_to_action(RUN, "Drain", "B"), "has a step of this name already"),
        (lambda p: None, lambda e: e.move_to_block(RUN, "A", "main"), "POU Main has this name already"),
        (lambda p: None, lambda e: e.move_to_block(RUN, "A", "IF"), "is a keyword"),
        (lambda p: None, lambda e: e.dissolve_chart("Main.Drain"), "executes no action of the POU"),
        (lambda p: None, lambda e: e.move_to_block([], "A", "B"), "a run of steps has none"),
    ],
)
def test_what_would_break_is_refused_with_its_reason(
    change: Callable[[sfc.Project], object], move: Callable[[Editor], object], message: str
) -> None:
    project = plant()
    change(project)
    before = project.model_dump()
    with pytest.raises(ModelError, match=message):
        move(project.edit())
    assert project.model_dump() == before


def test_tools_that_leave_a_step_without_executing_its_action_are_refused() -> None:
    project = sfc.load(FIXTURES / "simaticml" / "FB_Drill.xml")
    chart = next(project.charts()).chart
    some = next(each for each in chart.steps if not each.initial)
    with pytest.raises(ModelError, match="executes no action once more when its step was left"):
        project.edit().move_to_action([some], "A", "B")


def test_a_chart_that_goes_on_where_it_was_stays_in_its_action() -> None:
    project = sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml")
    with pytest.raises(ModelError, match="has step actions, times or conditions of its own"):
        project.edit().dissolve_chart("PLC_PRG.Homing")
    project.edit().set("PLC_PRG.Homing", max_time=None, min_time=None)
    with pytest.raises(ModelError, match="goes on where it was"):
        project.edit().dissolve_chart("PLC_PRG.Homing")


def test_simple_steps_of_codesys_23_become_iec_steps_first() -> None:
    project = sfc.load(FIXTURES / "codesys23" / "distribution_belt.EXP")
    chart: Any = next(each.chart for each in project.charts() if not any(each.chart.associations()))
    some = next(each for each in chart.steps if not each.initial)
    with pytest.raises(ModelError, match="it needs IEC steps"):
        project.edit().move_to_action([some], "A", "B")


@pytest.mark.parametrize("move", MOVES)
def test_a_change_of_behaviour_is_told_by_the_proof(move: str) -> None:
    """A condition in the chart does not see what an action behind it has written in the same scan."""
    project = sfc.Project(dialect=sfc.Dialect.CODESYS)
    pou = project.add_program(
        "Main",
        *(step("Wait", initial=True), "Start"),
        simultaneous(
            [step("Rest"), "TRUE", step("Fill", actions=["N Valve"]), "Sensor", step("Filled")],
            [step("Look", actions=[("N Zeta", "Sensor := NOT Sensor;")])],
        ),
        *("NOT Start", jump("Wait")),
    )
    assert pou.interface is not None
    for section in pou.interface.sections:
        section.variables = [each for each in section.variables if each.name != "Sensor"]
    pou.add_variable("Sensor")
    edit = project.edit(prove=True, limit="20s")
    move_it = {"action": edit.move_to_action, "block": edit.move_to_block}[move]
    with pytest.raises(ModelError, match="different after"):
        move_it(["Main.Fill"], "Prepare", "Moved")


def beside(dialect: str) -> sfc.Project:
    project = sfc.Project(dialect=sfc.Dialect(dialect))
    pou = project.add_program(
        "Main",
        *(step("Wait", initial=True), "Start"),
        simultaneous(
            [step("Rest"), "TRUE", step("Fill", actions=[("N Gamma", "n := (n + 1) MOD 3;")]), "Full", step("Filled")],
            [step("Look", actions=[("N Mid", "n := n * 2 MOD 3;"), ("N Alpha", "m := (m + 1) MOD 2;")])],
        ),
        *("NOT Start", jump("Wait")),
    )
    pou.add_variable("n", "INT")
    pou.add_variable("m", "INT")
    return project


@pytest.mark.parametrize("move", MOVES)
@pytest.mark.parametrize(("dialect", "name"), [("codesys", "Zone"), ("codesys", "Beta"), ("iec", "Zone")])
def test_actions_that_share_variables_keep_their_order_in_a_scan(move: str, dialect: str, name: str) -> None:
    """CODESYS executes actions in the order of their names: Gamma is before Mid, Zone_run behind it."""
    project = beside(dialect)
    edit = project.edit(prove=dialect == "codesys", limit="5s")
    move_it = {
        "action": lambda: edit.move_to_action(["Main.Fill"], "Moved", name),
        "block": lambda: edit.move_to_block(["Main.Fill"], name, "Block"),
    }[move]
    if (dialect, name) == ("codesys", "Zone"):
        with pytest.raises(ModelError, match=r"Gamma and Mid would change places in a scan \(n\)"):
            move_it()
        assert project == beside(dialect)
        return
    moved = move_it()
    assert all(proof.equal for proof in edit.proofs)
    edit.dissolve_chart(moved)
    assert sfc.diff(beside(dialect), project).equal


@pytest.mark.parametrize("move", MOVES)
def test_charts_come_back_where_their_actions_keep_their_order(move: str) -> None:
    project = beside("codesys")
    edit = project.edit()
    moved = (
        edit.move_to_action(["Main.Fill"], "Moved", "Beta")
        if move == "action"
        else edit.move_to_block(["Main.Fill"], "Beta", "Block")
    )
    edit.rename("Main.Gamma" if move == "action" else "Block.Gamma", "Omega")
    with pytest.raises(ModelError, match="Omega and Mid would change places"):
        edit.dissolve_chart(moved)


@pytest.mark.parametrize("move", MOVES)
def test_a_step_that_other_texts_ask_for_stays(move: str) -> None:
    """Its name would mean nothing outside of its new chart: the text would be FALSE for ever."""
    project = plant()
    project.pou("Main").add_variable("Busy", "BOOL", "output")
    watching = sfc.ActionAssociation(id=900, target="Watch")
    project.pou("Main").actions.append(sfc.Action(name="Watch", body=sfc.StBody(text="Busy := Mix.x;")))
    project.pou("Main").chart.step("Wait").actions.append(watching)
    with project.edit() as edit, pytest.raises(ModelError, match="asks for the step Mix"):
        MOVES[move](edit)
