"""Random expressions and statements for the properties of the translations."""

from __future__ import annotations

from typing import Any

from hypothesis import strategies as st

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import AssignmentKind, Expression, Operator

Strategy = st.SearchStrategy[Any]

INSTANCES = {"t1": "TON", "t2": "TP", "e1": "R_TRIG", "e2": "F_TRIG", "ff": "SR", "cnt": "CTU", "u1": "Valve"}
"""The function block instances of the random programs, and their types. ``Valve`` is no standard block."""

LOGIC = (Operator.AND, Operator.OR, Operator.XOR)
COMPARISONS = (
    Operator.EQUAL,
    Operator.UNEQUAL,
    Operator.LESS,
    Operator.GREATER,
    Operator.LESS_OR_EQUAL,
    Operator.GREATER_OR_EQUAL,
)


def name(text: str) -> n.Name:
    return n.Name(text)


def member(base: str, part: str) -> n.Member:
    return n.Member(n.Name(base), n.Name(part))


def negation(operand: Expression) -> n.Unary:
    return n.Unary(Operator.NOT, operand)


def call(callee: str, *values: Expression, **named: Expression) -> n.Call:
    arguments = [n.Argument(value) for value in values]
    arguments += [n.Argument(value, n.Name(key)) for key, value in named.items()]
    return n.Call(n.Name(callee), tuple(arguments))


def parenthesized(inner: Strategy) -> Strategy:
    return st.builds(n.Parenthesized, inner)


boolean_variables = st.sampled_from(
    [
        *(name(text) for text in ("a", "b", "c", "d", "Start")),
        member("GVL", "x"),
        member("Step3", "X"),
        member("t1", "Q"),
        member("e1", "Q"),
        member("e2", "Q"),
        member("ff", "Q1"),
        member("u1", "Open"),
        n.Index(n.Name("flags"), (n.Name("i"),)),
        n.Address("%IX0.3"),
    ]
)
number_variables = st.sampled_from(
    [*(name(text) for text in ("i", "j", "Level")), member("cnt", "CV"), n.Index(n.Name("v"), (n.Literal("2"),))]
)
number_literals = st.sampled_from([n.Literal("0"), n.Literal("1"), n.Literal("2.5"), n.Literal("16#FF")])
truths = st.sampled_from([n.Literal("TRUE"), n.Literal("FALSE"), n.Literal("true")])


def _numbers(inner: Strategy) -> Strategy:
    return st.one_of(
        st.builds(
            lambda op, v: n.Operation(op, tuple(v)), st.sampled_from([Operator.ADD, Operator.MULTIPLY]), several(inner)
        ),
        st.builds(
            lambda op, a, b: n.Operation(op, (a, b)),
            st.sampled_from([Operator.SUBTRACT, Operator.DIVIDE, Operator.MODULO, Operator.POWER]),
            inner,
            inner,
        ),
        st.builds(n.Unary, st.just(Operator.NEGATE), inner),
        st.builds(lambda a: call("ABS", a), inner),
        st.builds(lambda a: call("INT_TO_REAL", IN=a), inner),
        st.builds(lambda a, b: call("MAX", a, b), inner, inner),
        st.builds(lambda a, b, c: call("LIMIT", MX=c, MN=a, IN=b), inner, inner, inner),
        st.builds(lambda a, b: call("ADD", IN1=a, IN2=b), inner, inner),
        st.builds(lambda a: call("MOVE", a), inner),
        st.builds(lambda a, b: call("Scaled", Raw=a, Factor=b), inner, inner),
        parenthesized(inner),
    )


def several(inner: Strategy) -> Strategy:
    return st.lists(inner, min_size=2, max_size=4)


numbers = st.recursive(number_variables | number_literals, _numbers, max_leaves=5)


