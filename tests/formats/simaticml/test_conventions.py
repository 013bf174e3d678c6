"""Our writer writes as Openness does: bytes, ids, order; and the example PLC has all that a document can hold."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc.formats.simaticml.openness_schemas import validate
from plcopen_sfc.model.body import StBody
from tests.corpus import ROOT
from tests.formats.simaticml import drilling_plc
from tests.formats.simaticml.documents import FIXTURES, parsed
from tests.formats.simaticml.official import official, outer_parts, without_namespace

DOCUMENTS = sorted(FIXTURES.glob("*.xml"))
PLC = sorted(drilling_plc.FOLDER.rglob("*.xml"))
EVERY = pytest.mark.parametrize("path", [*DOCUMENTS, *PLC], ids=lambda path: path.name)


def ids(root: etree._Element) -> list[str]:
    return [str(element.get("ID")) for element in root.iter(etree.Element) if element.get("ID") is not None]


@EVERY
def test_bytes_are_those_of_openness(path: Path) -> None:
    data = sfc.dumps(sfc.load(path), fresh=True)
    assert data.startswith(
        b'\xef\xbb\xbf<?xml version="1.0" encoding="utf-8"?>\r\n<Document>\r\n  <Engineering version='
    )
    assert data.count(b"\n") == data.count(b"\r\n") == data.count(b"\r")
    assert b"\t<" not in data
    assert not re.search(rb"[^ ]/>", data)


@EVERY
def test_ids_are_running_hexadecimal_numbers(path: Path) -> None:
    found = ids(parsed(sfc.dumps(sfc.load(path), fresh=True)))
    assert found == [format(number, "X") for number in range(len(found))]


def test_new_objects_get_the_next_ids_and_no_other_line_changes() -> None:
    project = sfc.load(FIXTURES / "tags.xml")
    table = project.tag_tables[0]
    table.tags.append(table.tags[1].model_copy(deep=True, update={"name": "Reset", "address": "%I9.0"}))
    before = (FIXTURES / "tags.xml").read_bytes()
    after = sfc.dumps(project)
    removed = set(before.splitlines()) - set(after.splitlines())
    assert removed == set()
    assert len(set(ids(parsed(after)))) == len(ids(parsed(after)))


@EVERY
def test_attributes_of_blocks_stand_in_alphabetical_order(path: Path) -> None:
    root = parsed(sfc.dumps(sfc.load(path), fresh=True))
    for holder in root.findall("./*/AttributeList"):
        names = [str(child.tag) for child in holder]
        assert names == sorted(names, key=str.lower)


@EVERY
def test_texts_have_a_culture_and_stand_in_items(path: Path) -> None:
    root = parsed(sfc.dumps(sfc.load(path), fresh=True))
    for text in root.iter("MultilingualText"):
        items = text.findall("ObjectList/MultilingualTextItem")
        assert items
        assert all(item.get("CompositionName") == "Items" for item in items)
        cultures = [item.findtext("AttributeList/Culture") for item in items]
        assert all(re.fullmatch(r"[a-z]{2}(-[A-Z][a-z]{3})?-[A-Z]{2}", culture or "") for culture in cultures)
        assert len(set(cultures)) == len(cultures)


@pytest.mark.slow
def test_the_setting_of_the_export_is_kept_and_not_invented() -> None:
    assert b"<ExportSetting>WithDefaults</ExportSetting>" in sfc.dumps(sfc.load(FIXTURES / "tags.xml"), fresh=True)
    converted = sfc.dumps(
        sfc.load(ROOT / "fixtures" / "codesys" / "sorting_conveyor.xml"), format="simaticml", partial=True
    )
    assert b"ExportSetting" not in converted
    assert b"InstalledProducts" not in converted


# -- the example PLC -----------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_example_plc_is_what_its_script_makes(tmp_path: Path) -> None:
    drilling_plc.make(tmp_path / "plc")
    made = {path.relative_to(tmp_path / "plc").as_posix() for path in (tmp_path / "plc").rglob("*.xml")}
    assert made == {path.relative_to(drilling_plc.FOLDER).as_posix() for path in PLC}
    assert sfc.load(tmp_path / "plc") == sfc.load(drilling_plc.FOLDER)


@pytest.mark.parametrize("path", PLC, ids=lambda path: path.name)
def test_the_example_plc_is_valid(path: Path) -> None:
    data = path.read_bytes()
    assert validate(data) == []
    for kind, number, element in outer_parts(parsed(data)):
        official(kind, number).assertValid(without_namespace(element))


def test_the_example_plc_is_a_whole_program() -> None:
    project = sfc.load(drilling_plc.FOLDER)
    project.read_all()
    assert project.diagnostics == ()
    chart = project.pou("FB_Drilling").sfc
    assert chart is not None
    events = {action.event for _, action in chart.associations()} - {None}
    assert events == {"S1", "S0", "V1", "V0", "L1", "L0", "A1", "R1"}
    assert {action.qualifier.value for _, action in chart.associations()} >= {"N", "S", "R", "D", "L", "CALL", "ON"}
    assert len(chart.sequences) == 2
    assert sum(step.interlock is not None for step in chart.steps) == 2
    assert sum(step.supervision is not None for step in chart.steps) == 2
    assert chart.permanent_pre
    assert chart.permanent_post
    assert any(len(transition.targets) > 1 for transition in chart.transitions)
    assert [t.name for t in chart.transitions if not t.targets] == ["T_Batch"]
    assert {block.kind.value for block in project.data_blocks} == {"global", "instance"}
    assert project.data_types
    assert project.tag_tables[0].constants
    assert {body.language for _, _, body in project.bodies()} >= {"SFC", "ST", "FBD"}


def test_the_readme_names_every_document() -> None:
    readme = (ROOT / "fixtures" / "README.md").read_text(encoding="utf-8")
    named = [f"`{path.relative_to(ROOT / 'fixtures').as_posix()}`" for path in (*DOCUMENTS, *PLC)]
    assert [name for name in named if name not in readme] == []


def test_the_call_of_an_instance_data_block_in_scl_is_no_call_of_a_function(tmp_path: Path) -> None:
    source = drilling_plc.SOURCE + (
        'ORGANIZATION_BLOCK "Cyclic"\nVERSION : 0.1\nBEGIN\n    "FB_Chips_DB"(run := TRUE);\n    "FC_Release"();\n'
        "END_ORGANIZATION_BLOCK\n"
    )
    plc = sfc.loads(source.encode(), format="scl")
    sfc.save(plc, f"{tmp_path / 'plc'}/", format="simaticml")
    data = (tmp_path / "plc" / "Program blocks" / "Cyclic.xml").read_bytes()
    root = parsed(data)
    assert [info.get("BlockType") for info in root.iter("{*}CallInfo")] == ["FB", "FC"]
    instance = root.find(".//{*}CallInfo/{*}Instance")
    assert instance is not None
    assert instance.get("Scope") == "GlobalVariable"
    block = sfc.loads(data)
    body = block.pou("Cyclic").bodies[0]
    assert isinstance(body, StBody)
    assert body.markup is None
    body.text = body.text.replace("TRUE", "FALSE")
    edited = sfc.dumps(block)
    assert sum(old != new for old, new in zip(data.splitlines(), edited.splitlines(), strict=True)) == 1
