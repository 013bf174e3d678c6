"""Equivalence of charts and programs: proven, tried, or refuted by inputs that show the difference.

First all that both can do together is searched (`plcopen_sfc.analysis.product`), with every value of every input that
is read: that is a proof, or gives the shortest input trace that shows a difference. Where there are too many states, or
a program uses a number in a way that no few values can represent, both run on directed and random inputs.

Each side may run as another tool runs it, and one of them may be later by a constant number of scans
(`plcopen_sfc.analysis.pairing`). Compared is what variables and steps are at the end of scans: in which order they were
written in the scan makes no difference.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any, NamedTuple, Protocol, TypedDict

from plcopen_sfc.analysis.coverage import Tally, any_untested, coverage_of
from plcopen_sfc.analysis.decomposition import divide, race
from plcopen_sfc.analysis.directed import Directed, DirectedSearch, Step
from plcopen_sfc.analysis.domains import Domain
from plcopen_sfc.analysis.number_terms import explore_terms, searches
from plcopen_sfc.analysis.pairing import (
    ASKED_FOR,
    Delay,
    connect,
    delays,
    heed_called,
    heed_instability,
    in_retiming,
    retimed,
    step_observations,
    with_commands,
)
from plcopen_sfc.analysis.product import BOTH_FAIL, Explored, Search, ended, search
from plcopen_sfc.analysis.search_limits import INTERRUPTED, SearchProgress, SearchWatch, seconds, spent
from plcopen_sfc.analysis.sequences import Joined
from plcopen_sfc.analysis.stimuli import stimuli
from plcopen_sfc.analysis.system_comparison import Comparison, filled, operating_names
from plcopen_sfc.analysis.systems import Observation, ProgramSystem
from plcopen_sfc.analysis.timers import Clocking, StepTimes, clocking, step_times
from plcopen_sfc.analysis.verdict import Counterexample, Verdict, VerdictKind
from plcopen_sfc.errors import ModelError, check_argument, check_names, listed_names
from plcopen_sfc.languages.binding.reached_pous import written_elsewhere
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.semantics.drawn_charts import as_executed
from plcopen_sfc.semantics.profile import Profile, ScanOrder, default_profile, have_equal_rules
from plcopen_sfc.semantics.profile import profile as profile_named
from plcopen_sfc.semantics.programs.runtime_types import Type
from plcopen_sfc.semantics.programs.variable_use import ALL_FREE
from plcopen_sfc.semantics.signals import Signal, SignalKind, Value
from plcopen_sfc.semantics.simulation import nanoseconds
from plcopen_sfc.semantics.subjects import Subject, resolve


class ChartCode(Protocol):
    """Code of a chart, such as a `LoweredPou`: a POU in its project, and what its comparison with the chart needs."""

    @property
    def project(self) -> Project:
        """The project with the code."""

    @property
    def name(self) -> str:
        """Name of the code in the project: ``Main``, ``Main.Fill``."""

    @property
    def profile(self) -> Profile:
        """Profile by which the chart is executed."""

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
_VARIANTS = 4
"""Results of unknown functions with which directed searches are made."""

_MOST_RUN_ALONE = 20_000
"""Scans of a difference that are run one by one; in longer ones those are skipped in which only clocks go on."""

_MOST_SHOWN = 5_000_000
"""Scans of a difference that are shown: a clock that ends after days takes as many as fill the memory."""

_MOST_SEARCHED = 1_000_000_000
"""States of a search, whatever `cap` is: as many take weeks."""

_QUICK_RUNS, _QUICK_SCANS = 12, 60
"""Scans that each of several delays is tried for, before a search."""

_AT_REST = 2
"""Scans at the start in which inputs rest where one tool tests no transition in the first: it does in the second."""

_SCANS_JOINED = 2
"""So many times fewer states are searched where sides are not compared scan by scan: each takes longer."""


class Searching(TypedDict, total=False):
    """Options of the search of a comparison; see `equivalent`."""

    free_inputs: Iterable[str] | str
    functions: Mapping[str, Callable[..., Any]]
    limit: float | str | None
    progress: Callable[[SearchProgress], None] | None
    scan_time: str | int | None


def equivalent(
    a: Comparable | ChartCode,
    b: Comparable | ChartCode,
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
    most_runs: int = 0,
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
    names it, and how the start and times are compared then.

    `outputs`: the variables to compare (by their names in `a`, or a mapping from these to those in `b`); without it all
    single values that both have under the same name, or at the same direct address, and that are no inputs, also those
    in arrays, structures and instances of the project's own function blocks, but of two tools not what only one of them
    writes or reads (``SFCTrans``, ``S_NO``). `step_flags`: by the path of a step of `a` the variable of `b` that
    tells that it is active (``X2``), what it must equal (``s = 2``), or the path of a step of `b`; without it flags
    with usual names are recognised, and steps of the same path in two charts. `inputs`: by their names in `b` those of
    inputs in `a` where they differ; of what is compared without `outputs` too.
    `fixed`: inputs that keep a value, by their names in either. `free_inputs`: variables that nothing writes and that
    are to be inputs though they are not declared so, or ``all``, but never those that tell of steps. `left_out`: a
    variable of `b`; scans that end with its value TRUE (``NOT Button``: FALSE) are not compared, nor what follows them.
    A `LoweredPou` as `b` brings its profile, step flags, inactive inputs and what is left out; SFC flags that operate
    the chart are inputs. `cap`: the most states of the search; `runs` of `scans` scans are tried where that ends
    without an answer, up to ten times as many while they find something new, and `most_runs` more while something that
    may be reachable is left.
    `scan_time`: without it one for which all durations of the programs end exactly in a scan.

    Functions and blocks that are called and that neither the project nor `functions` has are taken as unknown functions
    of what they are given, and of the calls before, the same in both; calls that are statements are compared.

    `limit`: seconds of processor time that it may take, or a text such as ``60s``; `progress` is told how far it is,
    ten times a second. An interruption (``KeyboardInterrupt``) ends it with what is known so far.

    The same arguments always give the same verdict, but for a limit. Raises `ModelError` where there is nothing to
    compare or an input has two types.
    """
    subjects = _subject(a), _subject(b)
    _check_options(
        names={"functions": functions, "step_flags": step_flags, "inputs": inputs, "fixed": fixed},
        numbers={"cap": cap, "runs": runs, "most_runs": most_runs, "scans": scans, "seed": seed},
    )
    check_argument(left_out, (str, type(None)), "what is left out is named by a text")
    outputs = _checked_outputs(outputs)
    if not isinstance(b, SfcNetwork | Pou | Project | Subject):
        profile = profile or b.profile
        step_flags = step_flags if step_flags is not None else b.step_flags or None
        fixed = {**b.at_rest, **(fixed or {})}
        left_out = left_out or b.left_out
    profiles = _profiles(profile, subjects)
    if not isinstance(b, SfcNetwork | Pou | Project | Subject):
        subjects = with_commands(*subjects, profiles[0])
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
        tuple(listed_names(free_inputs, "free inputs are named by texts")),
        left_out,
        functions or {},
    )
    compared.check_freed()
    time = seconds(limit)
    tries = _Tries(min(cap, _MOST_SEARCHED), runs, most_runs, scans, seed, time, progress, time)
    wanted = [each for each in delays(delay, profiles) if compared.can_have(each)]
    return compared.verdict(wanted[0], tries) if len(wanted) == 1 else _best_of(wanted, compared, tries)


