"""Coverage that a verdict reports, and the parts not covered and why."""

from __future__ import annotations

import json
from functools import cache
from random import Random

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.analysis import Verdict, VerdictKind, equivalent
from plcopen_sfc.analysis.coverage import PART
from plcopen_sfc.errors import ModelError
from plcopen_sfc.lowering.proof import prove
from plcopen_sfc.model import Action, ActionAssociation, ActionEvent, Pou, Project, Qualifier, StBody, conditions
from plcopen_sfc.semantics.subjects import resolve
from tests.lowering.random_charts import random_chart
from tests.sweeps import examples


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
    reached, written = second.counts["assignment"]
    assert reached == written >= 3  # how many there are is a matter of the code; it writes three outputs
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


UNCALLED = project(
    "VAR Other : TON; Own : TON; END_VAR\nVAR_OUTPUT Q : BOOL; END_VAR",
    "TRANSITION FROM A TO B := Other.Q; END_TRANSITION TRANSITION FROM B TO A := Own.Q; END_TRANSITION",
    "INITIAL_STEP A: END_STEP STEP B: Q(N); Run(N); END_STEP ACTION Run: Own(IN := TRUE, PT := T#1s); END_ACTION",
)


@pytest.mark.parametrize("names", ["Other.Q", "other", "all"])
def test_outputs_of_instances_that_nothing_calls_are_frozen_and_can_be_inputs(names: str) -> None:
    """Code beside what is compared may call them: they were taken for FALSE, and steps were proven unreachable."""
    frozen = equivalent(UNCALLED, UNCALLED, "iec")
    assert frozen.frozen == ("Other.Q",)
    assert not frozen.equal
    assert "unreachable (proven)" not in str(frozen)
    freed = equivalent(UNCALLED, UNCALLED, "iec", free_inputs=names)
    assert freed.proven
    assert (freed.inputs, freed.frozen) == (("Other.Q",), ())
    with pytest.raises(ModelError, match="is no variable that nothing writes"):
        equivalent(UNCALLED, UNCALLED, "iec", free_inputs="Own.Q")


def test_what_only_other_actions_of_its_pou_write_is_frozen_where_an_action_runs_alone() -> None:
    """They do not run then: what they write was taken for FALSE for ever, and steps were proven unreachable."""
    whole = UNCALLED.model_copy(deep=True)
    pou = whole.pou("Main")
    pou.actions.append(Action(name="Home", body=pou.bodies[0]))
    pou.actions.append(Action(name="Timers", body=StBody(text="Other(IN := Ready, PT := T#1s); Ready := NOT Ready;")))
    pou.bodies = [StBody(text="Timers(); Home();")]
    action = resolve(whole, "Main.Home")
    alone = equivalent(action, action, "iec")
    assert alone.frozen == ("Other.Q",)
    assert "unreachable (proven)" not in str(alone)
    assert "Ready" not in str(alone)
    freed = equivalent(action, action, "iec", free_inputs="all")
    assert (freed.proven, freed.inputs) == (True, ("Other.Q",))
    trace = sfc.simulate(
        whole, pou="Main.Home", free_inputs="all", inputs=lambda scan, _: {"Other.Q": scan == 1}, scans=3
    )
    assert [trace.active(scan) for scan in range(3)] == [("A",), ("B",), ("B",)]
    assert equivalent(whole.pou("Main"), whole.pou("Main"), "iec").frozen == ()


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
        "VAR_INPUT up, down : BOOL; n : INT; END_VAR",
        """TRANSITION FROM A TO B := up; END_TRANSITION
        TRANSITION FROM B TO A := down; END_TRANSITION
        TRANSITION FROM B TO C := n > 5 AND n < 3; END_TRANSITION
        TRANSITION FROM C TO A := TRUE; END_TRANSITION
        TRANSITION FROM (A, B) TO D := up; END_TRANSITION""",
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
    assert (missed.name, missed.impossible) == ("P := TRUE", True)
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
        "assignment q := TRUE: needs `n * n = 1000003`, never reached"
    ]


def test_assignments_that_nothing_executes_are_proven_so() -> None:
    verdict = searched(counting("n > 5 AND n < 3"), counting("n > 5 AND n < 3", "FALSE"))
    assert verdict.kind is VerdictKind.TESTED
    assert [(each.name, each.why) for each in verdict.coverage[0].unreached] == [
        ("q := TRUE", "needs `n > 5 AND n < 3`, never TRUE (proven)"),
        ("q := TRUE", "the code around it is never executed (proven)"),
    ]
    assert searched(counting("n > 3"), counting("n > 3", "FALSE")).different


