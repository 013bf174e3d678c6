"""How deep a tree is. Trees are walked by recursion, so what is nested without measure is not let in."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from plcopen_sfc.languages.problems import Problem
from plcopen_sfc.languages.st.lexer import Token
from plcopen_sfc.languages.st.nodes import Node

MAX_DEPTH = 150
"""How many nodes may stand inside each other. The deepest body of the corpus has fewer than 30."""


def may_be_deep(tokens: list[Token]) -> bool:
    """Whether a tree of `tokens` could be too deep: a level takes at least one token, a block makes up to three."""
    blocks = run = longest = deepest = 0
    for token in tokens:
        kind = token.type
        if kind == "SEMICOLON":
            longest = max(longest, run)
            run = 0
        elif kind in _BLOCKS:
            blocks += _BLOCKS[kind]
            deepest = max(deepest, blocks)
            longest = max(longest, run)
            run = 0
        else:
            run += 1
    return max(longest, run) + 3 * deepest + 2 > MAX_DEPTH


_BLOCKS = {"IF": 1, "CASE": 1, "FOR": 1, "WHILE": 1, "REPEAT": 1, "REGION": 1, "TRY": 1} | {
    "END_IF": -1,
    "END_CASE": -1,
    "END_FOR": -1,
    "END_WHILE": -1,
    "END_REPEAT": -1,
    "END_REGION": -1,
    "ENDTRY": -1,
}


def too_deep(tree: Node) -> Problem | None:
    """The problem that nodes of `tree` are nested too deeply, at the first that is."""
    waiting: list[tuple[Any, int]] = [(tree, 1)]
    while waiting:
        item, level = waiting.pop()
        if isinstance(item, Node):
            if level > MAX_DEPTH:
                return Problem(f"this is nested in more than {MAX_DEPTH} levels", item.span or (0, 0))
            waiting += [(getattr(item, f.name), level + 1) for f in fields(item) if f.name != "span"]
        elif isinstance(item, tuple):
            waiting += [(member, level) for member in item]
    return None
