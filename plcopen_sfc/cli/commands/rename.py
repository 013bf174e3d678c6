"""``plcopen-sfc rename``: give a step, a variable, a POU another name wherever a file names it."""

from __future__ import annotations

from typing import Any

from plcopen_sfc.api import save
from plcopen_sfc.batch import FileChange, difference
from plcopen_sfc.cli.reading import STANDARD_STREAM, load_input, written_to_stdout
from plcopen_sfc.cli.screen import Screen
from plcopen_sfc.documents.folder_projects import edited_files
from plcopen_sfc.languages.binding import Use
from plcopen_sfc.report import LOSSES, Outcome, RenameResult

UNREAD_DOCUMENT = "DIR101"
_SHOWN = 20
_FINDINGS = 1


def run(screen: Screen, file: str, old: str, new: str, *, dry_run: bool) -> int:
    """Rename `old` to `new` in `file` (``-``: from standard input to standard output).

    With `dry_run` only show what would change in it.
    """
    project = load_input(screen, file)
    result = project.rename(old, new)
    for finding in project.diagnostics:
        if finding.code == UNREAD_DOCUMENT:
            screen.finding(finding, result=False)  # the name may be in it too
    if dry_run:
        files = edited_files(project, file)
        diff = [line for each in files for line in difference(FileChange(*each))]
        for line in () if screen.as_json else diff:
            screen.line((line, DIFF_STYLES.get(line[:1], "")))
        screen.result(_data(file, result) | {"diff": diff})
    else:
        with written_to_stdout(screen, file, "") as target:
            report = save(project, target, format=project.source.format if project.source is not None else None)
        if file == STANDARD_STREAM:
            report.written = [file]
        if not screen.as_json and not screen.quiet:
            _show(screen, result)
            for name in report.written:
                screen.line("written: ", (name, "bold"))
        losses = [f"{item.place}: {item.why}" for item in report.losses]
        screen.result(_data(file, result) | {"written": report.written, "losses": losses})
        for item in report.with_outcome(*LOSSES, Outcome.DROPPED):
            screen.note(f"{item.place}: {item.why}")
    if result.undecided and not screen.as_json:
        screen.note(f"these places have the name {result.old} too; look whether they mean {result.path}:")
        for undecided in result.undecided:
            screen.note(f"  {undecided}")
    return _FINDINGS if result.undecided else 0


DIFF_STYLES = {"+": "green", "-": "red", "@": "cyan"}


def _show(screen: Screen, result: RenameResult) -> None:
    count = len(result.changed)
    places = f"{count} place{'' if count == 1 else 's'} that name{'s' if count == 1 else ''} it changed too"
    screen.line((result.path, "bold"), " is called ", (result.new, "bold"), f" now, {places}")
    shown = result.changed if screen.verbose else result.changed[:_SHOWN]
    for use in shown:
        screen.line(f"  {use}")
    if len(shown) < count:
        screen.line(f"  .. and {count - len(shown)} more: --verbose shows all")


def _data(file: str, result: RenameResult) -> dict[str, Any]:
    return {
        "file": file,
        "path": result.path,
        "old": result.old,
        "new": result.new,
        "changed": [_use(use) for use in result.changed],
        "undecided": [_use(undecided.use) | {"reason": undecided.reason} for undecided in result.undecided],
    }


def _use(use: Use) -> dict[str, Any]:
    return {
        "path": use.path,
        "language": use.language,
        "line": use.line,
        "column": use.column,
        "text": use.text,
    }
