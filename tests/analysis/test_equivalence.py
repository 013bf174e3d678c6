"""Schemes of programming a chart: the right ones are proven equal to it, the wrong ones are found out."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import pytest
from hypothesis import given, settings

import plcopen_sfc as sfc
from plcopen_sfc.analysis import Verdict, VerdictKind, equivalent
from plcopen_sfc.errors import ModelError
from plcopen_sfc.model import ActionAssociation, Pou, Qualifier, SfcNetwork
from plcopen_sfc.pages.verdict_words import Verdicts
from plcopen_sfc.semantics.net import Competing
from plcopen_sfc.semantics.profile import PROFILES
from tests.analysis.schemes import (
    EXACT,
    WRONG_ANYWHERE,
    Flow,
    chart_of,
    clear_then_set,
    exact_case,
    flows,
    if_chain,
    if_chain_reversed,
    program,
    ring,
    step_flags,
    textbook,
    textbook_set_dominant,
    unguarded,
)
from tests.sweeps import examples

IEC_ALL = replace(PROFILES["iec"], name="all", competing=Competing.ALL)
SELECTION = Flow(4, (((0,), (1,)), ((0,), (2,)), ((1,), (3,)), ((2,), (3,)), ((3,), (0,))))
SELF_LOOP = Flow(2, (((0,), (0,)), ((0,), (1,)), ((1,), (0,))))
PARALLEL = Flow(6, (((0,), (1, 2)), ((1,), (3,)), ((2,), (4,)), ((3, 4), (5,)), ((5,), (0,))))
CHARTS = {
    "ring of two": ring(2),
    "ring of four": ring(4),
    "selection": SELECTION,
    "self-loop": SELF_LOOP,
    "simultaneous": PARALLEL,
    "two initial steps": Flow(4, (((0,), (1,)), ((1,), (0,)), ((2,), (3,)), ((3,), (2,))), initial=(0, 2)),
}


def compare(flow: Flow, code: Pou) -> Verdict:
    return equivalent(chart_of(flow), code, "iec", step_flags=step_flags(flow))


def assert_different(verdict: Verdict, scans: int | None = None) -> None:
    assert verdict.kind is VerdictKind.DIFFERENT, str(verdict)
    assert verdict.counterexample is not None
    assert verdict.counterexample.differences
    if scans is not None:
        assert len(verdict.counterexample.inputs) == scans, str(verdict)


# -- what is right


@pytest.mark.parametrize("scheme", EXACT)
@pytest.mark.parametrize("chart", CHARTS)
def test_exact_schemes_are_proven(scheme: str, chart: str) -> None:
    verdict = compare(CHARTS[chart], EXACT[scheme](CHARTS[chart]))
    assert verdict.proven, str(verdict)
    assert len(verdict.compared) == CHARTS[chart].steps


@pytest.mark.parametrize("chart", ["ring of two", "ring of four", "selection", "self-loop"])
def test_a_case_on_one_variable_is_proven(chart: str) -> None:
    flow = CHARTS[chart]
    code = exact_case(flow)
    assert compare(flow, code).proven
    by_value = equivalent(chart_of(flow), code, "iec", step_flags={f"S{n}": f"s = {n}" for n in range(flow.steps)})
    assert by_value.proven
    assert by_value.states == flow.steps


@pytest.mark.slow
@settings(deadline=None, max_examples=examples(25))
@given(flow=flows())
def test_exact_schemes_are_proven_for_random_charts(flow: Flow) -> None:
    for scheme in EXACT.values():
        verdict = compare(flow, scheme(flow))
        assert verdict.proven, str(verdict)
    if flow.single():
        assert compare(flow, exact_case(flow)).proven


# -- what is wrong


@pytest.mark.slow
@settings(deadline=None, max_examples=examples(20))
@given(flow=flows())
def test_textbook_chains_are_found_different_for_random_charts(flow: Flow) -> None:
    for scheme in WRONG_ANYWHERE.values():
        assert_different(compare(flow, scheme(flow)))


@settings(deadline=None, max_examples=examples(25))
@given(flow=flows())
def test_competing_transitions_without_a_guard_are_found_wherever_there_are_competing_transitions(flow: Flow) -> None:
    verdict = compare(flow, unguarded(flow))
    competing = any(flow.competing(number) for number in range(len(flow.transitions)))
    assert verdict.proven is not competing, str(verdict)


@settings(deadline=None, max_examples=10)
@given(flow=flows(parallel=False, most=6))
def test_competing_transitions_without_a_guard_are_right_where_all_are_cleared(flow: Flow) -> None:
    assert equivalent(chart_of(flow), unguarded(flow), IEC_ALL, step_flags=step_flags(flow)).proven


def test_overlap_and_run_through_of_the_textbook_chain() -> None:
    # with c0 and c1 the token is in S2 after one scan, and S1 and S2 are active together
    assert_different(compare(ring(4), textbook(ring(4))), 1)


def test_two_step_loops_of_the_textbook_chain_never_move() -> None:
    verdict = compare(ring(2), textbook(ring(2)))
    assert_different(verdict, 1)
    assert verdict.counterexample is not None
    names = {each.name for each in verdict.counterexample.differences}
    assert names == {"S0.X", "S1.X"}
    assert_different(compare(ring(2), textbook_set_dominant(ring(2))))


def test_chains_of_ifs() -> None:
    assert_different(compare(ring(4), if_chain(ring(4))), 1)
    # backwards nothing runs through but from the last step to the first
    assert_different(compare(ring(4), if_chain_reversed(ring(4))))
    backwards = Flow(3, (((2,), (0,)), ((1,), (2,)), ((0,), (1,))))
    assert_different(compare(backwards, if_chain_reversed(backwards)), 1)


def test_selection_without_priority_doubles_the_token() -> None:
    verdict = compare(SELECTION, unguarded(SELECTION))
    assert_different(verdict, 1)
    assert verdict.counterexample is not None
    assert dict(verdict.counterexample.inputs[0]) == {"c0": True, "c1": True}


def test_to_clear_and_set_transition_by_transition() -> None:
    # two tokens, one behind the other: the step that is left is entered in the same scan
    flow = Flow(3, (((0,), (1,)), ((1,), (2,)), ((2,), (0,))), initial=(0, 1))
    assert_different(compare(flow, clear_then_set(flow)), 1)
    assert compare(flow, EXACT["two phases"](flow)).proven


def test_a_self_loop_with_reset_dominance() -> None:
    lines = [
        "T0 := X0 AND c0;",
        "T1 := X0 AND c1 AND NOT T0;",
        "T2 := X1 AND c2;",
        "X0 := (T0 OR T2 OR X0) AND NOT (T0 OR T1);",
        "X1 := (T1 OR X1) AND NOT T2;",
    ]
    variables = ["X0 : BOOL := TRUE", "X1 : BOOL", "T0 : BOOL", "T1 : BOOL", "T2 : BOOL"]
    assert_different(compare(SELF_LOOP, program(lines, ["c0", "c1", "c2"], variables)), 1)


def test_an_init_pulse_of_one_scan_empties_the_textbook_chain() -> None:
    exact = [
        "T0 := X0 AND c0 AND NOT Init;",
        "T1 := X1 AND c1 AND NOT Init;",
        "T2 := X2 AND c2 AND NOT Init;",
        "X0 := (Init OR T2 OR X0) AND NOT T0;",
        "X1 := (T0 OR X1) AND NOT (T1 OR Init);",
        "X2 := (T1 OR X2) AND NOT (T2 OR Init);",
    ]
    bits = ["T0 : BOOL", "T1 : BOOL", "T2 : BOOL"]
    flags = ["X0 : BOOL := TRUE", "X1 : BOOL", "X2 : BOOL"]
    inputs = ["c0", "c1", "c2", "Init"]
    # Init is right for the chain but where the second step is active: there R wins in the first network
    wrong = [*exact[:3], "X0 := (Init OR T2 OR X0) AND NOT (X1 OR T0);", *exact[4:]]
    verdict = equivalent(program(exact, inputs, flags + bits), program(wrong, inputs, flags + bits), "iec")
    assert_different(verdict, 2)
    assert verdict.counterexample is not None
    assert verdict.counterexample.inputs[1]["Init"] is True
    without = equivalent(
        program(exact, inputs, flags + bits), program(wrong, inputs, flags + bits), "iec", fixed={"init": False}
    )
    assert without.proven


REGIONS = """
CASE {s0} OF
  1: IF c0 THEN s0 := 9; s1 := 10; s2 := 20; END_IF;
  9: IF {s1} = 11 AND {s2} = 21 AND c3 THEN s0 := 4; s1 := 0; s2 := 0; END_IF;
  4: IF c4 THEN s0 := 1; END_IF;
