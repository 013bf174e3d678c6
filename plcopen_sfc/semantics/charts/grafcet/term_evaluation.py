"""Edges and times in conditions of GRAFCET: ``↑a``, ``↓(a AND b)``, ``3s/X5``, ``3s/X5/2s``, ``X5/2s``.

IEC 60848:2013, 4.6 (transition conditions). An edge lasts for one evolution: it is TRUE when its operand has another
value than in the evolution before. ``t1/x/t2`` becomes TRUE when `x` was TRUE for t1, and stays so for t2 after `x`
has become FALSE: it is an on-delay with an off-delay behind. Program text knows neither: each term becomes a hidden
variable, and the condition is translated with its name in place of the term.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from plcopen_sfc.errors import Location, UnknownBehaviourError
from plcopen_sfc.languages.grafcet_conditions import ConditionError, to_structured_text
from plcopen_sfc.model import Condition, Expression
from plcopen_sfc.semantics.programs.routines import Routines
from plcopen_sfc.semantics.programs.runtime_types import BOOL, ELEMENTARY, INSTANT, Frame

if TYPE_CHECKING:
    from plcopen_sfc.semantics.programs.scopes import Scope


@dataclass(frozen=True, slots=True)
class EdgeTerm:
    """``↑operand``, or ``↓operand`` where it is not `rising`. `name` replaces it in the texts."""

    name: str
    operand: str
    rising: bool


@dataclass(frozen=True, slots=True)
class TimeTerm:
    """``first/operand/last``, the times as literals of program text (``T#3s``); None: without this delay."""

    name: str
    operand: str
    first: str | None
    last: str | None


class TermTexts:
    """Takes the terms out of texts. `edges` and `timers` are sorted: each needs only those before it."""

    def __init__(self) -> None:
        self._names: dict[tuple[str | bool | None, ...], str] = {}
        self.edges: list[EdgeTerm] = []
        self.timers: list[TimeTerm] = []

    def read(self, text: str) -> str:
        """Return a condition as structured text, a name in place of each term, the same for the same term.

        A text that is no condition of a GRAFCET is returned unchanged, for the parser of program text to refuse.
        """
        try:
            return self.readable(text)
        except ConditionError:
            return text

    def readable(self, text: str) -> str:
        """Return a condition as `read` does. Raises `ConditionError`."""
        return to_structured_text(text, self)

    def inner_first(self) -> list[str]:
        """Return the names of all terms, those that are in another one before it."""
        return list(self._names.values())

    def shown(self, text: str) -> str:
        """Return a text that has names of terms with the terms as people write them."""
        written = {edge.name: f"{'↑' if edge.rising else '↓'}{written_operand(edge.operand)}" for edge in self.edges}
        for timer in self.timers:
            parts = (timer.first, written_operand(timer.operand), timer.last)
            written[timer.name] = "/".join(part.removeprefix("T#") for part in parts if part is not None)
        found = re.sub(r"GRAFCET_(?:EDGE|TIME)_\d+", lambda name: written.get(name[0], name[0]), text)
        return found if found == text else self.shown(found)  # terms have terms in them

    def edge(self, operand: str, *, rising: bool) -> str:
        """Return the name of an edge."""
        term = ("edge", operand, rising)
        if term not in self._names:
            name = self._names[term] = f"GRAFCET_EDGE_{len(self._names) + 1}"
            self.edges.append(EdgeTerm(name, operand, rising))
        return self._names[term]

    def delay(self, operand: str, first: str | None, last: str | None) -> str:
        """Return the name of a time."""
        term = ("time", operand, first, last)
        if term not in self._names:
            name = self._names[term] = f"GRAFCET_TIME_{len(self._names) + 1}"
            self.timers.append(TimeTerm(name, operand, first, last))
        return self._names[term]


def written_operand(text: str) -> str:
    """Return the operand of an edge or a time, in parentheses where it needs some."""
    return text if re.fullmatch(r"[\w.]+|\(.*\)", text) else f"({text})"


def is_edge(name: str) -> bool:
    """True if a name replaces an edge in a text that was read."""
    return name.startswith("GRAFCET_EDGE_")


def is_term(name: str) -> bool:
    """True if a name replaces a term in a text that was read."""
    return is_edge(name) or name.startswith("GRAFCET_TIME_")


def has_edge(text: str) -> bool:
    """True if there is an edge in a text."""
    found = TermTexts()
    found.read(text)
    return bool(found.edges)


@dataclass(slots=True)
class _Edge:
    operand: str
    rising: bool
    slot: int
    before: int
    value: Callable[[Frame], bool] | None = None

    def update(self, frame: Frame, _now: int) -> None:
        assert self.value is not None  # noqa: S101  # translated before anything runs
        v, value = frame.v, self.value(frame)
        v[self.slot] = value is self.rising and v[self.before] is not self.rising
        v[self.before] = value


@dataclass(slots=True)
class _Timer:
    term: TimeTerm
    slot: int
    on_since: int
    off_since: int
    value: Callable[[Frame], bool] | None = None
    on_time: Callable[[Frame], int] | None = None
    off_time: Callable[[Frame], int] | None = None

    def update(self, frame: Frame, now: int) -> None:
        assert self.value is not None and self.on_time is not None and self.off_time is not None  # noqa: S101, PT018
        v = frame.v
        if not self.value(frame):
            v[self.on_since] = None
        elif v[self.on_since] is None:
            v[self.on_since] = now
        if v[self.on_since] is not None and now - v[self.on_since] >= self.on_time(frame):
            v[self.slot], v[self.off_since] = True, None
        elif v[self.slot]:
            if v[self.off_since] is None:
                v[self.off_since] = now
            if now - v[self.off_since] >= self.off_time(frame):
                v[self.slot], v[self.off_since] = False, None


class ChartTerms:
    """The terms of a chart, each with its hidden variable."""

    def __init__(self, scope: Scope, path: str) -> None:
        self._scope = scope
        self._path = path
        self._texts = TermTexts()
        self._edges: list[_Edge] = []
        self._timers: list[_Timer] = []
        self._inner_first: list[_Edge | _Timer] = []

    def __bool__(self) -> bool:
        return bool(self._edges or self._timers)

    def read(self, condition: Condition | None, where: str) -> Condition | None:
        """Return the condition at `where` without terms. Only while the chart is being declared."""
        if not isinstance(condition, Expression):
            return condition
        try:
            text = self._texts.readable(condition.text)
        except ConditionError as error:
            message = f"the condition {condition.text!r} cannot be read: {error}"
            raise UnknownBehaviourError(message, location=Location(path=where)) from error
        self._declare()
        return condition if text == condition.text else condition.model_copy(update={"text": text})

    def rising(self, condition: Condition, where: str) -> Condition:
        """Return the rising edge of a condition, unless it has an edge in it already."""
        return self.read(rising(condition), where) or condition

    def _declare(self) -> None:
        """Declare the variables of terms that are new."""
        hidden = self._scope.declare
        for edge in self._texts.edges[len(self._edges) :]:
            slot = hidden(edge.name, BOOL, hidden=True)
            before = hidden(f"{self._path}: {edge.name} before", BOOL, hidden=True)
            self._edges.append(_Edge(edge.operand, edge.rising, slot, before))
        for timer in self._texts.timers[len(self._timers) :]:
            slot = hidden(timer.name, BOOL, hidden=True)
            on, off = (hidden(f"{self._path}: {timer.name} {which}", INSTANT, hidden=True) for which in ("on", "off"))
            self._timers.append(_Timer(timer, slot, on, off))

    def translate(self) -> None:
        """Prepare the operands and times."""
        duration = ELEMENTARY["TIME"]
        for edge in self._edges:
            edge.value = Routines(self._scope).condition(Expression(text=edge.operand), self._path)
        for timer in self._timers:
            timer.value = Routines(self._scope).condition(Expression(text=timer.term.operand), self._path)
            timer.on_time = Routines(self._scope).expression(timer.term.first or "T#0s", self._path, duration)
            timer.off_time = Routines(self._scope).expression(timer.term.last or "T#0s", self._path, duration)

        made: dict[str, _Edge | _Timer] = {}
        made.update({text.name: edge for text, edge in zip(self._texts.edges, self._edges, strict=True)})
        made.update({text.name: timer for text, timer in zip(self._texts.timers, self._timers, strict=True)})
        self._inner_first = [made[name] for name in self._texts.inner_first()]

    def start(self, frame: Frame) -> None:
        """Begin without edges: a term that is TRUE at the start is none."""
        for edge in self._edges:
            assert edge.value is not None  # noqa: S101  # translated before anything runs
            frame.v[edge.before] = edge.value(frame)

    def evolve(self, frame: Frame, now: int) -> None:
        """Bring all terms up to date for the next evolution."""
        for term in self._inner_first:
            term.update(frame, now)

    def time(self, frame: Frame, now: int) -> None:
        """Bring the timers up to date with the situation."""
        for timer in self._timers:
            timer.update(frame, now)


def rising(condition: Condition) -> Condition:
    """Return the rising edge of a condition as a condition, unless it has an edge in it already."""
    if not isinstance(condition, Expression) or has_edge(condition.text):
        return condition
    text = f"NOT ({condition.text})" if condition.negated else condition.text
    return Expression(text=f"↑({text})")
