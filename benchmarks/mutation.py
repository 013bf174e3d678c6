"""How many mistakes in lowered code and in converted charts the comparison finds.

    python -m benchmarks.mutation                    a sample of the fixtures, about a minute
    python -m benchmarks.mutation --each 5           five mutants of each kind of each result
    python -m benchmarks.mutation --all              every mutant of the fixtures, hours
    python -m benchmarks.mutation --corpus FOLDER    charts of the files in a folder, too
    python -m benchmarks.mutation --only Pusher      results with this in their name
    python -m benchmarks.mutation --list             name every mutant and what became of it

Each mutant is a result with one mistake: code that a chart was lowered to, or the chart that the tool of another format
reads. It is compared with the chart that the result was made of, as `lower` compares, or as two tools execute it. The
score is how many are found different, of those that are not proven equal and can be run. The same arguments always give
the same counts.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from enum import StrEnum
from functools import partial
from pathlib import Path
from random import Random
from typing import Any

import plcopen_sfc as sfc
from benchmarks.chart_mutants import chart_mutants
from benchmarks.code_mutants import Mutant, body_mutants, initial_value_mutants
from plcopen_sfc import model as m
from plcopen_sfc.analysis import Verdict, equivalent
from plcopen_sfc.documents.file_documents import read_document
from plcopen_sfc.errors import SfcError
from plcopen_sfc.lowering import LoweredPou, lower
from plcopen_sfc.lowering.proof import prove
from plcopen_sfc.semantics.profile import default_profile
from plcopen_sfc.semantics.programs.variable_use import ALL_FREE
from plcopen_sfc.semantics.subjects import resolve

FIXTURES = Path(__file__).resolve().parents[1] / "fixtures"
FORMS = ("case ST", "regions ST", "bits ST", "flipflop LD", "flipflop FBD")
LOWERED = (
    ("codesys/sorting_conveyor.xml", "FB_Pusher", ("case ST", "bits ST", "flipflop LD")),
    ("codesys/sorting_conveyor.xml", "PLC_PRG.ACT_Home", ("bits ST",)),
    ("codesys/sorting_conveyor.xml", "PLC_PRG", ()),
    ("twincat/press_station.xml", "FB_Press", ("case ST",)),
    ("twincat/press_station.xml", "FB_Press.ACT_Jog", ("bits ST",)),
    ("plcopen/filling_station_2.01.xml", "CapStation", ("case ST", "flipflop FBD")),
    ("simaticml-training-chain/Ablauf.xml", "Ablauf", ("bits ST",)),
    ("simaticml/FB_Drill.xml", "FB_Drill", ()),
    ("training-chain/codesys.xml", "Ablauf", ("case ST", "flipflop LD")),
    ("training-chain/iec-text.st", "Ablauf", ("regions ST", "bits ST")),
)
"""Charts that are lowered, and the forms of a sample; those without one take minutes."""

CONVERTED = (
    ("codesys/sorting_conveyor.xml", "FB_Pusher", ("plcopen-2.01",)),
    ("codesys/sorting_conveyor.xml", "PLC_PRG.ACT_Home", ("plcopen-2.01", "iec-text")),
    ("twincat/press_station.xml", "FB_Press", ("plcopen-2.01",)),
    ("plcopen/filling_station_2.01.xml", "CapStation", ("codesys", "iec-text")),
    ("simaticml/FB_Drill.xml", "FB_Drill", ()),
    ("simaticml-training-chain/Ablauf.xml", "Ablauf", ("codesys", "plcopen-2.01")),
    ("training-chain/codesys.xml", "Ablauf", ("plcopen-2.01", "simaticml")),
    ("training-chain/iec-text.st", "Ablauf", ("codesys", "simaticml")),
)
"""Charts that are converted, and the formats of a sample."""

TARGETS = ("codesys", "plcopen-2.01", "iec-text", "simaticml")


class MutantOutcome(StrEnum):
    """The outcome of a mutant."""

    PROVEN = "proven equal"
    PROVEN_AT_REST = "while times rest"
    REFUSED = "refused"
    FAILED = "failed"
    FOUND = "found"
    NOT_REACHED = "not reached"
    SURVIVED = "survived"


LEFT = (MutantOutcome.SURVIVED, MutantOutcome.NOT_REACHED)

_SETTLING = 20_000
"""States of the search for a proof while times rest."""

_REST = 4
"""Scans that inputs which are times rest at then."""


@dataclass(frozen=True)
class Effort:
    """How much is tried for each mutant; see `equivalent`."""

    cap: int
    runs: int
    scans: int


@dataclass(frozen=True)
class Result:
    """A result that can have mistakes: its name, its mutants, and how it is compared with its chart."""

    name: str
    project: m.Project
    mutants: tuple[Mutant, ...]
    compare: Callable[..., Verdict]
    times: tuple[str, ...]
    """Inputs that are times."""


@dataclass(frozen=True)
class JudgedMutant:
    """A mutant by its kind and place, and what became of it. `why`: the verdict's first line, or the refusal."""

    result: str
    kind: str
    place: str
    outcome: MutantOutcome
    why: str
    seconds: float


