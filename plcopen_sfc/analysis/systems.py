"""Charts and programs as systems whose product can be searched: their inputs, and what is compared.

Results of unknown functions and blocks may be anything, but are the same on both sides. In a scan equal calls have
equal results, and all results are tried. A block depends on the calls before, too: which these were is compared at the
end of every scan, so both sides have made the same ones as long as the search goes on. A proof then holds
whatever the functions and blocks do. A difference may be none: a result may be another one in another scan, though the
arguments are the same.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import compress
from operator import itemgetter, ne, or_
from types import MappingProxyType
from typing import Any, Unpack

from plcopen_sfc.analysis.dead_variables import dead_cells
from plcopen_sfc.analysis.domains import NotProvableError, Probe, Split, Symbolic, Unasked, asked
from plcopen_sfc.analysis.product import (
    Branching,
    LeftOutError,
    UnansweredInstabilityError,
    end_of,
    hidden_reason,
)
from plcopen_sfc.analysis.timers import Clocking, StepTimes, WaitingTimer, step_times, waiting_timers
from plcopen_sfc.errors import ModelError, SfcError, SimulationError, UnstableChartError
from plcopen_sfc.languages.binding import names_in, uncalled_actions, with_called
from plcopen_sfc.languages.declarations.kept_texts import inheritance
from plcopen_sfc.languages.s7_globals import TABLE
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.semantics.charts import compile_chart
from plcopen_sfc.semantics.charts.running_chart import RunningChart
from plcopen_sfc.semantics.charts.step_state import Reached
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.programs.controller import Controller, Instance
from plcopen_sfc.semantics.programs.marks import Marks
from plcopen_sfc.semantics.programs.runtime import UNREAD
from plcopen_sfc.semantics.programs.runtime_types import (
    BOOL,
    ELAPSED,
    INSTANT,
    Family,
    Frame,
    OpaqueType,
    ScalarType,
    Type,
)
from plcopen_sfc.semantics.programs.scopes import RunOptions
from plcopen_sfc.semantics.programs.unknown_calls import UnknownCalls
from plcopen_sfc.semantics.signals import Signal, SignalKind, Value
from plcopen_sfc.semantics.subjects import (
    Subject,
    Watched,
    executed_alone,
    following_situation,
    is_written,
    step_flags,
    step_marking,
    watched,
    watched_members,
)

_NUMBERS = (Family.INTEGER, Family.BITS, Family.REAL, Family.DURATION)


class FreeCalls(UnknownCalls):
    """Derived values in a run, free ones in a search. `is_delayed`: the other side makes its calls in other scans."""

    def __init__(self) -> None:
        super().__init__()
        self.is_delayed = False
        self.number: Callable[[Hashable], Any] | None = None
        """Stand-in for a number that is the answer to a question, where numbers need not be known."""
        self._branching: Branching | None = None

    def begin_scan(self, branching: Branching | None) -> None:
        """A scan begins; `branching`: one of a search."""
        self._branching = branching
        self.begin()

    @property
    def is_exact(self) -> bool:
        """True if instances keep what tells different histories apart."""
        return self._branching is None

    def value(self, name: str, arguments: Any, type_: ScalarType | OpaqueType) -> Any:
        """Return the result of a function, or an output of a block in a situation; equal for equal arguments."""
        if self._branching is None:
            return super().value(name, arguments, type_)
        if self.is_delayed:
            raise NotProvableError(f"{name} is not known, and is called in other scans on both sides")
        before = tuple(call for call in self.log if name.startswith(f"{call[0]}."))
        question = ("call", name, self.key(arguments), before)
        if isinstance(type_, OpaqueType):
            raise NotProvableError(f"{name} is not known, and its value is of a type that is not known")
        if type_.family is Family.BOOL:
            return self._branching.answer(question)
        if self.number is not None and type_.family in _NUMBERS and type_.narrowed is None and not type_.names:
            return self.number(question)
        raise NotProvableError(f"{name} is not known, and its value is no truth value")

    def called(self, name: str, arguments: tuple[Any, ...], history: int, elapsed: int | None) -> Hashable:
        """Note the call of a block; its situation after that."""
        if self._branching is None:
            return super().called(name, arguments, history, elapsed)
        self.log.append((name, repr(self.key(arguments))))
        return None

    def key(self, value: Any) -> Hashable:
        """Equal for equal values."""
        if isinstance(value, Split):
            return "input", value.domain.name  # it is of this scan
        if isinstance(value, Probe):
            value.domain.double()
        return value.key() if isinstance(value, Symbolic) else super().key(value)


InputReader = Callable[[str], Any]
_NONE: Mapping[str, Value] = MappingProxyType({})
_NOT = "NOT "
_BEGUN = -1
"""Scans that a side waits for which has begun later, and is run already."""
_NO_STEPS = StepTimes(limit=0, anywhere=frozenset(), read=frozenset(), names=frozenset())


@dataclass(frozen=True)
class Observation:
    """Something to compare: a variable, a test of its value (``state = 3``), or a step flag (`bit`).

    `follows`: True if the step will be active in the next scan.
    """

    path: str
    equals: Value | None = None
    bit: int = 0
    follows: bool = False

    def __str__(self) -> str:
        if self.bit:
            return f"{self.path}.{'_x' if self.follows else 'X'}"
        return self.path if self.equals is None else f"{self.path} = {self.equals}"


class ProgramSystem:
    """A POU with its project, run scan by scan; see `plcopen_sfc.analysis.product.System`.

    `names` translates its inputs to the names that both systems share, `fixed` are inputs that keep a value,
    `free_inputs` variables that count as inputs, `not_free` those that never do (see `Controller`). `times`: what is
    known of the times of steps, looked up where it is None. `known_types`: see `Controller`.
    """

    def __init__(
        self,
        subject: Subject,
        profile: Profile,
        clock: Clocking,
        *,
        times: StepTimes | None = None,
        **options: Unpack[RunOptions],
    ) -> None:
        self.subject = subject = executed_alone(subject)
        self.clock = clock
        self.profile = profile
        self._options = options
        self._names: dict[str, str] = {}
        self._fixed: dict[str, Value] = {}
        self._source: InputReader = _no_input
        self.unknown_calls = FreeCalls()
        self._observes_calls = False
        run: RunOptions = {
            **options,
            "unknown_calls": self.unknown_calls,
            "chart_compiler": compile_chart,
            "read_input": self._input,
            "marking": True,
        }
        self._controller = Controller(subject.project, profile, **run)
        self.instance: Instance = self._controller.instance(subject.pou)
        self.variables: dict[str, Watched] = watched(self.instance)
        self.members: dict[str, Watched]
        self.members, self.large = watched_members(self.instance)
        self.addresses = self.instance.addresses()
        self.chart_steps, self._chart_marking = step_marking(self.instance)
        self.step_flags = step_flags(self.instance)
        self.steps, self._marking = self._all_steps()
        self.times = _NO_STEPS
        if self.instance.called_charts():
            self.times = times or step_times(subject, clock.scan_time)
        self._looked_at: list[str] = []
        self._forget = self._forgetting()
        self._dead: list[tuple[list[Any], int, Value | None]] = []
        self._timers: list[WaitingTimer] = []
        frames = [frame for _, _, frame in self.instance.called_charts()]
        self._starts = [(f.v, x.slot) for f in frames for x in f.layout.fields if x.type is INSTANT]
        structures = [each for f in frames for each in f.v if isinstance(each, Frame)]
        self._elapsed = [(f.v, x.slot) for f in structures for x in f.layout.fields if x.type is ELAPSED]
        self._begins = self._kept = self._alone = self._waiting = 0
        self._unseen = False
        self._at_rest: Mapping[str, Value] = _NONE
        self._resting: Mapping[str, Value] = _NONE
        self._late: Mapping[str, Value] = _NONE
        self._held: dict[str, Value] = {}
        self.holds_start = False
        """True if charts that begin in its first scan test no transition in it, if these come first."""
        self.tests_ahead = False
        """True if conditions of a chart that executes actions first see its times as a scan later."""
        self.is_delayed = False
        """True if it is compared with other scans of the other side."""
        self._queue: tuple[tuple[Any, ...] | SfcError | None, ...] = ()
        self._seen: tuple[Any, ...] | None = None
        self._initial = self._state()
        self._observe: Callable[[], tuple[Any, ...]] = tuple
        self.also_counted: frozenset[str] = frozenset()
        """Names of called POUs that the other side has not, or not so: what of them is executed counts too."""
        self.not_followed: dict[str, type[SfcError]] = {}
        """By the names of variables, how a scan ends that leaves them TRUE; ``NOT x``: that leaves x FALSE."""
        self._not_followed: Callable[[], tuple[Any, ...]] = tuple
        self._followed: tuple[bool, ...] = ()
        self.is_unanswered = False
        """True if the other side cannot tell that a chart of this one never becomes stable."""

    @property
    def told_types(self) -> Mapping[str, Type]:
        """Types of undeclared names, in lower case, that their uses tell."""
        library = self._controller.library
        own = ((path.casefold(), type_) for path, type_ in library.undeclared.items())
        return {path: type_ for path, type_ in own if path not in library.assumed and isinstance(type_, ScalarType)}

    def needs_types(self, told: Mapping[str, Type]) -> bool:
        """Return True if types that are `told` are not those of undeclared names that are assumed to be BOOL here."""
        return any(told.get(path, BOOL) is not BOOL for path in self._controller.library.assumed)

    @property
    def inputs(self) -> dict[str, Signal]:
        """Variables that get their values from outside, with their types."""
        return {name: each.signal for name, each in self.variables.items() if each.is_input}

    def local_name(self, path: str) -> str:
        """Return the name by which the POU knows a variable, in lower case.

        A path to an address begins with the POU. S7 has a global variable of no list in a data block.
        """
        own, unlisted = f"{self.subject.pou.name}.", f"{TABLE}."
        if path in self.addresses and path.startswith(own):
            return path.removeprefix(own).casefold()
        alone = path.removeprefix(unlisted).casefold()
        return path.casefold() if re.split(r"[.\[]", alone)[0] in self._own_names else alone

    @cached_property
    def _own_names(self) -> frozenset[str]:
        return frozenset(variable.name.casefold() for variable in self.subject.pou.variables())

    @property
    def marks(self) -> Marks:
        """Branches of its texts that were executed."""
        marks = self._controller.library.marks
        assert marks is not None  # noqa: S101  # it is made with them
        return marks

    def reached(self) -> tuple[list[tuple[int, int, int]], list[bool]]:
        """Parts of its charts and texts that were executed so far."""
        charts = [(each.steps, each.transitions, each.actions) for each in self._chart_marks()]
        return charts, [*self.marks.reached]

    def forget(self, before: tuple[list[tuple[int, int, int]], list[bool]]) -> None:
        """Count only what had been executed when `reached` gave this."""
        charts, texts = before
        for each, (steps, transitions, actions) in zip(self._chart_marks(), charts, strict=True):
            each.steps, each.transitions, each.actions = steps, transitions, actions
        self.marks.reached[: len(texts)] = texts

    def recall(self, before: tuple[list[tuple[int, int, int]], list[bool]]) -> None:
        """Count what had been executed when `reached` gave this, too."""
        charts, texts = before
        for each, (steps, transitions, actions) in zip(self._chart_marks(), charts, strict=True):
            each.steps |= steps
            each.transitions |= transitions
            each.actions |= actions
        self.marks.reached[: len(texts)] = map(or_, texts, self.marks.reached)

    def _chart_marks(self) -> list[Reached]:
        units = self._controller.library.units.values()  # charts of called programs are none of an instance in it
        charts = [chart for unit in units for _, chart in unit.charts]
        return list({id(c): c.reached for c in charts if isinstance(c, RunningChart)}.values())

    def frozen(self) -> list[str]:
        """Return the variables that it reads, that nothing writes, and that are no inputs."""
        inputs = {*self._fixed, *self._options.get("not_free", ())}
        return sorted(set(self._controller.library.use.frozen()) - inputs, key=str.casefold)

    def bit_patterns(self, signal: Signal) -> Iterator[int]:
        """Yield the integers of a type by which its bits may be told apart; none where it looks at no bits.

        Those are single bits and masks, and what gives a number of the texts when it is shifted.
        """
        library = self._controller.library
        if signal.kind is not SignalKind.INTEGER or not (library.use.masks or library.use.shifts):
            return
        width = (signal.greatest - signal.least).bit_length()
        for mask in library.use.masks:
            yield from (mask, ~mask)
        for number in library.use.numbers:
            for shift in (0, *(each for each in library.use.shifts if 0 < each < width)):
                low = (1 << shift) - 1
                yield from (number << shift, number << shift | low, number >> shift | (number & low) << width - shift)

    def text_lengths(self, signal: Signal) -> Iterator[int]:
        """Yield lengths that tell texts of a type apart: those of other texts, and numbers in the programs."""
        lengths = {each.signal.length for each in (*self.variables.values(), *self.members.values())}
        around = {length + more for length in (*self._controller.library.use.numbers, *lengths) for more in (-1, 0, 1)}
        yield from sorted(length for length in {*around, signal.length} if 0 < length <= signal.length)

    def not_driven(self) -> list[str]:
        """Return the inputs that it reads and that keep their values, because no few values can represent them."""
        return self._controller.library.use.not_given()

    def writes(self, path: str) -> bool:
        """Return True if it may write a variable. Outputs of unknown blocks are known from their calls."""
        unknown = self._controller.library.unknown
        if unknown is not None and unknown.owns(path):
            return False
        return is_written(self.instance, path)

    @property
    def writes_anything(self) -> bool:
        """True if it has a chart, or any statement that writes."""
        return bool(self.instance.charts() or self._controller.library.use.written)

    @property
    def size(self) -> int:
        """Number of its variables, with the internal ones of its charts."""
        return len(self.instance.frame.layout.fields)

    def marking(self) -> int:
        """Return the active steps of the chart that the POU is, as bits in the order of `chart_steps`."""
        return self._chart_marking()

    def _all_steps(self) -> tuple[tuple[str, ...], Callable[[], int]]:
        """Return the steps of the chart that the POU is, and of those that its actions are (``Sub.Fill``)."""
        names, main = self.chart_steps, self._chart_marking
        paths = list(names)
        inner: list[tuple[int, RunningChart]] = []
        own = self.instance.frame
        for path, chart, frame in self.instance.charts():
            if path and frame is own and isinstance(chart, RunningChart):
                inner.append((len(paths), chart))
                paths += [f"{path}.{step.path}" for step in chart.net.steps]
        if not inner:
            return names, main

        def marking() -> int:
            return main() | sum(chart.marking(own) << start for start, chart in inner)

        return tuple(paths), marking

    def connect(self, names: Mapping[str, str], fixed: Mapping[str, Value]) -> None:
        """Read inputs by the names that both systems share (`names`: own to shared), some of them as constants."""
        self._names = {own.casefold(): shared for own, shared in names.items()}
        self._fixed = {own.casefold(): value for own, value in fixed.items()}

    def shared_names(self) -> Mapping[str, str]:
        """Its inputs, in lower case, by the names that both systems share."""
        return self._names

    def observe(self, observations: Iterable[Observation]) -> None:
        """Say what `observed` gives."""
        wanted = list(observations)
        self._look_at([each.path for each in wanted if not each.bit])
        read = self._reader([each.path for each in wanted if not each.bit])
        if not any(each.bit or each.equals is not None for each in wanted):
            self._observe = read
            return

        places = iter(range(len(wanted)))
        plan = [(each.bit, each.follows, each.equals, 0 if each.bit else next(places)) for each in wanted]
        has_bits = any(each.bit for each in wanted)
        following = following_situation(self.instance) if any(each.follows for each in wanted) else int

        def observed() -> tuple[Any, ...]:
            values = read()
            marking = self._marking() if has_bits else 0
            next_marking = following()
            # of a step its bit, of a variable its value, of a test if it is met
            return tuple(
                [
                    (next_marking if follows else marking) & bit != 0
                    if bit
                    else values[place]
                    if equals is None
                    else bool(asked(values[place]) == equals)
                    for bit, follows, equals, place in plan
                ]
            )

        self._observe = observed

    def _reader(self, paths: Sequence[str]) -> Callable[[], tuple[Any, ...]]:
        """Return a function that gives the values of some variables, also of inputs that the scan has not read."""
        read = self.instance.reader(paths)
        given = {path.casefold() for path in self.instance.inputs()}
        if given.isdisjoint(path.casefold() for path in paths):
            return read
        return lambda: tuple(
            [self._unasked(path) if value is UNREAD else value for path, value in zip(paths, read(), strict=True)]
        )

    def _unasked(self, path: str) -> Any:
        found = Unasked(self._names.get(path.casefold(), path), partial(self._input, path))
        return found.ask() if self.is_delayed or path.casefold() in self._fixed else found

    def part(self, pou: Pou, observations: Sequence[Observation]) -> ProgramSystem:
        """Return a system of a part of its POU, at the same times, in which some of the same things are observed."""
        made = ProgramSystem(replace(self.subject, pou=pou), self.profile, self.clock, **self._options)
        own = {"begins": self._begins, "kept": self._kept, "alone": self._alone}
        made.holds_start, made.tests_ahead = self.holds_start, self.tests_ahead
        made.delay(**own, at_rest=self._at_rest, late=self._late, unseen=self._unseen)
        made.also_counted = self.also_counted
        made.is_unanswered = self.is_unanswered
        for name, kind in self.not_followed.items():
            made.leave_out(name, kind)
        bits = {path: 1 << index for index, path in enumerate(made.steps)}
        made.observe([replace(each, bit=bits[each.path]) if each.bit else each for each in observations])
        return made

    def delay(
        self,
        *,
        begins: int = 0,
        kept: int = 0,
        alone: int = 0,
        at_rest: Mapping[str, Value] = _NONE,
        late: Mapping[str, Value] = _NONE,
        unseen: bool = False,
    ) -> None:
        """Begin some scans later, or be compared with what the other side does some scans later.

        In the first `alone` scans, before the other side begins or tests transitions, the inputs `at_rest` have these
        values; the inputs `late` have those of the scan before, these at first. They are named in lower case. `unseen`:
        what it does in the `alone` scans has no counterpart.
        """
        self._begins, self._kept, self._alone = begins, kept, alone if at_rest or unseen else 0
        self._at_rest, self._unseen = at_rest, unseen
        self.is_delayed = bool(begins or kept or self._alone or late)
        self._resting = _NONE
        self._late, self._held = late, dict(late)

    @property
    def lag(self) -> int | None:
        """By how many scans it is compared with what the other side does later; None: it begins otherwise, too."""
        return None if self._kept and (self._begins or self._alone or self._late) else self._kept

    @property
    def is_retimable(self) -> bool:
        """True if its scans can be cut behind the actions: it is a chart, and the only one that it executes."""
        paths = [path for path, _, _ in self.instance.charts()]
        if len(self.subject.pou.bodies) != 1 or paths.count("") != 1:
            return False
        others = {re.split(r"[.\[]", path)[0].casefold() for path in paths if path}
        return not others or self._named.isdisjoint(others)

    @cached_property
    def _named(self) -> set[str]:
        """The names in the texts that it may execute: its bodies, and its actions and methods that are named there."""
        pou, dialect = self.subject.pou, self.subject.project.dialect
        named = {name for body in pou.bodies for name in names_in(body, dialect)}
        if inheritance(pou.interface).extends:  # the texts of its base are executed, too
            named |= {each.name.casefold() for each in pou.actions}
            named |= {variable.name.casefold() for variable in pou.variables()}
        return with_called(named, (*pou.actions, *pou.methods, *pou.transitions), dialect)

    def leave_out(self, name: str, kind: type[SfcError] = LeftOutError) -> None:
        """End scans that leave a variable TRUE with an error, or FALSE (``NOT Button``).

        Raises `ModelError` for an unknown name.
        """
        self.not_followed[name] = kind
        self._not_followed = self.instance.reader([each.removeprefix(_NOT) for each in self.not_followed])
        self._followed = tuple(each.startswith(_NOT) for each in self.not_followed)
        self._look_at([name.removeprefix(_NOT)])

    def _look_at(self, paths: Iterable[str]) -> None:
        """Variables are read at the end of scans. The state is the one before the first scan then."""
        self.reset()
        self._looked_at += paths
        self._forget = self._forgetting()
        found = dead_cells(self.instance, self._looked_at)
        own = self.instance.frame.v
        self.instance.leave_out(frozenset(slot for cells, slot, _ in found if cells is own))
        self._dead = [each for each in found if each[0] is not own]
        self._timers = waiting_timers(self.instance, self._looked_at, self.clock.scan_time)
        self._initial = self._state()

    def reset(self) -> None:
        """Go to the state before the first scan."""
        self.instance.restore(self._initial)
        self.instance.scans = 0  # errors tell the scan of this run, not of all that were searched
        self._waiting = self._begins or self._alone
        self._queue = (None,) * self._kept
        self._held = dict(self._late)

    def scan(self, read: InputReader, *, first: bool) -> None:
        """Run one scan."""
        if not self.is_delayed:
            self._scan(read, first=first)
            return
        self._seen = None
        is_unseen = self._unseen and self._waiting > 0
        if self._waiting > 0:
            self._waiting -= 1
            if self._begins:
                return
            self._resting = self._at_rest
        else:
            self._resting = _NONE
            if self._begins:
                first = self._waiting == 0
                self._waiting = _BEGUN
        if not self._kept:
            self._scan(read, first=first)
            self._seen = None if is_unseen else self.observed_now()
            return
        self._seen = self._in_turn(read, first=first)

    def _in_turn(self, read: InputReader, *, first: bool) -> tuple[Any, ...] | None:
        """Run one scan, and give what the scan has come to with which the other side is to be compared now."""
        last = self._queue[-1]
        if isinstance(last, SfcError):  # it has ended, which is compared in its turn
            now: tuple[Any, ...] | SfcError = last
        else:
            try:
                self._scan(read, first=first)
                now = self.observed_now()
            except SimulationError as error:
                if end_of([error, None]) is not None or hidden_reason(error) is not None:
                    raise
                now = error
        turn, *rest = (*self._queue, now)
        self._queue = tuple(rest)
        if isinstance(turn, SfcError):
            raise turn
        return turn

    def _scan(self, read: InputReader, *, first: bool) -> None:
        self._source = read
        processor = self._controller.library.processor
        processor.holding = self.holds_start and first
        processor.ahead = self.clock.scan_time if self.tests_ahead else 0
        searching = getattr(read, "__self__", None)
        self.unknown_calls.begin_scan(searching if isinstance(searching, Branching) else None)
        if not first:
            self._controller.now += self.clock.scan_time
        given = {name: self._given(name) for name in self._late}  # a later scan asks for them, if this one does or not
        try:
            self.instance.scan()
        except UnstableChartError as error:
            if self.is_unanswered:
                raise UnansweredInstabilityError(error.message, location=error.location, hint=error.hint) from None
            raise
        self._held = given
        if self.not_followed and (values := self._not_followed()) != self._followed:
            wrong = map(ne, values, self._followed)
            name, kind = next(compress(self.not_followed.items(), wrong))
            raise kind(f"{name} = TRUE")

    @cached_property
    def uncalled_actions(self) -> tuple[str, ...]:
        """The actions of a POU that no text of the project names and whose body is no chart: nothing executes them."""
        pou = self.subject.pou
        if pou.chart is not None:
            return ()
        return tuple(f"{pou.name}.{action.name}" for action in uncalled_actions(pou, self.subject.project))

    def called_pous(self) -> dict[str, Pou]:
        """Return the POUs of the project whose texts it executes besides its own, by their names."""
        owners = {re.split(r"[. ]", branch.owner)[0] for branch in self.marks.branches}
        owners |= {unit.pou.name for unit in self.instance.controller.library.units.values() if unit.charts}
        return {p.name: p for p in self.subject.project.pous if p.name in owners and p.name != self.subject.pou.name}

    def pass_time(self, scans: int) -> None:
        """Skip the time of some scans in which nothing but clocks would go on."""
        self._controller.now += scans * self.clock.scan_time
        self.instance.scans += scans

    def observed(self) -> tuple[Any, ...] | None:
        """Return the values to compare; None: this scan has no counterpart."""
        return self._seen if self.is_delayed else self.observed_now()

    def observed_now(self) -> tuple[Any, ...]:
        """Return the values to compare now or later."""
        return (*self._observe(), self._calls()) if self._observes_calls else self._observe()

    @property
    def fixed(self) -> Mapping[str, Value]:
        """The inputs that keep a value, by their names in lower case."""
        return self._fixed

    @property
    def unknown(self) -> tuple[str, ...]:
        """The functions and blocks that are called, and that the project does not have."""
        blocks = self._controller.library.unknown
        return tuple(blocks.names) if blocks is not None else ()

    @property
    def calls_blocks(self) -> bool:
        """True if a call of something unknown is a statement."""
        return bool(self._controller.library.unknown)

    def observe_calls(self) -> None:
        """Compare the calls of unknown functions and blocks that are statements, too."""
        self._observes_calls = True

    def _calls(self) -> str:
        """Return the calls of the present scan: those of an instance in their order, whatever was called in between."""
        return "; ".join(f"{name}({given})" for name, given in sorted(self.unknown_calls.log, key=itemgetter(0)))

    def snapshot(self) -> Any:
        """Return the state, without absolute times, and without what no later scan will see."""
        state = self._state()
        return (state, self._waiting, self._queue, tuple(self._held.items())) if self.is_delayed else state

    def _state(self) -> Any:
        now = self._controller.now
        for frame, forget in self._forget:
            forget(frame, now)
        self._clamp(now)
        for cells, index, value in self._dead:
            cells[index] = value
        return self.instance.snapshot()  # timers end by themselves, whatever their times come from

    def restore(self, snapshot: Any) -> None:
        """Go back to a state."""
        if self.is_delayed:
            snapshot, self._waiting, self._queue, held = snapshot
            self._held = dict(held)
        self.instance.restore(snapshot)

    def values(self, names: Iterable[str]) -> tuple[Any, ...]:
        """Return the present values of variables."""
        return tuple(self.instance.reader(list(names))())

    def _forgetting(self) -> list[tuple[Frame, Callable[[Frame, int], None]]]:
        """Return the statements that set back the times of steps."""
        found: list[tuple[Frame, Callable[[Frame, int], None]]] = []
        names = self.times.names.union(path.rpartition(".")[2].casefold() for path in self._looked_at)
        for _, chart, frame in self.instance.called_charts():
            if isinstance(chart, RunningChart):
                found.append((frame, chart.forgetting(self.times.anywhere, self.times.read, names)))
        return found

    def _clamp(self, now: int) -> None:
        """Set the times that charts and timers keep back to the limit beyond which they make no difference."""
        for timer in self._timers:
            timer.clamp(now)
        limit = self.times.limit
        if limit is None:
            return
        earliest = now - limit
        for cells, slot in self._starts:
            if cells[slot] is not None and cells[slot] < earliest:
                cells[slot] = earliest
        for cells, slot in self._elapsed:
            if cells[slot] > limit:  # noqa: PLR1730  # min() takes longer, for every step in every state
                cells[slot] = limit

    def _input(self, path: str) -> Any:
        key = path.casefold()
        return self._held[key] if key in self._late else self._given(path)

    def _given(self, path: str) -> Any:
        """Return the value that an input gets in this scan."""
        key = path.casefold()
        if key in self._fixed:
            return self._fixed[key]
        if key in self._resting:
            return self._resting[key]
        return self._source(self._names.get(key, path))


def _no_input(path: str) -> Any:
    raise ModelError(f"{path} is read outside of a scan")
