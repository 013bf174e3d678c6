"""From bytes to a project, for TC6 XML and the dialects that stand on it."""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from pydantic import ValidationError

from plcopen_sfc.errors import Location, StructureError
from plcopen_sfc.formats.base import Reading
from plcopen_sfc.formats.plcopen.project_reader import find_version, read_project
from plcopen_sfc.formats.plcopen.reading import DataReader, Fields, ReadContext
from plcopen_sfc.formats.xml.source import parse
from plcopen_sfc.model.project import Project


def load(
    data: bytes,
    *,
    file: str | None = None,
    data_readers: dict[str, DataReader] | None = None,
    usual_text_element: str = "p",
    finish_chart: Callable[[ReadContext, Fields], None] | None = None,
) -> Reading:
    """Read a TC6 file. Raises `FormatError` where it cannot be read at all."""
    with _collector_paused():
        root = parse(data, file=file)
        version = find_version(root, file=file)
        fields, ctx = read_project(
            root,
            version,
            file=file,
            data_readers=data_readers,
            usual_text_element=usual_text_element,
            finish_chart=finish_chart,
        )
        try:
            project = Project.model_validate(fields)
        except ValidationError as error:
            first = error.errors()[0]
            path = ".".join(map(str, first["loc"]))
            raise StructureError(
                f"carried data does not fit the model at {path}: {first['msg']}", location=Location(file)
            ) from error
    return Reading(project, ctx.diagnostics)


@contextmanager
def _collector_paused() -> Iterator[None]:
    """Reading creates many objects that all live on; looking for garbage among them takes longer than the reading."""
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()
