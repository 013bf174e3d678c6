"""Parsing structured text: every text gets a tree; a part that does not parse stays in it as text.

After an error the parser is taken back to the statements that were being read, what cannot be read up to the next
semicolon becomes one `Unreadable` statement, and reading goes on behind it. A missing semicolon is put in.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager, nullcontext
from contextvars import ContextVar
from dataclasses import dataclass
from functools import cache, lru_cache
from importlib.resources import files
from threading import Lock
from typing import Any, Generic, TypeVar

from lark import Lark
from lark.lexer import Lexer
from lark.parsers.lalr_analysis import Shift

from plcopen_sfc.collector import collecting_rarely
from plcopen_sfc.languages.problems import Lines, Problem
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.declaration_nodes import Declarations, tokenize_declarations
from plcopen_sfc.languages.st.lexer import MAX_PROBLEMS, Comment, Token, Tokens, tokenize
from plcopen_sfc.languages.st.nodes import Node, Unreadable
from plcopen_sfc.languages.st.tree_building import Builder, DeclarationBuilder, StatementList
from plcopen_sfc.languages.st.walking import children
from plcopen_sfc.model.dialect import Dialect

_CLOSED_BY = {
    "IF": "END_IF",
    "CASE": "END_CASE",
    "FOR": "END_FOR",
    "WHILE": "END_WHILE",
    "REPEAT": "END_REPEAT",
    "REGION": "END_REGION",
    "TRY": "ENDTRY",
    "VAR": "END_VAR",
    "VAR_ACCESS": "END_VAR",
    "VAR_CONFIG": "END_VAR",
    "TYPE": "END_TYPE",
    "STRUCT": "END_STRUCT",
    "UNION": "END_UNION",
}
_CLOSING = frozenset(_CLOSED_BY.values())
_DIVIDING = frozenset({"ELSE", "ELSIF", "UNTIL", "CATCH", "FINALLY"})
_STARTS = frozenset({"IF", "POU", "END_VAR", "END_TYPE", "END_STRUCT", "END_UNION"})
"""Where one of these is accepted, a statement or a declaration may start."""
_END = "$END"
_HEADS = frozenset({"POU", "END_POU"})
_BEHIND_SECTIONS = _HEADS | {"VAR", "VAR_ACCESS", "VAR_CONFIG", "TYPE", _END}
_INSIDE_DECLARATIONS = frozenset({"STRUCT", "UNION"})


@dataclass(frozen=True, slots=True)
class _Grammar:
    """The tables that lark makes of a grammar, for `Reading`.

    `actions` has for each state what a kind of token does there: a number is the state behind it, else a rule is
    complete: how many values it has, the function that makes one of them, and its name, by which `actions` has the
    state behind it. `first` and `last` are the states at both ends of a text, by the rule for all of it.
    """

    actions: dict[int, dict[str, Any]]
    first: dict[str, int]
    last: dict[str, int]
    builder: Builder


class Reading:
    """One run of the parser over `found`, from the rule `start`."""

    def __init__(self, grammar: _Grammar, start: str, text: str, found: Tokens) -> None:
        self._actions = grammar.actions
        self._values: list[Any] = []
        self._states, self._last_state = [grammar.first[start]], grammar.last[start]
        self._builder = builder = grammar.builder
        self._is_list = start in ("statements", "declarations")
        self._text = text
        self._tokens = [*found.tokens, Token(_END, "", (len(text), len(text)))]
        builder.problems = []

    def run(self) -> Any:
        """Return the node of the rule; None if an error leaves nothing of it."""
        tokens = self._tokens
        feed = self._feed
        if self._is_list:
            self._feed_semicolon(0)
        position, last = 0, len(tokens) - 1
        while True:
            while position < last and feed(tokens[position]):
                position += 1
            # after an error nothing may be left to reduce, and the end is found by a reduction
            if position == last and ((self._is_list and len(self._values) == 1) or feed(tokens[last])):
                result = self._values[0]
                return self._builder.whole(result, len(self._text)) if self._is_list else result
            if not self._is_list:
                self._tell(position)
                return None
            position = self._recover(position)

    def _feed(self, token: Token) -> bool:
        """Reduce what is complete before `token`, and take it in; False where the grammar has no such token there."""
        # what lark's own parser does, which looks for the function of each rule by all symbols of that
        actions, states, values, kind = self._actions, self._states, self._values, token.type
        while (action := actions[states[-1]].get(kind)) is not None:
            if action.__class__ is int:
                states.append(action)
                values.append(token)
                return True
            size, make, name = action
            first = len(values) - size
            items = values[first:]
            del values[first:], states[first + 1 :]
            states.append(actions[states[-1]][name])
            values.append(make(items))
            if kind == _END and states[-1] == self._last_state:
                return True
        return False

    def _feed_semicolon(self, offset: int) -> None:
        """Feed a semicolon that is not in the text; an empty statement that it makes is left out."""
        self._feed(Token("SEMICOLON", ";", (offset, offset)))

    def _tell(self, position: int) -> None:
        token = self._tokens[position]
        if token.type == "BAD":  # the lexer has told why
            return
        accepted = self._accepted()
        message = expectation(token, accepted)
        opening = self._opening()
        closing = {"UNTIL", _CLOSED_BY[opening.type]} if opening is not None else set()
        if opening is not None and closing & accepted and token.type in _BEHIND_SECTIONS | _CLOSING:
            line, _ = Lines(self._text).place(opening.span[0])
            message += f" for the {opening.value.split()[0].upper()} in line {line}"
        self._builder.problems.append(Problem(message, token.span))

    def _accepted(self) -> set[str]:
        """Return the types of the tokens that could come next."""
        return {kind for kind in self._actions[self._states[-1]] if kind.isupper() and self._is_accepted(kind)}

    def _is_accepted(self, kind: str) -> bool:
        states = [*self._states]
        while (action := self._actions[states[-1]].get(kind)) is not None:
            if isinstance(action, int):
                return True
            size, _, name = action
            del states[len(states) - size :]
            states.append(self._actions[states[-1]][name])
            if kind == _END and states[-1] == self._last_state:
                return True
        return False

    def _opening(self) -> Token | None:
        """Return the keyword of the innermost block that is open."""
        return next((v for v in reversed(self._values) if isinstance(v, Token) and v.type in _CLOSED_BY), None)

    def _opening_type(self) -> str | None:
        opening = self._opening()
        return opening.type if opening is not None else None

    def _unfinished_head(self) -> Token | None:
        """Return the keyword of the innermost block if its statements have not begun: ``IF a``."""
        for value in reversed(self._values):
            if isinstance(value, StatementList):
                break
            if isinstance(value, Token) and value.type in _CLOSED_BY:
                return value
        return None

    def _recover(self, position: int) -> int:
        """Make the parser ready to go on; the index of the token to go on with."""
        token = self._tokens[position]
        if not (token.type == "END_REPEAT" and self._behind_unreadable()):  # its condition is what could not be read
            self._tell(position)
        if len(self._builder.problems) >= MAX_PROBLEMS:
            return self._give_up(position)
        if self._semicolon_is_missing(position):
            self._feed_semicolon(self._tokens[position - 1].span[1])
            return position
        if token.type in _BEHIND_SECTIONS and "END_VAR" in self._accepted():
            end = self._tokens[position - 1].span[1]
            self._feed(Token("END_VAR", "", (end, end)))
            return position
        if token.type == _END:
            return self._give_up(position)
        if token.type in _CLOSING and self._close_outer_block(token) and token.type in self._accepted():
            return position
        if token.type == "END_REPEAT" and self._opening_type() == "REPEAT":
            return self._drop_block(position)
        if self._accepted() & _STARTS:  # an empty list is made only when something follows that fits
            self._feed_semicolon(token.span[0])
        start, opened = self._unwind(token.span[0])
        position = self._skip(position, opened)
        end = max(self._tokens[position - 1].span[1], start)
        self._keep(start, end)
        return position

    def _give_up(self, position: int) -> int:
        """Keep everything from the outermost unfinished statement on as text."""
        start, _ = self._unwind(self._tokens[position].span[0], outermost=True)
        self._keep(start, len(self._text))
        return len(self._tokens) - 1

    def _semicolon_is_missing(self, position: int) -> bool:
        token = self._tokens[position]
        accepted = self._accepted()
        if "SEMICOLON" not in accepted or accepted & _STARTS:  # where a statement may start, none is unfinished
            return False
        if token.type == _END or token.type in _CLOSED_BY or token.type in _CLOSING or token.type in _DIVIDING:
            return True
        between = self._text[self._tokens[position - 1].span[1] : token.span[0]]
        return token.type != "BAD" and ("\n" in between or "\r" in between)

    def _close_outer_block(self, token: Token) -> bool:
        """If `token` closes a block around the innermost one, go back to the statements of that block."""
        openings = [v for v in self._values if isinstance(v, Token) and _CLOSED_BY.get(v.type) == token.type]
        if not openings or self._unfinished_head() is openings[-1]:
            return False
        start = token.span[0]
        while self._opening() is not openings[-1] or not isinstance(self._values[-1], StatementList):
            start = self._pop(start)
        self._keep(start, token.span[0])
        return True

    def _drop_block(self, position: int) -> int:
        """Keep as text the innermost block, which ends at `position` but lacks a part (REPEAT without UNTIL)."""
        opening, start = self._opening(), self._tokens[position].span[0]
        while self._opening() is opening or not isinstance(self._values[-1], StatementList):
            start = self._pop(start)
        position += 2 if self._tokens[position + 1].type == "SEMICOLON" else 1
        self._keep(start, self._tokens[position - 1].span[1])
        return position

    def _behind_unreadable(self) -> bool:
        statements = self._values[-1]
        return isinstance(statements, StatementList) and bool(statements) and isinstance(statements[-1], Unreadable)

    def _unwind(self, start: int, *, outermost: bool = False) -> tuple[int, int]:
        """Take the parser back to the statements it was reading: where what it forgot starts, and its open blocks."""
        opened = 0
        while len(self._values) > 1 and (outermost or not isinstance(self._values[-1], StatementList)):
            value = self._values[-1]
            opened += isinstance(value, Token) and value.type in _CLOSED_BY
            start = self._pop(start)
        return start, opened

    def _pop(self, start: int) -> int:
        self._states.pop()
        value = self._values.pop()
        while isinstance(value, list):
            if not value:
                return start
            value = value[0]
        span = value.span if value is not None else None  # an optional part that is not there
        return min(start, span[0]) if span is not None else start

    def _skip(self, position: int, opened: int) -> int:
        """Return the token behind a statement that cannot be read and that has opened so many blocks."""
        depth, first = opened, position
        closing = {_CLOSED_BY[v.type] for v in self._values if isinstance(v, Token) and v.type in _CLOSED_BY}
        for index in range(position, len(self._tokens)):
            kind = self._tokens[index].type
            if kind == _END or (kind in _HEADS and index > first):
                return index
            if kind in _CLOSED_BY:
                if depth == 0 and index > first and kind not in _INSIDE_DECLARATIONS:
                    return index
                depth += 1
            elif kind in _CLOSING:
                if depth == 0:
                    if index > first and kind in closing:
                        return index
                    continue
                depth -= 1
                if depth == 0:
                    return index + (2 if self._tokens[index + 1].type == "SEMICOLON" else 1)
            elif depth == 0 and (kind == "SEMICOLON" or (kind in _DIVIDING and closing and index > first)):
                return index + (kind == "SEMICOLON")
        return len(self._tokens) - 1

    def _keep(self, start: int, end: int) -> None:
        statements: StatementList = self._values[-1]
        if statements and statements[-1].span[0] >= start:
            start = statements[-1].span[1]
        statements.append(Unreadable(self._text[start:end], span=(start, end)))


_SHOWN = {
    "SEMICOLON": "';'",
    "COLON": "':'",
    "COMMA": "','",
    "DOT": "'.'",
    "RANGE": "'..'",
    "LPAR": "'('",
    "RPAR": "')'",
    "LSQB": "'['",
    "RSQB": "']'",
    "ASSIGN": "':='",
    "ARROW": "'=>'",
    _END: "the end of the text",
    "TRY": "__TRY",
    "CATCH": "__CATCH",
    "FINALLY": "__FINALLY",
    "ENDTRY": "__ENDTRY",
    "POU": "the head of a POU",
    "END_POU": "the end of a POU",
    "QUALIFIER": "CONSTANT or the like",
    "DIRECTION": "READ_ONLY or READ_WRITE",
    "EDGE": "R_EDGE or F_EDGE",
    "POINTER": "POINTER TO or REFERENCE TO",
}
_CONTINUATIONS = frozenset(
    {"OPERATOR", "SIGN", "DOT", "LSQB", "CARET", "PERIPHERAL", "COMPOUND_ASSIGN", "LPAR", "ARROW", "RANGE", "COLON"}
)
_STATEMENT_STARTS = frozenset({"IF", "CASE", "FOR", "WHILE", "REPEAT", "EXIT", "CONTINUE", "RETURN"})
_EXPRESSION_STARTS = frozenset({"NAME", "LITERAL", "ADDRESS", "NOT", "LPAR", "SIGN", "OPERATOR"})  # AND(a, b)
_SHOWN_TEXT = 30


def expectation(found: Token, accepted: Iterable[str]) -> str:
    """``found 'THEN', expected ';' or an operator``, of the terminals that the grammar accepts there."""
    left = set(accepted)
    words: list[str] = []
    if left >= _STATEMENT_STARTS:
        words.append("a statement")
        left -= _STATEMENT_STARTS | _EXPRESSION_STARTS | {"SEMICOLON", "GOTO", "JMP", "REGION", "TRY", "CODE"}
    elif left >= _EXPRESSION_STARTS:
        words.append("an expression")
        left -= _EXPRESSION_STARTS
    elif "NAME" in left:
        words.append("a name")
        left.discard("NAME")
    if "OPERATOR" in left:
        words.append("an operator")
        left -= _CONTINUATIONS
    words[:0] = sorted(_SHOWN.get(terminal, terminal) for terminal in left)
    expected = f"{', '.join(words[:-1])} or {words[-1]}" if len(words) > 1 else "".join(words)
    shown = found.value if len(found.value) <= _SHOWN_TEXT else found.value[:_SHOWN_TEXT] + ".."
    what = "the end of the text" if found.type == _END else f"'{shown}'"
    if expected.endswith("a name") and found.type != "NAME" and found.value.isidentifier():
        what = f"the keyword {what}"  # whoever declares it takes it for a name
    return f"found {what}, expected {expected}" if expected else f"{what} cannot stand here"


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
        """Return the line and column of an offset, from 1."""
        return Lines(self.text).place(offset)


def parse_statements(text: str, dialect: Dialect = Dialect.IEC) -> Parsed[n.Statements]:
    """Return the statements of a body. Never raises: see `Parsed.problems`."""
    return _parse(text, Dialect(dialect), "statements")


@lru_cache(maxsize=4096)
def statement_problems(text: str, dialect: Dialect = Dialect.IEC) -> tuple[Problem, ...]:
    """Return the problems in the statements of a body, in the order of the text.

    Remembered, unlike the trees of long texts: to save an edit, a file is read again, and most of it is as it was.
    """
    return parse_statements(text, dialect).problems


def parse_expression(text: str, dialect: Dialect = Dialect.IEC) -> Parsed[n.Expression]:
    """Return an expression. Never raises: see `Parsed.problems`."""
    return _parse(text, Dialect(dialect), "whole_expression")


def parse_condition(text: str, dialect: Dialect = Dialect.IEC) -> Parsed[n.Expression]:
    """The condition of a transition: an expression, and what people write around it, ``:=`` before and ``;`` behind.

    IEC 61131-3 has both in the textual form of a transition; CODESYS and TwinCAT take the semicolon. Never raises.
    """
    return _parse(text, Dialect(dialect), "condition")


def bare_condition(text: str, dialect: Dialect = Dialect.IEC) -> str:
    """Return a condition without what `parse_condition` takes around it, ``:=`` and a semicolon. Comments stay."""
    _, end = parse_condition(text, dialect).tree.span or (0, 0)
    return (text[:end] + text[end:].replace(";", "", 1)).strip().removeprefix(":=").strip()


def parse_body(text: str, dialect: Dialect = Dialect.IEC) -> Parsed[Any]:
    """Return the statements of a body, or the condition alone that the body of a transition may be. Never raises."""
    statements = parse_statements(text, dialect)
    condition = parse_condition(text, dialect) if statements.problems else statements
    return statements if condition.problems else condition


def parse_declarations(text: str, dialect: Dialect = Dialect.IEC) -> Parsed[Declarations]:
    """Heads of POUs, variable sections and types. Bodies must not be in it. Never raises: see `Parsed.problems`."""
    return _parse(text, Dialect(dialect), "declarations")


def _parse(text: str, dialect: Dialect, start: str) -> Parsed[Any]:
    # conditions and short actions repeat a lot in real charts; trees cannot be changed, so equal texts share one
    if len(text) <= _CACHED:
        return _cached_parse(text, dialect, start)
    trees = _TREES.get()
    if trees is None:
        return _fresh_parse(text, dialect, start)
    found = trees.get((text, dialect, start))
    if found is None:
        found = _fresh_parse(text, dialect, start)
        if len(text) + sum(len(shared) for shared, _, _ in trees) <= _MOST_SHARED:
            trees[text, dialect, start] = found
    return found


_CACHED = 1000
_LONG = 100_000
_MOST_SHARED = 4_000_000
"""Characters of the texts whose trees an operation keeps: a tree takes about a hundred bytes for each."""

_TREES: ContextVar[dict[tuple[str, Dialect, str], Parsed[Any]] | None] = ContextVar("shared_trees", default=None)


@contextmanager
def sharing_trees() -> Iterator[None]:
    """Parse equal long texts once, as long as this is open: an operation looks at each body in several passes."""
    token = _TREES.set({} if (outer := _TREES.get()) is None else outer)
    try:
        yield
    finally:
        _TREES.reset(token)


@lru_cache(maxsize=16384)
def _cached_parse(text: str, dialect: Dialect, start: str) -> Parsed[Any]:
    return _fresh_parse(text, dialect, start)


def _fresh_parse(text: str, dialect: Dialect, start: str) -> Parsed[Any]:
    # turning the collector on again makes it look through everything once, which is dear for a short text
    with collecting_rarely() if len(text) > _LONG else nullcontext():
        declares = start == "declarations"
        found = tokenize_declarations(text, dialect) if declares else tokenize(text, dialect, embedded_code=True)
        with _LOCK:
            grammar = _grammar(dialect is Dialect.SCL, declares)
            tree = Reading(grammar, start, text, found).run()
            problems = sorted(found.problems + grammar.builder.problems, key=lambda problem: problem.span)
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
def _grammar(scl: bool, declares: bool) -> _Grammar:
    builder = (DeclarationBuilder if declares else Builder)(signs_below_power=scl)
    names = ["st.lark", "declarations.lark"] if declares else ["st.lark"]
    starts = ["declarations"] if declares else ["statements", "whole_expression", "condition"]
    lark = Lark(
        "\n".join(files(__package__).joinpath(name).read_text("utf-8") for name in names),
        parser="lalr",
        lexer=_GivenTokens,
        start=starts,
        keep_all_tokens=True,
        maybe_placeholders=False,
        transformer=builder,
    )
    tables = {start: lark.parse_interactive(start=start).parser_state.parse_conf for start in starts}
    table = tables[starts[0]]  # all have the same states
    actions = {
        state: {
            str(kind): arg if action is Shift else (len(arg.expansion), table.callbacks[arg], str(arg.origin.name))
            for kind, (action, arg) in choices.items()
        }
        for state, choices in table.states.items()
    }
    first = {start: each.start_state for start, each in tables.items()}
    return _Grammar(actions, first, {start: each.end_state for start, each in tables.items()}, builder)


MAX_DEPTH = 150
"""Number of nodes that may be nested. The deepest body of the corpus has fewer than 30."""


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
    """Return the problem that nodes of `tree` are nested too deeply, at the first that is."""
    waiting = [(tree, 1)]
    while waiting:
        node, level = waiting.pop()
        if level > MAX_DEPTH:
            return Problem(f"this is nested in more than {MAX_DEPTH} levels", node.span or (0, 0))
        waiting += [(inner, level + 1) for inner in children(node)]
    return None
