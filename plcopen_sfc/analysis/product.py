"""Search of everything that two systems can do together, scan by scan, with the same inputs.

Breadth first over the pairs of their states. In each state the scan runs once for every combination of values of those
inputs that it really reads: `Branching` notes what is read, and what was not tried yet. So a chart of 100 conditions
costs as many runs as conditions are looked at in a scan, not 2 to the power of 100. The first difference that is found
is one with the fewest scans.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Collection, Generator, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

from plcopen_sfc.analysis.domains import (
    Domain,
    KeptError,
    NotProvableError,
    Probe,
    Split,
    Symbolic,
    Text,
    Unasked,
    asked,
    frozen,
    plain,
)
from plcopen_sfc.errors import (
    ForcingConflictError,
    SfcError,
    SimulationError,
    UnknownBehaviourError,
    UnknownFunctionError,
    UnstableChartError,
)
from plcopen_sfc.semantics.signals import Value

RUNS_FOR_A_STATE = 4
_BEFORE_GIVING_UP = 16
"""The part of all scans that are run before it is estimated how many more there will be."""

BOTH_FAIL = "both end with an error"
"""Beginning of a note about it."""

InputReader = Callable[[str], Any]


class System(Protocol):
    """Something that runs scan by scan and can be put back into an earlier state."""

    def reset(self) -> None:
        """Go to the state before the first scan."""

    def scan(self, read: InputReader, *, first: bool) -> None:
        """Run one scan; `read` gives the value of an input. Time goes on before every scan but the first."""

    def observed(self) -> tuple[Any, ...] | None:
        """Return the values that are compared, at the end of a scan; None: they have no counterpart."""

    def snapshot(self) -> Any:
        """Return the state, without absolute times."""

    def restore(self, snapshot: Any) -> None:
        """Go back to a state."""


class LeftOutError(SfcError):
    """A scan is none of those that are to be compared."""


class UnansweredInstabilityError(UnstableChartError):
    """A chart never becomes stable, and what it is compared with makes one evolution in a scan: it cannot tell."""


class _Regrown(Exception):  # noqa: N818  # no error: the search starts again
    """A constant was found: there are more values to try."""


class Branching:
    """All combinations of values that the inputs of one scan can have, in the order in which they are read.

    Of `split` inputs, which are numbers, only as many values are tried as comparisons tell apart in that scan.
    """

    def __init__(self, domains: Mapping[str, Domain], split: Collection[str] = ()) -> None:
        self._domains = domains
        self._split = split
        self._path: list[tuple[Sequence[Any], int]] = []
        self._cursor = 0
        self.values: dict[str, Any] = {}
        self.answers: dict[Hashable, bool] = {}
        """Answers in this scan to questions that nothing decides."""

    def combinations(self) -> Iterator[dict[str, Any]]:
        """Run the body of the loop once for each combination; it reads its inputs with `read`."""
        self._path = []
        while True:
            self._cursor = 0
            self.values = {}
            self.answers = {}
            yield self.values
            # an odometer: the inputs of a scan are known only as it reads them, and what is read may depend on values
            # before
            while self._path and self._path[-1][1] + 1 == len(self._path[-1][0]):
                self._path.pop()
            if not self._path:
                return
            options, index = self._path[-1]
            self._path[-1] = (options, index + 1)

    def read(self, name: str) -> Any:
        """Return the value of an input in this scan."""
        if name in self.values:
            return self.values[name]
        domain = self._domains[name]
        value = self.values[name] = Split(domain, self._choose) if name in self._split else self._choose(domain.options)
        return value

    def answer(self, question: Hashable) -> bool:
        """TRUE and FALSE are tried; within a scan the answer stays."""
        if question not in self.answers:
            self.answers[question] = self._choose((False, True))
        return self.answers[question]

    def _choose(self, options: Sequence[Any]) -> Any:
        if self._cursor == len(self._path):
            self._path.append((options, 0))
        options, index = self._path[self._cursor]
        self._cursor += 1
        return options[index]


@dataclass(frozen=True)
class Explored:
    """Result of a search.

    `inputs`: those of the scans that lead to the first difference, None where there is none; `shortest`: no fewer scans
    lead to one. `complete`: all states were seen. `depth`: every input sequence of that many scans was tried. `reason`:
    why the search is not complete; `capped`: there are too many states. `notes`: what was not followed any further,
    because both end with an error there. `parts`: into how many the comparison was divided.
    `dead`: every run ends where it is not followed any further.
    """

    states: int
    depth: int
    complete: bool
    inputs: list[dict[str, Value]] | None = None
    reason: str = ""
    notes: tuple[str, ...] = ()
    shortest: bool = True
    capped: bool = False
    parts: int = 1
    dead: bool = False


class Progress(NamedTuple):
    """Progress of a search: scans that were run, the depth that is being searched, and states that were found."""

    scans: int
    depth: int
    states: int = 0


class StopError(Exception):
    """Thrown into a search that has to end with what it knows; its text tells why."""


Search = Generator[Progress, None, Explored]
"""A search that can be interrupted: it yields its progress before each state, and ends where `StopError` is thrown."""


def ended(searching: Search, look: Callable[[int], str] = lambda _: "") -> Explored:
    """Run a search to its end, or until `look` tells why it must end."""
    found, _ = advanced(searching, look)
    while found is None:
        found, _ = advanced(searching, look)
    return found


def advanced(searching: Search, look: Callable[[int], str]) -> tuple[Explored | None, Progress | None]:
    """Advance a search by one state; return its result if it ends, else its progress."""
    try:
        progress = next(searching)
        reason = look(progress.states)
        if reason:
            searching.throw(StopError(reason))
    except StopIteration as end:
        return end.value, None
    return None, progress


def search(
    left: System,
    right: System,
    domains: Mapping[str, Domain],
    cap: int,
    *,
    follow: Callable[[Branching], None] | None = None,
    scan: Callable[..., ScanEnd] | None = None,
) -> Search:
    """Search the product of two systems, state by state: up to `cap` states, and four scans for each of them.

    The domains grow by the constants that are found. Meanwhile nothing else may use the systems. `follow` is told what
    tries the inputs of all scans, where something else must be tried too. `scan`: what is run and compared with each
    combination of values, where that is not one scan of both.
    """
    split = {name for name, domain in domains.items() if domain.is_number}
    try:
        while True:
            try:
                return (yield from _search(left, right, domains, split, cap, follow=follow, scan=scan or _scan))
            except KeptError as kept:
                # a term for a number holds in one scan only; of one that is kept the values have to be tried one by one
                split.remove(kept.name)
            except _Regrown:
                for domain in domains.values():
                    domain.grown = False
    except NotProvableError as reason:
        return Explored(0, 0, complete=False, reason=str(reason))


def _search(
    left: System,
    right: System,
    domains: Mapping[str, Domain],
    split: Collection[str],
    cap: int,
    *,
    follow: Callable[[Branching], None] | None,
    scan: Callable[..., ScanEnd],
) -> Search:
    # comparisons divide the numbers of `split` as they come: of these no value can have been missing
    tried = [domain for name, domain in domains.items() if name not in split]
    probing = follow is not None or any(isinstance(o, Symbolic) for domain in tried for o in domain.options)
    left.reset()
    right.reset()
    # of a state that was gone on from only the way to it is kept: snapshots of all would fill the memory
    origins: list[tuple[int, dict[str, Any]]] = [(-1, {})]
    depths = [0]
    # breadth first: the first difference that is found needs the fewest scans
    waiting = deque([(0, left.snapshot(), right.snapshot())])
    seen: set[Any] = set()
    branching = Branching(domains, split)
    if follow is not None:
        follow(branching)
    runs = 0
    notes: dict[str, SfcError] = {}
    closed = False
    limit = cap * RUNS_FOR_A_STATE
    too_many = f"more than {limit:,} scans to search"
    while waiting:
        number, before_left, before_right = waiting.popleft()
        for values in branching.combinations():
            try:
                yield Progress(runs, depths[number], len(seen))
            except StopError as stop:
                return _stopped(len(seen), depths[number], str(stop))
            runs += 1
            # those that wait take about as many scans each as those before them: when they alone are too many, the
            # search cannot end in time, and the scans are better spent on directed runs
            more = len(waiting) * runs / (len(origins) - len(waiting)) if runs > limit // _BEFORE_GIVING_UP else 0
            if runs + more > limit:
                return _stopped(len(seen), depths[number], too_many)
            left.restore(before_left)
            right.restore(before_right)
            ended = scan(left, right, branching.read, first=number == 0)
            runs += ended.more
            if ended.is_different:
                _check_domains(tried)  # a shorter trace may need a value that was not known yet
                inputs = [*_inputs(origins, number), {name: plain(value) for name, value in values.items()}]
                return Explored(len(seen), depths[number], complete=False, inputs=inputs)
            if ended.failure is not None:
                notes[ended.note] = ended.failure
                continue
            after = (left.snapshot(), right.snapshot())
            code = frozen(after) if probing else after
            if code in seen:
                # a run that comes back to a known state goes on for ever: not all of them end where both fail
                closed = True
                continue
            seen.add(code)
            if len(seen) > cap:
                return _stopped(cap, depths[number], f"more than {cap:,} states")
            waiting.append((len(origins), *after))
            origins.append((number, dict(values)))
            depths.append(depths[number] + 1)
    _check_domains(tried)
    broken = next((each for each in notes.values() if not isinstance(each, SimulationError)), None)
    if not seen and broken is not None:
        raise broken  # nothing ever ran, and it is no scan that has ended
    dead = not closed and bool(notes)
    return Explored(len(seen), max(depths), complete=True, notes=tuple(notes), dead=dead)


def _stopped(states: int, depth: int, reason: str) -> Explored:
    return Explored(states, depth, complete=False, reason=reason, capped=True)


def _check_domains(domains: Iterable[Domain]) -> None:
    if any(domain.grown for domain in domains):
        # inputs were tried with too few values: what was the same for those may differ for the new one
        raise _Regrown


class ScanEnd(NamedTuple):
    """End of one step of a search: both sides are the same, or not, or `failure` is why they are not followed.

    `note` tells of the failure what a proof then leaves out, or which side alone ends with it. `more`: what it took
    beyond one step, in steps.
    """

    is_different: bool = False
    note: str = ""
    failure: SfcError | None = None
    more: int = 0


NEVER_STABLE = "situations that never become stable are left out"
"""What a proof rests on where a chart fires transitions for ever with some inputs."""


def _scan(left: System, right: System, read: InputReader, *, first: bool) -> ScanEnd:
    failures = [failure_of(system, read, first=first) for system in (left, right)]
    ended = end_of(failures)
    if ended is not None:
        return ScanEnd(False, *ended)
    return ScanEnd(any(failures) or bool(compare(left.observed(), right.observed())))


def end_of(failures: Sequence[SfcError | None]) -> tuple[str, SfcError] | None:
    """Return why two systems cannot be compared any further, and the error.

    Both fail, or neither of them becomes stable; or orders of a chart contradict each other, which is a mistake of its
    author: what follows is unknown; or the user does not want to know what follows. That only one of them never
    becomes stable is a difference, if the other could tell. Raises an error if a system cannot be executed at all.
    """
    for failure in failures:
        if isinstance(failure, UnknownBehaviourError | UnknownFunctionError):
            raise failure
    for failure in failures:
        is_told = all(isinstance(each, _NOT_FOLLOWED) for each in failures)
        if isinstance(failure, UnansweredInstabilityError) or (isinstance(failure, UnstableChartError) and is_told):
            return NEVER_STABLE, failure
        if isinstance(failure, ForcingConflictError):
            return "situations in which forcing orders contradict each other are left out", failure
        if isinstance(failure, LeftOutError):
            return f"what follows {failure.message} is left out", failure
    first = failures[0]
    if first is not None and all(failures):
        place = str(first.location)
        return f"{BOTH_FAIL}: {f'{place}: ' if place else ''}{first.message}", first
    return None


_NOT_FOLLOWED = (UnstableChartError, ForcingConflictError, LeftOutError)


def failure_of(system: System, read: InputReader, *, first: bool) -> SfcError | None:
    """Run a scan; the error that it ends with, such as a division by zero."""
    try:
        system.scan(read, first=first)
    except (TypeError, AttributeError) as error:
        raise NotProvableError("an input is used in a way that cannot be followed") from error
    except SfcError as error:
        reason = hidden_reason(error)
        if reason is not None:
            raise reason from None
        return error
    return None


def hidden_reason(error: SfcError) -> NotProvableError | None:
    """Return the reason that ends a proof, if that is what an error of a program comes from."""
    reason: BaseException | None = error
    while reason is not None and not isinstance(reason, NotProvableError):
        reason = reason.__cause__ or reason.__context__
    return reason


def compare(left: Sequence[Any] | None, right: Sequence[Any] | None) -> list[int]:
    """Return the places at which two observations differ; none, where one of them has no counterpart."""
    if left is None or right is None:
        return []
    if _COPIES.isdisjoint(map(type, left)) and left == right:
        return []
    return [
        place
        for place, (a, b) in enumerate(zip(left, right, strict=True))
        if (a is not b or type(a) in _COPIES) and not _equal(a, b)
    ]


_COPIES = frozenset({Probe, Text})
"""Values of inputs that may be of earlier scans: that they look equal does not tell that they are."""


def _equal(a: Any, b: Any) -> bool:
    if isinstance(a, Unasked) and isinstance(b, Unasked) and a.name == b.name:
        return True
    a, b = asked(a), asked(b)
    if not isinstance(a, Probe) and not isinstance(b, Probe):
        return bool(a == b) or (a != a and b != b)  # noqa: PLR0124  # two that are no numbers are the same
    if isinstance(a, Probe) and isinstance(b, Probe) and a.domain is b.domain:
        if type(a) in _COPIES:
            a.domain.double()  # one of them may be of an earlier scan
        return bool(a.value == b.value)
    if plain(a) != plain(b):
        return False
    if isinstance(a, Split) or isinstance(b, Split):
        return bool(a == b)  # the number may be another one too
    raise NotProvableError(f"{(a if isinstance(a, Probe) else b).domain.name} is put out")


def _inputs(origins: Sequence[tuple[int, dict[str, Any]]], number: int) -> list[dict[str, Value]]:
    found: list[dict[str, Value]] = []
    while number > 0:
        number, values = origins[number]
        found.append({name: plain(value) for name, value in values.items()})
    return found[::-1]
