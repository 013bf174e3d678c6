"""Files of PLC projects of TwinCAT 3: identity, edits, charts written from the model, folders, and errors."""

from __future__ import annotations

import copy
import difflib
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc import jump, selection, step
from plcopen_sfc.errors import LossError, SfcError
from plcopen_sfc.formats.archives.chart_elements import ATTRIBUTES, ELEMENTS
from plcopen_sfc.formats.archives.object_archive import type_of
from plcopen_sfc.formats.format_interface import WriteOptions
from plcopen_sfc.formats.twincat.twincat_codec import CODEC
from plcopen_sfc.model import ForeignData, Pou, PouInstance, PouKind, Project, Step, Task, Transition, VariableSection
from plcopen_sfc.model.drawing import SymbolKind
from plcopen_sfc.report import ConversionReport, Outcome
from tests.corpus import ROOT, corpus_files
from tests.samples import FIXTURES
from tests.sweeps import WHOLE

BELT = FIXTURES / "twincat-belt"
CHART = BELT / "POUs" / "Ablauf_Band.TcPOU"
REAL = [path for path in corpus_files("twincat") if path.suffix == ".TcPOU"]
SMALL = sorted(REAL, key=lambda path: path.stat().st_size)[: len(REAL) if WHOLE else 4]
FILES = [CHART, *(pytest.param(path, marks=pytest.mark.corpus, id=path.stem) for path in REAL)]
EDITED = [CHART, *(pytest.param(path, marks=pytest.mark.corpus, id=path.stem) for path in SMALL)]


def changed(before: bytes, after: bytes) -> list[str]:
    """Return the lines that were taken out and put in."""
    texts = (data.decode("utf-8-sig").splitlines() for data in (before, after))
    found = difflib.unified_diff(*texts, lineterm="", n=0)
    return [line for line in found if not line.startswith(("---", "+++", "@@"))]


@pytest.mark.parametrize("path", FILES)
def test_a_file_comes_back_byte_for_byte(path: Path) -> None:
    project = sfc.load(path)
    assert sfc.dumps(project) == path.read_bytes()
    assert list(project.charts())
    assert not [each for each in project.diagnostics if each.severity.value == "error"]


@pytest.mark.parametrize("path", FILES)
def test_the_archive_of_a_chart_is_written_from_the_model_as_the_tool_wrote_it(path: Path) -> None:
    data = path.read_bytes()
    project = sfc.load(path)
    tree = CODEC.to_tree(project, WriteOptions(same=True, source=data), ConversionReport())
    written, source = (_archives(root) for root in (tree, etree.fromstring(data)))
    assert written.keys() == source.keys()
    for name, archive in source.items():
        other = set(difflib.unified_diff(archive, written[name], lineterm="", n=0))
        values = {line for line in other if line[:1] in "+-" and line[1:2] == "<"}
        # the tool keeps how a name in a jump and a qualifier were typed, and one version adds a number to the chart
        assert all('<v n="Value">' in line or "ImplId" in line for line in values), sorted(values)


def _archives(root: etree._Element) -> dict[str, list[str]]:
    """Return the archives of charts and settings, line by line, by what they are the archive of."""
    found: dict[str, list[str]] = {}
    for archive in root.iter("XmlArchive"):
        holder = archive.getparent()
        owner = next(each for each in archive.iterancestors() if each.get("Name"))
        if holder is not None and holder.tag in ("SFC", "ObjectProperties"):
            lines = [f"<{each.tag} {dict(each.attrib)}" for each in archive.iter() if len(each)]
            lines += [f'<v n="{each.get("n")}">{each.text}' for each in archive.iter("v", "Type")]
            found[f"{owner.get('Name')}/{holder.tag}"] = lines
    return found


def _condition(project: Project) -> None:
    next(iter(project.charts())).chart.transitions[0].condition = "Fertig AND NOT Halt"


def _name(project: Project) -> None:
    chart = next(iter(project.charts())).chart
    chart.rename_step(chart.steps[-2 % len(chart.steps)].name, "Zz9_Neu")


def _time(project: Project) -> None:
    next(iter(project.charts())).chart.steps[-1].min_time = "T#5s"


def _comment(project: Project) -> None:
    next(iter(project.charts())).chart.steps[0].comment = "eine Anmerkung"


def _variable(project: Project) -> None:
    for variable in project.pous[0].variables()[:1]:
        variable.name += "_neu"


@pytest.mark.slow
@pytest.mark.parametrize("edit", [_condition, _name, _time, _comment, _variable])
@pytest.mark.parametrize("path", EDITED)
def test_an_edit_changes_its_line(path: Path, edit: Callable[[Project], None]) -> None:
    project = sfc.load(path)
    edit(project)
    data = sfc.dumps(project)
    lines = changed(path.read_bytes(), data)
    assert len([line for line in lines if line.startswith("+")]) <= 2, lines
    assert len(lines) in (0, 2, 4)
    assert [pou.model_dump() for pou in sfc.loads(data).pous] == [pou.model_dump() for pou in project.pous]


@pytest.mark.parametrize("path", EDITED)
def test_a_step_that_is_put_in_changes_no_other_element(path: Path) -> None:
    project = sfc.load(path)
    chart = next(iter(project.charts())).chart
    transition = chart.transitions[0]
    free = 10_000
    chart.steps.append(Step(id=free, name="Zz9_Neu"))
    chart.transitions.append(Transition(id=free + 1, sources=[free], targets=transition.targets, condition="weiter"))
    transition.targets = [free]
    data = sfc.dumps(project)
    gone = [line for line in changed(path.read_bytes(), data) if line.startswith("-")]
    assert len(gone) <= 9, gone  # a jump may be drawn again: it has the numbers of four elements
    back = next(iter(sfc.loads(data).charts())).chart
    assert {step.name for step in back.steps} == {step.name for step in chart.steps}
    assert sorted(back.labels().values()) == sorted(chart.labels().values())


@pytest.mark.parametrize("end", [0, -1])
def test_a_macro_stays_folded_when_its_first_or_last_step_is_deleted(end: int) -> None:
    """Its first or last element was gone, so all the others were written again, outside of it."""
    project = sfc.load(CHART)
    data, macros = CHART.read_bytes(), {}
    chart = project.pous[0].chart
    assert chart is not None
    for element in etree.fromstring(data).iter("o"):
        if element.get("t") == "SFCMacro":
            names = [each.text or "" for each in element.iter("v") if each.get("n") == "Value"]
            macros[id(element)] = [step for step in chart.steps if f'"{step.name}"' in names]
    (steps,) = macros.values()
    edit = project.edit()
    edit.delete_step(steps[end], "both")
    saved = sfc.dumps(project)
    assert saved.count(b"SFCMacro") == data.count(b"SFCMacro")
    assert sum(line.startswith("+") for line in changed(data, saved)) <= 30
    edit.undo()
    assert sfc.dumps(project) == data


