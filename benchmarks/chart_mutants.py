"""Mutants of charts, by their model: steps, transitions, conditions, action associations, and bodies of actions."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

from benchmarks.code_mutants import Mutant, body_mutants, doubled_time, expression_mutants, initial_value_mutants
from plcopen_sfc import model as m
from plcopen_sfc.model import Qualifier
from plcopen_sfc.model.dialect import Dialect

__all__ = ["chart_mutants"]

Change = Callable[[m.SfcNetwork], None]
Found = tuple[str, str, Change]

_OTHER_QUALIFIER = {
    Qualifier.NONE: Qualifier.S,
    Qualifier.N: Qualifier.S,
    Qualifier.S: Qualifier.N,
    Qualifier.R: Qualifier.N,
    Qualifier.R0: Qualifier.N,
    Qualifier.P: Qualifier.N,
    Qualifier.P1: Qualifier.P0,
    Qualifier.P0: Qualifier.P1,
    Qualifier.L: Qualifier.D,
    Qualifier.D: Qualifier.L,
    Qualifier.SD: Qualifier.D,
    Qualifier.DS: Qualifier.SD,
    Qualifier.SL: Qualifier.L,
}


def chart_mutants(project: m.Project, name: str) -> Iterator[Mutant]:
    """The mutants of the chart of this name, of the bodies that its steps execute, and of its POU's initial values."""
    found = next(chart for chart in project.charts() if chart.name == name)
    chart, pou = found.chart, found.pou
    for kind, place, change in _changes(chart, project.dialect):
        yield Mutant(kind, place, project, partial(_change, name, change))
    named = {each.target.casefold() for _, each in chart.associations() if each.target}
    named |= {str(a).casefold() for s in chart.steps for a in (s.entry_action, s.main_action, s.exit_action) if a}
    for action in pou.actions:
        if action.name.casefold() in named:
            for mutant in body_mutants(project, f"{pou.name}.{action.name}"):
                yield Mutant(mutant.kind, f"action {action.name}, {mutant.place}", project, mutant.change)
    yield from initial_value_mutants(project, pou.name)


def _change(name: str, change: Change, project: m.Project) -> None:
    change(next(chart.chart for chart in project.charts() if chart.name == name))


def _changes(chart: m.SfcNetwork, dialect: Dialect) -> Iterator[Found]:
    labels = chart.labels()
    for i, transition in enumerate(chart.transitions):
        yield from _of_transition(chart, i, labels[transition.id])
        yield from _of_condition(transition, i, labels[transition.id], dialect)
    for i, step in enumerate(chart.steps):
        yield from _of_step(chart, i)
        for k in range(len(step.actions)):
            yield from _of_association(step, i, k, dialect)
    for step in chart.steps:
        leaving = chart.outgoing(step)
        if len(leaving) > 1:
            first, second = leaving[0].id, leaving[1].id
            yield "priority swapped", f"the first two that leave {step.name}", partial(_swap, first, second)


# -- transitions


def _of_transition(chart: m.SfcNetwork, i: int, label: str) -> Iterator[Found]:
    transition = chart.transitions[i]
    others = [s for s in chart.steps if s.id not in transition.targets and s.id not in transition.sources]
    if others and len(transition.targets) == 1:
        other = others[(7 * i) % len(others)]
        yield "transition rewired", f"{label}: to {other.name}", partial(_set_targets, i, [other.id])
    yield "step added", f"behind {label}", partial(_add_step, i)
    yield "transition removed", label, partial(_remove_transition, i)


def _set_targets(i: int, targets: list[int], chart: m.SfcNetwork) -> None:
    chart.transitions[i].targets = targets


def _remove_transition(i: int, chart: m.SfcNetwork) -> None:
    del chart.transitions[i]


def _add_step(i: int, chart: m.SfcNetwork) -> None:
    step = chart.add_step("AddedStep")
    added = m.Transition(id=chart.new_id(), sources=[step.id], targets=chart.transitions[i].targets)
    added.condition = m.Expression(text="TRUE")
    chart.transitions.append(added)
    chart.transitions[i].targets = [step.id]


def _swap(first: int, second: int, chart: m.SfcNetwork) -> None:
    """Have the second of two competing transitions tried before the first."""
    one, other = chart.transition(first), chart.transition(second)
    if one.priority != other.priority:
        one.priority, other.priority = other.priority, one.priority
        return
    a, b = chart.transitions.index(one), chart.transitions.index(other)
    chart.transitions[a], chart.transitions[b] = other, one


