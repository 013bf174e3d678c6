"""An S7-GRAPH block, ready to run: what happens in one cycle (manual, "Processing of a sequencer").

Conditions, step change, actions: the events of the steps that were left and of those that were entered are in the same
cycle. Permanent operations are executed in every cycle, also while the sequence is off.

Actions (manual, "Actions in steps"): without an event: N, D and L are coils (TRUE while the step is active, from a time
on, up to a time), which are FALSE when it was left; S and R set and reset; a call or an assignment is executed in every
cycle. With an event: once, in the cycle of the event. A coil that several active steps drive is TRUE if one of them
wants it so.
"""

from __future__ import annotations

from collections.abc import Callable, Container
from dataclasses import dataclass
from functools import reduce
from operator import or_
from typing import TYPE_CHECKING, Any

from plcopen_sfc.errors import Location, UnknownBehaviourError
from plcopen_sfc.model import ActionAssociation, ActionEvent, Qualifier, SfcNetwork
from plcopen_sfc.model.actions import COILS, COUNTERS, NEED_EVENT, NEED_TIME, SWITCHES, TIMERS
from plcopen_sfc.model.chart_settings import GraphSettings
from plcopen_sfc.model.sfc import Condition as Stated
from plcopen_sfc.semantics.charts.chart_actions import check_associations, check_step_actions, missing_time
from plcopen_sfc.semantics.charts.graph import step_data
from plcopen_sfc.semantics.charts.graph.graph_parameters import Commands, Mode, Parameters
from plcopen_sfc.semantics.charts.graph.interlock_conditions import CheckedSteps, StepConditions, programmed
from plcopen_sfc.semantics.charts.running_chart import RunningChart
from plcopen_sfc.semantics.charts.step_state import ActionOrigin, Reached, Steps, forgetting, override, tick
from plcopen_sfc.semantics.charts.transition_firing import (
    NOTHING,
    Move,
    Plans,
    Run,
    Write,
    execution,
)
from plcopen_sfc.semantics.net import Net, NetTransition, Owner, indexes
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.programs.routines import Routines
from plcopen_sfc.semantics.programs.runtime import fail
from plcopen_sfc.semantics.programs.runtime_types import ELAPSED, ELEMENTARY, INSTANT, LINT, Frame

if TYPE_CHECKING:
    from plcopen_sfc.semantics.programs.scopes import Scope

_LAST_COUNT = 999
"""S5 counters count from 0 to 999."""

Duration = Callable[[Frame], int]


@dataclass(frozen=True, slots=True)
class Happening:
    """Changes in a cycle: steps left and active, steps by their events, and those with a satisfied interlock."""

    left: int
    active: int
    events: dict[ActionEvent, int]
    released: int


@dataclass(slots=True)
class _Timer:
    """An S5 timer: how it runs (a `Qualifier`'s place, 0: not), its start and its time; `write` sets its output."""

    mode: int
    start: int
    time: int
    write: Write | None = None


_RUNS = {Qualifier.TL: 1, Qualifier.TD: 2, Qualifier.TF: 3}


@dataclass(slots=True)
class _Row:
    """An action of a step, ready to run."""

    qualifier: Qualifier
    event: ActionEvent | None
    interlock: bool
    since: int
    key: str
    noted: int
    write: Write | None = None
    run: Run | None = None
    duration: Duration | None = None
    read: Callable[[Frame], Any] | None = None
    switched: int = 0
    timer: _Timer | None = None

    @property
    def is_coil(self) -> bool:
        return self.qualifier in COILS and self.run is None