def _booleans(inner: Strategy) -> Strategy:
    return st.one_of(
        st.builds(lambda op, v: n.Operation(op, tuple(v)), st.sampled_from(LOGIC), several(inner)),
        st.builds(lambda op, v: n.Operation(op, tuple(v)), st.sampled_from(LOGIC), several(inner)),
        st.builds(negation, inner),
        st.builds(lambda g, a, b: call("SEL", g, a, b), inner, inner, inner),
        st.builds(lambda a: call("IsSafe", Door=a), inner),
        st.builds(lambda a, b, c: call("AND", a, b, c), inner, inner, inner),
        parenthesized(inner),
    )


comparisons = st.one_of(
    st.builds(lambda op, a, b: n.Operation(op, (a, b)), st.sampled_from(COMPARISONS), numbers, numbers),
    st.builds(lambda a, b, c: call("GT", a, b, c), number_variables, numbers, number_variables),
)
booleans = st.recursive(boolean_variables | boolean_variables | truths | comparisons, _booleans, max_leaves=12)
"""Boolean expressions with everything that is in conditions."""

pure_booleans = st.recursive(
    st.sampled_from([name(text) for text in "abcde"]) | truths,
    lambda inner: st.one_of(
        st.builds(lambda op, v: n.Operation(op, tuple(v)), st.sampled_from(LOGIC), several(inner)),
        st.builds(negation, inner),
        parenthesized(inner),
    ),
    max_leaves=15,
)
"""Boolean expressions of variables only."""

# -- statements -------------------------------------------------------------------------------------------------------

targets = st.sampled_from([name("out1"), name("out2"), name("a"), member("GVL", "x"), n.Address("%QX1.0")])
kinds = st.sampled_from([AssignmentKind.ASSIGN, AssignmentKind.ASSIGN, AssignmentKind.SET, AssignmentKind.RESET])


def _instance_call(instance: str, **named: Expression) -> n.CallStatement:
    return n.CallStatement(call(instance, **named))


calls = st.one_of(
    st.builds(lambda a: _instance_call("t1", IN=a, PT=n.Literal("T#5s")), booleans),
    st.builds(lambda a: _instance_call("t2", PT=n.Name("tPulse"), IN=a), booleans),
    st.builds(lambda i, a: _instance_call(i, CLK=a), st.sampled_from(["e1", "e2"]), booleans),
    st.builds(lambda a, b: _instance_call("ff", SET1=a, RESET=b), booleans, booleans),
    st.builds(lambda a, b: _instance_call("cnt", CU=a, PV=b), booleans, numbers),
    st.builds(lambda a, b: _instance_call("u1", Command=a, Position=b), booleans, numbers),
    st.just(_instance_call("t1")),
)
assignments = st.one_of(
    st.builds(n.Assignment, targets, booleans, kinds),
    st.builds(n.Assignment, st.sampled_from([name("k"), member("GVL", "n")]), numbers),
)
leaps = st.sampled_from([n.Goto(n.Name("again"), "JMP"), n.ReturnStatement()])
simple = st.one_of(assignments, assignments, calls, calls, leaps)


def _if(condition: Expression, *inner: n.Node) -> n.If:
    return n.If((n.Branch(condition, inner),))  # type: ignore[arg-type]


statements = st.one_of(
    simple,
    simple,
    simple,
    st.builds(_if, booleans, simple),
    st.builds(_if, booleans, simple, simple),
    st.builds(lambda c, a, b: n.If((n.Branch(c, (a,)),), (b,)), booleans, simple, simple),
    st.builds(lambda a: n.While(n.Name("b"), (a,)), assignments),
    st.just(n.LabelStatement(n.Name("again"))),
    st.builds(lambda a: n.CallStatement(call("Drive", Speed=a)), numbers),
    st.just(n.Empty()),
    st.builds(lambda a: n.RegionBlock("title", (a,)), simple),
)
programs = st.lists(statements, max_size=6).map(lambda found: n.Statements(tuple(found)))
"""Statements of every kind, most of which have a graphical form."""
