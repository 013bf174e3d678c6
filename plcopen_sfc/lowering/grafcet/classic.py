"""A GRAFCET as textbooks lower it: its continuous and stored actions as actions with N, S and R."""

from __future__ import annotations

from dataclasses import replace

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.lowering.chains.chain import refuse_classic
from plcopen_sfc.lowering.code.logic import FALSE, TRUE, is_constant
from plcopen_sfc.lowering.grafcet.reading import is_grafcet, read_grafcet
from plcopen_sfc.lowering.reading.chart import read_chart
from plcopen_sfc.lowering.reading.grafcet_source import StoredAction
from plcopen_sfc.lowering.reading.source import ActionSource, ChartSource, Use
from plcopen_sfc.model.actions import ActionKind, Qualifier
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.semantics.profile import Profile


def read_plain(pou: Pou, chart: SfcNetwork, dialect: Dialect, profile: Profile) -> ChartSource:
    """Read a chart as textbook forms see it. Raises `LoweringError` for what they have no place for."""
    if is_grafcet(chart, profile):
        return plain_chart(read_grafcet(pou, dialect, profile))
    return read_chart(pou, chart, dialect, profile)


def plain_chart(source: ChartSource) -> ChartSource:
    """The chart without what only GRAFCET has. Raises `LoweringError` for what textbook forms have no place for."""
    grafcet = source.grafcet
    if grafcet is None:
        return source
    for what, there in (
        ("edges", grafcet.edges),
        ("times of conditions", grafcet.delays),
        ("charts that others rule", grafcet.ruled),
    ):
        if there:
            refuse_classic(source, what)
    actions = {action.name.casefold(): action for action in (*source.actions, *grafcet.continuous)}
    for stored in grafcet.stored:
        target, use = _use(source, stored)
        name = print_node(target, source.dialect)
        before = actions.get(name.casefold(), ActionSource(name, target, (), ()))
        actions[name.casefold()] = replace(before, uses=(*before.uses, use))
    in_order = sorted(actions.values(), key=lambda action: min(step for use in action.uses for step in use.steps))
    return replace(source, actions=tuple(in_order), grafcet=None)


def _use(source: ChartSource, stored: StoredAction) -> tuple[n.Expression, Use]:
    """The output that a stored action sets or resets, and the association that does so."""
    if stored.kind is not ActionKind.ON_ACTIVATION:
        refuse_classic(source, "stored actions on deactivation or on an event")
    only = stored.statements[0]
    if len(stored.statements) > 1 or not isinstance(only, n.Assignment) or not isinstance(only.value, n.Literal):
        refuse_classic(source, "stored actions that give an output anything but TRUE or FALSE")
    sets, resets = (is_constant(only.value, constant) for constant in (TRUE, FALSE))
    if not sets and not resets:
        refuse_classic(source, f"stored actions that give an output the value {only.value.text}")
    return only.target, Use(stored.steps, False, Qualifier.S if sets else Qualifier.R, TRUE, None)
