"""``plcopen-sfc apply``: run a script on many files, and show or write what it changes."""

from __future__ import annotations

import sys
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from plcopen_sfc.batch import AppliedFile, apply, difference, project_files
from plcopen_sfc.cli.editing import DIFF_STYLES
from plcopen_sfc.cli.reading import STANDARD_STREAM, expand
from plcopen_sfc.cli.screen import Screen, Table
from plcopen_sfc.errors import ScriptError
from plcopen_sfc.files import write_atomic

_FINDINGS = 1


@dataclass(frozen=True)
class ApplyOptions:
    """Options of a run: those of `plcopen_sfc.batch.apply`. `patch` gets a unified diff of all changes."""

    write: bool = False
    patch: Path | None = None
    jobs: int = 1
    scheduler: str = ""
    prove: bool = False
    journal: Path | None = None


def run(screen: Screen, script: str, files: list[str], settings: list[str], how: ApplyOptions) -> int:
    """Run `script` on `files` (``-``: those that standard input lists)."""
    listed = [line.strip() for line in sys.stdin] if STANDARD_STREAM in files else []
    paths = project_files([*expand(each for each in files if each != STANDARD_STREAM), *filter(None, listed)])
    outcomes: Counter[str] = Counter()
    reasons: Counter[str] = Counter()
    data, lines = [], []
    done = apply(
        script,
        paths,
        settings=dict(map(_setting, settings)),
        write=how.write,
        jobs=how.jobs,
        scheduler=how.scheduler,
        prove=how.prove,
        journal=str(how.journal) if how.journal is not None else None,
    )
    for each in screen.progress_of(done, len(paths), "Applying"):
        outcome = (
            "failed" if each.error else "done before" if each.resumed else "changed" if each.changes else "unchanged"
        )
        outcomes[outcome] += 1
        reasons[each.error.replace(each.path, "..").partition("\n")[0]] += bool(each.error)
        diff = [line for change in each.changes for line in difference(change)]
        lines += diff if how.patch is not None else []
        proofs = {"proofs": [proof.as_dict() for proof in each.proofs]} if how.prove else {}
        data.append({"path": each.path, "outcome": outcome, "error": each.error, "diff": diff, **proofs})
        _show(screen, each, diff)
    if how.patch is not None:
        write_atomic(str(how.patch), "".join(f"{line}\n" for line in lines).encode())
    if not screen.as_json and not screen.quiet:
        _summarise(screen, outcomes, reasons, written=how.write)
    screen.result({"files": data, "counts": dict(outcomes), "written": how.write})
    return _FINDINGS if outcomes["failed"] else 0


def _summarise(screen: Screen, outcomes: Counter[str], reasons: Counter[str], *, written: bool) -> None:
    if outcomes["failed"] > 1:
        table = Table(["files", "failed because"])
        table.rows = [[count, reason] for reason, count in reasons.most_common(_REASONS) if count]
        screen.table(table)
    names = ["changed", "unchanged", "failed", *(["done before"] if outcomes["done before"] else [])]
    counts = ", ".join(f"{outcomes[each]} {each}" for each in names)
    screen.line(counts + ("" if written or not outcomes["changed"] else "; nothing is written without --write"))


_REASONS = 10
"""Reasons that the summary lists, the most frequent first."""


def _show(screen: Screen, done: AppliedFile, diff: list[str]) -> None:
    if done.error:
        screen.note(f"failed: {done.path}: {done.error}")
    if screen.as_json or screen.quiet or not done.changes:
        return
    new = sum(line.startswith("+") and not line.startswith("+++") for line in diff)
    screen.line("changed: ", (done.path, "bold"), f", {new} line{'' if new == 1 else 's'}")
    for proof in done.proofs:
        screen.line(f"  {str(proof).splitlines()[0]}")
    for line in diff if screen.verbose else ():
        screen.line((f"  {line}", DIFF_STYLES.get(line[:1], "")))


def _setting(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not equals:
        raise ScriptError(f"a setting is NAME=VALUE, not {text!r}")
    return name, value
