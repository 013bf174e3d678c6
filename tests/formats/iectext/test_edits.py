"""An edit of a text changes the lines that say what was edited, and no others."""

from __future__ import annotations

import difflib
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.cli import main
from tests.corpus import CORPUS, require_corpus
from tests.samples import FIXTURES

PLANT = FIXTURES / "iectext" / "mixing_plant.st"
MATIEC = CORPUS / "iectext" / "beremiz__matiec" / "tests" / "sfc.txt"
VERIFAPS = sorted((CORPUS / "iectext").rglob("Algo1_left.sfc"))


def edited(project: m.Project, before: bytes) -> list[str]:
    """The lines of the diff that saving an edit makes; the text says what the model says."""
    after = sfc.dumps(project)
    assert sfc.loads(after) == project
    lines = difflib.unified_diff(before.decode().splitlines(), after.decode().splitlines(), lineterm="", n=0)
    return [line for line in lines if not line.startswith(("---", "+++", "@@"))]


@pytest.fixture
def plant() -> m.Project:
    return sfc.load(PLANT)


def chart_of(project: m.Project) -> m.SfcNetwork:
    return next(iter(project.charts())).chart


def test_a_step_is_renamed(plant: m.Project) -> None:
    chart_of(plant).step("Drain").name = "Empty"
    assert edited(plant, PLANT.read_bytes()) == [
        "-  TRANSITION Broken (PRIORITY := 2) FROM Fill TO Drain",
        "+  TRANSITION Broken (PRIORITY := 2) FROM Fill TO Empty",
        "-  TRANSITION FROM (Stir, Signal) TO Drain := Stir.T >= tStir; END_TRANSITION",
        "+  TRANSITION FROM (Stir, Signal) TO Empty := Stir.T >= tStir; END_TRANSITION",
        "-  STEP Drain:",
        "+  STEP Empty:",
        "-  TRANSITION FROM Drain TO Done := NOT LevelLow; END_TRANSITION",
        "+  TRANSITION FROM Empty TO Done := NOT LevelLow; END_TRANSITION",
    ]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["mixing_plant.st", "distribution_belt.st"])
def test_renaming_any_step_changes_the_lines_that_name_it(name: str) -> None:
    before = (FIXTURES / "iectext" / name).read_bytes()
    for step in chart_of(sfc.load(FIXTURES / "iectext" / name)).steps:
        project = sfc.load(FIXTURES / "iectext" / name)
        chart_of(project).rename_step(step.name, "Zz9_Neu")
        lines = edited(project, before)
        removed = [line[1:] for line in lines if line.startswith("-")]
        assert removed
        assert [line[1:].replace("Zz9_Neu", step.name) for line in lines if line.startswith("+")] == removed


def test_a_condition_is_changed(plant: m.Project) -> None:
    chart_of(plant).transition("Full").condition = m.Expression(text="LevelHigh OR S2_Stop")
    assert edited(plant, PLANT.read_bytes()) == [
        "-  TRANSITION Full (PRIORITY := 1) FROM Fill TO (Stir, Signal) := LevelHigh; END_TRANSITION",
        "+  TRANSITION Full (PRIORITY := 1) FROM Fill TO (Stir, Signal) := LevelHigh OR S2_Stop; END_TRANSITION",
    ]


def test_what_text_cannot_say_is_added_as_a_pragma(plant: m.Project) -> None:
    chart_of(plant).step("Drain").max_time = "T#1m"
    assert [line.strip("+ ") for line in edited(plant, PLANT.read_bytes())] == ["{plcopen_sfc max_time := 'T#1m'}"]


def test_a_statement_is_added(plant: m.Project) -> None:
    action = plant.pou("Mixer").action("CountBatch")
    assert action is not None
    assert isinstance(action.body, m.StBody)
    action.body.text += "\nReady := FALSE;"
    assert edited(plant, PLANT.read_bytes()) == ["+    Ready := FALSE;"]


