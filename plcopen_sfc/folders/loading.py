"""Reading a folder of documents as one project."""

from __future__ import annotations

import os
from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from pathlib import Path, PurePosixPath
from typing import BinaryIO, TypeVar

from plcopen_sfc.collector import collector_paused
from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.documents import read_document
from plcopen_sfc.errors import FileAccessError, Location, SfcError, UnknownFormatError, UnreadFormatError
from plcopen_sfc.files import access_failure, read_bytes
from plcopen_sfc.folders.merging import merged, shared_fields, with_objects, without_objects
from plcopen_sfc.formats.base import Format
from plcopen_sfc.formats.head import HEAD
from plcopen_sfc.formats.registry import FORMATS, format_named, recognised_as
from plcopen_sfc.formats.unread import named_like
from plcopen_sfc.model.project import FolderOrigin, Project, SourceDocument
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
    origin = FolderOrigin(kind.name, "", folder, {}, {}, {}, [], [])
    things: list[ProjectObject] = []
    origin.unreadable.update(scan.failures)
    with collector_paused():
        for name in progress(scan.files) if progress is not None else scan.files:
            try:
                things += _read(origin, kind, name, as_tool=as_tool)
            except SfcError as error:
                origin.unreadable[name] = error
            except (MemoryError, RecursionError) as error:
                what = "memory" if isinstance(error, MemoryError) else "nesting"
                place = Location(str(Path(folder, name)))
                origin.unreadable[name] = SfcError(f"the document takes more {what} than there is", location=place)
    origin.others += scan.links
    if not origin.documents:
        raise _nothing(origin, kind)
    frame = merged(origin.documents, kind)
    project = with_objects(frame, things)
    origin.version = frame.header.version if frame.header.version in kind.versions else kind.versions[-1]
    origin.shared = shared_fields(project)
    origin.own_diagnostics += _findings(origin, project)
    project._origin = origin
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


def _read(origin: FolderOrigin, kind: Format, name: str, *, as_tool: bool) -> list[ProjectObject]:
    """Read one file, if it is a document of `kind`; its objects."""
    path = Path(origin.path, name)
    if path.suffix.casefold() not in kind.extensions:
        origin.others.append(name)
        return []
    if not recognised_as(kind, _start(path)):
        origin.others.append(name)
        return []
    return add_document(origin, name, read_bytes(path), as_tool=as_tool)


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


def add_document(origin: FolderOrigin, name: str, data: bytes, *, as_tool: bool = False) -> list[ProjectObject]:
    """Make `data` the document `name` of the folder; returns its objects, which know where they are from."""
    part = read_document(data, format=origin.format, path=str(Path(origin.path, name)), as_tool=as_tool)
    things = list(part.objects())
    origin.documents[name] = SourceDocument(without_objects(part), len(things))
    settle(things, name)
    return things


def settle(things: Iterable[ProjectObject], name: str) -> None:
    """Let objects know that they are those of the document `name`, in their order."""
    folder = PurePosixPath(name).parent.as_posix()
    for place, thing in enumerate(things):
        thing.settle((name, place), "" if folder == "." else folder)


def _nothing(origin: FolderOrigin, kind: Format) -> SfcError:
    if origin.unreadable:
        count = len(origin.unreadable)
        first = next(iter(origin.unreadable.values()))
        message = f"none of the {count} documents in this folder can be read; the first: {first.message}"
        return FileAccessError(message, location=Location(origin.path), hint=first.hint)
    message = f"the folder has no document of {kind.name}"
    known = next((known for name in origin.others if (known := named_like(name)) is not None), None)
    if known is not None:
        message = f"{message}; a file in it is {known.title}, which is not read"
        return UnreadFormatError(message, location=Location(origin.path), hint=known.advice)
    hint = "Folders are read as exports of TIA Portal Openness; name files of other formats one by one."
    return UnknownFormatError(message, location=Location(origin.path), hint=hint)


def _findings(origin: FolderOrigin, project: Project) -> list[Diagnostic]:
    """What is wrong with the folder as a whole."""
    found = [
        Diagnostic("DIR101", Severity.ERROR, f"not read: {error.message}", _place(error, Path(origin.path, name)))
        for name, error in origin.unreadable.items()
    ]
    versions = {document.origin.version for document in origin.documents.values()}
    if len(versions) > 1:
        message = "the documents are of several versions: " + ", ".join(sorted(versions))
        found.append(Diagnostic("DIR104", Severity.INFO, message, Location(origin.path)))
    groups: list[Sequence[ProjectObject]] = [
        [*project.pous, *project.data_blocks, *project.data_types],
        project.tag_tables,
    ]
    for group in groups:
        found += _twice(origin, group, "DIR102", lambda thing: thing.name.casefold())
    found += _twice(origin, project.pous, "DIR103", lambda pou: pou.number and (pou.kind, pou.number))
    found += _twice(origin, project.data_blocks, "DIR103", lambda block: block.number)
    return found


T = TypeVar("T", bound=ProjectObject)


def _twice(
    origin: FolderOrigin, things: Sequence[T], code: str, key: Callable[[T], Hashable | None]
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
            place = Location(str(Path(origin.path, _file(thing))), None, None, thing.name)
            yield Diagnostic(code, Severity.WARNING, message, place)


def _file(thing: ProjectObject) -> str:
    return thing._home[0] if thing._home is not None else ""


def _place(error: SfcError, path: Path) -> Location:
    place = error.location
    return Location(place.file or str(path), place.line, place.column, place.path)
