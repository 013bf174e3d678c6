"""Rows of S7-GRAPH in IEC text, which has neither their calls nor their qualifiers."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.report import START_OF_CHART, Outcome
from tests.conversion.features import Feature, FeatureChart, feature_project


def graph(target: str | None, qualifier: str, **fields: object) -> m.Project:
    """A chart of S7-GRAPH with one row."""

    def build(rig: FeatureChart) -> None:
        rig.act("Idle", "q", "S")
        rig.act("Work", target, qualifier, **fields)
        rig.declare(m.SectionKind.LOCAL, m.Variable(name="late", type=m.DerivedType(name="TON_TIME")))

    project = feature_project(Feature("row", ("simaticml",), build), "simaticml")
    return sfc.loads(sfc.dumps(project, format="simaticml"), format="simaticml")


def test_a_call_is_an_action_that_runs_while_the_step_is_active() -> None:
    project = graph(None, "CALL", body=m.StBody(text="#late(IN := #g, PT := T#1s);"))
    data, report = sfc.convert(project, "iec-text")
    assert report.losses == []
    row = next(sfc.loads(data, as_tool=True).charts()).chart.step("Work").actions[0]
    assert row.qualifier is m.Qualifier.N
    assert b"IF Work.X THEN\n            #late(IN := #g, PT := T#1s);\n        END_IF;" in data
    again = next(sfc.loads(data).charts()).chart.step("Work").actions[0]
    assert (again.qualifier, again.body) == (m.Qualifier.CALL, m.StBody(text="#late(IN := #g, PT := T#1s);"))


@pytest.mark.parametrize("target", ["iec-text", "plcopen", "codesys"])
def test_the_other_name_of_r_is_r(target: str) -> None:
    def build(rig: FeatureChart) -> None:
        rig.act("Idle", "q", "S")
        rig.act("Work", "q", "R0")

    project = feature_project(Feature("row", ("iec-text",), build), "iec-text")
    if target != "iec-text":
        project = sfc.loads(sfc.dumps(project, format="iec-text"), format="iec-text")
    data = sfc.dumps(project, format=target)
    assert {item.what for item in sfc.convert(project, target)[1].losses} <= {START_OF_CHART}
    row = next(sfc.loads(data, as_tool=True).charts()).chart.step("Work").actions[0]
    assert row.qualifier is m.Qualifier.R
    again = next(sfc.loads(data).charts()).chart.step("Work").actions[0]
    assert again.qualifier is m.Qualifier.R0


@pytest.mark.parametrize(("qualifier", "fields"), [("CU", {}), ("TL", {"duration": "T#2s"}), ("ON", {})])
def test_other_qualifiers_of_graph_do_not_compile_and_are_told(qualifier: str, fields: dict[str, str]) -> None:
    project = graph("Done" if qualifier == "ON" else "n", qualifier, event="S1", **fields)
    data, report = sfc.convert(project, "iec-text", partial=True)
    assert b"NOT_EXECUTED_" in data
    assert "qualifier" in [item.what for item in report.with_outcome(Outcome.NOT_EXECUTED)]
    assert report.with_outcome(Outcome.APPROXIMATED) == []
