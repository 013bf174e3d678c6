"""Actions that are called: those of instances, instances and programs themselves, and actions with a chart."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import VerdictKind, equivalent
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import lower
from plcopen_sfc.semantics.subjects import resolve
from tests.lowering.charts import act, boolean, pou_with

FORMS = [("bits", "ST"), ("flipflop", "FBD"), ("flipflop", "LD"), ("auto", "ST")]


def ring(*names: str, prefix: str = "c") -> m.SfcNetwork:
    """Steps in a ring, with an input as the condition of each transition."""
    chart = m.SfcNetwork()
    steps = [chart.add_step(name, initial=name == names[0]) for name in names]
    for number, step in enumerate(steps):
        chart.add_transition(step, steps[(number + 1) % len(steps)], f"{prefix}{number + 1}")
    return chart


def plant() -> m.Project:
    """A chart that executes an action and a call of an instance, a program, and two levels of charts in actions."""
    motor = m.Pou(
        name="Motor",
        kind=m.PouKind.FUNCTION_BLOCK,
        interface=m.Interface(
            sections=[m.VariableSection(kind=m.SectionKind.OUTPUT, variables=[boolean("On"), boolean("Called")])]
        ),
        bodies=[m.StBody(text="Called := NOT Called;")],
        actions=[m.Action(name="Start", body=m.StBody(text="On := TRUE;"))],
    )
    lamp = m.Pou(name="Lamp", kind=m.PouKind.PROGRAM, bodies=[m.StBody(text="Lit := NOT Lit;")])
    lamp.interface = m.Interface(sections=[m.VariableSection(kind=m.SectionKind.LOCAL, variables=[boolean("Lit")])])
    inner, deep = ring("Open", "Close", prefix="i"), ring("Low", "High", prefix="d")
    act(inner, inner.steps[1], "q_inner")
    act(inner, inner.steps[0], "Deep")
    act(deep, deep.steps[1], "q_deep")
    outer = ring("Idle", "Run", "Shine")
    act(outer, outer.steps[1], "Drive.Start")
    act(outer, outer.steps[1], "Drive")
    act(outer, outer.steps[1], "Inner")
    act(outer, outer.steps[2], "Lamp")
    pou = pou_with(outer)
    for transition, text in zip(
        outer.transitions, ("c1 OR Lamp.Lit", "c2 AND Drive.On", "c3 AND Drive.Called"), strict=True
    ):
        transition.condition = m.Expression(text=text)
    assert pou.interface is not None
    local, result = (m.VariableSection(kind=kind) for kind in (m.SectionKind.LOCAL, m.SectionKind.OUTPUT))
    local.variables = [m.Variable(name="Drive", type=m.DerivedType(name="Motor"))]
    result.variables = [boolean("q_inner"), boolean("q_deep")]
    pou.interface.sections[0].variables += [boolean(name) for name in ("i1", "i2", "d1", "d2")]
    pou.interface.sections[1:] = [local, result]
    pou.actions = [
        m.Action(name="Inner", body=m.SfcBody(chart=inner)),
        m.Action(name="Deep", body=m.SfcBody(chart=deep)),
        m.Action(name="Alone", body=m.SfcBody(chart=ring("Off", "On", prefix="d"))),
    ]
    return m.Project(name="Anlage", pous=[motor, lamp, pou], dialect=m.Dialect.CODESYS)


@pytest.mark.slow
@pytest.mark.parametrize(("construction", "language"), FORMS)
def test_they_are_called(construction: str, language: str) -> None:
    project = plant()
    lowered = lower(project, construction, pou="Ablauf", language=language, verify=False)
    found = equivalent(resolve(project, "Ablauf"), resolve(lowered.project, "Ablauf"), "codesys", cap=2_000, runs=10)
    assert not found.different, str(found)
    assert {"q_inner", "q_deep", "Shine.X"} <= set(found.compared) or construction == "auto"


def test_charts_of_actions_that_are_called_are_lowered_too() -> None:
    lowered = lower(plant(), "case", pou="Ablauf", verify=False)
    charts = [action.name for action in lowered.pou.actions if isinstance(action.body, m.SfcBody)]
    assert charts == ["Alone"], "nothing calls it"


def test_the_code_of_the_chart_of_an_action_stands_in_the_action() -> None:
    project = plant()
    lowered = lower(project, "case", pou="Ablauf.Inner")
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN
    written = lowered.project.pou("Ablauf")
    assert isinstance(written.body, m.SfcBody), "its own chart is still there"
    actions = {action.name: action.body for action in written.actions}
    assert isinstance(actions["Inner"], m.StBody)
    assert isinstance(actions["Deep"], m.StBody)
    assert (lowered.name, lowered.language, lowered.code) == ("Ablauf.Inner", "ST", actions["Inner"])
    assert str(lowered).startswith("Ablauf.Inner: exact case in ST")
    textbook = lower(project, "case", pou="Ablauf.Inner", style="classic")
    assert textbook.proof is not None
    assert textbook.proof.kind is VerdictKind.DIFFERENT
    assert textbook.faults
    assert equivalent(
        resolve(project, "Ablauf"), resolve(lowered.project, "Ablauf"), "codesys", cap=2_000, runs=5
    ).equal


@pytest.mark.slow
@pytest.mark.parametrize("language", ["ST", "FBD", "LD"])
def test_calls_come_back_from_a_file(language: str) -> None:
    project = plant()
    lowered = lower(project, "flipflop", pou="Ablauf", language=language, target="codesys", verify=False)
    again = sfc.loads(sfc.dumps(lowered.project, format="codesys"), format="codesys")
    assert not equivalent(resolve(project, "Ablauf"), resolve(again, "Ablauf"), "codesys", cap=500, runs=10).different


def test_what_networks_cannot_say_is_text_in_a_box_of_codesys() -> None:
    project = plant()
    pou = project.pou("Ablauf")
    chart = pou.sfc
    assert chart is not None
    assert pou.interface is not None
    kind = m.ElementaryType(name=m.Elementary.INT)
    pou.interface.sections[1].variables.append(m.Variable(name="n", type=kind))
    text = "FOR n := 1 TO 3 DO q_deep := NOT q_deep; END_FOR;"
    chart.steps[1].actions = [m.ActionAssociation(id=chart.new_id(), body=m.StBody(text=text))]
    lowered = lower(project, "flipflop", pou="Ablauf", language="FBD", target="codesys", verify=False)
    again = sfc.loads(sfc.dumps(lowered.project, format="codesys"), format="codesys")
    assert not equivalent(resolve(project, "Ablauf"), resolve(again, "Ablauf"), "codesys", cap=500, runs=10).different
    with pytest.raises(LoweringError, match="cannot be drawn"):
        lower(project, "flipflop", pou="Ablauf", language="FBD", target="plcopen-2.01", verify=False)


@pytest.mark.parametrize("construction", ["case", "bits"])
def test_an_action_that_return_leaves_is_called_where_actions_can_be(construction: str) -> None:
    chart = ring("Idle", "Run")
    act(chart, chart.steps[1], "Fill")
    chart.steps[0].entry_action = "Fill"
    pou = pou_with(chart)
    pou.actions = [m.Action(name="Fill", body=m.StBody(text="IF c1 THEN RETURN; END_IF; q := NOT q;"))]
    assert pou.interface is not None
    pou.interface.sections[1].variables = [boolean("q")]
    lowered = lower(m.Project(pous=[pou], dialect=m.Dialect.CODESYS), construction)
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN
    assert isinstance(lowered.code, m.StBody)
    assert "Fill();" in lowered.code.text
    assert "RETURN" not in lowered.code.text
    pou.actions[0].body = m.StBody(text="IF Run.x THEN RETURN; END_IF; q := NOT q;")  # there are no steps to ask
    with pytest.raises(LoweringError, match="RETURN and jumps"):
        lower(m.Project(pous=[pou], dialect=m.Dialect.CODESYS), construction)


def test_what_cannot_be_drawn_is_named_with_its_pou() -> None:
    project = plant()
    with pytest.raises(LoweringError, match=r"Drive\.Start") as refused:
        lower(project, "flipflop", pou="Ablauf", target="plcopen", verify=False)
    assert refused.value.location is not None
    assert str(refused.value.location.path).startswith("POU Ablauf / network ")


def test_names_that_the_chart_around_has_too_end_with_the_action() -> None:
    """Both charts go back with SFCReset, and remember its edge."""
    outer, inner = ring("S1", "S2"), ring("S1", "S3", prefix="i")
    pou = pou_with(outer)
    assert pou.interface is not None
    pou.interface.sections[0].variables += [boolean(name) for name in ("c1", "c2", "i1", "i2", "SFCReset")]
    pou.actions.append(m.Action(name="Fill", body=m.SfcBody(chart=inner)))
    outer.steps[1].actions.append(m.ActionAssociation(id=91, target="Fill", qualifier=m.Qualifier.N))
    made = lower(m.Project(dialect=m.Dialect.CODESYS, pous=[pou]), "case", pou="Ablauf", states="constants")
    assert made.proof is not None
    assert made.proof.proven, str(made.proof)
    names = {variable.name for variable in made.pou.variables()}
    assert {"step_number", "step_number_Fill", "STEP_1", "STEP_1_Fill", "STEP_3"} <= names
    assert [name for name in names if name.endswith("_2")] == ["STEP_2"]
