"""An edit of an export of CoDeSys 2.3 changes the lines of what was edited, and no others."""

from __future__ import annotations

import difflib
from collections.abc import Callable
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.sfc import SfcNetwork
from tests.corpus import ROOT, corpus_files, require_corpus
from tests.formats.codesys23.test_reading import BELT


def belt(project: m.Project) -> SfcNetwork:
    chart = project.pou("Ablauf").chart
    assert chart is not None
    return chart


def differences(path: Path, project: m.Project) -> list[str]:
    """Save `project`, see that it comes back, and return the lines that differ from the file."""
    old, data = path.read_bytes(), sfc.dumps(project)
    assert sfc.loads(data).pous == sfc.loads(sfc.dumps(sfc.loads(data), format="json")).pous
    lines = [each.decode("cp1252").splitlines(keepends=True) for each in (old, data)]
    matcher = difflib.SequenceMatcher(None, *lines, autojunk=False)
    found: list[str] = []
    for operation, low, high, new_low, new_high in matcher.get_opcodes():
        if operation != "equal":
            found += [f"-{line.strip()}" for line in lines[0][low:high]]
            found += [f"+{line.strip()}" for line in lines[1][new_low:new_high]]
    return found


def rename_step(project: m.Project) -> None:
    belt(project).rename_step("Warten", "Verweilen")


def set_time(project: m.Project) -> None:
    belt(project).step("Zurueck").max_time = "t#30s"


def comment_step(project: m.Project) -> None:
    belt(project).step("Zurueck").comment = "zum Anfang"


def set_condition(project: m.Project) -> None:
    belt(project).transition("Zurueck -> Pruefen").condition = "Platz1 AND NOT Platz3"


def change_step_action(project: m.Project) -> None:
    body = belt(project).step("Zu_Platz3").main_action
    assert isinstance(body, StBody)
    body.text += "\nH2_Halt := FALSE;"


def empty_step(project: m.Project) -> None:
    belt(project).step("Zu_Platz3").main_action = None


def change_action(project: m.Project) -> None:
    project.pou("Ablauf").action("Zaehlen").body = StBody(text="Gependelt := Gependelt + 2;")


def add_step(project: m.Project) -> None:
    chart = belt(project)
    chart.add_step("Quittieren")
    chart.add_transition("Abtransport", "Quittieren", condition="S3_Halt")
    chart.add_transition("Quittieren", "Bereit", condition="S1_Start")


def insert_step(project: m.Project) -> None:
    project.edit().insert_step("Zwischen", belt(project).transition("Warten -> Zurueck"), "TRUE")


def insert_step_before(project: m.Project) -> None:
    link = belt(project).transition("Pruefen -> Abtransport")
    project.edit().insert_step("Zwischen", link, "S3_Halt", before=True)


def remove_transition(project: m.Project) -> None:
    chart = belt(project)
    chart.transitions.remove(chart.transition("Pendel_Zaehlen -> Pruefen"))


def comment_variable(project: m.Project) -> None:
    project.pou("Ablauf").variables()[4].comment = "Runden"


def rename_global(project: m.Project) -> None:
    project.rename("Globale_Variablen.S3_Halt", "S3_Stop")


