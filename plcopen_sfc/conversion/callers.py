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
from plcopen_sfc.conversion.chart_runs import is_whole, longer_scans, settled
from plcopen_sfc.conversion.reporting import in_the_source
from plcopen_sfc.languages.binding import names_in
from plcopen_sfc.languages.binding.reached_pous import reached_pous
from plcopen_sfc.languages.st.literals import time_literal
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.types import DerivedType, Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection
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


class _Together(NamedTuple):
    """Programs that are executed together, by a path; names (lower case) of the charts that they reach.

    `is_exact`: one after the other in each scan; else in tasks of their own.
    """

    path: str
    programs: list[str]
    charts: set[str]
    is_exact: bool = True


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
            continue
        given = []
        if verdict is None or not (each.is_exact and is_whole(verdict)):
            given.append(f"given: what calls it was not compared in all situations: {each.path}")
        if verdict is not None and verdict.timed:
            times = [verdict.scan_time, *longer_scans(running[0], verdict)]
            shown = ", ".join(map(time_literal, times))
            given.append(f"given: what calls it was run with scans of {shown}: {each.path}")
        for path in report.compared:
            if path.removeprefix("POU ").partition(" / ")[0].casefold() in each.charts:
                report.compared[path] += "".join(f"\n{line}" for line in given)
