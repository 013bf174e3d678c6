"""Writes whole projects. The reader is `project_reader`."""

from __future__ import annotations

from plcopen_sfc.formats.base import WriteOptions
from plcopen_sfc.formats.iectext.printing import Piece, Printer, comment_lines, pragmas, split
from plcopen_sfc.formats.iectext.unit_writer import write_pou
from plcopen_sfc.languages.pragmas import Change, Fields, changes, plain_fields
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport, Fate

VERSION = 1
_UNITS = frozenset({"pous"})


def write_project(project: Project, _options: WriteOptions, report: ConversionReport) -> Piece:
    """The text of a project."""
    printer = Printer(project.dialect, report)
    meant = plain_fields(project, leave=_UNITS)
    said: Fields = {}
    found = [Change(("project", *c.path), c.value) for c in changes(said, meant)]
    for change in found:
        printer.note(Fate.CARRIED, str(change.path[1]).replace("_", " "), "project", "IEC text cannot say it")
    near, late = split(found)
    top = pragmas([Change(("format",), VERSION), *near], "")
    parts: list[Piece | str] = [(comment_lines(meant, said, "") and "") or "", top]
    for pou in project.pous:
        parts += ["\n", write_pou(printer, pou)]
    if late:
        parts.append("\n" + pragmas(late, ""))
    return Piece("project", parts)
