"""``plcopen-sfc normalize``: remove what the tool of a file ignores, such as the time of an export, for clean diffs."""

from __future__ import annotations

from collections.abc import Sequence

from plcopen_sfc.cli.reading import expand
from plcopen_sfc.cli.screen import UNREADABLE, Screen
from plcopen_sfc.errors import SfcError
from plcopen_sfc.files import read_bytes, write_atomic
from plcopen_sfc.formats.file_recognition import recognise

_FINDINGS = 1


def run(screen: Screen, patterns: Sequence[str], *, dry_run: bool) -> int:
    """Normalise files in place, or with `dry_run` only list them. Return 1 if a file was, or would be, changed."""
    results = []
    for name in screen.progress(expand(patterns), "Normalising"):
        try:
            data = read_bytes(name)
            normalised = recognise(data, file=name).codec().normalize(data)
        except SfcError as error:
            screen.error(error)
            screen.exit_code = UNREADABLE
            continue
        is_changed = normalised is not None and normalised != data  # None: the format has no such parts
        results.append({"file": name, "changed": is_changed})
        if normalised is None or not is_changed:
            continue
        if not dry_run:
            write_atomic(name, normalised)
        screen.exit_code = max(screen.exit_code, _FINDINGS)
        if not screen.as_json and not screen.quiet:
            screen.line("would be normalised: " if dry_run else "normalised: ", (name, "bold"))
    screen.result({"files": results, "written": not dry_run})
    return screen.exit_code
