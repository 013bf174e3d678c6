"""Documents come back byte for byte without an edit, and with one the diff is that edit."""

from __future__ import annotations

import difflib
import re
from pathlib import Path
from typing import Any

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.model import Contact, FbdBody, LdBody, MultilingualText, Project, SfcNetwork, StBody, Tag
from tests.formats.simaticml.documents import ALL_PARAMS, FIXTURES, SOME_GRAPH_PARAMS

NEW = "Zz9_Neu"


def changed_lines(before: bytes, after: bytes) -> tuple[list[str], list[str]]:
    """The lines that went and those that came."""
    old, new = (data.decode("utf-8-sig").splitlines() for data in (before, after))
    lines = [line for line in difflib.unified_diff(old, new, n=0, lineterm="") if line[:3] not in ("---", "+++")]
    return [line[1:] for line in lines if line[0] == "-"], [line[1:] for line in lines if line[0] == "+"]


def those_with(pattern: bytes) -> list[Any]:
    """The documents with this in them."""
    found = re.compile(pattern, re.DOTALL)
    paths = [(param, param.values[0]) for param in ALL_PARAMS]
    return [param for param, path in paths if not isinstance(path, Path) or found.search(path.read_bytes())]


def first_chart(project: Project) -> SfcNetwork:
    chart = next((chart.chart for chart in project.charts() if chart.chart.steps), None)
    if chart is None:
        pytest.skip("the block has no steps")
    return chart


@pytest.mark.parametrize("path", ALL_PARAMS)
def test_unedited_documents_come_back_byte_for_byte(path: Path) -> None:
    data = path.read_bytes()
    project = sfc.load(path)
    assert project.source is not None
    assert project.source.format == "simaticml"
    assert sfc.dumps(project) == data
    project.read_all()
    assert sfc.dumps(project) == data


@pytest.mark.parametrize("path", SOME_GRAPH_PARAMS)
def test_renaming_a_step_changes_the_lines_that_name_it(path: Path) -> None:
    data = path.read_bytes()
    project = sfc.loads(data)
    chart = first_chart(project)
    old = chart.steps[-1].name
    chart.steps[-1].name = NEW
    edited = sfc.dumps(project)
    gone, come = changed_lines(data, edited)
    # the step, and the static member of its name where the export has one
    assert 1 <= len(gone) == len(come) <= 2
    assert [line.replace(f'"{old}"', f'"{NEW}"', 1) for line in gone] == come
    assert [step.name for step in first_chart(sfc.loads(edited)).steps] == [step.name for step in chart.steps]


@pytest.mark.parametrize("path", SOME_GRAPH_PARAMS)
def test_a_comment_of_a_transition_is_lines_of_its_own(path: Path) -> None:
    data = path.read_bytes()
    project = sfc.loads(data)
    chart = first_chart(project)
    transition = next((t for t in chart.transitions if t.comment is None), None)
    if transition is None:
        pytest.skip("every transition has a comment")
    transition.comment = MultilingualText(texts={"de-DE": "Füllen < Leeren", "en-US": "fill & empty"})
    edited = sfc.dumps(project)
    gone, come = changed_lines(data, edited)
    assert gone == []
    assert len(come) == 4
    assert first_chart(sfc.loads(edited)).transition(transition.id).comment == transition.comment


@pytest.mark.slow
@pytest.mark.parametrize("path", those_with(rb"<SW\.Blocks\.(?!\w*DB\b).*<Member "))
def test_renaming_a_variable_changes_one_line(path: Path) -> None:
    data = path.read_bytes()
    project = sfc.loads(data)
    variables = [v for pou in project.pous if pou.interface is not None for v in pou.interface.variables()]
    if not variables:
        pytest.skip("nothing is declared here but in data blocks")
    variables[0].name = NEW
    edited = sfc.dumps(project)
    gone, come = changed_lines(data, edited)
    assert len(gone) == len(come) == 1
    again = [v.name for pou in sfc.loads(edited).pous if pou.interface is not None for v in pou.interface.variables()]
    assert again == [v.name for v in variables]


@pytest.mark.slow
@pytest.mark.parametrize("path", those_with(rb'<Part Name="Contact"'))
def test_the_operand_of_a_contact(path: Path) -> None:
    """In a network that we write as TIA Portal does, the edit is the operand; any other is written again."""
    data = path.read_bytes()
    project = sfc.loads(data)
    bodies = [body for _, _, body in project.bodies() if isinstance(body, LdBody | FbdBody)]
    networks = [n for body in bodies for n in body.networks if n.extension_data is None or not n.extension_data.data]
    contacts = [node for network in networks for node in network.nodes if isinstance(node, Contact)]
    contact = next((contact for contact in contacts if contact.variable.startswith(("#", '"'))), None)
    if contact is None:
        pytest.skip("no contact")
    contact.variable = "#Zz9"
    edited = sfc.dumps(project)
    gone, come = changed_lines(data, edited)
    assert sum("UId=" in line for line in gone) <= 1  # all lines are of one operand, however long its path is
    assert len(come) <= 3
    assert [body for _, _, body in sfc.loads(edited).bodies()] == [body for _, _, body in project.bodies()]


@pytest.mark.parametrize("path", SOME_GRAPH_PARAMS)
def test_an_edit_taken_back_gives_the_old_file(path: Path) -> None:
    data = path.read_bytes()
    project = sfc.loads(data)
    chart = first_chart(project)
    old = chart.steps[0].name
    chart.steps[0].name = NEW
    again = sfc.loads(sfc.dumps(project))
    first_chart(again).steps[0].name = old
    assert sfc.dumps(again) == data


def test_an_inserted_tag_leaves_the_ids_of_the_others() -> None:
    path = FIXTURES / "tags.xml"
    data = path.read_bytes()
    project = sfc.loads(data)
    project.tag_tables[0].tags.insert(1, Tag(name="New", type="Bool", address="%I0.7"))
    edited = sfc.dumps(project)
    gone, come = changed_lines(data, edited)
    assert gone == []
    assert len(come) == 7
    again = sfc.loads(edited)
    assert again.tag_tables == project.tag_tables
    del again.tag_tables[0].tags[1]
    assert sfc.dumps(again) == data


@pytest.mark.parametrize("name", ["FC_Release.xml", "FB_Motor.xml"])
def test_a_network_put_in_front(name: str) -> None:
    data = (FIXTURES / name).read_bytes()
    project = sfc.loads(data)
    project.pous[0].bodies.insert(0, StBody(text="#a := 1;", title=MultilingualText(texts={"de-DE": "Neu"})))
    edited = sfc.dumps(project)
    gone, _ = changed_lines(data, edited)
    assert gone == []
    assert sfc.loads(edited).pous[0].bodies == project.pous[0].bodies
