"""Verdict of a comparison, and the inputs that show a difference."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from html import escape
from typing import Any, NamedTuple

from plcopen_sfc.analysis.coverage import Coverage, any_untested, led_by_chart, listed
from plcopen_sfc.analysis.pairing import NO_DELAY, Delay
from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.languages.st.literals import time_literal
from plcopen_sfc.semantics.signals import Signal, SignalKind, Value
from plcopen_sfc.semantics.trace import Trace, aligned
from plcopen_sfc.whole_numbers import counted

_MOST_ROWS = 20
"""Scans of a counterexample that are all shown; of more only those in which something that is shown changes."""

_LONGEST_PATTERN = 8
"""Rows of a pattern that is shown once, however often it repeats."""

_FIRST_ROWS, _LAST_ROWS = 20, 20
"""Lines of a table that are shown where even its patterns are more."""


class VerdictKind(StrEnum):
    """Kind of a verdict."""

    PROVEN = "equal (proof)"
    TESTED = "equal in directed runs"
    UNTESTED = "equal where it was run, but not all was reached"
    DIFFERENT = "different"


@dataclass(frozen=True)
class Difference:
    """Something that has different values; `error` where one side ends with an error there.

    `delay`: the values are those of scans that are compared, that of the earlier side so many scans before.
    """

    name: str
    left: Value | None
    right: Value | None
    error: str = ""
    delay: int = 0
    signal: Signal | None = field(default=None, compare=False, repr=False)

    def __str__(self) -> str:
        if self.error:
            return self.error
        before = f" {counted(abs(self.delay), 'scan')} before"
        sides = before if self.delay > 0 else "", before if self.delay < 0 else ""
        left, right = shown_value(self.left, self.signal), shown_value(self.right, self.signal)
        return f"{self.name} is {left} in the first{sides[0]} and {right} in the second{sides[1]}"


class _Row(NamedTuple):
    """A scan of a table, and its cells; the first two are its number and its time."""

    scan: int
    cells: tuple[str, ...]


def _folded(rows: Sequence[_Row], lines: Sequence[str]) -> list[str]:
    """Return the lines of a table in which rows that follow each other in a pattern are shown once.

    Rows are the same with equal values and as many scans since the row before: nothing is hidden but the numbers of
    scans. What is then still long loses its middle, and a line tells so.
    """
    if len(lines) <= _MOST_ROWS:
        return list(lines)
    before = [0, *(row.scan for row in rows)]
    keys = [(row.scan - earlier, row.cells[2:]) for row, earlier in zip(rows, before, strict=False)]
    found: list[str] = []
    at = 0
    while at < len(keys):
        length, more = max(((n, _repetitions(keys, at, n)) for n in range(1, _LONGEST_PATTERN + 1)), key=_saved)
        found += lines[at : at + length]
        at += length * (more + 1)
        if more:
            what = "the row above" if length == 1 else f"the {length} rows above"
            found.append(f".. {what} {counted(more, 'more time')}, up to scan {rows[at - 1].scan}")
    left_out = len(found) - _FIRST_ROWS - _LAST_ROWS
    if left_out <= 1:
        return found
    return [*found[:_FIRST_ROWS], f".. {left_out} rows are not shown here", *found[-_LAST_ROWS:]]


def _repetitions(keys: Sequence[object], at: int, length: int) -> int:
    """Return how often the `length` rows at a place are repeated right behind themselves; once is no pattern."""
    end = at + length
    while end < len(keys) and keys[end] == keys[end - length]:
        end += 1
    more = (end - at) // length - 1
    return more if more * length > 1 else 0


def _saved(pattern: tuple[int, int]) -> tuple[int, int]:
    """Return how many rows a pattern saves, the shorter one first."""
    length, more = pattern
    return length * more, -length


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

    def __repr__(self) -> str:
        return f"Counterexample({len(self.inputs)} scans, {len(self.differences)} differences)"

    def __str__(self) -> str:
        """The differences, and a table of the inputs and of what differs in the end.

        Of a long one only the scans with changes; what repeats is shown once. `inputs` and `as_dict` have all scans.
        """
        names = [name for name in dict.fromkeys(n for row in self.inputs for n in row) if name in self.left]
        differing = [d.name for d in self.differences if d.name in self.left]
        sides = (("first", self.left), ("second", self.right))
        headers = ["scan", "time", *names]
        for side, trace in sides:
            headers += [f"{side}: active"] * bool(trace.steps) + [f"{side}: {name}" for name in differing]
        rows: list[_Row] = []
        for scan in self._scans_shown([*names, *differing]):
            row = [self.left[name].signal.text(self.left[name][scan]) for name in names]
            for _, trace in sides:
                row += [" ".join(trace.active(scan)) or "-"] * bool(trace.steps)
                row += [trace[name].signal.text(trace[name][scan]) for name in differing]
            rows.append(_Row(scan, (str(scan), time_literal(self.left.time(scan)).removeprefix("T#"), *row)))
        head, *lines = aligned([headers, *(row.cells for row in rows)])
        return "\n".join([*(str(each) for each in self.differences), head, *_folded(rows, lines)])

    def _scans_shown(self, names: Sequence[str]) -> Sequence[int]:
        count = len(self.left)
        if count <= _MOST_ROWS:
            return range(count)
        shown = [(trace, name) for trace in (self.left, self.right) for name in names if name in trace]
        changes = {scan for trace, name in shown for scan, _ in trace[name].runs()}
        changes |= {scan for trace in (self.left, self.right) for scan, _ in trace.situations()}
        return sorted(changes | {count - 1})

    def as_dict(self) -> dict[str, Any]:
        """Return the counterexample as plain data, for JSON."""
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
    """The result of a comparison, and its evidence.

    `compared`: what was compared, by the names of the first; `uncompared`: what only the first has and so could not be.
    `states`: the pairs of states that were searched, with all input sequences of `depth` scans; `parts`: in how many
    searches of what does not depend on each other. `runs` of `scans` scans were made with directed and random inputs.
    `scan_time` (nanoseconds): statements about times hold for it. `reason`: why there is no proof. `notes`: what was
    left out of the search. `coverage`: what was executed of the first and of the second, and what was not. `frozen`:
    variables that nothing writes and that are declared as no inputs, so that they kept their values. `delay`: by how
    many scans the second is later in all that was compared, and how that was compared; `delay_notes` describe it.
    `unknown`: functions and blocks that are called and that the file does not contain; see `equivalent`.
    `gap`: what was not compared, in words: what is written and can be seen from outside, or what follows an error of
    both.
    """

    kind: VerdictKind
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
    coverage: tuple[Coverage, ...] = ()
    frozen: tuple[str, ...] = ()
    delay: Delay = NO_DELAY
    delay_notes: tuple[str, ...] = ()
    unknown: tuple[str, ...] = ()
    interrupted: bool = False
    gap: str = ""

    @property
    def equal(self) -> bool:
        """True if no difference was found, and all that can be reached was compared."""
        return self.kind in (VerdictKind.PROVEN, VerdictKind.TESTED)

    @property
    def different(self) -> bool:
        """True if a difference was found."""
        return self.kind is VerdictKind.DIFFERENT

    def joined(self, other: Verdict) -> Verdict:
        """Return the same with what another search of the same two has reached, in which some inputs were inactive."""
        coverage = tuple(mine.joined(theirs) for mine, theirs in zip(self.coverage, other.coverage, strict=True))
        kind = self.kind
        if kind is VerdictKind.UNTESTED and not self.interrupted and not self.gap and not any_untested(coverage):
            kind = VerdictKind.TESTED
        return replace(self, kind=kind, coverage=coverage)

    @property
    def proven(self) -> bool:
        """True if there is none, whatever the inputs are."""
        return self.kind is VerdictKind.PROVEN

    @property
    def ran_nothing(self) -> bool:
        """True if neither side finished a scan, as both end with an error."""
        return not self.states and not self.scans and bool(self.gap)

    def __repr__(self) -> str:
        return f"Verdict({self.kind}: {self.states} states, {self.runs} runs, {len(self.compared)} values compared)"

    def _repr_html_(self) -> str:
        """Show the verdict in Jupyter: its text, and for a difference what both sides do."""
        found = self.counterexample
        pictures = (found.left.to_svg(), found.right.to_svg()) if found is not None else ()
        return f"<pre>{escape(str(self))}</pre>{''.join(pictures)}"

    def __str__(self) -> str:
        """The `summary` and `premises`, then what was executed; for a difference the inputs that show it."""
        shown = self._covered() if self.counterexample is None else (str(self.counterexample), *self._unknown())
        return "\n".join([self.summary, *self.premises, *shown])

    @property
    def summary(self) -> str:
        """The verdict in one short line."""
        times = f", scan time {time_literal(self.scan_time)}" if self.timed else ""
        later = f", {self.delay}" if self.delay.scans else ""
        if self.counterexample is not None:
            how = "shortest input trace" if self.counterexample.shortest else "an input trace"
            how += f", compared with the {self.delay}" if self.delay.scans else ""
            return f"different after {counted(len(self.counterexample.inputs), 'scan')} ({how}{times})"
        if self.proven:
            parts = f" in {self.parts} parts" if self.parts > 1 else ""
            return f"equal{later} (proof: {counted(self.states, 'state')}{parts}, all inputs{times})"
        run = counted(self.states, "state")
        if self.runs:
            run = f"{counted(self.runs, 'directed run')}, {counted(self.scans, 'scan')}"
        missed = ""
        if self.kind is VerdictKind.UNTESTED:
            missed = f"not all was {'compared' if self.gap else 'reached'}{self._missing()}, "
        # a search that is ended before its first scan has not seen anything that is equal
        found = f"equal{later} in {run}{times}" if self.scans or not self.runs else "no scan was run"
        if self.ran_nothing:
            found = "no scan was finished"
        return f"{missed}{found} (no proof: {self.reason.partition('; ')[0]})"

    @property
    def premises(self) -> tuple[str, ...]:
        """What the verdict rests on, in lines: further reasons why there is no proof, and how both were compared."""
        if self.counterexample is not None:  # who repeats it must know which scans were put beside each other
            return tuple(f"given: {note}" for note in self.delay_notes)
        if self.proven:
            return tuple(f"given: {note}" for note in (*self.notes, *self.delay_notes))
        _, _, more = self.reason.partition("; ")
        tried = f"all inputs tried for {counted(self.depth, 'scan')}" if self.depth and self.runs else ""
        reasons = ", ".join(filter(None, [more, tried]))
        told = [f"no proof: {reasons}"] if reasons else []
        return (*told, *(f"given: {note}" for note in self.delay_notes))

    def _unknown(self) -> Iterator[str]:
        if self.unknown:
            yield f"unknown, taken as functions of what they are given: {', '.join(self.unknown)}"

    def _missing(self) -> str:
        found = next(filter(None, (each.missing() for each in led_by_chart(self.coverage))), "")
        return f" ({found})" if found else ""

    def _covered(self) -> Iterator[str]:
        """Return the texts not executed, then how much was, in lines."""
        yield from dict.fromkeys(line for each in led_by_chart(self.coverage) for line in each.lines())
        if self.coverage:
            told = list(dict.fromkeys(map(str, self.coverage)))
            yield (
                f"covered on both sides: {told[0]}" if len(told) < len(self.coverage) else f"covered: {'; '.join(told)}"
            )
        yield from self._unknown()
        if self.uncompared:
            yield f"not compared: {listed(self.uncompared)}"
        if self.frozen:
            yield f"frozen, because nothing writes them and they are declared as no inputs: {', '.join(self.frozen)}"

    def as_dict(self) -> dict[str, Any]:
        """Return the verdict as plain data, for JSON."""
        data: dict[str, Any] = {
            "kind": self.kind.value,
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
            "coverage": [each.as_dict() for each in self.coverage],
            "frozen": list(self.frozen),
            "unknown": list(self.unknown),
            "delay": self.delay.as_dict(),
            "interrupted": self.interrupted,
        }
        if self.delay_notes:
            data["delay_notes"] = list(self.delay_notes)
        if self.reason:
            data["reason"] = self.reason
        if self.gap:
            data["gap"] = self.gap
        if self.notes:
            data["notes"] = list(self.notes)
        return data | ({} if self.counterexample is None else {"counterexample": self.counterexample.as_dict()})


def shown_value(value: Value | None, signal: Signal | None) -> str:
    """Return a value of a signal for people."""
    if isinstance(value, bool):
        return {True: "TRUE", False: "FALSE"}[value]
    if signal is None or signal.kind not in (SignalKind.DURATION, SignalKind.INTEGER) or not isinstance(value, int):
        return str(value)
    return signal.text(value)


class UntestedError(LoweringError):
    """Code that is equal to its chart where both were run, but not all that can be reached was.

    `verdict` tells what was reached. Nothing was written.
    """

    def __init__(self, message: str, *, verdict: Verdict, location: Location | None = None, hint: str = "") -> None:
        super().__init__(message, location=location, hint=hint)
        self.verdict = verdict
