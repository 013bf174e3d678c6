"""Projects in paths, binary files and folders: loading them, and saving them in a format.

`plcopen_sfc.load` and `plcopen_sfc.save` are these functions, and describe their arguments.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, TypedDict

from plcopen_sfc.documents.file import encode, normalized, read_document, refuse_losses
from plcopen_sfc.documents.source import FolderSource
from plcopen_sfc.errors import UnknownFormatError
from plcopen_sfc.files import read_bytes, refuse_empty, write_atomic
from plcopen_sfc.formats.registry import FORMATS, TIA_FORMAT, for_tia, format_named
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport

if TYPE_CHECKING:
    from plcopen_sfc.documents.folders.loading import Progress

Source = str | os.PathLike[str] | BinaryIO


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
            from plcopen_sfc.documents.folders.loading import load_folder  # noqa: PLC0415  # most projects are files

            return load_folder(path, format=format, progress=progress, as_tool=as_tool)
        return read_document(read_bytes(path), format=format, path=path, as_tool=as_tool)
    return read_document(source.read(), format=format, path=getattr(source, "name", None), as_tool=as_tool)


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
    if path is not None and is_folder(path, project, name):
        from plcopen_sfc.documents.folders.saving import save_folder  # noqa: PLC0415  # most projects are files

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
        target.write(data)
    return report


def format_to_write(project: Project, format: str | None, tia: str = "", path: str | None = None) -> str:
    """Return the name of the format to write: that asked for, that of the source, or that of the extension."""
    if tia:
        return for_tia(format or TIA_FORMAT, tia)
    if format:
        return format
    if project.source is not None:
        return project.source.format
    if path is not None:
        by_extension = [f.name for f in FORMATS if Path(path).suffix.lower() in f.extensions]
        if len(by_extension) == 1:
            return by_extension[0]
    raise UnknownFormatError(
        "say in which format to save: the project was not loaded from a file", hint='For example format="plcopen".'
    )


def is_folder(path: str, project: Project, name: str) -> bool:
    """Return True if `path` is a folder, or is meant to become one, for `project` in the format `name`."""
    if Path(path).exists():
        return Path(path).is_dir()
    if path.endswith(("/", os.sep)):
        return True
    folders = isinstance(project.source, FolderSource) and format_named(name)[0].folders
    return folders and not Path(path).suffix
