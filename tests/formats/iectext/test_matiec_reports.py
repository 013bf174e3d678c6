"""Reports on texts for matiec: its compiler takes what they name no loss of, and nothing is called our own mistake."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.report import ConversionReport, Outcome
from tests.judges.matiec import MatiecError, require_matiec
from tests.samples import FIXTURES


def _mistakes(report: ConversionReport) -> list[str]:
    return [f"{item.path}: {item.why}" for item in report.items if "please report" in item.why]


def test_a_supervision_of_s7_is_statements() -> None:
    project = sfc.load(FIXTURES / "simaticml" / "FB_Drill.xml")
    step = next(project.charts()).chart.steps[1]
    step.supervision = m.Supervised(condition=m.Expression(text="FALSE"))
    data, report = sfc.convert(project, "iec-text", flavour="matiec", partial=True)
    assert b"ChartLogic(S)" in data
    assert not [item for item in report.losses if "supervision" in item.what + item.why]
    assert not _mistakes(report)


def test_a_pou_without_a_name_gets_one() -> None:
    project = sfc.load(FIXTURES / "simaticml" / "FB_Drill.xml")
    project.pous[0].name = ""
    data, report = sfc.convert(project, "iec-text", flavour="matiec", partial=True)
    assert b"FUNCTION_BLOCK Unnamed\n" in data
    assert not _mistakes(report)


@pytest.mark.parametrize("flavour", ["", "matiec"])
def test_boxes_of_a_library_are_not_declared_whatever_the_name_of_their_pou(flavour: str) -> None:
    pins = m.BlockParameters(inputs=[m.BlockVariable(name="size", input=m.InputPin(expression="0"))])
    box = m.Block(id=1, type_name="GetBlockName", parameters=pins)
    body = m.FbdBody(networks=[m.LogicNetwork(nodes=[box])])
    pou = m.Pou(name="A_++b+c", kind=m.PouKind.FUNCTION_BLOCK, bodies=[body])
    project = m.Project(pous=[pou], dialect=m.Dialect.SCL)
    _, report = sfc.convert(project, "iec-text", flavour=flavour, partial=True)
    assert [item.what for item in report.losses] == ["undeclared name"]
    assert "GetBlockName" in report.losses[0].why
    assert not _mistakes(report)


_PLANT = """PROGRAM Plant
VAR n : INT; x : REAL; go : BOOL; text : STRING; END_VAR
{declared}
INITIAL_STEP S1: Work(N); END_STEP
STEP S2: END_STEP
TRANSITION FROM S1 TO S2 := {condition}; END_TRANSITION
TRANSITION FROM S2 TO S1 := go; END_TRANSITION
ACTION Work: {work} END_ACTION
END_PROGRAM
"""


def _plant(declared: str = "", work: str = "n := 1;", condition: str = "go") -> tuple[str, ConversionReport]:
    text = _PLANT.format(declared=declared, work=work, condition=condition)
    project = sfc.loads(text.encode(), format="iec-text")
    assert not project.diagnostics
    data, report = sfc.convert(project, "iec-text", flavour="matiec", partial=True)
    return data.decode(), report


@pytest.mark.slow
@pytest.mark.parametrize(
    ("part", "written"),
    [
        ({"work": "x := 1E3 + REAL#2e-1;"}, "x := 1.0E3 + REAL#2.0e-1;"),
        ({"work": "n := TO_INT(x) + TO_INT(3.5) + TO_INT(n);"}, "n := REAL_TO_INT(x) + REAL_TO_INT(3.5) + (n);"),
        ({"condition": "TO_REAL(n) > 1E3"}, "INT_TO_REAL(n) > 1.0E3"),
        ({"work": "x := REAL#3; go := BOOL#TRUE;"}, "x := REAL#3.0; go := BOOL#TRUE;"),
        ({"work": "text := 'ä$L$$L';"}, "text := '$E4$0A$$L';"),
        ({"work": "x := n; x := -2 + x * (n + 1);"}, "x := INT_TO_REAL(n); x := -2.0 + x * INT_TO_REAL(n + 1);"),
        ({"declared": "VAR d : DINT; END_VAR", "work": "d := n * 1000;"}, "d := INT_TO_DINT(n * 1000);"),
        ({"condition": "x > 0 AND x * (2 + 3) < n"}, "x > 0.0 AND x * (2.0 + 3.0) < INT_TO_REAL(n)"),
        ({"declared": "VAR y : REAL := 1; z : ARRAY[0..1] OF REAL := [1E3, 2]; END_VAR"}, "y : REAL := 1.0;"),
        ({"declared": "VAR CONSTANT most : INT := 3; END_VAR\nVAR a : ARRAY[0..most] OF INT; END_VAR"}, "[0..3]"),
        ({"work": ""}, "idle := FALSE;"),
        ({"declared": "VAR PERSISTENT kept : INT; END_VAR"}, "VAR RETAIN"),
        ({"declared": "VAR short : STRING[10]; END_VAR", "condition": "LEN(short) > 3"}, "short : STRING;"),
    ],
)
def test_what_matiec_spells_otherwise_is_written_so(part: dict[str, str], written: str, tmp_path: Path) -> None:
    text, report = _plant(**part)
    assert written in text
    assert not [item for item in report.losses if item.outcome is Outcome.NOT_EXECUTED]
    require_matiec().translate(text, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("part", "what", "path"),
    [
        ({"work": "n.2 := go;"}, "bit access", "POU Plant / action ChartLogic"),
        ({"declared": "VAR long : LTIME; END_VAR"}, "type", "POU Plant / variable long"),
        ({"declared": 'VAR wide : WSTRING := "a"; END_VAR'}, "type", "POU Plant / variable wide"),
        ({"declared": "VAR a : ARRAY[0..1] OF ARRAY[0..2] OF INT; END_VAR"}, "type", "POU Plant / variable a"),
        ({"declared": "VAR_STAT all : INT; END_VAR"}, "section", "POU Plant"),
        ({"work": "n := TO_INT(x + 1.0);"}, "function", "POU Plant / action ChartLogic"),
        ({"work": "IF go THEN RETURN; END_IF; n := 3;"}, "RETURN", "POU Plant / action ChartLogic"),
        ({"work": "n := %IW3;"}, "address", "POU Plant / action ChartLogic"),
        ({"work": "n := x;"}, "assignment", "POU Plant / action ChartLogic"),
        ({"work": "n := 2.5;"}, "assignment", "POU Plant / action ChartLogic"),
        ({"declared": "VAR w : WORD; END_VAR", "condition": "w < n"}, "operation", "POU Plant / transition S1 -> S2"),
        ({"work": "n := n AND 7;"}, "operation", "POU Plant / action ChartLogic"),
        ({"declared": "VAR p : POINTER TO INT; END_VAR"}, "type", "POU Plant / variable p"),
        ({"declared": "VAR a : ARRAY[0..n] OF INT; END_VAR"}, "type", "POU Plant / variable a"),
    ],
)
def test_what_matiec_does_not_take_is_in_the_report(part: dict[str, str], what: str, path: str, tmp_path: Path) -> None:
    text, report = _plant(**part)
    lost = [item for item in report.losses if item.outcome is Outcome.NOT_EXECUTED]
    assert [(item.what, item.path.replace("Work", "ChartLogic")) for item in lost] == [(what, path)]
    with pytest.raises(MatiecError):
        require_matiec().translate(text, tmp_path)


def test_global_variables_of_every_kind_compile(tmp_path: Path) -> None:
    text = """TYPE P : STRUCT a : REAL := 1E3; b : INT; END_STRUCT; END_TYPE
