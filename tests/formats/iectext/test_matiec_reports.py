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


def test_a_supervision_of_s7_is_one_item() -> None:
    project = sfc.load(FIXTURES / "simaticml" / "FB_Drill.xml")
    step = next(project.charts()).network.steps[1]
    step.supervision = m.Supervised(condition=m.Expression(text="FALSE"))
    data, report = sfc.convert(project, "iec-text", flavour="matiec", partial=True)
    assert b"ChartLogic(S)" in data
    assert "matiec has no supervision" in {item.why for item in report.losses}
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


@pytest.mark.parametrize(
    ("part", "written"),
    [
        ({"work": "x := 1E3 + REAL#2e-1;"}, "x := 1.0E3 + REAL#2.0e-1;"),
        ({"work": "n := TO_INT(x) + TO_INT(3.5) + TO_INT(n);"}, "n := REAL_TO_INT(x) + REAL_TO_INT(3.5) + (n);"),
        ({"condition": "TO_REAL(n) > 1E3"}, "INT_TO_REAL(n) > 1.0E3"),
        ({"declared": "VAR PERSISTENT kept : INT; END_VAR"}, "VAR RETAIN"),
        ({"declared": "VAR short : STRING[10]; END_VAR", "condition": "LEN(short) > 3"}, "short : STRING;"),
    ],
)
def test_what_matiec_spells_otherwise_is_written_so(part: dict[str, str], written: str, tmp_path: Path) -> None:
    text, report = _plant(**part)
    assert written in text
    assert not [item for item in report.losses if item.outcome is Outcome.NOT_EXECUTED]
    require_matiec().translate(text, tmp_path)


@pytest.mark.parametrize(
    ("part", "what", "path"),
    [
        ({"condition": "n.3"}, "bit access", "POU Plant / transition S1 -> S2"),
        ({"work": "n.2 := go;"}, "bit access", "POU Plant / action ChartLogic"),
        ({"declared": "VAR long : LTIME; END_VAR"}, "type", "POU Plant / variable long"),
        ({"declared": 'VAR wide : WSTRING := "a"; END_VAR'}, "type", "POU Plant / variable wide"),
        ({"declared": "VAR a : ARRAY[0..1] OF ARRAY[0..2] OF INT; END_VAR"}, "type", "POU Plant / variable a"),
        ({"declared": "VAR_STAT all : INT; END_VAR"}, "section", "POU Plant"),
        ({"work": "n := TO_INT(x + 1.0);"}, "function", "POU Plant / action ChartLogic"),
    ],
)
def test_what_matiec_does_not_take_is_in_the_report(part: dict[str, str], what: str, path: str, tmp_path: Path) -> None:
    text, report = _plant(**part)
    lost = [item for item in report.losses if item.outcome is Outcome.NOT_EXECUTED]
    assert [(item.what, item.path.replace("Work", "ChartLogic")) for item in lost] == [(what, path)]
    with pytest.raises(MatiecError):
        require_matiec().translate(text, tmp_path)
