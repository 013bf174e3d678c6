"""Features of S7-GRAPH in charts for matiec and Beremiz: statements that do the same."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.report import Outcome
from tests.conversion.features import FEATURES, Feature, feature_project
from tests.judges.matiec import require_matiec

LACKED = {"SkipSteps", "counter"}
QUICK = {"interlock with N", "supervision", "event S0", "permanent instruction after", "ON"}
OF_GRAPH = [
    pytest.param(feature, id=feature.name, marks=() if feature.name in QUICK else pytest.mark.slow)
    for feature in FEATURES
    if feature.sources == ("simaticml",)
]


@pytest.mark.parametrize("feature", OF_GRAPH)
def test_beremiz_executes_what_s7_graph_has_more(feature: Feature) -> None:
    source = feature_project(feature, "simaticml")
    data, report = sfc.convert(source, "plcopen-2.01", flavour="beremiz", partial=True, limit=10)
    lost = report.with_outcome(Outcome.NOT_EXECUTED)
    assert bool(lost) is (feature.name in LACKED), lost
    (verdict,) = report.compared.values()
    # S7-GRAPH tests no transition in its first scan: where the initial step acts, one scan is another
    same = verdict.startswith(("equal", "the same but for the inputs that actions see, and the first scan: equal"))
    assert same or lost, verdict
    assert b"NOT_EXECUTED" not in data or lost


@pytest.mark.slow
def test_the_compiler_takes_it(tmp_path: Path) -> None:
    matiec = require_matiec()
    for feature in (each for each in FEATURES if each.sources == ("simaticml",) and each.name not in LACKED):
        source = feature_project(feature, "simaticml")
        matiec.translate(sfc.convert(source, "iec-text", flavour="matiec")[0].decode(), tmp_path / feature.name)


def test_functions_with_global_variables_are_told_for_matiec() -> None:
    text = "FUNCTION Sum_up : INT VAR_INPUT a : INT; END_VAR Sum_up := a + total; END_FUNCTION\n"
    text += "PROGRAM Main VAR n : INT; END_VAR n := Sum_up(a := n); END_PROGRAM"
    project = sfc.loads(text.encode(), format="iec-text")
    total = m.Variable.model_validate({"name": "total", "type": "INT"})
    project.global_variables = [m.VariableSection(kind=m.SectionKind.GLOBAL, variables=[total])]
    report = sfc.convert(project, "iec-text", flavour="matiec", partial=True)[1]
    (item,) = report.with_outcome(Outcome.NOT_EXECUTED)
    assert item.path == "POU Sum_up"
    assert item.why == "functions have no global variables in matiec: total; it does not compile"
