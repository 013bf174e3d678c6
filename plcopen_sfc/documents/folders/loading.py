"""Reading a folder of documents as one project."""

from __future__ import annotations

import os
from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from pathlib import Path, PurePosixPath
from typing import BinaryIO, TypeVar

from plcopen_sfc.collector import collector_paused
from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.documents.file import read_document
from plcopen_sfc.documents.folders.merging import merged, shared_fields, with_objects, without_objects
from plcopen_sfc.documents.source import FolderSource, SourceDocument
from plcopen_sfc.errors import FileAccessError, Location, SfcError, UnknownFormatError, UnreadFormatError
from plcopen_sfc.files import access_failure, read_bytes
from plcopen_sfc.formats.file_recognition import HEAD, named_like
from plcopen_sfc.formats.format_interface import Format
from plcopen_sfc.formats.provenance import place_in_folder, put_in_folder
from plcopen_sfc.formats.registry import FORMATS, format_named, recognised_as
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.project_object import ProjectObject

__all__ = ["Progress", "add_document", "files_below", "load_folder", "settle"]

Progress = Callable[[Sequence[str]], Iterable[str]]
"""Goes through the files of a folder and shows somebody how far it is."""


def load_folder(
    folder: str, *, format: str | None = None, progress: Progress | None = None, as_tool: bool = False
) -> Project:
    """Read all documents below `folder` into one project; `as_tool`: as their tool sees them.

    A document that cannot be read does not keep the others from it: it is an error in `Project.diagnostics`. Raises
    `FileAccessError` where the folder cannot be read, `UnknownFormatError` where it has no document that can be.
    """
    kind = _folder_format(folder, format)
    scan = _Scan(Path(folder))
    source = FolderSource(kind.name, "", folder, {}, {}, {}, [], [])
    things: list[ProjectObject] = []
    source.unreadable.update(scan.failures)
    with collector_paused():
        for name in progress(scan.files) if progress is not None else scan.files:
            try:
                things += _read(source, kind, name, as_tool=as_tool)
            except SfcError as error:
                source.unreadable[name] = error
            except (MemoryError, RecursionError) as error:
                what = "memory" if isinstance(error, MemoryError) else "nesting"
                place = Location(str(Path(folder, name)))
                source.unreadable[name] = SfcError(f"the document takes more {what} than there is", location=place)
    source.others += scan.links
    if not source.documents:
        raise _nothing(source, kind)
    frame = merged(source.documents, kind)
    project = with_objects(frame, things)
    project.adopt()
    source.version = frame.header.version if frame.header.version in kind.versions else kind.versions[-1]
    source.shared = shared_fields(project)
    source.own_diagnostics += _findings(source, project)
    project.source = source
    return project


def _folder_format(folder: str, format: str | None) -> Format:
    known = [kind for kind in FORMATS if kind.folders]
    if format is None:
        return known[0]
    kind = format_named(format)[0]
    if not kind.folders:
        names = ", ".join(each.name for each in known)
        raise UnknownFormatError(
            f"a folder is no project in the format {kind.name}",
            location=Location(folder),
            hint=f"Folders are read in the format {names}; name the files otherwise.",
        )
    return kind


class _Scan:
    """The files below a folder, by their paths in it (with ``/``), in an order that no file system decides.

    Hidden folders and files (``.git``) are none of the project's. Links to folders are not followed: they may lead
    round in circles, or to files that are read already.
    """

    def __init__(self, top: Path) -> None:
        self._top = top
        self.files: list[str] = []
        self.links: list[str] = []
        self.failures: dict[str, SfcError] = {}
        try:
            os.scandir(top).close()
        except OSError as error:
            raise access_failure(top, error) from error
        for parent, folders, files in os.walk(top, onerror=self._failed):
            here = PurePosixPath(Path(parent).relative_to(top).as_posix())
            self.links += [(here / name).as_posix() for name in folders if Path(parent, name).is_symlink()]
            folders[:] = [name for name in folders if not name.startswith(".")]
            self.files += [(here / name).as_posix() for name in files if not name.startswith(".")]
        self.files.sort(key=lambda name: (name.casefold(), name))

    def _failed(self, error: OSError) -> None:
        name = Path(os.fsdecode(error.filename)).relative_to(self._top).as_posix()
        self.failures[name] = access_failure(error.filename, error)


def files_below(folder: str) -> list[str]:
    """The paths of all files in `folder` that are not hidden, and of links to folders."""
    scan = _Scan(Path(folder))
    return [*scan.files, *scan.links]


