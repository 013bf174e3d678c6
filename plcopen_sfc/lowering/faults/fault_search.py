"""Search for the faults of a textbook sequence: the shortest inputs that show each of them.

The state space of the code is searched alone, breadth first, with every value of the inputs that it reads. Variables
before a copy of the code show which transitions want to fire at the beginning of a scan. The chart is run afterwards,
with the inputs that were found.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate
from typing import Any, NamedTuple

from plcopen_sfc.analysis.domains import Domain, NotProvableError, Probe, frozen, plain
from plcopen_sfc.analysis.marking import marking_graph
from plcopen_sfc.analysis.pairing import step_observations
from plcopen_sfc.analysis.product import Branching, failure_of
from plcopen_sfc.analysis.stimuli import stimuli
from plcopen_sfc.analysis.systems import Observation, ProgramSystem
from plcopen_sfc.analysis.timers import clocking
from plcopen_sfc.errors import UnstableChartError
from plcopen_sfc.lowering.faults.fault_detection import (
    CASE_RULES,
    FLIP_FLOP_RULES,
    ChartFacts,
    FaultPlace,
    ObservedScan,
    Rule,
    WatchedPou,
    outputs_of,
    watched_pou,
)
from plcopen_sfc.lowering.faults.fault_kinds import Fault, FaultKind, FaultScan
from plcopen_sfc.lowering.lowering_options import Construction, LoweringRules
from plcopen_sfc.lowering.reading.chart_source import ChartSource
from plcopen_sfc.semantics.net import indexes, mask
from plcopen_sfc.semantics.profile import Evolution
from plcopen_sfc.semantics.signals import Signal, SignalKind, Value
from plcopen_sfc.semantics.subjects import Subject

__all__ = ["find_faults"]

_SCANS = 6_000
"""Scans of one search, and those of going through the steps; a sequence of four steps needs some hundred."""

_CALM_SCANS = 20_000
_WORK = 4_000_000
"""Steps and transitions times the scans of one search: big charts get fewer."""

_MARKINGS = 10_000
_RUNS, _RUN_SCANS = 40, 100
Inputs = tuple[Mapping[str, Value], ...]


def find_faults(
    chart: Subject,
    code: Subject,
    source: ChartSource,
    rules: LoweringRules,
    *,
    situation: Mapping[str, str],
    at_rest: Mapping[str, bool],
    left_out: str | None = None,
) -> tuple[Fault, ...]:
    """Return the faults of `code`, which is the textbook form of `chart`, each with a trace that shows it.

    `source` is the chart as it was read, `situation` has the expressions that are TRUE while steps are active, by the
    path of the step; `at_rest` and `left_out` are those of `Constructed`. The whole state space of the code is
    searched. Where it is too large, the search goes from step to step; and where the inputs cannot be enumerated,
    typical and random ones are tried. A fault that is found so is one, but its trace need not be the shortest.
    """
    looked_for = FLIP_FLOP_RULES if rules.construction is Construction.FLIPFLOP else CASE_RULES
    restarts = {rules.init, rules.stop} & set(at_rest) | ({left_out} if left_out is not None else set())
    clock = clocking([chart, code], None)
    original = ProgramSystem(chart, rules.profile, clock)
    until_stable = rules.profile.evolution is Evolution.UNTIL_STABLE
    watched = watched_pou(code.pou, source, situation, behind=until_stable)
    program = ProgramSystem(replace(code, pou=watched.pou), rules.profile, clock)
    known = {name.casefold() for name in program.variables}
    outputs = [each for each in outputs_of(source.actions) if each.name.casefold() in known]
    flags = {path: seen for path, _, seen in step_observations(original, program, situation)}
    observed = _Observed(
        program,
        [flags[step.path] for step in source.net.steps],
        watched,
        [_restart(each) for each in sorted(filter(None, restarts)) if each.casefold() in known or each == left_out],
        [output.name for output in outputs],
    )
    facts = ChartFacts(source, rules.profile, marking_graph(source.net, cap=_MARKINGS), outputs, waits=bool(restarts))
    fixed = {name: value for name, value in at_rest.items() if name not in restarts}
    signals = _connect(program, original, fixed)
    found = _Search(observed, facts, looked_for, signals).all()
    by_kind = {kind: {place: way for (each, place), way in found.items() if each is kind} for kind in looked_for}
    shown = _Showing(observed, original, facts, signals)
    return tuple(shown.fault(kind, places) for kind, places in by_kind.items() if places)


def _restart(condition: str) -> Observation:
    """Return what is TRUE while a variable restarts the sequence, or its negation (``NOT Button``)."""
    name = condition.removeprefix("NOT ")
    return Observation(name, equals=False) if name != condition else Observation(name)


def _connect(code: ProgramSystem, chart: ProgramSystem, fixed: Mapping[str, bool]) -> dict[str, Signal]:
    """Let both read inputs by the same names, those that the code has; these with their types."""
    constants = {name.casefold(): value for name, value in fixed.items()}
    names: dict[str, str] = {}
    signals: dict[str, Signal] = {}
    for system in (code, chart):
        own = {}
        for name, signal in system.inputs.items():
            if name.casefold() not in constants:
                own[name] = names.setdefault(name.casefold(), name)
                signals.setdefault(own[name], signal)
        system.connect(own, {n: constants[n.casefold()] for n in system.inputs if n.casefold() in constants})
    return signals


class _Seen(NamedTuple):
    """End of a scan: active steps, transitions that wanted to fire and still do (bits), a restart, and outputs."""

    marking: int
    wanted: int
    waiting: int
    restarted: bool
    outputs: tuple[bool, ...]


class _Observed:
    """Code, and its variables that the detection of faults reads."""

    def __init__(
        self,
        program: ProgramSystem,
        steps: Sequence[Observation],
        watched: WatchedPou,
        restarts: Sequence[Observation],
        outputs: Sequence[str],
    ) -> None:
        self.program = program
        self._counts = len(steps), len(watched.before), len(watched.behind), len(restarts)
        self._before, self._behind = list(watched.before), list(watched.behind)
        names = [*watched.before.values(), *watched.behind.values()]
        self._cells = [program.instance.cell(name) for name in names]
        program.observe([*steps, *map(Observation, names), *restarts, *map(Observation, outputs)])

    def reset(self) -> _Seen:
        """Go to the state before the first scan."""
        self.program.reset()
        return self._seen()

    def scan(self, read: Callable[[str], Any], *, first: bool) -> _Seen | None:
        """Run a scan; None if it ends with an error."""
        return None if failure_of(self.program, read, first=first) is not None else self._seen()

    def snapshot(self) -> Any:
        """Return the state, to which the variables that were added do not belong."""
        for cells, index in self._cells:
            cells[index] = False
        return self.program.snapshot()

    def _seen(self) -> _Seen:
        values = tuple(map(bool, self.program.observed_now()))
        steps, before, behind, restarts = accumulate(self._counts)
        return _Seen(
            _bits(range(steps), values[:steps]),
            _bits(self._before, values[steps:before]),
            _bits(self._behind, values[before:behind]),
            any(values[behind:restarts]),
            values[restarts:],
        )


def _bits(places: Iterable[int], values: Iterable[bool]) -> int:
    return sum(1 << place for place, value in zip(places, values, strict=True) if value)


@dataclass(frozen=True)
class _Found:
    """Inputs that show a fault in one place. `shortest`: no fewer scans do."""

    inputs: Inputs
    shortest: bool


@dataclass(frozen=True)
class _State:
    """State from which the search continues: the inputs that lead to it, and the observations at its end."""

    snapshot: Any
    origin: int
    inputs: Mapping[str, Any]
    seen: _Seen


_Faults = dict[tuple[FaultKind, FaultPlace], _Found]


class _FewInputs(Branching):
    """Inputs of which only a few Boolean ones are TRUE together: the sequence goes step by step."""

    def __init__(self, domains: Mapping[str, Domain], most: int) -> None:
        super().__init__(domains)
        self._most = most

    def read(self, name: str) -> Any:
        """Return the value of an input in this scan."""
        enough = sum(value is True for value in self.values.values()) >= self._most
        if enough and name not in self.values and self._domains[name].signal.kind is SignalKind.BOOL:
            self.values[name] = False
        return super().read(name)


class _Search:
    def __init__(
        self, code: _Observed, facts: ChartFacts, rules: Mapping[FaultKind, Rule], signals: Mapping[str, Signal]
    ) -> None:
        self._code, self._facts, self._rules, self._signals = code, facts, rules, signals
        self._domains = {name: Domain(name, signal) for name, signal in signals.items()}

    def all(self) -> _Faults:
        """Return the faults by kind and place."""
        found: _Faults = {}
        most = _WORK // (len(self._facts.net.steps) + len(self._facts.net.transitions) + 1)
        try:
            if not self._code.program.clock.reason:
                every = Branching(self._domains)
                # with all inputs first: a trace found so is the shortest one. Too many states: only where the sequence
                # goes step by step, with as many TRUE inputs as one condition can need and one more
                if self._breadth_first(found, every, lambda _: True, min(_SCANS, most // 4), shortest=True):
                    return found
                few = _FewInputs(self._domains, self._facts.inputs_of_a_condition + 1)
                if self._breadth_first(found, few, self._is_calm, min(_CALM_SCANS, most), shortest=False):
                    return found
        # inputs without a finite domain: what was found so far depends on the order of the search
        except NotProvableError:
            found.clear()
        self._at_random(found, min(_RUNS, most // _RUN_SCANS))
        return found

    def _is_calm(self, marking: int) -> bool:
        """Return True if the code is in a situation of the chart, or in one with the steps just before besides."""
        following, graph = self._facts.following, self._facts.graph
        # the textbook form keeps a step for one scan beside the one behind it: that is its normal way, from which the
        # search goes on; any other situation is the result of a fault, and leads to more of the same
        behind = [step for step in indexes(marking) if following[step] & marking]
        ahead = marking & ~mask(behind)
        return marking in graph or (ahead in graph and all(following[step] & ahead for step in behind))

    def _breadth_first(
        self, found: _Faults, branching: Branching, goes_on: Callable[[int], bool], most: int, *, shortest: bool
    ) -> bool:
        """Search the states of the code, up to `most` scans. Returns True if all states were expanded."""
        while True:
            for domain in self._domains.values():
                domain.grown = False
            complete = self._searched(found, branching, goes_on, most, shortest=shortest)
            # a comparison with a number not seen before gives its input new values: the search starts again with them
            if not any(domain.grown for domain in self._domains.values()):
                return complete
            if shortest:  # a shorter trace may need a value that was not known yet
                found.clear()

    def _searched(
        self, found: _Faults, branching: Branching, goes_on: Callable[[int], bool], most: int, *, shortest: bool
    ) -> bool:
        probing = any(isinstance(option, Probe) for domain in self._domains.values() for option in domain.options)
        start = self._code.reset()
        states = [_State(self._code.snapshot(), -1, {}, start)]
        known: set[Any] = set()
        waiting = deque([0])
        scans = 0
        while waiting:
            number = waiting.popleft()
            state = states[number]
            for values in branching.combinations():
                scans += 1
                if scans > most:
                    return False
                self._code.program.restore(state.snapshot)
                seen = self._code.scan(branching.read, first=number == 0)
                if seen is None:
                    continue
                reached = _State(None, number, values, seen)
                for fault in self._shown(state.seen, seen, first=number == 0):
                    if fault not in found:
                        found[fault] = _Found(_inputs(states, reached), shortest)
                snapshot = self._code.snapshot()
                # outputs are a part of the key: a gap shows itself only in comparison with the scan before
                key = (frozen(snapshot) if probing else snapshot, seen.outputs)
                if key not in known and goes_on(seen.marking):
                    known.add(key)
                    states.append(replace(reached, snapshot=snapshot, inputs=dict(values)))
                    waiting.append(len(states) - 1)
            states[number] = replace(state, snapshot=None)  # it is not gone back to
        return True

    def _shown(self, before: _Seen, after: _Seen, *, first: bool) -> Iterator[tuple[FaultKind, FaultPlace]]:
        scan = ObservedScan(
            first,
            before.marking,
            after.marking,
            after.wanted,
            after.waiting,
            after.restarted,
            before.outputs,
            after.outputs,
        )
        for kind, rule in self._rules.items():
            for place in rule(self._facts, scan):
                yield kind, place

    def _at_random(self, found: _Faults, runs: int) -> None:
        """Try typical and random inputs, for faults in places where none was found yet."""
        clock = self._code.program.clock
        for rows in stimuli(self._signals, self._domains, clock, seed=0, runs=runs, scans=_RUN_SCANS):
            before = self._code.reset()
            for number, row in enumerate(rows):
                after = self._code.scan(row.__getitem__, first=number == 0)
                if after is None:
                    break
                for fault in self._shown(before, after, first=number == 0):
                    known = found.get(fault)
                    if known is None or (not known.shortest and number + 1 < len(known.inputs)):
                        found[fault] = _Found(tuple(rows[: number + 1]), shortest=False)
                before = after


class _Showing:
    """Report of a fault, with the reaction of the chart, which restarts where the code is initialised."""

    def __init__(self, code: _Observed, chart: ProgramSystem, facts: ChartFacts, signals: Mapping[str, Signal]) -> None:
        self._code, self._chart, self._facts, self._signals = code, chart, facts, signals

    def fault(self, kind: FaultKind, places: Mapping[FaultPlace, _Found]) -> Fault:
        """Return a fault with the trace of the place where the fewest scans show it."""
        place = min(places, key=lambda each: len(places[each].inputs))
        others = tuple(each for each in places if each != place)
        names = {name.casefold() for name in place}
        outputs = [output.name for output in self._facts.outputs if output.name.casefold() in names]
        trace = self._trace(places[place].inputs, outputs)
        return Fault(kind, place, others, trace, places[place].shortest, self._signals)

    def _trace(self, inputs: Inputs, outputs: list[str]) -> tuple[FaultScan, ...]:
        read = [name for name in self._signals if any(name in row for row in inputs)]
        usual = {name: signal.default for name, signal in self._signals.items()}
        net = self._facts.net
        self._chart.observe([Observation(name) for name in outputs])
        self._chart.reset()
        self._code.reset()
        scans = []
        for number, given in enumerate(inputs):
            row = {**usual, **given}
            seen = self._code.scan(row.__getitem__, first=number == 0)
            if seen is None:
                break
            active, failure = net.initial, None
            if seen.restarted:
                self._chart.reset()
            else:
                failure = failure_of(self._chart, row.__getitem__, first=number == 0)
                active = self._chart.marking()
            values = {each.name: now for each, now in zip(self._facts.outputs, seen.outputs, strict=True)}
            scans.append(
                FaultScan(
                    {name: row[name] for name in read},
                    net.names(active),
                    net.names(seen.marking),
                    dict(zip(outputs, map(bool, self._chart.observed_now()), strict=True)),
                    {name: values[name] for name in outputs},
                    is_stable=not isinstance(failure, UnstableChartError),
                )
            )
        return tuple(scans)


def _inputs(states: Sequence[_State], last: _State) -> Inputs:
    """Return the inputs of the scans that lead to a state."""
    rows: list[Mapping[str, Value]] = []
    state = last
    while state.origin >= 0:
        rows.append({name: plain(value) for name, value in state.inputs.items()})
        state = states[state.origin]
    return tuple(rows[::-1])
