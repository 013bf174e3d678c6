"""Whether a chart and a program, two charts, or two programs do the same: proven, tried, or shown to be different.

First all that both can do together is searched (`plcopen_sfc.analysis.product`), with every value of every input that
is read: that is a proof, or gives the shortest input trace that shows a difference. Where there are too many states, or
a program does with a number what no few values stand for, both are run on directed and random inputs.

Each side may run as another tool runs it, and one of them may be later by a constant number of scans
(`plcopen_sfc.analysis.delay`). Compared is what variables and steps are at the end of scans: in which order they were
written in the scan makes no difference.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property
from time import monotonic
from typing import Any, NamedTuple, Protocol, TypedDict

from plcopen_sfc.analysis.clocking import Clocking, clocking
from plcopen_sfc.analysis.coverage import Coverage, Tally
from plcopen_sfc.analysis.delay import NO_DELAY, Delay, delays, retimed
from plcopen_sfc.analysis.directed import DirectedSearch
from plcopen_sfc.analysis.dividing import divide, race
from plcopen_sfc.analysis.domains import Domain, plain
from plcopen_sfc.analysis.limits import INTERRUPTED, SearchProgress, Watch, seconds
from plcopen_sfc.analysis.product import BOTH_FAIL, Explored, Search, compare, end_of, failure_of, search
from plcopen_sfc.analysis.stimuli import stimuli
from plcopen_sfc.analysis.systems import Observation, ProgramSystem, connect, step_observations
from plcopen_sfc.analysis.terms import explore_terms
from plcopen_sfc.errors import ModelError, SfcError
from plcopen_sfc.languages.st.literals import time_literal
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.semantics.charts.graph.parameters import PARAMETERS
from plcopen_sfc.semantics.drawn import as_executed
from plcopen_sfc.semantics.profile import Profile, ScanOrder, default_profile
from plcopen_sfc.semantics.profile import profile as profile_named
from plcopen_sfc.semantics.programs.library import ALL_FREE
from plcopen_sfc.semantics.signals import Signal, Value
from plcopen_sfc.semantics.simulation import nanoseconds
from plcopen_sfc.semantics.subjects import Subject, resolve
from plcopen_sfc.semantics.trace import Column, Trace

__all__ = ["Counterexample", "Difference", "Searching", "Verdict", "VerdictKind", "equivalent"]


class Code(Protocol):
    """Code of a chart, such as a `LoweredPou`: a POU in its project, and what its comparison with the chart needs."""

    @property
    def project(self) -> Project:
        """The project with the code."""

    @property
    def name(self) -> str:
        """Where the code is in the project: ``Main``, ``Main.Fill``."""

    @property
    def profile(self) -> Profile:
        """How the chart is executed."""

    @property
    def step_flags(self) -> Mapping[str, str]:
        """The variables that tell of steps, by the paths of the steps."""

    @property
    def at_rest(self) -> Mapping[str, bool]:
        """Values that inputs keep which only the code has."""

    @property
    def left_out(self) -> str | None:
        """A variable of the code: scans that end with its value TRUE are not compared."""


Comparable = SfcNetwork | Pou | Project | Subject
_CALLS = "calls of unknown blocks"
_SHRINKING_RUNS = 500
_VARIANTS = 4
"""Results of unknown functions with which directed searches are made."""

_SEEDS = 64
"""Results of unknown functions that are tried with the inputs of a difference."""

_QUICK_RUNS, _QUICK_SCANS = 12, 60
"""What each of several delays is tried with before it is searched whether it fits."""

_OUTPUTS = frozenset({"output", "external"})


class Searching(TypedDict, total=False):
    """What a user may want of the search of a comparison; see `equivalent`."""

    free_inputs: Iterable[str] | str
    limit: float | str | None
    progress: Callable[[SearchProgress], None] | None


class VerdictKind(StrEnum):
    """What a comparison came to."""

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

    def __str__(self) -> str:
        if self.error:
            return self.error
        before = f" {abs(self.delay)} scan{'' if abs(self.delay) == 1 else 's'} before"
        sides = before if self.delay > 0 else "", before if self.delay < 0 else ""
        left, right = _shown(self.left), _shown(self.right)
        return f"{self.name} is {left} in the first{sides[0]} and {right} in the second{sides[1]}"


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
    left out of the search. `coverage`: what was executed of the first and of the second, and what was not. `frozen`:
    variables that nothing writes and that are declared as no inputs, so that they kept their values. `delay`: by how
    many scans the second is later in all that was compared, and how that was compared; `delay_notes` say it.
    `unknown`: functions and blocks that are called and that the file does not contain; see `equivalent`.
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

    @property
    def equal(self) -> bool:
        """Whether no difference was found, and all that can be reached was compared."""
        return self.kind in (VerdictKind.PROVEN, VerdictKind.TESTED)

    @property
    def different(self) -> bool:
        """Whether a difference was found."""
        return self.kind is VerdictKind.DIFFERENT

    def joined(self, other: Verdict) -> Verdict:
        """The same with what another search of the same two has reached, in which some inputs were at rest."""
        coverage = tuple(mine.joined(theirs) for mine, theirs in zip(self.coverage, other.coverage, strict=True))
        kind = self.kind
        if kind is VerdictKind.UNTESTED and not self.interrupted and not _untested(coverage):
            kind = VerdictKind.TESTED
        return replace(self, kind=kind, coverage=coverage)

    @property
    def proven(self) -> bool:
        """Whether there is none, whatever the inputs are."""
        return self.kind is VerdictKind.PROVEN

    def __str__(self) -> str:
        """One line, then what was executed; for a difference the inputs that show it."""
        times = f", scan time {time_literal(self.scan_time)}" if self.timed else ""
        later = f", {self.delay}" if self.delay.scans else ""
        if self.counterexample is not None:
            count = len(self.counterexample.inputs)
            how = "shortest input trace" if self.counterexample.shortest else "an input trace"
            how += f", compared with the {self.delay}" if self.delay.scans else ""
            head = f"different after {count} scan{'' if count == 1 else 's'} ({how}{times})"
            return "\n".join([head, str(self.counterexample), *self._unknown()])
        if self.proven:
            left_out = "".join(f"; {note}" for note in (*self.notes, *self.delay_notes))
            parts = f" in {self.parts} parts" if self.parts > 1 else ""
            head = f"equal{later} (proof: {self.states} states{parts}, all inputs{times}{left_out})"
        else:
            tried = f", all inputs tried for {self.depth} scans" if self.depth and self.runs else ""
            tried += "".join(f"; {note}" for note in self.delay_notes)
            run = f"{self.runs} directed runs, {self.scans} scans" if self.runs else f"{self.states} states"
            missed = "not all was reached, " if self.kind is VerdictKind.UNTESTED else ""
            head = f"{missed}equal{later} in {run}{times} (no proof: {self.reason}{tried})"
        return "\n".join([head, *self._covered()])

    def _unknown(self) -> Iterator[str]:
        if self.unknown:
            yield f"unknown, taken as functions of what they are given: {', '.join(self.unknown)}"

    def _covered(self) -> Iterator[str]:
        """What was executed, in lines."""
        has_chart = any(each.has_chart for each in self.coverage)
        if self.coverage:
            yield "covered: " + "; ".join(map(str, self.coverage))
        for each in self.coverage:
            if each.has_chart or not has_chart:  # what is not reached of its code follows from the chart
                yield from each.lines()
        yield from self._unknown()
        if self.frozen:
            yield f"frozen, because nothing writes them and they are declared as no inputs: {', '.join(self.frozen)}"

    def as_dict(self) -> dict[str, Any]:
        """The verdict as plain data, for JSON."""
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
        if self.notes:
            data["notes"] = list(self.notes)
        return data | ({} if self.counterexample is None else {"counterexample": self.counterexample.as_dict()})


def equivalent(
    a: Comparable | Code,
    b: Comparable | Code,
    profile: str | Profile | tuple[str | Profile, str | Profile] | None = None,
    *,
    delay: int | str | Delay | Iterable[int] = 0,
    outputs: Iterable[str] | Mapping[str, str] | None = None,
    step_flags: Mapping[str, str] | None = None,
    inputs: Mapping[str, str] | None = None,
    fixed: Mapping[str, Value] | None = None,
    free_inputs: Iterable[str] | str = (),
    left_out: str | None = None,
    cap: int = 100_000,
    runs: int = 100,
    scans: int = 200,
    seed: int = 0,
    scan_time: str | int | None = None,
    functions: Mapping[str, Callable[..., Any]] | None = None,
    limit: float | str | None = None,
    progress: Callable[[SearchProgress], None] | None = None,
) -> Verdict:
    """Compare what two charts or programs do, scan by scan, with the same inputs.

    `profile`: how both are executed, or each of them: ``("s7graph", "codesys")``; without it both as the first.
    `delay`: by how many scans `b` may be later in all that is compared (less than 0: `a`), a number, several of which
    the smallest with a proof is taken, else the smallest with the best verdict, or ``"auto"`` for -2 to 2; the verdict
    says which it is, and how the start and times are compared then.

    `outputs`: the variables to compare (by their names in `a`, or a mapping from these to those in `b`); without it all
    single values that both have under the same name and that are no inputs, also those in structures and in instances
    of the project's own function blocks, but of two tools not what only one of them writes or reads (``SFCTrans``,
    ``S_NO``). `step_flags`: by the path of a step of `a` the variable of `b` that tells that it is active (``X2``),
    what it must equal (``s = 2``), or the path of a step of `b`; without it flags with usual names are recognised, and
    steps of the same path in two charts. `inputs`: by their names in `b` those of inputs in `a` where they differ.
    `fixed`: inputs that keep a value, by their names in either. `free_inputs`: variables that nothing writes and that
    are to be inputs though they are not declared so, or ``all``, but never those that tell of steps. `left_out`: a
    variable of `b`; scans that end with its value TRUE are not compared, nor what follows them. A `LoweredPou` as `b`
    brings its profile, step flags, inputs at rest and what is left out. `cap`: the most states of the search; `runs` of
    `scans` scans are tried where that ends without an answer. `scan_time`: without it one for which all durations of
    the programs end exactly in a scan.

    Functions and blocks that are called and that neither the project nor `functions` has are taken as unknown functions
    of what they are given, and of the calls before, the same in both; calls that are statements are compared.

    `limit`: seconds that it may take, or a text such as ``60s``; `progress` is told how far it is, ten times a second.
    An interruption (``KeyboardInterrupt``) ends it with what is known so far.

    The same arguments always give the same verdict, but for a limit. Raises `ModelError` where there is nothing to
    compare or an input has two types.
    """
    subjects = _subject(a), _subject(b)
    if not isinstance(b, SfcNetwork | Pou | Project | Subject):
        profile = profile or b.profile
        step_flags = step_flags if step_flags is not None else b.step_flags or None
        fixed = {**b.at_rest, **(fixed or {})}
        left_out = left_out or b.left_out
    profiles = _profiles(profile, subjects[0].project)
    subjects = as_executed(subjects[0], profiles[0]), as_executed(subjects[1], profiles[1])
    clock = clocking(subjects, nanoseconds(scan_time) if scan_time is not None else None)
    compared = _Compared(
        subjects,
        profiles,
        clock,
        outputs,
        step_flags,
        inputs or {},
        fixed or {},
        (free_inputs,) if isinstance(free_inputs, str) else tuple(free_inputs),
        left_out,
        functions or {},
    )
    compared.check_freed()
    tries = _Tries(cap, runs, scans, seed, seconds(limit), progress)
    wanted = [each for each in delays(delay, profiles) if not each.retimed or compared.can_be_retimed]
    if len(wanted) == 1:
        return compared.verdict(wanted[0], tries)
    longest: tuple[int, Delay] | None = None
    best: Verdict | None = None
    end = monotonic() + tries.limit if tries.limit is not None else None
    for each in wanted:
        if end is not None:
            tries = tries._replace(limit=end - monotonic())
            if best is not None and end <= monotonic():
                break
        length = compared.quick_difference(each, tries)
        if length is None:
            found = compared.verdict(each, tries)
            if found.proven or found.interrupted:
                return found if found.proven or best is None else best
            if not found.different:
                if best is None or (found.equal and not best.equal):
                    best = found
                continue
            assert found.counterexample is not None  # noqa: S101  # it is different
            length = len(found.counterexample.inputs)
        length -= abs(each.queued)  # scans without a counterpart
        if longest is None or length > longest[0]:
            longest = length, each
    if best is not None:
        return best
    assert longest is not None  # noqa: S101  # at least one was tried
    return compared.verdict(longest[1], tries)


def _untested(coverage: Sequence[Coverage]) -> bool:
    """Whether something that may be reachable was not reached: of a chart, where there is one."""
    charts = [each for each in coverage if each.has_chart]
    return any(each.untested for each in charts or coverage)


def _subject(given: Comparable | Code) -> Subject:
    if isinstance(given, Subject):
        return given
    return resolve(given) if isinstance(given, SfcNetwork | Pou | Project) else resolve(given.project, given.name)


def _profiles(
    given: str | Profile | tuple[str | Profile, str | Profile] | None, project: Project
) -> tuple[Profile, Profile]:
    if isinstance(given, tuple):
        return profile_named(given[0]), profile_named(given[1])
    chosen = default_profile(project) if given is None else profile_named(given)
    return chosen, chosen


def _operating(profile: Profile) -> set[str]:
    """The variables by which a tool lets people operate a chart, and tells them what it does, in upper case."""
    names = {flag.variable.upper() for flag in profile.flags}
    return names | set(PARAMETERS) if profile.graph_parameters else names


class _Tries(NamedTuple):
    """How much is tried: see `equivalent`."""

    cap: int
    runs: int
    scans: int
    seed: int
    limit: float | None
    progress: Callable[[SearchProgress], None] | None


@dataclass(frozen=True)
class _Compared:
    """What is compared, but for the delay; see `equivalent`."""

    subjects: tuple[Subject, Subject]
    profiles: tuple[Profile, Profile]
    clock: Clocking
    outputs: Iterable[str] | Mapping[str, str] | None
    step_flags: Mapping[str, str] | None
    inputs: Mapping[str, str]
    fixed: Mapping[str, Value]
    free_inputs: tuple[str, ...]
    left_out: str | None
    functions: Mapping[str, Callable[..., Any]]

    def check_freed(self) -> None:
        """Refuse names of variables that neither system can have as an input."""
        systems = self._systems(NO_DELAY) if self.free_inputs else ()
        known = {name.casefold() for system in systems for name in system.inputs}
        for name in self.free_inputs:
            if name != ALL_FREE and name.casefold() not in known:
                frozen = dict.fromkeys(each for system in systems for each in system.frozen())
                hint = f"These are: {', '.join(frozen)}" if frozen else "All variables are inputs, or are written."
                raise ModelError(f"{name!r} is no variable that nothing writes", hint=hint)

    @cached_property
    def can_be_retimed(self) -> bool:
        """Whether the scans of sides that execute actions first can be cut elsewhere."""
        left, right = self._systems(NO_DELAY)
        return all(
            system.is_retimable
            for system, profile in zip((left, right), self.profiles, strict=True)
            if profile.order is not ScanOrder.TRANSITIONS_FIRST
        )

    @cached_property
    def resting(self) -> dict[str, Value]:
        """Inputs that operate a chart in only one of two tools: they rest, but for those that are named in `inputs`."""
        own = _operating(self.profiles[0]) ^ _operating(self.profiles[1])
        if not own:
            return {}
        named = {name.upper() for pair in self.inputs.items() for name in pair}
        found = {name: signal for system in self._systems(NO_DELAY) for name, signal in system.inputs.items()}
        return {n: signal.default for n, signal in found.items() if n.upper() in own - named}

    @cached_property
    def _flags(self) -> tuple[list[str], list[str]]:
        """The variables of each side that tell of steps: no inputs, also where nothing writes them."""
        if not self.free_inputs:
            return [], []
        left, right = (
            ProgramSystem(subject, profile, self.clock, functions=self.functions)
            for subject, profile in zip(self.subjects, self.profiles, strict=True)
        )
        steps = step_observations(left, right, self.step_flags)
        return [], [other.path for _, _, other in steps if not other.bit]

    def _systems(self, delay: Delay) -> tuple[ProgramSystem, ProgramSystem]:
        profiles = [retimed(each) if delay.retimed else each for each in self.profiles]
        left, right = (
            ProgramSystem(
                *(subject, profile, self.clock),
                functions=self.functions,
                free_inputs=self.free_inputs,
                not_free=flags,
            )
            for subject, profile, flags in zip(self.subjects, profiles, self._flags, strict=True)
        )
        if self.left_out is not None:
            right.leave_out(self.left_out)
        earlier, later = (left, right) if delay.queued > 0 else (right, left)
        count = abs(delay.queued)
        earlier.delay(begins=0, kept=count)
        later.delay(begins=count if delay.late_start else 0, kept=0)
        return left, right

    def _prepared(self, delay: Delay) -> tuple[_Comparison, dict[str, Signal]]:
        left, right = self._systems(delay)
        comparison = _Comparison(left, right, self.outputs, self.step_flags, delay)
        return comparison, connect(left, right, self.inputs, {**self.resting, **self.fixed})

    def quick_difference(self, delay: Delay, tries: _Tries) -> int | None:
        """How many scans it takes to a difference in a few directed runs; None where there is none."""
        comparison, signals = self._prepared(delay)
        domains = {name: Domain(name, signal) for name, signal in signals.items()}
        rows = stimuli(signals, domains, self.clock, seed=tries.seed, runs=_QUICK_RUNS, scans=_QUICK_SCANS)
        lengths = [length for each in rows if (length := comparison.first_difference(each)) is not None]
        return min(lengths, default=None)

    def verdict(self, delay: Delay, tries: _Tries) -> Verdict:
        """Compare both with one delay."""
        comparison, signals = self._prepared(delay)
        left, right = comparison.left, comparison.right
        tallies = (Tally(left), Tally(right))
        cap, clock = tries.cap, self.clock
        watch = Watch(tries.limit, tries.progress, tallies[0].numbers)
        domains = {name: Domain(name, signal) for name, signal in signals.items()}

        def build(
            one: Pou, other: Pou, pairs: Sequence[tuple[Observation, Observation]]
        ) -> tuple[ProgramSystem, ProgramSystem, Mapping[str, Domain]]:
            parts = [
                system.part(pou, [pair[side] for pair in pairs])
                for side, (system, pou) in enumerate(((left, one), (right, other)))
            ]
            for tally, part in zip(tallies, parts, strict=True):
                tally.add(part)
            own = connect(parts[0], parts[1], self.inputs, {**self.resting, **self.fixed})
            return parts[0], parts[1], {name: Domain(name, signal) for name, signal in own.items()}

        def divided() -> Search | None:
            division = divide(left, right, comparison.pairs) if not comparison.unknown else None
            return division.search(build, cap, watch.look) if division is not None else None

        def accepted(shown: Explored) -> bool:
            rows = filled(shown.inputs or [], signals)
            return comparison.first_difference(rows) == len(rows)

        found = Explored(0, 0, complete=False, reason=clock.reason)
        if not clock.reason:
            try:
                whole = search(left, right, domains, cap)
                found = race(whole, left.size + right.size, divided, accepted, watch.look)
                if not found.complete and found.inputs is None:
                    found = explore_terms(left, right, signals, cap, watch.look) or found
            except KeyboardInterrupt:
                found = Explored(watch.states, 0, complete=False, reason=INTERRUPTED)
        watch.proving = False
        counterexample = None
        runs_made = scans_made = 0
        stopped = ""
        if found.inputs is not None and comparison.unknown:
            found = comparison.without_impossible(found, filled(found.inputs, signals))
        if found.inputs is not None:
            counterexample = comparison.show(found.inputs, signals, shortest=found.shortest)
        elif not found.complete and found.reason != INTERRUPTED:
            effort = tries.runs * tries.scans
            variants = range(_VARIANTS) if comparison.unknown else (0,)
            for variant in variants:  # of the results of unknown functions
                comparison.vary(variant)
                directed = DirectedSearch(
                    *(left, right, signals, domains, clock),
                    scans=effort // len(variants),
                    seed=tries.seed,
                    look=watch.look,
                ).run()
                runs_made, scans_made = runs_made + directed.runs, scans_made + directed.scans
                stopped = directed.stopped
                length = comparison.first_difference(directed.inputs) if directed.inputs is not None else None
                if directed.inputs is not None and length is not None:
                    shrunk = _shrunk(directed.inputs[:length], signals, comparison)
                    counterexample = comparison.show(shrunk, signals, shortest=False)
                if counterexample is not None or stopped:
                    break
        frozen = tuple(dict.fromkeys([*left.frozen(), *right.frozen()]))
        failed = next((note for note in found.notes if note.startswith(BOTH_FAIL)), "")
        coverage = tuple(tally.coverage(complete=found.complete and not frozen and not failed) for tally in tallies)
        equal = VerdictKind.PROVEN if found.complete else VerdictKind.TESTED
        reason = "; ".join(filter(None, (found.reason, stopped)))
        interrupted = reason.endswith(INTERRUPTED)
        if _untested(coverage) or (found.complete and found.dead) or interrupted:
            equal = VerdictKind.UNTESTED
            if found.complete:
                reason = f"all inputs were tried, but {failed}" if failed else f"{', '.join(frozen)} kept their values"
        if reason and None in (left.times.limit, right.times.limit) and found.states >= cap:
            reason += "; elapsed times of steps are used otherwise than in comparisons with constants"
        return Verdict(
            VerdictKind.DIFFERENT if counterexample is not None else equal,
            tuple(comparison.names),
            tuple(comparison.uncompared),
            tuple(signals),
            found.states,
            found.depth,
            runs_made,
            scans_made,
            clock.scan_time,
            bool(clock.constants),
            " and ".join(dict.fromkeys(each.name for each in self.profiles)),
            reason,
            counterexample,
            (*found.notes, *([f"{', '.join(self.resting)} at rest"] if self.resting else [])),
            found.parts,
            coverage,
            frozen,
            delay,
            delay.notes([each.order for each in self.profiles]),
            comparison.unknown,
            interrupted,
        )


class _Comparison:
    """Two systems and what of them is compared."""

    def __init__(
        self,
        left: ProgramSystem,
        right: ProgramSystem,
        outputs: Iterable[str] | Mapping[str, str] | None,
        step_flags: Mapping[str, str] | None,
        delay: Delay,
    ) -> None:
        self.left = left
        self.right = right
        self._delay = delay
        pairs = _outputs(left, right, outputs, delayed=delay.queued != 0)
        if outputs is None:
            own = _operating(left.profile) ^ _operating(right.profile)
            pairs = [each for each in pairs if each[0].upper().rpartition(".")[2] not in own]
        steps = step_observations(left, right, step_flags)
        self.names = [name for name, _, _ in pairs] + [f"{path}.X" for path, _, _ in steps]
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
            system.unknown_calls.is_delayed = delay.queued != 0
        self.unknown = tuple(dict.fromkeys([*left.unknown, *right.unknown]))
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

    def vary(self, seed: int) -> None:
        """Have other results of unknown functions and blocks in runs."""
        self.left.unknown_calls.seed = self.right.unknown_calls.seed = seed

    def without_impossible(self, found: Explored, rows: Sequence[Mapping[str, Any]]) -> Explored:
        """What a search has found, without a difference that results of unknown functions and blocks do not show.

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
        compared = {name.casefold() for name in self.names}  # ``Fill.x`` may be an input of one and a step of the other
        shown = [name for name in signals if name in read and name.casefold() not in compared]
        traces = [self._trace(system, shown, signals) for system in (self.left, self.right)]
        differences: list[Difference] = []
        for row, failures in zip(rows, self._runs(rows), strict=True):
            given = tuple(row[name] for name in shown)
            for system, trace in zip((self.left, self.right), traces, strict=True):
                marking = system.marking() if trace.steps else 0
                trace.record((*given, *map(plain, system.observed_now())), marking)
            if any(failures):
                differences = [
                    Difference("", None, None, f"only the {which} fails: {failure}")
                    for which, failure in zip(("first", "second"), failures, strict=True)
                    if failure is not None
                ]
                continue
            values = self.left.observed(), self.right.observed()
            if values[0] is not None and values[1] is not None:
                differences = [
                    Difference(self.names[i], values[0][i], values[1][i], delay=self._delay.queued)
                    for i in compare(*values)
                ]
        given_rows = tuple({name: row[name] for name in shown} for row in rows)
        return Counterexample(given_rows, tuple(differences), traces[0], traces[1], shortest)

    def _trace(self, system: ProgramSystem, shown: Iterable[str], signals: Mapping[str, Signal]) -> Trace:
        columns = [Column(name, signals[name], "input") for name in shown]
        columns += [Column(n, s, "output") for n, s in zip(self.names, self.signals, strict=True)]
        return Trace(columns, scan_time=system.clock.scan_time, steps=system.steps, name=system.subject.name)


def _outputs(
    left: ProgramSystem,
    right: ProgramSystem,
    outputs: Iterable[str] | Mapping[str, str] | None,
    *,
    delayed: bool,
) -> list[tuple[str, Signal, str]]:
    """The variables to compare: name and signal on the left, name on the right.

    `delayed`: the two see the inputs of different scans, and so do not give instances the same inputs.
    """
    mine, theirs = ({name.casefold(): name for name in system.variables} for system in (left, right))
    if outputs is None:
        found = [
            (name, left.variables[name].signal, theirs[key])
            for key, name in mine.items()
            if key in theirs and not left.variables[name].is_input and not right.variables[theirs[key]].is_input
        ]
        others = {path.casefold(): path for path in right.members}
        return found + [
            (path, member.signal, others[path.casefold()])
            for path, member in left.members.items()
            if path.casefold() in others
            and right.members[others[path.casefold()]].signal.kind is member.signal.kind
            and not (delayed and member.is_input)
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
