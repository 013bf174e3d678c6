"""Data types and sections of interfaces as TIA Portal has them.

Types are spelled ``Bool``, ``Array[0..9] of "Valve"``, ``String[20]``. Of sections TIA Portal has one of each kind in a
fixed order, other tools any number in any order: variables of several sections of a kind are put into one, and a
comment keeps in which they were.
"""

from __future__ import annotations

import re
from collections.abc import Container
from typing import Any

from plcopen_sfc.formats.simaticml.element_reader import Fields
from plcopen_sfc.languages.s7_types import is_too_long
from plcopen_sfc.languages.standard_blocks import S7_VERSION
from plcopen_sfc.model import types as t
from plcopen_sfc.model.variables import SectionKind, VariableSection

_ELEMENTARY = {
    "Bool": t.Elementary.BOOL,
    "Byte": t.Elementary.BYTE,
    "Word": t.Elementary.WORD,
    "DWord": t.Elementary.DWORD,
    "LWord": t.Elementary.LWORD,
    "SInt": t.Elementary.SINT,
    "Int": t.Elementary.INT,
    "DInt": t.Elementary.DINT,
    "LInt": t.Elementary.LINT,
    "USInt": t.Elementary.USINT,
    "UInt": t.Elementary.UINT,
    "UDInt": t.Elementary.UDINT,
    "ULInt": t.Elementary.ULINT,
    "Real": t.Elementary.REAL,
    "LReal": t.Elementary.LREAL,
    "Time": t.Elementary.TIME,
    "LTime": t.Elementary.LTIME,
    "Date": t.Elementary.DATE,
    "Time_Of_Day": t.Elementary.TOD,
    "LTime_Of_Day": t.Elementary.LTOD,
    "Date_And_Time": t.Elementary.DT,
    "LDT": t.Elementary.LDT,
    "Char": t.Elementary.CHAR,
    "WChar": t.Elementary.WCHAR,
}
_IN_ANY_CASE = {name.casefold(): kind for name, kind in _ELEMENTARY.items()}
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
    """Read a data type from its spelling; `members` are those of its ``Struct``, however deep that is.

    Upper and lower case count as little as in TIA Portal: files that scripts wrote have ``BOOL``.
    """
    if (elementary := _IN_ANY_CASE.get(text.casefold())) is not None:
        return {"kind": "elementary", "name": elementary}
    if text == "Struct":
        return {"kind": "struct", "members": members or []}
    if found := _STRING.fullmatch(text):
        return {"kind": "string", "wide": bool(found[1]), "length": found[2]}
    if found := _ARRAY.fullmatch(text):
        dimensions = [part.partition("..") for part in found[1].split(",")]
        if all(separator or lower == "*" for lower, separator, _ in dimensions):
            return {
                "kind": "array",
                "dimensions": [
                    {"lower": lower.strip(), "upper": upper.strip() if separator else "*"}
                    for lower, separator, upper in dimensions
                ],
                "base": read_type(found[2], members),
            }
    if len(text) > 2 and text[0] == text[-1] == '"' and '"' not in text[1:-1]:
        return {"kind": "derived", "name": text[1:-1]}
    return {"kind": "derived", "name": text}


def write_type(type: t.DataType) -> str:
    """Return the spelling of TIA Portal for a data type."""
    if isinstance(type, t.ElementaryType):
        return _SPELLED.get(type.name, "Variant")
    if isinstance(type, t.StringType):
        return ("WString" if type.wide else "String") + (f"[{type.length}]" if type.length is not None else "")
    if isinstance(type, t.ArrayType):
        bounds = ", ".join(d.lower if d.lower == d.upper == "*" else f"{d.lower}..{d.upper}" for d in type.dimensions)
        return f"Array[{bounds}] of {write_type(type.base)}"
    if isinstance(type, t.StructType):
        return "Struct"
    if isinstance(type, t.DerivedType):
        return type.name if _SYSTEM.fullmatch(type.name) else f'"{type.name}"'
    return "Variant"


def version_of(type: t.DataType) -> str | None:
    """Return the version that a declaration names of a type of the system; None: it names none."""
    return S7_VERSION if isinstance(type, t.DerivedType) and _VERSIONED.fullmatch(type.name) else None


def struct_of(type: t.DataType) -> t.StructType | None:
    """Return the structure whose members a declaration of this type lists."""
    type = t.element_type(type)
    return type if isinstance(type, t.StructType) else None


def is_tia_type(type: t.DataType) -> bool:
    """True if TIA Portal has this type: arrays of anything but arrays (help, "Format of ARRAY")."""
    if isinstance(type, t.ArrayType):
        type = type.base
    if isinstance(type, t.ElementaryType):
        return type.name in _SPELLED
    return isinstance(type, t.StringType | t.DerivedType | t.StructType) and not is_too_long(type)


