"""What a verdict says that it covered, and what not and why."""

from __future__ import annotations

import json

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.analysis import Verdict, VerdictKind, equivalent
from plcopen_sfc.errors import ModelError
from plcopen_sfc.model import Project


def project(declarations: str, transitions: str, steps: str = "INITIAL_STEP A: END_STEP STEP B: END_STEP") -> Project:
    text = f"PROGRAM Main\n{declarations}\n{steps}\n{transitions}\nEND_PROGRAM\n"
    return sfc.loads(text.encode(), format="iec-text")


def against_bits(chart: Project, **options: object) -> Verdict:
    return equivalent(chart, sfc.lower(chart, "bits", verify=False).project, "iec", **options)  # type: ignore[arg-type]


FROZEN = project(
    "VAR Start : BOOL; Limit : INT := 3; END_VAR\nVAR_INPUT Stop : BOOL; END_VAR\nVAR_OUTPUT Q : BOOL; END_VAR",
    "TRANSITION FROM A TO B := Start; END_TRANSITION TRANSITION FROM B TO A := Stop AND Limit > 2; END_TRANSITION",
    "INITIAL_STEP A: END_STEP STEP B: Q(N); END_STEP",
)


def test_a_proof_names_what_it_covered() -> None:
    chart = sfc.load("fixtures/training-chain/plcopen_2.01.xml")
    verdict = against_bits(chart)
    assert verdict.proven
    first, second = verdict.coverage
    assert first.counts == {"step": (4, 4), "transition": (4, 4), "action": (3, 3)}
    assert second.counts["assignment"] == (16, 16)
    assert first.unreached == second.unreached == verdict.frozen == ()
    data = json.loads(json.dumps(verdict.as_dict()))
    assert data["coverage"][0]["counts"]["step"] == {"reached": 4, "all": 4}


def test_frozen_variables_are_named_and_can_be_inputs() -> None:
    frozen = against_bits(FROZEN)
    assert frozen.frozen == ("Limit", "Start")
    assert frozen.coverage[0].counts == {"step": (1, 2), "transition": (0, 2), "action": (0, 1)}
    assert [each.name for each in frozen.coverage[0].unreached if each.kind == "step"] == ["B"]
    assert "needs `Start`" in str(frozen)
    freed = against_bits(FROZEN, free_inputs="start")
    assert freed.proven
    assert freed.coverage[0].counts["step"] == (2, 2)
    assert freed.inputs == ("Start", "Stop")
    assert freed.frozen == ("Limit",)
    everything = against_bits(FROZEN, free_inputs="all")
    assert everything.proven
    assert everything.frozen == ()


@pytest.mark.parametrize("name", ["Q", "Stopp"])
def test_what_is_written_or_unknown_cannot_be_freed(name: str) -> None:
    with pytest.raises(ModelError, match="is no variable that nothing writes"):
        against_bits(FROZEN, free_inputs=name)


def test_a_simulation_sets_freed_variables() -> None:
    trace = sfc.simulate(FROZEN, free_inputs="all", inputs=lambda scan, _: {"Start": scan == 1}, scans=4)
    assert [trace.active(scan) for scan in range(4)] == [("A",), ("B",), ("B",), ("B",)]
    assert trace["Start"].direction == "input"


def test_what_cannot_be_reached_is_proven_by_conditions_and_markings() -> None:
    chart = project(
        "VAR_INPUT c, d : BOOL; n : INT; END_VAR",
        """TRANSITION FROM A TO B := c; END_TRANSITION
        TRANSITION FROM B TO A := d; END_TRANSITION
        TRANSITION FROM B TO C := n > 5 AND n < 3; END_TRANSITION
        TRANSITION FROM C TO A := TRUE; END_TRANSITION
        TRANSITION FROM (A, B) TO D := c; END_TRANSITION""",
        "INITIAL_STEP A: END_STEP STEP B: END_STEP STEP C: END_STEP STEP D: END_STEP",
    )
    verdict = against_bits(chart, cap=1, runs=3)
    missed = {each.name: each for each in verdict.coverage[0].unreached if each.kind == "step"}
    assert set(missed) == {"C", "D"}
    assert all(each.impossible and each.why == "unreachable (proven)" for each in missed.values())


