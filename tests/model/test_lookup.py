"""Finding things in a project: one name for one thing, and one way to look it up."""

from __future__ import annotations

import plcopen_sfc as sfc
from plcopen_sfc import model as m


def project_with_an_action() -> m.Project:
    main, fill = m.SfcNetwork(), m.SfcNetwork()
    main.add_step("Init", initial=True)
    fill.add_step("Open", initial=True)
    pou = m.Pou(
        name="Main",
        kind=m.PouKind.PROGRAM,
        bodies=[m.SfcBody(chart=main)],
        actions=[m.Action(name="Fill", body=m.SfcBody(chart=fill)), m.Action(name="Drain", body=m.StBody(text="x;"))],
    )
    return sfc.Project(pous=[pou])


def test_a_chart_is_called_chart_wherever_it_is():
    project = project_with_an_action()
    pou = project.pou("Main")
    own, of_action = project.charts()
    assert own.chart is pou.chart is pou.sfc is pou.body.chart is own.chart.steps[0].chart
    assert (of_action.name, of_action.pou, of_action.chart.steps[0].name) == ("Main.Fill", pou, "Open")
    partial = m.PartialChart(name="G2", chart=m.SfcNetwork())
    assert partial.chart.steps == []


def test_bodies_of_a_project_and_of_a_pou_have_one_shape():
    project = project_with_an_action()
    found = [(each.name, each.pou.name, each.body.language) for each in project.bodies()]
    assert found == [("Main", "Main", "SFC"), ("Main.Fill", "Main", "SFC"), ("Main.Drain", "Main", "ST")]
    assert list(project.pou("Main").named_bodies()) == list(project.bodies())
