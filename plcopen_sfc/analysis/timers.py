"""Use of times in programs, and timers whose elapsed time makes no difference beyond a limit.

Lowered charts measure the time of a step with an on-delay that never ends (``Fill_time.ET >= T#5s``). Its elapsed time
would go on growing for days while the step waits for something else, and every millisecond would be a state: beyond the
greatest constant that it is compared with that makes no difference. And a timer that an action started and nothing
calls any more would go on growing forever: once its time is over it makes no difference when it was started.

`Clocking` and `StepTimes` bound how far a search must follow times, and in which steps.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from operator import itemgetter
from typing import Any, TypeGuard

from plcopen_sfc.analysis.dead_variables import all_nodes
from plcopen_sfc.languages.binding import BoundText, bind, texts_in
from plcopen_sfc.languages.binding.name_scopes import with_inner_charts
from plcopen_sfc.languages.binding.text_sites import Role, SiteKind
from plcopen_sfc.languages.effects import plain_path
from plcopen_sfc.languages.networks.network_graph import wires_of
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_condition, walk
from plcopen_sfc.languages.st.literals import duration_of
from plcopen_sfc.languages.st.walking import children
from plcopen_sfc.model.body import FbdBody, LdBody
from plcopen_sfc.model.conditions import Expression, WiredCondition
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.sfc import BodyCondition, SfcNetwork
from plcopen_sfc.semantics.charts.grafcet.term_evaluation import TermTexts
from plcopen_sfc.semantics.programs.controller import Instance
from plcopen_sfc.semantics.programs.runtime_types import ELAPSED, INSTANT, Frame, Layout, StructureType
from plcopen_sfc.semantics.subjects import Subject

_CLOCKS = frozenset({"time", "rd_sys_t", "time_tck"})
_TIMES = frozenset({"T", "U"})
_DEFAULT_SCAN = 10_000_000


@dataclass(frozen=True)
class Clocking:
    """Advance of time in a search.

    `scan_time` in nanoseconds; `constants` are the durations in the programs; `reason` tells why no finite number of
    states can represent all times.
    """

    scan_time: int
    constants: tuple[int, ...] = ()
    reason: str = ""


@dataclass(frozen=True)
class StepTimes:
    """Use that a program makes of the times and other data of the steps of its charts.

    Elapsed times beyond `limit` make no difference any more (None: they may). `read` are the steps of which a text
    reads the time, `anywhere` those of which one does elsewhere than in the conditions behind them. `names` are all
    that texts have but those of what a member is read of: ``V1`` and not ``Clamp`` of ``Clamp.V1``. Names are in lower
    case.
    """

    limit: int | None
    anywhere: frozenset[str]
    read: frozenset[str]
    names: frozenset[str]


def clocking(subjects: Sequence[Subject], scan_time: int | None) -> Clocking:
    """Look through programs for the durations in them.

    Without `scan_time` it is half of the greatest one that all durations are multiples of, so that every duration ends
    in a scan and there is one before and one after it; 10 ms without durations.
    """
    texts = [text for subject in subjects for text in _texts(subject)]
    constants = sorted(_constants(texts))
    if scan_time is None:
        common = math.gcd(*constants)
        scan_time = (common // 2 if common % 2 == 0 else common) or _DEFAULT_SCAN
    reads_clock = any(use.role is Role.CALL and use.name.casefold() in _CLOCKS for text in texts for use in text.uses)
    return Clocking(scan_time, tuple(constants), "the program reads the clock" if reads_clock else "")


def _constants(texts: Iterable[BoundText]) -> set[int]:
    """Return the durations that times are compared with, or that timers are started with."""
    literals = (node for text in texts for tree in _trees(text) for node in walk(tree) if isinstance(node, n.Literal))
    return {value for literal in literals if (value := duration_of(literal)) is not None and value > 0}


def step_times(subject: Subject, scan_time: int) -> StepTimes:
    """Look through a program for what it does with the times of steps, which it alone sees."""
    texts = _texts(subject)
    charts = [inner for _, _, chart in subject.project.charts() for inner in with_inner_charts(chart)]
    reads = [read for text in texts for read in _reads_of_times(text)]
    steps = [step for chart in charts for step in chart.steps]
    durations = [a.duration for step in steps for a in step.actions]
    durations += [time for step in steps for time in (step.min_time, step.max_time, step.warning_time)]
    known = all(duration is None or duration_of(duration) is not None for duration in durations)
    plain = all(read.is_compared for read in reads)
    limit = max(_constants(texts), default=0) + scan_time if plain and known else None
    names = frozenset(name for text in texts for tree in _trees(text) for name in _names_in(tree))
    return StepTimes(limit, *_steps_read(charts, [read.step for read in reads], subject.project.dialect), names)


def _names_in(tree: n.Node) -> Iterator[str]:
    """Yield the names in a tree, in lower case, but for those that a member is named of."""
    pending = [tree]
    while pending:
        node = pending.pop()
        if isinstance(node, n.Name):
            yield node.identifier.casefold()
        elif isinstance(node, n.Member) and isinstance(node.base, n.Name):
            yield node.name.identifier.casefold()
        else:
            pending += children(node)


def _steps_read(
    charts: Sequence[SfcNetwork], reads: Iterable[str], dialect: Dialect
) -> tuple[frozenset[str], frozenset[str]]:
    """Return the names of steps whose time is read when they are not active, and of those whose time is read."""
    read = Counter(reads)
    own: Counter[str] = Counter()
    if any(_has_wired_times(chart) for chart in charts):
        read.update(step.name.casefold() for chart in charts for step in chart.steps)
    for chart in charts:
        for step in chart.steps:
            key = step.name.casefold()
            if key in read:
                behind = [transition.condition for transition in chart.outgoing(step)]
                conditions = [each for each in behind if isinstance(each, Expression | BodyCondition)]
                texts = [text for each in conditions for text in texts_in(each, dialect)]
                own[key] += sum(found.step == key for text in texts for found in _reads_of_times(text))
    # conditions behind a step are tested only while it is active; other texts read its time when it is not, too
    anywhere = frozenset(name for name, count in read.items() if count != own[name])
    return anywhere, frozenset(read)


def _has_wired_times(chart: SfcNetwork) -> bool:
    """True if a wire leads from the time of a step."""
    wired = [t.condition.input for t in chart.transitions if isinstance(t.condition, WiredCondition)]
    wires = [*(wire for node in chart.logic for wire in wires_of(node)), *(w for pin in wired for w in pin.connections)]
    return any(wire.pin in _TIMES for wire in wires)


@dataclass(frozen=True)
class _TimeRead:
    """A text that reads the time of a step; `is_compared`: it does nothing else than compare it with a constant."""

    step: str
    is_compared: bool


def _reads_of_times(text: BoundText) -> Iterator[_TimeRead]:
    """Yield the reads of times in a text, each as often as it is there; all its names where it cannot be read."""
    if text.text_site.reading is SiteKind.FOREIGN:
        return
    for tree in _trees(text):
        for read in _reads_in(tree):
            yield _TimeRead(read.step, read.is_compared or _is_compared_by_boxes(text))
        unread = (node for node in walk(tree) if isinstance(node, n.Unreadable))
        yield from (_TimeRead(use.name.casefold(), False) for _ in unread for use in text.uses)


def _reads_in(tree: n.Node) -> Iterator[_TimeRead]:
    """Yield the reads of times in a tree, by their places: pins of a network with equal texts share their nodes."""
    pending = [tree]
    while pending:
        node = pending.pop()
        compared = _compared_time(node)
        if compared is not None:
            yield _TimeRead(_last_name(compared.base), True)
            continue
        if _is_time(node):
            yield _TimeRead(_last_name(node.base), False)
        pending += children(node)


def _compared_time(node: n.Node) -> n.Member | None:
    """Return the time of a step that a node compares with a constant, and nothing else."""
    if isinstance(node, n.Operation) and node.operator in n.COMPARISONS:
        first, second = map(n.bare, node.operands)
        for time, constant in ((first, second), (second, first)):
            if _is_time(time) and isinstance(constant, n.Literal) and duration_of(constant) is not None:
                return time
    return None


def _is_time(node: n.Node) -> TypeGuard[n.Member]:
    return isinstance(node, n.Member) and node.name.identifier.upper() in _TIMES


def _is_compared_by_boxes(text: BoundText) -> bool:
    """True for a text at a pin of a condition in FBD or LD that does nothing with times but compare them."""
    condition = text.text_site.site.transition
    body = condition.body if condition is not None else None
    if not isinstance(body, FbdBody | LdBody):
        return False
    bound = bind(body, text.dialect)
    return not bound.unknown and all(read.is_compared for tree in bound.trees for read in _reads_in(tree))


def _last_name(node: n.Expression) -> str:
    while isinstance(node, n.Index | n.Dereference | n.Parenthesized):
        node = node.inner if isinstance(node, n.Parenthesized) else node.base
    name = node.name if isinstance(node, n.Member) else node
    return name.identifier.casefold() if isinstance(name, n.Name) else ""


def _trees(text: BoundText) -> Iterator[n.Expression | n.Statement]:
    """Yield the trees of a text, and those of the edges and times of IEC 60848 in a condition (``3s/X5``)."""
    terms = TermTexts()
    read = terms.read(text.text_site.text) if isinstance(text.text_site.holder, Expression) else ""
    # /1B1 is no structured text before it was read as a condition of a GRAFCET: each name in it may be a time then
    is_unread = bool(read) and any(isinstance(node, n.Unreadable) for tree in text.trees for node in walk(tree))
    if not terms.edges and not terms.timers and not is_unread:
        yield from text.trees
        return
    texts = [read, *(edge.operand for edge in terms.edges)]
    for timer in terms.timers:
        texts += [timer.operand, *(time for time in (timer.first, timer.last) if time is not None)]
    yield from (parse_condition(each, text.dialect).tree for each in texts)


def _texts(subject: Subject) -> list[BoundText]:
    """Return the texts of the POU and of all that it may call, of global variables and of types."""
    project, dialect = subject.project, subject.project.dialect
    others = {pou.name: pou for pou in project.pous if pou.name != subject.pou.name}
    waiting, found = [subject.pou], list[BoundText]()
    while waiting:
        own = [*texts_in(waiting.pop(), dialect)]
        found += own
        names = {use.name.casefold() for text in own for use in text.uses}
        waiting += [others.pop(name) for name in [*others] if name.casefold() in names]
    for declared in (*project.global_variables, *project.data_types):
        found += texts_in(declared, dialect)
    return found


_ON_DELAYS = frozenset({"TON", "LTON", "TON_TIME", "TON_LTIME"})
_OUTPUTS = ("q", "et")
_ROUNDING = 1_000_000
"""Elapsed times are whole milliseconds at most."""


@dataclass(frozen=True)
class WaitingTimer:
    """The cells of an on-delay, and the elapsed time beyond which it makes no difference (nanoseconds)."""

    cells: list[Any]
    start: int
    elapsed: int
    limit: int

    def clamp(self, now: int) -> None:
        """Set the elapsed time back to the limit."""
        cells = self.cells
        if cells[self.start] is not None and now - cells[self.start] > self.limit:
            cells[self.start] = now - self.limit
        if cells[self.elapsed] > self.limit:  # noqa: PLR1730  # min() takes longer
            cells[self.elapsed] = self.limit


def waiting_timers(instance: Instance, observed: Collection[str], scan_time: int) -> list[WaitingTimer]:
    """Return the on-delays of a POU whose times are constants, if all calls of them are known.

    `observed` (paths) are variables that are looked at when a scan has ended.
    """
    frames = {
        field.name.casefold(): frame
        for field in instance.frame.layout.fields
        if _is_on_delay(field.type, instance) and isinstance(frame := instance.frame.v[field.slot], Frame)
    }
    nodes = all_nodes(instance) if frames else None
    if nodes is None:
        return []
    uses = _Uses(instance, frozenset(frames))
    for node in nodes:
        uses.look(node)
    for path in observed:
        uses.read.update(part.strip('"#') for part in path.casefold().split("."))
    found = []
    for name, frame in frames.items():
        presets = uses.presets.get(name)
        if name in uses.otherwise or not presets:
            continue
        # a scan beyond the last time that makes a difference: a scan earlier it might still make one
        limit = max(presets) + scan_time + _ROUNDING
        if name not in uses.read:  # not even Q, which turns at the preset
            limit = min(limit, max(uses.constants.get(name, ()), default=0) + scan_time + _ROUNDING)
        start, elapsed = frame.layout.find("START"), frame.layout.find("ET")
        if start is not None and elapsed is not None:
            found.append(WaitingTimer(frame.v, start.slot, elapsed.slot, limit))
    return found


def _is_on_delay(type_: object, instance: Instance) -> bool:
    if not isinstance(type_, StructureType) or type_.layout.name.upper() not in _ON_DELAYS:
        return False
    layout: Layout = type_.layout
    return instance.controller.library.block_of(layout) is not None


class _Uses:
    """Uses of some timers.

    `constants`: what their elapsed time is compared with; `presets`: their times; `read`: those of which more is read;
    `otherwise`: names that are used in any other way.
    """

    def __init__(self, instance: Instance, timers: frozenset[str]) -> None:
        self._dialect = instance.controller.project.dialect
        self._timers = timers
        self.constants: dict[str, list[int]] = {}
        self.presets: dict[str, list[int]] = {}
        self.read: set[str] = set()
        self.otherwise: set[str] = set()

    def look(self, node: n.Node) -> None:
        """Look through a statement or an expression."""
        if isinstance(node, n.Operation) and node.operator in n.COMPARISONS:
            first, second = node.operands
            if self._compared(first, second) or self._compared(second, first):
                return
        if isinstance(node, n.Call) and self._called(node):
            return
        path = plain_path(node) if isinstance(node, n.Member) else None
        if path is not None and len(path) == 2 and path[0] in self._timers and path[1] in _OUTPUTS:
            self.read.add(path[0])
            return
        if isinstance(node, n.Name):
            self.otherwise.add(node.identifier.casefold())
        for part in children(node):
            self.look(part)

    def _compared(self, time: n.Expression, constant: n.Expression) -> bool:
        path = plain_path(n.bare(time))
        value = self._duration(constant)
        if path is None or len(path) != 2 or path[0] not in self._timers or path[1] != "et" or value is None:
            return False
        self.constants.setdefault(path[0], []).append(value)
        return True

    def _called(self, call: n.Call) -> bool:
        """A call with IN and with a constant PT."""
        path = plain_path(call.callee)
        if path is None or len(path) != 1 or path[0] not in self._timers:
            return False
        given = {a.name.identifier.upper(): a.value for a in call.arguments if a.name is not None and not a.output}
        preset = self._duration(given.get("PT"))
        if len(given) != len(call.arguments) or given.keys() != {"IN", "PT"} or preset is None:
            return False
        self.presets.setdefault(path[0], []).append(preset)
        if given["IN"] is not None:
            self.look(given["IN"])
        return True

    def _duration(self, node: n.Expression | None) -> int | None:
        """Return the value of a literal duration in nanoseconds; None: it is none."""
        node = n.bare(node) if node is not None else None
        return duration_of(node, self._dialect) if isinstance(node, n.Literal) else None


STEADY = 2
"""Scans after the end of a clock in which it is still waited for."""


class RunningClocks:
    """The clocks that run in an instance, and the cells in it that are no clocks."""

    def __init__(self, instance: Instance) -> None:
        self._controller = instance.controller
        self._starts: list[tuple[list[Any], int]] = []
        self._rest: list[tuple[list[Any], Callable[[list[Any]], Any]]] = []
        self._seen: set[int] = set()
        for frame in (instance.frame, instance.controller.library.frame):
            self._look(frame)

    def _look(self, frame: Frame) -> None:
        if id(frame) in self._seen:
            return
        self._seen.add(id(frame))
        types = [field.type for field in frame.layout.fields]
        times = INSTANT in types
        rest: list[int] = []
        for slot, (type_, value) in enumerate(zip(types, frame.v, strict=False)):
            if type_ is INSTANT:
                self._starts.append((frame.v, slot))
            elif isinstance(value, Frame):
                self._look(value)
            elif isinstance(value, list):
                for item in value:
                    if isinstance(item, Frame):
                        self._look(item)
            # beside a start, a time is how long ago that was
            elif not (times and getattr(type_, "name", "") in ("TIME", "LTIME")) and type_ is not ELAPSED:
                rest.append(slot)
        if rest:
            self._rest.append((frame.v, itemgetter(*rest)))

    def still(self) -> list[Any]:
        """Return the values of all that is no clock."""
        return [values(cells) for cells, values in self._rest]

    def next_end(self, clock: Clocking) -> int | None:
        """Return in how many scans the next clock ends, if one runs; one that has just ended is waited for.

        A condition may want more than the time, or see it a scan later. One that was set in this scan, though nothing
        else has changed in it, is set in each: it tells when the last one was.
        """
        now = self._controller.now
        past = STEADY * clock.scan_time
        left = [
            constant - (now - start)
            for cells, slot in self._starts
            if (start := cells[slot]) is not None and start != now
            for constant in clock.constants
            if constant + past > now - start
        ]
        return min(left) // clock.scan_time if left else None
