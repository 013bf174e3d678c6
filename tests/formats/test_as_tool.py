"""Reading a file as the tool of its format sees it: nothing of what only this package reads."""

from __future__ import annotations

import codecs
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.documents.file_documents import as_tool_sees
from plcopen_sfc.documents.sources import FileSource
from plcopen_sfc.formats.registry import format_named
from plcopen_sfc.model.compare import differences
from tests.strategies import projects
from tests.sweeps import examples

TARGETS = ["plcopen-1.01", "plcopen-2.01", "codesys", "simaticml", "scl", "iec-text"]
FIXTURES = Path(__file__).parents[2] / "fixtures"
FILES = ["codesys/device_export.xml", "simaticml/FB_Drill.xml"]


def seen(content: bytes, target: str) -> bytes:
    return as_tool_sees(content, format_named(target)[0])


def has_ours(content: bytes) -> bool:
    """True if there are carriers in a file in which no text mentions them."""
    text = content.decode("utf-8-sig")
    for head in ("{plcopen_sfc format", "{plcopen_sfc project.dialect"):
        text = text.replace(head, "")
    return any(mark in text for mark in ("<!--plcopen_sfc ", "{plcopen_sfc ", 'name="urn:plcopen-sfc:'))


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("name", FILES)
def test_nothing_of_ours_is_left(name: str, target: str) -> None:
    content = sfc.dumps(sfc.load(FIXTURES / name), format=target, fresh=True, partial=True)
    left = seen(content, target)
    assert has_ours(content) or name.startswith(target.partition("-")[0])
    assert not has_ours(left)
    assert seen(left, target) == left
    assert left.count(b"\n") == content.count(b"\n"), "everything stays in its line"
    project = sfc.loads(content, format=target, as_tool=True)
    assert list(differences(project, sfc.loads(left, format=target))) == []
    assert isinstance(project.source, FileSource)
    assert project.source.content == left


@pytest.mark.slow
@settings(max_examples=examples(25))
@given(project=projects(), target=st.sampled_from(TARGETS))
def test_whatever_is_carried_is_not_seen(project: m.Project, target: str) -> None:
    content = sfc.dumps(project, format=target, partial=True)
    left = seen(content, target)
    assert not has_ours(left)
    assert seen(left, target) == left
    sfc.loads(left, format=target)
    if left == content:
        assert sfc.loads(content, format=target, as_tool=True) == sfc.loads(content, format=target)


TYPES = [m.ElementaryType(name=name) for name in (m.Elementary.BOOL, m.Elementary.INT, m.Elementary.TIME)]
names = st.from_regex(r"v[a-z0-9]{1,4}", fullmatch=True)


@st.composite
def plain_blocks(draw: st.DrawFn) -> m.Project:
    """Function blocks that every format can say: variables of elementary types, and statements."""
    pous = []
    for name in draw(st.lists(names, min_size=1, max_size=3, unique=True)):
        inputs = draw(st.lists(names, min_size=1, max_size=4, unique=True))
        variables = [m.Variable(name=each, type=draw(st.sampled_from(TYPES))) for each in inputs]
        text = "\n".join(f"{each} := {each};" for each in draw(st.lists(st.sampled_from(inputs), min_size=1)))
        sections = [m.VariableSection(kind=m.SectionKind.INPUT, variables=variables)]
        interface = m.Interface(sections=sections)
        bodies = [m.StBody(text=text)]
        pous.append(m.Pou(name=f"F{name}", kind=m.PouKind.FUNCTION_BLOCK, interface=interface, bodies=bodies))
    return m.Project(pous=pous)


@pytest.mark.slow
@settings(max_examples=examples(40))
@given(project=plain_blocks(), target=st.sampled_from(TARGETS))
def test_what_needs_no_carrying_is_read_as_always(project: m.Project, target: str) -> None:
    if target in ("scl", "simaticml"):
        project = sfc.loads(sfc.dumps(project, format="scl"))  # in its dialect
        project.header.product = "TIA Portal" if target == "simaticml" else ""
    content = sfc.dumps(project, format=target)
    assert seen(content, target) == content
    assert list(differences(sfc.loads(content, format=target, as_tool=True), sfc.loads(content, format=target))) == []


def test_texts_that_look_like_carriers_stay() -> None:
    text = (
        b"PROGRAM Main\nVAR s : STRING := '{plcopen_sfc x}'; END_VAR\n"
        b"s := '{plcopen_sfc y}'; // {plcopen_sfc z}\n(* {plcopen_sfc z} *)\nEND_PROGRAM\n"
    )
    assert seen(text, "iec-text") == text
    project = sfc.loads(text, format="iec-text")
    body = project.pous[0].bodies[0]
    assert isinstance(body, m.StBody)
    body.text = "x := '<!--plcopen_sfc {} -->'; // urn:plcopen-sfc: <data name="
    content = sfc.dumps(project, format="plcopen")
    assert seen(content, "plcopen") == content
    cdata = content.replace(b"x := '&lt;!--plcopen_sfc {} --&gt;'", b"<![CDATA[x := '<!--plcopen_sfc {} -->']]>")
    assert cdata != content
    assert seen(cdata, "plcopen") == cdata


@pytest.mark.parametrize("codec", ["utf-16-le", "cp1252"])
def test_in_other_encodings_too(codec: str) -> None:
    project = sfc.load(FIXTURES / FILES[0])
    text = sfc.dumps(project, format="plcopen-1.01", partial=True).decode()
    name = "UTF-16" if codec == "utf-16-le" else "windows-1252"
    declared = text.replace('encoding="utf-8"', f'encoding="{name}"', 1)
    assert declared != text
    mark = codecs.BOM_UTF16_LE if codec == "utf-16-le" else b""
    left = seen(mark + declared.encode(codec, "xmlcharrefreplace"), "plcopen")
    assert "<!--plcopen_sfc".encode(codec) not in left
    assert list(differences(sfc.loads(left), sfc.loads(text.encode(), as_tool=True))) == []


def test_what_is_no_file_is_said_as_always() -> None:
    with pytest.raises(sfc.FormatError, match=r"project"):
        sfc.loads(b'<project xmlns="http://www.plcopen.org/xml/tc6_0200"><!--plcopen_sfc {}-->', as_tool=True)
    assert sfc.loads(sfc.dumps(m.Project(name="a"), format="json"), as_tool=True).name == "a"


ADDED = {
    *("PRG_Pumps_DB", "GVL_IO", "MainTask", "E_PumpMode", "FB_Runtime_Reset"),
    *("PRG_Pumps_SelectPump_entry", "PRG_Pumps_Swap_entry"),
    # statements of main actions that ask the SFC flags
    *(f"PRG_Pumps_{step}_main" for step in ("CloseValve", "Pumping", "Standby", "StartPump1", "StartPump2")),
}
"""Features that only TIA Portal has: an instance, a list, a task, an enumeration, and functions of actions."""


@pytest.mark.slow
def test_a_folder_is_read_so_too(tmp_path: Path) -> None:
    sfc.save(sfc.load(FIXTURES / "codesys" / "device_export.xml"), f"{tmp_path}/plc/", format="simaticml", partial=True)
    whole, tool = (sfc.load(tmp_path / "plc", as_tool=each) for each in (False, True))
    things = [[*project.data_blocks, *project.tag_tables, *project.pous] for project in (whole, tool)]
    names = [{thing.name for thing in found} for found in things]
    assert (names[1] - names[0], names[0] - names[1]) == (ADDED, set())
    assert (whole.name, tool.name) == ("PumpStation.project", "")
