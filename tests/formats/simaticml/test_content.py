"""Documents whose content contradicts itself: what is wrong is said with its place, and nothing is lost."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from lxml import etree

import plcopen_sfc as sfc
from tests.formats.simaticml.documents import FIXTURES, parsed
from tests.formats.simaticml.test_damaged import lost
from tests.sweeps import some_of

DRILL = (FIXTURES / "FB_Drill.xml").read_bytes()
RELEASE = (FIXTURES / "FC_Release.xml").read_bytes()


def damaged(data: bytes, old: str, new: str) -> bytes:
    """`data` with the first match of the pattern `old` replaced."""
    found = re.sub(old.encode(), new.encode(), data, count=1)
    assert found != data
    return found


CASES = (
    ("XML220", RELEASE, r'<IdentCon UId="21" />', '<IdentCon UId="999" />', "the operand 999"),
    ("XML220", RELEASE, r'<NameCon UId="\d+" Name="in1" />', '<NameCon UId="998" Name="in1" />', "the element 998"),
    ("XML220", RELEASE, r'<Access Scope="GlobalVariable" UId="22">', '<Access Scope="LocalVariable" UId="21">', "'21'"),
    ("XML221", RELEASE, r"<Part Name=", "<Strange /><Part Name=", "Strange"),
    ("SFC113", DRILL, r'(Type="SimBegin" Cardinality)="2"', r'\1="5"', "has 2 paths, but its Cardinality is 5"),
    ("SFC113", DRILL, r'(Type="AltEnd" Cardinality)="\d+"', r'\1="9"', "paths, but its Cardinality is 9"),
    ("SFC109", DRILL, r'(<Step [^>]*Name)="Cool"', r'\1="Drill"', "'Drill'"),
    ("SFC109", DRILL, r'(<Transition [^>]*Name)="T_Deep"', r'\1="Drill"', "'Drill'"),
    ("SFC115", DRILL, r'<Part Name="TrCoil"', '<Part Name="SomeCoil"', "does not end in TrCoil"),
    ("SFC101", DRILL, r'(<Step Number)="2"', r'\1="1"', "the number 1"),
)


@pytest.mark.parametrize(("code", "data", "old", "new", "message"), CASES)
def test_a_contradiction_is_said_and_kept(code: str, data: bytes, old: str, new: str, message: str) -> None:
    changed = damaged(data, old, new)
    project = sfc.loads(changed, format="simaticml")
    project.read_all()
    found = [d for d in project.diagnostics if d.code == code]
    assert found
    assert any(message in d.message for d in found)
    assert all(d.location is not None and d.location.line for d in found)
    assert sfc.dumps(project) == changed
    if code != "SFC101":  # one of the two gets another number in a document that is written again
        assert not lost(changed, sfc.dumps(project, fresh=True))


def test_a_step_with_the_name_of_a_variable() -> None:
    member = '<Section Name="Static"><Member Name="drill" Datatype="Int" />'
    changed = damaged(DRILL, r'<Section Name="Static">', member)
    project = sfc.loads(changed)
    project.read_all()
    (found,) = [d for d in project.diagnostics if d.code == "SFC114"]
    assert "'Drill'" in found.message
    assert found.location is not None
    assert "step Drill" not in (found.location.path or "")


def test_its_own_member_is_no_clash() -> None:
    project = sfc.loads(DRILL)
    project.read_all()
    assert not project.diagnostics


@pytest.mark.slow
@pytest.mark.parametrize("path", sorted(FIXTURES.glob("*.xml")), ids=lambda path: path.name)
def test_unknown_attributes_of_every_kind_of_element_survive(path: Path) -> None:
    root = parsed(path.read_bytes())
    kinds: dict[tuple[str, str], etree._Element] = {}
    for element in root.iter(etree.Element):
        parent = element.getparent()
        kinds.setdefault((str(parent.tag) if parent is not None else "", str(element.tag)), element)
    for kind, element in some_of(list(kinds.items()), 6):
        element.set("Unknown", "7")
        data = etree.tostring(root)
        del element.attrib["Unknown"]
        project = sfc.loads(data, format="simaticml")
        assert not lost(data, sfc.dumps(project, fresh=True)), kind
