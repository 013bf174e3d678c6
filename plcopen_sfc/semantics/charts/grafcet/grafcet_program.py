"""Evolution of a chart of GRAFCET besides firing transitions, and its actions (IEC 60848:2013, 4.8).

Continuous ones write their output in every stable situation, stored ones once, in the evolution of their event.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from plcopen_sfc.errors import Location, UnknownBehaviourError
from plcopen_sfc.model import ActionAssociation, ActionKind, Condition, Qualifier
from plcopen_sfc.semantics.charts.chart_actions import Actions
from plcopen_sfc.semantics.charts.grafcet.partial_charts import Hierarchy
from plcopen_sfc.semantics.charts.grafcet.term_evaluation import ChartTerms
from plcopen_sfc.semantics.charts.qualifier_control import SituationChange
from plcopen_sfc.semantics.charts.step_state import ActionOrigin, Reached, Steps
from plcopen_sfc.semantics.charts.transition_firing import Move, Run
from plcopen_sfc.semantics.net import Net, Owner
from plcopen_sfc.semantics.profile import Profile
from plcopen_sfc.semantics.programs.routines import Routines
from plcopen_sfc.semantics.programs.runtime_types import Frame

if TYPE_CHECKING:
    from collections.abc import Callable

    from plcopen_sfc.semantics.programs.scopes import Scope

CONTINUOUS = {
    ActionKind.CONTINUOUS: Qualifier.N,
    ActionKind.CONDITIONAL: Qualifier.N,
    ActionKind.DELAYED: Qualifier.D,
    ActionKind.LIMITED: Qualifier.L,
}
"""The kinds that write an output in every stable situation, by what each association does."""
STORED = (ActionKind.ON_ACTIVATION, ActionKind.ON_DEACTIVATION, ActionKind.ON_EVENT)
"""The kinds that are executed once."""


@dataclass(slots=True)
class _Stored:
    owner: Owner
    model: ActionAssociation
    event: Condition | None
    noted: int
    run: Run | None = None
    happens: Callable[[Frame], bool] | None = None


def _event(model: ActionAssociation, terms: ChartTerms | None, path: str, owner: Owner) -> Condition | None:
    if model.kind is not ActionKind.ON_EVENT:
        return None
    if model.condition is None or terms is None:
        raise UnknownBehaviourError(
            f"the stored action on {model.target} has no event that the profile knows",
            location=Location(path=f"{path} / step {owner.path}"),
        )
    return terms.rising(model.condition, f"{path} / step {owner.path}")


class GrafcetActions:
    """The actions of a chart that have a kind of IEC 60848."""

    def __init__(
        self,
        steps: Steps,
        scope: Scope,
        path: str,
        terms: ChartTerms | None,
        profile: Profile,
        *,
        reached: Reached,
    ) -> None:
        self._reached = reached
        self._scope = scope
        self._path = path
        own = [(owner, model) for owner, model in steps.net.owned() if model.kind in CONTINUOUS]
        for owner, model in own:
            if model.value is not None and model.value.strip().upper() not in ("TRUE", "1"):
                raise UnknownBehaviourError(
                    f"a continuous action gives {model.target} the value {model.value}: only Booleans have one",
                    location=Location(path=f"{path} / step {owner.path}"),
                )
        continuous = [
            (
                owner,
                model.model_copy(
                    update={
                        "qualifier": CONTINUOUS[model.kind] if model.kind else Qualifier.N,
                        "value": None,
                        "condition": terms.read(model.condition, f"{path} / step {owner.path}")
                        if terms is not None
                        else model.condition,
                    }
                ),
            )
            for owner, model in own
        ]
        # each action has its own delay, and the OR of them all is written in every scan (4.8.2)
        self._continuous = Actions(
            continuous, steps, scope, f"{path}: continuous", profile, reached=reached, continuous=True
        )
        self._stored = [
            _Stored(
                owner,
                model,
                _event(model, terms, path, owner),
                reached.action(
                    f"{owner.path}: {model.target or 'action in place'}", [ActionOrigin(owner.steps, model)]
                ),
            )
            for owner, model in steps.net.owned()
            if model.kind in STORED
        ]

    @property
    def step_times(self) -> set[int]:
        """The slots with starts of steps that delayed and limited actions depend on."""
        return self._continuous.step_times

    def translate(self) -> None:
        """Prepare conditions and assignments."""
        self._continuous.translate()
        for stored in self._stored:
            where = f"{self._path} / step {stored.owner.path}"
            model = stored.model
            if model.body is not None:
                stored.run = Routines(self._scope).body(model.body, where)
            elif model.target is not None:
                stored.run = Routines(self._scope).statements(f"{model.target} := {model.value or 'TRUE'};", where)
            if stored.event is not None:
                stored.happens = Routines(self._scope).condition(stored.event, where)

    def happen(self, frame: Frame, situation: int) -> None:
        """Execute actions on events. `situation`: steps that are active, and were not just activated by the event."""
        for stored in self._stored:
            if (
                stored.happens is not None
                and stored.run is not None
                and situation & stored.owner.steps
                and stored.happens(frame)
            ):
                self._reached.actions |= stored.noted
                stored.run(frame)

    def store(self, frame: Frame, before: int, situation: int) -> None:
        """Execute actions on deactivation and on activation, in this order, after an evolution."""
        for kind, was, is_ in (
            (ActionKind.ON_DEACTIVATION, before, situation),
            (ActionKind.ON_ACTIVATION, situation, before),
        ):
            for stored in self._stored:
                steps = stored.owner.steps
                if stored.model.kind is kind and was & steps and not is_ & steps and stored.run is not None:
                    self._reached.actions |= stored.noted
                    stored.run(frame)

    def act(self, frame: Frame, now: int, situation: int) -> None:
        """Write the outputs of continuous actions in a stable situation."""
        self._continuous.act(frame, now, situation, SituationChange(0, 0, situation))


class Grafcet:
    """ChartTerms, actions and hierarchy of a chart."""

    def __init__(self, steps: Steps, scope: Scope, path: str, profile: Profile, *, reached: Reached) -> None:
        self.terms = ChartTerms(scope, path)
        self._reads = profile.grafcet_terms
        self._conditions = {
            t.index: self.read(t.transition.condition, f"{path} / transition {t.path}") for t in steps.net.transitions
        }
        self._hierarchy = Hierarchy(steps.net, path)
        self._actions = GrafcetActions(
            steps, scope, path, self.terms if self._reads else None, profile, reached=reached
        )

    def read(self, condition: Condition | None, where: str) -> Condition | None:
        """Return the condition at `where` without terms that program text does not know."""
        return self.terms.read(condition, where) if self._reads else condition

    def condition(self, transition: int) -> Condition | None:
        """Return the condition of a transition, without terms."""
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
        """Return the situation of the first scan."""
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
        """Return the transitions of charts that are not forced."""
        held = self._hierarchy.held(situation) if self._hierarchy else 0
        return [move for move in moves if not (move.sources | move.targets) & held] if held else moves

    def rule(self, before: int, situation: int) -> int:
        """Return the situation after an evolution, as forcing orders and enclosing steps want it."""
        return self._hierarchy.apply(before, situation) if self._hierarchy else situation

    def act(self, frame: Frame, now: int, situation: int) -> None:
        """Write the outputs of the situation that a scan ends with."""
        self.terms.time(frame, now)
        self._actions.act(frame, now, situation)


def has_grafcet(net: Net, profile: Profile) -> bool:
    """True if a chart needs all this."""
    has_actions = any(model.kind is not None or model.forcing is not None for _, model in net.owned())
    return net.hierarchy or has_actions or profile.grafcet_terms
