"""``plcopen-sfc formats``, ``rules`` and ``schema``: what is read and written, and what `check` looks for."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from plcopen_sfc.analysis.checks import Rule, all_rules
from plcopen_sfc.analysis.checks.rule_table import catalogue, in_profiles, selected
from plcopen_sfc.cli.screen import Screen, Table
from plcopen_sfc.formats.format_interface import Format
from plcopen_sfc.formats.registry import all_formats
from plcopen_sfc.model.project import Project


def formats(screen: Screen) -> int:
    """Print the table of formats."""
    listed = [_format_data(kind) for kind in all_formats()]
    screen.result({"formats": listed})
    if screen.as_json:
        return 0
    table = Table(["format", "extensions", "what it is", "charts keep"])
    for kind in listed:
        table.rows.append(
            (
                kind["name"],
                " ".join(kind["extensions"]),
                kind["title"],
                ", ".join(kind["capabilities"]),
            )
        )
    screen.table(table)
    screen.line()
    for kind in listed:
        if kind["versions"]:
            insist = ", ".join(f"{kind['name']}-{version}" for version in kind["versions"])
            screen.line(f"{kind['title']}: --to {insist} insists on a version.")
        for flavour in kind["flavours"]:
            screen.line(f"{kind['title']}: --for {flavour} writes what {flavour} can read.")
    return 0


def _format_data(kind: Format) -> dict[str, Any]:
    return {
        "name": kind.name,
        "title": kind.title,
        "extensions": list(kind.extensions),
        "versions": list(kind.versions),
        "flavours": list(kind.flavours),
        "capabilities": list(kind.capabilities),
    }


def rules(screen: Screen, codes: Sequence[str] | None, *, markdown: bool) -> int:
    """List all rules, or explain those with these codes."""
    found = selected(all_rules(), codes or (), ())
    screen.result({"rules": [_rule_data(rule) for rule in found]})
    if screen.as_json:
        return 0
    if markdown:
        screen.lines([[(line, "")] for line in catalogue(found).splitlines()])
    elif codes:
        for rule in found:
            _explain(screen, rule)
    else:
        table = Table(["rule", "severity", "what"])
        table.rows = [[rule.code, rule.severity.value if rule.severity else "-", rule.title] for rule in found]
        screen.table(table)
    return 0


def schema(screen: Screen) -> int:
    """Print the JSON Schema of the model."""
    screen.as_json = True
    screen.result({"$schema": "https://json-schema.org/draft/2020-12/schema", **Project.model_json_schema()})
    return 0


def _explain(screen: Screen, rule: Rule) -> None:
    screen.line((f"{rule.code} ", "bold"), (rule.title, "bold"))
    screen.line(f"  {rule.why}")
    screen.line(f"  What to do: {rule.hints}")
    screen.line(f"  Severity: {in_profiles(rule)}")
    for line in rule.example.strip().splitlines():
        screen.line(f"    {line}")


def _rule_data(rule: Rule) -> dict[str, Any]:
    return {
        "code": rule.code,
        "title": rule.title,
        "why": rule.why,
        "hint": rule.hint,
        "grafcet_hint": rule.grafcet_hint,
        "severity": rule.severity,
        "severities": dict(rule.severities),
        "example": rule.example.strip(),
    }
