"""Whether a chart and a program, two charts, or two programs do the same: proven, tried, or shown to be different.

First all that both can do together is searched (`plcopen_sfc.analysis.product`), with every value of every input that
is read: that is a proof, or gives the shortest input trace that shows a difference. Where there are too many states, or
a program does with a number what no few values stand for, both are run on directed and random inputs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from plcopen_sfc.analysis.clocking import clocking
from plcopen_sfc.analysis.dividing import divide, race
from plcopen_sfc.analysis.domains import Domain, plain
from plcopen_sfc.analysis.product import Explored, Search, compare, end_of, failure_of, search
from plcopen_sfc.analysis.stimuli import stimuli
from plcopen_sfc.analysis.systems import Observation, ProgramSystem, connect, step_observations
from plcopen_sfc.analysis.terms import explore_terms
from plcopen_sfc.errors import ModelError, SfcError
from plcopen_sfc.languages.st.literals import time_literal
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.semantics.profile import Profile, default_profile
from plcopen_sfc.semantics.profile import profile as profile_named
from plcopen_sfc.semantics.signals import Signal, Value
from plcopen_sfc.semantics.simulation import nanoseconds
from plcopen_sfc.semantics.subjects import Subject, resolve
from plcopen_sfc.semantics.trace import Column, Trace

__all__ = ["Counterexample", "Difference", "Outcome", "Verdict", "equivalent"]

Comparable = SfcNetwork | Pou | Project | Subject
_SHRINKING_RUNS = 500
_OUTPUTS = frozenset({"output", "external"})


class Outcome(StrEnum):
    """What a comparison came to."""

    PROVEN = "equal (proof)"
    TESTED = "equal on random runs"
    DIFFERENT = "different"


@dataclass(frozen=True)
class Difference:
    """Something that has different values; `error` where one side ends with an error there."""

    name: str
    left: Value | None
    right: Value | None
    error: str = ""

    def __str__(self) -> str:
        if self.error:
            return self.error
        return f"{self.name} is {_shown(self.left)} in the first and {_shown(self.right)} in the second"


@dataclass(frozen=True)
class Counterexample:
    """Inputs that show a difference, scan by scan, and what both sides do with them.

    `shortest`: no shorter sequence of inputs shows any. The traces hold the inputs and what was compared.
    """

    inputs: tuple[Mapping[str, Value], ...]
    differences: tuple[Difference, ...]
    left: Trace
    right: Trace
    shortest: bool

    def __str__(self) -> str:
        """The differences, and a table of the inputs and of what differs in the end."""
        names = [name for name in dict.fromkeys(n for row in self.inputs for n in row) if name in self.left]
        differing = [d.name for d in self.differences if d.name in self.left]
        sides = (("first", self.left), ("second", self.right))
        headers = ["scan", "time", *names]
        for side, trace in sides:
            headers += [f"{side}: active"] * bool(trace.steps) + [f"{side}: {name}" for name in differing]
        rows = [headers]
        for scan in range(len(self.left)):
            row = [str(scan), time_literal(self.left.time(scan)).removeprefix("T#")]
            row += [self.left[name].signal.text(self.left[name][scan]) for name in names]
            for _, trace in sides:
                row += [" ".join(trace.active(scan)) or "-"] * bool(trace.steps)
                row += [trace[name].signal.text(trace[name][scan]) for name in differing]
            rows.append(row)
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        lines = ["  ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)).rstrip() for row in rows]
        return "\n".join([*(str(each) for each in self.differences), *lines])

    def as_dict(self) -> dict[str, Any]:
        """The counterexample as plain data, for JSON."""
        return {
            "inputs": [dict(row) for row in self.inputs],
            "shortest": self.shortest,
            "differences": [
                {"name": d.name, "left": d.left, "right": d.right} | ({"error": d.error} if d.error else {})
                for d in self.differences
            ],
            "left": self.left.as_dict(),
            "right": self.right.as_dict(),
        }


@dataclass(frozen=True)
class Verdict:
    """The result of a comparison, and what it stands on.

    `compared`: what was compared, by the names of the first; `uncompared`: what only one side has and so could not be.
    `states`: the pairs of states that were searched, with all input sequences of `depth` scans; `parts`: in how many
    searches of what does not depend on each other. `runs` of `scans` scans were made with directed and random inputs.
    `scan_time` (nanoseconds): what is said of times holds for it. `reason`: why there is no proof. `notes`: what was
    left out of the search.
    """

    outcome: Outcome
    compared: tuple[str, ...]
    uncompared: tuple[str, ...]
    inputs: tuple[str, ...]
    states: int
    depth: int
    runs: int
    scans: int
    scan_time: int
    timed: bool
    profile: str
    reason: str = ""
    counterexample: Counterexample | None = None
    notes: tuple[str, ...] = ()
    parts: int = 1

    @property
    def equal(self) -> bool:
        """Whether no difference was found."""
        return self.outcome is not Outcome.DIFFERENT

    @property
    def proven(self) -> bool:
        """Whether there is none, whatever the inputs are."""
        return self.outcome is Outcome.PROVEN

    def __str__(self) -> str:
        """One line, and for a difference the inputs that show it."""
        times = f", scan time {time_literal(self.scan_time)}" if self.timed else ""
        if self.counterexample is not None:
            count = len(self.counterexample.inputs)
            how = "shortest input trace" if self.counterexample.shortest else "an input trace"
            return f"different after {count} scan{'' if count == 1 else 's'} ({how}{times})\n{self.counterexample}"
        if self.proven:
            left_out = "".join(f"; {note}" for note in self.notes)
            parts = f" in {self.parts} parts" if self.parts > 1 else ""
            return f"equal (proof: {self.states} states{parts}, all inputs{times}{left_out})"
        tried = f", all inputs tried for {self.depth} scans" if self.depth else ""
        return f"equal on {self.runs} random runs of {self.scans} scans{times} (no proof: {self.reason}{tried})"

    def as_dict(self) -> dict[str, Any]:
        """The verdict as plain data, for JSON."""
        data: dict[str, Any] = {
            "outcome": self.outcome.value,
            "equal": self.equal,
            "proven": self.proven,
            "profile": self.profile,
            "scan_time_ns": self.scan_time,
            "timed": self.timed,
            "states": self.states,
            "depth": self.depth,
            "parts": self.parts,
            "runs": self.runs,
            "scans": self.scans,
            "inputs": list(self.inputs),
            "compared": list(self.compared),
            "uncompared": list(self.uncompared),
        }
        if self.reason:
            data["reason"] = self.reason
        if self.notes:
            data["notes"] = list(self.notes)
        return data | ({} if self.counterexample is None else {"counterexample": self.counterexample.as_dict()})


def equivalent(
    a: Comparable,
    b: Comparable,
    profile: str | Profile | None = None,
    *,
    outputs: Iterable[str] | Mapping[str, str] | None = None,
    step_flags: Mapping[str, str] | None = None,
    inputs: Mapping[str, str] | None = None,
    fixed: Mapping[str, Value] | None = None,
    left_out: str | None = None,
    cap: int = 100_000,
    runs: int = 100,
    scans: int = 200,
    seed: int = 0,
    scan_time: str | int | None = None,
    functions: Mapping[str, Callable[..., Any]] | None = None,
) -> Verdict:
    """Compare what two charts or programs do, scan by scan, with the same inputs.

    `outputs`: the variables to compare (by their names in `a`, or a mapping from these to those in `b`); without it all
    single values that both have under the same name and that are no inputs. `step_flags`: by the path of a step of `a`
    the variable of `b` that tells that it is active (``X2``), or what it must equal (``s = 2``); without it flags with
    usual names are recognised, and steps of the same path in two charts. `inputs`: by their names in `b` those of
    inputs in `a` where they differ. `fixed`: inputs that keep a value, by their names in either. `left_out`: a
    variable of `b`; scans that end with its value TRUE are not compared, nor what follows them. `cap`: the most states
    of the search; `runs` of `scans` scans are tried where that ends without an answer. `scan_time`: without it one for
    which all durations of the programs end exactly in a scan.

    The same arguments always give the same verdict. Raises `ModelError` where there is nothing to compare or an input
    has two types.
    """
    subjects = [each if isinstance(each, Subject) else resolve(each) for each in (a, b)]
    chosen = default_profile(subjects[0].project) if profile is None else profile_named(profile)
    clock = clocking(subjects, nanoseconds(scan_time) if scan_time is not None else None)
    left, right = (ProgramSystem(subject, chosen, clock, functions=functions) for subject in subjects)
    if left_out is not None:
        right.leave_out(left_out)
    comparison = _Comparison(left, right, outputs, step_flags)
    signals = connect(left, right, inputs or {}, fixed or {})
    domains = {name: Domain(name, signal) for name, signal in signals.items()}

    def build(
        one: Pou, other: Pou, pairs: Sequence[tuple[Observation, Observation]]
    ) -> tuple[ProgramSystem, ProgramSystem, Mapping[str, Domain]]:
        parts = [
            system.part(pou, [pair[side] for pair in pairs])
            for side, (system, pou) in enumerate(((left, one), (right, other)))
        ]
        own = connect(parts[0], parts[1], inputs or {}, fixed or {})
        return parts[0], parts[1], {name: Domain(name, signal) for name, signal in own.items()}

    def divided() -> Search | None:
        division = divide(left, right, comparison.pairs)
        return division.search(build, cap) if division is not None else None

    def accepted(shown: Explored) -> bool:
        rows = filled(shown.inputs or [], signals)
        return comparison.first_difference(rows) == len(rows)

    found = Explored(0, 0, complete=False, reason=clock.reason)
    if not clock.reason:
        found = race(search(left, right, domains, cap), left.size + right.size, divided, accepted)
    if not clock.reason and not found.complete and found.inputs is None:
        found = explore_terms(left, right, signals, cap) or found
    counterexample = None
    runs_made = 0
    if found.inputs is not None:
        counterexample = comparison.show(found.inputs, signals, shortest=found.shortest)
    elif not found.complete:
        for rows in stimuli(signals, domains, clock, seed=seed, runs=runs, scans=scans):
            runs_made += 1
            length = comparison.first_difference(rows)
            if length is not None:
                shrunk = _shrunk(rows[:length], signals, comparison)
                counterexample = comparison.show(shrunk, signals, shortest=False)
                break
    outcome = Outcome.DIFFERENT if counterexample is not None else Outcome.PROVEN if found.complete else Outcome.TESTED
    reason = found.reason
    if reason and None in (left.times.limit, right.times.limit) and found.states >= cap:
        reason += "; elapsed times of steps are used otherwise than in comparisons with constants"
    return Verdict(
        outcome,
        tuple(comparison.names),
        tuple(comparison.uncompared),
        tuple(signals),
        found.states,
        found.depth,
        runs_made,
        scans if runs_made else 0,
        clock.scan_time,
        bool(clock.constants),
        chosen.name,
        reason,
        counterexample,
        found.notes,
        found.parts,
    )


class _Comparison:
    """Two systems and what of them is compared."""

    def __init__(
        self,
        left: ProgramSystem,
        right: ProgramSystem,
        outputs: Iterable[str] | Mapping[str, str] | None,
        step_flags: Mapping[str, str] | None,
    ) -> None:
        self.left = left
        self.right = right
        pairs = _outputs(left, right, outputs)
        steps = step_observations(left, right, step_flags)
        self.names = [name for name, _, _ in pairs] + [f"{path}.X" for path, _, _ in steps]
        self.signals = [signal for _, signal, _ in pairs] + [Signal.elementary("BOOL")] * len(steps)
        if not self.names:
            hint = "Name variables of both with outputs=, or flags of steps with step_flags=."
            raise ModelError("the two have nothing in common that could be compared", hint=hint)
        self.pairs = [(Observation(name), Observation(other)) for name, _, other in pairs]
        self.pairs += [(own, other) for _, own, other in steps]
        left.observe([own for own, _ in self.pairs])
        right.observe([other for _, other in self.pairs])
        compared = {name.casefold() for name in self.names}
        told = {path.casefold() for path, _, _ in steps}
        self.uncompared = [
            name
            for name, each in left.variables.items()
            if each.direction in _OUTPUTS and name.casefold() not in compared
        ]
        self.uncompared += [f"{path}.X" for path in left.steps if path.casefold() not in told]

    def _runs(self, rows: Iterable[Mapping[str, Any]]) -> Iterator[tuple[SfcError | None, SfcError | None]]:
        """Run both from the start; the errors of each scan, after which the systems can be looked at."""
        self.left.reset()
        self.right.reset()
        for scan, row in enumerate(rows):
            yield tuple(failure_of(each, row.__getitem__, first=scan == 0) for each in (self.left, self.right))  # type: ignore[misc]

    def first_difference(self, rows: Sequence[Mapping[str, Any]]) -> int | None:
        """How many scans it takes to a difference; None where there is none."""
        for scan, failures in enumerate(self._runs(rows)):
            if end_of(failures) is not None:
                return None
            if any(failures):
                return scan + 1
            if compare(self.left.observed(), self.right.observed()):
                return scan + 1
        return None

    def show(
        self, inputs: Sequence[Mapping[str, Value]], signals: Mapping[str, Signal], *, shortest: bool
    ) -> Counterexample:
        """What both do with these inputs; those that are not given stay as they are."""
        rows = filled(inputs, signals)
        read = {name for row in inputs for name in row}
        shown = [name for name in signals if name in read]
        traces = [self._trace(system, shown, signals) for system in (self.left, self.right)]
        differences: list[Difference] = []
        for row, failures in zip(rows, self._runs(rows), strict=True):
            given = tuple(row[name] for name in shown)
            for system, trace in zip((self.left, self.right), traces, strict=True):
                marking = system.marking() if trace.steps else 0
                trace.record((*given, *map(plain, system.observed())), marking)
            if any(failures):
                differences = [
                    Difference("", None, None, f"only the {which} fails: {failure}")
                    for which, failure in zip(("first", "second"), failures, strict=True)
                    if failure is not None
                ]
                continue
            values = self.left.observed(), self.right.observed()
            differences = [Difference(self.names[i], values[0][i], values[1][i]) for i in compare(*values)]
        given_rows = tuple({name: row[name] for name in shown} for row in rows)
        return Counterexample(given_rows, tuple(differences), traces[0], traces[1], shortest)

    def _trace(self, system: ProgramSystem, shown: Iterable[str], signals: Mapping[str, Signal]) -> Trace:
        columns = [Column(name, signals[name], "input") for name in shown]
        columns += [Column(n, s, "output") for n, s in zip(self.names, self.signals, strict=True)]
        return Trace(columns, scan_time=system.clock.scan_time, steps=system.steps, name=system.subject.name)


def _outputs(
    left: ProgramSystem, right: ProgramSystem, outputs: Iterable[str] | Mapping[str, str] | None
) -> list[tuple[str, Signal, str]]:
    """The variables to compare: name and signal on the left, name on the right."""
    mine, theirs = ({name.casefold(): name for name in system.variables} for system in (left, right))
    if outputs is None:
        return [
            (name, left.variables[name].signal, theirs[key])
            for key, name in mine.items()
            if key in theirs and not left.variables[name].is_input and not right.variables[theirs[key]].is_input
        ]
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
    """A value for every input in every scan: what is not given stays as it was."""
    row = {name: signal.default for name, signal in signals.items()}
    rows = []
    for given in inputs:
        row = {**row, **given}
        rows.append(row)
    return rows


def _shrunk(
    rows: Sequence[Mapping[str, Value]], signals: Mapping[str, Signal], comparison: _Comparison
) -> list[Mapping[str, Value]]:
    """Fewer scans and fewer inputs that still show a difference: what is not needed is left out, one after another."""
    best = list(rows)
    budget = _SHRINKING_RUNS

    def attempt(candidate: list[Mapping[str, Value]]) -> bool:
        nonlocal best, budget
        if budget <= 0:
            return False
        budget -= 1
        length = comparison.first_difference(candidate)
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


def _shown(value: Value | None) -> str:
    return {True: "TRUE", False: "FALSE"}[value] if isinstance(value, bool) else str(value)
