"""Objections to a sequencer as CASEs."""

from __future__ import annotations

from dataclasses import replace

from plcopen_sfc.analysis.regions import Regions
from plcopen_sfc.errors import Location, LoweringError
from plcopen_sfc.lowering.encodings.case_encodings import one_step_at_a_time
from plcopen_sfc.lowering.encodings.case_states import one_region, regions_of
from plcopen_sfc.lowering.graph.sequencer_source import GraphSource
from plcopen_sfc.lowering.lowering_options import Construction
from plcopen_sfc.lowering.schedule.scan_schedule import firing_together
from plcopen_sfc.model.actions import Qualifier
from plcopen_sfc.semantics.profile import Profile

ON_BY_HAND = "S_ON"
"""The parameter that switches a step on whatever others are active."""


def one_sequence(source: GraphSource, profile: Profile) -> Regions | str:
    """Return all steps as one region, or in words why a CASE cannot hold them."""
    return several_steps(source, profile) or one_step_at_a_time(source) or one_region(source.net)


def sequences(source: GraphSource, profile: Profile) -> Regions | str:
    """Return a region for each sequence and each simultaneous branch, or in words why CASEs cannot hold them."""
    objection = several_steps(source, profile)
    if objection:
        return objection
    if source.skips and any(len(t.sources) != 1 or len(t.targets) > 1 for t in source.net.transitions):
        return "steps can be skipped, and there are simultaneous branches"
    return regions_of(source.region_net)


def several_steps(source: GraphSource, profile: Profile) -> str:
    """Return why several steps of a sequence can be active whatever its structure is; empty if they cannot."""
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
    other = firing_together(source, profile)
    if other is not None:
        return f"transition {other.path} fires together with competing transitions under the profile {profile.name}"
    loops = (t.path for t in source.net.transitions if set(t.sources) & set(t.targets))
    if source.skips and (loop := next(loops, None)) is not None:
        return f"steps can be skipped, and transition {loop} leads back to its own step"
    return ""


def without_switching_by_hand(source: GraphSource) -> GraphSource:
    """Return the same without the switching of steps by hand."""
    return replace(source, parameters={k: v for k, v in source.parameters.items() if k != ON_BY_HAND})


def refuse_several_steps(source: GraphSource, wanted: Construction, profile: Profile) -> None:
    """Raise `LoweringError` where CASEs are wanted, and several steps that share one can be active."""
    found = {Construction.CASE: one_sequence, Construction.REGIONS: sequences}.get(wanted)
    objection = found(source, profile) if found is not None else None
    if isinstance(objection, str):
        hint = "Step bits can hold every sequencer."
        if on_by_hand(source):
            hint += f" Where {ON_BY_HAND} is never operated, leave it inactive: at_rest=['{ON_BY_HAND}'], --at-rest."
        raise LoweringError(
            f"a CASE holds one active step, and that is not so here: {objection}",
            location=Location(path=source.pou.name),
            hint=hint,
        )


def on_by_hand(source: GraphSource) -> bool:
    """Return True if the parameters of the block can switch steps on."""
    return not source.locked and {"SW_MAN", "S_SEL", ON_BY_HAND} <= set(source.parameters)
