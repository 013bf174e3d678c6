"""Conditions in texts: what was never TRUE, never FALSE or never decided is named, and the search solves for it."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.analysis import Verdict, VerdictKind, equivalent
from plcopen_sfc.model import Project

HARD = "(w XOR 16#1234) = 16#0FF0"
"""z3 does not solve it for w, and chance does not find the one value."""


def project(body: str, around: str = "", declarations: str = "") -> Project:
    text = f"""{around}
PROGRAM Main
VAR_INPUT a, b : BOOL; n, m : INT; w : WORD; END_VAR
VAR_OUTPUT q : BOOL; r : INT; END_VAR
{declarations}
{body}
END_PROGRAM
"""
    return sfc.loads(text.encode(), format="iec-text")


def compare(one: str, other: str, around: tuple[str, str] = ("", ""), declarations: str = "") -> Verdict:
    left, right = (project(body, a, declarations) for body, a in zip((one, other), around, strict=True))
    return equivalent(left.pou("Main"), right.pou("Main"), "iec", runs=30, scans=100)


ACTION = """INITIAL_STEP S1: END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
STEP S2: Add(N); END_STEP
TRANSITION FROM S2 TO S1 := NOT a; END_TRANSITION
ACTION Add: {} END_ACTION"""
EDGE = "VAR edge : R_TRIG; count : CTU; END_VAR"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("one", "other", "named"),
    [
        (f"IF NOT ({HARD}) THEN r := n; END_IF;", "r := n;", "was never FALSE"),
        (
            f"IF a THEN r := 1; ELSIF NOT ({HARD}) THEN r := n; END_IF;",
            "IF a THEN r := 1; ELSE r := n; END_IF;",
            "FALSE",
        ),
        (f"IF {HARD} THEN RETURN; END_IF; r := n;", "r := n;", "was never TRUE"),
        (f"FOR r := 0 TO 5 DO IF {HARD} THEN EXIT; END_IF; END_FOR;", "FOR r := 0 TO 5 DO ; END_FOR;", "never TRUE"),
        (f"r := 0; WHILE r < 3 AND NOT ({HARD}) DO r := r + 1; END_WHILE;", "r := 3;", "never decided it"),
        (f"r := 0; REPEAT r := r + 1; UNTIL r > 2 OR {HARD} END_REPEAT;", "r := 3;", "never decided it"),
        ("CASE w XOR 16#1234 OF 16#0FF0: ; ELSE r := n; END_CASE;", "r := n;", "was never TRUE"),
        (f"r := SEL({HARD}, 1, 2);", "r := 1;", "was never TRUE"),
        (f"r := BOOL_TO_INT({HARD});", "r := 0;", "was never TRUE"),
        (f"edge(CLK := {HARD}); q := edge.Q;", "edge(CLK := FALSE); q := edge.Q;", "was never TRUE"),
        (f"IF {HARD} THEN count(CU := a, R := FALSE, PV := 3); END_IF; r := n / 3;", "r := n / 3;", "was never TRUE"),
        (f"q := a OR {HARD}; r := n / 3;", "q := a; r := n / 3;", "never decided it"),
    ],
)
@pytest.mark.parametrize("place", ["program", "action"])
def test_a_condition_that_never_had_an_outcome_is_named(one: str, other: str, named: str, place: str) -> None:
    if place == "action":
        one, other = ACTION.format(one), ACTION.format(other)
    verdict = compare(one, other, declarations=EDGE)
    assert verdict.kind is VerdictKind.UNTESTED
    assert any(named in str(each) and "XOR" in str(each) for each in verdict.coverage[0].untested), str(verdict)


FUNCTION = "FUNCTION F : INT VAR_INPUT w : WORD; n : INT; END_VAR {} END_FUNCTION"
BLOCK = "FUNCTION_BLOCK B VAR_INPUT w : WORD; n : INT; END_VAR VAR_OUTPUT r : INT; END_VAR {} END_FUNCTION_BLOCK"


@pytest.mark.parametrize(
    ("declared", "call", "result"),
    [(FUNCTION, "r := F(w := w, n := n);", "F"), (BLOCK, "i(w := w, n := n, r => r);", "r")],
)
def test_conditions_of_what_is_called_count_unless_it_is_the_same_on_both_sides(
    declared: str, call: str, result: str
) -> None:
    instance = "VAR i : B; END_VAR" if "i(" in call else ""
    hard, plain = (
        declared.format(text) for text in (f"IF NOT ({HARD}) THEN {result} := n; END_IF;", f"{result} := n;")
    )
    verdict = compare(call, call, (hard, plain), instance)
    assert verdict.kind is VerdictKind.UNTESTED
    assert [str(each) for each in verdict.coverage[0].untested] == [
        f"condition {declared.split()[1]}: `NOT ({HARD})` was never FALSE"
    ]
    assert compare(call, call, (hard, hard), instance).equal


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("IF n > m AND n < 105 THEN q := TRUE; ELSE q := FALSE; END_IF;", ("105", "104")),
        ("q := n > m AND n < 105;", ("105", "104")),
        ("IF a OR n * 3 = m + 1234 THEN RETURN; END_IF; r := r + n / 3;", ("1234", "1235")),
        ("r := SEL(n + m > 777, 1, 2);", ("777", "778")),
        ("r := 0; WHILE r < n AND r < 20 DO r := r + 1; END_WHILE; r := r + m / 3;", ("20", "21")),
        (ACTION.format("IF n > m AND n < 105 THEN q := TRUE; ELSE q := FALSE; END_IF;"), ("105", "104")),
        (ACTION.format("r := n / 3;").replace("NOT a;", "n > m AND n < 105;"), ("105", "104")),
        ("CASE n - m OF 1017..1030: r := 1; ELSE r := 2; END_CASE;", ("1017", "1018")),
    ],
)
def test_bounds_of_conditions_are_solved(one: str, other: tuple[str, str]) -> None:
    assert compare(one, one.replace(*other)).different


@pytest.mark.parametrize(
    "body",
    [
        "IF n > 5 THEN IF n > 3 THEN r := m / 3; END_IF; END_IF;",
        "IF n > 5 AND n > 3 THEN ; END_IF; r := m / 3;",
        "r := 0; WHILE r < 3 DO r := r + 1; END_WHILE; r := m / 3;",
        "FOR r := 0 TO 5 DO ; END_FOR; r := m / 3;",
        "r := SEL(n > 32766 AND n < 5, n / 3, m);",
        "IF a AND NOT a THEN RETURN; END_IF; r := m / 3;",
    ],
)
def test_outcomes_that_are_impossible_are_not_demanded(body: str) -> None:
    verdict = compare(body, body)
    assert verdict.equal, str(verdict)


@pytest.mark.slow
def test_an_index_that_is_an_input_goes_through_all_elements() -> None:
    table = "VAR CONSTANT t : ARRAY[0..199] OF INT := [137({0}), {1}, 62({0})]; END_VAR"
    left, right = (project("r := t[n];", declarations=table.format(0, value)) for value in (1, 2))
    verdict = equivalent(left, right, "iec")
    assert verdict.different, str(verdict)
    assert verdict.counterexample is not None
    assert verdict.counterexample.inputs[-1]["n"] == 137


def test_a_proof_needs_no_outcomes() -> None:
    body = "IF NOT a THEN q := b; END_IF;"
    assert compare(body, body).proven


def test_actions_of_a_program_that_nothing_calls_do_not_count() -> None:
    body = "r := r + n / 3; Used();\n{} ACTION Used: q := a; END_ACTION ACTION Unused: q := b; END_ACTION"
    assert compare(body.format(""), body.format("")).coverage[0].counts["assignment"] == (2, 2)
    called = body.format("").replace("Used();", "Used(); IF n > 5 AND n < 3 THEN Unused(); END_IF;")
    assert compare(called, called).coverage[0].counts["assignment"] == (2, 3)
