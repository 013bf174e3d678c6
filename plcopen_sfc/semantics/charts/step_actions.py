"""The step actions of CODESYS: entry and exit actions, executed once, and main actions, executed while active."""

from __future__ import annotations

from typing import TYPE_CHECKING

from plcopen_sfc.errors import Location, UnknownBehaviourError
from plcopen_sfc.semantics.charts.plans import Run
from plcopen_sfc.semantics.charts.reached import Origin, Reached
from plcopen_sfc.semantics.net import Net, indexes
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.programs.layouts import Frame

if TYPE_CHECKING:
    from plcopen_sfc.model import Body
    from plcopen_sfc.semantics.programs import Scope


def check_step_actions(net: Net, profile: Profile, path: str) -> None:
    """Refuse step actions where the profile has none. Raises `UnknownBehaviourError`."""
    if profile.step_actions:
        return
    for step in net.steps:
        if step.step.entry_action or step.step.main_action or step.step.exit_action:
            raise UnknownBehaviourError(
                f"step {step.path} has entry, main or exit actions, which the profile {profile.name} does not have",
                location=Location(path=f"{path} / step {step.path}"),
            )


class StepActions:
    """What the steps of a chart execute, by the index of the step."""

    def __init__(self, net: Net, reached: Reached) -> None:
        self._net = net
        self._reached = reached
        self._entry: dict[int, Run] = {}
        self._main: dict[int, Run] = {}
        self._exit: dict[int, Run] = {}

    def translate(self, scope: Scope, path: str) -> None:
        """Prepare the bodies."""
        for index, step in enumerate(s.step for s in self._net.steps):
            where = f"{path} / step {self._net.steps[index].path}"
            for word, action, found in (
                ("entry", step.entry_action, self._entry),
                ("main", step.main_action, self._main),
                ("exit", step.exit_action, self._exit),
            ):
                if action:
                    label = f"{self._net.steps[index].path}: {word} action"
                    bit = self._reached.action(label, [Origin(self._net.steps[index].bit, None)])
                    found[index] = self._noted(_run(action, scope, where), bit)

    def _noted(self, run: Run, bit: int) -> Run:
        reached = self._reached

        def noted(frame: Frame) -> None:
            reached.actions |= bit
            run(frame)

        return noted

    def leave_and_enter(self, frame: Frame, left: int, entered: int) -> None:
        """Exit actions, then entry actions, both in the order of the chart."""
        for index in indexes(left):
            if index in self._exit:
                self._exit[index](frame)
        for index in indexes(entered):
            if index in self._entry:
                self._entry[index](frame)

    def of(self, situation: int) -> tuple[Run, ...]:
        """The main actions of the active steps."""
        return tuple(self._main[index] for index in indexes(situation) if index in self._main)


def _run(action: str | Body, scope: Scope, where: str) -> Run:
    if not isinstance(action, str):
        return scope.body(action, where)
    return scope.action(action) or scope.statements(f"{action}();", where)
