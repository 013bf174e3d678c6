"""A chart, ready to run: what happens in one scan."""

from __future__ import annotations

from collections.abc import Callable, Container
from typing import TYPE_CHECKING

from plcopen_sfc.errors import Location, SimulationError, UnknownBehaviourError, UnstableChartError
from plcopen_sfc.model import SfcFlag, SfcNetwork
from plcopen_sfc.model.sfc import Condition as Stated
from plcopen_sfc.semantics.charts.chart_actions import (
    Actions,
    StepActions,
    check_associations,
    check_step_actions,
)
from plcopen_sfc.semantics.charts.grafcet.grafcet_program import Grafcet, has_grafcet
from plcopen_sfc.semantics.charts.graph.interlock_conditions import check_no_graph
from plcopen_sfc.semantics.charts.qualifier_control import SituationChange
from plcopen_sfc.semantics.charts.running_chart import RunningChart
from plcopen_sfc.semantics.charts.sfc_flags import FlagEffect, Flags, Tip, analysis
from plcopen_sfc.semantics.charts.step_state import forgetting, tick
from plcopen_sfc.semantics.charts.transition_firing import (
    NOTHING,
    Cleared,
    Move,
    Plan,
    Plans,
    Run,
    Watch,
    testing_order,
)
from plcopen_sfc.semantics.net import Net, NetTransition, indexes
from plcopen_sfc.semantics.profile import Evolution, Profile, ScanOrder, StepVariables
from plcopen_sfc.semantics.programs.routines import Routines
from plcopen_sfc.semantics.programs.runtime import fail
from plcopen_sfc.semantics.programs.runtime_types import BOOL, ELEMENTARY, INSTANT, Frame

if TYPE_CHECKING:
    from plcopen_sfc.semantics.programs.scopes import Scope

Condition = Callable[[Frame], bool]


