"""Behaviour of changed charts: old and new are run against each other."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from plcopen_sfc.analysis.equivalence import equivalent
from plcopen_sfc.comparison.changes import Change, ChangeKind, Proof
from plcopen_sfc.errors import SfcError
from plcopen_sfc.model.project import Project
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.semantics.profile import default_profile
from plcopen_sfc.semantics.programs.variable_use import ALL_FREE
from plcopen_sfc.semantics.subjects import resolve

__all__ = ["proofs"]

_NEVER_EXECUTED = frozenset({"comment", "title", "number", "warning time"})


def proofs(projects: tuple[Project, Project], changes: Iterable[Change], limit: float | str | None) -> Iterator[Proof]:
    """Run the charts that may do something else in the second project, each for at most `limit` (seconds, or a time).

    These are the charts of changed POUs, and all charts where something has changed that is in none: they may use it.
    """
    left, right = projects
    changed = {ObjectPath.of(change.path).owner.casefold() for change in changes if _matters(change)}
    there = {chart.report_path.casefold(): chart for chart in right.charts()}
    owners = {chart.pou.report_path.casefold() for chart in left.charts()}
    profiles = default_profile(left), default_profile(right)
    for chart in list(left.charts()):
        other = there.get(chart.report_path.casefold())
        if other is None or not (chart.pou.report_path.casefold() in changed or changed - owners):
            continue
        try:
            verdict = equivalent(
                resolve(left, chart.name),
                resolve(right, other.name),
                profiles,
                delay=0 if profiles[0] == profiles[1] else "auto",
                free_inputs=ALL_FREE,
                limit=limit,
            )
        except SfcError as error:
            yield Proof(chart.report_path, reason=error.message)
        else:
            yield Proof(chart.report_path, verdict)


def _matters(change: Change) -> bool:
    is_executed = change.kind not in (ChangeKind.LAYOUT, ChangeKind.RENAMED)
    return is_executed and change.aspect not in _NEVER_EXECUTED
