"""Differences in what is executed as items of a `ConversionReport`, in the words of an engineer.

Source and result of a conversion are run against each other, under the rules of their tools.
"""

from __future__ import annotations

import re
import time
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

from plcopen_sfc.conversion.assumed_types import assumed_types, with_types
from plcopen_sfc.conversion.causes import concerns, times_among, told_apart, told_difference, told_while_held
from plcopen_sfc.conversion.comparison import OF_LIBRARY, ExecutionDifference
from plcopen_sfc.conversion.executed_parts import (
    FIRST_SCAN,
    HIDDEN_FLAG,
    OPERATING_INPUT,
    OPERATING_KINDS,
    PLAIN_VARIABLES,
    PROGRAM_CALL,
    RESTING_INPUT,
    SHOWN_STATE,
    STABILITY,
    START,
    STORED,
    UNDECLARED,
    UNDECLARED_TYPE,
    UNUSED_INPUT,
)
from plcopen_sfc.conversion.meaning import UNREAD_CONDITION
from plcopen_sfc.diagnostics import Diagnostic
from plcopen_sfc.errors import SfcError
from plcopen_sfc.languages.binding import names_in
from plcopen_sfc.languages.binding.name_scopes import with_inner_charts
from plcopen_sfc.languages.declarations.kept_texts import inheritance
from plcopen_sfc.model.actions import ActionAssociation, Qualifier
from plcopen_sfc.model.project import Chart, Project
from plcopen_sfc.model.sfc import SfcFlag
from plcopen_sfc.model.types import used_types
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.object_path import ObjectPath
from plcopen_sfc.report import (
    ARITHMETIC,
    CHART_OF_ACTION,
    FALLING_EDGE,
    LOSSES,
    ORDER_OF_ACTIONS,
    ConversionReport,
    Item,
    Outcome,
)
from plcopen_sfc.semantics.net import Net
from plcopen_sfc.semantics.profile import Evolution, Profile, ScanOrder, default_profile
from plcopen_sfc.semantics.programs.variable_use import ALL_FREE
from plcopen_sfc.semantics.subjects import resolve

if TYPE_CHECKING:
    from plcopen_sfc.analysis.verdict import Counterexample, Verdict

    pass

_CAP, _RUNS, _SCANS = 2_000, 10, 100
"""States of a search for a proof, and runs without one: a difference between tools shows early, or is proven away."""

_APART = OPERATING_KINDS | {SHOWN_STATE, STABILITY, START, FIRST_SCAN, CHART_OF_ACTION, ORDER_OF_ACTIONS, FALLING_EDGE}
_APART |= {ARITHMETIC, "retain", "address", "interval", "max time", "maximum time"}
"""Losses beside which a run shows more: what operates a chart rests, nothing looks at addresses or times of tasks, and
the chart of a GRAFCET may have no step that is only passed, and begins one scan later. A block for the chart of an
action may do the same, and actions in another order or calculations of other widths."""


def report_running(
    report: ConversionReport,
    source: Project,
    result: Project,
    called: Mapping[str, str],
    *,
    tool: str,
    target: Profile | None,
    limit: float,
) -> None:
    """Run each chart of `source` and what the target `tool` reads of it, and add what came of it to `report`.

    Charts in which something is not executed are left out: they differ. Where something is approximated, the run tells
    whether that changes what the chart does; the report names it already, so a difference is no item of its own.
    `called` gives the paths in the source of what has another name in the result, `target` the rules of the target
    where they are not those of its files. `limit` is the time in seconds that all of this may take.
    """
    from plcopen_sfc.analysis.equivalence import equivalent  # noqa: PLC0415  # most conversions run nothing
    from plcopen_sfc.analysis.pairing import Delay  # noqa: PLC0415
    from plcopen_sfc.analysis.verdict import VerdictKind  # noqa: PLC0415

    profiles = default_profile(source), target or default_profile(result)
    end = time.monotonic() + limit
    losses = [item for item in report.losses if not _is_apart(item) and item.what != UNDECLARED_TYPE]
    undeclared = {item.why.split("`")[1].casefold() for item in report.losses if item.what == UNDECLARED_TYPE}
    assumed = assumed_types(source, undeclared) if undeclared else []
    undeclared -= {declaration.name.casefold() for declaration in assumed}
    running = [with_types(project, assumed) if assumed else project for project in (source, result)]
    for there, here in list(_pairs(source, result, called)):
        named = {item.outcome for item in losses if concerns(item, there.report_path)}
        types = [name for variable in there.pou.variables() for name in used_types(variable.type)]
        unknown = next((name for name in types if name.casefold() in undeclared), None)
        if here is not None and unknown is not None:  # no run knows what its members are, or that blocks share them
            report.compared[there.report_path] = f"not compared: nothing declares the type `{unknown}` of its variables"
            continue
        if here is None or Outcome.NOT_EXECUTED in named:
            what = "what is not executed" if named else f"nothing in {tool} that has its name"
            report.compared[there.report_path] = f"not compared: the report names {what}"
            continue
        left = end - time.monotonic()
        if left <= 0:
            _note_untested(report, there.report_path, "not run: the time limit was reached")
            continue
        compared = partial(
            equivalent,
            resolve(running[0], there.name),
            resolve(running[1], here.name),
            profile=profiles,
            step_flags=_step_flags(there, here, called, _hidden_flags(report, there)),
            inputs=_renamed_variables(here, called) | _executed_inputs(report, there),
            free_inputs=ALL_FREE,
            cap=_CAP,
            runs=_RUNS,
            scans=_SCANS,
        )
        try:
            verdict = compared(delay="auto", limit=left)
            is_cut = verdict.delay.retimed and verdict.equal
            other = profiles[0].order is not profiles[1].order
            is_cut = is_cut and _lasts(there, source, verdict.inputs, has_other_inputs=other)
            as_run = compared(delay=Delay(verdict.delay.scans), limit=left) if is_cut else verdict
        except SfcError as error:
            _note_untested(report, there.report_path, f"not run: {error.message}")
            continue
        run = _Run(there, verdict, as_run, profiles, tool)
        if named:
            report.compared[there.report_path] = run.told_with(losses)
        elif verdict.kind is VerdictKind.UNTESTED:
            _note_untested(report, there.report_path, *str(verdict).splitlines())
        else:
            times, left = times_among(verdict.inputs, there), end - time.monotonic()
            is_held = verdict.counterexample is not None and times and left > 0
            held = told_while_held(compared(delay="auto", limit=left, fixed=times), times) if is_held else ""
            _report_run(report, run, held)
        if profiles[0].evolution is Evolution.UNTIL_STABLE is not profiles[1].evolution and not as_run.equal:
            single = replace(profiles[0], evolution=profiles[1].evolution), profiles[1]
            report.compared[there.report_path] += _told_single(compared, single, end - time.monotonic())
        if any(name.casefold() == declaration.name.casefold() for name in types for declaration in assumed):
            report.compared[there.report_path] += "; types that nothing declares have the members that are used of them"