class GraphActions:
    """The actions of a sequencer."""

    def __init__(self, steps: Steps, scope: Scope, path: str, reached: Reached) -> None:
        self._net = steps.net
        self._reached = reached
        self._scope = scope
        self._path = path
        self._rows: list[list[tuple[_Row, ActionAssociation]]] = [[] for _ in steps.net.steps]
        self._timers: dict[str, _Timer] = {}
        self.trailing = scope.declare(f"{path}: steps left before", ELEMENTARY["LINT"], hidden=True)
        for owner, model in steps.net.owned():
            self._check(owner, model)
            name = f"{owner.path}: {model.qualifier} {model.target or 'action in place'}"
            label = f"{name} at {model.event}" if model.event is not None else name
            noted = reached.action(label, [ActionOrigin(owner.steps, model)])
            key = (model.target or "").casefold()
            row = _Row(model.qualifier, model.event, model.interlock, steps.since_of(owner), key, noted)
            if model.event is ActionEvent.C:  # no event: the row acts as one with the interlock
                row.event, row.interlock = None, True
            if model.qualifier in TIMERS:
                row.timer = self._timer(row.key)
            if model.qualifier in SWITCHES:
                row.switched = self._steps_named(model.target or "", owner)
            self._rows[owner.steps.bit_length() - 1].append((row, model))

    def _check(self, owner: Owner, model: ActionAssociation) -> None:
        where = Location(path=f"{self._path} / step {owner.path}")
        if model.qualifier in NEED_EVENT and model.event in (None, ActionEvent.C):
            raise UnknownBehaviourError(f"{model.qualifier} of {model.target} needs an event", location=where)
        if model.qualifier in (Qualifier.D, Qualifier.L, Qualifier.TF) and model.event not in (None, ActionEvent.C):
            raise UnknownBehaviourError(f"{model.qualifier} of {model.target} has no event", location=where)
        if owner.step.negated or model.negated or model.condition is not None:
            raise UnknownBehaviourError(
                f"{model.target or 'an action'} is negated or has a condition, which S7-GRAPH does not know",
                location=where,
            )

    def _timer(self, name: str) -> _Timer:
        found = self._timers.get(name)
        if found is None:
            place = f"{self._path}: timer {name}"
            found = self._timers[name] = _Timer(
                self._scope.declare(f"{place}.mode", ELEMENTARY["INT"], hidden=True),
                self._scope.declare(f"{place}.start", INSTANT, hidden=True),
                self._scope.declare(f"{place}.time", ELAPSED, hidden=True),
            )
        return found

    def _steps_named(self, name: str, owner: Owner) -> int:
        bare = name.strip('"#').casefold()
        if bare == "s_all":
            return (1 << len(self._net.steps)) - 1
        for step in self._net.steps:
            if bare in (step.step.name.casefold(), f"s{step.step.number}"):
                return step.bit
        raise UnknownBehaviourError(
            f"there is no step {name}", location=Location(path=f"{self._path} / step {owner.path}")
        )

    def translate(self) -> None:
        """Prepare operands, bodies and times."""
        for index, rows in enumerate(self._rows):
            where = f"{self._path} / step {self._net.steps[index].path}"
            for row, model in rows:
                self._translate(row, model, where)

    def _translate(self, row: _Row, model: ActionAssociation, where: str) -> None:
        if model.duration:
            row.duration = Routines(self._scope).expression(model.duration, where, ELEMENTARY["TIME"])
        elif model.qualifier in NEED_TIME:
            row.duration = missing_time(f"{model.target} has no time for {model.qualifier}", where)
        if row.qualifier in SWITCHES:
            return
        if row.qualifier in COUNTERS and model.target:
            number = ELEMENTARY["INT"]
            row.read = Routines(self._scope).getter(model.target, number)
            row.write = Routines(self._scope).setter(model.target, number)
            if model.value:
                row.duration = Routines(self._scope).expression(model.value, where, number)
        elif model.body is not None:
            row.run = Routines(self._scope).body(model.body, where)
        elif model.target is not None and model.value is not None:
            row.run = Routines(self._scope).statements(f"{model.target} := {model.value};", where)
        elif model.target is not None and row.qualifier is Qualifier.CALL:
            row.run = Routines(self._scope).statements(f"{model.target}();", where)
        elif model.target is not None:
            row.run, row.write = execution(model.target, self._scope, where)
            if row.timer is not None:
                row.timer.write = row.write

    def act(self, frame: Frame, now: int, happening: Happening) -> tuple[int, int]:
        """Execute the actions of a cycle. Gives the steps that they switch on and off."""
        v = frame.v
        self._drive_coils(frame, now, v[self.trailing], happening)
        v[self.trailing] = happening.left
        on = off = 0
        # what a step does when it is left comes before what the next one does
        for index in [*indexes(happening.left & ~happening.active), *indexes(happening.active)]:
            bit = 1 << index
            for row, _ in self._rows[index]:
                if row.is_coil or (row.interlock and not bit & happening.released):
                    continue
                if row.event is None:
                    if row.timer is not None:
                        self._fall_off(frame, now, row, active=bool(bit & happening.active))
                    elif bit & happening.active:
                        self._execute(frame, now, row)
                elif bit & happening.events.get(row.event, 0):
                    self._reached.actions |= row.noted
                    if row.qualifier is Qualifier.ON:
                        on |= row.switched
                    elif row.qualifier is Qualifier.OFF:
                        # OFF S_ALL spares the step that it is in, OFF of this step alone does not
                        off |= row.switched & ~(bit if row.switched & (row.switched - 1) else 0)
                    else:
                        self._execute(frame, now, row)
        self._run_timers(frame, now)
        return on, off

    def _drive_coils(self, frame: Frame, now: int, trailing: int, happening: Happening) -> None:
        """Write the coils of the active steps and of those that were left; what S0 has set, once more a cycle later."""
        wanted: dict[str, tuple[Write, bool]] = {}
        driving = happening.left | happening.active
        for index in indexes(driving | trailing):
            bit = 1 << index
            for row, _ in self._rows[index]:
                written = bit & driving or row.event is ActionEvent.S0
                if row.is_coil and row.write is not None and written:
                    before = wanted.get(row.key, (row.write, False))[1]
                    wanted[row.key] = (row.write, before or self._is_wanted(frame, now, row, bit, happening))
        for write, value in wanted.values():
            write(frame, value)

    def _is_wanted(self, frame: Frame, now: int, row: _Row, bit: int, happening: Happening) -> bool:
        if row.interlock and not bit & happening.released:
            return False
        if row.event is not None:
            wanted = bool(bit & happening.events.get(row.event, 0))
            self._reached.actions |= row.noted * wanted
            return wanted
        if not bit & happening.active:
            return False
        if row.duration is not None:
            # D acts from its time on, L up to it
            late = now - frame.v[row.since] >= row.duration(frame)
            if late is not (row.qualifier is Qualifier.D):
                return False
        self._reached.actions |= row.noted
        return True

    def _execute(self, frame: Frame, now: int, row: _Row) -> None:
        self._reached.actions |= row.noted
        if row.run is not None:
            row.run(frame)
        elif row.timer is not None:
            v = frame.v
            v[row.timer.mode] = _RUNS.get(row.qualifier, 0)
            v[row.timer.start] = now if row.qualifier is not Qualifier.TR else None
            v[row.timer.time] = row.duration(frame) if row.duration is not None else 0
            if row.timer.write is not None:
                row.timer.write(frame, False)
        elif row.read is not None and row.write is not None:
            count = int(row.read(frame))
            match row.qualifier:
                case Qualifier.CS:
                    count = int(row.duration(frame)) if row.duration is not None else 0
                case Qualifier.CU:
                    count = min(count + 1, _LAST_COUNT)
                case Qualifier.CD:
                    count = max(count - 1, 0)
                case _:
                    count = 0
            row.write(frame, count)
        elif row.write is not None:
            row.write(frame, row.qualifier is Qualifier.S)

    def _fall_off(self, frame: Frame, now: int, row: _Row, *, active: bool) -> None:
        """TF: TRUE while the step is active, and for its time after that."""
        assert row.timer is not None  # noqa: S101  # the caller has looked
        self._reached.actions |= row.noted
        v = frame.v
        v[row.timer.mode] = _RUNS[Qualifier.TF]
        v[row.timer.start] = None if active else now
        v[row.timer.time] = row.duration(frame) if row.duration is not None else 0

    def _run_timers(self, frame: Frame, now: int) -> None:
        v = frame.v
        for timer in self._timers.values():
            if not v[timer.mode] or timer.write is None:
                continue
            over = v[timer.start] is not None and now - v[timer.start] >= v[timer.time]
            timer.write(frame, over if v[timer.mode] == _RUNS[Qualifier.TD] else not over)
            if over and v[timer.mode] != _RUNS[Qualifier.TD]:
                v[timer.mode] = 0


