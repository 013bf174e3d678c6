"""Features of S7-GRAPH in charts for matiec and Beremiz: statements that do the same."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import equivalent
from plcopen_sfc.conversion.chart_runs import SHIFTED
from plcopen_sfc.report import Outcome
from tests.conversion.features import FEATURES, Feature, feature_project
from tests.judges.matiec import require_matiec

QUICK = {"interlock with N", "supervision", "event S0", "permanent instruction after", "ON", "timer of S5: TF"}
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
    assert lost == []
    (verdict,) = report.compared.values()
    # S7-GRAPH tests no transition in its first scan: where the initial step acts, one scan is another
    same = verdict.startswith("equal") or verdict.splitlines()[0].endswith(SHIFTED)
    assert same, verdict
    assert b"NOT_EXECUTED" not in data


@pytest.mark.slow
def test_the_compiler_takes_it(tmp_path: Path) -> None:
    matiec = require_matiec()
    for feature in (each for each in FEATURES if each.sources == ("simaticml",)):
        source = feature_project(feature, "simaticml")
        matiec.translate(sfc.convert(source, "iec-text", flavour="matiec")[0].decode(), tmp_path / feature.name)


FUNCTIONS = """FUNCTION Inner : INT VAR_INPUT a : INT; END_VAR total := 3 - total; Inner := total + a; END_FUNCTION
FUNCTION Outer : INT VAR_INPUT a : INT; END_VAR
IF active THEN Outer := Inner(a); ELSE Outer := Inner(a := 1); END_IF;
END_FUNCTION
FUNCTION_BLOCK Main
VAR_INPUT go : BOOL; END_VAR
VAR_OUTPUT n : INT; END_VAR
VAR_EXTERNAL total : INT; END_VAR
{hiding}
active := go; n := Outer(2) + Outer(a := 3);
END_FUNCTION_BLOCK
"""


def of_functions(hiding: str = "") -> m.Project:
    project = sfc.loads(FUNCTIONS.format(hiding=hiding).encode(), format="iec-text")
    variables = [m.Variable.model_validate({"name": n, "type": t}) for n, t in (("total", "INT"), ("active", "BOOL"))]
    project.global_variables = [m.VariableSection(kind=m.SectionKind.GLOBAL, variables=variables)]
    return project


def test_calls_pass_global_variables_to_functions_for_matiec() -> None:
    source = of_functions()
    data, report = sfc.convert(source, "iec-text", flavour="matiec")
    assert report.losses == []
    text = data.decode()
    assert "n := Outer(2, active, total) + Outer(a := 3, active := active, total := total);" in text
    assert "THEN Outer := Inner(a, total); ELSE Outer := Inner(a := 1, total := total); END_IF;" in text
    written = sfc.loads(data, as_tool=True)
    assert equivalent(source.pou("Main"), written.pou("Main"), outputs=["n"]).proven


def test_a_function_whose_caller_hides_a_global_variable_is_told_for_matiec() -> None:
    """So is the function that it calls, which nothing passes the variable then."""
    report = sfc.convert(of_functions("VAR active : BOOL; END_VAR"), "iec-text", flavour="matiec", partial=True)[1]
    lost = {(item.path, item.why) for item in report.with_outcome(Outcome.NOT_EXECUTED)}
    assert ("POU Inner", "functions have no global variables in matiec: total; it does not compile") in lost
    assert ("POU Outer", "functions have no global variables in matiec: active; it does not compile") in lost
