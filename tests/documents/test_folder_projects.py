"""A folder of documents as one project: nothing changes but what was edited."""

from __future__ import annotations

import copy
import os
import shutil
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import plcopen_sfc as sfc
from plcopen_sfc.diagnostics import DamagedSourceError
from plcopen_sfc.errors import FileAccessError, LossError, ModelError, OldVersionError, UnknownFormatError
from plcopen_sfc.model import Project
from plcopen_sfc.model.compare import differences
from tests.corpus import ROOT
from tests.documents.exports import PLACES, block, changes, contents, export
from tests.samples import FIXTURES
from tests.sweeps import examples

posix_only = pytest.mark.skipif(os.name == "nt", reason="needs POSIX permissions and links")
not_root = pytest.mark.skipif(hasattr(os, "geteuid") and os.geteuid() == 0, reason="root may read everything")


def test_an_export_is_one_project(tmp_path: Path) -> None:
    project = sfc.load(export(tmp_path))
    assert {thing.name: thing.folder for thing in project.objects()} == {
        "Bohrmaschine": "PLC tags",
        "Station": "PLC data types",
        "Machine": "Program blocks",
        "FB_Drill_DB": "Program blocks/Station Süd",
        "FB_Drill": "Program blocks/Station Süd",
        "FB_Motor": "Program blocks",
        "FC_Release": "Program blocks",
    }
    assert project.diagnostics == ()
    assert project.header.version == "V20"


PLC = ROOT / "fixtures" / "simaticml-plc"


def test_the_example_plc(tmp_path: Path) -> None:
    """The larger example: all of it comes back, also through another format."""
    project = sfc.load(PLC)
    assert project.diagnostics == ()
    assert sfc.check_syntax(project) == []
    assert sfc.save(project, tmp_path / "copy").unchanged
    assert contents(tmp_path / "copy") == contents(PLC)
    sfc.save(project, tmp_path / "all.json", format="json")
    report = sfc.save(sfc.load(tmp_path / "all.json"), f"{tmp_path}/back/", format="simaticml")
    assert report.losses == []
    back = sfc.load(tmp_path / "back")
    names = {thing.name: thing for thing in back.objects()}
    for thing in project.objects():
        assert list(differences(thing, names[thing.name], ignore=frozenset({"drawing", "extension_data"}))) == []


def test_unedited_nothing_is_touched(tmp_path: Path) -> None:
    folder = export(tmp_path)
    before = contents(folder)
    times = {path: (folder / path).stat().st_mtime_ns for path in before}
    project = sfc.load(folder)
    project.read_all()
    report = sfc.save(project, folder)
    assert report.unchanged
    assert report.written == []
    assert contents(folder) == before
    assert {path: (folder / path).stat().st_mtime_ns for path in before} == times


def test_a_copy_elsewhere_is_the_same(tmp_path: Path) -> None:
    folder = export(tmp_path)
    report = sfc.save(sfc.load(folder), tmp_path / "copy")
    assert report.unchanged
    assert len(report.written) == len(PLACES)
    assert contents(tmp_path / "copy") == contents(folder)


def test_a_rename_changes_the_lines_that_name_it_in_all_files(tmp_path: Path) -> None:
    folder = export(tmp_path)
    before = contents(folder)
    project = sfc.load(folder)
    project.rename("FB_Drill", "FB_Bohren")
    report = sfc.save(project, folder)
    after = contents(folder)
    changed = changes(before, after)
    assert {Path(name).name for name in changed} == {"FB_Drill.xml", "FB_Drill_DB.xml"}
    assert {Path(name).name for name in report.written} == {"FB_Drill.xml", "FB_Drill_DB.xml"}
    for name in changed:
        lines = zip(before[name].split(b"\n"), after[name].split(b"\n"), strict=True)
        edited = [(old, new) for old, new in lines if old != new]
        assert [old.replace(b"FB_Drill<", b"FB_Bohren<") for old, _ in edited] == [new for _, new in edited]
        assert len(edited) == 1


