"""Lowering as scripts call it: a copy of the project with code instead of the chart, and the proof."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import VerdictKind, equivalent
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import Construction, lower
from tests.lowering.charts import training_chain
from tests.samples import FIXTURES


def project() -> m.Project:
    return m.Project(name="Anlage", pous=[training_chain()])


def test_the_copy_has_code_where_the_project_has_a_chart() -> None:
    original = project()
    before = original.model_copy(deep=True)
    lowered = lower(original)
    assert original == before
    assert lowered.construction is Construction.CASE
    assert isinstance(lowered.project.pou("Ablauf").body, m.StBody)
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN
    assert {"Q1", "Q2", "Q3", "S1.X", "S2.X", "S3.X", "S4.X"} <= set(lowered.proof.compared)


def test_the_textbook_chain_is_different_and_says_with_which_inputs() -> None:
    lowered = lower(project(), "fup", style="classic", init="Init", lang="de")
    assert lowered.construction is Construction.FLIPFLOP
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.DIFFERENT
    assert lowered.proof.counterexample is not None
    assert lowered.proof.counterexample.shortest


@pytest.mark.parametrize("form", ["plcopen-2.01", "codesys", "iec-text", "scl", "simaticml", "json"])
@pytest.mark.parametrize("construction", ["case", "bits"])
def test_what_was_written_and_read_again_is_proven_too(construction: str, form: str) -> None:
    original = project()
    again = sfc.loads(sfc.dumps(lower(original, construction, verify=False).project, format=form), format=form)
    found = equivalent(original, again, "iec")
    assert found.kind is VerdictKind.PROVEN, str(found)


@pytest.mark.slow
@pytest.mark.parametrize("form", ["plcopen-2.01", "codesys", "iec-text", "json"])
@pytest.mark.parametrize("language", ["FBD", "LD"])
def test_networks_that_were_written_and_read_again_are_proven_too(language: str, form: str) -> None:
    original = project()
    lowered = lower(original, "flipflop", language=language, verify=False)
    found = equivalent(original, sfc.loads(sfc.dumps(lowered.project, format=form), format=form), "iec")
    assert found.kind is VerdictKind.PROVEN, str(found)


def test_what_is_not_known_is_refused() -> None:
    original = project()
    for wrong in ({"construction": "magic"}, {"style": "baroque"}, {"language": "CFC"}, {"lang": "fr"}):
        with pytest.raises(LoweringError, match="There are: "):
            lower(original, **wrong)
    with pytest.raises(LoweringError, match="cannot be drawn in FBD"):
        lower(original, "case", language="FBD")
    chart = original.pous[0].sfc
    assert chart is not None
    chart.steps[0].supervision = m.Supervised(condition=m.Expression(text="B5"))
    with pytest.raises(LoweringError, match="supervisions"):
        lower(original)


def test_a_chart_that_was_not_read_completely_is_refused() -> None:
    broken = sfc.load(FIXTURES / "broken" / "connection_to_nothing.xml")
    with pytest.raises(LoweringError, match="not read completely"):
        lower(broken, verify=False)


def test_a_step_with_the_name_of_a_variable_is_refused_before_any_code_is_made() -> None:
    """Which of both a name means depends on the tool: the code was found to be different then."""
    original = project()
    chart = original.pous[0].sfc
    assert chart is not None
    chart.steps[1].name = original.pous[0].variables()[0].name.swapcase()
    with pytest.raises(LoweringError, match=r"is called .*, too: rename it or the step"):
        lower(original, verify=False)


@pytest.mark.parametrize("kind", ["action", "transition"])
def test_two_parts_of_one_name_are_refused_with_their_place(kind: str) -> None:
    """A chart that names them would be lowered with the first and executed with the last."""
    original = project()
    pou = original.pous[0]
    assert pou.sfc is not None
    bodies = [m.StBody(text=text) for text in ("Q1 := TRUE;", "Q1 := FALSE;")]
    names = zip(("Fill", "FILL"), bodies, strict=True)
    if kind == "action":
        pou.sfc.steps[0].entry_action = "Fill"
        pou.actions = [m.Action(name=name, body=body) for name, body in names]
    else:
        pou.sfc.transitions[0].condition = m.NamedCondition(name="Fill")
        pou.transitions = [m.NamedTransition(name=name, body=body) for name, body in names]
    with pytest.raises(LoweringError, match=f"2 {kind}s called Fill") as refused:
        lower(original)
    assert refused.value.location.path == f"POU Ablauf / {kind} Fill"
    assert "Rename" in refused.value.hint
