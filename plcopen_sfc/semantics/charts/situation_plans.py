"""Plans of situations before they are executed: worked out once for each situation that a chart gets into.

This is what makes a scan cost as much as there are active steps, however big the chart is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from plcopen_sfc.errors import Location, SimulationError
from plcopen_sfc.model import PouKind
from plcopen_sfc.semantics.charts.sfc_flags import Analysis
from plcopen_sfc.semantics.charts.transition_firing import Move
from plcopen_sfc.semantics.programs.routines import Routines
from plcopen_sfc.semantics.programs.types import ElementaryType, Family, Frame, StructureType

if TYPE_CHECKING:
    from plcopen_sfc.semantics.programs.scopes import Scope

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


def execution(target: str, scope: Scope, where: str) -> tuple[Run | None, Write | None]:
    """How to execute it, or how to write it: one of both. An undeclared name is a Boolean variable."""
    action = scope.action(target)
    if action is not None:
        return action, None
    try:
        type_ = Routines(scope).type_of(target)
    except SimulationError:  # a member that is no variable: an action of the instance, or nothing that could be called
        return Routines(scope).statements(f"{target}();", where), None
    is_called = isinstance(type_, StructureType) or (type_ is None and _is_program(target, scope))
    if is_called:
        return Routines(scope).statements(f"{target}();", where), None
    if type_ is not None and not (isinstance(type_, ElementaryType) and type_.family is Family.BOOL):
        return None, _refusing(f"{target} is of type {type_.name}: only a Boolean variable can be an action", where)
    return None, Routines(scope).setter(target)


def _is_program(target: str, scope: Scope) -> bool:
    key = target.casefold()
    return any(pou.name.casefold() == key and pou.kind is PouKind.PROGRAM for pou in scope.library.project.pous)


def _refusing(message: str, where: str) -> Write:
    def fail(_: Frame, __: Any) -> None:
        raise SimulationError(message, location=Location(path=where))

    return fail
