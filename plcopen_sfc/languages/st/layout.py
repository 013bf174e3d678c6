"""Layout of structured text: keywords in capitals, blanks between words, lines indented by their blocks.

Comments, line breaks and names stay as they are written, and so does what a text means: its tokens are the same.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.lexer import Comment, Token, tokenize
from plcopen_sfc.languages.st.parsing import parse_condition, parse_statements
from plcopen_sfc.languages.st.printing import INDENT
from plcopen_sfc.languages.st.walking import walk
from plcopen_sfc.languages.text_edits import Edit, apply_edits
from plcopen_sfc.model.dialect import Dialect

_OPENING = {"IF": 1, "CASE": 2, "FOR": 1, "WHILE": 1, "REPEAT": 1, "REGION": 1}
"""Levels that the lines in a block are deeper: those of a CASE are below its labels."""
_CLOSING = frozenset(f"END_{word}" for word in _OPENING)
_BETWEEN = frozenset({"ELSE", "ELSIF", "UNTIL"})
_OPERAND_ENDS = frozenset({"NAME", "LITERAL", "RPAR", "RSQB", "CARET", "ADDRESS"})
_CALLED_ENDS = frozenset({"NAME", "RSQB", "CARET"})
_AS_WRITTEN = frozenset({"NAME", "ADDRESS", "BAD"})
_CLOSE_BEFORE = frozenset({"SEMICOLON", "COMMA", "RPAR", "RSQB", "DOT", "CARET", "RANGE", "COLON"})
_CLOSE_BEHIND = frozenset({"LPAR", "LSQB", "DOT", "RANGE"})


class _Places(NamedTuple):
    """Places at which statements and labels of a CASE begin, and labels."""

    beginnings: frozenset[int]
    labels: frozenset[int]


def layout_edits(text: str, dialect: Dialect, *, is_condition: bool = False) -> list[Edit]:
    """Return the edits that lay a text of statements, or a condition, out; none where it cannot be read."""
    parsed = parse_condition(text, dialect) if is_condition else parse_statements(text, dialect)
    if parsed.problems:
        return []
    found = tokenize(text, dialect)
    parts: list[Token | Comment] = sorted([*found.tokens, *found.comments], key=lambda part: part.span)
    places = _places(parsed.tree)
    edits = [Edit(*part.span, part.value.upper()) for part in found.tokens if _is_word(part)]
    levels: list[int] = []
    unary: set[int] = set()
    last: Token | None = None
    for place, part in enumerate(parts):
        start = parts[place - 1].span[1] if place else 0
        gap = text[start : part.span[0]]
        kind = part.type if isinstance(part, Token) else ""
        if kind in _CLOSING and levels:
            levels.pop()
        if "\n" in gap or "\r" in gap or not place:
            is_outer = kind in _BETWEEN or _following(parts, place).span[0] in places.labels
            goes_on = bool(kind) and kind not in _CLOSING | _BETWEEN and part.span[0] not in places.beginnings
            level = max(sum(levels) - is_outer, 0) + (goes_on and place > 0)
            wanted = _breaks(gap) + INDENT * level
        else:
            wanted = _blank(parts[place - 1], part, unary)
        if wanted != gap:
            edits.append(Edit(start, part.span[0], wanted))
        if kind in _OPENING:
            levels.append(_OPENING[kind])
        if kind == "SIGN" and (last is None or last.type not in _OPERAND_ENDS):
            unary.add(part.span[0])
        last = part if isinstance(part, Token) else last
    edits += [Edit(parts[-1].span[1], len(text), _breaks(text[parts[-1].span[1] :]))] if parts else []
    edits = sorted(edit for edit in edits if text[edit.start : edit.end] != edit.text)
    return edits if _same_tokens(text, apply_edits(text, edits), dialect) else []


def _is_word(part: Token) -> bool:
    """True for keywords, operators that are words, TRUE and FALSE."""
    return part.type not in _AS_WRITTEN and part.value.isidentifier()


def _places(tree: n.Node) -> _Places:
    """Return where statements begin, and labels."""
    starts: set[int] = set()
    labels: set[int] = set()
    for node in walk(tree):
        for name in ("statements", "otherwise"):
            starts.update(each.span[0] for each in getattr(node, name, None) or () if each.span is not None)
        if isinstance(node, n.CaseBranch) and node.labels[0].span is not None:
            labels.add(node.labels[0].span[0])
    return _Places(frozenset(starts | labels), frozenset(labels))


def _following(parts: list[Token | Comment], place: int) -> Token | Comment:
    """Return the token that the comments at a place are before."""
    return next((part for part in parts[place:] if isinstance(part, Token)), parts[place])


def _breaks(gap: str) -> str:
    """Return the line ends in a gap."""
    return "".join(re.findall(r"\r\n|\r|\n", gap))


def _blank(left: Token | Comment, right: Token | Comment, unary: set[int]) -> str:
    """Return what is between two parts of a line."""
    if isinstance(left, Comment) or isinstance(right, Comment):
        return " "
    if left.span[0] in unary:
        return " " if right.type == "SIGN" else ""  # two signs together look like another operator
    if right.type in _CLOSE_BEFORE or left.type in _CLOSE_BEHIND:
        return ""
    if right.type == "LSQB":
        return "" if left.type in _OPERAND_ENDS else " "
    if right.type == "LPAR":
        return "" if left.type in _CALLED_ENDS else " "
    return " "


def _same_tokens(before: str, after: str, dialect: Dialect) -> bool:
    """True if two texts have the same tokens and comments, whatever the case of keywords."""
    one, other = tokenize(before, dialect), tokenize(after, dialect)
    words = [[(t.type, t.value.upper() if _is_word(t) else t.value) for t in each.tokens] for each in (one, other)]
    return words[0] == words[1] and [c.text for c in one.comments] == [c.text for c in other.comments]
