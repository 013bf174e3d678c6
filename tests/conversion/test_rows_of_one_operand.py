"""Rows of S7-GRAPH that write one operand or read what others write: the same in CODESYS and TC6, or reported."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis.equivalence import equivalent
from plcopen_sfc.errors import LossError
from plcopen_sfc.report import INPUTS_OF_ACTIONS, ORDER_OF_ACTIONS, START_OF_CHART, Outcome
from tests.conversion.features import Feature, FeatureChart, feature_project

Row = tuple[str, str, dict[str, str]]
IN_WORK: Row = ("Work", "N", {})
CASES: dict[str, list[Row]] = {
    "driven, reset when left": [IN_WORK, ("Work", "R", {"event": "S0"})],
    "driven, set when left": [IN_WORK, ("Work", "S", {"event": "S0"})],
    "driven, reset at the start": [IN_WORK, ("Work", "R", {"event": "S1"})],
    "driven, set at the start": [IN_WORK, ("Work", "S", {"event": "S1"}), ("Idle", "R", {})],
    "driven, assigned when left": [IN_WORK, ("Work", "N", {"event": "S0", "value": "g"})],
    "driven, assigned at the start": [IN_WORK, ("Work", "N", {"event": "S1", "value": "g"})],
    "for a time, then set": [("Work", "L", {"duration": "T#2s"}), ("Done", "S", {"event": "S1"}), ("Idle", "R", {})],
    "set, then driven": [("Idle", "S", {}), IN_WORK],
    "set, driven, reset": [("Idle", "S", {}), IN_WORK, ("Done", "R", {})],
    "two times": [("Work", "L", {"duration": "T#2s"}), ("Done", "L", {"duration": "T#3s"})],
    "two delays": [("Work", "D", {"duration": "T#2s"}), ("Done", "D", {"duration": "T#3s"})],
    "for a time, then driven": [("Work", "L", {"duration": "T#2s"}), ("Done", "N", {})],
    "reset, then set by the same step": [("Work", "R", {}), ("Work", "S", {}), ("Idle", "R", {})],
    "set, then reset by the same step": [("Idle", "S", {}), ("Work", "S", {}), ("Work", "R", {})],
    "set at the start, then assigned": [("Work", "S", {"event": "S1"}), ("Work", "N", {"value": "g"})],
    "assigned, then set at the start": [("Work", "N", {"value": "g"}), ("Work", "S", {"event": "S1"})],
    "set, then reset at the start": [("Work", "S", {}), ("Work", "R", {"event": "S1"}), ("Idle", "R", {})],
    "reset when left, driven by the next step": [IN_WORK, ("Work", "R", {"event": "S0"}), ("Done", "N", {})],
}
DIFFERENT = {
    ("reset when left, driven by the next step", "codesys"),
    ("reset when left, driven by the next step", "plcopen"),
}


def graph(rows: list[Row]) -> m.Project:
    """A chart of S7-GRAPH with these rows of the operand q."""

    def build(rig: FeatureChart) -> None:
        for step, qualifier, fields in rows:
            rig.act(step, "q", qualifier, **fields)

    project = feature_project(Feature("rows", ("simaticml",), build), "simaticml")
    return sfc.loads(sfc.dumps(project, format="simaticml"), format="simaticml")


@pytest.mark.slow
@pytest.mark.parametrize("target", ["codesys", "plcopen"])
@pytest.mark.parametrize("name", CASES)
def test_the_operand_is_written_as_in_the_source(name: str, target: str) -> None:
    project = graph(CASES[name])
    data, report = sfc.convert(project, target, partial=True)
    result = sfc.loads(data, format=target, as_tool=True)
    profiles = ("s7graph", "codesys" if target == "codesys" else "iec")
    verdict = equivalent(project.pou("Main"), result.pou("Main"), profiles, delay="auto", outputs=["q"], cap=2000)
    assert verdict.equal is ((name, target) not in DIFFERENT), verdict
    allowed = (INPUTS_OF_ACTIONS, START_OF_CHART)  # by the comparison
    losses = [item for item in report.losses if item.what not in allowed]
    assert verdict.equal is not bool(losses), losses


READING: dict[str, list[tuple[str, str, str, dict[str, str]]]] = {
    "at the start, what a row above counts": [
        ("Work", "n", "N", {"value": "n + 1"}),
        ("Work", "m", "N", {"value": "n", "event": "S1"}),
    ],
    "at the start, what rows above and below do": [
        ("Work", "n", "N", {"value": "3"}),
        ("Work", "n", "N", {"value": "n * 2", "event": "S1"}),
        ("Work", "n", "N", {"value": "n + 1"}),
    ],
    "before it is set": [("Work", "r", "N", {"value": "q"}), ("Work", "q", "S", {}), ("Done", "q", "R", {})],
    "what the step drives": [("Work", "z", "N", {}), ("Work", "r", "N", {"value": "z"})],
    "what the step drives, at the start": [("Work", "q", "N", {}), ("Work", "r", "N", {"value": "q", "event": "S1"})],
    "what another branch counts": [
        ("Work", "n", "N", {"value": "n + 1"}),
        ("Along", "m", "N", {"value": "n"}),
    ],
    "what another branch drives": [("Work", "q", "N", {}), ("Along", "r", "N", {"value": "q"})],
    "what the step drove": [("Work", "q", "N", {}), ("Work", "r", "N", {"value": "q", "event": "S0"})],
}
TOLD = {
    ("what another branch counts", "codesys"),
    ("what another branch drives", "codesys"),
    ("what the step drove", "codesys"),
}


@pytest.mark.parametrize("target", ["codesys", "plcopen"])
@pytest.mark.parametrize("name", READING)
def test_rows_read_what_others_write_in_the_order_of_s7_graph(name: str, target: str) -> None:
    def build(rig: FeatureChart) -> None:
        rig.declare(m.SectionKind.OUTPUT, m.Variable(name="m", type=m.ElementaryType(name=m.Elementary.INT)))
        rig.declare(m.SectionKind.OUTPUT, m.Variable(name="z", type=m.ElementaryType(name=m.Elementary.BOOL)))
        if any(step == "Along" for step, *_ in READING[name]):
            along = rig.chart.add_step("Along")
            for transition in rig.chart.transitions:
                transition.targets += [along.id] * (rig.chart.step("Work").id in transition.targets)
                transition.sources += [along.id] * (rig.chart.step("Work").id in transition.sources)
        for step, operand, qualifier, fields in READING[name]:
            rig.act(step, operand, qualifier, **fields)

    project = feature_project(Feature("rows", ("simaticml",), build), "simaticml")
    project = sfc.loads(sfc.dumps(project, format="simaticml"), format="simaticml")
    data, report = sfc.convert(project, target)
    result = sfc.loads(data, format=target, as_tool=True)
    profiles = ("s7graph", "codesys" if target == "codesys" else "iec")
    outputs = ["q", "r", "z", "n", "m"]
    verdict = equivalent(
        project.pou("Main"), result.pou("Main"), profiles, delay="auto", outputs=outputs, cap=2000, runs=20
    )
    assert verdict.equal is ((name, target) not in TOLD), verdict
    told = [item.what for item in report.losses if item.what not in (INPUTS_OF_ACTIONS, START_OF_CHART)]
    assert told == ([] if verdict.equal else [ORDER_OF_ACTIONS])


@pytest.mark.parametrize("target", ["plcopen", "iec-text"])
def test_a_text_of_a_row_is_not_executed_after_its_step(target: str) -> None:
    def build(rig: FeatureChart) -> None:
        rig.act("Work", None, "N", body=m.StBody(text="#n := #n + 1;"))

    project = feature_project(Feature("rows", ("simaticml",), build), "simaticml")
    data, report = sfc.convert(project, target, flavour="matiec" if target == "iec-text" else "", strict=True)
    result = sfc.loads(data, format=target, as_tool=True)
    profiles = ("s7graph", "matiec" if target == "iec-text" else "iec")
    verdict = equivalent(project.pou("Main"), result.pou("Main"), profiles, delay="auto", cap=2000, runs=20)
    assert verdict.counterexample is None, verdict
    assert not report.losses


@pytest.mark.parametrize("name", ["driven, reset at the start", "driven, set when left", "two times"])
def test_the_rows_come_back(name: str) -> None:
    project = graph(CASES[name])
    back = sfc.loads(sfc.convert(project, "codesys")[0], format="codesys")
    rows = [(row.qualifier, row.event) for _, row in next(project.charts()).chart.associations()]
    assert [(row.qualifier, row.event) for _, row in next(back.charts()).chart.associations()] == rows


@pytest.mark.parametrize("target", ["codesys", "plcopen"])
def test_the_order_of_rows_is_found_without_running_them(target: str) -> None:
    """A row between R and S reads the operand, and another row of the chart is lost anyway."""
    rows: list[Row] = [
        ("Work", "R", {}),
        ("Work", "CALL", {"target": None, "body": m.StBody(text="#n := 1;")}),
        ("Work", "S", {}),
        ("Done", "S", {"target": "r", "event": "V1"}),
    ]

    def build(rig: FeatureChart) -> None:
        for step, qualifier, fields in rows:
            rig.act(step, fields.pop("target", "q"), qualifier, **fields)

    _, report = sfc.convert(feature_project(Feature("rows", ("simaticml",), build), "simaticml"), target, partial=True)
    (item,) = [item for item in report.losses if item.what == "stored value of q"]
    assert item.path == "POU Main / step Work"
    assert "order" in item.why
    assert "mistake" not in item.why


def test_the_order_of_rows_is_found_on_the_way_to_tia_portal(tmp_path: Path) -> None:
    project = feature_project(
        Feature("rows", ("codesys",), lambda rig: [rig.act("Work", "q", each) for each in "RS"]), "codesys"
    )
    _, report = sfc.convert(project, "simaticml", partial=True)
    (item,) = [item for item in report.losses if item.what == "stored value of q"]
    assert item.outcome is Outcome.APPROXIMATED
    with pytest.raises(LossError):
        sfc.save(project, tmp_path / "chart.xml", format="simaticml", partial=True, strict=True)