def test_what_only_terms_have_reached_was_not_reached() -> None:
    """A search with terms in place of numbers looks behind every condition, whether or not numbers get there."""
    one, other = (
        sfc.loads(
            COUNTING.format(condition="n = 123456789", value=v).replace("m / 3", "m * 8").encode(), format="iec-text"
        )
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
    """Return the verdict of a comparison by runs, of charts with a condition each."""
    texts = [PARTS.format(condition).encode() for condition in (one, other or one)]
    sides = [sfc.loads(text, format="iec-text") for text in texts]
    return equivalent(*sides, "iec", cap=20, runs=20, scans=40, scan_time="100ms")


@pytest.mark.parametrize("sides", [("b OR n > 100000", "b OR FALSE"), ("b OR FALSE", "b OR n > 100000")])
def test_the_search_makes_parts_of_conditions_decide_them(sides: tuple[str, str]) -> None:
    assert decided(*sides).different
    same = decided("b OR n > 100000")
    assert same.kind is VerdictKind.TESTED, str(same)
    assert same.coverage[0].counts["part of condition"] == (3, 3)  # and b was TRUE and FALSE


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


ASSIGNED = """FUNCTION Change : BOOL VAR_IN_OUT x : INT; END_VAR x := 0; Change := TRUE; END_FUNCTION
FUNCTION_BLOCK Changing VAR_OUTPUT k : INT; END_VAR k := 3; END_FUNCTION_BLOCK
PROGRAM Main VAR_INPUT a : BOOL; n : INT; r : REAL; s : STRING; END_VAR
VAR_OUTPUT q : BOOL; m : INT; END_VAR
VAR t : TON; f : Changing; k : INT; u : STRING; END_VAR
m := n + 1;
{}
k := n; u := s;
END_PROGRAM"""


def assigned(body: str, other: str) -> Verdict:
    one, two = (sfc.loads(ASSIGNED.format(each).encode(), format="iec-text") for each in (body, other))
    return equivalent(one.pou("Main"), two.pou("Main"), "iec", cap=50, runs=10, scans=100)


def test_a_comparison_that_is_assigned_must_have_both_outcomes() -> None:
    verdict = assigned("q := n * n * n = 3 * n + 7;", "q := FALSE;")
    assert verdict.kind is VerdictKind.UNTESTED, str(verdict)
    told = "assignment `q := n * n * n = 3 * n + 7` was never TRUE"
    assert [str(each) for each in verdict.coverage[0].untested] == [told]
    assert f"not reached: {told}" in str(verdict).splitlines()
    assert verdict.coverage[0].counts["outcome of comparison"] == (1, 2)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("value", "constant"),
    [
        ("n * n = 1521", "FALSE"),
        ("n * n - 3 * n = 18 AND a", "FALSE AND a"),
        ("n MOD 7 = 3 AND n / 7 = 111", "FALSE"),
        ("-n / 7 = 111 AND n MOD 7 = -3", "FALSE"),
        ("ABS(n) = 777", "FALSE"),
        ("INT_TO_REAL(n) * 0.5 = 1000.5", "FALSE"),
        ("r * r = 2.25", "FALSE"),
        ("REAL_TO_INT(r) = 77 AND r > 77.2", "FALSE"),
        ("LEN(s) = 7", "FALSE"),
        ("s = 'hello'", "FALSE"),
        ("s = 'Füllen'", "FALSE"),
        ("s > 'x' AND s <> 'y'", "FALSE"),
        ("LEFT(s, 3) = 'abc' AND RIGHT(s, 2) = 'yz' AND MID(s, 2, 4) = 'de'", "FALSE"),
        ("LEN(CONCAT(s, 'abc')) = 9 AND FIND(s, 'xx') = 4", "FALSE"),
        ("k = 12345", "FALSE"),
        ("u = 'copy'", "FALSE"),
        ("m > n", "TRUE"),
        ("a OR n + 1 > n", "TRUE OR a"),
        ("a AND ABS(n) < 0", "FALSE AND a"),
    ],
)
def test_the_search_finds_outcomes_of_comparisons(value: str, constant: str) -> None:
    """By texts and lengths, also of copies, behind arithmetic and standard functions, and where integers overflow."""
    same = assigned(f"q := {value}; m := m / 3;", f"q := {value}; m := m / 3;")
    assert same.kind is VerdictKind.TESTED, str(same)
    assert same.coverage[0].counts["outcome of comparison"] == (2, 2)
    assert assigned(f"q := {value}; m := m / 3;", f"q := {constant}; m := m / 3;").different


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
    assert [str(each) for each in verdict.coverage[0].untested] == ["assignment `q := n * n = 1000003` was never TRUE"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("body", "impossible"),
    [
        ("IF n > 5 THEN q := n > 3; END_IF;", ["q := n > 3 is never FALSE (proven)"]),
        ("IF n > 5 THEN q := a; ELSE q := n > 7; END_IF;", ["q := n > 7 is never TRUE (proven)"]),
        ("IF n <= 5 THEN RETURN; END_IF; q := n > 3;", ["q := n > 3 is never FALSE (proven)"]),
        ("IF n > 5 THEN t(IN := a, PT := T#1s); q := n > 3; END_IF;", ["q := n > 3 is never FALSE (proven)"]),
        (
            "CASE n OF 1..3: q := n > 4; ELSE q := n = 2; END_CASE;",
            ["q := n > 4 is never TRUE (proven)", "q := n = 2 is never TRUE (proven)"],
        ),
        (
            "IF n > 5 THEN IF n < 3 THEN q := a; END_IF; END_IF;",
            ["q := a needs `n > 5` and `n < 3`, never TRUE (proven)"],
        ),
    ],
)
def test_what_a_branch_excludes_is_not_demanded(body: str, impossible: list[str]) -> None:
    body = f"{body} m := m / 3;"
    verdict = assigned(body, body)
    assert verdict.kind is VerdictKind.TESTED, str(verdict)
    for side in verdict.coverage:
        assert [f"{each.name} {each.why}" for each in side.unreached] == impossible
        assert all(each.impossible for each in side.unreached)


