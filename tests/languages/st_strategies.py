"""Random programs in structured text, as trees, for every dialect; and layouts for them."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

from hypothesis import strategies as st

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.lexer import tokenize
from plcopen_sfc.languages.st.nodes import AssignmentKind, Operator, Quoting
from plcopen_sfc.model.dialect import Dialect

Draw = Callable[[st.SearchStrategy[Any]], Any]

CODESYS = frozenset({Dialect.CODESYS, Dialect.TWINCAT})
dialects = st.sampled_from(Dialect)

_LITERALS = """TRUE FALSE 0 1 42 1_000 16#FF 2#1010_1010 8#77 1.5 1.0E-3 2.5e+10 INT#5 UINT#16#FF REAL#1.0E5 BOOL#1
    WORD#16#00ff 'text' '' 'a$'b' '$N$0A' T#5s t#1h2m3s4ms TIME#1.5s LTIME#1us T#-5s D#2024-01-31 DATE#2024-01-31
    TOD#12:30:00.5 TIME_OF_DAY#12:30:00 DT#2024-01-31-12:30:00 DATE_AND_TIME#2024-01-31-12:30:00 Color#red""".split()
_DIALECT_LITERALS = {
    Dialect.IEC: ['"wide"', "STRING#'x'", "LDT#2024-01-31-12:30:00", "1e5"],
    Dialect.CODESYS: ['"wide"', "'with space'", "LTIME#1ns"],
    Dialect.TWINCAT: ['"wide"', "'with space'", "LTIME#1ns"],
    Dialect.SCL: ["W#16#FF", "B#16#0", "S5T#10s", "P#M10.0", "P#DB1.DBX0.0 BYTE 10", "DTL#2024-01-31-12:30:00", "L#5"],
}
_ADDRESSES = ["%IX0.0", "%QW4", "%MD12", "%M20.0", "%I0.0"]
_KINDS = {
    Dialect.IEC: [AssignmentKind.ASSIGN, AssignmentKind.ATTEMPT],
    Dialect.CODESYS: [AssignmentKind.ASSIGN, AssignmentKind.SET, AssignmentKind.RESET, AssignmentKind.REFERENCE],
    Dialect.TWINCAT: [AssignmentKind.ASSIGN, AssignmentKind.SET, AssignmentKind.RESET, AssignmentKind.REFERENCE],
    Dialect.SCL: [AssignmentKind.ASSIGN, AssignmentKind.ADD, AssignmentKind.MULTIPLY, AssignmentKind.DIVIDE],
}
_BINARY = [operator for operator in Operator if operator not in (Operator.NOT, Operator.NEGATE, Operator.PLUS)]
_ROWS = (Operator.AND, Operator.OR, Operator.XOR, Operator.ADD, Operator.MULTIPLY)
_SIGNS = (Operator.NOT, Operator.NEGATE, Operator.PLUS)


def _is_name(text: str) -> bool:
    return all(
        [token.type for token in tokenize(text, dialect).tokens] == ["NAME"] and not tokenize(text, dialect).problems
        for dialect in Dialect
    )


_words = st.sampled_from(
    "a b x Motor bStart Ventil_auf Größe _x S R REF Step1 T D N iZähler THIS SUPER PRIORITY ANDx IFF SET AT".split()
) | st.from_regex(r"[A-Za-zÄÖÜäöü_][A-Za-z0-9_ß]{0,7}", fullmatch=True).filter(_is_name)
_quoted = st.text(st.characters(exclude_categories=("Cs", "Cc", "Zl", "Zp"), exclude_characters='"'), min_size=1).map(
    lambda text: text[:12]
)


@cache
def names(dialect: Dialect) -> st.SearchStrategy[n.Name]:
    """Names of variables; quoted and with ``#`` too where the dialect has that."""
    plain = st.builds(n.Name, _words)
    if dialect is not Dialect.SCL:
        return plain
    return st.one_of(
        plain,
        st.builds(n.Name, _words, st.just(Quoting.LOCAL)),
        st.builds(n.Name, _quoted, st.sampled_from([Quoting.GLOBAL, Quoting.LOCAL_QUOTED])),
    )


@cache
def literals(dialect: Dialect) -> st.SearchStrategy[n.Literal]:
    """Literals of every type."""
    return st.sampled_from(_LITERALS + _DIALECT_LITERALS[dialect]).map(n.Literal)


