"""A text that is read: its pragmas and comments, the findings about it, and how bodies and comments lie on the page."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import islice
from typing import NamedTuple

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import Location
from plcopen_sfc.formats.iectext.text_outline import Outline
from plcopen_sfc.formats.text_patch import plain_lines
from plcopen_sfc.languages.declarations.kept_texts import unwrapped, wrapped
from plcopen_sfc.languages.il_problems import instruction_problems
from plcopen_sfc.languages.pragmas import Fields, NotationError, RemainderEntry, parse_change
from plcopen_sfc.languages.problems import Lines, Problem
from plcopen_sfc.languages.st import parse_expression, parse_statements
from plcopen_sfc.languages.st.lexer import Comment, CommentKind, Token

INDENT = "    "
_FIRST_LINE_END = re.compile(r"[ \t]*\n")
_BLANK_LINES_BEFORE = re.compile(r"(?:[ \t]*\n)*")
_MARK_OR_CONTROL = re.compile(r"\(\*|\*\)|[\x00-\x08\x0b-\x1f\x7f\x85\u2028\u2029\ufeff]")


class TextBlock(NamedTuple):
    """A text of several lines: its lines without common margin and blank edges, and these edges."""

    text: str
    margin: str = ""
    before: str = ""
    after: str = ""

    def whole(self) -> str:
        """Return the text with its margin and edges."""
        return self.before + indented(self.text, self.margin) + self.after


def block(text: str) -> TextBlock:
    """Take the margin and the blank edges off a text whose first line has its margin too."""
    before = _BLANK_LINES_BEFORE.match(text)
    start = before.end() if before is not None else 0
    core = text[start:].rstrip()
    if not core:
        return TextBlock("", before=text)
    margin = _margin(core.split("\n"))
    lines = [line[len(margin) :] if line.strip() else line for line in core.split("\n")]
    return TextBlock("\n".join(lines), margin, text[:start], text[start + len(core) :])


def taken(source: str) -> str:
    """Return the lines between a header and its END as a reader takes them: without margin and blank edges."""
    text = plain_lines(source)
    core = text.strip()
    if "\n" not in core or _FIRST_LINE_END.match(text) is not None:
        return block(text).text
    # the first line is behind the header and does not show the margin
    head, _, rest = core.partition("\n")
    return head.rstrip() + "\n" + _dedented(rest)


def _dedented(text: str) -> str:
    lines = text.split("\n")
    margin = _margin(lines)
    return "\n".join(line[len(margin) :] if line.strip() else line for line in lines)


def _margin(lines: list[str]) -> str:
    margins = [line[: len(line) - len(line.lstrip(" \t"))] for line in lines if line.strip()]
    margin = min(margins, key=len, default="")
    while not all(one.startswith(margin) for one in margins):
        margin = margin[:-1]
    return margin


def indented(text: str, indent: str) -> str:
    """`text` with `indent` before each line that is not blank."""
    return "\n".join(indent + line if line.strip() else line for line in text.split("\n"))


# -- comments ---------------------------------------------------------------------------------------------------------


def format_comment(text: str, indent: str) -> str | None:
    """``(* text *)``, its further lines below the first; None where the text would not come back from that."""
    if _MARK_OR_CONTROL.search(text):
        return None
    lines = text.split("\n")
    shown = (
        "(* " + "\n".join([lines[0], *(indent + "   " + line if line.strip() else line for line in lines[1:])]) + " *)"
    )
    return shown if taken_comment(shown) == text else None


def taken_comment(raw: str) -> str:
    """Return the text of a comment: without its marks, the blank beside each, and the margin of its further lines."""
    text = plain_lines(raw)
    if text.startswith("//"):
        return text[2:].removeprefix(" ").rstrip()
    inner = text[2 : -2 if len(text) >= 4 and text.endswith(("*)", "*/")) else None]
    inner = inner.removeprefix(" ").removesuffix(" ")
    first, line_end, rest = inner.partition("\n")
    if not line_end:
        return inner
    if not rest.strip():
        return first.rstrip()
    if not first.strip():
        return block(inner).text
    return first + "\n" + _dedented(rest)


OWN_PRAGMA = re.compile(r"\{\s*plcopen_sfc\b")


_MANY = 20
"""Findings of one body that are reported; the rest mostly follows from these."""
_SOLID = re.compile(r"\S+")
_OF_PROJECT = re.compile(r"\{\s*plcopen_sfc\s+(?:format|project\.dialect)\s*:=")


def between_semicolons(tokens: list[Token]) -> Iterator[list[Token]]:
    """Yield the tokens between semicolons, where there are any."""
    group: list[Token] = []
    for token in tokens:
        if token.type == "SEMICOLON":
            if group:
                yield group
            group = []
        else:
            group.append(token)
    if group:
        yield group


@dataclass(slots=True)
class Annotations:
    """Text beside the code: changes that our pragmas make, comments, and pragmas of other tools."""

    changes: list[tuple[RemainderEntry, int]] = field(default_factory=list)
    comments: list[str] = field(default_factory=list)
    pragmas: list[str] = field(default_factory=list)

    def extend(self, other: Annotations) -> None:
        """Add the content of `other`."""
        self.changes += other.changes
        self.comments += other.comments
        self.pragmas += other.pragmas

    def put_into(self, fields: Fields) -> None:
        """Put the comments and the pragmas of other tools into `fields`."""
        if self.comments:
            fields["comment"] = "\n".join(self.comments)
        for pragma in self.pragmas:
            keep_text(fields, "pragma", pragma)


def keep_text(fields: Fields, place: str, text: str) -> None:
    """Keep a text that the model has no field for with the object of `fields`; `place` tells what it is."""
    keep_data(fields, wrapped(place, text))


def keep_data(fields: Fields, data: Fields) -> None:
    """Add foreign data to the fields of an object."""
    fields.setdefault("extension_data", {}).setdefault("data", []).append(data)


def kept_texts(fields: Fields) -> Iterator[tuple[str, str, Fields]]:
    """Yield the place and the text of each piece of foreign data of an object, empty for those of others, and it."""
    for data in fields.get("extension_data", {}).get("data", []):
        yield *(unwrapped(data.get("content", "")) or ("", "")), data


@dataclass
class TextSource:
    """A text that is being read.

    `ignored` are the offsets of pragmas that do not fit and are left out, `named` the transition objects of the POU
    that is being read, in lower case, `checked` the places whose text was parsed.
    """

    outline: Outline
    file: str | None = None
    diagnostics: list[Diagnostic] = field(default_factory=list)
    ignored: set[int] = field(default_factory=set)
    named: frozenset[str] = frozenset()
    checked: list[tuple[int, int]] = field(default_factory=list)
    _lines: Lines | None = None
    _noted: set[Diagnostic] = field(default_factory=set)

    @property
    def text(self) -> str:
        """Whole text."""
        return self.outline.text

    @cached_property
    def has_changes(self) -> bool:
        """True if a pragma of this package may change what the text declares."""
        own = sum(map(is_own, self.outline.found.comments))
        return own > len(_OF_PROJECT.findall(self.text))

    def location(self, offset: int, path: str = "") -> Location:
        """Return the place of an offset."""
        if self._lines is None:
            self._lines = Lines(self.text)
        line, column = self._lines.place(offset)
        return Location(self.file, line, column, path or None)

    def note(self, code: str, message: str, offset: int, path: str = "", severity: Severity = Severity.ERROR) -> None:
        """Add a finding; the same one only once."""
        finding = Diagnostic(code, severity, message, self.location(offset, path))
        if finding not in self._noted:
            self._noted.add(finding)
            self.diagnostics.append(finding)

    def check(self, problems: Iterable[Problem], start: int, end: int, text: str, *, code: str, path: str) -> None:
        """Report the problems of `text`, which was taken from between two offsets."""
        self.checked.append((start, end))
        for problem in islice(problems, _MANY):
            self.note(code, problem.message, self.place_of(start, text, problem.span[0]), path)

    def check_code(self, body: Fields, start: int, end: int, path: str) -> None:
        """Report the problems of the statements or instructions of a body, or of an expression."""
        text, dialect = body.get("text", ""), self.outline.dialect
        if not text:
            return
        if body.get("language") == "IL":
            problems: Sequence[Problem] = instruction_problems(text, dialect)
        else:
            parse = parse_expression if body.get("kind") == "expression" else parse_statements
            problems = parse(text, dialect).problems
        self.check(problems, start, end, text, code="IEC110", path=path)

    def place_of(self, start: int, text: str, offset: int) -> int:
        """Return the offset of the character at `offset` of `text`, which was taken from the text at `start`."""
        solid = len("".join(text[:offset].split()))
        for found in _SOLID.finditer(self.text, start):
            if solid < len(found.group()):
                return found.start() + solid
            solid -= len(found.group())
        return len(self.text)

    def annotations(self, start: int, end: int, path: str = "") -> Annotations:
        """Return the annotations in the comments and pragmas between two offsets."""
        found = Annotations()
        for comment in self.outline.comments(start, end):
            self._sort(comment, found, path)
        return found

    def _sort(self, comment: Comment, into: Annotations, path: str) -> None:
        if is_own(comment):
            offset = comment.span[0]
            if offset not in self.ignored:
                try:
                    change = parse_change(comment.text[:-1], comment.text.index("plcopen_sfc") + len("plcopen_sfc"))
                    into.changes.append((change, offset))
                except NotationError as error:
                    self.note("IEC210", f"this pragma cannot be read: {error}", offset + error.position, path)
        elif comment.kind is CommentKind.PRAGMA:
            into.pragmas.append(comment.text)
        else:
            into.comments.append(taken_comment(comment.text))

    def core(self, start: int, end: int) -> tuple[int, int]:
        """Return the place between two offsets without the pragmas of this package that begin and end it."""
        own = [c.span for c in self.outline.comments(start, end) if is_own(c)]
        for span in own:
            if self.text[start : span[0]].strip():
                break
            start = span[1]
        for span in reversed(own):
            if span[1] <= start or self.text[span[1] : end].strip():
                break
            end = span[0]
        return start, end

    def attached(self, start: int, end: int) -> int:
        """Return the begin of the comments and pragmas directly above the part at `end`, not before `start`."""
        begin = end
        for comment in reversed(self.outline.comments(start, end)):
            between = self.text[comment.span[1] : begin]
            line_start = max(self.text.rfind("\n", 0, comment.span[0]), self.text.rfind("\r", 0, comment.span[0])) + 1
            own_line = not self.text[max(line_start, start) : comment.span[0]].strip() and line_start >= start
            if between.strip() or len(re.findall(r"\r\n|\r|\n", between)) > 1 or not own_line:
                break
            begin = comment.span[0]
        return begin


def is_own(comment: Comment) -> bool:
    """True if a comment is a pragma of this package."""
    return comment.kind is CommentKind.PRAGMA and OWN_PRAGMA.match(comment.text) is not None
