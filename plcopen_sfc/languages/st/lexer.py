"""Tokens of structured text: names, literals, keywords and punctuation, with comments and pragmas set apart."""

from __future__ import annotations

import re
from dataclasses import dataclass
from enum import StrEnum
from functools import cache

from plcopen_sfc.languages.problems import Problem
from plcopen_sfc.languages.st.nodes import Span
from plcopen_sfc.model.dialect import Dialect


@dataclass(slots=True, eq=False)
class Token:
    """A token: its type in the grammar, its text and where it is."""

    type: str
    value: str
    span: Span


class CommentKind(StrEnum):
    """The kinds of text between tokens that mean something to a person or a tool."""

    LINE = "line"
    BLOCK = "block"
    PRAGMA = "pragma"


@dataclass(frozen=True, slots=True)
class Comment:
    """A comment or a pragma; `text` includes its delimiters."""

    kind: CommentKind
    text: str
    span: Span


@dataclass(frozen=True, slots=True)
class Tokens:
    """Tokens of a text."""

    tokens: list[Token]
    comments: list[Comment]
    problems: list[Problem]


MAX_PROBLEMS = 50
"""So many wrong tokens of one text are told, and so many wrong statements; the rest is kept unread."""

STATEMENT_KEYWORDS = frozenset(
    """IF THEN ELSIF ELSE END_IF CASE OF END_CASE FOR TO BY DO END_FOR WHILE END_WHILE REPEAT UNTIL END_REPEAT
    EXIT CONTINUE RETURN NOT""".split()
)
_DIALECT_KEYWORDS = {
    Dialect.IEC: frozenset(),
    Dialect.CODESYS: frozenset({"JMP", "__TRY", "__CATCH", "__FINALLY", "__ENDTRY"}),
    Dialect.TWINCAT: frozenset({"JMP", "__TRY", "__CATCH", "__FINALLY", "__ENDTRY"}),
    Dialect.SCL: frozenset({"GOTO", "REGION", "END_REGION"}),
}
_WORD_OPERATORS = frozenset({"AND", "OR", "XOR", "MOD", "AND_THEN", "OR_ELSE"})
_LITERAL_WORDS = frozenset({"TRUE", "FALSE", "NULL"})
_PUNCTUATION = {
    ":=": "ASSIGN",
    "=>": "ARROW",
    "..": "RANGE",
    ";": "SEMICOLON",
    ":": "COLON",
    ",": "COMMA",
    ".": "DOT",
    "(": "LPAR",
    ")": "RPAR",
    "[": "LSQB",
    "]": "RSQB",
    "^": "CARET",
    "+": "SIGN",
    "-": "SIGN",
    "?=": "COMPOUND_ASSIGN",
    "+=": "COMPOUND_ASSIGN",
    "-=": "COMPOUND_ASSIGN",
    "*=": "COMPOUND_ASSIGN",
    "/=": "COMPOUND_ASSIGN",
}
_OPERAND_ENDS = frozenset({"NAME", "RSQB", "RPAR", "CARET", "ADDRESS"})

_SINGLE_QUOTED = r"'[^$'\r\n]*+(?:\$[\s\S][^$'\r\n]*+)*+'"
_DOUBLE_QUOTED = r'"[^$"\r\n]*+(?:\$[\s\S][^$"\r\n]*+)*+"'
_NUMBER = r"\d[\d_]*(?:\#[0-9A-Za-z_]+|(?:\.\d[\d_]*)?(?:[eE][+-]?\d+)?)"
_NUMBERED_NAME = r"\d+(?!(?:[eE][+-]?\d+|ms|us|ns|min|[smhd])(?!\w))[^\W\d_]\w*"
"""A name that begins with digits, as GRAFCETs have for sensors (``1B1``): neither ``1E5`` nor ``3s``."""


