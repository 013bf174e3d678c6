"""Source and result of a conversion run against each other, under the rules of their tools."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

from plcopen_sfc.conversion.assumed_types import assumed_types, with_inputs, with_types
from plcopen_sfc.conversion.callers import report_callers
from plcopen_sfc.conversion.causes import (
    ToolRule,
    acting_first,
    concerns,
    differing_rules,
    held_inputs,
    told_apart,
    told_held_calls,
)
from plcopen_sfc.conversion.chart_runs import IN_IT, ChartRun, ComparedChart
from plcopen_sfc.conversion.compared_names import (
    executed_inputs,
    hidden_flags,
    kept_inside,
    listed_variables,
    renamed_variables,
    step_names,
)
from plcopen_sfc.conversion.executed_parts import (
    BOOLEAN_ACTIONS,
    FIRST_SCAN,
    OPERATING_KINDS,
    SELECTION,
    SHOWN_STATE,
    STABILITY,
    START,
    UNDECLARED,
    UNDECLARED_TYPE,
)
from plcopen_sfc.conversion.scan_order import chart_pairs
from plcopen_sfc.errors import ComparisonInterrupt, SfcError
from plcopen_sfc.languages.st.literals import time_literal
from plcopen_sfc.model.chart_settings import SfcFlag
from plcopen_sfc.model.project import Chart, Project
from plcopen_sfc.model.types import used_types
from plcopen_sfc.report import (
    ARITHMETIC,
    CHART_OF_ACTION,
    COUNTER,
    FALLING_EDGE,
    INPUTS_OF_ACTIONS,
    INPUTS_TOGETHER,
    ORDER_OF_ACTIONS,
    START_OF_CHART,
    ConversionReport,
    Item,
    Outcome,
)
from plcopen_sfc.semantics.profile import (
    Evolution,
    Profile,
    ScanOrder,
    default_profile,
    have_equal_rules,
    profile_as,
)
from plcopen_sfc.semantics.programs.variable_use import ALL_FREE
from plcopen_sfc.semantics.subjects import resolve

if TYPE_CHECKING:
    from plcopen_sfc.analysis.verdict import Counterexample, Verdict

_CAP, _RUNS, _MOST_RUNS, _SCANS = 2_000, 10, 100, 100
"""States of a search for a proof, and runs without one: a difference between tools shows early, or is proven away."""

_LEAST_LIMIT, _LIMIT_OF_STEP = 20.0, 0.1
"""Seconds for which charts are simulated at most if no limit is given.

