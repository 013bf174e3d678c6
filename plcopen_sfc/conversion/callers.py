"""Code that calls charts, where these do the same a scan later in one of two tools.

A chart that is equal but for a constant delay is no other chart, but what reads its outputs together with inputs,
times or other charts may see them in another order.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from copy import deepcopy
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

from plcopen_sfc.conversion.causes import told_example, told_held_calls
from plcopen_sfc.conversion.reporting import in_the_source
from plcopen_sfc.errors import SfcError
from plcopen_sfc.languages.binding import names_in
from plcopen_sfc.languages.binding.reached_pous import reached_pous
from plcopen_sfc.languages.task_schedules import nanoseconds, schedule_of
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Chart, Project
from plcopen_sfc.model.sfc import SfcBody
from plcopen_sfc.model.types import DerivedType, Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection
from plcopen_sfc.report import ConversionReport, Outcome
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.subjects import Subject, resolve

if TYPE_CHECKING:
    from plcopen_sfc.analysis.verdict import Verdict


_SCAN_TIME = 10_000_000
"""Nanoseconds of a scan where no task of the source declares its interval."""


def callers(project: Project) -> Iterator[tuple[Pou, set[str]]]:
    """Yield the POUs without a chart that call charts, but for those that another one of them calls.

    With each the names (lower case) of the charts that it reaches.
    """
    charts = {pou.name.casefold() for pou in project.pous if pou.chart is not None}
    others = [pou for pou in project.pous if pou.chart is None and pou.kind is not PouKind.FUNCTION]
    reached = {
        pou.name: {each.name.casefold() for each, _ in reached_pous(pou, names_in(pou, project.dialect), project)}
        for pou in (others if charts else ())
    }
    calling = [pou for pou in others if pou.name in reached and not charts.isdisjoint(reached[pou.name])]
    for pou in calling:
        if not any(pou.name.casefold() in reached[other.name] for other in calling if other is not pou):
            yield pou, charts & reached[pou.name]


class _Together(NamedTuple):
    """Programs that are executed together, by a path; names (lower case) of the charts that they reach.

    `is_exact`: one after the other in each scan; else in tasks of their own.
    """

    path: str
    programs: list[str]
    charts: set[str]
    is_exact: bool = True


def calls_charts(chart: Chart, project: Project) -> bool:
    """True if a chart calls another one, or one that is an action of its POU."""
    if any(isinstance(action.body, SfcBody) for action in chart.pou.actions):
        return True
    reached = reached_pous(chart.pou, names_in(chart.pou, project.dialect), project)
    return any(pou.chart is not None for pou, _ in reached if pou is not chart.pou)


def _together(project: Project) -> Iterator[_Together]:
    """Yield the tasks that execute several programs, and charts with them, and tasks that share variables.

    Without a task every program counts as one of its own.
    """
    programs = {pou.name.casefold(): pou for pou in project.pous if pou.kind is PouKind.PROGRAM}
    charts = {chart.pou.name.casefold(): {chart.pou.name.casefold()} for chart in project.charts()}
    charts |= {pou.name.casefold(): reached for pou, reached in callers(project)}
    groups = {
        task.name: list(dict.fromkeys(each.type_name or each.name for each in task.instances))
        for task in sorted(project.tasks(), key=lambda task: task.priority)
    } or {pou.name: [pou.name] for pou in programs.values()}
    kind = "tasks" if project.tasks() else "programs"
    known = {path: names for path, names in groups.items() if programs.keys() >= {name.casefold() for name in names}}
    reached = {path: set().union(*(charts.get(name.casefold(), ()) for name in names)) for path, names in known.items()}
    for path, names in known.items():
        if len(names) > 1 and reached[path]:
            yield _Together(f"task {path}", names, reached[path])
    every = list(dict.fromkeys(name for names in known.values() for name in names))
    if len(known) > 1 and any(reached.values()) and _share(project, known.values()):
        yield _Together(f"{kind} {', '.join(known)}", every, set().union(*reached.values()), is_exact=False)


def _share(project: Project, groups: Iterable[Sequence[str]]) -> bool:
    """True if programs of two groups name one global variable."""
    common = {variable.name.casefold() for section in project.global_sections() for variable in section.variables}
    common |= {block.name.casefold() for block in project.data_blocks}
    seen: set[str] = set()
    for names in groups:
        pous = map(project.pou, names)
        named = [reached_pous(pou, names_in(pou, project.dialect), project) for pou in pous]
        used = common.intersection(name for each in named for _, own in each for name in own)
        if not seen.isdisjoint(used):
            return True
        seen |= used
    return False


def _caller_of(project: Project, programs: Sequence[str]) -> Subject:
    """Return a program beside those of a project that calls some of them, as instances with their names."""
    copied = deepcopy(project)
    instances = [
        Variable(name=copied.pou(each).name, type=DerivedType(name=copied.pou(each).name)) for each in programs
    ]
    for each in programs:
        copied.pou(each).kind = PouKind.FUNCTION_BLOCK
    copied.global_variables = [*copied.global_variables, VariableSection(kind=SectionKind.GLOBAL, variables=instances)]
    body = StBody(text=" ".join(f"{each}();" for each in programs))
    copied.pous = [*copied.pous, Pou(name=_CALLER, kind=PouKind.PROGRAM, interface=Interface(), bodies=[body])]
    return resolve(copied, _CALLER)


_CALLER = "Programs_together"


class _Calling(NamedTuple):
    """What calls charts in two projects, by its path in the first; names of these charts, in lower case.

    `inputs`: as in `equivalent`. `is_exact`: see `_Together`.
    """

    path: str
    charts: set[str]
    subjects: tuple[Subject, Subject]
    inputs: Mapping[str, str]
    is_exact: bool = True


def _calling(
    one: Project, other: Project, called: Mapping[str, str], inputs: Callable[[Pou], Mapping[str, str]]
) -> Iterator[_Calling]:
    """Yield what calls charts in both projects: POUs, and programs that share variables.

    `inputs`: see `report_callers`.
    """
    names = {in_the_source(pou.report_path, called): pou.name for pou in other.pous}
    theirs = {pou.name.casefold(): names[pou.report_path] for pou in one.pous if pou.report_path in names}
    for pou, charts in callers(one):
        if name := theirs.get(pou.name.casefold()):
            subjects = resolve(one, pou.name), resolve(other, name)
            yield _Calling(pou.report_path, charts, subjects, inputs(subjects[1].pou))
    for each in _together(one):
        found = [theirs.get(name.casefold(), "") for name in each.programs]
        if all(name and other.pou(name).kind is PouKind.PROGRAM for name in found):
            subjects = _caller_of(one, each.programs), _caller_of(other, found)
            names = dict(zip(found, each.programs, strict=True))
            for new, old in names.copy().items():
                names |= {f"{new}.{here}": f"{old}.{there}" for here, there in inputs(other.pou(new)).items()}
            yield _Calling(each.path, each.charts, subjects, names, each.is_exact)


def report_callers(
    report: ConversionReport,
    running: Sequence[Project],
    called: Mapping[str, str],
    compared: Callable[..., Verdict],
    *,
    inputs: Callable[[Pou], Mapping[str, str]],
    late: int,
    profiles: tuple[Profile, Profile],
    tool: str,
    end: float,
) -> None:
    """Run what calls charts in both projects of `running`, and report what sees them in another order.

    `compared` compares two subjects; it ends when the thread has used `end` seconds of processor time. `inputs` gives
    the names in the source of variables of a POU of the result that have others there; `late` is by how many scans
    charts are later in the result, less than 0: in the source. The verdicts on charts tell what calls them and could
    not be run, or not in all situations.

    Raises `KeyboardInterrupt`.
    """
    sides = (tool, "the source") if late > 0 else ("the source", tool)
    why = f"in {sides[0]} it sees what the charts that it calls do a scan later than in {sides[1]}"
    if not late and not (why := told_held_calls(profiles, tool)):
        return
    found = list(_calling(running[0], running[1], called, inputs))
    for number, each in enumerate(found):
        share = (end - time.thread_time()) / (len(found) - number)
        verdict = settled(partial(compared, *each.subjects, inputs=each.inputs), running[0], late, share)
        if verdict is not None and verdict.counterexample is not None:
            told = told_example(verdict.counterexample, tool)
            report.add(Outcome.APPROXIMATED, "calls of charts", each.path, f"{told}; {why}")
        elif verdict is None or not (each.is_exact and is_whole(verdict)):
            for path in report.compared:
                if path.removeprefix("POU ").partition(" / ")[0].casefold() in each.charts:
                    report.compared[path] += f"\ngiven: what calls it was not compared in all situations: {each.path}"


def is_whole(verdict: Verdict) -> bool:
    """True for a proof that leaves nothing out."""
    from plcopen_sfc.analysis.sequences import RESTLESS  # noqa: PLC0415  # most conversions run nothing

    return verdict.proven and not any(RESTLESS in note for note in verdict.notes)


def longer_scans(source: Project, verdict: Verdict) -> list[int]:
    """Return the scan times of the tasks of a project, else the usual one, that are longer than that of a verdict."""
    declared = {nanoseconds(schedule_of(task).interval) for task in source.tasks()}
    times = {each for each in declared if each is not None} or {_SCAN_TIME}
    return sorted(each for each in times if verdict.timed and each > verdict.scan_time)


def settled(compared: Callable[..., Verdict], source: Project, late: int, limit: float) -> Verdict | None:
    """Return the verdict on what both come to while inputs stay: that which tells least; None where it cannot be run.

    First with inputs of single scans; where there are times with the scans of the tasks of `source` as well, and, if
    one side is later, with inputs that stay until both rest, and times as they are. `late`: by how many scans the
    second is later, about.
    """
    from plcopen_sfc.analysis.pairing import Delay  # noqa: PLC0415  # most conversions run nothing

    end, found = time.thread_time() + limit, None
    waiting: list[tuple[int | None, bool]] = [(None, False)]
    while waiting:
        left = (end - time.thread_time()) / len(waiting)
        scan_time, to_rest = waiting.pop(0)
        delay = Delay(late, settled=True, in_sequence=to_rest)
        try:
            verdict = compared(delay=delay, scan_time=scan_time, limit=left) if left > 0 else None
        except SfcError:
            return None
        if verdict is None or verdict.different:
            return verdict
        if verdict.interrupted:
            raise KeyboardInterrupt
        if found is None and verdict.timed:
            times = None, *longer_scans(source, verdict)
            waiting += [(each, to_rest) for each in times for to_rest in ((False, True) if late else (False,))][1:]
        if found is None or (is_whole(found) and not is_whole(verdict)):
            found = verdict
    return found
