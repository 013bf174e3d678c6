"""Equal things in other spellings: the report does not list them as different."""

from __future__ import annotations

import re

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis.equivalence import equivalent
from plcopen_sfc.languages.networks import DrawingRules, draw_ld
from plcopen_sfc.languages.st import parse_statements
from plcopen_sfc.pages.page_words import german
from plcopen_sfc.report import Item, Outcome

RING = """FUNCTION_BLOCK Main
VAR_INPUT a, b, c : BOOL; END_VAR
VAR_OUTPUT n : INT; r : BOOL; END_VAR
INITIAL_STEP S0: END_STEP
TRANSITION FROM S0 TO S1 := a; END_TRANSITION
STEP S1: Pulse(P); Count(N); END_STEP
TRANSITION FROM S1 TO S0 := b; END_TRANSITION
ACTION Pulse: r := NOT r; END_ACTION
ACTION Count: n := n + 1; END_ACTION
END_FUNCTION_BLOCK
"""


def ring(text: str = RING, format: str = "iec-text") -> m.Project:
    """The chart as a file of `format`."""
    return sfc.loads(sfc.convert(sfc.loads(text.encode(), format="iec-text"), format)[0], format=format)


def losses(project: m.Project, target: str) -> list[Item]:
    return sfc.convert(project, target, partial=True)[1].losses


@pytest.mark.parametrize(
    ("spelled", "meant"), [("PT0S", "T#0ms"), ("PT0.05S", "T#50ms"), ("PT1M", "T#1m"), ("10ms", "T#10ms")]
)
def test_intervals_are_equal_however_they_are_spelled(spelled: str, meant: str) -> None:
    project = ring(
        "PROGRAM Main\nEND_PROGRAM\nCONFIGURATION C RESOURCE R ON PLC TASK T(INTERVAL := T#9ms, PRIORITY := 1);"
        " END_RESOURCE END_CONFIGURATION",
        "plcopen",
    )
    task = project.configurations[0].resources[0].tasks[0]
    task.interval = spelled
    data, report = sfc.convert(project, "iec-text", partial=True)
    assert meant in data.decode()
    assert [item for item in report.losses if item.what == "interval"] == []


@pytest.mark.parametrize(
    ("interval", "clock"), [("T#1m20ms", "00:01:00.02"), ("T#5s", "00:00:05"), ("TIME#90m", "01:30:00")]
)
def test_an_interval_is_a_clock_time_in_the_first_version_of_tc6(interval: str, clock: str) -> None:
    project = ring(
        f"PROGRAM Main\nEND_PROGRAM\nCONFIGURATION C RESOURCE R ON PLC TASK T(INTERVAL := {interval}, PRIORITY := 1);"
        " END_RESOURCE END_CONFIGURATION",
        "plcopen",
    )
    data, report = sfc.convert(project, "plcopen-1.01")
    assert f'interval="{clock}"'.encode() in data
    assert report.losses == []
    assert sfc.loads(data).configurations[0].resources[0].tasks[0].interval == interval
    edited = sfc.loads(data.replace(clock.encode(), b"00:00:00.5"))
    assert edited.configurations[0].resources[0].tasks[0].interval == "00:00:00.5"


def test_a_minimum_time_of_a_tc6_chart_is_one_in_codesys() -> None:
    project = ring(format="plcopen")
    next(project.charts()).chart.step("S1").min_time = "T#1s"
    assert [item for item in losses(project, "codesys") if item.what == "min time"] == []


def test_the_order_of_competing_transitions_in_a_file_says_nothing() -> None:
    text = RING.replace(
        "TRANSITION FROM S1",
        "TRANSITION (PRIORITY := 2) FROM S1 TO S0 := c AND b; END_TRANSITION\nTRANSITION (PRIORITY := 1) FROM S1",
    )
    assert [item for item in losses(ring(text), "plcopen") if item.what == "condition"] == []


@pytest.mark.slow
def test_programs_of_beremiz_have_no_final_scan_in_codesys_either() -> None:
    project = ring(format="plcopen")
    project.header.product = "Beremiz"
    data, report = sfc.convert(project, "codesys", partial=True)
    assert report.losses == []
    step = next(sfc.loads(data, as_tool=True).charts()).chart.step("S1")
    assert (step.entry_action, step.main_action, step.actions) == ("Pulse", "Count", [])
    again = sfc.loads(data, as_tool=True)
    profiles = ("beremiz", "codesys")
    assert equivalent(project.pou("Main"), again.pou("Main"), profiles, delay="auto", outputs=["n", "r"], cap=500).equal


