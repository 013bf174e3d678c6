"""``plcopen-sfc lower``: program code instead of a chart, with the proof that it does the same."""

from __future__ import annotations

import json
import os
import re
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from plcopen_sfc.analysis.equivalence import Outcome
from plcopen_sfc.api import load, save
from plcopen_sfc.cli.reading import exit_code_for
from plcopen_sfc.cli.screen import Screen
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.files import write_atomic
from plcopen_sfc.formats.registry import format_named
from plcopen_sfc.lowering.code.flag_places import flags_of_several
from plcopen_sfc.lowering.forms import Style
from plcopen_sfc.lowering.lower import LoweredPou, faults_of, lower
from plcopen_sfc.lowering.proving import prove
from plcopen_sfc.model.project import Chart, Project
from plcopen_sfc.report import ConversionReport, Fate
from plcopen_sfc.semantics.subjects import Subject, resolve

_FINDINGS = 1
_SHOWN = 10
_DRAWN = re.compile(r"pous\[[^\]]*\]\.bodies\[\d+\]\.networks\[\d+\]\.nodes\b")
"""How networks are drawn, which each format does in its own way; that they do the same is proven."""


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
    lang: str
    verify: bool
    tia: str = ""


def run(screen: Screen, source: str, target: str | None, how: How, *, report_to: Path | None) -> int:
    """Lower the charts of `source`, or one of them, and write the project with the code to `target` (None: next to it).

    What is written has been read back and compared with the chart. Where exact code is different nothing is written.
    """
    project = load(source, progress=lambda files: screen.progress(files, "Loading"))
    for finding in project.diagnostics:
        screen.finding(finding, result=False)
    lowered = list(_lowered(project, how))
    name = target or _beside(Path(source), how.to)
    with tempfile.TemporaryDirectory() as folder:
        draft = Path(folder) / Path(name).name
        is_folder = name.endswith(("/", os.sep))
        report = save(lowered[-1].project, f"{draft}/" if is_folder else draft, format=how.to, tia=how.tia)
        _refuse_comments(report, lowered)
        if how.verify:
            again = load(draft, format=how.to)
            lowered = [_compared(resolve(project, each.name), again, each) for each in lowered]
        if draft.is_dir():
            report = save(lowered[-1].project, name, format=how.to, tia=how.tia)
        else:
            write_atomic(Path(name), draft.read_bytes())
            report.written = [name]
    if how.verify:
        report.items = [item for item in report.items if not _DRAWN.match(item.path)]
    data = {"file": name, "pous": [each.as_dict() for each in lowered], "conversion": report.as_dict()}
    if report_to is not None:
        write_atomic(report_to, (json.dumps(data, ensure_ascii=False, indent=2) + "\n").encode())
    if screen.as_json:
        screen.json(data)
    else:
        _show(screen, name, lowered, report)
    different = any(each.proof is not None and each.proof.outcome is Outcome.DIFFERENT for each in lowered)
    return _FINDINGS if different else exit_code_for(screen, project.diagnostics)


def _refuse_comments(report: ConversionReport, lowered: Sequence[LoweredPou]) -> None:
    """Raise `LoweringError` where code would stand in a comment: we read it back from there, but its tool does not."""
    blocks = {f"POU {each.name}" for each in lowered}
    for item in report.with_fate(Fate.CARRIED):
        if item.what in ("network", "body") and item.path in blocks:
            raise LoweringError(
                f"nothing is written: a network of {item.path} would stand in a comment only: {item.why}",
                hint="Structured text can hold it: --language ST.",
            )


def _lowered(project: Project, how: How) -> Iterator[LoweredPou]:
    """The chart that was asked for, or all charts, each in the project that the one before it has left."""
    name = how.pou or _first_chart(project)
    if name is None:
        raise LoweringError("there is no chart to be lowered")
    several = how.pou is None and len(list(project.charts())) > 1
    following = ""
    while True:
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
            flags=flags_of_several(how.flags, name or "", following) if several else how.flags,
            modes=how.modes,
            target=how.to,
            lang=how.lang,
            verify=False,
        )
        yield lowered
        project, following = lowered.project, lowered.following or following
        name = _first_chart(project)
        if how.pou is not None or name is None:
            return


def _first_chart(project: Project) -> str | None:
    """The name of a chart: of a POU, else of an action, which none of the others uses.

    Charts bring those of the actions that they call along; code of an action that is there already would be taken
    for a part of their own.
    """
    charts = list(project.charts())
    used = {f"{chart.pou.name}.{name}".casefold() for chart in charts for name in _used_by(chart)}
    bodies = [chart.name for chart in charts if chart.name == chart.pou.name]
    outer = [chart.name for chart in charts if chart.name.casefold() not in used]
    return next(iter([*bodies, *outer, *(chart.name for chart in charts)]), None)


def _used_by(chart: Chart) -> Iterator[str]:
    for step in chart.network.steps:
        used = [*(each.target for each in step.actions), step.entry_action, step.main_action, step.exit_action]
        yield from (name for name in used if isinstance(name, str) and f"{chart.pou.name}.{name}" != chart.name)


def _compared(chart: Subject, again: Project, lowered: LoweredPou) -> LoweredPou:
    """With the proof for the code as it was read back, and the faults of a textbook form."""
    proof = prove(
        chart,
        resolve(again, chart.name),
        lowered.profile,
        fixed=lowered.at_rest,
        left_out=lowered.left_out,
        step_flags=lowered.step_flags or None,
    )
    if proof.outcome is Outcome.DIFFERENT and lowered.style is Style.EXACT:
        raise LoweringError(
            f"nothing is written: read back, the code does not do what the chart does: {proof}",
            hint="Please report it with the chart.",
        )
    return replace(lowered, proof=proof, faults=faults_of(chart, lowered))


def _show(screen: Screen, target: str, lowered: Sequence[LoweredPou], report: ConversionReport) -> None:
    for each in lowered:
        head, *rest = str(each).splitlines()
        screen.line((each.name, "bold"), head.removeprefix(each.name))
        for line in rest if each.proof is not None else [*rest, "not compared with the chart"]:
            screen.line(line)
    losses = [*(item for each in lowered for item in each.losses), *report.losses]
    for item in losses if screen.verbose else losses[:_SHOWN]:
        screen.line((item.fate.value, "yellow"), f": {item.what} {item.path}: {item.why}")
    if len(losses) > _SHOWN and not screen.verbose:
        screen.line(f".. and {len(losses) - _SHOWN} more: --verbose shows all, --report writes all")
    screen.line("written: ", (target, "bold"))


def _beside(source: Path, to: str) -> str:
    """A name next to `source`: a folder for a folder, if the format has them."""
    kind = format_named(to)[0]
    extension = "" if source.is_dir() and kind.folders else kind.extensions[0]
    place = source.resolve() if source.is_dir() else source
    return str(place.with_name(f"{place.stem}-lowered{extension}"))