_EVENT_SLOTS = {
    ActionEvent.S1: step_data.S1,
    ActionEvent.S0: step_data.S0,
    ActionEvent.L1: step_data.L1,
    ActionEvent.L0: step_data.L0,
    ActionEvent.V1: step_data.V1,
    ActionEvent.V0: step_data.V0,
    ActionEvent.A1: step_data.A1,
    ActionEvent.R1: step_data.R1,
}


class GraphProgram(RunningChart):
    """A sequencer under a profile with the parameters of S7-GRAPH."""

    def __init__(self, chart: SfcNetwork, scope: Scope, path: str, profile: Profile) -> None:
        super().__init__(Net.of_sequencer(chart), chart, scope, path, profile)
        self._valid = scope.declare(f"{path}: valid transitions", LINT, hidden=True)
        self._eventful = scope.declare(f"{path}: steps with events", LINT, hidden=True)
        self._before = scope.declare(f"{path}: cycle before", INSTANT, hidden=True)
        self._display = scope.declare(f"{path}: step displayed", LINT, hidden=True)
        self._slots = self._steps.slots
        structure = scope.structure("SFC_TRANSITION", step_data.TRANSITION)
        self._transitions = [
            override(scope, t.transition.name, structure) if t.transition.name else None for t in self.net.transitions
        ]
        settings = chart.graph_settings or GraphSettings()
        self._skips = bool(settings.skip_steps)
        self._parameters = Parameters(scope, path, locked=bool(settings.lock_operating_mode))
        self._conditions = StepConditions(
            self.net, self._slots, acknowledged=bool(settings.acknowledge_errors_required)
        )
        self._plans = Plans(self._moves_in)
        self._timed = Plans(self._steps.timed)
        self._pre: tuple[Run, ...] = ()
        self._post: tuple[Run, ...] = ()
        self._actions: GraphActions | None = None
        try:
            if self.net.macros or self.net.hierarchy:
                raise UnknownBehaviourError("S7-GRAPH has no macro-steps, enclosing steps and forcing orders")
            check_associations(self.net, profile, path)
            check_step_actions(self.net, profile, path)
            self._actions = GraphActions(self._steps, scope, path, self.reached)
        except UnknownBehaviourError as error:
            self._refused = error

    @property
    def is_divisible(self) -> bool:
        """See `RunningChart`."""
        return self._refused is None and not self._chart.logic

    def forgetting(
        self, anywhere: Container[str], read: Container[str], names: Container[str]
    ) -> Callable[[Frame, int], None]:
        """See `RunningChart`."""
        # conditions are also evaluated for steps that are not active yet
        ahead = self._skips or any(a.qualifier in SWITCHES for s in self.net.steps for a in s.step.actions)
        used = {self._steps.since[s.index] for s in self.net.steps if any(a.duration for a in s.step.actions)}
        times = forgetting(self._steps, read if ahead else anywhere, read, used)
        rows = self.net.owned()
        # each cycle clears the events of the last one before anything but permanent operations and other texts
        # sees them, and the coils of S0 alone look back at the steps that were left before
        shown = [step_data.EVENT_NAMES, step_data.TRANSITION, (step.step.name.casefold() for step in self.net.steps)]
        sees_events, sees_transitions, sees_steps = (any(name.casefold() in names for name in each) for each in shown)
        sees_undisturbed = "u" in names
        looks_back = any(row.event is ActionEvent.S0 for _, row in rows)
        # that an interlock was not satisfied in the cycle before makes its events, and nothing else
        told = (ActionEvent.L1, ActionEvent.L0)
        watched = reduce(or_, (owner.steps for owner, row in rows if row.event in told), 0)
        unwatched = [self._slots[s.index] for s in self.net.steps if not watched & s.bit and not sees_events]

        def forget(frame: Frame, now: int) -> None:
            times(frame, now)
            if sees_steps:
                return
            v = frame.v
            if not sees_events:
                self._clear_events(frame)
                v[self._eventful] = 0
            if not sees_transitions:
                self._show_transitions(frame, (), {}, 0)
            if not looks_back and self._actions is not None:
                v[self._actions.trailing] = 0
            for slot in unwatched:
                v[slot].v[step_data.LA] = v[slot].v[step_data.LS] = False
            if not sees_undisturbed:
                for slot in self._slots:
                    v[slot].v[step_data.U] = 0

        return forget

    # -- preparing

    def translate(self) -> None:
        """Prepare conditions and bodies. Anything unknown to the profile is an error of the first scan."""
        if self._refused is not None or self._actions is None:
            return
        # drawn operations first: they tell the types of instances that others only name
        self._pre = self._bodies([(p.body, "before") for p in self._chart.permanent_pre])
        if self._chart.logic:
            self._pre += (Routines(self._scope).chart_logic(self._chart, self.path),)
        self._post = self._bodies([(p.body, "after") for p in self._chart.permanent_post])
        self._actions.translate()
        self._parameters.translate()
        self._conditions.translate(self._scope, self.path)
        self._moves = tuple(self._move(each, lambda _: _satisfied) for each in self.net.transitions)
        self._limits = tuple(
            (
                self._slots[s.index],
                slot,
                Routines(self._scope).expression(text, f"{self.path} / step {s.path}", ELEMENTARY["TIME"]),
            )
            for s in self.net.steps
            for slot, text in ((step_data.T_MAX, s.step.max_time), (step_data.T_WARN, s.step.warning_time))
            if text
        )

    def _stated(self, transition: NetTransition) -> Stated | None:
        return programmed(transition.transition.condition)

    def _bodies(self, bodies: list[tuple[Any, str]]) -> tuple[Run, ...]:
        return tuple(
            Routines(self._scope).body(body, f"{self.path} / permanent operations {when} the sequence")
            for body, when in bodies
            if body is not None
        )

    # -- running

    def initialise(self, frame: Frame) -> None:
        """A new instance: nothing is active before its first cycle."""
        v = frame.v
        v[self._situation] = v[self._shown] = v[self._valid] = v[self._eventful] = 0
        v[self._started] = False
        for step in self.net.steps:
            v[self._slots[step.index]].v[step_data.SNO] = step.step.number or 0
        for transition, slot in zip(self.net.transitions, self._transitions, strict=True):
            if slot is not None:
                v[slot].v[step_data.TNO] = transition.transition.number or 0

    def execute(self, frame: Frame) -> None:
        """Execute one cycle."""
        if self._refused is not None:
            fail(self._refused)
        now = self._clock.now
        v = frame.v
        if not v[self._started]:
            for slot, member, limit in self._limits:
                v[slot].v[member] = limit(frame)
        for run in self._pre:
            run(frame)
        self._sequence(frame, now)
        for run in self._post:
            run(frame)

    def _sequence(self, frame: Frame, now: int) -> None:
        v = frame.v
        before = v[self._shown]
        commands = self._parameters.commands(frame)
        self._clear_events(frame)
        tick(frame, self._timed[before], now)
        checked = self._conditions.check(frame, before, acknowledge=commands.acknowledge)
        self._count_undisturbed(frame, now, before, checked.disturbed)
        situation = self._next(frame, commands, checked)
        entered = situation & ~before
        left = before & ~situation
        if situation != before:
            self._conditions.forget(frame, left)
            self._steps.change(frame, before, situation, entered, now)
            for index in indexes(entered):
                values = v[self._slots[index]].v
                values[step_data.S1], values[step_data.U] = True, 0
            for index in indexes(left):
                v[self._slots[index]].v[step_data.S0] = True
            # the first actions of a step depend on its interlock in this very cycle
            checked = checked.after(left, self._conditions.check(frame, entered, acknowledge=False))
        if commands.register:
            for index in indexes(situation):
                v[self._slots[index]].v[step_data.R1] = True
        v[self._shown] = situation
        self.reached.steps |= situation
        v[self._eventful] = situation | left
        assert self._actions is not None  # noqa: S101  # execute() has looked
        on, off = self._actions.act(
            frame, now, Happening(left, situation, self._events(frame, situation | left), checked.released)
        )
        v[self._situation] = situation & ~off | on  # steps that actions switch are shown from the next cycle on
        if self._parameters.has_outputs:
            self._report(frame, commands, situation, checked)

    def _next(self, frame: Frame, commands: Commands, checked: CheckedSteps) -> int:
        """Return the situation of this cycle."""
        v = frame.v
        situation: int = v[self._situation]
        first = not v[self._started]
        v[self._started] = True
        if commands.off:
            return 0
        if first or commands.init:
            return self.net.initial
        if commands.mode is Mode.MANUAL:
            selected = next((s.bit for s in self.net.steps if s.step.number == commands.selected), 0)
            if commands.on_step:
                situation |= selected
            if commands.off_step:
                situation &= ~selected
            self._show_transitions(frame, (), {}, 0)
            return situation
        enabled = self._plans[situation]
        satisfied = {move.bit: bool(move.condition(frame)) for move in enabled}
        free = [move for move in enabled if not move.sources & checked.held]
        switching = [move._replace(condition=_satisfied) for move in free if _switches(commands, satisfied[move.bit])]
        left, entered, bits = self._choose(frame, switching) if switching else NOTHING
        self.reached.transitions |= bits
        if self._skips and entered:
            entered = self._skip(frame, situation & ~left, entered)
        self._show_transitions(frame, enabled, satisfied, bits)
        return situation & ~left | entered

    def _skip(self, frame: Frame, situation: int, entered: int) -> int:
        """Steps whose next transition is satisfied already do not become active; no step is passed twice."""
        passed = situation
        moved = True
        while moved:
            moved = False
            for step in self.net.steps:
                bit = step.bit
                if not bit & entered or bit & passed:
                    continue
                passed |= bit
                onward = next((m for m in self._plans[bit] if m.sources == bit and m.condition(frame)), None)
                if onward is not None:
                    self.reached.transitions |= onward.bit
                    entered = entered & ~bit | onward.targets
                    moved = True
        return entered

    def _moves_in(self, situation: int) -> tuple[Move, ...]:
        return tuple(self._moves[i] for i in self.net.enabled(situation))

    def _show_transitions(
        self, frame: Frame, enabled: tuple[Move, ...], satisfied: dict[int, bool], switched: int
    ) -> None:
        v = frame.v
        for index in indexes(v[self._valid]):
            slot = self._transitions[index]
            if slot is not None:
                values = v[slot].v
                values[step_data.TV] = values[step_data.TT] = values[step_data.TS] = False
        valid = 0
        for move in enabled:
            valid |= move.bit
            slot = self._transitions[move.bit.bit_length() - 1]
            if slot is not None:
                values = v[slot].v
                values[step_data.TV], values[step_data.TT] = True, satisfied[move.bit]
                values[step_data.TS] = bool(switched & move.bit)
        v[self._valid] = valid

    def _clear_events(self, frame: Frame) -> None:
        v = frame.v
        for index in indexes(v[self._eventful]):
            values = v[self._slots[index]].v
            for slot in step_data.EVENTS:
                values[slot] = False

    def _events(self, frame: Frame, steps: int) -> dict[ActionEvent, int]:
        found: dict[ActionEvent, int] = {}
        for index in indexes(steps):
            values = frame.v[self._slots[index]].v
            for event, slot in _EVENT_SLOTS.items():
                if values[slot]:
                    found[event] = found.get(event, 0) | 1 << index
        return found

    def _count_undisturbed(self, frame: Frame, now: int, active: int, disturbed: int) -> None:
        v = frame.v
        passed = now - v[self._before] if v[self._before] is not None else 0
        v[self._before] = now
        for index in indexes(active & ~disturbed):
            v[self._slots[index]].v[step_data.U] += passed

    def _report(self, frame: Frame, commands: Commands, situation: int, checked: CheckedSteps) -> None:
        """The outputs: the step displayed is the one selected, else the first active one."""
        v = frame.v
        numbers = sorted(self.net.steps[i].step.number or 0 for i in indexes(situation))
        shown = v[self._display]
        if commands.mode is Mode.MANUAL and commands.selected != 0:
            shown = commands.selected
        elif shown not in numbers:
            shown = numbers[0] if numbers else 0
        elif commands.next or commands.previous:
            shown = numbers[(numbers.index(shown) + (1 if commands.next else -1)) % len(numbers)]
        v[self._display] = shown
        values = {
            "S_NO": shown,
            "S_MORE": len(numbers) > 1,
            "S_ACTIVE": shown in numbers,
            "ERR_FLT": checked.disturbed != 0,
        }
        self._parameters.report(frame, commands.mode, values)


def _satisfied(_: Frame) -> bool:
    """Condition of an empty network of a transition: its coil is on the power rail."""
    return True


def _switches(commands: Commands, satisfied: bool) -> bool:
    match commands.mode:
        case Mode.INCHING:
            return satisfied and commands.push
        case Mode.AUTOMATIC_OR_STEP_BY_STEP:
            return satisfied or commands.push
        case _:
            return satisfied