def test_branches_of_programs_are_counted() -> None:
    text = """PROGRAM Main
VAR_INPUT n : INT; c : BOOL; END_VAR
VAR_OUTPUT Q, P : BOOL; END_VAR
Q := c;
IF c AND NOT c THEN P := TRUE; ELSIF n = 7 THEN P := FALSE; END_IF;
CASE n OF 1: Q := TRUE; 2..3: Q := FALSE; ELSE P := c; END_CASE;
END_PROGRAM
"""
    one, other = (sfc.loads(text.encode(), format="iec-text") for _ in range(2))
    verdict = equivalent(one, other, "iec")
    assert verdict.proven
    assert [each.counts for each in verdict.coverage] == [{"assignment": (5, 6)}] * 2
    missed = verdict.coverage[0].unreached[0]
    assert (missed.name, missed.impossible) == ("P := TRUE;", True)
    assert missed.why == "needs `c AND NOT c`, never TRUE (proven)"


COUNTING = """PROGRAM Main VAR_INPUT a, b : BOOL; m : DINT; END_VAR VAR_OUTPUT q : BOOL; END_VAR VAR n : DINT; END_VAR
INITIAL_STEP Rest: END_STEP
STEP Run: Fill(N); END_STEP
TRANSITION FROM Rest TO Run := a; END_TRANSITION
TRANSITION FROM Run TO Rest := b; END_TRANSITION
ACTION Fill: IF {condition} THEN q := {value}; END_IF; n := n + m / 3; END_ACTION
ACTION Unused: q := TRUE; END_ACTION
END_PROGRAM"""


def counting(condition: str, value: str = "TRUE") -> Project:
    return sfc.loads(COUNTING.format(condition=condition, value=value).encode(), format="iec-text")


def searched(one: Project, other: Project) -> Verdict:
    return equivalent(one, other, "iec", cap=20, runs=4, scans=50)


@pytest.mark.parametrize("value", ["TRUE", "FALSE"])
def test_an_assignment_in_an_action_that_was_not_reached_is_named(value: str) -> None:
    far = "n * n = 1000003"
    verdict = searched(counting(far), counting(far, value))
    assert verdict.kind is VerdictKind.UNTESTED
    assert verdict.coverage[0].counts["assignment"] == (1, 3)
    assert [str(each) for each in verdict.coverage[0].untested] == [
        "assignment q := TRUE;: needs `n * n = 1000003`, never reached"
    ]


def test_assignments_that_nothing_executes_are_proven_so() -> None:
    verdict = searched(counting("n > 5 AND n < 3"), counting("n > 5 AND n < 3", "FALSE"))
    assert verdict.kind is VerdictKind.TESTED
    assert [(each.name, each.why) for each in verdict.coverage[0].unreached] == [
        ("q := TRUE;", "needs `n > 5 AND n < 3`, never TRUE (proven)"),
        ("q := TRUE;", "what it stands in is never executed (proven)"),
    ]
    assert searched(counting("n > 3"), counting("n > 3", "FALSE")).different


def test_what_only_terms_have_reached_was_not_reached() -> None:
    """A search with terms in place of numbers looks behind every condition, whether or not numbers get there."""
    one, other = (
        sfc.loads(COUNTING.format(condition="n > 100000000", value=v).replace("m / 3", "m").encode(), format="iec-text")
        for v in ("TRUE", "FALSE")
    )
    assert searched(one, one).proven
    assert searched(one, other).kind is VerdictKind.UNTESTED


PARTS = """PROGRAM Main VAR_INPUT a, b : BOOL; m, n : DINT; END_VAR VAR sum : DINT; END_VAR
INITIAL_STEP S1: END_STEP
STEP S2: Add(N); END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S1 := {}; END_TRANSITION
ACTION Add: sum := sum + m / 3; END_ACTION
END_PROGRAM"""


def decided(one: str, other: str = "") -> Verdict:
    """What a comparison comes to that is no proof, of charts with a condition each."""
    texts = [PARTS.format(condition).encode() for condition in (one, other or one)]
    sides = [sfc.loads(text, format="iec-text") for text in texts]
    return equivalent(*sides, "iec", cap=20, runs=20, scans=40, scan_time="100ms")


@pytest.mark.parametrize("sides", [("b OR n > 100000", "b OR FALSE"), ("b OR FALSE", "b OR n > 100000")])
def test_the_search_makes_parts_of_conditions_decide_them(sides: tuple[str, str]) -> None:
    assert decided(*sides).different
    same = decided("b OR n > 100000")
    assert same.kind is VerdictKind.TESTED, str(same)
    assert same.coverage[0].counts["part of condition"] == (1, 1)


