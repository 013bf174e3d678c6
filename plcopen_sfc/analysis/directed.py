"""Directed search for a difference where not everything can be tried: into every part of the programs.

Both sides run the same inputs, scan by scan, and are compared in each scan. States in which something is new are kept:
a situation of the charts, a transition that fired, a branch that was executed, or variables that have come nearer to
what a condition wants. From each kept state the search goes on: with inputs that z3 finds for conditions of the next
transitions, one at a time so that parallel branches are entered apart; by holding the inputs until something happens,
over the times that clocks wait for; by changing single inputs; by repeating what has brought a counter nearer; and by
chance. The same arguments always give the same search: its effort is counted in scans.
"""

from __future__ import annotations

import heapq
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, islice
from math import frexp, inf, nextafter
from random import Random
from typing import Any, NamedTuple

from plcopen_sfc.analysis.coverage import counted_charts, unreachable_in
from plcopen_sfc.analysis.deciding_parts import ConditionParts
from plcopen_sfc.analysis.distances import Measurement
from plcopen_sfc.analysis.domains import GREATEST_REAL, Domain, NotProvableError, plain
from plcopen_sfc.analysis.goals import Goal, Goals, total
from plcopen_sfc.analysis.product import compare, end_of, failure_of
from plcopen_sfc.analysis.search_limits import INTERRUPTED
from plcopen_sfc.analysis.stimuli import patterns
from plcopen_sfc.analysis.systems import ProgramSystem
from plcopen_sfc.analysis.timers import STEADY, Clocking, RunningClocks
from plcopen_sfc.model.chart_settings import SfcFlag
from plcopen_sfc.semantics.inputs import samples
from plcopen_sfc.semantics.signals import Signal, SignalKind, Value

_PATTERN_SCANS = 40
_WAITS = 40
"""Scans of one wait, besides those around the end of each time."""

_AROUND_END = 2 + STEADY
"""Scans that run around the end of a time while nothing but clocks goes on."""

_FLIPS = 24
_HOPES = 4
"""Transitions of a state for which single inputs are changed."""

_VALUES = 8
_MOST_VALUES = 60
"""Of an input, with those that conditions want."""

_MOST_PATTERNS = 96
"""Of an input whose bits may matter."""

_CHANGED_BIT = 0.5
_ANY_VALUE = 0.1
_CHANCES = 12
_LOOKED_BACK = 40
_REPEATED = 2_000
_MOST_GOALS = 24
_MOST_OTHERS = 8
"""Branches of the side that does not lead, when all of the leading side were reached."""

_MOST_STATES = 20_000
_BOUND_TRIES = 3
"""Limit for solving one bound of a comparison."""

_LONGEST = 10
"""Times the effort that a search takes at most, which goes on as long as it comes to something new."""

_PHASES = 10
"""Parts of the effort: after one without anything new, what is left is looked at whether it is reachable at all.

After the next ones the rest is wanted in turn with it.
"""

_TRIES = 8
"""Limit for trying inputs that z3 has found for a part of a condition."""

_MOST_TRIED = 60
"""Parts of conditions, bounds of comparisons and outcomes, each, that z3 is asked for in one state."""

_FLAGS = frozenset(flag.variable.casefold() for flag in SfcFlag)

Row = dict[str, Value]
Step = tuple[Row, int]
"""The inputs of a scan, and how many scans went by before it with the same ones, in which only clocks went on."""


@dataclass(slots=True)
class _State:
    """A pair of states that was kept: how it was reached, and with what inputs."""

    before: Any
    parent: int
    way: list[Step]
    row: Row
    key: Any
    distance: float
    reached: int
    rounds: int = 0

    @property
    def situation(self) -> Any:
        """The situations of the charts of both sides."""
        return self.key and (self.key[0], self.key[3])


class _Wanted(NamedTuple):
    """Inputs that are tried from a state.

    `rows` are held until the situation changes. `after`: those of a scan behind one with the other values. `bounds`:
    those with which a comparison just changes. `hoped`: they make a condition TRUE as far as inputs decide it.
    """

    rows: list[Row]
    after: list[Row]
    bounds: list[Row]
    hoped: list[Row]


