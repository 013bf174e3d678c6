"""Charts that look the same in the target and act otherwise: running both says so."""

from __future__ import annotations

import _thread
import io
import re
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.cli.app import run
from plcopen_sfc.conversion.chart_runs import SHIFTED
from plcopen_sfc.conversion.running import report_running
from plcopen_sfc.errors import ComparisonInterrupt, LossError, SfcError
from plcopen_sfc.pages.conversion_overview import ChartVerdict, verdict_of
from plcopen_sfc.pages.page_words import german
from plcopen_sfc.report import START_OF_CHART, ConversionReport, Outcome
from tests.corpus import corpus_files
from tests.samples import FIXTURES

CHART = """FUNCTION_BLOCK Main
VAR_INPUT a, b : BOOL{edge}; t : TIME; END_VAR
VAR_OUTPUT q : BOOL{initial}; m : INT; END_VAR
INITIAL_STEP S0: END_STEP
TRANSITION FROM S0 TO S1 := a; END_TRANSITION
STEP S1: {first} END_STEP
TRANSITION FROM S1 TO S2 := b; END_TRANSITION
STEP S2: {second} END_STEP
TRANSITION FROM S2 TO S0 := a; END_TRANSITION
{actions}
END_FUNCTION_BLOCK
"""
ACTIONS = {"Aa": "m := 1;", "Zz": "m := 2;", "Set": "q := TRUE;"}


def chart(first: str, second: str = "", initial: str = "", edge: str = "") -> sfc.Project:
    used = [f"ACTION {name}: {text} END_ACTION" for name, text in ACTIONS.items() if f"{name}(" in first + second]
    text = CHART.format(first=first, second=second, initial=initial, edge=edge, actions="\n".join(used))
    return sfc.loads(text.encode(), format="iec-text")


def saved(project: sfc.Project, target: str, **options: Any) -> ConversionReport:
    return sfc.save(project, io.BytesIO(), format=target, limit=6, **options)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("project", "target", "cause"),
    [
        (chart("q(D, t);"), "simaticml", "; while `t` stays T#1s, both are equal"),
        (chart("q(D, t);", "Set(N);"), "simaticml", "; while `t` stays T#1s: it does something else after"),
        (chart("q(N);", "Set(P1);"), "codesys", "a cause is the order of actions, which the report names"),
        (chart("q(N);", initial=" := TRUE"), "codesys", "q is written in every scan in the source and only while"),
        (chart("Zz(N); Aa(N);"), "codesys", "a cause is the order of actions, which the report names"),
    ],
    ids=[
        "a time that changes",
        "a time that changes, and more",
        "N and an assignment",
        "TRUE at the start",
        "order of actions",
    ],
)
def test_what_looks_the_same_and_acts_otherwise_is_approximated(project: sfc.Project, target: str, cause: str) -> None:
    report = saved(project, target)
    (item,) = [item for item in report.losses if item.what == "chart"]
    assert (item.outcome, item.path) == (Outcome.APPROXIMATED, "POU Main")
    assert "it does something else after" in item.why
    assert cause in item.why
    assert report.compared["POU Main"].startswith("different")
    assert german(item.why).startswith("es tut nach ")
    with pytest.raises(LossError):
        saved(project, target, strict=True)


@pytest.mark.parametrize("target", ["simaticml", "codesys", "plcopen-2.01"])
def test_conditions_with_the_time_of_a_step_are_proven_in_every_tool(target: str) -> None:
    project = chart("q(N);")
    transition = project.pous[0].chart.transitions[1]
    transition.condition = m.Expression(text="b AND S1.T >= T#500ms")
    verdict = saved(project, target).compared["POU Main"]
    assert verdict.startswith("equal")
    assert "(proof: " in verdict


SAMPLED = """ACTION Look: IF b AND m = 0 THEN m := 1; END_IF; IF NOT b AND m = 0 THEN m := 2; END_IF; END_ACTION"""


@pytest.mark.parametrize("target", ["codesys", "plcopen-2.01"])
def test_a_station_with_interlocks_supervisions_and_counters_is_proven(target: str) -> None:
    """As TIA users program one: what is not compared with each other is searched apart, whatever a counter counts."""
    project = sfc.Project(name="Plant")
    pou = project.add_function_block(
        "Station",
        sfc.step("Idle", initial=True, actions=["N Ready", "S1 R Trouble"]),
        "Start AND Auto",
        sfc.step("Feed", actions=["N Belt", "S1 N Count := Count + 1"], supervision="Jam", interlock="Guard"),
        "Part",
        sfc.step("Clamp", actions=["S Clamped", "C N ClampLamp", "V1 S Trouble"], interlock="Guard", supervision="Jam"),
        "Closed",
        sfc.simultaneous(
            [
                sfc.step(
                    "Drill", actions=["C N Drilling", "L1 S Stopped", "L0 R Stopped"], interlock="Guard AND NOT Over"
                ),
                "Deep",
                sfc.step("Up", actions=["N Lift"]),
            ],
            [
                sfc.step("Cool", actions=["D T#2s Pump", "S0 R Alarm"]),
                "Cold",
                sfc.step("Cooled", actions=["L T#3s Lamp"]),
            ],
        ),
        "Top",
        sfc.step("Check", actions=["S1 N Trigger", "N Lamp"]),
        sfc.selection(
            ["Ok", sfc.step("Good", actions=["S1 S IsGood"]), "TRUE"],
            ["Bad", sfc.step("Failed", actions=["S1 R IsGood", "S1 S Alarm"]), "Ack"],
        ),
        sfc.step("Open", actions=["R Clamped"]),
        "Opened",
        sfc.jump("Idle"),
    )
    pou.add_variable("Count", "INT", "output")
    source = sfc.loads(sfc.dumps(project, format="simaticml"))
    _, report = sfc.convert(source, target, limit="30s")
    (verdict,) = report.compared.values()
    assert re.search(r"equal.* \(proof: \d+ states in \d+ parts", verdict), verdict
    assert not report.untested
    assert all(item.outcome is not Outcome.NOT_EXECUTED for item in report.losses)


@pytest.mark.parametrize(
    ("first", "initial", "target", "why"),
    [
        ("Look(N);", "", "codesys", "CODESYS executes the actions before the transitions, and so sees other inputs"),
        (
            "",
            "q(S);",
            "codesys",
            "CODESYS executes the actions of the initial step in its first scan, and others a scan",
        ),
        ("", "q(S);", "simaticml", "TIA Portal tests no transition in its first scan"),
    ],
    ids=["an input read on entry", "a stored action of the initial step", "a first scan that waits"],
)
def test_inputs_of_the_entry_and_of_the_first_scan_are_no_constant_delay(
    first: str, initial: str, target: str, why: str
) -> None:
    text = CHART.format(first=first, second="", initial="", edge="", actions=SAMPLED if first else "")
    text = text.replace("INITIAL_STEP S0: ", f"INITIAL_STEP S0: {initial} ")
    report = saved(sfc.loads(text.encode(), format="iec-text"), target)
    (item,) = [item for item in report.losses if item.what == "chart"]
    assert item.outcome is Outcome.APPROXIMATED
    assert why in item.why
    first = report.compared["POU Main"].splitlines()[0]
    assert first.startswith("different after ")  # a proof alone would say the opposite
    assert first.endswith(SHIFTED)
    assert german(item.why).startswith("es tut nach ")


RACING = "IF S1.T >= T#20ms THEN m := m + 1; END_IF;"


@pytest.mark.parametrize("target", ["codesys", "twincat"])
@pytest.mark.parametrize(
    ("first", "body", "differs"),
    [
        ("q(DS, T#20ms);", "", True),
        ("q(D, T#20ms);", "", True),
        ("Run(N);", RACING, True),
        ("Run(N);", "m := m + 1;", True),  # as often as the step has scans
        ("q(DS, T#10ms);", "", False),
        ("q(DS, T#30ms);", "", False),
        ("q(L, T#20ms);", "", False),
        ("q(N);", "", False),
    ],
    ids=["DS", "D", "an action that asks for the time", "an action that counts", "earlier", "later", "L", "N"],
)
def test_what_waits_for_the_same_time_as_a_transition_is_told(
    first: str, body: str, target: str, *, differs: bool
) -> None:
    """It was equal: by the delay, actions see the times of the scan before. Where nothing races, it is still."""
    text = CHART.format(
        first=first, second="", initial="", edge="", actions=f"ACTION Run: {body} END_ACTION" * (body != "")
    )
    text = text.replace("S1 TO S2 := b", "S1 TO S2 := S1.T >= T#20ms")
    report = saved(sfc.loads(text.encode(), format="iec-text"), target)
    seen = report.compared["POU Main"].splitlines()[0]
    items = [item for item in report.losses if item.what == "chart"]
    if not differs:
        assert seen.startswith("equal, second 1 scan later (proof: ")
        assert not items
        return
    assert seen.startswith("different after ")
    assert seen.endswith(SHIFTED)
    (item,) = items
    assert item.outcome is Outcome.APPROXIMATED
    assert "executes the actions before the transitions" in item.why