def _best_of(wanted: Sequence[Delay], compared: _Compared, tries: _Tries) -> Verdict:
    """Compare with several delays: the first proof counts, else the best verdict, else the longest trace.

    Both sides are prepared for each delay, which takes longer than a short limit where they are large. Then the
    likeliest delay comes first, and no other where that one shows no difference. Each has half of the time that is
    left, the last one all of it: a delay that none is left for is not known to make a difference.
    """
    longest: tuple[tuple[bool, int, bool], Delay, Verdict | None] | None = None
    likely = in_retiming(compared.profiles) or 0
    best: Verdict | None = None
    end = spent() + tries.limit if tries.limit is not None else None
    if tries.limit is not None and 2 * len(wanted) * compared.preparing > tries.limit:
        wanted = sorted(wanted, key=lambda each: not each.retimed)
    for each in wanted:
        length: int | None = None
        found: Verdict | None = None
        is_short = False
        if end is not None:
            tries = tries._replace(limit=end - spent())
            is_short = end <= spent() + compared.preparing
            if best is not None and is_short:
                break
        if not is_short:
            length = compared.quick_difference(each, tries)
        if length is None:
            left = end - spent() if end is not None else None
            found = compared.verdict(each, tries._replace(limit=left and (left if each is wanted[-1] else left / 2)))
            if found.interrupted and best is not None:
                reason = f"{best.reason}; {INTERRUPTED}"
                found = replace(best, kind=VerdictKind.UNTESTED, reason=reason, interrupted=True)
            if found.proven or found.interrupted:
                return found
            if not found.different:
                if best is None or (found.equal and not best.equal):
                    best = found
                tries = tries._replace(most_runs=0)  # another one is worth a proof, but not more runs
                continue
            assert found.counterexample is not None  # noqa: S101  # it is different
            length = len(found.counterexample.inputs)
        length -= abs(each.queued)  # scans without a counterpart
        # the side whose actions come first is the later one, if any
        rank = each.scans * likely >= 0, length, each.scans == likely
        if longest is None or rank > longest[0]:
            longest = rank, each, found
    if best is not None:
        return best
    assert longest is not None  # noqa: S101  # at least one was tried
    if longest[2] is not None:
        return longest[2]
    if end is not None and tries.whole is not None:
        tries = tries._replace(limit=max(end - spent(), tries.whole / 2))
    return compared.verdict(longest[1], tries)


