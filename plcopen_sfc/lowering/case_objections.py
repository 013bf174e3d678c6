"""Objections to CASEs: why one for a chart, or one for each of its parts, cannot hold it."""

from __future__ import annotations

from dataclasses import replace

from plcopen_sfc.lowering.encodings.case_states import regions_of
from plcopen_sfc.lowering.graph.sequencer_source import GraphSource
from plcopen_sfc.lowering.lowering_options import Construction
from plcopen_sfc.lowering.reading.chart_source import ChartSource, GrafcetSource
from plcopen_sfc.lowering.schedule.scan_schedule import exclude, firing_together
from plcopen_sfc.semantics.net import Competing, indexes
from plcopen_sfc.semantics.profile import Profile

_ON_BY_HAND = "S_ON"
"""The parameter of S7-GRAPH that switches a step on whatever others are active."""


def objection(source: ChartSource, profile: Profile, construction: Construction) -> str:
    """Return why the CASEs of a construction cannot hold a chart; empty if they can, or if it has none."""
    if construction not in (Construction.CASE, Construction.REGIONS):
        return ""
    structure = _several_at_a_time if construction is Construction.CASE else _without_regions
    if isinstance(source, GraphSource):
        return _switched(source) or _firing_together(source, profile) or _skipped(source) or structure(source)
    if source.grafcet is None:
        return _firing_together(source, profile) or structure(source)
    ruled = _ruled if construction is Construction.CASE else _ruled_in_parts
    return structure(source) or ruled(source, source.grafcet) or _not_exclusive(source, profile)


def refuse_cases(source: ChartSource, profile: Profile, construction: Construction) -> None:
    """Raise `LoweringError` where CASEs are wanted that cannot hold a chart."""
    found = objection(source, profile, construction)
    if found:
        which = "one CASE cannot" if construction is Construction.CASE else "no CASEs can"
        hint = "Step bits can hold every chart."
        if _is_on_by_hand(source):
            hint += f" Where {_ON_BY_HAND} is never operated, leave it inactive: at_rest=['{_ON_BY_HAND}'], --at-rest."
        source.refuse(f"{which} hold the chart: {found}", hint)


def fits_without_switching(source: ChartSource, profile: Profile) -> bool:
    """Return True if nothing but the switching of steps by hand keeps a chart of S7-GRAPH from having CASEs."""
    if not isinstance(source, GraphSource) or not _is_on_by_hand(source):
        return False
    parameters = {name: own for name, own in source.parameters.items() if name != _ON_BY_HAND}
    return not objection(replace(source, parameters=parameters), profile, Construction.REGIONS)


# -- the structure


def _several_at_a_time(source: ChartSource) -> str:
    """Return why a chart can have several steps active, or none at the start; empty if it has one until it ends."""
    initial = source.net.initial.bit_count()
    if initial != 1:
        return f"it has {initial} initial steps"
    for transition in source.net.transitions:
        if len(transition.sources) != 1 or len(transition.targets) > 1:
            return f"transition {transition.path} does not lead from one step to one step"
    return ""


def _without_regions(source: ChartSource) -> str:
    """Return why a chart is not built of regions; empty if it is."""
    found = regions_of(source.region_net)
    return found if isinstance(found, str) else ""


def _firing_together(source: ChartSource, profile: Profile) -> str:
    other = firing_together(source, profile)
    if other is None:
        return ""
    return f"transition {other.path} fires together with competing transitions under the profile {profile.name}"


# -- S7-GRAPH


def _switched(source: GraphSource) -> str:
    """Return what switches steps that no transition leads to or from."""
    if not source.net.initial:
        return "no step is initial"
    for step in source.net.steps:
        for row in source.rows[step.index]:
            if row.switched:
                return f"step {step.path} switches steps {row.qualifier.lower()}: {row.name}"
    return f"{_ON_BY_HAND} can switch on a step while another one is active" if _is_on_by_hand(source) else ""


def _skipped(source: GraphSource) -> str:
    """Return what keeps a chart whose steps are skipped from having CASEs."""
    for transition in source.net.transitions if source.skips else ():
        if set(transition.sources) & set(transition.targets):
            return f"steps can be skipped, and transition {transition.path} leads back to its own step"
    if source.skips and any(len(t.sources) != 1 or len(t.targets) > 1 for t in source.net.transitions):
        return "steps can be skipped, and there are simultaneous branches"
    return ""


def _is_on_by_hand(source: ChartSource) -> bool:
    """Return True if the parameters of the block can switch steps on."""
    needed = {"SW_MAN", "S_SEL", _ON_BY_HAND}
    return isinstance(source, GraphSource) and not source.locked and needed <= set(source.parameters)


# -- GRAFCET


def _ruled(_: ChartSource, grafcet: GrafcetSource) -> str:
    return "some of its charts force or enclose others" if grafcet.ruled else ""


def _ruled_in_parts(source: ChartSource, grafcet: GrafcetSource) -> str:
    """Return which charts above impose a situation that the states of regions cannot hold."""
    regions = regions_of(source.region_net)
    if isinstance(regions, str):
        return regions
    for chart in grafcet.ruled:
        if chart.enclosures:
            return f"steps enclose {chart.name}"
        for order in chart.orders:
            forced = [regions.region_of[i] for i in indexes(order.imposed or 0)]
            branches = [i for i in forced if i is None or regions.regions[i].block is not None]
            if branches or len(set(forced)) < len(forced):
                return f"an order puts {chart.name} into simultaneous branches"
    return ""


def _not_exclusive(source: ChartSource, profile: Profile) -> str:
    """Return which transitions of a GRAFCET would need several states of one part in one evolution, or none."""
    for transition in source.net.transitions:
        # the state would not change, so that nothing shows the evolution
        if set(transition.sources) & set(transition.targets):
            return f"transition {transition.path} leads back to its own step"
        for other in transition.competing if profile.competing is not Competing.PRIORITY else ():
            if not exclude(source.conditions[other], source.conditions[transition.index], source.dialect):
                first = source.net.transitions[other].path
                return f"the conditions of {first} and {transition.path} do not exclude each other"
    return ""
