"""Validation of small documents, one fault each: code, line, path and words."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest
from lxml import etree

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import FileAccessError, XmlSyntaxError
from plcopen_sfc.formats.plcopen.tc6_versions import validate_tc6
from plcopen_sfc.formats.xml.schema_validation import MAX_FINDINGS, is_valid, schema_path
from plcopen_sfc.formats.xml.xml_parsing import parse_xml
from tests.corpus import ROOT
from tests.mutants import systematic_mutants

NAMESPACES = {"1.01": "http://www.plcopen.org/xml/tc6.xsd"} | {
    version: f"http://www.plcopen.org/xml/tc6_{number}" for version, number in (("2.0", "0200"), ("2.01", "0201"))
}
STEP = '<step localId="7" name="Fill"><position x="1" y="2"/></step>'
SFC = '/project/types/pous/pou[@name="Main"]/body/SFC'


def document(body: str = "", *, version: str = "2.01", interface: str = "", end: str = "", pou: str = "") -> bytes:
    """A small project; `interface` is in line 10, `body` in line 12, `pou` in line 14 and `end` in line 18."""
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<project xmlns="{NAMESPACES[version]}">
<fileHeader companyName="" productName="" productVersion="" creationDateTime="2024-01-31T08:30:00"/>
<contentHeader name="Plant"><coordinateInfo><fbd><scaling x="1" y="1"/></fbd><ld><scaling x="1" y="1"/></ld>
<sfc><scaling x="1" y="1"/></sfc></coordinateInfo></contentHeader>
<types>
<dataTypes/>
<pous>
<pou name="Main" pouType="program">
{interface}
<body><SFC>
{body}
</SFC></body>
{pou}
</pou>
</pous></types>
<instances><configurations/></instances>
{end}
</project>
""".encode()


def only(data: bytes) -> Diagnostic:
    found = validate_tc6(data, file="a.xml")
    assert len(found) == 1, found
    assert found[0].severity is Severity.ERROR
    assert found[0].location.file == "a.xml"
    return found[0]


@pytest.mark.parametrize("version", NAMESPACES)
def test_valid(version: str) -> None:
    assert validate_tc6(document(STEP, version=version)) == []


def test_a_valid_file_does_not_load_xmlschema() -> None:
    program = (
        "import sys; from plcopen_sfc.formats.plcopen.tc6_versions import validate_tc6; "
        f"assert validate_tc6(open({str(ROOT / 'fixtures/plcopen/every_element_2.01.xml')!r}, 'rb').read()) == []; "
        "assert 'xmlschema' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", program], check=True, cwd=ROOT)


