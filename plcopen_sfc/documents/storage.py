"""Projects in paths, binary files and folders: loading them, and saving them in a format.

`plcopen_sfc.load` and `plcopen_sfc.save` are these functions, and describe their arguments.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, Protocol, TypedDict, runtime_checkable

from plcopen_sfc.documents.file_documents import encode, normalized, read_document, refuse_losses
from plcopen_sfc.documents.save_checks import refuse_mistakes
from plcopen_sfc.documents.sources import FolderSource
from plcopen_sfc.errors import Location, UnknownFormatError, check_argument
from plcopen_sfc.files import read_bytes, refuse_empty, write_atomic
from plcopen_sfc.formats.registry import FORMATS, TIA_FORMAT, for_tia, format_named
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport

if TYPE_CHECKING:
    from plcopen_sfc.documents.folder_projects import Progress

Source = str | os.PathLike[str] | BinaryIO


@runtime_checkable
class _Readable(Protocol):
    def read(self) -> bytes: ...


@runtime_checkable
class _Writable(Protocol):
    def write(self, data: bytes, /) -> int: ...


class SaveOptions(TypedDict, total=False):
    """Options of `save_project`."""

    format: str | None
    flavour: str
    tia: str
    strict: bool
    partial: bool
    fresh: bool
    normalize: bool
    limit: float


def load_project(
    source: Source, *, format: str | None = None, progress: Progress | None = None, as_tool: bool = False
) -> Project:
    """Load a project from a path, a binary file, or a folder of documents of TIA Portal Openness."""
    if isinstance(source, str | os.PathLike):
        path = os.fspath(source)
        refuse_empty(path)
        if Path(path).is_dir():
            from plcopen_sfc.documents.folder_projects import load_folder  # noqa: PLC0415  # most projects are files

            return load_folder(path, format=format, progress=progress, as_tool=as_tool)
        return read_document(read_bytes(path), format=format, path=path, as_tool=as_tool)
    hint = "loads takes bytes." if isinstance(source, bytes | bytearray) else ""
    check_argument(source, _Readable, "load needs a path or a binary file", hint)
    content = source.read()
    check_argument(content, bytes, "load needs a file that is opened as binary", 'Open it with open(path, "rb").')
    name = getattr(source, "name", None)
    return read_document(content, format=format, path=name if isinstance(name, str) else None, as_tool=as_tool)


def save_project(
    project: Project,
    target: Source,
    *,
    format: str | None = None,
    flavour: str = "",
    tia: str = "",
    strict: bool = False,
    partial: bool = False,
    fresh: bool = False,
    normalize: bool = False,
    limit: float = 0,
) -> ConversionReport:
    """Save a project to a path, a folder or a binary file; returns what became of each item."""
    path = os.fspath(target) if isinstance(target, str | os.PathLike) else None
    if path is not None:
        refuse_empty(path)
    name = format_to_write(project, format, tia, path)
    refuse_mistakes(project, format_named(name)[0])
    if path is not None and is_folder(path, project, name):
        from plcopen_sfc.documents.folder_projects import save_folder  # noqa: PLC0415  # most projects are files

        return save_folder(
            project,
            path,
            name,
            flavour=flavour,
            strict=strict,
            partial=partial,
            fresh=fresh,
            normalize=normalize,
            limit=limit,
        )
    data, report = encode(project, name, flavour=flavour, fresh=fresh, limit=limit)
    if normalize:
        before, data = data, normalized(data, name)
        report.unchanged = report.unchanged and data == before
    refuse_losses(report, strict=strict, partial=partial)
    if isinstance(target, str | os.PathLike):
        write_atomic(target, data)
        report.written.append(os.fspath(target))
    else:
        check_argument(target, _Writable, "save needs a path or a binary file")
        target.write(data)
    return report


def format_to_write(project: Project, format: str | None, tia: str = "", path: str | None = None) -> str:
    """Return the name of the format to write: the one asked for, else that of the source or of the extension of `path`.

    An extension that the format of the source does not have decides, unless no format has it.
    """
    if tia:
        return for_tia(format or TIA_FORMAT, tia)
    if format:
        return format
    extension = Path(path).suffix.lower() if path is not None else ""
    named = [kind.name for kind in FORMATS if extension in kind.extensions]
    own = project.source.format if project.source is not None else None
    if own is not None and (not named or own in named):
        return own
    if len(named) == 1:
        return named[0]
    if named:
        message = f"files with the extension {extension} are of several formats: {', '.join(named)}"
        raise UnknownFormatError(message, location=Location(path), hint=f'Name one of them: format="{named[0]}".')
    raise UnknownFormatError(
        "the format to save in is not known: the project was not loaded from a file",
        location=Location(path),
        hint='Name one, such as format="plcopen", or save to a file with the extension of a format (.scl, .json).',
    )


def is_folder(path: str, project: Project, name: str) -> bool:
    """Return True if `path` is a folder, or is meant to become one, for `project` in the format `name`."""
    if Path(path).exists():
        return Path(path).is_dir()
    if path.endswith(("/", os.sep)):
        return True
    folders = isinstance(project.source, FolderSource) and format_named(name)[0].folders
    return folders and not Path(path).suffix
