"""Renames of steps and transitions follow into data blocks and programs, in documents too."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.errors import ModelError
from plcopen_sfc.model import (
    ActionAssociation,
    ActionEvent,
    DataBlock,
    Expression,
    Interface,
    Pou,
    Project,
    Qualifier,
    SfcBody,
    SfcNetwork,
    StBody,
    Variable,
    VariableSection,
)
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import DataBlockKind, PouKind
from plcopen_sfc.model.types import DerivedType
from plcopen_sfc.model.variables import SectionKind


def block() -> Project:
    """A GRAPH block with an instance data block, and a function that reads it."""
    chart = SfcNetwork()
    drill, cool = chart.add_step("Drill", initial=True), chart.add_step("Cool")
    chart.add_transition(drill, cool, "#Drill.T > T#5s").name = "T_1"
    chart.add_transition(cool, drill, "NOT #Drill.X").name = "T_2"
    cool.actions.append(
        ActionAssociation(id=90, qualifier=Qualifier.OFF, event=ActionEvent.S1, target="Drill"),
    )
    members = [
        Variable(name="Drill", type=DerivedType(name="G7_StepPlus_V6")),
        Variable(name="T_1", type=DerivedType(name="G7_TransitionPlus_V6")),
    ]
    interface = Interface(sections=[VariableSection(kind=SectionKind.LOCAL, variables=members)])
    text = '"Out" := "DB_Seq".Drill.X AND "DB_Seq".T_1.TT;'
    return Project(
        pous=[
            Pou(name="FB_Seq", kind=PouKind.FUNCTION_BLOCK, interface=interface, bodies=[SfcBody(chart=chart)]),
            Pou(name="FC_Use", kind=PouKind.FUNCTION, bodies=[StBody(text=text)]),
        ],
        data_blocks=[
            DataBlock(
                name="DB_Seq",
                kind=DataBlockKind.INSTANCE,
                type_name="FB_Seq",
                interface=interface.model_copy(deep=True),
            )
        ],
        dialect=Dialect.SCL,
    )


def members(project: Project) -> list[list[str]]:
    """The names of the members of the block and of its instance."""
    interfaces = [project.pou("FB_Seq").interface, project.data_blocks[0].interface]
    return [[v.name for v in interface.variables()] for interface in interfaces if interface is not None]


def program(project: Project) -> str:
    (body,) = project.pou("FC_Use").bodies
    assert isinstance(body, StBody)
    return body.text


def chart_of(project: Project) -> SfcNetwork:
    chart = project.pou("FB_Seq").sfc
    assert chart is not None
    return chart


def conditions(chart: SfcNetwork) -> list[str]:
    return [t.condition.text for t in chart.transitions if isinstance(t.condition, Expression)]


@pytest.mark.parametrize("through_file", [False, True], ids=["model", "file"])
def test_a_step_is_renamed_everywhere(through_file: bool) -> None:
    project = block()
    if through_file:
        project = sfc.loads(sfc.dumps(project, format="simaticml"))
    chart_of(project).rename_step("Drill", "Bore")
    if through_file:
        project = sfc.loads(sfc.dumps(project))
    assert members(project) == [["Bore", "T_1"], ["Bore", "T_1"]]
    assert program(project) == '"Out" := "DB_Seq".Bore.X AND "DB_Seq".T_1.TT;'
    chart = chart_of(project)
    assert conditions(chart) == ["#Bore.T > T#5s", "NOT #Bore.X"]
    assert [action.target for action in chart.step("Cool").actions] == ["Bore"]


@pytest.mark.parametrize("through_file", [False, True], ids=["model", "file"])
def test_a_transition_is_renamed_everywhere(through_file: bool) -> None:
    project = block()
    if through_file:
        project = sfc.loads(sfc.dumps(project, format="simaticml"))
    project.rename("FB_Seq.T_1", "T_Done")
    if through_file:
        project = sfc.loads(sfc.dumps(project))
    assert members(project) == [["Drill", "T_Done"], ["Drill", "T_Done"]]
    assert program(project) == '"Out" := "DB_Seq".Drill.X AND "DB_Seq".T_Done.TT;'


def test_a_name_that_a_member_has_is_refused() -> None:
    project = block()
    interface = project.pou("FB_Seq").interface
    assert interface is not None
    interface.sections[0].variables.append(Variable(name="Bore", type="INT"))
    with pytest.raises(ModelError):
        chart_of(project).rename_step("Drill", "Bore")
    assert members(project)[1] == ["Drill", "T_1"]