PROGRAM Plant
VAR n : INT; END_VAR
n := rows[1].b + kept + limits[2]; one.b := n;
END_PROGRAM
VAR_GLOBAL one : P := (a := 2, b := 3); rows : ARRAY[1..3] OF P; limits : ARRAY[1..2] OF INT := [4, 5]; END_VAR
VAR_GLOBAL PERSISTENT kept : INT := 3; END_VAR
"""
    data, report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "iec-text", flavour="matiec")
    assert not report.losses
    machine = require_matiec().build(data.decode(), tmp_path, program="Plant")
    assert machine.run([{}], ["n"]) == [{"n": 8}]


@pytest.mark.parametrize("declared", ["UNION a : INT; b : WORD; END_UNION", "(red := 1, green := 5)"])
def test_types_that_matiec_has_not_are_in_the_report(declared: str) -> None:
    text = f"TYPE U : {declared}; END_TYPE\nPROGRAM Plant\nVAR u : U; END_VAR\n;\nEND_PROGRAM\n"
    _, report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "iec-text", flavour="matiec", partial=True)
    assert [item.what for item in report.items if item.what in ("type", "enumeration")] in (["type"], ["enumeration"])


def test_an_instance_is_called_and_a_number_is_no_action(tmp_path: Path) -> None:
    text = _PLANT.format(declared="VAR t : TON; END_VAR", work="n := 1;", condition="t.Q")
    project = sfc.loads(text.replace("Work(N)", "t(N)").encode(), format="iec-text")
    data, report = sfc.convert(project, "iec-text", flavour="matiec")
    assert b"t();" in data
    assert {item.outcome for item in report.losses} == {Outcome.APPROXIMATED}
    require_matiec().translate(data.decode(), tmp_path)
    project = sfc.loads(text.replace("Work(N)", "n(N)").encode(), format="iec-text")
    _, report = sfc.convert(project, "iec-text", flavour="matiec", partial=True)
    assert [item.why for item in report.with_outcome(Outcome.NOT_EXECUTED)] == [
        "n is of type INT: only a Boolean variable can be an action"
    ]


def test_arrays_of_blocks_and_steps_of_instances_do_not_compile_in_matiec() -> None:
    text = """FUNCTION_BLOCK Axis
VAR_INPUT go : BOOL; END_VAR
INITIAL_STEP Wait: END_STEP
TRANSITION FROM Wait TO Fill := go; END_TRANSITION
STEP Fill: END_STEP
TRANSITION FROM Fill TO Wait := NOT go; END_TRANSITION
END_FUNCTION_BLOCK
PROGRAM Main
VAR a : Axis; many : ARRAY[1..2] OF Axis; ts : ARRAY[1..3] OF TON; q, Fill : BOOL; END_VAR
a(go := q); ts[1](IN := q, PT := T#1s); Fill := q;
q := a.Fill.x;
END_PROGRAM
"""
    project = sfc.loads(text.encode(), format="iec-text")
    project.dialect = m.Dialect.CODESYS
    _, report = sfc.convert(project, "iec-text", flavour="matiec", partial=True)
    lost = [(item.path, item.why) for item in report.with_outcome("not executed")]
    assert {path for path, why in lost if "no arrays of function blocks" in why} == {
        "POU Main / variable many",
        "POU Main / variable ts",
    }
    assert [path for path, why in lost if "`Fill` is a step of Axis" in why] == ["POU Main"]