CASES = {
    "missing attribute": (
        STEP.replace(' name="Fill"', ""),
        "XSD004", 12, '/step[@localId="7"]', "<step> has no name, which it must have",
    ),
    "missing attribute of a type": (
        STEP.replace('localId="7" ', ""),
        "XSD004", 12, '/step[@name="Fill"]', "<step> has no localId, which it must have: a whole number, 0 or greater",
    ),
    "unknown attribute, near a known one": (
        STEP.replace("<step", '<step initalStep="true"'),
        "XSD005", 12, '/step[@localId="7"]', "<step> has an unknown attribute initalStep; initialStep may be meant",
    ),
    "unknown attribute": (
        STEP.replace('x="1"', 'x="1" z="3"'),
        "XSD005", 12, '/step[@localId="7"]/position', "<position> has an unknown attribute z; it may have x, y",
    ),
    "foreign attribute": (
        STEP.replace("<step", '<step xmlns:v="http://example.org/v" v:mark="1"'),
        "XSD005", 12, '/step[@localId="7"]', "has the foreign attribute mark, which this format does not",
    ),
    "wrong number": (
        STEP.replace('"7"', '"S7"'),
        "XSD006", 12, '/step[@localId="S7"]', 'localId="S7" of <step> must be a whole number, 0 or greater',
    ),
    "wrong decimal, repaired": (
        STEP.replace('x="1"', 'x="1,5"'),
        "XSD006", 12, '/step[@localId="7"]/position', 'x="1,5" of <position> must be a number like 12.5; write "1.5"',
    ),
    "wrong boolean, repaired": (
        STEP.replace("<step", '<step initialStep="TRUE"'),
        "XSD006", 12, '/step[@localId="7"]', 'initialStep="TRUE" of <step> must be true or false; write "true"',
    ),
    "wrong word of a list": (
        '<contact localId="1" storage="sett"><position x="0" y="0"/><variable>a</variable></contact>',
        "XSD006", 12, '/contact[@localId="1"]', 'storage="sett" of <contact> must be one of none, set, reset',
    ),
    "missing first child": (
        STEP.replace('<position x="1" y="2"/>', "<connectionPointIn/>"),
        "XSD003", 12, '/step[@localId="7"]/connectionPointIn',
        "<position> is missing in <step>, before <connectionPointIn>",
    ),
    "missing only child": (
        '<step localId="7" name="Fill"/>',
        "XSD003", 12, '/step[@localId="7"]', "<position> is missing in <step>",
    ),
    "missing choice": (
        f'<macroStep localId="1"><position x="0" y="0"/><body/></macroStep>{STEP}',
        "XSD003", 12, '/macroStep[@localId="1"]/body', "one of IL, ST, FBD, LD, SFC is missing in <body>",
    ),
    "unknown element": (
        STEP + "<stepp/>",
        "XSD002", 12, "/stepp", "<SFC> knows no <stepp>; <step> may be meant",
    ),
    "unknown element, nothing like it": (
        STEP.replace("</step>", "<zzz/></step>"),
        "XSD002", 12, '/step[@localId="7"]/zzz',
        "<step> knows no <zzz>; it may hold position, connectionPointIn, connectionPointOut,",
    ),
    "element in the wrong namespace": (
        STEP.replace("<position", '<position xmlns=""'),
        "XSD002", 12, '/step[@localId="7"]/position', "is in the wrong namespace: none instead of http://www.plcopen.org",
    ),
    "wrong order": (
        STEP.replace("</step>", '<connectionPointOut formalParameter="sfc"/><connectionPointIn/></step>'),
        "XSD002", 12, '/step[@localId="7"]/connectionPointIn',
        "<connectionPointIn> is too late in <step>: it must come before <connectionPointOut>",
    ),
    "too early": (
        '<step localId="7" name="Fill"><connectionPointIn/><position x="1" y="2"/></step>',
        "XSD002", 12, '/step[@localId="7"]/connectionPointIn',
        "<connectionPointIn> is too early in <step>: position must come first",
    ),
    "twice": (
        STEP.replace("</step>", "<connectionPointIn/><connectionPointIn/></step>"),
        "XSD002", 12, '/step[@localId="7"]/connectionPointIn[2]',
        "a second <connectionPointIn> in <step>; only one is allowed",
    ),
    "one excludes the other": (
        '<rightPowerRail localId="7"><position x="0" y="0"/><connectionPointIn><connection refLocalId="1"/>'
        "<expression/></connectionPointIn></rightPowerRail>",
        "XSD002", 12, '/rightPowerRail[@localId="7"]/connectionPointIn/expression',
        "<expression> is not allowed here in <connectionPointIn>",
    ),
    "content in an empty element": (
        STEP.replace('y="2"/>', 'y="2"><x/></position>'),
        "XSD002", 12, '/step[@localId="7"]/position/x', "<position> must be empty; <x> is not allowed in it",
    ),
    "text in an empty element": (
        STEP.replace('y="2"/>', 'y="2">3</position>'),
        "XSD008", 12, '/step[@localId="7"]/position', 'text "3" is directly in <position>, where only elements are',
    ),
    "blank in an empty element": (
        STEP.replace('y="2"/>', 'y="2"> </position>'),
        "XSD008", 12, '/step[@localId="7"]/position', "<position> must be empty; not even blanks or line breaks",
    ),
    "text between elements": (
        STEP + "Fill -> Empty",
        "XSD008", 11, "", 'text "Fill -> Empty" is directly in <SFC>, where only elements are allowed',
    ),
    "element in a text": (
        '<inVariable localId="1"><position x="0" y="0"/><expression>a<b/></expression></inVariable>',
        "XSD002", 12, '/inVariable[@localId="1"]/expression/b',
        "<expression> holds text only; it must not contain an element",
    ),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(("body", "code", "line", "path", "words"), CASES.values(), ids=list(CASES))
def test_faults_of_a_chart(body: str, code: str, line: int, path: str, words: str) -> None:
    finding = only(document(body))
    assert (finding.code, finding.location.line, finding.location.path) == (code, line, SFC + path)
    assert words in finding.message


def test_raw_code_says_how_to_write_it() -> None:
    action = '<actions><action name="A"><body><ST>x := 1;</ST></body></action></actions>'
    finding = only(document(interface=action))
    assert finding.code == "XSD008"
    assert 'text "x := 1;" is directly in <ST>; it belongs into an element of XHTML: <ST><xhtml' in finding.message
    assert finding.location.path == '/project/types/pous/pou[@name="Main"]/actions/action[@name="A"]/body/ST'


@pytest.mark.parametrize(
    ("content", "code", "words"),
    [
        ("", "XSD003", "<ST> is empty; it must hold one element of XHTML"),
        ("<p>x</p>", "XSD002", "<p> is not allowed in <ST>, only one element of XHTML"),
        (
            '<p xmlns="http://www.w3.org/1999/xhtml"/><p xmlns="http://www.w3.org/1999/xhtml"/>',
            "XSD002",
            "more than one",
        ),
    ],
)
def test_code_without_its_one_xhtml_element(content: str, code: str, words: str) -> None:
    finding = only(document(interface=f'<actions><action name="A"><body><ST>{content}</ST></body></action></actions>'))
    assert finding.code == code
    assert words in finding.message


def test_actions_behind_the_body() -> None:
    finding = only(document(pou="<actions/>"))
    assert (finding.code, finding.location.line) == ("XSD002", 14)
    assert "<actions> is too late in <pou>: it must come before <body>" in finding.message


def test_sections_missing_from_the_project() -> None:
    data = document().replace(b"<instances><configurations/></instances>", b"")
    finding = only(data)
    assert (finding.code, finding.location.line, finding.location.path) == ("XSD003", 2, "/project")
    assert "<instances> is missing in <project>" in finding.message


def test_date_with_a_blank() -> None:
    finding = only(document().replace(b"31T08", b"31 08"))
    assert (finding.code, finding.location.line, finding.location.path) == ("XSD006", 3, "/project/fileHeader")
    assert 'write "2024-01-31T08:30:00"' in finding.message


def test_several_faults_in_order_of_lines() -> None:
    found = validate_tc6(document(STEP.replace(' name="Fill"', "") + "\n<step/>").replace(b"31T08", b"31 08"))
    assert [finding.code for finding in found] == ["XSD006", "XSD004", "XSD004", "XSD004", "XSD003"]
    assert [finding.location.line for finding in found] == [3, 12, 13, 13, 13]


def test_ids_that_are_not_unique() -> None:
    steps = (
        STEP.replace("<step", '<step globalId="a"')
        + "\n"
        + STEP.replace("<step", '<step globalId="a"').replace("7", "8")
    )
    finding = only(document(steps))
    assert (finding.code, finding.location.line, finding.location.path) == ("XSD009", 13, SFC + '/step[@localId="8"]')
    assert 'globalId="a" of <step> is also the globalId of <step> in line 12; ids must differ' in finding.message


def test_an_id_that_is_no_name() -> None:
    finding = only(document(STEP.replace("<step", '<step globalId="1 a"')))
    assert finding.code == "XSD006"
    assert "beginning with a letter or an underscore" in finding.message


def test_priority_out_of_range() -> None:
    task = '<configuration name="C"><resource name="R"><task name="T" priority="65536"/></resource></configuration>'
    data = document().replace(b"<configurations/>", f"<configurations>{task}</configurations>".encode())
    finding = only(data)
    assert 'priority="65536" of <task> must be a whole number from 0 to 65535' in finding.message
    assert str(finding.location.path).endswith('configuration[@name="C"]/resource[@name="R"]/task[@name="T"]')


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (document().replace(b"tc6_0201", b"tc6_0305"), "namespace http://www.plcopen.org/xml/tc6_0305 is not known"),
        (document().replace(b' xmlns="http://www.plcopen.org/xml/tc6_0201"', b""), "<project> is in no namespace"),
        (document().replace(b"project", b"Project"), "begins with <project>, not with <Project>"),
        (b"<TcPlcObject/>", "no TC6 XML: it begins with <TcPlcObject>"),
        (b'<Project xmlns="www.iec.ch/public/TC65SC65BWG7TF10"/>', "IEC 61131-10"),
    ],
)
def test_what_is_no_known_tc6(data: bytes, words: str) -> None:
    finding = only(data)
    assert finding.code == "XSD001"
    assert words in finding.message
    assert finding.location.line is not None


