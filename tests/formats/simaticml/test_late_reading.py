"""Objects of a document are read when a script first looks at them, and no script sees that."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import plcopen_sfc as sfc
from plcopen_sfc.model import Project
from plcopen_sfc.model.late import ProjectObject
from tests.documents.exports import FIXTURES, block
from tests.sweeps import examples

PATHS = sorted(FIXTURES.glob("*.xml"))
by_name = pytest.mark.parametrize("path", PATHS, ids=lambda path: path.name)


def only(project: Project) -> ProjectObject:
    """The one object of a project."""
    (thing,) = project.objects()
    return thing


@by_name
def test_loading_reads_no_object(path: Path) -> None:
    project = sfc.load(path)
    assert only(project).is_unread
    assert sfc.dumps(project) == path.read_bytes()
    assert only(project).is_unread
    _ = only(project).name
    assert only(project).is_unread
    _ = only(project).comment
    assert not only(project).is_unread


@by_name
def test_a_read_object_is_still_unedited(path: Path) -> None:
    project = sfc.load(path)
    project.read_all()
    assert sfc.convert(project, "simaticml")[1].unchanged


@by_name
def test_copies_and_pickles_are_equal(path: Path) -> None:
    ways: list[Callable[[Any], Any]] = [copy.deepcopy, copy.copy, lambda thing: pickle.loads(pickle.dumps(thing))]  # noqa: S301
    for make in ways:
        project, other = sfc.load(path), sfc.load(path)
        assert make(project) == other
        assert make(only(project)) == only(other)


@by_name
def test_a_name_given_before_reading_stays(path: Path) -> None:
    project = sfc.load(path)
    thing = only(project)
    thing.name += "_x"
    assert thing.is_unread
    assert sfc.dumps(project) != path.read_bytes()
    thing.read()
    assert thing.name.endswith("_x")
    thing.name = thing.name.removesuffix("_x")
    assert sfc.dumps(project) == path.read_bytes()


@by_name
def test_an_assignment_reads_the_rest(path: Path) -> None:
    project, other = sfc.load(path), sfc.load(path)
    only(project).comment = None
    assert not only(project).is_unread
    _ = only(other).comment
    only(other).comment = None
    assert project == other


@by_name
def test_unread_and_read_projects_serialise_alike(path: Path) -> None:
    one, other = sfc.load(path), sfc.load(path)
    other.read_all()
    assert one.model_dump_json() == other.model_dump_json()


DAMAGED = (
    '{"kind": "nonsense"}',
    '{"actions": [{"name": 5}]}',
    '{"interface": {"x": 1}}',
    '{"interface": 5}',
    '{"extension_data": 5}',
    '{"extension_data": null}',
    '{"extension_data": {"data": 7}}',
    '{"attributes": 3}',
    "[1, 2",
)


@pytest.mark.parametrize("fields", DAMAGED)
def test_carried_fields_that_do_not_fit_cost_nothing(fields: str) -> None:
    """They are left out with a warning, wherever they stand, and stay in the file."""
    data = block("X", comment=f"<!--plcopen_sfc {fields}-->")
    inside = block("X").replace(b'Datatype="Bool" />', f'Datatype="Bool"><!--plcopen_sfc {fields}--></Member>'.encode())
    for content in (data, inside):
        project = sfc.loads(content)
        assert {found.code for found in project.diagnostics} == {"XML208"}
        assert sfc.dumps(project) == content
        project.data_blocks[0].number = 77
        assert sfc.dumps(project) == content.replace(b"<Number>1<", b"<Number>77<")


def test_the_folder_that_a_file_names_itself() -> None:
    project = sfc.loads(block("X", comment='<!--plcopen_sfc {"folder": "A/B"}-->'))
    assert project.data_blocks[0].folder == "A/B"
    project.data_blocks[0].folder = "C"
    assert b'{"folder": "C"}' in sfc.dumps(project)


@settings(deadline=None, max_examples=examples(30))
@given(st.lists(st.sampled_from(["name", "read", "number", "comment", "copy", "save"]), max_size=6))
def test_any_order_of_looking_and_editing_gives_the_same(deeds: list[str]) -> None:
    """An object that was read first and one that was not are the same after the same edits."""
    late, early = sfc.loads(block("X")), sfc.loads(block("X"))
    early.read_all()
    for index, deed in enumerate(deeds):
        for project in (late, early):
            thing = project.data_blocks[0]
            if deed == "name":
                thing.name = f"N{index}"
            elif deed == "number":
                thing.number = index + 5
            elif deed == "comment":
                thing.comment = f"c{index}"
            elif deed == "copy":
                project.data_blocks[0] = copy.deepcopy(thing)
            elif deed == "save":
                sfc.dumps(project)
            elif project is late:
                thing.read()
    assert sfc.dumps(late) == sfc.dumps(early)
    assert late == early