def lowered_result(path: Path, chart: str, form: str, effort: Effort) -> Result:
    """A lowered chart. Raises `SfcError` where it cannot be lowered."""
    construction, language = form.split()
    source = sfc.load(path)
    # mistakes in states are made in their numbers, whatever the target would be given
    made = lower(source, construction, pou=chart, language=language, states="numbers", verify=False)
    owner = made.name.split(".")[0]
    mutants = (*body_mutants(made.project, made.name), *initial_value_mutants(made.project, owner))
    compare = partial(_proven, source, made, effort)
    return Result(f"{path.stem} {made.name}, {form}", made.project, mutants, compare, _times(source, owner))


def _proven(
    source: m.Project, made: LoweredPou, effort: Effort, mutant: m.Project, fixed: Mapping[str, int] | None = None
) -> Verdict:
    at_rest: dict[str, Any] = {**made.at_rest, **(fixed or {})}
    return prove(
        resolve(source, made.name),
        resolve(mutant, made.name),
        made.profile,
        fixed=at_rest,
        left_out=made.left_out,
        step_flags=made.step_flags or None,
        cap=_SETTLING if fixed else effort.cap,
        runs=effort.runs,
        scans=effort.scans,
        free_inputs=ALL_FREE,
    )


def _times(project: m.Project, pou: str) -> tuple[str, ...]:
    """The inputs of a POU that are times."""
    inputs = project.pou(pou).variables(m.SectionKind.INPUT)
    return tuple(v.name for v in inputs if isinstance(v.type, m.ElementaryType) and v.type.name.value == "TIME")


def converted_result(path: Path, chart: str, target: str, effort: Effort) -> Result:
    """A chart as the tool of another format reads it. Raises `SfcError` where it cannot be converted."""
    source = sfc.load(path)
    data, _ = sfc.convert(source, target, partial=True)
    result = read_document(data, format=target.split("-2", maxsplit=1)[0], path=None, as_tool=True)
    charts = [each.name for each in result.charts()]
    name = next((each for each in charts if each.casefold() == chart.casefold()), charts[0] if charts else "")
    profiles = default_profile(source), default_profile(result)

    def compare(mutant: m.Project, fixed: Mapping[str, int] | None = None) -> Verdict:
        return equivalent(
            resolve(source, chart),
            resolve(mutant, name),
            profiles,
            delay="auto",
            fixed=fixed,
            cap=_SETTLING if fixed else effort.cap,
            runs=effort.runs,
            scans=effort.scans,
            free_inputs=ALL_FREE,
        )

    if not name:
        raise SfcError(f"no chart in {target}")
    mutants = tuple(chart_mutants(result, name))
    return Result(f"{path.stem} {chart} to {target}", result, mutants, compare, _times(source, chart.partition(".")[0]))


def judged(result: Result, mutant: Mutant) -> JudgedMutant:
    """Return the outcome of a mutant."""
    start = time.process_time()
    try:
        made = mutant.made()
        verdict = result.compare(made)
        kind, why = _outcome(verdict), str(verdict).splitlines()[0]
        if kind in LEFT and result.times:
            again = result.compare(made, dict.fromkeys(result.times, _REST * verdict.scan_time))
            if again.proven:
                kind = MutantOutcome.PROVEN_AT_REST
            elif again.counterexample is not None:
                why = f"but while {', '.join(result.times)} rest: {str(again).splitlines()[0]}"
    except SfcError as error:
        kind, why = MutantOutcome.REFUSED, error.message.splitlines()[0]
    except Exception as error:
        kind, why = MutantOutcome.FAILED, repr(error)
    return JudgedMutant(result.name, mutant.kind, mutant.place, kind, why, time.process_time() - start)


def _outcome(verdict: Verdict) -> MutantOutcome:
    if verdict.counterexample is not None:
        return MutantOutcome.FOUND
    if verdict.proven:
        return MutantOutcome.PROVEN
    return MutantOutcome.SURVIVED if verdict.equal else MutantOutcome.NOT_REACHED


def sample(mutants: Iterable[Mutant], each: int | None, name: str) -> list[Mutant]:
    """So many of each kind, the same ones for the same name; None: all."""
    kinds: dict[str, list[Mutant]] = defaultdict(list)
    for mutant in mutants:
        kinds[mutant.kind].append(mutant)
    if each is None:
        return [mutant for found in kinds.values() for mutant in found]
    random = Random(name)
    return [mutant for found in kinds.values() for mutant in random.sample(found, min(each, len(found)))]


