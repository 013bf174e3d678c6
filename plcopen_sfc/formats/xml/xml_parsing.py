"""XML files from bytes to a tree: encodings, the parser with its limits, and clear words for files that are no XML.

PLC projects come from everywhere, so a file is untrusted input. Three things make reading it safe and still as fast as
libxml2 itself:

* Only the document type declaration, before the root element, can declare entities or name other files. The reader
  looks at those few bytes and refuses a file that declares any before the parser sees it.
* libxml2 parses with its own limits on (nesting of 256, ten million characters in one text). Only a file that breaks
  the text limit is parsed a second time without limits, after a count of its nesting.
* Python decodes what is not UTF-8, and the parser gets UTF-8, so that both see the same characters. UTF-8 (nearly all
  files) goes to the parser as it is.

libxml2 calls errors "Premature end of data in tag x line 3" or "Start tag expected, '<' not found". After a failure,
and only then, the file is looked at once more, slowly: is it XML at all, does it break off, are two tags crossed?
"""

from __future__ import annotations

import codecs
import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, NamedTuple, cast
from xml.parsers import expat

from lxml import etree

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import EncodingError, FormatError, Location, UnsafeXmlError, XmlSyntaxError
from plcopen_sfc.object_path import ObjectPath

MAX_DEPTH = 256
"""Deepest nesting accepted: libxml2's own limit. Real exports stay below 50; recursive readers need some bound."""
MAX_ATTRIBUTES = 1000
"""Most attributes of an element: to read them all takes libxml2 the square of their number."""


