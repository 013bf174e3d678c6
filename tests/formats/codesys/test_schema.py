"""Validation of CODESYS and TwinCAT files: what hides in foreign data is checked where it is."""

from __future__ import annotations

import re

import pytest
from lxml import etree

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.formats.codesys import codesys_names as names
from plcopen_sfc.formats.codesys.codesys_codec import validate_codesys
from plcopen_sfc.formats.plcopen.tc6_versions import validate_tc6
from plcopen_sfc.formats.xml.schema_validation import is_valid
from tests.corpus import ROOT, corpus_files, require_corpus
from tests.mutants import Mutator

PREFIX = names.PREFIX
FIXTURES = sorted([*(ROOT / "fixtures" / "codesys").glob("*.xml"), *(ROOT / "fixtures" / "twincat").glob("*.xml")])
HIDDEN_MUTANTS = 60
STEP = '<step localId="7" name="Fill"><position x="0" y="0"/></step>'


def data(name: str, payload: str) -> str:
    return f'<addData><data name="{PREFIX}{name}" handleUnknown="implementation">{payload}</data></addData>'


def chart(content: str) -> str:
    return f'<pou name="Main" pouType="program"><body><SFC>\n{content}\n</SFC></body></pou>'


def document(end: str, number: str = "0200") -> bytes:
    """A project without POUs of its own, and with foreign data that begins in line 8."""
    return f"""<?xml version="1.0" encoding="utf-8"?>
<project xmlns="http://www.plcopen.org/xml/tc6_{number}">
<fileHeader companyName="" productName="CODESYS" productVersion="" creationDateTime="2024-01-31T08:30:00"/>
<contentHeader name="Plant"><coordinateInfo><fbd><scaling x="1" y="1"/></fbd><ld><scaling x="1" y="1"/></ld>
<sfc><scaling x="1" y="1"/></sfc></coordinateInfo></contentHeader>
<types><dataTypes/><pous/></types>
<instances><configurations/></instances>
{end}
</project>
""".encode()


def application(content: str) -> bytes:
    """The same with POUs and the like where TwinCAT keeps them."""
    return document(data("application", f'<resource name="App">\n{content}\n</resource>'))


def only(source: bytes) -> Diagnostic:
    found = validate_codesys(source, file="a.xml")
    assert len(found) == 1, found
    return found[0]


@pytest.mark.parametrize("path", FIXTURES, ids=lambda path: path.name)
def test_our_examples_are_valid(path: object) -> None:
    assert validate_codesys(path.read_bytes()) == []  # type: ignore[attr-defined]


@pytest.mark.parametrize("number", ["0200", "0201"])
def test_valid(number: str) -> None:
    assert validate_codesys(document(data("pou", chart(STEP)), number)) == []


def test_the_old_version_has_no_foreign_data() -> None:
    assert validate_codesys((ROOT / "fixtures/plcopen/every_element_1.01.xml").read_bytes()) == []


def test_a_hidden_pou_is_checked_as_one_of_the_project() -> None:
    source = application(data("pou", chart(STEP.replace(' name="Fill"', ""))))
    assert validate_tc6(source) == [], "the schema of TC6 does not see it"
    finding = only(source)
    assert (finding.code, finding.severity, finding.location.line) == ("XSD004", Severity.ERROR, 10)
    assert finding.location.path == (
        f'/project/addData/data[@name="{PREFIX}application"]/resource[@name="App"]/addData/data[@name="{PREFIX}pou"]'
        '/pou[@name="Main"]/body/SFC/step[@localId="7"]'
    )
    assert finding.message == "<step> has no name, which it must have"


