"""GRAFCETs in tools: what becomes of their actions and conditions, run against the source, and what is refused."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.errors import LossError, ModelError
from plcopen_sfc.model import Project
from plcopen_sfc.report import ConversionReport

TEXT = """GRAFCET Kette AS FUNCTION_BLOCK
INPUTS
    B1
    B2
    B5
OUTPUTS
    Q1
    Q2
    Q3
    H1
    H2
INTERNALS
    n : INT
INITIAL STEP 1
    Q1
    Q3 IF B5
    ON ACTIVATION Q2 := FALSE
1 -> 2 : B1 * /B2
STEP 2
    Q3 IF B5 + B1
    H1 AFTER 30ms
    H2 FOR 30ms
    ON ACTIVATION Q2 := 1
    ON ACTIVATION n := n + 1
2 -> 1 : 50ms/X2 * B2 * /B1
"""
STABILITY = "search for stability"


def losses(report: ConversionReport) -> dict[str, str]:
    return {item.what: item.why for item in report.items if item.outcome in ("not executed", "approximated")}


def converted(text: str, form: str) -> tuple[Project, ConversionReport]:
    data, report = sfc.convert(sfc.loads(text.encode()), form, partial=True)
    return sfc.loads(data), report


@pytest.mark.parametrize("form", ["codesys", "twincat", "simaticml", "plcopen"])
def test_a_chart_without_transient_steps_does_the_same(form: str) -> None:
    source = sfc.loads(TEXT.encode())
    result, report = converted(TEXT, form)
    assert losses(report).keys() == {STABILITY}
    profiles = ("grafcet", {"plcopen": "iec", "simaticml": "s7graph"}.get(form, "codesys"))
    verdict = sfc.equivalent(source, result, profiles, delay="auto", cap=300, runs=4, scans=60)
    assert verdict.counterexample is None, verdict


def test_conditions_and_names_are_those_of_the_tool() -> None:
    chart = converted(TEXT, "plcopen")[0].pous[0].chart
    assert chart is not None
    assert [(step.name, step.number) for step in chart.steps] == [("Step1", 1), ("Step2", 2)]
    texts = [getattr(transition.condition, "text", None) for transition in chart.transitions]
    assert texts == ["B1 AND NOT B2", "Step2.T >= T#50ms AND B2 AND NOT B1"]
    graph = converted(TEXT, "simaticml")[0].pous[0].chart
    assert graph is not None
    events = [(a.target, a.value, a.event) for a in graph.step("Step2").actions if a.event is not None]
    assert events == [("#n", "#n + 1", "S1")]
    assert [step.interlock is not None for step in graph.steps] == [True, True]


def test_strict_conversions_refuse_the_difference() -> None:
    with pytest.raises(LossError, match="fires transitions once in a scan"):
        sfc.convert(sfc.loads(TEXT.encode()), "codesys", strict=True)


@pytest.mark.parametrize(
    ("line", "what"),
    [
        ("    ON EVENT ↑B1 : Q1 := TRUE", "action"),
        ("    Q1 IF ↑B5", "condition"),
        ("    Q1 IF B5 AFTER 3s", "action"),
        ("1 -> 2 : ↑B1", "condition"),
        ("1 -> 2 : 3s/B1", "condition"),
        ("1 -> 2 : B1 B2", "condition"),
        ("CHART G1\n    INITIAL STEP 10\nCHART G2\n    INITIAL STEP 20\n        FORCE G1{INIT}", ""),
    ],
)
@pytest.mark.parametrize("form", ["codesys", "codesys23", "twincat", "simaticml"])
def test_what_the_tool_has_no_words_for_is_told(line: str, what: str, form: str) -> None:
    head = "GRAFCET G AS FUNCTION_BLOCK\nINPUTS\n    B1\n    B2\n    B5\nOUTPUTS\n    Q1\n"
    text = f"{head}INITIAL STEP 1\nSTEP 2\n{line}\n"
    found = losses(converted(text, form)[1])
    assert what in found if what else any("partial charts" in each for each in found)


DIGITS = TEXT.replace("B1", "1B1").replace("Q1", "1M1")


def test_names_that_begin_with_a_digit_are_for_tia_only() -> None:
    report = sfc.convert(sfc.loads(DIGITS.encode()), "simaticml").report
    assert losses(report).keys() == {STABILITY}
    for form in ("codesys", "plcopen", "twincat"):
        with pytest.raises(ModelError, match="no digit at the start"):
            sfc.convert(sfc.loads(DIGITS.encode()), form, partial=True)
    assert (
        sfc.loads(sfc.convert(sfc.loads(DIGITS.encode()), "grafcet", partial=True).data).pous[0].interface is not None
    )
