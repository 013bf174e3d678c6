"""The numbered rules on charts: one table (`RULES`), one way to apply them (`check_charts`), modules by subject."""

from plcopen_sfc.analysis.checks.checked_chart import Finding, Rule
from plcopen_sfc.analysis.checks.rule_table import RULES, check_charts, rule_named

__all__ = ["RULES", "Finding", "Rule", "check_charts", "rule_named"]