@pytest.mark.parametrize(
    "body",
    [
        "IF n > 5 THEN m := 0; q := m > n; END_IF;",
        "IF m > 5 THEN m := n; q := m > 3; END_IF;",
        "IF m > 5 THEN WHILE m > 0 DO q := m > 3; m := m - 1; END_WHILE; END_IF;",
        "IF m > 5 THEN Change(m); q := m > 3; END_IF;",
        "IF m > 5 THEN f(); q := m > 3; END_IF;",
    ],
)
def test_a_branch_excludes_nothing_of_what_is_written_in_it(body: str) -> None:
    verdict = assigned(f"{body} m := m / 3;", f"{body} m := m / 3;")
    outcomes = [each for each in verdict.coverage[0].unreached if "never FALSE" in each.why]
    assert not any(each.impossible for each in outcomes), str(verdict)


ACTING = """PROGRAM Main VAR_INPUT a, b, c : BOOL; m : DINT; END_VAR VAR_OUTPUT q, p : BOOL; END_VAR
VAR sum : DINT; END_VAR
INITIAL_STEP S1: END_STEP
STEP S2: Add(N); {}; END_STEP
STEP S3: p(N); END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S1 := {}; END_TRANSITION
TRANSITION FROM S2 TO S3 := m > 5 AND m < 3; END_TRANSITION
TRANSITION FROM S3 TO S1 := a; END_TRANSITION
ACTION Add: sum := sum + m / 3; END_ACTION
END_PROGRAM"""


def acting(action: str, other: str = "", leaving: str = "b", **options: str) -> Verdict:
    """Return the verdict of a comparison by runs, of charts with an action each."""
    texts = [ACTING.format(each, leaving).encode() for each in (action, other or action)]
    sides = [sfc.loads(text, format="iec-text") for text in texts]
    for side, condition in zip(sides, (options.get("condition", ""), options.get("condition", "")), strict=True):
        if condition:
            chart = side.pou("Main").sfc
            assert chart is not None
            chart.step("S2").actions[1].condition = conditions.Expression(text=condition)
    return equivalent(*sides, "codesys" if options else "iec", cap=20, runs=50, scans=40, scan_time="100ms")


def test_what_follows_from_a_step_that_was_not_entered_is_only_counted() -> None:
    chart = sfc.loads(
        b"""PROGRAM Main
VAR_INPUT a : BOOL; m : INT; END_VAR
VAR level : REAL; END_VAR
VAR_OUTPUT q : BOOL; n : INT; END_VAR
INITIAL_STEP S1: END_STEP
STEP S2: q(N); END_STEP
STEP S3: Count(N); END_STEP
TRANSITION FROM S1 TO S2 := INT_TO_REAL(m) * level > 7.0; END_TRANSITION
TRANSITION FROM S2 TO S3 := a; END_TRANSITION
TRANSITION FROM S3 TO S1 := NOT a; END_TRANSITION
ACTION Count: n := n + 1; END_ACTION
END_PROGRAM""",
        format="iec-text",
    )
    verdict = equivalent(chart, chart, "iec", cap=5, runs=5, scans=20)
    head, first, second, third, *_ = str(verdict).splitlines()
    assert head.startswith("not all was reached (2 steps, 1 transition"), head
    assert first == "not reached: steps S2, S3: needs `INT_TO_REAL(m) * level > 7.0`, never reached"
    assert second == "not reached behind these steps: 2 transitions, 2 actions, 1 assignment"
    assert third.startswith("covered on both sides: 1 of 3 steps")
    assert {each["name"] for each in verdict.as_dict()["coverage"][0]["unreached"]} >= {"q", "Count", "S3 -> S1"}


