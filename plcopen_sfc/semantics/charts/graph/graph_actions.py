"""Actions of S7-GRAPH steps (manual, "Actions in steps").

Without an event: N, D and L are coils (TRUE while the step is active, from a time on, up to a time), which are FALSE
when it was left; S and R set and reset; a call or an assignment is executed in every cycle. With an event: once, in the
cycle of the event. A coil that several active steps drive is TRUE if one of them wants it so.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from plcopen_sfc.errors import Location, UnknownBehaviourError
from plcopen_sfc.model import ActionAssociation, ActionEvent, Qualifier
from plcopen_sfc.semantics.charts.chart_actions import Owner, missing_time
from plcopen_sfc.semantics.charts.situation_plans import Run, Write, execution
from plcopen_sfc.semantics.charts.step_state import Origin, Reached
from plcopen_sfc.semantics.net import Net, indexes
from plcopen_sfc.semantics.programs.routines import Routines
from plcopen_sfc.semantics.programs.types import ELAPSED, ELEMENTARY, INSTANT, Frame

if TYPE_CHECKING:
    from plcopen_sfc.semantics.programs.scopes import Scope

_COILS = frozenset({Qualifier.N, Qualifier.D, Qualifier.L})
SWITCHES = frozenset({Qualifier.ON, Qualifier.OFF})
"""Qualifiers that switch steps."""
_COUNTERS = frozenset({Qualifier.CS, Qualifier.CU, Qualifier.CD, Qualifier.CR})
_TIMERS = frozenset({Qualifier.TL, Qualifier.TD, Qualifier.TR, Qualifier.TF})
_NEED_EVENT = (SWITCHES | _COUNTERS | _TIMERS) - {Qualifier.TF}
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
        return self.qualifier in _COILS and self.run is None


class GraphActions:
    """The actions of a sequencer."""

    def __init__(
        self,
        net: Net,
        owned: Sequence[tuple[Owner, ActionAssociation]],
        scope: Scope,
        path: str,
        reached: Reached,
    ) -> None:
        self._net = net
        self._reached = reached
        self._scope = scope
        self._path = path
        self._rows: list[list[tuple[_Row, ActionAssociation]]] = [[] for _ in net.steps]
        self._timers: dict[str, _Timer] = {}
        self.trailing = scope.declare(f"{path}: steps left before", ELEMENTARY["LINT"], hidden=True)
        for owner, model in owned:
            self._check(owner, model)
            name = f"{owner.path}: {model.qualifier} {model.target or 'action in place'}"
            label = f"{name} at {model.event}" if model.event is not None else name
            noted = reached.action(label, [Origin(owner.steps, model)])
            key = (model.target or "").casefold()
            row = _Row(model.qualifier, model.event, model.interlock, owner.since, key, noted)
            if model.event is ActionEvent.C:
                row.event, row.interlock = None, True
            if model.qualifier in _TIMERS:
                row.timer = self._timer(row.key)
            if model.qualifier in SWITCHES:
                row.switched = self._steps_named(model.target or "", owner)
            self._rows[owner.steps.bit_length() - 1].append((row, model))

    def _check(self, owner: Owner, model: ActionAssociation) -> None:
        where = Location(path=f"{self._path} / step {owner.path}")
        if model.qualifier in _NEED_EVENT and model.event in (None, ActionEvent.C):
            raise UnknownBehaviourError(f"{model.qualifier} of {model.target} needs an event", location=where)
        if model.qualifier in (Qualifier.D, Qualifier.L, Qualifier.TF) and model.event not in (None, ActionEvent.C):
            raise UnknownBehaviourError(f"{model.qualifier} of {model.target} has no event", location=where)
        if owner.inverted or model.negated or model.condition is not None:
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
        elif model.qualifier in (Qualifier.D, Qualifier.L, Qualifier.TL, Qualifier.TD, Qualifier.TF):
            row.duration = missing_time(f"{model.target} has no time for {model.qualifier}", where)
        if row.qualifier in SWITCHES:
            return
        if row.qualifier in _COUNTERS and model.target:
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
