"""Printing of texts: the blocks that they are made of, names, pragmas, and the outcome of each item.

Conditions and bodies that are drawn, FBD and LD, are beside structured text with the same meaning. Other tools and
people read the text; the drawing is in pragmas at the end of the unit, and counts as long as the text is the one it was
written with.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Collection, Iterable
from dataclasses import dataclass, field

from pydantic import BaseModel

from plcopen_sfc.formats.iectext.text_outline import KEYWORDS, MODIFIERS, PartKind, outline
from plcopen_sfc.formats.iectext.text_source import (
    OWN_PRAGMA,
    TextBlock,
    block,
    format_comment,
    indented,
    is_own,
    keep_data,
    kept_texts,
    taken,
)
from plcopen_sfc.languages.pragmas import Fields, RemainderEntry, Segment, additions
from plcopen_sfc.languages.st.lexer import CommentKind, tokenize
from plcopen_sfc.languages.words import take_name
from plcopen_sfc.model.body import FbdBody, IlBody, LdBody, StBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.sfc import SfcBody
from plcopen_sfc.report import Cause, CauseKind, ConversionReport, Outcome

DRAWN = "drawn"
_SHOWN = "shown"
_LONG = 80


def drawn_changes(intended: Fields, shown: str, place: tuple[Segment, ...]) -> list[RemainderEntry]:
    """Pragmas that hold the drawing `intended` of the text at `place`."""
    path = (*place, DRAWN)
    return [RemainderEntry((*path, _SHOWN), _mark(shown)), *additions(intended, path)]


def put_drawing(fields: Fields, field: str) -> bool:
    """Replace the text in `field` by its drawing. False: the text was changed, so the drawing is left out."""
    drawing = fields.pop(DRAWN, None)
    if not isinstance(drawing, dict):
        return True
    mark = drawing.pop(_SHOWN, None)
    found: Fields = fields.get(field) or {}
    read_back: Fields = found.get("body", found)  # a condition may be statements
    if _mark(str(read_back.get("text", read_back.get("name", "")))) != mark:
        return False
    fields[field] = drawing
    return True


def _mark(text: str) -> str:
    """Return the text, or of a long one a digest."""
    return text if len(text) <= _LONG else "#" + hashlib.sha256(text.encode()).hexdigest()[:12]


_CLOSERS = frozenset(k for k in KEYWORDS if k.startswith("END_"))
_OF_HEADS = frozenset({":", "EXTENDS", "IMPLEMENTS"})
_RESERVED = MODIFIERS | {"FROM", "PRIORITY", "WITH", "ON", "EXTENDS", "IMPLEMENTS"}
_FOREIGN_PRAGMA = re.compile(r"\{(?!\s*plcopen_sfc\b)[^{}\x00\r]*\}|\{\{(?:(?!\}\})[^\x00\r])*\}\}")
_WIDE = 160
_APART = frozenset({"extension_data", "drawing", "logic", "settings", "networks", "drawn"})


@dataclass(slots=True)
class TextPrinter:
    """Writes for a dialect and notes the outcome of each item."""

    dialect: Dialect
    report: ConversionReport
    used: set[str] = field(default_factory=set)
    """Names in the POU that is being written, in lower case, which an action in place must not take."""
    actions: frozenset[str] = frozenset()
    """Actions of that POU, in lower case."""
    variables: frozenset[str] = frozenset()
    """Names of all variables of the project, in lower case: an initial value of a string may be one of them."""

    def note(self, outcome: Outcome, what: str, path: str, why: str = "") -> None:
        """Note the outcome of an item."""
        self.report.add(outcome, what, path, why)

    def note_placeholder(self, what: str, path: str, name: str) -> None:
        """Note that an object is not executed, which the undeclared `name` replaces."""
        why = f"no text expresses it; the undeclared name {name} is in its place, so that the text does not compile"
        self.report.add(Outcome.NOT_EXECUTED, what, path, why, Cause(CauseKind.PLACEHOLDER, name))

    def is_name(self, name: str) -> bool:
        """True if `name` can be written as a name: one word that is no keyword."""
        tokens = tokenize(name, self.dialect, KEYWORDS).tokens
        return (
            len(tokens) == 1
            and tokens[0].type == "NAME"
            and tokens[0].span == (0, len(name))
            and re.fullmatch(r"[^\W\d]\w*", name) is not None
            and name.upper() not in _RESERVED
        )

    def new_name(self, wish: str) -> str:
        """Return a name near `wish` that nothing in this POU has."""
        base = re.sub(r"\W+", "_", wish).strip("_") or "Unnamed"
        base = f"_{base}" if base[0].isdigit() else base
        base = base if self.is_name(base) else f"{base}_"
        return take_name(base, self.used)

    def is_expression(self, text: str) -> bool:
        """True if `text` comes back as it is from between ``:=`` and ``;``."""
        if not text or text != text.strip() or "\r" in text or "\x00" in text:
            return False
        found = tokenize(text, self.dialect, KEYWORDS)
        if found.problems or not found.tokens or any(t.type in _CLOSERS or t.type == "SEMICOLON" for t in found.tokens):
            return False
        comments = found.comments
        if any(OWN_PRAGMA.match(c.text) for c in comments):
            return False
        if comments and comments[-1].kind is CommentKind.LINE and comments[-1].span[1] == len(text):
            return False
        return self._stays_loose(f"x := {text};")

    def _stays_loose(self, statements: str) -> bool:
        found = outline(f"PROGRAM x\n{statements}\nEND_PROGRAM\n", self.dialect)
        if found.problems or len(found.parts) != 1 or not found.parts[0].closed:
            return False
        return all(part.kind is PartKind.LOOSE for part in found.parts[0].parts)

    def code(self, text: str) -> tuple[TextBlock, bool]:
        """Return the lines of a body, and True if a reader gets them back unchanged between a header and its END."""
        lines = block(text)
        if "\r" in text or "\x00" in text:
            return lines, False
        source = "\n" + indented(lines.text, "    ") + "\n"
        found = tokenize(lines.text, self.dialect, KEYWORDS)
        if found.problems or any(t.type in _CLOSERS for t in found.tokens) or taken(source) != lines.text:
            return lines, False
        if any(is_own(c) for c in found.comments):
            return lines, False
        if found.tokens and found.tokens[0].value.upper() in _OF_HEADS:  # it would belong to the head before it
            return lines, False
        return lines, self._stays_loose(lines.text)


def missing(printer: TextPrinter, what: str) -> str:
    """Name that is declared nowhere: other tools refuse the text, as there is no correct one for this place."""
    return printer.new_name(f"NOT_EXECUTED_{what}")


EXECUTED = frozenset(
    "min_time interlock supervision macro encloses negated partial_charts permanent_pre permanent_post".split()
)
"""Fields that a controller executes. In pragmas only this package sees them."""


def outcome_of(change: RemainderEntry) -> Outcome:
    """Return the outcome of a field that is in a pragma."""
    fields = [part for part in change.path if isinstance(part, str) and part != "chart"]
    if fields[:1] == ["exclude"]:
        return Outcome.APPROXIMATED
    if isinstance(change.value, dict) and fields[:1] in (["permanent_pre"], ["permanent_post"]):
        body = change.value.get("body") or {}
        return (
            Outcome.NOT_EXECUTED if body.keys() & {"body_of", "networks", "text", "content"} else Outcome.EXTENSION_DATA
        )
    return Outcome.NOT_EXECUTED if fields[:1] and fields[0] in EXECUTED else Outcome.EXTENSION_DATA


def pragma(change: RemainderEntry) -> str:
    """Return a pragma for a change."""
    return f"{{plcopen_sfc {change}}}"


def pragmas(changes: Iterable[RemainderEntry], indent: str) -> str:
    """Pragmas, one on a line."""
    return "".join(f"{indent}{pragma(change)}\n" for change in changes)


def split(found: Iterable[RemainderEntry]) -> tuple[list[RemainderEntry], list[RemainderEntry]]:
    """Changes to write beside an object, and those for the end of its unit: foreign data, which no person reads.

    The items of one list stay together.
    """
    every = list(found)
    apart = {_group(change) for change in every if _is_big(change)}
    near = [change for change in every if _group(change) not in apart]
    return near, [change for change in every if _group(change) in apart]


def _is_big(change: RemainderEntry) -> bool:
    return not _APART.isdisjoint(change.path) or len(str(change)) > _WIDE


def _group(change: RemainderEntry) -> tuple[object, ...]:
    for index, segment in enumerate(change.path):
        if not isinstance(segment, str):
            return change.path[:index]
    return change.path


def label(change: RemainderEntry) -> str:
    """Return the name of a change in reports."""
    return "foreign data" if "extension_data" in change.path else str(change.path[0]).replace("_", " ")


def note_changes(printer: TextPrinter, found: Iterable[RemainderEntry], path: str, *, leave: Collection[str]) -> None:
    """Report each field of the object at `path` that only pragmas hold, once, but for the fields `leave`."""
    read_back = dict.fromkeys(
        (outcome_of(change), label(change)) for change in found if str(change.path[0]) not in leave
    )
    for outcome, what in read_back:
        printer.note(outcome, what, path, "IEC text has no place for it")


def comment_lines(fields: Fields, read_back: Fields, indent: str) -> str:
    """Return the comment in `fields` as lines of its own, if it can be a comment; `read_back` gets it then."""
    text = fields.get("comment")
    shown = format_comment(text, indent) if isinstance(text, str) else None
    if shown is None:
        return ""
    read_back["comment"] = text
    return f"{indent}{shown}\n"


def foreign_pragmas(fields: Fields, read_back: Fields, indent: str) -> str:
    """Pragmas of other tools that were read from a text."""
    lines = ""
    for place, text, data in kept_texts(fields):
        if place != "pragma" or not _FOREIGN_PRAGMA.fullmatch(text):
            break
        lines += f"{indent}{text}\n"
        keep_data(read_back, data)
    return lines


def is_text_body(thing: BaseModel) -> bool:
    """True if `thing` is a body that can be in an action."""
    return isinstance(thing, StBody | IlBody | SfcBody | FbdBody | LdBody)


def is_lifted_body(thing: BaseModel) -> bool:
    """True if `thing` is a body that is written as an action: not one without networks, which no drawing shows."""
    return is_text_body(thing) and not (isinstance(thing, FbdBody | LdBody) and not thing.networks)
