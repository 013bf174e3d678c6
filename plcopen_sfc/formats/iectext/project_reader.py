"""Reads whole files. The writer is `project_writer`."""

from __future__ import annotations

import re

from pydantic import ValidationError

from plcopen_sfc.errors import StructureError
from plcopen_sfc.formats.iectext.chart_reader import change
from plcopen_sfc.formats.iectext.config_reader import read_configuration, read_global_section
from plcopen_sfc.formats.iectext.declarations_reader import read_listing, read_types
from plcopen_sfc.formats.iectext.layout import newlines
from plcopen_sfc.formats.iectext.outline import POUS, Kind, Part, outline
from plcopen_sfc.formats.iectext.source import Remark, Source, wrapped
from plcopen_sfc.formats.iectext.unit_reader import read_pou
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.pragmas import Change, Fields
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project

_DIALECT = re.compile(r"\{\s*plcopen_sfc\s+project\.dialect\s*:=\s*'(\w+)'\s*\}")


def read_project(text: str, file: str | None) -> tuple[Project, Source]:
    """The project that a text says."""
    src = Source(outline(text, dialect_of(text)), file)
    for problem in src.outline.structure:
        src.note("IEC101", problem.message, problem.span[0])
    remark = Remark()
    fields: Fields = {}
    pous: list[Pou] = []
    position = 0
    for part in src.outline.parts:
        gap = (_project_changes(src, position, part.start, remark), part.start)
        position = part.end
        if part.kind in POUS:
            pous.append(read_pou(src, part, gap))
        else:
            _read_unit(src, part, gap, fields)
    for problem in src.outline.found.problems:  # those in bodies were told with their bodies
        if not any(start <= problem.span[0] < end for start, end in src.checked):
            src.note("IEC100", problem.message, problem.span[0])
    remark.extend(src.remark(position, len(text)))
    remark.put_into(fields)
    for found, offset in remark.changes:
        if found.path[0] == "project" and len(found.path) > 1:
            change(src, fields, (Change(found.path[1:], found.value, found.instead), offset), "project")
    try:
        project = Project.model_validate(fields | {"pous": pous})
    except ValidationError as error:
        first = error.errors()[0]
        message = f"{'.'.join(map(str, first['loc']))}: {first['msg']}"
        path = ("project", *first["loc"])
        offsets = (offset for found, offset in remark.changes if found.path == path[: len(found.path)])
        raise StructureError(message, location=src.location(next(offsets, 0))) from error
    return project, src


def _read_unit(src: Source, part: Part, gap: tuple[int, int], fields: Fields) -> None:
    if part.kind is Kind.TYPE:
        fields.setdefault("data_types", []).extend(_read_types(src, part, gap))
    elif part.kind is Kind.VAR and part.keyword == "VAR_CONFIG":
        for section in read_listing(src, part, gap, ""):
            known = fields.setdefault("config_variables", section)
            if known is not section:
                known.setdefault("variables", []).extend(section.get("variables", []))
    elif part.kind is Kind.VAR and part.keyword == "VAR_GLOBAL":
        fields.setdefault("global_variables", []).extend(read_global_section(src, part, gap, ""))
    elif part.kind is Kind.CONFIGURATION:
        found, application = read_configuration(src, part, gap)
        also = found.keys() - {"name", "resources"}
        if application and len(found.get("resources", ())) == 1 and not also:
            fields.setdefault("applications", []).extend(found["resources"])
        else:
            fields.setdefault("configurations", []).append(found)
    else:
        if part.kind is Kind.LOOSE:
            src.note("IEC107", "this belongs to no unit: PROGRAM, FUNCTION_BLOCK, FUNCTION, TYPE ..", part.start)
        data = wrapped("unit", newlines(src.text[gap[0] : part.end]).strip())
        fields.setdefault("carried", {}).setdefault("data", []).append(data)


def _read_types(src: Source, part: Part, gap: tuple[int, int]) -> list[Fields]:
    types = read_types(src, part, gap)
    remark = src.remark(*gap)
    for fields in types[:1]:
        typed = [c for c, _ in remark.changes if c.path == ("declaration_ends",)]
        if typed:
            start = src.core(*gap)[0]
            start += len(src.text[start : part.start]) - len(src.text[start : part.start].lstrip())
            fields["declaration"] = newlines(src.text[start : part.end]) + str(typed[0].value)
        for found in remark.changes:
            if found[0].path != ("declaration_ends",):
                change(src, fields, found, f"data type {fields.get('name', '')}")
    return types


def _project_changes(src: Source, start: int, end: int, remark: Remark) -> int:
    """Take the pragmas that speak of the project, and return where the rest of the gap begins."""
    for comment in src.outline.comments(start, end):
        found = src.remark(*comment.span)
        if not found.changes or found.changes[0][0].path[0] not in ("project", "format"):
            break
        remark.extend(found)
        start = comment.span[1]
    return start


def dialect_of(text: str) -> Dialect:
    """The dialect that a text says it is in."""
    found = _DIALECT.search(text)
    try:
        return Dialect(found.group(1)) if found is not None else Dialect.IEC
    except ValueError:
        return Dialect.IEC