def _told_single(compared: Callable[..., Verdict], profiles: tuple[Profile, Profile], limit: float) -> str:
    """Return how a GRAFCET without the search for stability compares with its result, which has none; else nothing.

    What is left of a difference then is one of the conversion: with the search, inputs that come together tell apart
    every chart whose steps they pass.
    """
    try:
        verdict = compared(profile=profiles, delay="auto", limit=limit) if limit > 0 else None
    except SfcError:
        return ""
    if verdict is None or verdict.counterexample is not None:
        return ""
    return f"; without its search for stability: {str(verdict).splitlines()[0]}"


class _Run(NamedTuple):
    """A chart of the source that was run against its result.

    `verdict`: what was found; `as_run`: the same with a constant delay only, where that is another question.
    """

    place: Chart
    verdict: Verdict
    as_run: Verdict
    profiles: tuple[Profile, Profile]
    tool: str

    def told_with(self, losses: Sequence[Item]) -> str:
        """Return what was found of a chart in which the report names something as approximated."""
        example = self.as_run.counterexample
        told = self.told(example, losses) if example is not None else str(self.as_run).splitlines()[0]
        return f"{told}; what the report names as approximated is in it"

    def told(self, example: Counterexample, losses: Sequence[Item], rule: str = "") -> str:
        """Return a difference in words, with its cause, which is the `rule` of a tool where one is given."""
        return told_difference(example, self.place, losses, self.profiles, self.tool, rule=rule)


def _report_run(report: ConversionReport, run: _Run, held: str) -> None:
    """Report what was found of a chart of which the report names no loss; `held`: while times of actions stay."""
    verdict, as_run, path = run.verdict, run.as_run, run.place.report_path
    report.compared[path] = str(as_run).splitlines()[0]
    if not as_run.equal and verdict.equal:
        report.compared[path] += "; the same but for the inputs that actions see, and the first scan"
    if verdict.proven:
        usual = 1 if run.profiles[1].order is ScanOrder.ACTIONS_FIRST else 0  # a later result passed other situations
        if abs(verdict.delay.scans) <= usual:
            _note_proven(report, path, STABILITY, "which fires transitions once in a scan")
        _note_proven(report, path, CHART_OF_ACTION, "which calls a block for the chart of the action")
        _note_proven(report, path, ORDER_OF_ACTIONS, "which executes actions in another order")
        _note_proven(report, path, FALLING_EDGE, "which sees another first edge of F_TRIG")
        if not run.profiles[1].initial_situation_held:  # of which no proof has the first scan
            _note_proven(report, path, FIRST_SCAN, "whose actions have not seen the initial step then")
        _note_proven(report, path, ARITHMETIC, "which calculates with other numbers of bits")
    if verdict.counterexample is not None:
        why = run.told(verdict.counterexample, report.losses)
        report.add(Outcome.APPROXIMATED, "chart", path, why + held)
    elif not as_run.equal:
        example = as_run.counterexample
        why = "it is not known to do the same"
        if example is not None:
            why = run.told(example, (), told_apart(example, run.profiles, run.tool))
        report.add(Outcome.APPROXIMATED, "chart", path, why)


