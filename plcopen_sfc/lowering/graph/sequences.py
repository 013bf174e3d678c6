"""Which sequencers CASEs can hold: those of which each sequence, or each branch, has at most one active step."""

from __future__ import annotations

from plcopen_sfc.analysis.regions import Region, Regions
from plcopen_sfc.lowering.chains.case import one_step_at_a_time
from plcopen_sfc.lowering.chains.machines import one_region, regions_of
from plcopen_sfc.lowering.chains.rivals import firing_together
from plcopen_sfc.lowering.graph.source import GraphSource
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.semantics.net import Net, indexes
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
    net = source.net
    if all(len(t.sources) == 1 and len(t.targets) <= 1 for t in net.transitions):
        return _connected(net)
    if source.skips:
        return "steps can be skipped, and there are simultaneous branches"
    return regions_of(net)


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


def on_by_hand(source: GraphSource) -> bool:
    """Whether the parameters of the block can switch steps on."""
    return not source.locked and {"SW_MAN", "S_SEL", ON_BY_HAND} <= set(source.parameters)


def _connected(net: Net) -> Regions | str:
    """A region for the steps that transitions connect, each of them from one step to one."""
    part = list(range(len(net.steps)))

    def first(step: int) -> int:
        while part[step] != step:
            step = part[step]
        return step

    for transition in net.transitions:
        for target in transition.targets:
            low, high = sorted((first(transition.sources[0]), first(target)))
            part[high] = low
    members: dict[int, list[int]] = {}
    for step in range(len(net.steps)):
        members.setdefault(first(step), []).append(step)
    initial: dict[int, int] = {}
    for step in indexes(net.initial):
        known = initial.setdefault(first(step), step)
        if known != step:
            return f"{net.steps[known].path} and {net.steps[step].path} of one sequence are both initial"
    regions = tuple(
        Region(
            index,
            tuple(steps),
            tuple(t.index for t in net.transitions if first(t.sources[0]) == key),
            block=None,
            blocks=(),
            initial=initial.get(key),
        )
        for index, (key, steps) in enumerate(members.items())
    )
    numbers = {key: index for index, key in enumerate(members)}
    return Regions(net, regions, (), tuple(numbers[first(step)] for step in range(len(net.steps))))
