"""Symbol tables of STEP 7 V5 (``sdf``, the system data format of its symbol editor) as tables of TIA tags.

Each line is a symbol: its name, address, type and comment, in quotation marks with commas between. STEP 7 fills the
cells up with blanks. Symbols of blocks and of the periphery are no tags in TIA Portal; their lines are kept.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import Location
from plcopen_sfc.formats.format_interface import ReadResult, WriteOptions
from plcopen_sfc.formats.text_codec import TextCodec
from plcopen_sfc.formats.text_encoding import SourceText
from plcopen_sfc.formats.text_patch import BlockSpan, Place, WrittenBlock, block_span, numbered_blocks
from plcopen_sfc.languages.declarations import write_type
from plcopen_sfc.languages.declarations.kept_texts import keep, kept
from plcopen_sfc.languages.translation.literal_translation import translated_address
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.project import Project, Tag, TagTable
from plcopen_sfc.model.text import MultilingualText, plain
from plcopen_sfc.report import Cause, CauseKind, ConversionReport, Outcome

_GERMAN = {"I": "E", "Q": "A", "C": "Z"}
_INTERNATIONAL = {german: area for area, german in _GERMAN.items()}
_BIT_OR_WORD = r"([EAIQM])[ \t]*(?:([BWD])[ \t]*(\d+)|X?[ \t]*(\d+)\.([0-7]))"
_OPERAND = re.compile(rf"{_BIT_OR_WORD}|([TZC])[ \t]*(\d+)", re.IGNORECASE)
_OTHER = re.compile(
    r"(?:FB|FC|OB|DB|SFB|SFC|UDT|VAT)[ \t]*\d+|P[EAIQ][BWD]?[ \t]*\d+(?:\.[0-7])?",
    re.IGNORECASE,
)


def is_operand(text: str) -> bool:
    """Return True if a text is an address of a symbol: also that of a block, or of the periphery."""
    return _OPERAND.fullmatch(text) is not None or _OTHER.fullmatch(text) is not None


def is_german(text: str) -> bool:
    """Return True if an address is in German mnemonics (E, A, Z)."""
    return re.match(r"P?[EAZ]", text, re.IGNORECASE) is not None


def tag_address(text: str) -> str | None:
    """Return the address of a TIA tag; None for what is none, such as a block."""
    found = _OPERAND.fullmatch(text)
    if found is None:
        return None
    area, width, first, byte, bit, block, number = found.groups()
    area = (area or block).upper()
    area = _INTERNATIONAL.get(area, area)
    if block:
        return f"%{area}{number}"
    return f"%{area}{width.upper()}{first}" if width else f"%{area}{byte}.{bit}"


def with_mnemonics(text: str, *, german: bool) -> str:
    """Return the address of a symbol of the periphery in these mnemonics; any other one as it is."""
    found = re.match(r"(P)([EAIQ])", text, re.IGNORECASE)
    if found is None or _OTHER.fullmatch(text.rstrip()) is None:
        return text
    area = _INTERNATIONAL.get(found[2].upper(), found[2].upper())
    return f"P{_GERMAN[area] if german else area}{text[found.end() :]}"


def operand(address: str, *, german: bool) -> str | None:
    """Return the address of a symbol; None where STEP 7 V5 has none for that of a tag, such as ``%IW4:P``."""
    known = tag_address(address.strip().removeprefix("%"))
    if known is None:
        return None
    area, rest = known[1], known[2:]
    width = rest[0] if rest[0] in "BWD" else ""
    return f"{_GERMAN.get(area, area) if german else area}{width} {rest.removeprefix(width)}"


LINE = re.compile(
    r'[ \t]*"(?P<symbol>[^"\r\n]*)"[ \t]*,[ \t]*"?(?P<address>[^",\r\n]*)"[ \t]*,'
    r'[ \t]*"?(?P<type>[^",\r\n]*)"(?:[ \t]*,[ \t]*"(?P<comment>[^\r\n]*)")?[ \t]*(?:\Z|(?=[\r\n]))'
)
"""A symbol. The manual has an example that lacks an opening quotation mark."""
_CODE_PAGE = "cp1252"
TABLE = "Symbols"
"""Name of the table that a file is: it has none itself."""
_WIDTHS = (24, 12, 10, 80)
"""So wide the cells are in files of STEP 7."""
_TYPES = {
    word.upper(): word
    for word in (
        *("Bool", "Byte", "Word", "DWord", "Int", "DInt", "Real", "Char", "Time", "S5Time", "Date", "Time_Of_Day"),
        *("Timer", "Counter"),
    )
}
_NO_PLACE = "a symbol table has symbols with an address, and no program"


@dataclass
class _Found:
    """A file that was read: its table, the places of its lines, and findings."""

    table: TagTable = field(default_factory=lambda: TagTable(name=TABLE))
    places: list[Place] = field(default_factory=list)
    diagnostics: list[Diagnostic] = field(default_factory=list)


def _read(source: SourceText, file: str | None = None) -> _Found:
    found, others = _Found(), dict[str, str]()
    if source.guessed:
        message = f"the file has no byte order mark and is not in UTF-8; taken as {source.encoding}, which is a guess"
        found.diagnostics.append(Diagnostic("SDF201", Severity.INFO, message, Location(file, 1)))
    for number, line in enumerate(re.finditer(r"[^\r\n]+", source.text), 1):
        if not line.group().strip("\ufeff \t\x1a"):
            continue
        symbol = LINE.fullmatch(line.group().removeprefix("\ufeff"))
        start = line.start() + line.group().startswith("\ufeff")
        address = symbol["address"].strip() if symbol is not None else ""
        if symbol is None or (symbol["symbol"].strip() and not is_operand(address)):
            message = f"{line.group()[:60]!r} is no symbol" if symbol is None else f"{address!r} is no address"
            found.diagnostics.append(Diagnostic("SDF101", Severity.ERROR, message, Location(file, number)))
        located = tag_address(address)
        if symbol is None or located is None:
            name = f"line{len(others) + 1}"
            others[name] = line.group().removeprefix("\ufeff")
            found.places.append((("other", name), (start, line.end()), ()))
            continue
        word = symbol["type"].strip()
        comment = (symbol["comment"] or "").rstrip() or None
        tag = Tag(name=symbol["symbol"].strip(), type=_TYPES.get(word.upper(), word), address=located, comment=comment)
        found.table.tags.append(tag)
        found.places.append((("tag", tag.name), (start, line.end()), ()))
    found.table.extension_data = keep(others)
    return found


class SdfCodec(TextCodec):
    """Symbol tables; `german`: new addresses are in German mnemonics."""

    encoding = _CODE_PAGE  # `_Writer` reports what it does not have
    newline = "\r\n"

    def __init__(self, *, german: bool = False) -> None:
        self._german = german

    def for_version(self, version: str) -> SdfCodec:
        """Return the codec for mnemonics that were asked for."""
        return SdfCodec(german=version == "german")

    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        """Read a file. A line that is no symbol is kept and reported."""
        found = _read(self.decode(data), file)
        german = self._is_german(data)
        # comments have no language; those beside German mnemonics are taken for German, a guess
        language = "de-DE" if german else None
        project = Project(dialect=Dialect.SCL, tag_tables=[found.table], language=language)
        return ReadResult(project, found.diagnostics, "german" if german else "international")

    def _is_german(self, data: bytes) -> bool:
        lines = LINE.finditer(self.decode(data).text)
        return any(is_german(line["address"].strip()) for line in lines if tag_address(line["address"].strip()))

    def to_blocks(self, project: Project, options: WriteOptions, report: ConversionReport) -> WrittenBlock:
        blocks = [*_Writer(project, report, german=self._german).blocks()]
        return WrittenBlock(("file", ""), blocks=numbered_blocks(blocks))

    def located(self, content: bytes) -> tuple[Project, SourceText, BlockSpan]:
        source = self.decode(content)
        found = _read(source)
        spans = block_span(("file", ""), (0, len(source.text)), found.places)
        return Project(dialect=Dialect.SCL, tag_tables=[found.table]), source, spans


class _Writer:
    def __init__(self, project: Project, report: ConversionReport, *, german: bool) -> None:
        self._project, self._report, self._german = project, report, german
        self._written: dict[str, str] = {}

    def blocks(self) -> Iterator[WrittenBlock]:
        for thing in self._project.objects():
            if isinstance(thing, TagTable):
                self._report.add(Outcome.KEPT, "tag table", thing.report_path)
                for constant in thing.constants:
                    self._lost("constant", f"{thing.report_path} / constant {constant.name}", "it is no symbol")
            else:
                self._report.add(Outcome.NOT_EXECUTED, thing.kind_in_reports, thing.report_path, _NO_PLACE)
        for tag, path in self._tags():
            line = self._line(tag, path)
            if line is not None:
                yield WrittenBlock(("tag", tag.name), line, verbatim=True)
        for table in self._project.tag_tables:
            for name, text in kept(table.extension_data).items():
                symbol = LINE.fullmatch(text)
                start, end = symbol.span("address") if symbol is not None else (0, 0)
                line = text[:start] + with_mnemonics(text[start:end], german=self._german) + text[end:]
                yield WrittenBlock(("other", name), line, verbatim=True)

    def _tags(self) -> Iterator[tuple[Tag, str]]:
        """Yield the tags, then the variables with an address, with their paths."""
        for table in self._project.tag_tables:
            yield from ((tag, f"{table.report_path} / tag {tag.name}") for tag in table.tags)
        variables = [(f"{pou.report_path} / {v.name}", v) for pou in self._project.pous for v in pou.variables()]
        for section in self._project.global_sections():
            path = f"global variable {section.name}." if section.name else "global variable "
            variables += [(f"{path}{v.name}", v) for v in section.variables]
            for variable in section.variables:
                if not variable.address:
                    self._lost("variable", f"{path}{variable.name}", "a symbol has an address")
        for place, variable in variables:
            if variable.address:
                word = write_type(variable.type, Dialect.SCL)
                address = translated_address(variable.address, self._project.address_dialect, Dialect.SCL)
                if address.severity is not None:
                    outcome = Outcome.NOT_EXECUTED if address.severity is Severity.ERROR else Outcome.TRANSLATED
                    self._report.add(outcome, "address", place, f"{variable.address}: {address.reason}")
                if address.severity is not Severity.ERROR:
                    yield Tag(name=variable.name, type=word, address=address.text, comment=variable.comment), place

    def _line(self, tag: Tag, path: str) -> str | None:
        """Return the line of a tag; None where STEP 7 V5 has no such symbol."""
        address = operand(tag.address or "", german=self._german)
        word = tag.type.strip('"').upper()
        known = self._written.get(tag.name.casefold())
        why, cause = "", None
        if address is None:
            why = f"{tag.address or 'no address'} is no address of a symbol in STEP 7 V5"
        elif word not in _TYPES:
            why, cause = f"STEP 7 V5 has no type {tag.type}", Cause(CauseKind.LACKING, tag.type)
        elif _not_in_code_page(tag.name):
            why = f"the code page of STEP 7 V5 has no {_not_in_code_page(tag.name)}"
        elif known not in (None, address):
            why = f"the symbol {tag.name} is {known} already"
        if why:
            self._lost("tag", path, why, cause)
        if address is None or why or known is not None:
            return None
        self._written[tag.name.casefold()] = address
        if len(tag.name) > _WIDTHS[0]:
            why = f"a symbol of STEP 7 V5 has up to {_WIDTHS[0]} characters"
            self._report.add(Outcome.APPROXIMATED, "tag", path, why)
        language = "de" if self._german else ""
        comment = " ".join(plain(tag.comment, language).split())
        if isinstance(tag.comment, MultilingualText) and (left := sorted(_others(tag.comment, language))):
            why = f"a symbol has one comment, and names no language: not in the file are {', '.join(left)}"
            self._report.add(Outcome.DROPPED, "comment", path, why)
        if missing := _not_in_code_page(comment):
            why = f"a question mark replaces {missing}, which the code page of STEP 7 V5 does not have"
            self._report.add(Outcome.DROPPED, "comment", path, why)
        cells = (tag.name, address, word, comment.replace('"', "'"))
        return ",".join(f'"{cell:<{width}}"' for cell, width in zip(cells, _WIDTHS, strict=True))

    def _lost(self, what: str, path: str, why: str, cause: Cause | None = None) -> None:
        self._report.add(Outcome.NOT_EXECUTED, what, path, why, cause)


def _others(comment: MultilingualText, language: str) -> Iterator[str]:
    """Yield the languages whose text is not the one in `language`, which is written."""
    return (each for each, text in comment.texts.items() if text and text != plain(comment, language))


def _not_in_code_page(text: str) -> str:
    """Return the characters of a text that the code page of the files does not have."""
    return "".join(sorted({letter for letter in text if not letter.encode(_CODE_PAGE, errors="ignore")}))


CODEC = SdfCodec()