@pytest.mark.slow
def test_names_are_resolved_across_files(tmp_path: Path) -> None:
    """A tag, a member of a data block, a data type and a member of it: every file that names them follows."""
    folder = export(tmp_path)
    before = contents(folder)
    files = {
        "Stop": {"tags.xml", "FB_Motor.xml", "FC_Release.xml", "FB_Drill.xml"},
        "Machine.GuardOpen": {"Machine.xml", "FB_Drill.xml"},
        "Station": {"Station.xml", "Machine.xml"},
        "Station.Count": {"Station.xml", "FB_Motor.xml"},
    }
    for path, changed in files.items():
        project = sfc.load(folder)
        result = project.rename(path, "Zz9")
        assert result.undecided == ()
        sfc.save(project, tmp_path / "renamed")
        assert {Path(name).name for name in changes(before, contents(tmp_path / "renamed"))} == changed


def test_a_second_save_counts_from_the_first(tmp_path: Path) -> None:
    folder = export(tmp_path)
    before = contents(folder)
    project = sfc.load(folder)
    project.rename("FB_Drill", "FB_Bohren")
    sfc.save(project, folder)
    assert sfc.save(project, folder).written == []
    project.rename("FB_Bohren", "FB_Drill")
    assert len(sfc.save(project, folder).written) == 2
    assert contents(folder) == before
    assert sfc.load(folder) == project


def test_a_reverted_edit_of_a_chart_is_written_back(tmp_path: Path) -> None:
    folder = export(tmp_path)
    before = contents(folder)
    project = sfc.load(folder)
    chart = project.pou("FB_Drill").sfc
    assert chart is not None
    step = chart.step("Drill")
    old, step.max_time = step.max_time, "T#77S"
    sfc.save(project, folder)
    assert len(changes(before, contents(folder))) == 1
    step.max_time = old
    sfc.save(project, folder)
    assert contents(folder) == before


def test_new_objects_get_files_and_lost_ones_lose_theirs(tmp_path: Path) -> None:
    folder = export(tmp_path)
    before = contents(folder)
    project = sfc.load(folder)
    new = copy.deepcopy(project.pou("FC_Release"))
    new.name = "Freigabe/Ü: 2*"
    project.pous.append(new)
    project.data_blocks = [block for block in project.data_blocks if block.name != "Machine"]
    report = sfc.save(project, folder)
    assert [Path(path).name for path in report.written] == ["Freigabe_Ü_ 2_.xml"]
    assert [Path(path).name for path in report.removed] == ["Machine.xml"]
    assert changes(before, contents(folder)) == {"Program blocks/Freigabe_Ü_ 2_.xml", "Program blocks/Machine.xml"}
    again = sfc.load(folder)
    assert again.pou("Freigabe/Ü: 2*").bodies == project.pou("FC_Release").bodies


def test_an_object_moves_with_its_folder(tmp_path: Path) -> None:
    folder = export(tmp_path)
    before = contents(folder)
    project = sfc.load(folder)
    project.pou("FB_Motor").folder = "Program blocks/Antriebe"
    report = sfc.save(project, folder)
    after = contents(folder)
    assert changes(before, after) == {"Program blocks/FB_Motor.xml", "Program blocks/Antriebe/FB_Motor.xml"}
    assert after["Program blocks/Antriebe/FB_Motor.xml"] == before["Program blocks/FB_Motor.xml"]
    assert len(report.removed) == 1


@pytest.mark.parametrize("bad", ["../elsewhere", "/elsewhere", "C:\\x", "a/../../b"])
def test_no_folder_leads_out_of_the_project(tmp_path: Path, bad: str) -> None:
    folder = export(tmp_path)
    before = contents(tmp_path)
    project = sfc.load(folder)
    project.pou("FB_Motor").folder = bad
    with pytest.raises(ModelError, match="out of the project"):
        sfc.save(project, folder)
    assert contents(tmp_path) == before


def test_objects_of_one_document_stay_together(tmp_path: Path) -> None:
    one, two = block("One", 1).decode(), block("Two", 2).decode()
    start, end = two.index("  <SW."), two.index("</Document>")
    both = one.replace("</Document>", two[start:end].replace('ID="0"', 'ID="1"') + "</Document>")
    (tmp_path / "both.xml").write_bytes(both.encode())
    project = sfc.load(tmp_path)
    assert [thing.name for thing in project.data_blocks] == ["One", "Two"]
    project.data_blocks[1].name = "Three"
    sfc.save(project, tmp_path)
    assert (tmp_path / "both.xml").read_bytes() == both.replace("Two", "Three").encode()
    project.data_blocks[1].folder = "Apart"
    sfc.save(project, tmp_path)
    assert sorted(contents(tmp_path)) == ["Apart/Three.xml", "both.xml"]
    assert b"Three" not in (tmp_path / "both.xml").read_bytes()
    del project.data_blocks[0]
    assert [Path(path).name for path in sfc.save(project, tmp_path).removed] == ["both.xml"]


