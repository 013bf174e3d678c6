"""Comparisons of programs that call what their file does not contain."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.analysis import Verdict, VerdictKind, equivalent
from plcopen_sfc.errors import UnknownFunctionError
from plcopen_sfc.model import Project

CALLS = "calls of unknown blocks"


def program(body: str) -> Project:
    text = f"""PROGRAM Main VAR_INPUT a, b : BOOL; level : INT; END_VAR VAR_OUTPUT q : BOOL; n : INT; END_VAR
        VAR inst, other : Vendor; old : BOOL; END_VAR {body} END_PROGRAM"""
    return sfc.loads(text.encode(), format="iec-text")


def compared(first: str, second: str, **more: int) -> Verdict:
    return equivalent(program(first), program(second), outputs=["q", "n"], **more)


def names(verdict: Verdict) -> set[str]:
    assert verdict.counterexample is not None, str(verdict)
    return {each.name for each in verdict.counterexample.differences}


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ("q := F(a, level);", "q := F(a, level);"),
        ("q := F(a);", "IF a THEN q := F(TRUE); ELSE q := F(FALSE); END_IF;"),
        ("q := F(x := a) AND b;", "IF b THEN q := F(x := a); ELSE q := FALSE; END_IF;"),
        ("n := G(level);", "n := G(level);"),
        ("n := G(level) + 1; q := H(n);", "n := G(level) + 1; q := H(n);"),
        ("IF a THEN Count(level); END_IF;", "IF NOT a THEN ; ELSE Count(level); END_IF;"),
        ("inst(IN := a); q := inst.Q;", "inst(IN := a); q := inst.Q;"),
        ("inst(IN := a, Q => q);", "inst(IN := a, Q => old); q := old;"),
        ("inst(IN := a); other(IN := b); q := inst.Q;", "other(IN := b); inst(IN := a); q := inst.Q;"),
        ("q := inst.Ready(); inst(IN := a);", "q := inst.Ready(); inst(IN := a);"),
        ("inst.Mode := b; inst(IN := a); q := inst.Q;", "inst.Mode := b; inst(IN := a); q := inst.Q;"),
        ("Lib.Start(EN := a, Step := level);", "IF a THEN Lib.Start(Step := level); END_IF;"),
    ],
)
def test_equal_calls_are_proven(first: str, second: str) -> None:
    verdict = compared(first, second)
    assert verdict.proven, str(verdict)
    assert verdict.unknown
    assert f"unknown, taken as functions of what they are given: {', '.join(verdict.unknown)}" in str(verdict)
    assert verdict.as_dict()["unknown"] == list(verdict.unknown)


@pytest.mark.parametrize(
    ("first", "second", "shown"),
    [
        ("q := F(a, level);", "q := F(b, level);", {"q"}),
        ("q := F(level);", "q := F(level + 1);", {"q"}),
        ("q := F(level);", "q := F(5);", {"q"}),
        ("q := F(a);", "q := NOT F(a);", {"q"}),
        ("q := F(a);", "q := G(a);", {"q"}),
        ("n := G(level) + 1;", "n := G(level);", {"n"}),
        ("IF a THEN Count(level); END_IF;", "", {CALLS}),
        ("IF a THEN Count(level); END_IF;", "IF a THEN Count(level); Count(level); END_IF;", {CALLS}),
        ("IF a THEN Count(level); END_IF;", "IF a THEN Count(5); END_IF;", {CALLS}),
        ("inst(IN := a); q := inst.Q;", "q := inst.Q; inst(IN := a);", {"q"}),
        ("inst(IN := a); q := inst.Q;", "other(IN := a); q := other.Q;", {CALLS}),
        ("inst.Mode := b; inst(IN := a);", "inst.Mode := NOT b; inst(IN := a);", {CALLS}),
        ("inst(IN := a); q := inst.Q;", "inst(IN := a AND NOT old); q := inst.Q; old := a;", {CALLS}),
    ],
)
def test_other_calls_are_a_difference(first: str, second: str, shown: set[str]) -> None:
    verdict = compared(first, second)
    assert verdict.kind is VerdictKind.DIFFERENT, str(verdict)
    assert shown <= names(verdict)
    assert "unknown, taken as" in str(verdict)


@pytest.mark.slow
def test_results_are_the_same_in_every_scan() -> None:
    """A search finds a difference where a function answers otherwise later, which it cannot: that is none."""
    verdict = compared("q := F(TRUE);", "IF NOT old THEN q := F(TRUE); END_IF; old := TRUE;")
    assert verdict.kind is VerdictKind.TESTED, str(verdict)
    assert "results of F may tell them apart" in verdict.reason


def test_blocks_depend_on_the_calls_before() -> None:
    rising = "inst(IN := a); q := inst.Q;"
    verdict = compared(rising, f"IF b THEN inst(IN := a); END_IF; {rising}")
    assert verdict.kind is VerdictKind.DIFFERENT
    assert CALLS in names(verdict)


@pytest.mark.slow
def test_a_delay_of_calls_is_tried() -> None:
    later = "q := old; inst(IN := a); old := inst.Q;"
    verdict = equivalent(program("q := F(a);"), program("q := F(old); old := a;"), delay=1, outputs=["q"])
    assert verdict.kind is VerdictKind.TESTED, str(verdict)
    assert (
        compared("inst(IN := a); q := inst.Q;", later, delay=1).kind is VerdictKind.DIFFERENT
    )  # the calls are not late


def test_the_same_arguments_give_the_same_verdict() -> None:
    first, second = (compared("q := F(level);", "q := F(level + 1);") for _ in range(2))
    assert first == second


def test_supplied_functions_are_known() -> None:
    project = program("q := F(level);")
    verdict = equivalent(project, program("q := level > 3;"), outputs=["q"], functions={"F": lambda level: level > 3})
    assert not verdict.different
    assert not verdict.unknown
    with pytest.raises(UnknownFunctionError):
        sfc.simulate(project, scans=1)