@cache
def _members(dialect: Dialect) -> st.SearchStrategy[n.Name]:
    found = st.builds(n.Name, _words) | st.sampled_from(["0", "15"]).map(n.Name)
    if dialect is Dialect.SCL:
        found |= st.sampled_from(["%X0", "%B1"]).map(n.Name) | st.builds(n.Name, _quoted, st.just(Quoting.GLOBAL))
    return found


def variables(dialect: Dialect, inner: st.SearchStrategy[n.Expression]) -> st.SearchStrategy[n.Expression]:
    """Targets of assignments; `inner` is between brackets."""
    addresses = st.sampled_from(_ADDRESSES).map(n.Address)
    indices = st.lists(inner, min_size=1, max_size=2).map(tuple)

    def longer(base: st.SearchStrategy[n.Expression]) -> st.SearchStrategy[n.Expression]:
        found = st.builds(n.Member, base, _members(dialect)) | st.builds(n.Index, base, indices)
        return found if dialect is Dialect.SCL else found | st.builds(n.Dereference, base)

    paths = st.recursive(names(dialect), longer, max_leaves=3)
    found = paths | addresses
    return found | st.builds(n.Peripheral, found) if dialect is Dialect.SCL else found


def calls(dialect: Dialect, inner: st.SearchStrategy[n.Expression]) -> st.SearchStrategy[n.Call]:
    """Calls with arguments of every form; `inner` are their values."""
    places = variables(dialect, inner)
    plain = st.builds(n.Name, _words)
    values = inner | st.builds(n.AssignmentExpression, places, inner)
    positional = st.builds(n.Argument, inner)
    named = st.builds(n.Argument, values | st.none(), plain)
    outputs = st.builds(n.Argument, places | st.none(), plain, st.just(True))
    inverted = st.builds(n.Argument, places, plain, st.just(True), st.just(True))
    arguments = st.lists(positional, max_size=3) | st.lists(named | outputs | inverted, max_size=3)
    callee = names(dialect) | st.builds(n.Member, names(dialect), plain)
    return st.builds(n.Call, callee, arguments.map(tuple))


@cache
def expressions(dialect: Dialect) -> st.SearchStrategy[n.Expression]:
    """Any expression."""
    leaves = names(dialect) | literals(dialect) | st.sampled_from(_ADDRESSES).map(n.Address)

    def larger(inner: st.SearchStrategy[n.Expression]) -> st.SearchStrategy[n.Expression]:
        places = variables(dialect, inner)
        return st.one_of(
            st.builds(n.Operation, st.sampled_from(_BINARY), st.tuples(inner, inner)),
            st.builds(n.Operation, st.sampled_from(_ROWS), st.lists(inner, min_size=3, max_size=4).map(tuple)),
            st.builds(n.Unary, st.sampled_from(_SIGNS), inner),
            st.builds(n.Parenthesized, inner),
            st.builds(n.Parenthesized, st.builds(n.AssignmentExpression, places, inner)),
            places,
            calls(dialect, inner),
        )

    return st.recursive(leaves, larger, max_leaves=4)


@cache
def _simple_statements(dialect: Dialect) -> st.SearchStrategy[n.Statement]:
    values = expressions(dialect)
    places = variables(dialect, values)
    found: list[st.SearchStrategy[n.Statement]] = [
        st.builds(n.Assignment, places, values, st.sampled_from(_KINDS[dialect])),
        st.builds(n.Assignment, places, st.builds(n.AssignmentExpression, places, values)),
        st.builds(n.CallStatement, calls(dialect, values)),
        st.builds(n.Exit),
        st.builds(n.Continue),
        st.builds(n.ReturnStatement, st.none() | values),
        st.builds(n.Empty),
    ]
    if dialect in CODESYS:
        found.append(st.builds(n.CallStatement, names(dialect)))
        found.append(st.builds(n.Goto, st.builds(n.Name, _words), st.just("JMP")))
    if dialect is Dialect.SCL:
        found.append(st.builds(n.Goto, st.builds(n.Name, _words), st.just("GOTO")))
    return st.one_of(found)


