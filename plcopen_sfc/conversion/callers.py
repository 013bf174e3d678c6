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
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.variables import Interface
from plcopen_sfc.report import ConversionReport, Outcome
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.subjects import Subject, resolve

if TYPE_CHECKING:
    from plcopen_sfc.analysis.verdict import Verdict


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


def _tasks(project: Project) -> Iterator[tuple[str, list[str], set[str]]]:
    """Yield the tasks that execute several programs, and charts with them: names, those of the programs and charts."""
    programs = {pou.name.casefold() for pou in project.pous if pou.kind is PouKind.PROGRAM}
    charts = {chart.pou.name.casefold(): {chart.pou.name.casefold()} for chart in project.charts()}
    charts |= {pou.name.casefold(): reached for pou, reached in callers(project)}
    for task in project.tasks():
        names = list(dict.fromkeys(each.type_name or each.name for each in task.instances))
        known = {name.casefold() for name in names}
        if len(known) > 1 and known <= programs and not known.isdisjoint(charts):
            yield task.name, names, set().union(*(charts[each] for each in known & charts.keys()))


def _caller_of(project: Project, programs: Iterable[str]) -> Subject:
    """Return a program beside those of a project that calls some of them."""
    body = StBody(text=" ".join(f"{each}();" for each in programs))
    copied = deepcopy(project)
    copied.pous = [*copied.pous, Pou(name=_CALLER, kind=PouKind.PROGRAM, interface=Interface(), bodies=[body])]
    return resolve(copied, _CALLER)


_CALLER = "Programs_of_the_task"


class _Calling(NamedTuple):
    """What calls charts in two projects, by its path in the first; names of these charts, in lower case.

    `inputs`: as in `equivalent`.
    """

    path: str
    charts: set[str]
    subjects: tuple[Subject, Subject]
    inputs: Mapping[str, str]


def _calling(
    one: Project, other: Project, called: Mapping[str, str], inputs: Callable[[Pou], Mapping[str, str]]
) -> Iterator[_Calling]:
    """Yield what calls charts in both projects: POUs, and tasks, whose programs share values.

    `inputs`: see `report_callers`.
    """
    names = {in_the_source(pou.report_path, called): pou.name for pou in other.pous}
    theirs = {pou.name.casefold(): names[pou.report_path] for pou in one.pous if pou.report_path in names}
    for pou, charts in callers(one):
        if name := theirs.get(pou.name.casefold()):
            subjects = resolve(one, pou.name), resolve(other, name)
            yield _Calling(pou.report_path, charts, subjects, inputs(subjects[1].pou))
    for task, programs, charts in _tasks(one):
        found = [theirs.get(each.casefold(), "") for each in programs]
        if all(name and other.pou(name).kind is PouKind.PROGRAM for name in found):
            subjects = _caller_of(one, programs), _caller_of(other, found)
            names = dict(zip(found, programs, strict=True))
            for new, old in names.copy().items():
                names |= {f"{new}.{here}": f"{old}.{there}" for here, there in inputs(other.pou(new)).items()}
            yield _Calling(f"task {task}", charts, subjects, names)


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
        verdict = _verdict_on(partial(compared, *each.subjects, inputs=each.inputs), late, share)
        if verdict is not None and verdict.counterexample is not None:
            told = told_example(verdict.counterexample, tool)
            report.add(Outcome.APPROXIMATED, "calls of charts", each.path, f"{told}; {why}")
        elif verdict is None or not is_whole(verdict):
            for path in report.compared:
                if path.removeprefix("POU ").partition(" / ")[0].casefold() in each.charts:
                    report.compared[path] += f"\ngiven: {each.path}, which calls it, was not compared in all situations"


def is_whole(verdict: Verdict) -> bool:
    """True for a proof that leaves nothing out."""
    from plcopen_sfc.analysis.sequences import RESTLESS  # noqa: PLC0415  # most conversions run nothing

    return verdict.proven and not any(RESTLESS in note for note in verdict.notes)


def _verdict_on(compared: Callable[..., Verdict], late: int, limit: float) -> Verdict | None:
    """Return the verdict on what calls charts: that which tells least; None where it cannot be run.

    `late`: see `report_callers`. First what both come to with inputs of single scans, then what comes of times while
    inputs stay.
    """
    from plcopen_sfc.analysis.pairing import Delay  # noqa: PLC0415  # most conversions run nothing

    end, found = time.thread_time() + limit, None
    for share, delay in ((2, Delay(late, settled=True)), (1, Delay(late, in_sequence=True))):
        left = (end - time.thread_time()) / share
        try:
            verdict = compared(delay=delay, limit=left) if left > 0 else None
        except SfcError:
            return None
        if verdict is None or verdict.different:
            return verdict
        if verdict.interrupted:
            raise KeyboardInterrupt
        if found is None or is_whole(found):
            found = verdict
    return found
