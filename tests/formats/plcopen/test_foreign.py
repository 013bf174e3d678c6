"""Projects that come from elsewhere: what TC6 wants and they do not have, and what TC6 does not know."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.formats.plcopen.tc6_versions import validate_tc6
from plcopen_sfc.model import OpaqueBody, Pou, PouKind, Project

TARGETS = ["plcopen", "plcopen-2.0", "plcopen-1.01", "codesys"]


@pytest.mark.parametrize("target", TARGETS)
def test_a_body_of_another_format_is_carried(target: str) -> None:
    body = OpaqueBody(source="simaticml", content="<StatementList> & more")
    project = Project(pous=[Pou(name="Main", kind=PouKind.PROGRAM, bodies=[body])])
    data, report = sfc.convert(project, target, partial=True)
    back = sfc.loads(data)
    assert back.pous == project.pous
    assert {(item.outcome, item.what) for item in report.losses} == {(sfc.Outcome.NOT_EXECUTED, "code")}


@pytest.mark.parametrize("target", TARGETS)
def test_a_project_without_a_time_comes_back_without_one(target: str) -> None:
    data, report = sfc.convert(Project(name="New"), target)
    assert report.losses == []
    assert sfc.loads(data).header.created == ""
    assert b'creationDateTime="1970-01-01T00:00:00"' in data


def test_a_time_of_that_day_is_kept() -> None:
    project = Project()
    project.header.created = "1970-01-01T00:00:00Z"
    assert sfc.loads(sfc.dumps(project, format="plcopen")).header.created == "1970-01-01T00:00:00Z"


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("time", ["2007-07-07 11:58:26", "2007-07-07T11:58:26", "2007-13-07T11:58:26", "yesterday"])
def test_times_of_other_forms_are_written_as_the_schema_wants_them_and_come_back(time: str, target: str) -> None:
    project = Project(name="New", modified=time)
    project.header.created = time
    data = sfc.dumps(project, format=target)
    assert validate_tc6(data) == []
    back = sfc.loads(data)
    assert (back.header.created, back.modified) == (time, time)
    seen = sfc.loads(data, as_tool=True).header.created
    assert seen == (time.replace(" ", "T") if time.startswith("2007-07") else "")
