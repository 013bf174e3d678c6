"""Textual IEC 61131-3: read and write."""

from __future__ import annotations

from plcopen_sfc.formats.base import Reading, WriteOptions
from plcopen_sfc.formats.iectext.project_reader import read_project
from plcopen_sfc.formats.iectext.project_writer import write_project
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport


def read(data: bytes, *, file: str | None = None) -> Reading:
    """Read a text. Raises `FormatError`."""
    project, src = read_project(data.decode("utf-8-sig"), file)
    return Reading(project, src.diagnostics)


def write(project: Project, options: WriteOptions, report: ConversionReport) -> bytes:
    """Write a text anew."""
    return (write_project(project, options, report).whole() + "\n").encode()
