"""``plcopen-sfc rename``: give a step, a variable, a POU another name wherever a file names it."""

from __future__ import annotations

from typing import Any

from plcopen_sfc.api import load, save
from plcopen_sfc.cli.diff import difference
from plcopen_sfc.cli.screen import Screen
from plcopen_sfc.documents.folder_projects import edited_files
from plcopen_sfc.languages.binding import Use
from plcopen_sfc.refactor.rename import RenameResult
from plcopen_sfc.report import LOSSES, ConversionReport, Outcome

UNREAD_DOCUMENT = "DIR101"
_SHOWN = 20
_FINDINGS = 1


def run(screen: Screen, file: str, old: str, new: str, *, dry_run: bool) -> int:
    """Rename `old` to `new` in `file`; with `dry_run` only show what would change in it."""
    project = load(file, progress=lambda files: screen.progress(files, "Loading"))
    result = project.rename(old, new)
    for finding in project.diagnostics:
        if finding.code == UNREAD_DOCUMENT:
            screen.finding(finding, result=False)  # the name may stand in it too
    report = None
    diff: list[str] = []
    if dry_run:
        diff = [line for name, before, after in edited_files(project, file) for line in difference(before, after, name)]
    else:
        report = save(project, file)
    if screen.as_json:
        screen.json(_data(file, result, report, diff))
    elif dry_run:
        for line in diff:
            screen.line((line, _DIFF_STYLES.get(line[:1], "")))
    else:
        _show(screen, result)
        for name in report.written if report is not None else ():
            screen.line("written: ", (name, "bold"))
    for item in report.with_outcome(*LOSSES, Outcome.DROPPED) if report is not None else ():
        screen.note(f"{item.place}: {item.why}")
    if result.undecided and not screen.as_json:
        screen.note(f"these places have the name {result.old} too; look whether they mean {result.path}:")
        for undecided in result.undecided:
            screen.note(f"  {undecided}")
    return _FINDINGS if result.undecided else 0


_DIFF_STYLES = {"+": "green", "-": "red", "@": "cyan"}


def _show(screen: Screen, result: RenameResult) -> None:
    count = len(result.changed)
    places = f"{count} place{'' if count == 1 else 's'} that name{'s' if count == 1 else ''} it changed too"
    screen.line((result.path, "bold"), " is called ", (result.new, "bold"), f" now, {places}")
    shown = result.changed if screen.verbose else result.changed[:_SHOWN]
    for use in shown:
        screen.line(f"  {use}")
    if len(shown) < count:
        screen.line(f"  .. and {count - len(shown)} more: --verbose shows all")


def _data(file: str, result: RenameResult, report: ConversionReport | None, diff: list[str]) -> dict[str, Any]:
    data: dict[str, Any] = {
        "file": file,
        "path": result.path,
        "old": result.old,
        "new": result.new,
        "changed": [_use(use) for use in result.changed],
        "undecided": [_use(undecided.use) | {"reason": undecided.reason} for undecided in result.undecided],
    }
    if report is None:
        return data | {"diff": diff}
    return data | {
        "written": report.written,
        "losses": [f"{item.place}: {item.why}" for item in report.losses],
    }


def _use(use: Use) -> dict[str, Any]:
    return {
        "path": use.path,
        "language": use.language,
        "line": use.line,
        "column": use.column,
        "text": use.text,
    }