def test_a_step_and_a_transition_are_added(plant: m.Project) -> None:
    network = chart_of(plant)
    step = network.add_step("Clean")
    network.add_transition(network.step("Done"), step, "Dirty")
    lines = edited(plant, PLANT.read_bytes())
    assert all(line.startswith("+") for line in lines)
    assert [line[1:].strip() for line in lines if line != "+"] == [
        "STEP Clean: {plcopen_sfc id := 20}",
        "END_STEP",
        "TRANSITION FROM Done TO Clean {plcopen_sfc id := 21}",
        ":= Dirty;",
        "END_TRANSITION",
    ] or len(lines) == 7


def test_a_transition_is_removed(plant: m.Project) -> None:
    network = chart_of(plant)
    network.transitions.remove(network.transition("Broken"))
    lines = edited(plant, PLANT.read_bytes())
    assert "-  TRANSITION Broken (PRIORITY := 2) FROM Fill TO Drain" in lines
    # the ids of the others stay: the number that nobody has now is not given to the next transition
    assert [line for line in lines if line.startswith("+")] == ["+{plcopen_sfc chart.unused_ids := [16]}"]


def test_a_variable_is_added(plant: m.Project) -> None:
    interface = plant.pou("Mixer").interface
    assert interface is not None
    interface.sections[0].variables.append(m.Variable.model_validate({"name": "Dirty", "type": "BOOL"}))
    assert [line.strip("+ ") for line in edited(plant, PLANT.read_bytes())] == ["Dirty : BOOL;"]


def test_line_ends_and_code_pages_stay(tmp_path: Path) -> None:
    data = PLANT.read_text(encoding="utf-8").replace("\n", "\r\n").encode("cp1252")
    project = sfc.loads(data)
    assert [d.code for d in project.diagnostics] == ["IEC200"]
    chart_of(project).step("Drain").name = "Lösen"
    after = sfc.dumps(project)
    assert after.decode("cp1252").count("\r\n") == data.count(b"\r\n") == after.count(b"\n")
    assert chart_of(sfc.loads(after)).step("Lösen").name == "Lösen"


@pytest.mark.corpus
@pytest.mark.parametrize("path", [MATIEC, *VERIFAPS], ids=lambda path: path.name)
def test_texts_of_others_keep_their_layout(path: Path) -> None:
    require_corpus()
    project = sfc.load(path)
    step = chart_of(project).steps[1]
    old, step.name = step.name, "Zz9_Neu"
    lines = edited(project, path.read_bytes())
    removed = [line[1:] for line in lines if line.startswith("-")]
    added = [line[1:] for line in lines if line.startswith("+")]
    assert removed
    assert [line.replace("Zz9_Neu", old) for line in added] == removed


def test_an_export_of_codesys_is_edited_as_text() -> None:
    """The text of an export is edited by hand; what nobody touched comes back to the export as it was."""
    source = sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml")
    text = sfc.dumps(source, format="iec-text", partial=True).decode()
    assert text.count("{plcopen_sfc max_time := 'T#10s'}") == 1
    again = sfc.loads(
        text.replace("max_time := 'T#10s'", "max_time := 'T#11s'").replace(":= xHomed;", ":= NOT xHomed;").encode()
    )
    chart = source.pou("PLC_PRG").sfc
    assert chart is not None
    chart.step("Homing").max_time = "T#11s"
    next(t for t in chart.transitions if t.condition == m.Expression(text="xHomed")).condition = m.Expression(
        text="NOT xHomed"
    )
    assert again == source


def test_the_command_line_converts_there_and_back(tmp_path: Path) -> None:
    source, text, back = FIXTURES / "codesys" / "distribution_belt.xml", tmp_path / "belt.st", tmp_path / "belt.xml"
    assert main(["convert", str(source), str(text), "--to", "iec-text", "--partial", "--limit", "0"]) == 0
    assert text.read_bytes() == (FIXTURES / "iectext" / "distribution_belt.st").read_bytes()
    assert main(["convert", str(text), str(back), "--to", "codesys", "--strict", "--limit", "0"]) == 0
    assert sfc.load(back) == sfc.load(source)


