"""Sequences of S7-GRAPH without an initial step start with their first step."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.model import ActionAssociation, Dialect, Project, Sequence, SfcNetwork
from tests.lowering.grafcets import pou_with
from tests.semantics.charts.rig import Rig, chain


def unmarked() -> SfcNetwork:
    chart = chain("A", "B", conditions="go stop")
    chart.steps[0].initial = False
    chart.steps[1].actions = [ActionAssociation(id=50, target="Q")]
    return chart


def test_the_first_step_is_active_in_the_first_cycle() -> None:
    bench = Rig(unmarked(), "s7graph", variables="go stop Q")
    assert bench.scan().active == "A"
    assert bench.scan(go=True).active == "B"
    assert Rig(unmarked(), "codesys", variables="go stop Q").scan().active == ""


def test_each_sequence_starts_for_itself() -> None:
    chart = chain("A", "B", conditions="c1 c2")
    chart.steps += chain("C", "D").steps
    for number, step in enumerate(chart.steps):
        step.id = 10 + number
        step.initial = step.name == "B"
    chart.transitions = []
    chart.sequences = [Sequence(steps=[10, 11]), Sequence(steps=[12, 13])]
    assert Rig(chart, "s7graph", variables="c1 c2").scan().active == "B C"


@pytest.mark.parametrize("form", ["codesys", "plcopen", "grafcet-text"])
def test_other_tools_get_the_step_as_their_initial_step(form: str) -> None:
    source = Project(name="p", pous=[pou_with(unmarked(), "go stop", "Q")], dialect=Dialect.SCL)
    project = sfc.loads(sfc.dumps(source, format="simaticml"))
    data, report = sfc.convert(project, form, strict=True)
    chart = sfc.loads(data).pous[0].chart
    assert chart is not None
    assert [step.initial for step in chart.steps] == [True, False]
    assert "initial step" in {item.what for item in report.items if item.outcome == "translated"}


def test_it_is_lowered_with_a_proof() -> None:
    source = Project(name="p", pous=[pou_with(unmarked(), "go stop", "Q")], dialect=Dialect.SCL)
    proof = sfc.lower(source, profile="s7graph").proof
    assert proof is not None
    assert proof.equal