BETWEEN = """INITIAL_STEP S0: END_STEP
TRANSITION FROM S0 TO S1 := a; END_TRANSITION
STEP S1: q(D, T#20ms); END_STEP
TRANSITION FROM S1 TO S2 := q; END_TRANSITION
TRANSITION FROM S1 TO S3 := S1.T >= T#20ms; END_TRANSITION
STEP S2: r(S); END_STEP
STEP S3: END_STEP
TRANSITION FROM S2 TO S0 := NOT a; END_TRANSITION
TRANSITION FROM S3 TO S0 := NOT a; END_TRANSITION
"""


def test_a_step_that_only_the_target_enters_is_told() -> None:
    """`S2: never reached (proven)` was true of the source, and by the delay: only CODESYS executes `q` before it."""
    text = (
        f"FUNCTION_BLOCK Main VAR_INPUT a : BOOL; END_VAR VAR_OUTPUT q, r : BOOL; END_VAR {BETWEEN}END_FUNCTION_BLOCK"
    )
    report = saved(sfc.loads(text.encode(), format="iec-text"), "codesys")
    assert report.compared["POU Main"].startswith("different after ")
    assert "never reached" not in report.compared["POU Main"]
    assert [item.what for item in report.losses] == ["chart"]


LATE = {
    "a long wait": "STEP S1: r(N); END_STEP TRANSITION FROM S1 TO S2 := S1.T >= T#2s; END_TRANSITION",
    "what never rests": (
        "STEP S1: r(N); END_STEP TRANSITION FROM S1 TO R1 := m < 40; END_TRANSITION "
        "STEP R1: Count(P1); END_STEP TRANSITION FROM R1 TO S1 := R1.T >= T#20ms; END_TRANSITION "
        "TRANSITION FROM S1 TO S2 := m >= 40; END_TRANSITION ACTION Count: m := m + 1; END_ACTION"
    ),
}


@pytest.mark.parametrize("first", [pytest.param(each, id=name) for name, each in LATE.items()])
def test_a_race_behind_many_scans_is_told(first: str) -> None:
    """The run ended after 100 scans, or as many states, and nothing said so."""
    text = f"""FUNCTION_BLOCK Main VAR_INPUT a : BOOL; END_VAR VAR_OUTPUT q, r : BOOL; m : INT; END_VAR
    INITIAL_STEP S0: END_STEP TRANSITION FROM S0 TO S1 := a; END_TRANSITION {first}
    STEP S2: q(DS, T#20ms); END_STEP TRANSITION FROM S2 TO S3 := S2.T >= T#20ms; END_TRANSITION
    STEP S3: END_STEP TRANSITION FROM S3 TO S0 := FALSE; END_TRANSITION END_FUNCTION_BLOCK"""
    report = saved(sfc.loads(text.encode(), format="iec-text"), "codesys")
    assert report.compared["POU Main"].startswith("different after ")
    assert "q is FALSE in the source and TRUE in CODESYS" in "".join(item.why for item in report.losses)


WITH_OUTPUT = """INITIAL_STEP S0: END_STEP TRANSITION FROM S0 TO S1 := a; END_TRANSITION
STEP S1: x(N); END_STEP TRANSITION FROM S1 TO S0 := NOT a; END_TRANSITION
"""


@pytest.mark.parametrize(
    ("reading", "differs"), [("p := m.x;", False), ("IF a AND NOT m.x THEN p := TRUE; END_IF;", True)]
)
def test_a_caller_that_sees_its_chart_late_is_told(reading: str, *, differs: bool) -> None:
    """The chart was proven, and nothing was said of the program that reads its output together with an input."""
    text = f"""FUNCTION_BLOCK A VAR_INPUT a : BOOL; END_VAR VAR_OUTPUT x : BOOL; END_VAR {WITH_OUTPUT}
    END_FUNCTION_BLOCK PROGRAM Main VAR_INPUT a : BOOL; END_VAR VAR_OUTPUT p : BOOL; END_VAR VAR m : A; END_VAR
    m(a := a); {reading} END_PROGRAM"""
    report = saved(sfc.loads(text.encode(), format="iec-text"), "codesys")
    assert report.compared["POU A"].startswith("equal, second 1 scan later (proof")
    found = [(item.outcome, item.path) for item in report.losses if item.what == "calls of charts"]
    assert found == [(Outcome.APPROXIMATED, "POU Main")] * differs
    assert all("in CODESYS sieht er" in german(item.why) for item in report.losses)


SUB = f"""FUNCTION_BLOCK A VAR_INPUT a : BOOL; END_VAR VAR_OUTPUT x : BOOL; END_VAR {WITH_OUTPUT} END_FUNCTION_BLOCK
"""
PULSED = {
    "IF a AND m.x THEN p := TRUE; END_IF;": {"codesys"},
    "IF a THEN m(a := a); IF m.x THEN p := TRUE; END_IF; END_IF;": {"codesys", "simaticml"},
    "IF a THEN n := n + 1; END_IF; IF n = 1 AND m.x THEN p := TRUE; END_IF;": {"codesys"},
    "IF n = 0 THEN m(a := TRUE); n := 1; END_IF; IF m.x THEN p := TRUE; END_IF;": {"codesys", "simaticml"},
    "m(a := a); m(a := a); IF a AND m.x THEN p := TRUE; END_IF;": set(),
    "g.s(a := a); IF a AND g.s.x THEN p := TRUE; END_IF;": {"codesys"},
    "p := m.x;": set(),
    "p := m.x OR a;": set(),
    "t(IN := m.x, PT := T#20ms); p := t.Q;": set(),
}
"""Code behind or around ``m(a := a)``, and the tools that do something else with a pulse of ``a``."""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("code", "target"),
    # a PLC data type has no instances of blocks: S7-GRAPH gets no structure with a chart
    [(code, tool) for code in PULSED for tool in ("codesys", "simaticml") if "g.s" not in code or tool == "codesys"],
)
def test_a_caller_that_needs_a_pulse_of_an_input_is_told(code: str, target: str) -> None:
    """Inputs stayed in the run of callers; those of S7-GRAPH, which holds the first call of a chart, were not run."""
    call = "" if "m(a" in code else "m(a := a);"
    holder, held = ("TYPE G : STRUCT s : A; END_STRUCT; END_TYPE", "g : G;") if "g.s" in code else ("", "")
    around = f"VAR_INPUT a : BOOL; END_VAR VAR_OUTPUT p : BOOL; END_VAR VAR m : A; {held} n : INT; t : TON; END_VAR"
    text = f"{holder} {SUB} PROGRAM Main {around} {call} {code} END_PROGRAM"
    report = saved(sfc.loads(text.encode(), format="iec-text"), target)
    assert report.compared["POU A"].startswith("equal")
    told = [item for item in report.losses if item.what == "calls of charts"]
    assert [item.path for item in told] == ["POU Main"] * (target in PULSED[code])
    assert all(german(item.why) != item.why for item in told)


def test_scans_with_which_a_caller_was_run_are_told_where_times_matter() -> None:
    """At 20 ms a file without a task does something else in CODESYS; it was run at 10 ms, and nothing said so."""
    around = "VAR_INPUT a : BOOL; END_VAR VAR_OUTPUT p : BOOL; END_VAR VAR m : A; t, u : TON; END_VAR"
    code = "t(IN := a, PT := T#30ms); m(a := t.Q); u(IN := a, PT := T#40ms); IF u.Q AND NOT m.x THEN p := TRUE; END_IF;"
    text = f"{SUB} PROGRAM Main {around} {code} END_PROGRAM"
    report = saved(sfc.loads(text.encode(), format="iec-text"), "codesys")
    assert report.losses == []
    assert "given: what calls it was run with scans of T#5ms, T#10ms: POU Main" in report.compared["POU A"]


@pytest.mark.parametrize("target", ["codesys", "plcopen-2.01"])
def test_a_caller_whose_input_has_another_name_gets_the_same_values(target: str) -> None:
    """It was run with two inputs, and called different, where a tool takes no spaces in names."""
    around = "VAR_INPUT go : BOOL; END_VAR VAR_OUTPUT p : BOOL; END_VAR VAR m : A; END_VAR"
    text = f"{SUB} FUNCTION_BLOCK Main {around} m(a := go); p := m.x; END_FUNCTION_BLOCK"
    made = sfc.dumps(sfc.loads(text.encode(), format="iec-text"), format="simaticml")
    source = sfc.loads(made, as_tool=True)
    source.rename("Main.go", "Start Knopf")
    report = saved(source, target)
    assert any("Start Knopf is called Start_Knopf" in item.why for item in report.items)
    assert [item for item in report.losses if item.what == "calls of charts"] == []


