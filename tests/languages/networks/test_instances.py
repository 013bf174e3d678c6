"""Calls with outputs, and boxes of S7 that keep their state in a variable: drawn, and read as they are executed."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plcopen_sfc import model as m
from plcopen_sfc.languages.networks import (
    DrawingRules,
    DrawnBody,
    body_statements,
    declared_rules,
    draw_fbd,
    draw_ld,
)
from plcopen_sfc.languages.st import parse_statements, print_node
from tests.sweeps import examples


def drawn(text: str, rules: DrawingRules, *, ladder: bool = False) -> DrawnBody[m.FbdBody] | DrawnBody[m.LdBody]:
    statements = parse_statements(text).tree.statements
    return draw_ld(statements, rules) if ladder else draw_fbd(statements, rules)


def lines(found: DrawnBody[m.FbdBody] | DrawnBody[m.LdBody]) -> list[str]:
    assert not found.problems
    read = body_statements(found.body)
    assert read.complete
    return print_node(read.tree).split("\n")


RULES = DrawingRules(instances={"drive": "FB_Drive", "late": "TON"})


@pytest.mark.parametrize("ladder", [False, True])
def test_outputs_go_to_the_variables_beside_their_pins(ladder: bool) -> None:
    found = drawn("drive(start := a AND b, speed := n, done => q, fault => alarm.bits[2]);", RULES, ladder=ladder)
    assert lines(found) == [
        "drive(start := a AND b, speed := n);",
        "q := drive.done;",
        "alarm.bits[2] := drive.fault;",
    ]
    (block,) = [n for n in found.body.networks[0].nodes if isinstance(n, m.Block) and n.instance == "drive"]
    assert [variable.name for variable in block.parameters.outputs] == ["done", "fault"]


def test_outputs_of_standard_blocks_are_drawn_once() -> None:
    found = drawn("late(IN := a, PT := T#1s, Q => b, ET => t);", RULES)
    assert lines(found) == ["late(IN := a, PT := T#1s);", "b := late.Q;", "t := late.ET;"]
    (block,) = [n for n in found.body.networks[0].nodes if isinstance(n, m.Block)]
    assert [variable.name for variable in block.parameters.outputs] == ["Q", "ET"]


def test_what_is_no_plain_output_stays_text() -> None:
    found = drawn("drive(start := a, NOT done => q);", RULES)
    assert [problem.message for problem in found.problems]


NAMES = st.sampled_from(["a", "b", "c"])


@settings(deadline=None, max_examples=examples(40))
@given(
    st.lists(st.tuples(NAMES, st.sampled_from(["q1", "q2", "q3"])), min_size=1, max_size=4, unique_by=lambda p: p[1]),
    st.booleans(),
)
def test_calls_come_back_in_their_order(calls: list[tuple[str, str]], ladder: bool) -> None:
    instances = {f"fb{number}": "FB_Drive" for number in range(len(calls))}
    text = "\n".join(f"fb{number}(start := {a}, done => {q});" for number, (a, q) in enumerate(calls))
    found = drawn(text, DrawingRules(instances=instances), ladder=ladder)
    expected = [
        line
        for number, (a, q) in enumerate(calls)
        for line in (f"fb{number}(start := {a});", f"{q} := fb{number}.done;")
    ]
    assert lines(found) == expected


OPERANDS = declared_rules(
    [m.Variable(name=n, type=m.ElementaryType(name=m.Elementary.BOOL)) for n in ("x", "y", "old")]
)
OPERANDS = replace(OPERANDS, operands={"x": "RS", "y": "SR", "old": "R_TRIG"})


@pytest.mark.parametrize("ladder", [False, True])
def test_flip_flops_keep_their_state_in_a_variable(ladder: bool) -> None:
    found = drawn("x(S := a, R1 := b); y(S1 := x, R := c); q := x;", OPERANDS, ladder=ladder)
    assert lines(found) == ["x := (a OR x) AND NOT b;", "y := x OR y AND NOT c;", "q := x;"]


def test_they_are_executed_where_they_stand_though_nothing_uses_their_output() -> None:
    found = drawn("q1 := x; x(S := a, R1 := b); q2 := x;", OPERANDS)
    (network,) = found.body.networks
    for node in network.nodes:  # as in TIA Portal, which has neither places nor an order
        node.position, node.execution_order = (0, 0), None
    assert lines(found) == ["q1 := x;", "x := (a OR x) AND NOT b;", "q2 := x;"]


def test_what_uses_a_flip_flop_is_wired_to_it_or_reads_its_variable() -> None:
    found = drawn("x(S := a, R1 := b); q := x.Q1; p := x.Q1 AND c;", OPERANDS)
    assert lines(found) == ["x := (a OR x) AND NOT b;", "q := x;", "p := x AND c;"]


def test_edges_keep_the_last_value_in_a_variable() -> None:
    found = drawn("old(CLK := a); q := old.Q;", OPERANDS)
    value, *rest = lines(found)
    helper = value.removesuffix(" := a AND NOT old;")
    assert helper != value
    assert rest == ["old := a;", f"q := {helper};"]