def _subject(given: Comparable | ChartCode) -> Subject:
    if isinstance(given, Subject):
        return given
    is_code = hasattr(given, "step_flags")
    return resolve(given.project, given.name) if is_code else resolve(given)  # type: ignore[union-attr,arg-type]


def _check_options(*, names: Mapping[str, object], numbers: Mapping[str, object]) -> None:
    """Raise `ArgumentError` for an option that is no mapping from names, None aside, or no whole number."""
    for option, given in names.items():
        check_names({} if given is None else given, f"{option} are a mapping from names")
    for option, number in numbers.items():
        check_argument(number, int, f"{option} is a whole number")


def _checked_outputs(outputs: Iterable[str] | Mapping[str, str] | None) -> Iterable[str] | Mapping[str, str] | None:
    """Return outputs as they are given, a list of names as one. Raises `ArgumentError`."""
    if isinstance(outputs, Mapping):
        check_names(outputs, "outputs are a mapping from names")
        return outputs
    return listed_names(outputs, "outputs are named by texts") if outputs is not None else None


def _profiles(
    given: str | Profile | tuple[str | Profile, str | Profile] | None, subjects: tuple[Subject, Subject]
) -> tuple[Profile, Profile]:
    if isinstance(given, tuple):
        return profile_named(given[0]), profile_named(given[1])
    if given is not None:
        return profile_named(given), profile_named(given)
    chosen, other = (default_profile(each.project) for each in subjects)
    return chosen, other if have_equal_rules(chosen, other) else chosen  # a converted file may have another notation


class _Tries(NamedTuple):
    """Limits of what is tried: see `equivalent`."""

    cap: int
    runs: int
    most_runs: int
    scans: int
    seed: int
    limit: float | None
    progress: Callable[[SearchProgress], None] | None
    whole: float | None
    """The limit of all comparisons; `limit` is what is left of it."""


