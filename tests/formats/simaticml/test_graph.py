"""GRAPH blocks: as many objects in the model as in the file, what connections mean, and every kind of action row."""

from __future__ import annotations

import io
from pathlib import Path

import pytest
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc.drawing import fits
from plcopen_sfc.model import (
    BodyCondition,
    Expression,
    MultilingualText,
    Project,
    SfcNetwork,
)
from plcopen_sfc.report import Outcome
from tests.formats.simaticml.documents import FIXTURES, GRAPH_PARAMS, parsed


def charts(project: Project) -> list[SfcNetwork]:
    return [chart.chart for chart in project.charts()]


@pytest.mark.parametrize("path", GRAPH_PARAMS)
def test_as_many_objects_as_elements(path: Path) -> None:
    root = parsed(path.read_bytes())
    (chart,) = charts(sfc.load(path))
    assert len(chart.steps) == len(root.findall(".//{*}Steps/{*}Step"))
    assert len(chart.transitions) == len(root.findall(".//{*}Transitions/{*}Transition"))
    assert len(chart.sequences) == len(root.findall(".//{*}Sequence"))
    rows = [row for row in root.findall(".//{*}Actions/{*}Action") if len(row) or row.attrib]
    assert len(list(chart.associations())) == len(rows)
    assert len(chart.permanent_pre) == len(root.findall(".//{*}PreOperations/{*}PermanentOperation"))
    assert len(chart.permanent_post) == len(root.findall(".//{*}PostOperations/{*}PermanentOperation"))
    assert [step.number for step in chart.steps] == [int(e.get("Number", "")) for e in root.iter("{*}Step")]


@pytest.mark.parametrize("path", GRAPH_PARAMS)
def test_connections_mean_what_they_say(path: Path) -> None:
    """Without branches, a transition leads from the step that is connected to it to the one that it is connected to."""
    root = parsed(path.read_bytes())
    project = sfc.load(path)
    (chart,) = charts(project)
    if any(d.code == "SFC102" for d in project.diagnostics) or not chart.steps:
        pytest.skip("a template with a connection to nothing")
    assert fits(chart)
    numbers = {step.id: step.number for step in chart.steps}
    transitions = {t.number: t for t in chart.transitions}
    seen = 0
    for connection in root.iter("{*}Connection"):
        source, target = (next(iter(node)) for node in list(connection)[:2])
        kinds = [etree.QName(source).localname, etree.QName(target).localname]
        if kinds == ["StepRef", "TransitionRef"]:
            found = transitions[int(target.get("Number", ""))].sources
            assert [numbers[i] for i in found] == [int(source.get("Number", ""))]
        elif kinds == ["TransitionRef", "StepRef"]:
            found = transitions[int(source.get("Number", ""))].targets
            assert [numbers[i] for i in found] == [int(target.get("Number", ""))]
        elif kinds == ["TransitionRef", "EndConnection"]:
            assert transitions[int(source.get("Number", ""))].targets == []
        else:
            continue
        seen += 1
    assert seen


def test_the_drilling_machine() -> None:
    (chart,) = charts(sfc.load(FIXTURES / "FB_Drill.xml"))
    names = {step.id: step.name for step in chart.steps}
    nets = {t.name: ([names[i] for i in t.sources], [names[i] for i in t.targets]) for t in chart.transitions}
    assert nets["T_Clamped"] == (["Clamp part"], ["Drill", "Cool"])
    assert nets["T_Down"] == (["Drill", "Cool"], ["Bottom"])
    assert nets["T_Free"] == (["Release"], ["Ready"])
    assert nets["T_End"] == (["Lamp on"], [])
    assert [t.name for t in chart.outgoing(chart.step("Bottom"))] == ["T_Deep", "T_Flat"]
    assert [[names[i] for i in sequence.steps][-1] for sequence in chart.sequences] == ["Release", "Lamp on"]
    drill = chart.step("Drill")
    assert drill.supervision is not None
    assert drill.supervision.alarm == MultilingualText(texts={"de-DE": "Druck zu klein", "en-US": "Pressure too low"})
    assert chart.step("Ready").supervision is None
    settings = chart.graph_settings
    assert settings is not None
    assert settings.acknowledge_errors_required is True
    assert settings.alarm_categories == []  # the usual ones
    conditions = [t.condition for t in chart.transitions]
    assert all(isinstance(condition, BodyCondition) for condition in conditions)


