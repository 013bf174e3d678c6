"""Actions that ask for steps of a lowered chart ask its code."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import lower
from plcopen_sfc.model.network import Connection, InputPin
from plcopen_sfc.semantics.simulation import Simulation
from plcopen_sfc.semantics.subjects import resolve
from tests.corpus import ROOT
from tests.lowering.charts import act, boolean, training_chain

FORMS = [("bits", "ST"), ("case", "ST"), ("regions", "ST"), ("flipflop", "ST"), ("flipflop", "FBD"), ("flipflop", "LD")]


def asking(body: m.Body) -> m.Project:
    """The training chain, whose third step calls an action with this body."""
    pou = training_chain()
    assert pou.sfc is not None
    assert pou.interface is not None
    act(pou.sfc, pou.sfc.steps[2], "Ask")
    pou.interface.sections[1].variables.append(boolean("Lamp"))
    pou.actions.append(m.Action(name="Ask", body=body))
    return m.Project(pous=[pou], dialect=m.Dialect.CODESYS)


def contact(asked: str) -> m.LdBody:
    rail = m.LeftPowerRail(id=0)
    symbol = m.Contact(id=1, variable=asked, input=InputPin(connections=[Connection(source=0)]))
    coil = m.Coil(id=2, variable="Lamp", input=InputPin(connections=[Connection(source=1)]))
    return m.LdBody(networks=[m.LogicNetwork(nodes=[rail, symbol, coil])])


@pytest.mark.parametrize(("construction", "language"), FORMS)
@pytest.mark.parametrize(
    "text", ["Lamp := S3.x AND NOT S1.X; // S3.x", "IF s3.X THEN Lamp := TRUE; ELSE Lamp := S2.x; END_IF;"]
)
def test_statements_ask_for_steps(construction: str, language: str, text: str) -> None:
    lowered = lower(asking(m.StBody(text=text)), construction, language=language, profile="codesys")
    assert lowered.proof is not None
    assert lowered.proof.proven, str(lowered.proof)
    assert "Lamp" in lowered.proof.compared
    assert not any("." in name for name in lowered.proof.inputs)


def test_a_comment_asks_for_no_step() -> None:
    texts = ("Lamp := TRUE;", "Lamp := TRUE; // S3.x", "Lamp := S3.x;")
    plain, told, asked = (lower(asking(m.StBody(text=text)), "case", profile="codesys", verify=False) for text in texts)
    assert [each.code.text.startswith("// Action Ask") for each in (plain, told, asked)] == [True, True, False]


@pytest.mark.parametrize(("construction", "language"), [("bits", "ST"), ("flipflop", "FBD"), ("flipflop", "LD")])
def test_contacts_ask_for_steps(construction: str, language: str) -> None:
    lowered = lower(asking(contact("S3.x")), construction, language=language, profile="codesys")
    assert lowered.proof is not None
    assert lowered.proof.proven, str(lowered.proof)
    assert not any("." in name for name in lowered.proof.inputs)


def test_a_contact_cannot_compare() -> None:
    for construction in ("case", "auto"):
        lowered = lower(asking(contact("S3.x")), construction, profile="codesys")
        assert lowered.construction == "case"
        assert lowered.proof is not None
        assert lowered.proof.proven, str(lowered.proof)
        assert isinstance(lowered.pou.body, m.StBody)
        assert "X3 := step_number = STEP_3;" in lowered.pou.body.text, "a flag for this step alone"
        assert "X1 :=" not in lowered.pou.body.text


@pytest.mark.slow
@pytest.mark.parametrize(("construction", "language"), [("auto", "ST"), ("flipflop", "LD"), ("flipflop", "FBD")])
def test_the_conveyor_has_no_inputs_with_names_of_steps(construction: str, language: str) -> None:
    project = sfc.load(ROOT / "fixtures/codesys/sorting_conveyor.xml")
    lowered = lower(project, construction, pou="PLC_PRG", language=language, verify=False)
    undeclared = Simulation(resolve(lowered.project, "PLC_PRG")).undeclared
    assert [name for name in undeclared if name.casefold().endswith(".x")] == []


def test_times_of_steps_are_refused() -> None:
    with pytest.raises(LoweringError, match=r"S3.t is not lowered yet: the code does not keep it"):
        lower(asking(m.StBody(text="Lamp := S3.t > T#1s;")), "bits", profile="codesys")


def test_a_variable_with_the_name_of_a_step_is_that_variable() -> None:
    project = asking(m.StBody(text="Lamp := S4.x;"))
    pou = project.pous[0]
    assert pou.interface is not None
    struct = m.StructType(members=[boolean("x")])
    pou.interface.sections.append(
        m.VariableSection(kind=m.SectionKind.INPUT, variables=[m.Variable(name="S4", type=struct)])
    )
    lowered = lower(project, "bits", profile="codesys", verify=False)
    body = lowered.pou.actions[0].body
    assert isinstance(body, m.StBody)
    assert body.text == "Lamp := S4.x;"
