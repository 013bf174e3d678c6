"""Several charts of a project lowered one after the other, each in the project that the one before it has left."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import TypedDict, Unpack

from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering.chart_lowering import LoweredPou, lower
from plcopen_sfc.lowering.code.code_declarations import flags_of_several
from plcopen_sfc.lowering.lowering_options import ActionPlace, Construction, Language, OperatingMode, States, Style
from plcopen_sfc.model.project import Chart, Project
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.subjects import resolve


class LoweringOptions(TypedDict, total=False):
    """Options of `lower` but for the construction, the target and the proof."""

    style: Style | str
    language: Language | str | None
    profile: Profile | str | None
    init: str | None
    stop: str | None
    reset_actions: bool
    states: States | str | None
    actions: ActionPlace | str
    flags: str
    flag_names: str
    modes: Iterable[OperatingMode | str]
    at_rest: Iterable[str]
    lang: str


@dataclass(frozen=True)
class LoweredProject:
    """A project with code instead of charts: `project` has that of all `pous`; `refused` has an error for each other.

    Charts that were lowered together with one that calls them are in neither.
    """

    project: Project
    pous: tuple[LoweredPou, ...]
    refused: dict[str, LoweringError]


def lower_project(
    project: Project,
    construction: Construction | str = Construction.AUTO,
    *,
    pou: str | None = None,
    without: Collection[str] = (),
    target: str | None = None,
    **options: Unpack[LoweringOptions],
) -> LoweredProject:
    """Lower all charts of a project, or the one called `pou`, but for those `without`; nothing is proven yet.

    Raises `LoweringError` where there is no chart, or an option is wrong for all of them.
    """
    names = [pou] if pou is not None else [chart.name for chart in project.charts()]
    if not names:
        raise LoweringError("there is no chart to be lowered")
    flags = options.get("flags", "local")
    options["modes"], options["at_rest"] = tuple(options.get("modes", ())), options.get("at_rest", ())
    left = set(names) - set(without)
    found: list[LoweredPou] = []
    refused: dict[str, LoweringError] = {}
    current, following = project, ""
    while left:
        name = pou or next_chart(chart for chart in current.charts() if chart.name in left)
        if name is None:  # all others were lowered with those that call them
            break
        left.remove(name)
        if len(names) > 1:
            options["flags"] = flags_of_several(flags, name, following)
        try:
            lowered = lower(current, construction, pou=name, target=target, verify=False, **options)
        except LoweringError as error:
            if error.location.path is None:  # an option that concerns all charts
                raise
            refused[name] = error
            continue
        found.append(replace(lowered, chart=resolve(project, name)))
        current, following = lowered.project, lowered.following or following
    return LoweredProject(current, tuple(found), refused)


def next_chart(charts: Iterable[Chart]) -> str | None:
    """Return the name of the chart to lower first: of a POU, else of an action that no other chart uses.

    Lowering a chart lowers those of the actions that it calls too. Code that an action has already would be taken for a
    part of the chart itself.
    """
    charts = list(charts)
    used = {f"{chart.pou.name}.{name}".casefold() for chart in charts for name in _actions_of(chart)}
    bodies = [chart.name for chart in charts if chart.name == chart.pou.name]
    outer = [chart.name for chart in charts if chart.name.casefold() not in used]
    return next(iter([*bodies, *outer, *(chart.name for chart in charts)]), None)


def _actions_of(chart: Chart) -> Iterator[str]:
    """Yield the names of the actions that the steps of a chart use, but for its own."""
    for step in chart.chart.steps:
        used = [*(each.target for each in step.actions), step.entry_action, step.main_action, step.exit_action]
        yield from (name for name in used if isinstance(name, str) and f"{chart.pou.name}.{name}" != chart.name)
