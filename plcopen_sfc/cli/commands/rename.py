"""``plcopen-sfc rename``: give a step, a variable, a POU another name wherever a file names it."""

from __future__ import annotations

from typing import Any

from plcopen_sfc.cli.editing import finish
from plcopen_sfc.cli.reading import load_input
from plcopen_sfc.cli.screen import Screen
from plcopen_sfc.languages.binding import Use
from plcopen_sfc.report import RenameResult

_SHOWN = 20
_FINDINGS = 1


def run(screen: Screen, file: str, old: str, new: str, *, dry_run: bool) -> int:
    """Rename `old` to `new` in `file` (``-``: from standard input to standard output).

    With `dry_run` only show what would change in it.
    """
    project = load_input(screen, file)
    result = project.rename(old, new)
    finish(screen, file, project, _data(file, result), lambda: _show(screen, result), dry_run=dry_run)
    if result.undecided and not screen.as_json:
        screen.note(f"these places have the name {result.old} too; look whether they mean {result.path}:")
        for undecided in result.undecided:
            screen.note(f"  {undecided}")
    return _FINDINGS if result.undecided else 0


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