@pytest.mark.parametrize(
    ("edit", "expected"),
    [
        (
            rename_step,
            [
                "-TRANSITION FROM Zu_Platz3 TO Warten:=",
                "+TRANSITION FROM Zu_Platz3 TO Verweilen:=",
                "-STEP Warten:",
                "-LD Warten",
                "+STEP Verweilen:",
                "+LD Verweilen",
                "-CAL Wartezeit(IN := Warten, PT := t#3s)",
                "+CAL Wartezeit(IN := Verweilen, PT := t#3s)",
                "-TRANSITION FROM Warten TO Zurueck:=",
                "+TRANSITION FROM Verweilen TO Zurueck:=",
            ],
        ),
        (set_time, ["-(* @SFCMAXTIME := 't#20s' *)", "+(* @SFCMAXTIME := 't#30s' *)"]),
        (comment_step, ["-(* @SFCCOMMENT := '' *)", "+(* @SFCCOMMENT := 'zum Anfang' *)"]),
        (set_condition, ["-Platz1", "+Platz1 AND NOT Platz3"]),
        (change_step_action, ["+H2_Halt := FALSE;"]),
        (empty_step, ["-H1_Bereit := FALSE;", "-Band_Rechts := TRUE;"]),
        (change_action, ["-Gependelt := Gependelt + 1;", "+Gependelt := Gependelt + 2;"]),
        (
            add_step,
            [
                "+TRANSITION FROM Abtransport TO Quittieren:=",
                "+S3_Halt",
                "+END_TRANSITION",
                "+STEP Quittieren:",
                "+END_STEP",
                "+(* @SFCMAXTIME := '' *)",
                "+(* @SFCMINTIME := '' *)",
                "+(* @SFCCOMMENT := '' *)",
                "+TRANSITION FROM Quittieren TO Bereit:=",
                "+S1_Start",
                "+END_TRANSITION",
            ],
        ),
        (
            insert_step,
            [
                "-TRANSITION FROM Warten TO Zurueck:=",
                "+TRANSITION FROM Warten TO Zwischen:=",
                "+END_TRANSITION",
                "+STEP Zwischen:",
                "+END_STEP",
                "+(* @SFCMAXTIME := '' *)",
                "+(* @SFCMINTIME := '' *)",
                "+(* @SFCCOMMENT := '' *)",
                "+TRANSITION FROM Zwischen TO Zurueck:=",
                "+TRUE",
            ],
        ),
        (
            insert_step_before,
            [
                "+STEP Zwischen:",
                "+END_STEP",
                "+(* @SFCMAXTIME := '' *)",
                "+(* @SFCMINTIME := '' *)",
                "+(* @SFCCOMMENT := '' *)",
                "-TRANSITION FROM Pruefen TO Abtransport:=",
                "+TRANSITION FROM Pruefen TO Zwischen:=",
                "+S3_Halt",
                "+",
                "+END_TRANSITION",
                "+TRANSITION FROM Zwischen TO Abtransport:=",
                "-",
            ],
        ),
        (remove_transition, ["-TRANSITION FROM Pendel_Zaehlen TO Pruefen:=", "-TRUE", "-", "-END_TRANSITION"]),
        (comment_variable, ["-Gependelt:INT;", "+Gependelt:INT; (* Runden *)"]),
        (
            rename_global,
            [
                "-Ablauf(SFCInit := S0_Not, SFCReset := S2_Zurueck, SFCPause := S3_Halt);",
                "+Ablauf(SFCInit := S0_Not, SFCReset := S2_Zurueck, SFCPause := S3_Stop);",
                "-S3_Halt AT %IX0.3:BOOL;",
                "+S3_Stop AT %IX0.3:BOOL;",
            ],
        ),
    ],
)
def test_an_edit_changes_its_lines(edit: Callable[[m.Project], None], expected: list[str]) -> None:
    project = sfc.load(BELT)
    edit(project)
    assert differences(BELT, project) == expected


PRAGMAS = (
    "(* @NESTEDCOMMENTS := 'Yes' *)\n(* @PATH := '' *)\n(* @OBJECTFLAGS := '0, 8' *)\n(* @SYMFILEFLAGS := '2048' *)\n"
)
VARIABLE = "\tx:INT;\t(* old *)\nEND_VAR\n"
OBJECTS = (
    f"VAR_GLOBAL\n{VARIABLE}VAR_GLOBAL CONSTANT\n\tc : INT := 1;\nEND_VAR\n",
    f"TYPE T :(A,B);\nEND_TYPE\nPROGRAM P\nVAR\n{VARIABLE}x := 1;\nEND_PROGRAM\n",
    f"FUNCTION F : INT\nVAR_INPUT\n{VARIABLE}(* @END_DECLARATION := '0' *)\nF := a;\nEND_FUNCTION\n",
    f"(* all *)\nPROGRAM P\nVAR RETAIN\n{VARIABLE}END_PROGRAM\nACTION A:\nEND_ACTION\n_VISU\n_A: 'x\n",
)