class ChartProgram(RunningChart):
    """A chart of IEC 61131-3 or GRAFCET."""

    def __init__(self, chart: SfcNetwork, scope: Scope, path: str, profile: Profile) -> None:
        super().__init__(Net.of(chart), chart, scope, path, profile)
        self._profile = profile
        self._paused = scope.declare(f"{path}: paused", INSTANT, hidden=True)
        self._grafcet: Grafcet | None = None
        try:
            check_associations(self.net, profile, path)
            check_step_actions(self.net, profile, path)
            check_no_graph(self.net, profile, path)
            if has_grafcet(self.net, profile):
                self._grafcet = Grafcet(self._steps, scope, path, profile, reached=self.reached)
        except UnknownBehaviourError as error:
            self._refused = error
        plain = [(owner, model) for owner, model in self.net.owned() if model.kind is None and model.forcing is None]
        self._actions = Actions(plain, self._steps, scope, path, profile, reached=self.reached)
        self._flags = Flags(chart, scope, path, profile)
        self._has_flags = bool(self._flags.used)
        self._step_actions = StepActions(self.net, self.reached)
        self._tested = testing_order(self.net) if profile.numbered_first else None
        self._until_stable = profile.evolution is Evolution.UNTIL_STABLE
        self._order = profile.order
        self._pending = -1
        if self._order is ScanOrder.RETIMED:
            self._pending = scope.declare(f"{path}: transitions pending", BOOL, hidden=True)
        self._plans = Plans(self._plan)
        self._waits: dict[int, Condition] = {}
        self._watches: dict[int, Watch] = {}
        self._logic: Run | None = None

    @property
    def is_divisible(self) -> bool:
        """See `RunningChart`.

        Flags, forcing orders, the search for a stable situation and logic drawn beside the steps concern all of them.
        """
        whole = self._refused is not None or self._grafcet is not None or self._has_flags or self._logic is not None
        simple = self._profile.step_variables is not StepVariables.FLAG and not self.net.macros
        return simple and not whole and not self._until_stable

    def forgetting(
        self, anywhere: Container[str], read: Container[str], _names: Container[str]
    ) -> Callable[[Frame, int], None]:
        """See `RunningChart`."""
        used = {self._steps.since[index] for index in (*self._waits, *self._watches)} | self._actions.step_times
        if self._grafcet is not None:
            used |= self._grafcet.step_times
        return forgetting(self._steps, anywhere, read, used)

    # -- preparing

    def translate(self) -> None:
        """Prepare conditions and bodies. Anything unknown to the profile is an error of the first scan."""
        if self._refused is not None:
            return
        self._actions.translate()
        if self._grafcet is not None:
            self._grafcet.translate()
        self._flags.translate()
        self._step_actions.translate(self._scope, self.path)
        if self._chart.logic:
            self._logic = Routines(self._scope).chart_logic(self._chart, self.path)
        self._moves = tuple(self._move(each, _missing_condition) for each in self.net.transitions)
        for step in self.net.steps:
            where = f"{self.path} / step {step.path}"
            if self._profile.minimum_times and step.step.min_time:
                self._waits[step.index] = self._wait(step.index, step.step.min_time, where)
            if self._profile.maximum_times and step.step.max_time and SfcFlag.ERROR in self._flags.used:
                time = Routines(self._scope).expression(step.step.max_time, where, ELEMENTARY["TIME"])
                reasons = analysis(self.net, step.index, self._scope, where)
                self._watches[step.index] = Watch(step.step.name, self._steps.since[step.index], time, reasons)

    def _stated(self, transition: NetTransition) -> Stated | None:
        if self._grafcet is not None:
            return self._grafcet.condition(transition.index)
        return transition.transition.condition

    def _wait(self, index: int, text: str, where: str) -> Condition:
        time = Routines(self._scope).expression(text, where, ELEMENTARY["TIME"])
        since = self._steps.since[index]
        clock = self._clock

        def waited(frame: Frame) -> bool:
            return bool(clock.now + clock.ahead - frame.v[since] >= time(frame))

        return waited

    def _plan(self, situation: int) -> Plan:
        indexed = self.net.enabled(situation)
        order = indexed if self._tested is None else sorted(indexed, key=self._tested.__getitem__)
        enabled = [self._moves[index] for index in order]
        moves = tuple(self._timed(move, move.condition) for move in enabled)
        forced = tuple(self._timed(move, lambda _: True) for move in enabled)
        active = list(indexes(situation))
        watches = tuple(self._watches[index] for index in active if index in self._watches)
        current = self.net.steps[active[-1]].step.name if active else ""
        timed = self._steps.timed(situation)
        return Plan(moves, forced, timed, self._step_actions.of(situation), watches, current)

    def _timed(self, move: Move, condition: Condition) -> Move:
        """Return the transition with the minimum times of its sources."""
        waits = [self._waits[index] for index in indexes(move.sources) if index in self._waits]
        if not waits:
            return move._replace(condition=condition)
        return move._replace(condition=lambda frame: all(waited(frame) for waited in waits) and condition(frame))

    # -- looking

    def situation(self, frame: Frame) -> int:
        """The steps whose transitions the next scan looks at; with actions first they may not have been active yet."""
        following: int = frame.v[self._situation]
        return following

    def step_flags(self) -> dict[str, int]:
        """Return the BOOL variables that the chart has for its steps (``X3``), with the steps as bits of `net`."""
        return {name.name: name.steps for name in self._steps.names if name.flag}

    # -- running

    def initialise(self, frame: Frame) -> None:
        """A new instance: nothing is active before its first scan."""
        v = frame.v
        v[self._situation] = self.net.initial
        v[self._shown] = 0
        v[self._started] = False

    def execute(self, frame: Frame) -> None:
        """Execute one scan."""
        if self._refused is not None:
            fail(self._refused)
        now = self._clock.now
        if self._order is ScanOrder.RETIMED and frame.v[self._pending]:
            frame.v[self._pending] = False
            tick(frame, self._plans[frame.v[self._situation]].timed, now)
            self._announce(frame, self._evolve(frame))
        if self._logic is not None:
            if not frame.v[self._started]:  # a wire from an initial step is TRUE from the first scan on
                self._steps.change(frame, 0, self.net.initial, self.net.initial, now)
            self._logic(frame)
        if self._has_flags and not self._obey(frame, now):
            return
        match self._order:
            case ScanOrder.TRANSITIONS_FIRST:
                self._announce(frame, self._transitions_then_actions(frame, now))
            case ScanOrder.ACTIONS_FIRST:
                self._act(frame, now)
                self._announce(frame, self._evolve_ahead(frame, now))
            case ScanOrder.RETIMED:
                self._act(frame, now)
                frame.v[self._pending] = True

    def _announce(self, frame: Frame, fired: bool) -> None:  # what a flag tells
        if self._has_flags:
            self._flags.put(SfcFlag.TRANS, frame, fired)

    def _act(self, frame: Frame, now: int) -> None:
        """Activate the steps that were entered in the scan before, and execute the actions."""
        v = frame.v
        situation = v[self._situation]
        before = v[self._shown]
        entered = situation & ~before
        if not v[self._started]:
            v[self._started] = True
            self.reached.steps |= situation
            self._steps.change(frame, before, situation, situation, now + self._clock.ahead)
            v[self._shown] = situation
            before = 0
            entered = situation if self._profile.initial_steps_entered else 0
        elif situation != before:
            self._steps.change(frame, before, situation, entered, now)
            v[self._shown] = situation
        plan = self._plans[situation]
        tick(frame, plan.timed, now)
        self._execute(frame, now, plan, SituationChange(before & ~situation, entered, situation))

    def _evolve_ahead(self, frame: Frame, now: int) -> bool:
        """Clear transitions with times that are ahead."""
        ahead = self._clock.ahead
        timed = self._plans[frame.v[self._situation]].timed if ahead else ()
        tick(frame, timed, now + ahead)
        fired = self._evolve(frame)
        tick(frame, timed, now)
        return fired

    def _evolve(self, frame: Frame) -> bool:
        """Clear transitions; the steps that they enter become active in the next scan."""
        v = frame.v
        situation = v[self._situation]
        cleared = self._clear(frame, self._plans[situation], situation)
        if not cleared.transitions:
            return False
        v[self._situation] = following = situation & ~cleared.left | cleared.entered
        self.reached.steps |= following
        self.reached.transitions |= cleared.transitions
        self._steps.announce(frame, situation, following)
        return True

    def _transitions_then_actions(self, frame: Frame, now: int) -> bool:
        v = frame.v
        first = not v[self._started]
        situation = v[self._situation]
        before = v[self._shown]
        seen = 0
        if first:
            v[self._started] = True
            if self._grafcet is not None:
                situation = self._grafcet.start(frame, situation)
            self.reached.steps |= situation
            self._steps.change(frame, before, situation, situation, now)
            before = 0 if self._profile.initial_steps_entered else situation
            if self._grafcet is not None:
                self._grafcet.store(frame, before, situation)
            seen = situation & ~before if self._until_stable else 0
        tick(frame, self._plans[situation].timed, now)
        fired = False
        fresh = situation if first else 0
        if not (first and (self._profile.initial_situation_held or self._clock.holding)):
            for _ in range(self._profile.max_evolutions):
                if self._grafcet is not None:
                    self._grafcet.begin(frame, now, situation, fresh)
                # conditions of an evolution are tested on one situation and before any action: what fires first must
                # not change what the others see
                cleared = self._clear(frame, self._plans[situation], situation)
                if not cleared.transitions:
                    break
                fired = True
                previous = situation
                situation = self._move_on(frame, now, situation, cleared)
                fresh = situation & ~previous
                seen |= situation
                if not self._until_stable:
                    break
            else:
                raise self._unstable(situation)
        v[self._situation] = v[self._shown] = situation
        # steps that were passed in between have no actions but stored ones and pulses (`seen`): IEC 60848, 4.8
        plan = self._plans[situation]
        self._execute(frame, now, plan, SituationChange(before & ~situation, situation & ~before, seen | situation))
        return fired

    def _clear(self, frame: Frame, plan: Plan, situation: int) -> Cleared:
        """Return the transitions that are cleared in one evolution."""
        moves = plan.moves
        if self._has_flags:
            tip = self._flags.tip(frame)
            if tip is Tip.LOCKED:
                return NOTHING
            if tip is Tip.FORCED:
                moves = plan.forced
        if self._grafcet is not None:
            return self._choose(frame, self._grafcet.free(moves, situation))
        return self._choose(frame, moves)

    def _move_on(self, frame: Frame, now: int, situation: int, cleared: Cleared) -> int:
        """Return the next situation. A step that is left and entered at once stays active; its time may start again."""
        after: int = situation & ~cleared.left | cleared.entered
        if self._grafcet is not None:
            after = self._grafcet.rule(situation, after)
        restarted = cleared.entered if self._profile.entering_restarts_time else cleared.entered & cleared.left
        if not self._profile.leaving_restarts_time:
            restarted = 0
        entered = after & (restarted | ~situation)
        self.reached.steps |= after
        self.reached.transitions |= cleared.transitions
        self._steps.change(frame, situation, after, entered, now)
        if self._grafcet is not None:
            self._grafcet.store(frame, situation, after)
        return after

    def _execute(self, frame: Frame, now: int, plan: Plan, change: SituationChange) -> None:
        """Execute the actions of a situation."""
        situation = frame.v[self._shown]
        if self._has_flags:
            self._flags.put(SfcFlag.CURRENT_STEP, frame, plan.current)
        if change.left or change.entered:
            self._step_actions.leave_and_enter(frame, change.left, change.entered)
        if plan.watches and self._flags.can_time_out(frame):
            self._watch(frame, now, plan)
        for run in plan.main:
            run(frame)
        self._actions.act(frame, now, situation, change)
        if self._grafcet is not None:
            self._grafcet.act(frame, now, situation)

    def _watch(self, frame: Frame, now: int, plan: Plan) -> None:
        """Report the first step that is active longer than it may."""
        for watch in plan.watches:
            if now - frame.v[watch.since] > watch.time(frame):
                self._flags.time_out(frame, watch.step, watch.reasons(frame))
                return

    def _obey(self, frame: Frame, now: int) -> bool:
        """Do what the flags want. False: nothing else happens in this scan."""
        v = frame.v
        order, new = self._flags.order(frame)
        if self._profile.pause_stops_time:
            self._stop_time(frame, now, stopped=order is FlagEffect.STOP)
        if order is FlagEffect.STOP:
            # a pause from the first scan on: programs see the initial steps, but nothing of them is executed
            if not v[self._started]:
                self._steps.change(frame, v[self._shown], self.net.initial, self.net.initial, now)
                v[self._shown] = self.net.initial
            return False
        if order is FlagEffect.RUN:
            if new:
                self._steps.restart(frame, v[self._shown], now)
            return True
        ends = self._profile.init_ends_actions if order is FlagEffect.INIT else self._profile.reset_ends_actions
        if new:
            if ends:
                self._actions.end(frame)
            self._steps.change(frame, v[self._shown], self.net.initial, self.net.initial, now)
            v[self._shown] = v[self._situation] = self.net.initial
            # the next scan counts as the first one again, so that entry actions and pulses of the initial steps come
            v[self._started] = False
        if order is FlagEffect.INIT:
            self._steps.restart(frame, self.net.initial, now)
            return False
        return True

    def _stop_time(self, frame: Frame, now: int, *, stopped: bool) -> None:
        """Leave out of all times the span from the first stopped scan to the one that goes on."""
        v = frame.v
        if stopped:
            if v[self._paused] is None:
                v[self._paused] = now
        elif v[self._paused] is not None:
            passed = now - v[self._paused]
            v[self._paused] = None
            for slot in {*self._steps.starts, *self._actions.starts}:
                if v[slot] is not None:
                    v[slot] += passed

    def _unstable(self, situation: int) -> UnstableChartError:
        return UnstableChartError(
            f"after {self._profile.max_evolutions} evolutions with the same inputs transitions are still cleared",
            location=Location(path=self.path),
            hint="Active steps at the end: " + ", ".join(self.net.names(situation)),
        )


def _missing_condition(where: str) -> Condition:
    def fail(_: Frame) -> bool:
        raise SimulationError("the transition has no condition", location=Location(path=where))

    return fail
