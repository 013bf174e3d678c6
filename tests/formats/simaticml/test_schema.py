"""Validation of documents of TIA Portal Openness, one fault each: code, severity, line and words."""

from __future__ import annotations

from pathlib import Path

import pytest
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.documents.file_documents import normalized
from plcopen_sfc.errors import SfcError, XmlSyntaxError
from plcopen_sfc.formats.simaticml.openness_schemas import validate
from plcopen_sfc.formats.simaticml.tia_versions import LANGUAGES, SCHEMAS, VERSIONS
from plcopen_sfc.formats.xml.schema_validation import MAX_FINDINGS, is_valid
from tests.corpus import ROOT
from tests.formats.simaticml.documents import FIXTURES, parsed, real_documents
from tests.mutants import Mutator

FOLDER = ROOT / "schemas" / "simaticml"


@pytest.mark.parametrize("path", sorted(FIXTURES.rglob("*.xml")), ids=lambda path: path.name)
def test_our_examples_are_valid(path: Path) -> None:
    assert validate(path.read_bytes()) == []


def test_there_is_a_schema_for_every_entry_of_the_table_of_versions() -> None:
    there = {path.stem for path in FOLDER.glob("*-v*.xsd")}
    wanted = {f"{kind}-v{number}" for kind, numbers in SCHEMAS.items() for number in numbers}
    assert there == wanted
    assert all(
        version.schema(kind) in {0, *SCHEMAS[kind]} for version in VERSIONS for kind in ("Interface", *LANGUAGES)
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file", "edit", "expected", "words"),
    [
        ("tags.xml", ("Name>", "Nam>"), "warning XSD002", "<AttributeList> knows no <Nam>"),
        ("tags.xml", ("SW.Tags.PlcUserConstant", "SW.Tags.Future"), "warning XSD002", "knows no"),
        ("tags.xml", ('PlcTagTable ID="0"', "PlcTagTable"), "error XSD004", "has no ID"),
        ("tags.xml", ('PlcTagTable ID="0"', 'PlcTagTable ID="x"'), "error XSD006", "of the form"),
        ("tags.xml", ('version="V20"', 'version="V13"'), "error XSD001", "V13"),
        ("tags.xml", ("Document>", "Documents>"), "error XSD001", "<Documents>"),
        ("FB_Drill.xml", ("Graph/v5", "Graph/v3"), "error XSD031", "TIA Portal V20 has"),
        ("FB_Drill.xml", ("Graph/v5", "Graph/v6"), "error XSD032", "which came with V21"),
        ("FB_Drill.xml", ("LinkType>Jump", "LinkType>Hop"), "error XSD007", "one of Direct, Jump"),
        ("FB_Drill.xml", ('Qualifier="L"', 'Qualifier="P1"'), "error XSD006", "must be one of"),
        ("FB_Motor.xml", ('Scope="LocalVariable"', 'Scope="Here"'), "error XSD006", "LocalVariable"),
        ("Station.xml", ("Member Name", "Member Nme"), "error XSD004", "has no Name"),
    ],
)
def test_one_kind_of_fault(file: str, edit: tuple[str, str], expected: str, words: str) -> None:
    text = (FIXTURES / file).read_text(encoding="utf-8-sig")
    assert edit[0] in text
    found = validate(text.replace(*edit).encode(), file="a.xml")
    fitting = [finding for finding in found if expected in str(finding) and words in finding.message]
    assert fitting, found
    assert fitting[0].location.line is not None


def test_the_line_is_that_of_the_file_also_inside_of_a_part() -> None:
    text = (FIXTURES / "FB_Drill.xml").read_text(encoding="utf-8-sig")
    line = 1 + text[: text.index('Qualifier="L"')].count("\n")
    (finding,) = validate(text.replace('Qualifier="L"', 'Qualifier="P1"', 1).encode())
    assert finding.location.line == line
    assert "/Graph/Sequence" in (finding.location.path or "")


