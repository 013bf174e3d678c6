"""The rules."""

from __future__ import annotations

from plcopen_sfc.analysis.checks import connections, ends, reachability, starts
from plcopen_sfc.analysis.checks.rules import Rule

RULES: tuple[Rule, ...] = (
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
)
"""Every rule, by code."""


def rule_named(code: str) -> Rule:
    """The rule with this code. `KeyError` where there is none."""
    return {rule.code: rule for rule in RULES}[code.upper()]