@pytest.mark.parametrize("kind", ["twincat", "codesys"])
def test_a_step_before_a_jump_leaves_the_other_branches_where_they_are(kind: str) -> None:
    """The jump hung together with the end of the others by its wire, and what is below the branches moved into one."""
    project = Project(dialect="codesys")
    branches = [["a", step("First"), "b"], ["c", step("Second"), "d"], ["e", jump("Wait")]]
    project.add_program(
        "Main",
        *(step("Wait", initial=True), "Start", step("Ready"), selection(*branches)),
        *(step("Run"), "f", step("End"), "g", jump("Ready")),
    )
    project = sfc.loads(sfc.dumps(project, format=kind))
    project.edit().remove_branch(project.pous[0].chart.transition("Ready -> Second"))
    data = sfc.dumps(project)
    project = sfc.loads(data)
    chart = project.pous[0].chart
    edit = project.edit()
    edit.insert_step("Extra", chart.transition("Ready -> Wait"), "TRUE")
    saved = sfc.dumps(project)
    assert sum(line.startswith("-") for line in changed(data, saved)) <= 12
    back = sfc.loads(saved).pous[0].chart
    assert sorted(back.labels().values()) == sorted(chart.labels().values())
    edit.undo()
    assert sfc.dumps(project) == data


def test_a_chart_goes_to_plcopen_xml_and_back() -> None:
    project = sfc.load(CHART)
    export = sfc.loads(sfc.dumps(project, format="codesys"))
    back = sfc.loads(sfc.dumps(export, format="twincat"))
    for other in (export, back):
        one, two = project.pous[0].chart, other.pous[0].chart
        assert one is not None
        assert two is not None
        assert [step.model_dump(exclude={"id", "actions", "extension_data"}) for step in one.steps] == [
            step.model_dump(exclude={"id", "actions", "extension_data"}) for step in two.steps
        ]
        assert list(one.labels().values()) == list(two.labels().values())
        assert [t.condition for t in one.transitions] == [t.condition for t in two.transitions]
        assert one.settings == two.settings
    assert b"SFCMacro" in sfc.dumps(back)
    assert sfc.dumps(export, format="codesys").count(b"SFCMacro") == 0


@pytest.mark.slow
def test_another_tools_project_becomes_a_folder(tmp_path: Path) -> None:
    source = sfc.load(FIXTURES / "codesys" / "distribution_belt.xml")
    report = sfc.save(source, tmp_path, format="twincat", partial=True)
    assert {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*.*")} == {
        "POUs/Ablauf_Band.TcPOU",
        "POUs/BLINK.TcPOU",  # of the library Util, which TwinCAT does not have
        "POUs/Eingabe_Anzahl.TcPOU",
        "POUs/PLC_PRG.TcPOU",
        "GVLs/GVL_EA.TcGVL",
        "GVLs/GVL_Statistik.TcGVL",
        "MainTask.TcTTO",
        "Visu.TcTTO",
    }
    assert not report.with_outcome(Outcome.NOT_EXECUTED)
    assert {item.what for item in report.with_outcome(Outcome.APPROXIMATED)} == {"watchdog"}
    back = sfc.load(tmp_path)
    tasks = {task.name: task for each in back.applications for task in each.tasks}
    assert {name: (task.interval, task.priority) for name, task in tasks.items()} == {
        "MainTask": ("T#20ms", 1),
        "Visu": ("T#100ms", 31),
    }
    assert [each.name for each in tasks["MainTask"].instances] == ["PLC_PRG"]
    changes = [change for change in sfc.diff(source, back).changes if "BLINK" not in change.path]
    assert {change.aspect for change in changes} == {"watchdog"}
    assert back.source is not None
    assert back.source.format == "twincat"
    assert sfc.equivalent(source.pous[0], back.pou(source.pous[0].name), limit=2) is not None
    first = (tmp_path / "POUs" / "Ablauf_Band.TcPOU").read_bytes()
    assert first.startswith(b"\xef\xbb\xbf<?xml")
    assert b"\n" not in first.replace(b"\r\n", b"")


def test_a_folder_is_saved_file_by_file(tmp_path: Path) -> None:
    shutil.copytree(BELT, tmp_path / "belt")
    before = {path: path.read_bytes() for path in (tmp_path / "belt").rglob("*.*")}
    project = sfc.load(tmp_path / "belt")
    assert sfc.save(project, tmp_path / "belt").unchanged
    section = next(each for each in project.global_variables if each.name == "GVL_Statistik")
    section.variables[0].comment = "Stück"
    project.global_variables.append(VariableSection(kind="global", name="GVL_Neu"))
    project.pous.append(Pou(name="Neu", kind=PouKind.FUNCTION_BLOCK))
    report = sfc.save(project, tmp_path / "belt")
    written = {Path(name).relative_to(tmp_path / "belt").as_posix() for name in report.written}
    assert written == {"GVLs/GVL_Statistik.TcGVL", "GVLs/GVL_Neu.TcGVL", "POUs/Neu.TcPOU"}
    assert len(changed(before[tmp_path / "belt/GVLs/GVL_Statistik.TcGVL"], _read(tmp_path, "GVL_Statistik"))) == 2
    project.global_variables = [each for each in project.global_variables if each.name != "GVL_Neu"]
    project.pous = [each for each in project.pous if each.name != "Neu"]
    report = sfc.save(project, tmp_path / "belt")
    assert sorted(Path(name).name for name in report.removed) == ["GVL_Neu.TcGVL", "Neu.TcPOU"]


@pytest.mark.parametrize("saved_to", ["belt", "belt/PLC.plcproj"])
def test_a_project_file_lists_the_files_of_the_project(saved_to: str, tmp_path: Path) -> None:
    shutil.copytree(BELT, tmp_path / "belt")
    listing = tmp_path / "belt" / "PLC.plcproj"
    listing.write_text(
        '<Project xmlns="http://schemas.microsoft.com/developer/msbuild/2003"><ItemGroup>'
        '<Compile Include="POUs\\Ablauf_Band.TcPOU"><SubType>Code</SubType></Compile>'
        '<Compile Include="POUs\\Gone.TcPOU"><SubType>Code</SubType></Compile>'
        '<Compile Include="gvls\\GVL_EA.TcGVL"><SubType>Code</SubType></Compile></ItemGroup></Project>'
    )
    project = sfc.load(listing)
    assert [pou.name for pou in project.pous] == ["Ablauf_Band"]
    assert [section.name for section in project.global_variables] == ["GVL_EA"]
    assert [each.code for each in project.diagnostics if "Gone" in str(each.location.file)] == ["DIR101"]
    _name(project)
    assert [Path(name).name for name in sfc.save(project, tmp_path / saved_to).written] == ["Ablauf_Band.TcPOU"]
    assert (tmp_path / "belt" / "MainTask.TcTTO").exists()