@pytest.mark.parametrize(
    ("name", "payload", "words"),
    [
        ("datatype", '<dataType name="T"/>', "<baseType> is missing in <dataType>"),
        ("globalvars", '<globalVars constant="yes"/>', 'constant="yes" of <globalVars> must be true or false'),
        (
            "pou",
            '<pou name="Main"/>',
            "<pou> has no pouType, which it must have: one of program, functionBlock, function",
        ),
        ("pou", '<pow name="Main"/>', f"data of the name {PREFIX}pou must hold <pou>, not <pow>"),
        ("pou", '<pou xmlns="" name="Main" pouType="program"/>', "<pou> of http"),
        ("method", '<Method name="M"><body/></Method>', "one of IL, ST, FBD, LD, SFC is missing in <body>"),
    ],
)
def test_faults_in_hidden_objects_are_errors(name: str, payload: str, words: str) -> None:
    finding = only(application(data(name, payload)))
    assert finding.severity is Severity.ERROR
    assert words in finding.message
    assert finding.location.line == 9


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "payload", "code", "words"),
    [
        ("objectid", "<ObjectId>17</ObjectId>", "XSD007", 'the text "17" of <ObjectId> must be of the form'),
        ("objectid", "<ObjektId/>", "XSD020", "must hold <ObjectId>, not <ObjektId>"),
        ("sfcsettings", "<SFCSettings><Flags/></SFCSettings>", "XSD003", "<LibTitle> is missing in <SFCSettings>"),
        ("ldbranchid", '<BranchId xmlns="">two</BranchId>', "XSD007", "must be a whole number, 0 or greater"),
        ("interfaceasplaintext", "<InterfaceAsPlainText>VAR</InterfaceAsPlainText>", "XSD008", "element of XHTML"),
        ("tasksettings", "<TaskSettings/>", "XSD004", "<TaskSettings> has no KindOfTask"),
        ("attributes", '<Attributes><Attribute Name="a"/></Attributes>', "XSD004", "<Attribute> has no Value"),
        ("buildproperties", "<BuildProperties>x</BuildProperties>", "XSD008", 'text "x" is directly in'),
        ("libraries", "<Libraries><Library/></Libraries>", "XSD004", "<Library> has no Name"),
        ("method", "<Method/>", "XSD004", "<Method> has no name"),
        ("projectstructure", "<ProjectStructure><Folder/></ProjectStructure>", "XSD004", "<Folder> has no Name"),
        ("fbdcalltype", '<CallType xmlns=""><a/></CallType>', "XSD002", "<CallType> holds text only"),
        (
            "fbd/implementationattributes",
            '<fbdattributes xmlns=""><attribute name="a"/></fbdattributes>',
            "XSD004",
            "<attribute> has no value",
        ),
    ],
)
def test_faults_in_what_is_the_vendors_own_are_warnings(name: str, payload: str, code: str, words: str) -> None:
    finding = only(document(data(name, payload)))
    assert (finding.code, finding.severity, finding.location.line) == (code, Severity.WARNING, 8)
    assert words in finding.message


def attribute(guid: str, text: str) -> bytes:
    payload = f'<attributes xmlns=""><attribute guid="{guid}">{text}</attribute></attributes>'
    return document(data("pou", chart(STEP.replace("</step>", data("sfc/element", payload) + "</step>"))))


@pytest.mark.parametrize(
    ("guid", "good", "bad"),
    [
        (names.EXCLUDE, "FALSE", "0"),
        (names.INITIAL, "TRUE", ""),
        (names.SYMBOL, "4", "5"),
        (names.MONITORING, "2", "3"),
        (names.QUALIFIER, "SD T#2s", "DD T#2s"),
        (names.PARALLEL, "\n  TRUE\n", "yes"),
        (names.DUPLICATION.upper(), "false", "falsch"),
    ],
)
def test_values_of_chart_attributes(guid: str, good: str, bad: str) -> None:
    assert validate_codesys(attribute(guid, good)) == []
    finding = only(attribute(guid, bad))
    assert (finding.code, finding.severity, finding.location.line) == ("XSD022", Severity.WARNING, 9)
    assert f'the value "{bad}" of this attribute must be' in finding.message
    assert str(finding.location.path).endswith(f'/attributes/attribute[@guid="{guid}"]')


@pytest.mark.parametrize("guid", [names.NAME, names.COMMENT, names.MIN_TIME, names.MAX_TIME, names.ENTRY_ACTION])
def test_chart_attributes_of_any_text(guid: str) -> None:
    assert validate_codesys(attribute(guid, "T#1s\nanything")) == []