@pytest.mark.slow
def test_an_edit_loses_nothing_that_the_file_keeps_beside_already() -> None:
    belt = FIXTURES / "iectext" / "distribution_belt.st"
    project = sfc.load(belt)
    chart = project.pou("Ablauf_Band").chart
    assert chart is not None
    chart.rename_step("Warten", "Warte2")
    assert len(edited(project, belt.read_bytes())) < 20
    project = sfc.load(belt)
    project.pou("Ablauf_Band").chart.step("Zu_Platz3").min_time = "T#1s"  # that is new, and IEC 61131-3 has none
    with pytest.raises(sfc.LossError, match=r"1 item would not be executed: min time POU Ablauf_Band / step Zu_Platz3"):
        sfc.dumps(project)


@pytest.mark.slow
@pytest.mark.parametrize("target", ["codesys", "plcopen-2.01"])
def test_what_a_conversion_could_not_say_refuses_no_later_edit(target: str) -> None:
    source = sfc.load(FIXTURES / "simaticml" / "FB_Drill.xml")
    data, report = sfc.convert(source, target, partial=True)
    assert report.with_outcome(sfc.Outcome.NOT_EXECUTED)
    project = sfc.loads(data)
    project.rename("FB_Drill.Ready", "Rest")
    assert b'"Rest"' in sfc.dumps(project)


MIXED = """PROGRAM Main
VAR a, b : BOOL; END_VAR

(* the start *)
INITIAL_STEP Start:   // line
\ta(N);
END_STEP

STEP Second: (* inside *)
\tb(R);  // set
END_STEP

ACTION Act:
\ta := b;
END_ACTION

STEP Third: END_STEP

TRANSITION FROM Start TO Second := a; END_TRANSITION
TRANSITION FROM Second TO Third := b; END_TRANSITION
TRANSITION FROM Third TO Start := a AND b; END_TRANSITION
END_PROGRAM
"""


def test_a_new_step_leaves_steps_actions_and_transitions_in_their_order() -> None:
    project = sfc.loads(MIXED.encode(), format="iec-text")
    project.edit().insert_step("New", chart_of(project).transitions[0], "TRUE")
    lines = edited(project, MIXED.encode())
    assert [line for line in lines if line.startswith("-")] == ["-TRANSITION FROM Start TO Second := a; END_TRANSITION"]
    assert "+TRANSITION FROM Start TO New := a; END_TRANSITION" in lines
    assert len(lines) < 12


def test_a_name_in_other_letters_is_all_that_changes() -> None:
    project = sfc.loads(MIXED.encode(), format="iec-text")
    project.rename("Main.Second", "SECOND")
    assert edited(project, MIXED.encode()) == [
        "-STEP Second: (* inside *)",
        "+STEP SECOND: (* inside *)",
        "-TRANSITION FROM Start TO Second := a; END_TRANSITION",
        "-TRANSITION FROM Second TO Third := b; END_TRANSITION",
        "+TRANSITION FROM Start TO SECOND := a; END_TRANSITION",
        "+TRANSITION FROM SECOND TO Third := b; END_TRANSITION",
    ]


@pytest.mark.parametrize("edit", ["S3.X OR (B5)", "S3.X AND (B4)", "TRUE"])
def test_statements_in_place_of_a_condition_win_over_its_pragmas(edit: str) -> None:
    """What beside tools execute was ignored: the condition in the pragmas was taken, and nothing said so."""
    text = (FIXTURES / "training-chain" / "iec-text.st").read_text("utf-8")
    assert text.count("Q3 := S3.X AND (B5);") == 1
    project = sfc.loads(text.replace("S3.X AND (B5)", edit).encode())
    (row,) = project.pous[0].chart.step("S3").actions
    assert row.condition is None
    assert isinstance(row.body, sfc.StBody)
    assert row.body.text.strip() == f"Q3 := {edit};"
    assert "IEC213" in {each.code for each in project.diagnostics}
    (kept,) = sfc.loads(text.encode()).pous[0].chart.step("S3").actions
    assert (kept.target, kept.condition.text, kept.body) == ("Q3", "B5", None)