def test_an_action_that_was_never_executed_is_not_called_equal() -> None:
    kept, dropped = "q(DS, T#10s)", "q(R)"
    leaving = "b OR S2.T > T#5s AND m * m <> 1000003"
    verdict = acting(kept, dropped, leaving)
    assert verdict.kind is VerdictKind.UNTESTED, str(verdict)
    untested = [str(each) for each in verdict.coverage[0].untested]
    assert untested[0] == "action q: step S2 never executed it, needs T#10s to pass (DS)"
    assert f"not reached: {untested[0]}" in str(verdict).splitlines()


@pytest.mark.slow
@pytest.mark.parametrize("action", ["q(D, T#1h)", "q(SD, T#1h)", "q(L, T#10s)", "q(P1)", "q(P0)"])
def test_the_search_has_actions_executed(action: str) -> None:
    verdict = acting(action)
    assert verdict.kind is VerdictKind.TESTED, str(verdict)
    assert verdict.coverage[0].counts["action"] == (2, 3)
    assert acting(action, "q(R)").different


def test_the_search_makes_conditions_of_actions_true() -> None:
    verdict = acting("q(N)", condition="m = 123457 AND c")
    assert verdict.kind is VerdictKind.TESTED, str(verdict)
    assert verdict.coverage[0].counts["action"] == (2, 3)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("action", "leaving", "why"),
    [
        ("q(R)", "b", "step S2 only resets it"),
        ("q(D, T#10s)", "b OR S2.T > T#5s", "step S2 is left before T#10s has passed (proven)"),
        ("q(DS, T#10s)", "S2.T >= T#10s", "step S2 is left before T#10s has passed (proven)"),
        ("q(L, T#0s)", "b", "its time T#0s is over at once (proven)"),
        ("q(SL, T#0ms)", "b", "its time T#0ms is over at once (proven)"),
    ],
)
def test_an_action_that_nothing_executes_is_not_demanded(action: str, leaving: str, why: str) -> None:
    verdict = acting(action, leaving=leaving)
    assert verdict.kind is VerdictKind.TESTED, str(verdict)
    assert {each.name: each.why for each in verdict.coverage[0].unreached if each.kind == "action"} == {
        "q": why,
        "p": "needs step S3, unreachable (proven)",
    }


def test_a_condition_of_an_action_that_is_never_true_is_not_demanded() -> None:
    verdict = acting("q(N)", condition="m < 3 AND m > 5")
    assert verdict.kind is VerdictKind.TESTED, str(verdict)
    assert [each.why for each in verdict.coverage[0].unreached if each.name == "q"] == [
        "needs `m < 3 AND m > 5`, never TRUE (proven)"
    ]


FLAGGED = """PROGRAM Main VAR_INPUT a, b : BOOL; m : DINT; END_VAR VAR sum : DINT; flag, on : BOOL := {}; END_VAR
INITIAL_STEP S1: END_STEP
STEP S2: Add(N); END_STEP
STEP S3: END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION FROM S2 TO S3 := flag AND on; END_TRANSITION
TRANSITION FROM S2 TO S1 := b OR flag; END_TRANSITION
TRANSITION FROM S3 TO S1 := a; END_TRANSITION
ACTION Add: sum := sum + m / 3;
{}
END_ACTION
END_PROGRAM"""


def flagged(first: str, action: str) -> Verdict:
    chart = sfc.loads(FLAGGED.format(first, action).encode(), format="iec-text")
    return equivalent(chart, chart, "iec", cap=20, runs=20, scans=40)


def test_a_variable_that_is_written_behind_a_line_break_is_written() -> None:
    found = flagged("FALSE", "flag := sum * 7919 MOD 1000003 = 4711;\non := TRUE;")
    step = next(each for each in found.coverage[0].unreached if each.kind == "step")
    assert not step.impossible, step.why
    assert found.kind is VerdictKind.UNTESTED


@pytest.mark.parametrize(
    ("condition", "never"),
    [
        ("b AND flag", {"S3": "unreachable (proven)"}),
        ("flag OR b", {"S2 -> S3: `b`": "is never TRUE (proven)"}),
    ],
)
def test_what_a_transition_with_priority_excludes_is_not_demanded(condition: str, never: dict[str, str]) -> None:
    text = FLAGGED.format("FALSE", "flag := sum = 123456789;")
    text = text.replace("flag AND on", "b").replace("TO S1 := b OR flag", f"TO S3 := {condition}")
    text = text.replace("FROM S2 TO S3 := b;", "FROM S2 TO S1 := b;")
    found = equivalent(*[sfc.loads(text.encode(), format="iec-text")] * 2, "iec", cap=20, runs=20, scans=40)
    assert never.items() <= {each.name: each.why for each in found.coverage[0].unreached if each.impossible}.items()


