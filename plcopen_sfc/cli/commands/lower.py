"""``plcopen-sfc lower``: program code instead of a chart, with the proof that it does the same."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from plcopen_sfc.analysis.limits import SearchProgress
from plcopen_sfc.api import load, save
from plcopen_sfc.cli.guard import UNREADABLE
from plcopen_sfc.cli.reading import error_data, exit_code_for
from plcopen_sfc.cli.screen import Screen
from plcopen_sfc.errors import Location, LoweringError, UntestedError
from plcopen_sfc.files import write_atomic
from plcopen_sfc.formats.registry import format_named
from plcopen_sfc.lowering.code.flag_places import flags_of_several
from plcopen_sfc.lowering.lower import LoweredPou, faults_of, lower
from plcopen_sfc.lowering.placing import errors_of
from plcopen_sfc.lowering.proving import refuse_untested
from plcopen_sfc.lowering.written import prove_written
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Chart, Project
from plcopen_sfc.report import ConversionReport, Outcome
from plcopen_sfc.semantics.subjects import resolve

_FINDINGS = 1
_SHOWN = 10


@dataclass(frozen=True)
class How:
    """What to lower and how: the options of the command."""

    to: str
    pou: str | None
    construction: str
    style: str
    language: str | None
    profile: str | None
    init: str | None
    stop: str | None
    reset_actions: bool
    states: str
    actions: str
    flags: str
    modes: tuple[str, ...]
    at_rest: tuple[str, ...]
    lang: str
    verify: bool
    skip_refused: bool = False
    tia: str = ""
    free: tuple[str, ...] = ()
    accept_untested: bool = False
    limit: str | None = None
    accept_errors: bool = False


@dataclass(frozen=True)
class _Made:
    """What became of the charts of a project: code, which stands in `draft`, or a refusal, by their names."""

    lowered: list[LoweredPou]
    refused: dict[str, LoweringError]
    report: ConversionReport
    draft: Path

    @property
    def charts(self) -> int:
        """How many there were, but for those that were lowered with others."""
        return len(self.lowered) + len(self.refused)


def run(screen: Screen, source: str, target: str | None, how: How, *, report_to: Path | None) -> int:
    """Lower the charts of `source`, or one of them, and write the project with the code to `target` (None: next to it).

    What is written has been read back and compared with the chart. Where exact code is different, or a chart is refused
    that is not to be skipped, nothing is written.
    """
    project = load(source, progress=lambda files: screen.progress(files, "Loading"))
    for finding in project.diagnostics:
        screen.finding(finding, result=False)
    if how.accept_errors:
        project.accept_errors()
    name = target or _beside(Path(source), how.to)
    with tempfile.TemporaryDirectory() as folder:
        with screen.searching() as progress:
            made = _made(project, how, Path(folder), name, progress)
        written = bool(made.lowered) and (how.skip_refused or not made.refused)
        untested = all(isinstance(error, UntestedError) for error in made.refused.values())
        if not written and len(made.refused) == 1 and not made.lowered and not untested:
            raise next(iter(made.refused.values()))
        report = _written(made, how, name) if written else made.report
    data = {
        "file": name if written else None,
        "pous": [each.as_dict() for each in made.lowered],
        "refused": [{"pou": pou, **_refusal(error)} for pou, error in made.refused.items()],
        "conversion": report.as_dict() if written else None,
    }
    if report_to is not None:
        write_atomic(report_to, (json.dumps(data, ensure_ascii=False, indent=2) + "\n").encode())
    if screen.as_json:
        screen.json(data)
    elif written:
        _show(screen, name, made.lowered, report)
    for error in made.refused.values():
        screen.error(error)
    if not written:
        screen.complain(f"nothing is written: {len(made.refused)} of {made.charts} charts are refused")
        if made.lowered:
            screen.advise("--skip-refused leaves them as they are and lowers the others.")
        return _FINDINGS if untested else UNREADABLE
    if made.refused:
        screen.note(f"{len(made.refused)} of {made.charts} charts are refused, and left as they are")
    different = any(each.proof is not None and each.proof.different for each in made.lowered)
    return _FINDINGS if different or made.refused else exit_code_for(screen, project.diagnostics)


def _refusal(error: LoweringError) -> dict[str, object]:
    """A refusal as plain data, with the comparison that has led to it."""
    data: dict[str, object] = dict(error_data(error))
    return data | ({"proof": error.verdict.as_dict()} if isinstance(error, UntestedError) else {})


def _made(
    project: Project, how: How, folder: Path, name: str, progress: Callable[[SearchProgress], None] | None
) -> _Made:
    """Lower the charts and write them into a folder of drafts; what is written has been compared."""
    refused: dict[str, LoweringError] = {}
    while True:
        lowered = list(_lowered(project, how, refused))
        if not lowered:
            return _Made([], refused, ConversionReport(), folder)
        place = folder / str(len(refused))
        place.mkdir()
        draft = place / Path(name).name
        is_folder = name.endswith(("/", os.sep))
        asked_for, left_out = _asked_for(lowered[-1].project, how)
        report = save(asked_for, f"{draft}/" if is_folder else draft, format=how.to, tia=how.tia, partial=True)
        for pou in left_out:
            why = "it was not asked for, and SCL has no charts: the file has no such block"
            report.add(Outcome.NOT_EXECUTED, "chart", pou.report_path, why)
        seen = load(draft, format=how.to, as_tool=True) if how.verify else None
        late: dict[str, LoweringError] = {}
        for number, each in enumerate(lowered):
            chart = resolve(project, each.name)
            try:
                with errors_of(chart.project, chart.pou, chart.name):
                    refuse_comments(report, [each])
                    if seen is not None:
                        proof = prove_written(
                            chart,
                            each,
                            seen,
                            partial(load, draft, format=how.to),
                            free_inputs=how.free,
                            limit=how.limit,
                            progress=progress,
                        )
                        refuse_untested(each.name, proof, accepted=how.accept_untested)
                        lowered[number] = replace(each, proof=proof, faults=faults_of(chart, each))
            except LoweringError as error:
                late[each.name] = error
                if isinstance(error, UntestedError) and error.verdict.interrupted:
                    break
        refused |= late
        lowered = [each for each in lowered if each.name not in late]
        stopped = any(isinstance(error, UntestedError) and error.verdict.interrupted for error in late.values())
        if not late or not how.skip_refused or stopped:
            return _Made(lowered, refused, report, draft)


def _asked_for(project: Project, how: How) -> tuple[Project, list[Pou]]:
    """The project without the charts that were not asked for, where they would be blocks that do nothing; and these."""
    left_out = [pou for pou in project.pous if pou.sfc is not None] if how.pou is not None and how.to == "scl" else []
    if not left_out:
        return project, []
    copy = project.model_copy(deep=True)
    names = {pou.name for pou in left_out}
    copy.pous = [pou for pou in copy.pous if pou.name not in names]
    return copy, left_out


def _written(made: _Made, how: How, name: str) -> ConversionReport:
    """Put the draft where it belongs."""
    if made.draft.is_dir():
        return save(made.lowered[-1].project, name, format=how.to, tia=how.tia, partial=True)
    write_atomic(Path(name), made.draft.read_bytes())
    made.report.written = [name]
    return made.report


def refuse_comments(report: ConversionReport, lowered: Sequence[LoweredPou]) -> None:
    """Raise `LoweringError` where networks would stand in a comment: the proof finds that too, but not why."""
    blocks = {f"POU {each.name}" for each in lowered}
    for item in report.with_outcome(Outcome.EXTENSION_DATA, Outcome.NOT_EXECUTED):
        if item.what in ("network", "body") and item.path in blocks:
            raise LoweringError(
                f"a network would stand in a comment only: {item.why}",
                location=Location(path=item.path),
                hint="Structured text can hold it: --language ST.",
            )


def _lowered(project: Project, how: How, refused: dict[str, LoweringError]) -> Iterator[LoweredPou]:
    """The chart that was asked for, or all charts, each in the project that the one before it has left.

    Charts that are `refused` are left out; those that are refused now are added to them.
    """
    names = [how.pou] if how.pou is not None else [chart.name for chart in project.charts()]
    if not names:
        raise LoweringError("there is no chart to be lowered")
    left = set(names) - set(refused)
    following = ""
    while left:
        name = how.pou or first_chart(chart for chart in project.charts() if chart.name in left)
        if name is None:  # all others were lowered with those that call them
            return
        left.remove(name)
        try:
            lowered = lower(
                project,
                how.construction,
                pou=name,
                style=how.style,
                language=how.language,
                profile=how.profile,
                init=how.init,
                stop=how.stop,
                reset_actions=how.reset_actions,
                states=how.states,
                actions=how.actions,
                flags=flags_of_several(how.flags, name, following) if len(names) > 1 else how.flags,
                modes=how.modes,
                at_rest=how.at_rest,
                target=how.to,
                lang=how.lang,
                verify=False,
            )
        except LoweringError as error:
            if error.location.path is None:  # an option that concerns all charts
                raise
            refused[name] = error
            continue
        yield lowered
        project, following = lowered.project, lowered.following or following


def first_chart(charts: Iterable[Chart]) -> str | None:
    """The name of the one to lower first: of a POU, else of an action, which none of the others uses.

    Charts bring those of the actions that they call along; code of an action that is there already would be taken
    for a part of their own.
    """
    charts = list(charts)
    used = {f"{chart.pou.name}.{name}".casefold() for chart in charts for name in _used_by(chart)}
    bodies = [chart.name for chart in charts if chart.name == chart.pou.name]
    outer = [chart.name for chart in charts if chart.name.casefold() not in used]
    return next(iter([*bodies, *outer, *(chart.name for chart in charts)]), None)


def _used_by(chart: Chart) -> Iterator[str]:
    for step in chart.network.steps:
        used = [*(each.target for each in step.actions), step.entry_action, step.main_action, step.exit_action]
        yield from (name for name in used if isinstance(name, str) and f"{chart.pou.name}.{name}" != chart.name)


def _show(screen: Screen, target: str, lowered: Sequence[LoweredPou], report: ConversionReport) -> None:
    for each in lowered:
        head, *rest = str(each).splitlines()
        screen.line((each.name, "bold"), head.removeprefix(each.name))
        for line in rest if each.proof is not None else [*rest, "not compared with the chart"]:
            screen.line(line)
    losses = [*(item for each in lowered for item in each.losses), *report.losses]
    for item in losses if screen.verbose else losses[:_SHOWN]:
        screen.line((item.outcome.value, "yellow"), f": {item.place}: {item.why}")
    if len(losses) > _SHOWN and not screen.verbose:
        screen.line(f".. and {len(losses) - _SHOWN} more: --verbose shows all, --report writes all")
    screen.line("written: ", (target, "bold"))


def _beside(source: Path, to: str) -> str:
    """A name next to `source`: a folder for a folder, if the format has them."""
    kind = format_named(to)[0]
    extension = "" if source.is_dir() and kind.folders else kind.extensions[0]
    place = source.resolve() if source.is_dir() else source
    return str(place.with_name(f"{place.stem}-lowered{extension}"))
