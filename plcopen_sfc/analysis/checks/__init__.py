"""The numbered rules on charts: one table (`all_rules`), one way to apply them (`check_charts`), modules by subject.

`rule_table`          the table, the application of rules, and CHK: comments that suppress findings
`checked_chart`       a rule, a finding, and the chart that rules look at
`judged_terms`        edges and times of a GRAFCET, as the chart's conditions are decided with; `flag_values`: its flags
`structure_rules`     NAM, and STR on elements and how they are drawn and linked
`reachability_rules`  EVO, and STR06 to STR08, STR10, STR13, STR15: on the marking graph and on branches
`transition_rules`    CND and SEL: conditions and competing transitions
`action_rules`        ACT, with `action_targets`: the variables that actions write, and how
`race_rules`          ACT04 and ACT19: variables that several write
`name_rules`          VAR: names in program text
`grafcet_rules`       HIE, and ACT11 to ACT13: macro-steps, enclosing steps, forcing orders, kinds of actions
`limit_rules`         TIM, LIM and LOW: limits of step times, of S7-GRAPH and of lowered code
"""

from plcopen_sfc.analysis.checks.checked_chart import Finding, Rule
from plcopen_sfc.analysis.checks.rule_table import all_rules, check_charts

__all__ = ["Finding", "Rule", "all_rules", "check_charts"]
