"""Runs of steps of a chart: entered at one step and left at one, moved into a macro-step or another chart, and back."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import count

from plcopen_sfc.languages.binding.name_scopes import with_inner_charts
from plcopen_sfc.languages.binding.name_uses import Names
from plcopen_sfc.languages.binding.text_sites import Site
from plcopen_sfc.languages.grafcet_conditions import condition_problem
from plcopen_sfc.languages.networks import wired_steps
from plcopen_sfc.languages.st import parse_condition
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.sfc import (
    Condition,
    Macro,
    PartialChart,
    PartialChartKind,
    SfcBody,
    SfcNetwork,
    Step,
    Transition,
)
from plcopen_sfc.refactor.chart_edits import refused
from plcopen_sfc.refactor.journal import Journal
from plcopen_sfc.refactor.queries import dialect_in, owners


@dataclass(frozen=True, slots=True)
class Run:
    """Steps of a chart, with the transitions between them (`inner`), and those that enter and leave them.

    `exits` are the steps that are left: one, where nothing else is allowed, or none.
    """

    steps: list[Step]
    inner: list[Transition]
    entering: list[Transition]
    leaving: list[Transition]
    first: Step
    exits: list[Step]

    @property
    def last(self) -> Step | None:
        """The step that is left."""
        return self.exits[0] if self.exits else None

    @property
    def left_inside(self) -> list[Transition]:
        """The transitions between its steps that leave the last one: they compete with those that leave the run."""
        return [each for each in self.inner if self.last is not None and self.last.id in each.sources]


def run_of(chart: SfcNetwork, steps: Sequence[Step], name: str, what: str, *, left_anywhere: bool = False) -> Run:
    """Return a run that a step called `name` can replace. Raises `ModelError`, whose message begins with `what`.

    `left_anywhere`: a run without simultaneous sequences may be left at several steps, for one of them is active.
    """
    inside = {step.id for step in steps}
    if not steps or not {*map(id, steps)}.issubset(map(id, chart.steps)):
        raise refused(what, "it needs steps of one chart")
    if any(step.initial for step in steps):
        raise refused(what, "an initial step is among them")
    if any(each.name.casefold() == name.casefold() and each.id not in inside for each in chart.steps):
        raise refused(what, "the chart has a step of this name already")
    inner, entering, leaving = [], [], []
    for each in chart.transitions:
        begins, ends = not inside.isdisjoint(each.sources), not inside.isdisjoint(each.targets)
        if begins and ends and inside.issuperset(each.sources) and inside.issuperset(each.targets):
            inner.append(each)
        elif begins and ends:
            raise refused(what, f"the transition {chart.label(each)} is partly inside")
        elif ends:
            entering.append(each)
        elif begins:
            leaving.append(each)
    entries = {i for each in entering for i in each.targets if i in inside}
    exits = {i for each in leaving for i in each.sources if i in inside}
    many = len(inside) if left_anywhere and all(len(each.targets) == 1 for each in inner) else 1
    if len(entries) != 1 or len(exits) > many:
        raise refused(what, f"the steps are entered at {len(entries)} steps and left at {len(exits)}, not at one")
    needed = wired_steps(chart)
    wired = [step for step in steps if step.id in needed]
    if wired:
        raise refused(what, f"a wire leads from {wired[0].name!r} to logic that is drawn in the chart")
    first = next(step for step in steps if step.id in entries)
    left = [step for step in steps if step.id in exits]
    return Run([step for step in chart.steps if step.id in inside], inner, entering, leaving, first, left)


def replace_run(journal: Journal, chart: SfcNetwork, run: Run, name: str) -> Step:
    """Put a new step into the place of a run."""
    inside = {step.id for step in run.steps}
    made = Step(id=chart.new_id(), name=name)
    place = min(index for index, step in enumerate(chart.steps) if step.id in inside)
    remaining = [step for step in chart.steps if step.id not in inside]
    journal.put(chart, "steps", [*remaining[:place], made, *remaining[place:]])
    inner = {id(each) for each in run.inner}
    journal.put(chart, "transitions", [each for each in chart.transitions if id(each) not in inner])
    for links, side in ((run.entering, "targets"), (run.leaving, "sources")):
        for each in links:
            journal.put(each, side, [made.id if i in inside else i for i in getattr(each, side)])
    return made


def put_back(
    journal: Journal, chart: SfcNetwork, place: Step, inner: SfcNetwork, run: Run, *, order: Sequence[Transition] = ()
) -> list[Step]:
    """Put a run, whose steps are all that is left of the chart `inner`, into the place of a step of a chart.

    `order`: the transitions of the run and those that leave it, in the order in which they compete.
    """
    numbers = count(chart.new_id())
    ids = {step.id: next(numbers) for step in run.steps}
    for step in run.steps:
        journal.put(step, "id", ids[step.id])
        for association in step.actions:
            journal.put(association, "id", next(numbers))
    for each in run.inner:
        journal.put(each, "id", next(numbers))
        journal.put(each, "sources", [ids[i] for i in each.sources if i in ids])
        journal.put(each, "targets", [ids[i] for i in each.targets if i in ids])
    for each in chart.incoming(place):
        journal.put(each, "targets", [run.first.id if i == place.id else i for i in each.targets])
    if run.last is not None:
        for each in chart.outgoing(place):
            journal.put(each, "sources", [run.last.id if i == place.id else i for i in each.sources])
    journal.put(run.first, "initial", place.initial)
    journal.put(inner, "steps", [])
    journal.put(inner, "transitions", [])
    index = next(index for index, step in enumerate(chart.steps) if step is place)
    journal.put(chart, "steps", [*chart.steps[:index], *run.steps, *chart.steps[index + 1 :]])
    moved = {id(each) for each in order}
    first = next((number for number, each in enumerate(chart.transitions) if id(each) in moved), len(chart.transitions))
    before, behind = chart.transitions[:first], [each for each in chart.transitions[first:] if id(each) not in moved]
    journal.put(chart, "transitions", [*before, *(order or run.inner), *behind])
    return run.steps


def check_free(chart: SfcNetwork, place: Step, inner: SfcNetwork, what: str) -> None:
    """Raise `ModelError` where a chart cannot take the steps of another one into the place of a step."""
    taken = {step.name.casefold() for step in chart.steps if step is not place}
    clashes = [step.name for step in inner.steps if step.name.casefold() in taken]
    if clashes:
        raise refused(what, f"the chart has a step {clashes[0]!r} already")
    if inner.logic or inner.partial_charts:
        raise refused(what, "its chart has drawn logic or partial charts")


# -- macro-steps


def move_to_macro(journal: Journal, chart: SfcNetwork, steps: Sequence[Step], name: str) -> Step:
    """Move steps into a macro-step: they are entered at one step and left at one.

    In a GRAFCET they become its expansion (IEC 60848:2013, 7.4).
    """
    what = f"the macro-step {name!r} cannot be made"
    whole = grafcet_of(chart)
    run = run_of(chart, steps, name, what)
    # A macro-step is left when its last step is active. A transition inside that leaves the same step would compete
    # with those behind the macro-step, for which no tool has an order.
    if run.left_inside:
        raise refused(what, f"the step that is left last goes on inside, too: {chart.label(run.left_inside[0])}")
    # a step without a transition behind it would be a second last step
    going_on = {source for each in run.inner for source in each.sources}
    ends_there = [s for s in run.steps if s.id not in going_on and s is not run.last]
    if run.last is not None and ends_there:
        raise refused(what, f"the step {ends_there[0].name!r} leads nowhere")
    if whole is not None and (run.last is None or run.last is run.first):
        raise refused(what, "an expansion begins with one step and ends with another")
    if whole is not None and _expansion(whole, name) is not None:
        raise refused(what, f"the GRAFCET has a partial chart {name!r} already")
    macro = replace_run(journal, chart, run, name)
    inner = SfcNetwork(steps=run.steps, transitions=run.inner)
    if whole is None:
        journal.put(run.first, "initial", True)
        macro.macro = Macro(body=SfcBody(chart=inner))
        return macro
    ends = [step.name for step in (run.first, run.last) if step is not None]
    expansion = PartialChart(
        name=name, kind=PartialChartKind.EXPANSION, chart=inner, entry_step=ends[0], exit_step=ends[-1]
    )
    journal.put(whole, "partial_charts", [*whole.partial_charts, expansion])
    macro.macro = Macro(expansion=name)
    return macro


def grafcet_of(chart: SfcNetwork) -> SfcNetwork | None:
    """Return the GRAFCET that a chart is or is a part of; None where it is none."""
    project, pou = owners(chart)
    whole = next((body.chart for body in pou.bodies if isinstance(body, SfcBody)), chart)
    return whole if Names(project).is_in_grafcet(Site(pou, charts=(whole,))) else None


def check_conditions(chart: SfcNetwork, links: Iterable[Transition]) -> None:
    """Raise `ModelError` where the condition of a transition is an expression that cannot be read."""
    for link in links:
        if isinstance(link.condition, Expression):
            check_condition(chart, f"the condition of {chart.label(link)}", link.condition)


def check_condition(chart: SfcNetwork, what: str, condition: Condition | None) -> None:
    """Raise `ModelError` where a condition of something in a chart is an expression that cannot be read."""
    if not isinstance(condition, Expression) or not condition.text.strip():
        return
    text, dialect = condition.text, dialect_in(chart)
    found = parse_condition(text, dialect).problems
    problem = found[0] if found and grafcet_of(chart) is None else found and condition_problem(text, dialect)
    if problem:
        raise refused(f"{what} cannot be {text!r}", problem.message)


def _expansion(whole: SfcNetwork, name: str | None) -> PartialChart | None:
    return next((each for each in whole.partial_charts if each.name.casefold() == (name or "").casefold()), None)


def dissolve_macro(journal: Journal, chart: SfcNetwork, macro: Step) -> list[Step]:
    """Put the steps of a macro-step into its place."""
    what = f"the macro-step {macro.name!r} cannot be dissolved"
    whole = grafcet_of(chart)
    expansion = _expansion(whole, macro.macro.expansion) if whole is not None and macro.macro is not None else None
    if expansion is not None:
        inner = expansion.chart
    elif macro.macro is not None and isinstance(macro.macro.body, SfcBody):
        inner = macro.macro.body.chart
    else:
        raise refused(what, "it has no chart of its own")
    if macro.actions:
        raise refused(what, "it has actions itself")
    check_free(chart, macro, inner, what)
    entries = inner.initial_steps or [step for step in inner.steps if not inner.incoming(step)]
    exits = [step for step in inner.steps if not inner.outgoing(step)]
    if whole is not None and expansion is not None:
        for step in (step for each in with_inner_charts(whole) for step in each.steps):
            if step is not macro and step.macro is not None and _expansion(whole, step.macro.expansion) is expansion:
                raise refused(what, f"{step.name} has the same expansion")
        entries = [step for step in inner.steps if step.name == expansion.entry_step] or entries
        exits = [step for step in inner.steps if step.name == expansion.exit_step] or exits
    if len(entries) != 1 or (len(exits) != 1 and chart.outgoing(macro)):
        raise refused(what, f"it has {len(entries)} entry steps and {len(exits)} exit steps, not one")
    run = Run(list(inner.steps), list(inner.transitions), [], [], entries[0], exits)
    steps = put_back(journal, chart, macro, inner, run)
    if whole is not None and expansion is not None:
        journal.put(whole, "partial_charts", [each for each in whole.partial_charts if each is not expansion])
    return steps
