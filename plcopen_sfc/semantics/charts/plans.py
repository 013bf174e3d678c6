"""What is known of a situation before it is executed: worked out once for each situation that a chart gets into.

This is what makes a scan cost as much as there are active steps, however big the chart is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from plcopen_sfc.semantics.charts.analyzation import Analysis
from plcopen_sfc.semantics.charts.moves import Move
from plcopen_sfc.semantics.programs.layouts import Frame

Run = Callable[[Frame], None]
"""Executes a body."""

Write = Callable[[Frame, Any], None]
"""Writes a variable."""


@dataclass(frozen=True, slots=True)
class Watch:
    """A maximum time: the name of the step, the slot of its start, the time, and what keeps the step from ending."""

    step: str
    since: int
    time: Callable[[Frame], int]
    reasons: Analysis


@dataclass(frozen=True, slots=True)
class Plan:
    """A situation: its enabled transitions, times to bring up to date, main actions, and maximum times.

    `forced` are the transitions without their conditions, `current` is the name of the last active step of the chart.
    """

    moves: tuple[Move, ...]
    forced: tuple[Move, ...]
    timed: tuple[tuple[int, int], ...]
    main: tuple[Run, ...]
    watches: tuple[Watch, ...]
    current: str


class Plans:
    """The plans of the situations that were met."""

    __slots__ = ("_found", "_make")

    def __init__(self, make: Callable[[int], Plan]) -> None:
        self._make = make
        self._found: dict[int, Plan] = {}

    def of(self, situation: int) -> Plan:
        """The plan of a situation."""
        plan = self._found.get(situation)
        if plan is None:
            if len(self._found) >= MOST_PLANS:
                self._found.clear()
            plan = self._found[situation] = self._make(situation)
        return plan


MOST_PLANS = 4096
"""Plans that are kept. A chart visits few situations; one with wide parallelism must not fill the memory."""
