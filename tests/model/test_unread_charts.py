"""Charts are read when they are first looked at, which no script sees."""

from __future__ import annotations

import copy
import pickle
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.model import Project, SfcBody, SfcNetwork

CONVEYOR = Path(__file__).parents[2] / "fixtures" / "codesys" / "sorting_conveyor.xml"


def unread(project: Project) -> list[SfcBody]:
    return [body for _, _, body in project.bodies() if isinstance(body, SfcBody) and body.chart.is_unread]


def test_loading_and_saving_unedited_read_no_chart() -> None:
    project = sfc.load(CONVEYOR)
    assert len(unread(project)) == 3
    assert sfc.dumps(project) == CONVEYOR.read_bytes()
    assert len(unread(project)) == 3


def test_an_edit_reads_only_the_chart_that_it_is_in() -> None:
    project = sfc.load(CONVEYOR)
    chart = project.pou("FB_Pusher").sfc
    assert chart is not None
    chart.steps[0].comment = "starts here"
    assert sfc.dumps(project) != CONVEYOR.read_bytes()
    assert len(unread(project)) == 2


def test_a_chart_that_is_shown_is_not_empty() -> None:
    chart = sfc.load(CONVEYOR).pou("FB_Pusher").chart
    assert repr(chart).startswith("SfcNetwork(steps=[")


@pytest.mark.slow
def test_read_and_unread_projects_are_equal() -> None:
    one, other = sfc.load(CONVEYOR), sfc.loads(sfc.dumps(sfc.load(CONVEYOR), fresh=True))
    for chart in one.charts():
        assert chart.chart.steps
    assert one == other


def test_another_field_of_an_unread_body_can_be_set() -> None:
    project = sfc.load(CONVEYOR)
    body = unread(project)[0]
    body.comment = "checked"
    assert body.chart.steps
    assert body.comment == "checked"


def test_a_chart_put_in_place_of_an_unread_one_is_an_edit() -> None:
    project = sfc.load(CONVEYOR)
    body = unread(project)[0]
    body.chart = SfcNetwork()
    body.chart.add_step("Only", initial=True)
    back = sfc.loads(sfc.dumps(project))
    name = next(name for name, _, b in project.bodies() if b is body)
    assert [s.name for n, _, b in back.bodies() if n == name and isinstance(b, SfcBody) for s in b.chart.steps] == [
        "Only"
    ]


def test_copies_and_pickles_have_their_charts() -> None:
    project = sfc.load(CONVEYOR)
    copied = copy.deepcopy(project)
    assert copied == project
    assert sfc.dumps(copied) == CONVEYOR.read_bytes()
    again = pickle.loads(pickle.dumps(sfc.load(CONVEYOR)))  # noqa: S301  # our own bytes
    assert again == project
    again.pou("FB_Pusher").sfc.steps[0].comment = "edited after pickling"
    assert sfc.loads(sfc.dumps(again)) == again


def test_bodies_that_change_places_keep_their_charts() -> None:
    project = sfc.load(CONVEYOR)
    first, second = (pou for pou in project.pous if pou.sfc is not None)
    first.bodies, second.bodies = second.bodies, first.bodies
    back = sfc.loads(sfc.dumps(project))
    assert back == project
