"""Edges and times in conditions of GRAFCET: ``↑a``, ``↓(a AND b)``, ``3s/X5``, ``3s/X5/2s``, ``X5/2s``.

IEC 60848:2013, 4.6 (transition conditions). An edge lasts for one evolution: it is TRUE when its operand has another
value than in the evolution before. ``t1/x/t2`` becomes TRUE when `x` was TRUE for t1, and stays so for t2 after `x`
has become FALSE. Program text knows neither: each term becomes a hidden variable, and the condition is translated with
its name in place of the term.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from plcopen_sfc.model import Condition, Expression
from plcopen_sfc.semantics.programs.layouts import Frame
from plcopen_sfc.semantics.programs.types import BOOL, ELEMENTARY, INSTANT

if TYPE_CHECKING:
    from plcopen_sfc.semantics.programs import Scope

_OPERAND = r"(?:[^\W\d][\w.]*|\((?:[^()]|\([^()]*\))*\))"
_TIME = r"(?:L?T(?:IME)?#\w+|\d+(?:\.\d+)?\s*(?:ms|s|min|m|h|d))"
_EDGE = re.compile(rf"(?P<sign>[↑↓])\s*(?P<operand>{_OPERAND})")
_TIMED = re.compile(
    rf"(?:(?P<first>{_TIME})\s*/\s*(?P<operand>{_OPERAND})(?:\s*/\s*(?P<last>{_TIME}))?"
    rf"|(?P<left>{_OPERAND})\s*/\s*(?P<off>{_TIME}))",
    re.IGNORECASE,
)


@dataclass(slots=True)
class _Edge:
    operand: str
    rising: bool
    slot: int
    before: int
    value: Callable[[Frame], bool] | None = None


@dataclass(slots=True)
class _Timer:
    operand: str
    first: str
    last: str
    slot: int
    on_since: int
    off_since: int
    value: Callable[[Frame], bool] | None = None
    on_time: Callable[[Frame], int] | None = None
    off_time: Callable[[Frame], int] | None = None


class Terms:
    """The terms of a chart, each with its hidden variable."""

    def __init__(self, scope: Scope, path: str) -> None:
        self._scope = scope
        self._path = path
        self._names: dict[str, str] = {}
        self._edges: list[_Edge] = []
        self._timers: list[_Timer] = []

    def __bool__(self) -> bool:
        return bool(self._edges or self._timers)

    def read(self, condition: Condition | None) -> Condition | None:
        """The condition without terms. Only while the chart is being declared."""
        if not isinstance(condition, Expression):
            return condition
        text = _TIMED.sub(self._timer, _EDGE.sub(self._edge, condition.text))
        return condition if text == condition.text else condition.model_copy(update={"text": text})

    def rising(self, condition: Condition) -> Condition:
        """The rising edge of a condition, unless it has an edge in it already."""
        if not isinstance(condition, Expression) or _EDGE.search(condition.text):
            return self.read(condition) or condition
        text = f"NOT ({condition.text})" if condition.negated else condition.text
        return self.read(Expression(text=f"↑({text})")) or condition

    def _hidden(self, term: str, kind: str) -> str:
        name = f"GRAFCET_{kind}_{len(self._names) + 1}"
        self._names[term] = name
        return name

    def _edge(self, found: re.Match[str]) -> str:
        term = found.group(0)
        name = self._names.get(term)
        if name is None:
            name = self._hidden(term, "EDGE")
            slot = self._scope.declare(name, BOOL, hidden=True)
            before = self._scope.declare(f"{self._path}: {term} before", BOOL, hidden=True)
            operand = _EDGE.sub(self._edge, found["operand"])
            self._edges.append(_Edge(_TIMED.sub(self._timer, operand), found["sign"] == "↑", slot, before))
        return name

    def _timer(self, found: re.Match[str]) -> str:
        term = found.group(0)
        name = self._names.get(term)
        if name is None:
            name = self._hidden(term, "TIME")
            slot = self._scope.declare(name, BOOL, hidden=True)
            on, off = (self._scope.declare(f"{self._path}: {term} {w}", INSTANT, hidden=True) for w in ("on", "off"))
            operand = found["operand"] or found["left"]
            first, last = found["first"] or "T#0s", found["last"] or found["off"] or "T#0s"
            self._timers.append(_Timer(operand, _literal(first), _literal(last), slot, on, off))
        return name

    def translate(self) -> None:
        """Prepare the operands and times."""
        duration = ELEMENTARY["TIME"]
        for edge in self._edges:
            edge.value = self._scope.condition(Expression(text=edge.operand), self._path)
        for timer in self._timers:
            timer.value = self._scope.condition(Expression(text=timer.operand), self._path)
            timer.on_time = self._scope.expression(timer.first, self._path, duration)
            timer.off_time = self._scope.expression(timer.last, self._path, duration)

    def start(self, frame: Frame) -> None:
        """What is TRUE at the start is no edge."""
        for edge in self._edges:
            assert edge.value is not None  # noqa: S101  # translated before anything runs
            frame.v[edge.before] = edge.value(frame)

    def evolve(self, frame: Frame, now: int) -> None:
        """Bring all terms up to date for the next evolution."""
        v = frame.v
        self.time(frame, now)
        for edge in self._edges:
            assert edge.value is not None  # noqa: S101
            value = edge.value(frame)
            v[edge.slot] = value is edge.rising and v[edge.before] is not edge.rising
            v[edge.before] = value

    def time(self, frame: Frame, now: int) -> None:
        """Bring the timers up to date with the situation."""
        v = frame.v
        for timer in self._timers:
            assert timer.value is not None and timer.on_time is not None and timer.off_time is not None  # noqa: S101, PT018
            if timer.value(frame):
                if v[timer.on_since] is None:
                    v[timer.on_since] = now
                done = now - v[timer.on_since] >= timer.on_time(frame)
                v[timer.slot] = done or (v[timer.slot] and v[timer.off_since] is not None)
                if done:
                    v[timer.off_since] = None
                continue
            v[timer.on_since] = None
            if v[timer.slot]:
                if v[timer.off_since] is None:
                    v[timer.off_since] = now
                if now - v[timer.off_since] >= timer.off_time(frame):
                    v[timer.slot], v[timer.off_since] = False, None


def _literal(time: str) -> str:
    compact = "".join(time.split())
    return compact if "#" in compact else "T#" + compact.replace("min", "m")
