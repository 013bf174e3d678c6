"""The table of formats."""

from __future__ import annotations

import re
from functools import cache

from plcopen_sfc import plugins
from plcopen_sfc.errors import PluginError, UnknownFormatError, UnknownVersionError, check_argument, nearest
from plcopen_sfc.formats.format_interface import ChartHost, DrawingNeed, FileHead, Format, NetworkForm
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.plugins import provided_by_plugins


def _is_tc6(head: FileHead) -> bool:
    return head.root == "project" and head.namespace.startswith("http://www.plcopen.org/xml/tc6")


def _is_codesys(head: FileHead) -> bool:
    # a file converted from CODESYS may carry its data too, but then its texts are in elements with a prefix
    return _is_tc6(head) and not head.xhtml_prefix and head.mentions("http://www.3s-software.com/plcopenxml/")


_TEXT_UNIT = re.compile(
    r"\s*+(?:(?>\(\*.*?\*\)|//[^\r\n]*+|\{\{.*?\}\}|\{[^}]*+\})\s*+)*+"
    r"(?:PROGRAM|FUNCTION_BLOCK|FUNCTION|TYPE|VAR_GLOBAL|CONFIGURATION|CLASS|INTERFACE|NAMESPACE|USING)\b"
    r"(?!\s*[\":=])",
    re.DOTALL | re.IGNORECASE,
)
_TEXT_PART = re.compile(r"\b(?:END_[A-Z_]+|VAR|VAR_[A-Z_]+|INITIAL_STEP)\b", re.IGNORECASE)


_OWN_TEXT = re.compile(r"\s*\{\s*plcopen_sfc\s+format\b")


def _is_iec_text(head: FileHead) -> bool:
    if _OWN_TEXT.match(head.text):
        return True
    return _TEXT_UNIT.match(head.text) is not None and _TEXT_PART.search(head.text) is not None


_SCL_UNIT = re.compile(
    r"ORGANIZATION_BLOCK|DATA_BLOCK|(?:FUNCTION_BLOCK|FUNCTION|TYPE)\s+(?:\"|(?P<number>(?:FB|FC|UDT)\d+\b))",
    re.IGNORECASE,
)
_SCL_SIGN = re.compile(
    r"^[ \t]*(?:BEGIN|(?:TITLE|VERSION|AUTHOR|FAMILY|NAME)\s*[:=]|KNOW_HOW_PROTECT)|(?<!\w)#[^\W\d]|:\s*VOID\b|\"",
    re.IGNORECASE | re.MULTILINE,
)
"""What only sources of S7 have: a block of any tool may be called ``FB1``."""
_BEFORE_UNITS = re.compile(r"\s*+(?:(?>\(\*.*?\*\)|//[^\r\n]*+|\(/\*.*?\*/\)|/\*.*?\*/)\s*+)*+", re.DOTALL)
_OWN_SCL = "// {plcopen_sfc "


def _is_scl(head: FileHead) -> bool:
    start = _BEFORE_UNITS.match(head.text)
    position = start.end() if start is not None else 0
    found = _SCL_UNIT.match(head.text, position)
    if found is not None and found["number"] is not None and _SCL_SIGN.search(head.text, position) is None:
        return False
    return found is not None or head.text.startswith(_OWN_SCL)


_EXPORT = re.compile(
    r"\s*\(\* @(?:NESTEDCOMMENTS|GLOBAL_VARIABLE_LIST|PATH|OBJECTFLAGS|SYMFILEFLAGS|END_DECLARATION)\b"
    r"|\s*(?:_ALARMCONFIG|PLC_CONFIGURATION|LIBRARY)[ \t]*\r?\n"
)
_IN_EXPORT = re.compile(
    r"^[ \t]*+(?:\(\* @(?:END_DECLARATION|SFCMAXTIME|SFCMINTIME|SFCCOMMENT|TEXT_IMPLEMENTATION|OBJECT_END)\b"
    r"|_(?:CFC|FBD|LD)_BODY[ \t]*$)",
    re.MULTILINE,
)
"""Lines inside of objects, for files from which somebody took the pragmas before them."""


