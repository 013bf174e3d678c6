"""Finds the units of a source text: POUs, types, data blocks; and in each where its declarations end.

Bodies are not parsed here: a chart in textual form has words of its own.
"""

from __future__ import annotations

from dataclasses import dataclass

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.problems import Lines, Problem
from plcopen_sfc.languages.st.lexer import Comment, Token, tokenize
from plcopen_sfc.languages.st.nodes import Span

_WITH_BODY = frozenset("PROGRAM FUNCTION_BLOCK FUNCTION CLASS ORGANIZATION_BLOCK DATA_BLOCK METHOD ACTION".split())
_DECLARATIONS = frozenset("TYPE INTERFACE CONFIGURATION".split())
_UNITS = _WITH_BODY | _DECLARATIONS
_POUS = frozenset("PROGRAM FUNCTION_BLOCK FUNCTION CLASS ORGANIZATION_BLOCK DATA_BLOCK".split())
"""Units that stand in no other."""
_SECTIONS = frozenset(
    """VAR VAR_INPUT VAR_OUTPUT VAR_IN_OUT VAR_TEMP VAR_EXTERNAL VAR_GLOBAL VAR_STAT VAR_INST VAR_ACCESS
    VAR_CONFIG VAR_GENERIC""".split()
)
_WORDS = _UNITS | _SECTIONS | {f"END_{word}" for word in _UNITS} | {"END_VAR"}
_SCL_WORDS = _WORDS | {"BEGIN", "STRUCT", "END_STRUCT", "TITLE"}


@dataclass(frozen=True, slots=True)
class DeclaredUnit:
    """A unit of a source text. All places are offsets into it.

    `head` is what declares: from the keyword up to the body; of what has no body (types) all of it. `body` is what
    stands between it and the end; `end` is the place of ``END_FUNCTION_BLOCK``, None if it is missing. Lists of global
    variables are units with the keyword ``VAR_GLOBAL``.
    """

    keyword: str
    span: Span
    head: Span
    body: Span | None
    end: Span | None


@dataclass(frozen=True, slots=True)
class Units:
    """The units of a text; `comments` are all of its comments, `problems` what is outside of any unit."""

    units: tuple[DeclaredUnit, ...]
    comments: tuple[Comment, ...]
    problems: tuple[Problem, ...]


def split_units(text: str, dialect: Dialect = Dialect.IEC) -> Units:
    """The units of `text`, in their order."""
    found = tokenize(text, dialect, _SCL_WORDS if dialect is Dialect.SCL else _WORDS)
    tokens = found.tokens
    units: list[DeclaredUnit] = []
    problems: list[Problem] = []
    lines = Lines(text)
    position = 0
    while position < len(tokens):
        kind = tokens[position].type
        if kind in _UNITS:
            unit, position = _unit(text, tokens, position, dialect)
            if unit.end is None:
                line, _ = lines.place(unit.span[0])
                message = f"END_{unit.keyword} is missing for the {unit.keyword} in line {line}"
                problems.append(Problem(message, (unit.span[1], unit.span[1])))
            units.append(unit)
        elif kind in _SECTIONS:
            end = _end_of_section(tokens, position)
            span = (tokens[position].span[0], tokens[end - 1].span[1])
            units.append(DeclaredUnit(kind, span, span, None, None))
            position = end
        else:
            position = _stray(tokens, position, problems)
    return Units(tuple(units), tuple(found.comments), tuple(problems))


def _unit(text: str, tokens: list[Token], first: int, dialect: Dialect) -> tuple[DeclaredUnit, int]:
    keyword = tokens[first].type
    closing = f"END_{keyword}"
    stop_at = _POUS if keyword in _WITH_BODY else frozenset()
    index = first + 1
    while index < len(tokens) and tokens[index].type != closing:
        if tokens[index].type in stop_at and _begins_a_line(text, tokens, index):
            break
        index += 1
    last = index if index < len(tokens) and tokens[index].type == closing else None
    behind = last if last is not None else min(index, _next_unit(tokens, first + 1))
    start = tokens[first].span[0]
    end = tokens[last].span if last is not None else None
    stop = end[0] if end is not None else tokens[behind - 1].span[1]
    span = (start, end[1] if end is not None else stop)
    after = last + 1 if last is not None else behind
    if keyword in _DECLARATIONS:
        return DeclaredUnit(keyword, span, span, None, end), after
    head_end, split = _end_of_head(text, tokens, first, behind, dialect)
    return DeclaredUnit(keyword, span, (start, head_end), (split, stop), end), after


def _begins_a_line(text: str, tokens: list[Token], index: int) -> bool:
    between = text[tokens[index - 1].span[1] : tokens[index].span[0]]
    return "\n" in between or "\r" in between


def _next_unit(tokens: list[Token], position: int) -> int:
    """Where the next unit starts, for one whose end is missing."""
    depth = 0
    for index in range(position, len(tokens)):
        kind = tokens[index].type
        depth += (kind in _SECTIONS) - (kind == "END_VAR")
        if depth <= 0 and kind in _UNITS:
            return index
    return len(tokens)


def _end_of_head(text: str, tokens: list[Token], first: int, behind: int, dialect: Dialect) -> Span:
    """Where the head ends and the body starts: at BEGIN, else behind the last section, else behind the first line."""
    end = -1
    index = first + 1
    while index < behind:
        kind = tokens[index].type
        if kind == "BEGIN" and dialect is Dialect.SCL:
            return tokens[index].span
        if kind in _SECTIONS:
            index = _end_of_section(tokens, index)
            end = tokens[index - 1].span[1]
            continue
        if kind == "STRUCT" and dialect is Dialect.SCL:
            index = _end_of_struct(tokens, index)
            end = tokens[index - 1].span[1]
            continue
        if end >= 0 and dialect is not Dialect.SCL:
            break
        index += 1
    if end < 0:
        end = _end_of_line(text, tokens, first, behind)
    return end, end


def _end_of_section(tokens: list[Token], position: int) -> int:
    for index in range(position + 1, len(tokens)):
        if tokens[index].type == "END_VAR":
            return index + 1
    return len(tokens)


def _end_of_struct(tokens: list[Token], position: int) -> int:
    depth = 0
    for index in range(position, len(tokens)):
        depth += (tokens[index].type == "STRUCT") - (tokens[index].type == "END_STRUCT")
        if depth == 0:
            semicolon = index + 1 < len(tokens) and tokens[index + 1].type == "SEMICOLON"
            return index + (2 if semicolon else 1)
    return len(tokens)


def _end_of_line(text: str, tokens: list[Token], first: int, behind: int) -> int:
    """The end of the last token on the line of the name."""
    if first + 1 >= behind:
        return tokens[first].span[1]
    index = first + 1
    while index + 1 < behind:
        if _begins_a_line(text, tokens, index + 1):
            break
        index += 1
    return tokens[index].span[1]


def _stray(tokens: list[Token], position: int, problems: list[Problem]) -> int:
    """Skip what is outside of units."""
    end = position
    while end < len(tokens) and tokens[end].type not in _UNITS | _SECTIONS:
        end += 1
    if any(token.type != "SEMICOLON" for token in tokens[position:end]):
        span = (tokens[position].span[0], tokens[end - 1].span[1])
        problems.append(Problem("a POU, a type or a list of variables is expected here", span))
    return end