def test_one_bad_file_does_not_cost_the_others(tmp_path: Path) -> None:
    folder = export(tmp_path)
    whole = (folder / "PLC tags" / "tags.xml").read_bytes()
    strangers = {
        "cut.xml": whole[:900],
        "bomb.xml": b'<!DOCTYPE Document [<!ENTITY a "aa">]>' + whole.removeprefix(b"\xef\xbb\xbf"),
        "new.xml": block("New", version="Vnext"),
        "deep.xml": b'<Document><Engineering version="V20" />' + b"<a>" * 400 + b"</a>" * 400 + b"</Document>",
    }
    others = {"notes.txt": b"x", "hmi.xml": b"<Hmi/>", "empty.xml": b"", "sub/block.s7dcl": b"FUNCTION"}
    (folder / "sub").mkdir()
    for name, data in (strangers | others).items():
        (folder / name).write_bytes(data)
    project = sfc.load(folder)
    assert len(list(project.objects())) == len(PLACES)
    errors = [found for found in project.diagnostics if found.code == "DIR101"]
    assert {Path(found.location.file or "").name for found in errors} == strangers.keys()
    assert all("Error" not in found.message for found in errors)
    report = sfc.save(project, folder)
    assert {Path(path).relative_to(folder).as_posix() for path in report.left_alone} == strangers.keys() | others.keys()
    with pytest.raises(DamagedSourceError, match="DIR101"):
        sfc.save(project, tmp_path / "copy")
    assert not (tmp_path / "copy").exists()
    project.accept_errors()
    elsewhere = sfc.save(project, tmp_path / "copy", partial=True)
    assert {item.path for item in elsewhere.losses} == strangers.keys()
    with pytest.raises(LossError, match="could not be read"):
        sfc.save(project, tmp_path / "strict", strict=True)
    assert not (tmp_path / "strict").exists()


def test_unreadable_documents_are_missing_in_other_formats(tmp_path: Path) -> None:
    folder = export(tmp_path)
    (folder / "cut.xml").write_bytes((folder / "PLC tags" / "tags.xml").read_bytes()[:900])
    project = sfc.load(folder)
    with pytest.raises(DamagedSourceError, match="DIR101"):
        sfc.save(project, tmp_path / "all.xml", format="plcopen")
    project.accept_errors()
    report = sfc.save(project, tmp_path / "all.xml", format="plcopen", partial=True)
    assert [item.path for item in report.losses if item.what == "file"] == ["cut.xml"]


def test_a_report_names_document_and_line(tmp_path: Path) -> None:
    folder = export(tmp_path)
    report = sfc.save(sfc.load(folder), tmp_path / "all.xml", format="plcopen", partial=True)
    items = [item for item in report.items if item.what == "interlock" and item.path.startswith("POU FB_Drill")]
    assert items
    path = folder / "Program blocks" / "Station Süd" / "FB_Drill.xml"
    for item in items:
        assert item.file == str(path)
        assert item.line is not None
        step = item.path.partition("step ")[2].partition(" / ")[0]
        step = {"Clamp_part": "Clamp part"}.get(step, step)  # what only SCL can write has another name in TC6
        assert f'Name="{step}"' in path.read_text("utf-8-sig").splitlines()[item.line - 1]


def test_translated_texts_are_in_documents_and_lines_too(tmp_path: Path) -> None:
    folder = export(tmp_path)
    report = sfc.save(sfc.load(folder), tmp_path / "all.xml", format="codesys", partial=True)
    items = [item for item in report.items if item.what == "text"]
    assert {item.path.partition(" ")[0] for item in items} == {"POU"}
    places = {"FB_Drill": "Program blocks/Station Süd/FB_Drill.xml", "FB_Motor": "Program blocks/FB_Motor.xml"}
    for item in items:
        name = item.path.split(" ")[1]
        path = folder / places.get(name, f"Program blocks/{name}.xml")
        assert item.file == str(path)
        assert item.line is not None
        kind, _, called = item.path.partition(" / ")[2].partition(" / ")[0].partition(" ")
        line = path.read_text("utf-8-sig").splitlines()[item.line - 1]
        if kind in ("step", "transition"):
            assert f'Name="{called}"' in line
        else:
            assert "<SW.Blocks." in line
    assert any(" / step " in item.path for item in items)