Steps are entered and compared in 0.1 s each, those with a manual mode of S7-GRAPH and a handful of steps in 10 to 20.
"""

_APART = OPERATING_KINDS | {SHOWN_STATE, STABILITY, START, FIRST_SCAN, CHART_OF_ACTION, ORDER_OF_ACTIONS, FALLING_EDGE}
_APART |= {
    SELECTION,
    INPUTS_OF_ACTIONS,
    INPUTS_TOGETHER,
    START_OF_CHART,
    ARITHMETIC,
    COUNTER,
    BOOLEAN_ACTIONS,
    "retain",
    "address",
    "interval",
}
_APART |= {"max time", "maximum time"}
"""Losses beside which a run shows more: what operates a chart rests, nothing looks at addresses or times of tasks, and
the chart of a GRAFCET may have no step that is only passed or left by two transitions, and begins one scan later. A
block for the chart of an action may do the same, and actions in another order or calculations of other widths."""


def usual_limit(project: Project) -> float:
    """Return the seconds that suffice for the charts of a project, as far as their sizes tell."""
    return max(_LEAST_LIMIT, _LIMIT_OF_STEP * sum(len(place.chart.steps) for place in project.charts()))


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

    Charts in which something is not executed are left out: they differ. A call of what no file declares is the same
    unknown function on both sides. Where something is approximated, the run tells whether that changes what the chart
    does; the report names it already, so a difference is no item of its own.
    `called` gives the paths in the source of what has another name in the result, `target` the rules of the target
    where they are not those of its files. `limit` is the processor time that all of this may take, in seconds.

    Raises `ComparisonInterrupt` with the report so far.
    """
    from plcopen_sfc.analysis.equivalence import equivalent  # noqa: PLC0415  # most conversions run nothing

    profiles = default_profile(source), target or default_profile(result)
    end_of_all = time.thread_time() + limit
    losses = [item for item in report.losses if not _is_apart(item) and item.what != UNDECLARED_TYPE]
    undeclared = {item.why.split("`")[1].casefold() for item in report.losses if item.what == UNDECLARED_TYPE}
    assumed = assumed_types(source, undeclared) if undeclared else []
    undeclared -= {declaration.name.casefold() for declaration in assumed}
    pairs = list(chart_pairs(source, result, called))
    cap = round(_CAP * max(limit / usual_limit(source), 1))  # who gives more time wants a proof of more states
    asked = with_inputs(result, kept_inside(pairs, called))
    listed = listed_variables(source, result)
    running = [with_types(project, assumed) if assumed else project for project in (source, asked)]
    delays, differs = [0], False
    options = partial(equivalent, profile=profiles, free_inputs=ALL_FREE, cap=cap, runs=_RUNS, most_runs=_MOST_RUNS)
    with _told_when_interrupted(report, [there for there, _ in pairs]):
        for number, (there, here) in enumerate(pairs):
            named = {item.outcome for item in losses if concerns(item, there.report_path)}
            types = [name for variable in there.pou.variables() for name in used_types(variable.type)]
            untyped = next((name for name in types if name.casefold() in undeclared), None)
            if here is None or untyped is not None or Outcome.NOT_EXECUTED in named:
                report.compared[there.report_path] = (
                    f"not compared: {_why_not_compared(there, here, named, untyped, tool)}"
                )
                differs = True
                continue
            left = (end_of_all - time.thread_time()) / (len(pairs) - number)  # a large chart leaves time for the others
            end = time.thread_time() + left
            chart = ComparedChart(report, there, source, profiles, tool)
            compared = partial(
                chart.ask,
                options,
                resolve(running[0], there.name),
                resolve(running[1], here.name),
                step_flags=step_names(there, here, called, hidden_flags(report, there)),
                inputs=listed | renamed_variables(here.pou, called) | executed_inputs(report, there),
                scans=_SCANS,
            )
            found = chart.run_with_commands(compared, renamed_variables(here.pou, called), end)
            if found is None:
                continue
            run, by, given = found
            delays.append(run.verdict.delay.scans)
            differs |= run.as_run.different
            alike = _note_verdict(chart, run, by, losses if named else None, end)
            chart.note_more(
                *filter(None, [run.stays]),
                *given,
                *_of_its_origin(source, profiles[0]),
                *_never_entered(run.as_run),
                *alike,
            )
            if run.as_run.unknown and there.report_path not in report.untested:  # whose lines tell it already
                chart.note_more(f"unknown, taken as functions of what they are given: {', '.join(run.as_run.unknown)}")
            if any(name.casefold() == declaration.name.casefold() for name in types for declaration in assumed):
                chart.note_more("types that nothing declares have the members that are used of them")
        if not differs:  # else the charts tell that something is another one
            report_callers(
                *(report, running, called, options),
                inputs=lambda pou: listed | renamed_variables(pou, called),
                late=max(delays, key=abs),
                profiles=profiles,
                tool=tool,
                end=end_of_all,
            )


@contextmanager
def _told_when_interrupted(report: ConversionReport, charts: Iterable[Chart]) -> Iterator[None]:
    """Let an interruption end the comparison of charts with `ComparisonInterrupt`, and tell which were not compared."""
    try:
        yield
    except KeyboardInterrupt:
        for chart in charts:
            report.compared.setdefault(chart.report_path, "not compared: interrupted")
        raise ComparisonInterrupt(report) from None