@cache
def _pattern(dialect: Dialect, comments: Dialect) -> re.Pattern[str]:
    scl = dialect is Dialect.SCL
    codesys = dialect in (Dialect.CODESYS, Dialect.TWINCAT)
    numbered = "(?!)" if scl else _NUMBERED_NAME  # SCL writes such names in quotes
    groups = [
        # 1 COMMENT to the end of the line, 2 the start of a block, whose end `_Blocks` finds
        r"(//[^\r\n]*)",
        r"(\(\*|/\*|\(/\*|\{)" if comments is Dialect.SCL else r"(\(\*|/\*|\{\{(?=[\s\S]*?\}\})|\{)",
        # 3 LITERAL
        r"((?i:(?:L?TIME|L?T|S5T|S5TIME)\#[-+]?(?:\w|\.(?=\d))+"
        r"|(?:L?DATE_AND_TIME|L?TIME_OF_DAY|DTL|L?DATE|L?TOD|L?DT|L?D)\#\d(?:[\d_-]|[:.](?=\d))*)"
        + (r"|(?i:P\#[\w.]+(?:\s+(?:BOOL|BYTE|WORD|DWORD|INT|DINT|REAL|CHAR)\s+\d+\b)?)" if scl else "")
        + rf"|[^\W\d]\w*\#(?:{_SINGLE_QUOTED}|{_DOUBLE_QUOTED}|[-+]?{_NUMBER}|[^\W\d]\w*)"
        + (r"|\#(?!)" if scl else f"|{_DOUBLE_QUOTED}")
        + rf"|{_SINGLE_QUOTED}|(?<![^.]\.)(?!{numbered}){_NUMBER})",
        # 4 COMPOUND_ASSIGN by a word, if an operand is before it
        r"((?i:REF|S|R)=)" if codesys else r"((?!))",
        # 5 NAME or keyword, 6 NAME that is not valid
        rf"([^\W\d]\w*|(?<!\w){numbered})",
        r'(\#[^\W\d]\w*|\#"[^"\r\n]+"|"[^"\r\n]+"|(?<=\.)%[XBWDLxbwdl]\d+|(?<=\.)\d+)'
        if scl
        else r"((?<=\.)%[XBWDLxbwdl]\d+|(?<=\.)\d+)",
        # 7 ADDRESS
        r"(%(?i:DB\d+\.(?:DB)?)?[A-Za-z*]+[\d.*]*(?<!\.))",
        # 8 OPERATOR, 9 punctuation
        r"(\*\*|<>|<=|>=|=(?!>)|<|>|\*(?!=)|/(?!=)|&)",
        r"(:P\b|:=|=>|\.\.|\?=|[-+*/]=|[;:,.()\[\]^+-])" if scl else r"(:=|=>|\.\.|\?=|[-+*/]=|[;:,.()\[\]^+-])",
        # 10 an opening quote without its end, 11 anything else
        r"""(['"][^\r\n]*)""",
        r"([\s\S])",
    ]
    # spaces before a token belong to the match: one step of the loop less for each
    return re.compile(r"[\s\ufeff]*+(?:" + "|".join(groups) + r")")


_COMMENT, _BLOCK, _LITERAL, _WORD_ASSIGN, _WORD, _NAME, _ADDRESS, _OPERATOR, _PUNCT, _OPEN_QUOTE = range(1, 11)
_PLAIN = {_OPERATOR: "OPERATOR", _LITERAL: "LITERAL", _NAME: "NAME", _ADDRESS: "ADDRESS"}
"""The token types of groups that are tokens as they are."""


@cache
def _words(dialect: Dialect, keywords: frozenset[str]) -> dict[str, str]:
    """Return the token type of each word that is no name; grows with the spellings that occur."""
    words = dict.fromkeys(STATEMENT_KEYWORDS | _DIALECT_KEYWORDS[dialect] | keywords)
    types = {word: word.strip("_") for word in words}
    types |= dict.fromkeys(_WORD_OPERATORS, "OPERATOR") | dict.fromkeys(_LITERAL_WORDS, "LITERAL")
    if dialect in (Dialect.CODESYS, Dialect.TWINCAT):
        types |= {word: f"{_LATER}{types[word]}" for word in _LATER_WORDS if word in types}
    return types


