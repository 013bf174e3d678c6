"""From bytes to a project, for TC6 XML and the dialects that stand on it."""

from __future__ import annotations

from collections.abc import Callable

from pydantic import ValidationError

from plcopen_sfc.collector import collector_paused
from plcopen_sfc.formats.format_interface import ReadResult
from plcopen_sfc.formats.plcopen.body_reader import misfit
from plcopen_sfc.formats.plcopen.project_reader import find_version, read_project
from plcopen_sfc.formats.plcopen.reading import DataReader, Fields, ReadContext
from plcopen_sfc.formats.xml.xml_parsing import SourceLines, parse
from plcopen_sfc.model.project import Project


def load(
    data: bytes,
    *,
    file: str | None = None,
    data_readers: dict[str, DataReader] | None = None,
    usual_text_element: str = "p",
    placeless: bool = False,
    finish_chart: Callable[[ReadContext, Fields], None] | None = None,
) -> ReadResult:
    """Read a TC6 file. Raises `FormatError` where it cannot be read at all."""
    with collector_paused():
        root = parse(data, file=file)
        version = find_version(root, file=file)
        fields, ctx = read_project(
            root,
            version,
            file=file,
            lines=SourceLines(root, data),
            data_readers=data_readers,
            usual_text_element=usual_text_element,
            placeless=placeless,
            finish_chart=finish_chart,
        )
        try:
            project = Project.model_validate(fields)
        except ValidationError as error:
            raise misfit(error, file) from error
    return ReadResult(project, ctx.diagnostics, version.name)
