"""Charts in parts: its independent nets, every action, and every step action.

The control of an action depends on its own steps, conditions and times only, and so does what it writes. Where the
whole chart obeys flags, forcing orders or the like, it is not divided.
"""

from __future__ import annotations

from collections.abc import Iterator, Set

from plcopen_sfc.analysis.slicing.parts import NOTHING, NotDivisibleError, Part, Uses
from plcopen_sfc.analysis.slicing.programs import statements_of
from plcopen_sfc.errors import SfcError
from plcopen_sfc.languages.networks import condition_reader
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression
from plcopen_sfc.languages.st.effects import path_of
from plcopen_sfc.model.actions import ActionAssociation
from plcopen_sfc.model.body import Body, SfcBody
from plcopen_sfc.model.conditions import Condition
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.sfc import SfcNetwork, Step
from plcopen_sfc.semantics.charts.chart import ChartProgram
from plcopen_sfc.semantics.programs.instances import Instance
from plcopen_sfc.semantics.programs.types import ElementaryType, Family

__all__ = ["ChartParts"]

_STEP_ACTIONS = ("entry_action", "main_action", "exit_action")
_Place = tuple[int, str]
"""A step by its id, and which of its actions: the index of an association, or a step action."""


class ChartParts:
    """See `plcopen_sfc.analysis.slicing.parts.Parts`."""

    def __init__(self, instance: Instance) -> None:
        self._instance = instance
        self._pou = instance.unit.pou
        charts = instance.charts()
        chart = self._pou.chart
        program = charts[0][1] if len(charts) == 1 else None
        if chart is None or not isinstance(program, ChartProgram) or not program.is_divisible:
            raise NotDivisibleError("the chart acts as a whole")
        self._chart: SfcNetwork = chart
        self._uses = Uses(instance)
        self._actions = {action.name.casefold(): action.body for action in self._pou.actions}
        self.parts: list[Part] = []
        self._nets = self._find_nets()
        for steps in self._nets:
            self.parts.append(self._net(steps))
        self._places: list[_Place] = []
        for step in chart.steps:
            for place, part in self._step(step):
                self._places.append(place)
                self.parts.append(part)

    def taken(self, kept: Set[int]) -> Pou:
        """The chart with these parts only. It keeps at least one net: without any it would be none."""
        nets = {number for number in kept if number < len(self._nets)} or {0}
        ids = {step for number in nets for step in self._nets[number]}
        places = {self._places[number - len(self._nets)] for number in kept if number >= len(self._nets)}
        steps = [_taken_step(step, places) for step in self._chart.steps if step.id in ids]
        transitions = [t for t in self._chart.transitions if ids & {*t.sources, *t.targets}]
        chart = self._chart.model_copy(update={"steps": steps, "transitions": transitions, "drawing": None})
        return self._pou.model_copy(update={"bodies": [SfcBody(chart=chart)]})

    # -- nets

    def _find_nets(self) -> list[frozenset[int]]:
        """The ids of steps that transitions connect, in the order of the chart."""
        net_of = {step.id: {step.id} for step in self._chart.steps}
        for transition in self._chart.transitions:
            ends = [*transition.sources, *transition.targets]
            joined = set().union(*(net_of[each] for each in ends))
            for each in joined:
                net_of[each] = joined
        return list(dict.fromkeys(frozenset(net) for net in net_of.values()))

    def _net(self, steps: Set[int]) -> Part:
        found = NOTHING
        dialect = self._instance.controller.project.dialect
        read = condition_reader(self._chart, dialect, transitions=self._pou.transitions)
        for transition in self._chart.transitions:
            if not steps & {*transition.sources, *transition.targets}:
                continue
            if transition.condition is None:
                raise NotDivisibleError("a transition has no condition")
            condition = read(transition.condition)
            if condition.tree is None or condition.obstacles or condition.helpers:
                raise NotDivisibleError("a condition cannot be read")
            found |= self._uses.of(condition.tree) | self._uses.of_all(condition.before)
        for step in self._chart.steps:
            if step.id in steps:
                found |= Part(self._times(step.min_time, step.max_time), self._name(step))
        return found

    def _name(self, step: Step) -> frozenset[str]:
        return frozenset({step.name.casefold()})

    def _times(self, *texts: str | None) -> frozenset[str]:
        names = frozenset[str]()
        for text in texts:
            if text:
                time = self._uses.of(self._expression(text))
                if time.always or time.writes:
                    raise NotDivisibleError(f"{text} is calculated")
                names |= time.reads
        return names

    # -- actions

    def _step(self, step: Step) -> Iterator[tuple[_Place, Part]]:
        around = Part(self._name(step), frozenset())
        for index, association in enumerate(step.actions):
            if not association.exclude:
                yield (step.id, f"{index}"), around | self._association(association)
        for kind in _STEP_ACTIONS:
            action = getattr(step, kind)
            if action:
                yield (step.id, kind), around | self._body(action)

    def _association(self, association: ActionAssociation) -> Part:
        """All associations with an action read what the others do: they share a control."""
        if association.event is not None or association.interlock or association.kind is not None:
            raise NotDivisibleError("an action is one of S7-GRAPH or GRAFCET")
        if association.qualifier.needs_duration and not association.duration:
            raise NotDivisibleError("an action has no time")
        found = Part(self._times(association.duration) | self._condition(association.condition), frozenset())
        if association.body is not None:
            found |= self._body(association.body)
        if association.target is not None:
            found |= self._target(association.target, association.value)
        return found

    def _condition(self, condition: Condition | None) -> frozenset[str]:
        if condition is None:
            return frozenset()
        if condition.kind != "expression":
            raise NotDivisibleError("the condition of an action is no text")
        return self._times(condition.text)

    def _target(self, target: str, value: str | None) -> Part:
        tree = self._expression(target)
        if value is not None:
            return self._uses.of(n.Assignment(tree, self._expression(value)))
        if target.casefold() in self._actions:
            return self._body(target)
        path = path_of(tree)
        try:
            type_ = self._instance.type_of(target)
        except SfcError as error:
            raise NotDivisibleError(f"{target} is no variable") from error
        if not isinstance(type_, ElementaryType) or type_.family is not Family.BOOL:
            raise NotDivisibleError(f"{target} is no Boolean variable")
        written = self._uses.names([path])
        return Part(self._uses.of(tree).reads, written)

    def _body(self, body: str | Body) -> Part:
        """An action: of the POU by its name, or in place."""
        if isinstance(body, str):
            named = self._actions.get(body.casefold())
            if named is None:
                raise NotDivisibleError(f"{body} is no action of the POU")
            body = named
        return self._uses.of_all(statements_of(body, self._instance))

    def _expression(self, text: str) -> n.Expression:
        parsed = parse_expression(text, self._instance.controller.project.dialect)
        if parsed.problems:
            raise NotDivisibleError(f"{text} does not parse")
        return parsed.tree


def _taken_step(step: Step, places: Set[_Place]) -> Step:
    kept = {place for owner, place in places if owner == step.id}
    update: dict[str, object] = {"actions": [a for index, a in enumerate(step.actions) if f"{index}" in kept]}
    update |= {kind: None for kind in _STEP_ACTIONS if kind not in kept}
    return step.model_copy(update=update)
