"""Timers whose elapsed time makes no difference beyond a limit.

Lowered charts measure the time of a step with an on-delay that never ends (``Fill_time.ET >= T#5s``). Its elapsed time
would go on growing for days while the step waits for something else, and every millisecond would be a state: beyond the
greatest constant that it is compared with that makes no difference. And a timer that an action started and nobody calls
any more would go on growing forever: once its time is over it makes no difference when it was started.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

from plcopen_sfc.analysis.clocking import Clocking
from plcopen_sfc.analysis.sole_bodies import all_nodes
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.effects import plain_path
from plcopen_sfc.languages.st.literals import LiteralError, LiteralKind, literal_value
from plcopen_sfc.languages.st.walking import children
from plcopen_sfc.semantics.programs.controller import Instance
from plcopen_sfc.semantics.programs.types import INSTANT, Frame, Layout, StructureType

__all__ = ["RunningClocks", "WaitingTimer", "waiting_timers"]

_ON_DELAYS = frozenset({"TON", "LTON", "TON_TIME", "TON_LTIME"})
_COMPARING = frozenset(
    {
        n.Operator.EQUAL,
        n.Operator.UNEQUAL,
        n.Operator.LESS,
        n.Operator.GREATER,
        n.Operator.LESS_OR_EQUAL,
        n.Operator.GREATER_OR_EQUAL,
    }
)
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
    """The on-delays of a POU whose times are constants, if all calls of them are known.

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
        limit = max(presets) + scan_time + _ROUNDING
        if name not in uses.read:
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
    """What is done with some timers.

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
        if isinstance(node, n.Operation) and node.operator in _COMPARING:
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
        """The value of a literal duration in nanoseconds; None: it is none."""
        node = n.bare(node) if node is not None else None
        if not isinstance(node, n.Literal):
            return None
        try:
            literal = literal_value(node, self._dialect)
        except LiteralError:
            return None
        return literal.value if literal.kind is LiteralKind.DURATION and isinstance(literal.value, int) else None


STEADY = 2
"""Scans after the end of a clock in which it is still waited for."""


class RunningClocks:
    """The clocks that run in an instance, and the cells in it that are none."""

    def __init__(self, instance: Instance) -> None:
        self._controller = instance.controller
        self._starts: list[tuple[list[Any], int]] = []
        self._rest: list[tuple[list[Any], int]] = []
        self._seen: set[int] = set()
        for frame in (instance.frame, instance.controller.library.frame):
            self._look(frame)

    def _look(self, frame: Frame) -> None:
        if id(frame) in self._seen:
            return
        self._seen.add(id(frame))
        types = [field.type for field in frame.layout.fields]
        times = INSTANT in types
        for slot, (type_, value) in enumerate(zip(types, frame.v, strict=False)):
            if type_ is INSTANT:
                self._starts.append((frame.v, slot))
            elif isinstance(value, Frame):
                self._look(value)
            elif isinstance(value, list):
                for item in value:
                    if isinstance(item, Frame):
                        self._look(item)
            elif not (times and getattr(type_, "name", "") in ("TIME", "LTIME")) and not _is_elapsed(type_):
                self._rest.append((frame.v, slot))

    def still(self) -> list[Any]:
        """The values of all that is no clock."""
        return [cells[slot] if not isinstance(cells[slot], list) else None for cells, slot in self._rest]

    def next_end(self, clock: Clocking) -> int | None:
        """In how many scans the next clock ends, if one runs; one that has just ended is waited for.

        A condition may want more than the time, or see it a scan later.
        """
        now = self._controller.now
        past = STEADY * clock.scan_time
        left = [
            constant - (now - start)
            for cells, slot in self._starts
            if (start := cells[slot]) is not None
            for constant in clock.constants
            if constant + past > now - start
        ]
        return min(left) // clock.scan_time if left else None


def _is_elapsed(type_: Any) -> bool:
    return getattr(type_, "unit", 0) == 1 and getattr(type_, "length", 0) == 1
