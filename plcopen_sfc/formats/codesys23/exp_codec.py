"""``.EXP`` files: read, write, and put edits into the text, in the code page of the file. `exp_reader` reads them.

CoDeSys 2.3 writes the code page of its Windows, and no file names it.

What the text cannot express is in comments that the reader takes back: the text is read as it was written, and the rest
of the model is put behind it.

What CODESYS V3 has and CoDeSys 2.3 has not (CoDeSys 2.3 manual, "Operators", "Data types" and "Statements") is found
before: values of enumerations get the name that they have there; operators, statements, conversions and types are
reported, as a program with them does not compile.
"""

from __future__ import annotations

import codecs
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache

from plcopen_sfc.errors import EncodingError, Location
from plcopen_sfc.formats.codesys23.chart_text import ChartNames, body_text, chart_blocks
from plcopen_sfc.formats.codesys23.exp_language import replace_later_language, replace_line_comments
from plcopen_sfc.formats.codesys23.exp_outline import OWN_LINE
from plcopen_sfc.formats.codesys23.exp_reader import (
    CODE_PAGE,
    DIVIDER,
    HEADER,
    KINDS,
    ONE_BYTE_PAGES,
    central_letters,
    footer_of,
    read_export,
)
from plcopen_sfc.formats.declaration_blocks import section_block, type_blocks
from plcopen_sfc.formats.format_interface import ReadResult, WriteOptions
from plcopen_sfc.formats.provenance import content_digest
from plcopen_sfc.formats.registry import CODE_PAGES
from plcopen_sfc.formats.remainder_comments import lacking
from plcopen_sfc.formats.text_codec import TextCodec
from plcopen_sfc.formats.text_encoding import SourceText, decode_text
from plcopen_sfc.formats.text_patch import BlockSpan, WrittenBlock, numbered_blocks
from plcopen_sfc.languages.declarations import write_type, write_value, write_variable
from plcopen_sfc.languages.declarations.attributes import pragma_attributes
from plcopen_sfc.languages.declarations.conditional_declarations import without_conditions
from plcopen_sfc.languages.declarations.declaration_comments import LINE_END
from plcopen_sfc.languages.declarations.kept_texts import kept
from plcopen_sfc.languages.pragmas import RemainderEntry
from plcopen_sfc.languages.st.lexer import Token, tokenize
from plcopen_sfc.languages.text_edits import Edit, apply_edits, without
from plcopen_sfc.languages.translation.text_translation import inside_comment, with_block_comments
from plcopen_sfc.model import types as t
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Action, Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import Body, SfcBody
from plcopen_sfc.model.text import Text, plain
from plcopen_sfc.model.variables import VariableSection, sections_of
from plcopen_sfc.report import ConversionReport, Outcome

USUAL = "cp1252"
_NAMED = re.compile(rb"\{plcopen_sfc code_page := '(cp\d{3,4})'\}")
_LETTERS = re.compile(rb"[\x80-\xff]")
_LONG_RUN = re.compile(rb"[\xa8\xb8\xc0-\xff]{3,}")
"""Letters of Cyrillic words. In Western and Central European words such letters are alone or in pairs."""


class CodePageText(SourceText):
    """Text of a file in a code page, which it keeps."""

    __slots__ = ()

    def encode(self, text: str) -> tuple[bytes, bool]:
        """Return `text` in the code page of the file, and False. Raises `EncodingError`."""
        try:
            if self.encoding in ONE_BYTE_PAGES:
                data, _ = codecs.charmap_encode(text, "strict", codecs.charmap_build(_characters(self.encoding)))
                return data, False
            return text.encode(self.encoding), False
        except UnicodeEncodeError as error:
            raise EncodingError(
                f"{text[error.start]!r} is not in the code page {self.encoding} of this file",
                hint="CoDeSys 2.3 has one code page in a file, and no Unicode. Use characters of that code page.",
            ) from error


@cache
def _characters(page: str) -> str:
    """Return the 256 characters of a code page; for a byte that has none, the control character of its number.

    No page of Windows has these, so a damaged file comes back byte for byte. `\ufffe` is for bytes from 16#A0 on.
    """
    return "".join(
        bytes([byte]).decode(page, "ignore") or (chr(byte) if byte < 0xA0 else "\ufffe") for byte in range(256)
    )


