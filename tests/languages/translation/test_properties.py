"""Random programs in one dialect and in another: what the translation keeps, and the way back."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import permutations
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_statements, print_node, transform, walk, without_parentheses
from plcopen_sfc.languages.st.lexer import tokenize
from plcopen_sfc.languages.st.nodes import Expression, Node, Operator, Quoting
from plcopen_sfc.languages.translation import TextKind, TranslationContext, translate, translate_text
from plcopen_sfc.model.dialect import Dialect
from tests.languages.st_strategies import laid_out, programs

IEC, CODESYS, TWINCAT, SCL = Dialect.IEC, Dialect.CODESYS, Dialect.TWINCAT, Dialect.SCL
SLOW_TO_DRAW = settings(suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large], deadline=None)

pairs = st.sampled_from(list(permutations((IEC, CODESYS, SCL), 2)))
"""A source and a target. TwinCAT is CODESYS."""

# -- programs that every dialect can say ------------------------------------------------------------------------------

LOCALS = ["a", "b", "count", "t", "c"]
GLOBALS = ["Motor", "G1", "F1", "T1"]
CONTEXT = TranslationContext(locals=LOCALS, types={"t": "TON", "T1": "TON", "c": "CTU"})

_names = st.sampled_from(["a", "b", "count", "Motor", "G1"]).map(n.Name)
_literals = st.sampled_from(
    """TRUE 0 42 16#FF 2#1010 1.5 1.0E-3 INT#5 REAL#1.5 'text' 'a$'b' T#5s T#1d2h LTIME#1us D#2024-01-31 TOD#12:30:00
    WORD#16#FF BYTE#16#0 "wide" "it's" """.split()
).map(n.Literal)
_addresses = st.sampled_from(["%IX0.0", "%QX1.7", "%MB4"]).map(n.Address)
_members = st.sampled_from(["x", "Value", "3", "15"]).map(n.Name)
_binary = [o for o in Operator if o not in (Operator.NOT, Operator.NEGATE, Operator.PLUS, Operator.AND_THEN)]
_binary.remove(Operator.OR_ELSE)


def _places(inner: st.SearchStrategy[Expression]) -> st.SearchStrategy[Expression]:
    def longer(base: st.SearchStrategy[Expression]) -> st.SearchStrategy[Expression]:
        return st.builds(n.Member, base, _members) | st.builds(n.Index, base, st.tuples(inner))

    return st.recursive(_names, longer, max_leaves=3) | _addresses


def _calls(inner: st.SearchStrategy[Expression]) -> st.SearchStrategy[Expression]:
    value = st.builds(n.Argument, inner)
    function = st.builds(n.Call, st.sampled_from(["ABS", "SQRT", "INT_TO_REAL"]).map(n.Name), st.tuples(value))
    own = st.builds(n.Call, st.just(n.Name("F1")), st.tuples(st.builds(n.Argument, inner, st.just(n.Name("p")))))
    return function | own


def _larger(inner: st.SearchStrategy[Expression]) -> st.SearchStrategy[Expression]:
    rows = st.sampled_from([Operator.AND, Operator.OR, Operator.ADD])
    return st.one_of(
        st.builds(n.Operation, st.sampled_from(_binary), st.tuples(inner, inner)),
        st.builds(n.Operation, rows, st.lists(inner, min_size=3, max_size=4).map(tuple)),
        st.builds(n.Unary, st.sampled_from([Operator.NOT, Operator.NEGATE]), inner),
        st.builds(n.Parenthesized, inner),
        _places(inner),
        _calls(inner),
    )


_expressions = st.recursive(_names | _literals | _addresses, _larger, max_leaves=8)
_inputs = {"t": ("IN", "PT"), "T1": ("IN", "PT"), "c": ("CU", "R")}
_instances = st.sampled_from(sorted(_inputs)).flatmap(
    lambda name: st.builds(
        n.Call,
        st.just(n.Name(name)),
        st.tuples(*(st.builds(n.Argument, _expressions, st.just(n.Name(pin))) for pin in _inputs[name])),
    )
)
_simple = st.one_of(
    st.builds(n.Assignment, _places(_expressions), _expressions),
    st.builds(n.CallStatement, _instances),
    st.builds(n.Exit),
    st.builds(n.ReturnStatement),
    st.builds(n.Empty),
)