LISTED = """\ufeff<?xml version="1.0" encoding="utf-8"?>\r
<Project xmlns="http://schemas.microsoft.com/developer/msbuild/2003">\r
  <ItemGroup>\r
    <Compile Include="POUs\\Ablauf_Band.TcPOU">\r
      <SubType>Code</SubType>\r
    </Compile>\r
    <Compile Include="GVLs\\GVL_EA.TcGVL">\r
      <SubType>Code</SubType>\r
    </Compile>\r
  </ItemGroup>\r
  <ItemGroup>\r
    <Folder Include="POUs" />\r
  </ItemGroup>\r
</Project>\r
"""


@pytest.mark.parametrize("saved_to", ["belt", "belt/PLC.plcproj"])
def test_new_files_are_entered_in_the_project_file_and_old_ones_taken_out(saved_to: str, tmp_path: Path) -> None:
    shutil.copytree(BELT, tmp_path / "belt")
    listing = tmp_path / "belt" / "PLC.plcproj"
    listing.write_bytes(LISTED.encode())
    project = sfc.load(listing)
    project.pous.append(Pou(name="Neu", kind=PouKind.FUNCTION_BLOCK))
    project.global_variables = []
    report = sfc.save(project, tmp_path / saved_to)
    assert {Path(name).name for name in report.written} == {"Neu.TcPOU", "PLC.plcproj"}
    assert changed(LISTED.encode(), listing.read_bytes()) == [
        '-    <Compile Include="GVLs\\GVL_EA.TcGVL">',
        '+    <Compile Include="POUs\\Neu.TcPOU">',
    ]
    assert b"\n" not in listing.read_bytes().replace(b"\r\n", b"")
    again = sfc.load(listing)
    assert [pou.name for pou in again.pous] == ["Ablauf_Band", "Neu"]
    again.global_variables.append(VariableSection(kind="global", name="GVL_Neu"))
    sfc.save(again, tmp_path / saved_to)
    assert b'<Compile Include="GVLs\\GVL_Neu.TcGVL">\r\n      <SubType>Code' in listing.read_bytes()
    assert b'<Folder Include="GVLs" />' in listing.read_bytes()
    _name(again)
    assert [Path(name).name for name in sfc.save(again, tmp_path / saved_to).written] == ["Ablauf_Band.TcPOU"]


@pytest.mark.parametrize(
    ("listed", "left"),
    [
        (["GVLs"], []),
        (["GVLs", "POUs"], ["POUs"]),
        (["gvls\\", "Plans"], ["Plans"]),  # one that had no file before is the user's
        (["GVLs", "GVLs\\Old"], ["GVLs", "GVLs\\Old"]),
    ],
)
def test_a_folder_whose_last_file_is_gone_is_taken_out(listed: list[str], left: list[str], tmp_path: Path) -> None:
    shutil.copytree(BELT, tmp_path / "belt")
    listing = tmp_path / "belt" / "PLC.plcproj"
    entry = '    <Folder Include="{}" />\r\n'
    text = LISTED.replace(entry.format("POUs"), "".join(map(entry.format, listed)))
    listing.write_bytes(text.encode())
    project = sfc.load(listing)
    project.global_variables = []
    sfc.save(project, listing)
    assert re.findall('<Folder Include="(.*?)"', listing.read_text()) == left
    assert listing.read_text().count("<ItemGroup>") == (2 if left else 1)
    other = text.replace(
        "</ItemGroup>\r\n  <ItemGroup>", '  <None Include="GVLs\\notes.txt" />\r\n  </ItemGroup>\r\n  <ItemGroup>'
    )
    shutil.copytree(BELT, tmp_path / "belt", dirs_exist_ok=True)
    listing.write_bytes(other.encode())
    project = sfc.load(listing)
    project.global_variables = []
    sfc.save(project, listing)
    assert re.findall('<Folder Include="(.*?)"', listing.read_text()) == listed  # a file of another kind is there


def test_tasks_are_edited_in_their_files(tmp_path: Path) -> None:
    shutil.copytree(BELT, tmp_path / "belt")
    before = _read(tmp_path, "Visu")
    project = sfc.load(tmp_path / "belt")
    resource = project.applications[0]
    next(task for task in resource.tasks if task.name == "Visu").interval = "T#250us"
    resource.tasks.append(Task(name="Slow", interval="T#1s", instances=[PouInstance(name="PLC_PRG", type_name="")]))
    report = sfc.save(project, tmp_path / "belt")
    assert {Path(name).name for name in report.written} == {"Visu.TcTTO", "Slow.TcTTO"}
    assert changed(before, _read(tmp_path, "Visu")) == [
        "-    <CycleTime>100000</CycleTime>",
        "+    <CycleTime>250</CycleTime>",
    ]
    again = sfc.load(tmp_path / "belt")
    assert sfc.save(again, tmp_path / "belt").unchanged
    resource.tasks = [task for task in resource.tasks if task.name != "Slow"]
    assert [Path(name).name for name in sfc.save(project, tmp_path / "belt").removed] == ["Slow.TcTTO"]


def test_tasks_at_events_are_not_executed(tmp_path: Path) -> None:
    project = sfc.load(FIXTURES / "iectext" / "mixing_plant.st")
    report = sfc.save(project, tmp_path, format="twincat", partial=True)
    assert "task OnEdge" in {item.path for item in report.with_outcome(Outcome.NOT_EXECUTED)}


def _read(folder: Path, name: str) -> bytes:
    return next(folder.rglob(f"{name}.*")).read_bytes()


def test_several_objects_need_a_folder() -> None:
    with pytest.raises(SfcError, match="one POU") as refused:
        sfc.dumps(sfc.load(FIXTURES / "codesys" / "distribution_belt.xml"), format="twincat", partial=True)
    assert "folder" in refused.value.hint