@pytest.mark.parametrize("tasks", ["one", "two", "none"])
def test_programs_that_share_what_a_chart_writes_are_run_together(tasks: str) -> None:
    """Of programs in tasks of their own, or in none, nothing was run, and nothing said so."""
    programs = "VAR_EXTERNAL a, x : BOOL; END_VAR"
    text = f"""PROGRAM One {programs} {WITH_OUTPUT} END_PROGRAM
    PROGRAM Two {programs} VAR_OUTPUT p : BOOL; END_VAR {{code}} END_PROGRAM
    CONFIGURATION C VAR_GLOBAL a, x : BOOL; END_VAR RESOURCE R ON PLC {{tasks}} END_RESOURCE END_CONFIGURATION"""
    one, two = "TASK Fast(INTERVAL := T#10ms, PRIORITY := 1);", "TASK Slow(INTERVAL := T#20ms, PRIORITY := 2);"
    instances = "PROGRAM I1 WITH Fast : One; PROGRAM I2 WITH {} : Two;"
    given = {"one": one + instances.format("Fast"), "two": one + two + instances.format("Slow"), "none": ""}
    path = {"one": "task Fast", "two": "tasks Fast, Slow", "none": "programs One, Two"}[tasks]
    for code, differs in (("IF a AND NOT x THEN p := TRUE; END_IF;", True), ("p := x;", False)):
        source = sfc.loads(text.format(code=code, tasks=given[tasks]).encode(), format="iec-text")
        report = saved(source, "codesys", partial=True)
        told = [(item.outcome, item.path) for item in report.losses if item.what == "calls of charts"]
        assert told == [(Outcome.APPROXIMATED, path)] * differs
        line = f"given: what calls it was not compared in all situations: {path}"
        assert (line in report.compared["POU One"]) is (tasks != "one" and not differs)


@pytest.mark.parametrize("target", ["codesys", "simaticml"])
def test_a_step_that_calls_a_chart_may_last_a_scan_longer(target: str) -> None:
    chart = """INITIAL_STEP S0: END_STEP TRANSITION FROM S0 TO S1 := a; END_TRANSITION STEP S1: Call(N); END_STEP
    TRANSITION FROM S1 TO S2 := m.x; END_TRANSITION STEP S2: q(S); END_STEP
    TRANSITION FROM S2 TO S0 := NOT a; END_TRANSITION ACTION Call: m(a := TRUE); END_ACTION"""
    around = "VAR_INPUT a : BOOL; END_VAR VAR_OUTPUT q : BOOL; END_VAR VAR m : A; END_VAR"
    report = saved(sfc.loads(f"{SUB} PROGRAM Main {around} {chart} END_PROGRAM".encode(), format="iec-text"), target)
    assert "\nin what both come to while inputs stay: equal" in report.compared["POU Main"]
    assert [item.outcome for item in report.losses if item.what == "chart"] == [Outcome.APPROXIMATED]


def test_a_caller_of_an_instance_data_block_is_run() -> None:
    around = "VAR_INPUT a : BOOL; END_VAR VAR_OUTPUT p : BOOL; END_VAR VAR m : A; END_VAR"
    text = f"{SUB} FUNCTION_BLOCK Main {around} m(a := a); IF a AND m.x THEN p := TRUE; END_IF; END_FUNCTION_BLOCK"
    made = sfc.dumps(sfc.loads(text.encode(), format="iec-text"), format="simaticml")
    source = sfc.loads(made, as_tool=True)
    body = source.pou("Main").bodies[0]
    assert isinstance(body, m.StBody)
    body.text = body.text.replace("#m", '"A_DB"')
    source.data_blocks.append(m.DataBlock(name="A_DB", kind=m.DataBlockKind.INSTANCE, type_name="A"))
    report = saved(source, "codesys", at_rest="all")
    assert [item.path for item in report.losses if item.what == "calls of charts"] == ["POU Main"]


@pytest.mark.parametrize("target", ["plcopen-2.01", "simaticml"])
@pytest.mark.parametrize(("flag", "action", "differs"), [("SFCInit", "q(P1);", True), ("SFCReset", "q(N);", False)])
def test_a_flag_that_comes_behind_a_transition_is_told(flag: str, action: str, target: str, *, differs: bool) -> None:
    """A transition was fired in both, and CODESYS had not executed the step yet: nothing of it was told."""
    body = "ACTION Set: q := TRUE; END_ACTION" if differs else ""
    text = f"""PROGRAM Main VAR_INPUT a, b, {flag} : BOOL; END_VAR VAR_OUTPUT q : BOOL; END_VAR
    INITIAL_STEP S0: END_STEP TRANSITION FROM S0 TO S1 := a; END_TRANSITION
    STEP S1: {action.replace("q", "Set") if differs else action} END_STEP
    TRANSITION FROM S1 TO S0 := b; END_TRANSITION {body} END_PROGRAM"""
    source = sfc.loads(sfc.dumps(sfc.loads(text.encode(), format="iec-text"), format="codesys"), as_tool=True)
    report = saved(source, target)
    assert [item.path for item in report.losses if item.what == "chart"] == ["POU Main"] * differs


def test_a_chart_in_a_step_is_told_that_s7_graph_holds_when_it_is_called_first() -> None:
    chart = """INITIAL_STEP S0: END_STEP TRANSITION FROM S0 TO S1 := a; END_TRANSITION STEP S1: Call(N); END_STEP
    TRANSITION FROM S1 TO S2 := m.x; END_TRANSITION TRANSITION FROM S1 TO S3 := S1.T >= T#10ms; END_TRANSITION
    STEP S2: END_STEP STEP S3: END_STEP TRANSITION FROM S2 TO S0 := NOT a; END_TRANSITION
    TRANSITION FROM S3 TO S0 := NOT a; END_TRANSITION ACTION Call: m(a := TRUE); END_ACTION"""
    text = f"{SUB} PROGRAM Main VAR_INPUT a : BOOL; END_VAR VAR m : A; END_VAR {chart} END_PROGRAM"
    report = saved(sfc.loads(text.encode(), format="iec-text"), "simaticml")
    told = [item.why for item in report.losses if item.what == "chart"]
    assert [why.rpartition("; ")[2] for why in told] == [
        "TIA Portal tests no transition of a chart in the scan that calls it first"
    ]
    assert "equal (proof" in report.compared["POU Main"].splitlines()[-1]
    assert german(told[0]) != told[0]


def test_a_delayed_action_of_a_grafcet_that_codesys_executes_is_told_with_its_cause() -> None:
    """The cause was not known: CODESYS has no action of IEC 60848, so the source was not run in its order."""
    text = """GRAFCET Main
INPUTS
    a
OUTPUTS
    p
CHART G1
    INITIAL STEP 1
    1 -> 2 : ↑a
    STEP 2
        p AFTER 20ms
    2 -> 1 : 20ms/X2
"""
    report = saved(sfc.loads(text.encode(), format="grafcet-text"), "codesys")
    told = [item.why for item in report.losses if item.what == "chart"]
    assert [why.rpartition("; ")[2] for why in told] == ["CODESYS executes the actions before the transitions"]
    assert "in the order of the source: equal, second 1 scan later (proof" in report.compared["POU Main"]


def test_steps_that_are_not_reached_are_told_with_the_scans() -> None:
    """With scans of 10 ms both times end in one, and the other transition could be the first."""
    text = CHART.format(first="", second="", initial="", edge="", actions="")
    text = text.replace("S1 TO S2 := b", "S1 TO S2 := S1.T >= T#15ms")
    later = "STEP S3: END_STEP TRANSITION FROM S1 TO S3 := S1.T >= T#20ms; END_TRANSITION END_FUNCTION_BLOCK"
    source = sfc.loads(text.replace("END_FUNCTION_BLOCK", later).encode(), format="iec-text")
    lines = saved(source, "plcopen-2.01").compared["POU Main"].splitlines()
    assert lines[-2:] == ["not reached: step S3: unreachable (proven)", "given: not reached with scans of T#2ms500us"]


def test_a_file_that_was_converted_is_told_to_be_compared_as_what_it_was() -> None:
    """The verdict on a CODESYS file with notes of its source was that on the source, executed by another tool."""
    first = sfc.loads(f"{SUB}".encode(), format="iec-text")
    file = sfc.dumps(first, format="codesys")
    told = "given: the source is the iec-text from which its file was converted"
    assert told in saved(sfc.loads(file), "plcopen-2.01").compared["POU A"]
    assert "from which its file" not in saved(sfc.loads(file, as_tool=True), "plcopen-2.01").compared["POU A"]
    assert "from which its file" not in saved(first, "plcopen-2.01").compared["POU A"]