def _lasts(chart: Chart, project: Project, inputs: Iterable[str], *, has_other_inputs: bool) -> bool:
    """True if a chart can do something else for good where its actions see other inputs, or in the first scan.

    A Boolean that follows its initial step is late or early once. What is stored, and what statements do, stays.
    """
    bodies = {action.name.casefold() for action in chart.pou.actions}

    def follows(each: ActionAssociation) -> bool:
        is_plain = each.qualifier in (Qualifier.N, Qualifier.L, Qualifier.D) and each.event is None
        return is_plain and each.body is None and each.value is None and (each.target or "").casefold() not in bodies

    for step in (step for inner in with_inner_charts(chart.chart) for step in inner.initial_steps):
        if step.entry_action or step.main_action or step.exit_action or not all(map(follows, step.actions)):
            return True
    if not has_other_inputs:
        return False
    known = {name.casefold().partition("[")[0].rpartition(".")[2] for name in inputs}
    return any(not known.isdisjoint(names) for names in _names_of_actions(chart, project))


def _names_of_actions(chart: Chart, project: Project) -> Iterator[set[str]]:
    """Yield the names (lower case) in the actions and steps of a chart, then in all POUs that these may call.

    Without the variables that a called POU has of its own. Types of variables that are named tell the blocks.
    """
    pous = {pou.name.casefold(): pou for pou in project.pous}
    types = {declared.name.casefold(): declared.type for declared in project.data_types}
    global_ = [variable for section in project.global_sections() for variable in section.variables]
    steps = (step for inner in with_inner_charts(chart.chart) for step in inner.steps)
    texts = (*chart.pou.actions, *chart.pou.methods, *steps)
    waiting = [(chart.pou, {name for each in texts for name in names_in(each, project.dialect)})]
    seen, family = {chart.pou.name.casefold()}, {chart.pou.name.casefold()}
    while waiting:
        pou, names = waiting.pop()
        bases = {base.casefold() for base in inheritance(pou.interface).extends}
        family |= bases if pou.name.casefold() in family else set()
        sections = pou.interface.sections if pou.interface is not None and pou.name.casefold() not in family else []
        own = {v.name.casefold() for each in sections if each.kind is not SectionKind.EXTERNAL for v in each.variables}
        yield names - own
        reached = names | bases
        kinds = [v.type for v in (*pou.variables(), *global_) if v.name.casefold() in names]
        while kinds:
            new = {name.casefold() for name in used_types(kinds.pop())} - reached
            reached |= new
            kinds += [types[name] for name in new & types.keys()]
        called = reached & pous.keys() - seen
        seen |= called
        waiting += [(pous[each], names_in(pous[each], project.dialect)) for each in called]


def _note_proven(report: ConversionReport, path: str, what: str, how: str) -> None:
    """Tell that the target does the same, `how` says in what way, where the report was not sure of it."""
    for at, item in enumerate(report.items):
        if item.what == what and f"{item.path} / ".startswith(f"{path} / "):
            why = f"with all inputs the target, {how}, does the same"
            report.items[at] = replace(item, outcome=Outcome.TRANSLATED, why=why)


def _hidden_flags(report: ConversionReport, chart: Chart) -> set[str]:
    """Return the steps whose flags are FALSE in the result where others are active in their place."""
    paths = [ObjectPath.of(item.path) for item in report.items if item.what == HIDDEN_FLAG]
    return {path.last.removeprefix("step ") for path in paths if path.around == chart.report_path}


def _step_flags(there: Chart, here: Chart, called: Mapping[str, str], hidden: Collection[str]) -> dict[str, str] | None:
    """Return the steps of the result by those of the source but for `hidden` ones; None where all have their names."""
    net, other = Net.of(there.chart), Net.of(here.chart)
    paths = zip(other.steps, other.report_paths(here.report_path)[0], strict=True)
    result = {in_the_source(path, called): step.path for step, path in paths}
    own = zip(net.steps, net.report_paths(there.report_path)[0], strict=True)
    found = {step.path: (step.step.name, result[path]) for step, path in own if path in result}
    if not hidden and all(path == step for path, (_, step) in found.items()):
        return None
    return {path: step for path, (name, step) in found.items() if name not in hidden}


def _renamed_variables(here: Chart, called: Mapping[str, str]) -> dict[str, str]:
    """Return the names in the source of variables that a POU of the result sees and that have others there."""
    own, shared = f"{here.pou.report_path} / ", "global variable "
    found = {
        new.removeprefix(shared): old.removeprefix(shared) for new, old in called.items() if new.startswith(shared)
    }
    plain = [path.removeprefix(own) for path in called if path.startswith(own) and "step " not in path]
    external = {variable.name for variable in here.pou.variables(SectionKind.EXTERNAL)}
    for variable in here.pou.variables():  # which hides a tag
        if variable.name not in external:
            found.pop(variable.name, None)
    return found | {name: ObjectPath.of(called[own + name]).last for name in plain if " / " not in name}