DAMAGED = {
    "an element of an unknown type": (b't="SFCJump"', b't="SFCLeap"', "TWC102", "SFCLeap"),
    "a number that is used twice": (b'<v n="Id">3L</v>', b'<v n="Id">0L</v>', "SFC101", "number 0"),
    "a number that two attributes have": (b'<v n="Id">70L</v>', b'<v n="Id">69L</v>', "TWC105", "number 69"),
    "a segment without a list": (b'<l2 n="InnerList">', b'<l2 n="InnerLst">', "TWC101", "no list of elements"),
    "another identity of a type": (b"{86ee92a2", b"{96ee92a2", "TWC103", "SFCStep"),
    "a type that is not listed": (b'<Type n="SFCTransition">', b'<Type n="SFCOther">', "TWC103", "lacks SFCTransition"),
    "code in an element": (
        b'<n n="EmbeddedTransition" />',
        b'<o n="EmbeddedTransition" t="X" />',
        "TWC102",
        "Embedded",
    ),
    "a list without the type of its attributes": (b' cet="SFCAttribute"', b"", "TWC102", "type of its items"),
    "a list without the type of its elements": (b' cet="SFCSegment"', b"", "TWC102", "type nothing"),
    "a list without the type of its associations": (b' cet="SFCActionAssociation"', b"", "TWC102", "type nothing"),
    "associations of another type": (b'cet="SFCActionAssociation"', b'cet="SFCStep"', "TWC102", "of the type SFCStep"),
    "a step without a list": (
        b'<l2 n="InnerList" cet="SFCActionAssociation">',
        b'<l2 n="InnerLst" cet="SFCActionAssociation">',
        "TWC101",
        "the step Bereitschaft has no list",
    ),
    "a branch without a list": (
        b'<l2 n="InnerList" cet="SFCSegment">',
        b'<l2 n="Inner">',
        "TWC101",
        "a branch has no list",
    ),
    "a flag that is neither used nor unused": (b'<v n="Use">true</v>', b'<v n="Use">ture</v>', "TWC102", "Use is ture"),
    "a flag without a word on its use": (b'<v n="Use">true</v>', b"", "TWC102", "Use is without a value"),
    "a truth that is none": (b'<v n="Value">"TRUE"</v>', b'<v n="Value">"JA"</v>', "TWC102", "cannot be JA"),
    "a truth of another type": (
        b't="BoolValue"',
        b't="StringValue"',
        "TWC102",
        "Exclude is a StringValue, and not a BoolValue",
    ),
    "a text without quotes": (
        b'"Bereitschaft"</v>',
        b"Bereitschaft</v>",
        "TWC102",
        "Name is no text in quotes, but Bereitschaft",
    ),
    "an attribute that is given twice": (
        b"{a6b08bd8-b696-47e3-9cbf-7408b61c9ff8}",
        b"{700a583f-b4d4-43e4-8c14-629c7cd3bec8}",
        "TWC102",
        "MainAction is given twice",
    ),
    "a member that no file has": (b'<n n="EmbeddedMainAction" />', b'<n n="Delay" />', "TWC102", "Delay: no known"),
    "a step without a name": (b'"Grundstellung"</v>', b'""</v>', "TWC102", "a step has no name"),
    "a flag that no tool has": (b"<v>Pause</v>", b"<v>Pauze</v>", "TWC102", "Pauze is no SFC flag"),
    "a second body": (b"<SFC>", b"<ST>;</ST><SFC>", "TWC102", "a second body in SFC"),
    "an association without an action": (
        b'"GVL_EA.H1_Bereit"</v>',
        b'""</v>',
        "TWC102",
        "an association names no action",
    ),
    "an element without its attributes": (
        b'<l2 n="Attributes"',
        b'<l2 n="Attribute"',
        "TWC101",
        "no list of attributes",
    ),
    "a branch with a segment of another type": (
        b'cet="SFCSegment"',
        b'cet="SFCStep"',
        "TWC102",
        "segment of the type SFCStep",
    ),
    "an element without a number": (b'<v n="Id">0L</v>', b"", "SFC101", "has no number"),
    "an attribute without its identity": (
        b'<v n="AttributeId">{a6b08bd8-b696-47e3-9cbf-7408b61c9ff8}</v>',
        b"",
        "TWC102",
        "the attribute  of an element is not understood",
    ),
    "a member that is there twice": (
        b'<n n="EmbeddedMainAction" />',
        b'<n n="EmbeddedMainAction" /><n n="EmbeddedMainAction" />',
        "TWC102",
        "EmbeddedMainAction is given twice",
    ),
    "settings without a member": (b'<v n="Version">', b'<v n="Edition">', "TWC102", "settings of a chart lack Version"),
    "settings without flags": (b'<d2 n="Flags"', b'<d2 n="Flag"', "TWC102", "settings of a chart lack Flags"),
    "a flag without a value": (b"<v>Pause</v>", b"", "TWC102", "no names with a value for each"),
    "a flag that is there twice": (b"<v>Pause</v>", b"<v>Reset</v>", "TWC102", "no names with a value for each"),
    "properties without an archive": (
        b"<ObjectProperties>",
        b"<ObjectProperties /><ObjectProperties>",
        "TWC102",
        "properties of a chart are no archive",
    ),
    "a second object in an archive": (
        b"<Data>",
        b'<Data><o t="SFCImplementationObject" />',
        "TWC102",
        "a second object in the archive",
    ),
    "settings of another type": (
        b't="SFCProperty"',
        b't="FlagProperty"',
        "TWC102",
        "properties of a chart that are not understood",
    ),
    "something beside the settings": (
        b"</ObjectProperties>",
        b"<Runs>false</Runs></ObjectProperties>",
        "TWC102",
        "Runs in the properties of a chart is not understood",
    ),
    "no qualifier": (b'"D T#3s"', b'"Q T#3s"', "TWC102", "Q is no qualifier"),
    "a jump to nowhere": (b'"Grundstellung"</v>', b'"Nirgends"</v>', "SFC103", "Grundstellung"),
}


@pytest.mark.parametrize(
    ("parts", "code", "words"),
    [
        (("<Data>", "</Data>"), "TWC101", "no objects (Data): nothing of it is read"),
        (("<TypeList>", "</TypeList>"), "TWC103", "no list of types (TypeList)"),
    ],
)
def test_an_archive_without_its_parts_is_an_error(parts: tuple[str, str], code: str, words: str) -> None:
    """The first was a body that is not understood, as a warning; the second was read without a word."""
    start, end = (part.encode() for part in parts)
    data = CHART.read_bytes()
    cut = data[: data.index(start)] + data[data.index(end) + len(end) :]
    project = sfc.loads(cut)
    (found,) = [each for each in project.diagnostics if each.code == code]
    assert words in found.message
    assert found.severity.value == "error"
    assert found.location.line
    assert sfc.dumps(project) == cut


@pytest.mark.parametrize("damage", DAMAGED)
def test_damage_is_told_at_its_place(damage: str) -> None:
    old, new, code, words = DAMAGED[damage]
    data = CHART.read_bytes()
    assert old in data
    project = sfc.loads(data.replace(old, new, 1))
    found = [each for each in project.diagnostics if each.code == code]
    assert any(words in each.message for each in found), project.diagnostics
    assert all(each.location.line for each in found)
    assert all((each.location.path or "").startswith("POU Ablauf_Band") for each in found)


BODY = re.compile(rb"<Implementation>.*?</Implementation>", re.DOTALL)


@pytest.mark.parametrize(
    ("owner", "called"),
    [
        (b"<POU ", "the POU Pump"),
        (b"<Action ", "the Action Clr"),
        (b"<Method ", "the Method Inc"),
        (b"<Transition ", "the Transition Full"),
        (b"<Get ", "the accessor Runs.Get"),
    ],
)
@pytest.mark.parametrize("instead", [b"", b"<Implementation />", b"<Implemented><ST/></Implemented>"])
def test_an_object_without_a_body_is_an_error(owner: bytes, called: str, instead: bytes) -> None:
    """It was read as one that does nothing, and converted without a word."""
    condition = b'<Transition Name="Full"><Implementation><ST><![CDATA[cnt > 3]]></ST></Implementation></Transition>'
    properties = METHODS[METHODS.index(b"<Property ") : METHODS.index(b"<LineIds")]
    data = WITH_PARTS.replace(b"  </POU>", condition + properties + b"  </POU>")
    assert not sfc.loads(data).diagnostics
    start = data.index(owner)
    damaged = data[:start] + BODY.sub(instead, data[start:], count=1)
    project = sfc.loads(damaged)
    found = [each for each in project.diagnostics if each.code == "TWC108"]
    assert [called in each.message for each in found] == [True], project.diagnostics
    assert found[0].severity is sfc.Severity.ERROR
    assert found[0].location.line == damaged[:start].count(b"\n") + 1
    with pytest.raises(sfc.DamagedSourceError):
        sfc.dumps(project, format="codesys", partial=True)
    assert sfc.dumps(project) == damaged


