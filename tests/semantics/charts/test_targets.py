"""Targets of action associations."""

from __future__ import annotations

import pytest

from plcopen_sfc.errors import SimulationError
from plcopen_sfc.model import (
    Action,
    ActionAssociation,
    Dialect,
    Interface,
    Pou,
    PouKind,
    Project,
    Qualifier,
    SfcBody,
    StBody,
    Variable,
    VariableSection,
)
from plcopen_sfc.semantics.charts import compile_chart
from plcopen_sfc.semantics.profile import PROFILES
from plcopen_sfc.semantics.programs import Controller, Instance
from tests.semantics.charts.rig import chain

MOTOR = Pou(
    name="Motor",
    kind=PouKind.FUNCTION_BLOCK,
    interface=Interface(
        sections=[VariableSection(variables=[Variable(name="n", type="INT"), Variable(name="ready", type="BOOL")])]
    ),
    actions=[Action(name="Go", body=StBody(text="n := n + 1;"))],
    bodies=[StBody(text="n := n + 100;")],
)
PUMP = Pou(name="Pump", kind=PouKind.PROGRAM, bodies=[StBody(text="GVL_count := GVL_count + 1;")])


def instance(target: str, profile: str = "codesys") -> tuple[Instance, Controller]:
    chart = chain("A", "B", conditions="FALSE FALSE")
    chart.step("A").actions = [ActionAssociation(id=1, qualifier=Qualifier.N, target=target)]
    variables = [
        Variable(name="M", type="Motor"),
        Variable(name="flags", type="WORD"),
        Variable(name="number", type="INT"),
    ]
    main = Pou(
        name="Main",
        kind=PouKind.PROGRAM,
        interface=Interface(sections=[VariableSection(variables=variables)]),
        actions=[Action(name="Own", body=StBody(text="number := 7;"))],
        bodies=[SfcBody(chart=chart)],
    )
    project = Project(name="p", pous=[MOTOR, PUMP, main], dialect=Dialect.CODESYS)
    controller = Controller(project, PROFILES[profile], chart_compiler=compile_chart)
    found = controller.instance("Main")
    found.scan()
    return found, controller


def test_an_action_of_the_pou() -> None:
    assert instance("own")[0]["number"] == 7


def test_an_action_of_an_instance() -> None:
    assert instance("M.Go")[0]["M.n"] == 1


def test_a_variable_of_an_instance() -> None:
    assert instance("M.ready")[0]["M.ready"] is True


def test_an_instance_is_called() -> None:
    assert instance("M")[0]["M.n"] == 100


def test_a_program_is_called() -> None:
    assert instance("Pump")[0]["GVL_count"] == 1


def test_a_bit_of_a_word() -> None:
    assert instance("flags.3")[0]["flags"] == 8


def test_a_name_that_nobody_declares_is_a_boolean_variable_that_is_reported() -> None:
    found, controller = instance("Lamp")
    assert found["Lamp"] is True
    assert [name.casefold() for name in controller.undeclared] == ["lamp"]


def test_a_number_is_no_action() -> None:
    with pytest.raises(SimulationError, match="number is of type INT"):
        instance("number")


def test_an_action_that_an_instance_does_not_have() -> None:
    with pytest.raises(SimulationError, match="Motor has no Stop"):
        instance("M.Stop")