def _executed_inputs(report: ConversionReport, chart: Chart) -> dict[str, str]:
    """The inputs that operate a chart of S7-GRAPH and are executed in the target; all others rest."""
    executed = [item for item in report.with_outcome(Outcome.TRANSLATED) if item.what == OPERATING_INPUT]
    paths = [ObjectPath.of(item.path) for item in executed]
    found = {path.last: path.last for path in paths if path.around == chart.report_path}
    enables = SfcFlag.ENABLE_LIMIT.variable
    is_asked = any((each.what, each.path) == (enables, chart.report_path) for each in report.items)
    if is_asked and any(each.name == enables for each in chart.pou.variables(SectionKind.INPUT)):
        found[enables] = enables
    return found


def _note_untested(report: ConversionReport, path: str, found: str, *unreached: str) -> None:
    report.compared[path] = found
    report.untested[path] = list(unreached)


def _pairs(source: Project, result: Project, called: Mapping[str, str]) -> Iterator[tuple[Chart, Chart | None]]:
    """The charts of the source that are not empty, each with that of the result."""
    found = {in_the_source(chart.report_path, called).casefold(): chart for chart in result.charts()}
    for chart in source.charts():
        if chart.chart.steps or chart.chart.partial_charts:
            yield chart, found.get(chart.report_path.casefold())


def _is_apart(item: Item) -> bool:
    """True for a loss beside which a run shows more: a name that nothing declares is the same input on both sides."""
    return item.what in _APART or (item.what == UNDECLARED and item.outcome is Outcome.APPROXIMATED)


UNSAID = "; nothing was said of it while writing: please report this as a mistake of plcopen_sfc"
"""The end of what is said of a difference that the reader of the target found, and no writer had named."""

_SHOWN = 60
_LISTED = 5


def report_execution(
    report: ConversionReport, differences: Iterable[ExecutionDifference], tool: str, called: Mapping[str, str]
) -> None:
    """Add to `report` what the target `tool` does not execute, or executes otherwise.

    What a writer says it has translated, or has listed as a loss, is not listed again. What it has noted as extension
    data is taken out where it is not executed. A difference at a place of which no writer has said anything is a
    mistake of this package, and the item says so. `called` gives the paths in the source of what has another name in
    the target.
    """
    refused = {item.path for item in report.losses if item.what == "hierarchy"}
    report.items = [item for item in report.items if not _is_of_refused(item, refused)]
    settled = Counter(
        (in_the_source(item.path, called), item.what)
        for item in report.items
        if item.outcome in LOSSES or item.outcome is Outcome.TRANSLATED
    )
    lost = {(in_the_source(item.path, called), item.what) for item in report.items if item.outcome in LOSSES}
    found = list(_without_repetition(differences, {_last(path) for path, what in lost if what == "global variable"}))
    rewritten = _rewritten_steps(found, settled)
    changed = {(difference.path, difference.aspect) for difference in found}
    said = {name for item in report.items if item.outcome in LOSSES for name in _IN_PLACE.findall(item.why)}
    replaced = {_bare(item.path) for item in report.items if item.outcome in LOSSES and _IN_PLACE.search(item.why)}
    noticed = {item.path for item in report.items if item.outcome is not Outcome.KEPT}
    around_noticed = {around for path in noticed for around in ObjectPath.of(path).outwards()}
    words = {
        word.casefold()
        for item in report.items
        if item.outcome in LOSSES
        for found in _LACKED.findall(item.why)
        for word in found
    }
    not_executed = report.with_outcome(Outcome.NOT_EXECUTED)
    losing = {ObjectPath.of(in_the_source(item.path, called)).owner for item in not_executed}
    told = set()
    for difference in found:
        what = difference.aspect or difference.kind
        place = in_the_source(difference.path, called)
        names = {(place, each) for each in (what, *_ALSO_CALLED.get(what, ()))}
        names |= {(place, each) for each in OPERATING_KINDS if what in OPERATING_KINDS}
        if difference.kind == "chart" and place in refused:
            continue
        if difference.kind == "global variable" and any(
            aspect == difference.aspect and path.endswith(f" / {difference.name}") for path, aspect in lost
        ):
            continue  # a variable of a program that is a tag
        if difference.kind == "method":
            names.add((ObjectPath.of(place).around, "methods"))
        if difference.left is None and difference.kind in (UNDECLARED, "action") and difference.name in said:
            continue
        if difference.kind in (UNDECLARED, UNDECLARED_TYPE) and difference.name.casefold() in words:
            continue
        if difference.kind == UNDECLARED and _STAND_IN.match(difference.name) and ObjectPath.of(place).owner in losing:
            continue
        if difference.aspect in _WRITTEN_OTHERWISE and (difference.right or "").partition(" ")[0] in said:
            continue
        if difference.kind == "action" and ((place, "action") in lost or _bare(place) in replaced):
            continue
        if (f"{place} / {difference.aspect}", "flag") in lost:
            continue
        if names & settled.keys() or _is_rewritten(difference, rewritten, settled, changed):
            continue
        told |= names
        why = _why(difference, tool)
        is_box = difference.kind == UNDECLARED and difference.left not in (None, OF_LIBRARY)
        if not (
            is_box
            or _is_noticed(difference, noticed, around_noticed)
            or _is_final_scan(difference)
            or _is_later(difference)
        ):
            why += UNSAID
        report.items.append(Item(_outcome(difference), what, place, why))
    report.items = [item for item in report.items if not _is_superseded(item, told)]


