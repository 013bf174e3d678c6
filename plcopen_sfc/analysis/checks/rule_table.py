"""Every rule, and the catalogue of them for people."""

from __future__ import annotations

from collections.abc import Iterable

from plcopen_sfc.analysis.checks import (
    condition_rules,
    connection_rules,
    event_rules,
    hierarchy_rules,
    limit_rules,
    name_rules,
    qualifier_rules,
    race_rules,
    reachability_rules,
    selection_rules,
    start_and_end_rules,
    storing_rules,
    suppression,
    transient_rules,
)
from plcopen_sfc.analysis.checks.rule import FAMILIES, Rule

_ON_CHARTS: tuple[Rule, ...] = (
    connection_rules.STR01,
    start_and_end_rules.STR02,
    connection_rules.STR04,
    connection_rules.STR05,
    reachability_rules.STR06,
    reachability_rules.STR07,
    reachability_rules.STR08,
    start_and_end_rules.STR09,
    reachability_rules.STR10,
    start_and_end_rules.STR11,
    start_and_end_rules.STR12,
    hierarchy_rules.STR13,
    start_and_end_rules.STR14,
    reachability_rules.STR15,
    name_rules.NAM01,
    name_rules.NAM02,
    name_rules.NAM03,
    name_rules.NAM04,
    name_rules.NAM05,
    selection_rules.SEL01,
    selection_rules.SEL02,
    selection_rules.SEL03,
    selection_rules.SEL04,
    condition_rules.CND01,
    condition_rules.CND02,
    condition_rules.CND03,
    condition_rules.CND04,
    condition_rules.CND05,
    condition_rules.CND06,
    condition_rules.CND07,
    condition_rules.CND08,
    condition_rules.CND09,
    qualifier_rules.ACT01,
    storing_rules.ACT02,
    storing_rules.ACT03,
    race_rules.ACT04,
    qualifier_rules.ACT05,
    qualifier_rules.ACT06,
    qualifier_rules.ACT07,
    qualifier_rules.ACT08,
    qualifier_rules.ACT09,
    storing_rules.ACT10,
    event_rules.ACT11,
    event_rules.ACT12,
    event_rules.ACT13,
    qualifier_rules.ACT14,
    qualifier_rules.ACT15,
    qualifier_rules.ACT16,
    qualifier_rules.ACT17,
    storing_rules.ACT18,
    transient_rules.EVO01,
    transient_rules.EVO02,
    event_rules.TIM01,
    hierarchy_rules.HIE01,
    hierarchy_rules.HIE02,
    hierarchy_rules.HIE03,
    hierarchy_rules.HIE04,
    hierarchy_rules.HIE05,
    hierarchy_rules.HIE06,
    hierarchy_rules.HIE07,
    hierarchy_rules.HIE08,
    limit_rules.LIM01,
    limit_rules.LOW01,
    limit_rules.LOW02,
)

RULES: tuple[Rule, ...] = (*_ON_CHARTS, suppression.rule_on([*(rule.code for rule in _ON_CHARTS), "CHK01"]))
"""Every rule, by group and number."""


def rule_named(code: str) -> Rule:
    """The rule with this code. `KeyError` where there is none."""
    return {rule.code: rule for rule in RULES}[code.upper()]


_GROUPS = {
    "STR": "Structure",
    "NAM": "Names and numbers",
    "SEL": "Selections",
    "CND": "Conditions",
    "ACT": "Actions",
    "EVO": "Evolution",
    "TIM": "Times",
    "HIE": "Hierarchy",
    "LIM": "Limits of tools",
    "LOW": "Lowering",
    "CHK": "The check itself",
}
_HEAD = """# Checks

The numbered rules on charts: `plcopen-sfc check` on the [command line](cli.md#check), `sfc.check` in Python. This page
is made from the rules (`plcopen-sfc rules --markdown > docs/checks.md`).

How severe a breach is depends on how the chart is executed: on the profile. Where a rule gives several severities,
those are for the profiles that they name; a dash means that the rule is not for them. Findings of elements that are
excluded from the program are left out, and so are those that a comment suppresses: `plcopen-sfc: ignore STR09` in the
comment of a step, a transition, a chart or a POU. Reachability is that of the chart with all conditions free: what is
found impossible is impossible, whatever the inputs do.

"""


def in_profiles(rule: Rule) -> str:
    """The severity of a breach, profile by profile where they differ."""
    groups: dict[str, list[str]] = {}
    for name in FAMILIES:
        severity = rule.severity_for(name)
        groups.setdefault(severity.value if severity is not None else "-", []).append(name)
    if len(groups) == 1:
        return next(iter(groups))
    usual = rule.severity.value if rule.severity is not None else "-"
    return ", ".join(
        [usual, *(f"{severity} ({', '.join(names)})" for severity, names in groups.items() if severity != usual)]
    )


def catalogue(rules: Iterable[Rule]) -> str:
    """The page in Markdown."""
    rules = list(rules)
    lines = [_HEAD.rstrip("\n"), "", "| rule | what | severity |", "|---|---|---|"]
    lines += [f"| [{r.code}](#{r.code.lower()}) | {r.title} | {in_profiles(r)} |" for r in rules]
    group = ""
    for rule in rules:
        if rule.code[:3] != group:
            group = rule.code[:3]
            lines += ["", f"## {_GROUPS[group]}"]
        lines += ["", f"### {rule.code}", "", f"**{rule.title}.** {rule.why}", ""]
        lines += [f"Severity: {in_profiles(rule)}. {rule.hint}", ""]
        lines += _example(rule.example)
    return "\n".join(lines) + "\n"


def _example(example: str) -> list[str]:
    if "\n" not in example:
        return [f"Example: {example}."]
    return ["```iecst", *example.strip().splitlines(), "```"]
