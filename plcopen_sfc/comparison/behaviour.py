"""Behaviour of what changed: old and new are run against each other, and what no run shows is named."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

from plcopen_sfc.analysis.equivalence import equivalent
from plcopen_sfc.analysis.verdict import Verdict
from plcopen_sfc.comparison.changes import Change, ChangeKind, Proof
from plcopen_sfc.errors import SfcError
from plcopen_sfc.languages.binding import Names
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.semantics.profile import default_profile
from plcopen_sfc.semantics.programs.variable_use import ALL_FREE
from plcopen_sfc.semantics.subjects import resolve

__all__ = ["proofs"]

_NEVER_EXECUTED = frozenset({"comment", "title", "number", "warning time"})
_TERMINALS = "no run shows at which terminal or in which memory a variable is"
_TASKS = "tasks are not run"
_NOT_RUN: Mapping[str, str] = {
    "address": _TERMINALS,
    "VAR_CONFIG": _TERMINALS,
    "retain": "no run ends and starts again",
    "persistent": "no run ends and starts again",
    "task": _TASKS,
    "program instance": _TASKS,
}
"""Why runs do not show a change, by what has changed."""


class _Runnable(NamedTuple):
    """Something that can be run: its name in the project, its path in reports, and that of its POU."""

    name: str
    path: str
    owner: str


def proofs(projects: tuple[Project, Project], changes: Iterable[Change], limit: float | str | None) -> Iterator[Proof]:
    """Run what may do something else in the second project, each for at most `limit` (seconds, or a time).

    These are the programs, function blocks and charts that have changed, and all of them where something has changed
    that is in none: they may use it. What no run shows is a proof without a verdict.
    """
    executed = [change for change in changes if _is_executed(change)]
    shown = []
    for change in executed:
        reason = _NOT_RUN.get(change.aspect) or _NOT_RUN.get(change.what) or _not_called(projects, change)
        if reason:
            yield Proof(change.place, reason=reason)
        else:
            shown.append(change)
    changed = {ObjectPath.of(change.path).owner.casefold() for change in shown}
    here, there = map(_runnable, projects)
    outside = changed - {each.owner.casefold() for each in here.values()}
    for key, each in here.items():
        if key in there and (outside or each.owner.casefold() in changed):
            yield _run(projects, (each, there[key]), limit)


def _is_executed(change: Change) -> bool:
    is_behaviour = change.kind not in (ChangeKind.LAYOUT, ChangeKind.RENAMED)
    return is_behaviour and change.aspect not in _NEVER_EXECUTED


def _runnable(project: Project) -> dict[str, _Runnable]:
    """Return programs, function blocks and the charts of their actions, by their paths in lower case."""
    charts = [_Runnable(chart.name, chart.report_path, chart.pou.report_path) for chart in project.charts()]
    pous = [_Runnable(pou.name, pou.report_path, pou.report_path) for pou in project.pous if _is_run(pou)]
    return {each.path.casefold(): each for each in (*pous, *charts)}


def _is_run(pou: Pou) -> bool:
    return pou.kind is not PouKind.FUNCTION and bool(pou.bodies)


def _not_called(projects: tuple[Project, Project], change: Change) -> str:
    """Return why nothing runs what has changed, such as that nothing calls it; empty if something does."""
    path = ObjectPath.of(change.path)
    for project in projects:
        pou = next((each for each in project.pous if each.report_path.casefold() == path.owner.casefold()), None)
        if pou is None:
            continue
        if change.path == pou.report_path and change.kind in (ChangeKind.ADDED, ChangeKind.REMOVED) and _is_run(pou):
            return "it is only in one of the two" if pou.kind is PouKind.PROGRAM else ""
        names = [pou.name] if pou.kind is PouKind.FUNCTION else _methods_at(pou, change.path)
        if names and all(each.text_site.site.pou is pou for each in Names(project).occurrences(*names)):
            return "it is run only where it is called, and nothing calls it"
        return ""
    return ""


def _methods_at(pou: Pou, path: str) -> list[str]:
    start = f"{pou.report_path} / method "
    return [each.name for each in pou.methods if f"{path} / ".startswith(f"{start}{each.name} / ")]


def _run(projects: tuple[Project, Project], both: tuple[_Runnable, _Runnable], limit: float | str | None) -> Proof:
    """Run something in both projects, with any values of what nothing writes: it may be an input of the machine."""
    left, right = map(default_profile, projects)

    def verdict(*free: str) -> Verdict:
        return equivalent(
            resolve(projects[0], both[0].name),
            resolve(projects[1], both[1].name),
            (left, right),
            delay=0 if left == right else "auto",
            free_inputs=free,
            limit=limit,
        )

    try:
        found = verdict(ALL_FREE)
        frozen = verdict() if found.different else found
    except SfcError as error:
        return Proof(both[0].path, reason=error.message)
    if found.different and frozen.equal and frozen.frozen:
        names = ", ".join(frozen.frozen)
        why = f"only if something outside writes {names}; while they keep their start values, both do the same"
    else:
        why = ""
    return Proof(both[0].path, found, why)