def _note_verdict(
    chart: ComparedChart, run: ChartRun, compared: Callable[..., Verdict], losses: Sequence[Item] | None, end: float
) -> list[str]:
    """Put the verdict on a run into the report; return how the chart compares under other rules.

    `losses`: those among which the report names some of this chart; None where it names none of it.
    """
    from plcopen_sfc.analysis.verdict import VerdictKind  # noqa: PLC0415  # most conversions run nothing

    every = chart.report.losses
    held = [] if run.verdict.equal else _told_while_held(compared, run, every if losses is None else losses, end)
    alike = _Alike()
    if run.as_run.counterexample is not None:
        alike = _told_alike(compared, run, every, end - time.thread_time())
    if run.verdict.kind is VerdictKind.UNTESTED:
        seen, *unreached = str(run.verdict).splitlines()
        chart.note_untested("\n".join([seen, *([] if losses is None else [IN_IT])]), *unreached)
    elif losses is None:
        _report_run(chart.report, run, alike.causes_in(every), held or alike.rules)
    else:
        chart.note(*run.told_with(alike.causes_in(losses), held or alike.rules))
    return list(alike.told)


def _of_its_origin(source: Project, executed: Profile) -> list[str]:
    """Return that the source is executed as what its file was converted from, where its tool has other rules."""
    file = source.source.format if source.source is not None else ""
    if not source.is_converted or file == "json" or have_equal_rules(executed, profile_as(source, file)):
        return []
    told = f"the source is the {source.origin} from which its file was converted"
    return [f"given: {told}, and not what {file} executes of it (--as-tool)"]


def _never_entered(verdict: Verdict) -> list[str]:
    """Return the steps that no input leads to on either side, in lines; with other scans times may end otherwise."""
    from plcopen_sfc.analysis.coverage import STEP  # noqa: PLC0415  # most conversions run nothing

    if not verdict.equal:
        return []
    first = verdict.coverage[0]
    lines = replace(first, unreached=tuple(each for each in first.unreached if each.kind == STEP)).lines()
    is_timed = verdict.timed and any(line.startswith("not reached") for line in lines)
    return [*lines, *([f"given: not reached with scans of {time_literal(verdict.scan_time)}"] * is_timed)]


def _why_not_compared(
    there: Chart, here: Chart | None, named: Collection[Outcome], untyped: str | None, tool: str
) -> str:
    """Return why a chart is not run; `untyped` is a type of its variables that nothing declares."""
    if here is not None and untyped is not None:  # no run knows what its members are, or that blocks share them
        return f"nothing declares the type `{untyped}` of its variables; convert the file that does as well"
    if not named and there.chart is not there.pou.chart:
        return f"in {tool} it is no chart of an action, and its POU runs what is in its place"
    if not named:
        return f"nothing in {tool} has its name; test it there"
    return f"not all of it is executed; change that in the source, or test it in {tool}"


def _told_while_held(compared: Callable[..., Verdict], run: ChartRun, losses: Sequence[Item], end: float) -> list[str]:
    """Return how a chart that differs compares while inputs stay that tools see at other times; empty if no better."""
    example = run.verdict.counterexample
    if example is None:
        return []
    for held in held_inputs(example, run.verdict.inputs, run.chart, run.profiles, run.tool):
        left = end - time.thread_time()
        verdict = compared(delay="auto", limit=left, fixed=held.values) if left > 0 else None
        if verdict is not None:
            other = verdict.counterexample
            told = held.told(verdict, run.told(other, losses) if other is not None else [])
            if told:
                return told
    return []


class _Alike(NamedTuple):
    """How a chart that differs compares under other rules, and what that says of the causes of its difference.

    `told`: verdicts in words; `rules`: the rules that are a cause, in words; `no_causes`: subjects of items of the
    report that are none, as the same differs without them.
    """

    told: Sequence[str] = ()
    rules: Sequence[str] = ()
    no_causes: frozenset[str] = frozenset()

    def causes_in(self, losses: Sequence[Item]) -> list[Item]:
        """Return the items that may be a cause."""
        return [each for each in losses if each.what not in self.no_causes]


