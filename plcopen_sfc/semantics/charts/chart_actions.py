"""Actions of a chart: what is executed or written in a scan, and in which order."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any

from plcopen_sfc.errors import Location, SimulationError, UnknownBehaviourError
from plcopen_sfc.model import ActionAssociation, Expression, Qualifier
from plcopen_sfc.model.text import local_name
from plcopen_sfc.semantics.charts.qualifier_control import (
    OFF,
    ON,
    PULSE,
    Association,
    Control,
    Reserve,
    SequentialControl,
    SituationChange,
    continuous_control,
    plain_control,
    standard_control,
)
from plcopen_sfc.semantics.charts.step_state import ActionOrigin, Reached, Steps
from plcopen_sfc.semantics.charts.transition_firing import Plans, Run, Write, execution
from plcopen_sfc.semantics.net import Net, Owner, indexes
from plcopen_sfc.semantics.profile import ActionControl, ActionOrder, BooleanTargets, Profile, ScanOrder
from plcopen_sfc.semantics.programs.routines import Routines
from plcopen_sfc.semantics.programs.runtime_types import ELEMENTARY, INSTANT, LINT, Frame, ScalarType, default

if TYPE_CHECKING:
    from plcopen_sfc.model import Body
    from plcopen_sfc.semantics.programs.scopes import Scope

_OUT = ON | PULSE
_PULSES = (Qualifier.P, Qualifier.P1, Qualifier.P0)


@dataclass(slots=True, eq=False)
class ExecutedAction:
    """An action: a body to run or a Boolean variable to write, and the control that decides on it.

    `name` orders actions of CODESYS. `bit` is its place in the set of actions with a memory, `noted` that in what the
    chart has reached, `out` the slot of its control's last result, `memory` are all private slots with
    what they hold at the start.
    """

    name: str
    bit: int
    noted: int
    out: int
    memory: list[tuple[int, Any]]
    control: Control
    associations: list[Association]
    model: list[tuple[Owner, ActionAssociation]]
    run: Run | None = None
    write: Write | None = None


@dataclass(slots=True)
class _Draft:
    name: str
    model: list[tuple[Owner, ActionAssociation]] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class _Work:
    """Work of a scan: the actions that it must ask, and the variables of all others."""

    actions: tuple[ExecutedAction, ...]
    idle: tuple[Write, ...]


@dataclass(frozen=True, slots=True)
class _Drawn:
    """A condition that may hold blocks with a state, and the slot that has its value while controls are asked."""

    association: Association
    is_true: Callable[[Frame], bool]
    slot: int


class Actions:
    """All actions of a chart that follow the qualifiers of IEC 61131-3; those of GRAFCET that are `continuous`."""

    def __init__(
        self,
        owned: Sequence[tuple[Owner, ActionAssociation]],
        steps: Steps,
        scope: Scope,
        path: str,
        profile: Profile,
        *,
        reached: Reached,
        continuous: bool = False,
    ) -> None:
        self._steps = steps
        self._scope = scope
        self._path = path
        self._profile = profile
        self._reached = reached
        self._continuous = continuous
        self._sequential = profile.action_control is ActionControl.SEQUENTIAL and not continuous
        self._always = profile.boolean_targets is BooleanTargets.ALWAYS or continuous
        self._busy = scope.declare(f"{path}: busy actions", LINT, hidden=True)
        self._work = Plans(self._plan)
        drafts = _gather(owned) if continuous else self._in_order(_gather(owned))
        self.starts: list[int] = []
        """The slots of running timers."""
        self._drawn: list[_Drawn] = []
        self._slots: dict[int, int] = {}
        self._actions = tuple(self._action(index, draft) for index, draft in enumerate(drafts))
        self._by_step: dict[int, list[ExecutedAction]] = {}
        self._asked: list[ExecutedAction] = []
        for action in self._actions:
            for association in action.associations:
                if association.inverted or (self._sequential and association.qualifier in _PULSES):
                    self._asked.append(action)
                for index in indexes(association.steps):
                    self._by_step.setdefault(index, []).append(action)

    def _in_order(self, drafts: list[_Draft]) -> list[_Draft]:
        """Return the actions as they are executed; variables first where associations decide one after the other."""
        order = self._profile.action_order
        unit = self._scope.unit
        actions = unit.pou.actions if unit is not None else ()
        declared = {action.name.casefold(): number for number, action in enumerate(actions)}

        def place(draft: _Draft) -> tuple[bool, int, str]:
            name = local_name(draft.name).casefold()
            late = self._sequential and (not name or name in declared)
            if order is ActionOrder.ALPHABETIC:
                return late, 0, name
            return late, declared.get(name, -1) if order is ActionOrder.DECLARED else 0, ""

        return sorted(drafts, key=place)

    def _action(self, index: int, draft: _Draft) -> ExecutedAction:
        associations = [self._association(owner, model) for owner, model in draft.model]
        memory: list[tuple[int, Any]] = []

        def reserve(name: str, type_: ScalarType) -> int:
            slot = self._scope.declare(f"{self._path}: {draft.name}.{index}.{name}", type_, hidden=True)
            memory.append((slot, default(type_)))
            if type_ is INSTANT:
                self.starts.append(slot)
            return slot

        control = self._control(associations, reserve)
        out = reserve("out", ELEMENTARY["USINT"])
        for number, (association, (_, model)) in enumerate(zip(associations, draft.model, strict=True)):
            if model.condition is not None and not isinstance(model.condition, Expression):
                self._slots[id(association)] = reserve(f"condition {number}", ELEMENTARY["BOOL"])
        origins = [ActionOrigin(owner.steps, model) for owner, model in draft.model]
        noted = self._reached.action(draft.name or f"{draft.model[0][0].path}: action in place", origins)
        return ExecutedAction(draft.name, 1 << index, noted, out, memory, control, associations, draft.model)

    def _association(self, owner: Owner, model: ActionAssociation) -> Association:
        inverted = owner.step.negated is not model.negated
        condition, since = _not_yet if model.condition is not None else None, self._steps.since_of(owner)
        return Association(model.qualifier, owner.steps, inverted, condition, lambda _: 0, since)

    @property
    def step_times(self) -> set[int]:
        """The slots with starts of steps that controls depend on; others have timers of their own."""
        if not self._sequential and not self._continuous:
            return set()
        associations = [association for action in self._actions for association in action.associations]
        return {a.since for a in associations if a.qualifier in (Qualifier.D, Qualifier.L)}

    def _control(self, associations: Sequence[Association], reserve: Reserve) -> Control:
        if self._continuous:
            return continuous_control(associations)
        if self._sequential:
            return SequentialControl(associations, reserve)
        if all(a.qualifier in (Qualifier.N, Qualifier.NONE) for a in associations):
            return plain_control(associations)
        return standard_control(associations, reserve, cancels=self._profile.reset_cancels_delays)

    def translate(self) -> None:
        """Prepare bodies, targets, times and conditions. Raises `UnknownBehaviourError`."""
        for action in self._actions:
            for (owner, model), association in zip(action.model, action.associations, strict=True):
                self._translate(owner, model, association)
            model = action.model[0][1]
            where = f"{self._path} / step {action.model[0][0].path}"
            if action.name == "":
                if model.body is not None:
                    action.run = Routines(self._scope).body(model.body, where)
            elif model.target is not None and model.value is not None:
                action.run = Routines(self._scope).statements(f"{model.target} := {model.value};", where)
            elif model.target is not None:
                action.run, action.write = execution(model.target, self._scope, where)
                if isinstance(action.control, SequentialControl):
                    action.control.holds = action.write is not None

    def _translate(self, owner: Owner, model: ActionAssociation, association: Association) -> None:
        where = f"{self._path} / step {owner.path}"
        if model.condition is not None:
            condition = Routines(self._scope).condition(model.condition, where)
            if isinstance(model.condition, Expression):
                association.condition = condition
            else:
                slot = self._slots[id(association)]
                self._drawn.append(_Drawn(association, condition, slot))
                association.condition = partial(_kept, slot)
        if model.duration:
            association.duration = Routines(self._scope).expression(model.duration, where, ELEMENTARY["TIME"])
        elif model.qualifier.needs_duration:
            association.duration = missing_time(
                f"{model.target or 'an action'} has no time for {model.qualifier}", where
            )

    def act(self, frame: Frame, now: int, situation: int, change: SituationChange) -> None:
        """Ask all controls, then execute: first what has ended, then what is active.

        `situation` are the active steps, and `change` how they came to be active in this scan.
        """
        v = frame.v
        for drawn in self._drawn:  # once in each scan in which their steps act, however often controls ask
            v[drawn.slot] = drawn.association.acts(situation | change.seen) and drawn.is_true(frame)
        concerned = change.seen | change.left if self._sequential else change.seen
        work = self._work[situation, concerned, v[self._busy]]
        ended: list[ExecutedAction] = []
        active: list[ExecutedAction] = []
        resting: list[Write] = []
        busy = 0
        for action in work.actions:
            bits = action.control(frame, now, situation, change)
            before = v[action.out]
            out = v[action.out] = bits & _OUT
            if out:
                active.append(action)
                self._reached.actions |= action.noted
            elif self._sequential:
                if bits & OFF:
                    ended.append(action)
            elif self._always and action.write is not None:
                resting.append(action.write)
            elif before and (action.run is None or (self._profile.final_scan and before & ON)):
                ended.append(action)
            if bits & ~OFF:
                busy |= action.bit
        v[self._busy] = busy
        for drawn in self._drawn:
            v[drawn.slot] = False
        for write in (*work.idle, *resting):
            write(frame, False)
        for actions, is_active in ((ended, False), (active, True)):
            for action in actions:
                if action.run is not None:
                    action.run(frame)
                elif action.write is not None:
                    action.write(frame, is_active)

    def _plan(self, key: tuple[int, int, int]) -> _Work:
        situation, seen, busy = key
        found = {self._actions[index] for index in indexes(busy)}
        found.update(action for index in indexes(situation | seen) for action in self._by_step.get(index, ()))
        found.update(self._asked)
        asked = tuple(sorted(found, key=lambda action: action.bit))
        idle: tuple[Write, ...] = ()
        if self._always:
            idle = tuple(a.write for a in self._actions if a not in found and a.write is not None)
        return _Work(asked, idle)

    def end(self, frame: Frame) -> None:
        """End everything, what is stored too, without executing anything: Boolean variables become FALSE."""
        v = frame.v
        for action in self._actions:
            was_on = v[action.out]
            if was_on or v[self._busy] & action.bit:
                for slot, value in action.memory:
                    v[slot] = value
                if action.write is not None and was_on:
                    action.write(frame, False)
        v[self._busy] = 0


def _gather(owned: Sequence[tuple[Owner, ActionAssociation]]) -> list[_Draft]:
    """The actions of a chart: associations with the same target are one, every body in place is one of its own."""
    by_name: dict[str, _Draft] = {}
    found: list[_Draft] = []
    for owner, model in owned:
        if model.target is not None:
            key = f"{model.target} := {model.value}" if model.value is not None else model.target
            draft = by_name.get(key.casefold())
            if draft is None:
                draft = by_name[key.casefold()] = _Draft(model.target)
                found.append(draft)
            draft.model.append((owner, model))
        if model.body is not None:
            found.append(_Draft("", [(owner, model)]))
    return found


def _kept(slot: int, frame: Frame) -> bool:
    return bool(frame.v[slot])


def _not_yet(_: Frame) -> bool:
    raise AssertionError("a condition is asked before it is translated")


def missing_time(message: str, where: str) -> Callable[[Frame], int]:
    """Substitute for a time that the chart does not have."""

    def fail(_: Frame) -> int:
        raise SimulationError(message, location=Location(path=where), hint="Give it one, as in T#2s.")

    return fail


def check_associations(net: Net, profile: Profile, path: str) -> None:
    """Refuse what the profile does not know. Raises `UnknownBehaviourError`."""
    knows_grafcet = profile.order is ScanOrder.TRANSITIONS_FIRST and not profile.graph_parameters
    for owner, model in net.owned():
        where = Location(path=f"{path} / step {owner.path}")
        what = model.target or "a body"
        lacking = f"which the profile {profile.name} does not have"
        if model.qualifier not in profile.qualifiers:
            message = f"the profile {profile.name} does not say what the qualifier {model.qualifier} of {what} does"
        elif (model.kind is not None or model.forcing is not None) and not knows_grafcet:
            message = f"{what} is an action of GRAFCET, {lacking}"
        elif (model.event is not None or model.interlock) and not profile.graph_parameters:
            message = f"{what} depends on an event or interlock of S7-GRAPH, {lacking}"
        else:
            continue
        raise UnknownBehaviourError(message, location=where)


def check_step_actions(net: Net, profile: Profile, path: str) -> None:
    """Refuse step actions where the profile has none. Raises `UnknownBehaviourError`."""
    if profile.step_actions:
        return
    for step in net.steps:
        if any(step.step.step_actions.values()):
            raise UnknownBehaviourError(
                f"step {step.path} has entry, main or exit actions, which the profile {profile.name} does not have",
                location=Location(path=f"{path} / step {step.path}"),
            )


class StepActions:
    """Step actions of a chart, by the index of the step."""

    def __init__(self, net: Net, reached: Reached) -> None:
        self._net = net
        self._reached = reached
        self._entry, self._main, self._exit = dict[int, Run](), dict[int, Run](), dict[int, Run]()

    def translate(self, scope: Scope, path: str) -> None:
        """Prepare the bodies."""
        for index, step in enumerate(s.step for s in self._net.steps):
            where = f"{path} / step {self._net.steps[index].path}"
            for word, action in step.step_actions.items():
                if action:
                    found = {"entry": self._entry, "main": self._main, "exit": self._exit}[word]
                    label = f"{self._net.steps[index].path}: {word} action"
                    bit = self._reached.action(label, [ActionOrigin(self._net.steps[index].bit, None)])
                    found[index] = self._noted(_run(action, scope, where), bit)

    def _noted(self, run: Run, bit: int) -> Run:
        reached = self._reached

        def noted(frame: Frame) -> None:
            reached.actions |= bit
            run(frame)

        return noted

    def leave_and_enter(self, frame: Frame, left: int, entered: int) -> None:
        """Exit actions, then entry actions, both in the order of the chart."""
        for steps, actions in ((left, self._exit), (entered, self._entry)):
            for index in indexes(steps):
                if index in actions:
                    actions[index](frame)

    def of(self, situation: int) -> tuple[Run, ...]:
        """Return the main actions of the active steps."""
        return tuple(self._main[index] for index in indexes(situation) if index in self._main)


def _run(action: str | Body, scope: Scope, where: str) -> Run:
    if not isinstance(action, str):
        return Routines(scope).body(action, where)
    return scope.action(action) or Routines(scope).statements(f"{action}();", where)