@pytest.mark.parametrize("body", ["n := n + 1;", "IF NOT c THEN n := n + 1; END_IF;"])  # a row, a function
def test_programs_of_beremiz_have_no_final_scan_in_tia_portal_either(body: str) -> None:
    """Rows with the event S0 executed them once more, and TIA Portal was told to do so."""
    project = ring(RING.replace("n := n + 1;", body), "plcopen")
    project.header.product = "Beremiz"
    data, report = sfc.convert(project, "simaticml")
    assert report.losses == []
    again = sfc.loads(data)
    again.pou("Main").chart.add_step("S2")
    again.pou("Main").chart.add_transition("S2", "S0", "c")
    edited = sfc.loads(sfc.dumps(again), as_tool=True)  # an edit gives them none either
    assert [row for _, row in edited.pou("Main").chart.associations() if row.event is m.ActionEvent.S0] == []


def test_a_pulse_in_a_tool_with_final_scans_is_told_as_that() -> None:
    project = ring(format="plcopen")
    project.header.product = "Beremiz"
    (told,) = [item.why for item in losses(project, "iec-text") if item.what == "trigger"]
    assert told == "action `Pulse` runs as P with a final scan in tools that read the text, not as P"
    assert "als P mit letztem Durchlauf ausgeführt, nicht als P" in german(told)


def test_an_action_of_several_steps_keeps_its_qualifier_and_its_final_scan_is_named() -> None:
    project = ring(RING.replace("INITIAL_STEP S0:", "INITIAL_STEP S0: Count(N);"), "plcopen")
    project.header.product = "Beremiz"
    told = losses(project, "codesys")
    assert {(item.outcome, item.why) for item in told} == {
        (Outcome.APPROXIMATED, "action `Count` runs once more in CODESYS after the step is left"),
        (
            Outcome.APPROXIMATED,
            "its initial step does more than switch on variables while it is active: CODESYS executes its actions in "
            "the first scan before a transition is tested",
        ),
    }


def test_an_interlock_that_no_text_says_is_told_once() -> None:
    chart = m.SfcNetwork()
    step = chart.add_step("S0", initial=True)
    network = draw_ld(parse_statements("q := a AND (b OR c);", m.Dialect.IEC).tree.statements, DrawingRules()).body
    step.interlock = m.Supervised(condition=m.BodyCondition(body=network))
    pou = m.Pou(name="Main", kind=m.PouKind.FUNCTION_BLOCK, bodies=[m.SfcBody(chart=chart)])
    told = losses(m.Project(name="P", dialect=m.Dialect.IEC, pous=[pou]), "iec-text")
    assert [item.what for item in told].count("interlock") == 1


def test_a_name_that_stands_for_what_no_text_says_is_part_of_the_reason() -> None:
    body = m.OpaqueBody(source="vendor", content="<x/>")
    project = m.Project(
        name="P", dialect=m.Dialect.IEC, pous=[m.Pou(name="Main", kind=m.PouKind.PROGRAM, bodies=[body])]
    )
    told = losses(project, "iec-text")
    assert [item.what for item in told] == ["body"]
    assert "the undeclared name NOT_EXECUTED_Main is in its place" in told[0].why


@pytest.mark.parametrize("target", ["codesys23", "twincat", "plcopen-2.01"])
def test_a_main_action_that_nothing_declares_is_its_call(target: str) -> None:
    """In a folder of TwinCAT it is in another file; a text has the call in place."""
    text = "PROGRAM Main INITIAL_STEP S0: END_STEP TRANSITION FROM S0 TO S0 := TRUE; END_TRANSITION END_PROGRAM"
    project = sfc.loads(text.encode(), format="iec-text")
    project.dialect = m.Dialect.CODESYS
    (chart,) = project.charts()
    chart.chart.step("S0").main_action = "S0_active"
    _, report = sfc.convert(project, target, partial=True)
    assert [item.why for item in report.losses if "report this as a mistake" in item.why] == []


@pytest.mark.parametrize("name", ["1 Fill", "Fill-Up", "compr. air", "Fill.", "IF", "a  b"])
@pytest.mark.parametrize("target", ["iec-text", "codesys", "codesys23", "simaticml"])
def test_steps_with_names_of_another_tool_do_the_same_elsewhere(name: str, target: str) -> None:
    """Texts spelled such a step in their own way, and it was called not executed; CODESYS does not compile it."""
    source = sfc.convert(sfc.loads(RING.encode(), format="iec-text"), "plcopen")[0]
    project = sfc.loads(source.replace(b'"S1"', f'"{name}"'.encode()), format="plcopen")
    data, report = sfc.convert(project, target, partial=True)
    assert [item for item in report.losses if "step" in item.what or "transition" in item.what] == []
    there = sfc.loads(data, format=target, as_tool=True)
    steps = [step.name for step in there.pous[0].chart.steps]
    assert len(steps) == 2
    if target != "simaticml":  # which puts names in quotes
        assert all(re.fullmatch(r"[^\W\d]\w*", each) for each in steps)
    named = name if target == "iec-text" else next(each for each in steps if each != "S0")
    assert [step.name for step in sfc.loads(data, format=target).pous[0].chart.steps if step.name != "S0"] == [named]


