"""A PLC of TIA Portal goes to another tool and comes back: what the other cannot say is kept, validly."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.formats.plcopen.tc6_versions import validate_tc6
from plcopen_sfc.model.compare import differences
from tests.samples import FIXTURES

PLC = FIXTURES / "simaticml-plc"
FORMATS = ["plcopen-2.01", "plcopen-2.0", "plcopen-1.01", "codesys"]


@pytest.fixture(scope="module")
def plc() -> m.Project:
    return sfc.load(PLC)


@pytest.mark.parametrize("form", FORMATS)
def test_what_is_written_is_valid(plc: m.Project, form: str) -> None:
    assert [
        d for d in validate_tc6(sfc.dumps(plc, format=form, partial=True), file="plc.xml") if d.severity == "error"
    ] == []


@pytest.mark.slow
def test_it_comes_back_as_it_was(plc: m.Project) -> None:
    other = sfc.loads(sfc.dumps(plc, format="plcopen-2.01", partial=True))
    back = sfc.loads(sfc.dumps(other, format="simaticml", tia="V21"))
    assert [d.path for d in differences(plc, back)] == []


@pytest.mark.slow
@pytest.mark.parametrize("form", FORMATS)
def test_the_results_of_conditions_are_their_coils_again(plc: m.Project, form: str) -> None:
    other = sfc.loads(sfc.dumps(plc, format=form, partial=True), format=form)
    data = sfc.dumps(other, format="simaticml").decode("utf-8-sig")
    assert re.findall('<Component Name="(?:Tr|Il|Sv)Coil"', data) == []
    assert data.count('<Part Name="TrCoil"') == 11
    assert data.count('<Part Name="IlCoil"') >= 2
    assert data.count('<Part Name="SvCoil"') >= 2


@pytest.mark.slow
def test_an_edited_documentation_wins_over_the_languages_it_had(plc: m.Project, tmp_path: Path) -> None:
    text = sfc.dumps(plc, format="plcopen-2.01", partial=True).decode()
    assert "Grundstellung\nHome position" in text
    edited = sfc.loads(text.replace("Grundstellung\nHome position", "Start").encode())
    kept = sfc.loads(text.encode())
    chart, other = edited.pou("FB_Drilling").sfc, kept.pou("FB_Drilling").sfc
    assert chart is not None
    assert other is not None
    assert chart.step("Home").comment == "Start"
    assert other.step("Home").comment == m.MultilingualText(texts={"de-DE": "Grundstellung", "en-US": "Home position"})


STL = """<Document><Engineering version="V20" /><SW.Blocks.FC ID="0"><AttributeList><Name>Old</Name>
<Number>1</Number><ProgrammingLanguage>STL</ProgrammingLanguage></AttributeList><ObjectList>
<SW.Blocks.CompileUnit ID="1" CompositionName="CompileUnits"><AttributeList><NetworkSource>
<StatementList xmlns="http://www.siemens.com/automation/Openness/SW/NetworkSource/StatementList/v5">
<StlStatement UId="21"><StlToken Text="NOP_0" /></StlStatement></StatementList></NetworkSource>
<ProgrammingLanguage>STL</ProgrammingLanguage></AttributeList></SW.Blocks.CompileUnit></ObjectList></SW.Blocks.FC></Document>"""


@pytest.mark.parametrize("form", FORMATS)
def test_a_body_that_nobody_else_knows_is_carried(form: str) -> None:
    project = sfc.loads(STL.encode())
    data = sfc.dumps(project, format=form, partial=True)
    assert [d for d in validate_tc6(data) if d.severity == "error"] == []
    back = sfc.loads(sfc.dumps(sfc.loads(data, format=form), format="simaticml"))
    (old,), (new,) = project.pous[0].bodies, back.pous[0].bodies
    assert isinstance(old, m.OpaqueBody)
    assert isinstance(new, m.OpaqueBody)
    assert (new.source, new.content) == (old.source, old.content)


@pytest.mark.parametrize("form", FORMATS)
def test_networks_that_count_their_elements_anew_stay_apart_on_one_sheet(form: str) -> None:
    def network(name: str) -> m.LogicNetwork:
        source = m.InputVariable(id=21, expression=name)
        wire = m.InputPin(connections=[m.Connection(source=21)])
        return m.LogicNetwork(nodes=[source, m.OutputVariable(id=22, expression=f"{name}_out", input=wire)])

    body = m.FbdBody(networks=[network("a"), network("b")])
    pou = m.Pou(name="Block", kind=m.PouKind.FUNCTION_BLOCK, bodies=[body])
    data = sfc.dumps(m.Project(pous=[pou]), format=form)
    assert [d for d in validate_tc6(data) if d.severity == "error"] == []
    ids = re.findall(r'localId="(\d+)"', data.decode("utf-8-sig"))
    assert len(ids) >= 4
    assert len(set(ids)) == len(ids)
    assert sfc.loads(data, format=form).pous[0].bodies == [body]
