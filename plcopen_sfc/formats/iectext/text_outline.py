"""Outline of a text: units and their parts, found by their keywords.

Bodies are not parsed here, so an error in one of them costs nothing else; every part knows its place.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from dataclasses import dataclass, field
from enum import StrEnum

from plcopen_sfc.languages.problems import Problem
from plcopen_sfc.languages.st.lexer import Comment, Token, Tokens, tokenize
from plcopen_sfc.model.dialect import Dialect


class PartKind(StrEnum):
    """Kinds of parts, by the keyword that opens them."""

    PROGRAM = "PROGRAM"
    FUNCTION_BLOCK = "FUNCTION_BLOCK"
    FUNCTION = "FUNCTION"
    METHOD = "METHOD"
    ACTION = "ACTION"
    STEP = "STEP"
    INITIAL_STEP = "INITIAL_STEP"
    TRANSITION = "TRANSITION"
    PROPERTY = "PROPERTY"
    TYPE = "TYPE"
    VAR = "VAR"
    CONFIGURATION = "CONFIGURATION"
    RESOURCE = "RESOURCE"
    INTERFACE = "INTERFACE"
    CLASS = "CLASS"
    NAMESPACE = "NAMESPACE"
    LOOSE = "loose"
    """Text that belongs to no part: the statements of a body."""


POUS = frozenset({PartKind.PROGRAM, PartKind.FUNCTION_BLOCK, PartKind.FUNCTION})
VAR_KEYWORDS = frozenset(
    """VAR VAR_INPUT VAR_OUTPUT VAR_IN_OUT VAR_TEMP VAR_EXTERNAL VAR_GLOBAL VAR_ACCESS VAR_CONFIG VAR_STAT
    VAR_INST""".split()
)
_FOREIGN_UNITS = frozenset({PartKind.INTERFACE, PartKind.CLASS, PartKind.NAMESPACE})
_UNITS = POUS | _FOREIGN_UNITS | {PartKind.TYPE, PartKind.CONFIGURATION}
_CONTAINERS = POUS | {PartKind.METHOD, PartKind.ACTION}
_NESTED = {
    "METHOD": PartKind.METHOD,
    "ACTION": PartKind.ACTION,
    "STEP": PartKind.STEP,
    "INITIAL_STEP": PartKind.INITIAL_STEP,
    "TRANSITION": PartKind.TRANSITION,
    "PROPERTY": PartKind.PROPERTY,
}
_CLOSERS = {f"END_{kind.value}" for kind in PartKind if kind not in (PartKind.LOOSE, PartKind.INITIAL_STEP)}
KEYWORDS = frozenset({kind.value for kind in PartKind if kind is not PartKind.LOOSE} | _CLOSERS | VAR_KEYWORDS)
MODIFIERS = frozenset({"PUBLIC", "PRIVATE", "PROTECTED", "INTERNAL", "FINAL", "ABSTRACT", "OVERRIDE"})
_TYPE_PREFIXES = frozenset({"POINTER", "REFERENCE"})
_WORD = re.compile(r"[^\W\d]\w*")


@dataclass(slots=True)
class TextPart:
    """A part of the text.

    `start` and `end` are offsets from its keyword to behind its END keyword, `inside` those of the text between,
    `tokens` the range of tokens between, `head` the range of tokens from the keyword to the end of the header. `name`
    is empty where there is none, as `return_type` (its offsets) is None.
    """

    kind: PartKind
    start: int
    end: int
    keyword: str = ""
    name: str = ""
    head: tuple[int, int] = (0, 0)
    inside: tuple[int, int] = (0, 0)
    tokens: tuple[int, int] = (0, 0)
    parts: list[TextPart] = field(default_factory=list)
    return_type: tuple[int, int] | None = None
    closed: bool = True


@dataclass(slots=True)
class Outline:
    """Parts of a text, its tokens, and the problems of its `structure`."""

    text: str
    dialect: Dialect
    found: Tokens
    parts: list[TextPart]
    structure: list[Problem]
    _token_starts: list[int] = field(init=False, repr=False)
    _comment_starts: list[int] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        # every part of a chart asks for its comments: to ask each token for its place took a fourth of the reading
        self._token_starts = [token.span[0] for token in self.found.tokens]
        self._comment_starts = [comment.span[0] for comment in self.found.comments]

    @property
    def problems(self) -> list[Problem]:
        """All problems: of tokens, and of the structure."""
        return [*self.found.problems, *self.structure]

    def comments(self, start: int, end: int) -> list[Comment]:
        """Return the comments and pragmas that are wholly between two offsets."""
        first, last = (bisect_left(self._comment_starts, offset) for offset in (start, end))
        return [comment for comment in self.found.comments[first:last] if comment.span[1] <= end]

    def tokens_within(self, start: int, end: int) -> list[Token]:
        """Return the tokens that start between two offsets."""
        first, last = (bisect_left(self._token_starts, offset) for offset in (start, end))
        return self.found.tokens[first:last]

    def tokens(self, span: tuple[int, int]) -> list[Token]:
        """Return the tokens of a range."""
        return self.found.tokens[span[0] : span[1]]

    def leads(self, part: TextPart) -> bool:
        """True if a transition is one of a chart; a transition object of the POU has no FROM and no TO."""
        depth = 0
        for token in self.tokens(part.tokens):
            depth += (token.type == "LPAR") - (token.type == "RPAR")
            if depth == 0 and token.type in ("ASSIGN", "COLON"):
                break
            if token.value.upper() in ("FROM", "TO"):
                return True
        return False


def outline(text: str, dialect: Dialect) -> Outline:
    """Find the parts of a text. Never raises: see `Outline.problems`."""
    found = tokenize(text, dialect, KEYWORDS)
    scan = _Scan(text, found.tokens)
    parts = scan.units()
    return Outline(text, dialect, found, parts, scan.problems)


class _Scan:
    def __init__(self, text: str, tokens: list[Token]) -> None:
        self.text = text
        self.tokens = tokens
        self.at = 0
        self.inner = 0
        self.problems: list[Problem] = []

    # -- looking at tokens ----------------------------------------------------------------------------------------

    def type(self, ahead: int = 0) -> str:
        index = self.at + ahead
        return self.tokens[index].type if index < len(self.tokens) else ""

    def is_word(self, ahead: int = 0) -> bool:
        index = self.at + ahead
        return index < len(self.tokens) and _WORD.fullmatch(self.tokens[index].value) is not None

    def word(self, ahead: int = 0) -> str:
        index = self.at + ahead
        return self.tokens[index].value.upper() if index < len(self.tokens) else ""

    def offset(self) -> int:
        """Return the offset at which the next token starts, or the text ends."""
        return self.tokens[self.at].span[0] if self.at < len(self.tokens) else len(self.text)

    def behind(self) -> int:
        """Return the offset at which the last token ended."""
        return self.tokens[self.at - 1].span[1] if self.at else 0

    def starts_line(self) -> bool:
        return "\n" in self.text[self.behind() : self.offset()] or "\r" in self.text[self.behind() : self.offset()]

    def may_open(self) -> bool:
        """True if a part may begin here: at the start of a line, or where a header or a statement ends."""
        if self.at in (0, self.inner) or self.starts_line():
            return True
        before = self.tokens[self.at - 1].type
        return before == "SEMICOLON" or before.startswith("END_")

    def problem(self, message: str, start: int, end: int) -> None:
        self.problems.append(Problem(message, (start, max(end, start))))

    # -- units ----------------------------------------------------------------------------------------------------

    def units(self) -> list[TextPart]:
        parts: list[TextPart] = []
        loose = -1
        while self.at < len(self.tokens):
            opener = self.unit_opener()
            if opener is None:
                loose = self.at if loose < 0 else loose
                self.at += 1
                continue
            loose = self.take_loose(loose, parts)
            parts.append(self.unit(opener))
        self.take_loose(loose, parts)
        return parts

    def take_loose(self, first: int, parts: list[TextPart]) -> int:
        """Put the text from the token `first` on (-1: none) into `parts`. Returns -1: nothing is loose now."""
        if first >= 0:
            start, end = self.tokens[first].span[0], self.behind()
            parts.append(TextPart(PartKind.LOOSE, start, end, inside=(start, end), tokens=(first, self.at)))
        return -1

    def unit_opener(self) -> PartKind | None:
        kind = self.type()
        if kind in VAR_KEYWORDS:
            return PartKind.VAR if self.may_open() else None
        if kind not in _UNITS or not self.may_open():
            return None
        if kind == PartKind.TYPE:
            return PartKind.TYPE
        # a program instance of a configuration looks like a program: PROGRAM name WITH .., PROGRAM name : ..
        if not self.is_word(1) or (kind == PartKind.PROGRAM and (self.word(2) == "WITH" or self.type(2) == "COLON")):
            return None
        return PartKind(kind)

    def unit(self, kind: PartKind) -> TextPart:
        if kind is PartKind.VAR:
            return self.section()
        if kind is PartKind.TYPE or kind in _FOREIGN_UNITS:
            return self.plain(kind)
        if kind is PartKind.CONFIGURATION:
            return self.configuration()
        return self.container(kind)

    def section(self) -> TextPart:
        """``VAR .. END_VAR``."""
        first = self.at
        keyword = self.type()
        self.at += 1
        return self.until_end(TextPart(PartKind.VAR, self.tokens[first].span[0], 0, keyword, head=(first, self.at)))

    def plain(self, kind: PartKind) -> TextPart:
        """Return a part whose inside is not looked into."""
        first = self.at
        self.at += 1
        name = self.tokens[self.at].value if kind is not PartKind.TYPE and self.is_word() else ""
        return self.until_end(TextPart(kind, self.tokens[first].span[0], 0, kind.value, name, (first, self.at)))

    def until_end(self, part: TextPart) -> TextPart:
        """Move behind the END keyword of `part`, or to where its lack shows."""
        closer = f"END_{part.kind.value}"
        begin, first = self.behind(), self.at
        while self.at < len(self.tokens):
            kind = self.tokens[self.at].type
            if kind not in KEYWORDS:  # nearly all tokens, and declarations are most of many files
                self.at += 1
                continue
            if kind == closer:
                return self.close(part, begin, first)
            if self.shows_missing_end(part.kind, kind):
                break
            self.at += 1
        return self.unclosed(part, begin, first)

    def shows_missing_end(self, within: PartKind, found: str) -> bool:
        """True if the token here cannot be within a part of this kind."""
        if within in _FOREIGN_UNITS or within is PartKind.PROPERTY:
            return found in _CLOSERS and found in {f"END_{unit}" for unit in POUS} and within is PartKind.PROPERTY
        if found in _CLOSERS:
            return True
        if self.unit_opener() is not None and (within is not PartKind.TRANSITION or found not in VAR_KEYWORDS):
            return True
        return within not in (PartKind.TYPE, PartKind.VAR) and self.nested_opener() is not None and self.starts_line()

    def close(self, part: TextPart, begin: int, first: int) -> TextPart:
        part.inside, part.tokens = (begin, self.offset()), (first, self.at)
        self.at += 1
        part.end = self.behind()
        return part

    def unclosed(self, part: TextPart, begin: int, first: int) -> TextPart:
        """End a part whose END keyword is missing before the next token."""
        part.closed = False
        part.tokens = (first, self.at)
        part.end = max(self.behind(), begin) if self.at < len(self.tokens) else len(self.text)
        part.inside = (begin, part.end)
        kind = PartKind.STEP if part.kind is PartKind.INITIAL_STEP else part.kind
        closer = "END_VAR" if part.kind is PartKind.VAR else f"END_{kind.value}"
        start = self.tokens[part.head[0]].span[0]
        what = " ".join(filter(None, (part.keyword, part.name)))
        before = f" before {self.tokens[self.at].value}" if self.at < len(self.tokens) else ""
        self.problem(f"{closer} of {what} is missing{before}", start, self.tokens[part.head[1] - 1].span[1])
        return part

    # -- parts of units -------------------------------------------------------------------------------------------

    def nested_opener(self) -> PartKind | None:
        """Return the kind of part that begins here inside a POU, if one does."""
        kind = self.type()
        if kind in VAR_KEYWORDS:
            return PartKind.VAR if self.may_open() else None
        nested = _NESTED.get(kind)
        if nested is None or not self.may_open():
            return None
        if nested in (PartKind.STEP, PartKind.INITIAL_STEP):
            return nested if self.is_word(1) and self.type(2) == "COLON" else None
        if nested is PartKind.TRANSITION:
            return nested if self.is_word(1) or self.type(1) == "LPAR" else None
        return nested if self.is_word(1) else None

    def container(self, kind: PartKind) -> TextPart:
        """Return a POU, a method or an action: its header, then parts and statements up to its END."""
        first = self.at
        part = TextPart(kind, self.offset(), 0, self.type())
        self.at += 1
        self.header(part)
        part.head = (first, self.at)
        begin, inner = self.behind(), self.at
        self.inner = inner
        closer = f"END_{kind.value}"
        loose = -1
        while self.at < len(self.tokens):
            found = self.type()
            nested = None if found == closer else self.nested_opener()
            ends = found == closer or (nested is None and self.ends_container(kind, found))
            ends = ends or (nested in (PartKind.METHOD, PartKind.PROPERTY) and kind not in POUS)
            # an action is a chart or statements: after statements, the next part shows that its end is missing
            ends = ends or (kind is PartKind.ACTION and nested is not None and loose >= 0)
            if nested is None and not ends:
                loose = self.at if loose < 0 else loose
                self.at += 1
                continue
            loose = self.take_loose(loose, part.parts)
            if found == closer:
                return self.close(part, begin, inner)
            if ends:
                return self.unclosed(part, begin, inner)
            if nested is not None:
                part.parts.append(self.nested(nested))
        self.take_loose(loose, part.parts)
        return self.unclosed(part, begin, inner)

    def ends_container(self, kind: PartKind, found: str) -> bool:
        """True if the token here closes or opens something around a container of this kind."""
        if self.unit_opener() is not None:
            return True
        if found not in _CLOSERS:
            return False
        if kind in POUS:
            return found in {f"END_{unit}" for unit in POUS}
        return found in {f"END_{unit}" for unit in POUS | {PartKind.METHOD, PartKind.ACTION}}

    def nested(self, kind: PartKind) -> TextPart:
        if kind is PartKind.VAR:
            return self.section()
        if kind in _CONTAINERS:
            return self.container(kind)
        first = self.at
        part = TextPart(kind, self.offset(), 0, self.type())
        self.at += 1
        if kind in (PartKind.STEP, PartKind.INITIAL_STEP):
            part.name = self.tokens[self.at].value
            part.head = (first, self.at + 2)
            self.at += 2
            part.kind = PartKind.STEP
        else:
            part.head = (first, self.at)
            if kind is PartKind.PROPERTY:
                part.name = self.tokens[self.at].value
        return self.until_end(part)

    def header(self, part: TextPart) -> None:
        """Move behind ``name``, ``: type``, ``EXTENDS ..`` and the like."""
        while self.word() in MODIFIERS and self.is_word(1):
            self.at += 1
        if self.is_word():
            part.name = self.tokens[self.at].value
            self.at += 1
            while self.type() == "DOT" and self.is_word(1) and not self.starts_line():
                part.name += "." + self.tokens[self.at + 1].value
                self.at += 2
        if part.kind is PartKind.ACTION:
            self.at += self.type() == "COLON"
            return
        if self.type() == "COLON" and part.kind is not PartKind.PROGRAM:
            self.at += 1
            start = self.offset()
            self.skip_type()
            part.return_type = (start, self.behind())
        while self.word() in ("EXTENDS", "IMPLEMENTS"):
            self.at += 1
            self.skip_names()
        self.at += self.type() == "SEMICOLON" and not self.starts_line()

    def skip_names(self) -> None:
        while self.is_word():
            self.at += 1
            if self.type() not in ("COMMA", "DOT"):
                break
            self.at += 1

    def skip_type(self) -> None:
        while self.word() in _TYPE_PREFIXES and self.type(1) == "TO":
            self.at += 2
        if self.word() == "REF_TO":
            self.at += 1
        is_array = self.word() == "ARRAY"
        self.at += self.is_word()
        while self.type() == "DOT" and self.is_word(1):
            self.at += 2
        if self.type() in ("LSQB", "LPAR") and not self.starts_line():
            self.skip_brackets()
        if is_array and self.type() == "OF":
            self.at += 1
            self.skip_type()

    def skip_brackets(self) -> None:
        depth = 0
        while self.at < len(self.tokens):
            kind = self.type()
            depth += (kind in ("LSQB", "LPAR")) - (kind in ("RSQB", "RPAR"))
            self.at += 1
            if depth == 0:
                return

    # -- configurations -------------------------------------------------------------------------------------------

    def configuration(self, kind: PartKind = PartKind.CONFIGURATION) -> TextPart:
        """Configuration or a resource: its resources and sections are parts, the rest is looked at by the reader."""
        first = self.at
        part = TextPart(kind, self.offset(), 0, kind.value)
        self.at += 1
        part.name = self.tokens[self.at].value if self.is_word() else ""
        self.at += self.is_word()
        if kind is PartKind.RESOURCE and self.word() == "ON" and self.is_word(1):
            self.at += 2
        part.head = (first, self.at)
        begin, inner = self.behind(), self.at
        loose = -1
        while self.at < len(self.tokens):
            found = self.type()
            opens = found in VAR_KEYWORDS or (found == "RESOURCE" and self.is_word(1))
            closes = found in _CLOSERS or (not opens and self.unit_opener() is not None and self.starts_line())
            if not opens and not closes:
                loose = self.at if loose < 0 else loose
                self.at += 1
                continue
            loose = self.take_loose(loose, part.parts)
            if found == f"END_{kind.value}":
                return self.close(part, begin, inner)
            if closes or (opens and found == "RESOURCE" and kind is PartKind.RESOURCE):
                return self.unclosed(part, begin, inner)
            part.parts.append(self.section() if found in VAR_KEYWORDS else self.configuration(PartKind.RESOURCE))
        self.take_loose(loose, part.parts)
        return self.unclosed(part, begin, inner)
