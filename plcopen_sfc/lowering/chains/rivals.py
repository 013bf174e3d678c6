"""Which rivals exclude each other, and which fire together."""

from __future__ import annotations

from plcopen_sfc.semantics.charts.moves import testing_order
from plcopen_sfc.semantics.net import Net, NetTransition, Rivals
from plcopen_sfc.semantics.profile import Profile


def exclusive_rivals(net: Net, profile: Profile) -> list[tuple[int, ...]]:
    """For each transition the rivals tried before it that keep it from firing when they fire."""
    if profile.rivals is Rivals.PRIORITY:
        return [transition.rivals for transition in net.transitions]
    if not profile.numbered_first:
        return [()] * len(net.transitions)
    tested = testing_order(net)
    numbered = {transition.index for transition in net.transitions if transition.transition.priority is not None}
    return [tuple(i for i in t.rivals if i in numbered and tested[i] < tested[t.index]) for t in net.transitions]


def firing_together(net: Net, profile: Profile) -> NetTransition | None:
    """The first transition that can fire although a rival before it does; None if all rivals exclude each other."""
    exclusive = exclusive_rivals(net, profile)
    return next((t for t in net.transitions if exclusive[t.index] != t.rivals), None)
