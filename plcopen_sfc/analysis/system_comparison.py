"""Two systems side by side: what of them is compared, and what both do with given inputs."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain, repeat
from typing import Any

from plcopen_sfc.analysis.domains import plain
from plcopen_sfc.analysis.pairing import Delay, output_pairs, step_observations, unpaired
from plcopen_sfc.analysis.product import Explored, ScanEnd, compare, end_of, failure_of
from plcopen_sfc.analysis.sequences import InTurn, Joined, Settled
from plcopen_sfc.analysis.systems import Observation, ProgramSystem
from plcopen_sfc.analysis.verdict import Counterexample, Difference
from plcopen_sfc.errors import ModelError, SfcError
from plcopen_sfc.model.chart_settings import SfcFlag
from plcopen_sfc.semantics.charts.graph.graph_parameters import PARAMETERS
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.programs.runtime_types import MOST_ELEMENTS
from plcopen_sfc.semantics.signals import Signal, Value
from plcopen_sfc.semantics.trace import Column, Trace

_CALLS = "calls of unknown blocks"
_SHRINKING_RUNS, _SHRINKING_SCANS = 500, 500_000

Look = Callable[[int], str]
"""Tells why a search must end."""

_SEEDS = 64
"""Results of unknown functions that are tried with the inputs of a difference."""


def never(_: int) -> str:
    """Time is never over."""
    return ""


def _names_of_one_tool(left: ProgramSystem, right: ProgramSystem) -> frozenset[str]:
    """Return the variables, in upper case, that only one of two tools has, or whose values are in its language."""
    dialects = {each.subject.project.dialect for each in (left, right)}
    texts = {SfcFlag.ERROR_ANALYZATION.variable.upper()} if len(dialects) > 1 else set()
    return frozenset((operating_names(left.profile) ^ operating_names(right.profile)) | texts)


def _without_other_steps(
    left: ProgramSystem, pairs: Iterable[tuple[str, Signal, str]], steps: Iterable[tuple[str, Observation, Observation]]
) -> list[tuple[str, Signal, str]]:
    """Return pairs without flags of a step with a name that is the flag of another step on the right.

    `pairs` and `steps` have the variables and the steps that are compared. In a GRAFCET ``X3`` is the flag of step 3;
    in code it may be that of the exit step ``S3``, and step 3 is ``X3_2`` there.
    """
    told = {right.path.casefold(): own.bit for _, own, right in steps if right.equals is None and not right.bit}
    flags = {name.casefold(): bits for name, bits in left.step_flags.items()}

    def is_same(name: str, other: str) -> bool:
        meant = flags.get(name.casefold())
        return meant is None or told.get(other.casefold(), meant) == meant

    return [each for each in pairs if is_same(each[0], each[2])]


def _both_write(left: ProgramSystem, right: ProgramSystem, pair: tuple[str, Signal, str]) -> bool:
    """True if the programs or charts of both write a variable that only one of their tools knows by itself."""
    name, _, other = pair
    return all(
        system.writes(path) or (system.instance.charts() and path.upper() in operating_names(system.profile))
        for system, path in ((left, name), (right, other))
    )


class Comparison:
    """Two systems and what of them is compared."""

    def __init__(
        self,
        left: ProgramSystem,
        right: ProgramSystem,
        outputs: Iterable[str] | Mapping[str, str] | None,
        step_flags: Mapping[str, str] | None,
        delay: Delay,
        *,
        names: Mapping[str, str],
    ) -> None:
        self.left = left
        self.right = right
        self._delay = delay
        if outputs is not None:
            pairs = _named_pairs(left, right, outputs)
        else:
            pairs = output_pairs(left, right, names, delayed=delay.is_apart)
            own = _names_of_one_tool(left, right)
            pairs = [
                each
                for each in pairs
                if each[0].upper().rpartition(".")[2] not in own or _both_write(left, right, each)
            ]
        steps = step_observations(left, right, step_flags)
        pairs = _without_other_steps(left, pairs, steps)
        given = {*left.inputs, *right.inputs}  # what VAR_IN_OUT are before and after a scan has two names
        self.names = [f"{name} (written)" if name in given else name for name, _, _ in pairs]
        self.names += [f"{path}.X" for path, _, _ in steps]
        self.signals = [signal for _, signal, _ in pairs] + [Signal.elementary("BOOL")] * len(steps)
        if not self.names:
            hint = "Name variables of both with outputs=, or flags of steps with step_flags=."
            raise ModelError("the two have nothing in common that could be compared", hint=hint)
        self.pairs = [(Observation(name), Observation(other)) for name, _, other in pairs]
        self.pairs += [(own, other) for _, own, other in steps]
        if left.calls_blocks or right.calls_blocks:
            self.names.append(_CALLS)
            self.signals.append(Signal.elementary("STRING"))
            left.observe_calls()
            right.observe_calls()
        for system in (left, right):
            system.unknown_calls.is_delayed = delay.is_apart
        self.unknown = tuple(dict.fromkeys([*left.unknown, *right.unknown]))
        left.observe([own for own, _ in self.pairs])
        right.observe([other for _, other in self.pairs])
        lonely = unpaired(left, self.names)
        kept = dict.fromkeys([*left.not_driven(), *right.not_driven()])
        gaps = [f"inputs that keep their values: {', '.join(kept)}"] if kept else []
        self.gap = "; ".join(filter(None, [*gaps, "" if outputs is not None else self._not_compared(lonely)]))
        told = {path.casefold() for path, _, _ in steps}
        self.uncompared = lonely
        self.uncompared += [f"{path}.X" for path in left.steps if path.casefold() not in told]

    def _not_compared(self, lonely: Sequence[str]) -> str:
        """Return the variables written and not compared though it can be seen from outside, in words.

        `lonely`: outputs that only the first has.
        """
        own = _names_of_one_tool(self.left, self.right)
        is_whole = self.left.subject.name == self.left.subject.pou.name  # else the POU has texts that are not executed
        written = [
            each
            for each in lonely
            if each not in self.left.large
            and each.upper().rpartition(".")[2] not in own
            and (is_whole or self.left.variables[each].direction == "output")
            and self.left.writes(each)
        ]
        if written:
            return f"only the first has {', '.join(written)}"
        theirs = {path.casefold() for path in self.right.large}
        large = [path for path in self.left.large if path.casefold() in theirs]
        large = [path for path in large if self.left.writes(path) or self.right.writes(path)]
        if large:
            return f"arrays of more than {MOST_ELEMENTS} elements are not compared: {', '.join(large)}"
        is_written = self.left.calls_blocks or self.right.calls_blocks
        is_written |= any(
            each.bit or system.writes(each.path)
            for pair in self.pairs
            for system, each in zip((self.left, self.right), pair, strict=True)
        )
        if is_written or not (self.left.writes_anything or self.right.writes_anything):
            return ""
        return "nothing of what they write is compared"

    def vary(self, seed: int) -> None:
        """Have other results of unknown functions and blocks in runs."""
        self.left.unknown_calls.seed = self.right.unknown_calls.seed = seed

    def without_impossible(self, found: Explored, rows: Sequence[Mapping[str, Any]]) -> Explored:
        """Return the result of a search, without a difference that unknown functions and blocks do not show.

        In a search a function may have another result in each scan.
        """
        for seed in range(_SEEDS):
            self.vary(seed)
            length = self.first_difference(rows)
            if length is not None:
                assert found.inputs is not None  # noqa: S101  # the caller knows
                return replace(found, inputs=found.inputs[:length], shortest=False)
        names = ", ".join(self.unknown)
        return replace(
            found, inputs=None, reason=f"results of {names} may tell them apart, but none that was tried does"
        )

    def _runs(
        self, rows: Iterable[Mapping[str, Any]], skipped: Sequence[int] | None = None
    ) -> Iterator[tuple[SfcError | None, SfcError | None]]:
        """Run both from the start; the errors of each scan, after which the systems can be looked at.

        `skipped`: how many scans go by before each, with the same inputs, in which only clocks go on.
        """
        self.left.reset()
        self.right.reset()
        for scan, row in enumerate(rows):
            if skipped is not None and skipped[scan]:
                for side in (self.left, self.right):
                    side.pass_time(skipped[scan])
            yield tuple(failure_of(each, row.__getitem__, first=scan == 0) for each in (self.left, self.right))  # type: ignore[misc]

    def first_difference(
        self, rows: Sequence[Mapping[str, Any]], skipped: Sequence[int] | None = None, look: Look = never
    ) -> int | None:
        """Return how many rows it takes to a difference; None where there is none, or `look` ends it."""
        for scan, failures in enumerate(self._runs(rows, skipped)):
            if end_of(failures) is not None or look(scan):
                return None
            if any(failures):
                return scan + 1
            if compare(self.left.observed(), self.right.observed()):
                return scan + 1
        return None

    def shrunk(
        self, rows: Sequence[Mapping[str, Value]], signals: Mapping[str, Signal], look: Look = never
    ) -> list[Mapping[str, Value]]:
        """Fewer scans and fewer inputs that still show a difference: what is not needed is left out, one by one."""
        best = list(rows)
        budget = min(_SHRINKING_RUNS, _SHRINKING_SCANS // (len(best) or 1))

        def attempt(candidate: list[Mapping[str, Value]]) -> bool:
            nonlocal best, budget
            if budget <= 0 or look(0):
                return False
            budget -= 1
            length = self.first_difference(candidate, look=look)
            if length is None:
                return False
            best = candidate[:length]
            return True

        size = max(len(best) // 2, 1)
        while size:
            start = 0
            while start < len(best):
                if not attempt(best[:start] + best[start + size :]):
                    start += size
            size //= 2
        for name, signal in signals.items():
            attempt([{**row, name: signal.default} for row in best])
        return best

    def show(
        self,
        inputs: Sequence[Mapping[str, Value]],
        signals: Mapping[str, Signal],
        skipped: Sequence[int] | None = None,
        *,
        shortest: bool,
    ) -> Counterexample:
        """Return the run of both with these inputs; those that are not given stay as they are."""
        rows = filled(inputs, signals)
        shown = self._shown(inputs, signals)
        traces = [self._trace(system, shown, signals) for system in (self.left, self.right)]
        differences: list[Difference] = []
        before: list[tuple[tuple[Value, ...], int]] = [((), 0), ((), 0)]
        for place, (row, failures) in enumerate(zip(rows, self._runs(rows, skipped), strict=True)):
            given = tuple(row[name] for name in shown)
            for side, (system, trace) in enumerate(zip((self.left, self.right), traces, strict=True)):
                if skipped is not None and skipped[place]:
                    trace.record((*given, *before[side][0]), before[side][1], scans=skipped[place])
                before[side] = tuple(map(plain, system.observed_now())), system.marking() if trace.steps else 0
                trace.record((*given, *before[side][0]), before[side][1])
            if any(failures):
                differences = [
                    Difference("", None, None, f"only the {which} fails: {failure}")
                    for which, failure in zip(("first", "second"), failures, strict=True)
                    if failure is not None
                ]
                continue
            values = self.left.observed(), self.right.observed()
            if values[0] is not None and values[1] is not None:
                differences = [self._difference(i, values[0][i], values[1][i], traces[0]) for i in compare(*values)]
        given_rows = [{name: row[name] for name in shown} for row in rows]
        counts = [1 + count for count in skipped] if skipped is not None else [1] * len(rows)
        held = tuple(chain.from_iterable(map(repeat, given_rows, counts)))
        return Counterexample(held, tuple(differences), traces[0], traces[1], shortest)

    def joined(self) -> Joined | None:
        """Return both as they are run where they are not compared scan by scan."""
        if self._delay.settled:
            return Settled(self.left, self.right, to_rest=self._delay.in_sequence)
        return InTurn(self.left, self.right) if self._delay.in_sequence else None

    def show_joined(
        self, joined: Joined, inputs: Sequence[Mapping[str, Value]], signals: Mapping[str, Signal], *, shortest: bool
    ) -> Counterexample:
        """Return the run of both side by side, as `joined` runs them."""
        shown = self._shown(inputs, signals)
        sides = joined.sides
        traces = [self._trace(system, shown, signals) for system in (self.left, self.right)]
        seen: list[tuple[dict[str, Value], list[tuple[tuple[Value, ...], int]]]] = []
        ends: ScanEnd | None = None

        def look() -> None:
            pairs = zip((self.left, self.right), traces, strict=True)
            now = [
                (tuple(map(plain, each.observed_now())), each.marking() if trace.steps else 0) for each, trace in pairs
            ]
            seen.append(({name: row[name] for name in shown}, now))

        for side in sides:
            side.reset()
        for place, row in enumerate(filled(inputs, signals)):
            ends = joined.run(*sides, row.__getitem__, first=not place, look=look)
            if not ends.is_different and joined.unseen:
                del seen[-joined.unseen :]
        for held, now in seen:
            for (values, marking), trace in zip(now, traces, strict=True):
                trace.record((*held.values(), *values), marking)
        assert ends is not None and ends.is_different  # noqa: S101,PT018  # the search has found it so
        differences = [self._difference(place, one, other, traces[0]) for place, one, other in joined.differing()]
        if ends.failure is not None:
            differences = [Difference("", None, None, ends.note)]
        return Counterexample(tuple(held for held, _ in seen), tuple(differences), traces[0], traces[1], shortest)

    def _shown(self, inputs: Sequence[Mapping[str, Value]], signals: Mapping[str, Signal]) -> list[str]:
        """Return the inputs that a table shows: those that were read, and are not what is compared as well."""
        read = {name for row in inputs for name in row}
        compared = {name.casefold() for name in self.names}  # ``Fill.x`` may be an input of one and a step of the other
        return [name for name in signals if name in read and name.casefold() not in compared]

    def _difference(self, place: int, left: Any, right: Any, trace: Trace) -> Difference:
        name, delay = self.names[place], self._delay.queued
        signal = trace[name].signal if name in trace else None
        return Difference(name, plain(left), plain(right), delay=delay, signal=signal)

    def _trace(self, system: ProgramSystem, shown: Iterable[str], signals: Mapping[str, Signal]) -> Trace:
        columns = [Column(name, signals[name], "input") for name in shown]
        columns += [Column(n, s, "output") for n, s in zip(self.names, self.signals, strict=True)]
        return Trace(columns, scan_time=system.clock.scan_time, steps=system.chart_steps, name=system.subject.name)


def _named_pairs(
    left: ProgramSystem, right: ProgramSystem, outputs: Iterable[str] | Mapping[str, str]
) -> list[tuple[str, Signal, str]]:
    """Return the variables that a user wants to compare: name and signal on the left, name on the right."""
    mine, theirs = (
        {known: name for name in system.variables for known in (system.local_name(name), name.casefold())}
        for system in (left, right)
    )
    pairs = outputs.items() if isinstance(outputs, Mapping) else ((name, name) for name in outputs)
    found = []
    for own, other in pairs:
        for which, system, names, name in (("first", left, mine, own), ("second", right, theirs, other)):
            if name.casefold() not in names:
                known = ", ".join([each for each, var in system.variables.items() if not var.is_input][:20])
                raise ModelError(f"the {which} has no variable {name!r}", hint=f"It has: {known}")
        name = mine[own.casefold()]
        found.append((name, left.variables[name].signal, theirs[other.casefold()]))
    return found


def filled(inputs: Sequence[Mapping[str, Value]], signals: Mapping[str, Signal]) -> list[dict[str, Value]]:
    """Return a value for every input in every scan: what is not given stays as it was."""
    row = {name: signal.default for name, signal in signals.items()}
    rows = []
    for given in inputs:
        row = {**row, **given}
        rows.append(row)
    return rows


def operating_names(profile: Profile) -> set[str]:
    """Return the variables by which a tool lets people operate a chart, and tells them what it does, in upper case."""
    names = {flag.variable.upper() for flag in profile.flags}
    return names | set(PARAMETERS) if profile.graph_parameters else names