def _is_of_refused(item: Item, refused: Iterable[str]) -> bool:
    """True for a loss that is that of the whole chart of a GRAFCET, whose hierarchy the target cannot have."""
    of_chart = item.what in _OF_PARTIAL_CHARTS and item.path in refused
    as_it_stands = item.what == "text" and "notation of GRAFCETs" in item.why
    return item.outcome in LOSSES and (
        of_chart or (as_it_stands and any(item.path.startswith(f"{path} / ") for path in refused))
    )


_OF_PARTIAL_CHARTS = ("partial charts", "chart partial charts", "chart")


def report_errors(report: ConversionReport, found: Iterable[Diagnostic], tool: str, called: Mapping[str, str]) -> None:
    """Add the errors that reading the written file has `found`, where no loss at the same place tells them already."""
    lost = [ObjectPath.of(item.path) for item in report.items if item.outcome in LOSSES]
    for error in found:
        place = ObjectPath.of(in_the_source(error.location.path or "", called))
        is_told = any(path[: len(place.parts)] == place.parts for path in (each.parts for each in lost))
        # readers name a block as its tool does: FB Main
        is_told |= len(place.parts) == 1 and any(_name_of(path.owner) == _name_of(place) for path in lost)
        if not is_told:
            why = f"the written file has an error for {tool}: {error.message} ({error.code})"
            report.add(Outcome.NOT_EXECUTED, "error", place, why)


def _name_of(path: str) -> str:
    return path.partition(" ")[2]


_WRITTEN_OTHERWISE = ("condition", "interlock", "supervision", "code")
"""Aspects in whose place writers put an undeclared name."""
_IN_PLACE = re.compile(r"undeclared name (\w+)")
"""Form in which writers tell the name that they put in place of what the target cannot say."""
_STAND_IN = re.compile(r"NOT_(?:EXECUTED|TRANSLATED)_")
"""Beginning of such names: the loss in the same POU tells it, even where its words do not have the name."""
_LACKED = re.compile(
    r"(?:has no (?:counterpart of|function block|function|type) |declares `)([\w.]+)|(\w+) is no standard function"
)
"""Form in which they tell the name of a function or a type that the target lacks."""


def _rewritten_steps(differences: Iterable[ExecutionDifference], settled: Counter[tuple[str, str]]) -> set[str]:
    """The steps whose actions a writer has rewritten: it accounts for each of them that is not found again."""
    missing: dict[str, set[str]] = {}
    found = list(differences)
    changed = {(difference.path, difference.aspect) for difference in found}
    for difference in found:
        if difference.kind == "action" and _is_at_other_times(difference, changed):
            continue
        if difference.kind == "action" and difference.left is not None and len(difference.steps) == 1:
            missing.setdefault(difference.steps[0], set()).add(difference.path)
    told: Counter[str] = Counter()
    for (path, what), count in settled.items():
        if what in _ACTIONS:
            told[_step_of(path)] += count
    return {step for step, count in told.items() if count >= len(missing.get(step, ()))}


def _step_of(path: str) -> str:
    """The step that something belongs to; the path itself where it is in no step."""
    found = (each for each in reversed([*ObjectPath.of(path).outwards()]) if each.last.startswith("step "))
    return next(found, ObjectPath.of(path))


_ACTIONS = ("action", "action association", "entry action", "main action", "exit action")


def _is_rewritten(
    difference: ExecutionDifference,
    rewritten: set[str],
    settled: Counter[tuple[str, str]],
    changed: set[tuple[str, str]],
) -> bool:
    """True if a writer accounts for it: actions as statements, supervisions and times in the conditions behind them.

    `changed` are the aspects that differ, by the paths of their parts.
    """
    if _is_at_other_times(difference, changed):
        return False
    if difference.kind == "action" or difference.aspect == "interlock":
        return bool(difference.steps) and set(difference.steps) <= rewritten
    if difference.aspect == "condition" and difference.is_stronger:
        return any(settled[step, what] for step in difference.steps for what in ("supervision", "min time"))
    if difference.aspect == "type":
        owner = ObjectPath.of(difference.path).owner
        return any(what == "length of a string" and ObjectPath.of(path).owner == owner for path, what in settled)
    if difference.aspect in ("initial value", "start values", "retain"):
        return False
    if difference.kind in _OF_THE_PROJECT - _OF_THE_CONFIGURATION:
        name = difference.name.rpartition(".")[2]
        return any(path.replace(".", " ").split(" ")[-1] == name for path, _ in settled)
    if difference.aspect == "acknowledge errors required":
        return any(what == "supervision" and path.startswith(difference.path) for path, what in settled)
    if difference.kind in ("step", "transition") and difference.left is None:  # it stays, but does nothing
        chart = ObjectPath.of(difference.path).around
        return any(what == "exclude" and path.startswith(chart) for path, what in settled)
    return False


