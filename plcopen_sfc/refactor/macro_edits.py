"""A run of steps as a macro-step, and back (TC6 `macroStep`; IEC 60848, 7)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import count

from plcopen_sfc.model.body import SfcBody
from plcopen_sfc.model.sfc import Macro, SfcNetwork, Step
from plcopen_sfc.refactor.chart_edits import refused
from plcopen_sfc.refactor.journal import Journal


def move_to_macro(journal: Journal, chart: SfcNetwork, steps: Sequence[Step], name: str) -> Step:
    """Move steps into a macro-step: they are entered at one step and left at one."""
    what = f"the macro-step {name!r} cannot be made"
    inside = {step.id for step in steps}
    if not steps or any(not any(each is step for each in chart.steps) for step in steps):
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
    if len(entries) != 1 or len(exits) > 1:
        raise refused(what, f"the steps are entered at {len(entries)} steps and left at {len(exits)}, not at one")
    entry = next(step for step in steps if step.id in entries)
    left = [each for each in inner if not exits.isdisjoint(each.sources)]
    if left:
        raise refused(what, f"the step that is left last goes on inside, too: {chart.label(left[0])}")
    ends_there = [s for s in steps if not any(s.id in each.sources for each in inner) and s.id not in exits]
    if exits and ends_there:
        raise refused(what, f"the step {ends_there[0].name!r} leads nowhere")

    macro = Step(id=chart.new_id(), name=name)
    place = min(index for index, step in enumerate(chart.steps) if step.id in inside)
    remaining = [step for step in chart.steps if step.id not in inside]
    journal.put(chart, "steps", [*remaining[:place], macro, *remaining[place:]])
    journal.put(chart, "transitions", [each for each in chart.transitions if not any(each is i for i in inner)])
    for each in entering:
        journal.put(each, "targets", [macro.id if i in inside else i for i in each.targets])
    for each in leaving:
        journal.put(each, "sources", [macro.id if i in inside else i for i in each.sources])
    journal.put(entry, "initial", True)
    macro.macro = Macro(body=SfcBody(chart=SfcNetwork(steps=list(steps), transitions=inner)))
    return macro


def dissolve_macro(journal: Journal, chart: SfcNetwork, macro: Step) -> list[Step]:
    """Put the steps of a macro-step into its place."""
    what = f"the macro-step {macro.name!r} cannot be dissolved"
    if macro.macro is None or not isinstance(macro.macro.body, SfcBody):
        raise refused(what, "it has no chart of its own")
    inner = macro.macro.body.chart
    if inner.logic or inner.partial_charts or macro.actions:
        raise refused(what, "its chart has drawn logic or partial charts, or it has actions itself")
    taken = {step.name.casefold() for step in chart.steps if step is not macro}
    clashes = [step.name for step in inner.steps if step.name.casefold() in taken]
    if clashes:
        raise refused(what, f"the chart has a step {clashes[0]!r} already")
    entries = inner.initial_steps or [step for step in inner.steps if not inner.incoming(step)]
    exits = [step for step in inner.steps if not inner.outgoing(step)]
    if len(entries) != 1 or (len(exits) != 1 and chart.outgoing(macro)):
        raise refused(what, f"it has {len(entries)} entry steps and {len(exits)} exit steps, not one")

    numbers = count(chart.new_id())
    ids = {step.id: next(numbers) for step in inner.steps}
    steps, transitions = list(inner.steps), list(inner.transitions)
    for step in steps:
        journal.put(step, "id", ids[step.id])
        for association in step.actions:
            journal.put(association, "id", next(numbers))
    for each in transitions:
        journal.put(each, "id", next(numbers))
        journal.put(each, "sources", [ids[i] for i in each.sources if i in ids])
        journal.put(each, "targets", [ids[i] for i in each.targets if i in ids])
    for each in chart.incoming(macro):
        journal.put(each, "targets", [entries[0].id if i == macro.id else i for i in each.targets])
    for each in chart.outgoing(macro):
        journal.put(each, "sources", [exits[0].id if i == macro.id else i for i in each.sources])
    journal.put(entries[0], "initial", macro.initial)
    journal.put(inner, "steps", [])
    journal.put(inner, "transitions", [])
    place = next(index for index, step in enumerate(chart.steps) if step is macro)
    journal.put(chart, "steps", [*chart.steps[:place], *steps, *chart.steps[place + 1 :]])
    journal.put(chart, "transitions", [*chart.transitions, *transitions])
    return steps