def _told_alike(compared: Callable[..., Verdict], run: ChartRun, losses: Sequence[Item], limit: float) -> _Alike:
    """Return how a chart that differs compares under one more rule of the target, or all, and the rules as causes.

    Nothing where it differs yet: what is left of a difference then is one of the conversion. With the search for
    stability, inputs that come together tell apart every chart of a GRAFCET whose steps they pass. What is ruled goes
    on in a second evolution when its order ends, in the target at once: there the runs are compared in which nothing
    fires behind another transition of the same scan. Charts that execute
    others have no constant delay where the tools execute actions and transitions in another order.
    """
    profiles, tool, example = run.profiles, run.tool, run.verdict.counterexample
    evolution, order = profiles[1].evolution, profiles[1].order
    end = time.thread_time() + limit

    def run_under(first: Callable[[], Profile], second: Profile = profiles[1]) -> Verdict | None:
        left = end - time.thread_time()
        try:
            return compared(profile=(first(), second), delay="auto", limit=left) if left > 0 else None
        except SfcError:  # some would contradict others: S7-GRAPH has one order
            return None

    def equal_under(rules: Callable[[], Profile]) -> Verdict | None:
        found = run_under(rules)
        return found if found is not None and found.equal else None

    if profiles[0].evolution is Evolution.UNTIL_STABLE is not evolution:
        once = run_under(lambda: replace(profiles[0], evolution=evolution))
        if once is not None and once.equal:
            words = "the source fires transitions until none can fire, and passes steps"
            cause = ToolRule(lambda: profiles[0], STABILITY, words).told(losses, run.chart)
            return _Alike([f"without its search for stability: {once.summary}"], [cause])
        if early := acting_first(profiles, tool):
            found = run_under(lambda: profiles[0], replace(profiles[1], order=profiles[0].order))
            if found is not None and found.equal:
                return _Alike([f"with actions and transitions in the order of the source: {found.summary}"], [early])
        no_causes = frozenset({STABILITY} if once is not None and _is_same(once.counterexample, example) else ())
        found = run_under(lambda: replace(profiles[0], max_evolutions=2))
        if found is None or found.counterexample is not None or not found.states:  # it passes one in its first scan
            return _Alike(no_causes=no_causes)
        return _Alike([f"where it passes no step: {found.summary}"], no_causes=no_causes)
    if example is None:
        return _Alike()
    if evolution is Evolution.UNTIL_STABLE is not profiles[0].evolution:
        once = run_under(lambda: profiles[0], replace(profiles[1], evolution=profiles[0].evolution))
        if once is not None and once.equal:
            cause = f"{tool} fires transitions until none can fire, and passes steps"
            return _Alike([f"without the search for stability of {tool}: {once.summary}"], [cause])
    if profiles[0].order is not order and (found := equal_under(lambda: replace(profiles[0], order=order))) is not None:
        line = f"with actions and transitions in the order of {tool}: {found.summary}"
        return _Alike([line], [acting_first(profiles, tool)])
    if held := told_held_calls(profiles, tool):
        one, other = (replace(each, initial_situation_held=True) for each in profiles)
        calling = run_under(lambda: one, other)
        if calling is not None and calling.equal:
            line = f"where both test no transition of a chart in the scan that calls it first: {calling.summary}"
            return _Alike([line], [held])
    if (found := equal_under(lambda: profiles[1])) is None:
        return _Alike()
    every = differing_rules(example, run.chart, profiles, tool)
    rules = [rule for rule in every if equal_under(rule.patched) is not None]
    return _Alike([f"under the rules of {tool}: {found.summary}"], [rule.told(losses, run.chart) for rule in rules])


def _is_same(one: Counterexample | None, other: Counterexample | None) -> bool:
    """True if two runs differ in the same values after as many scans."""
    if one is None or other is None:
        return one is other
    return one.differences == other.differences and len(one.inputs) == len(other.inputs)