@pytest.mark.parametrize(
    ("first", "action", "is_proven"),
    [
        ("FALSE", "on := b; flag := on AND NOT b;", True),
        ("FALSE", "on := b; flag := a AND NOT (on OR NOT b);", True),
        ("FALSE", "flag := on AND NOT b; on := b;", False),  # of the scan before
        ("FALSE", "IF a THEN on := b; END_IF; flag := on AND NOT b;", False),
        ("FALSE", "on := b; on := NOT b; flag := on AND NOT b AND m > 123456;", False),
        ("TRUE", "on := b; flag := on AND NOT b;", False),
    ],
)
def test_a_variable_that_is_always_computed_as_false_is_false(first: str, action: str, is_proven: bool) -> None:
    found = flagged(first, action)
    assert ("S3" in {each.name for each in found.coverage[0].unreached if each.impossible}) is is_proven, str(found)


GUARDED = """FUNCTION_BLOCK Main VAR_INPUT a, b : BOOL; {} END_VAR VAR_OUTPUT n : INT; END_VAR
INITIAL_STEP S1: END_STEP STEP S2: END_STEP STEP S3: END_STEP
TRANSITION FROM S1 TO S2 := a; END_TRANSITION
TRANSITION (PRIORITY := 1) FROM S2 TO S1 := NOT b; END_TRANSITION
TRANSITION (PRIORITY := 2) FROM S2 TO S3 := NOT b AND a; END_TRANSITION
TRANSITION FROM S3 TO S1 := a; END_TRANSITION
END_FUNCTION_BLOCK"""


@pytest.mark.parametrize(
    ("declared", "switches", "is_proven"),
    [
        ("", False, True),
        ("ACK_EF : BOOL;", False, True),
        ("SW_TOP, T_PUSH, OFF_SQ : BOOL;", False, True),
        ("S_ON : BOOL;", False, False),
        ("", True, False),
    ],
)
def test_what_nothing_reaches_in_a_sequencer_is_not_demanded(declared: str, switches: bool, is_proven: bool) -> None:
    """It was not known of any sequencer of S7-GRAPH, though only some have steps that other things switch."""
    main = sfc.loads(GUARDED.format(declared).encode(), format="iec-text").pou("Main")
    assert main.chart is not None
    if switches:
        row = ActionAssociation(id=99, qualifier=Qualifier.ON, target="S3", event=ActionEvent.S1)
        main.chart.step("S1").actions.append(row)
    found = equivalent(main, main, "s7graph", cap=2, runs=2, scans=10)
    told = {each.name: each.why for each in found.coverage[0].unreached if each.impossible}
    assert ("S3" in told) is is_proven, str(found)
    # T_PUSH lets the first of two transitions fire, and nothing the second while that is TRUE
    assert [each.kind for each in found.coverage[0].unreached if each.impossible].count("transition") == 1 + is_proven


@pytest.mark.parametrize(("declared", "is_proven"), [("", True), ("REG_S : BOOL;", False)])
def test_what_an_event_does_that_nothing_makes_is_not_demanded(declared: str, is_proven: bool) -> None:
    main = sfc.loads(GUARDED.format(declared).encode(), format="iec-text").pou("Main")
    assert main.chart is not None
    row = ActionAssociation(id=99, qualifier=Qualifier.N, target="n", value="3", event=ActionEvent.R1)
    main.chart.step("S2").actions.append(row)
    found = equivalent(main, main, "s7graph", cap=2, runs=2, scans=10)
    told = [each.why for each in found.coverage[0].unreached if each.kind in ("action", "assignment")]
    assert (told == ["needs the event R1, which nothing registers (proven)"] * 2) is is_proven, str(found)


@pytest.mark.parametrize(
    ("calls", "is_proven"),
    [
        ("q := Chosen(k := 1); p := Chosen(1);", True),
        ("q := Chosen(k := 1); p := Chosen(k := n);", False),
        ("q := Chosen(k := 1); p := Chosen(k := 2);", False),
    ],
)
def test_what_all_calls_of_a_function_exclude_is_not_demanded(calls: str, is_proven: bool) -> None:
    text = f"""FUNCTION Chosen : BOOL VAR_INPUT k : INT; END_VAR
    IF k = 7 THEN Chosen := FALSE; ELSE Chosen := TRUE; END_IF; END_FUNCTION
    PROGRAM Main VAR_INPUT n : INT; END_VAR VAR_OUTPUT q, p : BOOL; END_VAR {calls} END_PROGRAM"""
    swapped = text.replace(
        "k = 7 THEN Chosen := FALSE; ELSE Chosen := TRUE", "k <> 7 THEN Chosen := TRUE; ELSE Chosen := FALSE"
    )
    one, other = (sfc.loads(each.encode(), format="iec-text").pou("Main") for each in (text, swapped))
    found = equivalent(one, other, "iec", cap=1, runs=2, scans=5)
    told = {each.name: each.why for each in found.coverage[0].unreached if each.impossible}
    assert (told.get("Chosen: Chosen := FALSE") == "needs `k = 7`, never TRUE (proven)") is is_proven, str(found)


