"""Parsing structured text: every text gets a tree, and what does not parse stays in it as it stands."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import dataclass, fields
from functools import cache, lru_cache
from importlib.resources import files
from threading import Lock
from typing import Any, Generic, TypeVar

from lark import Lark
from lark.lexer import Lexer

from plcopen_sfc.collector import collecting_rarely
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.problems import Lines, Problem
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.builder import Builder
from plcopen_sfc.languages.st.builder_declarations import DeclarationBuilder
from plcopen_sfc.languages.st.declaration_nodes import Declarations, tokenize_declarations
from plcopen_sfc.languages.st.lexer import Comment, Token, tokenize
from plcopen_sfc.languages.st.nodes import Node
from plcopen_sfc.languages.st.recovery import Reading

Tree_co = TypeVar("Tree_co", covariant=True)


@dataclass(frozen=True, slots=True)
class Parsed(Generic[Tree_co]):
    """A text and its tree.

    `problems` tell what does not parse, in the order of the text; what is there is `Unreadable` in the tree.
    """

    text: str
    dialect: Dialect
    tree: Tree_co
    comments: tuple[Comment, ...] = ()
    problems: tuple[Problem, ...] = ()

    def place(self, offset: int) -> tuple[int, int]:
        """The line and column of an offset, from 1."""
        return Lines(self.text).place(offset)


def parse_statements(text: str, dialect: Dialect = Dialect.IEC) -> Parsed[n.Statements]:
    """The statements of a body. Never raises: see `Parsed.problems`."""
    return _parse(text, Dialect(dialect), "statements")


def parse_expression(text: str, dialect: Dialect = Dialect.IEC) -> Parsed[n.Expression]:
    """An expression. Never raises: see `Parsed.problems`."""
    return _parse(text, Dialect(dialect), "whole_expression")


def parse_condition(text: str, dialect: Dialect = Dialect.IEC) -> Parsed[n.Expression]:
    """The condition of a transition: an expression, and what people write around it, ``:=`` before and ``;`` behind.

    IEC 61131-3 has both in the textual form of a transition; CODESYS and TwinCAT take the semicolon. Never raises.
    """
    return _parse(text, Dialect(dialect), "condition")


def parse_declarations(text: str, dialect: Dialect = Dialect.IEC) -> Parsed[Declarations]:
    """Heads of POUs, variable sections and types. Bodies must not be in it. Never raises: see `Parsed.problems`."""
    return _parse(text, Dialect(dialect), "declarations")


def _parse(text: str, dialect: Dialect, start: str) -> Parsed[Any]:
    # conditions and short actions repeat a lot in real charts; trees cannot be changed, so equal texts share one
    return (_cached_parse if len(text) <= _CACHED else _fresh_parse)(text, dialect, start)


_CACHED = 1000
_LONG = 100_000


@lru_cache(maxsize=16384)
def _cached_parse(text: str, dialect: Dialect, start: str) -> Parsed[Any]:
    return _fresh_parse(text, dialect, start)


def _fresh_parse(text: str, dialect: Dialect, start: str) -> Parsed[Any]:
    # turning the collector on again makes it look through everything once, which is dear for a short text
    with collecting_rarely() if len(text) > _LONG else nullcontext():
        declares = start == "declarations"
        found = tokenize_declarations(text, dialect) if declares else tokenize(text, dialect, embedded_code=True)
        with _LOCK:
            lark, builder = _parser_for(dialect is Dialect.SCL, declares)
            tree = Reading(lark, builder, start, text, found).run()
            problems = sorted(found.problems + builder.problems, key=lambda problem: problem.span)
        problem = too_deep(tree) if tree is not None and may_be_deep(found.tokens) else None
    if problem is not None:
        problems = [problem]
    if tree is None or problem is not None:
        tree = n.Unreadable(text, span=(0, len(text)))
        if start not in ("whole_expression", "condition"):
            tree = Declarations((tree,), span=tree.span) if declares else n.Statements((tree,), span=tree.span)
    return Parsed(text, dialect, tree, tuple(found.comments), tuple(problems))


_LOCK = Lock()
"""One parse at a time: the builder collects the problems of the text that is being parsed."""


class _GivenTokens(Lexer):
    """Stands where lark wants a lexer; the tokens are fed one by one."""

    def __init__(self, *_: Any) -> None:
        pass

    def lex(self, *_: Any) -> Any:
        raise NotImplementedError


@cache
def _parser_for(scl: bool, declares: bool) -> tuple[Lark, Builder]:
    builder = (DeclarationBuilder if declares else Builder)(signs_below_power=scl)
    names = ["st.lark", "declarations.lark"] if declares else ["st.lark"]
    lark = Lark(
        "\n".join(files(__package__).joinpath(name).read_text("utf-8") for name in names),
        parser="lalr",
        lexer=_GivenTokens,
        start=["declarations"] if declares else ["statements", "whole_expression", "condition"],
        keep_all_tokens=True,
        maybe_placeholders=False,
        transformer=builder,
    )
    return lark, builder


MAX_DEPTH = 150
"""How many nodes may stand inside each other. The deepest body of the corpus has fewer than 30."""


def may_be_deep(tokens: list[Token]) -> bool:
    """True if a tree of `tokens` could be too deep: a level takes at least one token, a block makes up to three."""
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