@dataclass(frozen=True)
class _Compared:
    """Subject of a comparison, but for the delay; see `equivalent`."""

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
    spans: list[float] = field(default_factory=list)
    """Seconds that it took to prepare both sides, each time."""

    @property
    def preparing(self) -> float:
        """Seconds that it takes to prepare both sides for a delay; 0 where that was not done yet."""
        return max(self.spans, default=0.0)

    def check_freed(self) -> None:
        """Refuse names of variables that neither system can have as an input."""
        freed = [name for name in self.free_inputs if name != ALL_FREE]
        systems = self._plain if self.free_inputs else ()
        names = {name.casefold() for system in systems for name in system.inputs}
        known = names | {re.split(r"[.\[]", name)[0] for name in names}
        for name in freed:
            if name.casefold() not in known:
                frozen = dict.fromkeys(each for system in systems for each in system.frozen())
                hint = f"These are: {', '.join(frozen)}" if frozen else "All variables are inputs, or are written."
                raise ModelError(f"{name!r} is no variable that nothing writes", hint=hint)

    @cached_property
    def _written_elsewhere(self) -> frozenset[str]:
        """The variables that other code of the projects writes as well: inputs, whatever the compared sides write."""
        return frozenset().union(*(written_elsewhere(each.pou, each.project) for each in self.subjects))

    @property
    def passes_start(self) -> bool:
        """True if the second has a step before the initial steps of the first, in which its first scan passes.

        No transition of the first is tested in that scan. A step before one initial step counts only if it leads to
        that step of the first and to none of its others: else the second begins elsewhere, and that is a difference.
        """
        (first, second), profile = [subject.pou for subject in self.subjects], self.profiles[0]
        if not _has_start(second) or _has_start(first):
            return False
        if profile.grafcet_terms:
            return True
        if first.chart is None or second.chart is None:
            return False
        names = {step.name.casefold(): step.initial for step in first.chart.steps}
        entered = second.chart.outgoing(second.chart.initial_steps[0])[0].targets
        begun = {step.name.casefold() for step in second.chart.steps if step.id in entered} & names.keys()
        initial = {name for name, is_initial in names.items() if is_initial}
        return len(initial) > 1 or (bool(initial) and begun == initial)

    def can_have(self, delay: Delay) -> bool:
        """False for a delay that makes no sense: of scans that cannot be cut, or of inputs that there are none of."""
        is_late = any(name not in ASKED_FOR for name, _ in self.operated)
        return (not delay.retimed or self.can_be_retimed) and (not delay.operated_later or is_late)

    @cached_property
    def can_be_retimed(self) -> bool:
        """True if the scans of sides that execute actions first can be cut elsewhere."""
        left, right = self._plain
        return all(
            system.is_retimable
            for system, profile in zip((left, right), self.profiles, strict=True)
            if profile.order is not ScanOrder.TRANSITIONS_FIRST
        )

    @cached_property
    def resting(self) -> dict[str, Value]:
        """Inputs that operate a chart in only one of two tools: they rest, but for those that are named in `inputs`."""
        own = operating_names(self.profiles[0]) ^ operating_names(self.profiles[1])
        if not own:
            return {}
        named = {name.upper() for pair in self.inputs.items() for name in pair}
        found = {name: signal for system in self._plain for name, signal in system.inputs.items()}
        return {n: signal.default for n, signal in found.items() if n.upper() in own - named}

    @cached_property
    def _flags(self) -> tuple[list[str], list[str]]:
        """The variables of each side that tell of steps: no inputs, also where nothing writes them."""
        if not self.free_inputs:
            return [], []
        left, right = (
            ProgramSystem(subject, profile, self.clock, functions=self.functions, times=times)
            for subject, profile, times in zip(self.subjects, self.profiles, self._times, strict=True)
        )
        steps = step_observations(left, right, self.step_flags)
        return [], [other.path for _, _, other in steps if not other.bit]

    @property
    def _plain(self) -> tuple[ProgramSystem, ProgramSystem]:
        """Both sides as they are, to be looked at."""
        return self._built(retiming=False)

    @cached_property
    def _times(self) -> tuple[StepTimes, StepTimes]:
        """Use that both make of the times of steps, which no profile and no delay changes."""
        left, right = self.subjects
        return step_times(left, self.clock.scan_time), step_times(right, self.clock.scan_time)

    @cached_property
    def _kept(self) -> dict[bool, tuple[ProgramSystem, ProgramSystem]]:
        """Both sides, retimed and not, as far as they are made already: translating a large project takes long."""
        return {}

    def _built(self, *, retiming: bool) -> tuple[ProgramSystem, ProgramSystem]:
        """Return both sides for a short look: whoever is next changes their delay and what is observed."""
        if retiming not in self._kept:
            self._kept[retiming] = self._systems(retiming=retiming)
        return self._kept[retiming]

    def _systems(self, *, retiming: bool) -> tuple[ProgramSystem, ProgramSystem]:
        """Translate both sides."""
        start = spent()
        profiles = [retimed(each) if retiming else each for each in self.profiles]

        def system(side: int, told: Mapping[str, Type], written: Iterable[str] = ()) -> ProgramSystem:
            return ProgramSystem(
                *(self.subjects[side], profiles[side], self.clock),
                functions=self.functions,
                free_inputs=[*self.free_inputs, *self._written_elsewhere],
                not_free=[*self._flags[side], *written],
                times=self._times[side],
                known_types=told,
            )

        left = system(0, {})
        right = system(1, left.told_types)
        # the first use of an undeclared name gives it its type, and another order of the texts may have it another one
        if left.needs_types(right.told_types):
            left = system(0, right.told_types)
            right = system(1, left.told_types)
        # what one side writes is no input of the other, of which a part that writes it may be a unit of its own
        if written := self._written_there(right, left):
            right = system(1, left.told_types, written)
        if written := self._written_there(left, right):
            left = system(0, right.told_types, written)
        self.spans.append(spent() - start)
        if self.left_out is not None:
            right.leave_out(self.left_out)
        heed_instability(left, right, is_first=True)
        heed_instability(right, left, is_first=False)
        return left, right

    def _written_there(self, system: ProgramSystem, other: ProgramSystem) -> list[str]:
        """Return the inputs of a system that the other has as variables and writes, and not as inputs.

        What the other does not read and does not write is an input of this one all the same.
        """
        variables = other.variables if self.free_inputs or self._written_elsewhere else {}
        shared = (name for name in system.inputs if name in variables and not variables[name].is_input)
        return [name for name in shared if other.writes(name)]

    def _delay(self, left: ProgramSystem, right: ProgramSystem, delay: Delay) -> None:
        """Have both sides begin and be compared as a delay has it."""
        # without retiming, a first that tests no transition in its first scan is in step already
        is_late = delay.is_held or not self.profiles[0].initial_situation_held
        left.holds_start = delay.is_held or (self.passes_start and right.profile.order is ScanOrder.TRANSITIONS_FIRST)
        right.holds_start = delay.is_held
        left.tests_ahead = right.tests_ahead = delay.settled and not delay.in_sequence
        later_start = int(is_late and self.passes_start and right.profile.order is not ScanOrder.TRANSITIONS_FIRST)
        earlier, later = (left, right) if delay.queued > 0 else (right, left)
        count = abs(delay.queued)
        if delay.settled:
            is_same = self.profiles[0].initial_situation_held is self.profiles[1].initial_situation_held
            for system in () if is_same else (left, right):
                at_rest = {name.casefold(): signal.default for name, signal in system.inputs.items()}
                system.delay(alone=_AT_REST, at_rest=at_rest)
            return
        if delay.in_sequence:  # all have executed their initial steps once before a transition of these is tested
            for system, passes in ((left, False), (right, later_start > 0)):
                begins = int(system.profile.order is ScanOrder.ACTIONS_FIRST and not passes)
                system.delay(begins=begins, alone=1 - begins, at_rest=self._operated(system), unseen=passes)
            return
        if delay.retimed:
            for system, begins in ((left, later_start), (right, 0)):
                operated = self._operated(system)
                is_later = delay.operated_later and system.profile.order is ScanOrder.TRANSITIONS_FIRST
                late = {name: default for name, default in operated.items() if name.upper() not in ASKED_FOR}
                system.delay(begins=begins, alone=1, at_rest=operated, late=late if is_later else {})
            return
        alone = count if delay.late_start else 0
        earlier.delay(
            begins=later_start if earlier is left else 0, kept=count, alone=alone, at_rest=self._operated(earlier)
        )
        later.delay(begins=alone + (later_start if later is left else 0))

    @cached_property
    def operated(self) -> list[tuple[str, str]]:
        """The pairs of inputs that operate a chart and do not rest."""
        operating = operating_names(self.profiles[0]) | operating_names(self.profiles[1])
        return [(a, b) for a, b in self.inputs.items() if not operating.isdisjoint((a.upper(), b.upper()))]

    def _operated(self, system: ProgramSystem) -> dict[str, Value]:
        """Inputs of one side that operate a chart and do not rest, by their names in lower case."""
        named = {name.casefold() for pair in self.operated for name in pair}
        found = ((name.casefold(), signal.default) for name, signal in system.inputs.items())
        return {name: default for name, default in found if name in named}

    def prepared(self, delay: Delay, *, briefly: bool = False) -> tuple[Comparison, dict[str, Signal]]:
        """Both sides with a delay, and their inputs; `briefly`: not to be used behind the next call."""
        left, right = (self._built if briefly else self._systems)(retiming=delay.retimed)
        self._delay(left, right, delay)
        return Comparison(left, right, self.outputs, self.step_flags, delay, names=self.inputs), self.connected(
            left, right
        )

    def connected(self, left: ProgramSystem, right: ProgramSystem) -> dict[str, Signal]:
        """Connect the inputs of two systems."""
        return connect(left, right, self.inputs, {**self.resting, **self.fixed})

    def quick_difference(self, delay: Delay, tries: _Tries) -> int | None:
        """Return how many scans it takes to a difference in a few directed runs; None where there is none."""
        comparison, signals = self.prepared(delay, briefly=True)
        watch = SearchWatch(tries.limit, None, lambda: (0, 0), tries.whole)
        domains = {name: Domain(name, signal) for name, signal in signals.items()}
        rows = self.quick_runs(signals, domains, tries)
        found = (comparison.first_difference(each, look=watch.look) for each in rows if not watch.look(0))
        lengths = [length for length in found if length is not None]
        return min(lengths, default=None)

    def quick_runs(
        self, signals: Mapping[str, Signal], domains: Mapping[str, Domain], tries: _Tries
    ) -> Iterator[list[dict[str, Value]]]:
        """Yield the inputs of a few directed runs."""
        return stimuli(signals, domains, self.clock, seed=tries.seed, runs=_QUICK_RUNS, scans=_QUICK_SCANS)

    def limits(self, signals: Mapping[str, Signal]) -> Iterator[str]:
        """Yield what "all inputs" does not mean."""
        if self.resting:
            yield f"{', '.join(self.resting)} at rest"
        if any(each.kind is SignalKind.REAL for each in signals.values()):
            yield "REAL inputs are finite numbers"

    def verdict(self, delay: Delay, tries: _Tries) -> Verdict:
        """Compare both with one delay."""
        return _Attempt(self, delay, tries).verdict()


