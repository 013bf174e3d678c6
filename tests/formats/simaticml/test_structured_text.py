"""SCL: tokens to text and back."""

from __future__ import annotations

from collections import Counter
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc.formats.simaticml.element_reader import NotUnderstoodError, same_content
from plcopen_sfc.formats.simaticml.program_comparison import renumber
from plcopen_sfc.formats.simaticml.scl_tokens import InterfaceNames, read_code, scl_text, write_text
from plcopen_sfc.model import StBody
from tests.formats.simaticml.documents import FIXTURES, parsed, real_documents
from tests.languages import st_simaticml

TEXTS = (
    "#a := #b + 1;",
    '"Tag" := #"with blank".x AND NOT "DB".y[#i, 2].z;',
    "IF #a THEN // comment\n    #b := TRUE;\nELSIF #c = 16#FF THEN\n    ;\nEND_IF;",
    "CASE #step OF\n    0:\n        #x := 1.5;\n    1..5, 7: #x := -2;\nELSE\n    EXIT;\nEND_CASE;",
    "FOR #i := 1 TO 10 BY 2 DO\n\n    #s[#i] := 'it''s' ;\nEND_FOR;",
    "#timer(IN := #a, PT := T#5s, Q => #b);\n#x := #timer.Q;",
    '"FC_1"(a := #x, b := (1 + 2) * 3);',
    "#x := ABS(#y) + MAX(IN1 := 1, IN2 := #z);",
    "#w.%X3 := %I0.1;\n%QW4 := #v;",
    "REGION Name of it\n    #a := 1;\nEND_REGION",
    "(* block *) #a := (* inner *) 1; (/* both */)",
    "#a := \n\n",
    "// only a comment",
    "#a := unknown § ;",
)


def through_tokens(text: str) -> str:
    root = etree.Element("StructuredText")
    write_text(root, text, InterfaceNames({}), "de-DE")
    return scl_text(root)


@pytest.mark.parametrize("text", TEXTS)
def test_text_comes_back_from_its_tokens(text: str) -> None:
    assert through_tokens(text) == text


@given(st.text(alphabet="#\"ab1.;:=()[]+%X' \n/*,TRUE", max_size=40))
def test_any_text_comes_back(text: str) -> None:
    assert through_tokens(text) == text


def test_ids_count_on() -> None:
    root = etree.Element("StructuredText")
    write_text(root, "#a := 1;", InterfaceNames({}), "")
    ids = [int(element.get("UId", "")) for element in root.iterdescendants()]
    # that of the type of the constant is left out
    assert ids == [21, 22, 23, 24, 25, 26, 27, 28, 30, 31]


def test_instances_of_user_blocks_are_called_by_their_block() -> None:
    root = etree.Element("StructuredText")
    write_text(
        root,
        "#motor(go := TRUE);#timer(IN := TRUE);",
        InterfaceNames({"#motor": '"FB_Motor"', "#timer": "TON_TIME"}),
        "",
    )
    assert [element.tag for element in root.iter("CallInfo", "Instruction")] == ["CallInfo", "Instruction"]
    assert scl_text(root) == "#motor(go := TRUE);#timer(IN := TRUE);"


@pytest.mark.slow
@pytest.mark.corpus
def test_texts_of_the_corpus() -> None:
    """As another reader reads them; written again they are the same text, most of them in the same tokens."""
    outcomes: Counter[str] = Counter()
    for path in real_documents():
        for element in parsed(path.read_bytes()).iter("{*}StructuredText"):
            try:
                text = scl_text(element)
            except NotUnderstoodError:
                outcomes["opaque"] += 1
                continue
            outcomes["read"] += 1
            fields = read_code(element, InterfaceNames({}))
            outcomes["kept beside"] += "markup" in fields
            if not any(local.get("Scope") == "GlobalConstant" for local in element.iter("{*}Access")):
                assert text == st_simaticml.scl_text(element)
            # exports have no carriage returns; a template made by hand has
            outcomes["same text"] += through_tokens(text) == text.replace("\r\n", "\n")
    if not outcomes:
        pytest.skip("no corpus beside the repository")
    assert outcomes["opaque"] == 0
    assert outcomes["same text"] == outcomes["read"]
    # one template of another tool, in seven versions: blanks and line ends are tokens there
    assert outcomes["kept beside"] == 7