@dataclass(frozen=True)
class Directed:
    """Result of a search: the steps of a run that ends with a difference, or None; and how much was run.

    `stopped`: why it ended before its effort was spent.
    """

    steps: list[Step] | None
    runs: int
    scans: int
    notes: tuple[str, ...] = ()
    stopped: str = ""


class _End(Exception):  # noqa: N818  # no error: the effort is spent, or there is a difference
    pass


class DirectedSearch:
    """See the module.

    `parts`: those of the conditions of both sides; `scans`: the effort, in which something new must come or it ends;
    `seed`: of what is left to chance; `look` tells why the search must end.
    """

    def __init__(
        self,
        left: ProgramSystem,
        right: ProgramSystem,
        signals: Mapping[str, Signal],
        domains: Mapping[str, Domain],
        clock: Clocking,
        *,
        parts: tuple[ConditionParts, ConditionParts],
        scans: int,
        seed: int,
        look: Callable[[int], str],
    ) -> None:
        self._sides = (left, right)
        self._signals = signals
        self._clock = clock
        self._effort = self._end = scans
        self._look_at_time = look
        self._stopped = ""
        self._chance = Random(f"{seed}")  # noqa: S311  # no secret
        # the side with more transitions tells more of what leads where: modes may be conditions there
        leading = int(_transitions(left) < _transitions(right))
        self._goals = Goals(self._sides[leading], signals, parts[leading], look)
        self._parts = parts
        self._with_parts = [self._goals]
        other = self._sides[1 - leading]
        self._others = Goals(other, signals, parts[1 - leading], look)
        for goal in chain(self._others.branches, self._others.parts):
            goal.leads = False
        has_outcomes = not all(branch.is_statement for branch in other.marks.branches)
        if any(parts[1 - leading]) or (has_outcomes and bool(other.instance.charts()) == bool(self._goals.charts)):
            self._with_parts.append(self._others)
        self._quiet: Row = {name: signal.default for name, signal in signals.items()}
        self._values = {name: _values(domains[name], signal) for name, signal in signals.items()}
        self._bitwise = {name for name, signal in signals.items() if self._learn_of_programs(name, signal)}
        self._moved = [name for name in signals if name.casefold().rpartition(".")[2] not in _FLAGS]
        self._states: list[_State] = []
        self._by_key: dict[Any, int] = {}
        self._waiting: list[tuple[int, bool, int, float, int, int]] = []
        self._visits: Counter[Any] = Counter()
        self._frontier: list[Goal] = []
        self._measurement = Measurement([])
        self._reached = -1
        self._progress = 0
        self._dead: set[Goal] | None = None
        self._looks_aside = self._only_parts = False
        self._turned = False
        self._read: dict[str, None] = {}
        self._notes: dict[str, None] = {}
        self._runs = 0
        self._scans = 0
        self._difference: list[Step] | None = None
        self._clocks = [RunningClocks(each.instance) for each in self._sides]
        # of the run that goes on
        self._at = 0
        self._way: list[Step] = []

    def run(self, more: int = 0) -> Directed:
        """Search to the end; with another effort, of `more` scans, go on behind it."""
        if more:
            self._effort, self._end = more, self._scans + more
        try:
            if not self._states:
                self._start()
            while self._waiting:
                if self._turned:
                    self._harvest()
                self._go_on_from(self._next())
        except _End:
            pass
        except KeyboardInterrupt:
            self._stopped = INTERRUPTED
        return Directed(self._difference, self._runs, self._scans, tuple(self._notes), self._stopped)

    def _learn_of_programs(self, name: str, signal: Signal) -> bool:
        """Try the values of an input that the programs ask for; return True where they look at its bits."""
        if signal.kind is SignalKind.STRING:
            self._learn(name, (_text(length) for side in self._sides for length in side.text_lengths(signal)))
        # what is compared with a constant may be a copy of an input
        self._learn(name, (each for goals in self._with_parts for each in goals.constants(signal)))
        bits = (_wrapped(each, signal) for side in self._sides for each in side.bit_patterns(signal))
        return self._learn(name, bits, most=_MOST_PATTERNS)

    def _learn(self, name: str, values: Iterable[Value], *, most: int = _MOST_VALUES) -> bool:
        """Try more values of an input; return True where there are any."""
        known = self._values[name]
        found = dict.fromkeys(values)
        known += [value for value in found if value not in known][: max(most - len(known), 0)]
        return bool(found)

    # -- runs

    def _start(self) -> None:
        """The first states: runs of patterns that known mistakes fall over."""
        row = self._quiet
        for side in self._sides:
            side.reset()
        self._keep(row, -1, [])
        options = {name: list(values) for name, values in self._values.items()}
        for rows in patterns(self._signals, options, _PATTERN_SCANS):
            self._begin(0)
            for each in rows:
                if not self._scan(each):
                    break

    def _begin(self, number: int) -> None:
        """Go back to a kept state."""
        self._runs += 1
        state = self._states[number]
        for side, before in zip(self._sides, state.before, strict=True):
            side.restore(before)
        self._at = number
        self._way = []

    def _scan(self, row: Row, *, virtual: int = 0) -> bool:
        """Run one scan, after `virtual` ones in which nothing but clocks goes on; False where that ends the run."""
        self._check_time()
        if self._scans >= self._end:
            raise _End
        self._scans += 1
        first = self._at == 0 and not self._way
        if virtual:
            for side in self._sides:
                side.pass_time(virtual)
        self._way.append((row, virtual))

        def read(name: str) -> Value:
            self._read[name] = None
            return row[name]

        try:
            failures = [failure_of(side, read, first=first) for side in self._sides]
        except NotProvableError as error:
            self._notes[str(error)] = None
            return False
        ended = end_of(failures)
        if ended is not None:
            self._notes[ended[0]] = None
            return False
        if any(failures) or compare(self._sides[0].observed(), self._sides[1].observed()):
            self._differs()
            return False
        self._look(row)
        return True

    def _check_time(self) -> None:
        self._stopped = self._look_at_time(self._scans)
        if self._stopped:
            raise _End

    def _differs(self) -> None:
        self._difference = [*self._ways_to(self._at), *self._way]
        raise _End

    def _ways_to(self, number: int) -> list[Step]:
        ways: list[list[Step]] = []
        while number > 0:
            ways.append(self._states[number].way)
            number = self._states[number].parent
        return [step for way in reversed(ways) for step in way]

    # -- what is kept

    def _look(self, row: Row) -> None:
        """Keep the present state if something is new in it."""
        markings = self._goals.markings()
        reached = self._count()
        is_stuck = self._scans - self._progress > self._effort // _PHASES
        if reached != self._reached:
            self._end = min(max(self._end, self._scans + self._effort), self._effort * _LONGEST)
        if reached != self._reached or is_stuck:
            self._reached, self._progress = reached, self._scans
            self._turned |= is_stuck
            if is_stuck and self._dead is None:
                leading = self._goals.system
                present = leading.snapshot()  # first values are asked for, too
                self._dead = self._goals.impossible(unreachable_in(leading, is_late=self._is_late))
                leading.restore(present)
            else:
                self._looks_aside ^= is_stuck
            self._frontier = self._open()
            self._measurement = Measurement([goal.distance for goal in self._frontier])
        distances = self._measurement.take()
        far = tuple((goal, _bucket(each)) for goal, each in zip(self._frontier, distances, strict=True) if each)
        key = (markings, far, len(self._frontier), self._others.markings())
        number = self._by_key.get(key)
        distance = total(distances)
        if number is not None and distance >= self._states[number].distance:
            return
        if len(self._states) >= _MOST_STATES:
            return
        self._keep(row, self._at, self._way, key, distance)

    def _is_late(self) -> bool:
        return bool(self._look_at_time(self._scans))

    def _keep(self, row: Row, parent: int, way: list[Step], key: Any = None, distance: float = float("inf")) -> None:
        number = len(self._states)
        before = tuple(side.snapshot() for side in self._sides)
        self._states.append(_State(before, parent, list(way), row, key, distance, self._reached))
        self._by_key[key] = number
        self._push(number)
        # the run goes on from the kept state, so that ways are not told twice
        self._at, self._way = number, []

    def _count(self) -> int:
        """Return how much was reached: it only grows."""
        charts = sum(
            chart.reached.steps.bit_count() + chart.reached.transitions.bit_count() + chart.reached.actions.bit_count()
            for chart, _ in self._goals.charts
        )
        return charts + sum(sum(side.marks.reached) for side in self._sides) + sum(each.seen for each in self._parts)

    def _open(self) -> list[Goal]:
        leading = chain(self._goals.open_transitions(), self._goals.open_branches())
        dead = self._dead or ()
        found = list(islice((each for each in leading if each not in dead), _MOST_GOALS))
        if self._only_parts is bool(found):
            self._only_parts = not found
            self._turned = True
        if not found or self._looks_aside:  # parts of conditions come last: they are many, and most decide on the way
            parts = (
                goal
                for goals in self._with_parts
                for goal in chain(goals.open_actions(), goals.open_parts(), goals.open_outcomes())
            )
            others = islice(self._others.open_branches(), _MOST_OTHERS)  # most are reached with those of the first
            found = list(islice(chain(others, parts), _MOST_GOALS))
        return found

    def _push(self, number: int) -> None:
        heapq.heappush(self._waiting, self._turn(number))

    def _turn(self, number: int) -> tuple[int, bool, int, float, int, int]:
        """Return the turn of a state: near ones first, of them those of which few were looked at.

        Of the others those first that were kept last: how far older ones are was told of what was wanted then.
        """
        state = self._states[number]
        is_near = self._is_near(state)
        order = (self._visits[state.situation], 0.0, -number) if is_near else (-state.reached, state.distance, number)
        return state.rounds, not is_near, *order, number

    def _is_near(self, state: _State) -> bool:
        """True if a step is active in which something is looked at that is wanted."""
        if state.key is None:
            return False
        leading, _, _, others = state.key
        return any(
            steps & (leading if goal.leads else others)[chart]
            for goal in self._frontier
            if self._only_parts or goal.part is None or not goal.leads  # most are decided on the way to the others
            for chart, steps in goal.places
        )

    def _next(self) -> int:
        if self._turned:  # other goals are wanted now: what was far may be near to them
            self._turned = False
            self._waiting = [self._turn(number) for *_, number in self._waiting]
            heapq.heapify(self._waiting)
        while True:
            _, was_far, visits, _, _, number = heapq.heappop(self._waiting)
            state = self._states[number]
            if not was_far and not (self._is_near(state) and visits == self._visits[state.situation]):
                self._push(
                    number
                )  # what it was near to was reached meanwhile, or others of its situation had their turn
                continue
            if state.rounds == 0 or self._by_key.get(state.key) == number:  # else a nearer one is in its place
                self._visits[state.situation] += 1
                return number

    # -- going on

    def _go_on_from(self, number: int) -> None:
        state = self._states[number]
        try:
            if state.rounds == 0:
                self._read = {}
                self._solve(number)
                self._begin(number)
                self._wait(state.row)
                self._repeat(number)
                self._flips(number, list(self._read))
            else:
                self._random(number)
            state.rounds += 1
        finally:
            self._push(number)

    def _harvest(self) -> None:
        """Go on from all kept states in which only inputs are missing for branches that are wanted now."""
        wanted = [
            (goals, each)
            for goals in (self._goals, self._others)
            for each in islice(goals.open_branches(), _MOST_GOALS)
            if each in self._frontier
        ]
        measurement = Measurement([goal.distance for _, goal in wanted])
        for number in range(len(self._states) if wanted else 0):
            self._begin(number)
            for (goals, goal), distance in zip(wanted, measurement.take(), strict=True):
                if distance or goals.system.marks.reached[goal.branch]:
                    continue
                values = goals.solve([goal], [])
                if values is not None:
                    row = {**self._states[number].row, **values}
                    # what is computed behind the branch, such as an edge, is seen there in the next scan
                    if self._scan(row) and not goals.system.marks.reached[goal.branch]:
                        self._scan(row)
                    self._begin(number)

    def _solve(self, number: int) -> None:
        """Make the conditions of the next transitions TRUE, each alone where that is possible; then none of them."""
        state = self._states[number]
        self._begin(number)
        self._runs -= 1  # only to look at it
        wanted = self._wanted(state)
        for row in wanted.rows:
            self._begin(number)
            if self._scan(row):
                self._wait(row)
        # An edge is wanted: a scan with the other value comes before.
        for values in wanted.after:
            row = {**state.row, **values}
            self._begin(number)
            if self._scan({name: False if name in values and value is True else value for name, value in row.items()}):
                self._scan(row)
        for values in wanted.bounds:
            self._begin(number)
            self._scan({**state.row, **values})
        for row in wanted.hoped[:_HOPES]:
            self._hope(number, row)

    def _wanted(self, state: _State) -> _Wanted:
        """Ask z3 for inputs with which something new happens in a state, in which both sides are."""
        enabled = self._goals.enabled(state.key[0]) if state.key is not None else []
        rows: list[Row] = []
        bounds: list[Row] = []

        def add(values: Row | None, around: Row = state.row) -> bool:
            if values is not None:
                for name, value in values.items():  # what a condition wants once is worth a try elsewhere
                    self._learn(name, [value])
                row = {**around, **values}
                if row not in rows:
                    rows.append(row)
            return values is not None

        hoped: list[Row] = []
        after: list[Row] = []

        def try_part(goals: Goals, goal: Goal, values: Row | None) -> None:
            later = goals.solve_after(goal) if values is None else None
            if add(values) or later is not None:
                goal.tries += 1
            after.extend([later] if later is not None else [])

        for goal in enabled:
            self._check_time()
            # The fewer transitions fire at once, the more situations are seen one by one: first all other conditions
            # are FALSE, then only the competing ones, then any.
            others = [each for each in enabled if each is not goal and each.tree is not None]
            before = [each for each in others if each.sources & goal.sources and each.chart == goal.chart]
            solved = add(self._goals.solve([goal], others)) or add(self._goals.solve([goal], before))
            if not (solved or add(self._goals.solve([goal], []))) and goal in self._frontier:
                values = self._goals.solve([goal], [], hoping=True)
                hoped += [{**state.row, **values}] if values is not None else []
        if enabled:
            held = self._goals.solve([], enabled)
            add(held, self._quiet)  # where an action adds up an input, nothing but clocks goes on only while that is 0
            add(held)
            self._hold(held, add)
        for goals in (self._goals, self._others):
            for goal in goals.branches:
                if goal in self._frontier:
                    add(goals.solve([goal], []))
        for goals in self._with_parts:
            for goal in self._tried(goals.tested(chain(goals.open_actions(), goals.open_parts()))):
                try_part(goals, goal, goals.solve_part(goal))
            for goal in self._tried(goals.open_bounds(_BOUND_TRIES)):
                bounds += self._at_bound(goals.solve_bound(goal))
            for goal in self._tried(goals.open_outcomes()):
                try_part(goals, goal, goals.solve([goal], []))
        return _Wanted(rows, after, bounds, hoped)

    def _tried(self, goals: Iterable[Goal]) -> Iterator[Goal]:
        """Yield those that are worth a try in one state; others have their turn in the next ones.

        A program of a few pages has hundreds of them, and to solve these takes longer than to run it.
        """
        left = [each for each in goals if each.tries < _TRIES]
        for goal in left if len(left) <= _MOST_TRIED else self._chance.sample(left, _MOST_TRIED):
            self._check_time()
            yield goal

    def _hold(self, held: Row | None, add: Callable[[Row | None], bool]) -> None:
        """Add inputs that hold the situation, and with which branches are executed that wait for a time in it."""
        for goals in (self._goals, self._others) if held is not None else ():
            waiting = [goal for goal in goals.branches if goal.waits and goal in self._frontier]
            distances = Measurement([goal.distance for goal in waiting]).take()
            nearest = sorted(zip(distances, range(len(waiting)), strict=True))[:_HOPES]
            for goal in (waiting[place] for _, place in nearest):
                values = goals.solve([goal], [], hoping=True)
                add({**(held or {}), **values} if values else None)

    def _hope(self, number: int, row: Row) -> None:
        """Change single inputs with a condition TRUE as far as inputs decide it: a called block may decide the rest.

        Its output counts in the scan in which it is called, such as the pulse of an edge.
        """
        self._begin(number)
        if self._scan(row):
            self._wait(row)
        before = self._states[number].row
        for name in [each for each in self._read if self._signals[each].kind is SignalKind.BOOL][:_FLIPS]:
            self._begin(number)
            if self._scan({**row, name: not before[name]}):
                self._scan({**row, name: before[name]})

    def _at_bound(self, found: Row | None) -> list[Row]:
        """Return values of inputs at which a comparison changes, and with the real numbers beside them."""
        if not found:
            return []
        near = [
            {**found, name: each} for name, value in found.items() for each in _neighbours(self._signals[name], value)
        ]
        return [found, *near]

    def _wait(self, row: Row) -> None:
        """Hold the inputs until the situation changes, over times in which nothing but clocks goes on."""
        markings = self._goals.markings()
        steady = 0
        seen: Any = None
        for _ in range(_WAITS + _AROUND_END * len(self._clock.constants)):
            virtual = 0
            if steady >= STEADY:
                ends = [each.next_end(self._clock) for each in self._clocks]
                known = [end for end in ends if end is not None]
                if not known:
                    return
                virtual = max(min(known) - 2, 0)
            if not self._scan(row, virtual=virtual):
                return
            if self._goals.markings() != markings:
                for _ in range(STEADY):  # pulses that the change begins: of what has come nearer they tell nothing yet
                    if not self._scan(row):
                        return
                return
            now = [each.still() for each in self._clocks]
            steady = steady + 1 if now == seen else 0
            seen = now

    def _flips(self, number: int, read: Sequence[str]) -> None:
        """Change single inputs that are read, for a scan and for longer."""
        state = self._states[number]
        names = [name for name in read if name in self._values]
        for name in names[:_FLIPS]:
            values = [value for value in self._values[name] if value != state.row[name]]
            if name in self._bitwise or len(values) > 2 * _VALUES:
                values = self._chance.sample(values, min(len(values), _VALUES))
            for value in values[:_VALUES]:
                row = {**state.row, name: value}
                self._begin(number)
                if self._scan(row) and self._scan(row) and self._signals[name].kind is SignalKind.BOOL:
                    self._scan(state.row)

    def _repeat(self, number: int) -> None:
        """Repeat what brought a variable nearer to what is wanted since the same situation was there before."""
        state = self._states[number]
        if state.key is None or not state.distance:
            return
        way: list[list[Step]] = [state.way]
        ancestor = state.parent
        for _ in range(_LOOKED_BACK):
            if ancestor <= 0:
                return
            earlier = self._states[ancestor]
            if earlier.key[0] == state.key[0] and earlier.key[2] == state.key[2] and earlier.distance > state.distance:
                break
            way.append(earlier.way)
            ancestor = earlier.parent
        else:
            return
        steps = [step for each in reversed(way) for step in each]
        if sum(1 + skipped for _, skipped in steps) > _LOOKED_BACK * 2:
            return
        self._begin(number)
        best = state.distance
        for _ in range(_REPEATED):
            for row, skipped in steps:
                for _ in range(1 + skipped):
                    if not self._scan(row):
                        return
            distance = total(self._measurement.take())
            if not distance < best:
                return
            best = distance

    def _random(self, number: int) -> None:
        """Inputs by chance, each held for some scans."""
        chance = self._chance
        row = self._states[number].row
        self._begin(number)
        names = self._moved or list(self._signals)
        for _ in range(_CHANCES):
            if names:
                changed = chance.sample(names, min(len(names), chance.choice((1, 1, 2, 3))))
                row = {**row, **{name: self._other(name, row[name]) for name in changed}}
            for _ in range(chance.choice((1, 1, 2, 5))):
                if not self._scan(row):
                    return
        self._wait(row)

    def _other(self, name: str, value: Value) -> Value:
        """A value by chance; where bits matter, often the present one with another bit, or a number around it."""
        signal = self._signals[name]
        if name in self._bitwise and isinstance(value, int) and self._chance.random() < _CHANGED_BIT:
            bit = 1 << self._chance.randrange((signal.greatest - signal.least).bit_length())
            return _wrapped(
                self._chance.choice((value ^ bit, value + 1, value - 1, self._chance.getrandbits(64))), signal
            )
        if signal.kind in (SignalKind.REAL, SignalKind.STRING) and self._chance.random() < _ANY_VALUE:
            if signal.kind is SignalKind.STRING:
                return _text(self._chance.randrange(signal.length + 1))
            return signal.accept(self._chance.uniform(-1, 1) * 10 ** self._chance.randrange(-2, 7))
        return self._chance.choice(self._values[name])


