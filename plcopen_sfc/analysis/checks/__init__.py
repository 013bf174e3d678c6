"""The numbered rules on charts: one table (`RULES`), one way to apply them (`check_charts`)."""

from plcopen_sfc.analysis.checks.check_run import check_charts
from plcopen_sfc.analysis.checks.rule import Finding, Rule
from plcopen_sfc.analysis.checks.rule_table import RULES, rule_named

__all__ = ["RULES", "Finding", "Rule", "check_charts", "rule_named"]