CODE_PAGES = ("cp1252", "cp1250", "cp1251", "cp1253", "cp1254", "cp1257", "cp932", "cp936", "cp949", "cp950")
"""The code pages of Windows in which CoDeSys 2.3 writes, in the order in which they are tried."""


def _is_export_of_codesys23(head: FileHead) -> bool:
    if _EXPORT.match(head.text) is not None:
        return True
    if _OWN_TEXT.match(head.text) or _TEXT_UNIT.match(head.text) is None:
        return False
    return _IN_EXPORT.search(head.text.replace("\r", "")) is not None


def _is_simaticml(head: FileHead) -> bool:
    if head.root == "Document":
        return "<Engineering" in head.text or re.search(r"<(?:SW|Hmi)\.", head.text) is not None
    # parts of documents, and other exports of Openness: the reader tells what they are
    openness = "http://www.siemens.com/automation/Openness/"
    return head.root.startswith("SW.") or head.namespace.startswith(openness) or head.root in ("FlgNet", "CAEXFile")


def _is_grafcet_text(head: FileHead) -> bool:
    if head.root:
        return False
    # in the words of this package, and in the notations of grafcet2plc and Grafcet_to_Automaton
    begins = re.match(r"\s*GRAFCET[ \t]+\S|\ufeff?\s*%\w+[ \t]*\([ \t]*X\d", head.text)
    return begins is not None or re.search(r"(?m)^[ \t]*<GRAFCET>[ \t]*\r?$", head.text) is not None


_OF_LISTS = ("steps", "associations", "step actions", "times", "interlocks", "supervisions", "priorities", "comments")
_LIST_HEADINGS = re.compile(
    r"^(?=(?:.*[;,\t])?[ \"]*(?:step|step name|schritt|schrittname|variable|tag|symbol|signal)[ \"]*(?:[;,\t]|$))"
    r"(?:.*[;,\t])?[ \"]*(?:action|aktion|condition|(?:weiterschalt)?bedingung|next(?: step)?|folgeschritt|"
    r"(?:data ?|daten)?typ[e]?|address|adresse)[ \"]*(?:[;,\t]|$)",
    re.IGNORECASE | re.MULTILINE,
)


_SYMBOL = re.compile(
    r'^\ufeff?[ \t]*"[^"\r\n]*"[ \t]*,'
    r'[ \t]*"(?:P?[EAIQ][BWD]?|M[BWD]?|[TZC]|S?F[BC]|[OD]B|UDT|VAT)[ \t]*\d+(?:\.\d)?[ \t]*"'
    r'[ \t]*,[ \t]*"?[^",\r\n]*"',
    re.IGNORECASE | re.MULTILINE,
)