SECTIONS = {
    "Input": SectionKind.INPUT,
    "Output": SectionKind.OUTPUT,
    "InOut": SectionKind.IN_OUT,
    "Static": SectionKind.LOCAL,
    "Temp": SectionKind.TEMP,
    "Constant": SectionKind.CONSTANT,
    "Return": SectionKind.RETURN,
}
"""Sections of TIA Portal, in their order."""
LAYOUT = "section_layout"
"""Field of our comments that lists the sections in which the variables were."""
_NAMES = {kind: name for name, kind in SECTIONS.items()}
_ORDER = list(SECTIONS)
_REMANENCE = "Remanence"
_RETAIN = "Retain"


def section_name(section: VariableSection, *, static: bool = True) -> str | None:
    """Name of TIA Portal for a section; None without a counterpart. `static`: the block has static variables."""
    if holds_constants(section):
        return "Constant"
    return "Temp" if section.kind is SectionKind.LOCAL and not static else _NAMES.get(section.kind)


def holds_constants(section: VariableSection) -> bool:
    """True if the variables of a section are constants of their block, which have a section of their own here."""
    return section.kind is SectionKind.CONSTANT or (section.kind is SectionKind.LOCAL and section.constant)


def are_usual_sections(sections: list[VariableSection], *, static: bool = True) -> bool:
    """True if TIA Portal has these sections as they are."""
    names = [section_name(section, static=static) for section in sections]
    if not static and any(section.kind is SectionKind.LOCAL and not section.constant for section in sections):
        return False
    places = [_ORDER.index(name) for name in names if name is not None]
    kept = any(section.retain or section.persistent for section in sections)
    return None not in names and places == sorted(set(places)) and not kept


def merged_sections(
    sections: list[VariableSection],
    *,
    static: bool = True,
    apart: Container[str] = (),
    kept_inside: Container[str] = (),
) -> tuple[list[VariableSection], list[Fields]]:
    """Return the sections that TIA Portal has for these, and the content of the comment about them.

    `apart` are names, in lower case, of variables that are no members of the block: the comment has them.
    `kept_inside` are those of inputs that are static variables there.
    """
    found: dict[str, VariableSection] = {}
    layout: list[Fields] = []
    for section in sections:
        name = section_name(section, static=static)
        if name is None:
            layout.append({"section": section.model_dump(mode="json", exclude_none=True)})
            continue
        kept = section.model_dump(mode="json", exclude_none=True, exclude={"variables"})
        members = [variable for variable in section.variables if variable.name.casefold() not in apart]
        inside = [each for each in members if section.kind is SectionKind.INPUT and each.name.casefold() in kept_inside]
        names = [
            variable.model_dump(mode="json", exclude_none=True) if variable.name.casefold() in apart else variable.name
            for variable in section.variables
        ]
        layout.append({"section": kept, "names": names} | ({"static": [v.name for v in inside]} if inside else {}))
        for part, variables in ((name, [each for each in members if each not in inside]), ("Static", inside)):
            if variables or part == name:
                one = found.setdefault(part, VariableSection(kind=SECTIONS[part]))
                one.variables = [*one.variables, *(_retained(variable, section) for variable in variables)]
    return [found[name] for name in _ORDER if name in found], layout


def _retained(variable: t.Variable, section: VariableSection) -> t.Variable:
    if not (section.retain or section.persistent) or _REMANENCE in variable.attributes:
        return variable
    return variable.model_copy(update={"attributes": {_REMANENCE: _RETAIN, **variable.attributes}})


def restored_sections(sections: list[Any], layout: list[Fields]) -> list[Any]:
    """Sections that `merged_sections` was given; variables that are new, or moved, go into the first of a kind."""
    pool = {variable["name"]: (variable, section["kind"]) for section in sections for variable in section["variables"]}
    found: list[Any] = []
    for entry in layout:
        section: Fields = dict(entry["section"])
        if "names" in entry:
            kinds = _kinds(section)
            taken: list[Any] = []
            for name in entry["names"]:
                if not isinstance(name, str):
                    taken.append(name)
                elif name in pool and (pool[name][1] in kinds or _is_inside(name, pool[name][1], entry)):
                    taken.append(pool.pop(name)[0])
            kept = section.get("retain") or section.get("persistent")
            section["variables"] = [_as_before(variable) for variable in taken] if kept else taken
        found.append(section)
    for variable, kind in pool.values():
        fitting = next((s for s in found if s["kind"] == kind and not s.get("constant")), None)
        if fitting is None:
            found.append({"kind": kind, "variables": [variable]})
        else:
            fitting["variables"].append(variable)
    return found


def _is_inside(name: str, kind: SectionKind, entry: Fields) -> bool:
    """True if an input that was written as a static variable still is one."""
    return kind is SectionKind.LOCAL and name in entry.get("static", ())


def _kinds(kept: Fields) -> set[SectionKind]:
    """Kinds of the sections of TIA Portal in which the variables of a section go, in blocks and in functions."""
    section = VariableSection.model_validate(kept)
    names = (section_name(section), section_name(section, static=False))
    return {SECTIONS[name] for name in names if name is not None}


def _as_before(variable: Fields) -> Fields:
    kept = dict(variable.get("attributes", {}))
    if kept.get(_REMANENCE) == _RETAIN:
        del kept[_REMANENCE]
    return {**variable, "attributes": kept}
