"""Source and result of a conversion, run against each other under the rules of their tools."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping

from plcopen_sfc.analysis.equivalence import equivalent
from plcopen_sfc.analysis.verdict import Counterexample, VerdictKind
from plcopen_sfc.conversion.executed_parts import OPERATING_KINDS, SHOWN_STATE, UNDECLARED
from plcopen_sfc.conversion.reporting import in_the_source
from plcopen_sfc.errors import SfcError
from plcopen_sfc.model.project import Chart, Project
from plcopen_sfc.report import LOSSES, ConversionReport, Item, Outcome
from plcopen_sfc.semantics.profile import Profile, default_profile
from plcopen_sfc.semantics.programs.variable_use import ALL_FREE
from plcopen_sfc.semantics.subjects import resolve

__all__ = ["report_running"]

_CAP, _RUNS, _SCANS = 2_000, 10, 100
"""States of a search for a proof, and runs without one: a difference between tools shows early, or is proven away."""

_SEARCH = "search for stability"
_APART = OPERATING_KINDS | {SHOWN_STATE, _SEARCH, "retain", "address", "interval", "max time", "maximum time"}
"""Losses beside which a run shows more: what operates a chart rests, nothing looks at addresses or times of tasks, and
the chart of a GRAFCET may have no step that is only passed."""


def report_running(
    report: ConversionReport,
    source: Project,
    result: Project,
    called: Mapping[str, str],
    *,
    tool: str,
    target: Profile | None,
    limit: float,
) -> None:
    """Run each chart of `source` and what the target `tool` reads of it, and add what came of it to `report`.

    Charts of which the report names a loss already are left out: they differ. `called` gives the paths in the source of
    what has another name in the result, `target` the rules of the target where they are not those of its files. `limit`
    is the time in seconds that all of this may take.
    """
    profiles = default_profile(source), target or default_profile(result)
    end = time.monotonic() + limit
    for there, here in list(_pairs(source, result, called, report)):
        left = end - time.monotonic()
        if left <= 0:
            _note_untested(report, there.report_path, "not run: the time limit was reached")
            continue
        try:
            verdict = equivalent(
                resolve(source, there.name),
                resolve(result, here.name),
                profiles,
                delay="auto",
                free_inputs=ALL_FREE,
                cap=_CAP,
                runs=_RUNS,
                scans=_SCANS,
                limit=left,
            )
        except SfcError as error:
            _note_untested(report, there.report_path, f"not run: {error.message}")
            continue
        if verdict.kind is VerdictKind.UNTESTED:
            _note_untested(report, there.report_path, *str(verdict).splitlines())
            continue
        report.compared[there.report_path] = str(verdict).splitlines()[0]
        if verdict.counterexample is not None:
            report.add(Outcome.APPROXIMATED, "chart", there.report_path, _why(verdict.counterexample, tool))


def _note_untested(report: ConversionReport, path: str, found: str, *unreached: str) -> None:
    report.compared[path] = found
    report.untested[path] = list(unreached)


def _pairs(
    source: Project, result: Project, called: Mapping[str, str], report: ConversionReport
) -> Iterator[tuple[Chart, Chart]]:
    """The charts that are to be run: of the source, with that of the result."""
    found = {in_the_source(chart.report_path, called).casefold(): chart for chart in result.charts()}
    lossy = [f"{item.path} / " for item in report.items if item.outcome in LOSSES and not _is_apart(item)]
    for chart in source.charts():
        inside = f"{chart.report_path} / "
        here = found.get(chart.report_path.casefold())
        if here is not None and not any(path.startswith(inside) or inside.startswith(path) for path in lossy):
            yield chart, here


def _is_apart(item: Item) -> bool:
    """True for a loss beside which a run shows more: a name that nothing declares is the same input on both sides."""
    return item.what in _APART or (item.what == UNDECLARED and item.outcome is Outcome.APPROXIMATED)


def _why(example: Counterexample, tool: str) -> str:
    count = len(example.inputs)
    scans = f"{count} scan{'' if count == 1 else 's'}"
    shown = str(example.differences[0]).replace("in the first", "in the source").replace("in the second", f"in {tool}")
    return f"it does something else after {scans}: {shown}"