END_CASE;
"""
CHILDREN = """
CASE {s1} OF 10: IF c1 THEN s1 := 11; END_IF; END_CASE;
CASE {s2} OF 20: IF c2 THEN s2 := 21; END_IF; END_CASE;
"""
LIVE = {"s0": "s0", "s1": "s1", "s2": "s2"}
OLD = {"s0": "o0", "s1": "o1", "s2": "o2"}
REGION_FLAGS = {"S0": "s0 = 1", "S1": "s1 = 10", "S2": "s2 = 20", "S3": "s1 = 11", "S4": "s2 = 21", "S5": "s0 = 4"}


def regions(text: str) -> Verdict:
    variables = ["s0 : INT := 1", *(f"{name} : INT" for name in ("s1", "s2", "o0", "o1", "o2"))]
    code = program(text, [f"c{n}" for n in range(5)], variables)
    return equivalent(chart_of(PARALLEL), code, "iec", step_flags=REGION_FLAGS)


def test_one_case_for_each_region_is_right_from_a_snapshot_only() -> None:
    snapshot = "o0 := s0; o1 := s1; o2 := s2;\n"
    assert regions(snapshot + REGIONS.format_map(OLD) + CHILDREN.format_map(OLD)).proven
    assert regions(snapshot + CHILDREN.format_map(OLD) + REGIONS.format_map(OLD)).proven
    # parents first: the children move in the scan of the fork; children first: the join sees their last move
    assert_different(regions(REGIONS.format_map(LIVE) + CHILDREN.format_map(LIVE)), 1)
    assert_different(regions(CHILDREN.format_map(LIVE) + REGIONS.format_map(LIVE)), 2)


# -- outputs


def acting(flow: Flow, actions: dict[int, list[tuple[Qualifier, str, str | None]]]) -> SfcNetwork:
    chart = chart_of(flow)
    number = 1000
    for step, associations in actions.items():
        for qualifier, target, duration in associations:
            number += 1
            association = ActionAssociation(id=number, qualifier=qualifier, target=target, duration=duration)
            chart.steps[step].actions.append(association)
    return chart


N, S, R = Qualifier.N, Qualifier.S, Qualifier.R
MOVES = """
CASE s OF
  0: {q0} IF c0 THEN s := 1; {leave} END_IF;
  1: {q1} IF c1 THEN s := 2; {leave} END_IF;
  2: {q2} IF c2 THEN s := 0; {leave} END_IF;
