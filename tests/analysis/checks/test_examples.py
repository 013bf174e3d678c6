"""The table of rules, and the page that is made of it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.analysis.checks import Rule, all_rules
from plcopen_sfc.analysis.checks.checked_chart import FAMILIES
from plcopen_sfc.analysis.checks.rule_table import catalogue
from plcopen_sfc.pages.page_words import german
from tests.analysis.checks.charts import project_of

PAGE = Path(__file__).resolve().parents[3] / "docs" / "checks.md"
WORD = re.compile(r"\b[a-z]{3,}\b(?=[^`]*(?:`[^`]*`[^`]*)*$)")
"""Words in small letters that are not in code."""
IN_TEXT = [rule for rule in all_rules() if "\n" in rule.example]


def test_codes_are_unique_and_in_order() -> None:
    found = [rule.code for rule in all_rules()]
    assert len(set(found)) == len(found)
    assert all(re.fullmatch(r"[A-Z]{3}\d\d", code) for code in found)
    for group in {code[:3] for code in found}:
        numbers = [code for code in found if code.startswith(group)]
        assert numbers == sorted(numbers)


@pytest.mark.parametrize("rule", all_rules(), ids=lambda rule: rule.code)
def test_a_rule_says_what_people_need(rule: Rule) -> None:
    assert not rule.title.endswith(".")
    assert rule.why.endswith(".")
    assert rule.hint.endswith(".")
    assert rule.example
    assert set(rule.severities) <= set(FAMILIES)
    assert any(rule.severity_for(name) is not None for name in FAMILIES)


@pytest.mark.parametrize("rule", IN_TEXT, ids=lambda rule: rule.code)
def test_examples_break_their_rule(rule: Rule) -> None:
    is_grafcet = rule.example.startswith("\nGRAFCET ")
    project = sfc.loads(rule.example.encode()) if is_grafcet else project_of(rule.example)
    found = {name: sfc.check(project, profile=name, select=[rule.code]) for name in FAMILIES}
    assert any(found.values())
    for name, findings in found.items():
        assert {finding.severity for finding in findings} <= {rule.severity_for(name)}
    told = {text for findings in found.values() for finding in findings for text in (finding.message, finding.hint)}
    for text in told:
        told_of_it = german(text)
        assert told_of_it != text
        kept = set(WORD.findall(told_of_it)) & set(WORD.findall(text)) - {"was"}
        # names of the example are kept, and nothing else is English
        assert [word for word in kept if not re.search(rf"\b{word}\b", rule.example)] == [], told_of_it


def test_the_page_is_made_of_the_rules() -> None:
    assert PAGE.read_text(encoding="utf-8") == catalogue(all_rules()), "plcopen-sfc rules --markdown > docs/checks.md"
