"""Reads variable sections and types of values. The writer is `declarations_writer`."""

from __future__ import annotations

from plcopen_sfc.formats.iectext.outline import Part
from plcopen_sfc.formats.iectext.source import Source
from plcopen_sfc.languages.pragmas import Fields


def read_section(src: Source, part: Part, gap: tuple[int, int], place: str) -> list[Fields]:
    return []


def read_return_type(src: Source, span: tuple[int, int], place: str) -> Fields:
    return {"kind": "derived", "name": src.text[span[0] : span[1]]}
