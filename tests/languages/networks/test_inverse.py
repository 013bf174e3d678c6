"""Text drawn as a network and read again is the text, up to normal form."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plcopen_sfc.conversion.meaning import program_form
from plcopen_sfc.languages.networks.drawing_rules import DrawingRules
from plcopen_sfc.languages.networks.network_drawing import (
    DrawnExpression,
    draw_fbd,
    draw_fbd_expression,
    draw_ld,
    draw_ld_expression,
)
from plcopen_sfc.languages.networks.network_reading import body_statements
from plcopen_sfc.languages.networks.wires import normal_form
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.parsing import parse_expression, parse_statements
from plcopen_sfc.languages.st.printing import print_node
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.model.dialect import Dialect
from tests.languages.networks.build import read_drawn
from tests.languages.networks.programs import INSTANCES, booleans, numbers, programs

tools = st.sampled_from([None, *Tool])


def shown(tree: n.Node) -> str:
    return print_node(normal_form(tree))


def meant(tree: n.Node) -> str:
    """What a text means: in ladders NOT is at each contact, not around several."""
    return program_form(tree, lambda node: node)


@pytest.mark.slow
@settings(deadline=None)
@given(booleans | numbers, tools)
def test_an_expression_drawn_as_fbd_reads_as_itself(expression: n.Expression, tool: Tool | None) -> None:
    drawn = draw_fbd_expression(expression, DrawingRules(tool=tool))
    read = read_drawn(drawn)
    assert not read.problems
    assert not read.before
    assert read.tree is not None
    assert shown(read.tree) == shown(expression)
    assert normal_form(read.tree) == normal_form(expression)


@settings(deadline=None)
@given(booleans, tools)
def test_a_condition_drawn_as_ld_reads_as_itself(expression: n.Expression, tool: Tool | None) -> None:
    drawn = draw_ld_expression(expression, DrawingRules(tool=tool))
    read = read_drawn(drawn)
    assert not read.problems
    assert not read.before
    assert read.tree is not None
    assert meant(read.tree) == meant(expression)


@pytest.mark.slow
@settings(deadline=None)
@given(programs, tools, st.booleans(), st.sampled_from(["FBD", "LD"]))
def test_statements_drawn_read_as_themselves(
    program: n.Statements, tool: Tool | None, divided: bool, language: str
) -> None:
    rules = DrawingRules(Dialect.CODESYS, tool=tool, instances=INSTANCES)
    draw = draw_fbd if language == "FBD" else draw_ld
    read = body_statements(draw(program.statements, rules, divided=divided).body, Dialect.CODESYS)
    assert read.complete, read.problems
    assert not read.helpers
    assert meant(read.tree) == meant(program)
    assert language == "LD" or normal_form(read.tree) == normal_form(program)


@settings(deadline=None)
@given(booleans)
def test_the_normal_form_is_normal(expression: n.Expression) -> None:
    assert normal_form(normal_form(expression)) == normal_form(expression)


ODD = """
NOT(a) | AND(a) | EXPT(IN1 := i, IN2 := j) | f(a, Out => b) | f() | SR(a) | SEL(a) | SEL(G := a) | SUB(i, j, k)
ADD(IN1 := i, IN1 := j) | AND(IN2 := a, IN1 := b) | MAX(i) | a AND_THEN b | p^.x | THIS^.Go(a) | v[f(i)] > 5
INT_TO_REAL(EN := a, IN := i) | TIME#5s > t | 'text' = s | (((a))) | -(-i) | +i | MOVE(IN := a) | NOT NOT a
(a := b) AND c | Color#red = c
"""


@pytest.mark.parametrize("text", [text.strip() for text in re.split(r"[|\n]", ODD.strip())])
@pytest.mark.parametrize("draw", [draw_fbd_expression, draw_ld_expression])
def test_odd_expressions_read_as_themselves(text: str, draw: Callable[..., DrawnExpression]) -> None:
    parsed = parse_expression(text, Dialect.CODESYS)
    assert not parsed.problems
    drawn = draw(parsed.tree, DrawingRules(Dialect.CODESYS))
    read = read_drawn(drawn, Dialect.CODESYS)
    assert not read.before
    assert read.tree is not None
    assert shown(read.tree) == shown(parsed.tree)


def test_stored_variables_in_texts_of_boxes_are_those_of_the_dialect() -> None:
    program = parse_statements("WHILE a DO x S= b; y R= b; END_WHILE", Dialect.CODESYS).tree
    read = body_statements(draw_fbd(program.statements).body)
    assert read.complete
    assert normal_form(read.tree) == normal_form(program)