END_CASE;
"""
STATE = ["s : INT", "Q : BOOL"]


def test_an_output_of_two_neighbours_has_no_gap() -> None:
    chart = acting(ring(3), {1: [(N, "Q", None)], 2: [(N, "Q", None)]})
    behind = MOVES.format(q0="", q1="", q2="", leave="") + "Q := s = 1 OR s = 2;"
    inside = MOVES.format(q0="", q1="Q := TRUE;", q2="Q := TRUE;", leave="Q := FALSE;")
    flags = {f"S{n}": f"s = {n}" for n in range(3)}
    right = equivalent(chart, program(behind, ["c0", "c1", "c2"], STATE), "iec", step_flags=flags)
    assert right.proven, str(right)
    assert "Q" in right.compared
    wrong = equivalent(chart, program(inside, ["c0", "c1", "c2"], STATE), "iec", step_flags=flags)
    assert_different(wrong)


def test_an_output_of_two_steps_is_no_matter_of_the_last_writer() -> None:
    chart = acting(PARALLEL, {1: [(N, "Q", None)], 2: [(N, "Q", None)]})
    code = EXACT["two phases"](PARALLEL)
    variables = ["X0 : BOOL := TRUE", *(f"X{n} : BOOL" for n in range(1, 6)), *(f"T{n} : BOOL" for n in range(5))]
    text = code.body.text if code.body is not None and code.body.language == "ST" else ""
    last = "\nIF X1 THEN Q := TRUE; ELSE Q := FALSE; END_IF;\nIF X2 THEN Q := TRUE; ELSE Q := FALSE; END_IF;"
    for addition, proven in (("\nQ := X1 OR X2;", True), (last, False)):
        changed = program(text + addition, PARALLEL.inputs(), [*variables, "Q : BOOL"])
        verdict = equivalent(chart, changed, "iec", step_flags=step_flags(PARALLEL))
        assert verdict.proven is proven, str(verdict)


def test_stored_outputs() -> None:
    chart = acting(ring(3), {1: [(S, "Q", None)], 2: [(R, "Q", None)]})
    moves = MOVES.format(q0="", q1="", q2="", leave="")
    flags = {f"S{n}": f"s = {n}" for n in range(3)}
    stored = moves + "IF s = 1 THEN Q := TRUE; ELSIF s = 2 THEN Q := FALSE; END_IF;"
    assert equivalent(chart, program(stored, ["c0", "c1", "c2"], STATE), "iec", step_flags=flags).proven
    not_stored = moves + "Q := s = 1;"
    verdict = equivalent(chart, program(not_stored, ["c0", "c1", "c2"], STATE), "iec", step_flags=flags)
    assert verdict.proven  # S1 is always followed by S2, where Q is reset
    back = Flow(3, (((0,), (1,)), ((1,), (0,)), ((1,), (2,)), ((2,), (0,))))
    wide = acting(back, {1: [(S, "Q", None)], 2: [(R, "Q", None)]})
    text = exact_case(back)
    body = text.body.text if text.body is not None and text.body.language == "ST" else ""
    variables = ["s : INT", "Q : BOOL", *(f"X{n} : BOOL" for n in range(3))]
    wrong = program(body + "\nQ := s = 1;", back.inputs(), variables)
    assert_different(equivalent(wide, wrong, "iec", step_flags=step_flags(back)))


# -- times


def timed_chart(condition: str) -> SfcNetwork:
    return chart_of(replace(ring(2), conditions=("c0", condition)))


TIMED = """
t(IN := s = 1, PT := {time});
CASE s OF
  0: IF c0 THEN s := 1; END_IF;
  1: IF t.Q THEN s := 0; END_IF;