def _read(source: FolderSource, kind: Format, name: str, *, as_tool: bool) -> list[ProjectObject]:
    """Read one file, if it is a document of `kind`; its objects."""
    path = Path(source.path, name)
    if path.suffix.casefold() not in kind.extensions:
        source.others.append(name)
        return []
    if not recognised_as(kind, _start(path)):
        source.others.append(name)
        return []
    return add_document(source, name, read_bytes(path), as_tool=as_tool)


def _start(path: Path) -> bytes:
    """Enough of a file to know what it is: a stranger may be of any size."""
    try:
        if path.exists() and not path.is_file():
            return b""  # a pipe would wait for ever
        file: BinaryIO
        with path.open("rb") as file:
            return file.read(HEAD)
    except OSError as error:
        raise access_failure(path, error) from error


def add_document(source: FolderSource, name: str, data: bytes, *, as_tool: bool = False) -> list[ProjectObject]:
    """Make `data` the document `name` of the folder; returns its objects, which know where they are from."""
    part = read_document(data, format=source.format, path=str(Path(source.path, name)), as_tool=as_tool)
    things = list(part.objects())
    source.documents[name] = SourceDocument(without_objects(part), len(things))
    settle(things, name)
    return things


def settle(things: Iterable[ProjectObject], name: str) -> None:
    """Let objects know that they are those of the document `name`, in their order."""
    folder = PurePosixPath(name).parent.as_posix()
    for place, thing in enumerate(things):
        put_in_folder(thing, name, place, "" if folder == "." else folder)


def _nothing(source: FolderSource, kind: Format) -> SfcError:
    if source.unreadable:
        count = len(source.unreadable)
        first = next(iter(source.unreadable.values()))
        message = f"none of the {count} documents in this folder can be read; the first: {first.message}"
        return FileAccessError(message, location=Location(source.path), hint=first.hint)
    message = f"the folder has no document of {kind.name}"
    known = next((known for name in source.others if (known := named_like(name)) is not None), None)
    if known is not None:
        message = f"{message}; a file in it is {known.title}, which is not read"
        return UnreadFormatError(message, location=Location(source.path), hint=known.advice)
    hint = "Folders are read as exports of TIA Portal Openness; name files of other formats one by one."
    return UnknownFormatError(message, location=Location(source.path), hint=hint)


def _findings(source: FolderSource, project: Project) -> list[Diagnostic]:
    """What is wrong with the folder as a whole."""
    found = [
        Diagnostic("DIR101", Severity.ERROR, f"not read: {error.message}", _place(error, Path(source.path, name)))
        for name, error in source.unreadable.items()
    ]
    versions = {document.source.version for document in source.documents.values()}
    if len(versions) > 1:
        message = "the documents are of several versions: " + ", ".join(sorted(versions))
        found.append(Diagnostic("DIR104", Severity.INFO, message, Location(source.path)))
    groups: list[Sequence[ProjectObject]] = [
        [*project.pous, *project.data_blocks, *project.data_types],
        project.tag_tables,
    ]
    for group in groups:
        found += _twice(source, group, "DIR102", lambda thing: thing.name.casefold())
    found += _twice(source, project.pous, "DIR103", lambda pou: pou.number and (pou.kind, pou.number))
    found += _twice(source, project.data_blocks, "DIR103", lambda block: block.number)
    return found


T = TypeVar("T", bound=ProjectObject)


def _twice(
    source: FolderSource, things: Sequence[T], code: str, key: Callable[[T], Hashable | None]
) -> Iterator[Diagnostic]:
    """Objects that have the same `key` as one before them: its name, its number."""
    first: dict[Hashable, T] = {}
    for thing in things:
        mine = key(thing)
        other = first.setdefault(mine, thing)
        if other is not thing and mine is not None:
            message = f"{thing.name} is declared in {_file(other)} too"
            if code == "DIR103":
                message = f"{other.name}, in {_file(other)}, has the same number"
            place = Location(str(Path(source.path, _file(thing))), None, None, thing.name)
            yield Diagnostic(code, Severity.WARNING, message, place)


def _file(thing: ProjectObject) -> str:
    place = place_in_folder(thing)
    return place[0] if place is not None else ""


def _place(error: SfcError, path: Path) -> Location:
    place = error.location
    return Location(place.file or str(path), place.line, place.column, place.path)
