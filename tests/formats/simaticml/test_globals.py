"""Global variables of other tools: data blocks, tags and constants of TIA Portal."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.model.compare import differences
from plcopen_sfc.semantics.programs import Controller
from tests.formats.simaticml.documents import parsed

BOOL, INT = (m.ElementaryType(name=name) for name in (m.Elementary.BOOL, m.Elementary.INT))
LOGIC = "FUNCTION_BLOCK Main\nVAR_OUTPUT y : INT; END_VAR\n{}\nEND_FUNCTION_BLOCK"


def section(*variables: m.Variable, **fields: object) -> m.VariableSection:
    return m.VariableSection.model_validate(
        {"kind": m.SectionKind.GLOBAL, "variables": [v.model_dump() for v in variables], **fields}
    )


def variable(name: str, type_: m.ElementaryType, **fields: object) -> m.Variable:
    return m.Variable.model_validate({"name": name, "type": type_, **fields})


def with_lists() -> m.Project:
    project = sfc.loads(LOGIC.format("y := Plant.Level + 1;").encode(), format="iec-text")
    project.dialect = m.Dialect.CODESYS
    lists = [section(variable("Level", INT, initial=m.SimpleValue(text="41")), variable("Open", BOOL), name="Plant")]
    project.applications = [m.Resource(name="App", global_variables=lists)]
    return project


def with_globals() -> m.Project:
    text = LOGIC.format("VAR_EXTERNAL Top : INT; Start : BOOL; END_VAR\nIF NOT Start THEN y := Top; END_IF;")
    project = sfc.loads(text.encode(), format="iec-text")
    own = [section(variable("Top", INT, initial=m.SimpleValue(text="42")), constant=True, name="Limits")]
    inputs = [section(variable("Start", BOOL, address="%IX0.3"), variable("Loose", BOOL))]
    project.configurations = [m.Configuration(name="Plc", global_variables=[*own, *inputs])]
    return project


def value(project: m.Project) -> object:
    instance = Controller(project).instance("Main")
    instance.scan()
    return instance["y"]


@pytest.mark.parametrize("target", ["simaticml", "scl"])
def test_lists_of_global_variables_are_data_blocks(target: str) -> None:
    project = with_lists()
    content, report = sfc.convert(project, target)
    assert ("Plant", "a data block") in [(i.path, i.why) for i in report.items if i.outcome is sfc.Outcome.TRANSLATED]
    seen = sfc.loads(content, format=target, as_tool=True)
    (block,) = seen.data_blocks
    assert block.interface is not None
    assert (block.name, [v.name for v in block.interface.variables()]) == ("Plant", ["Level", "Open"])
    assert value(seen) == value(project) == 42
    back = sfc.loads(content, format=target)
    assert back.data_blocks == []
    there = sfc.loads(sfc.dumps(back, format="codesys"))
    assert list(differences(there.applications, project.applications)) == []


def test_others_are_tags_and_constants() -> None:
    project = with_globals()
    content, report = sfc.convert(project, "simaticml", partial=True)
    assert report.losses == []
    seen = sfc.loads(content, as_tool=True)
    (table,), (block,) = seen.tag_tables, seen.data_blocks
    assert block.interface is not None
    assert (block.name, [v.name for v in block.interface.variables()]) == ("GlobalVariables", ["Loose"])
    assert [(tag.name, tag.type, tag.address) for tag in table.tags] == [("Start", "Bool", "%I0.3")]
    assert [(constant.name, constant.initial) for constant in table.constants] == [("Top", m.SimpleValue(text="42"))]
    assert value(seen) == value(project) == 42
    back = sfc.loads(content)
    start = next(v for section in back.global_sections() for v in section.variables if v.name == "Start")
    assert start.address == "%I0.3", "as S7 has it, whose texts are in the file"
    start.address = "%IX0.3"
    assert (back.tag_tables, back.configurations) == ([], project.configurations)


def test_what_a_data_block_cannot_hold_is_told() -> None:
    project = with_lists()
    block = m.Pou(name="Axis", kind=m.PouKind.FUNCTION_BLOCK, bodies=[m.StBody(text=";")])
    project.pous.append(block)
    motor = m.Variable(name="motor", type=m.DerivedType(name="Axis"))
    project.applications[0].global_variables[0].variables += [motor, variable("Lamp", BOOL, address="%QX0.8")]
    content, report = sfc.convert(project, "simaticml", partial=True)
    losses = [(item.what, item.path) for item in report.losses]
    assert losses == [("global variable", "Plant.motor"), ("global variable", "Plant.Lamp")]
    (data,) = sfc.loads(content, as_tool=True).data_blocks
    assert data.interface is not None
    assert [v.name for v in data.interface.variables()] == ["Level", "Open", "Lamp"]


def test_a_block_that_has_the_name_stays() -> None:
    project = with_lists()
    project.data_blocks = [m.DataBlock(name="PLANT", interface=m.Interface())]
    seen = sfc.loads(sfc.dumps(project, format="simaticml", partial=True), as_tool=True)
    assert [block.name for block in seen.data_blocks] == ["PLANT"]


def test_an_edit_of_a_global_variable_reaches_its_block() -> None:
    project = sfc.loads(sfc.dumps(with_lists(), format="simaticml"))
    project.applications[0].global_variables[0].variables[0].name = "Height"
    seen = sfc.loads(sfc.dumps(project), as_tool=True)
    assert seen.data_blocks[0].interface is not None
    assert [v.name for v in seen.data_blocks[0].interface.variables()] == ["Height", "Open"]


@pytest.mark.parametrize(("old", "new"), [(b">41<", b">43<"), (b'Name="Open"', b'Name="Shut"')])
def test_a_copy_that_somebody_edited_is_not_lost(old: bytes, new: bytes) -> None:
    content = sfc.dumps(with_lists(), format="simaticml")
    assert content.count(old) == 1
    edited = sfc.loads(content.replace(old, new))
    assert [finding.code for finding in edited.diagnostics] == ["XML213"]
    (block,) = edited.data_blocks
    seen = sfc.loads(sfc.dumps(edited, format="simaticml"), as_tool=True)
    assert [each.name for each in seen.data_blocks] == [block.name]
    assert seen.data_blocks[0].interface == block.interface
    assert sfc.dumps(edited) == content.replace(old, new)


def test_a_copy_stays_one_however_the_document_is_written() -> None:
    content = sfc.dumps(with_lists(), format="simaticml")
    squeezed = b">".join(part.strip() for part in content.split(b">")).replace(b'ID="', b'ID="7')
    assert sfc.loads(squeezed).data_blocks == []
    assert sfc.loads(sfc.dumps(with_lists(), format="simaticml", tia="V16")).data_blocks == []
    assert sfc.loads(sfc.dumps(with_lists(), format="simaticml", normalize=True)).data_blocks == []


def test_a_folder_has_one_object_in_each_document(tmp_path: Path) -> None:
    project = with_lists()
    project.applications[0].global_variables.append(
        m.VariableSection(kind=m.SectionKind.GLOBAL, name="Second", variables=[variable("Ready", BOOL)])
    )
    report = sfc.save(project, f"{tmp_path}/out/", format="simaticml")
    assert report.with_outcome(sfc.Outcome.DROPPED) == []
    held = {
        path.name: [element.tag for element in parsed(path.read_bytes()) if str(element.tag).startswith("SW.")]
        for path in (tmp_path / "out").rglob("*.xml")
    }
    assert held["Plant.xml"] == held["Second.xml"] == ["SW.Blocks.GlobalDB"]
    assert held.pop("plcopen_sfc.xml") == []
    assert {len(tags) for tags in held.values()} == {1}
    assert {block.name for block in sfc.load(tmp_path / "out", as_tool=True).data_blocks} == {"Plant", "Second"}
    back = sfc.load(tmp_path / "out")
    assert back.data_blocks == []
    assert list(differences(back.applications, project.applications)) == []


def test_documents_of_a_folder_know_the_whole_project(tmp_path: Path) -> None:
    """An action of an instance is none of the document of the block that has the chart, which gets its statements."""
    chart = m.SfcNetwork()
    step = chart.add_step("Go", initial=True)
    step.actions = [m.ActionAssociation(id=9, target="motor.Stop")]
    motor = m.Pou(name="Motor", kind=m.PouKind.FUNCTION_BLOCK, bodies=[m.StBody(text=";")])
    motor.actions = [m.Action(name="Stop", body=m.StBody(text="run := FALSE;"))]
    run = m.Variable(name="run", type=m.ElementaryType(name=m.Elementary.BOOL))
    motor.interface = m.Interface(sections=[m.VariableSection(kind=m.SectionKind.OUTPUT, variables=[run])])
    instance = m.Variable(name="motor", type=m.DerivedType(name="Motor"))
    main = m.Pou(name="Main", kind=m.PouKind.FUNCTION_BLOCK, bodies=[m.SfcBody(chart=chart)])
    main.interface = m.Interface(sections=[m.VariableSection(kind=m.SectionKind.LOCAL, variables=[instance])])
    report = sfc.save(m.Project(pous=[main, motor]), f"{tmp_path}/out/", format="simaticml", limit=5)
    assert not report.losses
    assert report.compared["POU Main"].startswith("equal (proof")
    seen = sfc.load(tmp_path / "out", as_tool=True)
    chart_seen = seen.pou("Main").sfc
    assert chart_seen is not None
    rows = [(each.target, each.value) for each in chart_seen.step("Go").actions]
    assert rows == [("#motor.run", "FALSE")] * 2  # the second one is the final scan


@pytest.mark.parametrize(
    ("declared", "path"),
    [
        ("TYPE G : STRUCT s : Motor; END_STRUCT; END_TYPE", "type G / s"),
        ("TYPE G : STRUCT s : ARRAY [0..1] OF Motor; END_STRUCT; END_TYPE", "type G / s"),
        ("VAR_GLOBAL s : ARRAY [0..1] OF Motor; END_VAR", "s"),
    ],
)
@pytest.mark.parametrize("target", ["simaticml", "scl"])
def test_what_is_global_has_no_instances_of_function_blocks(declared: str, path: str, target: str) -> None:
    """Types of structures and global data blocks of S7 have none; these were written, and nothing was told."""
    text = f"{declared} FUNCTION_BLOCK Motor VAR_OUTPUT q : BOOL; END_VAR q := TRUE; END_FUNCTION_BLOCK"
    project = sfc.loads(text.encode(), format="iec-text")
    report = sfc.convert(project, target, partial=True).report
    told = [item.path for item in report.losses if "no instances of function blocks" in item.why]
    assert told == [path]