def test_a_part_of_a_condition_may_be_a_long_time() -> None:
    assert decided("b AND m < 7 OR S2.T > T#1h").kind is VerdictKind.TESTED
    assert decided("b AND m < 7 OR S2.T > T#1h", "b AND m < 7").different


def test_a_part_that_never_decided_a_condition_is_named() -> None:
    found = decided("b OR n * n = 1000003", "b OR FALSE")
    assert found.kind is VerdictKind.UNTESTED
    assert [str(each) for each in found.coverage[0].untested] == [
        "transition S2 -> S1: `n * n = 1000003` never decided it"
    ]
    assert "transition S2 -> S1: `n * n = 1000003` never decided it" in str(found)


@pytest.mark.parametrize(
    ("condition", "part"),
    [("b OR n > 7 AND n < 3", "n > 7 AND n < 3"), ("b AND (n < 5 OR n > 3)", "n < 5 OR n > 3")],
)
def test_a_part_that_cannot_decide_a_condition_is_proven_so(condition: str, part: str) -> None:
    found = decided(condition)
    assert found.kind is VerdictKind.TESTED
    assert [str(each) for each in found.coverage[0].unreached] == [
        f"transition S2 -> S1: `{part}` can never decide it (proven)"
    ]


def test_a_proof_counts_no_parts_of_conditions() -> None:
    project = sfc.loads(PARTS.format("b OR n > 5").replace("sum + m / 3", "m").encode(), format="iec-text")
    found = equivalent(project, project, "iec")
    assert found.proven
    assert "part of condition" not in found.coverage[0].counts


ASSIGNED = """PROGRAM Main VAR_INPUT a : BOOL; n : INT; r : REAL; s : STRING; END_VAR
VAR_OUTPUT q : BOOL; m : INT; END_VAR
m := n + 1;
{}
END_PROGRAM"""


def assigned(body: str, other: str) -> Verdict:
    one, two = (sfc.loads(ASSIGNED.format(each).encode(), format="iec-text") for each in (body, other))
    return equivalent(one, two, "iec", cap=50, runs=10, scans=100)


@pytest.mark.parametrize(
    ("value", "constant"),
    [
        ("m > n", "TRUE"),
        ("a OR n + 1 > n", "TRUE OR a"),
        ("n * n = 1521", "FALSE"),
        ("LEN(s) = 7", "FALSE"),
        ("r * r = 2.25", "FALSE"),
        ("a AND ABS(n) < 0", "FALSE AND a"),
    ],
)
def test_a_comparison_that_is_assigned_must_have_both_outcomes(value: str, constant: str) -> None:
    verdict = assigned(f"q := {value};", f"q := {constant};")
    missing = "TRUE" if constant.startswith("FALSE") else "FALSE"
    assert verdict.kind is VerdictKind.UNTESTED, str(verdict)
    assert [str(each) for each in verdict.coverage[0].untested] == [f"assignment `q := {value};` was never {missing}"]
    assert f"not reached: assignment `q := {value};` was never {missing}" in str(verdict).splitlines()
    assert verdict.coverage[0].counts["outcome of comparison"] == (1, 2)


def test_outcomes_of_comparisons_are_searched_and_proven_impossible() -> None:
    found = assigned("q := n = 12345; m := m / 3;", "m := m / 3; q := n = 12345;")
    assert found.kind is VerdictKind.TESTED, str(found)
    assert found.coverage[0].counts["outcome of comparison"] == (2, 2)
    assert assigned("q := n = 12345; m := m / 3;", "q := FALSE; m := m / 3;").different
    impossible = assigned("q := n > 5 AND n < 3; m := m / 3;", "q := FALSE; m := m / 3;")
    assert impossible.kind is VerdictKind.TESTED, str(impossible)
    assert [each.why for each in impossible.coverage[0].unreached] == ["is never TRUE (proven)"]
    booleans = assigned("q := a = FALSE OR a; m := m / 3;", "q := TRUE; m := m / 3;")
    assert booleans.kind is VerdictKind.TESTED, str(booleans)


def test_outcomes_count_in_actions_of_charts() -> None:
    one, other = (
        sfc.loads(COUNTING.replace("IF {condition} THEN q := {value}; END_IF", f"q := {v}").encode(), format="iec-text")
        for v in ("n * n = 1000003", "FALSE")
    )
    verdict = searched(one, other)
    assert verdict.kind is VerdictKind.UNTESTED
    assert [str(each) for each in verdict.coverage[0].untested] == ["assignment `q := n * n = 1000003;` was never TRUE"]
