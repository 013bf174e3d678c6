"""The rules."""

from __future__ import annotations

from plcopen_sfc.analysis.checks import (
    conditions,
    connections,
    ends,
    events,
    hierarchy,
    limits,
    lowering,
    names,
    qualifiers,
    races,
    reachability,
    remarks,
    selections,
    starts,
    storing,
    times,
    transients,
)
from plcopen_sfc.analysis.checks.rules import Rule

_ON_CHARTS: tuple[Rule, ...] = (
    connections.STR01,
    starts.STR02,
    connections.STR04,
    connections.STR05,
    reachability.STR06,
    reachability.STR07,
    reachability.STR08,
    ends.STR09,
    reachability.STR10,
    ends.STR11,
    starts.STR12,
    ends.STR14,
    reachability.STR15,
    names.NAM01,
    names.NAM02,
    names.NAM03,
    names.NAM04,
    names.NAM05,
    selections.SEL01,
    selections.SEL02,
    selections.SEL03,
    conditions.CND01,
    conditions.CND02,
    conditions.CND03,
    conditions.CND04,
    conditions.CND05,
    conditions.CND06,
    conditions.CND07,
    qualifiers.ACT01,
    storing.ACT02,
    storing.ACT03,
    races.ACT04,
    qualifiers.ACT05,
    qualifiers.ACT06,
    qualifiers.ACT07,
    qualifiers.ACT08,
    qualifiers.ACT09,
    storing.ACT10,
    events.ACT11,
    events.ACT12,
    events.ACT13,
    qualifiers.ACT14,
    qualifiers.ACT15,
    qualifiers.ACT16,
    qualifiers.ACT17,
    storing.ACT18,
    transients.EVO01,
    transients.EVO02,
    times.TIM01,
    hierarchy.HIE01,
    hierarchy.HIE02,
    hierarchy.HIE03,
    hierarchy.HIE04,
    hierarchy.HIE05,
    hierarchy.HIE06,
    limits.LIM01,
    lowering.LOW01,
    lowering.LOW02,
)

RULES: tuple[Rule, ...] = (*_ON_CHARTS, remarks.rule_on([*(rule.code for rule in _ON_CHARTS), "CHK01"]))
"""Every rule, by group and number."""


def rule_named(code: str) -> Rule:
    """The rule with this code. `KeyError` where there is none."""
    return {rule.code: rule for rule in RULES}[code.upper()]
