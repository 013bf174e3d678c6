"""``plcopen-sfc merge``: put what was edited in a step list into the file that the list was written from."""

from __future__ import annotations

from plcopen_sfc.api import load, save
from plcopen_sfc.batch import FileChange, difference
from plcopen_sfc.cli.editing import DIFF_STYLES
from plcopen_sfc.cli.reading import load_input
from plcopen_sfc.cli.screen import Screen
from plcopen_sfc.documents.folder_projects import edited_files
from plcopen_sfc.documents.list_merging import merge_list


def run(screen: Screen, source: str, file: str, *, dry_run: bool) -> int:
    """Merge the list `source` into `file`; with `dry_run` only show what would change in it."""
    edited, project = load_input(screen, source), load(file)
    for finding in edited.diagnostics:
        screen.finding(finding, result=False)
    changes = merge_list(project, edited)
    diff = [line for each in edited_files(project, file) for line in difference(FileChange(*each))]
    written = []
    if changes and not dry_run:
        written = save(project, file, format=project.source.format if project.source is not None else None).written
    if not screen.as_json and not screen.quiet:
        for change in changes:
            screen.line(change)
        for line in diff if dry_run else ():
            screen.line((line, DIFF_STYLES.get(line[:1], "")))
        for name in written:
            screen.line("written: ", (name, "bold"))
        if not changes:
            screen.line("the list changes nothing")
    screen.result({"list": source, "file": file, "changes": changes, "diff": diff, "written": written})
    return 0
