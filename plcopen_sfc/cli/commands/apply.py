"""``plcopen-sfc apply``: run a script on many files, and show or write what it changes."""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path

from plcopen_sfc.batch import AppliedFile, apply, difference, project_files
from plcopen_sfc.cli.commands.rename import DIFF_STYLES
from plcopen_sfc.cli.reading import STANDARD_STREAM, expand
from plcopen_sfc.cli.screen import Screen
from plcopen_sfc.errors import ScriptError
from plcopen_sfc.files import write_atomic

_FINDINGS = 1


def run(
    screen: Screen, script: str, files: list[str], settings: list[str], *, write: bool, patch: Path | None, jobs: int
) -> int:
    """Run `script` on `files` (``-``: those that standard input lists). `patch` gets a unified diff of all changes."""
    listed = [line.strip() for line in sys.stdin] if STANDARD_STREAM in files else []
    paths = project_files([*expand(each for each in files if each != STANDARD_STREAM), *filter(None, listed)])
    outcomes: Counter[str] = Counter()
    data, lines = [], []
    for done in apply(script, paths, settings=dict(map(_setting, settings)), write=write, jobs=jobs):
        outcome = "failed" if done.error else "changed" if done.changes else "unchanged"
        outcomes[outcome] += 1
        diff = [line for change in done.changes for line in difference(change)]
        lines += diff
        data.append({"path": done.path, "outcome": outcome, "error": done.error, "diff": diff})
        _show(screen, done, diff)
    if patch is not None:
        write_atomic(str(patch), "".join(f"{line}\n" for line in lines).encode())
    counts = ", ".join(f"{outcomes[each]} {each}" for each in ("changed", "unchanged", "failed"))
    if not screen.as_json and not screen.quiet:
        screen.line(counts + ("" if write or not outcomes["changed"] else "; nothing is written without --write"))
    screen.result({"files": data, "counts": dict(outcomes), "written": write})
    return _FINDINGS if outcomes["failed"] else 0


def _show(screen: Screen, done: AppliedFile, diff: list[str]) -> None:
    if done.error:
        screen.note(f"failed: {done.path}: {done.error}")
    if screen.as_json or screen.quiet or not done.changes:
        return
    new = sum(line.startswith("+") and not line.startswith("+++") for line in diff)
    screen.line("changed: ", (done.path, "bold"), f", {new} line{'' if new == 1 else 's'}")
    for line in diff if screen.verbose else ():
        screen.line((f"  {line}", DIFF_STYLES.get(line[:1], "")))


def _setting(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not equals:
        raise ScriptError(f"a setting is NAME=VALUE, not {text!r}")
    return name, value
