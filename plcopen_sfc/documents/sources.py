"""Sources of a project: the file or the folder that it was read from, and the places of objects in them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import chain
from typing import TYPE_CHECKING, Any, NamedTuple

from plcopen_sfc.errors import FormatError, Location, listed_names
from plcopen_sfc.formats.provenance import place_in_folder
from plcopen_sfc.formats.registry import format_named
from plcopen_sfc.model.late import ProjectObject
from plcopen_sfc.model.project import Project
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.report import line_of

if TYPE_CHECKING:
    from plcopen_sfc.diagnostics import Diagnostic
    from plcopen_sfc.errors import SfcError


@dataclass
class FileSource:
    """The file that a project was read from; what saving needs to write only the edits.

    `fingerprint` is that of the project as it was read. `path` is None for bytes without a name. `errors_accepted`:
    see `Project.accept_errors`. `saved`: what was written to the path since.
    """

    format: str
    version: str
    content: bytes
    fingerprint: bytes
    path: str | None
    diagnostics: list[Diagnostic]
    errors_accepted: bool = False
    saved: bytes | None = None

    def __repr__(self) -> str:
        place = f"{self.path}, " if self.path else ""
        return f"FileSource({place}{self.format} {self.version}, {len(self.content):,} bytes)"

    @property
    def is_folder(self) -> bool:
        """False: all objects are in one file."""
        return False

    def accept_errors(self) -> None:
        """See `Project.accept_errors`."""
        self.errors_accepted = True

    def __deepcopy__(self, memo: dict[int, Any]) -> FileSource:
        """Copies of a project come from the same file."""
        return replace(self)


class SourceDocument(NamedTuple):
    """One document of a folder: a project with what is beside its objects, and how many objects it has."""

    frame: Project
    objects: int

    @property
    def source(self) -> FileSource:
        """The file that the document was read from."""
        if not isinstance(self.frame.source, FileSource):
            raise TypeError("a document is read from one file")
        return self.frame.source


@dataclass
class FolderSource:
    """The folder that a project was read from; what saving needs to touch changed files only.

    `path` is the folder, `documents` are by their path in it. `version` is the newest of theirs. `shared` is what the
    project has beside its objects, as it was read. `unreadable` are documents that could not be read, and why; `others`
    the files that do not belong to the project.
    """

    format: str
    version: str
    path: str
    documents: dict[str, SourceDocument] = field(default_factory=dict)
    shared: dict[str, Any] = field(default_factory=dict)
    unreadable: dict[str, SfcError] = field(default_factory=dict)
    others: list[str] = field(default_factory=list)
    own_diagnostics: list[Diagnostic] = field(default_factory=list)
    errors_accepted: bool = False

    def __repr__(self) -> str:
        return f"FolderSource({self.path}, {self.format} {self.version}, {len(self.documents)} documents)"

    @property
    def is_folder(self) -> bool:
        """True: each object has a file of its own."""
        return True

    @property
    def diagnostics(self) -> list[Diagnostic]:
        """Findings about the folder, and about its documents."""
        of_documents = (document.source.diagnostics for document in self.documents.values())
        return [*self.own_diagnostics, *chain.from_iterable(of_documents)]

    def accept_errors(self) -> None:
        """See `Project.accept_errors`."""
        self.errors_accepted = True
        for document in self.documents.values():
            document.source.accept_errors()

    def __deepcopy__(self, memo: dict[int, Any]) -> FolderSource:
        """Copies of a project come from the same files, but each is saved by itself."""
        return replace(self, documents=dict(self.documents))


def with_objects(frame: Project, things: Iterable[ProjectObject]) -> Project:
    """Return a copy of `frame` with `things`, in their order."""
    lists: dict[str, list[ProjectObject]] = {name: [] for name in Project.OBJECTS}
    for thing in things:
        lists[_LIST_OF[type(thing).__name__]].append(thing)
    return frame.model_copy(update=lists)


_LIST_OF = {"TagTable": "tag_tables", "DataTypeDeclaration": "data_types", "DataBlock": "data_blocks", "Pou": "pous"}


def documents_of(project: Project) -> Iterator[Project]:
    """Yield the documents that a project was read from, each as a project with the very objects that are in it.

    A project that was not read from a folder is its one document. Objects that are in no document come last.
    """
    source = project.source
    if not isinstance(source, FolderSource):
        yield project
        return
    things: dict[str, list[ProjectObject]] = {path: [] for path in source.documents}
    new: list[ProjectObject] = []
    for thing in project.objects():
        place = place_in_folder(thing)
        path = place[0] if place is not None else ""
        things.get(path, new).append(thing)
    for path, document in source.documents.items():
        yield with_objects(document.frame, things[path])
    if new:
        yield with_objects(Project(dialect=project.dialect), new)


def locations_of(project: Project, paths: Iterable[str]) -> list[Location]:
    """Return the places of objects by their paths (``POU Main / step S3``), each with its path.

    The file is that of the document, in a folder the one that has the POU or the type. The line is that of the object
    or of what is around it, as far as the format tells; there is none in a project that was not loaded.
    """
    read = [*documents_of(project)]
    documents = {each.report_path: document for document in read for each in (*document.pous, *document.data_types)}
    only = read[0] if len(read) == 1 else None
    known: dict[int, tuple[str | None, Mapping[str, int]]] = {}
    found: list[Location] = []
    for path in listed_names(paths, "paths of objects are texts: POU Main / step S3"):
        document = documents.get(ObjectPath.of(path).owner, only)
        if document is None:
            found.append(Location(path=path))
            continue
        if id(document) not in known:
            known[id(document)] = _lines(document)
        file, lines = known[id(document)]
        inside = _IN_PARTIAL_CHART.sub(r" / \2 / \1 ", path, count=1)
        found.append(Location(file, line_of(inside if inside in lines else path, lines), None, path))
    return found


_IN_PARTIAL_CHART = re.compile(r" / (step|transition) (?:\S+\.)?(\w+)\.(?=\S)")
"""``step G1.M3.E3`` of a net, which has the steps of all partial charts: step E3 of M3."""


def _lines(document: Project) -> tuple[str | None, Mapping[str, int]]:
    """Return the name of the file that a document was read from, and the lines of its objects by their paths."""
    source = document.source
    if not isinstance(source, FileSource):
        return None, {}
    codec = format_named(source.format)[0].codec()
    try:
        return source.path, codec.lines(source.content, document)
    except FormatError:  # the project was read with another format than its content has
        return source.path, {}
