"""What charts of all kinds have in common while they run: their steps, their transitions, and who looks at them."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Container, Mapping
from typing import Any

from plcopen_sfc.errors import UnknownBehaviourError
from plcopen_sfc.model.sfc import Condition, SfcNetwork
from plcopen_sfc.semantics.charts.step_state import Reached, Steps
from plcopen_sfc.semantics.charts.transition_firing import Move, Plans, choice, watched
from plcopen_sfc.semantics.net import Net, NetTransition
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.programs.routines import Routines
from plcopen_sfc.semantics.programs.runtime_types import BOOL, LINT, Frame
from plcopen_sfc.semantics.programs.scopes import CompiledChart, Scope


class RunningChart(CompiledChart):
    """A chart of a POU under a profile. One object serves all instances; what they are in is in their frames.

    A chart with something unknown to the profile is `_refused`: that is an error of the first scan.
    """

    def __init__(self, net: Net, chart: SfcNetwork, scope: Scope, path: str, profile: Profile) -> None:
        self.net = net
        self.path = path
        self.reached = Reached()
        self._chart = chart
        self._scope = scope
        self._clock = scope.clock
        self._situation = scope.declare(f"{path}: situation", LINT, hidden=True)
        self._shown = scope.declare(f"{path}: situation shown", LINT, hidden=True)
        self._started = scope.declare(f"{path}: started", BOOL, hidden=True)
        self._steps = Steps(net, scope, path, profile)
        self._choose = choice(profile)
        self._moves: tuple[Move, ...] = ()
        self._plans: Plans[int, Any]
        self._refused: UnknownBehaviourError | None = None

    @property
    @abstractmethod
    def is_divisible(self) -> bool:
        """True if its nets and its actions do not know of each other but by variables."""

    @abstractmethod
    def forgetting(
        self, anywhere: Container[str], read: Container[str], names: Container[str]
    ) -> Callable[[Frame, int], None]:
        """Return a function that sets back data of steps that no later scan sees, so that fewer states are different.

        `read` are the steps whose time a text reads (names in lower case), `anywhere` those of which one does elsewhere
        than in the conditions behind them, and so also when they are not active. `names` are those of all else that a
        text reads: of its steps where one reads more than a member, and of members.
        """

    @abstractmethod
    def _stated(self, transition: NetTransition) -> Condition | None:
        """Return the condition that is translated; None where there is none."""

    def _move(self, transition: NetTransition, missing: Callable[[str], Callable[[Frame], bool]]) -> Move:
        """Return a transition, ready to run; `missing` gives the condition of one that has none at a place."""
        where = f"{self.path} / transition {transition.path}"
        stated = self._stated(transition)
        if stated is None:
            condition = missing(where)
        else:
            condition = Routines(self._scope).condition(stated, where, chart=transition.chart)
        numbered = transition.transition.priority is not None
        return Move(transition.pre, transition.post, transition.bit, condition, numbered, transition.path)

    def watch(self, looks: Mapping[int, Callable[[Frame], None]]) -> None:
        """Call something each time the condition of a transition is tested, by the index of the transition."""
        self._moves = tuple(watched(move, looks.get(index)) for index, move in enumerate(self._moves))
        self._plans.clear()

    def situation(self, frame: Frame) -> int:
        """Return the steps whose transitions the next scan looks at."""
        return self.marking(frame)

    def marking(self, frame: Frame) -> int:
        """Return the active steps as programs see them, as bits of `net`."""
        shown: int = frame.v[self._shown]
        return shown

    def active(self, frame: Frame) -> tuple[str, ...]:
        """Return the paths of the active steps."""
        return self.net.names(self.marking(frame))