@dataclass(frozen=True)
class _Runs:
    """Result of directed runs. `stopped`: why they ended early; `notes`: where single runs ended."""

    counterexample: Counterexample | None = None
    runs: int = 0
    scans: int = 0
    stopped: str = ""
    notes: tuple[str, ...] = ()


class _Attempt:
    """A comparison with one delay: a search for a proof, and directed runs where there is none."""

    def __init__(self, compared: _Compared, delay: Delay, tries: _Tries) -> None:
        self._compared, self._delay, self._tries = compared, delay, tries
        self._clock = compared.clock
        self._comparison, self._signals = compared.prepared(delay)
        self._left, self._right = self._comparison.left, self._comparison.right
        self._joined = self._comparison.joined()
        heed_called(self._left, self._right)
        self._tallies = (Tally(self._left), Tally(self._right))
        self._untried = self._left.reached(), self._right.reached()
        self._watch = SearchWatch(tries.limit, tries.progress, self._tallies[0].numbers, tries.whole)
        self._domains = {name: Domain(name, signal) for name, signal in self._signals.items()}

    def verdict(self) -> Verdict:
        """Search, run where there is no proof, and tell what was covered."""
        found = self._search()
        self._watch.proving = False
        if found.inputs is not None and self._comparison.unknown:
            found = self._comparison.without_impossible(found, filled(found.inputs, self._signals))
        if found.inputs is not None:
            show = partial(self._comparison.show_joined, self._joined) if self._joined else self._comparison.show
            return self._verdict(found, _Runs(show(found.inputs, self._signals, shortest=found.shortest)))
        if found.complete or found.reason == INTERRUPTED:
            return self._verdict(found, _Runs())
        return self._verdict(found, self._run_joined(self._joined)) if self._joined else self._verdict_of_runs(found)

    def _search(self) -> Explored:
        """Try every value of every input, in the whole and in parts."""
        left, right, look = self._left, self._right, self._watch.look
        found = Explored(0, 0, complete=False, reason=self._clock.reason)
        try:
            if self._joined is not None and not self._clock.reason:
                cap = self._tries.cap // _SCANS_JOINED
                return ended(search(*self._joined.sides, self._domains, cap, scan=self._joined.run), look)
            for number, cap in enumerate(searches(left, right, self._tries.cap) if not self._clock.reason else ()):
                whole = search(left, right, self._domains, cap)
                found = race(whole, left.size + right.size, partial(self._divided, cap), self._accepted, look)
                if number == 0 and not found.complete and found.inputs is None:
                    found = explore_terms(left, right, self._signals, self._tries.cap, look) or found
                if found.complete or found.inputs is not None or not found.capped:
                    break
        except KeyboardInterrupt:
            found = Explored(self._watch.states, 0, complete=False, reason=INTERRUPTED)
        return found

    def _run_joined(self, joined: Joined) -> _Runs:
        """Run both with inputs that do not follow from what they do."""
        sides, signals = joined.sides, self._signals
        rows = self._compared.quick_runs(signals, self._domains, self._tries)
        made = scans = 0
        for given in rows:
            for side in sides:
                side.reset()
            for place, row in enumerate(given):
                if stopped := self._watch.look(scans):
                    return _Runs(None, made, scans, stopped)
                scans += 1
                ends = joined.run(*sides, row.__getitem__, first=not place)
                if ends.is_different:
                    shown = self._comparison.show_joined(joined, given[: place + 1], signals, shortest=False)
                    return _Runs(shown, made + 1, scans)
                if ends.failure is not None:
                    break
            made += 1
        return _Runs(None, made, scans)

    def _divided(self, cap: int) -> Search | None:
        comparison = self._comparison
        division = divide(self._left, self._right, comparison.pairs) if not comparison.unknown else None
        return division.search(self._built, cap, self._watch.look) if division is not None else None

    def _built(
        self, one: Pou, other: Pou, pairs: Sequence[tuple[Observation, Observation]]
    ) -> tuple[ProgramSystem, ProgramSystem, Mapping[str, Domain]]:
        parts = [
            system.part(pou, [pair[side] for pair in pairs])
            for side, (system, pou) in enumerate(((self._left, one), (self._right, other)))
        ]
        for tally, part in zip(self._tallies, parts, strict=True):
            tally.add(part)
        own = self._compared.connected(parts[0], parts[1])
        return parts[0], parts[1], {name: Domain(name, signal) for name, signal in own.items()}

    def _accepted(self, shown: Explored) -> bool:
        rows = filled(shown.inputs or [], self._signals)
        return self._comparison.first_difference(rows) == len(rows)

    def _verdict_of_runs(self, found: Explored) -> Verdict:
        """Run both with inputs that lead to what was not executed yet."""
        comparison, signals, tries = self._comparison, self._signals, self._tries
        parts = self._tallies[0].look_at_conditions(), self._tallies[1].look_at_conditions()
        sides = self._left, self._right
        searched = [side.reached() for side in sides]
        for side, untried in zip(sides, self._untried, strict=True):
            side.forget(untried)  # on the way to what the search for a proof has reached, conditions are looked at
        variants = range(_VARIANTS) if comparison.unknown else (0,)
        before, made = _Runs(), _Runs()
        for variant in variants:  # of the results of unknown functions
            comparison.vary(variant)
            directed = DirectedSearch(
                *(*sides, signals, self._domains, self._clock),
                parts=parts,
                scans=tries.runs * tries.scans // len(variants),
                seed=tries.seed,
                look=self._watch.look,
            )
            before, made = made, self._ran(directed.run(), made)
            if made.counterexample is not None or made.stopped:
                break
        for side, proving in zip(sides, searched, strict=True):
            side.recall(proving)
        verdict = self._verdict(found, made)
        if not tries.most_runs or made.counterexample or made.stopped or not any_untested(verdict.coverage):
            return verdict
        return self._verdict(found, self._ran(directed.run(tries.most_runs * tries.scans), before))

    def _ran(self, directed: Directed, made: _Runs) -> _Runs:
        """Return what runs have come to, with those that were `made` before; a difference is run once more."""
        counterexample, stopped = None, directed.stopped
        if directed.steps is not None:
            counterexample, stopped = _confirmed(directed.steps, self._comparison, self._signals, self._watch)
        notes = tuple(dict.fromkeys([*made.notes, *directed.notes]))
        return _Runs(counterexample, made.runs + directed.runs, made.scans + directed.scans, stopped, notes)

    def _verdict(self, found: Explored, ran: _Runs) -> Verdict:
        comparison, clock, compared = self._comparison, self._clock, self._compared
        left, right, delay = self._left, self._right, self._delay
        frozen = tuple(dict.fromkeys([*left.frozen(), *right.frozen()]))
        failed = next((note for note in (*found.notes, *ran.notes) if note.startswith(BOTH_FAIL)), "")
        covered = found.complete and not frozen and not failed
        coverage = coverage_of(self._tallies, comparison.pairs, complete=covered, is_late=self._watch.is_late)
        equal = VerdictKind.PROVEN if found.complete else VerdictKind.TESTED
        reason = "; ".join(dict.fromkeys(filter(None, (found.reason, ran.stopped))))
        interrupted = reason.endswith(INTERRUPTED)
        # a controller goes on after an error, each in its own way: what follows is not compared
        if any_untested(coverage) or (found.complete and found.dead) or failed or interrupted:
            equal = VerdictKind.UNTESTED
            if failed and not found.complete:
                reason = "; ".join(dict.fromkeys(filter(None, (reason, failed))))
            elif found.complete:
                why = failed or ("; ".join(found.notes) if found.dead else "")
                reason = f"all inputs were tried, but {why}" if why else f"{', '.join(frozen)} kept their values"
        # outputs that could not be compared may differ, however equal all others are
        if comparison.gap:
            equal = VerdictKind.UNTESTED
            reason = "; ".join(filter(None, (comparison.gap, reason)))
        if reason and None in (left.times.limit, right.times.limit) and found.states >= self._tries.cap:
            reason += "; elapsed times of steps are used otherwise than in comparisons with constants"
        return Verdict(
            VerdictKind.DIFFERENT if ran.counterexample is not None else equal,
            tuple(comparison.names),
            tuple(comparison.uncompared),
            tuple(self._signals),
            found.states,
            found.depth,
            ran.runs,
            ran.scans,
            clock.scan_time,
            bool(clock.constants),
            " and ".join(dict.fromkeys(each.name for each in compared.profiles)),
            reason,
            ran.counterexample,
            (*found.notes, *compared.limits(self._signals)),
            found.parts,
            coverage,
            frozen,
            delay,
            (
                *delay.notes([each.order for each in compared.profiles], [a for a, _ in compared.operated]),
                *(("the first begins when the second has passed its initial step",) if compared.passes_start else ()),
            ),
            comparison.unknown,
            interrupted,
            "; ".join(filter(None, (comparison.gap, failed))),
        )


