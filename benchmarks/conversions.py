"""Outcomes of conversions of real files, for each pair of formats, and whether running both agrees with the report.

    python -m benchmarks.conversions                     the fixtures, to every other format
    python -m benchmarks.conversions --corpus FOLDER     the files of a folder, too
    python -m benchmarks.conversions --limit 3           run each chart in both tools, for so many seconds
    python -m benchmarks.conversions --to beremiz        to this format, or for this tool; may be given again
    python -m benchmarks.conversions --only traffic      files with this in their name
    python -m benchmarks.conversions --every 5           the fixtures, and every fifth file of the folder
    python -m benchmarks.conversions --list              name every file and what became of it
    python -m benchmarks.conversions --resume FILE       keep results in a file, and go on with those that it has

A conversion is *executed* where the report names no loss, *otherwise* where something is approximated, *partial* where
something is not executed, *refused* where it is written in no case. *Unsaid* are losses that the reader of the target
found and no writer had named. With ``--limit`` each chart is simulated for both, and charts are counted by what came of
it (`CHARTS`), with the reasons why others were not run.
"""

from __future__ import annotations

import argparse
import io
import json
import re
import time
from collections import Counter, defaultdict
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import plcopen_sfc as sfc
from plcopen_sfc.conversion.causes import UNKNOWN_CAUSE, concerns
from plcopen_sfc.conversion.reporting import UNSAID
from plcopen_sfc.documents.sources import FileSource
from plcopen_sfc.errors import SfcError
from plcopen_sfc.pages.conversion_overview import ChartVerdict, verdict_of
from plcopen_sfc.report import ConversionReport, Outcome

FIXTURES = Path(__file__).resolve().parents[1] / "fixtures"
TARGETS = (
    *("codesys", "twincat", "codesys23", "plcopen-2.01", "plcopen-1.01"),
    *("simaticml", "scl", "iec-text"),
)
FLAVOURS = {"beremiz": "plcopen-2.01"}
"""Tools that a format is written for, with that format."""
FOLDERS = frozenset({"twincat"})
"""Targets in which a file holds one object: a project becomes a folder."""
WRITTEN = ("executed", "otherwise", "partial", "refused", "failed")
COUNTED = ("files", *WRITTEN, "unsaid")
CHARTS = (
    *("charts", "the same", "a scan later", "proven", "differs as named", "differs"),
    *("not all reached", "not executed", "not compared", "not run", "refused", "left out"),
)
"""Charts by what came of running them: `proven` are among the same, also a scan later. *Differs as named*: by something
that the report names, or a rule of the tools. *Not executed*: the report names what the target does not execute."""
REACHED = "steps reached"
"""Column of the steps that runs reached, of those of all charts that are the same as far as was reached."""
MOST_CHARTS = 16
"""Charts of files with more are *left out*: exports of one plant in eight states, each of which takes minutes."""


@dataclass
class Judged:
    """Outcome of a file in a target: the pair of formats, counts by column, and what to list."""

    pair: str
    file: str
    counts: Counter[str] = field(default_factory=Counter)
    notes: list[str] = field(default_factory=list)


def judged(path: Path, target: str, *, limit: float) -> Judged | None:
    """Convert a file, and run each chart for `limit` seconds; None where it is not read, or is of this format."""
    try:
        project = sfc.load(path)
        found_charts = [each for each in project.charts() if each.chart.steps or each.chart.partial_charts]
    except SfcError:
        return None
    steps = {each.report_path: len(each.chart.steps) for each in found_charts}
    charts, source = [*steps], source_of(project)
    if target == source or (limit and not charts):
        return None
    found = Judged(f"{source} -> {target}", path.name, Counter(files=1, charts=len(charts)))
    if limit and len(charts) > MOST_CHARTS:
        found.counts["left out"] = len(charts)
        return found
    try:
        report = _saved(project, target, limit * len(charts))
    except SfcError as error:
        found.counts["refused"] += len(charts) if limit else 1
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
    for chart in charts if limit else ():
        column, why = _seen(report, chart)
        found.counts[column] += 1
        if column in ("the same", "a scan later", "not all reached"):
            missed = _MISSED.search(report.compared.get(chart, ""))
            found.counts["steps"] += steps[chart]
            found.counts[REACHED] += steps[chart] - (int(missed[1]) if missed is not None else 0)
        found.counts["proven"] += _PROVEN.match(report.compared.get(chart, "")) is not None
        if column not in ("the same", "a scan later"):
            found.notes.append(f"{column}: {chart}: {why}")
    return found


