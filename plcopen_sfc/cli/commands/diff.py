"""``plcopen-sfc diff``: what changed between two projects, in the words of an engineer."""

from __future__ import annotations

import os
from dataclasses import dataclass

from plcopen_sfc.cli.reading import STANDARD_STREAM, load_input
from plcopen_sfc.cli.screen import Screen
from plcopen_sfc.comparison import ChangeKind, diff
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.errors import InputError
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.project import Project

_DIFFERENCES = 1
_NO_FILE = frozenset({os.devnull, "/dev/null"})
_STYLES = {ChangeKind.ADDED: "green", ChangeKind.REMOVED: "red", ChangeKind.LAYOUT: "dim"}
_DIFF_STYLES = {"+": "green", "-": "red", "@": "cyan"}


@dataclass(frozen=True)
class DiffOptions:
    """Options of the command."""

    layout: bool = False
    prove: bool = False
    limit: str = "30s"
    exit_code: bool = False


def run(screen: Screen, before: str, after: str, how: DiffOptions) -> int:
    """Print the changes from `before` to `after`."""
    if before == after == STANDARD_STREAM:
        raise InputError("standard input cannot be both files", hint="Name a file for one of them.")
    loaded = [_load(screen, name) for name in (before, after)]
    dialect = next((project.dialect for project in loaded if project is not None), Dialect.IEC)
    left, right = (Project(dialect=dialect) if project is None else project for project in loaded)
    found = diff(left, right, layout=how.layout, prove=how.prove, limit=how.limit)
    for text, kind in found.text() if found.changes or not screen.quiet else ():
        style = _STYLES.get(kind, "") if kind is not None else _DIFF_STYLES.get(text.lstrip()[:1], "")
        if not screen.as_json:
            screen.line((text, style))
    screen.result({"a": before, "b": after, **found.as_dict()})
    return _DIFFERENCES if how.exit_code and not found.equal else 0


def _load(screen: Screen, name: str) -> Project | None:
    """Load a file, and tell what could not be read in it: no comparison has that. None where git has no file."""
    if name in _NO_FILE:
        return None
    project = load_input(screen, name)
    for finding in project.diagnostics:
        if finding.severity is Severity.ERROR:
            screen.finding(finding, result=False)
    return project
