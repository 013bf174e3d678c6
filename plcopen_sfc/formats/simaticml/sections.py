"""Sections of interfaces: TIA Portal has one of each kind, in a fixed order; other tools any number, in any order.

Variables of several sections of a kind stand in one, and a comment says in which they stood.
"""

from __future__ import annotations

from typing import Any

from plcopen_sfc.formats.simaticml.reading import Fields
from plcopen_sfc.model.types import Variable
from plcopen_sfc.model.variables import SectionKind, VariableSection

SECTIONS = {
    "Input": SectionKind.INPUT,
    "Output": SectionKind.OUTPUT,
    "InOut": SectionKind.IN_OUT,
    "Static": SectionKind.LOCAL,
    "Temp": SectionKind.TEMP,
    "Constant": SectionKind.CONSTANT,
    "Return": SectionKind.RETURN,
}
"""The sections of TIA Portal, in their order."""
LAYOUT = "section_layout"
"""The field of our comments that says in which sections the variables stood."""
_NAMES = {kind: name for name, kind in SECTIONS.items()}
_ORDER = list(SECTIONS)
_REMANENCE = "Remanence"
_RETAIN = "Retain"


def section_name(section: VariableSection, *, static: bool = True) -> str | None:
    """What TIA Portal calls a section; None: it has none for it. `static`: the block has static variables."""
    if holds_constants(section):
        return "Constant"
    return "Temp" if section.kind is SectionKind.LOCAL and not static else _NAMES.get(section.kind)


def holds_constants(section: VariableSection) -> bool:
    """True if the variables of a section are constants of their block, which have a section of their own here."""
    return section.kind is SectionKind.CONSTANT or (section.kind is SectionKind.LOCAL and section.constant)


def is_usual(sections: list[VariableSection], *, static: bool = True) -> bool:
    """True if TIA Portal has these sections as they are."""
    names = [section_name(section, static=static) for section in sections]
    if not static and any(section.kind is SectionKind.LOCAL and not section.constant for section in sections):
        return False
    places = [_ORDER.index(name) for name in names if name is not None]
    kept = any(section.retain or section.persistent for section in sections)
    return None not in names and places == sorted(set(places)) and not kept


def merged(sections: list[VariableSection], *, static: bool = True) -> tuple[list[VariableSection], list[Fields]]:
    """The sections that TIA Portal has for these, and what the comment says of them."""
    found: dict[str, VariableSection] = {}
    layout: list[Fields] = []
    for section in sections:
        name = section_name(section, static=static)
        if name is None:
            layout.append({"section": section.model_dump(mode="json", exclude_none=True)})
            continue
        said = section.model_dump(mode="json", exclude_none=True, exclude={"variables"})
        layout.append({"section": said, "names": [variable.name for variable in section.variables]})
        one = found.setdefault(name, VariableSection(kind=SECTIONS[name]))
        one.variables = [*one.variables, *(_retained(variable, section) for variable in section.variables)]
    return [found[name] for name in _ORDER if name in found], layout


def _retained(variable: Variable, section: VariableSection) -> Variable:
    if not (section.retain or section.persistent) or _REMANENCE in variable.attributes:
        return variable
    return variable.model_copy(update={"attributes": {_REMANENCE: _RETAIN, **variable.attributes}})


def restored(sections: list[Any], layout: list[Fields]) -> list[Any]:
    """The sections that `merged` was given; variables that came since, or are in another, stand in the first of it."""
    pool = {variable["name"]: (variable, section["kind"]) for section in sections for variable in section["variables"]}
    found: list[Any] = []
    for entry in layout:
        section: Fields = dict(entry["section"])
        if "names" in entry:
            kinds = _kinds(section)
            taken = [pool.pop(name)[0] for name in entry["names"] if name in pool and pool[name][1] in kinds]
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


def _kinds(said: Fields) -> set[SectionKind]:
    """The kinds of the sections of TIA Portal in which the variables of a section stand, in blocks and in functions."""
    section = VariableSection.model_validate(said)
    names = (section_name(section), section_name(section, static=False))
    return {SECTIONS[name] for name in names if name is not None}


def _as_before(variable: Fields) -> Fields:
    said = dict(variable.get("attributes", {}))
    if said.get(_REMANENCE) == _RETAIN:
        del said[_REMANENCE]
    return {**variable, "attributes": said}
