"""Situations of a GRAFCET under its forcing orders and enclosing steps, whatever its conditions are.

In the marking graph every chart evolves by itself: a step that an order keeps inactive is active beside the order, and
one that only an order activates never is (IEC 60848:2013, 7.1 and 7.3).
"""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.errors import ForcingConflictError, UnknownBehaviourError
from plcopen_sfc.semantics.charts.chart_actions import Owner
from plcopen_sfc.semantics.charts.grafcet.partial_charts import Hierarchy
from plcopen_sfc.semantics.net import Net, NetStep, NetTransition

_NO_SLOT = -1


class RuledSituations:
    """The situations that are found with at most `cap` of them, one transition after the other.

    `complete`: there are no others. It is False for a chart whose hierarchy has no meaning too.
    """

    def __init__(self, net: Net, cap: int) -> None:
        owners = [(Owner(s.path, s.bit, _NO_SLOT, s.step.negated), s.step.actions) for s in net.steps]
        owners += [(Owner(m.path, m.steps, _NO_SLOT, m.step.negated), m.step.actions) for m in net.macros]
        owned = [(owner, model) for owner, models in owners for model in models if not model.exclude]
        self._seen: set[int] = set()
        self.complete = False
        try:
            self._hierarchy = Hierarchy(net, owned, "")
        except UnknownBehaviourError:
            return
        try:
            first = self._hierarchy.start(net.initial)
        except ForcingConflictError:
            first = net.initial  # the orders of initial steps contradict each other
        self._explore(net, first, cap)

    def _explore(self, net: Net, first: int, cap: int) -> None:
        waiting = [first]
        self._seen.add(first)
        while waiting:
            if len(self._seen) > cap:
                return
            before = waiting.pop()
            for transition in net.transitions:
                after = self.after(before, transition)
                if after is not None and after not in self._seen:
                    self._seen.add(after)
                    waiting.append(after)
        self.complete = True

    def after(self, before: int, *fired: NetTransition) -> int | None:
        """Return the situation after transitions fire together; None where they cannot.

        Where orders contradict each other it is the one before they act.
        """
        try:
            held = self._hierarchy.held(before)
        except ForcingConflictError:
            return None
        sources = targets = 0
        for transition in fired:
            if transition.pre & ~before or (transition.pre | transition.post) & held:
                return None
            sources |= transition.pre
            targets |= transition.post
        situation = before & ~sources | targets
        try:
            return self._hierarchy.apply(before, situation)
        except ForcingConflictError:
            return situation

    def __iter__(self) -> Iterator[int]:
        return iter(self._seen)

    def concurrent(self, a: NetStep, b: NetStep) -> bool:
        """Return True if two steps are active together in a situation that was found."""
        both = a.bit | b.bit
        return a is not b and any(situation & both == both for situation in self._seen)
