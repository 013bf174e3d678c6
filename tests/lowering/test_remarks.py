"""Comments and titles of a chart are in its code, in every form."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.lowering import LoweredPou, lower
from plcopen_sfc.model.text import plain
from tests.lowering.charts import training_chain

TEXTS = ("Waits for parts", "tank in the cellar", "two lines,", "both of them", "forward", "counts them")


def commented() -> m.Pou:
    pou = training_chain()
    chart = pou.sfc
    assert chart is not None
    chart.steps[1].comment = TEXTS[0]
    chart.steps[2].title = m.MultilingualText(texts={"de-DE": "Tank im Keller", "en-US": TEXTS[1]})
    chart.transitions[0].comment = "\n".join(TEXTS[2:4])
    chart.steps[0].actions[0].comment = TEXTS[4]
    pou.actions.append(m.Action(name="Count", comment=TEXTS[5], body=m.StBody(text="Q3 := B5;")))
    chart.steps[1].actions.append(m.ActionAssociation(id=900, target="Count"))
    return pou


def text_of(lowered: LoweredPou) -> str:
    """All comments of the code."""
    body = lowered.pou.body
    if isinstance(body, m.StBody):
        comments = [line.strip() for line in body.text.splitlines() if line.strip().startswith("//")]
        return "\n".join([*comments, *(plain(variable.comment) for variable in lowered.pou.variables())])
    assert isinstance(body, m.FbdBody | m.LdBody)
    return "\n".join(plain(network.comment) for network in body.networks)


FORMS = [
    ("case", "ST", "exact"),
    ("case", "ST", "classic"),
    ("regions", "ST", "exact"),
    ("bits", "ST", "exact"),
    *(("flipflop", language, style) for language in ("ST", "FBD", "LD") for style in ("exact", "classic")),
]


@pytest.mark.parametrize(("construction", "language", "style"), FORMS)
def test_comments_of_steps_and_transitions_stand_in_the_code(construction: str, language: str, style: str) -> None:
    lowered = lower(commented(), construction, style=style, language=language, profile="iec", verify=False)
    assert [text for text in TEXTS if text not in text_of(lowered)] == [], text_of(lowered)


def test_a_title_in_several_languages_is_said_in_that_of_the_code() -> None:
    german = text_of(lower(commented(), "case", profile="iec", lang="de", verify=False))
    assert "Tank im Keller" in german
    assert TEXTS[1] not in german


def test_a_comment_is_before_its_transition() -> None:
    lowered = lower(commented(), "case", profile="iec")
    body = lowered.pou.body
    assert isinstance(body, m.StBody)
    lines = [line.strip() for line in body.text.splitlines()]
    place = lines.index(f"// {TEXTS[2]}")
    assert lines[place + 1] == f"// {TEXTS[3]}"
    assert lines[place + 2].startswith("IF ")
    assert lowered.proof is not None
    assert lowered.proof.proven


@pytest.mark.parametrize(("construction", "language"), [("bits", "ST"), ("flipflop", "FBD"), ("flipflop", "LD")])
def test_comments_of_sequencers_stand_in_their_code(construction: str, language: str) -> None:
    project = sfc.load("fixtures/simaticml-plc")
    chart = project.pou("FB_Drilling").sfc
    assert chart is not None
    for number, element in enumerate([*chart.steps, *chart.transitions]):
        element.comment = f"remark {number}."
    for step in chart.steps if language != "ST" else ():
        step.actions = [action for action in step.actions if action.event is None]  # calls on events have no box
    lowered = lower(project, construction, pou="FB_Drilling", language=language, verify=False)
    paths = {item.path for item in lowered.losses if item.why.startswith("not in the code")}
    assert not {path for path in paths if " / step " in path or " / transition " in path}
    comments = "\n".join(plain(v.comment) for v in lowered.pou.variables())
    assert lowered.pou.body is not None
    assert "remark 0." in comments + lowered.pou.body.model_dump_json()


@pytest.mark.parametrize("construction", ["case", "regions", "bits"])
def test_comments_in_what_steps_do_stay(construction: str) -> None:
    pou = training_chain()
    assert pou.sfc is not None
    pou.actions.append(m.Action(name="Stir", body=m.StBody(text="// not before the valve is shut\nQ3 := B5;")))
    pou.sfc.steps[1].main_action = "Stir"
    pou.sfc.steps[2].main_action = m.StBody(text="Q3 := B4;")
    lowered = lower(pou, construction, profile="codesys")
    assert lowered.proof is not None
    assert lowered.proof.proven
    assert isinstance(lowered.pou.body, m.StBody)
    lines = [line.strip() for line in lowered.pou.body.text.splitlines()]
    place = lines.index("// not before the valve is shut")
    assert lines[place + 1] == "Q3 := B5;"
