"""Action control: in which scans an action is executed (IEC 61131-3 ed. 3, 6.7.4.6).

There is one control for each action, whatever number of steps is associated with it: every input is the OR over all
associations with that qualifier, as in the function block ACTION_CONTROL of the standard::

    q := N OR S_FF OR (L AND NOT L_TMR) OR D_TMR OR R_TRIG(P) OR SD_TMR OR DS_FF OR (SL_FF AND NOT SL_TMR)
    Q := q AND NOT R;   R also resets S_FF, SD_FF, DS_FF and SL_FF, and with them their timers

P1 and P0 are pulses at the rising and falling edge of their input, without a final scan. Times are those of the
association that is active; a timer that goes on without one keeps the last.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import reduce
from operator import or_
from typing import Any, NamedTuple

from plcopen_sfc.model import Qualifier
from plcopen_sfc.semantics.programs.runtime_types import BOOL, ELAPSED, INSTANT, Frame, ScalarType

ON = 1
"""The output Q of an action control."""
BUSY = 2
"""The control has a memory: it must be asked again although its steps may be inactive."""
PULSE = 4
"""P1 or P0: the action is executed in this scan only."""
OFF = 8
"""The Boolean variable becomes FALSE in this scan; without ON and OFF it keeps what it has (`SequentialControl`)."""

Reserve = Callable[[str, ScalarType], int]
"""Gives a private slot of a frame for a purpose and a type."""


@dataclass(slots=True)
class Association:
    """An action association, ready to run: `steps` are the bits of its step (of all steps inside a macro-step).

    `inverted`: it acts while the step is not active. `condition` must hold besides. `duration` gives nanoseconds.
    `since` are the slots with the times at which the steps became active, by their bits.
    """

    qualifier: Qualifier
    steps: int
    inverted: bool
    condition: Callable[[Frame], bool] | None
    duration: Callable[[Frame], int]
    since: int

    def acts(self, situation: int) -> bool:
        """True if its step lets it act in this situation."""
        return (situation & self.steps == 0) is self.inverted

    def is_on(self, situation: int, frame: Frame) -> bool:
        """True if it acts in this situation, and its condition holds."""
        if not self.acts(situation):
            return False
        return self.condition is None or self.condition(frame)


class SituationChange(NamedTuple):
    """Change of the situation in a scan.

    `left`: the steps that were active before and are no more, `entered`: those that became active, `seen`: all that
    were active in any situation of the scan.
    """

    left: int
    entered: int
    seen: int


Control = Callable[[Frame, int, int, SituationChange], int]
"""Decides on one action: ON, BUSY, PULSE and OFF for a scan.