@pytest.mark.parametrize(
    ("old", "new", "code", "words"),
    [
        (b'<Action Name="Stop"', b'<Action Name="clr"', "TWC109", "the Action clr has the name of the Action Clr"),
        (b'<Action Name="Stop"', b'<Method Name="Inc"', "TWC109", "the Method Inc has the name of the Method Inc"),
        (b'<Action Name="Stop"', b"<Action", "TWC108", "a part of the kind Action has no name"),
        (
            b"<Method Name",
            b"<Declaration>PROGRAM Other</Declaration><Method Name",
            "TWC102",
            "second Declaration",
        ),
        (
            b"<Method Name",
            b"<Implementation><ST/></Implementation><Method Name",
            "TWC102",
            "second Implementation",
        ),
    ],
)
def test_parts_that_are_there_twice_or_have_no_name_are_errors(old: bytes, new: bytes, code: str, words: str) -> None:
    """The first one counted, in silence."""
    damaged = WITH_PARTS.replace(old, new, 1)
    if new.startswith(b'<Method Name="Inc'):
        start = WITH_PARTS.index(b"<Method")
        method = WITH_PARTS[start : WITH_PARTS.index(b"</Method>") + 9]
        damaged = WITH_PARTS.replace(method, method + method.replace(b"3333", b"5555"))
    project = sfc.loads(damaged)
    (found,) = [each for each in project.diagnostics if each.severity is sfc.Severity.ERROR]
    assert (found.code, words in found.message) == (code, True), found
    assert found.location.line
    assert sfc.dumps(project) == damaged


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (b"<CycleTime>20000</CycleTime>", b"", "CycleTime of the task is missing"),
        (b"<CycleTime>20000", b"<CycleTime>2O000", "CycleTime of the task is 2O000"),
        (b"<Priority>1<", b"<Priority><", "Priority of the task is missing"),
        (b"<Name>PLC_PRG</Name>", b"", "a PouCall has no name"),
        (b"<Name>PLC_PRG</Name>", b"<Name>PLC_PRG</Name><Name>PLC_PRG</Name>", "a PouCall has several names"),
        (b'Name="MainTask"', b"", "a Task has no name"),
        (b"<Priority>", b"<Disabled>true</Disabled><Priority>", "Disabled of the task is not understood"),
        (b"<Priority>", b"<Priority>1</Priority><Priority>", "Priority of the task is not understood"),
        (b"<PouCall>", b"<PouCall><Exclude>true</Exclude>", "Exclude of the task is not understood"),
    ],
)
def test_what_a_task_lacks_or_has_beside_is_an_error(old: bytes, new: bytes, words: str) -> None:
    """It had no interval then, the highest priority or no program, or another element, without a word."""
    data = (BELT / "MainTask.TcTTO").read_bytes()
    assert old in data
    project = sfc.loads(data.replace(old, new))
    (found,) = project.diagnostics
    assert (found.code, found.severity, words in found.message) == ("TWC110", sfc.Severity.ERROR, True)
    assert found.location.line
    assert sfc.dumps(project) == data.replace(old, new)


@pytest.mark.parametrize("content", [b"", b"\0" * 100, b"<TcPlcObjekt/>", b"no XML"])
def test_a_file_whose_beginning_is_damaged_is_told(content: bytes, tmp_path: Path) -> None:
    """It did not look like a file of TwinCAT any more, and was left out of the project in silence."""
    shutil.copytree(BELT, tmp_path / "belt")
    broken = tmp_path / "belt" / "POUs" / "PLC_PRG.TcPOU"
    broken.write_bytes(content)
    project = sfc.load(tmp_path / "belt")
    assert "PLC_PRG" not in {pou.name for pou in project.pous}
    (found,) = [each for each in project.diagnostics if each.severity is sfc.Severity.ERROR]
    assert (found.code, found.location.file) == ("DIR101", str(broken))
    project.pous[0].comment = "edited"
    sfc.save(project, tmp_path / "belt", partial=True)
    assert broken.read_bytes() == content


def test_a_second_object_in_a_file_is_not_read_and_told() -> None:
    data = CHART.read_bytes().replace(
        b"</TcPlcObject>",
        b'<POU Name="Other" Id="{1c5c6e05-2bb7-4258-aaaa-000000000001}">'
        b"<Declaration><![CDATA[PROGRAM Other]]></Declaration>"
        b"<Implementation><ST><![CDATA[;]]></ST></Implementation></POU></TcPlcObject>",
    )
    project = sfc.loads(data)
    assert [pou.name for pou in project.pous] == ["Ablauf_Band"]
    (found,) = project.diagnostics
    assert (found.code, "Other" in found.message) == ("TWC106", True)
    assert sfc.dumps(project) == data
    with pytest.raises(sfc.DamagedSourceError):  # it would be missing in another format
        sfc.dumps(project, format="codesys")


def test_a_truncated_file_does_not_keep_the_others_from_being_read(tmp_path: Path) -> None:
    shutil.copytree(BELT, tmp_path / "belt")
    broken = tmp_path / "belt" / "POUs" / "Ablauf_Band.TcPOU"
    broken.write_bytes(broken.read_bytes()[:20_000])
    project = sfc.load(tmp_path / "belt")
    assert project.global_variables
    assert project.pous
    (found,) = [each for each in project.diagnostics if each.severity.value == "error"]
    assert found.location.line
    assert found.location.file == str(broken)


@pytest.mark.parametrize(
    ("old", "new"),
    [(b"<POU ", b"<Recipe "), (b"<Declaration>", b"<Declared>"), (b"PROGRAM Ablauf_Band", b"TYPE x : INT; END_TYPE")],
)
def test_files_of_nothing_that_is_read_are_refused(old: bytes, new: bytes) -> None:
    data = CHART.read_bytes().replace(old, new, 1)
    for opening in (b"POU", b"Declaration"):
        if old == b"<" + opening + (b" " if opening == b"POU" else b">"):
            data = data.replace(b"</" + opening + b">", b"</" + new.strip(b"<> ") + b">", 1)
    with pytest.raises(SfcError) as refused:
        sfc.loads(data)
    assert refused.value.location.line