FORMATS: tuple[Format, ...] = (
    Format(
        name="codesys",
        title="CODESYS V3 and TwinCAT 3 PLCopenXML",
        tool="CODESYS",
        module="plcopen_sfc.formats.codesys.codesys_codec",
        extensions=(".xml",),
        recognises=_is_codesys,
        capabilities=(
            "steps",
            "step actions",
            "associations",
            "times",
            "flags",
            "comments",
            "branches",
            "logic bodies",
        ),
        xml=True,
        drawing=DrawingNeed.STRUCTURED,
        dialect=Dialect.CODESYS,
        one_sheet=True,
        standard="TC6",
        il_conditions=False,
        charts=ChartHost("CODESYS", is_codesys=True, excludes=True),
        extends=True,
    ),
    Format(
        name="plcopen",
        title="PLCopen TC6 XML",
        tool="TC6 tools",
        module="plcopen_sfc.formats.plcopen.tc6_codec",
        extensions=(".xml",),
        recognises=lambda head: _is_tc6(head) and not _is_codesys(head),
        capabilities=(
            "steps",
            "macro-steps",
            "associations",
            "priorities",
            "logic in charts",
            "layout",
            "logic bodies",
        ),
        versions=("1.01", "2.0", "2.01"),
        flavours=("beremiz",),
        xml=True,
        drawing=DrawingNeed.PLAIN,
        positions=True,
        dialect=Dialect.IEC,
        one_sheet=True,
        standard="TC6",
        charts=ChartHost("TC6", is_codesys=False, names_lists=False),
    ),
    Format(
        name="simaticml",
        title="SimaticML of TIA Portal Openness",
        tool="TIA Portal",
        module="plcopen_sfc.formats.simaticml.simaticml_codec",
        extensions=(".xml",),
        recognises=_is_simaticml,
        capabilities=(
            "steps",
            "interlocks",
            "supervisions",
            "events",
            "permanent operations",
            "sequences",
            "times",
            "comments",
            "branches",
            "logic bodies",
            "data blocks",
            "tags",
        ),
        versions=("V14 SP1", "V15", "V15.1", "V16", "V17", "V18", "V19", "V20", "V21"),
        flags_as_conditions=True,
        xml=True,
        drawing=DrawingNeed.PLAIN,
        dialect=Dialect.SCL,
        ids=False,
        folders=True,
        il_conditions=False,
        il_bodies=False,
    ),
    Format(
        name="twincat",
        title="TwinCAT 3 project files (.TcPOU)",
        tool="TwinCAT",
        module="plcopen_sfc.formats.twincat.twincat_codec",
        extensions=(".tcpou", ".tcgvl", ".tcdut", ".tcio", ".tctto"),
        recognises=lambda head: head.root == "TcPlcObject",
        capabilities=("steps", "step actions", "associations", "times", "flags", "comments", "branches"),
        xml=True,
        drawing=DrawingNeed.STRUCTURED,
        dialect=Dialect.CODESYS,
        networks=NetworkForm.STATEMENTS,
        folders=True,
        list_extension=".plcproj",
        one_sheet=True,
        il_conditions=False,
        il_bodies=False,
        extension_data=False,
        charts=ChartHost("TwinCAT", is_codesys=True, excludes=True, by_bytes=True),
        extends=True,
    ),
    Format(
        name="codesys-export",
        title="exports of CODESYS V3 in its own format (.export)",
        tool="CODESYS",
        module="plcopen_sfc.formats.codesys_export.export_codec",
        extensions=(".export",),
        recognises=lambda head: head.root == "ExportFile",
        capabilities=("steps", "step actions", "associations", "times", "flags", "comments", "branches"),
        xml=True,
        drawing=DrawingNeed.STRUCTURED,
        dialect=Dialect.CODESYS,
        networks=NetworkForm.STATEMENTS,
        one_sheet=True,
        il_conditions=False,
        il_bodies=False,
        extension_data=False,
        charts=ChartHost("CODESYS", is_codesys=True, excludes=True, has_tasks=False),
        extends=True,
    ),
    Format(
        name="json",
        title="the model itself",
        tool="",
        module="plcopen_sfc.formats.json_codec",
        extensions=(".json",),
        recognises=lambda head: head.text.lstrip().startswith("{") and '"plcopen_sfc"' in head.text[:2000],
        capabilities=("everything",),
    ),
    Format(
        name="codesys23",
        title="exports of CoDeSys 2.3 and TwinCAT 2 (.EXP)",
        tool="CoDeSys 2.3",
        module="plcopen_sfc.formats.codesys23.exp_codec",
        extensions=(".exp",),
        versions=CODE_PAGES,
        recognises=_is_export_of_codesys23,
        capabilities=("steps", "step actions", "associations", "times", "flags", "comments", "the rest in comments"),
        text=True,
        dialect=Dialect.CODESYS,
        ids=False,
        networks=NetworkForm.STATEMENTS,
        charts=ChartHost(
            "CoDeSys 2.3",
            is_codesys=True,
            has_tasks=False,
            has_main=True,
            has_methods=False,
            il_conditions=True,
            keeps_bodies=True,
            names_lists=False,
        ),
    ),
    Format(
        name="scl",
        title="external sources of TIA Portal and STEP 7 in SCL",
        tool="TIA Portal",
        module="plcopen_sfc.formats.scl.scl_codec",
        extensions=(".scl",),
        recognises=_is_scl,
        capabilities=("declarations", "program text", "the rest in comments"),
        text=True,
        dialect=Dialect.SCL,
        networks=NetworkForm.COMMENTS,
        il_conditions=False,
        il_bodies=False,
        used_first=True,
    ),
    Format(
        name="grafcet",
        title="GRAFCETs of the AGRAFE editor (.grafcet)",
        tool="",
        module="plcopen_sfc.formats.grafcet.grafcet_xmi_codec",
        extensions=(".grafcet",),
        recognises=lambda head: head.root == "Grafcet",
        capabilities=("steps", "partial charts", "macro-steps", "forcing orders", "GRAFCET actions"),
        xml=True,
        ids=False,
        dialect=Dialect.IEC,
        networks=NetworkForm.STATEMENTS,
        il_conditions=False,
        il_bodies=False,
    ),
    Format(
        name="grafcet-text",
        title="GRAFCETs (IEC 60848) as text",
        tool="",
        module="plcopen_sfc.formats.grafcet.grafcet_text_codec",
        extensions=(".gct",),
        recognises=_is_grafcet_text,
        capabilities=(
            "steps",
            "partial charts",
            "macro-steps",
            "forcing orders",
            "GRAFCET actions",
            "comments",
            "the rest in comments",
        ),
        text=True,
        ids=False,
        dialect=Dialect.IEC,
        networks=NetworkForm.STATEMENTS,
        il_conditions=False,
        il_bodies=False,
    ),
    Format(
        name="xlsx",
        title="step list as a workbook",
        tool="",
        module="plcopen_sfc.formats.steplist.xlsx_codec",
        extensions=(".xlsx",),
        recognises=lambda head: head.data.startswith(b"PK\x03\x04") and b"xl/" in head.data,
        capabilities=_OF_LISTS,
        xml_texts=True,
        ids=False,
        dialect=Dialect.IEC,
        extension_data=False,
        networks=NetworkForm.STATEMENTS,
        il_conditions=False,
        il_bodies=False,
    ),
    Format(
        name="csv",
        title="step list as text",
        tool="",
        module="plcopen_sfc.formats.steplist.list_codec",
        extensions=(".csv",),
        recognises=lambda head: not head.root and _LIST_HEADINGS.search(head.text) is not None,
        capabilities=_OF_LISTS,
        ids=False,
        dialect=Dialect.IEC,
        extension_data=False,
        networks=NetworkForm.STATEMENTS,
        il_conditions=False,
        il_bodies=False,
    ),
    Format(
        name="sdf",
        title="symbol table of STEP 7 V5",
        tool="",
        module="plcopen_sfc.formats.symboltable.sdf_codec",
        extensions=(".sdf",),
        versions=("international", "german"),
        recognises=lambda head: not head.root and _SYMBOL.search(head.text) is not None,
        capabilities=("tags",),
        text=True,
        ids=False,
        networks=NetworkForm.COMMENTS,
        il_conditions=False,
        il_bodies=False,
        extension_data=False,
    ),
    Format(
        name="iec-text",
        title="IEC 61131-3 as text, with SFC",
        tool="tools that read the text",
        module="plcopen_sfc.formats.iectext.iectext_codec",
        extensions=(".st", ".iecst", ".sfc"),
        recognises=_is_iec_text,
        capabilities=("steps", "associations", "priorities", "comments", "the rest in pragmas"),
        flavours=("matiec",),
        text=True,
        networks=NetworkForm.STATEMENTS,
    ),
)
"""The formats of this package, in the order in which they are tried."""