def decode_export(data: bytes, page: str = "") -> CodePageText:
    """Return the text of a file: in `page`, or in UTF-8 where it is that, else in a code page, which is a guess.

    Raises `EncodingError` where it is not in `page`.
    """
    if page:
        try:
            return CodePageText(data.decode(page), page)
        except UnicodeDecodeError as error:
            line = data.count(b"\n", 0, error.start) + 1
            message = f"the byte 16#{data[error.start]:02X} is no character of the code page {page}"
            raise EncodingError(
                message, location=Location(None, line), hint="Name another code page, or none."
            ) from error
    encoding = named = _named_page(data)
    marked = data.startswith((codecs.BOM_UTF8, codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    if not encoding and not marked:
        if data.isascii():
            return CodePageText(data.decode("ascii"), USUAL)
        encoding = "cp1251" if _is_cyrillic(data) else "cp1250" if _is_central(data) else USUAL
        encoding = "utf-8" if _is_utf8(data) else encoding
    try:
        if encoding in ONE_BYTE_PAGES:
            text, _ = codecs.charmap_decode(data, "strict", _characters(encoding))
        else:
            text = data.decode(encoding)
        return CodePageText(text, encoding, guessed=not named)
    except (UnicodeDecodeError, LookupError):
        found = decode_text(data)
        return CodePageText(found.text, found.encoding, guessed=found.guessed)


def _named_page(data: bytes) -> str:
    """Return the code page that a comment of this package in a file names; empty without one."""
    named = _NAMED.search(data)
    return named[1].decode() if named is not None and named[1].decode() in CODE_PAGES else ""


def _is_taken_as_usual(text: str) -> bool:
    """True if a reader takes a text in the usual code page for that, where no comment names it."""
    return text.isascii() or decode_export(text.encode(USUAL, errors="replace")).encoding == USUAL


def _has_all(page: str, text: str) -> bool:
    try:
        text.encode(page)
    except UnicodeEncodeError:
        return False
    return True


def _is_utf8(data: bytes) -> bool:
    try:
        data.decode("utf-8")
    except UnicodeDecodeError:
        return False
    return True


def _is_cyrillic(data: bytes) -> bool:
    return 2 * sum(map(len, _LONG_RUN.findall(data))) > len(_LETTERS.findall(data))


def _is_central(data: bytes) -> bool:
    """True if one in twenty letters speaks for Central Europe: umlauts and most accents are the same in both pages."""
    found = sum(map(len, central_letters(data)))
    return bool(found) and 20 * found >= len(_LETTERS.findall(data))


_DIALECT = Dialect.CODESYS
_KEYWORDS = {kind: word for word, kind in KINDS.items()} | {PouKind.ORGANIZATION_BLOCK: "PROGRAM"}


def write_export(project: Project, meant: Project, report: ConversionReport, page: str = "") -> tuple[str, str]:
    """Return the text of a project, and its code page: `page`, or the first one that has its characters.

    `meant` as in `write_blocks`.
    """
    if not page:
        text = "\n".join(block.whole() for block in _objects(project, ConversionReport()))
        page = next((each for each in CODE_PAGES if _has_all(each, text)), USUAL)
    return write_blocks(project, meant, report, page).whole(), page


def write_blocks(
    project: Project,
    meant: Project,
    report: ConversionReport,
    page: str = "",
    *,
    baseline: Project | None = None,
    named: str = "",
) -> WrittenBlock:
    """Return the text of a project, in the blocks that an edit replaces.

    `meant` comes back from it: the project itself, or what it was before it was put into the terms of the tool.
    `page`: characters that this code page does not have are replaced, and are in comments. `baseline` is what was read
    from a text without such comments, so that what is as it was there needs none. `named` is the code page that the
    comments name in any case.
    """
    blocks = [_in_page(block, page) if page else block for block in numbered_blocks(_objects(project, report))]
    if baseline is None:
        left = _missing(blocks, meant)
    else:
        edited, before = _others(meant, baseline), _others(baseline, meant)
        # content that a file spells in its own way would come back otherwise from our text, and is kept
        known = {str(change) for change, _ in _missing(_written(before), before)}
        known_names = {pou.report_path for pou in meant.pous} - {pou.report_path for pou in edited.pous}
        own = [pou for pou in project.pous if pou.report_path not in known_names]
        written = project.model_copy(update={"pous": own, "data_types": edited.data_types})
        left = [one for one in _missing(_written(written), edited) if str(one[0]) not in known]
    for change, path in left:
        report.add(Outcome.EXTENSION_DATA, change.field, path, "CoDeSys 2.3 cannot express it; it is in a comment")
    if page and not (page == USUAL and _is_taken_as_usual("\n".join(block.whole() for block in blocks))):
        named = page
    if named:
        left.insert(0, (RemainderEntry((CODE_PAGE,), named), ""))
    if left:
        rest = "\n".join(f"(* {_ascii(f'{{plcopen_sfc {change}}}')} *)" for change, _ in left)
        blocks.append(WrittenBlock(("rest", ""), rest, apart=True))
    return WrittenBlock(("file", ""), blocks=tuple(blocks))


def _missing(blocks: Sequence[WrittenBlock], meant: Project) -> list[tuple[RemainderEntry, str]]:
    """Return the content of `meant` that the text in `blocks` lacks, each with the path of what it belongs to."""
    text = WrittenBlock(("file", ""), blocks=tuple(blocks)).whole()
    return [*lacking(read_export(SourceText(text + "\n", USUAL)).project, meant)]


def _written(project: Project) -> list[WrittenBlock]:
    return list(numbered_blocks(_objects(project, ConversionReport())))


def _others(project: Project, known: Project) -> Project:
    """Return a project without the POUs and types that are as in `known`; the reader of a POU asks for the rest."""
    digests = {thing.report_path: content_digest(thing) for thing in (*known.pous, *known.data_types)}

    def is_other(thing: Pou | t.DataTypeDeclaration) -> bool:
        return digests.get(thing.report_path) != content_digest(thing)

    pous = [pou for pou in project.pous if is_other(pou)]
    types = [declared for declared in project.data_types if is_other(declared)]
    return project.model_copy(update={"pous": pous, "data_types": types})


def _ascii(text: str) -> str:
    """Return a comment of this package in characters that every code page has."""
    return "".join(c if c.isascii() else "".join(f"$u{unit:04X}" for unit in _utf16(c)) for c in text)


def _utf16(character: str) -> Iterator[int]:
    data = character.encode("utf-16-be", "surrogatepass")
    return (int.from_bytes(data[at : at + 2]) for at in range(0, len(data), 2))


def _in_page(block: WrittenBlock, page: str) -> WrittenBlock:
    text = block.text.encode(page, errors="replace").decode(page)
    return replace(block, text=text, blocks=tuple(_in_page(each, page) for each in block.blocks))


# -- objects


def _objects(project: Project, report: ConversionReport) -> Iterator[WrittenBlock]:
    for declaration in project.data_types:
        report.add(Outcome.KEPT, "data type", f"type {declaration.name}")
        yield _data_type(declaration)
    for pou in project.pous:
        report.add(Outcome.KEPT, "POU", f"POU {pou.name}")
        yield WrittenBlock(("POU", pou.name), blocks=numbered_blocks(_pou(pou, report)), apart=True)
    yield from _global_lists(project, report)
    for name, text in kept(project.extension_data).items():
        if re.fullmatch(r"section\d+", name):
            yield WrittenBlock(("other", name), text, apart=True, verbatim=True)
    if plain(project.comment):
        yield WrittenBlock(("comment", ""), _comments(project.comment), apart=True)


def _data_type(declaration: t.DataTypeDeclaration) -> WrittenBlock:
    texts = kept(declaration.extension_data)
    initial = write_value(declaration.initial, _DIALECT) if declaration.initial is not None else ""
    type_ = _bare_lists(with_block_comments(_without_attributes(write_type(declaration.type, _DIALECT)), _DIALECT))
    is_struct = isinstance(declaration.type, t.StructType)
    lines = [_comments(declaration.comment)] if plain(declaration.comment) else []
    lines += [f"TYPE {declaration.name} :", type_] if is_struct else [f"TYPE {declaration.name} : {type_}"]
    value = _bare_lists(f" := {initial};") if initial else "" if is_struct else ";"
    text = _tabs("\n".join(lines)) + value
    text = f"{text}\nEND_TYPE"
    inner = tuple(type_blocks(text, declaration, _member))
    blocks = [*_header(texts), WrittenBlock(("type", ""), "" if inner else text, inner)]
    if "undivided" not in texts:
        blocks.append(WrittenBlock(("divider", ""), DIVIDER))
    return WrittenBlock(("type", declaration.name), blocks=tuple(blocks), apart=True)


def _member(member: t.Variable) -> str:
    return _tabs(
        _bare_lists(with_block_comments(_without_attributes(write_variable(member, _DIALECT, " " * 4)), _DIALECT))
    )


def _global_lists(project: Project, report: ConversionReport) -> Iterator[WrittenBlock]:
    """Yield the lists: sections of one name that follow each other are one list."""
    lists: list[list[VariableSection]] = []
    for section in project.global_sections():
        same = lists and lists[-1][0].name == section.name and "header" not in kept(section.extension_data)
        if same and (section.name or "unlisted" in kept(lists[-1][0].extension_data)):
            lists[-1].append(section)
        else:
            lists.append([section])
    for number, sections in enumerate(lists, 1):
        texts = kept(sections[0].extension_data)
        name = sections[0].name or ("" if "unlisted" in texts else f"Globals_{number}")
        report.add(Outcome.KEPT, "global variables", name)
        blocks = _header(texts, f"(* @GLOBAL_VARIABLE_LIST := '{name}' *)" if name else "")
        blocks += [_section(section) for section in sections]
        footer = texts.get("footer", footer_of(name))
        if footer:
            blocks.append(WrittenBlock(("footer", ""), footer, apart="footer" not in texts))
        yield WrittenBlock(("global variables", name), blocks=numbered_blocks(blocks), apart=True)


def _pou(pou: Pou, report: ConversionReport) -> Iterator[WrittenBlock]:
    texts = kept(pou.extension_data)
    yield from _header(texts)
    if plain(pou.comment):
        yield WrittenBlock(("comment", ""), _comments(pou.comment))
    keyword = _KEYWORDS[pou.kind]
    result = pou.interface.return_type if pou.interface is not None else None
    type_ = f" : {write_type(result, _DIALECT)}" if result is not None else ""
    yield WrittenBlock(("head", ""), f"{keyword} {pou.name}{type_}")
    for section in sections_of(pou.interface):
        yield _section(section)
    if "undivided" not in texts:
        yield WrittenBlock(("divider", ""), DIVIDER)
    yield from _pragmas(texts)
    names = ChartNames(pou, report)
    yield from _body(pou.body, names, f"POU {pou.name}")
    yield WrittenBlock(("end", ""), f"END_{keyword}")
    for action in pou.actions:
        report.add(Outcome.KEPT, "action", f"POU {pou.name} / action {action.name}")
        yield _action(action, names, f"POU {pou.name} / action {action.name}")
    for action in names.added:
        yield _action(action, names, f"POU {pou.name} / action {action.name}")


def _action(action: Action, names: ChartNames, path: str) -> WrittenBlock:
    blocks = [WrittenBlock(("head", ""), f"ACTION {action.name}:")]
    blocks += _pragmas(kept(action.extension_data))
    blocks += _body(action.body, names, path)
    blocks.append(WrittenBlock(("end", ""), "END_ACTION"))
    return WrittenBlock(("action", action.name), blocks=numbered_blocks(blocks), apart=True)


def _pragmas(texts: dict[str, str]) -> Iterator[WrittenBlock]:
    """Yield the pragmas at the start of a body."""
    for pragma in filter(None, texts.get("pragmas", "").split("\n")):
        name = re.search(r"@(\w+)", pragma)
        yield WrittenBlock(("pragma", name[1] if name is not None else ""), pragma)


def _body(body: Body | None, names: ChartNames, path: str) -> Iterator[WrittenBlock]:
    if isinstance(body, SfcBody):
        yield from chart_blocks(body, names, path)
    elif text := body_text(body):
        yield WrittenBlock(("body", ""), text, verbatim=True)


# -- parts


def _header(texts: dict[str, str], listed: str = "") -> list[WrittenBlock]:
    text = texts.get("header", HEADER)
    if listed:
        first, _, others = text.partition("\n")
        text = "\n".join(filter(None, (first, listed, others)))
    return [WrittenBlock(("header", ""), text)] if text else []


def _section(section: VariableSection) -> WrittenBlock:
    return _each_text(section_block(section, _DIALECT))


def _each_text(block: WrittenBlock) -> WrittenBlock:
    """Return a block of declarations in the terms of CoDeSys 2.3, at the start of the line as it has them.

    It has no attributes before declarations: a comment keeps them with all else that the text does not express.
    """
    text = _bare_lists(with_block_comments(_without_attributes(block.text), _DIALECT))
    if block.key[0] in ("head", "end"):
        text = "\n".join(line.lstrip() for line in text.split("\n"))
    else:
        text = re.sub(r"^\t", "", _tabs(text), flags=re.MULTILINE)
    return replace(block, text=text, blocks=tuple(map(_each_text, block.blocks)))


def _without_attributes(text: str) -> str:
    """Return declarations without the attributes and conditions of CODESYS V3, each in a line of its own."""
    return without_conditions("\n".join(line for line in text.split("\n") if pragma_attributes(line) is None))


@dataclass(slots=True)
class _List:
    """A list in brackets, or what is in parentheses, up to the place that was read.

    `is_value`: it is what an array or a member starts with. `is_several`: it has more than one element. `is_of_lists`:
    an element is a list itself.
    """

    opening: Token
    is_value: bool
    is_several: bool = False
    is_of_lists: bool = False


def _bare_lists(text: str) -> str:
    """Return declarations with the initial values of arrays as CoDeSys 2.3 has them: ``:= 1, 2, 3(7)``."""
    tokens = tokenize(text, _DIALECT).tokens if "[" in text else []
    edits: list[Edit] = []
    around: list[_List] = []
    for index, token in enumerate(tokens):
        if around and token.type in ("COMMA", "LPAR"):
            around[-1].is_several = True
        if token.type == "LSQB" and around and around[-1].opening.type == "LSQB":
            around[-1].is_of_lists = True
        if token.type in ("LSQB", "LPAR"):
            around.append(_List(token, is_value=index > 0 and tokens[index - 1].type == "ASSIGN"))
        elif token.type in ("RSQB", "RPAR") and around:
            ended = around.pop()
            # the list of an array in an array would not be told from its elements, and one value not from a list
            if token.type == "RSQB" and ended.is_value and ended.is_several and not ended.is_of_lists:
                edits += [Edit(*ended.opening.span, ""), Edit(*token.span, "")]
    return apply_edits(text, edits)


def _tabs(text: str) -> str:
    """Return `text` indented by tabs, as CoDeSys 2.3 does it."""
    return re.sub(r"^(?: {4})+", lambda found: "\t" * (len(found.group()) // 4), text, flags=re.MULTILINE)


def _comments(text: Text | None) -> str:
    return "\n".join(f"(* {inside_comment(line)} *)" for line in LINE_END.split(plain(text)))


class ExpCodec(TextCodec):
    """Exports of CoDeSys 2.3 and TwinCAT 2; `page` is their code page where one was asked for."""

    def __init__(self, page: str = "") -> None:
        self._page = page

    def for_version(self, version: str) -> ExpCodec:
        """Return the codec for a code page."""
        return ExpCodec(version) if version in CODE_PAGES else self

    def decode(self, content: bytes) -> SourceText:
        return decode_export(content, self._page)

    def read(self, data: bytes, *, file: str | None = None) -> ReadResult:
        """Read a file. What does not parse is kept and reported."""
        found = read_export(self.decode(data), file)
        return ReadResult(found.project, found.diagnostics, self._page)

    def without_own_comments(self, text: str) -> str:
        return without(text, (found.span() for found in OWN_LINE.finditer(text)))

    def write(self, project: Project, options: WriteOptions, report: ConversionReport) -> bytes:
        """Write a whole file with CRLF, in the code page that has its characters."""
        text, page = write_export(project, options.rewritten or project, report, self._page)
        return f"\n{text}\n".replace("\n", "\r\n").encode(page, errors="replace")

    def replace_missing(self, project: Project, report: ConversionReport) -> None:
        """Write comments as CoDeSys 2.3 has them, and report what it does not compile."""
        replace_line_comments(project, report)
        replace_later_language(project, report)

    def to_blocks(self, project: Project, options: WriteOptions, report: ConversionReport) -> WrittenBlock:
        # in comments of this package an object may be named with its neighbours
        known = options.baseline if not OWN_LINE.search(self.decode(options.source).text) else None
        named = _named_page(options.source)
        return write_blocks(project, options.rewritten or project, report, baseline=known, named=named)

    def located(self, content: bytes) -> tuple[Project, SourceText, BlockSpan]:
        source = self.decode(content)
        found = read_export(source)
        return found.project, source, found.spans


CODEC = ExpCodec()