METHODS = b"""\xef\xbb\xbf<?xml version="1.0" encoding="utf-8"?>
<TcPlcObject Version="1.1.0.1">
  <POU Name="Pump" Id="{5a961730-f4bc-46e9-979d-c80cbcef2de5}" SpecialFunc="None">
    <Declaration><![CDATA[{attribute 'reflection'}
FUNCTION_BLOCK Pump EXTENDS Base
VAR_INPUT
\tPart : ARRAY [*] OF INT; // any number
END_VAR
]]></Declaration>
    <Implementation>
      <ST><![CDATA[]]></ST>
    </Implementation>
    <Method Name="Start" Id="{5a961730-f4bc-46e9-979d-c80cbcef2de6}">
      <Declaration><![CDATA[METHOD Start : BOOL
VAR_INPUT
\tSpeed : INT;
END_VAR
]]></Declaration>
      <Implementation>
        <ST><![CDATA[Start := Speed > 0;]]></ST>
      </Implementation>
    </Method>
    <Property Name="Runs" Id="{5a961730-f4bc-46e9-979d-c80cbcef2de7}">
      <Declaration><![CDATA[PROPERTY Runs : BOOL]]></Declaration>
      <Get Name="Get" Id="{5a961730-f4bc-46e9-979d-c80cbcef2de8}">
        <Declaration><![CDATA[]]></Declaration>
        <Implementation>
          <ST><![CDATA[Runs := TRUE;]]></ST>
        </Implementation>
      </Get>
    </Property>
    <LineIds Name="Pump.Start">
      <LineId Id="2" Count="0" />
    </LineIds>
  </POU>
</TcPlcObject>"""


def test_methods_and_properties() -> None:
    project = sfc.loads(METHODS)
    method = project.pous[0].methods[0]
    assert [variable.name for variable in method.interface.variables()] == ["Speed"]
    method.interface.variables()[0].name = "Rate"
    method.body.text = "Start := Rate > 0;"
    lines = changed(METHODS, sfc.dumps(project))
    assert [line.strip() for line in lines if line.startswith("+")] == [
        "+\tRate : INT;",
        "+        <ST><![CDATA[Start := Rate > 0;]]></ST>",
    ]
    report = ConversionReport()
    sfc.dumps(project, format="codesys", partial=True)
    CODEC.write(project, WriteOptions(), report)
    assert ("property", "POU Pump / property Runs") in {(item.what, item.path) for item in report.items}
    assert report.with_outcome(Outcome.NOT_EXECUTED) == []


INTERFACE = METHODS.replace(b"POU", b"Itf").replace(
    METHODS[METHODS.index(b"{attribute") : METHODS.index(b"]]>")], b"INTERFACE Pump EXTENDS Base\n"
)


def test_interfaces_are_kept_as_text_with_their_methods(tmp_path: Path) -> None:
    project = sfc.loads(INTERFACE)
    assert sfc.dumps(project) == INTERFACE
    assert project.extension_data is not None
    assert "METHOD Start : BOOL" in project.extension_data.data[0].content
    shutil.copytree(BELT, tmp_path / "belt")
    (tmp_path / "belt" / "Pump.TcIO").write_bytes(INTERFACE)
    folder = sfc.load(tmp_path / "belt")
    _name(folder)
    assert [Path(name).name for name in sfc.save(folder, tmp_path / "belt").written] == ["Ablauf_Band.TcPOU"]
    with pytest.raises(SfcError, match="INTERFACE Pump"):
        sfc.dumps(folder, format="codesys")


def test_pragmas_and_modifiers_stay_around_an_edit() -> None:
    data = METHODS.replace(b"METHOD Start", b"{attribute 'hide'}\nMETHOD PUBLIC ABSTRACT Start")
    project = sfc.loads(data)
    project.pous[0].variables()[0].name = "Parts"
    assert project.pous[0].methods[0].interface is not None
    project.pous[0].methods[0].interface.variables()[0].name = "Rate"
    edited = sfc.dumps(project)
    assert [line for line in changed(data, edited) if line.startswith("+")] == [
        "+\tParts : ARRAY [*] OF INT; // any number",
        "+\tRate : INT;",
    ]
    fresh = sfc.dumps(project, fresh=True, partial=True)
    for word in (b"{attribute 'reflection'}", b"{attribute 'hide'}", b"PUBLIC ABSTRACT", b"EXTENDS Base"):
        assert word in fresh
    assert b"plcopen_sfc" not in fresh


PROPERTY = (
    METHODS.replace(b"Runs := TRUE;", b"\nIF Count >= 2 AND x < 3 THEN Runs := TRUE; END_IF\n")
    .replace(b"<Declaration><![CDATA[]]>", b"<Declaration><![CDATA[VAR\n\tx : INT;\nEND_VAR\n]]>")
    .replace(b"\nVAR_IN", b"\nVAR\n\tCount, x : INT;\nEND_VAR\nVAR_IN", 1)
)


def test_a_rename_changes_the_code_of_properties() -> None:
    """A property kept the old name, and a batch did not tell."""
    project = sfc.loads(PROPERTY)
    name = project.pous[0].name
    uses = project.uses(f"{name}.Count")
    assert [(use.language, use.line) for use in uses] == [("ST", 6)]
    assert project.uses(f"{name}.x") == [], "the property has its own"
    result = project.rename(f"{name}.Count", "Number")
    assert (len(result.changed), result.undecided) == (1, ())
    edited = sfc.dumps(project)
    assert [line for line in changed(PROPERTY, edited) if line.startswith("+")] == [
        "+\tNumber, x : INT;",
        "+IF Number >= 2 AND x < 3 THEN Runs := TRUE; END_IF",
    ]
    assert sfc.loads(edited) == project


ALONE = PROPERTY.replace(b" EXTENDS Base", b"")


def kept_property(project: Project) -> ForeignData:
    extension_data = project.pous[0].extension_data
    assert extension_data is not None
    return next(each for each in extension_data.data if "PROPERTY" in each.content)


def test_a_property_is_changed_added_and_taken_out() -> None:
    """A file got no property that it did not have, and none with another number of lines."""
    project = sfc.loads(PROPERTY)
    kept = kept_property(project)
    kept.content = kept.content.replace("END_IF", "END_IF\nRuns := FALSE;")
    longer = sfc.dumps(project)
    assert sfc.loads(longer) == project
    assert [line.strip() for line in changed(PROPERTY, longer) if line[0] == "+" and "Runs := FALSE" in line] != []
    assert longer.count(b"{5a961730-f4bc-46e9-979d-c80cbcef2de8}") == 1, "its accessor stays the same object"
    data = project.pous[0].extension_data
    assert data is not None
    second = "PROPERTY PUBLIC Second : INT\nGET\nSecond := Count;\nEND_GET\n"
    second += "SET\nVAR\n\ty : INT;\nEND_VAR\nCount := Second;\nEND_SET"
    data.data.append(kept.model_copy(update={"content": kept.content.replace(second_of(kept.content), second)}))
    both = sfc.dumps(project)
    assert sfc.loads(both) == project
    properties = etree.fromstring(both).findall(".//Property")
    assert [each.get("Name") for each in properties] == ["Runs", "Second"]
    assert [each.findtext("Declaration") for each in properties[1]][1:] == ["", "VAR\n\ty : INT;\nEND_VAR"]
    data.data.remove(kept)
    alone = sfc.dumps(project)
    assert [each.get("Name") for each in etree.fromstring(alone).iter("Property")] == ["Second"]
    kept_property(project).content = kept_property(project).content.replace("END_GET", "END_SET")
    with pytest.raises(LossError, match="not GET and SET with their code"):
        sfc.dumps(project)