def tokenize(
    text: str,
    dialect: Dialect = Dialect.IEC,
    keywords: frozenset[str] = frozenset(),
    *,
    comments_of: Dialect | None = None,
    embedded_code: bool = False,
) -> Tokens:
    """Return the tokens of `text`. `keywords` are words that are no names here, beyond those of statements.

    `comments_of`: the dialect of its comments where that is another one. `embedded_code`: ``{{ .. }}`` is a token, as
    it is executed where it is among statements; else it is a pragma.
    """
    # Every text goes through this loop: it is one function, with bound methods in local names, as calls would take
    # longer than the work. What depends on the token before is decided here, so that the grammar needs no look-ahead:
    # keywords behind a dot are members, and ``S=`` is an assignment behind an operand only.
    words = _words(dialect, keywords)
    known = words.get
    tokens: list[Token] = []
    comments: list[Comment] = []
    problems: list[Problem] = []
    append = tokens.append
    match = _pattern(dialect, comments_of or dialect).match
    position, end = 0, len(text)
    previous = ""
    blocks = _Blocks(text)
    while position < end:
        found = match(text, position)
        if found is None:  # spaces at the end
            break
        group = found.lastindex or 0
        start, position = found.span(group)
        value = found.group(group)
        if group == _WORD:
            kind = "NAME"
            if previous != "DOT":
                kind = known(value) or known(value.upper()) or "NAME"
                if kind[0] == _LATER:
                    kind = "NAME" if _is_name(kind, previous, text, position) else kind[1:]
                elif kind in _UP_TO_LINE_END:
                    if _UP_TO_LINE_END[kind].match(text, position):
                        position = _line_end(text, position)
                        value = text[start:position]
                    else:
                        kind = "NAME"
        elif group == _PUNCT:
            kind = _PUNCTUATION.get(value, "PERIPHERAL")
            if kind == "PERIPHERAL" and (previous not in _OPERAND_ENDS or tokens[-1].span[1] != start):
                kind, value, position = "COLON", ":", start + 1
        elif group in _PLAIN:
            kind = _PLAIN[group]
        elif group == _COMMENT:
            comments.append(Comment(CommentKind.LINE, value, (start, position)))
            continue
        elif group == _BLOCK:
            position = blocks.end(value, start)
            if value == "{{" and embedded_code:
                append(Token("CODE", text[start:position], (start, position)))
                previous = "CODE"
                continue
            if position < 0:
                position = end
                problems.append(_endless(value, (start, end)))
            kind = CommentKind.PRAGMA if value[0] == "{" else CommentKind.BLOCK
            comments.append(Comment(kind, text[start:position], (start, position)))
            continue
        elif group == _WORD_ASSIGN:
            if previous in _OPERAND_ENDS:
                kind = "COMPOUND_ASSIGN"
            else:  # a comparison with a variable that is called S or R
                append(Token("NAME", value[:-1], (start, position - 1)))
                kind, value, start = "OPERATOR", "=", position - 1
        elif group == _OPEN_QUOTE:
            kind = "BAD"
            if len(problems) < MAX_PROBLEMS:
                problems.append(Problem("this string has no end on its line", (start, position)))
        else:
            kind = "BAD"
            if len(problems) < MAX_PROBLEMS:
                problems.append(Problem(_out_of_place(value), (start, position)))
        append(Token(kind, value, (start, position)))
        previous = kind
    return Tokens(tokens, comments, problems)


_UP_TO_LINE_END = {"REGION": re.compile(r"(?!\s*:)"), "TITLE": re.compile(r"\s*=")}
"""Words before free text, and the token that follows them if they are no names."""


