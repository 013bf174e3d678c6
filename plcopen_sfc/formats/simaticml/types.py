"""Data types as TIA Portal spells them: ``Bool``, ``Array[0..9] of "Valve"``, ``String[20]``."""

from __future__ import annotations

import re

from plcopen_sfc.formats.simaticml.reading import Fields
from plcopen_sfc.languages.standard_blocks import S7_VERSION
from plcopen_sfc.model.types import (
    ArrayType,
    DataType,
    DerivedType,
    Elementary,
    ElementaryType,
    StringType,
    StructType,
)

_ELEMENTARY = {
    "Bool": Elementary.BOOL,
    "Byte": Elementary.BYTE,
    "Word": Elementary.WORD,
    "DWord": Elementary.DWORD,
    "LWord": Elementary.LWORD,
    "SInt": Elementary.SINT,
    "Int": Elementary.INT,
    "DInt": Elementary.DINT,
    "LInt": Elementary.LINT,
    "USInt": Elementary.USINT,
    "UInt": Elementary.UINT,
    "UDInt": Elementary.UDINT,
    "ULInt": Elementary.ULINT,
    "Real": Elementary.REAL,
    "LReal": Elementary.LREAL,
    "Time": Elementary.TIME,
    "LTime": Elementary.LTIME,
    "Date": Elementary.DATE,
    "Time_Of_Day": Elementary.TOD,
    "LTime_Of_Day": Elementary.LTOD,
    "Date_And_Time": Elementary.DT,
    "LDT": Elementary.LDT,
    "Char": Elementary.CHAR,
    "WChar": Elementary.WCHAR,
}
_SPELLED = {kind: name for name, kind in _ELEMENTARY.items()}
_STRING = re.compile(r"(W?)String(?:\[([^\]]+)\])?")
_ARRAY = re.compile(r"Array\[([^\]]+)\] of (.+)")
_SYSTEM = re.compile(
    r"(?:TON|TOF|TP|TONR|IEC|CTU|CTD|CTUD|G7|HW|OB|DB|CONN|TCON|PORT|EVENT|AOM|PIP|RTM|LOG)_\w+|[CU]?Void|DTL|S5Time"
    r"|Timer|Counter|Variant|Any|Pointer|[RF]_TRIG|REMOTE|RDREC|WRREC|TADDR_Param|TSEND_C|TRCV_C|GEOADDR|NREF|CREF"
    r"|Block_\w+|ErrorStruct|Struct|TIMEZONE|STARTINFO|CONDITIONS|SSL_HEADER|VREF|STRING|ARRAY"
)
"""Types of the system, which are not quoted as those of users are."""
_VERSIONED = re.compile(r"(?:TON|TOF|TP|TONR|IEC|CTU|CTD|CTUD)_\w+|[RF]_TRIG")


def read_type(text: str, members: list[Fields] | None = None) -> Fields:
    """A data type from its spelling; `members` are those of its ``Struct``, however deep that is."""
    if text in _ELEMENTARY:
        return {"kind": "elementary", "name": _ELEMENTARY[text]}
    if text == "Struct":
        return {"kind": "struct", "members": members or []}
    if found := _STRING.fullmatch(text):
        return {"kind": "string", "wide": bool(found[1]), "length": found[2]}
    if found := _ARRAY.fullmatch(text):
        dimensions = [part.partition("..") for part in found[1].split(",")]
        if all(separator or lower == "*" for lower, separator, _ in dimensions):
            return {
                "kind": "array",
                "dimensions": [{"lower": lower.strip(), "upper": upper.strip()} for lower, _, upper in dimensions],
                "base": read_type(found[2], members),
            }
    if len(text) > 2 and text[0] == text[-1] == '"' and '"' not in text[1:-1]:
        return {"kind": "derived", "name": text[1:-1]}
    return {"kind": "derived", "name": text}


def write_type(type: DataType) -> str:
    """How TIA Portal spells a data type."""
    if isinstance(type, ElementaryType):
        return _SPELLED.get(type.name, "Variant")
    if isinstance(type, StringType):
        return ("WString" if type.wide else "String") + (f"[{type.length}]" if type.length is not None else "")
    if isinstance(type, ArrayType):
        bounds = ", ".join(f"{d.lower}..{d.upper}" if d.upper else d.lower for d in type.dimensions)
        return f"Array[{bounds}] of {write_type(type.base)}"
    if isinstance(type, StructType):
        return "Struct"
    if isinstance(type, DerivedType):
        return type.name if _SYSTEM.fullmatch(type.name) else f'"{type.name}"'
    return "Variant"


def version_of(type: DataType) -> str | None:
    """The version that a declaration names of a type of the system; None: it names none."""
    return S7_VERSION if isinstance(type, DerivedType) and _VERSIONED.fullmatch(type.name) else None


def struct_of(type: DataType) -> StructType | None:
    """The structure whose members a declaration of this type lists."""
    while isinstance(type, ArrayType):
        type = type.base
    return type if isinstance(type, StructType) else None


def is_sayable(type: DataType) -> bool:
    """Whether TIA Portal has this type."""
    while isinstance(type, ArrayType):
        type = type.base
    if isinstance(type, ElementaryType):
        return type.name in _SPELLED
    return isinstance(type, StringType | DerivedType | StructType)
