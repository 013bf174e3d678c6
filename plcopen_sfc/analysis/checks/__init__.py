"""The numbered rules on charts: one table (`all_rules`), one way to apply them (`check_charts`), modules by subject."""

from plcopen_sfc.analysis.checks.checked_chart import Finding, Rule
from plcopen_sfc.analysis.checks.rule_table import all_rules, check_charts, rule_named

__all__ = ["Finding", "Rule", "all_rules", "check_charts", "rule_named"]
