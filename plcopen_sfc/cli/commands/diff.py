"""``plcopen-sfc diff``: what changed between two projects, in the words of an engineer."""

from __future__ import annotations

import os
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

from plcopen_sfc.cli.command_files import STANDARD_STREAM, load_input
from plcopen_sfc.cli.many_files import for_each
from plcopen_sfc.cli.options import DiffOptions
from plcopen_sfc.cli.screen import Screen
from plcopen_sfc.comparison import ChangeKind, ProjectDiff, diff
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.errors import FormatError, InputError
from plcopen_sfc.files import file_exists, folder_exists, refuse_unwritable, write_atomic
from plcopen_sfc.formats.registry import all_formats
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.project import Project

_DIFFERENCES = 1
_NO_FILE = frozenset({os.devnull, "/dev/null"})
_STYLES = {ChangeKind.ADDED: "green", ChangeKind.REMOVED: "red", ChangeKind.LAYOUT: "dim"}
_DIFF_STYLES = {"+": "green", "-": "red", "@": "cyan"}


def run(screen: Screen, before: str, after: str, how: DiffOptions) -> int:
    """Print the changes from `before` to `after`: of two files, or of all files of two folders."""
    if before == after == STANDARD_STREAM:
        raise InputError("standard input cannot be both files", hint="Name a file for one of them.")
    if how.html is not None:
        refuse_unwritable(how.html)
    try:
        found = _compared(screen, before, after, how)
    except FormatError:
        if how.html is not None or not (folder_exists(before) and folder_exists(after)):
            raise
        return _run_folders(screen, before, after, how)
    _show(screen, found)
    screen.result({"a": before, "b": after, **found.as_dict()})
    return _DIFFERENCES if how.exit_code and not found.equal else 0


def _run_folders(screen: Screen, before: str, after: str, how: DiffOptions) -> int:
    """Compare the files of two folders that are no projects themselves, each with that of the same name."""
    names = [name for name in sorted({*_files(before), *_files(after)}) if not _same_bytes(before, after, name)]
    outcomes = for_each(screen, names, partial(_compare, before, after, how), "Comparing", jobs=how.jobs, told=False)
    equal = all(each.error is None and each.value["equal"] for each in outcomes)
    if equal and not screen.quiet and not screen.as_json:
        screen.line("no differences")
    screen.result({"a": before, "b": after, "equal": equal, "files": [each.as_dict() for each in outcomes]})
    return screen.exit_code or (_DIFFERENCES if how.exit_code and not equal else 0)


def _same_bytes(before: str, after: str, name: str) -> bool:
    paths = Path(before, name), Path(after, name)
    return all(map(file_exists, paths)) and paths[0].read_bytes() == paths[1].read_bytes()


def _compare(before: str, after: str, how: DiffOptions, screen: Screen, name: str) -> dict[str, Any]:
    old, new = (str(path) if file_exists(path) else os.devnull for path in (Path(before, name), Path(after, name)))
    found = _compared(screen, old, new, how)
    if found.changes and not screen.as_json:
        screen.line((f"== {name}", "bold"))
        _show(screen, found)
    return {"file": name, **found.as_dict()}


def _files(folder: str) -> Iterator[str]:
    """Yield the files in a folder that can be programs, by their paths in it."""
    extensions = {extension for kind in all_formats() for extension in kind.extensions}
    for path in Path(folder).rglob("*"):
        if path.suffix.casefold() in extensions and path.is_file():
            yield path.relative_to(folder).as_posix()


def _compared(screen: Screen, before: str, after: str, how: DiffOptions) -> ProjectDiff:
    loaded = [_load(screen, name) for name in (before, after)]
    dialect = next((project.dialect for project in loaded if project is not None), Dialect.IEC)
    left, right = (Project(dialect=dialect) if project is None else project for project in loaded)
    found = diff(left, right, layout=how.layout, prove=how.prove, limit=how.limit)
    if how.html is not None:
        from plcopen_sfc.pages import diff_page  # noqa: PLC0415

        write_atomic(how.html, diff_page(left, right, found, lang=how.lang).encode("ascii"))
        screen.note(f"written: {how.html}")
    return found


def _show(screen: Screen, found: ProjectDiff) -> None:
    for text, kind in found.text() if found.changes or not screen.quiet else ():
        style = _STYLES.get(kind, "") if kind is not None else _DIFF_STYLES.get(text.lstrip()[:1], "")
        if not screen.as_json:
            screen.line((text, style))


def _load(screen: Screen, name: str) -> Project | None:
    """Load a file, and tell what of it no comparison has. None where git has no file."""
    if name in _NO_FILE:
        return None
    project = load_input(screen, name)
    for finding in project.diagnostics:
        if finding.severity is Severity.ERROR or finding.code in _LEFT_OUT:
            screen.finding(finding, result=False)
    return project


_LEFT_OUT = ("DIR105",)
"""Findings about files that are no part of the project of their folder."""
