"""Tasks and CoDeSys 2.3, whose controller executes PLC_PRG in every cycle where no task is configured."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.report import ConversionReport, Outcome
from tests.samples import FIXTURES

PROGRAMS = """PROGRAM Main VAR n : INT; END_VAR n := n + 1; END_PROGRAM
PROGRAM Other VAR n : INT; END_VAR n := n + 2; END_PROGRAM
{more}
CONFIGURATION C RESOURCE R ON PLC {tasks} END_RESOURCE END_CONFIGURATION
"""
ONE = "TASK t({}PRIORITY := 1); PROGRAM Main WITH t : Main; PROGRAM Other WITH t : Other;"


def converted(tasks: str, more: str = "") -> tuple[m.Project, m.Project, ConversionReport]:
    """What CoDeSys 2.3 reads, what this package reads, and the report."""
    source = sfc.loads(PROGRAMS.format(tasks=tasks, more=more).encode(), format="iec-text")
    data, report = sfc.convert(source, "codesys23", partial=True)
    return sfc.loads(data, format="codesys23", as_tool=True), sfc.loads(data, format="codesys23"), report


def test_plc_prg_calls_the_programs_of_a_task_in_their_order() -> None:
    read, back, report = converted(ONE.format(""))
    assert report.losses == []
    (body,) = read.pou("PLC_PRG").bodies
    assert isinstance(body, m.StBody)
    assert body.text.split() == ["Main();", "Other();"]
    trace = sfc.simulate(read, pou="PLC_PRG", scans=3, record=["Main.n", "Other.n"])
    assert (trace["Main.n"][-1], trace["Other.n"][-1]) == (3, 6)
    assert "PLC_PRG" not in {pou.name for pou in back.pous}
    assert [task.name for resource in back.resources() for task in resource.tasks] == ["t"]


def test_the_cycle_time_is_told() -> None:
    _, _, report = converted(ONE.format("INTERVAL := T#20ms, "))
    (item,) = report.losses
    assert (item.outcome, item.path) == (Outcome.APPROXIMATED, "task t")
    assert "T#20ms" in item.why


@pytest.mark.parametrize(
    ("tasks", "more"),
    [
        ("TASK s(PRIORITY := 1); PROGRAM Main WITH s : Main; TASK t(PRIORITY := 2); PROGRAM Other WITH t : Other;", ""),
        (ONE.format("SINGLE := go, "), ""),
        ("TASK t(PRIORITY := 1); PROGRAM a WITH t : Main; PROGRAM b WITH t : Main;", ""),
        (ONE.format(""), "PROGRAM PLC_PRG VAR n : INT; END_VAR n := 1; END_PROGRAM"),
    ],
    ids=["two tasks", "an event", "two instances", "another PLC_PRG"],
)
def test_tasks_that_no_program_replaces_are_not_executed(tasks: str, more: str) -> None:
    read, _, report = converted(tasks, more)
    assert "task" in {item.what for item in report.with_outcome(Outcome.NOT_EXECUTED)}
    assert len(read.pous) == 2 + bool(more)


@pytest.mark.parametrize("target", ["codesys", "plcopen-2.01", "simaticml"])
def test_plc_prg_of_an_export_without_tasks_is_executed_elsewhere(target: str) -> None:
    program = sfc.loads(b"PROGRAM PLC_PRG VAR n : INT; END_VAR n := n + 1; END_PROGRAM", format="iec-text")
    program.dialect = m.Dialect.CODESYS
    export = sfc.loads(sfc.dumps(program, format="codesys23"), format="codesys23", as_tool=True)
    data, report = sfc.convert(export, target)
    assert report.losses == []
    read = sfc.loads(data, format=target, as_tool=True)
    called = [instance.name for resource in read.resources() for instance in resource.every_instance()]
    called += [pou.name for pou in read.pous if pou.kind is m.PouKind.ORGANIZATION_BLOCK]
    assert called == [{"simaticml": "MainTask"}.get(target, "PLC_PRG")]


@pytest.mark.parametrize("target", ["codesys", "plcopen"])
def test_the_task_that_other_tools_get_does_not_come_home(target: str) -> None:
    """It came back in a comment, as a task that the project had not had; lists of variables went to the front."""
    belt = sfc.load(FIXTURES / "codesys23" / "distribution_belt.EXP")
    data, report = sfc.convert(belt, target, partial=True)
    away = sfc.loads(data)
    assert [task.name for task in away.tasks()] == ["MainTask"]
    home, report = sfc.convert(away, "codesys23", partial=True)
    assert str(sfc.diff(belt, sfc.loads(home))) == "no differences"
    assert not report.losses
    assert b"plcopen_sfc configurations" not in home
    places = [home.index(word) for word in (b"PROGRAM Ablauf", b"PROGRAM PLC_PRG", b"GLOBAL_VARIABLE_LIST")]
    assert places == sorted(places)
    away.tasks()[0].settings.kind, away.tasks()[0].settings.interval = "Cyclic", "t#10ms"
    assert b"plcopen_sfc configurations" in sfc.convert(away, "codesys23", partial=True)[0]
