"""The files of a command: finding and loading them, and writing to standard output."""

from __future__ import annotations

import glob
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from plcopen_sfc.api import load, loads
from plcopen_sfc.cli.screen import UNREADABLE, Screen
from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import FileAccessError, Location, SfcError, told_when_exhausted
from plcopen_sfc.files import folder_exists, path_exists
from plcopen_sfc.model.project import Project

STANDARD_STREAM = "-"
"""The name of standard input and standard output, in every command."""


_FINDINGS = 1


@dataclass(frozen=True)
class LoadedFile:
    """A file or folder that was asked for: its project, or why there is none."""

    name: str
    project: Project | None = None
    findings: tuple[Diagnostic, ...] = ()
    error: SfcError | None = None


def load_each(screen: Screen, names: Sequence[str], doing: str = "Reading") -> Iterator[LoadedFile]:
    """Load every file. The error of one that cannot be read is printed and noted in the exit code."""
    for name in screen.progress(names, doing):
        try:
            screen.detail(f"reading {name}")
            with told_when_exhausted(name):
                if folder_exists(name):
                    project = _load_folder(screen, name, doing, bars=len(names) == 1)
                else:
                    project = load_input(screen, name)
                findings = project.diagnostics  # reads the charts, too, while their errors can be reported
            found = LoadedFile(name, project, findings)
        except SfcError as error:
            failure = error
        else:
            yield found
            continue
        screen.exit_code = UNREADABLE
        screen.error(failure)
        yield LoadedFile(name, error=failure)


def load_input(screen: Screen, name: str, *, as_tool: bool = False) -> Project:
    """Load a file, a folder or standard input (``-``)."""
    if name == STANDARD_STREAM:
        return loads(sys.stdin.buffer.read(), path="standard input", as_tool=as_tool)
    return load(name, progress=lambda files: screen.progress(files, "Loading"), as_tool=as_tool)


@contextmanager
def written_to_stdout(screen: Screen, target: str, extension: str) -> Iterator[str]:
    """Give the path to write to: `target`, or for ``-`` that of a file which goes to standard output in the end.

    What the command prints goes to standard error then. Raises `SfcError` where that is to be JSON.
    """
    if target != STANDARD_STREAM:
        yield target
        return
    if screen.as_json:
        hint = "Write the report to a file: --report FILE.json."
        raise SfcError("the file and the JSON report cannot both go to standard output", hint=hint)
    screen.results_to_stderr = True
    with TemporaryDirectory() as folder:
        path = Path(folder, f"stdout{extension}")
        yield str(path)
        if path.exists():
            sys.stdout.flush()
            sys.stdout.buffer.write(path.read_bytes())


def _load_folder(screen: Screen, name: str, doing: str, *, bars: bool) -> Project:
    """Load a folder and read all that is in it, with progress bars if no other one runs already."""
    if not bars:
        return load(name)
    project = load(name, progress=lambda files: screen.progress(files, "Loading"))
    for thing in screen.progress(list(project.objects()), doing):
        thing.read()
    return project


def exit_code_for(screen: Screen, findings: Sequence[Diagnostic]) -> int:
    """The exit code so far, worsened by findings that are errors."""
    return max(screen.exit_code, _FINDINGS if any(f.severity is Severity.ERROR for f in findings) else 0)


def finding_data(finding: Diagnostic) -> dict[str, Any]:
    """A finding as plain data, for JSON."""
    data = {
        "code": finding.code,
        "severity": finding.severity.value,
        "message": finding.message,
        **_place(finding.location),
    }
    return data | ({"hint": finding.hint} if finding.hint else {})


def error_data(error: SfcError) -> dict[str, Any]:
    """An error as plain data, for JSON."""
    data = {"type": type(error).__name__, "message": error.message, **_place(error.location)}
    return data | ({"hint": error.hint} if error.hint else {})


def _place(location: Location) -> dict[str, Any]:
    fields = {"file": location.file, "line": location.line, "column": location.column, "path": location.path}
    return {key: value for key, value in fields.items() if value is not None}


def expand(names: Iterable[str]) -> list[str]:
    """The files that `names` mean, each once. Raises `FileAccessError` where a pattern matches nothing."""
    found: list[str] = []
    for name in names:
        if not glob.has_magic(name) or path_exists(name):
            found.append(name)
            continue
        matching = sorted(match for match in glob.glob(name) if not folder_exists(match))  # noqa: PTH207  # any path
        if not matching:
            hint = "Check the pattern and the working folder."
            raise FileAccessError("no file matches this pattern", location=Location(name), hint=hint)
        found += matching
    return list(dict.fromkeys(found))