def second_of(content: str) -> str:
    """The text of a property in what is kept of it, without its end."""
    return content[content.index("PROPERTY Runs") : content.index("\nEND_PROPERTY")]


@pytest.mark.parametrize("to", ["twincat", "codesys-export"])
@pytest.mark.parametrize("kind", ["twincat", "iec-text", "codesys-export"])
def test_properties_go_to_the_formats_that_have_them(kind: str, to: str) -> None:
    source = sfc.loads(sfc.dumps(sfc.loads(ALONE), format=kind))
    found = sfc.loads(sfc.convert(source, to).data)
    assert " ".join(kept_property(found).content.split()) == " ".join(kept_property(source).content.split())


@pytest.mark.parametrize("to", ["twincat", "codesys-export"])
def test_a_copied_block_takes_its_properties_and_methods_along(to: str, tmp_path: Path) -> None:
    place = tmp_path / ("plc" if to == "twincat" else "plc.export")
    (tmp_path / "plc").mkdir()
    target = Project(dialect="codesys")
    for name in ("Main", "Other"):
        target.add_program(name)
    sfc.save(target, place, format=to)
    target = sfc.load(place)
    edit = target.edit()
    edit.copy_pou(sfc.loads(ALONE), "Pump", {"Pump": "Pump2", "Pump.Count": "Number"})
    sfc.save(target, place)
    copy = sfc.load(place).pou("Pump2")
    assert [each.name for each in copy.methods] == ["Start"]
    assert copy.extension_data is not None
    assert "IF Number &gt;= 2" in next(each.content for each in copy.extension_data.data if "PROPERTY" in each.content)
    edit.undo()
    sfc.save(target, place)
    assert [each.name for each in sfc.load(place).pous] == ["Main", "Other"]


def test_properties_are_texts_that_other_formats_have_too() -> None:
    text = sfc.dumps(sfc.loads(METHODS), format="iec-text").decode()
    assert [line.strip() for line in text.splitlines() if "PROPERTY" in line] == [
        "PROPERTY Runs : BOOL",
        "END_PROPERTY",
    ]


def test_a_text_that_cannot_be_read_is_told_at_its_line() -> None:
    project = sfc.loads(METHODS.replace(b"Speed : INT;", b"Speed : ;"))
    found = [each for each in project.diagnostics if each.severity.value == "error"]
    assert {each.location.line for each in found} == {16}


def test_the_same_model_is_the_same_file() -> None:
    project = sfc.load(FIXTURES / "codesys" / "distribution_belt.xml")
    project.pous = project.pous[:1]
    project.global_variables, project.applications = [], []
    assert sfc.dumps(project, format="twincat", partial=True) == sfc.dumps(project, format="twincat", partial=True)


def test_the_page_lists_every_attribute() -> None:
    page = (ROOT / "docs" / "formats" / "twincat.md").read_text(encoding="utf-8")
    listed = [line for line in page.splitlines() if line.startswith("| `SFC")]
    assert listed == [
        f"| `{kind}` | {attribute.name} | `{field}` |"
        for kind, table in ELEMENTS.items()
        for field, attribute in table.items()
    ]


def test_words_at_addresses_are_at_their_bytes_in_twincat(tmp_path: Path) -> None:
    text = b"""{plcopen_sfc project.dialect := 'codesys'}
    PROGRAM Main
    VAR lamp AT %QW3 : WORD; bit AT %QX3.1 : BOOL; first AT %QW0 : WORD; END_VAR
    lamp := %IW2 OR %IW0; %QX1.2 := bit;
    END_PROGRAM"""
    project = sfc.loads(text, format="iec-text")
    sfc.save(project, tmp_path / "plc", format="twincat", strict=True)
    there = sfc.load(tmp_path / "plc")
    assert [v.address for v in there.pou("Main").variables()] == ["%QW6", "%QX3.1", "%QW0"]
    assert there.pou("Main").body.text == "lamp := %IW4 OR %IW0; %QX1.2 := bit;"
    back = sfc.loads(sfc.convert(there, "codesys", strict=True).data)
    assert [v.address for v in back.pou("Main").variables()] == ["%QW3", "%QX3.1", "%QW0"]
    assert back.pou("Main").body.text == project.pou("Main").body.text


@pytest.mark.parametrize("word", ["On", "With", "Task", "Extends"])
def test_words_that_stand_between_declarations_are_names(word: str, tmp_path: Path) -> None:
    text = f"""{{plcopen_sfc project.dialect := 'codesys'}}
    TYPE Mode : (Off, {word}); END_TYPE
    PROGRAM Main
    VAR m : Mode := {word}; END_VAR
    m := Mode.{word};
    END_PROGRAM"""
    project = sfc.loads(text.encode(), format="iec-text")
    sfc.save(project, tmp_path, format="twincat", strict=True)
    kept = sfc.load(tmp_path, as_tool=True)
    there = "Extends_2" if word == "Extends" else word  # a keyword of CODESYS V3
    assert [value.name for value in kept.data_types[0].type.values] == ["Off", there]
    assert word.encode() in sfc.dumps(project, format="codesys23", strict=True)


def test_two_files_with_one_identity_are_told(tmp_path: Path) -> None:
    shutil.copytree(BELT, tmp_path / "belt")
    first, second = (tmp_path / "belt" / "POUs" / f"{name}.TcPOU" for name in ("PLC_PRG", "Eingabe_Anzahl"))
    known = sfc.load(first).pous[0].object_id
    other = sfc.load(second).pous[0].object_id
    assert known is not None
    assert other is not None
    second.write_bytes(second.read_bytes().replace(other.encode(), known.encode()))
    (found,) = sfc.load(tmp_path / "belt").diagnostics
    assert (found.code, found.severity.value) == ("DIR106", "warning")
    assert known in found.message


WITH_PARTS = b"""<?xml version="1.0" encoding="utf-8"?>
<TcPlcObject Version="1.1.0.1" ProductVersion="3.1.4024.0">
  <POU Name="Pump" Id="{11111111-1111-1111-1111-111111111111}" SpecialFunc="None">
    <Declaration><![CDATA[FUNCTION_BLOCK Pump
VAR
\tcnt : INT;
END_VAR
]]></Declaration>
    <Implementation>
      <ST><![CDATA[Inc(n := 1);
Clr();]]></ST>
    </Implementation>
    <Action Name="Clr" Id="{22222222-2222-2222-2222-222222222222}">
      <Implementation>
        <ST><![CDATA[cnt := 0;]]></ST>
      </Implementation>
    </Action>
    <Method Name="Inc" Id="{33333333-3333-3333-3333-333333333333}">
      <Declaration><![CDATA[METHOD Inc : INT
VAR_INPUT
\tn : INT;
END_VAR
]]></Declaration>
      <Implementation>
        <ST><![CDATA[cnt := cnt + n;]]></ST>
      </Implementation>
    </Method>
    <Action Name="Stop" Id="{44444444-4444-4444-4444-444444444444}">
      <Implementation>
        <ST><![CDATA[cnt := -1;]]></ST>
      </Implementation>
    </Action>
  </POU>
</TcPlcObject>
"""