def test_programs_of_a_task_that_share_a_variable_are_run_together() -> None:
    text = f"""PROGRAM One VAR_EXTERNAL a, x : BOOL; END_VAR {WITH_OUTPUT} END_PROGRAM
    PROGRAM Two VAR_EXTERNAL a, x : BOOL; END_VAR VAR_OUTPUT p : BOOL; END_VAR
    IF a AND NOT x THEN p := TRUE; END_IF; END_PROGRAM
    CONFIGURATION C VAR_GLOBAL a, x : BOOL; END_VAR RESOURCE R ON PLC TASK Fast(INTERVAL := T#10ms, PRIORITY := 1);
    PROGRAM I1 WITH Fast : One; PROGRAM I2 WITH Fast : Two; END_RESOURCE END_CONFIGURATION"""
    report = saved(sfc.loads(text.encode(), format="iec-text"), "codesys")
    assert [item.path for item in report.losses if item.what == "calls of charts"] == ["task Fast"]


@pytest.mark.parametrize("target", ["codesys", "plcopen-2.01"])
@pytest.mark.parametrize(("interval", "differs"), [("T#5ms", False), ("T#10ms", True), ("", True)])
def test_times_that_end_in_one_scan_of_the_task_are_told(interval: str, target: str, *, differs: bool) -> None:
    """20 and 15 ms were compared with scans of 2.5 ms: with those of the task they end in one."""
    text = CHART.format(first="q(DS, T#20ms);", second="", initial="", edge="", actions="")
    text = text.replace("S1 TO S2 := b", "S1 TO S2 := S1.T >= T#15ms").replace("FUNCTION_BLOCK", "PROGRAM")
    task = f"TASK Fast(INTERVAL := {interval}, PRIORITY := 1); PROGRAM M WITH Fast : Main;"
    around = f"CONFIGURATION C RESOURCE R ON PLC {task} END_RESOURCE END_CONFIGURATION" if interval else ""
    source = sfc.loads(f"{text}{around}".encode(), format="iec-text")
    if target != "codesys":  # whose tasks are those of an application, in no configuration
        source = sfc.loads(sfc.dumps(source, format="codesys"), as_tool=True)
        source.applications = list(source.resources())
        source.configurations = []
    report = saved(source, target)
    assert ("given: for the difference scans of T#10ms" in report.compared["POU Main"]) is differs
    late = "second" if target == "codesys" else "first"
    assert report.compared["POU Main"].startswith("different after " if differs else f"equal, {late} 1 scan later")
    assert bool([item for item in report.losses if item.what == "chart"]) is differs


@pytest.mark.parametrize("target", ["simaticml", "plcopen-2.01"])
def test_a_pause_that_comes_with_a_condition_is_told(target: str) -> None:
    """CODESYS tests no condition in that scan; the target stored that it was TRUE and fired behind the pause."""
    text = CHART.format(first="q(N);", second="", initial="", edge="", actions="").replace("a, b :", "a, b, SFCPause :")
    drawn = sfc.dumps(sfc.loads(text.encode(), format="iec-text"), format="codesys")
    report = saved(sfc.loads(drawn, as_tool=True), target)
    assert report.compared["POU Main"].splitlines()[0].endswith(SHIFTED)
    assert [(item.outcome, item.what) for item in report.losses] == [(Outcome.APPROXIMATED, "simultaneous inputs")]


@pytest.mark.parametrize(
    ("initial", "condition", "why"),
    [
        ("r(S);", "S0.T >= T#20ms", "CODESYS executes the actions before the transitions, and so compares the times"),
        (
            "Count(N);",
            "S0.T >= T#20ms",
            "CODESYS executes the actions of the initial step in its first scan, and others",
        ),
        (
            "Count(N);",
            "a",
            "CODESYS executes the actions of the initial step in its first scan, and others a scan later",
        ),
    ],
)
def test_what_shows_that_a_tool_executes_actions_first_is_told(initial: str, condition: str, why: str) -> None:
    """It told of other inputs in actions that read none."""
    actions = "ACTION Count: m := m + 1; END_ACTION" if "Count" in initial else ""
    text = CHART.format(first="q(N);", second="", initial="; r : BOOL", edge="", actions=actions)
    text = text.replace("INITIAL_STEP S0: ", f"INITIAL_STEP S0: {initial} ").replace(
        "S0 TO S1 := a", f"S0 TO S1 := {condition}"
    )
    (item,) = saved(sfc.loads(text.encode(), format="iec-text"), "codesys").losses
    assert f"; {why}" in item.why
    assert "other inputs" not in item.why
    assert "CODESYS executes" not in german(item.why)


def test_a_pulse_of_the_initial_step_that_matiec_does_not_execute_is_told_as_such() -> None:
    text = CHART.format(first="", second="", initial="", edge="", actions="ACTION Set: m := 1; END_ACTION")
    text = text.replace("INITIAL_STEP S0: ", "INITIAL_STEP S0: Set(P1); ")
    project = sfc.loads(text.encode(), format="iec-text")
    project.header.product = "Beremiz"
    source = sfc.loads(sfc.dumps(project, format="plcopen-2.01"), as_tool=True)
    (item,) = [item for item in saved(source, "codesys").losses if item.what == "chart"]
    assert "the start is no activation of the initial step in the source" in item.why
    assert "keine Aktivierung des Anfangsschritts" in german(item.why)


def test_an_input_that_its_block_writes_is_one_in_the_run_as_well() -> None:
    text = CHART.format(first="Take(N);", second="", initial="", edge="", actions="ACTION Take: a := FALSE; END_ACTION")
    user = "PROGRAM User VAR main : Main; END_VAR main.a := main.m = 0; main(b := TRUE); END_PROGRAM"
    report = saved(sfc.loads((text + user).encode(), format="iec-text"), "simaticml")
    assert [item.path for item in report.items if item.what == "section"] == ["POU Main / a"]  # static: S7 writes none
    assert report.compared["POU Main"].startswith("equal (proof")
    assert not [item for item in report.losses if item.what == "chart"]


CALLED = """VAR_GLOBAL b : BOOL; END_VAR
FUNCTION_BLOCK Inner VAR_OUTPUT seen : BOOL; END_VAR VAR_EXTERNAL b : BOOL; END_VAR seen := b; END_FUNCTION_BLOCK
FUNCTION_BLOCK Sampler VAR inner : Inner; END_VAR VAR_OUTPUT seen : BOOL; END_VAR
inner(); seen := inner.seen; END_FUNCTION_BLOCK
FUNCTION_BLOCK Plain VAR b : BOOL; END_VAR VAR_OUTPUT seen : BOOL; END_VAR b := TRUE; seen := b; END_FUNCTION_BLOCK
FUNCTION Sample : BOOL VAR_EXTERNAL b : BOOL; END_VAR Sample := b; END_FUNCTION
TYPE Samplers : STRUCT one : Sampler; END_STRUCT; END_TYPE
FUNCTION_BLOCK Main
VAR_INPUT a : BOOL; END_VAR VAR_OUTPUT m : INT; END_VAR
VAR sampler : Sampler; plain : Plain; some : ARRAY [0..1] OF Samplers; END_VAR
INITIAL_STEP S0: END_STEP
TRANSITION FROM S0 TO S1 := a; END_TRANSITION
STEP S1: Look(N); END_STEP
TRANSITION FROM S1 TO S0 := NOT a; END_TRANSITION
ACTION Look: {call} IF {value} AND m = 0 THEN m := 1; END_IF; IF NOT {value} AND m = 0 THEN m := 2; END_IF; END_ACTION
END_FUNCTION_BLOCK
"""


@pytest.mark.parametrize(
    ("call", "value", "reads_input"),
    [
        ("sampler();", "sampler.seen", True),
        ("some[1].one();", "some[1].one.seen", True),
        ("", "Sample()", True),
        ("plain();", "plain.seen", False),
    ],
)
def test_an_input_that_a_called_block_reads_is_no_constant_delay(call: str, value: str, reads_input: bool) -> None:
    project = sfc.loads(CALLED.format(call=call, value=value).encode(), format="iec-text")
    report = saved(project, "codesys")
    first = report.compared["POU Main"].splitlines()[0]
    assert first.endswith(SHIFTED) if reads_input else first.startswith("equal, second 1 scan later")
    assert ["CODESYS executes the actions before" in item.why for item in report.losses] == [True] * reads_input