def _report_run(report: ConversionReport, run: ChartRun, losses: Sequence[Item], rules: Sequence[str]) -> None:
    """Report the verdict on a chart of which the report names no loss; `losses` and `rules`: see `ChartRun.told`."""
    from plcopen_sfc.analysis.product import NEVER_STABLE  # noqa: PLC0415  # most conversions run nothing

    verdict, as_run, path = run.verdict, run.as_run, run.chart.report_path
    report.compared[path] = "\n".join(run.seen)
    if verdict.proven:
        usual = 1 if run.profiles[1].order is ScanOrder.ACTIONS_FIRST else 0  # a later result passed other situations
        if abs(verdict.delay.scans) <= usual and NEVER_STABLE not in verdict.notes:
            _note_proven(report, path, STABILITY, "which fires transitions once in a scan")
        for what, how in _PROVEN.items():
            _note_proven(report, path, what, how)
        if not run.profiles[1].initial_situation_held:  # of which no proof has the first scan
            _note_proven(report, path, FIRST_SCAN, "whose actions have not seen the initial step then")
    if as_run.proven:
        _note_proven(report, path, INPUTS_OF_ACTIONS, "whose actions see other inputs")
    if as_run.equal:  # every run has a first scan
        _note_proven(report, path, START_OF_CHART, "which begins otherwise")
    if verdict.counterexample is not None:
        report.add(Outcome.APPROXIMATED, "chart", path, "; ".join(run.told(verdict.counterexample, losses, rules)))
    elif not as_run.equal:
        example = as_run.counterexample
        why = "it is not known to do the same"
        if example is not None:
            why = "; ".join(run.told(example, (), told_apart(example, run.chart, run.profiles, run.tool)))
            # The first scan is in every example, but where that tells how it differs, no action has seen another input.
            report.items = [each for each in report.items if not _is_told(each, path, why)]
        if example is None or not _is_operated(example, report, path):
            report.add(Outcome.APPROXIMATED, "chart", path, why)


def _is_operated(example: Counterexample, report: ConversionReport, path: str) -> bool:
    """True if flags operate a chart in a run, and an item tells what differs where other inputs come with them."""
    flags = {flag.variable.upper() for flag in SfcFlag}
    given = {name.upper() for row in example.inputs for name, value in row.items() if value is True}
    return not flags.isdisjoint(given) and any(
        (each.what, each.path) == (INPUTS_TOGETHER, path) for each in report.items
    )


def _is_told(item: Item, path: str, why: str) -> bool:
    """True if an item tells of the start of a chart, or of what its actions see and `why` has as a cause."""
    cause, _, _ = item.why.rpartition(": ")[2].partition(", and so ")
    return item.path == path and (item.what == START_OF_CHART or (item.what == INPUTS_OF_ACTIONS and cause in why))


_PROVEN = {
    SELECTION: "which fires other transitions of a selection",
    CHART_OF_ACTION: "which calls a block for the chart of the action",
    ORDER_OF_ACTIONS: "which executes actions in another order",
    BOOLEAN_ACTIONS: "which writes variables of actions at other times",
    FALLING_EDGE: "which sees another first edge of F_TRIG",
    COUNTER: "whose counters end at other numbers",
    ARITHMETIC: "which calculates with other numbers of bits",
}
"""What the target does otherwise, which every proof covers, whatever the delay is."""


def _note_proven(report: ConversionReport, path: str, what: str, how: str) -> None:
    """Tell that the target does the same, and `how`, where the report was not sure of it."""
    for at, item in enumerate(report.items):
        if item.what == what and f"{item.path} / ".startswith(f"{path} / "):
            why = f"with all inputs the target, {how}, does the same"
            report.items[at] = replace(item, outcome=Outcome.TRANSLATED, why=why)


def _is_apart(item: Item) -> bool:
    """True for a loss beside which a run shows more.

    A name that no file declares, neither of the source nor of the target, is the same input on both sides, or the same
    unknown function.
    """
    return item.what in _APART or (item.what == UNDECLARED and " declared neither in the source nor in " in item.why)