def test_renamed_actions_and_methods_stay_where_they_are() -> None:
    project = sfc.loads(WITH_PARTS)
    project.rename("Pump.Inc", "Plus")
    project.rename("Pump.Clr", "Clear")
    assert sfc.dumps(project) == WITH_PARTS.replace(b"Inc", b"Plus").replace(b"Clr", b"Clear")


def test_a_symbol_with_the_number_of_an_attribute_keeps_it_alone() -> None:
    """A new drawing numbers its symbols from the model, which knows no numbers of attributes."""
    project = sfc.load(FIXTURES / "twincat-belt" / "POUs" / "Ablauf_Band.TcPOU")
    drawing = project.pou("Ablauf_Band").chart.drawing  # type: ignore[union-attr]
    assert drawing is not None
    jump = next(symbol for symbol in drawing.symbols if symbol.kind is SymbolKind.JUMP)
    jump.id = max(int(number) for number in re.findall(r'n="Id">(\d+)L', sfc.dumps(project).decode()))
    again = sfc.loads(sfc.dumps(project))
    assert not again.diagnostics
    assert str(sfc.diff(project, again)) == "no differences"


def test_an_object_with_another_name_than_its_declaration_is_told_and_has_that() -> None:
    data = METHODS.replace(b'<POU Name="Pump"', b'<POU Name="Engine"').replace(
        b'<Method Name="Start"', b'<Method Name="Begin"'
    )
    assert data != METHODS
    project = sfc.loads(data)
    assert [pou.name for pou in project.pous] == [pou.name for pou in sfc.loads(METHODS).pous]
    found = [(each.code, each.severity.value, each.message) for each in project.diagnostics]
    assert [each[:2] for each in found] == [("TWC107", "warning")] * 2
    assert "Engine declares" in found[0][2]
    assert sfc.dumps(project) == data
    project.pous[0].interface.sections[0].variables[0].comment = "any"  # an edit leaves both names
    assert changed(data, sfc.dumps(project))[0].startswith("-\tPart")


def test_objects_with_one_identity_are_told() -> None:
    data = CHART.read_bytes()
    first, second, *_ = re.findall(rb'<Action Name="\w+" Id="(\{[^"]*\})"', data)
    project = sfc.loads(data.replace(second, first))
    (found,) = [each for each in project.diagnostics if each.code == "TWC105"]
    names = [each.name for each in project.pous[0].actions]
    assert found.message == f"the Action {names[1]} has the Id of the Action {names[0]}"


def test_each_attribute_that_an_element_lacks_is_told() -> None:
    """A step without its attribute of the initial step was no initial step any more, in silence."""
    data = CHART.read_bytes()
    tree = etree.fromstring(data)
    seen: set[tuple[str, str]] = set()
    for element in tree.iter("o"):
        held = element.find("l2[@n='Attributes']")
        kind = type_of(element)
        for attribute in held if held is not None and kind in ELEMENTS else ():
            name = ATTRIBUTES[(attribute.findtext("v[@n='AttributeId']") or "").strip("{}")].name
            if (kind, name) in seen:
                continue
            seen.add((kind, name))
            place = list(held).index(attribute)  # type: ignore[arg-type]
            held.remove(attribute)  # type: ignore[union-attr]
            found = [each for each in sfc.loads(etree.tostring(tree)).diagnostics if each.code == "TWC102"]
            told = [
                each for each in found if each.message == f"an element of the type {kind} lacks the attribute {name}"
            ]
            assert len(told) == 1
            assert told[0].location.line
            held.insert(place, attribute)  # type: ignore[union-attr]
    assert seen == {(kind, each.name) for kind, table in ELEMENTS.items() for each in table.values()}


def test_an_association_that_is_there_twice_is_told() -> None:
    """A list of associations was read with all, whatever their numbers are."""
    tree = etree.fromstring(CHART.read_bytes())
    held = next(each for each in tree.iter("l2") if each.get("cet") == "SFCActionAssociation" and len(each))
    held.append(copy.deepcopy(held[0]))
    found = [each for each in sfc.loads(etree.tostring(tree)).diagnostics if each.code == "SFC101"]
    assert len(found) == 1
    assert "an association has the number" in found[0].message
    number = held[0].find("v[@n='Id']")
    assert number is not None
    held[:] = [held[0]]
    held[0].remove(number)
    assert "an association has no number" in str(sfc.loads(etree.tostring(tree)).diagnostics)


def test_a_list_of_global_variables_without_a_name_is_told() -> None:
    data = (BELT / "GVLs" / "GVL_EA.TcGVL").read_bytes().replace(b'<GVL Name="GVL_EA"', b"<GVL")
    project = sfc.loads(data)
    (found,) = project.diagnostics
    assert (found.code, found.severity, found.location.line) == ("TWC108", sfc.Severity.ERROR, 3)
    assert sfc.dumps(project) == data


def test_a_file_that_is_listed_without_its_path_is_told(tmp_path: Path) -> None:
    shutil.copytree(BELT, tmp_path / "belt")
    listing = tmp_path / "belt" / "PLC.plcproj"
    compiled = '<Compile Include="POUs\\PLC_PRG.TcPOU" /><Compile Inclde="GVLs\\GVL_EA.TcGVL" />'
    listing.write_text(f"<Project><ItemGroup>{compiled}</ItemGroup></Project>")
    project = sfc.load(listing)
    assert [pou.name for pou in project.pous] == ["PLC_PRG"]
    (found,) = project.diagnostics
    assert (found.code, "a file without its path (Include)" in found.message) == ("DIR101", True)
    with pytest.raises(sfc.DamagedSourceError):
        sfc.save(project, tmp_path / "out.xml", format="codesys", partial=True)


def test_a_listed_file_outside_of_the_folder_is_told(tmp_path: Path) -> None:
    shutil.copytree(BELT, tmp_path / "belt")
    listed = "".join(f'<Compile Include="{each}"/>' for each in ("POUs\\PLC_PRG.TcPOU", "..\\A.TcPOU"))
    content = f"<Project><ItemGroup>{listed}</ItemGroup></Project>"
    (tmp_path / "belt" / "Belt.plcproj").write_text(content, encoding="utf-8")
    (found,) = sfc.load(tmp_path / "belt" / "Belt.plcproj").diagnostics
    assert "outside of its folder: load the folder above" in found.message