@pytest.mark.parametrize(
    "action", ["flag := FALSE;", "flag := FALSE; (* flag := TRUE; *)", "IF b THEN flag := FALSE; END_IF"]
)
def test_a_variable_that_only_gets_its_first_value_keeps_it(action: str) -> None:
    found = flagged("FALSE", action)
    assert found.kind is VerdictKind.TESTED
    reasons = {each.name: each.why for each in found.coverage[0].unreached}
    assert reasons["S3"] == "unreachable (proven)"
    assert reasons["S2 -> S1: `flag`"] == "is never TRUE (proven)"


@pytest.mark.parametrize(
    ("condition", "missed"),
    [
        ("b AND S2.X", ["`S2.X` is never FALSE (proven)"]),
        ("b OR S1.X", ["`S1.X` is never TRUE (proven)"]),
        ("b AND (c XOR NOT d)", []),
        ("b AND enable", ["`enable` was never FALSE, as enable kept its value (frozen)"]),
        ("b AND (limit > 2)", ["`limit > 2` never decided it, as limit kept its value (frozen)"]),
        ("b OR far", ["`far` was never TRUE"]),
    ],
)
def test_booleans_must_have_been_true_and_false_where_they_were_tested(condition: str, missed: list[str]) -> None:
    text = PARTS.format(condition).replace("n : DINT;", "n : DINT; c, d : BOOL;")
    text = text.replace("VAR sum", "VAR enable : BOOL := TRUE; limit : DINT := 3; far : BOOL; sum")
    text = text.replace("sum := sum", "far := sum * sum = 1000003; sum := sum")
    chart = sfc.loads(text.encode(), format="iec-text")
    found = equivalent(chart, chart, "iec", cap=20, runs=20, scans=40, scan_time="100ms")
    parts = [each for each in found.coverage[0].unreached if each.kind == "part of condition"]
    assert [str(each) for each in parts] == [f"transition S2 -> S1: {each}" for each in missed]
    assert all(each.impossible is ("far" not in each.name) for each in parts)


# -- code beside its chart


@cache
def press() -> Project:
    return sfc.load("fixtures/twincat/press_station.xml")


def press_and_code(old: str = "", new: str = "") -> Verdict:
    """The press, whose code sets stored actions back, beside that code with a change."""
    code = sfc.lower(press(), "case", pou="FB_Press", verify=False)
    body = code.project.pou("FB_Press").bodies[0]
    assert isinstance(body, StBody)
    assert old in body.text
    body.text = body.text.replace(old, new)
    return prove(
        *(resolve(each, "FB_Press") for each in (press(), code.project)),
        code.profile,
        fixed=code.at_rest,
        left_out=code.left_out,
        step_flags=code.step_flags,
        cap=2_000,
        runs=30,
    )


@pytest.mark.slow
def test_every_assignment_of_code_beside_a_chart_is_reached_or_proven_dead() -> None:
    verdict = press_and_code()
    assert verdict.kind is VerdictKind.TESTED
    assert [each for each in verdict.coverage[1].unreached if each.kind == "assignment" and not each.impossible] == []


def test_a_mistake_in_what_code_does_when_it_is_set_back_is_found() -> None:
    setting_back = "    bOverload := FALSE;\n    RETURN;"
    assert press_and_code(setting_back, setting_back.replace("FALSE", "TRUE")).different


@pytest.mark.slow
def test_an_assignment_that_only_code_has_is_named_where_nothing_reached_it() -> None:
    verdict = press_and_code("// Step times", "IF fForce * fForce < 0.0 THEN bDone := TRUE; END_IF;")
    assert verdict.kind is VerdictKind.UNTESTED
    assert "(1 assignment)" in str(verdict)
    assert "not reached: assignment bDone := TRUE: needs `fForce * fForce < 0.0`, never reached" in str(verdict)


