"""Outcomes of conversions of real files, for each pair of formats, and whether running both agrees with the report.

    python -m benchmarks.conversions                     the fixtures, to every other format
    python -m benchmarks.conversions --corpus FOLDER     the files of a folder, too
    python -m benchmarks.conversions --limit 5           run the charts of each file in both tools, for so many seconds
    python -m benchmarks.conversions --only traffic      files with this in their name
    python -m benchmarks.conversions --every 5           the fixtures, and every fifth file of the folder
    python -m benchmarks.conversions --list              name every file and what became of it

A conversion is *executed* where the report names no loss, *otherwise* where something is approximated, *partial* where
something is not executed, *refused* where it is written in no case. *Unsaid* are losses that the reader of the target
found and no writer had named. With ``--limit``, charts of which the report names no other loss are *the same*,
*different* or *unknown* when they are run in both tools.
"""

from __future__ import annotations

import argparse
import io
import time
from collections import Counter, defaultdict
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import plcopen_sfc as sfc
from plcopen_sfc.conversion.reporting import UNSAID
from plcopen_sfc.documents.sources import FileSource
from plcopen_sfc.errors import SfcError
from plcopen_sfc.report import ConversionReport, Outcome

FIXTURES = Path(__file__).resolve().parents[1] / "fixtures"
TARGETS = (
    *("codesys", "twincat", "codesys23", "plcopen-2.01", "plcopen-1.01"),
    *("simaticml", "scl", "iec-text"),
)
FOLDERS = frozenset({"twincat"})
"""Targets in which a file holds one object: a project becomes a folder."""
WRITTEN = ("executed", "otherwise", "partial", "refused", "failed")
COUNTED = ("files", *WRITTEN, "unsaid")
COLUMNS = (*COUNTED, "the same", "unknown", "different")


@dataclass
class Judged:
    """Outcome of a file in a target: the pair of formats, counts by column, and what to list."""

    pair: str
    file: str
    counts: Counter[str] = field(default_factory=Counter)
    notes: list[str] = field(default_factory=list)


def judged(path: Path, target: str, *, limit: float) -> Judged | None:
    """Convert a file; None where it is not read, or is of this format."""
    try:
        project = sfc.load(path)
    except SfcError:
        return None
    source = source_of(project)
    if target == source:
        return None
    found = Judged(f"{source} -> {target}", path.name, Counter(files=1))
    try:
        report = _saved(project, target, limit)
    except SfcError as error:
        found.counts["refused"] += 1
        found.notes.append(f"refused: {error.message}")
        return found
    except Exception as error:
        found.counts["failed"] += 1
        found.notes.append(f"failed: {error!r}")
        return found
    found.counts[_column(report)] += 1
    unsaid = [item for item in report.losses if UNSAID in item.why]
    found.counts["unsaid"] += len(unsaid)
    found.notes += [f"unsaid: {item.place}: {item.why}" for item in unsaid]
    for chart, verdict in report.compared.items():
        if verdict.startswith("not compared"):
            continue
        column = next((name for name, start in _VERDICTS.items() if verdict.startswith(start)), "unknown")
        found.counts[column] += 1
        if column != "the same":
            found.notes.append(f"{column}: {chart}: {verdict}")
    return found


def source_of(project: sfc.Project) -> str:
    """Return the format of a project that was loaded, as pairs name it."""
    origin = project.source
    assert isinstance(origin, FileSource)
    return f"{origin.format}-{origin.version}" if origin.format == "plcopen" else origin.format


def _saved(project: sfc.Project, target: str, limit: float) -> ConversionReport:
    if target not in FOLDERS:
        return sfc.save(project, io.BytesIO(), format=target, partial=True, limit=limit)
    with TemporaryDirectory() as folder:
        return sfc.save(project, folder, format=target, partial=True, limit=limit)


_VERDICTS = {"the same": ("equal",), "different": ("different", "it does something else")}


def _column(report: ConversionReport) -> str:
    if report.with_outcome(Outcome.NOT_EXECUTED):
        return "partial"
    return "otherwise" if report.losses else "executed"


def files(folders: list[Path], only: str, step: int = 1) -> Iterator[Path]:
    """The fixtures and every `step`-th file of other folders."""
    for folder in folders:
        every = sorted(path for path in folder.rglob("*") if path.is_file())
        wanted = [path for path in every if only.casefold() in str(path).casefold()]
        yield from wanted if folder == FIXTURES else wanted[::step]


def _work(job: tuple[Path, str], *, limit: float) -> Judged | None:
    return judged(*job, limit=limit)


def table(found: list[Judged], columns: tuple[str, ...]) -> str:
    """Counts by pair of formats as a table of Markdown."""
    pairs: dict[str, Counter[str]] = defaultdict(Counter)
    for each in found:
        pairs[each.pair] += each.counts
    total: Counter[str] = sum(pairs.values(), Counter())
    rows = [["pair", *columns]]
    rows += [[name, *(str(row[c]) for c in columns)] for name, row in [*sorted(pairs.items()), ("all", total)]]
    lines = ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join([lines[0], "|---|" + "---:|" * len(columns), *lines[1:]])


def main() -> None:
    """Convert and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--corpus", type=Path)
    parser.add_argument("--to", action="append", choices=TARGETS)
    parser.add_argument("--only", default="")
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--limit", type=float, default=0, help="seconds in which the charts of a file are run")
    parser.add_argument("--processes", type=int, default=2)
    given = parser.parse_args()
    folders = [FIXTURES, *([given.corpus] if given.corpus is not None else [])]
    jobs = [(path, target) for path in files(folders, given.only, given.every) for target in given.to or TARGETS]
    start = time.monotonic()
    found: list[Judged] = []
    with ProcessPoolExecutor(given.processes) as pool:
        for each in pool.map(partial(_work, limit=given.limit), jobs):
            if each is None:
                continue
            found.append(each)
            wrong = [note for note in each.notes if note.startswith(("unsaid", "failed", "different"))]
            for note in each.notes if given.list else wrong:
                print(f"{each.pair} {each.file}: {note}", flush=True)
    shown = table(found, COLUMNS if given.limit else COUNTED)
    print(f"\n{shown}\n\n{time.monotonic() - start:.0f} s with {given.processes} processes")


if __name__ == "__main__":
    main()
