"""What lowering understands of a chart, and what it refuses."""

from __future__ import annotations

import pytest

from plcopen_sfc import model as m
from plcopen_sfc.analysis.equivalence import Outcome
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering.forms import Construction, Language
from tests.lowering.charts import boolean, training_chain
from tests.lowering.test_exact import FORMS, verdict


def test_assignments_are_executed_while_their_step_is_active() -> None:
    pou = training_chain()
    chart = pou.sfc
    assert chart is not None
    assert pou.interface is not None
    whole = m.ElementaryType(name=m.Elementary.INT)
    pou.interface.sections[1].variables += [m.Variable(name=name, type=whole) for name in ("n", "k")]
    for step, value in zip(chart.steps, ("n + 1", "7", "n + 1", "k"), strict=True):
        chart_action = m.ActionAssociation(id=chart.new_id(), target="n", value=value)
        step.actions.append(chart_action)
    chart.steps[1].actions.append(m.ActionAssociation(id=chart.new_id(), target="k", value="3", qualifier="P1"))
    chart.transitions[0].condition = m.Expression(text="B1 OR n > 1")
    for profile in ("iec", "codesys"):
        for construction, language in FORMS[::2]:
            found = verdict(pou, construction, language, profile)
            assert found.equal, f"{profile} {construction} {language}: {found}"
            assert {"n", "k"} <= set(found.compared)


def test_whether_a_step_will_be_active_is_whether_it_is_where_programs_ask() -> None:
    pou = training_chain()
    chart = pou.sfc
    assert chart is not None
    chart.transitions[2].condition = m.Expression(text="B3 AND S3._x AND NOT S1._X")
    chart.steps[3].main_action = m.StBody(text="Q3 := S4._x;")
    chart.steps[2].actions.clear()
    for construction, language in FORMS[::2]:
        found = verdict(pou, construction, language, "codesys")
        assert found.outcome is Outcome.PROVEN, str(found)
    with pytest.raises(LoweringError, match="_x"):
        verdict(pou, Construction.BITS, Language.ST, "iec")


def test_simple_steps_of_codesys_23_are_flags() -> None:
    pou = training_chain()
    chart = pou.sfc
    assert chart is not None
    for step in chart.steps:
        step.actions.clear()
    chart.steps[1].main_action = m.StBody(text="Q2 := NOT Q2;")
    chart.transitions[1].condition = m.Expression(text="B2 AND S2 AND NOT S3")
    for construction, language in FORMS:
        found = verdict(pou, construction, language, "codesys23")
        assert found.outcome is Outcome.PROVEN, f"{construction} {language}: {found}"


@pytest.mark.parametrize("text", ["Level", "NOT (B1 AND Level)", "B1 OR NOT Level"])
def test_a_condition_of_another_type_is_refused(text: str) -> None:
    pou = training_chain()
    chart = pou.sfc
    assert chart is not None
    assert pou.interface is not None
    level = m.Variable(name="Level", type=m.ElementaryType(name=m.Elementary.DINT))
    pou.interface.sections[0].variables.append(level)
    chart.transitions[0].condition = m.Expression(text=text)
    with pytest.raises(LoweringError, match="Level is a DINT"):
        verdict(pou, Construction.BITS, Language.ST)
    chart.transitions[0].condition = m.Expression(text="Level > 3 AND B1")
    assert verdict(pou, Construction.BITS, Language.ST).proven


def test_qualifiers_that_nothing_defines_are_refused() -> None:
    pou = training_chain()
    chart = pou.sfc
    assert chart is not None
    association = m.ActionAssociation(id=chart.new_id(), target="Q1", qualifier="DL", duration="T#1s")
    chart.steps[0].actions.append(association)
    with pytest.raises(LoweringError, match="does not say what DL does"):
        verdict(pou, Construction.BITS, Language.ST)


def test_a_block_with_a_state_in_the_condition_of_an_action_is_refused() -> None:
    pou = training_chain()
    chart = pou.sfc
    assert chart is not None
    assert pou.interface is not None
    pou.interface.sections[0].variables.append(boolean("B6"))
    contact = m.Contact(id=1, variable="B6", edge=m.Edge.RISING, input=m.InputPin(connections=[m.Connection(source=2)]))
    rail = m.LeftPowerRail(id=2, outputs=[m.OutputPin()])
    coil = m.Coil(id=3, variable="Drawn", input=m.InputPin(connections=[m.Connection(source=1)]))
    pou.transitions.append(
        m.NamedTransition(name="Drawn", body=m.LdBody(networks=[m.LogicNetwork(nodes=[rail, contact, coil])]))
    )
    condition = m.NamedCondition(name="Drawn")
    chart.steps[0].actions[0].condition = condition
    with pytest.raises(LoweringError, match="blocks that have a state"):
        verdict(pou, Construction.BITS, Language.ST)