def test_a_part_without_its_namespace_is_told() -> None:
    text = (FIXTURES / "FC_Release.xml").read_text(encoding="utf-8-sig")
    bare = text.replace(' xmlns="http://www.siemens.com/automation/Openness/SW/NetworkSource/FlgNet/v5"', "")
    assert bare != text
    found = validate(bare.encode())
    assert {finding.code for finding in found} == {"XSD031"}
    assert "FlgNet/v5" in found[0].message


def test_objects_of_other_kinds_are_no_fault_of_the_document() -> None:
    data = b'<Document><Engineering version="V16" /><Hmi.Tag.TagTable ID="0" /></Document>'
    assert validate(data) == []


def test_no_xml_is_an_error_of_its_own() -> None:
    with pytest.raises(XmlSyntaxError):
        validate(b"<Document><Engineering")


@pytest.mark.slow
def test_a_file_full_of_faults_is_cut_off() -> None:
    member = '<Member Nme="x" Datatype="Bool" />'
    space = "http://www.siemens.com/automation/Openness/SW/Interface/v5"
    parts = f'<Sections xmlns="{space}"><Section Name="Static">{member * 400}</Section></Sections>'
    block = f'<SW.Blocks.GlobalDB ID="0"><AttributeList><Name>D</Name><Interface>{parts}</Interface></AttributeList>'
    data = f'<Document><Engineering version="V20" />{block}</SW.Blocks.GlobalDB></Document>'.encode()
    assert MAX_FINDINGS < len(validate(data)) < 2 * MAX_FINDINGS + 2


@pytest.mark.slow
@pytest.mark.parametrize("file", ["FB_Drill.xml", "FB_Motor.xml", "Machine.xml", "tags.xml"])
def test_damaged_documents_end_in_findings_or_own_errors(file: str) -> None:
    """Validation, saving for another version and normalising take whatever comes."""
    mutator = Mutator(parsed((FIXTURES / file).read_bytes()), file, tags=("Step", "FlgNet", "Member", "unheardOf"))
    for _ in range(12):
        data = etree.tostring(mutator.mutant())
        validate(data)
        try:
            project = sfc.loads(data, format="simaticml")
            normalized(data, "simaticml")
            sfc.dumps(project, tia="V15")
        except SfcError:
            continue


@pytest.mark.slow
@pytest.mark.corpus
def test_real_documents_are_valid_but_for_known_faults() -> None:
    """Those are templates and files made by hand: every finding was looked at, and is a fault of the file."""
    invalid = {path.name[:12] for path in real_documents() if validate(path.read_bytes())}
    known = {
        "DBRobot.xml",
        "4d4c7206fc4f",
        "SyntheticCas",
        "acd70a836a40",
        "bfbae00f88b3",
        "23142af917fe",
        "257555554dba",
    }
    known |= {"4072d534ad71", "8e60e84ed0f1", "f0477a1e2d4d", "fb-call.xml", "V14SP1.xml"}
    assert invalid <= known


@pytest.mark.slow
@pytest.mark.corpus
def test_the_frame_of_real_documents_is_complete_in_the_schema() -> None:
    """No export has an object or an attribute that our schema of the frame does not know."""
    for path in real_documents():
        root = parsed(path.read_bytes())
        if not is_valid(root, "simaticml/document"):
            found = [f for f in validate(path.read_bytes()) if f.severity is Severity.WARNING]
            assert found == [], path


@pytest.mark.corpus
def test_one_schema_for_editors_says_the_same_of_whole_documents() -> None:
    elsewhere = {"XSD031", "XSD032"}
    for path in (*real_documents()[::3], *sorted(FIXTURES.rglob("*.xml"))):
        data = path.read_bytes()
        found = [finding for finding in validate(data) if finding.code not in elsewhere]
        assert is_valid(parsed(data), "simaticml/whole-document") == (not found), path


def test_the_schema_for_editors_knows_every_part() -> None:
    imported = {
        str(each.get("schemaLocation")) for each in etree.parse(FOLDER / "whole-document.xsd").iter("{*}import")
    }
    assert imported == {path.name for path in FOLDER.glob("*-v*.xsd")}
