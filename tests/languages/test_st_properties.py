"""Random programs: what is printed is parsed as the same tree, in any layout; edits touch only their place."""

from __future__ import annotations

from collections import Counter
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from plcopen_sfc.languages.st import (
    Parsed,
    parse_expression,
    parse_statements,
    print_node,
    render,
    transform,
    walk,
    without_parentheses,
)
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.model.dialect import Dialect
from tests.languages.st_invariants import assert_tree_fits
from tests.languages.st_strategies import expressions, laid_out, programs, statements

SLOW_TO_DRAW = settings(suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large], deadline=None)


def read_back(parsed: Parsed[Any], tree: n.Node) -> None:
    assert parsed.problems == (), parsed.text
    assert without_parentheses(parsed.tree) == without_parentheses(tree), parsed.text
    assert_tree_fits(parsed)


@pytest.mark.slow
@SLOW_TO_DRAW
@given(programs())
def test_a_printed_program_is_read_as_the_same_tree(program: tuple[Dialect, n.Statements]) -> None:
    dialect, tree = program
    read_back(parse_statements(print_node(tree), dialect), tree)


@SLOW_TO_DRAW
@given(st.data(), st.sampled_from(Dialect))
def test_a_printed_expression_is_read_as_the_same_tree(data: st.DataObject, dialect: Dialect) -> None:
    tree = data.draw(expressions(dialect))
    read_back(parse_expression(print_node(tree), dialect), tree)


@pytest.mark.slow
@SLOW_TO_DRAW
@given(programs())
def test_a_tree_that_was_read_prints_as_itself(program: tuple[Dialect, n.Statements]) -> None:
    dialect, tree = program
    parsed = parse_statements(print_node(tree), dialect)
    again = parse_statements(print_node(parsed.tree), dialect)
    assert again.tree == parsed.tree  # with its parentheses: none is added, none is lost


@pytest.mark.slow
@SLOW_TO_DRAW
@given(st.data(), programs())
def test_layout_and_comments_say_nothing(data: st.DataObject, program: tuple[Dialect, n.Statements]) -> None:
    dialect, tree = program
    text = data.draw(laid_out(print_node(tree), dialect))
    parsed = parse_statements(text, dialect)
    read_back(parsed, tree)
    assert render(parsed, parsed.tree) == text


@pytest.mark.slow
@SLOW_TO_DRAW
@given(st.data(), programs())
def test_renaming_changes_the_names_and_nothing_else(
    data: st.DataObject, program: tuple[Dialect, n.Statements]
) -> None:
    dialect, tree = program
    text = data.draw(laid_out(print_node(tree), dialect))
    parsed = parse_statements(text, dialect)
    found = [node for node in walk(parsed.tree) if isinstance(node, n.Name)]
    if not found:
        return
    old = data.draw(st.sampled_from(found)).identifier

    def renamed(node: n.Node) -> n.Node:
        if isinstance(node, n.Name) and node.identifier == old:
            return n.Name("Renamed_1", node.quoting, span=node.span)
        return node

    expected, end = "", 0
    for name in sorted((each for each in found if each.identifier == old), key=lambda each: each.span or (0, 0)):
        assert name.span is not None
        expected += text[end : name.span[0]] + text[name.span[0] : name.span[1]].replace(old, "Renamed_1")
        end = name.span[1]
    changed = transform(parsed.tree, renamed)
    assert render(parsed, changed) == expected + text[end:]
    assert parse_statements(render(parsed, changed), dialect).tree == changed


STATEMENT_LISTS = ("statements", "branches", "otherwise", "handler", "finally_")


def spans_of_inner_statements(statement: n.Node) -> list[n.Span]:
    """Where the statements inside `statement` stand: they go, with their comments, when its body is another."""
    lists = [getattr(node, name, None) or () for node in walk(statement) for name in STATEMENT_LISTS]
    return [inner.span for nodes in lists for inner in nodes if inner.span is not None]


@pytest.mark.slow
@SLOW_TO_DRAW
@given(st.data(), programs())
def test_an_edited_tree_is_written_as_it_is_and_loses_no_comment(
    data: st.DataObject, program: tuple[Dialect, n.Statements]
) -> None:
    dialect, tree = program
    text = data.draw(laid_out(print_node(tree), dialect))
    parsed = parse_statements(text, dialect)
    body = list(parsed.tree.statements)
    # a semicolon on its own in front would be read as the end of what is before it
    new = tuple(each for each in data.draw(statements(dialect)).statements if not isinstance(each, n.Empty))
    at = data.draw(st.integers(0, len(body)))
    kind = data.draw(st.sampled_from(["insert", "replace", "condition"]))
    # nor does one stay behind what is new: it would be read as its end
    behind = at + 1 if kind == "replace" else at
    while kind != "condition" and behind < len(body) and isinstance(body[behind], n.Empty):
        del body[behind]
    if kind == "insert" or not body:
        body[at:at] = new
        edited = n.Statements(tuple(body))
    elif kind == "replace":
        body[at : at + 1] = new
        edited = n.Statements(tuple(body))
    else:
        value = data.draw(expressions(dialect))
        chosen = data.draw(st.integers(0, 5))
        operands = [node for node in walk(parsed.tree) if isinstance(node, n.Literal)]
        if not operands:
            return
        old = operands[chosen % len(operands)]
        edited = transform(parsed.tree, lambda node: n.Parenthesized(value) if node is old else node)
    written = parse_statements(render(parsed, edited), dialect)
    assert written.problems == (), written.text
    assert without_parentheses(written.tree) == without_parentheses(edited), written.text
    removed = parsed.tree.statements[at].span if kind == "replace" and at < len(parsed.tree.statements) else None
    gone = [] if removed is None else [removed] if not new else spans_of_inner_statements(parsed.tree.statements[at])
    expected = [c.text for c in parsed.comments if not any(start <= c.span[0] < end for start, end in gone)]
    lost = Counter(expected) - Counter(c.text for c in written.comments)
    assert not lost, written.text
