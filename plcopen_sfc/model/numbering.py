"""Ids that mean nothing but the order: to compare charts of formats that have no ids of their own."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import count, zip_longest
from typing import Any

from plcopen_sfc.model.base import Model
from plcopen_sfc.model.late import models_in
from plcopen_sfc.model.network import Connection, Node
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import ActionAssociation, SfcNetwork, Step, Transition


def numbered_in_order(project: Project) -> Project:
    """Return a copy of `project` in which everything that has an id is numbered from 1 in the order of the model.

    Each chart and each network counts for itself. Drawings are left out: they are full of ids and mean nothing more
    than their chart.
    """
    copy = project.model_copy(deep=True)
    number_in_order(copy)
    return copy


def number_in_order(project: Project) -> None:
    """Number everything in `project` as `numbered_in_order` does in a copy."""
    for thing in models_in(project):
        if isinstance(thing, SfcNetwork):
            thing.drawing = None
            _number_chart(thing)
        elif (nodes := thing.__dict__.get("nodes")) is not None:
            _number_nodes(nodes)


def _numbers(ids: Iterable[int]) -> dict[int, int]:
    return {number: place for place, number in enumerate(dict.fromkeys(ids), 1)}


def _number_chart(chart: SfcNetwork) -> None:
    _renumber(chart, _numbers(thing.id for thing in _things(chart)))


def _things(chart: SfcNetwork) -> list[Step | Transition | ActionAssociation | Node]:
    associations = (association for _, association in chart.associations())
    return [*chart.steps, *chart.transitions, *associations, *chart.logic]


def take_ids(project: Project, other: Project) -> None:
    """Give the elements of charts in `project` the ids of those in `other`, and new ones to what `other` lacks.

    Steps belong together by their names, transitions by where they lead from and to, associations by their place.
    """
    charts = {chart.name: chart.chart for chart in other.charts()}
    for named in project.charts():
        _take_ids(named.chart, charts.get(named.name))


def _take_ids(chart: SfcNetwork, like: SfcNetwork | None) -> None:
    chart.drawing = None
    if like is not None:
        _renumber(chart, _ids_of(chart, like))
        partials = {partial.name.casefold(): partial.chart for partial in like.partial_charts}
        for partial in chart.partial_charts:
            _take_ids(partial.chart, partials.get(partial.name.casefold()))


def _ids_of(chart: SfcNetwork, like: SfcNetwork) -> dict[int, int]:
    ids = [thing.id for thing in like.steps] + [thing.id for thing in like.transitions]
    free = count(max([0, *ids, *(association.id for _, association in like.associations())]) + 1)
    steps = {step.name.casefold(): step for step in reversed(like.steps)}
    numbers: dict[int, int] = {}
    for step in chart.steps:
        found = steps.pop(step.name.casefold(), None)
        numbers[step.id] = found.id if found is not None else next(free)
        places = found.actions if found is not None else []
        for association, place in zip_longest(step.actions, places):
            if association is not None:
                numbers[association.id] = place.id if place is not None else next(free)
    waiting = list(like.transitions)
    for transition in chart.transitions:
        ends = [[numbers.get(each) for each in side] for side in (transition.sources, transition.targets)]
        same = next((each for each in waiting if [each.sources, each.targets] == ends), None)
        if same is not None:
            waiting.remove(same)
        numbers[transition.id] = same.id if same is not None else next(free)
    return numbers | {node.id: next(free) for node in chart.logic}


def _renumber(chart: SfcNetwork, numbers: dict[int, int]) -> None:
    for thing in _things(chart):
        thing.id = numbers[thing.id]
    for transition in chart.transitions:
        transition.sources = [numbers.get(number, 0) for number in transition.sources]
        transition.targets = [numbers.get(number, 0) for number in transition.targets]
    for sequence in chart.sequences:
        sequence.steps = [numbers.get(number, 0) for number in sequence.steps]
    wires = [wire for part in (chart.logic, [t.condition for t in chart.transitions]) for wire in wires_in(part)]
    for wire in wires:
        wire.source = numbers.get(wire.source, 0)


def _number_nodes(nodes: list[Node]) -> None:
    numbers = _numbers(node.id for node in nodes)
    for node in nodes:
        node.id = numbers[node.id]
    for wire in wires_in(nodes):
        wire.source = numbers.get(wire.source, 0)


def wires_in(thing: Any) -> list[Connection]:
    """Return the wires in nodes or conditions, but for those inside bodies, which have ids of their own."""
    if isinstance(thing, Connection):
        return [thing]
    if isinstance(thing, list):
        return [wire for item in thing for wire in wires_in(item)]
    if isinstance(thing, Model) and not hasattr(thing, "language"):
        names = (name for name in type(thing).__pydantic_fields__ if name != "body")
        return [wire for name in names for wire in wires_in(getattr(thing, name))]
    return []
