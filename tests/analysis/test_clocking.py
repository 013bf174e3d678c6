"""Facts about the times of programs, found before they are searched."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.analysis.timers import clocking, step_times
from plcopen_sfc.languages.networks import DrawingRules, draw_fbd, draw_ld
from plcopen_sfc.languages.st.parsing import parse_statements
from plcopen_sfc.model import (
    Action,
    ActionAssociation,
    BodyCondition,
    IlBody,
    PartialChart,
    Qualifier,
    SfcNetwork,
    StBody,
)
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.semantics.subjects import Subject, resolve

MS = 1_000_000


def chart(condition: str, duration: str | None = None) -> Subject:
    network = SfcNetwork()
    first, second = network.add_step("A", initial=True), network.add_step("B")
    network.add_transition(first, second, condition)
    network.add_transition(second, first, "TRUE")
    if duration is not None:
        association = ActionAssociation(id=100, qualifier=Qualifier.L, target="Q", duration=duration)
        network.steps[1].actions.append(association)
    return resolve(network)


def test_the_scan_time_divides_every_duration_twice() -> None:
    clock = clocking([chart("A.T > T#1s", "T#400ms"), chart("A.T > T#2.2s")], None)
    assert clock.constants == (400 * MS, 1000 * MS, 2200 * MS)
    assert clock.scan_time == 100 * MS
    assert clocking([chart("Go")], None).scan_time == 10 * MS
    assert clocking([chart("A.T > T#1s")], 7 * MS).scan_time == 7 * MS


@pytest.mark.parametrize(
    ("condition", "duration", "limited"),
    [
        ("Go", None, True),
        ("A.T > T#1s", "T#5s", True),
        ("A.t>=TIME#1s AND NOT (A.T < t#2s)", None, True),
        ("A.T - T#1s > T#1s", None, False),
        ("A.T > T#1s + Delay", None, False),
        ("A.T > T#1s-Delay", None, False),
        ("Total - A.T > T#1s", None, False),
        ("Total-A.T>T#1s", None, False),
        ("(A.T > T#1s) OR B.T <= T#2s", None, True),
        ("Total MOD A.T > T#1s", None, False),
        ("Go AND A.T > T#1s AND B.T < T#1s", None, True),
        ("(A.T) > T#1s", None, True),
        ("A.T > Delay", None, False),
        ("T#1s < (A.T)", None, True),
        ("Go", "Delay", False),
        ("3s/X1", None, True),
        ("X1 / 3 s", None, True),
        ("1B1 * /1B2 * [C1>=3]", None, True),
        ("/(a + b̅) · ¬NOT_AUS", None, True),
        ("a AND (b", None, False),
    ],
)
def test_elapsed_times_are_limited_where_they_are_compared_with_constants(
    condition: str, duration: str | None, *, limited: bool
) -> None:
    assert (step_times(chart(condition, duration), 10 * MS).limit is not None) is limited


@pytest.mark.parametrize("draw", [draw_fbd, draw_ld])
@pytest.mark.parametrize(("condition", "limited"), [("A.T > T#1s AND Go", True), ("A.T > T#1s AND A.T > Delay", False)])
def test_times_in_a_drawn_condition_are_limited_where_its_boxes_compare_them(
    draw: Callable[..., Any], condition: str, *, limited: bool
) -> None:
    subject = chart("Go")
    assert subject.pou.chart is not None
    statements = parse_statements(f"Result := {condition};", Dialect.IEC).tree.statements
    drawn = BodyCondition(name="Ready", body=draw(statements, DrawingRules(Dialect.IEC)).body)
    subject.pou.chart.transitions[0].condition = drawn
    found = step_times(subject, 10 * MS)
    assert (found.limit is not None) is limited
    assert (found.read, found.anywhere) == ({"a"}, set())


def test_times_of_steps_are_limited_by_the_durations_of_their_own_program() -> None:
    assert step_times(chart("A.T > T#1s", "T#2s"), 10 * MS).limit == 2010 * MS


def test_times_of_grafcet_are_durations_too() -> None:
    assert clocking([chart("3s/X1 AND a/500ms")], None).constants == (500 * MS, 3000 * MS)
    inner = chart("20ms/(a OR b)/40ms").pou.sfc
    assert inner is not None
    outer = SfcNetwork(partial_charts=[PartialChart(name="G1", chart=inner)])
    assert clocking([resolve(outer)], None).constants == (20 * MS, 40 * MS)


def test_a_program_that_reads_the_clock_has_no_finite_states() -> None:
    assert "clock" in clocking([chart("TIME() > T#5s")], None).reason


def test_durations_of_what_is_called_count_too() -> None:
    text = """
    FUNCTION_BLOCK Inner VAR t : TON; END_VAR t(IN := TRUE, PT := T#3s); END_FUNCTION_BLOCK
    FUNCTION_BLOCK Outer VAR i : Inner; END_VAR i(); END_FUNCTION_BLOCK
    FUNCTION_BLOCK Other VAR t : TON; END_VAR t(PT := T#7s); END_FUNCTION_BLOCK
    PROGRAM Main VAR o : Outer; END_VAR o(); END_PROGRAM
    """
    project = sfc.loads(text.encode(), format="iec-text")
    assert clocking([resolve(project, "Main")], None).constants == (3000 * MS,)


def test_times_of_steps_with_names_in_quotes() -> None:
    found = chart('#"Step 1".T >= T#2s AND "DB"."Other step".U > T#1s')
    found.project.dialect = Dialect.SCL
    times = step_times(found, 10 * MS)
    assert times.read == {"step 1", "other step"}


@pytest.mark.parametrize(
    ("condition", "constants"),
    [
        ("Go (* T#3s *)", ()),
        ("Text = 'T#3s'", ()),
        ("A.T > T#1s (* after T#3s *)", (1000 * MS,)),
        ("Go (* TIME() *)", ()),
    ],
)
def test_durations_in_comments_and_strings_are_none(condition: str, constants: tuple[int, ...]) -> None:
    found = clocking([chart(condition)], None)
    assert (found.constants, found.reason) == (constants, "")


def test_times_of_steps_in_comments_and_strings_are_not_read() -> None:
    times = step_times(chart("Go (* B.T *) AND Text <> 'A.T'"), 10 * MS)
    assert times.read == frozenset()
    assert times.limit is not None


def test_durations_of_what_is_named_in_a_comment_do_not_count() -> None:
    text = """
    FUNCTION_BLOCK Other VAR t : TON; END_VAR t(PT := T#7s); END_FUNCTION_BLOCK
    PROGRAM Main VAR o : BOOL; END_VAR o := TRUE; (* Other *) END_PROGRAM
    """
    project = sfc.loads(text.encode(), format="iec-text")
    assert clocking([resolve(project, "Main")], None).constants == ()


def test_instruction_list_reads_times_of_steps() -> None:
    found = chart("Go")
    found.pou.actions.append(Action(name="Look", body=IlBody(text="LD A.T\nGT T#1s\nST Late")))
    times = step_times(found, 10 * MS)
    assert (times.read, times.anywhere, times.limit) == ({"a"}, {"a"}, None)


def test_what_cannot_be_read_may_read_every_time_that_it_names() -> None:
    found = chart("Go")
    found.pou.actions.append(Action(name="Look", body=StBody(text="x := := A.T > T#1s;")))
    times = step_times(found, 10 * MS)
    assert "a" in times.anywhere
    assert times.limit is None
