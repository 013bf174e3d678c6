"""A comparison ends when its time is over, whatever it compares."""

from __future__ import annotations

from time import sleep, thread_time

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.analysis import Verdict, VerdictKind, equivalence, equivalent
from plcopen_sfc.analysis.search_limits import SearchWatch, seconds
from plcopen_sfc.analysis.systems import ProgramSystem
from plcopen_sfc.analysis.verdict import UntestedError
from plcopen_sfc.errors import InputError
from plcopen_sfc.model import Project

_LATE = 4.0
"""Seconds of processor time that a comparison may need to say what it has found."""


def project(leave: str, body: str = "q := c;") -> Project:
    text = f"""
    PROGRAM Main VAR_INPUT a, c : BOOL; END_VAR VAR_OUTPUT q : BOOL; END_VAR VAR i, k : DINT; END_VAR
    INITIAL_STEP Rest: END_STEP
    STEP Run: Fill(N); END_STEP
    STEP Long: END_STEP
    TRANSITION FROM Rest TO Run := a; END_TRANSITION
    TRANSITION FROM Run TO Long := Run.T > T#100ms; END_TRANSITION
    TRANSITION FROM Long TO Rest := {leave}; END_TRANSITION
    ACTION Fill: {body} END_ACTION
    END_PROGRAM"""
    return sfc.loads(text.encode(), format="iec-text")


def limited(one: Project, other: Project, **options: object) -> Verdict:
    started = thread_time()
    verdict = equivalent(one, other, "iec", limit=0.5, **options)  # type: ignore[arg-type]
    assert thread_time() - started < 0.5 + _LATE
    return verdict


def test_a_difference_after_a_day_is_found_in_time_and_told_shortly() -> None:
    verdict = equivalent(project("Long.T > T#24h"), project("Long.T > T#25h"), "iec", cap=200)
    assert verdict.counterexample is not None
    assert len(verdict.counterexample.inputs) > 1_000_000
    assert len(str(verdict).splitlines()) < 40
    assert [each.name for each in verdict.counterexample.differences] == ["Rest.X", "Long.X"]


@pytest.mark.slow
@pytest.mark.parametrize("delay", [0, "auto"])
def test_long_scans_end_in_time(delay: int | str) -> None:
    looping = "FOR i := 0 TO 100000 DO k := k + i MOD 7; END_FOR; q := k > 5;"
    verdict = limited(project("c", looping), project("c", looping), delay=delay)
    assert verdict.kind is VerdictKind.UNTESTED
    assert "time limit" in verdict.reason


def test_a_limit_counts_no_time_in_which_others_use_the_processor() -> None:
    """By the wall clock a proof became a test where the machine was busy."""
    watch = SearchWatch(0.4, None, lambda: (0, 0))
    sleep(0.3)  # more than the half of it that is for the proof
    assert watch.look(0) == ""


def test_nothing_is_called_equal_before_the_first_scan() -> None:
    verdict = equivalent(project("Long.T > T#24h"), project("Long.T > T#25h"), "iec", limit=0.000_001)
    assert (verdict.equal, verdict.scans) == (False, 0)
    assert "no scan was run" in str(verdict)
    assert "equal" not in str(verdict)


def test_no_more_delays_are_prepared_than_there_is_time_for(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[object] = []
    monkeypatch.setattr(equivalence, "ProgramSystem", lambda *a, **k: made.append(a) or ProgramSystem(*a, **k))
    both = project("c"), project("NOT c")
    verdict = equivalent(*both, ("iec", "codesys"), delay="auto", limit=0.000_001)
    assert verdict.kind is VerdictKind.UNTESTED  # other delays might do, so nothing is called different either
    assert verdict.delay.retimed  # the likeliest delay between tools that execute actions first and last
    assert len(made) == 4  # two to look at, two to compare
    assert "(proven)" not in str(verdict)  # and no time for reasons


@pytest.mark.parametrize("limit", ["abc", "5 x", "T#1", "0s", "1,5"])
def test_a_limit_that_is_none_is_called_so(limit: str) -> None:
    with pytest.raises(InputError, match=f"'{limit}' is no time limit"):
        equivalent(project("c"), project("c"), "iec", limit=limit)


@pytest.mark.slow
def test_what_several_delays_have_used_up_is_told_by_the_whole_limit() -> None:
    looping = "FOR i := 0 TO 100000 DO k := k + i MOD 7; END_FOR; q := k > 5;"
    verdict = limited(project("c", looping), project("c", looping), delay=[0, 1, 2])
    assert "the time limit of 0.5 s was reached" in verdict.reason
    assert "-" not in verdict.reason


@pytest.mark.parametrize(
    ("limit", "expected"), [("5", 5), ("2.5", 2.5), (3, 3), ("60s", 60), ("2m", 120), ("1ms", 0.001)]
)
def test_a_limit_is_a_number_of_seconds_or_has_a_unit(limit: float | str, expected: float) -> None:
    assert seconds(limit) == expected


def test_lowering_tells_the_limit_that_it_was_given() -> None:
    with pytest.raises(UntestedError, match=r"the time limit of 0\.001 s"):
        sfc.lower(project("Long.T > T#24h"), limit="1ms")
