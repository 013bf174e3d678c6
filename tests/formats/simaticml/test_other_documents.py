"""XML of TIA Portal that is no document with PLC objects, and blocks that cannot be looked into: a clear word each."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.cli import main
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.errors import StructureError
from plcopen_sfc.formats.simaticml.openness_schemas import validate
from plcopen_sfc.model import Elementary, ElementaryType
from tests.formats.simaticml.documents import FIXTURES

MOTOR = (FIXTURES / "FB_Motor.xml").read_bytes()
SPACE = "http://www.siemens.com/automation/Openness/SW"


@pytest.mark.parametrize(
    ("data", "words"),
    [
        ("<FlgNet><Parts /></FlgNet>", "a network in LAD or FBD"),
        (f'<FlgNet xmlns="{SPACE}/NetworkSource/FlgNet/v4"><Parts /></FlgNet>', "a network in LAD or FBD"),
        (f'<g:Graph xmlns:g="{SPACE}/NetworkSource/Graph/v5" />', "a chart of S7-GRAPH"),
        (f'<StructuredText xmlns="{SPACE}/NetworkSource/StructuredText/v3" />', "a network in SCL"),
        (f'<Sections xmlns="{SPACE}/Interface/v5" />', "the interface of a block"),
        ('<SW.Blocks.FB ID="0"><AttributeList /></SW.Blocks.FB>', "an object"),
        ('<CAEXFile FileName="plc.aml" SchemaVersion="2.15" />', "hardware"),
    ],
)
def test_a_part_of_a_document_says_what_it_is(data: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "part.xml"
    path.write_text(f'<?xml version="1.0" encoding="utf-8"?>\r\n{data}', encoding="utf-8")
    with pytest.raises(StructureError, match=words) as caught:
        sfc.load(path)
    assert caught.value.hint
    assert caught.value.location.file == str(path)
    assert [finding.code for finding in validate(path.read_bytes())] == ["XSD001"]
    assert main(["info", str(path)]) == 2


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("Hmi.Tag.TagTable", "an operator panel"),
        ("SW.TechnologicalObjects.TechnologicalInstanceDB", "a technology object"),
        ("SW.WatchAndForceTables.PlcWatchTable", "a watch or force table"),
        ("SW.Blocks.Future", "not known"),
        ("Something", "none of the objects"),
    ],
)
def test_an_object_of_another_kind_is_said_and_kept(kind: str, words: str) -> None:
    head = b'<?xml version="1.0" encoding="utf-8"?>\r\n<Document><Engineering version="V17" />'
    data = head + f'<{kind} ID="0"><AttributeList><Name>A</Name></AttributeList></{kind}></Document>'.encode()
    project = sfc.loads(data)
    (finding,) = project.diagnostics
    assert (finding.code, finding.severity) == ("XML201", Severity.WARNING)
    assert words in finding.message
    assert sfc.dumps(project) == data
    assert f"<{kind}".encode() in sfc.dumps(project, fresh=True)


@pytest.mark.parametrize(
    ("attribute", "value", "code", "words"),
    [
        ("IsKnowHowProtected", "true", "XML211", "know-how protected"),
        ("IsConsistent", "false", "XML212", "not consistent"),
    ],
)
def test_a_block_that_cannot_be_looked_into(attribute: str, value: str, code: str, words: str) -> None:
    marked = f'<{attribute} ReadOnly="true">{value}</{attribute}>\r\n      <Name>FB_Motor'.encode()
    data = MOTOR.replace(b"<Name>FB_Motor", marked, 1)
    assert data != MOTOR
    project = sfc.loads(data)
    (finding,) = [d for d in project.diagnostics if d.code == code]
    assert words in finding.message
    assert "FB_Motor" in finding.message
    assert sfc.dumps(project) == data
    assert attribute.encode() in sfc.dumps(project, fresh=True)
    project.pous[0].number = 77
    edited = sfc.dumps(project)
    assert [new for old, new in zip(data.splitlines(), edited.splitlines(), strict=True) if old != new] == [
        b"      <Number>77</Number>"
    ]


def test_a_protected_block_without_its_program() -> None:
    block = (
        b'<SW.Blocks.FB ID="0"><AttributeList><IsKnowHowProtected ReadOnly="true">true</IsKnowHowProtected>'
        b"<Name>Secret</Name><Number>3</Number><ProgrammingLanguage>SCL</ProgrammingLanguage></AttributeList>"
        b"</SW.Blocks.FB>"
    )
    data = b'<Document><Engineering version="V18" />' + block + b"</Document>"
    project = sfc.loads(data)
    assert [d.code for d in project.diagnostics] == ["XML211"]
    assert project.pou("Secret").bodies == []
    assert sfc.dumps(project) == data
    assert validate(data) == []


def test_types_are_read_in_any_case_and_written_as_they_are_spelled() -> None:
    """Documents that scripts write have BOOL; TIA Portal itself writes Bool."""
    odd = MOTOR.replace(b'<Member Name="Enable" Datatype="Bool"', b'<Member Name="Enable" Datatype="BOOL"')
    assert odd != MOTOR
    project = sfc.loads(odd)
    enable = next(v for v in project.pous[0].variables() if v.name == "Enable")
    assert enable.type == ElementaryType(name=Elementary.BOOL)
    enable.name = "Released"
    assert b'<Member Name="Released" Datatype="BOOL"' in sfc.dumps(project)