def _of_condition(transition: m.Transition, i: int, label: str, dialect: Dialect) -> Iterator[Found]:
    condition = transition.condition
    if condition is None:
        return
    yield "condition dropped", label, partial(_set_condition, i, None)
    yield "condition negated", label, partial(_negate, i)
    if isinstance(condition, m.Expression):
        if condition.text.strip().upper() != "TRUE":
            yield "condition TRUE", label, partial(_set_condition, i, m.Expression(text="TRUE"))
        for kind, place, text in expression_mutants(condition.text, dialect):
            new = m.Expression(text=text(), negated=condition.negated)
            yield kind, f"{label}: {place}", partial(_set_condition, i, new)
    else:
        yield "condition TRUE", label, partial(_set_condition, i, m.Expression(text="TRUE"))


def _set_condition(i: int, condition: Any, chart: m.SfcNetwork) -> None:
    chart.transitions[i].condition = condition


def _negate(i: int, chart: m.SfcNetwork) -> None:
    condition = chart.transitions[i].condition
    assert condition is not None
    condition.negated = not condition.negated


# -- steps


def _of_step(chart: m.SfcNetwork, i: int) -> Iterator[Found]:
    step = chart.steps[i]
    leaving, entering = chart.outgoing(step), chart.incoming(step)
    alone = len(leaving) == 1 and leaving[0].sources == [step.id]
    if alone and entering and not step.initial and step.id not in leaving[0].targets:
        yield "step bypassed", step.name, partial(_bypass, i)
    for time in ("min_time", "max_time"):
        if (longer := doubled_time(getattr(step, time) or "", Dialect.IEC)) != "":
            yield "time changed", f"{time} of {step.name}", partial(_set_of_step, i, time, longer)
    for each in ("interlock", "supervision"):
        own = getattr(step, each)
        if own is not None and own.condition is not None:
            yield f"{each} removed", step.name, partial(_set_of_step, i, each, None)
    for each in ("entry_action", "main_action", "exit_action"):
        if getattr(step, each) is not None:
            yield "action removed", f"{each} of {step.name}", partial(_set_of_step, i, each, None)


def _set_of_step(i: int, field: str, value: object, chart: m.SfcNetwork) -> None:
    setattr(chart.steps[i], field, value)


def _bypass(i: int, chart: m.SfcNetwork) -> None:
    """Lead what enters a step to where it leads."""
    step = chart.steps[i]
    targets = chart.outgoing(step)[0].targets
    for transition in chart.incoming(step):
        rest = [each for each in transition.targets if each != step.id]
        transition.targets = [*rest, *(each for each in targets if each not in rest)]


# -- associations


def _of_association(step: m.Step, i: int, k: int, dialect: Dialect) -> Iterator[Found]:
    own = step.actions[k]
    place = f"{step.name}: {own.qualifier.value} {own.target or 'body'}"
    change = partial(partial, _set_of_association, i, k)
    yield "action removed", place, partial(_remove_association, i, k)
    yield "action doubled", place, partial(_double_association, i, k)
    if (other := _OTHER_QUALIFIER.get(own.qualifier)) is not None:
        yield "qualifier changed", f"{place} as {other.value}", partial(_set_qualifier, i, k, other)
    if (longer := doubled_time(own.duration or "", dialect)) != "":
        yield "time changed", place, change("duration", longer)
    if own.event is not None:
        yield "event removed", f"{place}, {own.event.value}", change("event", None)
    if own.interlock:
        yield "interlock removed", place, change("interlock", False)
    if own.condition is not None:
        yield "condition dropped", place, change("condition", None)
    if (own.value or "").upper() in ("TRUE", "FALSE"):
        yield "assignment inverted", place, change("value", "FALSE" if (own.value or "").upper() == "TRUE" else "TRUE")
    if own.target is None and isinstance(own.body, m.StBody):
        yield "action removed", f"{place}: its text", change("body", m.StBody(text=""))


def _set_of_association(i: int, k: int, field: str, value: object, chart: m.SfcNetwork) -> None:
    setattr(chart.steps[i].actions[k], field, value)


def _set_qualifier(i: int, k: int, qualifier: Qualifier, chart: m.SfcNetwork) -> None:
    own = chart.steps[i].actions[k]
    own.qualifier = qualifier
    if qualifier.needs_duration:
        own.duration = own.duration or "T#1s"
    else:
        own.duration = None


def _remove_association(i: int, k: int, chart: m.SfcNetwork) -> None:
    del chart.steps[i].actions[k]


def _double_association(i: int, k: int, chart: m.SfcNetwork) -> None:
    own = chart.steps[i].actions[k]
    chart.steps[i].actions.insert(k, own.model_copy(deep=True, update={"id": chart.new_id()}))