@pytest.mark.parametrize("target", ["codesys", "plcopen-2.01"])
@pytest.mark.parametrize(
    ("call", "value", "told"),
    [
        ("", "b", "b"),
        ("sampler();", "sampler.seen", "b"),
        ("", "Sample()", "b"),
        ("plain();", "plain.seen", ""),
        ("", "kept", "kept"),
        ("", "S1.x", ""),
        ("kept := a;", "kept", "a"),
    ],
)
def test_actions_that_read_inputs_are_told_without_a_run(target: str, call: str, value: str, told: str) -> None:
    text = CALLED.format(call=call, value=value).replace("VAR sampler", "VAR kept : BOOL := TRUE; sampler")
    text = text.replace("VAR_INPUT a", "VAR_EXTERNAL b : BOOL; END_VAR VAR_INPUT a")
    report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), target, partial=True).report
    found = [(item.outcome, item.path, item.why) for item in report.items if item.what == "inputs of actions"]
    why = f"its actions read {told}: CODESYS executes the actions before the transitions, and so sees other inputs in"
    assert found == ([(Outcome.APPROXIMATED, "POU Main", f"{why} them")] if told and target == "codesys" else [])
    assert all(german(why).startswith("ihre Aktionen lesen ") for _, _, why in found)


@pytest.mark.parametrize(
    ("initial", "told"),
    [("W(N);", True), ("q(S);", True), ("W(P1);", True), ("q(N);", False), ("q(R);", False), ("k(R);", True)],
)
@pytest.mark.parametrize("target", ["codesys", "simaticml", "plcopen-2.01"])
def test_initial_steps_that_do_something_for_good_are_told_without_a_run(target: str, initial: str, told: bool) -> None:
    text = f"""FUNCTION_BLOCK Main
        VAR_INPUT go : BOOL; END_VAR VAR_OUTPUT q, p : BOOL; k : BOOL := TRUE; n : INT; END_VAR
        INITIAL_STEP S1: {initial} END_STEP
        STEP S2: p(N); q(R); END_STEP
        TRANSITION FROM S1 TO S2 := go; END_TRANSITION
        TRANSITION FROM S2 TO S1 := NOT go; END_TRANSITION
        ACTION W: n := n + 1; END_ACTION
        END_FUNCTION_BLOCK"""
    project = sfc.loads(text.encode(), format="iec-text")
    found = [item for item in sfc.convert(project, target).report.items if item.what == START_OF_CHART]
    is_told = told and target != "plcopen-2.01"
    assert [(item.outcome, item.path) for item in found] == [(Outcome.APPROXIMATED, "POU Main")] * is_told
    assert all(german(item.why).startswith("ihr Initialschritt ") for item in found)
    assert is_told or sfc.convert(project, target, limit=8).report.losses == []


@pytest.mark.parametrize(("initial", "told"), [("W(P1);", True), ("q(P0);", True), ("q(N);", False), ("W(S);", False)])
def test_pulses_at_the_start_that_matiec_does_not_execute_are_told_without_a_run(initial: str, told: bool) -> None:
    text = CHART.format(first="", second="", initial="", edge="", actions="ACTION W: m := m + 1; END_ACTION")
    text = text.replace("INITIAL_STEP S0:", f"INITIAL_STEP S0: {initial}")
    data = sfc.dumps(sfc.loads(text.encode(), format="iec-text"), format="plcopen-2.01")
    source = sfc.loads(data.replace(b'productName="', b'productName="Beremiz '))
    found = [item for item in sfc.convert(source, "iec-text").report.losses if item.what == START_OF_CHART]
    assert [(item.outcome, item.path) for item in found] == [(Outcome.APPROXIMATED, "POU Main")] * told
    assert all(german(item.why).startswith("ihr Initialschritt hat Impulse") for item in found)


def test_actions_that_read_no_input_are_only_later() -> None:
    report = saved(chart("q(N);", "Set(S);"), "codesys", strict=True)
    assert report.compared["POU Main"].startswith("equal, second 1 scan later")


@pytest.mark.parametrize("target", ["codesys", "plcopen", "simaticml"])
def test_what_acts_the_same_is_said_to(target: str) -> None:
    report = saved(chart("q(N);", "Aa(P1);"), target, strict=True)
    assert report.compared["POU Main"].startswith("equal")


UNREACHED = """FUNCTION_BLOCK Main
VAR_INPUT x : REAL; END_VAR
VAR_OUTPUT q : BOOL; END_VAR
INITIAL_STEP S0: END_STEP
TRANSITION FROM S0 TO S1 := SIN(x) * 1.0E20 = 3.0; END_TRANSITION
STEP S1: q(N); END_STEP
TRANSITION FROM S1 TO S0 := TRUE; END_TRANSITION
END_FUNCTION_BLOCK
"""


@pytest.mark.slow
def test_what_was_not_reached_is_told() -> None:
    report = saved(sfc.loads(UNREACHED.encode()), "codesys")
    assert report.compared["POU Main"].startswith("not all was reached")
    assert any("S1" in line for line in report.untested["POU Main"])


@pytest.mark.slow
@pytest.mark.corpus
def test_the_time_that_is_left_is_used_for_what_was_not_reached() -> None:
    """A crane with 16 steps in a row was not run to its end, in a fifth of the time."""
    path = next((each for each in corpus_files("codesys") if "VerifAPS" in str(each) and each.name == "test.xml"), None)
    if path is None:
        pytest.skip("no corpus")
    report = saved(sfc.load(path), "codesys23")
    assert report.untested == {}
    assert report.compared["POU Crane"].startswith("equal")


