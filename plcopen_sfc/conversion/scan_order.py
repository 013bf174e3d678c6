"""Charts whose actions one tool executes before the transitions, and the other one behind them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from plcopen_sfc.conversion.causes import acting_early, only_one, told_held, told_held_calls
from plcopen_sfc.conversion.executed_parts import FIRST_SCAN
from plcopen_sfc.conversion.reporting import in_the_source
from plcopen_sfc.languages.binding import actions_by_name, bind, names_in, step_effects
from plcopen_sfc.languages.binding.name_scopes import with_inner_charts
from plcopen_sfc.languages.binding.reached_pous import reached_pous
from plcopen_sfc.model.actions import ActionEvent, Qualifier
from plcopen_sfc.model.chart_settings import SfcFlag
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Chart, Project
from plcopen_sfc.model.sfc import ActionAssociation, SfcBody, Step
from plcopen_sfc.model.types import SimpleValue, used_types
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.report import CHART_OF_ACTION, INPUTS_OF_ACTIONS, START_OF_CHART, ConversionReport, Outcome
from plcopen_sfc.semantics.inputs import MEMBER_NAMES
from plcopen_sfc.semantics.profile import Profile, ScanOrder

_GIVEN = (SectionKind.INPUT, SectionKind.IN_OUT)
_KEPT = (SectionKind.LOCAL, SectionKind.EXTERNAL, SectionKind.GLOBAL)
_OPERATING = MEMBER_NAMES | {flag.variable.casefold() for flag in SfcFlag}
"""Names of variables by which people operate a chart: a run keeps them at rest, or the report names them."""

_BEGINNING = {SfcFlag.INIT.variable.casefold(), SfcFlag.RESET.variable.casefold()}

_OF_SUPERVISIONS = (ActionEvent.V1, ActionEvent.V0, ActionEvent.A1)
_PULSES = (Qualifier.P, Qualifier.P0, Qualifier.P1)
_SHOWN = 5


def report_scan_order(
    report: ConversionReport,
    source: Project,
    result: Project,
    called: Mapping[str, str],
    *,
    profiles: tuple[Profile, Profile],
    tool: str,
) -> None:
    """Report what charts do otherwise where tools have another order of actions and transitions, or another start.

    `called` gives the paths in the source of what has another name in the result, `profiles` the rules of both tools.
    """
    early, start = acting_early(profiles, tool), _start(profiles, tool)
    is_entered = profiles[1].initial_steps_entered and not profiles[0].initial_steps_entered
    begun = {item.path for item in report.items if item.what == FIRST_SCAN}
    # of a source that holds first calls, what is written holds them, too
    holds = told_held_calls(profiles, tool) if profiles[1].initial_situation_held and not early else ""
    for there, here in chart_pairs(source, result, called) if early or start or is_entered else ():
        if here is None:
            continue
        if start and there.report_path not in begun and is_begun_for_good(there):
            why = f"its initial step does more than switch on variables while it is active: {start}"
            report.add(Outcome.APPROXIMATED, START_OF_CHART, there.report_path, why)
        elif is_entered and any(row.qualifier in _PULSES for step in _initial(there) for row in step.actions):
            why = f"its initial step has pulses, which the source does not execute at the start: {tool} does"
            report.add(Outcome.APPROXIMATED, START_OF_CHART, there.report_path, why)
        if holds and calls_charts(there, source):
            report.add(Outcome.APPROXIMATED, CHART_OF_ACTION, there.report_path, f"it calls charts: {holds}")
        read = _inputs_read(there, source) if early else []
        if read:
            shown = ", ".join(read[:_SHOWN]) + (", .." if len(read) > _SHOWN else "")
            why = f"its actions read {shown}: {early}"
            report.add(Outcome.APPROXIMATED, INPUTS_OF_ACTIONS, there.report_path, why)


def _start(profiles: tuple[Profile, Profile], tool: str) -> str:
    """Return what one of two tools alone does in the first scan of a chart; empty where both do the same."""
    if held := told_held(profiles, tool):
        return held
    early = only_one(profiles, tool, lambda each: each.order is ScanOrder.ACTIONS_FIRST)
    return early and f"{early} executes its actions in the first scan before a transition is tested"


def _inputs_read(chart: Chart, project: Project) -> list[str]:
    """Return the variables that the actions of a chart read and that get their values from outside.

    They are inputs of its POU, and other variables that nothing writes which a scan executes.
    """
    reading = list(_names_of_actions(chart, project))
    # of the chart itself only what is read counts; of what it calls any name may be
    done = step_effects(list(_acting(chart)), actions_by_name(chart.pou), project.dialect)
    named = {name for path in done.reads for name in path} | {name for _, names in reading[1:] for name in names}
    called = {path[-1] for path in done.calls}
    methods = [method for method in chart.pou.methods if method.name.casefold() in called]
    named |= {name for method in methods for name in names_in(method, project.dialect)}
    named -= _OPERATING
    given = {v.name for kind in _GIVEN for v in chart.pou.variables(kind)}
    blocks = [block.interface for block in project.data_blocks if block.interface is not None]
    own = [each for each in (chart.pou.interface, *blocks) if each is not None]
    sections = [*project.global_sections(), *(section for each in own for section in each.sections)]
    plain = {each.name.casefold() for each in project.data_types}  # function blocks get no values from outside
    others = {
        variable.name
        for section in sections
        if section.kind in _KEPT and not section.constant
        for variable in section.variables
        if plain.issuperset(map(str.casefold, used_types(variable.type)))
    }
    wanted = {name for name in given | others if name.casefold() in named}
    written = {name for path in (*done.writes, *done.calls) for name in path}
    if any(name.casefold() not in written for name in wanted - given):  # seldom: to bind all bodies takes long
        written |= _written([pou for pou, _ in reading], project)
    return sorted(name for name in wanted if name in given or name.casefold() not in written)


def _acting(chart: Chart) -> Iterator[Step]:
    """Yield the steps of a chart with what their actions read: supervisions are a part of conditions, but for events.

    Macro-steps have steps of their own.
    """
    for step in (step for inner in with_inner_charts(chart.chart) for step in inner.steps):
        is_awaited = any(row.event in _OF_SUPERVISIONS for row in step.actions)
        supervision = step.supervision if is_awaited else None
        is_all = supervision is step.supervision and step.macro is None  # nearly all: a copy takes 50 times as long
        yield step if is_all else step.model_copy(update={"supervision": supervision, "macro": None})


def _written(pous: Iterable[Pou], project: Project) -> set[str]:
    """Return the names (lower case) in what some POUs write or call, also of what it is a part of."""
    effects = [bind(body, project.dialect).effects for pou in pous for _, _, body in pou.named_bodies()]
    return {name for each in effects for path in (*each.writes, *each.calls) for name in path}


def is_begun_for_good(chart: Chart) -> bool:
    """True if a chart can do something else for good where its first scan is another one.

    A Boolean that follows its initial step is late or early once. What is stored, and what statements do, stays, but
    for the reset of a variable that is FALSE at the start.
    """
    bodies = {action.name.casefold() for action in chart.pou.actions}
    reset = set(_begun_as_false(chart.pou)) - bodies

    def follows(each: ActionAssociation) -> bool:
        target, plain = (each.target or "").casefold(), each.event is None and each.body is None and each.value is None
        is_kept = each.qualifier in (Qualifier.N, Qualifier.L, Qualifier.D) and target not in bodies
        return plain and (is_kept or (each.qualifier is Qualifier.R and target in reset))

    return any(
        s.entry_action or s.main_action or s.exit_action or not all(map(follows, s.actions)) for s in _initial(chart)
    )


def may_race(chart: Chart, inputs: Iterable[str]) -> bool:
    """True if a chart can do something else for good where its actions see other times than its transitions.

    That are actions with times and statements, and steps that others are active beside: each timed one lasts a scan
    longer; or `inputs` operate the chart. A Boolean follows its step.
    """
    bodies = {action.name.casefold() for action in chart.pou.actions}

    def acts(row: ActionAssociation) -> bool:
        return bool(row.duration or row.body or row.value) or (row.target or "").casefold() in bodies

    if chart.chart.partial_charts:
        return True
    for inner in with_inner_charts(chart.chart):
        if inner.permanent or len(inner.initial_steps) > 1:
            return True
        if any(len(each.targets) > 1 for each in inner.transitions):
            return True
        if any(s.entry_action or s.main_action or s.exit_action or any(map(acts, s.actions)) for s in inner.steps):
            return True
    return not _OPERATING.isdisjoint(name.casefold() for name in inputs)


def is_begun_again(inputs: Iterable[str]) -> bool:
    """True if one of the `inputs` of a run begins a chart of CODESYS again."""
    return not _BEGINNING.isdisjoint(name.casefold() for name in inputs)


def calls_charts(chart: Chart, project: Project) -> bool:
    """True if a chart calls another one, or one that is an action of its POU."""
    if any(isinstance(action.body, SfcBody) for action in chart.pou.actions):
        return True
    reached = reached_pous(chart.pou, names_in(chart.pou, project.dialect), project)
    return any(pou.chart is not None for pou, _ in reached if pou is not chart.pou)


def _initial(chart: Chart) -> Iterator[Step]:
    return (step for inner in with_inner_charts(chart.chart) for step in inner.initial_steps)


def _begun_as_false(pou: Pou) -> Iterator[str]:
    """Yield the Boolean variables (lower case) of a POU that nothing sets before its first scan."""
    for section in pou.interface.sections if pou.interface is not None else ():
        is_own = section.kind in (SectionKind.LOCAL, SectionKind.OUTPUT)
        for each in section.variables if is_own and not (section.retain or section.persistent) else ():
            initial = each.initial
            is_false = initial is None or (isinstance(initial, SimpleValue) and (initial.text or "").upper() == "FALSE")
            if is_false and each.address is None:
                yield each.name.casefold()


def reads_inputs(chart: Chart, project: Project, inputs: Iterable[str]) -> bool:
    """True if the actions of a chart read some of the `inputs` of a run."""
    known = {name.casefold().partition("[")[0].rpartition(".")[2] for name in inputs}
    return any(not known.isdisjoint(names) for _, names in _names_of_actions(chart, project))


def _names_of_actions(chart: Chart, project: Project) -> Iterator[tuple[Pou, set[str]]]:
    """Yield the POU of a chart and the names in its actions and steps, then all POUs that these may call."""
    texts = (*chart.pou.actions, *chart.pou.methods, *_acting(chart))
    names = {name for each in texts for name in names_in(each, project.dialect)}
    return reached_pous(chart.pou, names, project)


def chart_pairs(source: Project, result: Project, called: Mapping[str, str]) -> Iterator[tuple[Chart, Chart | None]]:
    """Yield the charts of the source that are not empty, each with that of the result."""
    found = {in_the_source(chart.report_path, called).casefold(): chart for chart in result.charts()}
    for chart in source.charts():
        if chart.chart.steps or chart.chart.partial_charts:
            yield chart, found.get(chart.report_path.casefold())
