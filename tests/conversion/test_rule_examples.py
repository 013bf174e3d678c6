"""The examples of docs/conversion.md, one for each rule: the rule acts in it, and both sides run the same."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from plcopen_sfc.conversion.adaptation import chart_rules, project_rewriting
from plcopen_sfc.report import START_OF_CHART
from tests.conversion.matrix import same_behaviour
from tests.conversion.rule_examples import EXAMPLES, RuleExample, examples_text

PAGE = Path(__file__).parents[2] / "docs" / "conversion.md"


def test_every_rule_has_its_example_on_the_page() -> None:
    rules = [rule.of for rule in (*project_rewriting.RULES, *chart_rules.CHART_RULES)]
    assert [example.rule for example in EXAMPLES] == rules
    assert examples_text() in PAGE.read_text("utf-8")


def watched(apply: Callable[[Any], None], acted: list[str], name: str) -> Callable[[Any], None]:
    """A rule that notes its name where it changes the project or the chart, or reports something."""

    def watching(this: Any) -> None:
        rewriting = getattr(this, "_rewriting", this)
        place = this.project if rewriting is this else rewriting.chart.pou

        def state() -> tuple[str, int]:
            return place.model_dump_json(), len(rewriting.report.items)

        before = state()
        apply(this)
        if state() != before:
            acted.append(name)

    return watching


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.rule)
def test_the_rule_acts_in_its_example(example: RuleExample, monkeypatch: pytest.MonkeyPatch) -> None:
    source, acted = example.load(), list[str]()
    for module, name in ((project_rewriting, "RULES"), (chart_rules, "CHART_RULES")):
        rules = getattr(module, name)
        monkeypatch.setattr(module, name, tuple(replace(r, apply=watched(r.apply, acted, r.of)) for r in rules))
    replace(example, load=lambda: source).converted()
    assert example.rule in acted


@pytest.mark.parametrize("example", EXAMPLES[len(project_rewriting.RULES) :], ids=lambda example: example.rule)
def test_the_chart_of_an_example_runs_the_same_or_the_report_has_why_not(example: RuleExample) -> None:
    source, result, report = example.converted()
    verdict = same_behaviour(source, result)
    assert verdict is not None
    assert verdict.equal or [item for item in report.losses if item.what != START_OF_CHART]