_BOMS = (
    (codecs.BOM_UTF32_LE, "utf-32-le"),  # before UTF-16: its mark begins like theirs
    (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
_UNMARKED = (
    (b"<\0\0\0", "utf-32-le"),
    (b"\0\0\0<", "utf-32-be"),
    (b"<\0", "utf-16-le"),
    (b"\0<", "utf-16-be"),
)
_DECLARATION = re.compile(r"""<\?xml\s[^>]*?\sencoding\s*=\s*(?:"([^"<>]*)"|'([^'<>]*)')""")
# Python codecs that are no character sets of files, or decode in quadratic time.
_NO_CHARSETS = frozenset({"utf-7", "idna", "punycode", "unicode-escape", "raw-unicode-escape", "undefined"})
_DECLARATION_LIMIT = 1024
_TEXT_LIMIT = 10_000_000  # of libxml2, for one text
_WIDE = re.compile("utf-(?:16|32)|ucs-?[24]", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Encoding:
    """Encoding of the characters of a file: Python's codec, the byte order mark, and what the file declares."""

    codec: str
    bom: bytes = b""
    declared: str | None = None

    def encode(self, text: str) -> bytes:
        """Return `text` as bytes of the file, byte order mark included; raises `UnicodeEncodeError`."""
        return self.bom + text.encode(self.codec)

    def is_reversible(self, text: str, data: bytes) -> bool:
        """True if `text`, which was decoded from `data`, would be written as it was; some codecs do not do that."""
        return self.codec == "utf-8" or self.encode(text) == data

    def positions(self, text: str, places: Iterable[int]) -> Iterator[int]:
        """Yield where rising `places` of `text`, each beside a tag, are in the bytes of the file."""
        start, offset = 0, len(self.bom)
        is_same = text.isascii() and self.codec == "utf-8"
        for place in places:
            offset += place - start if is_same else len(text[start:place].encode(self.codec))
            start = place
            yield offset


def detect_encoding(data: bytes, *, file: str | None = None) -> Encoding:
    """Return the encoding of an XML file, from its byte order mark, its first bytes and its XML declaration.

    Raises `EncodingError` where the three contradict each other or the declared encoding is unknown.
    """
    bom, codec = next(((mark, name) for mark, name in _BOMS if data.startswith(mark)), (b"", ""))
    if not codec:
        codec = next((name for start, name in _UNMARKED if data.startswith(start)), "")
    head = data[len(bom) : len(bom) + _DECLARATION_LIMIT].decode(codec or "latin-1", "replace")
    found = _DECLARATION.match(head)
    declared = (found[1] if found[1] is not None else found[2]) if found else None
    if declared is None:
        return Encoding(codec or "utf-8", bom)
    named = _codec_of(declared, file)
    if codec:
        _check_mark(codec, named, declared, bom, file)
        return Encoding(codec, bom, declared)
    if _WIDE.match(named):
        raise EncodingError(
            f'the file declares encoding="{declared}", but its bytes are not {declared.upper()}',
            location=Location(file, 1, 1),
            hint="Its first bytes are those of an 8-bit encoding: most likely the declaration should be utf-8.",
        )
    return Encoding(named, bom, declared)


def _codec_of(declared: str, file: str | None) -> str:
    try:
        codec = codecs.lookup(declared).name
        "".encode(codec)  # refuses codecs that do not turn text into bytes, such as base64
    except (LookupError, ValueError):
        codec = "undefined"
    if codec.replace("_", "-") in _NO_CHARSETS:
        raise EncodingError(
            f'the file declares encoding="{declared}", which is not known',
            location=Location(file, 1, 1),
            hint="Save the file as UTF-8.",
        )
    return codec


def _check_mark(codec: str, named: str, declared: str, bom: bytes, file: str | None) -> None:
    """The byte order mark and the declaration must not contradict each other in the width of the characters."""
    if named == codec or codec.startswith(named):
        return
    what = "byte order mark" if bom else "bytes"
    raise EncodingError(
        f'the file declares encoding="{declared}", but by its {what} it is {codec.upper()}',
        location=Location(file, 1, 1),
        hint=f'Change the declaration to encoding="{codec.removesuffix("-le").removesuffix("-be")}".',
    )


def decode_xml(data: bytes, *, file: str | None = None) -> tuple[str, Encoding]:
    """Return the characters of an XML file (without byte order mark, line ends as they are) and its encoding.

    Raises `EncodingError`, with the byte offset, where the bytes are not in the encoding of the file.
    """
    encoding = detect_encoding(data, file=file)
    try:
        return str(memoryview(data)[len(encoding.bom) :], encoding.codec), encoding
    except UnicodeDecodeError as error:
        raise _wrong_bytes(data, encoding, error, file) from error


def _wrong_bytes(data: bytes, encoding: Encoding, error: UnicodeDecodeError, file: str | None) -> EncodingError:
    offset = error.start + len(encoding.bom)
    before = data[len(encoding.bom) : offset].decode(encoding.codec, "replace")
    line = before.count("\n") + 1
    column = len(before) - before.rfind("\n")
    source = f'declares encoding="{encoding.declared}"' if encoding.declared else f"is read as {encoding.codec.upper()}"
    wrong = data[offset : offset + max(1, error.end - error.start)].hex(" ")
    hint = "Save the file again in the encoding that it declares."
    if encoding.codec in {"utf-8", "ascii"}:
        hint = "Most likely the file is in a Windows code page: declare that (windows-1252), or save it as UTF-8."
    return EncodingError(
        f"the file {source}, but at byte offset {offset} ({wrong}) it is not: {error.reason}",
        location=Location(file, line, column),
        hint=hint,
    )


def parse_xml(data: bytes, *, file: str | None = None) -> etree._Element:
    """Return the root element of an XML file.

    Line numbers are in `sourceline`, which libxml2 keeps exactly up to line 65534; use `SourceLines` for longer files.
    Comments, processing instructions and CDATA marks are kept.

    Raises `EncodingError`, `UnsafeXmlError`, or `XmlSyntaxError` for what is not well-formed, or not XML at all.
    """
    if problem := not_xml(data):
        raise XmlSyntaxError(problem.message, location=Location(file, 1, 1), hint=problem.hint)
    plain = _as_utf8(data, file)
    _refuse_entities(plain, file)
    refused: etree.XMLSyntaxError | None = None
    try:
        root = etree.fromstring(plain, _parser())
    except etree.XMLSyntaxError as error:
        # what is raised for it has no context: Dask pickles the context of an error, and this one cannot be pickled
        refused = error
    if refused is not None:
        root = _second_try(data, plain, refused, file)
    _refuse_declared_entities(root, file)
    if _may_have_many_attributes(plain):
        _refuse_many_attributes(root, file)
    return root


class BrokenXml(NamedTuple):
    """What comes before the place at which a file is no XML any more: its root, and the elements that are not whole."""

    root: etree._Element
    begun: frozenset[etree._Element]


def parse_broken_xml(data: bytes, *, file: str | None = None) -> BrokenXml | None:
    """Return what `parse_xml` would have read of a file that it refuses as `XmlSyntaxError`; None: not even its root.

    Raises `EncodingError` and `UnsafeXmlError`, too.
    """
    plain = _as_utf8(data, file)
    _refuse_entities(plain, file)
    parser = etree.XMLPullParser(("start", "end"), **_RULES)
    with suppress(etree.XMLSyntaxError):
        parser.feed(plain)
        parser.close()
    root: etree._Element | None = None
    begun: list[etree._Element] = []
    for event, element in cast("Iterator[tuple[str, etree._Element]]", parser.read_events()):
        root = element if root is None else root
        if event == "start":
            begun.append(element)
        else:
            begun.pop()
    if root is None:
        return None
    _refuse_declared_entities(root, file)
    return BrokenXml(root, frozenset(begun))


def _as_utf8(data: bytes, file: str | None) -> bytes:
    if detect_encoding(data, file=file).codec == "utf-8":
        return data
    text, _ = decode_xml(data, file=file)
    return text.encode("utf-8", "surrogatepass")


# The encoding is given: the declaration was checked, and here everything is UTF-8.
_RULES: Any = {
    "encoding": "utf-8",
    "resolve_entities": False,
    "no_network": True,
    "load_dtd": False,
    "strip_cdata": False,
}


def _parser(*, huge: bool = False) -> etree.XMLParser:
    return etree.XMLParser(huge_tree=huge, **_RULES)


def _second_try(data: bytes, plain: bytes, error: etree.XMLSyntaxError, file: str | None) -> etree._Element:
    """Parse once more without libxml2's size limits where one of them was the reason; otherwise explain the error."""
    _refuse_without_memory(error)
    if "depth" in (error.msg or "").lower():
        raise _too_deep(file, error.lineno)
    again = len(plain) > _TEXT_LIMIT
    if again:
        _check_depth(plain, file)
    decode_xml(data, file=file)  # wrong bytes are a clearer answer than the words of the parser for them
    if again:
        try:
            return etree.fromstring(plain, _parser(huge=True))
        except etree.XMLSyntaxError as second:
            error = second
            _refuse_without_memory(error)
    raise explain_syntax_error(plain, error, file)


def _refuse_without_memory(error: etree.XMLSyntaxError) -> None:
    """Raise `MemoryError` where the parser failed for the lack of memory, which it calls a syntax error."""
    if getattr(error, "code", None) == etree.ErrorTypes.ERR_NO_MEMORY:  # its stubs lack the attribute
        raise MemoryError


def _too_deep(file: str | None, line: int | None) -> UnsafeXmlError:
    return UnsafeXmlError(
        f"elements are nested deeper than {MAX_DEPTH} levels",
        location=Location(file, line),
        hint="No PLC tool writes such a file; it is damaged or made to exhaust the reader.",
    )


def _check_depth(plain: bytes, file: str | None) -> None:
    """Refuse nesting beyond `MAX_DEPTH`, without building anything. Syntax errors are left to the real parser."""
    depth = 0
    counter = expat.ParserCreate("utf-8")

    def start(_name: str, _attributes: object) -> None:
        nonlocal depth
        depth += 1
        if depth > MAX_DEPTH:
            raise _too_deep(file, counter.CurrentLineNumber)

    def end(_name: str) -> None:
        nonlocal depth
        depth -= 1

    counter.StartElementHandler = start
    counter.EndElementHandler = end
    try:
        counter.Parse(plain, True)
    except expat.ExpatError:
        return


def _may_have_many_attributes(plain: bytes) -> bool:
    """True if an element may have more than `MAX_ATTRIBUTES`: a look at each would take as long as to parse them."""
    least = MAX_ATTRIBUTES * len(' a=""')
    start = plain.find(b"<")
    while 0 <= start < len(plain) - least:
        following = plain.rfind(b"<", start + 1, start + least)
        if following < 0:
            following = plain.find(b"<", start + least)
            end = following if following >= 0 else len(plain)
            if plain.count(b'"', start, end) + plain.count(b"'", start, end) > 2 * MAX_ATTRIBUTES:
                return True
        start = following
    return False


def _refuse_many_attributes(root: etree._Element, file: str | None) -> None:
    for element in root.iter(etree.Element):
        if len(element.attrib) > MAX_ATTRIBUTES:
            raise UnsafeXmlError(
                f"an element has more than {MAX_ATTRIBUTES} attributes",
                location=Location(file, line_of(element)),
                hint="No PLC tool writes such a file; it is damaged or made to exhaust the reader.",
            )


_PROLOG = re.compile(rb"(?:\xef\xbb\xbf)?(?:\s++|<\?.*?\?>|<!--.*?-->)*+(?:(<!DOCTYPE)|)", re.DOTALL)
# An unclosed part runs to the end, so that no part of the file is looked at twice.
_DOCTYPE_PART = re.compile(
    rb"""<!--.*?(?:-->|\Z)|<\?.*?(?:\?>|\Z)|"[^"]*(?:"|\Z)|'[^']*(?:'|\Z)|\[|\]|>|<!ENTITY|%|\b(?:SYSTEM|PUBLIC)\b""",
    re.DOTALL,
)


def _refuse_entities(plain: bytes, file: str | None) -> None:
    """Refuse a document type declaration that declares entities or points outside the file."""
    prolog = _PROLOG.match(plain)
    if prolog is None or prolog[1] is None:
        return
    line = plain.count(b"\n", 0, prolog.start(1)) + 1
    inside = False
    for part in _DOCTYPE_PART.finditer(plain, prolog.end()):
        token = part[0]
        if token in {b"SYSTEM", b"PUBLIC"}:
            raise _unsafe("points to another file (SYSTEM or PUBLIC)", file, line)
        if token in {b"<!ENTITY", b"%"}:
            raise _unsafe("declares entities", file, line)
        if token == b"[":
            inside = True
        elif token == b"]":
            inside = False
        elif token == b">" and not inside:
            return


def _refuse_declared_entities(root: etree._Element, file: str | None) -> None:
    """The same check on what the parser saw: holds even if the look at the bytes missed something."""
    dtd: Any = root.getroottree().docinfo.internalDTD  # its properties are missing in lxml-stubs
    if dtd is not None and (dtd.system_url or dtd.external_id or any(True for _ in dtd.iterentities())):
        raise _unsafe("declares entities or points to another file", file, 1)


def _unsafe(what: str, file: str | None, line: int) -> FormatError:
    return UnsafeXmlError(
        f"the document type declaration (<!DOCTYPE) {what}",
        location=Location(file, line),
        hint="No PLC tool writes that. Remove the declaration if you trust the file.",
    )


_TAGS = re.compile(
    rb"""<!--.*?-->|<!\[CDATA\[.*?\]\]>|<\?.*?\?>|<!DOCTYPE(?:[^\[>"']|"[^"]*"|'[^']*'|\[.*?\]\s*(?=>))*>"""
    rb"""|</[^>]*>|(<)[^>"']*+(?:"[^"]*"[^>"']*+|'[^']*'[^>"']*+)*+>""",
    re.DOTALL,
)
_LAST_EXACT_LINE = 65534
_NUMBERED = re.compile(r"&#(?!(?:0*(?:9|10|13|34|38|39)|x0*(?:9|[AaDd]|2[267]));)")
"""A character that is written as its number, but for line ends, tabs and those that mark XML."""


def line_of(element: etree._Element) -> int | None:
    """Return the line of `element` in its file; beyond 65,535 lines it is off by a few (`SourceLines`)."""
    return cast("int | None", element.sourceline)


class SourceLines:
    """Line numbers of elements, right in files of any length.

    libxml2 keeps 16 bits a node; beyond that `sourceline` is guessed from neighbours and is off by a few lines. Up to
    there this asks `sourceline`; beyond, it counts once through the file. Like `sourceline`, the line is the one on
    which the start tag ends. The object keeps the tree alive: hold it while reading only.
    """

    def __init__(self, root: etree._Element, data: bytes) -> None:
        self._root = root
        self._data = data
        self._table: dict[etree._Element, int] | None = None

    def line(self, element: etree._Element) -> int | None:
        """Return the line of `element`, counting from 1; None for an element that was not read from a file."""
        line = cast("int | None", element.sourceline)
        if line is None or line <= _LAST_EXACT_LINE:
            return line
        if self._table is None:
            self._table = self._filled()
        return self._table.get(element, line)

    def may_have(self, is_in: Callable[[str], bool]) -> bool:
        """False if `is_in` is so for all text of the file: as it is written, and without markup inside of words."""
        text, _ = decode_xml(self._data)
        if _NUMBERED.search(text) or is_in(text):
            return True
        return is_in(str(etree.tostring(self._root, encoding="unicode", method="text")))

    def _filled(self) -> dict[etree._Element, int]:
        table: dict[etree._Element, int] = {}
        text, encoding = decode_xml(self._data)
        plain = self._data[len(encoding.bom) :] if encoding.codec == "utf-8" else text.encode("utf-8")
        elements = self._root.iter(etree.Element)
        line, counted = 1, 0
        for tag in _TAGS.finditer(plain):
            if tag[1] is None:
                continue
            end = tag.end()
            line += plain.count(b"\n", counted, end)
            counted = end
            element = next(elements, None)
            if element is None:
                break
            if line > _LAST_EXACT_LINE:
                table[element] = line
        return table


class ElementReading:
    """State of reading the elements of one file: the findings so far, and the place of the one being read."""

    def __init__(self, file: str | None, lines: SourceLines | None) -> None:
        self.file = file
        self.lines = lines
        self.diagnostics: list[Diagnostic] = []
        self.place: list[str] = []
        """Names of the objects around the one being read, for messages."""

    def report(self, code: str, severity: Severity, message: str, element: etree._Element, subject: str = "") -> None:
        """Add a finding about `element` of the file."""
        line = self.lines.line(element) if self.lines is not None else line_of(element)
        location = Location(self.file, line, None, ObjectPath(*self.place, subject) or None)
        self.diagnostics.append(Diagnostic(code, severity, message, location))

    def warn(self, code: str, message: str, element: etree._Element, subject: str = "") -> None:
        """Report a warning."""
        self.report(code, Severity.WARNING, message, element, subject)

    def error(self, code: str, message: str, element: etree._Element) -> None:
        """Report an error that does not keep the file from being loaded."""
        self.report(code, Severity.ERROR, message, element)


@dataclass(frozen=True, slots=True)
class XmlProblem:
    """An error and what to do."""

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
_AGAIN = "Export the project or object again from the tool that wrote it."
_LEADING = (b"\xef\xbb\xbf", b"\xff\xfe\0\0", b"\0\0\xfe\xff", b"\xff\xfe", b"\xfe\xff")


def not_xml(data: bytes) -> XmlProblem | None:
    """Return the problem of bytes that are clearly no XML; None if they may be."""
    if not data:
        return XmlProblem("the file is empty", _AGAIN)
    head = data[:4096]
    for mark in _LEADING:
        head = head.removeprefix(mark)
    start = head.replace(b"\0", b"").lstrip()
    if start.startswith(b"<"):
        return XmlProblem("this is an HTML page, not XML", _EXPORT) if _is_html(start) else None
    if not start:
        # Only the head may be blank; the parser looks at the rest.
        blank = not data.strip(b" \t\r\n\0\xef\xbb\xbf\xff\xfe")
        return XmlProblem("the file holds nothing but blanks", _AGAIN) if blank else None
    for signature, name, hint in _SIGNATURES:
        if data.startswith(signature) and (signature != b"MZ" or b"\0" in head):
            return XmlProblem(f"this is {name}, not XML", hint or _EXPORT)
    if start[:1] in b"{[" and re.match(rb'[{\[]\s*(?:["{}\[\]\d-]|true|false|null)', start):
        return XmlProblem("this is JSON, not XML", _EXPORT)
    text = _printable(start)
    if text is None:
        return XmlProblem("this is binary data, not XML", _EXPORT)
    return XmlProblem(f"this is plain text, not XML: it begins with {text!r}", _EXPORT)


def _is_html(start: bytes) -> bool:
    return re.match(rb"<(?:!doctype\s+html\b|html\b(?![^>]*xmlns))", start, re.IGNORECASE) is not None


def _printable(start: bytes) -> str | None:
    """Return the first words of a text; None for what is no text."""
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
    """Return the error of libxml2 about `plain` (UTF-8) in clearer words, with the place."""
    line, column = error.lineno or 1, max(error.position[1] or 1, 1)
    message = re.sub(r",? ?line \d+, column \d+.*$", "", error.msg or "not well-formed").strip()
    text = plain.decode("utf-8", "replace").removeprefix("\ufeff")
    if message.startswith(("XML or text declaration not at start", "XML declaration allowed only")):
        return XmlSyntaxError(
            "there is something before the XML declaration (<?xml ...?>)",
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
    """Return a file that breaks off, or a wrong end tag: (message, position, hint); None where it is something else."""
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
    """Return a `<` that begins nothing complete: the end of a truncated file, if nothing complete follows."""
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
    """Return line and column of a position, both from 1."""
    return text.count("\n", 0, position) + 1, position - text.rfind("\n", 0, position)
