"""Charts in actions for matiec and Beremiz: function blocks that the actions call, or a reason why not."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.analysis import equivalent
from plcopen_sfc.report import CHART_OF_ACTION, Outcome
from plcopen_sfc.semantics.profile import PROFILES
from tests.judges.matiec import require_matiec

FIXTURES = Path(__file__).parents[2] / "fixtures"
TEXT = """{{plcopen_sfc format := 1}}
{{plcopen_sfc project.dialect := '{dialect}'}}
VAR_GLOBAL
    lamp : BOOL;
END_VAR
FUNCTION_BLOCK FB_Count
VAR_INPUT up : BOOL; END_VAR
VAR_OUTPUT n : INT; END_VAR
IF up THEN n := (n + 1) MOD 3; END_IF;
END_FUNCTION_BLOCK
PROGRAM Main
VAR_INPUT a : BOOL; b : BOOL; END_VAR
VAR_OUTPUT q : BOOL; r : BOOL; n : INT; END_VAR
VAR CONSTANT LIMIT : INT := 2; END_VAR
VAR count : FB_Count; other : FB_Count; wait : TON; END_VAR
INITIAL_STEP Idle: Timers(N); END_STEP
TRANSITION FROM Idle TO Work := a; END_TRANSITION
STEP Work: Inner(N); END_STEP
TRANSITION FROM Work TO Idle := {left}; END_TRANSITION
ACTION Timers: wait(IN := a, PT := T#20ms); {timers} END_ACTION
ACTION Inner:
INITIAL_STEP One: END_STEP
TRANSITION FROM One TO Two := {goes}; END_TRANSITION
STEP Two: {rows} END_STEP
TRANSITION FROM Two TO One := b; END_TRANSITION
END_ACTION
ACTION Add: {add} END_ACTION
END_PROGRAM
"""
USUAL = {"left": "b", "timers": "", "goes": "a", "rows": "r(N);", "add": "n := (n + 1) MOD 3;"}
SAME = {
    "a variable": {},
    "an action of the block": {"rows": "Add(N);"},
    "a constant": {"goes": "n < LIMIT", "rows": "Add(P); r(N);"},
    "a global variable": {"rows": "lamp(N); Add(N);", "add": "r := lamp;"},
    "an instance of its own": {"rows": "Add(N);", "add": "count(up := a); n := count.n;"},
    "an instance that others call": {"goes": "wait.Q"},
    "its step asked for outside": {"left": "Two.X"},
    "an output that others count": {"rows": "r(N); Add(N);", "timers": "n := (n + 2) MOD 3;"},
}
REFUSED = {
    "a step around it": ({"goes": "Idle.X"}, "it names idle of the block around it"),
    "the time of its step": (
        {"left": "Two.T > T#20ms"},
        "more than the flag of its step two is asked for outside of it",
    ),
    "its initial step": ({"left": "One.X"}, "more than the flag of its step one is asked for outside of it"),
    "an action that others execute": (
        {"rows": "Timers(N);"},
        "the action timers is executed by others, too",
    ),
    "an instance that both call": (
        {"rows": "Add(N);", "add": "count(up := a);", "timers": "count(up := b);"},
        "the instance count is called in it, and used by others, too",
    ),
    "an input": ({"rows": "b(N);"}, "it writes b, which is an input"),
}


def source(dialect: str, **changed: str) -> sfc.Project:
    return sfc.loads(TEXT.format(dialect=dialect, **USUAL | changed).encode(), format="iec-text")


@pytest.mark.parametrize("dialect", ["iec", "codesys"])
@pytest.mark.parametrize("changed", SAME.values(), ids=SAME)
def test_a_block_does_what_the_chart_of_the_action_did(dialect: str, changed: dict[str, str]) -> None:
    """Under one tool's rules for both sides, for the report has what the tools do otherwise."""
    project = source(dialect, **changed)
    data, report = sfc.convert(project, "iec-text", flavour="matiec", partial=True)
    assert not report.with_outcome(Outcome.NOT_EXECUTED)
    assert (CHART_OF_ACTION in {item.what for item in report.losses}) is (dialect == "codesys")
    result = sfc.loads(data, format="iec-text", as_tool=True)
    assert result.pou("Main_Inner").chart is not None
    rules = (PROFILES[dialect], PROFILES[dialect])
    verdict = equivalent(project.pou("Main"), result.pou("Main"), rules, outputs=["q", "r", "n"], cap=1000)
    assert verdict.equal, verdict


@pytest.mark.parametrize(("target", "flavour"), [("iec-text", "matiec"), ("plcopen-2.01", "beremiz")])
@pytest.mark.parametrize(("changed", "why"), REFUSED.values(), ids=REFUSED)
def test_where_no_block_does_the_same_the_report_tells_why(
    target: str, flavour: str, changed: dict[str, str], why: str
) -> None:
    data, report = sfc.convert(source("iec", **changed), target, flavour=flavour, partial=True)
    told = [item.why for item in report.with_outcome(Outcome.NOT_EXECUTED) if item.what == "chart"]
    assert told == [f"no function block can have its chart: {why}"]
    assert b"NOT_EXECUTED_Inner" in data
    assert {pou.name for pou in sfc.loads(data, format=target, as_tool=True).pous} == {"Main", "FB_Count"}


@pytest.mark.parametrize("changed", SAME.values(), ids=SAME)
def test_beremiz_gets_the_same_blocks(changed: dict[str, str]) -> None:
    project = source("iec", **changed)
    data, report = sfc.convert(project, "plcopen-2.01", flavour="beremiz", partial=True)
    assert not report.with_outcome(Outcome.NOT_EXECUTED)
    result = sfc.loads(data, as_tool=True)
    rules = (PROFILES["iec"], PROFILES["iec"])
    assert equivalent(project.pou("Main"), result.pou("Main"), rules, outputs=["q", "r", "n"], cap=1000).equal


@pytest.mark.parametrize("changed", SAME.values(), ids=SAME)
def test_matiec_compiles_the_blocks_and_runs_them_as_they_are_read(changed: dict[str, str], tmp_path: Path) -> None:
    data, _ = sfc.convert(source("iec", **changed), "iec-text", flavour="matiec", partial=True)
    read = sfc.loads(data, format="iec-text", as_tool=True)
    inputs = [{"a": scan % 5 > 1, "b": scan % 7 > 4} for scan in range(60)]
    names = ["q", "r", "n", "Idle.X", "Work.X"]
    compiled = require_matiec().build(data.decode(), tmp_path).run(inputs, watch=names)
    trace = sfc.simulate(
        read,
        pou="Main",
        scans=60,
        inputs=lambda scan, _: inputs[scan],
        record=names,
        profile="matiec",
        scan_time="20ms",
    )
    assert [[row[name] for name in names] for row in compiled] == [
        [trace[name][scan] for name in names] for scan in range(60)
    ]


def test_the_conveyor_is_executed_whole_for_beremiz() -> None:
    source = sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml")
    data, report = sfc.convert(source, "plcopen-2.01", flavour="beremiz", limit=0)
    assert not report.with_outcome(Outcome.NOT_EXECUTED)
    read = sfc.loads(data, as_tool=True)
    assert read.pou("PLC_PRG_ACT_Home").chart is not None
    assert "ACT_Home_chart.Clear_ACT_Home_X" in data.decode()