PARALLEL = """FUNCTION_BLOCK Main
VAR_INPUT a, b : BOOL; END_VAR
VAR_OUTPUT n : INT; END_VAR
INITIAL_STEP S0: END_STEP
TRANSITION FROM S0 TO (P1, P2) := a; END_TRANSITION
{steps}
TRANSITION FROM (P1, P2) TO S0 := b; END_TRANSITION
ACTION One: n := 1; END_ACTION
ACTION Two: n := 2; END_ACTION
END_FUNCTION_BLOCK
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("steps", "outcome"),
    [
        ("STEP P1: One(N); END_STEP STEP P2: Two(N); END_STEP", "equal"),
        ("STEP P2: Two(N); END_STEP STEP P1: One(N); END_STEP", "different"),
    ],
)
@pytest.mark.parametrize("target", ["codesys", "plcopen"])
def test_parallel_sequences_that_write_one_operand_are_told_apart_by_the_order_of_their_steps(
    steps: str, outcome: str, target: str
) -> None:
    """The targets list the steps of parallel sequences from left to right, and execute them in this order."""
    project = sfc.loads(PARALLEL.format(steps=steps).encode(), format="iec-text")
    report = saved(project, target)
    assert report.compared["POU Main"].startswith(outcome)
    told = ["order of actions", "chart"] if target == "codesys" else ["chart"]  # which executes them by their names
    assert [item.what for item in report.losses] == (told if outcome == "different" else [])
    if outcome == "equal":
        graph = sfc.loads(sfc.dumps(project, format="simaticml"), as_tool=True)
        at_rest = saved(graph, target, partial=True, at_rest=["all"])  # the modes make loops of the sequences
        assert at_rest.compared["POU Main"].startswith("equal")


def test_a_chart_in_which_something_is_not_executed_is_not_run_and_none_without_a_limit() -> None:
    report = saved(sfc.load(FIXTURES / "simaticml" / "FB_Drill.xml"), "scl", partial=True)
    told = "not compared: not all of it is executed; change that in the source, or test it in TIA Portal"
    assert report.compared == {"POU FB_Drill": told}
    assert report.untested == {}
    assert sfc.save(chart("Zz(N); Aa(N);"), io.BytesIO(), format="codesys").compared == {}


@pytest.mark.slow
def test_a_block_alone_is_run_though_it_calls_what_no_file_declares() -> None:
    report = saved(sfc.load(FIXTURES / "simaticml" / "FB_Drill.xml"), "codesys", partial=True)
    assert [item.what for item in report.with_outcome(Outcome.NOT_EXECUTED)] == ["undeclared name"]
    found = report.compared["POU FB_Drill"]
    assert "equal, second 1 scan later in" in found, "with its inputs operated, behind the step before its sequences"
    assert "FC_Count" in " ".join([found, *report.untested.get("POU FB_Drill", ())])


@pytest.mark.parametrize(("condition", "outcome"), [("a", "equal"), ("b", "it does something else after 1 scan: ")])
def test_a_chart_in_which_something_is_approximated_is_run(condition: str, outcome: str) -> None:
    """The report names what differs, the run tells whether the chart does something else: it is no second item."""
    project = chart("q(N);")
    report = ConversionReport()
    report.add(Outcome.APPROXIMATED, "condition", "POU Main / transition S0 -> S1", "as a test has it")
    result = sfc.loads(sfc.dumps(project))
    pou = result.pou("Main")
    assert pou.chart is not None
    pou.chart.transitions[0].condition = m.Expression(text=condition)
    report_running(report, project, result, {}, tool="the target", target=None, limit=8)
    assert report.compared["POU Main"].startswith(outcome)
    assert report.compared["POU Main"].splitlines()[-1] == "what the report names as approximated is in it"
    assert len(report.items) == 1


BOOLEAN = "{}: other code writes it, too; the chart does so in every scan in the source, never in TC6 tools"


@pytest.mark.parametrize(
    ("what", "path", "why", "is_cause"),
    [
        ("Boolean actions", "POU Main", BOOLEAN.format("q"), False),
        ("Boolean actions", "POU Main", BOOLEAN.format("m"), True),
        ("Boolean actions", "POU Main", BOOLEAN.format("b"), True),  # which decides what the action writes
        (
            "order of actions",
            "POU Main",
            "q is executed after Set in one scan, in the source the other way round (q)",
            False,
        ),
        ("permanent instruction before the sequence", "POU Main", "other actions come before it", False),
        ("search for stability", "POU Main", "it passes a step", False),
        ("action", "POU Main / step S2 / action Set", "as a test has it", False),
        ("action", "POU Main / step S1 / action Look", "as a test has it", True),
        ("interlock", "POU Main / step S1", "as a test has it", True),
    ],
)
def test_only_what_can_change_what_differs_is_called_its_cause(what: str, path: str, why: str, is_cause: bool) -> None:
    """Any item of the chart was: an engineer looked for the fault at a variable that has nothing to do with it."""
    project = chart("Look(N); q(N);", "Set(N);")
    action = m.Action(name="Look", body=m.StBody(text="IF b THEN m := 1; END_IF;"))
    project.pou("Main").actions.append(action)
    result = sfc.loads(sfc.dumps(project))
    result.pou("Main").find_action("Look").body = m.StBody(text="IF b THEN m := 2; END_IF;")
    report = ConversionReport()
    report.add(Outcome.APPROXIMATED, what, path, why)
    report_running(report, project, result, {}, tool="TC6 tools", target=None, limit=8)
    items = [item.why.split("; ") for item in report.items if item.what == "chart"]
    told = items[0] if items else report.compared["POU Main"].splitlines()
    assert told[0].endswith("m is 1 in the source and 2 in TC6 tools")
    part = "" if path == "POU Main" else f" at {path.rpartition(' / ')[2]}"
    named = f"a cause is the {what}{part}, which the report names"
    assert told[1] == (named if is_cause else "the cause is not known: look at action Look")


INNER = """ACTION Inner: INITIAL_STEP I0: END_STEP TRANSITION FROM I0 TO I1 := b; END_TRANSITION STEP I1: q(N); END_STEP
TRANSITION FROM I1 TO I0 := NOT b; END_TRANSITION END_ACTION"""


def test_charts_of_actions_differ_by_the_order_of_actions_and_transitions_alone() -> None:
    """The inner chart is a scan later than the outer one, which is one later itself: a pulse of ``b`` is missed."""
    inner = INNER.replace("FROM I1 TO I0 := NOT b", "FROM I1 TO I0 := FALSE")
    text = CHART.format(first="Inner(N);", second="", initial="", edge="", actions=inner)
    report = saved(sfc.loads(text.encode(), format="iec-text"), "codesys")
    found = report.compared["POU Main"]
    assert found.startswith("it does something else")
    assert "\nwith actions and transitions in the order of CODESYS: equal (proof: " in found
    assert verdict_of(report, "POU Main") is ChartVerdict.DIFFERENT
    assert verdict_of(report, "POU Main / action Inner") is ChartVerdict.DELAYED


def test_a_chart_of_an_action_that_only_comes_later_is_told_to_come_to_the_same() -> None:
    """Nothing stays of the pulse that it misses."""
    text = CHART.format(first="Inner(N);", second="", initial="", edge="", actions=INNER)
    report = saved(sfc.loads(text.encode(), format="iec-text"), "codesys")
    assert "\nin what both come to while inputs stay: equal" in report.compared["POU Main"]
    assert verdict_of(report, "POU Main") is ChartVerdict.DIFFERENT


def test_a_rule_of_the_tools_is_named_beside_what_the_report_approximates() -> None:
    text = CHART.format(first="Look(N);", second="", initial="", edge="", actions=SAMPLED)
    project = sfc.loads(text.encode(), format="iec-text")
    report = ConversionReport()
    report.add(Outcome.APPROXIMATED, "condition", "POU Main / transition S2 -> S0", "as a test has it")
    result = sfc.loads(sfc.dumps(project, format="codesys"), as_tool=True)
    report_running(report, project, result, {}, tool="CODESYS", target=None, limit=8)
    found = report.compared["POU Main"]
    assert "\nCODESYS executes the actions before the transitions, and so sees other inputs in them\nwhat the" in found


def test_an_input_that_matiec_takes_by_another_name_is_the_same_on_both_sides() -> None:
    text = CHART.format(first="q(N);", second="", initial="", edge="", actions="").replace("a, b :", "grün, b :")
    text = text.replace(":= a;", ":= grün;")
    report = saved(sfc.loads(text.encode(), format="iec-text"), "plcopen-2.01", flavour="beremiz")
    assert [item.path for item in report.items if item.what == "name"] == ["Main.grün"]
    assert report.compared["POU Main"].startswith("equal")


def test_a_large_chart_leaves_time_for_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    limits: list[float] = []

    def noted(*_: Any, limit: float, **__: Any) -> None:
        limits.append(limit)
        raise SfcError("not run here")

    monkeypatch.setattr("plcopen_sfc.analysis.equivalence.equivalent", noted)
    text = "\n".join(
        CHART.replace("Main", f"Main{number}").format(first="", second="", initial="", edge="", actions="")
        for number in range(4)
    )
    report = saved(sfc.loads(text.encode(), format="iec-text"), "codesys")
    assert [found.startswith("not run: not run here") for found in report.compared.values()] == [True] * 4
    assert [20 / (4 - number) + 0.001 > limit for number, limit in enumerate(limits)] == [True] * 4


@pytest.mark.parametrize(("steps", "limit"), [(2, 20.0), (300, 30.0)])
def test_an_automatic_limit_grows_with_the_charts(monkeypatch: pytest.MonkeyPatch, steps: int, limit: float) -> None:
    limits: list[float] = []

    def noted(*_: Any, limit: float, **__: Any) -> None:
        limits.append(limit)
        raise SfcError("not run here")

    monkeypatch.setattr("plcopen_sfc.analysis.equivalence.equivalent", noted)
    lines = ["PROGRAM Main VAR a : BOOL; END_VAR INITIAL_STEP S0: END_STEP"]
    lines += [f"STEP S{n}: END_STEP TRANSITION FROM S{n - 1} TO S{n} := a; END_TRANSITION" for n in range(1, steps)]
    project = sfc.loads("\n".join([*lines, "END_PROGRAM"]).encode(), format="iec-text")
    sfc.save(project, io.BytesIO(), format="codesys", limit="auto")
    assert limits == [pytest.approx(limit, abs=0.2)]


@pytest.mark.parametrize("target", ["csv", "xlsx"])
def test_a_target_that_nothing_executes_is_not_compared(target: str) -> None:
    report = saved(chart("q(N);"), target, partial=True)
    assert report.compared["POU Main"].startswith("not compared, as nothing executes a step list")
    assert report.untested == {"POU Main": []}


def test_edge_detection_of_an_input_is_not_executed_where_there_is_none() -> None:
    project = chart("q(N);", edge=" R_EDGE")
    for target in ("codesys", "plcopen", "simaticml"):
        with pytest.raises(LossError, match="edge `R_EDGE`"):
            sfc.convert(project, target)


def test_names_of_steps_and_variables_are_told_apart_in_s7_graph() -> None:
    text = CHART.format(first="q(N);", second="", initial="", edge="", actions="").replace("m : INT", "m, Trans1 : INT")
    project = sfc.loads(text.encode(), format="iec-text")
    data, report = sfc.convert(project, "simaticml")
    assert report.losses == []
    assert sfc.loads(data).diagnostics == ()


@pytest.mark.parametrize("target", ["simaticml", "codesys", "codesys23"])
@pytest.mark.parametrize("is_taken", [False, True])
def test_a_step_with_the_name_of_a_variable_gets_another_and_its_own_again(target: str, is_taken: bool) -> None:
    text = CHART.format(first="q(N);", second="", initial="", edge="", actions="").replace(
        "m : INT", f"m : INT; s2{', S2_step' * is_taken} : BOOL"
    )
    text = text.replace("FROM S2 TO S0 := a;", "FROM S2 TO S0 := S2.X AND NOT s2;")
    data, report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), target)
    new = "S2_step_2" if is_taken else "S2_step"
    assert [item.path for item in report.items if f"{new} in" in item.why] == ["POU Main / step S2"]
    written = sfc.loads(data)
    assert [step.name for step in written.pou("Main").sfc.steps] == ["S0", "S1", new]
    again = sfc.loads(sfc.dumps(written, format="plcopen", partial=True)).pou("Main").sfc
    assert [step.name for step in again.steps] == ["S0", "S1", "S2"]
    condition = again.transitions[2].condition
    assert isinstance(condition, m.Expression)
    assert condition.text == "S2.X AND NOT s2"


def test_names_in_another_case_are_no_mistake_of_the_writer() -> None:
    text = CHART.format(
        first="aa(P1);", second="AA(N);", initial="", edge="", actions="ACTION Aa: m := m + 1; END_ACTION"
    )
    report = saved(sfc.loads(text.encode(), format="iec-text"), "codesys", partial=True)
    assert {item.path for item in report.losses} == {"POU Main / step S1 / action Aa"}
    assert not any("please report" in item.why for item in report.items)


def test_global_variables_of_no_list_are_run_where_they_are_in_one(tmp_path: Path) -> None:
    text = CHART.format(first="q(N);", second="", initial="", edge="", actions="")
    variables = "level AT %IW2 : INT; other AT %IW4 : INT; bound : REAL := 0.5;"
    text = text.replace("FUNCTION_BLOCK Main", f"VAR_GLOBAL {variables} END_VAR\nPROGRAM Main")
    text = text.replace("END_FUNCTION_BLOCK", "END_PROGRAM").replace(":= b;", ":= level > 10 AND other < 3;")
    text = text.replace("q : BOOL", "q : BOOL; r : REAL := -1.5")
    for target in ("twincat", "codesys", "plcopen"):
        project = sfc.loads(text.encode(), format="iec-text")
        folder = tmp_path / "out"
        folder.mkdir(exist_ok=True)
        report = sfc.save(project, folder if target == "twincat" else io.BytesIO(), format=target, limit=8)
        assert report.losses == []
        assert report.compared["POU Main"].startswith("equal")


def test_programs_with_other_names_are_those_of_their_tasks() -> None:
    project = sfc.load(FIXTURES / "broken" / "umlauts_utf8.xml")
    data, report = sfc.convert(project, "codesys")
    assert report.losses == []
    names = {item.why.split(" in ")[0] for item in report.items if item.what == "name"}
    assert {"Ruehrkessel", "Y2_Ablassventil"} <= names
    assert [pou.name for pou in sfc.loads(data).pous] == ["Ruehrkessel"]


@pytest.mark.parametrize("target", ["codesys", "twincat", "codesys23"])
def test_names_that_are_none_in_codesys_are_others_there_and_come_back(target: str, tmp_path: Path) -> None:
    text = CHART.format(first="Ventil_Öl(N);", second="zähle(P1);", initial="", edge="", actions="").replace(
        "m : INT", "m : INT; Ventil_Öl, Fuellen : BOOL"
    )
    text = text.replace("S1", "Füllen").replace(
        "END_FUNCTION_BLOCK", "ACTION zähle: m := m + 1; END_ACTION\nEND_FUNCTION_BLOCK"
    )
    project = sfc.loads(text.encode(), format="iec-text")
    path = tmp_path if target == "twincat" else tmp_path / "out.xml"
    report = sfc.save(project, path, format=target)
    assert {item.why.split(" in ")[0] for item in report.items if item.what == "name"} == {
        "Ventil_Oel", "zaehle", "Fuellen_2"
    }  # fmt: skip
    written = sfc.load(path)
    pou = written.pou("Main")
    assert pou.chart is not None
    names = [*(v.name for v in pou.variables()), *(a.name for a in pou.actions), *(s.name for s in pou.chart.steps)]
    assert all(name.isascii() for name in names)
    if target == "codesys":
        again = sfc.loads(sfc.dumps(written, format="plcopen")).pou("Main")
        assert again.chart is not None
        assert [step.name for step in again.chart.steps] == ["S0", "Füllen", "S2"]
        assert {action.name for action in again.actions} == {"zähle"}


@pytest.mark.parametrize("target", ["codesys", "plcopen"])
def test_what_only_text_can_declare_is_not_executed_elsewhere(target: str) -> None:
    text = CHART.format(first="q(N);", second="", initial="", edge="", actions="")
    static = text.replace("VAR_OUTPUT", "VAR_STAT count : INT; END_VAR\nVAR_OUTPUT")
    with pytest.raises(LossError, match="has no VAR_STAT, which is one for all"):
        sfc.convert(sfc.loads(static.encode(), format="iec-text"), target)
    program = text.replace("FUNCTION_BLOCK", "PROGRAM") + (
        "CONFIGURATION C RESOURCE R ON PLC TASK T(INTERVAL := T#10ms, PRIORITY := 1);"
        " PROGRAM P WITH T : Main(a := TRUE); END_RESOURCE END_CONFIGURATION"
    )
    with pytest.raises(LossError, match="does not get its arguments"):
        sfc.convert(sfc.loads(program.encode(), format="iec-text"), target)


@pytest.mark.slow
@pytest.mark.parametrize("target", ["codesys", "plcopen", "simaticml"])
def test_an_action_on_an_element_that_an_input_chooses_is_compared(target: str) -> None:
    text = CHART.format(first="ar[i](N);", second="", initial="", edge="", actions="")
    project = sfc.loads(text.replace("t : TIME;", "i : INT; END_VAR VAR ar : ARRAY[0..3] OF BOOL;").encode())
    assert saved(project, target, partial=True).compared.keys() == {"POU Main"}


@pytest.mark.parametrize("name", ["OFF_SQ", "init_sq", "SW_MAN", "T_PUSH"])
@pytest.mark.parametrize("source", ["codesys", "plcopen", "iec-text"])
def test_an_input_of_the_machine_does_not_become_one_that_operates_the_sequence(name: str, source: str) -> None:
    text = CHART.format(first="q(N);", second="", initial="", edge="", actions="").replace("a, b", f"a, b, {name}")
    project = sfc.loads(sfc.dumps(sfc.loads(text.encode(), format="iec-text"), format=source), format=source)
    with pytest.raises(LossError, match="operate the sequence"):
        sfc.convert(project, "simaticml")


@pytest.mark.slow
@pytest.mark.parametrize("target", ["codesys", "plcopen"])
def test_inputs_that_operate_a_sequence_of_tia_do_so_when_they_come_back(target: str) -> None:
    drill = sfc.load(FIXTURES / "simaticml" / "FB_Drill.xml")
    there = sfc.loads(sfc.dumps(drill, format=target, partial=True))
    _, report = sfc.convert(there, "simaticml", partial=True)
    assert [item.why for item in report.losses if "operate the sequence" in item.why] == []


@pytest.mark.parametrize("value", ["m + 1", "2 * m", "m MOD 7", "m + m * 2"])
def test_an_action_with_an_operation_is_no_row(value: str) -> None:
    """TIA Portal reads such rows and refuses to compile them."""
    text = CHART.format(
        first="Act(P1);", second="", initial="", edge="", actions=f"ACTION Act: m := {value}; END_ACTION"
    )
    data, _ = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "simaticml")
    chart = next(sfc.loads(data, as_tool=True).charts()).chart
    called = [row.qualifier for step in chart.steps for row in step.actions if row.target is None]
    assert called == ["CALL"]


@pytest.mark.parametrize("target", ["codesys", "plcopen"])
def test_variables_whose_names_the_target_reserves_are_the_same_on_both_sides(target: str) -> None:
    text = """{plcopen_sfc project.dialect := 'scl'}
