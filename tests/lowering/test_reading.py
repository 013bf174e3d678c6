"""Charts that lowering understands, and those that it refuses."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import VerdictKind
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import Construction, Language, lower
from tests.lowering.charts import training_chain
from tests.lowering.test_exact import FORMS, verdict
from tests.sweeps import some_of


@pytest.mark.slow
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
        for construction, language in some_of(FORMS, 5):
            found = verdict(pou, construction, language, profile)
            assert not found.different, f"{profile} {construction} {language}: {found}"
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
        assert found.kind is VerdictKind.PROVEN, str(found)
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
        assert found.kind is VerdictKind.PROVEN, f"{construction} {language}: {found}"


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
    with pytest.raises(LoweringError, match="has no rule for the qualifier DL"):
        verdict(pou, Construction.BITS, Language.ST)


@pytest.mark.parametrize(
    ("declared", "shown"),
    [("INT", "INT"), ("STRING", "string"), ("Colour", "enum"), ("Number", "WORD"), ("Rate", "subrange")],
)
@pytest.mark.parametrize("profile", ["iec", "codesys", "grafcet"])
def test_an_action_is_a_boolean_variable(declared: str, shown: str, profile: str) -> None:
    types: dict[str, m.EnumType | m.ElementaryType | m.SubrangeType] = {
        "Colour": m.EnumType(values=[m.EnumValue(name="Red")]),
        "Number": m.ElementaryType(name=m.Elementary.WORD),
        "Rate": m.SubrangeType(base=m.ElementaryType(name=m.Elementary.INT), bounds=m.Dimension(lower="0", upper="9")),
    }
    pou = training_chain()
    project = m.Project(pous=[pou], data_types=[m.DataTypeDeclaration(name=n, type=t) for n, t in types.items()])
    next(v for v in pou.variables() if v.name == "Q3").type = m.Variable(name="v", type=declared).type
    with pytest.raises(
        LoweringError, match=f"Q3 is of type {shown}: only a Boolean variable can be an action"
    ) as found:
        lower(project, profile=profile, verify=False)
    assert str(found.value.location) == "POU Ablauf / step S3 / action Q3"


def test_the_type_of_an_action_can_have_a_name_of_its_own_and_stand_outside() -> None:
    pou = training_chain()
    assert pou.interface is not None
    outputs = pou.interface.sections[1].variables
    signal = m.DataTypeDeclaration(name="Signal", type=m.ElementaryType(name=m.Elementary.BOOL))
    outputs[0].type = m.Variable(name="v", type="Signal").type
    outside = m.VariableSection(name="GVL", variables=[m.Variable(name="Q3", type="INT")])
    del outputs[2]
    project = m.Project(pous=[pou], data_types=[signal], global_variables=[outside])
    with pytest.raises(LoweringError, match="Q3 is of type INT"):
        lower(project, verify=False)
    outside.variables[0].type = m.ElementaryType(name=m.Elementary.BOOL)
    assert lower(project, verify=False).construction == "case"


def test_a_stored_action_without_a_value_is_of_a_boolean_variable() -> None:
    pou = training_chain()
    assert pou.sfc is not None
    pou.sfc.steps[0].actions = [m.ActionAssociation(id=90, kind="onActivation", target="Q1")]
    pou.sfc.steps[1].actions = [m.ActionAssociation(id=91, kind="continuous", target="Q2")]
    for name in ("Q1", "Q2"):
        next(v for v in pou.variables() if v.name == name).type = m.ElementaryType(name=m.Elementary.INT)
        with pytest.raises(LoweringError, match=f"{name} is of type INT"):
            lower(m.Project(pous=[pou]), profile="grafcet", verify=False)
        pou.sfc.steps[0].actions[0].value = "Q1 + 1"


def test_0_and_1_are_conditions() -> None:
    """As IEC 61131-3 ed. 2 and Beremiz write FALSE and TRUE."""
    pou = training_chain()
    chart = pou.sfc
    assert chart is not None
    for transition, text in zip(chart.transitions, ("1", "B2 AND (1 OR 0)", "NOT 0", "(1) XOR B4"), strict=True):
        transition.condition = m.Expression(text=text)
    chart.steps[2].actions[0].condition = m.Expression(text="1")
    for construction, language in FORMS:
        found = verdict(pou, construction, language, "iec")
        assert found.kind is VerdictKind.PROVEN, f"{construction} {language}: {found}"
    code = lower(pou, "bits", verify=False).code
    assert isinstance(code, m.StBody)
    assert "T1_2 := X1;" in code.text
    assert "T3_4 := X3 AND NOT FALSE;" in code.text


IN_IL = """PROGRAM Main
VAR_INPUT a, b : BOOL; END_VAR
VAR_OUTPUT q : BOOL; n : INT; END_VAR
INITIAL_STEP One: Count(P1); END_STEP
STEP Two: Drive(N); END_STEP
TRANSITION FROM One TO Two := a; END_TRANSITION
TRANSITION FROM Two TO One := NOT a; END_TRANSITION
ACTION Count:
LD n
ADD 1
MOD 3
ST n
END_ACTION
ACTION Drive:
%s
END_ACTION
END_PROGRAM
"""


@pytest.mark.parametrize("construction", ["case", "bits"])
def test_actions_in_instruction_list_are_lowered(construction: str) -> None:
    project = sfc.loads((IN_IL % "LD b\nANDN a\nST q\nLD n\nGE 2\nR q").encode(), format="iec-text")
    lowered = lower(project, construction)
    assert lowered.proof is not None
    assert lowered.proof.proven, str(lowered.proof)


JUMPING = {
    "over some": "LD b\nJMPC out\nLD a\nST q\nout:\nLD a\nR q",
    "if and else": "LD a\nJMPCN other\nLD b\nST q\nJMP done\nother: LD n\nADD 1\nMOD 3\nST n\ndone: LD n\nEQ 2\nS q",
    "leaving": "LD a\nRETC\nLD b\nRETCN\nLDN q\nST q",
    "three ways": "LD a\nJMPC one\nLD b\nJMPC two\nLD 0\nJMP out\none: LD 1\nST n\nJMP out\ntwo: LD TRUE\nST q\nRET\n"
    "out: LDN q\nST q",
    "back to where it is": "LD a\nJMPC next\nnext: LD b\nST q\nJMP away\nLD TRUE\nST q\naway:",
}


@pytest.mark.parametrize("name", JUMPING)
def test_jumps_forward_in_instruction_list_are_lowered(name: str) -> None:
    project = sfc.loads((IN_IL % JUMPING[name]).encode(), format="iec-text")
    lowered = lower(project, "case")
    assert lowered.proof is not None
    assert lowered.proof.proven, str(lowered.proof)
    assert "RETURN" not in lowered.pou.body.text  # type: ignore[union-attr]  # it would leave more than the action


def test_loops_in_instruction_list_are_lowered() -> None:
    project = sfc.loads(
        (IN_IL % "LD 0\nST n\nagain: LD b\nST q\nLD n\nADD 1\nST n\nLT 3\nJMPC again").encode(), format="iec-text"
    )
    lowered = lower(project, "case")
    assert lowered.proof is not None
    assert lowered.proof.proven, str(lowered.proof)
    assert "UNTIL NOT (n < 3)" in lowered.pou.body.text  # type: ignore[union-attr]


def test_jumps_in_instruction_list_that_are_no_loops_are_refused() -> None:
    jumping = "LD a\nJMPC inside\nagain: LD b\nST q\ninside: LD n\nJMPC again"
    project = sfc.loads((IN_IL % jumping).encode(), format="iec-text")
    with pytest.raises(LoweringError, match="instruction list whose jumps are no loops"):
        lower(project, "case")


def test_a_condition_that_jumps_with_a_value_is_refused_with_the_reason() -> None:
    pou = training_chain()
    chart = pou.sfc
    assert chart is not None
    chart.transitions[0].condition = m.BodyCondition(body=m.IlBody(text="LD B1\nJMPC m\nLD B2\nm: AND B3"))
    with pytest.raises(LoweringError, match="a value is loaded behind each label"):
        lower(pou, "case", profile="iec")


@pytest.mark.parametrize(
    ("action", "condition", "hint"),
    [
        (m.ActionAssociation(id=90, target="n"), "TRUE", "Let an action assign it: n := .."),
        (m.ActionAssociation(id=90, target="Q1", qualifier="D"), "TRUE", "Give the action one, such as T#5s."),
        (m.ActionAssociation(id=90, target="Q1", qualifier="D", duration="10 s"), "TRUE", "Repair it in its tool"),
        (m.ActionAssociation(id=90, target="Q1"), "n", "Compare it: n <> .."),
    ],
)
def test_a_refusal_of_a_text_tells_what_to_do(action: m.ActionAssociation, condition: str, hint: str) -> None:
    pou = training_chain()
    assert pou.sfc is not None
    assert pou.interface is not None
    pou.interface.sections[1].variables.append(m.Variable(name="n", type=m.ElementaryType(name=m.Elementary.INT)))
    pou.sfc.steps[1].actions = [action]
    pou.sfc.transitions[0].condition = m.Expression(text=condition)
    with pytest.raises(LoweringError) as refused:
        lower(m.Project(pous=[pou]), verify=False)
    assert refused.value.hint.startswith(hint)
