"""Losses of lowering: each thing of a chart that its code does not have is listed."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import lower
from plcopen_sfc.report import Item
from tests.lowering.charts import training_chain


def lost(pou: m.Pou, profile: str) -> list[tuple[str, str]]:
    return [(item.what, item.path) for item in items(pou, profile)]


def items(pou: m.Pou, profile: str) -> tuple[Item, ...]:
    return lower(pou, "bits", profile=profile, verify=False).losses


def timed() -> m.Pou:
    pou = training_chain()
    assert pou.sfc is not None
    pou.sfc.steps[1].min_time = "T#2s"
    pou.sfc.steps[2].max_time = "T#4s"
    return pou


def test_nothing_is_lost_of_a_plain_chart() -> None:
    assert lost(training_chain(), "iec") == []


def test_times_that_a_profile_does_not_have_are_told() -> None:
    pou = timed()
    assert lost(pou, "iec") == [
        ("minimum time", f"POU {pou.name} / step S2"),
        ("maximum time", f"POU {pou.name} / step S3"),
    ]
    assert "T#2s" in items(pou, "iec")[0].why


def test_a_maximum_time_counts_where_a_flag_reports_it() -> None:
    pou = timed()
    assert lost(pou, "codesys") == [("maximum time", f"POU {pou.name} / step S3")]
    assert pou.interface is not None
    pou.interface.sections[0].variables.append(m.Variable(name="SFCError", type=m.ElementaryType(name="BOOL")))
    assert lost(pou, "codesys") == []


def test_what_is_excluded_and_comments_of_the_drawing_are_told() -> None:
    pou = training_chain()
    chart = pou.sfc
    assert chart is not None
    chart.steps[0].actions[0].exclude = True
    chart.comment = "drawn by hand"
    chart.logic.append(m.CommentBox(id=chart.new_id(), content="look here"))
    action = chart.steps[0].actions[0].target
    assert lost(pou, "iec") == [
        ("action", f"POU {pou.name} / step S1 / action {action}"),
        ("comment", f"POU {pou.name}"),
        ("comment", f"POU {pou.name}"),
    ]
    assert {item.why for item in items(pou, "iec")[1:]} == {
        "not in the code: drawn by hand",
        "not in the code: look here",
    }


def test_a_comment_in_another_language_is_told() -> None:
    pou = training_chain()
    assert pou.sfc is not None
    pou.sfc.steps[0].comment = m.MultilingualText(texts={"de-DE": "Grundstellung", "en-US": "at rest"})
    (item,) = items(pou, "iec")
    assert item.why == "the code has it in one language, not in de-DE"


def test_comments_inside_of_texts_are_told_where_they_are_drawn() -> None:
    pou = training_chain()
    assert pou.sfc is not None
    pou.actions.append(m.Action(name="Count", body=m.StBody(text="Q3 := B5; // counts parts")))
    pou.sfc.steps[1].actions.append(m.ActionAssociation(id=900, target="Count"))
    text = lower(pou, "flipflop", language="ST", profile="iec", verify=False)
    drawn = lower(pou, "flipflop", language="FBD", profile="iec", verify=False)
    assert text.losses == ()
    assert [(item.path, item.why) for item in drawn.losses] == [
        (f"POU {pou.name} / action Count", "not in the code: // counts parts")
    ]


def test_charts_of_actions_that_are_lowered_along_lose_nothing_in_silence() -> None:
    outer, inner = training_chain(), timed()
    assert outer.sfc is not None
    assert inner.sfc is not None
    outer.actions.append(m.Action(name="Fill", body=m.SfcBody(chart=inner.sfc)))
    outer.sfc.steps[1].actions.append(m.ActionAssociation(id=900, target="Fill"))
    assert ("minimum time", f"POU {outer.name} / action Fill / step S2") in lost(outer, "iec")
    alone = lower(m.Project(pous=[outer]), "bits", pou=f"{outer.name}.Fill", profile="iec", verify=False)
    assert [item.what for item in alone.losses] == ["minimum time", "maximum time"]


def test_an_error_names_the_action_whose_chart_it_is_in() -> None:
    outer, inner = training_chain(), training_chain()
    assert outer.sfc is not None
    assert inner.sfc is not None
    inner.sfc.transitions[1].condition = None
    outer.actions.append(m.Action(name="Fill", body=m.SfcBody(chart=inner.sfc)))
    outer.sfc.steps[1].actions.append(m.ActionAssociation(id=900, target="Fill"))
    project = m.Project(pous=[outer])
    for name in (outer.name, f"{outer.name}.Fill"):
        with pytest.raises(LoweringError) as refused:
            lower(project, "bits", pou=name, profile="iec", verify=False)
        assert refused.value.location.path == f"POU {outer.name} / action Fill / transition S2 -> S3"


def test_variables_that_only_a_chart_can_have_are_one_loss() -> None:
    project = sfc.load("fixtures/simaticml-training-chain/Ablauf.xml")
    pou = project.pou("Ablauf")
    assert pou.interface is not None
    data = [m.Variable(name=name, type=m.DerivedType(name="G7_StepPlus_V6")) for name in ("S1", "S2")]
    pou.interface.sections.append(m.VariableSection(kind=m.SectionKind.LOCAL, variables=data))
    item = lower(project, "bits", verify=False).losses[-1]
    assert (item.what, item.path) == ("variables", f"POU {pou.name}")
    assert item.why.endswith(": S1, S2")
