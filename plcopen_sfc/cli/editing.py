"""Files that commands edit in place: shown as a diff, or written."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from plcopen_sfc.api import save
from plcopen_sfc.batch import FileChange, difference
from plcopen_sfc.cli.reading import STANDARD_STREAM, written_to_stdout
from plcopen_sfc.cli.screen import Screen
from plcopen_sfc.documents.folder_projects import edited_files
from plcopen_sfc.model import Project
from plcopen_sfc.report import LOSSES, Outcome

UNREAD_DOCUMENT = "DIR101"
DIFF_STYLES = {"+": "green", "-": "red", "@": "cyan"}


def finish(
    screen: Screen, file: str, project: Project, data: dict[str, Any], tell: Callable[[], None], *, dry_run: bool
) -> None:
    """Write an edited project back to `file` (``-``: to standard output), or with `dry_run` show what would change.

    `data` is what the command reports; `tell` shows it on the screen.
    """
    for finding in project.diagnostics:
        if finding.code == UNREAD_DOCUMENT:
            screen.finding(finding, result=False)  # what is edited may be named in it too
    if dry_run:
        diff = [line for each in edited_files(project, file) for line in difference(FileChange(*each))]
        for line in () if screen.as_json else diff:
            screen.line((line, DIFF_STYLES.get(line[:1], "")))
        screen.result(data | {"diff": diff})
        return
    with written_to_stdout(screen, file, "") as target:
        report = save(project, target, format=project.source.format if project.source is not None else None)
    if file == STANDARD_STREAM:
        report.written = [file]
    if not screen.as_json and not screen.quiet:
        tell()
        for name in report.written:
            screen.line("written: ", (name, "bold"))
    losses = [f"{item.place}: {item.why}" for item in report.losses]
    screen.result(data | {"written": report.written, "losses": losses})
    for item in report.with_outcome(*LOSSES, Outcome.DROPPED):
        screen.note(f"{item.place}: {item.why}")