END_CASE;
t(IN := s = 1, PT := {time});
"""
TIMED_STATE = ["s : INT", "t : TON"]
TIMED_FLAGS = {"S0": "s = 0", "S1": "s = 1"}


def test_step_times_are_followed_to_their_end() -> None:
    chart = timed_chart("S1.T >= T#5s")
    right = equivalent(chart, program(TIMED.format(time="T#5s"), ["c0"], TIMED_STATE), "iec", step_flags=TIMED_FLAGS)
    assert right.proven, str(right)
    assert right.timed
    assert right.scan_time == 2_500_000_000  # one scan before, in, and after T#5s
    finer = equivalent(
        chart,
        program(TIMED.format(time="T#5s"), ["c0"], TIMED_STATE),
        "iec",
        step_flags=TIMED_FLAGS,
        scan_time="100ms",
    )
    assert finer.proven
    assert finer.states > right.states
    wrong = program(TIMED.format(time="T#4.9s"), ["c0"], TIMED_STATE)
    assert_different(equivalent(chart, wrong, "iec", step_flags=TIMED_FLAGS))


def test_greater_is_not_greater_or_equal_in_the_scan_of_the_limit() -> None:
    assert_different(
        equivalent(
            timed_chart("S1.T > T#5s"),
            program(TIMED.format(time="T#5s"), ["c0"], TIMED_STATE),
            "iec",
            step_flags=TIMED_FLAGS,
        )
    )


def test_a_timer_inside_a_case_is_not_reset() -> None:
    inside = """
    CASE s OF
      0: IF c0 THEN s := 1; END_IF;
      1: t(IN := TRUE, PT := T#5s); IF t.Q THEN s := 0; END_IF;
    END_CASE;
    """
    code = program(inside, ["c0"], TIMED_STATE)
    verdict = equivalent(timed_chart("S1.T >= T#5s"), code, "iec", step_flags=TIMED_FLAGS)
    assert_different(verdict)


def test_times_that_are_calculated_with_are_not_proven_where_they_go_on_growing() -> None:
    growing = timed_chart("S1.T - T#1s >= T#4s AND c1")
    code = program(TIMED.format(time="T#5s").replace("t.Q", "t.Q AND c1"), ["c0", "c1"], TIMED_STATE)
    verdict = equivalent(growing, code, "iec", step_flags=TIMED_FLAGS, cap=200, runs=20, scans=50)
    assert verdict.kind is VerdictKind.TESTED
    assert "elapsed times" in verdict.reason
    limited = timed_chart("S1.T >= T#5s AND c1")
    assert equivalent(limited, code, "iec", step_flags=TIMED_FLAGS, cap=200).proven


def test_timers_whose_time_is_no_constant_are_followed_to_their_end() -> None:
    def timer(time: str, declared: str) -> Pou:
        variables = ["r : TON", "Q : BOOL", f"d : TIME := {declared}"]
        return program(f"r(IN := c0, PT := {time}); Q := r.Q;", ["c0"], variables)

    long, short = timer("d + T#1ms", "T#3ms"), timer("d + T#1ms", "T#1ms")
    assert equivalent(long, timer("T#4ms", "T#1ms"), "iec", outputs=["Q"], scan_time="1ms").proven
    assert_different(equivalent(long, short, "iec", outputs=["Q"], scan_time="1ms"))
    late = "r(IN := c0, PT := T#1ms * n); Q := r.Q; n := {};"
    growing, other = (program(late.format(value), ["c0"], ["r : TON", "Q : BOOL", "n : INT"]) for value in ("40", "41"))
    verdict = equivalent(growing, other, "iec", outputs=["Q"], scan_time="1ms")
    assert_different(verdict)
    assert verdict.counterexample is not None
    assert verdict.counterexample.shortest


@pytest.mark.slow
@pytest.mark.parametrize("qualifier", ["N", "S", "P", "P1", "P0", "L", "D", "SD", "DS", "SL"])
@pytest.mark.parametrize("profile", ["iec", "codesys", "matiec"])
def test_charts_with_every_qualifier_have_few_states(qualifier: str, profile: str) -> None:
    time = "T#2s" if qualifier in ("L", "D", "SD", "DS", "SL") else None
    chart = acting(ring(4), {1: [(Qualifier(qualifier), "A", time)], 3: [(R, "A", None)]})
    late = acting(ring(4), {2: [(Qualifier(qualifier), "A", time)], 0: [(R, "A", None)]})
    same = equivalent(chart, chart.model_copy(deep=True), profile)
    assert same.proven
    assert same.states <= 40
    assert_different(equivalent(chart, late, profile))


def test_a_chart_that_is_not_stable_for_all_inputs_is_proven_for_the_others() -> None:
    verdict = equivalent(chart_of(ring(2)), chart_of(ring(2)), "grafcet")
    assert verdict.proven
    assert "never become stable" in str(verdict)


# -- numbers


def numeric(condition: str, test: str) -> Verdict:
    chart = chart_of(replace(ring(2), conditions=(condition, "c1")))
    text = f"CASE s OF 0: IF {test} THEN s := 1; END_IF; 1: IF c1 THEN s := 0; END_IF; END_CASE;"
    lines = [
        "PROGRAM Code",
        "VAR_INPUT n : INT; m : INT; c1 : BOOL; END_VAR",
        "VAR s : INT; END_VAR",
        text,
        "END_PROGRAM",
    ]
    code = sfc.loads("\n".join(lines).encode(), format="iec-text").pous[0]
    return equivalent(chart, code, "iec", step_flags={"S0": "s = 0", "S1": "s = 1"}, runs=30)


def test_numbers_are_compared_in_their_intervals() -> None:
    assert numeric("n > 5", "n >= 6").proven
    assert numeric("n > 5 AND n < 100", "NOT (n <= 5 OR n > 99)").proven
    verdict = numeric("n > 5", "n > 6")
    assert_different(verdict, 1)
    assert verdict.counterexample is not None
    assert verdict.counterexample.inputs[0]["n"] == 6


@pytest.mark.slow
def test_numbers_that_are_calculated_with_are_tried() -> None:
    verdict = numeric("n / 2 > 3", "n > 7")
    assert verdict.kind is VerdictKind.TESTED
    assert "n is used otherwise" in verdict.reason
    assert_different(numeric("n / 2 > 3", "n > 6"))
    assert_different(numeric("n + 1 > 6", "n > 5"))  # behind 32767 is -32768
    assert_different(numeric("n > m", "n >= m"))


def test_texts_of_numbers_are_not_taken_for_known() -> None:
    for text in ("INT_TO_STRING(n) = '5'", "REAL_TO_STRING(INT_TO_REAL(n)) = '5.0'", "LEN(INT_TO_STRING(n)) = 6"):
        verdict = numeric(text, "FALSE")
        assert not verdict.proven, text


# -- the verdict


def test_a_verdict_tells_what_it_stands_on() -> None:
    verdict = compare(PARALLEL, EXACT["two phases"](PARALLEL))
    assert str(verdict).splitlines() == [
        f"equal (proof: {verdict.states} states, all inputs)",
        "covered: 6 of 6 steps, 5 of 5 transitions; 17 of 17 assignments",
    ]
    data = json.loads(json.dumps(verdict.as_dict()))
    assert data["proven"] is True
    assert data["compared"] == [f"S{n}.X" for n in range(6)]
    assert data["inputs"] == [f"c{n}" for n in range(5)]


def test_a_counterexample_is_a_table_and_json() -> None:
    verdict = compare(SELECTION, unguarded(SELECTION))
    text = str(verdict)
    assert text.startswith("different after 1 scan (shortest input trace)\n")
    assert "S2.X is FALSE in the first and TRUE in the second" in text
    data = json.loads(json.dumps(verdict.as_dict()))
    assert data["counterexample"]["inputs"] == [{"c0": True, "c1": True}]
    assert data["counterexample"]["shortest"] is True


COUNTER = """
PROGRAM Main
VAR_INPUT part : BOOL; END_VAR
VAR_OUTPUT full : BOOL; {out} END_VAR
VAR old : BOOL; {own} END_VAR
IF part AND NOT old THEN n := n + {step}; END_IF;
old := part;
full := n >= {limit};
END_PROGRAM
"""


def counter(limit: int, **where: str) -> sfc.Project:
    return sfc.loads(
        COUNTER.format(limit=limit, **{"out": "", "own": "", "step": "1", **where}).encode(), format="iec-text"
    )


def test_what_repeats_in_a_long_counterexample_is_shown_once() -> None:
    verdict = equivalent(counter(30, own="n : INT;"), counter(31, own="n : INT;"), "iec", cap=10)
    assert verdict.counterexample is not None
    scans = len(verdict.counterexample.inputs)
    lines = str(verdict).splitlines()
    assert len(lines) < 12
    (folded,) = (line for line in lines if line.startswith(".. "))
    found = re.fullmatch(r"\.\. the 2 rows above (\d+) more times, up to scan (\d+)", folded)
    assert found is not None
    rows = [line for line in lines if line[0].isdigit()]
    assert len(rows) + 2 * int(found[1]) == scans > 50
    assert rows[3].startswith(f"{int(found[2]) + 1} ")
    assert len(verdict.as_dict()["counterexample"]["inputs"]) == scans
    assert Verdicts(str, str)(folded) == f".. die 2 Zeilen darüber noch {found[1]} Mal, bis Zyklus {found[2]}"


def test_a_long_counterexample_without_a_pattern_loses_its_middle() -> None:
    faster = counter(9, out="n : INT;", step="SEL(n > 60, 1, 2)")
    verdict = equivalent(counter(9, out="n : INT;"), faster, "iec", cap=10)
    assert verdict.counterexample is not None
    lines = str(verdict).splitlines()
    assert len(lines) < 50
    (left_out,) = (line for line in lines if line.startswith(".. "))
    told = int(left_out.split()[1])
    rows = [line for line in lines if line[:1].isdigit()]
    assert told + len(rows) == len(verdict.counterexample.inputs)
    assert (rows[0].split()[0], rows[-1].split()[0]) == ("0", str(len(verdict.counterexample.inputs) - 1))


def test_beyond_the_cap_it_is_tried() -> None:
    flow = Flow(
        8, tuple(each for n in range(0, 8, 2) for each in (((n,), (n + 1,)), ((n + 1,), (n,)))), (), (0, 2, 4, 6)
    )
    equal = equivalent(
        chart_of(flow), EXACT["two phases"](flow), "iec", step_flags=step_flags(flow), cap=1, runs=12, scans=30
    )
    assert equal.kind is VerdictKind.TESTED
    assert 0 < equal.scans <= 10 * 12 * 30
    assert "more than 1 states" in equal.reason
    assert "directed runs" in str(equal)
    deep = textbook(flow)
    different = equivalent(chart_of(flow), deep, "iec", step_flags=step_flags(flow), cap=0, runs=30, scans=30)
    assert_different(different)


def test_the_same_question_has_the_same_answer() -> None:
    flow = PARALLEL
    verdicts = [compare(flow, textbook(flow)).as_dict() for _ in range(2)]
    assert verdicts[0] == verdicts[1]


def test_two_charts_are_compared_by_their_steps() -> None:
    assert equivalent(chart_of(PARALLEL), chart_of(PARALLEL), "iec").proven
    renamed = replace(SELECTION, transitions=(*SELECTION.transitions[:2][::-1], *SELECTION.transitions[2:]))
    assert_different(equivalent(chart_of(SELECTION), chart_of(renamed), "iec"))


def test_usual_names_of_flags_are_recognised() -> None:
    flow = ring(3)
    lines = ["T0 := X_S0 AND c0; T1 := S1_X AND c1; T2 := XS2 AND c2;"]
    lines += ["IF T0 THEN X_S0 := FALSE; S1_X := TRUE; END_IF;", "IF T1 THEN S1_X := FALSE; XS2 := TRUE; END_IF;"]
    lines += ["IF T2 THEN XS2 := FALSE; X_S0 := TRUE; END_IF;"]
    variables = ["X_S0 : BOOL := TRUE", "S1_X, XS2 : BOOL", "T0, T1, T2 : BOOL"]
    verdict = equivalent(chart_of(flow), program(lines, flow.inputs(), variables), "iec")
    assert verdict.proven
    assert verdict.compared == ("S0.X", "S1.X", "S2.X")


def test_flags_are_recognised_by_the_numbers_of_steps_where_these_are_clear() -> None:
    assert equivalent(chart_of(PARALLEL), EXACT["two phases"](PARALLEL), "iec").compared[0] == "S0.X"
    chart = chart_of(ring(2))
    chart.steps[0].name, chart.steps[1].name = "Fill1", "Drain1"
    chart.steps[1].number = 7
    lines = ["T := X7; X7 := X1 AND c0; X1 := T AND c1;"]
    verdict = equivalent(chart, program(lines, ["c0", "c1"], ["X1 : BOOL := TRUE", "X7, T : BOOL"]), "iec")
    assert verdict.compared == ("Fill1.X", "Drain1.X")
    chart.steps[1].number = None  # now both names end with 1
    with pytest.raises(ModelError, match="nothing in common"):
        equivalent(chart, program(["X1 := c0;"], ["c0"], ["X1 : BOOL"]), "iec")


def test_what_cannot_be_compared_is_told() -> None:
    with pytest.raises(ModelError, match="nothing in common"):
        equivalent(chart_of(ring(2)), program(["y := c0;"], ["c0"], ["y : BOOL"]), "iec")
    with pytest.raises(ModelError, match="no step 'S7'"):
        equivalent(chart_of(ring(2)), textbook(ring(2)), "iec", step_flags={"S7": "X0"})
    with pytest.raises(ModelError, match="the second has no variable 'Q'"):
        equivalent(
            acting(ring(2), {0: [(N, "Q", None)]}), textbook(ring(2)), "iec", outputs=["Q"], step_flags={"S0": "X0"}
        )
    partly = equivalent(
        acting(ring(2), {0: [(N, "Q", None)]}), EXACT["two phases"](ring(2)), "iec", step_flags={"S0": "X0"}
    )
    assert (partly.kind, partly.gap) == (VerdictKind.UNTESTED, "only the first has Q")
    assert set(partly.uncompared) == {"Q", "S1.X"}


# -- numbers of earlier scans


def level_program(body: str) -> Pou:
    text = f"""PROGRAM Main VAR_INPUT level : INT; name : STRING; END_VAR VAR_OUTPUT q : INT; s : STRING; END_VAR
        VAR n : BOOL; old, older : INT; text : STRING; END_VAR {body} END_PROGRAM"""
    project = sfc.loads(text.encode(), format="iec-text")
    return project.pous[0]


@pytest.mark.parametrize(
    ("now", "before"),
    [
        ("IF n THEN q := level; END_IF; n := TRUE;", "IF n THEN q := old; END_IF; n := TRUE; old := level;"),
        (
            "IF n THEN q := old; END_IF; n := TRUE; old := level;",
            "IF n THEN q := older; older := old; ELSE older := level; END_IF; n := TRUE; old := level;",
        ),
        ("IF level > 5 THEN q := level; END_IF;", "IF level > 5 AND old > 5 THEN q := old; END_IF; old := level;"),
        ("IF n THEN s := name; END_IF; n := TRUE;", "IF n THEN s := text; END_IF; n := TRUE; text := name;"),
    ],
)
def test_a_number_of_the_scan_before_is_another_one(now: str, before: str) -> None:
    verdict = equivalent(level_program(now), level_program(before), "iec", outputs=["q", "s"])
    assert_different(verdict)
    assert verdict.counterexample is not None
    assert verdict.counterexample.shortest


def test_numbers_of_two_scans_are_not_compared_in_a_proof() -> None:
    rising = level_program("IF n AND level > old THEN q := 1; END_IF; n := TRUE; old := level;")
    assert_different(equivalent(rising, level_program("q := 0;"), "iec", outputs=["q"]))
    same = equivalent(rising, rising, "iec", outputs=["q"])
    assert same.kind is not VerdictKind.DIFFERENT


# -- what is compared


def test_a_pou_brings_its_project_along() -> None:
    text = """FUNCTION Twice : INT VAR_INPUT x : INT; END_VAR Twice := 2 * x; END_FUNCTION
        PROGRAM {name} VAR_INPUT a : BOOL; END_VAR VAR_OUTPUT n : INT; END_VAR
        IF a THEN n := {value}; ELSE n := 0; END_IF; END_PROGRAM"""
    calling = sfc.loads(text.format(name="Calling", value="Twice(3)").encode(), format="iec-text")
    plain = sfc.loads(text.format(name="Plain", value="6").encode(), format="iec-text")
    assert equivalent(calling.pou("Calling"), plain.pou("Plain")).proven


def test_what_lower_returns_can_be_compared() -> None:
    project = sfc.load("fixtures/training-chain/iec-text.st")
    name = next(pou.name for pou in project.pous if pou.sfc is not None)
    lowered = sfc.lower(project, pou=name)
    assert lowered.proof is not None
    directly = equivalent(project.pou(name), lowered)
    assert (directly.kind, directly.states) == (lowered.proof.kind, lowered.proof.states)
    classic = sfc.lower(project, pou=name, style="classic")
    assert equivalent(project.pou(name), classic).kind is classic.proof.kind  # type: ignore[union-attr]


def test_flags_of_steps_are_never_freed() -> None:
    """Nothing writes the flag of a step that is never active."""
    chart = sfc.loads(
        b"FUNCTION_BLOCK F VAR go : BOOL; q : BOOL; END_VAR INITIAL_STEP A: END_STEP"
        b" TRANSITION FROM A TO B := go; END_TRANSITION STEP B: q(N); END_STEP"
        b" TRANSITION FROM B TO A := NOT go; END_TRANSITION STEP C: END_STEP END_FUNCTION_BLOCK",
        format="iec-text",
    )
    code = sfc.loads(
        b"FUNCTION_BLOCK F VAR go : BOOL; q : BOOL; A : BOOL := TRUE; X_C : BOOL; keep : BOOL; END_VAR"
        b" IF A AND go THEN A := FALSE; ELSIF NOT A AND NOT go THEN A := TRUE; END_IF;"
        b" q := NOT A; keep := X_C; END_FUNCTION_BLOCK",
        format="iec-text",
    )
    for flags in ({"A": "A", "C": "X_C"}, None):
        verdict = equivalent(chart, code, "iec", step_flags=flags, free_inputs="all")
        assert verdict.inputs == ("go",), str(verdict)
        assert "C.X" in verdict.compared
        assert verdict.frozen == ()
        assert "object at 0x" not in str(verdict)


def test_a_chart_of_a_tool_is_different_from_a_grafcet_that_never_becomes_stable() -> None:
    """Only a plan, the first of both, leaves out what no situation answers; the proof was about nothing."""
    resting = chart_of(replace(ring(2), conditions=("FALSE", "c0")))
    never = chart_of(replace(ring(2), conditions=("c0", "c0")))
    assert equivalent(resting, never, ("s7graph", "grafcet")).different
    assert "never become stable" in str(equivalent(never, resting, ("grafcet", "s7graph")))


@pytest.mark.parametrize("last", ["NOT a", "a AND b", "b"])
def test_a_grafcet_that_never_becomes_stable_is_different_from_one_that_does(last: str) -> None:
    never, resting = (ring_of_three(condition) for condition in ("a", last))
    assert equivalent(never, resting, "grafcet").different
    assert equivalent(resting, never, "grafcet").different
    code = sfc.lower(resting, verify=False, profile="grafcet")
    assert equivalent(never, code.pou, "grafcet", step_flags=code.step_flags).different
    proof = equivalent(never, never, "grafcet")
    assert proof.proven
    assert "never become stable" in str(proof)


def ring_of_three(last: str) -> sfc.SfcNetwork:
    chart = sfc.SfcNetwork()
    steps = [chart.add_step(str(number), initial=number == 1) for number in (1, 2, 3)]
    for place, condition in enumerate(("a", "a", last)):
        chart.add_transition(steps[place], steps[(place + 1) % 3], condition)
    steps[2].actions = [ActionAssociation(id=12, kind="continuous", target="W")]
    return chart


def test_verdicts_count_in_the_singular() -> None:
    alone = program("q := TRUE;", variables=["q : BOOL"])
    text = str(equivalent(alone, alone))
    assert "(proof: 1 state, all inputs" in text
