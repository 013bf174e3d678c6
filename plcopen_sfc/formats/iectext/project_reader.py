"""Reads whole files. The writer is `project_writer`."""

from __future__ import annotations

import re

from pydantic import ValidationError

from plcopen_sfc.errors import StructureError
from plcopen_sfc.formats.iectext.chart_reader import change
from plcopen_sfc.formats.iectext.outline import POUS, outline
from plcopen_sfc.formats.iectext.source import Remark, Source
from plcopen_sfc.formats.iectext.unit_reader import read_pou
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.pragmas import Change, Fields
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project

_DIALECT = re.compile(r"\{\s*plcopen_sfc\s+project\.dialect\s*:=\s*'(\w+)'\s*\}")


def read_project(text: str, file: str | None) -> tuple[Project, Source]:
    """The project that a text says."""
    src = Source(outline(text, _dialect(text)), file)
    for problem in src.outline.problems:
        src.note("IEC101", problem.message, problem.span[0])
    remark = Remark()
    pous: list[Pou] = []
    position = 0
    for part in src.outline.parts:
        if part.kind in POUS:
            own = _project_changes(src, position, part.start, remark)
            pous.append(read_pou(src, part, (own, part.start)))
        position = part.end
    remark.extend(src.remark(position, len(text)))
    fields: Fields = {}
    for found, offset in remark.changes:
        if found.path[0] == "project" and len(found.path) > 1:
            change(src, fields, (Change(found.path[1:], found.value), offset), "project")
    try:
        project = Project.model_validate(fields | {"pous": pous})
    except ValidationError as error:
        first = error.errors()[0]
        message = f"{'.'.join(map(str, first['loc']))}: {first['msg']}"
        raise StructureError(message, location=src.location(0)) from error
    return project, src


def _project_changes(src: Source, start: int, end: int, remark: Remark) -> int:
    """Take the pragmas that speak of the project, and return where the rest of the gap begins."""
    for comment in src.outline.comments(start, end):
        found = src.remark(*comment.span)
        if not found.changes or found.changes[0][0].path[0] not in ("project", "format"):
            break
        remark.extend(found)
        start = comment.span[1]
    return start


def _dialect(text: str) -> Dialect:
    found = _DIALECT.search(text)
    try:
        return Dialect(found.group(1)) if found is not None else Dialect.IEC
    except ValueError:
        return Dialect.IEC
