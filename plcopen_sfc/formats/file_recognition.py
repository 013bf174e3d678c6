"""Recognition of files by their content, and formats that are recognised but not read, with advice what to export."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import PurePath

from plcopen_sfc.errors import Location, UnknownFormatError, UnreadFormatError
from plcopen_sfc.formats.format_interface import FileHead, Format, head_of
from plcopen_sfc.formats.registry import FORMATS, all_formats
from plcopen_sfc.model.dialect import Dialect


def recognise(data: bytes, *, file: str | None = None) -> Format:
    """Return the format of a file's content.

    Raises `UnreadFormatError` for files of tools that are not read, `UnknownFormatError`, or what is wrong with the XML
    where it is XML.
    """
    head = head_of(data)
    refuse_by_content(head, file)
    found = next((f for f in all_formats() if f.recognises(head)), None)
    if found is not None:
        # an object without its pragmas: the declarations and the body look like IEC 61131-3
        is_export = found.name == "iec-text" and _suffix(file) in _CODESYS23.extensions
        return _CODESYS23 if is_export else found
    if not head.root and "\0" not in head.text and _suffix(file) in _GRAFCET_TEXT.extensions:
        return _GRAFCET_TEXT  # its reader tells what the first line lacks
    refuse_by_name(head, file)
    if head.text.lstrip().startswith("{"):
        raise UnknownFormatError(
            "JSON, but not a model that plcopen_sfc has saved", location=Location(file), hint=_HINT
        )
    # an error of its XML tells more than that the format is unknown
    from plcopen_sfc.formats.plcopen.tc6_versions import find_version  # noqa: PLC0415  # only for files in trouble
    from plcopen_sfc.formats.xml.xml_parsing import parse_xml  # noqa: PLC0415

    find_version(parse_xml(data, file=file), file=file)
    raise UnknownFormatError("no format recognises this file", location=Location(file), hint=_HINT)


def recognised_as(kind: Format, start: bytes) -> bool:
    """True if the first `HEAD` bytes of a file look like `kind`."""
    return kind.recognises(head_of(start))


_CODESYS23, _GRAFCET_TEXT = ({kind.name: kind for kind in FORMATS}[name] for name in ("codesys23", "grafcet-text"))
_HINT = "`plcopen-sfc formats` lists what can be read; give the format by name to insist on one."


_OPENNESS = (
    "Export the blocks as XML: with TIA Portal Openness, or by the version control interface (project tree > Version "
    "control interface > a workspace). Blocks in SCL: their context menu > Generate source from blocks."
)
_CODESYS = "Open it in CODESYS, then Project > Export PLCopenXML, or Project > Export."
_TWINCAT = (
    "Give the folder of the PLC project, whose .TcPOU, .TcGVL and .TcDUT files are read. Or in the Solution Explorer "
    "of TwinCAT: context menu of the PLC project (NAME Project) or of a folder in it > Export PLCopenXML."
)
_SCHNEIDER = "Control Expert has no export to PLCopen XML; nothing that it exports is read yet."
_ROCKWELL = "Studio 5000 exports charts as L5X and L5K only, and neither is read yet."
_STEP7 = "Migrate the project into TIA Portal (Project > Migrate project). " + _OPENNESS


@dataclass(frozen=True)
class UnreadFormat:
    """A format that is recognised: `title` tells what it is, `advice` what to do.

    `root` matches the name of the root element of XML, `namespace` is a part of its namespace, `text` matches the start
    of a text. `extensions` count where the content does not tell; with `insists` also where a text looks like one of a
    format that is read.
    """

    title: str
    advice: str
    root: str = ""
    namespace: str = ""
    text: str = ""
    extensions: tuple[str, ...] = ()
    insists: bool = False


UNREAD: tuple[UnreadFormat, ...] = (
    UnreadFormat(
        "a project of TwinCAT",
        _TWINCAT,
        root="TcSmProject",
        extensions=(".tsproj", ".tpzip", ".tnzip", ".tsp", ".sln"),
    ),
    UnreadFormat(
        "a project of CoDeSys V2.3 or TwinCAT 2",
        "Export it as .EXP: Project > Export. Or open it in CODESYS V3 (32 bit, with the package CODESYS V2.3 "
        "Converter) by File > Open Project, then Project > Export PLCopenXML.",
        extensions=(".pro",),
    ),
    UnreadFormat("a project of CODESYS", _CODESYS, extensions=(".project", ".library", ".compiled-library")),
    UnreadFormat(
        "a project archive of CODESYS",
        "In CODESYS: File > Project Archive > Extract Archive, then Project > Export PLCopenXML.",
        extensions=(".projectarchive",),
    ),
    UnreadFormat("an export of Studio 5000 (L5X)", _ROCKWELL, root="RSLogix5000Content", extensions=(".l5x",)),
    UnreadFormat(
        "an export of Studio 5000 (L5K)",
        _ROCKWELL,
        text=r"\A\s*(?:\(\*[\s\S]*?\*\)\s*)?IE_VER\s*:=",
        extensions=(".l5k",),
        insists=True,
    ),
    UnreadFormat("a project of Studio 5000", _ROCKWELL, extensions=(".acd",)),
    UnreadFormat(
        "an export of Control Expert or Unity Pro (XEF, ZEF, XSF, XBD, XST ..)",
        _SCHNEIDER,
        root=r"[A-Z]\w*ExchangeFile",
        extensions=(".xef", ".zef", ".xsf", ".xbd", ".xst", ".xld", ".xil", ".xdb", ".xdd"),
    ),
    UnreadFormat("a project of Control Expert or Unity Pro", _SCHNEIDER, extensions=(".stu", ".sta")),
    UnreadFormat(
        "an export of DeltaV (.fhx)",
        "DeltaV exports nothing else that is read.",
        text=r"\A\s*/\*\s*Version:[^*]*\*/[\s\S]{0,200}?\b(?:SCHEMA|LOCALE)\b",
        extensions=(".fhx",),
    ),
    UnreadFormat(
        "a SIMATIC SD document of TIA Portal (.s7dcl, .s7res)",
        _OPENNESS,
        text=r"\A\s*(?:\{\s*S7_\w+\s*:=|MultiLingualTexts:\s)",
        extensions=(".s7dcl", ".s7res"),
        insists=True,
    ),
    UnreadFormat(
        "an STL source of STEP 7 (.awl)",
        _STEP7,
        text=r"(?im)^[ \t]*NETWORK[ \t]*\r?\n\s*TITLE[ \t]*=",
        extensions=(".awl",),
    ),
    UnreadFormat(
        "a source of S7-GRAPH (.gr7)",
        _STEP7,
        text=r"\(\*\$_(?:NUM|COM|CMPSET|SETTINGS)\b|(?m:^[ \t]*PERM_CONDITION_AT_(?:BEGIN|END)\b)",
        extensions=(".gr7",),
        insists=True,
    ),
    UnreadFormat("a project of TIA Portal", _OPENNESS, extensions=tuple(f".ap{n}" for n in range(11, 22))),
    UnreadFormat(
        "an archive or library of TIA Portal",
        "Open it in TIA Portal (Project > Retrieve; a library: Global libraries > Open). " + _OPENNESS,
        extensions=tuple(f".{kind}{n}" for kind in ("zap", "al", "zal") for n in range(11, 22)),
    ),
    UnreadFormat("a project of STEP 7 V5", _STEP7, extensions=(".s7p",)),
    UnreadFormat(
        "XML of IEC 61131-10",
        "It is not read yet. Many of its tools also export PLCopen XML (TC6).",
        root="Project",
        namespace="TC65SC65BWG7TF10",
    ),
    UnreadFormat(
        "the build settings of a Beremiz project", "Give plc.xml beside it, which is the program.", root="BeremizRoot"
    ),
    UnreadFormat(
        "a metamodel of EMF (.ecore)",
        "A model that follows it, as a .grafcet file of AGRAFE, is read.",
        root="EPackage",
        extensions=(".ecore",),
    ),
    UnreadFormat(
        "a project of ClassicLadder",
        "ClassicLadder exports nothing that is read.",
        text=r"\A_FILES_CLASSICLADDER\b",
        extensions=(".clp", ".clprj"),
    ),
)
"""Every format that is recognised and not read, in the order in which they are tried."""


def refuse_by_content(head: FileHead, file: str | None) -> None:
    """Raise `UnreadFormatError` where the content, or a name that insists, is that of a format that is not read."""
    for kind in UNREAD:
        if _has_content(kind, head) or (kind.insists and not head.root and _suffix(file) in kind.extensions):
            raise _refusal(kind, file)


def refuse_by_name(head: FileHead, file: str | None) -> None:
    """Raise `UnreadFormatError` where only the name tells what it is, `UnknownFormatError` for a piece of program."""
    kind = named_like(file)
    if kind is not None:
        raise _refusal(kind, file)
    if not head.root and "\0" not in head.text:
        _refuse_fragments(head.text, file)


def named_like(file: str | None) -> UnreadFormat | None:
    """Return the format that is not read and has the extension of `file`."""
    return next((kind for kind in UNREAD if _suffix(file) in kind.extensions), None)


def _has_content(kind: UnreadFormat, head: FileHead) -> bool:
    if head.root:
        return bool(kind.root and re.fullmatch(kind.root, head.root)) and kind.namespace in head.namespace
    return bool(kind.text and re.search(kind.text, head.text))


def _suffix(file: str | None) -> str:
    return PurePath(file).suffix.lower() if file else ""


def _refusal(kind: UnreadFormat, file: str | None) -> UnreadFormatError:
    return UnreadFormatError(f"this is {kind.title}, which is not read", location=Location(file), hint=kind.advice)


# -- pieces of programs --------------------------------------------------------------------------------------------

_QUIET = re.compile(r"\(\*.*?\*\)|/\*.*?\*/|//[^\r\n]*|'[^'$\r\n]*+(?:\$.[^'$\r\n]*+)*+'", re.DOTALL)
_OF_SCL = re.compile(r'#[^\W\d]\w*|#"|"[^"\r\n]+"\s*(?:\.|:=|\()|^\s*(?:END_)?REGION\b|^\s*BEGIN\s*$', re.MULTILINE)
_STATEMENT = re.compile(r":=[^;]*;|\bEND_(?:IF|CASE|FOR|WHILE|REPEAT)\b", re.IGNORECASE)
_SECTION = re.compile(r"\s*VAR(?:_\w+)?\b", re.IGNORECASE)
_SOURCES = (".scl", ".st", ".iecst", ".sfc")


def _refuse_fragments(text: str, file: str | None) -> None:
    """Raise `UnknownFormatError` where a text is program text without the block that it belongs to."""
    plain = _QUIET.sub(" ", text)
    if not _SECTION.match(plain) and not _are_statements(text, plain):
        if _suffix(file) in _SOURCES:
            raise UnknownFormatError(
                "no block begins in this source", location=Location(file), hint="A source has whole blocks: " + _BLOCKS
            )
        return
    scl = _OF_SCL.search(plain) is not None or _suffix(file) == ".scl"
    what = "declarations" if _SECTION.match(plain) else "statements"
    block = 'FUNCTION_BLOCK "Name"' if scl else "FUNCTION_BLOCK Name"
    missing = [f"{block} before the text", "END_FUNCTION_BLOCK behind it"]
    if scl and not re.search(r"^\s*BEGIN\b", plain, re.MULTILINE | re.IGNORECASE):
        missing.insert(1, "BEGIN before the statements")
    hint = f"What is missing: {', '.join(missing)} (or another kind of block: {_BLOCKS})."
    if scl:
        hint += " TIA Portal writes whole blocks: context menu of the block > Generate source from blocks."
    language = "SCL" if scl else "structured text"
    raise UnknownFormatError(
        f"this is {language} without its block: it begins with {what}", location=Location(file), hint=hint
    )


def _are_statements(text: str, plain: str) -> bool:
    """Return True if most of `text` parses as statements of structured text; `plain` is the text without comments."""
    if not _STATEMENT.search(plain):
        return False
    from plcopen_sfc.languages.st.parsing import parse_statements  # noqa: PLC0415  # only for files in trouble

    parsed = parse_statements(text, Dialect.SCL if _OF_SCL.search(plain) else Dialect.CODESYS)
    # a long text was cut in a statement
    return len(parsed.problems) <= 1 + len(parsed.tree.statements) // 10


_BLOCKS = "FUNCTION_BLOCK, FUNCTION, ORGANIZATION_BLOCK or PROGRAM, TYPE, DATA_BLOCK"
