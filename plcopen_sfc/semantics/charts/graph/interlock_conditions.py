"""Interlocks and supervisions of S7-GRAPH steps (manual, "Conditions").

An interlock that is not satisfied while the step is active is an error: the actions that depend on it rest, the
sequence goes on. A supervision that is satisfied is a fault: the step is not left before it is gone and, where the
block wants it, acknowledged.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from plcopen_sfc.errors import Location, UnknownBehaviourError
from plcopen_sfc.languages.networks import is_empty_network
from plcopen_sfc.semantics.charts.graph import step_data
from plcopen_sfc.semantics.net import Net, indexes
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.programs.routines import Routines
from plcopen_sfc.semantics.programs.runtime_types import Frame

if TYPE_CHECKING:
    from plcopen_sfc.model import Condition as ModelCondition
    from plcopen_sfc.semantics.programs.scopes import Scope

Condition = Callable[[Frame], bool]


def check_no_graph(net: Net, profile: Profile, path: str) -> None:
    """Refuse what only sequencers of S7-GRAPH have. Raises `UnknownBehaviourError`."""
    chart = net.chart
    if any(operation.body is not None for operation in chart.permanent):
        raise UnknownBehaviourError(
            f"the chart has permanent operations, which the profile {profile.name} does not have",
            location=Location(path=path),
        )
    for step in net.steps:
        if programmed(step.step.conditions.get("supervision")) is not None:
            raise UnknownBehaviourError(
                f"step {step.path} has a supervision, which the profile {profile.name} does not have",
                location=Location(path=f"{path} / step {step.path}"),
            )


def programmed(condition: ModelCondition | None) -> ModelCondition | None:
    """Return the condition, unless it is an empty network: its coil alone, which nothing leads to."""
    return None if is_empty_network(condition) else condition


@dataclass(frozen=True, slots=True)
class CheckedSteps:
    """The steps whose interlock is satisfied, whose supervision holds them, and those with any disturbance."""

    released: int
    held: int
    disturbed: int

    def after(self, left: int, entered: CheckedSteps) -> CheckedSteps:
        """Return the same when some steps are left, and others entered."""
        return CheckedSteps(
            self.released & ~left | entered.released,
            self.held & ~left | entered.held,
            self.disturbed & ~left | entered.disturbed,
        )


class StepConditions:
    """The interlocks and supervisions of a sequencer."""

    def __init__(self, net: Net, slots: tuple[int, ...], *, acknowledged: bool) -> None:
        self._net = net
        self._slots = slots
        self._must_acknowledge = acknowledged
        self._interlocks: dict[int, Condition] = {}
        self._supervisions: dict[int, Condition] = {}

    def translate(self, scope: Scope, path: str) -> None:
        """Prepare the conditions."""
        for step in self._net.steps:
            where = f"{path} / step {step.path}"
            for kind, found in (("interlock", self._interlocks), ("supervision", self._supervisions)):
                condition = programmed(step.step.conditions.get(kind))
                if condition is not None:
                    found[step.index] = Routines(scope).condition(condition, where, chart=step.chart)

    def check(self, frame: Frame, active: int, *, acknowledge: bool) -> CheckedSteps:
        """Evaluate the conditions of active steps; sets their events."""
        released, held, disturbed = active, 0, 0
        for index in indexes(active):
            bit = 1 << index
            values = frame.v[self._slots[index]].v
            interlock = self._interlocks.get(index)
            values[step_data.LS] = satisfied = interlock is None or bool(interlock(frame))
            values[step_data.L1] = not satisfied and not values[step_data.LA]
            values[step_data.L0] = satisfied and values[step_data.LA]
            values[step_data.LA] = not satisfied
            if not satisfied:
                released &= ~bit
            if index in self._supervisions:
                self._supervise(frame, index, values, acknowledge=acknowledge)
                if values[step_data.VA]:
                    held |= bit
            if values[step_data.LA] or values[step_data.VA]:
                disturbed |= bit
        return CheckedSteps(released, held, disturbed)

    def _supervise(self, frame: Frame, index: int, values: list[object], *, acknowledge: bool) -> None:
        fault = bool(self._supervisions[index](frame))
        values[step_data.V1] = fault and not values[step_data.VS]
        values[step_data.V0] = not fault and values[step_data.VS]
        values[step_data.VS] = fault
        if values[step_data.V1]:
            values[step_data.VA] = True
            values[step_data.ACKNOWLEDGED] = False
        values[step_data.A1] = acknowledge and values[step_data.VA] and not values[step_data.ACKNOWLEDGED]
        if values[step_data.A1]:
            values[step_data.ACKNOWLEDGED] = True
        if not fault and (values[step_data.ACKNOWLEDGED] or not self._must_acknowledge):
            values[step_data.VA] = False

    def forget(self, frame: Frame, left: int) -> None:
        """Steps that were left have no conditions."""
        for index in indexes(left):
            values = frame.v[self._slots[index]].v
            for slot in (
                *step_data.EVENTS,
                step_data.LA,
                step_data.LS,
                step_data.VA,
                step_data.VS,
                step_data.ACKNOWLEDGED,
            ):
                values[slot] = False