def _transitions(system: ProgramSystem) -> int:
    """Return the number of transitions of the charts of a system."""
    return sum(len(chart.net.transitions) for _, chart in counted_charts(system))


def _bucket(distance: float) -> int:
    """Return the class of a distance: small ones each for itself, great ones by their order of magnitude."""
    if distance <= 4 and distance == int(distance):
        return int(distance)
    return 4 + frexp(distance)[1] if distance > 0 else 0


def _wrapped(number: int, signal: Signal) -> int:
    return (number - signal.least) % (signal.greatest - signal.least + 1) + signal.least


def _values(domain: Domain, signal: Signal) -> list[Value]:
    """Return the values that are tried for an input: those that comparisons tell apart, and some of its type.

    Among them are the least and the greatest integer or time: ``n + 1 > n`` is FALSE for one value only.
    """
    known = [plain(each) for each in domain.options]
    if signal.kind is SignalKind.BOOL:
        return known
    first, *others = samples(signal)
    bounds: tuple[Value, ...] = ()
    if signal.kind in (SignalKind.INTEGER, SignalKind.DURATION):
        bounds = (signal.least, signal.greatest)
    elif signal.kind is SignalKind.REAL:
        most = GREATEST_REAL if signal.type == "REAL" else sys.float_info.max
        bounds = tuple(map(signal.accept, (*_ROUNDED, most, -most)))
    return list(dict.fromkeys([*(known if len(known) > 1 else ()), first, *others[:1], *bounds, *others, *known]))


_ROUNDED = (1.5, 2.5, -1.5, -0.5, 2.7, 0.1, 16777217.0, 1.0e-30)
"""Real numbers that are rounded, some of them where they are kept with single precision."""


def _text(length: int) -> str:
    """Return a text of a length; those of less lengths begin it."""
    return "".join(chr(ord("A") + (7 * place + place // 26 * 3) % 26) for place in range(length))


def _neighbours(signal: Signal, value: Value) -> list[Value]:
    """Return the real numbers beside one: what is calculated with it may be rounded."""
    if signal.kind is not SignalKind.REAL or not isinstance(value, float) or not value:
        return []
    if signal.type != "REAL":
        return [nextafter(value, -inf), nextafter(value, inf)]
    return [signal.accept(value * (1 - 2**-23)), signal.accept(value * (1 + 2**-23))]