Job = tuple[Callable[..., Result], Path, str, str, Effort]


def jobs(effort: Effort, *, all_forms: bool, only: str, corpus: Path | None) -> Iterator[Job]:
    """The results that are looked at."""
    for make, table, every in ((lowered_result, LOWERED, FORMS), (converted_result, CONVERTED, TARGETS)):
        wanted = [(FIXTURES / file, chart, every if all_forms else forms) for file, chart, forms in table]
        if corpus is not None:
            wanted += [(path, chart, every) for path, chart in _charts_of(corpus)]
        for path, chart, forms in wanted:
            for form in forms:
                if only.casefold() in f"{path} {chart} {form}".casefold():
                    yield make, path, chart, form, effort


def _charts_of(folder: Path) -> Iterator[tuple[Path, str]]:
    """The distinct charts of the files of a folder that can be read."""
    seen: set[str] = set()
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        try:
            charts = list(sfc.load(path).charts())
        except (SfcError, OSError):
            continue
        for chart in charts:
            key = chart.chart.model_dump_json(exclude={"drawing"})
            if key not in seen:
                seen.add(key)
                yield path, chart.name


def work(job: Job, each: int | None) -> tuple[str, str, list[JudgedMutant]]:
    """Return the outcomes of the mutants of a result: its name, that without a mistake, and each."""
    make, path, chart, form, effort = job
    name = f"{path.stem} {chart} {form}"
    try:
        result = make(path, chart, form, effort)
        verdict = result.compare(result.project)
    except SfcError as error:
        return name, f"refused: {error.message.splitlines()[0]}", []
    told = str(verdict).splitlines()[0]
    if verdict.counterexample is not None:
        return result.name, told, []
    return result.name, told, [judged(result, mutant) for mutant in sample(result.mutants, each, name)]


def table(found: Iterable[JudgedMutant], by: Callable[[JudgedMutant], str], first: str) -> str:
    """Counts by outcome, and the score, as a table of Markdown."""
    counts: dict[str, Counter[MutantOutcome]] = defaultdict(Counter)
    for mutant in found:
        counts[by(mutant)][mutant.outcome] += 1
    rows = [[first, "mutants", *MutantOutcome, "score"]]
    total: Counter[MutantOutcome] = sum(counts.values(), Counter())
    for name, row in [*sorted(counts.items()), ("all", total)]:
        open_ = sum(row[each] for each in (MutantOutcome.FOUND, *LEFT))
        score = f"{100 * row[MutantOutcome.FOUND] / open_:.0f} %" if open_ else ""
        rows.append([name, str(row.total()), *(str(row[each]) for each in MutantOutcome), score])
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ["| " + " | ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)) + " |" for row in rows]
    return "\n".join([lines[0], "|" + "|".join("-" * (w + 2) for w in widths) + "|", *lines[1:]])


def main() -> None:
    """Compare and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--each", type=int, default=1, help="mutants of each kind of each result")
    parser.add_argument("--all", action="store_true", help="all of them, of results in all forms")
    parser.add_argument("--forms", action="store_true", help="results in all forms and formats")
    parser.add_argument("--corpus", type=Path)
    parser.add_argument("--only", default="")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--cap", type=int, default=2_000, help="the most states of a search")
    parser.add_argument("--runs", type=int, default=30)
    parser.add_argument("--scans", type=int, default=200)
    parser.add_argument("--processes", type=int, default=2)
    given = parser.parse_args()
    effort = Effort(given.cap, given.runs, given.scans)
    wanted = list(jobs(effort, all_forms=given.all or given.forms, only=given.only, corpus=given.corpus))
    start = time.monotonic()
    found: list[JudgedMutant] = []
    with ProcessPoolExecutor(given.processes) as pool:
        for name, told, mutants in pool.map(partial(work, each=None if given.all else given.each), wanted):
            seconds = sum(each.seconds for each in mutants)
            print(f"{name}: {told}; {len(mutants)} mutants, {seconds:.1f} s", flush=True)
            found += mutants
            for each in mutants:
                if given.list or each.outcome in (*LEFT, MutantOutcome.FAILED):
                    print(f"    {each.outcome}: {each.kind}: {each.place}: {each.why}", flush=True)
    print(f"\n{table(found, lambda each: each.kind, 'kind')}\n")
    print(table(found, lambda each: "code" if each.result.rpartition(", ")[1] else "chart", "result"))
    print(f"\n{time.monotonic() - start:.0f} s with {given.processes} processes")


if __name__ == "__main__":
    main()