def test_variables_that_keep_their_value_in_a_chart_keep_it_in_its_code() -> None:
    chart = project(
        "VAR_INPUT a : BOOL; x : REAL; END_VAR VAR_OUTPUT q : BOOL; r : REAL; END_VAR VAR late : TON; END_VAR",
        """TRANSITION FROM S1 TO S2 := a; END_TRANSITION
        TRANSITION FROM S2 TO S3 := late.Q; END_TRANSITION
        ACTION Do: r := r * x + x; END_ACTION
        ACTION Other: late(IN := TRUE, PT := T#1s); END_ACTION""",
        "INITIAL_STEP S1: Do(N); END_STEP STEP S2: END_STEP STEP S3: q(S); END_STEP",
    )
    code = sfc.lower(chart, "case", verify=False).project
    verdict = equivalent(chart, code, "iec", cap=20, runs=4, scans=50)
    (missed,) = [each for each in verdict.coverage[1].unreached if each.name.endswith(":= 3")]
    assert (missed.why, missed.impossible) == ("needs `late.Q`, never TRUE (proven)", True)


CALLED = """FUNCTION_BLOCK Sub
VAR_INPUT go, x : BOOL; k : INT; END_VAR VAR_OUTPUT done, odd : BOOL; END_VAR VAR n : DINT; END_VAR
INITIAL_STEP Idle: END_STEP
TRANSITION FROM Idle TO Work := go; END_TRANSITION
STEP Work: Cnt(N); END_STEP
TRANSITION FROM Work TO Fin := n > 90000 AND k = 4711; END_TRANSITION
STEP Fin: done(N); END_STEP
TRANSITION FROM Fin TO Last := x AND k = 77; END_TRANSITION
TRANSITION FROM Fin TO Idle := NOT go; END_TRANSITION
STEP Last: {last} END_STEP
TRANSITION FROM Last TO Idle := NOT go; END_TRANSITION
ACTION Cnt: n := n + k; END_ACTION
END_FUNCTION_BLOCK
PROGRAM PLC_PRG
VAR_INPUT start, y : BOOL; level : INT; END_VAR VAR_OUTPUT q : BOOL; END_VAR VAR s : Sub; END_VAR
s(go := start AND level > 70, x := y AND start, k := level);
q := s.odd;
END_PROGRAM
"""


def test_steps_of_a_called_chart_count_where_it_is_another_one() -> None:
    sides = [
        sfc.loads(CALLED.format(last=last).encode(), format="iec-text") for last in ("odd(N);", "odd(N); done(N);")
    ]
    verdict = equivalent(*(side.pou("PLC_PRG") for side in sides), "iec", cap=10, runs=1, scans=20)
    assert verdict.kind is VerdictKind.UNTESTED, str(verdict)
    assert {"Sub: Fin", "Sub: Last"} <= {each.name for each in verdict.coverage[0].untested if each.kind == "step"}
    longer = equivalent(*(side.pou("PLC_PRG") for side in sides), "iec", cap=10, runs=10, scans=100)
    assert longer.different, str(longer)  # transitions of the called chart are solved for inputs of the caller
    same = equivalent(sides[0].pou("PLC_PRG"), sides[0].pou("PLC_PRG"), "iec", cap=10, runs=1, scans=20)
    assert "step" not in same.coverage[0].counts


def test_what_only_a_search_with_terms_enters_of_a_called_program_does_not_count() -> None:
    body = CALLED[: CALLED.index("s(go")].replace("VAR s : Sub; END_VAR", "")
    body = body.replace("FUNCTION_BLOCK Sub", "PROGRAM Sub").replace("END_FUNCTION_BLOCK", "END_PROGRAM")
    body += "Sub(go := start, x := y, k := level); q := Sub.odd;\nEND_PROGRAM\n"
    sides = [sfc.loads(body.format(last=last).encode(), format="iec-text") for last in ("odd(N);", "odd(N); done(N);")]
    verdict = equivalent(*(side.pou("PLC_PRG") for side in sides), "codesys", cap=2000, runs=1, scans=20)
    assert verdict.different or verdict.coverage[0].counts["step"] < (4, 4), str(verdict)


SOLVED = """FUNCTION_BLOCK Sub
VAR_INPUT go : BOOL; k : DINT; END_VAR VAR_OUTPUT q : BOOL; END_VAR
INITIAL_STEP Idle: END_STEP
TRANSITION FROM Idle TO Work := go AND k * k = 152399025; END_TRANSITION
STEP Work: q({qualifier}); END_STEP
TRANSITION FROM Work TO Idle := NOT go; END_TRANSITION
END_FUNCTION_BLOCK
FUNCTION_BLOCK Machine
VAR_INPUT go : BOOL; k : DINT; END_VAR VAR_OUTPUT q : BOOL; END_VAR VAR s : Sub; END_VAR
s(go := go, k := k + 3); q := s.q;
END_FUNCTION_BLOCK
VAR_GLOBAL shared : Sub; END_VAR
PROGRAM PLC_PRG
VAR_INPUT a, b : BOOL; x, y : DINT; END_VAR VAR_OUTPUT q : BOOL; END_VAR VAR s : Sub; m : Machine; END_VAR
VAR_EXTERNAL shared : Sub; END_VAR
"""
STEPS = "INITIAL_STEP I: Call(N); END_STEP STEP J: END_STEP TRANSITION FROM I TO J := s.q; END_TRANSITION "