def test_objects_that_are_no_blocks_are_in_documents_and_lines(tmp_path: Path) -> None:
    folder = export(tmp_path)
    report = sfc.save(sfc.load(folder), tmp_path / "all.xml", format="plcopen", partial=True)
    (item,) = [item for item in report.items if item.path == "type Station" and item.what == "folder"]
    assert item.file == str(folder / "PLC data types" / "Station.xml")
    assert item.line is not None
    assert "<SW.Types.PlcStruct" in Path(item.file).read_text("utf-8-sig").splitlines()[item.line - 1]


def test_folders_without_documents(tmp_path: Path) -> None:
    with pytest.raises(UnknownFormatError, match="no document of simaticml"):
        sfc.load(tmp_path)
    (tmp_path / "cut.xml").write_bytes(block("A")[:300])
    with pytest.raises(FileAccessError, match="none of the 1 documents"):
        sfc.load(tmp_path)
    with pytest.raises(UnknownFormatError, match="a folder is no project in the format plcopen"):
        sfc.load(tmp_path, format="plcopen")
    with pytest.raises(FileAccessError, match="does not exist"):
        sfc.load(tmp_path / "none")
    with pytest.raises(FileAccessError, match="a project is one file"):
        sfc.save(Project(), tmp_path, format="plcopen")


@posix_only
def test_links_that_lead_round_are_not_followed(tmp_path: Path) -> None:
    folder = export(tmp_path)
    (folder / "Program blocks" / "round").symlink_to(folder)
    (folder / "self.xml").symlink_to(folder / "self.xml")
    (folder / "gone.xml").symlink_to(folder / "nowhere.xml")
    project = sfc.load(folder)
    assert len(project.pous) == 3
    assert len([found for found in project.diagnostics if found.code == "DIR101"]) == 2
    assert any(path.endswith("round") for path in sfc.save(project, folder).left_alone)


@posix_only
def test_nothing_is_written_through_a_link_out_of_the_folder(tmp_path: Path) -> None:
    project = sfc.load(export(tmp_path))
    target, elsewhere = tmp_path / "target", tmp_path / "elsewhere"
    target.mkdir()
    elsewhere.mkdir()
    (target / "Program blocks").symlink_to(elsewhere)
    with pytest.raises(sfc.SfcError, match="symbolic link that leads out"):
        sfc.save(project, target)
    assert not [*elsewhere.iterdir()]
    assert [path.name for path in target.iterdir()] == ["Program blocks"]


@posix_only
def test_pipes_are_not_waited_for(tmp_path: Path) -> None:
    folder = export(tmp_path)
    os.mkfifo(folder / "pipe.xml")
    assert len(sfc.load(folder).pous) == 3


@posix_only
@not_root
def test_folders_and_files_without_permission(tmp_path: Path) -> None:
    folder = export(tmp_path)
    (folder / "PLC tags").chmod(0)
    (folder / "Program blocks" / "Machine.xml").chmod(0)
    try:
        project = sfc.load(folder)
        assert len([found for found in project.diagnostics if found.code == "DIR101"]) == 2
    finally:
        (folder / "PLC tags").chmod(0o755)


