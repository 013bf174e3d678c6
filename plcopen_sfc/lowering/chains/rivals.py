"""Which rivals exclude each other, and which fire together."""

from __future__ import annotations

from plcopen_sfc.semantics.net import Net, NetTransition, Rivals
from plcopen_sfc.semantics.profile import Profile


def exclusive_rivals(net: Net, transition: NetTransition, profile: Profile) -> tuple[int, ...]:
    """The rivals tried before a transition that keep it from firing when they fire."""
    if profile.rivals is Rivals.PRIORITY:
        return transition.rivals
    if profile.numbered_first:
        return tuple(i for i in transition.rivals if net.transitions[i].transition.priority is not None)
    return ()


def firing_together(net: Net, profile: Profile) -> NetTransition | None:
    """The first transition that can fire although a rival before it does; None if all rivals exclude each other."""
    return next((t for t in net.transitions if exclusive_rivals(net, t, profile) != t.rivals), None)
