"""Tasks of engineers: each takes at most three lines, or one command."""

from __future__ import annotations

from collections.abc import Callable

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import jump, step
from plcopen_sfc.model import SfcNetwork
from tests.samples import FIXTURES

SORTING = FIXTURES / "codesys" / "sorting_conveyor.xml"


def plant_standard(project: sfc.Project, chart: SfcNetwork) -> bool:
    """Name all steps by the standard of the plant, number them by tens, supervise each that drives the belt."""
    with project.edit() as edit:
        edit.renumber(10, 10, names="S{number:03}_{name}")
        edit.set(project.steps(drives="*Belt*"), max_time="T#30s")
    return chart.step("S010_Init").max_time == "T#30s" and chart.step("S030_Idle").max_time is None


def missing_times(project: sfc.Project, chart: SfcNetwork) -> bool:
    """List the steps that drive something and have no maximum time."""
    names = [each.name for each in project.steps(drives="*", max_time=None)]
    return "PartDone" in names and "Homing" not in names


def emergency_exit(project: sfc.Project, chart: SfcNetwork) -> bool:
    """Let every step of a chart that is reached from Idle leave for Fault when the guard opens."""
    with project.edit() as edit:
        for each in chart.find(lambda s: not s.initial, reachable_from="Idle", name="S*"):
            edit.add_branch(each, "GVL_IO.B9_Guard", jump("Fault"))
    return all(chart.step("Fault") in each.successors for each in chart.find(name="S*"))


def shared_condition(project: sfc.Project, chart: SfcNetwork) -> bool:
    """Give the same condition of several transitions one name."""
    same = [each for each in chart.transitions if getattr(each.condition, "text", "") == "bFault"]
    for each in same or chart.transitions[1:2]:
        project.edit().extract_condition(each, "IsFaulty")
    return len(project.pou("PLC_PRG").transitions) == 1


def slower_start(project: sfc.Project, chart: SfcNetwork) -> bool:
    """Put a step of two seconds behind the first one."""
    project.edit().insert_step("Warn", chart.outgoing(chart.step("Init"))[0], "Warn.t > T#2s", actions=["N xHorn"])
    return [each.name for each in chart.step("Warn").successors] == ["Homing"]


def one_output_less(project: sfc.Project, chart: SfcNetwork) -> bool:
    """Replace a variable by another, and remove it."""
    edit = project.edit(clean=True)
    edit.replace_variable("PLC_PRG.bMeasure", "PLC_PRG.bBeltRun")
    return edit.removed == ["PLC_PRG.bMeasure"] and project.find("bMeasure") == []


def left_over(project: sfc.Project, chart: SfcNetwork) -> bool:
    """Remove what nothing uses any more."""
    return project.edit().remove_unused() == ["PLC_PRG.tHorn"]


def from_other_project(project: sfc.Project, chart: SfcNetwork) -> bool:
    """Put a chart of another project into this one, under another name."""
    other = sfc.Project(name="Library", dialect=project.dialect)
    other.add_function_block(
        "FB_Lamp", step("Off", initial=True), "xOn", step("On", actions=["N qLamp"]), "NOT xOn", jump("Off")
    )
    return project.edit().copy_pou(other, "FB_Lamp", {"FB_Lamp": "FB_Beacon"}).name == "FB_Beacon"


UNDECLARED = {"'B9_Guard' is no member of what is before it"}
"""Names in the tasks that the project lacks on purpose."""

TASKS = [
    plant_standard,
    missing_times,
    emergency_exit,
    shared_condition,
    slower_start,
    one_output_less,
    left_over,
    from_other_project,
]


@pytest.mark.parametrize("task", TASKS, ids=lambda task: task.__name__)
def test_a_task_is_done_and_saved(task: Callable[[sfc.Project, SfcNetwork], bool]) -> None:
    project = sfc.load(SORTING)
    chart = project.pou("PLC_PRG").chart
    assert chart is not None
    assert task(project, chart)
    # CODESYS has no exits of parallel branches, and would try them before the join, which the project tries first
    data, report = sfc.convert(project, "codesys", partial=True)
    assert {item.what for item in report.losses} == (
        {"order of transitions", "chart"} if task is emergency_exit else set()
    )
    saved = sfc.loads(data)
    assert sorted(each.name for each in saved.steps()) == sorted(each.name for each in project.steps())
    assert (
        sfc.check(saved, select=["VAR01"]) == sfc.check(sfc.load(SORTING), select=["VAR01"]) or task is emergency_exit
    )
