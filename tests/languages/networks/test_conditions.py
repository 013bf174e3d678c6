"""Conditions of transitions as expressions, however they are given."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plcopen_sfc.languages.networks.condition_reading import chart_statements, condition_expression
from plcopen_sfc.languages.networks.network_drawing import DrawnExpression, draw_fbd_expression, draw_ld_expression
from plcopen_sfc.languages.networks.results import NetworkExpression
from plcopen_sfc.languages.networks.wires import normal_form
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression
from plcopen_sfc.languages.st.printing import print_node
from plcopen_sfc.model import (
    Body,
    BodyCondition,
    Edge,
    Expression,
    FbdBody,
    IlBody,
    LdBody,
    LogicNetwork,
    NamedCondition,
    NamedTransition,
    Node,
    SfcNetwork,
    StBody,
    Step,
    Transition,
    WiredCondition,
)
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import InputPin
from tests.languages.networks.build import block, coil, contact, output, pin, rail, variable
from tests.languages.networks.programs import booleans


def chart(condition: object, *logic: Node) -> SfcNetwork:
    """A chart of two steps, 100 and 101, and one transition."""
    steps = [Step(id=100, name="S1", initial=True), Step(id=101, name="S2")]
    fields = {"id": 200, "sources": [100], "targets": [101], "condition": condition}
    return SfcNetwork(steps=steps, transitions=[Transition.model_validate(fields)], logic=list(logic))


def read(
    condition: object, *logic: Node, dialect: Dialect = Dialect.IEC, named: Body | None = None
) -> NetworkExpression:
    there = chart(condition, *logic)
    transitions = [NamedTransition(name="Ready", body=named)] if named is not None else []
    return condition_expression(there, there.transitions[0], dialect, transitions=transitions)


def text(result: NetworkExpression) -> str:
    """Everything that must be executed, and the expression."""
    assert result.tree is not None, result.problems
    return " ".join([print_node(statement) for statement in result.before] + [print_node(result.tree)])


def fbd(*nodes: Node) -> FbdBody:
    return FbdBody(networks=[LogicNetwork(nodes=list(nodes))])


def ld(*nodes: Node) -> LdBody:
    return LdBody(networks=[LogicNetwork(nodes=list(nodes))])


def test_texts() -> None:
    assert text(read("a AND b")) == "a AND b"
    assert text(read(Expression(text="a OR b", negated=True))) == "NOT (a OR b)"
    assert text(read(Expression(text="NOT a", negated=True))) == "a"
    assert [p.message for p in read("a AND").problems]


def test_no_condition() -> None:
    result = read(None)
    assert result.tree is None
    assert [str(p) for p in result.problems] == ["error: the transition has no condition"]


def test_wires_from_contacts() -> None:
    wired = WiredCondition(input=pin(2), negated=True)
    result = read(wired, rail(), contact(1, "a", 0), contact(2, "b", 1, negated=True), coil(3, "other", 1))
    assert text(result) == "NOT (a AND NOT b)"
    assert result.complete


def test_wires_that_meet_at_the_transition() -> None:
    assert text(read(WiredCondition(input=pin(1, 2)), rail(), contact(1, "a", 0), contact(2, "b", 0))) == "a OR b"


def test_wires_from_steps_and_function_blocks() -> None:
    timer = block(1, "TON", {"IN": (100, "x"), "PT": 2}, "Q", "ET", instance="timer")
    wired = WiredCondition(input=pin((1, "Q")))
    result = read(wired, timer, variable(2, "T#5s"))
    assert text(result) == "timer(IN := S1.X, PT := T#5s); timer.Q"
    assert result.instances == {"timer": "TON"}
    assert text(read(wired, timer, variable(2, "T#5s"), dialect=Dialect.CODESYS)) == (
        "timer(IN := S1.x, PT := T#5s); timer.Q"
    )


def test_edges_stand_before_the_expression() -> None:
    result = read(WiredCondition(input=pin(1)), rail(), contact(1, "a", 0, edge=Edge.RISING))
    assert text(result) == "edge_1(CLK := a); edge_1.Q"
    assert [helper.type_name for helper in result.helpers] == ["R_TRIG"]


def test_only_what_the_condition_depends_on_is_read() -> None:
    there = chart(
        WiredCondition(input=pin(1)), variable(1, "a"), variable(2, "b"), output(3, "x", 2), output(4, "y", (100, "x"))
    )
    assert text(condition_expression(there, there.transitions[0])) == "a"
    assert print_node(chart_statements(there).tree).splitlines() == ["x := b;", "y := S1.X;"]
    assert chart_statements(there).complete


def test_a_value_that_leads_nowhere_in_a_chart_is_a_problem() -> None:
    there = chart(WiredCondition(input=pin(1)), variable(1, "a"), variable(2, "b"))
    assert [str(p) for p in chart_statements(there).problems] == ["error: element 2: its value leads nowhere"]


def test_a_condition_wired_to_nothing() -> None:
    assert not read(WiredCondition(input=pin())).complete
    assert not read(WiredCondition(input=pin(77))).complete


@pytest.mark.parametrize("written", ["a AND b", ":= a AND b;", "a AND b;", "  := a AND b ", "Ready := a AND b;"])
def test_transition_objects_in_st(written: str) -> None:
    assert text(read(NamedCondition(name="READY"), named=StBody(text=written))) == "a AND b"


def test_statements_before_the_condition() -> None:
    body = StBody(text="timer(IN := a);\nReady := timer.Q;")
    assert text(read(NamedCondition(name="Ready"), named=body)) == "timer(IN := a); timer.Q"
    body = StBody(text="IF a THEN Ready := b; END_IF;")
    assert not read(NamedCondition(name="Ready"), named=body).complete


def test_transition_objects_that_are_drawn() -> None:
    named = NamedCondition(name="Ready", negated=True)
    body: Body = fbd(
        variable(1, "a"), variable(2, "b"), block(3, "OR", {"IN1": 1, "IN2": 2}, "OUT"), output(4, "Ready", 3)
    )
    assert text(read(named, named=body)) == "NOT (a OR b)"
    assert text(read(named, named=ld(rail(), contact(1, "a", 0), coil(2, "READY", 1, negated=True)))) == "a"


def test_a_transition_object_that_is_not_there_stands_by_its_name() -> None:
    assert text(read(NamedCondition(name="Elsewhere", negated=True))) == "NOT Elsewhere"


def test_drawn_in_place() -> None:
    nodes = [variable(1, "a"), variable(2, "5"), block(3, "GT", {"In1": 1, "In2": 2}, "Out1")]
    assert text(read(BodyCondition(body=fbd(*nodes)))) == "a > 5"
    assert read(BodyCondition(body=fbd(*nodes))).complete
    assert text(read(BodyCondition(body=fbd(*nodes, output(4, "whatever", 3))))) == "a > 5"
    assert text(read(BodyCondition(body=fbd(*nodes, output(4, "T1", 3), output(5, "x", 1)), name="T1"))) == (
        "T1 := a > 5; x := a; T1"
    )


def test_the_last_call_of_a_function_is_an_assumption() -> None:
    result = read(BodyCondition(body=fbd(variable(1, "a"), block(2, "IsSafe", {"Door": 1}, "OUT"))))
    assert text(result) == "IsSafe(Door := a)"
    assert [str(p) for p in result.problems] == ["warning: the value of the last call is taken as the condition"]


def test_bodies_that_do_not_tell_their_result() -> None:
    assert not read(BodyCondition(body=fbd(variable(1, "a"), output(2, "x", 1), output(3, "y", 1)))).complete
    assert not read(BodyCondition(body=IlBody(text="LD a\nJMPC x"))).complete


def test_instructions_that_only_compute_are_read() -> None:
    assert text(read(BodyCondition(body=IlBody(text="LD a\nAND b")))) == "a AND b"


@pytest.mark.slow
@settings(deadline=None)
@given(booleans, st.sampled_from([draw_fbd_expression, draw_ld_expression]))
def test_a_condition_drawn_into_a_chart_reads_as_itself(
    expression: n.Expression, draw: Callable[..., DrawnExpression]
) -> None:
    drawn = draw(expression, first_id=300)
    wired = WiredCondition(input=InputPin(connections=list(drawn.outputs)), negated=drawn.negated)
    result = read(wired, *drawn.network.nodes)
    assert result.complete
    assert result.tree is not None
    assert normal_form(result.tree) == normal_form(expression)


def test_what_is_drawn_as_branches_because_it_is_short_is_read_as_text() -> None:
    # 30 elements when it is drawn; more when it is read, before its arguments are in their usual form
    written = parse_expression("(a XOR GT(i, ABS(i), cnt.CV) XOR -i = -(MAX(i, cnt.CV) - (i - i))) AND (a OR b)").tree
    drawn = draw_ld_expression(written, first_id=300)
    wired = WiredCondition(input=InputPin(connections=list(drawn.outputs)), negated=drawn.negated)
    result = read(wired, *drawn.network.nodes)
    assert result.tree is not None
    assert normal_form(result.tree) == normal_form(written)