FUNCTION_BLOCK Seq
    VAR_INPUT sel, go : Bool; END_VAR
    VAR_OUTPUT mux, w : Bool; END_VAR
    INITIAL_STEP A: #w(N); END_STEP
    TRANSITION FROM A TO B := #sel; END_TRANSITION
    STEP B: #mux(N); END_STEP
    TRANSITION FROM B TO A := NOT #sel AND #go; END_TRANSITION
END_FUNCTION_BLOCK
"""
    project = sfc.loads(text.encode(), format="iec-text")
    data = io.BytesIO()
    report = sfc.save(project, data, format=target, limit=8)
    names = {variable.name for variable in sfc.loads(data.getvalue()).pou("Seq").variables()}
    assert {"sel_2", "mux_2"} <= names
    assert re.match(r"equal(, second 1 scan later)? \(proof: ", report.compared["POU Seq"]), report.compared
    assert not report.losses


@pytest.mark.slow
@pytest.mark.corpus
def test_steps_with_other_names_in_the_target_are_compared() -> None:
    """Nothing else can be: no row of this sequencer writes anything, and its steps are called ``Step 1``."""
    files = [path for path in corpus_files("simaticml") if path.name == "GraphBranch.xml"]
    if not files:
        pytest.skip("no corpus beside the repository (see tests/corpus.py)")
    report = sfc.save(sfc.load(files[0]), io.BytesIO(), format="codesys", limit=8, at_rest=["all"])
    assert [verdict.partition(" (")[0] for verdict in report.compared.values()] == ["equal"]


FALLING = """FUNCTION_BLOCK Main
VAR_INPUT a : BOOL; END_VAR VAR_OUTPUT n : INT; END_VAR VAR edge : F_TRIG; END_VAR
INITIAL_STEP S0: END_STEP
TRANSITION FROM S0 TO S1 := {condition}; END_TRANSITION
STEP S1: Act(N); END_STEP
TRANSITION FROM S1 TO S0 := NOT a; END_TRANSITION
ACTION Act: edge(CLK := a); IF edge.Q THEN n := 1; END_IF; END_ACTION
END_FUNCTION_BLOCK
"""


def test_a_global_f_trig_is_told_where_the_blocks_that_call_it_do_not_declare_it() -> None:
    text = "VAR_GLOBAL f : F_TRIG; END_VAR PROGRAM P VAR a : BOOL; END_VAR f(CLK := a); END_PROGRAM"
    losses = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "simaticml", partial=True).report.losses
    assert ("falling edge", "list of global variables") in {(item.what, item.path) for item in losses}


@pytest.mark.parametrize(("pins", "differs"), [("CU := TRUE", False), ("CD := TRUE", True)])
def test_that_counters_stop_at_zero_is_taken_back_by_a_proof(pins: str, differs: bool) -> None:
    text = FALLING.format(condition="TRUE").replace("F_TRIG", "CTUD").replace("CLK := a", f"{pins}, PV := 3")
    text = text.replace("IF edge.Q THEN n := 1; END_IF;", "n := edge.CV;")
    losses = saved(sfc.loads(text.encode(), format="iec-text"), "codesys").losses
    assert ("counter" in [item.what for item in losses]) is differs


@pytest.mark.parametrize(("condition", "differs"), [("TRUE", True), ("a", False)])
def test_the_first_call_of_f_trig_is_told_without_a_run_and_taken_back_by_a_proof(
    condition: str, differs: bool
) -> None:
    project = sfc.loads(FALLING.format(condition=condition).encode(), format="iec-text")
    why = "the first call of edge with FALSE is a falling edge in the source and none in TIA Portal"
    (item,) = sfc.convert(project, "simaticml", limit=0).report.losses
    assert (item.what, item.path, item.why) == ("falling edge", "POU Main", why)
    assert (
        german(why) == "der erste Aufruf von edge mit FALSE ist in der Quelle eine fallende Flanke, in TIA Portal keine"
    )
    losses = saved(project, "simaticml").losses
    assert [item.what for item in losses] == (["falling edge", "chart"] if differs else [])
    if differs:
        assert "a cause is the falling edge, which the report names" in losses[1].why


REQUESTED = """{{plcopen_sfc project.dialect := 'codesys'}}
VAR_GLOBAL request, sensor AT %IX0.0 : BOOL; END_VAR
PROGRAM Panel
VAR button : BOOL; END_VAR
IF button THEN {asked} := TRUE; END_IF
END_PROGRAM
PROGRAM Main
VAR valve : BOOL; n : INT; {local}END_VAR
INITIAL_STEP Init: END_STEP
TRANSITION FROM Init TO Fill := {asked}; END_TRANSITION
STEP Fill: valve(N); Take(N); END_STEP
TRANSITION FROM Fill TO Init := sensor; END_TRANSITION
ACTION Take: {asked} := FALSE; n := n + 1; {more} END_ACTION
END_PROGRAM
"""
LIMITED_BY_COUNT = "IF n > 3 THEN valve := FALSE; END_IF"


@pytest.mark.parametrize("asked", ["request", "Main.request"])
def test_what_another_program_writes_is_an_input_though_the_chart_writes_it(asked: str) -> None:
    local = "request : BOOL; " if asked != "request" else ""
    text = REQUESTED.format(asked="request", more=LIMITED_BY_COUNT, local=local)
    text = text.replace("THEN request := TRUE", f"THEN {asked} := TRUE")
    project = sfc.loads(text.encode(), format="iec-text")
    report = saved(project, "plcopen-2.01", partial=True)
    assert "different after" in report.compared["POU Main"]
    assert {item.what for item in report.with_outcome(Outcome.APPROXIMATED)} >= {"order of actions", "Boolean actions"}
    verdict = sfc.equivalent(project.pou("Main"), project.pou("Main"))
    assert verdict.proven
    assert verdict.coverage[0].counts["step"] == (2, 2)


def test_a_command_that_the_chart_takes_back_is_tried_from_outside() -> None:
    alone = re.sub("PROGRAM Panel.*?END_PROGRAM", "", REQUESTED, flags=re.DOTALL)
    project = sfc.loads(alone.format(asked="request", more=LIMITED_BY_COUNT, local="").encode(), format="iec-text")
    report = saved(project, "plcopen-2.01", partial=True)
    lines = report.untested["POU Main"]
    assert "not all steps are reached" in report.compared["POU Main"]
    assert any(line.startswith("not reached: step Fill: ") for line in lines)
    assert any(line.startswith("with `request` written from outside as well: different") for line in lines)
    assert {item.what for item in report.with_outcome(Outcome.APPROXIMATED)} >= {"order of actions", "Boolean actions"}
    counted = alone.replace("{asked} := FALSE; n := n + 1;", "n := n + 1;").replace("Take(N)", "Take(P)")
    project = sfc.loads(counted.format(asked="n = 7 OR n = 9", more="", local="").encode(), format="iec-text")
    report = saved(project, "codesys-export")
    assert report.compared["POU Main"].endswith("\ngiven: `n` written from outside as well")
    assert "POU Main" not in report.untested


@contextmanager
def interrupted_in(function: str) -> Iterator[None]:
    """Interrupt this thread, as Ctrl-C does, while it executes a function.

    It is done again after a second: Python forgets an interruption that comes while a destructor runs. A run of the
    tests in the background ignores the signal, so its handler is set here.
    """
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)
    main, ended = threading.get_ident(), threading.Event()

    def watch() -> None:
        while not ended.wait(0.01):
            frame = sys._current_frames().get(main)
            while frame is not None:
                if frame.f_code.co_name == function:
                    _thread.interrupt_main()
                    ended.wait(1)
                    break
                frame = frame.f_back

    watcher = threading.Thread(target=watch)
    watcher.start()
    try:
        yield
    finally:
        ended.set()
        watcher.join()
        signal.signal(signal.SIGINT, handler)


def test_ctrl_c_ends_a_comparison_with_what_is_known(tmp_path: Path) -> None:
    """The command said "interrupted", and nothing of the charts that it had compared."""
    project = sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml")
    target = tmp_path / "out.xml"
    with pytest.raises(ComparisonInterrupt) as stop, interrupted_in("equivalent"):
        sfc.save(project, target, format="plcopen-2.01", partial=True, limit=60)
    assert isinstance(stop.value, KeyboardInterrupt)
    told = stop.value.report.compared
    assert {chart.report_path for chart in project.charts()} == set(told)
    assert any("interrupted" in each for each in told.values())
    assert not target.exists()


def test_ctrl_c_shows_what_is_known(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = tmp_path / "out.xml"
    source = str(FIXTURES / "codesys" / "sorting_conveyor.xml")
    with interrupted_in("equivalent"):
        code = run(["convert", source, str(target), "--to", "plcopen-2.01", "--partial", "--limit", "60"])
    output = capsys.readouterr()
    assert code == 130
    assert "interrupted" in output.out
    assert "interrupted: nothing is written" in output.err
    assert not target.exists()


@pytest.mark.parametrize("target", ["codesys", "simaticml", "plcopen-2.01"])
def test_steps_that_no_input_leads_to_are_told_with_a_verdict_that_is_equal(target: str) -> None:
    """A proof of one state was all that a user saw of a chart whose first condition is never TRUE."""
    never = sfc.loads(CHART.replace(":= a;", ":= a AND NOT a;", 1).format(**NOTHING).encode(), format="iec-text")
    lines = saved(never, target).compared["POU Main"].splitlines()
    assert lines[0].startswith("equal")
    assert "not reached: steps S1, S2: unreachable (proven)" in lines
    assert not any("not reached" in line for line in saved(chart("q(N);"), target).compared["POU Main"].splitlines())


NOTHING = {"first": "q(N);", "second": "", "initial": "", "edge": "", "actions": ""}