def _compound(inner: st.SearchStrategy[n.Statement]) -> st.SearchStrategy[n.Statement]:
    block = st.lists(inner, min_size=1, max_size=3).map(tuple)
    branches = st.lists(st.builds(n.Branch, _expressions, block), min_size=1, max_size=2).map(tuple)
    labels = st.lists(st.sampled_from("0 1 42".split()).map(n.Literal), min_size=1, max_size=2).map(tuple)
    cases = st.lists(st.builds(n.CaseBranch, labels, block), min_size=1, max_size=2).map(tuple)
    return st.one_of(
        st.builds(n.If, branches, st.none() | block),
        st.builds(n.Case, _expressions, cases, st.none() | block),
        st.builds(n.For, _names, _expressions, _expressions, st.none() | _expressions, block),
        st.builds(n.While, _expressions, block),
        st.builds(n.Repeat, block, _expressions),
    )


_bodies = st.lists(st.recursive(_simple, _compound, max_leaves=5), min_size=1, max_size=4).map(
    lambda found: n.Statements(tuple(found))
)


def in_dialect(tree: Any, dialect: Dialect) -> Any:
    """A program of IEC 61131-3 as `dialect` says it."""
    return transform(tree, lambda node: _in_dialect(node, dialect))


def _in_dialect(node: Node, dialect: Dialect) -> Node:
    scl, codesys = dialect is SCL, dialect in (CODESYS, TWINCAT)
    match node:
        case n.Name(identifier) if scl and identifier in LOCALS:
            return replace(node, quoting=Quoting.LOCAL)
        case n.Name(identifier) if scl and identifier in GLOBALS:
            return replace(node, quoting=Quoting.GLOBAL)
        case n.Name(identifier) if scl and identifier.isdigit():
            return n.Name(f"%X{identifier}")
        case n.Call(n.Name("T1", Quoting.GLOBAL) as callee, _):
            return replace(node, callee=n.Member(callee, n.Name("TON")))
        case n.Argument(_, n.Name("R")) if codesys:
            return replace(node, name=n.Name("RESET"))
        case n.Address(text) if scl:
            return n.Address(text.replace("X", ""))
        case n.Literal(text) if scl:
            new = text.replace("WORD#", "W#").replace("BYTE#", "B#")
            return n.Literal(f"WSTRING#'{text[1:-1].replace(chr(39), '$' + chr(39))}'" if text[0] == '"' else new)
        case n.Operation(Operator.POWER, (base, exponent)) if codesys:
            return n.Call(n.Name("EXPT"), (n.Argument(base), n.Argument(exponent)))
        case _:
            return node


def meaning_of(tree: Node) -> Node:
    """A program without parentheses; a power is one, however it is written."""
    return without_parentheses(transform(tree, _power))


def _power(node: Node) -> Node:
    match node:
        case n.Call(n.Name("EXPT"), (n.Argument(n.Node() as base), n.Argument(n.Node() as exponent))):
            return n.Operation(Operator.POWER, (base, exponent))
        case _:
            return node


@pytest.mark.slow
@SLOW_TO_DRAW
@given(pairs, _bodies)
def test_a_program_says_the_same_in_any_dialect(pair: tuple[Dialect, Dialect], tree: n.Statements) -> None:
    source, target = pair
    found = translate_text(print_node(in_dialect(tree, source)), "statements", source, target, CONTEXT)
    assert found.notes == ()
    assert found.parsed.problems == ()
    assert meaning_of(found.parsed.tree) == meaning_of(in_dialect(tree, target)), found.text


