"""Where the objects of a project stand in its files, for messages and reports."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from plcopen_sfc.documents.folders.parts import documents_of
from plcopen_sfc.documents.source import FileSource
from plcopen_sfc.errors import FormatError, Location
from plcopen_sfc.formats.registry import format_named
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import line_of


def locations_of(project: Project, paths: Iterable[str]) -> list[Location]:
    """The places of objects by their paths (``POU Main / step S3``), each with its path.

    The file is that of the document, in a folder the one that has the POU. The line is that of the object or of what is
    around it, as far as the format tells; there is none in a project that was not loaded.
    """
    documents = {pou.name: document for document in documents_of(project) for pou in document.pous}
    known: dict[int, tuple[str | None, Mapping[str, int]]] = {}
    found: list[Location] = []
    for path in paths:
        document = documents.get(path.partition(" / ")[0].removeprefix("POU "))
        if document is None:
            found.append(Location(path=path))
            continue
        if id(document) not in known:
            known[id(document)] = _lines(document)
        file, lines = known[id(document)]
        found.append(Location(file, line_of(path, lines), None, path))
    return found


def _lines(document: Project) -> tuple[str | None, Mapping[str, int]]:
    """The name of the file that a document was read from, and the lines of its objects by their paths."""
    source = document.source
    if not isinstance(source, FileSource):
        return None, {}
    codec = format_named(source.format)[0].codec()
    try:
        return source.path, codec.lines(source.content, document)
    except FormatError:  # the project was read with another format than its content has
        return source.path, {}
