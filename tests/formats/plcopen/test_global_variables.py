"""Tag tables, data blocks and organization blocks of TIA Portal in CODESYS and TC6."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.formats.codesys.codesys_codec import validate_codesys
from plcopen_sfc.formats.plcopen.tc6_versions import validate_tc6
from plcopen_sfc.model import (
    ArrayType,
    ArrayValue,
    DataBlock,
    Dialect,
    Dimension,
    Interface,
    Pou,
    Project,
    RepeatedValue,
    SimpleValue,
    StBody,
    StringType,
    Variable,
    VariableSection,
)
from plcopen_sfc.model.compare import differences
from plcopen_sfc.model.pou import DataBlockKind, PouKind
from plcopen_sfc.model.project import Tag, TagTable
from plcopen_sfc.model.variables import SectionKind
from plcopen_sfc.report import Outcome

FIXTURES = Path(__file__).parents[3] / "fixtures"
TARGETS = ["codesys", "plcopen-2.01", "plcopen-1.01"]


def plant(**fields: object) -> Project:
    """A program that reads a tag, a constant and a data block, and counts in the block."""
    text = (
        'IF "Start Button" AND "Parts".done < "LIMIT_1" THEN "Parts".done := "Parts".done + 1; END_IF; "Lamp" := TRUE;'
    )
    tags = TagTable(
        name="Default tag table",
        tags=[
            Tag(name="Start Button", type="Bool", address="%I0.0"),
            Tag(name="Lamp", type="Bool", address="%Q4.1"),
        ],
        constants=[Variable(name="LIMIT_1", type="INT", initial="3")],
    )
    parts = [Variable(name="done", type="INT", initial="1", attributes={"Remanence": "Retain"})]
    block = DataBlock(name="Parts", interface=Interface(sections=[VariableSection(variables=parts)]))
    main = Pou(name="Main", kind=PouKind.ORGANIZATION_BLOCK, number=1, bodies=[StBody(text=text)])
    return Project.model_validate(
        {"pous": [main], "tag_tables": [tags], "data_blocks": [block], "dialect": Dialect.SCL} | fields
    )


def all_globals(project: Project) -> dict[str, Variable]:
    sections = [*project.global_variables, *(s for c in project.configurations for s in c.global_variables)]
    return {variable.name: variable for section in sections for variable in section.variables}


@pytest.mark.parametrize("target", TARGETS)
def test_programs_find_their_tags_constants_and_blocks(target: str) -> None:
    data, report = sfc.convert(plant(), target, partial=True)
    errors = [d for d in (validate_codesys if target == "codesys" else validate_tc6)(data) if d.severity == "error"]
    assert errors == []
    read = sfc.loads(data, as_tool=True)
    found = all_globals(read)
    assert found["Start_Button"].address == "%IX0.0"
    assert found["Lamp"].address == "%QX4.1"
    trace = sfc.simulate(
        read,
        pou="Main",
        inputs=lambda _scan, _values: {"Start_Button": True},
        scans=5,
        record=["Parts.done", "Lamp"],
    )
    assert list(trace["Parts.done"]) == [2, 3, 3, 3, 3]
    assert list(trace["Lamp"]) == [True] * 5
    assert report.losses == []
    sections = [*read.global_variables, *(s for c in read.configurations for s in c.global_variables)]
    assert [section.retain for section in sections] == [False, False, True]


@pytest.mark.parametrize("target", TARGETS)
def test_the_way_back_has_tables_and_blocks_and_no_lists(target: str) -> None:
    source = sfc.loads(sfc.dumps(plant(), format="simaticml"))
    back = sfc.loads(sfc.convert(source, target, partial=True)[0])
    assert back.global_variables == []
    assert back.configurations == []
    assert list(differences(source, sfc.loads(sfc.dumps(back, format="simaticml")))) == []


def test_a_list_that_was_edited_stays() -> None:
    data = sfc.dumps(plant(), format="codesys", partial=True)
    edited = data.replace(b"%IX0.0", b"%IX7.0")
    assert edited != data
    assert [section.name for section in sfc.loads(edited).global_variables] == ["Default_tag_table"]


@pytest.mark.parametrize("target", TARGETS)
def test_an_instance_is_a_global_variable_of_its_block(target: str) -> None:
    project = sfc.load(FIXTURES / "simaticml-plc")
    read = sfc.loads(sfc.dumps(project, format=target, partial=True), as_tool=True)
    kind = all_globals(read)["FB_Drilling_DB"].type
    assert getattr(kind, "name", None) == "FB_Drilling"


def test_what_has_no_type_is_reported() -> None:
    timer = DataBlock(name="T_1", kind=DataBlockKind.INSTANCE, type_name="IEC_TIMER")
    tags = TagTable(
        name="S5", tags=[Tag(name="Block", type="Block_FB", address="%M5"), Tag(name="T5", type="Timer", address="%T5")]
    )
    members = [Variable(name="at", type="DTL")]
    dated = DataBlock(name="Log", interface=Interface(sections=[VariableSection(variables=members)]))
    source = plant(pous=[], tag_tables=[tags], data_blocks=[timer, dated])
    data, report = sfc.convert(source, "plcopen", partial=True)
    timed = all_globals(sfc.loads(data, format="plcopen", as_tool=True))["T5"]  # what steps run of it is its output
    assert (str(timed.type), timed.address) == ("ElementaryType(name=BOOL)", None)
    found = {item.path: item.outcome for item in report.losses}
    assert found == {
        "data block T_1": Outcome.NOT_EXECUTED,
        "tag table S5 / tag Block": Outcome.NOT_EXECUTED,
        "data block Log / variable at": Outcome.NOT_EXECUTED,
    }


@pytest.mark.parametrize("target", ["plcopen-2.01", "plcopen-1.01"])
def test_lists_of_codesys_are_declared_in_tc6_and_names_resolve(target: str) -> None:
    variables = [
        Variable(name="start", type="BOOL", address="%IX0.0"),
        Variable(name="count", type="INT", initial="4"),
    ]
    source = Project(
        pous=[
            Pou(
                name="Main",
                kind=PouKind.PROGRAM,
                interface=Interface(sections=[VariableSection(variables=[Variable(name="own", type="INT")])]),
                bodies=[StBody(text="IF GVL_IO.start THEN // GVL_IO.start\n  gvl_io.count := count + 1;\nEND_IF")],
            )
        ],
        global_variables=[VariableSection(kind=SectionKind.GLOBAL, name="GVL_IO", variables=variables, retain=True)],
        dialect=Dialect.CODESYS,
    )
    data, report = sfc.convert(source, target)
    assert report.losses == []
    assert [d for d in validate_tc6(data) if d.severity == "error"] == []
    read = sfc.loads(data, as_tool=True)
    (section,) = read.configurations[0].global_variables
    assert section.retain
    assert all_globals(read)["start"].address == "%IX0.0"
    trace = sfc.simulate(read, pou="Main", inputs=lambda _s, _v: {"start": True}, scans=3, record=["count"])
    assert list(trace["count"]) == [5, 6, 7]
    back = sfc.loads(sfc.convert(sfc.loads(data), "codesys")[0])
    assert list(differences(sfc.loads(sfc.dumps(source, format="codesys")), back)) == []


@pytest.mark.parametrize("target", ["codesys", "plcopen"])
def test_start_values_are_translated_once(target: str) -> None:
    """A wide string of IEC 61131-3 looks like a name of SCL."""
    text = Variable(name="text", type=StringType(wide=True, length="36"), initial="WSTRING#'a b'")
    one = ArrayValue(items=[RepeatedValue(value=SimpleValue(text="WSTRING#'R134'"))])
    texts = Variable(
        name="texts", type=ArrayType(dimensions=[Dimension(lower="1", upper="1")], base=text.type), initial=one
    )
    interface = Interface(sections=[VariableSection(variables=[text, texts])])
    block = DataBlock(name="Labels", interface=interface)
    source = Project(data_blocks=[block], dialect=Dialect.SCL)
    data, report = sfc.convert(source, target)
    assert report.losses == []
    assert b'simpleValue value="&quot;a b&quot;"' in data
    assert b'simpleValue value="&quot;R134&quot;"' in data


def test_lists_that_tc6_cannot_tell_apart_are_reported() -> None:
    one = VariableSection(kind=SectionKind.GLOBAL, name="A", variables=[Variable(name="x", type="BOOL")])
    other = VariableSection(kind=SectionKind.GLOBAL, name="B", variables=[Variable(name="x", type="BOOL")])
    source = Project(global_variables=[one, other], dialect=Dialect.CODESYS)
    _, report = sfc.convert(source, "plcopen", partial=True)
    assert [(item.outcome, item.path) for item in report.losses] == [(Outcome.NOT_EXECUTED, "global variable x")]


@pytest.mark.parametrize(("initial", "length"), [("40", "40"), ("2 * 20", None)])
def test_a_constant_as_length_of_a_string_is_a_number_in_tc6_1_01(initial: str, length: str | None) -> None:
    most = VariableSection(
        kind=SectionKind.GLOBAL,
        name="GVL",
        constant=True,
        variables=[Variable(name="MOST", type="INT", initial=initial)],
    )
    text = Variable.model_validate({"name": "text", "type": {"kind": "string", "length": "MOST"}})
    pou = Pou(
        name="Main",
        kind=PouKind.PROGRAM,
        interface=Interface(sections=[VariableSection(variables=[text])]),
        bodies=[StBody(text=";")],
    )
    source = Project(pous=[pou], global_variables=[most], dialect=Dialect.CODESYS)
    data, report = sfc.convert(source, "plcopen-1.01", partial=True)
    assert [d for d in validate_tc6(data) if d.severity == "error"] == []
    assert [item.what for item in report.losses] == ([] if length else ["length of a string"])
    written = sfc.loads(data, as_tool=True).pous[0].variables()[0].type
    assert getattr(written, "length", "") == length
    assert sfc.loads(data).pous[0].variables()[0].type == text.type


@pytest.mark.parametrize("target", TARGETS)
def test_a_function_without_result_has_none(target: str) -> None:
    source = sfc.load(FIXTURES / "simaticml" / "FC_Release.xml")
    data, report = sfc.convert(source, target, partial=True)
    assert [item for item in report.losses if "Ret_Val" in item.path or "oid" in item.why] == []
    read = sfc.loads(data, as_tool=True).pou("FC_Release")
    assert [v.name for v in read.variables()] == ["Enable", "Running"]
    back = sfc.loads(sfc.dumps(sfc.loads(data), format="simaticml", partial=True))
    assert back.pou("FC_Release").interface == source.pou("FC_Release").interface
    edited = sfc.loads(data)
    edited.pou("FC_Release").comment = "changed"
    assert b"Ret_Val" in sfc.dumps(edited)
    assert [v.name for v in sfc.loads(sfc.dumps(edited), as_tool=True).pou("FC_Release").variables()] == [
        "Enable",
        "Running",
    ]