@pytest.mark.parametrize("header", ["", PRAGMAS], ids=["bare", "with pragmas"])
@pytest.mark.parametrize("text", OBJECTS)
def test_objects_in_other_forms_are_edited_in_place(text: str, header: str) -> None:
    project = sfc.loads((header + text).encode(), format="codesys23")
    assert sfc.dumps(project).decode() == header + text
    variables = [*(v for each in project.global_variables for v in each.variables)]
    variables += [v for pou in project.pous for v in pou.variables()]
    for variable in variables:
        if variable.comment == "old":
            variable.comment = "new"
    assert sfc.dumps(project).decode() == (header + text).replace("old", "new")


def test_characters_without_a_place_in_the_code_page_are_refused() -> None:
    project = sfc.load(BELT)
    belt(project).step("Zurueck").comment = "→ Platz 1"
    with pytest.raises(sfc.FormatError, match="'→' is not in the code page cp1252"):
        sfc.dumps(project)


@pytest.mark.corpus
def test_edits_of_real_files() -> None:
    require_corpus()
    path = next(path for path in corpus_files("codesys23") if path.name == "CALLBACK_MAIN_TASK.EXP")
    project = sfc.load(path)
    chart = project.pous[0].chart
    assert chart is not None
    chart.rename_step("_StartAppl", "_Started")
    chart.step("_Start").max_time = "t#1m"
    found = differences(path, project)
    assert len(found) == 8
    assert "+TRANSITION FROM _Start TO _Started:=" in found
    assert "+(* @SFCMAXTIME := 't#1m' *)" in found


@pytest.mark.parametrize("comment", ["it's", "''", "a (* b", "a *) b"])
def test_comments_of_steps_stay_as_they_are_beside_an_edit(comment: str) -> None:
    data = BELT.read_bytes().replace(b"@SFCCOMMENT := ''", f"@SFCCOMMENT := '{comment}'".encode(), 1)
    assert data != BELT.read_bytes()
    project = sfc.loads(data)
    set_condition(project)
    edited = sfc.dumps(project)
    assert set(edited.splitlines()) - set(data.splitlines()) == {b"Platz1 AND NOT Platz3"}
    assert f"'{comment}'".encode() in edited
    assert b"{plcopen_sfc" not in edited


CONVERTED = [
    ("iectext/mixing_plant.st", 16),
    pytest.param("plcopen/filling_station_2.01.xml", 10, marks=pytest.mark.slow),
    pytest.param("simaticml/FB_Drill.xml", 42, marks=pytest.mark.slow),
]


@pytest.mark.parametrize(("name", "most"), CONVERTED)
def test_an_edit_keeps_a_chart_of_another_tool_in_terms_of_codesys_2_3(name: str, most: int) -> None:
    """The chart was written in terms of its source: conditions were undeclared names, actions were gone."""
    data = sfc.dumps(sfc.load(ROOT / "fixtures" / name), format="codesys23", partial=True)
    project = sfc.loads(data)
    chart = next(project.charts()).chart
    chart.rename_step(chart.steps[1].name, "Zz_neu")
    old, new = (each.decode("cp1252").splitlines() for each in (data, sfc.dumps(project, partial=True)))
    changed = [line for line in difflib.ndiff(old, new) if line[0] in "-+"]
    assert 2 <= len(changed) <= most
    assert [line for line in new if "NOT_EXECUTED" in line] == [line for line in old if "NOT_EXECUTED" in line]
    again = next(sfc.loads("\r\n".join(["", *new[1:], ""]).encode("cp1252")).charts()).chart
    assert [step.name for step in again.steps] == [step.name for step in chart.steps]