@pytest.mark.slow
@SLOW_TO_DRAW
@given(st.data(), pairs, _bodies)
def test_there_and_back_is_where_it_started(
    data: st.DataObject, pair: tuple[Dialect, Dialect], tree: n.Statements
) -> None:
    source, target = pair
    tree = transform(tree, _without_powers_and_slashes)
    text = data.draw(laid_out(print_node(in_dialect(tree, source)), source))
    there = translate_text(text, "statements", source, target, CONTEXT)
    back = translate(there.parsed, source, CONTEXT)
    expected = text.replace("/* C */", "(* C *)")
    if source is SCL:  # there a pragma in a body is none
        expected = expected.replace("{pragma := 'x'}", "(*pragma {pragma := 'x'}*)")
    assert back.text == expected


def _without_powers_and_slashes(node: Node) -> Node:
    """Powers come back with other parentheses: they are calls in one dialect; a slash may start a comment."""
    if isinstance(node, n.Operation) and node.operator in (Operator.POWER, Operator.DIVIDE):
        return replace(node, operator=Operator.SUBTRACT)
    return node


# -- all programs -----------------------------------------------------------------------------------------------------


@pytest.mark.slow
@SLOW_TO_DRAW
@given(st.data(), programs(), st.sampled_from(Dialect))
def test_nothing_is_lost_silently(data: st.DataObject, program: tuple[Dialect, n.Statements], target: Dialect) -> None:
    source, tree = program
    text = data.draw(laid_out(print_node(tree), source))
    context = TranslationContext(locals=["a", "Motor"])
    found = translate_text(text, "statements", source, target, context)
    parsed = parse_statements(text, source)
    assert parsed.problems == ()
    if found.parsed.problems:
        assert any(note.severity is Severity.ERROR for note in found.notes), found.text
    before = sorted(_inside(comment.text) for comment in parsed.comments)
    after = sorted(_inside(comment.text) for comment in tokenize(found.text, target).comments)
    assert [comment for comment in after if not re.match(r"\{(end)?region", comment)] == before
    for note in found.notes:
        start, end = note.span
        assert 0 <= start <= end <= len(text)
        assert parsed.place(start) == (note.line, note.column)
    new_names = {rename.old.casefold(): rename.new for rename in context.renames}  # case says nothing in names
    for node in walk(transform(tree, _without_empty_arguments)):
        if isinstance(node, n.Name) and not node.identifier.startswith("%"):
            name = new_names.get(node.identifier.casefold(), node.identifier)
            assert name in found.text or node.identifier in found.text, (name, found.text)


def _without_empty_arguments(node: Node) -> Node:
    if isinstance(node, n.Call):
        return replace(node, arguments=tuple(argument for argument in node.arguments if argument.value is not None))
    return node


def _inside(comment: str) -> str:
    """The text of a comment, without its delimiters."""
    return re.sub(r"^(\(\*pragma |\(/?\*|/\*|//)|(\*/?\)|\*/)$", "", comment)


_fragments = st.sampled_from(
    [
        *"""( ) [ ] ; : := => .. . , # " ' (* *) // /* */ { } ^ + - * / ** = <> & :P S= R= REF= += %IX0.0 %MW T# T#5s
        S5T# 16#FF P#M1.0 IF THEN ELSE END_IF CASE OF END_CASE REGION END_REGION {region} {endregion} GOTO JMP a "b" #c
        x.3 TON EXPT SQR LIMIT CONCAT ROUND TRUNC_INT AND_THEN NOT MOD TRUE Color#red ß""".split(),
        "\n",
    ]
)


@SLOW_TO_DRAW
@given(
    st.lists(_fragments | st.text(max_size=3), max_size=12).map(" ".join),
    st.sampled_from(["statements", "expression", "condition"]),
    st.sampled_from(Dialect),
    st.sampled_from(Dialect),
)
def test_no_text_is_an_error(text: str, kind: TextKind, source: Dialect, target: Dialect) -> None:
    found = translate_text(text, kind, source, target, TranslationContext(locals=["a"], enumerations=["Color"]))
    if found.parsed.problems and not any(note.severity is Severity.ERROR for note in found.notes):
        pytest.fail(found.text)
