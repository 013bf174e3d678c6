"""Evolution of a chart of GRAFCET besides firing transitions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from plcopen_sfc.model import ActionAssociation, Condition
from plcopen_sfc.semantics.charts.chart_actions import Owner
from plcopen_sfc.semantics.charts.grafcet.executed_actions import GrafcetActions
from plcopen_sfc.semantics.charts.grafcet.partial_charts import Hierarchy
from plcopen_sfc.semantics.charts.grafcet.term_evaluation import Terms
from plcopen_sfc.semantics.charts.step_state import Reached
from plcopen_sfc.semantics.charts.transition_firing import Cleared, Move
from plcopen_sfc.semantics.net import Net
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.programs.types import Frame

if TYPE_CHECKING:
    from plcopen_sfc.semantics.programs.scopes import Scope


class Grafcet:
    """Terms, actions and hierarchy of a chart."""

    def __init__(
        self,
        net: Net,
        owned: Sequence[tuple[Owner, ActionAssociation]],
        scope: Scope,
        path: str,
        profile: Profile,
        *,
        reached: Reached,
    ) -> None:
        self.terms = Terms(scope, path)
        self._reads = profile.grafcet_terms
        self._conditions = {t.index: self.read(t.transition.condition) for t in net.transitions}
        self._hierarchy = Hierarchy(net, owned, path)
        self._actions = GrafcetActions(
            owned, scope, path, self.terms if self._reads else None, profile, reached=reached
        )

    def read(self, condition: Condition | None) -> Condition | None:
        """A condition without terms that program text does not know."""
        return self.terms.read(condition) if self._reads else condition

    def condition(self, transition: int) -> Condition | None:
        """The condition of a transition, without terms."""
        return self._conditions[transition]

    @property
    def step_times(self) -> set[int]:
        """The slots with starts of steps that actions depend on."""
        return self._actions.step_times

    def translate(self) -> None:
        """Prepare what can be executed."""
        self.terms.translate()
        self._actions.translate()

    def start(self, frame: Frame, situation: int) -> int:
        """The situation of the first scan."""
        self.terms.start(frame)
        if self._hierarchy:
            situation = self._hierarchy.start(situation)
        return situation

    def store(self, frame: Frame, before: int, situation: int) -> None:
        """Execute the stored actions of an evolution."""
        self._actions.store(frame, before, situation)

    def begin(self, frame: Frame, now: int, situation: int, fresh: int) -> None:
        """The beginning of an evolution. `fresh`: steps that the one before has activated."""
        self.terms.evolve(frame, now)
        self._actions.happen(frame, situation & ~fresh)

    def free(self, moves: Sequence[Move], situation: int) -> Sequence[Move]:
        """The transitions of charts that are not forced."""
        held = self._hierarchy.held(situation) if self._hierarchy else 0
        return [move for move in moves if not (move.sources | move.targets) & held] if held else moves

    def rule(self, before: int, situation: int, cleared: Cleared) -> int:
        """The situation after an evolution, as forcing orders and enclosing steps want it."""
        return self._hierarchy.apply(before, situation, cleared.entered) if self._hierarchy else situation

    def act(self, frame: Frame, now: int, situation: int) -> None:
        """Write the outputs of the situation that a scan ends with."""
        self.terms.time(frame, now)
        self._actions.act(frame, now, situation)


def has_grafcet(net: Net, owned: Sequence[tuple[Owner, ActionAssociation]], profile: Profile) -> bool:
    """True if a chart needs all this."""
    if net.hierarchy or any(model.kind is not None or model.forcing is not None for _, model in owned):
        return True
    return profile.grafcet_terms
