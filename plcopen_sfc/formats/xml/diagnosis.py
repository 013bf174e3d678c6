"""Why a file is not well-formed XML, in words that help.

libxml2 says "Premature end of data in tag x line 3" or "Start tag expected, '<' not found". Here the same file is
looked at once more, slowly and only after a failure: is it XML at all, does it break off, are two tags crossed?
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from plcopen_sfc.errors import Location, XmlSyntaxError

if TYPE_CHECKING:
    from lxml import etree

__all__ = ["Problem", "explain_syntax_error", "not_xml"]


@dataclass(frozen=True, slots=True)
class Problem:
    """What is wrong and what to do."""

    message: str
    hint: str


_SIGNATURES = (
    (b"PK\x03\x04", "a ZIP archive", "Unpack it and read the XML file inside."),
    (b"PK\x05\x06", "an empty ZIP archive", ""),
    (b"\x1f\x8b", "a gzip archive", "Unpack it and read the XML file inside."),
    (b"7z\xbc\xaf\x27\x1c", "a 7z archive", "Unpack it and read the XML file inside."),
    (b"\x89PNG\r\n", "a PNG picture", ""),
    (b"\xff\xd8\xff", "a JPEG picture", ""),
    (b"GIF8", "a GIF picture", ""),
    (b"%PDF-", "a PDF document", ""),
    (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "a binary OLE document", "Export it as XML from the tool that wrote it."),
    (b"SQLite format 3\0", "an SQLite database", ""),
    (b"MZ", "a Windows program", ""),
    (b"\x7fELF", "a Linux program", ""),
)
_EXPORT = "Export the project or object as XML from the tool that wrote it."
_LEADING = (b"\xef\xbb\xbf", b"\xff\xfe\0\0", b"\0\0\xfe\xff", b"\xff\xfe", b"\xfe\xff")


def not_xml(data: bytes) -> Problem | None:
    """What the bytes are, if they are clearly no XML; None if they may be."""
    if not data:
        return Problem("the file is empty", _EXPORT)
    head = data[:4096]
    for mark in _LEADING:
        head = head.removeprefix(mark)
    start = head.replace(b"\0", b"").lstrip()
    if start.startswith(b"<"):
        return Problem("this is an HTML page, not XML", _EXPORT) if _is_html(start) else None
    if not start:
        # Only the head may be blank; the parser looks at the rest.
        blank = not data.strip(b" \t\r\n\0\xef\xbb\xbf\xff\xfe")
        return Problem("the file holds nothing but blanks", _EXPORT) if blank else None
    for signature, name, hint in _SIGNATURES:
        if data.startswith(signature) and (signature != b"MZ" or b"\0" in head):
            return Problem(f"this is {name}, not XML", hint or _EXPORT)
    if start[:1] in b"{[" and re.match(rb'[{\[]\s*(?:["{}\[\]\d-]|true|false|null)', start):
        return Problem("this is JSON, not XML", _EXPORT)
    text = _printable(start)
    if text is None:
        return Problem("this is binary data, not XML", _EXPORT)
    return Problem(f"this is plain text, not XML: it begins with {text!r}", _EXPORT)


def _is_html(start: bytes) -> bool:
    return re.match(rb"<(?:!doctype\s+html\b|html\b(?![^>]*xmlns))", start, re.IGNORECASE) is not None


def _printable(start: bytes) -> str | None:
    """The first words of a text; None for what is no text."""
    if re.search(rb"[\0-\x08\x0e-\x1a\x1c-\x1f]", start):
        return None
    text = start.decode("utf-8", "replace") if b"\xc3" in start else start.decode("cp1252", "replace")
    line = text.splitlines()[0]
    return line if len(line) <= 40 else line[:37] + "..."


_TOKENS = re.compile(
    r"""<!--.*?-->|<!\[CDATA\[.*?\]\]>|<\?.*?\?>|</(?P<close>[^\s<>]*)\s*>"""
    r"""|<(?P<open>[^\s<>!?/"'=]++)[^<>"']*+(?:"[^"<]*"[^<>"']*+|'[^'<]*'[^<>"']*+)*+>|(?P<broken><)""",
    re.DOTALL,
)
_PROLOG_ONLY = re.compile(r"(?:\s++|<\?.*?\?>|<!--.*?-->)*+\Z", re.DOTALL)
_TRUNCATED = "The file breaks off: export or copy it again."


def explain_syntax_error(plain: bytes, error: etree.XMLSyntaxError, file: str | None) -> XmlSyntaxError:
    """The error of libxml2 about `plain` (UTF-8) in clearer words, with the place."""
    line, column = error.lineno or 1, max(error.position[1] or 1, 1)
    message = re.sub(r",? ?line \d+, column \d+.*$", "", error.msg or "not well-formed").strip()
    text = plain.decode("utf-8", "replace").removeprefix("\ufeff")
    if message.startswith(("XML or text declaration not at start", "XML declaration allowed only")):
        return XmlSyntaxError(
            "something stands before the XML declaration (<?xml ...?>)",
            location=Location(file, line, column),
            hint="Remove blanks, blank lines or other text before it.",
        )
    if message.startswith("Start tag expected") and _PROLOG_ONLY.match(text):
        return XmlSyntaxError("the file has no element", location=Location(file, line, column), hint=_TRUNCATED)
    found = _open_at(text, line)
    if found is not None:
        return XmlSyntaxError(found[0], location=Location(file, *_place(text, found[1])), hint=found[2])
    return XmlSyntaxError(
        f"not well-formed XML: {message}",
        location=Location(file, line, column),
        hint="Look at this line; if the file was edited by hand or merged, the damage is there.",
    )


def _open_at(text: str, error_line: int) -> tuple[str, int, str] | None:
    """A file that breaks off, or a wrong end tag: (message, position, hint); None where it is something else."""
    stack: list[tuple[str, int]] = []
    for token in _TOKENS.finditer(text):
        kind = token.lastgroup
        if kind == "open":
            if text[token.end() - 2] != "/":
                stack.append((token["open"], token.start()))
        elif kind == "close":
            name = token["close"]
            if not stack:
                return None
            opened, position = stack.pop()
            if opened != name:
                line, _ = _place(text, position)
                message = f"element <{opened}>, opened at line {line}, is closed by </{name}>"
                return message, token.start(), "An end tag is missing or misspelt between these two places."
        elif kind == "broken":
            return _broken(text, token.start(), stack)
    if stack:
        name, position = stack[-1]
        # A second problem further up would be the real one; the parser stops at the first.
        if error_line < text.count("\n", 0, len(text.rstrip())) + 1:
            return None
        line, _ = _place(text, position)
        return f"the file ends in the middle of element <{name}>, opened at line {line}", len(text), _TRUNCATED
    return None


def _broken(text: str, position: int, stack: list[tuple[str, int]]) -> tuple[str, int, str] | None:
    """A `<` that begins nothing complete: the end of a truncated file, if nothing complete follows."""
    rest = text[position:]
    if rest.startswith(("<!--", "<![CDATA[", "<?")) or "<" not in rest[1:]:
        kinds = (("<!--", "a comment"), ("<![CDATA[", "a CDATA section"), ("<?", "a processing instruction"))
        what = next((name for start, name in kinds if rest.startswith(start)), "a tag")
        place = ""
        if stack:
            line, _ = _place(text, stack[-1][1])
            place = f", in the middle of element <{stack[-1][0]}>, opened at line {line}"
        begun, _ = _place(text, position)
        return f"the file ends inside {what} begun at line {begun}{place}", len(text), _TRUNCATED
    return None


def _place(text: str, position: int) -> tuple[int, int]:
    """Line and column of a position, both from 1."""
    return text.count("\n", 0, position) + 1, position - text.rfind("\n", 0, position)