@cache
def all_formats() -> tuple[Format, ...]:
    """Return every format: those of this package, then those of plugins. Raises `PluginError`."""
    found = list(FORMATS)
    for kind in provided_by_plugins(plugins.FORMATS, Format):
        if any(kind.name == other.name for other in found):
            raise PluginError(f"a plugin provides the format {kind.name}, which there is already")
        found.append(kind)
    return tuple(found)


def format_named(name: str) -> tuple[Format, str]:
    """Return the format of this name and the version in it (``plcopen-2.0``). Raises `UnknownFormatError`."""
    check_argument(name, str, "format is the name of one")
    for candidate in all_formats():
        if name == candidate.name:
            return candidate, ""
        version = name.removeprefix(candidate.name + "-")
        if version != name and version in (*candidate.versions, "1.0"):
            return candidate, version
    raise _unknown(name)


def _unknown(name: object) -> UnknownFormatError:
    """Return the error for a name that is no format: with the format that its tool uses, or the nearest name."""
    asked = str(name).casefold().partition("-")[0]
    tool, use = next((use for names, *use in _TOOLS if asked in names.split()), ("", ""))
    if tool:
        return UnknownFormatError(f"there is no format {name!r}: {tool} uses {use}")
    known = [n for f in all_formats() for n in (f.name, *(f"{f.name}-{v}" for v in f.versions))]
    near = nearest(name, [*known, *(each for names, *_ in _TOOLS for each in names.split())])
    listed = (f.name + (f" ({', '.join(f.versions)})" if f.versions else "") for f in all_formats())
    return UnknownFormatError(f"there is no format {name!r}{near}", hint=f"Formats are: {', '.join(listed)}")