It gets the time, the active steps, and how they came to be active in this scan.
"""


class Input:
    """One input of a control: the OR over the associations with its qualifier."""

    __slots__ = ("_associations", "_others", "_steps")

    def __init__(self, associations: Sequence[Association]) -> None:
        self._associations = tuple(associations)
        plain = (a.steps for a in associations if not a.inverted and a.condition is None)
        self._steps = reduce(or_, plain, 0)
        self._others = tuple(a for a in associations if a.inverted or a.condition is not None)

    def is_on(self, situation: int, frame: Frame) -> bool:
        """True if any association acts."""
        if situation & self._steps:
            return True
        return any(a.is_on(situation, frame) for a in self._others) if self._others else False

    def duration(self, situation: int, frame: Frame) -> int:
        """Return the time of the first association that acts, in nanoseconds."""
        for association in self._associations:
            if association.is_on(situation, frame):
                return association.duration(frame)
        return 0


def plain_control(associations: Sequence[Association]) -> Control:
    """Return the control of an action that is only associated with N: no memory."""
    input_ = Input(associations)
    return lambda frame, _now, situation, _change: ON if input_.is_on(situation, frame) else 0


_Part = Callable[[Frame, int, int, int, bool], int]
"""The share of one qualifier in a control: as `Control`, with the steps seen, and the input R."""


def _non_stored(input_: Input) -> _Part:
    return lambda frame, _now, situation, _seen, _reset: ON if input_.is_on(situation, frame) else 0


def _stored(input_: Input, reserve: Reserve) -> _Part:
    slot = reserve("S_FF", BOOL)

    def step(frame: Frame, _now: int, _situation: int, seen: int, reset: bool) -> int:
        v = frame.v
        # `seen`: a step that is only passed in a scan stores its action too
        v[slot] = stored = not reset and (v[slot] or input_.is_on(seen, frame))
        return ON | BUSY if stored else 0

    return step


class _Timer:
    """The TON of a control: once its time is over that stays so until it is stopped, whatever happens to the time.

    IEC leaves it to the implementer what a change of PT does meanwhile (ed. 3, 6.6.3.5.5); so do the timers that
    programs have (`plcopen_sfc.semantics.programs.block_execution.on_delay`).
    """

    __slots__ = ("_done", "_start")

    def __init__(self, reserve: Reserve, name: str) -> None:
        self._start = reserve(name, INSTANT)
        self._done = reserve(f"{name}.Q", BOOL)

    def runs(self, v: list[Any]) -> bool:
        """True if it was started and not stopped since."""
        return v[self._start] is not None or v[self._done]

    def over(self, v: list[Any], now: int, time: int) -> bool:
        """Start it if it does not run; return True if its time is over."""
        if v[self._done]:
            return True
        if v[self._start] is None:
            v[self._start] = now
        if now - v[self._start] >= time:
            v[self._start], v[self._done] = None, True
        return bool(v[self._done])

    def stop(self, v: list[Any]) -> None:
        """Its input is FALSE."""
        v[self._start], v[self._done] = None, False


def _timed(input_: Input, reserve: Reserve, name: str, early: int, late: int) -> _Part:
    """L and D: what they give before the time of the step is over, and then."""
    timer = _Timer(reserve, f"{name}_TMR")

    def step(frame: Frame, now: int, situation: int, _seen: int, _reset: bool) -> int:
        if not input_.is_on(situation, frame):
            timer.stop(frame.v)
            return 0
        return BUSY | (late if timer.over(frame.v, now, input_.duration(situation, frame)) else early)

    return step


def _pulse(input_: Input, reserve: Reserve, name: str, signal: int) -> _Part:
    """P, and with `signal` PULSE instead of ON: P1."""
    before = reserve(name, BOOL)

    def step(frame: Frame, _now: int, situation: int, seen: int, _reset: bool) -> int:
        v = frame.v
        # `seen`, not `situation`: a step that is only passed in a scan gives its pulse too
        rising = not v[before] and input_.is_on(seen, frame)
        v[before] = still = input_.is_on(situation, frame)
        return (signal if rising else 0) | (BUSY if still else 0)

    return step


def _falling_pulse(input_: Input, reserve: Reserve) -> _Part:
    before = reserve("P0_TRIG", BOOL)

    def step(frame: Frame, _now: int, situation: int, seen: int, _reset: bool) -> int:
        v = frame.v
        was_on = v[before] or input_.is_on(seen, frame)
        v[before] = still = input_.is_on(situation, frame)
        if still:
            return BUSY
        return PULSE if was_on else 0

    return step


def _stored_timed(input_: Input, reserve: Reserve, name: str, *, cancels: bool) -> _Part:
    """SD and SL: a timer that starts with the first association and goes on without it."""
    timer = _Timer(reserve, f"{name}_TMR")
    time = reserve(f"{name}_TMR.PT", ELAPSED)
    is_delay = name == "SD"

    def step(frame: Frame, now: int, _situation: int, seen: int, reset: bool) -> int:
        v = frame.v
        if input_.is_on(seen, frame):
            v[time] = input_.duration(seen, frame)
        elif not timer.runs(v):
            return 0
        over = timer.over(v, now, v[time])
        # matiec: R does not end a delay that runs, and the action is set behind the R; only what is set ends
        if reset and (cancels or (is_delay and over)):
            timer.stop(v)
            return 0
        return ON | BUSY if over is is_delay else BUSY

    return step


def _delayed_stored(input_: Input, reserve: Reserve) -> _Part:
    timer = _Timer(reserve, "DS_TMR")
    slot = reserve("DS_FF", BOOL)

    def step(frame: Frame, now: int, situation: int, _seen: int, reset: bool) -> int:
        v = frame.v
        on = input_.is_on(situation, frame)
        done = on and timer.over(v, now, input_.duration(situation, frame))
        if not on:
            timer.stop(v)
        v[slot] = stored = not reset and (v[slot] or done)
        return (ON | BUSY if stored else 0) | (BUSY if on else 0)

    return step


def standard_control(associations: Sequence[Association], reserve: Reserve, *, cancels: bool) -> Control:
    """Return the ACTION_CONTROL of IEC 61131-3."""
    makers: tuple[tuple[Callable[[Input], _Part], tuple[Qualifier, ...]], ...] = (
        (_non_stored, (Qualifier.N, Qualifier.NONE)),
        (lambda of: _stored(of, reserve), (Qualifier.S,)),
        (lambda of: _timed(of, reserve, "L", ON, 0), (Qualifier.L,)),
        (lambda of: _timed(of, reserve, "D", 0, ON), (Qualifier.D,)),
        (lambda of: _pulse(of, reserve, "P_TRIG", ON), (Qualifier.P,)),
        (lambda of: _stored_timed(of, reserve, "SD", cancels=cancels), (Qualifier.SD,)),
        (lambda of: _delayed_stored(of, reserve), (Qualifier.DS,)),
        (lambda of: _stored_timed(of, reserve, "SL", cancels=cancels), (Qualifier.SL,)),
        (lambda of: _pulse(of, reserve, "P1_TRIG", PULSE), (Qualifier.P1,)),
        (lambda of: _falling_pulse(of, reserve), (Qualifier.P0,)),
    )
    found = [([a for a in associations if a.qualifier in qualifiers], make) for make, qualifiers in makers]
    parts = tuple(make(Input(own)) for own, make in found if own)
    resets = [a for a in associations if a.qualifier in (Qualifier.R, Qualifier.R0)]
    resetting = Input(resets) if resets else None

    def step(frame: Frame, now: int, situation: int, change: SituationChange) -> int:
        reset = resetting is not None and resetting.is_on(change.seen, frame)
        bits = 0
        for part in parts:
            bits |= part(frame, now, situation, change.seen, reset)
        return bits & BUSY if reset else bits

    return step


def continuous_control(associations: Sequence[Association]) -> Control:
    """Return the control of a continuous action of GRAFCET: each association has a delay of its own, any is enough.

    Delays are measured by the time of the step (IEC 60848:2013, 4.8.2).
    """

    def step(frame: Frame, now: int, situation: int, _change: SituationChange) -> int:
        for association in associations:
            if association.is_on(situation, frame):
                if association.qualifier is Qualifier.N:
                    return ON
                if _is_late(association, frame, now) is (association.qualifier is Qualifier.D):
                    return ON
        return 0

    return step


class SequentialControl:
    """The control of matiec: the associations act one after the other, and the last one that decides counts.

    N decides while its step is active and in the scan in which that is left, D from its time on and at the end, L as
    N does, P, P1 and P0 in every scan. What is stored comes on top of that for an action with a body. A Boolean
    variable (`holds`) is written where an association decides, by S and R while their step is active and at the end of
    the times of SD, DS and SL; in all other scans it keeps what it has.
    """

    __slots__ = ("_associations", "_reset_start", "_reset_time", "_set_start", "_set_time", "_stored", "holds")

    def __init__(self, associations: Sequence[Association], reserve: Reserve) -> None:
        self._associations = tuple(associations)
        self.holds = False
        self._stored = reserve("stored", BOOL)
        self._set_start = reserve("set_remaining_time", INSTANT)
        self._set_time = reserve("set_remaining_time.PT", ELAPSED)
        self._reset_start = reserve("reset_remaining_time", INSTANT)
        self._reset_time = reserve("reset_remaining_time.PT", ELAPSED)

    def __call__(self, frame: Frame, now: int, situation: int, change: SituationChange) -> int:
        """See `Control`."""
        v = frame.v
        set_ = _is_over(v, self._set_start, self._set_time, now)
        reset = _is_over(v, self._reset_start, self._reset_time, now)
        # None: no association decides. Only one that acts or has just ended does; else those of all inactive steps
        # would switch off what another one holds. Of several the last decides.
        state: bool | None = None
        before = situation & ~change.entered | change.left
        for association in self._associations:
            acts, acted = association.acts(situation), association.acts(before)
            active = acts and association.is_on(situation, frame)
            begins, ends = active and not acted, acted and not acts
            match association.qualifier:
                case Qualifier.N | Qualifier.NONE if acts or ends:
                    state = active
                case Qualifier.L if acts or ends:
                    state = active and not _is_late(association, frame, now)
                case Qualifier.D if ends or (acts and (not active or _is_late(association, frame, now))):
                    state = active
                case Qualifier.P | Qualifier.P1:
                    state = begins
                case Qualifier.P0:
                    state = ends
                case Qualifier.S:
                    set_ = set_ or active
                case Qualifier.R | Qualifier.R0:
                    reset = reset or active
                case Qualifier.SD | Qualifier.DS if begins:
                    _start(v, self._set_start, self._set_time, now, association.duration(frame))
                # DS needs its step until the delay is over, SD does not (IEC 61131-3 ed. 3, table 59)
                case Qualifier.DS if ends:
                    v[self._set_start] = None
                case Qualifier.SL if begins:
                    set_ = True
                    _start(v, self._reset_start, self._reset_time, now, association.duration(frame))
        if set_:
            v[self._set_start] = None
        if reset:
            v[self._reset_start] = None
        busy = BUSY if v[self._set_start] is not None or v[self._reset_start] is not None else 0
        if self.holds:
            if reset or (not set_ and state is False):
                return OFF | busy
            return ON | busy if set_ or state else busy
        v[self._stored] = stored = not reset and (set_ or v[self._stored])
        return ON | (BUSY if stored else busy) if state or stored else busy


def _is_late(association: Association, frame: Frame, now: int) -> bool:
    return bool(now - (frame.v[association.since] or 0) >= association.duration(frame))


def _start(v: list[Any], start: int, time: int, now: int, duration: int) -> None:
    """Start a time. One of zero never ends in the code of matiec."""
    v[start], v[time] = (now, duration) if duration > 0 else (None, 0)


def _is_over(v: list[Any], start: int, time: int, now: int) -> bool:
    """True if a time ends in this scan."""
    if v[start] is None or now - v[start] < v[time]:
        return False
    v[start] = None
    return True