def test_priorities_are_the_order_of_the_legs() -> None:
    data = (FIXTURES / "FB_Drill.xml").read_bytes()
    project = sfc.loads(data)
    (chart,) = charts(project)
    deep, flat = (chart.transition(name) for name in ("T_Deep", "T_Flat"))
    assert (deep.priority, flat.priority) == (1, 2)
    deep.priority, flat.priority = 2, 1
    (again,) = charts(sfc.loads(sfc.dumps(project)))
    assert [t.name for t in again.outgoing(again.step("Bottom"))] == ["T_Flat", "T_Deep"]


def test_a_priority_without_a_competing_transition_is_kept_beside() -> None:
    """It was gone from the file, and the report told only what was kept."""
    project = sfc.loads((FIXTURES / "FB_Drill.xml").read_bytes())
    charts(project)[0].transition("T_Start").priority = 9
    content = io.BytesIO()
    report = sfc.save(project, content, format="simaticml")
    assert [(item.outcome, item.path) for item in report.items if item.what == "priority"] == [
        (Outcome.EXTENSION_DATA, "POU FB_Drill / transition T_Start")
    ]
    (again,) = charts(sfc.loads(content.getvalue()))
    assert again.transition("T_Start").priority == 9


def test_a_step_added_to_a_chart_is_written_with_its_connections() -> None:
    data = (FIXTURES / "FB_Drill.xml").read_bytes()
    project = sfc.loads(data)
    (chart,) = charts(project)
    transition = chart.transition("T_Free")
    step = chart.add_step("Unload")
    ready = chart.step("Ready")
    transition.targets = [step.id]
    chart.add_transition(step, ready, "#Start")
    (again,) = charts(sfc.loads(sfc.dumps(project)))
    names = {s.id: s.name for s in again.steps}
    assert [names[i] for i in again.transition("T_Free").targets] == ["Unload"]
    (leaving,) = again.outgoing(again.step("Unload"))
    assert [names[i] for i in leaving.targets] == ["Ready"]
    assert leaving.condition == Expression(text="#Start")


def test_a_connection_to_nothing_is_an_error_and_stays() -> None:
    data = (FIXTURES / "FB_Drill.xml").read_bytes()
    damaged = data.replace(b'<TransitionRef Number="3" />', b'<TransitionRef Number="333" />', 1)
    project = sfc.loads(damaged)
    assert [d.code for d in project.diagnostics][:1] == ["SFC102"]
    assert sfc.dumps(project) == damaged
    fresh = sfc.dumps(project, fresh=True)
    assert fresh.count(b"<Connection>") == data.count(b"<Connection>")
    assert b'<TransitionRef Number="333" />' in fresh


def test_a_jump_to_another_sequence_leaves_both_sequences() -> None:
    """A file with such a jump was written anew after an edit, with one sequence in the place of two."""
    project = sfc.load("fixtures/simaticml-plc/Program blocks/FB_Drilling.xml")
    chart = project.pou("FB_Drilling").chart
    assert chart is not None
    parts = [sequence.steps for sequence in chart.sequences]
    project.edit().retarget(chart.step("Home"), chart.step("ChipsOff"))
    jumps = [transition.targets for transition in chart.jumps_between_sequences()]
    assert jumps
    for fresh in (False, True):
        written = sfc.dumps(project, fresh=fresh)
        again = sfc.loads(written)
        (chart,) = charts(again)
        assert [sequence.steps for sequence in chart.sequences] == parts
        assert [transition.targets for transition in chart.jumps_between_sequences()] == jumps
        chart.rename_step("ChipsOff", "SpaeneAus")
        lines = zip(written.splitlines(), sfc.dumps(again).splitlines(), strict=True)
        assert all(b"ChipsOff" in one for one, other in lines if one != other)


def test_the_title_of_a_sequence_that_an_edit_joins_to_another_is_reported() -> None:
    """It was gone from the file, and the report told only what was kept."""
    project = sfc.load("fixtures/simaticml-plc/Program blocks/FB_Drilling.xml")
    chart = project.pou("FB_Drilling").chart
    assert chart is not None
    chart.add_transition(["Home", "ChipsOff"], "Home", "FALSE")
    written = sfc.convert(project, "simaticml")
    lost = [item for item in written.report.with_outcome(sfc.report.Outcome.DROPPED) if item.what == "title"]
    assert {item.path for item in lost} == {"POU FB_Drilling / sequence 2"}
    assert all("Späneförderer" in item.why for item in lost)
    assert written.data.decode().count("<Sequence>") == 1
