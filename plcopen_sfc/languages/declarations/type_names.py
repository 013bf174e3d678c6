"""Names in declarations: of elementary types and sections in each dialect, and which must be in quotes."""

from __future__ import annotations

import re

from plcopen_sfc.languages.st.declaration_nodes import KEYWORDS, tokenize_declarations
from plcopen_sfc.languages.st.lexer import STATEMENT_KEYWORDS
from plcopen_sfc.languages.words import needs_quotes
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.types import Elementary
from plcopen_sfc.model.variables import SectionKind

ELEMENTARY: dict[str, Elementary] = {name.value: name for name in Elementary} | {
    "TIME_OF_DAY": Elementary.TOD,
    "LTIME_OF_DAY": Elementary.LTOD,
    "DATE_AND_TIME": Elementary.DT,
    "LDATE_AND_TIME": Elementary.LDT,
}
"""Elementary types by any of their names, in capitals."""

UNSIGNED = frozenset({Elementary.USINT, Elementary.UINT, Elementary.UDINT, Elementary.ULINT})

_SCL_TYPES = {
    Elementary.TOD: "Time_Of_Day",
    Elementary.LTOD: "LTime_Of_Day",
    Elementary.DT: "Date_And_Time",
} | {
    Elementary[name.upper()]: name
    for name in """Bool Byte Word DWord LWord SInt Int DInt LInt USInt UInt UDInt ULInt Real LReal Time LTime Date Char
    WChar""".split()
}

SECTIONS: dict[str, tuple[SectionKind, str]] = {
    "VAR": (SectionKind.LOCAL, ""),
    "VAR_TEMP": (SectionKind.TEMP, ""),
    "VAR_INPUT": (SectionKind.INPUT, ""),
    "VAR_OUTPUT": (SectionKind.OUTPUT, ""),
    "VAR_IN_OUT": (SectionKind.IN_OUT, ""),
    "VAR_EXTERNAL": (SectionKind.EXTERNAL, ""),
    "VAR_GLOBAL": (SectionKind.GLOBAL, ""),
}
"""The kind of section of each keyword. The others (``VAR_STAT``) are local and keep their keyword."""

SECTION_KEYWORDS: dict[SectionKind, str] = {kind: word for word, (kind, _) in SECTIONS.items()} | {
    SectionKind.ACCESS: "VAR",
    SectionKind.CONSTANT: "VAR",
    SectionKind.RETURN: "VAR_OUTPUT",
}
"""The keyword of each kind of section. Access paths of TC6 POUs have no path, which VAR_ACCESS wants."""

_IDENTIFIER = re.compile(r"[^\W\d]\w*")
_RESERVED = KEYWORDS | STATEMENT_KEYWORDS | frozenset("AND OR XOR MOD TRUE FALSE NULL AND_THEN OR_ELSE BEGIN".split())
_BETWEEN = frozenset(
    """
    ON WITH TASK EXTENDS IMPLEMENTS ACTION BEGIN CLASS CONFIGURATION DATA_BLOCK NAMESPACE ORGANIZATION_BLOCK RESOURCE
    TITLE UNION USING
    """.split()
)
"""Words that tools and our reader take for names wherever a name is declared."""
_SYSTEM_TYPES = re.compile(
    r"(?:FB|FC|DB|OB|UDT|SFB|SFC)\d+|Void|Variant|Any|Pointer|Block_\w+|DTL|S5Time|Timer|Counter|Struct"
    r"|(?:IEC|HW|OB|CONN|DB|PORT|RTM|PIP|EVENT|AOM|LADDR|TADDR|TCON|TMAIL|ErrorStruct|NREF|CREF|TO)_\w+|ErrorStruct"
    r"|G7_\w+|GRAPH_BASE|RDREC|GEOADDR"
    r"|TON|TOF|TP|TONR|CTU|CTD|CTUD|R_TRIG|F_TRIG"
    r"|(?:TON|TOF|TP|TONR)_(?:L?TIME)|CTU?D?_\w+|\w+_(?:TIMER|COUNTER)|REF_TO_\w+|(?:L?TOD|LDT|DT|DATE)",
    re.IGNORECASE,
)

_NUMBERS = re.compile(r"(?:FB|FC|DB|OB|UDT)\d+", re.IGNORECASE)


def is_unreserved(name: str) -> bool:
    """True if `name` needs no quotes."""
    return _IDENTIFIER.fullmatch(name) is not None and name.upper() not in _RESERVED


def is_quoted_in_scl(type_name: str) -> bool:
    """True if a type of this name is in quotes in SCL: user types do, those of the system do not."""
    return _SYSTEM_TYPES.fullmatch(type_name) is None


def is_unit_quoted_in_scl(name: str) -> bool:
    """True if a block or type of this name is declared in quotes in SCL: all are but numbers of blocks (``FB1``)."""
    return _NUMBERS.fullmatch(name) is None


def bare_name(text: str) -> str:
    """Return a name without the quotes of SCL."""
    return text[1:-1] if len(text) > 1 and text[0] == text[-1] == '"' else text


def written_name(name: str, dialect: Dialect) -> str:
    """`name` as a declaration can have it: in quotes in SCL; elsewhere an invalid name is made valid."""
    if is_unreserved(name) or (name.upper() in _BETWEEN and dialect is not Dialect.SCL):
        return name
    if dialect in (Dialect.CODESYS, Dialect.TWINCAT) and _is_read_as_name(name, dialect):
        return name
    if dialect is Dialect.SCL:
        return '"' + re.sub(r'["\r\n]', "_", name) + '"'
    plain = re.sub(r"\W", "_", name) or "_"
    return f"_{plain}" if plain[0].isdigit() else plain if is_unreserved(plain) else f"{plain}_"


def _is_read_as_name(name: str, dialect: Dialect) -> bool:
    """True if a declaration is read with this name: keywords of CODESYS V3 are names of variables in CoDeSys 2.3."""
    first, *others = tokenize_declarations(f"{name} :", dialect).tokens
    return first.type == "NAME" and first.value == name and len(others) == 1


def declared_name(name: str, dialect: Dialect) -> str:
    """Return the name of a variable as its declaration has it: in quotes in SCL if it has them in use, unlike types."""
    return (
        f'"{name}"'
        if dialect is Dialect.SCL and is_unreserved(name) and needs_quotes(name)
        else written_name(name, dialect)
    )


def written_elementary(name: Elementary, dialect: Dialect) -> str:
    """Return the name of an elementary type as the dialect writes it."""
    return _SCL_TYPES.get(name, name.value) if dialect is Dialect.SCL else name.value
