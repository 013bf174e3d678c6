"""Code that calls charts, where these do the same a scan later in one of two tools.

A chart that is equal but for a constant delay is no other chart, but what reads its outputs together with inputs,
times or other charts may see them in another order.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from copy import deepcopy
from typing import TYPE_CHECKING

from plcopen_sfc.conversion.causes import told_example
from plcopen_sfc.conversion.reporting import in_the_source
from plcopen_sfc.errors import SfcError
from plcopen_sfc.languages.binding import names_in
from plcopen_sfc.languages.binding.reached_pous import reached_pous
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.variables import Interface
from plcopen_sfc.report import ConversionReport, Outcome
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.subjects import Subject, resolve

if TYPE_CHECKING:
    from plcopen_sfc.analysis.verdict import Verdict


def callers(project: Project) -> Iterator[Pou]:
    """Yield the POUs without a chart that call charts, but for those that another one of them calls."""
    charts = {pou.name.casefold() for pou in project.pous if pou.chart is not None}
    others = [pou for pou in project.pous if pou.chart is None and pou.kind is not PouKind.FUNCTION]
    reached = {
        pou.name: {each.name.casefold() for each, _ in reached_pous(pou, names_in(pou, project.dialect), project)}
        for pou in (others if charts else ())
    }
    calling = [pou for pou in others if pou.name in reached and not charts.isdisjoint(reached[pou.name])]
    for pou in calling:
        if not any(pou.name.casefold() in reached[other.name] for other in calling if other is not pou):
            yield pou


def _tasks(project: Project) -> Iterator[tuple[str, list[str]]]:
    """Yield the tasks that execute several programs, and charts with them: names, and those of the programs."""
    programs = {pou.name.casefold() for pou in project.pous if pou.kind is PouKind.PROGRAM}
    charts = {each.name.casefold() for each in (*callers(project), *(chart.pou for chart in project.charts()))}
    for task in project.tasks():
        names = list(dict.fromkeys(each.type_name or each.name for each in task.instances))
        known = {name.casefold() for name in names}
        if len(known) > 1 and known <= programs and not known.isdisjoint(charts):
            yield task.name, names


def _calling(project: Project, programs: Iterable[str]) -> Subject:
    """Return a program beside those of a project that calls some of them."""
    body = StBody(text=" ".join(f"{each}();" for each in programs))
    copied = deepcopy(project)
    copied.pous = [*copied.pous, Pou(name=_CALLER, kind=PouKind.PROGRAM, interface=Interface(), bodies=[body])]
    return resolve(copied, _CALLER)


_CALLER = "Programs_of_the_task"


def _subjects(one: Project, other: Project, called: Mapping[str, str]) -> Iterator[tuple[str, Subject, Subject]]:
    """Yield what calls charts in both projects, by its path in `one`: POUs, and tasks, whose programs share values."""
    names = {in_the_source(pou.report_path, called): pou.name for pou in other.pous}
    theirs = {pou.name.casefold(): names[pou.report_path] for pou in one.pous if pou.report_path in names}
    for pou in callers(one):
        if name := theirs.get(pou.name.casefold()):
            yield pou.report_path, resolve(one, pou.name), resolve(other, name)
    for task, programs in _tasks(one):
        found = [theirs.get(each.casefold(), "") for each in programs]
        if all(name and other.pou(name).kind is PouKind.PROGRAM for name in found):
            yield f"task {task}", _calling(one, programs), _calling(other, found)


def report_callers(
    report: ConversionReport,
    running: Sequence[Project],
    called: Mapping[str, str],
    compared: Callable[..., Verdict],
    *,
    profiles: tuple[Profile, Profile],
    tool: str,
    end: float,
) -> None:
    """Run what calls charts in both projects of `running`, and report what sees them in another order.

    `compared` compares two subjects; it ends when the thread has used `end` seconds of processor time. What cannot be
    run is no item: the verdicts are on charts.

    Raises `KeyboardInterrupt`.
    """
    from plcopen_sfc.analysis.pairing import Delay, in_retiming  # noqa: PLC0415  # most conversions run nothing

    one, other = running
    scans = in_retiming(profiles)
    for path, *subjects in _subjects(one, other, called) if scans else ():
        left = end - time.thread_time()
        if left <= 0:
            return
        try:
            verdict = compared(*subjects, delay=Delay(scans or 0, in_sequence=True), limit=left)
        except SfcError:
            continue
        if verdict.interrupted:
            raise KeyboardInterrupt
        if verdict.counterexample is not None:
            late, early = (tool, "the source") if scans == 1 else ("the source", tool)
            why = f"in {late} it sees what the charts that it calls do a scan later than in {early}"
            told = told_example(verdict.counterexample, tool)
            report.add(Outcome.APPROXIMATED, "calls of charts", path, f"{told}; {why}")
