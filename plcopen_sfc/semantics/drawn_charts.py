"""Charts as the converter of Beremiz and OpenPLC hands them to the compiler, where a profile asks for it.

The choices of the profile about drawn logic become part of the model here: boxes before conditions become an action
that is stored from the initial step on, conditions become expressions, logic that leads nowhere is gone, and steps and
transitions are in the order of the flow. Simulation, comparison and lowering treat the result as any chart.
"""

from __future__ import annotations

from operator import is_
from typing import Any

from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.networks import NetworkStatements, kept_conditions
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.languages.words import free_name
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.conditions import Expression, NamedCondition, WiredCondition
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Action, Pou
from plcopen_sfc.model.sfc import ActionAssociation, BodyCondition, SfcBody, SfcNetwork, Step, Transition
from plcopen_sfc.model.types import DerivedType, Elementary, ElementaryType, Variable
from plcopen_sfc.model.variables import Interface, SectionKind, VariableSection
from plcopen_sfc.semantics.profile import DrawnBlocks, Profile
from plcopen_sfc.semantics.subjects import Subject

_ACTION = "Drawn_blocks"


def as_executed(subject: Subject, profile: Profile) -> Subject:
    """Return the same with charts as the profile has their drawn logic; `subject` itself where that changes nothing."""
    if profile.drawn_blocks is DrawnBlocks.WHEN_ENABLED and profile.drawn_logic and not profile.order_of_flow:
        return subject
    dialect = subject.project.dialect
    adapted = {id(pou): _pou(pou, dialect, profile) for pou in [*subject.project.pous, subject.pou]}
    if all(adapted[id(pou)] is pou for pou in [*subject.project.pous, subject.pou]):
        return subject
    project = subject.project.model_copy(update={"pous": [adapted[id(pou)] for pou in subject.project.pous]})
    return Subject(project, adapted[id(subject.pou)], subject.name)


def _pou(pou: Pou, dialect: Dialect, profile: Profile) -> Pou:
    body = pou.body
    if not isinstance(body, SfcBody):
        return pou
    chart = body.chart
    transitions, steps = list(chart.transitions), list(chart.steps)
    update: dict[str, Any] = {}
    if profile.drawn_blocks is DrawnBlocks.EVERY_SCAN and any(_is_drawn(t) for t in transitions):
        taken = [v.name for v in pou.variables()] + [action.name for action in pou.actions]
        drawn, conditions = kept_conditions(chart, dialect, transitions=pou.transitions, taken=taken)
        transitions = [_with_condition(t, conditions.get(t.id)) for t in transitions]
        initial = next((place for place, step in enumerate(steps) if step.initial), None)
        if drawn.tree.statements and initial is not None:
            name = free_name(_ACTION, {each.casefold() for each in taken})
            update["actions"] = [*pou.actions, Action(name=name, body=StBody(text=print_node(drawn.tree)))]
            steps[initial] = _storing(steps[initial], name, chart)
        update["interface"] = _interface(pou, drawn)
    if profile.order_of_flow:
        steps, transitions = in_order_of_flow(steps, transitions)
    logic = chart.logic if profile.drawn_logic else []
    unmoved = all(map(is_, [*steps, *transitions], [*chart.steps, *chart.transitions]))
    if unmoved and not update and len(logic) == len(chart.logic):
        return pou
    changed = chart.model_copy(update={"steps": steps, "transitions": transitions, "logic": logic})
    place = next(place for place, each in enumerate(pou.bodies) if each is body)
    bodies = [*pou.bodies[:place], body.model_copy(update={"chart": changed}), *pou.bodies[place + 1 :]]
    return pou.model_copy(update={**update, "bodies": bodies})


def _is_drawn(transition: Transition) -> bool:
    return isinstance(transition.condition, WiredCondition | BodyCondition | NamedCondition)


def _with_condition(transition: Transition, tree: n.Expression | None) -> Transition:
    if tree is None:
        return transition
    return transition.model_copy(update={"condition": Expression(text=print_node(tree))})


def _storing(step: Step, name: str, chart: SfcNetwork) -> Step:
    """Return the step with an association that stores the action; its id is one that nothing in the chart has."""
    used = [*chart.steps, *chart.transitions, *chart.logic, *(a for each in chart.steps for a in each.actions)]
    association = ActionAssociation(id=max(each.id for each in used) + 1, qualifier=Qualifier.S, target=name)
    return step.model_copy(update={"actions": [*step.actions, association]})


def _interface(pou: Pou, drawn: NetworkStatements) -> Interface:
    """Return the interface with what boxes give, and with instances that only the drawing names."""
    declared = {variable.name.casefold() for variable in pou.variables()}
    wanted = [(helper.name, helper.type_name or "BOOL") for helper in drawn.helpers]
    wanted += [(name, type_) for name, type_ in drawn.instances.items() if name.isidentifier()]
    variables: dict[str, Variable] = {}
    for name, type_ in wanted:
        known = Elementary.__members__.get(type_.upper())
        kind = ElementaryType(name=known) if known is not None else DerivedType(name=type_)
        if name.casefold() not in declared:
            variables.setdefault(name.casefold(), Variable(name=name, type=kind))
    interface = pou.interface if pou.interface is not None else Interface()
    section = VariableSection(kind=SectionKind.LOCAL, variables=list(variables.values()))
    return interface.model_copy(update={"sections": [*interface.sections, section]}) if variables else interface


def in_order_of_flow(steps: list[Step], transitions: list[Transition]) -> tuple[list[Step], list[Transition]]:
    """Steps and transitions as they are reached from the initial steps, one path after the other; then all others."""
    by_id = {step.id: step for step in steps}
    leaving = grouped((source, transition) for transition in transitions for source in transition.sources)
    found: dict[int, Step] = {}
    passed: dict[int, Transition] = {}
    waiting: list[Step | Transition] = [step for step in reversed(steps) if step.initial]
    while waiting:
        item = waiting.pop()
        if isinstance(item, Transition):
            if item.id not in passed:
                passed[item.id] = item
                waiting += [by_id[target] for target in reversed(item.targets) if target in by_id]
        elif item.id not in found:
            found[item.id] = item
            waiting += reversed(leaving.get(item.id, ()))
    rest = [step for step in steps if step.id not in found]
    return [*found.values(), *rest], [*passed.values(), *(t for t in transitions if t.id not in passed)]