def _block(found: list[n.Statement]) -> tuple[n.Statement, ...]:
    """`found` without semicolons that would be read as the end of a statement that can end without one."""
    return tuple(
        each
        for before, each in zip([None, *found], found, strict=False)
        if not (isinstance(each, n.Empty) and isinstance(before, n.RegionBlock | n.Try))
    )


_titles = (
    st.text(st.characters(exclude_categories=("Cs", "Cc", "Zl", "Zp")), max_size=8)
    .map(str.strip)
    .filter(lambda title: not title.startswith(":"))  # with a colon behind it, REGION is a name
)


def _compound(dialect: Dialect, inner: st.SearchStrategy[n.Statement]) -> st.SearchStrategy[n.Statement]:
    values = expressions(dialect)
    blocks = st.lists(inner, max_size=3).map(_block)
    labelled = blocks
    if dialect is not Dialect.IEC:  # in a CASE a name with a colon is a label of the CASE
        jumps = st.builds(n.LabelStatement, st.builds(n.Name, _words))
        labelled = st.lists(inner | jumps, max_size=3).map(_block)
    constants = literals(dialect) | names(dialect)
    labels = st.one_of(
        constants,
        st.builds(n.Unary, st.just(Operator.NEGATE), literals(dialect)),
        st.builds(n.Range, constants, constants),
        st.builds(n.Member, names(dialect), st.builds(n.Name, _words)),
    )
    cases = st.builds(n.CaseBranch, st.lists(labels, min_size=1, max_size=3).map(tuple), blocks)
    branches = st.lists(st.builds(n.Branch, values, labelled), min_size=1, max_size=3).map(tuple)
    found: list[st.SearchStrategy[n.Statement]] = [
        st.builds(n.If, branches, st.none() | labelled),
        st.builds(n.Case, values, st.lists(cases, max_size=3).map(tuple), st.none() | blocks),
        st.builds(n.For, variables(dialect, values), values, values, st.none() | values, labelled),
        st.builds(n.While, values, labelled),
        st.builds(n.Repeat, labelled, values),
    ]
    if dialect is Dialect.SCL:
        found.append(st.builds(n.RegionBlock, _titles, labelled))
    if dialect in CODESYS:
        handled = st.builds(n.Try, labelled, st.none() | names(dialect), labelled, st.none() | labelled)
        found.append(handled | st.builds(n.Try, labelled, st.none(), st.none(), st.none() | labelled))
    return st.one_of(found)


@cache
def statements(dialect: Dialect) -> st.SearchStrategy[n.Statements]:
    """Whole bodies."""
    tree = st.recursive(_simple_statements(dialect), lambda inner: _compound(dialect, inner), max_leaves=4)
    return st.lists(tree, max_size=4).map(lambda found: n.Statements(_block(found)))


# -- layouts ----------------------------------------------------------------------------------------------------------

_gaps = st.sampled_from(
    [
        *(" ", "  ", "\t", "\n", "\r\n", "\r", "\n\n    ", "\ufeff ", "\u00a0"),
        *(" (* x *) ", "(* a (* nested *) b *)", "(*\n*)", " (* 'open *) ", "(*) *)", "(**)", " /* C */ "),
        *(" // to the end\n", '//"\r\n', " {pragma := 'x'} "),
    ]
)


@st.composite
def laid_out(draw: Draw, text: str, dialect: Dialect) -> str:
    """`text` with other spaces and with comments wherever spaces stand between two tokens."""
    tokens = tokenize(text, dialect).tokens
    pieces: list[str] = [draw(_gaps | st.just(""))]
    starts = [token.span[0] for token in tokens[1:]]
    for token, following in zip(tokens, [*starts, len(text) + 1], strict=False):
        start, end = token.span
        pieces.append(text[start:end])
        gap = text[end:following] or following > len(text)
        if gap:
            new = draw(_gaps)
            # what is behind REGION in its line is its title; a slash before // would be part of the comment
            apart = {"REGION": "\n", "/": " "}.get(token.type if token.type == "REGION" else token.value, "")
            pieces.append(apart + new)
    return "".join(pieces)


@st.composite
def programs(draw: Draw) -> tuple[Dialect, n.Statements]:
    """A dialect and a body in it."""
    dialect: Dialect = draw(dialects)
    return dialect, draw(statements(dialect))
