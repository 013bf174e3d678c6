"""The file of a command: loading it, telling what is wrong with it, and writing to standard output."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from plcopen_sfc.api import load, loads
from plcopen_sfc.cli.screen import Screen
from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.documents.storage import format_of_extension
from plcopen_sfc.errors import InputError, Location, SfcError
from plcopen_sfc.formats.registry import TIA_FORMAT
from plcopen_sfc.model.project import Project

STANDARD_STREAM = "-"
"""The name of standard input and standard output, in every command."""

_FINDINGS = 1


def names_in(given: list[str] | None) -> tuple[str, ...]:
    """Return the names of an option that is repeatable and takes several with commas."""
    return tuple(name.strip() for each in given or () for name in each.split(",") if name.strip())


def read_input() -> bytes:
    """Read all of standard input."""
    return sys.stdin.buffer.read()


def load_input(screen: Screen, name: str, *, as_tool: bool = False) -> Project:
    """Load a file, a folder or standard input (``-``)."""
    if name == STANDARD_STREAM:
        return loads(read_input(), path="standard input", as_tool=as_tool)
    return load(name, progress=lambda files: screen.progress(files, "Loading", len(files)), as_tool=as_tool)


def load_and_tell(screen: Screen, name: str, *, as_tool: bool = False) -> Project:
    """Load as `load_input` does, and print what reading found beside the result of the command."""
    project = load_input(screen, name, as_tool=as_tool)
    for finding in project.diagnostics:
        screen.finding(finding, result=False)
    return project


def format_of_target(named: str, target: str | None, tia: str = "") -> str:
    """Return the format to write: the one that is `named`, or else that of the extension of `target`."""
    if named or tia:
        return named or TIA_FORMAT
    if target is None or target == STANDARD_STREAM:
        hint = "--to FORMAT names it, as the extension of a file to write to does: line24.scl, line24.json."
        raise InputError("the format to write is not named", hint=hint)
    return format_of_extension(target)


@contextmanager
def written_to_stdout(screen: Screen, target: str, extension: str) -> Iterator[str]:
    """Give the path to write to: `target`, or for ``-`` that of a file which goes to standard output in the end.

    The output of the command goes to standard error then. Raises `SfcError` where that is to be JSON.
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


def exit_code_for(screen: Screen, findings: Sequence[Diagnostic]) -> int:
    """Return the exit code so far, worsened by findings that are errors."""
    return max(screen.exit_code, _FINDINGS if any(f.severity is Severity.ERROR for f in findings) else 0)


def finding_data(finding: Diagnostic) -> dict[str, Any]:
    """Return a finding as plain data, for JSON."""
    data = {
        "code": finding.code,
        "severity": finding.severity.value,
        "message": finding.message,
        **_place(finding.location),
    }
    return data | ({"hint": finding.hint} if finding.hint else {})


def error_data(error: SfcError) -> dict[str, Any]:
    """Return an error as plain data, for JSON."""
    data = {"type": type(error).__name__, "message": error.message, **_place(error.location)}
    return data | ({"hint": error.hint} if error.hint else {})


def _place(location: Location) -> dict[str, Any]:
    fields = {"file": location.file, "line": location.line, "column": location.column, "path": location.path}
    return {key: value for key, value in fields.items() if value is not None}
