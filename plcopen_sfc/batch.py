"""Scripts that change many files: what each file becomes, and the changes on the disk.

A script is a Python file with a function ``refactor(project)``. Further parameters are its settings: they have a type
(`str`, `int`, `float` or `bool`), and a default where they may be left out.
"""

from __future__ import annotations

import difflib
import inspect
import io
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any, get_type_hints

from plcopen_sfc.analysis.processes import results
from plcopen_sfc.documents.folder_projects import edited_files, files_below
from plcopen_sfc.documents.sources import FileSource
from plcopen_sfc.documents.storage import load_project, save_project
from plcopen_sfc.errors import FormatError, Location, ScriptError, SfcError, nearest
from plcopen_sfc.formats.file_recognition import recognise
from plcopen_sfc.formats.format_interface import Format
from plcopen_sfc.model.project import Project

_START = 100_000
"""Bytes by which a file is recognised."""


@dataclass(frozen=True)
class FileChange:
    """A file that a script changes, with its content before and after; a file that is new or gone has none."""

    path: str
    before: bytes
    after: bytes


@dataclass(frozen=True)
class AppliedFile:
    """Result of a script for the project at `path`, a file or a folder. `error`: why it failed, and nothing changes."""

    path: str
    changes: tuple[FileChange, ...] = ()
    error: str = ""


def apply(
    script: str, paths: Iterable[str], *, settings: Mapping[str, str] | None = None, write: bool = False, jobs: int = 1
) -> Iterator[AppliedFile]:
    """Run a script on each of `paths` (see `project_files`), and yield what came of it, in their order.

    `settings` are texts by the names of parameters of its function ``refactor``. Files are changed with `write` only. A
    file for which the script fails stays as it is, and does not stop the others. `jobs` files are worked on at a time,
    each in a process of its own. Raises `ScriptError` for a script that cannot be run, or does not have the settings.
    """
    given = dict(settings or {})
    _function(script, given)  # before any file is touched
    yield from results(partial(_applied, script, given, write), list(paths), jobs)


def project_files(paths: Iterable[str]) -> list[str]:
    """Return files and folders that are a project each, once.

    A folder with documents of TIA Portal Openness or TwinCAT is one project; in others each file of a known format is.
    """
    found: list[str] = []
    for path in paths:
        found += _in_folder(path) if Path(path).is_dir() else [path]
    return list(dict.fromkeys(found))


def difference(change: FileChange) -> list[str]:
    """Return the lines of a unified diff, without context."""
    codec = _encoding(change.before or change.after, change.path)
    old, new = (text.decode(codec, "replace").lstrip("\ufeff").splitlines() for text in (change.before, change.after))
    return list(difflib.unified_diff(old, new, change.path, change.path, n=0, lineterm=""))


def _encoding(data: bytes, name: str) -> str:
    if not recognise(data, file=name).xml:
        return "utf-8"
    from plcopen_sfc.formats.xml.xml_parsing import detect_encoding  # noqa: PLC0415  # only for XML

    return detect_encoding(data, file=name).codec


def _in_folder(folder: str) -> list[str]:
    kinds = {name: kind for name in files_below(folder) if (kind := _kind(Path(folder, name))) is not None}
    if any(kind.folders for kind in kinds.values()):
        return [folder]
    return [str(Path(folder, name)) for name in sorted(kinds)]


def _kind(path: Path) -> Format | None:
    if not path.is_file():
        return None
    with path.open("rb") as file:
        start = file.read(_START)
    try:
        return recognise(start, file=str(path))
    except FormatError:
        return None


def _applied(script: str, settings: Mapping[str, str], write: bool, path: str) -> AppliedFile:
    function, values = _function(script, settings)
    try:
        project = load_project(path)
        function(project, **values)
        changes = tuple(_changes(project, path))
        if write and changes:
            save_project(project, path, format=project.source.format if project.source is not None else None)
        return AppliedFile(path, changes)
    except SfcError as error:
        return AppliedFile(path, error=str(error))
    except Exception as error:  # whatever a script does wrong, the other files go on
        frames = traceback.extract_tb(error.__traceback__)
        own = (each.lineno for each in reversed(frames) if Path(each.filename).resolve() == Path(script).resolve())
        line = next(own, 0)
        return AppliedFile(path, error=f"{script}:{line}: {type(error).__name__}: {error}")


def _changes(project: Project, path: str) -> Iterator[FileChange]:
    source = project.source
    if isinstance(source, FileSource):
        content = io.BytesIO()
        save_project(project, content, format=source.format)  # refuses what it would refuse on the disk
        if content.getvalue() != source.content:
            yield FileChange(path, source.content, content.getvalue())
        return
    for name, before, after in edited_files(project, path):
        yield FileChange(name, before, after)


def _function(script: str, settings: Mapping[str, str]) -> tuple[Callable[..., Any], dict[str, Any]]:
    """Return the function of a script, and its settings as values."""
    spec = spec_from_file_location("plcopen_sfc_script", script)
    if spec is None or spec.loader is None or not Path(script).is_file():
        raise ScriptError("there is no such script", location=Location(script), hint="It is a Python file.")
    module = module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
        function = getattr(module, "refactor", None)
        hints = get_type_hints(function) if callable(function) else {}
    except Exception as error:
        raise ScriptError(f"{type(error).__name__}: {error}", location=Location(script)) from error
    if not callable(function):
        raise ScriptError("the script has no function refactor(project)", location=Location(script))
    parameters = list(inspect.signature(function).parameters.values())[1:]
    names = [parameter.name for parameter in parameters]
    for name in settings:
        if name not in names:
            message = f"the script has no setting {name!r}{nearest(name, names)}"
            raise ScriptError(message, location=Location(script), hint=f"It has: {', '.join(names) or 'none'}")
    missing = [each.name for each in parameters if each.default is each.empty and each.name not in settings]
    if missing:
        hint = f"--set {missing[0]}=VALUE"
        raise ScriptError(f"the script needs the setting {missing[0]!r}", location=Location(script), hint=hint)
    return function, {name: _value(script, name, text, hints.get(name, str)) for name, text in settings.items()}


def _value(script: str, name: str, text: str, kind: Any) -> Any:
    try:
        if kind is bool:
            return {"true": True, "false": False}[text.casefold()]
        return kind(text) if kind in (int, float) else text
    except (ValueError, KeyError):
        what = {bool: "true or false", int: "a whole number", float: "a number"}[kind]
        raise ScriptError(f"the setting {name} is {what}, not {text!r}", location=Location(script)) from None
