"""Unedited files come back byte for byte, however they are written; an edited one keeps its handwriting."""

from __future__ import annotations

import copy
import io
from collections.abc import Sequence
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.model.project import Project
from tests.samples import (
    ALL_PARAMS,
    NEW,
    assert_only_names_changed,
    charts_in,
    label,
    name_places,
    outline,
    params,
    variants,
)
from tests.sweeps import in_turn

SMALL = 30_000
"""Files up to this size, of which each format has some, are tried in every handwriting; bigger ones in two."""
FILES = [param.values[0] for param in ALL_PARAMS]


def one_with_steps(project: Project) -> int | None:
    """The number of the first chart that has a named step."""
    return next(
        (n for n, chart in enumerate(project.charts()) if chart.chart.steps and chart.chart.steps[-1].name), None
    )


@pytest.mark.parametrize("path", ALL_PARAMS)
def test_unedited_files_come_back_byte_for_byte(path: Path) -> None:
    data = path.read_bytes()
    project = sfc.load(path)
    assert sfc.dumps(project) == data
    target = io.BytesIO()
    report = sfc.save(project, target)
    assert target.getvalue() == data
    assert report.unchanged
    assert not report.losses


def handwritings(path: Path) -> Sequence[tuple[str, bytes]]:
    """A file in other handwritings: a small one in all of them, a bigger one in two, the next file in two others."""
    data = path.read_bytes()
    made = list(variants(data).items())
    assert len(made) >= 11
    return made if len(data) <= SMALL else in_turn(made, FILES.index(path), 2)


@pytest.mark.slow
@pytest.mark.parametrize("path", params(0))
def test_every_handwriting_of_a_file_is_read_alike_and_comes_back(path: Path) -> None:
    data = path.read_bytes()
    original = sfc.loads(data)
    for name, variant in handwritings(path):
        project = sfc.loads(variant)
        assert project == original, f"{name}: {label(path)}"
        assert [d.code for d in project.diagnostics] == [d.code for d in original.diagnostics], name
        assert sfc.dumps(project) == variant, name


@pytest.mark.slow
@pytest.mark.parametrize("path", params(1))
def test_renaming_a_step_keeps_the_handwriting(path: Path) -> None:
    data = path.read_bytes()
    original = sfc.loads(data)
    number = one_with_steps(original)
    if number is None:
        pytest.skip("this file has no chart")
    for name, variant in handwritings(path):
        project = sfc.loads(variant)
        chart = list(project.charts())[number].chart
        old = chart.steps[-1].name
        chart.steps[-1].name = NEW
        places = name_places(charts_in(outline(variant))[number], len(chart.steps) - 1)
        edited = sfc.dumps(project)
        assert_only_names_changed(variant, edited, old, places, note=name)
        assert sfc.loads(edited) == project, name


@pytest.mark.slow
@pytest.mark.parametrize("path", params(2))
def test_an_edit_taken_back_gives_the_old_file(path: Path) -> None:
    data = path.read_bytes()
    project = sfc.loads(data)
    number = one_with_steps(project)
    if number is None:
        pytest.skip("this file has no chart")
    step = list(project.charts())[number].chart.steps[-1]
    old, step.name = step.name, NEW
    edited = sfc.dumps(project)
    assert edited != data
    again = sfc.loads(edited)
    list(again.charts())[number].chart.steps[-1].name = old
    assert sfc.dumps(again) == data
    step.name = old
    assert sfc.dumps(project) == data


def test_a_copy_of_a_project_still_saves_as_the_same_file() -> None:
    path = ALL_PARAMS[-1].values[0] or ALL_PARAMS[0].values[0]
    assert isinstance(path, Path)
    project = copy.deepcopy(sfc.load(path))
    assert sfc.dumps(project) == path.read_bytes()
    assert sfc.dumps(project.model_copy(deep=True)) == path.read_bytes()