def _seen(report: ConversionReport, chart: str) -> tuple[str, str]:
    """Return the column of a chart that was run, and why it is there."""
    told, verdict = report.compared.get(chart, ""), verdict_of(report, chart)
    if verdict in (ChartVerdict.DIFFERENT, ChartVerdict.SHIFTED):
        items = [item.why for item in report.losses if (item.what, item.path) == ("chart", chart)]
        why = items[0] if items else told
        unknown = UNKNOWN_CAUSE in why and not _OTHER_RULES.search(told)
        return "differs" if unknown else "differs as named", f"{why} / {told}"
    if verdict is not ChartVerdict.NOT_RUN:
        return _VERDICTS[verdict], told
    if told.startswith("not run"):
        return "not run", told
    lost = [item for item in report.with_outcome(Outcome.NOT_EXECUTED) if concerns(item, chart)]
    if lost:
        return "not executed", "; ".join(dict.fromkeys(f"{item.what}: {item.why}" for item in lost))
    return "not compared", told


_OTHER_RULES = re.compile(r"^(with actions and transitions in the order|under the rules) of ", re.MULTILINE)
_MISSED = re.compile(r"not all was reached \((\d+) steps?\b")
_PROVEN = re.compile(r"equal\b[^(]*\(proof")
_VERDICTS = {
    ChartVerdict.SAME: "the same",
    ChartVerdict.DELAYED: "a scan later",
    ChartVerdict.UNTESTED: "not all reached",
}


def source_of(project: sfc.Project) -> str:
    """Return the format of a project that was loaded, as pairs name it."""
    origin = project.source
    assert isinstance(origin, FileSource)
    return f"{origin.format}-{origin.version}" if origin.format == "plcopen" else origin.format


def _saved(project: sfc.Project, target: str, limit: float) -> ConversionReport:
    flavour = target if target in FLAVOURS else ""
    wanted = FLAVOURS.get(target, target)
    if target not in FOLDERS:
        return sfc.save(project, io.BytesIO(), format=wanted, flavour=flavour, partial=True, limit=limit)
    with TemporaryDirectory() as folder:
        return sfc.save(project, folder, format=wanted, partial=True, limit=limit)


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


def coverage(found: list[Judged]) -> str:
    """Steps that runs reached, by pair of formats, as a table of Markdown."""
    pairs: dict[str, Counter[str]] = defaultdict(Counter)
    for each in found:
        pairs[each.pair.replace(" -> ", " to ")] += each.counts
    rows = [(pair, row) for pair, row in sorted(pairs.items()) if row["steps"]]
    lines = [f"| {pair} | {row[REACHED]} of {row['steps']} |" for pair, row in rows]
    return "\n".join([f"| pair | {REACHED} |", "|---|---:|", *lines])


def reasons(found: list[Judged]) -> str:
    """Why charts are not the same, without the names in the reasons, the most frequent first."""
    counts: Counter[str] = Counter()
    for each in found:
        for note in each.notes:
            column, _, rest = note.partition(": ")
            if column in CHARTS:
                counts[f"{column}: {_NAMES.sub('…', rest.partition(': ')[2] or rest)}"] += 1
    return "\n".join(f"{count:5} {reason}" for reason, count in counts.most_common())


_NAMES = re.compile(r"`[^`]*`|'[^']*'|\bline \d+")


def _kept(path: Path | None) -> dict[tuple[str, str], Judged | None]:
    """The results of earlier runs in a file, by file and target."""
    if path is None or not path.exists():
        return {}
    rows = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    return {(row["path"], row["to"]): _judged_of(row["found"]) for row in rows}


def _judged_of(row: dict[str, Any] | None) -> Judged | None:
    return None if row is None else Judged(row["pair"], row["file"], Counter(row["counts"]), row["notes"])


def main() -> None:
    """Convert and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--corpus", type=Path)
    parser.add_argument("--to", action="append", choices=[*TARGETS, *FLAVOURS])
    parser.add_argument("--only", default="")
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--limit", type=float, default=0, help="seconds in which a chart is run")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--resume", type=Path)
    given = parser.parse_args()
    folders = [FIXTURES, *([given.corpus] if given.corpus is not None else [])]
    jobs = [(path, target) for target in given.to or TARGETS for path in files(folders, given.only, given.every)]
    start = time.monotonic()
    kept = _kept(given.resume)
    found = [kept[str(path), target] for path, target in jobs if (str(path), target) in kept]
    jobs = [(path, target) for path, target in jobs if (str(path), target) not in kept]
    with ProcessPoolExecutor(given.processes) as pool:
        for (path, target), each in zip(jobs, pool.map(partial(_work, limit=given.limit), jobs), strict=True):
            found.append(each)
            if given.resume is not None:
                row = {"path": str(path), "to": target, "found": None if each is None else vars(each)}
                with given.resume.open("a", encoding="utf-8") as file:
                    file.write(f"{json.dumps(row)}\n")
            if each is None:
                continue
            wrong = [note for note in each.notes if note.startswith(("unsaid", "failed", "differs"))]
            for note in each.notes if given.list else wrong:
                print(f"{each.pair} {each.file}: {note}", flush=True)
    results = [each for each in found if each is not None]
    print(f"\n{table(results, CHARTS if given.limit else COUNTED)}\n")
    if given.limit:
        print(f"{coverage(results)}\n\n{reasons(results)}\n")
    print(f"{time.monotonic() - start:.0f} s with {given.processes} processes")


if __name__ == "__main__":
    main()
