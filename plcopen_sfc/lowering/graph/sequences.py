"""Which sequencers CASEs can hold: those of which each sequence, or each branch, has at most one active step."""

from __future__ import annotations

from dataclasses import replace

from plcopen_sfc.analysis.regions import Regions
from plcopen_sfc.lowering.chains.case import one_step_at_a_time
from plcopen_sfc.lowering.chains.machines import one_region, regions_of
from plcopen_sfc.lowering.chains.rivals import firing_together
from plcopen_sfc.lowering.graph.source import GraphSource
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.semantics.net import Net
from plcopen_sfc.semantics.profile import Profile

ON_BY_HAND = "S_ON"
"""The parameter that switches a step on whatever others are active."""


def one_sequence(source: GraphSource, profile: Profile) -> Regions | str:
    """All steps as one region, or in words why a CASE cannot hold them."""
    return several_steps(source, profile) or one_step_at_a_time(source) or one_region(source.net)


def sequences(source: GraphSource, profile: Profile) -> Regions | str:
    """A region for each sequence and each simultaneous branch, or in words why CASEs cannot hold them."""
    objection = several_steps(source, profile)
    if objection:
        return objection
    if source.skips and any(len(t.sources) != 1 or len(t.targets) > 1 for t in source.net.transitions):
        return "steps can be skipped, and there are simultaneous branches"
    found = regions_of(_endless(source.net))
    return found if isinstance(found, str) else replace(found, net=source.net)


def _endless(net: Net) -> Net:
    """The same net, but what ends a sequence or a branch leads back to its own step: regions do not differ."""
    transitions = (replace(t, targets=t.targets or t.sources) if len(t.sources) == 1 else t for t in net.transitions)
    return replace(net, transitions=tuple(transitions))


def several_steps(source: GraphSource, profile: Profile) -> str:
    """What can leave several steps of a sequence active whatever its structure is; empty if nothing can."""
    if not source.net.initial:
        return "no step is initial"
    for step in source.net.steps:
        for row in source.rows[step.index]:
            if row.qualifier is Qualifier.ON:
                return f"step {step.path} switches steps on: {row.name}"
            if row.switched:
                return f"step {step.path} switches steps off: {row.name}"
    if on_by_hand(source):
        return f"{ON_BY_HAND} can switch on a step while another one is active"
    rival = firing_together(source.net, profile)
    if rival is not None:
        return f"transition {rival.path} fires together with its rivals under the profile {profile.name}"
    loops = (t.path for t in source.net.transitions if set(t.sources) & set(t.targets))
    if source.skips and (loop := next(loops, None)) is not None:
        return f"steps can be skipped, and transition {loop} leads back to its own step"
    return ""


def with_hands_off(source: GraphSource) -> GraphSource:
    """The same where nobody switches steps on by hand."""
    return replace(source, parameters={k: v for k, v in source.parameters.items() if k != ON_BY_HAND})


def on_by_hand(source: GraphSource) -> bool:
    """Whether the parameters of the block can switch steps on."""
    return not source.locked and {"SW_MAN", "S_SEL", ON_BY_HAND} <= set(source.parameters)
