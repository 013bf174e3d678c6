"""Reports on texts for matiec: nothing that the writer made itself is called a mistake of this package."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.report import ConversionReport
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