def test_a_step_of_a_text_that_other_texts_name_keeps_what_the_tool_sees() -> None:
    """`FROM` is a name in CODESYS and none in textual SFC: texts that name the step mean none there."""
    text = RING.replace("S1", "Busy").replace(":= b;", ":= Busy.x AND b;")
    source = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "codesys")[0]
    project = sfc.loads(source.replace(b"Busy", b"FROM"), format="codesys")
    _, report = sfc.convert(project, "iec-text", partial=True)
    assert any("FROM" in item.path for item in report.losses)


def test_long_names_get_shorter_ones_in_tia_and_their_own_again_elsewhere() -> None:
    """TIA Portal takes names of 128 characters, those of blocks of 125: longer ones were written without a word."""
    long = "Fill_the_tank_" * 10
    project = sfc.loads(re.sub(r"\b[bn]\b", lambda found: long + found[0], RING).encode(), format="iec-text")
    data, report = sfc.convert(project, "simaticml", partial=True)
    told = " in TIA Portal: TIA Portal takes names of 125 characters"
    assert len([item for item in report.items if item.what == "name" and item.why.endswith(told)]) == 2
    there = sfc.loads(data, format="simaticml")
    assert max(len(variable.name) for variable in there.pous[0].variables()) < 125
    back = sfc.loads(sfc.convert(there, "iec-text", partial=True)[0], format="iec-text")
    assert {long + "b", long + "n"} <= {variable.name for variable in back.pous[0].variables()}


@pytest.mark.parametrize("target", ["codesys", "twincat"])
def test_operators_of_codesys_in_a_text_are_no_unknown_names_there(target: str) -> None:
    """`ADR` was called declared nowhere, and CODESYS said not to compile it."""
    text = RING.replace("r : BOOL;", "r : BOOL; p : POINTER TO INT;").replace("n := n + 1;", "p := ADR(n);")
    assert [item for item in losses(sfc.loads(text.encode(), format="iec-text"), target) if "ADR" in item.why] == []


def test_the_pulse_of_a_variable_that_other_steps_have_as_n_is_executed() -> None:
    """Only other pulses of one action control could hide it; S7-GRAPH has no such control."""
    text = "STEP S1: q(P); END_STEP\nTRANSITION FROM S1 TO S2 := b; END_TRANSITION\nSTEP S2: {}; END_STEP\n"
    text = RING[: RING.index("STEP S1")] + text + "TRANSITION FROM S2 TO S0 := c; END_TRANSITION\nEND_FUNCTION_BLOCK\n"
    text = text.replace("r : BOOL", "q : BOOL")
    assert losses(sfc.loads(text.format("q(N)").encode(), format="iec-text"), "simaticml") == []
    (item,) = losses(sfc.loads(text.format("q(P)").encode(), format="iec-text"), "simaticml")[:1]
    assert item.why == "action `q` is controlled otherwise in TIA Portal: it also belongs to other steps"


def test_the_control_of_an_action_of_two_steps_is_told_as_such() -> None:
    """The report had that it runs as entry action and not as P1, which is the same but for the other step."""
    text = RING[: RING.index("STEP S1")] + "STEP S1: Count(P1); END_STEP\n"
    text += "TRANSITION FROM S1 TO S2 := b; END_TRANSITION\n"
    text += "STEP S2: Count(P1); END_STEP\nTRANSITION FROM S2 TO S0 := c; END_TRANSITION\n"
    text += "ACTION Count: n := n + 1; END_ACTION\nEND_FUNCTION_BLOCK\n"

    def told(text: str) -> set[str]:
        found = losses(sfc.loads(text.encode(), format="iec-text"), "codesys")
        return {item.why for item in found if item.what == "trigger"}

    assert told(text) == {"action `Count` is controlled otherwise in CODESYS: it also belongs to other steps"}
    assert told(text.replace("S2: Count(P1)", "S2: ")) == set()


@pytest.mark.parametrize("target", ["codesys", "plcopen-2.01", "simaticml", "twincat"])
@pytest.mark.parametrize(
    "text",
    [
        "VAR x, X : BOOL; END_VAR x := TRUE;",
        "VAR x : BOOL; END_VAR x := TRUE; ACTION a: x := FALSE; END_ACTION ACTION A: x := TRUE; END_ACTION",
    ],
)
def test_two_things_of_one_name_are_told_in_every_tool(text: str, target: str) -> None:
    """They were kept, and no tool compiles them."""
    project = sfc.loads(f"PROGRAM Main {text} END_PROGRAM".encode(), format="iec-text")
    report = sfc.convert(project, target, partial=True)[1]
    told = [item.why for item in report.with_outcome(Outcome.NOT_EXECUTED) if "a second" in item.why]
    assert told
    assert all("zweites Element" in german(why) for why in told)
