"""Invariants of every tree of structured text, whether its text is right or not."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

from plcopen_sfc.languages.st import Parsed, children, render, walk
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.declaration_nodes import Declarations
from plcopen_sfc.languages.st.nodes import Quoting


def assert_tree_fits(parsed: Parsed[Any]) -> None:
    """The tree covers its text: spans are nested and in order, and say where things stand; nothing is left out."""
    text = parsed.text
    assert render(parsed, parsed.tree) == text
    for comment in parsed.comments:
        assert text[slice(*comment.span)] == comment.text
    for problem in parsed.problems:
        assert 0 <= problem.span[0] <= problem.span[1] <= len(text)
        line, column = parsed.place(problem.span[0])
        assert line >= 1
        assert column >= 1
        assert problem.message
    for node in walk(parsed.tree):
        assert node.span is not None, node
        assert 0 <= node.span[0] <= node.span[1] <= len(text)
        _assert_says_what_stands_there(node, text[slice(*node.span)])
        _assert_children_in_order(node)
    if isinstance(parsed.tree, n.Statements | Declarations):
        _assert_all_covered(parsed)


def _assert_says_what_stands_there(node: n.Node, there: str) -> None:
    if isinstance(node, n.Name):
        closing = '"' if node.quoting in (Quoting.GLOBAL, Quoting.LOCAL_QUOTED) else ""
        assert there == f"{node.quoting.value}{node.identifier}{closing}"
    elif isinstance(node, n.Literal | n.Address):
        assert there == node.text
    elif isinstance(node, n.Unreadable):
        assert there == node.text or not node.text


def _assert_children_in_order(node: n.Node) -> None:
    # an argument's value is behind its name, and the condition of REPEAT behind its statements
    inside = sorted(child.span or (0, 0) for child in children(node))
    for span in inside:
        assert node.span is not None
        assert node.span[0] <= span[0] <= span[1] <= node.span[1], node
    for one, other in pairwise(inside):
        assert one[1] <= other[0], node


def _assert_all_covered(parsed: Parsed[Any]) -> None:
    """Whatever is outside of the statements or declarations is blank or a comment.

    Semicolons between declarations mean nothing and are in no node.
    """
    blank = "\ufeff;" if isinstance(parsed.tree, Declarations) else "\ufeff"
    covered = sorted([s.span or (0, 0) for s in children(parsed.tree)] + [c.span for c in parsed.comments])
    end = 0
    for span in [*covered, (len(parsed.text), len(parsed.text))]:
        outside = "".join(c for c in parsed.text[end : span[0]] if c not in blank).strip()
        assert not outside, f"{outside!r} is not in the tree"
        end = max(end, span[1])