def read_and_written(content: str) -> tuple[dict[str, Any], etree._Element, etree._Element]:
    """A program as it is read, the element, and what is written from that."""
    element = etree.fromstring(f"<StructuredText>{content}</StructuredText>")
    fields = read_code(element, InterfaceNames({}))
    copy = etree.Element("StructuredText")
    hints = fields.get("extension_data", {}).get("attributes", {})
    write_text(copy, fields["text"], InterfaceNames({}), "de-DE", hints)
    return fields, element, copy


def test_labels_and_jumps() -> None:
    content = """<Access Scope="Label" UId="21"><Label Name="Again" UId="22"><Token Text=":" UId="23" /></Label>
    </Access>
    <Blank UId="24" /><Token Text="GOTO" UId="25" /><Blank UId="26" />
    <Access Scope="Label" UId="27"><Label Name="Again" UId="28" /></Access><Token Text=";" UId="29" />"""
    fields, element, copy = read_and_written(content)
    assert fields == {"text": "Again: GOTO Again;"}
    assert same_content(element, copy)


def test_what_the_text_does_not_say_is_kept() -> None:
    content = """<Access Scope="LocalConstant" UId="21"><Constant Name="Init" UId="22" /></Access>
    <Blank UId="23" /><Access Scope="Call" UId="24"><Instruction Name="LIMIT" UId="25">
    <TemplateValue Name="value_type" Type="Type" UId="26">Real</TemplateValue>
    <Token Text="(" UId="27" /><Token Text=")" UId="29" /></Instruction></Access>"""
    fields, element, copy = read_and_written(content)
    assert fields["text"] == "#Init LIMIT()"
    assert "markup" not in fields
    assert same_content(element, copy)


def test_numbers_of_another_tool_come_back() -> None:
    fields, element, copy = read_and_written('<Token Text="RETURN" UId="1" /><Token Text=";" UId="7" />')
    assert fields["extension_data"]["attributes"] == {"UId numbers": "1 7"}
    renumber(copy, "1 7")
    assert same_content(element, copy)


def test_a_comment_in_several_languages_is_read_in_the_first_and_kept() -> None:
    content = """<Comment Inserted="true" UId="21"><MultiLanguageText Lang="de-DE" UId="22">ja</MultiLanguageText>
    <MultiLanguageText Lang="en-US" UId="23">yes</MultiLanguageText></Comment>"""
    fields, _, _ = read_and_written(content)
    assert fields["text"] == "(/*ja*/)"
    assert "yes" in fields["markup"]


def test_an_edit_of_a_text() -> None:
    data = (FIXTURES / "FB_Motor.xml").read_bytes()
    project = sfc.loads(data)
    (body,) = project.pous[0].bodies
    assert isinstance(body, StBody)
    assert body.markup is None
    assert body.text.startswith('"Motor" := #Enable AND NOT "Stop";\n')
    body.text = body.text.replace("+ 1", "+ 2")
    edited = sfc.dumps(project)
    assert len(edited) == len(data)
    assert sfc.loads(edited) == project


def test_constants_of_the_block_are_known_by_its_interface() -> None:
    """Where the scope says what the interface does, nothing is kept of it."""
    root = etree.Element("StructuredText")
    write_text(root, "#Speed := #LIMIT; #other := #LIMITS;", InterfaceNames({}, frozenset({"#limit"})), "")
    found = [(access.get("Scope"), [part.get("Name") for part in access.iter()][-1]) for access in root.iter("Access")]
    assert found == [
        ("LocalVariable", "Speed"),
        ("LocalConstant", "LIMIT"),
        ("LocalVariable", "other"),
        ("LocalVariable", "LIMITS"),
    ]
    assert "extension_data" not in read_code(root, InterfaceNames({}, frozenset({"#limit"})))
    assert read_code(root, InterfaceNames({}))["extension_data"]["attributes"]["operand #LIMIT"] == "LocalConstant"
