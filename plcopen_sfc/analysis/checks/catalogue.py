"""The rules as a page of documentation: docs/checks.md is what `catalogue` gives."""

from __future__ import annotations

from collections.abc import Iterable

from plcopen_sfc.analysis.checks.rules import FAMILIES, Rule

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
excluded from the program are left out, and so are those that a comment lets be: `plcopen-sfc: ignore STR09` in the
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