def _is_at_other_times(difference: ExecutionDifference, changed: set[tuple[str, str]]) -> bool:
    """True if an action is there, and executed at other times."""
    return difference.aspect in ("trigger", "final scan") and (difference.path, "code") not in changed


def _is_superseded(item: Item, told: set[tuple[str, str]]) -> bool:
    """True for extension data of which it is said now that the target does not execute it."""
    if item.outcome is not Outcome.EXTENSION_DATA:
        return False
    return any(what == item.what and ObjectPath.of(path).is_in(item.path) for path, what in told)


_ALSO_CALLED = {
    "step": ("exclude",),
    "transition": ("exclude",),
    "kind": ("program",),
    "trigger": ("event", "qualifier"),
    "permanent instruction before the sequence": ("chart permanent pre", "permanent pre"),
    "permanent instruction after the sequence": ("chart permanent post", "permanent post"),
    "variable": ("section",),
    "type": ("data type", "length of a string"),
    "action of the POU": ("body",),
    "initial value": ("data type", "initial"),
    "max time": ("maximum time",),
    "min time": ("minimum time",),
    "code": ("body", "network", "IL body"),
    "drawn logic": ("logic",),
    "extends": ("type",),
    "union": ("type",),
    "macro-step": ("macro",),
}
"""Other names that writers have for an aspect or a part."""


def _without_repetition(differences: Iterable[ExecutionDifference], said: set[str]) -> Iterator[ExecutionDifference]:
    """The differences, but of the interlock of a step only the actions that run without it, and lists as a whole.

    `said`: the global variables of which a writer says already that they are lost.
    """
    found = list(differences)
    without = {ObjectPath.of(d.path).around for d in found if d.kind == "action" and d.aspect == "interlock"}
    lists: dict[str, list[str]] = {}
    # an operating input that a chart has no longer may be obeyed all the same: code that writes it needs a variable
    missing = {_last(d.name) for d in found if d.right is None and not d.aspect and d.kind not in OPERATING_KINDS}
    missing |= {d.name.partition(".")[0].casefold() for d in found if d.kind == "global variable"}
    for difference in found:
        if difference.kind == UNDECLARED and difference.name.casefold() in missing:
            continue
        if difference.aspect == "interlock" and difference.path in without:
            continue
        if difference.kind == "global variable" and not difference.aspect and "." in difference.name:
            around, _, name = difference.name.partition(".")
            if name.casefold() in said:
                continue
            lists.setdefault(around, []).append(name)
            continue
        yield difference
    for around, names in lists.items():
        shown = ", ".join(names[:_LISTED]) + (f" and {len(names) - _LISTED} more" if len(names) > _LISTED else "")
        yield ExecutionDifference(f"global variables {around}", "global variables", around, "", shown, None)


def _last(name: str) -> str:
    return name.rpartition(".")[2].casefold()


def _bare(path: str) -> str:
    """The path of an action without what not all writers say of it: its kind, and the signs of S7."""
    parts = ObjectPath.of(path).parts
    bare = (*parts[:1], *(part.removeprefix("action ") for part in parts[1:]))
    return ObjectPath(*(part.replace("#", "").replace('"', "") for part in bare))


def _a(noun: str) -> str:
    return f"an {noun}" if noun[:1] in "aeiou" else f"a {noun}"


def in_the_source(path: str, called: Mapping[str, str]) -> str:
    """The path of something in the source: names may be others in the target."""
    whole = ObjectPath.of(path)
    for around in whole.outwards():
        if around in called:
            return ObjectPath(*ObjectPath.of(called[around]).parts, *whole.inside(around).parts)
    return path


def _is_noticed(difference: ExecutionDifference, noticed: set[str], around_noticed: set[ObjectPath]) -> bool:
    """True if a writer said something of the part, of something in it, or of what it is in."""
    path = ObjectPath.of(difference.path)
    if (
        difference.kind in _OF_THE_PROJECT | _KEPT_AS_TEXT
        or (difference.kind == UNDECLARED and difference.right == "")
        or difference.aspect in _LEFT_TO_THE_READER
        or difference.aspect.startswith(STORED)
        or path in around_noticed
        or (difference.aspect == "condition" and difference.left == UNREAD_CONDITION)  # the reader kept it as it is
    ):
        return True
    return any(around in noticed for around in path.outwards())


_LEFT_TO_THE_READER = frozenset(
    {"address", "static", "arguments", "edge", "extends", "implements", "union", "drawn logic", "order of transitions"}
    | {"section", "max time"}
)
"""Aspects of which no writer speaks: what the target does not say is found when it is read back."""