_LATER = "?"
"""Before the token type of a word that is a name where it cannot be a keyword."""
_LATER_WORDS = ("AND_THEN", "OR_ELSE", "CONTINUE", "JMP", "VAR_STAT")
"""Keywords of CODESYS V3 that are names of variables in CoDeSys 2.3, whose exports are read in the same dialect."""
_BEHIND_NAME = re.compile(
    r"\s*(?:[-+*=<>&,.:)\[\]^]|\((?!\*)|/(?![/*])|(?:AND|OR|XOR|MOD|AT|THEN|DO|OF|TO|BY)\b|\Z)", re.IGNORECASE
)
_BEFORE_OPERANDS = frozenset(
    """ASSIGN COMPOUND_ASSIGN OPERATOR SIGN NOT LPAR LSQB COMMA ARROW RANGE IF ELSIF WHILE UNTIL CASE FOR TO BY
    RETURN""".split()
)


def _is_name(kind: str, previous: str, text: str, position: int) -> bool:
    """True if one of `_LATER_WORDS`, of the token type `kind`, is no keyword between the tokens around it."""
    if kind == "?OPERATOR":  # one needs an operand before it
        return previous not in _OPERAND_ENDS and previous not in ("LITERAL", "PERIPHERAL")
    return previous in _BEFORE_OPERANDS or _BEHIND_NAME.match(text, position) is not None


def _line_end(text: str, position: int) -> int:
    found = re.compile(r"[\r\n]|$").search(text, position)
    return found.start() if found is not None else len(text)


_BLOCK_ENDS = {"(*": "*)", "/*": "*/", "(/*": "*/)", "{": "}", "{{": "}}"}


def _endless(opening: str, span: Span) -> Problem:
    what = "pragma" if opening == "{" else "comment"
    return Problem(f"this {what} has no end: {_BLOCK_ENDS[opening]} is missing", span)


_COMMENT_MARK = re.compile(r"\(\*|\*\)")


class _Blocks:
    """Ends of block comments and pragmas of a text.

    ``(* *)`` nest, in IEC 61131-3 ed. 3 always, in tools by an option. If they do not close when nested they are taken
    as not nested.
    """

    def __init__(self, text: str) -> None:
        self._text = text
        self._nested: dict[int, int] | None = None

    def end(self, opening: str, start: int) -> int:
        """Return the end of the block that starts with `opening` at `start`, -1 if it has none."""
        if opening == "(*":
            if self._nested is None:
                self._nested = self._pairs(start)
            if start in self._nested:
                return self._nested[start]
        closing = _BLOCK_ENDS[opening]
        found = self._text.find(closing, start + len(opening))
        return found + len(closing) if found >= 0 else -1

    def _pairs(self, start: int) -> dict[int, int]:
        """The ends of all comments from `start` on that close when nested: in one go, for any number of comments."""
        ends: dict[int, int] = {}
        opened: list[int] = []
        for mark in _COMMENT_MARK.finditer(self._text, start):
            if mark.group() == "(*":
                opened.append(mark.start())
            elif opened:
                ends[opened.pop()] = mark.end()
        return ends


_INSTEAD = {
    "↑": "R_TRIG: `Edge(CLK := a);` and then `Edge.Q`",
    "↓": "F_TRIG: `Edge(CLK := a);` and then `Edge.Q`",
    **dict.fromkeys("¬!", "NOT"),
    **dict.fromkeys("·∧⋅∙•", "AND"),
    "∨": "OR",
    "≤": "<=",
    "≥": ">=",
    "≠": "<>",
}
"""Signs that GRAFCETs have in conditions, and the words of structured text for them."""


def _out_of_place(character: str) -> str:
    """Return the message for a character that no token begins with."""
    instead = _INSTEAD.get(character)
    told = f"{_shown(character)} cannot stand here"
    return told if instead is None else f"{told}: structured text has {instead}"


def _shown(character: str) -> str:
    return repr(character) if character.isprintable() else f"the character U+{ord(character):04X}"
