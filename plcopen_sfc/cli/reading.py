"""Loading the files of a command one after another; one that cannot be read does not keep the others from it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from plcopen_sfc.api import load, loads
from plcopen_sfc.cli.guard import UNREADABLE, describe_exhaustion
from plcopen_sfc.cli.screen import Screen
from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import Location, SfcError
from plcopen_sfc.files import read_bytes
from plcopen_sfc.model.project import Project

__all__ = ["LoadedFile", "error_data", "exit_code_for", "finding_data", "load_each"]

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
            if Path(name).is_dir():
                project = _load_folder(screen, name, doing, bars=len(names) == 1)
            else:
                project = loads(read_bytes(name), path=name)
            findings = project.diagnostics  # reads the charts, too, while their errors can be told
            found = LoadedFile(name, project, findings)
        except SfcError as error:
            failure = error
        except (MemoryError, RecursionError) as error:
            failure = SfcError(describe_exhaustion(error), location=Location(name))
        else:
            yield found
            continue
        screen.exit_code = UNREADABLE
        screen.error(failure)
        yield LoadedFile(name, error=failure)


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
