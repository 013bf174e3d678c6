"""The declaration as text stays as long as it says what is declared."""

from __future__ import annotations

import difflib
import io
from collections.abc import Callable
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.model.types import DataTypeDeclaration, EnumType, EnumValue, StructType
from plcopen_sfc.model.variables import Interface, SectionKind
from plcopen_sfc.report import Outcome

PRESS = Path(__file__).parents[3] / "fixtures" / "twincat" / "press_station.xml"


def saved(project: sfc.Project) -> tuple[sfc.Project, sfc.ConversionReport]:
    target = io.BytesIO()
    report = sfc.save(project, target)
    return sfc.loads(target.getvalue()), report


def test_an_edit_elsewhere_keeps_the_text() -> None:
    project = sfc.load(PRESS)
    pou = project.pou("MAIN")
    assert pou.interface is not None
    text = pou.interface.declaration
    assert text
    chart = pou.sfc
    assert chart is not None
    chart.steps[0].comment = "waits for a part"
    back, report = saved(project)
    interface = back.pou("MAIN").interface
    assert interface is not None
    assert interface.declaration == text
    assert report.losses == []


def texts_of(project: sfc.Project) -> str:
    """All declarations as text, one below the other."""
    interfaces = [each.interface for pou in project.pous for each in (pou, *pou.methods) if each.interface is not None]
    declared = [*interfaces, *project.data_types, *project.global_sections()]
    return "\n".join(each.declaration for each in declared if each.declaration is not None)


def main(project: sfc.Project) -> Interface:
    interface = project.pou("MAIN").interface
    assert interface is not None
    return interface


def put(project: sfc.Project, variable_name: str, **fields: object) -> None:
    variable = next(each for each in main(project).variables() if each.name == variable_name)
    for field, value in fields.items():
        setattr(variable, field, value)


def put_in(project: sfc.Project, kind: SectionKind, *names: str) -> None:
    section = sfc.VariableSection(kind=kind, variables=[sfc.Variable(name=name, type="INT") for name in names])
    main(project).sections = [*main(project).sections, section]


def drop(project: sfc.Project, name: str) -> None:
    for section in main(project).sections:
        section.variables = [each for each in section.variables if each.name != name]


def rename_and_add(project: sfc.Project) -> None:
    project.rename("MAIN.tHold", "tWait")
    project.pou("MAIN").add_variable("bDone")


def add_member(project: sfc.Project) -> None:
    struct = next(each.type for each in project.data_types if isinstance(each.type, StructType))
    struct.members = [*struct.members, sfc.Variable(name="bNew", type="BOOL")]


EDITS: dict[str, tuple[Callable[[sfc.Project], None], list[str]]] = {
    "name": (
        lambda p: put(p, "Motor", name="Drive"),
        ["-\tMotor : FB_Motor; // transport chain", "+\tDrive : FB_Motor; // transport chain"],
    ),
    "type": (lambda p: put(p, "nErrors", type="DINT"), ["-\tnErrors : INT;", "+\tnErrors : DINT;"]),
    "initial value": (
        lambda p: put(p, "tHold", initial="T#3s"),
        ["-\ttHold : TIME := T#2s500ms;", "+\ttHold : TIME := T#3s;"],
    ),
    "address": (
        lambda p: put(p, "bStart", address="%IX1.0"),
        ["-\tbStart AT %I* : BOOL; // two-hand control", "+\tbStart AT %IX1.0 : BOOL; // two-hand control"],
    ),
    "comment": (
        lambda p: put(p, "bStart", comment="both hands"),
        ["-\tbStart AT %I* : BOOL; // two-hand control", "+\tbStart AT %I* : BOOL; // both hands"],
    ),
    "variable": (lambda p: p.pou("MAIN").add_variable("bDone"), ["+\tbDone : BOOL;"]),
    "no variable": (lambda p: drop(p, "nCycles"), ["-\tnCycles : UDINT;"]),
    "section": (
        lambda p: put_in(p, SectionKind.INPUT, "nMode"),
        ["+END_VAR", "+VAR_INPUT", "+    nMode : INT;"],
    ),
    "rename and variable": (
        rename_and_add,
        ["-\ttHold : TIME := T#2s500ms;", "+\ttWait : TIME := T#2s500ms;", "+\tbDone : BOOL;"],
    ),
    "member": (add_member, ["+\tbNew : BOOL;"]),
}


@pytest.mark.parametrize("kind", EDITS)
def test_an_edit_of_a_declaration_goes_into_its_text(kind: str) -> None:
    project = sfc.load(PRESS)
    before = texts_of(project)
    edit, expected = EDITS[kind]
    edit(project)
    back, report = saved(project)
    found = difflib.unified_diff(before.splitlines(), texts_of(back).splitlines(), n=0, lineterm="")
    assert [line for line in found if line[:2] not in ("--", "++", "@@")] == expected
    assert report.losses == []
    assert [each.interface and each.interface.sections for each in back.pous] == [
        each.interface and each.interface.sections for each in project.pous
    ]


def test_a_value_of_an_enumeration_goes_into_its_text() -> None:
    text = "// states\nTYPE E_State :\n(\n\tIdle, // at rest\n\tBusy := 5\n);\nEND_TYPE\n"
    enum = EnumType(values=[EnumValue(name="Idle"), EnumValue(name="Busy", value="5")])
    declared = DataTypeDeclaration(name="E_State", type=enum, declaration=text)
    project = sfc.loads(sfc.dumps(sfc.Project(data_types=[declared]), format="codesys"))
    found = project.data_types[0].type
    assert isinstance(found, EnumType)
    found.values = [*found.values, EnumValue(name="Broken", value="99")]
    back, report = saved(project)
    written = back.data_types[0].declaration
    assert written is not None
    assert all(each in written for each in ("Idle, // at rest", "Broken := 99"))
    assert (back.data_types[0].type, report.losses) == (found, [])


def test_a_text_into_which_an_edit_does_not_go_is_left_out_and_the_report_says_so() -> None:
    project = sfc.load(PRESS)
    main(project).declaration = "PROGRAM MAIN VAR Motor : ; END_VAR"
    back, report = saved(project)
    assert main(back).declaration is None
    [item] = report.with_outcome(Outcome.APPROXIMATED)
    assert (item.what, item.path) == ("declaration text", "POU MAIN")


def test_a_new_text_is_kept_with_the_edit() -> None:
    project = sfc.load(PRESS)
    interface = project.pou("MAIN").interface
    assert interface is not None
    interface.variables()[0].name = "Drive"
    interface.declaration = "PROGRAM MAIN VAR Drive : FB_Motor; END_VAR"
    back, report = saved(project)
    found = back.pou("MAIN").interface
    assert found is not None
    assert found.declaration == interface.declaration
    assert report.losses == []