_OF_THE_CONFIGURATION = frozenset({"task", "program instance", "VAR_CONFIG", PROGRAM_CALL})
_OF_THE_PROJECT = frozenset({"global variable", "global variables", "type"}) | _OF_THE_CONFIGURATION
"""Kinds of parts of which writers speak as a whole: "data blocks", "configurations"."""
_KEPT_AS_TEXT = frozenset({"unit", "property", "data of the tool", UNDECLARED_TYPE}) | OPERATING_KINDS
"""Kinds of parts that writers keep without looking into them."""


def _outcome(difference: ExecutionDifference) -> Outcome:
    """Outcome of a difference: approximated if something is executed once more or besides, else not executed."""
    if difference.kind in (UNDECLARED, UNDECLARED_TYPE) and difference.left == "":
        return Outcome.APPROXIMATED
    if difference.kind in _OPERATED:
        return _OPERATED[difference.kind]
    if difference.aspect == "type" and (difference.left or "").startswith(f"{difference.right} ("):
        return Outcome.APPROXIMATED  # without the bounds of a subrange
    if difference.aspect.startswith(STORED):  # the rows are executed, and another one counts
        return Outcome.APPROXIMATED
    if difference.kind not in (UNDECLARED, UNDECLARED_TYPE) and (
        difference.left is None or _is_later(difference) or _is_final_scan(difference)
    ):
        return Outcome.APPROXIMATED
    return Outcome.NOT_EXECUTED


_OPERATED = {
    OPERATING_INPUT: Outcome.NOT_EXECUTED,
    UNUSED_INPUT: Outcome.APPROXIMATED,
    RESTING_INPUT: Outcome.TRANSLATED,
}


def _is_later(difference: ExecutionDifference) -> bool:
    """True for the chart of an action where one tool tests transitions and the other executes actions first."""
    return (
        difference.aspect == "code" and (difference.left or "").startswith("a chart, ") and difference.right is not None
    )


def _is_final_scan(difference: ExecutionDifference) -> bool:
    """True if tools differ in whether they execute an action once more after its step was left."""
    return difference.aspect == "final scan"


def _why(difference: ExecutionDifference, tool: str) -> str:
    left, right = _apart(difference.left, difference.right)
    short = replace(difference, left=_cut(left), right=_cut(right))
    if difference.aspect == "":
        return _whole(short, tool)
    if difference.kind == "action":
        return _action(short, tool)
    left, right, aspect = short.left, short.right, short.aspect
    template = _MISSING.get(aspect)
    if aspect.startswith("code ") and right is None:
        return f"the {aspect.removeprefix('code ')}. body of the POU, `{left}`, is NOT executed in {tool}"
    if template is not None and right is None:
        return template.format(left=left, tool=tool, name=short.name, kind=short.kind)
    if aspect == "kind" and left == "program":
        return f"the program is a {right} in {tool}, which nothing calls"
    if aspect == "address" and left == right:
        return f"{left} is another place in {tool}: one tool counts words where the other counts bytes"
    if aspect == "variables" and left == "its own":
        return f"{short.name} has no variables of its own in {tool}: a program has one set of them for all its calls"
    if aspect == "variables":
        return f"{short.name} has variables of its own in {tool}: in the source all calls of the program share them"
    if aspect.startswith(STORED):
        why = "S7-GRAPH executes the rows S and R of an operand in their order; elsewhere R counts"
        return f"{aspect.removeprefix(STORED)} is {right} in {tool} while the step is active, not {left}: {why}"
    if left is None and aspect == "max time":
        return f"exceeding the maximum time {right} sets SFCError in {tool}, and does nothing in the source"
    if left is None:
        return f"{aspect} `{right}` in {tool}, none in the source"
    if left == UNREAD_CONDITION:
        return f"the condition is in a form of its tool that is not read: {tool} does not execute it"
    if left == right:
        return f"the {aspect} does something else in {tool}: `{left}`"
    if right is None:
        return f"{aspect} has no effect in {tool}" if left in (aspect, "on") else f"{aspect} `{left}` is not in {tool}"
    return f"{aspect} is `{right}` in {tool} instead of `{left}`"