def test_foreign_data_depends_on_the_version() -> None:
    empty = '<addData><data name="http://example.org/x" handleUnknown="discard"/></addData>'
    assert validate_tc6(document(end=empty, version="2.0")) == []
    assert only(document(end=empty, version="2.01")).code == "XSD003"
    old = only(document(end=empty, version="1.01"))
    assert (old.code, old.location.line) == ("XSD002", 18)
    assert "<project> knows no <addData>" in old.message


def test_foreign_data_is_not_looked_at() -> None:
    data = '<addData><data name="http://example.org/x" handleUnknown="discard"><pou/></data></addData>'
    assert validate_tc6(document(end=data)) == []


def test_elements_with_a_prefix() -> None:
    text = document(STEP + '<v:other xmlns:v="http://example.org/v"/><!-- -->').decode()
    found = only(text.encode())
    assert "<SFC> knows no <other>" in found.message
    plain = text.replace("<v:other xmlns:v=", "<other xmlns:v=").replace("xmlns=", "xmlns:t=")
    prefixed = re.sub(r"<(/?)(?=[a-zA-Z])", r"<\1t:", plain)
    finding = only(prefixed.encode())
    assert (finding.code, finding.location.line, finding.location.path) == ("XSD002", 12, SFC + "/other")


def test_the_list_is_cut_off() -> None:
    found = validate_tc6(
        document("\n".join('<step localId="x" name=""><position x="0" y="0"/></step>' for _ in range(150)))
    )
    assert len(found) == MAX_FINDINGS + 1
    assert (found[-1].code, found[-1].severity) == ("XSD099", Severity.INFO)
    assert f"{150 - MAX_FINDINGS} more" in found[-1].message


def test_lines_beyond_65535() -> None:
    finding = only(document("\n" * 70000 + "\n".join([STEP, "<stepp/>"])))
    assert finding.location.line == 12 + 70000 + 1


@pytest.mark.slow
def test_every_fault_is_explained() -> None:
    """Of all ways to damage a document every 37th: what is invalid has findings, and none is libxml2's own words."""
    root = parse_xml((ROOT / "fixtures" / "plcopen" / "every_element_1.01.xml").read_bytes())
    invalid = 0
    for number, (what, mutant) in enumerate(systematic_mutants(root)):
        if number % 37:
            continue
        data = etree.tostring(mutant)
        valid = is_valid(parse_xml(data), "plcopen-1.01")
        found = validate_tc6(data)
        assert valid == (not found), what
        assert "XSD019" not in {finding.code for finding in found}, what
        invalid += not valid
    assert invalid > 100


def test_what_is_not_xml() -> None:
    with pytest.raises(XmlSyntaxError):
        validate_tc6(b"PROGRAM Main", file="a.xml")


def test_a_schema_that_is_not_there() -> None:
    with pytest.raises(FileAccessError, match=r"schema nothing\.xsd is missing"):
        schema_path("nothing")
