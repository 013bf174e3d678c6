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
