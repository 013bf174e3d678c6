"""Storing what a frame holds and putting it back, millions of times in a search: by functions made for its layout.

The source of these functions holds numbers only (decision 0018). What is stored is one flat tuple.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

from plcopen_sfc.semantics.programs import types as t
from plcopen_sfc.semantics.programs.types import Direction, Field, Frame, Layout, Type

_Store = Callable[[list[Any], int, int | None], tuple[Hashable, ...]]
_Load = Callable[[list[Any], Any, int], None]


@dataclass(slots=True)
class _Plan:
    """How a layout is stored and put back; `counts` are the variables of all layouts in it at that time."""

    store: _Store
    store_limited: _Store
    load: _Load
    counts: dict[Layout, int]

    @property
    def is_current(self) -> bool:
        """True if no layout has grown since."""
        for layout, count in self.counts.items():  # noqa: SIM110  # all() takes twice as long, for every state
            if len(layout.fields) != count:
                return False
        return True


class Snapshots:
    """Stores and puts back what a frame holds: all that a later scan can see, relative to the present."""

    def __init__(self) -> None:
        self._plans: dict[tuple[Layout, frozenset[int]], _Plan] = {}

    def store(self, frame: Frame, now: int, limit: int | None, leave_out: frozenset[int] = frozenset()) -> Hashable:
        """Values that `frame` holds, but for some slots. Times that go on growing are not stored beyond `limit`."""
        plan = self._plan(frame.layout, leave_out)
        return (plan.store if limit is None else plan.store_limited)(frame.v, now, limit)

    def load(self, frame: Frame, stored: Any, now: int, leave_out: frozenset[int] = frozenset()) -> None:
        """Put back what `store` gave."""
        self._plan(frame.layout, leave_out).load(frame.v, stored, now)

    def _plan(self, layout: Layout, leave_out: frozenset[int]) -> _Plan:
        plan = self._plans.get((layout, leave_out))
        if plan is None or not plan.is_current:
            plan = self._plans[layout, leave_out] = _Writer().plan(layout, leave_out)
        return plan


@dataclass
class _Writer:
    """Writes the functions of one layout, or the loops of an array at some `depth` of arrays.

    `stored` and `limited` are items of the tuple, `loads` are statements.
    """

    depth: int = 0
    stored: list[str] = field(default_factory=list)
    limited: list[str] = field(default_factory=list)
    loads: list[str] = field(default_factory=list)
    counts: dict[Layout, int] = field(default_factory=dict)
    size: int = 0
    """How many items the tuple has: an item of `stored` may be several."""

    def plan(self, layout: Layout, leave_out: frozenset[int]) -> _Plan:
        """The functions."""
        self._frame("v", layout, leave_out)
        source = [
            f"def store(v, now, limit): return ({_items(self.stored)})",
            f"def store_limited(v, now, limit): return ({_items(self.limited)})",
            "def load(v, s0, now):",
            *(f" {line}" for line in self.lines()),
        ]
        return _Plan(*_functions("\n".join(source)), self.counts)

    def _frame(self, v: str, layout: Layout, leave_out: frozenset[int] = frozenset()) -> None:
        self.counts[layout] = len(layout.fields)
        run: list[int] = []
        for variable in self._seen(layout, leave_out):
            if not _is_plain(variable.type):
                continue
            if run and variable.slot != run[-1] + 1:
                self._run(v, run)
                run = []
            run.append(variable.slot)
        self._run(v, run)
        for variable in self._seen(layout, leave_out):
            if not _is_plain(variable.type):
                self._value(f"{v}[{variable.slot}]", variable.type)

    def _seen(self, layout: Layout, leave_out: frozenset[int]) -> Iterator[Field]:
        """The variables that a later scan can see."""
        for variable in layout.fields:
            kept = variable.direction not in (Direction.CONSTANT, Direction.IN_OUT) and variable.retained
            if kept and variable.slot not in leave_out:
                yield variable

    def _run(self, v: str, slots: list[int]) -> None:
        """Plain values in slots behind each other."""
        if slots:
            values = f"{v}[{slots[0]}:{slots[-1] + 1}]"
            self._add(
                f"*{values}",
                f"*{values}",
                f"{values} = s{self.depth}[{self.size}:{self.size + len(slots)}]",
                len(slots),
            )

    def _value(self, place: str, type_: Type) -> None:
        """A value that is no plain one."""
        at = f"s{self.depth}[{self.size}]"
        if isinstance(type_, t.StructureType):
            self._frame(f"{place}.v", type_.layout)
        elif type_ is t.INSTANT:
            age = f"now - {place}"
            self._add(
                f"None if {place} is None else {age}",
                f"None if {place} is None else min({age}, limit)",
                f"{place} = None if {at} is None else now - {at}",
            )
        elif type_ is t.ELAPSED:
            self._add(place, f"min({place}, limit)", f"{place} = {at}")
        elif isinstance(type_, t.ArrayType):
            self._array(place, at, type_)

    def _array(self, place: str, at: str, type_: t.ArrayType) -> None:
        if _is_plain(type_.base):
            self._add(f"tuple({place})", f"tuple({place})", f"{place}[:] = {at}")
            return
        element = _Writer(depth=self.depth + 1, counts=self.counts)
        index = f"i{element.depth}"
        element._value(f"{place}[{index}]", type_.base)
        stored, limited = (
            f"tuple([({_items(items)}) for {index} in range(len({place}))])"
            for items in (element.stored, element.limited)
        )
        loop = f"for {index}, s{element.depth} in enumerate({at}):"
        self._add(stored, limited, "\n".join([loop, *(f" {line}" for line in element.lines())]))

    def _add(self, stored: str, limited: str, load: str, size: int = 1) -> None:
        self.stored.append(stored)
        self.limited.append(limited)
        self.loads.append(load)
        self.size += size

    def lines(self) -> list[str]:
        """The lines of the statements."""
        return [line for load in self.loads or ["pass"] for line in load.split("\n")]


@lru_cache(maxsize=4096)  # a comparison makes the same program more than once
def _functions(source: str) -> tuple[_Store, _Store, _Load]:
    """Return the functions with this source."""
    made: dict[str, Any] = {}
    exec(compile(source, "<snapshot>", "exec"), made)  # noqa: S102  # numbers of slots, nothing else
    return made["store"], made["store_limited"], made["load"]


def _is_plain(type_: Type) -> bool:
    """True if a value is stored as it is."""
    return not isinstance(type_, t.StructureType | t.ArrayType) and type_ is not t.INSTANT and type_ is not t.ELAPSED


def _items(items: list[str]) -> str:
    return "".join(f"{item}, " for item in items)
