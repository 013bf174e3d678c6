"""Comparisons of what two tools do with a chart, one of which is later than the other."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import plcopen_sfc as sfc
from plcopen_sfc.analysis import Verdict, VerdictKind, equivalent
from plcopen_sfc.analysis.pairing import Delay, retimed
from plcopen_sfc.errors import ModelError
from plcopen_sfc.model import ActionAssociation, Expression, Project, Qualifier
from plcopen_sfc.semantics.profile import PROFILES
from tests.analysis.schemes import Flow, chart_of, flows
from tests.sweeps import examples

AUTO = "auto"
TOOLS = (("iec", "codesys"), ("codesys", "s7graph"), ("s7graph", "codesys"), ("s7graph", "iec"), ("matiec", "codesys"))
LATER = {"codesys": 1}


def ring(
    actions: dict[int, str] | None = None, conditions: str = "a|b|c", more: str = "", variables: str = ""
) -> Project:
    """Three steps in a ring, and what they do."""
    steps = [f"{'INITIAL_' * (i == 0)}STEP S{i}: {(actions or {}).get(i, '')} END_STEP" for i in range(3)]
    tests = conditions.split("|")
    moves = [f"TRANSITION FROM S{i} TO S{(i + 1) % 3} := {test}; END_TRANSITION" for i, test in enumerate(tests)]
    text = f"""PROGRAM Main VAR_INPUT a, b, c : BOOL; level : INT; END_VAR VAR_OUTPUT q : BOOL; n : INT; END_VAR
        VAR {variables} END_VAR {" ".join(steps + moves)} {more} END_PROGRAM"""
    return sfc.loads(text.encode(), format="iec-text")


def between(project: Project, first: str, second: str, delay: int | str | Delay = AUTO) -> Verdict:
    return equivalent(project, project, (first, second), delay=delay)


CONSTANT = {
    "steps": ring(),
    "N": ring({1: "q(N);"}),
    "S and R": ring({1: "q(S);", 2: "q(R);"}),
    "L": ring({1: "q(L, T#30ms);"}),
    "D": ring({1: "q(D, T#30ms);"}),
    "step flag": ring({1: "q(N);"}, "a|S1.X AND b|NOT S1.X"),
    "timer": ring({1: "act(N);"}, "a|t.Q|c", "ACTION act: t(IN := TRUE, PT := T#30ms); END_ACTION", "t : TON;"),
}
"""Behaviour that is later by a constant number of scans, however the chart is executed."""


@pytest.mark.slow
@pytest.mark.parametrize(("first", "second"), TOOLS)
@pytest.mark.parametrize("feature", CONSTANT)
def test_tools_do_the_same_with_a_constant_delay(feature: str, first: str, second: str) -> None:
    verdict = between(CONSTANT[feature], first, second)
    assert verdict.proven, str(verdict)
    assert verdict.delay.scans == LATER.get(second, 0) - LATER.get(first, 0)
    assert not verdict.delay.retimed or "s7graph" in (first, second), "only the first scan of S7-GRAPH is another one"
    assert verdict.profile == f"{first} and {second}"


RETIMED = {
    "step time": ring({1: "q(N);"}, "a|S1.T >= T#30ms|c"),
    "input in an action": ring({1: "act(S);"}, more="ACTION act: q := c; END_ACTION"),
    "stored by the initial step": ring({0: "q(S);", 2: "q(R);"}),
}
"""Delays that are not constant: inputs and times are seen a scan later by actions, or a scan sooner by conditions."""


@pytest.mark.parametrize("feature", RETIMED)
def test_what_scans_see_is_said_where_the_delay_depends_on_it(feature: str) -> None:
    verdict = between(RETIMED[feature], "iec", "codesys")
    assert verdict.proven, str(verdict)
    assert verdict.delay == Delay(1, retimed=True)
    assert verdict.delay_notes[1] == "actions of the second see the inputs and times of the scan before"
    assert verdict.delay_notes[1] in str(verdict)
    for exact in (Delay(1), Delay(1, late_start=True), Delay(0)):
        assert between(RETIMED[feature], "iec", "codesys", exact).kind is VerdictKind.DIFFERENT


def test_a_difference_says_how_scans_were_put_beside_each_other() -> None:
    """Whoever repeats the run sees something else in a second that has the inputs of the same scan."""
    other = ring({1: "act(S);"}, more="ACTION act: q := NOT c; END_ACTION")
    first, second = RETIMED["input in an action"].pous[0], other.pous[0]
    verdict = equivalent(first, second, ("iec", "codesys"), delay=Delay(1, retimed=True))
    assert verdict.different
    assert "given: actions of the second see the inputs and times of the scan before" in str(verdict).splitlines()


def test_charts_of_actions_that_are_not_executed_do_not_hinder_it() -> None:
    inner = "ACTION Sub: INITIAL_STEP I0: END_STEP TRANSITION FROM I0 TO I0 := b; END_TRANSITION END_ACTION"
    for used, is_retimed in (("act(S);", True), ("act(S); Sub(N);", False)):
        project = ring({1: used}, more=f"ACTION act: q := c; END_ACTION {inner}")
        verdict = equivalent(project.pous[0], project.pous[0], ("iec", "codesys"), delay=AUTO)
        assert verdict.delay.retimed is is_retimed, str(verdict)
        assert verdict.proven is is_retimed


def test_a_final_scan_is_a_difference_whatever_the_delay_is() -> None:
    counting = ring({1: "act(N);"}, more="ACTION act: n := n + 1; IF n > 5 THEN n := 0; END_IF; END_ACTION")
    assert between(counting, "iec", "codesys").proven
    verdict = between(counting, "s7graph", "codesys")
    assert verdict.kind is VerdictKind.DIFFERENT
    assert {each.name for each in verdict.counterexample.differences} == {"n"}  # type: ignore[union-attr]
    assert "1 scan before" in str(verdict)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("source", "result"),
    [
        (ring({1: "q(N);"}), ring({2: "q(N);"})),
        (ring({1: "q(N);"}), ring({1: "q(S);"})),
        (ring({1: "q(L, T#30ms);"}), ring({1: "q(L, T#45ms);"})),
        (ring({1: "q(N);"}), ring({1: "q(N);"}, "a|NOT b|c")),
        (ring({1: "q(N);"}, "a|S1.T >= T#30ms|c"), ring({1: "q(N);"}, "a|S1.T >= T#45ms|c")),
        (ring({1: "act(S);"}, more="ACTION act: q := c; END_ACTION"), ring({1: "q(S);"})),
    ],
)
def test_no_delay_hides_a_mistake(source: Project, result: Project) -> None:
    for pair in (("iec", "codesys"), ("codesys", "iec"), ("matiec", "iec")):
        verdict = equivalent(source, result, pair, delay=AUTO)
        assert verdict.kind is VerdictKind.DIFFERENT, str(verdict)
        assert verdict.counterexample is not None
        assert verdict.counterexample.differences


def delayed_program(scans: int, calculated: str = "x") -> Project:
    shifts = " ".join(f"m{i + 1} := m{i};" for i in reversed(range(1, scans)))
    text = f"""PROGRAM Main VAR_INPUT x : BOOL; level : INT; END_VAR VAR_OUTPUT y : BOOL; v : INT; END_VAR
        VAR m1, m2, m3 : BOOL; k1, k2, k3 : INT; END_VAR
        y := {f"m{scans}" if scans else calculated}; v := {f"k{scans}" if scans else "level"};
        {shifts} {shifts.replace("m", "k")} m1 := {calculated}; k1 := level; END_PROGRAM"""
    return sfc.loads(text.encode(), format="iec-text")


def compared(first: Project, second: Project, delay: int | str | Delay | range, **more: int) -> Verdict:
    return equivalent(first, second, delay=delay, outputs=["y", "v"], **more)  # type: ignore[arg-type]


@pytest.mark.parametrize("scans", [0, 1, 2])
def test_the_smallest_delay_that_fits_is_found(scans: int) -> None:
    now, later = delayed_program(0), delayed_program(scans)
    assert compared(now, later, AUTO).delay == Delay(scans)
    assert compared(later, now, AUTO).delay == Delay(-scans)
    found = compared(now, later, range(4))
    assert (found.proven, found.delay.scans) == (True, scans)
    assert compared(now, later, 3).kind is VerdictKind.DIFFERENT
    assert compared(now, delayed_program(scans, "NOT x"), AUTO).kind is VerdictKind.DIFFERENT


def test_what_the_later_side_does_first_is_not_compared_or_begins_later() -> None:
    now, later = delayed_program(0), delayed_program(1)
    together = compared(now, later, Delay(1))
    assert together.delay_notes == ("the first scan of the second has no counterpart",)
    assert compared(now, later, Delay(1, late_start=True)).kind is VerdictKind.DIFFERENT
    assert compared(now, now, Delay(1, late_start=True)).kind is VerdictKind.DIFFERENT  # other inputs then
    data = together.as_dict()
    kinds = ("late_start", "retimed", "operated_later", "in_sequence", "settled")
    assert data["delay"] == {"scans": 1, **dict.fromkeys(kinds, False)}
    assert data["delay_notes"] == list(together.delay_notes)
    assert str(together).startswith("equal, second 1 scan later (proof: ")


def test_errors_are_compared_in_their_turn() -> None:
    text = """PROGRAM Main VAR_INPUT x : BOOL; END_VAR VAR_OUTPUT y : BOOL; END_VAR VAR old : BOOL; n : INT; END_VAR
        y := {test}; IF {test} THEN n := 1 / n; END_IF; old := x; END_PROGRAM"""
    now, later = (sfc.loads(text.format(test=test).encode(), format="iec-text") for test in ("x", "old"))
    found = equivalent(now, later, delay=1, outputs=["y"])
    assert (found.kind, found.gap) == (VerdictKind.UNTESTED, "both end with an error: line 1 (Main): division by zero")
    assert equivalent(now, later).kind is VerdictKind.DIFFERENT


@pytest.mark.slow
def test_runs_are_compared_with_the_delay_too() -> None:
    now, later = delayed_program(0), delayed_program(2)
    tried = compared(now, later, AUTO, cap=1)
    assert (tried.kind, tried.delay.scans) == (VerdictKind.TESTED, 2)
    assert str(tried).startswith("equal, second 2 scans later in ")
    wrong = compared(now, delayed_program(2, "x AND level < 100"), 2, cap=1)
    assert wrong.counterexample is not None
    assert not wrong.counterexample.shortest


def test_names_of_steps_that_differ_are_given() -> None:
    source, result = ring({1: "q(N);"}), ring({1: "q(N);"})
    for step in result.pou("Main").sfc.steps:  # type: ignore[union-attr]
        result.pou("Main").sfc.rename_step(step.name, f"Schritt_{step.name}")  # type: ignore[union-attr]
    flags = {f"S{i}": f"Schritt_S{i}" for i in range(3)}
    verdict = equivalent(source, result, ("s7graph", "codesys"), delay=AUTO, step_flags=flags)
    assert verdict.proven
    assert {"S0.X", "S1.X", "S2.X", "q"} <= set(verdict.compared)
    swapped = equivalent(source, result, ("s7graph", "codesys"), delay=AUTO, step_flags=flags | {"S1": "Schritt_S2.X"})
    assert swapped.kind is VerdictKind.DIFFERENT


def test_what_only_one_tool_obeys_rests_and_is_not_compared() -> None:
    text = """FUNCTION_BLOCK Main VAR_INPUT INIT_SQ, OFF_SQ, go : BOOL; END_VAR VAR_OUTPUT q : BOOL; S_NO : INT; END_VAR
        INITIAL_STEP A: END_STEP TRANSITION FROM A TO B := go; END_TRANSITION
        STEP B: q(N); END_STEP TRANSITION FROM B TO A := NOT go; END_TRANSITION END_FUNCTION_BLOCK"""
    project = sfc.loads(text.encode(), format="iec-text")
    verdict = between(project, "s7graph", "codesys")
    assert verdict.proven, str(verdict)
    assert "INIT_SQ, OFF_SQ at rest" in verdict.notes
    assert "S_NO" in verdict.uncompared
    assert verdict.inputs == ("go",)
    assert "INIT_SQ" in between(project, "s7graph", "s7graph").inputs


def test_delays_that_are_none() -> None:
    for wrong in ("soon", ()):
        with pytest.raises(ModelError, match="no delay"):
            equivalent(ring(), ring(), delay=wrong)


@pytest.mark.slow
@settings(deadline=None, max_examples=10)
@given(flow=flows(), qualifiers=st.lists(st.sampled_from("NSRPLD"), max_size=4), random=st.randoms())
def test_charts_of_every_shape_have_a_constant_delay(flow: Flow, qualifiers: list[str], random: Random) -> None:
    """But for actions of the initial step, which only one of the tools may execute."""
    chart = chart_of(flow)
    for number, text in enumerate(qualifiers):
        action = ActionAssociation(id=900 + number, qualifier=Qualifier(text), target=f"q{random.randrange(2)}")
        action.duration = "T#20ms" if text in "LD" else None
        random.choice(chart.steps[1:]).actions.append(action)
    verdict = equivalent(chart, chart, ("iec", "codesys"), delay=AUTO)
    assert verdict.proven, str(verdict)
    assert verdict.delay == Delay(1)


# -- scans that are cut elsewhere


@settings(deadline=None, max_examples=examples(15))
@given(
    flow=flows(),
    qualifiers=st.lists(st.sampled_from("N S R P L D".split()), min_size=3, max_size=3),
    random=st.randoms(),
)
def test_retimed_scans_are_those_of_the_tool(flow: Flow, qualifiers: list[str], random: Random) -> None:
    """Conditions of a scan and actions of the next have the same inputs, all else is as CODESYS has it."""
    chart = chart_of(flow)
    for number, text in enumerate(qualifiers):
        duration = "T#20ms" if text in "LD" else None
        step = chart.steps[number % len(chart.steps)]
        guard = None if number else Expression(text="x")
        step.actions.append(
            ActionAssociation(
                id=900 + number, qualifier=Qualifier(text), target=f"q{number}", duration=duration, condition=guard
            )
        )
    rows = [{name: random.random() < 0.5 for name in (*flow.inputs(), "x")} for _ in range(31)]
    tool = sfc.simulate(chart, inputs=lambda i, _: rows[i + 1] | {"x": rows[i]["x"]}, scans=30, profile="codesys")
    cut = sfc.simulate(chart, inputs=lambda i, _: rows[i], scans=30, profile=retimed(PROFILES["codesys"]))
    for scan in range(30):
        assert tool.active(scan) == cut.active(scan)
        assert [tool[f"q{i}"][scan] for i in range(3)] == [cut[f"q{i}"][scan] for i in range(3)]


SPLIT = """PROGRAM Main VAR_INPUT a, b : BOOL; END_VAR VAR_OUTPUT q : BOOL; END_VAR
{start} {initial} Idle: END_STEP STEP Left: q(N); END_STEP STEP Right: END_STEP {more}
TRANSITION FROM Idle TO (Left, Right) := a; END_TRANSITION TRANSITION FROM (Left, Right) TO Idle := b; END_TRANSITION
END_PROGRAM"""


@pytest.mark.parametrize(("entered", "passes"), [("Idle, More", True), ("Left, Right", False), ("Idle, Left", False)])
def test_only_a_step_that_leads_to_the_initial_step_may_pass_first(*, entered: str, passes: bool) -> None:
    """A proof lets the first begin later then, so a step that leads elsewhere must not count."""
    more = "STEP More: END_STEP" if "More" in entered else ""
    begin = f"INITIAL_STEP Start: END_STEP TRANSITION FROM Start TO ({entered}) := TRUE; END_TRANSITION"
    plain, later = (
        sfc.loads(SPLIT.format(start=start, initial=initial, more=added).encode(), format="iec-text")
        for start, initial, added in (("", "INITIAL_STEP", ""), (begin, "STEP", more))
    )
    verdict = equivalent(plain, later, "iec", outputs={"q": "q"})
    assert verdict.equal is passes, verdict
    assert ("the first begins when" in str(verdict)) is passes


FAILING = """
FUNCTION_BLOCK Main
VAR_INPUT a : BOOL; END_VAR
VAR_OUTPUT n : INT := 2; END_VAR
INITIAL_STEP S0: END_STEP
TRANSITION FROM S0 TO S1 := a; END_TRANSITION
STEP S1: Run(N); END_STEP
TRANSITION FROM S1 TO S0 := S1.T >= T#20ms; END_TRANSITION
ACTION Run: IF S1.X AND S1.T >= T#20ms THEN n := 1 / (n - n); END_IF; END_ACTION
END_FUNCTION_BLOCK
"""


def test_an_error_that_only_one_side_comes_to_is_a_difference_in_sequence() -> None:
    """CODESYS executes the action once more before it tests the transition."""
    pou = sfc.loads(FAILING.encode(), format="iec-text").pou("Main")
    assert equivalent(pou, pou, ("iec", "codesys"), delay=Delay(1, retimed=True)).equal
    verdict = equivalent(pou, pou, ("iec", "codesys"), delay=Delay(1, in_sequence=True))
    assert verdict.counterexample is not None
    assert str(verdict.counterexample.differences[0]).startswith("only the second fails: ")