def test_twins_and_versions_are_told(tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    (tmp_path / "a.xml").write_bytes(block("Twin", 7))
    (tmp_path / "sub" / "a.xml").write_bytes(block("TWIN", 8, version="V16").replace(b"/v5", b"/v4"))
    (tmp_path / "b.xml").write_bytes(block("Other", 7, version="V21"))
    before = contents(tmp_path)
    project = sfc.load(tmp_path)
    assert {found.code for found in project.diagnostics} == {"DIR102", "DIR103", "DIR104"}
    assert project.header.version == "V21"
    with pytest.raises(DamagedSourceError, match=r"TWIN is declared in .*a.xml too: one of them is an old copy, or of"):
        sfc.convert(project, "codesys", partial=True)
    project.data_blocks[2].comment = None
    for data_block in project.data_blocks:
        data_block.name += "_neu"
    assert len(sfc.save(project, tmp_path).written) == 3
    for path, data in contents(tmp_path).items():
        assert data.replace(b"_neu", b"") == before[path]
    sfc.save(project, tmp_path, format="simaticml-V16")
    assert {document[40:120].count(b"V16") for document in contents(tmp_path).values()} == {1}


def test_a_version_that_is_too_old_names_what_all_documents_need(tmp_path: Path) -> None:
    folder = export(tmp_path)
    motor = (folder / "Program blocks" / "FB_Motor.xml").read_bytes()
    (folder / "Motor2.xml").write_bytes(motor.replace(b">FB_Motor<", b">FB_Motor2<"))
    project = sfc.load(folder)
    with pytest.raises(OldVersionError) as caught:
        sfc.save(project, tmp_path / "old", format="simaticml", tia="V14 SP1")
    assert {need.path.partition(" / ")[0] for need in caught.value.needs} >= {"POU FB_Motor", "POU FB_Motor2"}
    assert not (tmp_path / "old").exists()


def test_a_file_changed_meanwhile_is_not_overwritten(tmp_path: Path) -> None:
    folder = export(tmp_path)
    project = sfc.load(folder)
    path = folder / "Program blocks" / "Machine.xml"
    path.write_bytes(path.read_bytes().replace(b"V20", b"V19"))
    theirs = contents(folder)
    sfc.save(project, folder)
    project.rename("Machine", "Maschine")
    with pytest.raises(FileAccessError, match="changed since"):
        sfc.save(project, folder)
    project.data_blocks.clear()
    with pytest.raises(FileAccessError, match="changed since"):
        sfc.save(project, folder)
    assert contents(folder) == theirs


@pytest.mark.slow
def test_a_folder_becomes_one_file_and_a_folder_again(tmp_path: Path) -> None:
    project = sfc.load(export(tmp_path))
    for name in ("json", "simaticml", "plcopen", "codesys", "iec-text", "scl"):
        target = tmp_path / f"all.{name}"
        sfc.save(project, target, format=name, partial=True)
        one = sfc.load(target)
        assert {thing.name: thing.folder for thing in one.objects()} == {t.name: t.folder for t in project.objects()}
        back = tmp_path / f"back from {name}"
        sfc.save(one, back, format="simaticml", fresh=name == "simaticml", partial=True)


@pytest.mark.parametrize("name", ["plcopen/filling_station_2.01.xml", "codesys/distribution_belt.xml"])
def test_a_folder_has_the_bodies_of_the_single_file(name: str, tmp_path: Path) -> None:
    """A box R_TRIG with an instance became a PBox with one, which TIA Portal does not have."""
    source = sfc.load(FIXTURES / name)
    sfc.save(source, f"{tmp_path}/plc/", format="simaticml", partial=True)
    alone = sfc.loads(sfc.dumps(sfc.load(FIXTURES / name), format="simaticml", partial=True), as_tool=True)
    in_folder = sfc.load(tmp_path / "plc", as_tool=True)
    assert {pou.name: pou.bodies for pou in in_folder.pous} == {pou.name: pou.bodies for pou in alone.pous}


def test_a_project_of_another_tool_gets_the_folders_of_openness(tmp_path: Path) -> None:
    project = sfc.loads(_PUMPS, format="iec-text")
    report = sfc.save(project, f"{tmp_path}/out/", format="simaticml-V17")
    assert sorted(contents(tmp_path / "out")) == ["PLC data types/State.xml", "Program blocks/Pumps.xml"]
    assert report.losses == []
    back = sfc.load(tmp_path / "out")
    assert back.header.version == "V17"
    assert back.pou("Pumps").interface == project.pou("Pumps").interface
    assert sfc.save(project, tmp_path / "out", format="simaticml-V17").written == []


_PUMPS = b"""TYPE State : STRUCT a : BOOL; END_STRUCT END_TYPE
FUNCTION_BLOCK Pumps VAR s : State; END_VAR s.a := TRUE; END_FUNCTION_BLOCK
"""

names = st.text(st.characters(codec="utf-8", exclude_characters='\x00"'), min_size=1, max_size=12)


@settings(deadline=None, max_examples=examples(25))
@given(st.lists(names, min_size=1, max_size=4, unique=True))
def test_any_names_are_files(tmp_path_factory: pytest.TempPathFactory, many: list[str]) -> None:
    """Whatever objects are called, each gets a file of its own, and saving again changes nothing."""
    folder = tmp_path_factory.mktemp("names")
    project = sfc.loads(block("first"), format="simaticml")
    first = project.data_blocks[0]
    fitting = [name for name in many if name.isprintable() and name.strip() == name]
    for name in fitting:
        new = copy.deepcopy(first)
        new.name = name
        new.folder = None
        project.data_blocks.append(new)
    del project.data_blocks[0]
    project.source = None
    for data_block in project.data_blocks:
        data_block.__pydantic_private__["_home"] = None  # type: ignore[index]
    sfc.save(project, folder, format="simaticml")
    assert len({path.casefold() for path in contents(folder)}) == len(fitting)
    if fitting:
        again = sfc.load(folder)
        assert sorted(thing.name for thing in again.data_blocks) == sorted(fitting)
        assert sfc.save(again, folder).written == []


DEEDS = ("name", "number", "move", "copy", "delete", "save", "nothing")


@settings(deadline=None, max_examples=examples(25))
@given(st.lists(st.tuples(st.sampled_from(DEEDS), st.integers(0, 5)), max_size=8))
def test_any_edits_come_back(tmp_path_factory: pytest.TempPathFactory, deeds: list[tuple[str, int]]) -> None:
    """After any edits the folder is what the project says, and nothing was touched that the report does not name."""
    folder = tmp_path_factory.mktemp("edits")
    for index in range(3):
        (folder / f"{index}.xml").write_bytes(block(f"B{index}", index + 1))
    (folder / "notes.txt").write_bytes(b"x")
    project = sfc.load(folder)
    for step, (deed, place) in enumerate([*deeds, ("save", 0)]):
        things = project.data_blocks
        thing = things[place % len(things)] if things else None
        if deed == "save":
            before = contents(folder)
            report = sfc.save(project, folder)
            named = {Path(path).relative_to(folder).as_posix() for path in report.written + report.removed}
            assert changes(before, contents(folder)) == named
        elif thing is None:
            continue
        elif deed == "name":
            thing.name = f"N{step}"
        elif deed == "number":
            thing.number = 50 + step
        elif deed == "move":
            thing.folder = f"F{place}"
        elif deed == "copy":
            twin = copy.deepcopy(thing)
            twin.name = f"C{step}"
            things.append(twin)
        elif deed == "delete":
            things.remove(thing)
    if project.data_blocks:
        again = {thing.name: thing for thing in sfc.load(folder).data_blocks}
        assert again == {thing.name: thing for thing in project.data_blocks}
    assert (folder / "notes.txt").read_bytes() == b"x"


# the library has BLINK, another document a program; a chart with a macro has its number beside it
@pytest.mark.parametrize("name", ["Eingabe_Anzahl", "PLC_PRG", "Ablauf_Band"])
def test_a_new_document_is_of_the_tool_and_the_project_of_its_folder(tmp_path: Path, name: str) -> None:
    folder = tmp_path / "belt"
    shutil.copytree(FIXTURES / "twincat-belt", folder)
    project = sfc.load(folder)
    project.edit().copy_pou(project, name, {name: "Another"})
    assert not sfc.save(project, folder).losses
    again = sfc.load(folder)
    assert not again.diagnostics
    assert str(sfc.diff(project, again)) == "no differences"
    assert len({pou.object_id for pou in again.pous}) == len(again.pous)


def test_files_of_another_tool_are_told(tmp_path: Path) -> None:
    """They are no part of the project of the folder: nobody may take its conversion for all that is in it."""
    folder = tmp_path / "plant"
    shutil.copytree(FIXTURES / "simaticml-plc", folder)
    (folder / "notes.txt").write_text("PROGRAM", encoding="utf-8")
    assert not [each for each in sfc.load(folder).diagnostics if each.code == "DIR105"]
    shutil.copy(FIXTURES / "codesys" / "sorting_conveyor.xml", folder / "line.xml")
    shutil.copytree(FIXTURES / "twincat-belt", folder / "belt")
    told = [each.message for each in sfc.load(folder).diagnostics if each.code == "DIR105"]
    assert [message.partition(": ")[2] for message in told if "files of codesys" in message] == ["line.xml"]
    assert any("files of twincat" in message and "belt/GVLs" in message for message in told)
