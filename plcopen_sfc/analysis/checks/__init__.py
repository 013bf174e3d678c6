"""The numbered rules on charts: one table (`RULES`), one way to apply them (`check_charts`)."""

from plcopen_sfc.analysis.checks.rules import Finding, Rule
from plcopen_sfc.analysis.checks.running import check_charts
from plcopen_sfc.analysis.checks.table import RULES, rule_named

__all__ = ["RULES", "Finding", "Rule", "check_charts", "rule_named"]