@pytest.mark.parametrize(
    "body",
    [
        "IF a THEN s(go := b, k := x - 7); ELSE s(go := a, k := y); END_IF; q := s.q;",
        "s.k := x + 9; s(go := a); q := s.q;",
        "m(go := a, k := 2 * x); q := m.q;",
        "shared(go := a, k := x + 1); q := shared.q;",
        f"{STEPS}TRANSITION FROM J TO I := b; END_TRANSITION ACTION Call: s(go := a, k := x + 1); q := s.q; END_ACTION",
    ],
    ids=["two calls", "an assigned input", "a block in a block", "a global instance", "a call in an action"],
)
def test_conditions_of_called_charts_are_solved_for_inputs_of_their_callers(body: str) -> None:
    texts = [f"{SOLVED.format(qualifier=qualifier)}{body}\nEND_PROGRAM\n" for qualifier in "NP"]
    sides = [sfc.loads(text.encode(), format="iec-text").pou("PLC_PRG") for text in texts]
    verdict = equivalent(*sides, "iec", cap=10, runs=20, scans=100)
    assert verdict.different, str(verdict)


def test_conditions_of_called_programs_are_solved_for_inputs_of_their_callers() -> None:
    text = SOLVED.replace("FUNCTION_BLOCK Sub", "PROGRAM Line").replace("END_FUNCTION_BLOCK", "END_PROGRAM", 1)
    text = text[: text.index("FUNCTION_BLOCK Machine")] + "PROGRAM PLC_PRG\nVAR_INPUT a : BOOL; x : DINT; END_VAR\n"
    text += "VAR_OUTPUT q : BOOL; END_VAR\nLine(go := a, k := x - 5); q := Line.q;\nEND_PROGRAM\n"
    texts = [text.format(qualifier=qualifier) for qualifier in "NP"]
    sides = [sfc.loads(each.encode(), format="iec-text").pou("PLC_PRG") for each in texts]
    verdict = equivalent(*sides, "codesys", cap=10, runs=20, scans=100)
    assert verdict.different, str(verdict)


def test_flags_that_are_never_together_are_proven_apart() -> None:
    """What the action of one step asks of the time of another one, which is not active then, is reached by nothing."""
    chart = project(
        "VAR_INPUT Go : BOOL; END_VAR\nVAR_OUTPUT Q : BOOL; END_VAR",
        "TRANSITION FROM A TO B := Go; END_TRANSITION TRANSITION FROM B TO C := Go; END_TRANSITION"
        " TRANSITION FROM C TO A := NOT Go; END_TRANSITION",
        "INITIAL_STEP A: END_STEP STEP B: Early(N); END_STEP STEP C: Late(N); END_STEP"
        " ACTION Early: Q := B.X AND B.T < T#3s OR C.X; END_ACTION"
        " ACTION Late: Q := B.X AND B.T < T#3s OR C.X; END_ACTION",
    )
    verdict = equivalent(chart, chart, "codesys", cap=1, runs=10, scans=100)
    assert verdict.kind is VerdictKind.TESTED
    assert verdict.coverage[0].untested == ()


@pytest.mark.parametrize("profile", ["iec", "codesys", "matiec"])
def test_what_is_called_unreachable_is_reached_by_no_longer_run(profile: str) -> None:
    """The flags of some steps are asked for in the actions of others, in charts of all shapes."""
    impossible, seeds = 0, examples(24)
    for seed in range(seeds):
        random = Random(seed)  # noqa: S311
        pou = random_chart(seed, size=5, codesys=profile == "codesys")
        chart = pou.chart
        names = [step.name for step in chart.steps]
        for number, step in enumerate(chart.steps):
            asked = " AND ".join(f"{random.choice(names)}.X" for _ in range(2))
            text = f"IF {asked} AND {random.choice(names)}.T > T#20ms THEN q1 := TRUE; END_IF;"
            pou.actions.append(Action(name=f"Asks{number}", body=StBody(text=text)))
            step.actions.append(ActionAssociation(id=900 + number, qualifier=Qualifier.N, target=f"Asks{number}"))

        def unreached(pou: Pou = pou, **effort: int) -> dict[tuple[str, ...], bool]:
            first = equivalent(pou, pou, profile, cap=1, **effort).coverage[0]
            return {each.key: each.impossible for each in first.unreached if each.kind != PART}

        never = {key for key, proven in unreached(runs=1, scans=3).items() if proven}
        assert not never or never <= unreached(runs=30, scans=120).keys()
        impossible += len(never)
    assert impossible > seeds
