"""``plcopen-sfc rules``: what `check` looks for."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from plcopen_sfc.analysis.checks import Rule, all_rules
from plcopen_sfc.analysis.checks.rule_table import catalogue, in_profiles, selected
from plcopen_sfc.cli.screen import Screen, Table


def run(screen: Screen, codes: Sequence[str], *, markdown: bool) -> int:
    """List all rules, or explain those with these codes."""
    rules = selected(all_rules(), codes, ())
    screen.result({"rules": [_data(rule) for rule in rules]})
    if screen.as_json:
        return 0
    if markdown:
        screen.lines([[(line, "")] for line in catalogue(rules).splitlines()])
    elif codes:
        for rule in rules:
            _explain(screen, rule)
    else:
        table = Table(["rule", "severity", "what"])
        table.rows = [[rule.code, rule.severity.value if rule.severity else "-", rule.title] for rule in rules]
        screen.table(table)
    return 0


def _explain(screen: Screen, rule: Rule) -> None:
    screen.line((f"{rule.code} ", "bold"), (rule.title, "bold"))
    screen.line(f"  {rule.why}")
    screen.line(f"  What to do: {rule.hint}")
    screen.line(f"  Severity: {in_profiles(rule)}")
    for line in rule.example.strip().splitlines():
        screen.line(f"    {line}")


def _data(rule: Rule) -> dict[str, Any]:
    return {
        "code": rule.code,
        "title": rule.title,
        "why": rule.why,
        "hint": rule.hint,
        "severity": rule.severity,
        "severities": dict(rule.severities),
        "example": rule.example.strip(),
    }
