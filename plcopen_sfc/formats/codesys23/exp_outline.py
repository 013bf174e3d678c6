"""Outline of an ``.EXP`` file: its objects, and the places of their parts.

Bodies in graphical languages are no program text, so that the lines of the file decide where a part ends, and not the
tokens of the whole.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TypeAlias

from plcopen_sfc.languages.declarations import split_units
from plcopen_sfc.languages.problems import Problem
from plcopen_sfc.model.dialect import Dialect

Span: TypeAlias = tuple[int, int]

OTHER = "other"
"""Kind of the objects that are kept as they are: task configuration, visualisation, library manager .."""
GLOBALS = "VAR_GLOBAL"
PRAGMA = re.compile(r"\(\*[ \t]*@(?P<name>\w+)(?:[ \t]*:=[ \t]*(?P<value>(?:[^*]|\*(?!\)))*?))?[ \t]*\*\)")
_HEADER = re.compile(
    r"^[ \t]*(?=\(\*[ \t]*@(?:NESTEDCOMMENTS|GLOBAL_VARIABLE_LIST|PATH|OBJECTFLAGS|SYMFILEFLAGS)\b)", re.MULTILINE
)
_PLAIN_COMMENTS = re.compile(r"\(\*[ \t]*@NESTEDCOMMENTS[ \t]*:=[ \t]*'No'", re.IGNORECASE)
_END_OF_DECLARATION = re.compile(r"^[ \t]*(\(\*[ \t]*@END_DECLARATION\b[^*]*\*\))", re.MULTILINE)
_UNIT = re.compile(r"(PROGRAM|FUNCTION_BLOCK|FUNCTION)[ \t]+(\w+)|(TYPE)\b|(VAR_GLOBAL)\b", re.IGNORECASE)
_ACTION = re.compile(r"ACTION[ \t]+(\w+)[ \t]*:", re.IGNORECASE)
_ENDED = r"^|;|\*\)|\bEND_STRUCT"
"""What may stand in front of an END word, in the same line or not."""
_MARKER = re.compile(r"[\s\ufeff]*_[A-Z]+_BODY\b")
_MARKS = re.compile(r"'[^'$\r\n]*+(?:\$.[^'$\r\n]*+)*+'|\"[^\"$\r\n]*+(?:\$.[^\"$\r\n]*+)*+\"|\(\*|\*\)")
_ENDED_SECTIONS = frozenset({"LIBRARY", "PLC_CONFIGURATION", "RESOURCE", "VISUALISATION"})
"""Sections that have a word at their end (documented); of others that is not known."""
OWN_LINE = re.compile(r"^\(\* (\{plcopen_sfc [^\r\n]*\}) \*\)", re.MULTILINE)
"""A comment of this package: content that the text cannot express."""


@dataclass(slots=True)
class ExpBody:
    """Body of a POU or of an action: `span` is the text between its head and its END, `end` is that word."""

    span: Span
    end: Span


@dataclass(slots=True)
class ExpAction:
    """Action behind its POU."""

    name: str
    head: Span
    body: ExpBody


@dataclass(slots=True)
class ExpObject:
    """Object of a file. `header` are its pragmas, `declared` its declarations with the comments before them.

    `divider` is the pragma that ends the declarations, `footer` the pragmas behind a list of global variables.
    """

    kind: str
    span: Span
    name: str = ""
    header: Span = (0, 0)
    declared: Span = (0, 0)
    divider: Span | None = None
    footer: Span | None = None
    body: ExpBody | None = None
    actions: list[ExpAction] = field(default_factory=list)


@dataclass(slots=True)
class ExpOutline:
    """Objects of a file, and the structure problems; `text` is that of the file, comments of this package blanked."""

    text: str
    objects: list[ExpObject]
    problems: list[Problem]
    tail: Span


def outline_of(source: str) -> ExpOutline:
    """Return the objects of a file. Never raises: see `ExpOutline.problems`."""
    text = OWN_LINE.sub(lambda found: " " * len(found.group()), source)
    return _Scan(text).run()


class _Scan:
    def __init__(self, text: str) -> None:
        self.text = text
        self.objects: list[ExpObject] = []
        self.problems: list[Problem] = []

    def run(self) -> ExpOutline:
        starts = list(self._headers())
        position = 0
        if not starts or starts[0][0] > 0:
            position = self._units((0, 0), starts[0][0] if starts else len(self.text))
        for number, (start, behind) in enumerate(starts, 1):
            self._loose(position, start)
            self._check_nesting((start, behind), starts[number][0] if number < len(starts) else len(self.text))
            position = self._units((start, behind), starts[number][0] if number < len(starts) else len(self.text))
        return ExpOutline(self.text, self.objects, self.problems, (position, len(self.text)))

    def _loose(self, start: int, end: int) -> None:
        """Keep comments between objects that belong to none."""
        start, end = core(self.text, (start, end))
        if start < end:
            self.objects.append(ExpObject(OTHER, (start, end)))

    def _check_nesting(self, header: Span, end: int) -> None:
        """Report a comment within a comment where the option of the tool says that comments do not nest."""
        if _PLAIN_COMMENTS.search(self.text, *header) is None:
            return
        opened: int | None = None
        for mark in _MARKS.finditer(self.text, header[1], end):
            if mark.group() == "*)":
                opened = None
            elif mark.group() == "(*" and opened is not None:
                message = "this comment has (* in it: it is read as one that nests, and NESTEDCOMMENTS is 'No'"
                self.problems.append(Problem(message, (opened, mark.end())))
                return
            elif mark.group() == "(*":
                opened = mark.start()

    def _headers(self) -> Iterator[Span]:
        """Yield the runs of pragmas that begin an object."""
        end = 0
        for found in _HEADER.finditer(self.text):
            if found.end() < end:
                continue
            start = end = found.end()
            while (pragma := PRAGMA.match(self.text, self._blanks(end))) is not None:
                end = pragma.end()
            yield start, end

    def _blanks(self, position: int) -> int:
        while position < len(self.text) and self.text[position] in " \t\r\n\ufeff":
            position += 1
        return position

    # -- objects

    def _units(self, header: Span, limit: int) -> int:
        """Find the objects of which the first has `header`, and return where the last ends."""
        position = header[1]
        while True:
            start = self._blanks(position)
            solid = after_comments(self.text, position, limit)
            if solid >= limit:
                return header[0] if position == header[1] else position
            found = _UNIT.match(self.text, solid)
            action = _ACTION.match(self.text, solid)
            if action is not None and self.objects and self.objects[-1].body is not None:
                last = self.objects[-1]
                name, head = action[1], action.span()
                body = self._body(head[1], limit, f"END_ACTION of the action {name}", "END_ACTION", head)
                last.actions.append(ExpAction(name, (start, head[1]), body))
                position = body.end[1]
                last.span = (last.span[0], position)
                continue
            made = ExpObject(OTHER, (start, limit), header=header)
            if found is None:
                word = re.compile(r"\w*").match(self.text, solid)
                made.name = word.group() if word is not None else ""
                end = find_end(self.text, solid, limit, rf"_?END_?{made.name}|PLC_END") if made.name else None
                if end is None and made.name.upper() in _ENDED_SECTIONS:
                    message = f"the end of the section {made.name} is missing"
                    self.problems.append(Problem(message, (solid, solid + len(made.name))))
                behind = end[1] if end is not None else solid_end(self.text, start, limit)
                behind = behind if behind > position else limit  # no text that anything ends: all of it is one object
                made.span = (header[0] if header[0] < header[1] else start, behind)
            elif found[1]:
                self._pou(made, found, (start, solid), limit)
            elif found[3]:
                self._type(made, (start, solid), limit)
            else:
                self._globals(made, (start, solid), limit)
            self.objects.append(made)
            position = made.span[1]
            header = (position, position)

    def _pou(self, made: ExpObject, found: re.Match[str], at: Span, limit: int) -> None:
        made.kind, made.name = found[1].upper(), found[2]
        start, solid = at
        divider = _END_OF_DECLARATION.search(self.text, solid, limit)
        if divider is not None:
            made.divider = divider.span(1)
            made.declared = (start, solid_end(self.text, start, divider.start()))
        else:
            units = split_units(self.text[solid:limit], Dialect.CODESYS).units
            made.declared = (start, solid + units[0].head[1])
        behind = made.divider[1] if made.divider is not None else made.declared[1]
        closer = f"END_{made.kind}"
        made.body = self._body(behind, limit, f"{closer} of {made.kind} {made.name}", closer, found.span())
        made.span = (made.header[0], made.body.end[1])

    def _body(self, start: int, limit: int, what: str, closer: str, opener: Span) -> ExpBody:
        end = find_end(self.text, start, limit, closer) or find_end(self.text, start, limit, closer, before=_ENDED)
        if end is None:
            self.problems.append(Problem(f"{what} is missing", opener))
            stop = solid_end(self.text, start, limit)
            end = (stop, stop)
        return ExpBody((start, end[0]), end)

    def _type(self, made: ExpObject, at: Span, limit: int) -> None:
        made.kind = "TYPE"
        end = find_end(self.text, at[1], limit, "END_TYPE", before=_ENDED)
        if end is None:
            self.problems.append(Problem("END_TYPE is missing", (at[1], at[1] + len("TYPE"))))
            end = (limit, solid_end(self.text, at[1], limit))
        made.declared = (at[0], end[1])
        divider = PRAGMA.match(self.text, self._blanks(end[1]))
        made.divider = divider.span() if divider is not None and divider["name"] == "END_DECLARATION" else None
        made.span = (made.header[0], made.divider[1] if made.divider is not None else end[1])

    def _globals(self, made: ExpObject, at: Span, limit: int) -> None:
        made.kind = GLOBALS
        start, position = at
        end = position
        while re.compile("VAR_GLOBAL", re.IGNORECASE).match(self.text, position):
            found = find_end(self.text, position, limit, "END_VAR", before=_ENDED)
            if found is None:
                self.problems.append(Problem("END_VAR of VAR_GLOBAL is missing", (position, position + len(GLOBALS))))
                end = solid_end(self.text, position, limit)
                break
            end = found[1]
            position = after_comments(self.text, end, limit)
        made.declared = (start, end)
        first = behind = end
        while (pragma := PRAGMA.match(self.text, self._blanks(behind))) is not None and pragma.end() <= limit:
            first = pragma.start() if behind == end else first
            behind = pragma.end()
        made.footer = (first, behind) if behind > end else None
        made.span = (made.header[0], behind)
        header = {found["name"]: found["value"] or "" for found in PRAGMA.finditer(self.text, *made.header)}
        made.name = header.get("GLOBAL_VARIABLE_LIST", "").strip("'")


# -- places in texts


def find_end(text: str, start: int, limit: int, word: str, *, before: str = "^") -> Span | None:
    """Return the place of `word` at the start of a line, or behind what else `before` finds; None if it is nowhere.

    Words in comments do not count.
    """
    pattern = re.compile(rf"(?:{before})[ \t]*({word})\b", re.MULTILINE | re.I)
    found = [each.span(1) for each in pattern.finditer(text, start, limit)]
    if not found or _MARKER.match(text, start):
        return found[0] if found else None
    return next((span for span in found if not is_in_comment(text, start, span[0])), None)


def is_in_comment(text: str, start: int, end: int) -> bool:
    """True if a comment that begins behind `start` is open at `end`."""
    return open_comment(text, start, end) is not None


def open_comment(text: str, start: int, end: int) -> int | None:
    """Return where the outermost comment begins that is open at `end`; None without one. Comments nest."""
    opened: list[int] = []
    for mark in _MARKS.finditer(text, start, end):
        if mark.group() == "(*":
            opened.append(mark.start())
        elif mark.group() == "*)":
            del opened[-1:]
    return next(iter(opened), None)


def without_comments(text: str, span: Span) -> str:
    """Return `text` with blanks in the place of the comments in `span`, their line ends too, but for an open one."""
    parts: list[str] = []
    behind = 0
    opened: list[int] = []
    for mark in _MARKS.finditer(text, *span):
        if mark.group() == "(*":
            opened.append(mark.start())
        elif mark.group() == "*)" and opened:
            begin = opened.pop()
            if not opened:
                parts += (text[behind:begin], " " * (mark.end() - begin))
                behind = mark.end()
    return "".join([*parts, text[behind:]])


def after_comments(text: str, position: int, limit: int) -> int:
    """Return where anything but comments and blanks begins, `limit` if nothing does."""
    while position < limit:
        if text[position] in " \t\r\n\ufeff":
            position += 1
        elif text.startswith("(*", position):
            depth = 0
            for mark in re.compile(r"\(\*|\*\)").finditer(text, position, limit):
                depth += 1 if mark.group() == "(*" else -1
                if depth == 0:
                    position = mark.end()
                    break
            else:
                return limit
        else:
            return position
    return limit


def solid_end(text: str, start: int, end: int) -> int:
    """Return where the last character is that is no blank, not before `start`."""
    while end > start and text[end - 1].isspace():
        end -= 1
    return end


def core(text: str, span: Span) -> Span:
    """Return the lines in `span` without blank ones at both ends, and without blanks behind the last."""
    start, end = span[0], solid_end(text, *span)
    while (line := re.compile(r"[ \t]*(?:\r\n|\r|\n)").match(text, start, end)) is not None:
        start = line.end()
    return (start, max(start, end))