def test_an_unknown_chart_attribute() -> None:
    finding = only(attribute("00000000-0000-0000-0000-000000000000", "x"))
    assert (finding.code, finding.severity) == ("XSD021", Severity.WARNING)
    assert "may be of a newer version" in finding.message


def test_a_chart_attribute_without_its_guid() -> None:
    source = attribute(names.NAME, "x").replace(f' guid="{names.NAME}"'.encode(), b"")
    finding = only(source)
    assert (finding.code, finding.severity) == ("XSD004", Severity.WARNING)


def test_foreign_data_of_others_passes() -> None:
    foreign = '<addData><data name="http://example.org/x" handleUnknown="preserve"><own><thing/></own></data></addData>'
    assert validate_codesys(document(foreign)) == []


def test_findings_stand_in_the_order_of_lines() -> None:
    broken = STEP.replace(' name="Fill"', "")
    late = data("objectid", "<Wrong/>")
    source = document(data("pou", chart(broken + "\n\n" + STEP.replace("</step>", late + "</step>") + "\n" + broken)))
    assert [finding.location.line for finding in validate_codesys(source)] == [9, 11, 12]


def test_the_list_is_cut_off() -> None:
    many = "".join(f'<data name="{PREFIX}objectid" handleUnknown="discard"><Wrong/></data>' for _ in range(150))
    found = validate_codesys(document(f"<addData>{many}</addData>"))
    assert len(found) == 101
    assert (found[-1].code, found[-1].severity) == ("XSD099", Severity.INFO)


def test_no_tc6() -> None:
    assert only(b"<TcPlcObject/>").code == "XSD001"


@pytest.mark.corpus
def test_every_export_of_the_corpus_is_valid() -> None:
    require_corpus()
    files = [path for path in corpus_files("codesys") if path.suffix == ".xml"]
    assert files
    for path in files:
        assert validate_codesys(path.read_bytes()) == [], path


def hoisted(hidden: etree._Element) -> etree._Element:
    """An empty project with this POU in `types/pous`."""
    root = etree.fromstring(document("", etree.QName(hidden).namespace.rpartition("_")[2]))
    root.find("{*}types/{*}pous").append(hidden)
    return root


@pytest.mark.slow
@pytest.mark.parametrize("path", [path for path in FIXTURES if "sorting" not in path.name], ids=lambda path: path.name)
def test_a_hidden_pou_gets_the_verdict_that_it_gets_in_the_project(path: object) -> None:
    """Each mutant of a hidden POU is judged in its hiding place and in `types/pous`: the same faults either way."""
    root = etree.fromstring(path.read_bytes())  # type: ignore[attr-defined]
    hidden = [pou for pou in root.iter("{*}pou") if etree.QName(pou.getparent()).localname == "data"]
    assert hidden
    version = "2.0" if "0200" in str(hidden[0].tag) else "2.01"
    valid = 0
    for number in range(HIDDEN_MUTANTS):
        pou = hidden[number % len(hidden)]
        tree = hoisted(etree.fromstring(etree.tostring(pou, with_tail=False)))
        mutator = Mutator(tree.find("{*}types/{*}pous/{*}pou"), f"{path}{number}")
        mutant = mutator.mutant()
        at_home = hoisted(etree.fromstring(etree.tostring(mutant)))
        away = etree.fromstring(document(data("pou", ""), "0200" if version == "2.0" else "0201"))
        next(away.iter("{*}data")).append(etree.fromstring(etree.tostring(mutant)))
        verdict = is_valid(at_home, f"codesys-{version}")
        assert is_valid(away, f"codesys-{version}") == verdict, etree.tostring(mutant)
        valid += verdict
    assert 0 < valid < HIDDEN_MUTANTS


def test_the_schemas_know_every_payload_that_the_checks_know() -> None:
    text = "".join((ROOT / "schemas" / f"codesys-{part}.xsd").read_text("utf-8") for part in ("payloads", "shared"))
    declared = set(re.findall(r'^  <xs:element name="(\w+)"', text, re.MULTILINE))
    assert {"pou", "dataType", "globalVars", "resource", "Method", "attributes", "SFCSettings"} <= declared