def _has_start(pou: Pou) -> bool:
    """True if a chart begins with a step that does nothing but lead to several others at once.

    Actions that it stores are no matter: they are executed in every scan, as the logic of a chart is.
    """
    initial = pou.chart.initial_steps if pou.chart is not None else []
    if pou.chart is None or len(initial) != 1:
        return False
    leaving = pou.chart.outgoing(initial[0])
    if len(leaving) != 1 or len(leaving[0].targets) < 2 or pou.chart.incoming(initial[0]):
        return False
    if any(each.qualifier is not Qualifier.S for each in initial[0].actions):
        return False
    condition = leaving[0].condition
    if not isinstance(condition, Expression) or condition.negated:
        return False
    return condition.text.strip().upper() == "TRUE" or _is_passed_at_first(condition.text, pou)


def _is_passed_at_first(condition: str, pou: Pou) -> bool:
    """True for ``NOT waits OR ..`` with a variable of the POU that begins as FALSE: only an operated input sets it."""
    found = re.match(r"NOT (\w+) OR ", condition)
    held = [each for each in pou.variables(SectionKind.LOCAL) if found and each.name.casefold() == found[1].casefold()]
    return bool(held) and held[0].initial is None


def _confirmed(
    steps: Sequence[Step], comparison: Comparison, signals: Mapping[str, Signal], watch: SearchWatch
) -> tuple[Counterexample | None, str]:
    """Return the difference that a search came to, run from the start; or why it could not be."""
    rows, skipped = [row for row, _ in steps], [count for _, count in steps]
    length_of_all = len(steps) + sum(skipped)
    if length_of_all > _MOST_SHOWN:
        hint = "Give it longer scans with scan_time, or a shorter time in the program."
        raise ModelError(f"the two differ after {length_of_all} scans, which are too many to be shown", hint=hint)
    if length_of_all > _MOST_RUN_ALONE:
        if comparison.first_difference(rows, skipped, watch.look) != len(rows):
            return None, watch.look(0)
        return comparison.show(rows, signals, skipped, shortest=False), ""
    alone = [row for row, count in steps for row in [row] * (1 + count)]
    length = comparison.first_difference(alone, look=watch.look)
    if length is None:
        return None, watch.look(0)
    return comparison.show(comparison.shrunk(alone[:length], signals, watch.look), signals, shortest=False), ""
