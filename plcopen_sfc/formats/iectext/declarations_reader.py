"""Reads variable sections and types. The writer is `declarations_writer`."""

from __future__ import annotations

from plcopen_sfc.formats.iectext.layout import newlines
from plcopen_sfc.formats.iectext.outline import Part
from plcopen_sfc.formats.iectext.source import Source
from plcopen_sfc.languages.declarations import Declared, read_declarations
from plcopen_sfc.languages.pragmas import Fields, plain_fields
from plcopen_sfc.model.base import Element
from plcopen_sfc.model.variables import VariableSection


def read_section(src: Source, part: Part, gap: tuple[int, int], place: str) -> list[Fields]:
    """``VAR .. END_VAR`` with the comments before it; nothing where it is a section of configurations."""
    found = [section for section in _sections(src, part, gap, place) if isinstance(section, VariableSection)]
    return [plain_fields(section) for section in found]


def read_listing(src: Source, part: Part, gap: tuple[int, int], place: str) -> list[Fields]:
    """``VAR_ACCESS`` or ``VAR_CONFIG`` of a configuration."""
    found = _sections(src, part, gap, place)
    return [plain_fields(section) for section in found if not isinstance(section, VariableSection)]


def _sections(src: Source, part: Part, gap: tuple[int, int], place: str) -> list[Element]:
    declared = _declared(src, src.core(*gap)[0], part.end, place, "" if part.closed else "\nEND_VAR")
    return [found.thing for found in declared.items if isinstance(found.thing, Element)]


def read_types(src: Source, part: Part, gap: tuple[int, int]) -> list[Fields]:
    """``TYPE name : .. END_TYPE`` with the comments before it."""
    return [plain_fields(thing) for thing in _declared(src, src.core(*gap)[0], part.end, "", "").types]


def read_return_type(src: Source, span: tuple[int, int], place: str) -> Fields:
    """The type of the result of a function."""
    text = newlines(src.text[slice(*span)])
    heads = read_declarations(f"FUNCTION x : {text}\n", src.outline.dialect).heads
    if heads and heads[0].return_type is not None:
        return plain_fields(heads[0].return_type)
    src.note("IEC111", f"{text!r} is no type", span[0], place)
    return {"kind": "derived", "name": text}


def _declared(src: Source, start: int, end: int, place: str, missing: str) -> Declared:
    text = newlines(src.text[start:end])
    declared = read_declarations(text + missing, src.outline.dialect)
    src.check(declared.problems, start, end, text, code="IEC111", path=place)
    return declared
