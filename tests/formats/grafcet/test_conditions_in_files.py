"""Every form in which people write conditions, in every file in which a GRAFCET can be."""

from __future__ import annotations

from functools import cache

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.model import Expression, Project

FORMS = [
    *(
        "1B1 * 2B1 * START",
        "a . b",
        "a · b",
        "a + b",
        "/a",
        "a̅",
        "!a",
        "¬a",
        "↑a",
        "↓a",
        "[C1>3]",
        "1",
        "3s/X2",
        "X2/5s",
    ),
    *(
        "2s/a/3s",
        "1̅B̅1̅ * a",
        "↑1B1 + ↓START",
        "a AND NOT (b OR 1B1)",
        "/(a · b) + [C1≥2] * START",
        "TRUE",
        "=1",
        "a ∧ b ∨ a",
    ),
]
PLAN = """GRAFCET Plan
INPUTS
    a
    b
    1B1
    2B1
    START
INTERNALS
    C1 : INT
INITIAL STEP 1
1 -> 2 : START * /a
STEP 2
    ON ACTIVATION C1 := C1 + 1
2 -> 1 : {}
"""
FILES = ["grafcet-text", "grafcet", "json", "iec-text"]


@cache
def plan(condition: str) -> Project:
    return sfc.loads(PLAN.format(condition).encode())


def text_of(project: Project) -> str:
    chart = project.pous[0].chart
    assert chart is not None
    condition = chart.transitions[1].condition
    assert isinstance(condition, Expression)
    return condition.text


@pytest.mark.parametrize("condition", FORMS)
@pytest.mark.parametrize("form", FILES)
def test_a_condition_means_the_same_in_every_file(form: str, condition: str) -> None:
    source = plan(condition)
    data, report = sfc.convert(source, form)
    assert not [item for item in report.losses if item.outcome != "dropped"]
    again = sfc.loads(data)
    assert not sfc.check(again, select=["CND09", "CND08", "VAR01"])
    if form != "grafcet":  # whose terms are trees
        assert text_of(again) == condition
    verdict = sfc.equivalent(source, again, "grafcet", delay="auto", cap=200, runs=2, scans=20)
    assert verdict.counterexample is None, verdict


@pytest.mark.parametrize("condition", ["1B1 a", "a *", "3s", "[C1>]", "a(", "2"])
@pytest.mark.parametrize("form", ["grafcet-text", "json", "iec-text"])
def test_a_condition_that_cannot_be_read_is_told_in_every_file(form: str, condition: str) -> None:
    again = sfc.loads(sfc.convert(plan(condition), form, partial=True).data)
    assert [finding.code for finding in sfc.check(again, select=["CND09"])] == ["CND09"]