def _whole(difference: ExecutionDifference, tool: str) -> str:
    kind, name = difference.kind, difference.name
    if kind in (UNDECLARED, UNDECLARED_TYPE):
        what = "type" if kind == UNDECLARED_TYPE else "name"
        if difference.left == "":
            return f"the {what} `{name}` is declared neither in the source nor in {tool}, which does not compile it"
        if difference.left == OF_LIBRARY:
            why = "convert the file that declares it as well, or replace it if it is of a library"
            return f"the {what} `{name}` is declared neither in the source nor in {tool}: {why}"
        origin = "" if difference.left is None else f": it is {difference.left} of the library of its tool"
        return f"the {what} `{name}` is not declared in {tool}{origin}"
    if kind in OPERATING_KINDS:
        return f"{name} has no effect in {tool}{_OPERATED_BY[kind]}"
    if kind == "data of the tool":
        return f"only the tool of the source reads this: it is NOT executed in {tool}"
    if kind == "property":
        return f"property `{name}` is not declared in {tool}"
    if difference.left is None:
        return f"{tool} executes {_a(kind)} `{name}` that the source does not"
    if kind == "action":
        how = f" ({difference.left})" if difference.left else ""
        return f"{_called(name)}{how} is NOT executed in {tool}"
    if kind == PROGRAM_CALL:
        return f"`{name}` is a program: in {tool} others can neither call it nor read its variables"
    if kind == "global variables":
        return f"not declared in {tool}: {difference.left}"
    if kind == "start values":
        return f"the data block does not start with the values of its file in {tool}, some of which are not read"
    if kind in ("global variable", "variable", "type"):
        return f"{kind} `{name}` is not declared in {tool}"
    return f"{kind} `{name}` is NOT executed in {tool}" if name else f"the {kind} is NOT executed in {tool}"


_OPERATED_BY = {
    OPERATING_INPUT: "",
    UNUSED_INPUT: ", and nothing in the project operates it",
    RESTING_INPUT: ", and nobody operates it, as --at-rest says",
}


def _called(action: str) -> str:
    return "the action in place" if action == "in place" else f"action `{action}`"


def _action(difference: ExecutionDifference, tool: str) -> str:
    left, right, aspect = difference.left, difference.right, difference.aspect
    name = _called(difference.name)
    if _is_final_scan(difference):
        return f"{name} runs {'once more' if left is None else 'not once more'} in {tool} after the step is left"
    if _is_later(difference):
        return f"the chart of {name} begins a scan earlier or later in {tool}: {right}, in the source {left}"
    if aspect == "trigger" and left == right:
        return f"{name} is controlled otherwise in {tool}: it also belongs to other steps"
    if aspect == "trigger":
        return f"{name} runs as {right} in {tool}, not as {left}"
    if right is None and aspect == "value":
        return f"{name} sets its variable to TRUE in {tool} instead of `{left}`"
    if right is None and aspect == "code":
        return f"{name} has no program in {tool}"
    if right is None:
        return f"{name} runs WITHOUT its {aspect} `{left}` in {tool}"
    if left is None:
        return f"{name} has the {aspect} `{right}` in {tool}, and none in the source"
    return f"the {aspect} of {name} is `{right}` in {tool} instead of `{left}`"


_MISSING = {
    "min time": "the step may be left before its minimum time {left} in {tool}",
    "max time": "exceeding the maximum time {left} is not reported in {tool}",
    "interlock": "the interlock `{left}` has no effect in {tool}",
    "supervision": "the supervision `{left}` does NOT hold the step in {tool}",
    "condition": "the transition has no condition in {tool} instead of `{left}`",
    "initial value": "`{name}` does not start as {left} in {tool}",
    "start values": "`{name}` does not start with its own values in {tool}: {left}",
    "address": "`{name}` is not at {left} in {tool}",
    "retain": "`{name}` does not keep its value over a power failure in {tool}",
    "constant": "`{name}` is no constant in {tool}",
    SHOWN_STATE: "nothing sets these outputs in {tool}: {left}",
    PLAIN_VARIABLES: "variables of this name operate the sequence or show its state in {tool}: {left}",
    "code": "the {kind} has no program in {tool}",
    "drawn logic": "what is drawn beside the steps is NOT executed in {tool}: `{left}`",
    "extends": "the {kind} does not extend `{left}` in {tool}: nothing of that is in it",
    "implements": "the {kind} does not implement `{left}` in {tool}",
    "union": "the members of the UNION do not share their memory in {tool}",
    "negation": "the actions of the step do not act while it is NOT active in {tool}",
    "static": "each instance has a `{name}` of its own in {tool}: VAR_STAT is one for all",
    "arguments": "the program instance does not get its arguments in {tool}: {left}",
    "interval": "{name} does not run every {left} in {tool}",
    "trigger": "{name} does not start at a rising edge of {left} in {tool}",
    "kind of task": "{name} is a task of the kind {left}: there is none in {tool}",
}
"""Consequences of an aspect that is missing in the target."""


def _apart(left: str | None, right: str | None) -> tuple[str | None, str | None]:
    """Two long texts from a little before the place where they differ."""
    if left is None or right is None or len(min(left, right, key=len)) <= _SHOWN or left[:_SHOWN] != right[:_SHOWN]:
        return left, right
    same = next((at for at, (a, b) in enumerate(zip(left, right, strict=False)) if a != b), min(len(left), len(right)))
    start = max(left.rfind(" ", 0, max(same - _SHOWN // 4, 0)), 0)
    return f"..{left[start:]}", f"..{right[start:]}"


def _cut(text: str | None) -> str | None:
    if text is None:
        return None
    text = " ".join(text.split())
    return text if len(text) <= _SHOWN else text[: _SHOWN - 2] + ".."
