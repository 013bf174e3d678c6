"""Timers that only wait: their elapsed time makes no difference beyond what it is compared with."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.analysis import Verdict, VerdictKind, equivalent
from plcopen_sfc.analysis.systems import ProgramSystem
from plcopen_sfc.analysis.timers import clocking, waiting_timers
from plcopen_sfc.model import SfcBody, SfcNetwork, StBody
from plcopen_sfc.semantics.profile import profile
from plcopen_sfc.semantics.subjects import resolve
from tests.analysis.schemes import program

MS = 1_000_000
DAY = 24 * 60 * 60 * 1000
VARIABLES = ["t, u : TON", "a, b : BOOL", "e : TIME"]


def limits(text: str, *observed: str) -> list[int]:
    subject = resolve(program(text, ["i", "k"], VARIABLES))
    instance = ProgramSystem(subject, profile("iec"), clocking([subject], None)).instance
    return [timer.limit // MS for timer in waiting_timers(instance, observed, 10 * MS)]


@pytest.mark.parametrize(
    ("text", "limit"),
    [
        ("t(IN := i, PT := T#1d); a := t.ET >= T#50ms;", [61]),
        ("t(IN := i, PT := T#1d); a := T#70ms < (t.ET) AND k OR NOT (t.ET <> T#20ms);", [81]),
        ("IF k THEN t(IN := t.ET < T#3s, PT := T#1d); END_IF; a := t.ET >= T#50ms;", [3011]),
        ("t(IN := i, PT := T#1d);", [11]),
        ("t(IN := i, PT := T#60ms); a := t.ET >= T#50ms;", [61]),
        ("t(IN := i, PT := T#1d); a := t.ET >= T#50ms OR t.Q;", [DAY + 11]),
        ("IF k THEN t(IN := i, PT := T#2s); ELSE t(IN := i, PT := T#3s); END_IF; a := t.Q;", [3011]),
        ("t(IN := i, PT := T#1d); e := t.ET;", [DAY + 11]),
        ("t(IN := i, PT := T#1d, ET => e); a := t.ET >= T#50ms;", []),
        ("t(IN := i, PT := e); a := t.ET >= T#50ms;", []),
        ("t(IN := i); a := t.ET >= T#50ms;", []),
        ("t(i, T#1d); a := t.ET >= T#50ms;", []),
        ("t(IN := i, PT := T#1d); a := t.ET >= e;", [DAY + 11]),
        ("t(IN := i, PT := T#1d); a := t.ET + T#1s >= T#5s;", [DAY + 11]),
        ("t(IN := i, PT := T#1d); t(IN := k, PT := e); a := t.Q;", []),
        ("t(IN := i, PT := T#1d); t.PT := e; a := t.Q;", []),
        ("t(IN := i, PT := T#1d); u := t; a := t.ET >= T#50ms;", []),
    ],
)
def test_which_timers_only_wait(text: str, limit: list[int]) -> None:
    assert limits(text) == limit


def test_what_is_looked_at_behind_a_scan_counts() -> None:
    text = "t(IN := i, PT := T#1d); a := t.ET >= T#50ms;"
    assert limits(text, "a") == [61]
    assert limits(text, "t.Q") == [DAY + 11]


def waiting(condition: str, tested: str) -> Verdict:
    chart = SfcNetwork()
    first, second = chart.add_step("A", initial=True), chart.add_step("B")
    chart.add_transition(first, second, condition)
    chart.add_transition(second, first, "c1")
    text = f"""
    t(IN := x, PT := T#24d);
    IF x AND {tested} THEN x := FALSE; ELSIF NOT x AND c1 THEN x := TRUE; END_IF;
    t(IN := x, PT := T#24d);
    """
    code = program(text, ["c0", "c1"], ["x : BOOL := TRUE", "t : TON"])
    return equivalent(chart, code, "iec", step_flags={"A": "x"}, cap=100, runs=0)


def test_a_step_that_waits_longer_than_its_time_is_proven() -> None:
    assert waiting("A.T >= T#50ms AND c0", "t.ET >= T#50ms AND c0").proven
    assert waiting("A.T < T#50ms AND c0", "NOT (t.ET >= T#50ms) AND c0").proven
    assert waiting("A.T >= T#50ms AND c0", "t.ET > T#50ms AND c0").kind is VerdictKind.DIFFERENT
    assert waiting("A.T >= T#50ms AND c0", "t.ET >= T#75ms AND c0").kind is VerdictKind.DIFFERENT
    assert (
        waiting("A.T >= T#50ms AND c0", "t.ET >= T#50ms AND (t.ET < T#1s OR c1) AND c0").kind is VerdictKind.DIFFERENT
    )


def test_a_timer_that_nobody_calls_any_more_does_not_go_on() -> None:
    """A main action starts it, and does not see the end of its step."""
    chart = SfcNetwork()
    first, second = chart.add_step("A", initial=True), chart.add_step("B")
    chart.add_transition(first, second, "c0")
    chart.add_transition(second, first, "c1")
    first.main_action = StBody(text="t(IN := TRUE, PT := T#50ms); Q := t.Q;")
    code = program("", ["c0", "c1"], ["t : TON", "Q : BOOL"])
    pou = code.model_copy(update={"bodies": [SfcBody(chart=chart)]})
    text = """
    {} t(IN := TRUE, PT := T#{}ms); Q := t.Q; END_IF;
    IF x AND c0 THEN x := FALSE; ELSIF NOT x AND c1 THEN x := TRUE; END_IF;
    """
    right, wrong, always = (
        program(text.format(when, time), ["c0", "c1"], ["x : BOOL := TRUE", "t : TON", "Q : BOOL"])
        for when, time in (("IF x THEN", 50), ("IF x THEN", 60), ("IF TRUE THEN", 50))
    )
    assert equivalent(pou, right, "codesys", outputs=["Q"], scan_time="10ms", cap=100, runs=0).proven
    for other in (wrong, always):
        found = equivalent(pou, other, "codesys", outputs=["Q"], scan_time="10ms", cap=100)
        assert found.kind is VerdictKind.DIFFERENT


def test_the_time_of_the_only_step_in_a_macro_step_is_kept() -> None:
    """A macro-step has the start of its only step: who forgot its time forgot that of the step, which is asked for."""
    text = """PROGRAM Main
VAR_INPUT a : BOOL; END_VAR
VAR_OUTPUT q : BOOL; END_VAR
INITIAL_STEP S1: END_STEP
STEP S2: q(N); END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S1 := S2.T > T#1s; END_TRANSITION
END_PROGRAM
"""
    plain, moved = (sfc.loads(text.encode(), format="iec-text") for _ in range(2))
    moved.edit().move_to_macro(["Main.S2"], "M1")
    assert sfc.equivalent(plain, moved).proven