_TOOLS = (
    ("tia tiaportal openness step7 s7graph graph siemens", "TIA Portal", "simaticml; program text alone is scl"),
    (
        "twincat twincat3 tc3 beckhoff tcpou",
        "TwinCAT 3",
        "twincat (the files of its projects), codesys (its PLCopen XML)",
    ),
    ("codesys2 codesysv2 twincat2 tc2 exp", "CoDeSys 2.3", "codesys23"),
    ("codesys3 codesysv3 3s", "CODESYS V3", "codesys (its PLCopen XML), codesys-export (its own format)"),
    ("beremiz openplc", "Beremiz", 'plcopen, written with --for beremiz (flavour="beremiz")'),
    ("matiec iec2c", "matiec", 'iec-text, written with --for matiec (flavour="matiec")'),
    ("tc6 plcopenxml xml", "a tool that reads PLCopen TC6 XML", "plcopen; CODESYS and TwinCAT use codesys"),
    ("st text sfc iectext", "a tool that reads IEC 61131-3 as text", "iec-text"),
)
"""Names of tools and files that are asked for instead of formats, the tool, and what it uses."""


def for_tia(name: str, tia: str) -> str:
    """Return the name of the format `name` in the version `tia` of TIA Portal, spelled ``V16``, ``16`` or ``v14sp1``.

    Raises `UnknownFormatError` where the format has no such versions, `UnknownVersionError` for one that is not known.
    """
    check_argument(tia, str, "tia is the version of TIA Portal: V16")
    kind, version = format_named(name)
    if kind.name != TIA_FORMAT:
        raise UnknownFormatError(f"a version of TIA Portal is for {TIA_FORMAT}, not for {name}")
    spelled = tia.replace(" ", "").upper().removeprefix("V")
    wanted = next((known for known in kind.versions if known.replace(" ", "").upper() == f"V{spelled}"), None)
    if wanted is None:
        known = ", ".join(kind.versions)
        raise UnknownVersionError(f"there is no TIA Portal {tia!r} to write for", hint=f"There are {known}.")
    if version not in ("", wanted):
        raise UnknownFormatError(f"{name} is not for TIA Portal {wanted}", hint=f"Write {TIA_FORMAT} alone.")
    return f"{kind.name}-{wanted}"


TIA_FORMAT = "simaticml"