def test_another_target_changes_the_line_of_its_transition() -> None:
    """The writer puts transitions before the step that they lead to, and its place in the text is another one then."""
    steps = len(belt(sfc.load(BELT)).steps)
    for number, _ in enumerate(belt(sfc.load(BELT)).transitions):
        for target in range(steps):
            project = sfc.load(BELT)
            chart = belt(project)
            transition = chart.transitions[number]
            new = chart.steps[target].id
            if transition.targets == [new]:
                continue
            transition.targets = [new]
            removed, added = sorted(differences(BELT, project), reverse=True)
            assert removed.startswith("-TRANSITION FROM")
            assert added == f"+{removed[1:].partition(' TO ')[0]} TO {chart.steps[target].name}:="


def test_an_excluded_step_changes_what_it_executes_and_nothing_else() -> None:
    project = sfc.load(BELT)
    belt(project).step("Zurueck").exclude = True
    found = [line for line in differences(BELT, project) if "{plcopen_sfc " not in line and len(line) > 1]
    assert found == ["-Wartezeit(IN := FALSE);", "-Band_Links := TRUE;", "-Platz1", "+FALSE"]


def test_pragmas_before_a_body_and_lists_that_cannot_be_read_survive_an_edit() -> None:
    """An edit dropped both, and nothing told that."""
    text = "PROGRAM Main\nVAR\n\ta,b : BOOL; (* x *)\nEND_VAR\n(* @END_DECLARATION := '0' *)\n(* @OTHER := '1' *)\n"
    text += "INITIAL_STEP A:\nEND_STEP\n(* @SFCMAXTIME := 't#1s' *)\n\nEND_PROGRAM\n\n"
    text += "(* @NESTEDCOMMENTS := 'Yes' *)\n(* @GLOBAL_VARIABLE_LIST := 'G' *)\nVAR_GLOBAL\n\tg : (*BOOL;\nEND_VAR\n"
    project = sfc.loads(text.encode(), format="codesys23")
    project.pou("Main").chart.steps[0].max_time = "t#2s"
    assert sfc.dumps(project, partial=True).decode() == text.replace("t#1s", "t#2s")


def test_an_edit_keeps_the_comment_that_names_the_code_page() -> None:
    """It was taken out by any edit, and the code page was a guess when the file was read again."""
    declared = "(* @PATH := '' *)\nPROGRAM Main\nVAR\n\ta : BOOL;\nEND_VAR\n"
    text = f"{declared}(* @END_DECLARATION := '0' *)\na := TRUE;\nEND_PROGRAM\n"
    project = sfc.loads(text.encode(), format="codesys23")
    project.pous[0].variables()[0].comment = "Łódź"
    written = sfc.dumps(project, format="codesys23-cp1250")
    assert b"code_page := 'cp1250'" in written
    again = sfc.loads(written)
    assert again.diagnostics == ()
    again.pous[0].variables()[0].name = "b"
    edited = sfc.dumps(again)
    assert b"code_page := 'cp1250'" in edited
    back = sfc.loads(edited)
    assert back.diagnostics == ()
    assert back.pous[0].variables()[0].comment == "Łódź"


def test_a_file_that_was_cut_off_or_damaged_can_be_edited() -> None:
    """The first was refused as not executed, and the second got comments about steps that nobody had edited."""
    data = BELT.read_bytes()
    place = data.index(b"(* @SFCCOMMENT := ", data.index(b"STEP Warten:"))
    damaged = data.replace(
        b"Platz3\r\n\r\nEND_TRANSITION\r\nSTEP Pendel_Zurueck", b"Platz3\r\n\r\nEND_<TRANSITION\r\nSTEP Pendel_Zurueck"
    )
    assert damaged != data
    for text in (data[: place + 18], damaged):
        project = sfc.loads(text, format="codesys23")
        assert any(each.code in {"EXP101", "EXP102"} for each in project.diagnostics)
        project.pou("Ablauf").chart.rename_step("Zu_Platz3", "Hin")
        assert sfc.dumps(project) == text.replace(b"STEP Zu_Platz3", b"STEP Hin").replace(
            b"TO Zu_Platz3", b"TO Hin"
        ).replace(b"FROM Zu_Platz3", b"FROM Hin")
