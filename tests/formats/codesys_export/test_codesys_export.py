"""Exports of CODESYS V3 in its own format: identity, edits, new files, what stays in the file, and errors."""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.errors import SfcError, StructureError, XmlSyntaxError
from plcopen_sfc.model import Action, NamedTransition, Pou, PouKind, Project, StBody, Step, Transition
from plcopen_sfc.report import Outcome
from tests.samples import FIXTURES
from tests.strategies import projects

MIXER = FIXTURES / "codesys-export" / "mixer.export"
BELT = FIXTURES / "twincat-belt" / "POUs" / "Ablauf_Band.TcPOU"


def changed(before: bytes, after: bytes) -> list[str]:
    """Return the lines that were taken out and put in, without their indentation."""
    texts = (data.decode().splitlines() for data in (before, after))
    found = difflib.unified_diff(*texts, lineterm="", n=0)
    return [line[0] + line[1:].strip() for line in found if not line.startswith(("---", "+++", "@@"))]


def mixer() -> Project:
    return sfc.load(MIXER)


def chart_of(project: Project) -> sfc.model.SfcNetwork:
    chart = project.pou("Mischer").chart
    assert chart is not None
    return chart


def test_an_export_is_read_whole() -> None:
    project = mixer()
    assert project.source is not None
    assert project.source.format == "codesys-export"
    assert {pou.name: [*(a.name for a in pou.actions), *(m.name for m in pou.methods)] for pou in project.pous} == {
        "Ruehrwerk": ["Zaehlen", "Fertig"],
        "Mischer": ["Zaehler"],
    }
    chart = chart_of(project)
    assert [step.name for step in chart.steps] == ["Bereit", "Fuellen", "Ruehren", "Pumpen"]
    assert chart.step("Fuellen").max_time == "T#20s"
    assert chart.step("Ruehren").entry_action == "Werk.Zaehlen"
    assert "Abbruch" in {getattr(transition.condition, "name", "") for transition in chart.transitions}
    assert [each.name for each in project.pou("Mischer").transitions] == ["Abbruch"]
    assert [declared.name for declared in project.data_types] == ["Rezept"]
    assert [section.name for section in project.global_variables] == ["GVL"]
    (task,) = project.applications[0].tasks
    assert (task.name, task.priority, [each.name for each in task.instances]) == ("MainTask", 1, ["Mischer"])
    assert all(pou.project is project for pou in project.pous)
    assert sfc.simulate(project.pou("Mischer"), scans=3) is not None
    assert [found.code for found in project.diagnostics] == ["CEX103"]
    assert "1 of library manager (" in project.diagnostics[0].message
    assert project.diagnostics[0].location.line


POU_KIND = b"6f9dac99-8de1-4efc-8465-68ac443b7d08"
LIBRARIES = b"adb5cb65-8e1d-4a00-b70a-375ea27582f3"
ACTION_IN_WORK = b'"ParentGuid" Type="System.Guid">a2a167eb-7472-5675-910d-f51a3c752fa1'
ACCESSOR = b'"Name" Type="string">Get<'


def replaced(old: bytes, new: bytes, count: int = 1) -> bytes:
    """Return the file of the mixer with another text in it."""
    data = MIXER.read_bytes()
    assert old in data
    return data.replace(old, new, count)


@pytest.mark.parametrize(
    ("data", "words", "gone"),
    [
        (replaced(POU_KIND, POU_KIND[:-2] + b"ff"), "kind 6f9dac99-8de1-4efc-8465-68ac443b7dff", {"Ruehrwerk"}),
        (replaced(POU_KIND, POU_KIND[:-2] + b"ff"), "it holds Zaehlen, Fertig, Laeuft", {"Ruehrwerk"}),
        (replaced(POU_KIND, b""), "does not tell its kind", {"Ruehrwerk"}),
        (replaced(ACTION_IN_WORK, ACTION_IN_WORK[:-1] + b"0"), "2fa0 around it is not in the file", {"Zaehlen"}),
        (replaced(b"ffbfa93a-b94d-45fc", b"afbfa93a-b94d-45fc"), "it has a declaration or a body", {"GVL"}),
        (replaced(ACCESSOR, ACCESSOR.replace(b"Get", b"Got")), "neither Get nor Set", {"Ruehrwerk"}),
        (replaced(b'<List2 Name="EntryList"', b'<List2 Name="Entries"'), "in no list of objects", {"Ruehrwerk"}),
    ],
)
def test_an_object_that_is_a_part_of_the_program_is_not_lost_in_silence(
    data: bytes, words: str, gone: set[str]
) -> None:
    """A block whose kind was damaged took its actions along, an action without its block vanished: both unsaid."""
    project = sfc.loads(data)
    names = {pou.name for pou in project.pous} | {section.name for section in project.global_variables}
    names |= {action.name for pou in project.pous for action in pou.actions}
    assert not gone & names
    found = [each for each in project.diagnostics if each.code == "CEX102" and words in each.message]
    assert found
    assert all(each.severity is sfc.Severity.ERROR and each.location.line for each in found)
    with pytest.raises(sfc.DamagedSourceError, match="not read"):
        sfc.dumps(project, format="codesys", partial=True)
    assert sfc.dumps(project) == data
    if project.pous and project.pous[-1].name == "Mischer":
        _condition(project)
        assert len(changed(data, sfc.dumps(project))) == 2


def test_an_object_of_an_unknown_kind_without_code_is_kept_and_counted() -> None:
    data = replaced(LIBRARIES, LIBRARIES[:-2] + b"ff")
    project = sfc.loads(data)
    (found,) = project.diagnostics
    assert (found.code, found.severity) == ("CEX103", sfc.Severity.WARNING)
    assert "27582ff (Library Manager)" in found.message
    assert sfc.dumps(project, format="codesys", partial=True)


GLOBAL_LIST, PERSISTENT_LIST = (b"ffbfa93a-b94d-45fc-a329-229860183b1d", b"261bd6e6-249c-4232-bb6f-84c2fbeef430")
PERSISTENT = (
    MIXER.read_bytes().replace(GLOBAL_LIST, PERSISTENT_LIST).replace(b">VAR_GLOBAL<", b">VAR_GLOBAL PERSISTENT RETAIN<")
)
FIRST_GLOBAL = b"    Start : BOOL; // Taster<"
OTHER_GLOBALS = re.findall(rb">( +(?:Voll|Leer|Ventil|Pumpe) : BOOL;)<", PERSISTENT)


def test_persistent_variables_are_a_list_of_global_variables() -> None:
    """They were counted among libraries and visualizations, and were missing in every conversion."""
    project = sfc.loads(PERSISTENT)
    assert "persistent" not in str(project.diagnostics)
    (section,) = project.global_variables
    assert (section.name, section.persistent, section.retain) == ("GVL", True, True)
    assert [each.name for each in section.variables] == [each.name for each in mixer().global_variables[0].variables]
    (converted,) = sfc.loads(sfc.dumps(project, format="codesys", partial=True)).global_sections()
    assert converted.persistent
    section.variables[0].comment = "other"
    assert len(changed(PERSISTENT, sfc.dumps(project))) == 2
    project.global_variables = []
    assert PERSISTENT_LIST not in sfc.dumps(project)


@pytest.mark.parametrize("path", ["Mischer.Werk.Runden", "Mischer.Werke[1].Runden"])
def test_paths_of_instances_among_persistent_variables_declare_nothing(path: str) -> None:
    """CODESYS writes them for persistent variables of instances, which their blocks declare."""
    mixed = PERSISTENT.replace(FIRST_GLOBAL, f"    {path} : BOOL; // Taster<".encode())
    project = sfc.loads(mixed)
    (found,) = [each for each in project.diagnostics if each.severity is sfc.Severity.ERROR]
    assert (found.code, "GVL is not read: it declares variables beside paths" in found.message) == ("CEX102", True)
    alone = mixed
    for line in OTHER_GLOBALS:
        alone = alone.replace(line, b"")
    project = sfc.loads(alone)
    (found,) = project.diagnostics
    assert (found.code, found.severity) == ("CEX103", sfc.Severity.WARNING)
    assert "1 of persistent variables (GVL)" in found.message
    project.rename("Mischer.Werk", "Motor")
    assert f"{path} : BOOL;".encode() in sfc.dumps(project)


def test_actions_in_a_folder_of_their_pou_are_read_and_edited_there() -> None:
    """They were in no conversion, and nothing told it."""
    data = MIXER.read_bytes().decode()
    start = data.index("<Single Type", data.index('Name="Name" Type="string">Application<') - 700)
    folder = data[start : data.index("Library Manager", start)].rsplit("<Single Type", 1)[0].rstrip()
    folder = folder.replace("639b491f-5557-464c-af91-1471bac9f549", "738bea1e-99bb-4f04-90bb-a7a567e74e3a")
    inside = "7a0c1d1e-0000-4000-8000-0000000000ff"
    own = data[data.index('Name="Guid"', start) :].split(">")[1].split("<")[0]
    work = "a2a167eb-7472-5675-910d-f51a3c752fa1"
    folder = folder.replace(own, inside).replace("00000000-0000-0000-0000-000000000000", work)
    folder = folder.replace("Application", "Zaehler_alle")
    data = data.replace(f'"ParentGuid" Type="System.Guid">{work}', f'"ParentGuid" Type="System.Guid">{inside}', 1)
    whole = f"{data[:start]}{folder}\r\n    {data[start:]}".encode()
    project = sfc.loads(whole)
    assert [found.code for found in project.diagnostics] == ["CEX103"]
    assert [action.name for action in project.pou("Ruehrwerk").actions] == ["Zaehlen"]
    _action(project)
    assert len(changed(whole, sfc.dumps(project))) == 2
    del project.pous[0]
    rest = sfc.dumps(project)
    assert b"Zaehler_alle" not in rest
    assert b"Umdrehung" not in rest


TASK_FOLDER = '        <Single Type="string">Task Configuration</Single>'
LACKING = {
    "a body": ('Name="Implementation" Type="{74f81948', 'Name="Body" Type="{74f81948', "TWC108", "Mischer"),
    "a text": ('Name="TextBlobForSerialisation"', 'Name="Blob"', "CEX105", "the text"),
    "a line of a text": ('<Single Name="Text"', '<Single Name="Txt"', "CEX105", "the text"),
    "a number for each line": (
        '<Single Name="Id" Type="long">4</Single>',
        '<Single Name="Id" Type="long">3</Single>',
        "CEX105",
        "a number of its own for each line",
    ),
    "a name": ('Name="Name" Type="string">Zaehlen', 'Name="Nam" Type="string">Zaehlen', "CEX105", "Name"),
    "an identity": ('<Single Name="Guid"', '<Single Name="Gid"', "CEX105", "Guid"),
    "the programs of a task": ('Name="PouList"', 'Name="Pous"', "CEX105", "PouList"),
    "a list of attributes": ('Name="Attributes"', 'Name="Attribute"', "TWC101", "attributes"),
    "an enabled watchdog": ('Name="Enabled"', 'Name="Enable"', "CEX105", "Watchdog Enabled"),
    "a truth of a watchdog": (
        '"bool">False</Single>\r\n          <Single Name="Time"',
        '"bool">N</Single>\r\n          <Single Name="Time"',
        "CEX105",
        "True or False as Watchdog Enabled",
    ),
    "the time of a watchdog": (
        '<Single Name="Time" Type="string"></',
        '<Single Name="Tim" Type="string"></',
        "CEX105",
        "Watchdog Time Time",
    ),
    "the sensitivity of a watchdog": ('Name="Sensitivity"', 'Name="Sensitive"', "CEX105", "Watchdog Sensitivity"),
    "a whole watchdog": ('Name="Watchdog"', 'Name="Guard"', "CEX105", "Watchdog Enabled"),
    "the event of a task": ('Name="Event"', 'Name="Evt"', "CEX105", "Event"),
    "a priority": (
        'Name="Priority" Type="string">1<',
        'Name="Priority" Type="string">I<',
        "CEX105",
        "a number as Priority",
    ),
    "the way to a task": (f"{TASK_FOLDER}\r\n      </Array>", "</Array>", "CEX105", "the Path to it"),
    "the right way to a task": (TASK_FOLDER, TASK_FOLDER.replace("Task ", "Tsk "), "CEX105", "the Path to it"),
    "content of its kind": ('Name="Object" Type="{6f9', 'Name="Object" Type="{6f8', "CEX105", "Object of its kind"),
    "a part of an archive": ("<Null Name=", "<Nul Name=", "CEX102", "nothing that an archive holds"),
}


@pytest.mark.parametrize("what", LACKING)
def test_what_an_object_lacks_is_an_error(what: str) -> None:
    """Its value was empty then, and the file was converted without a word."""
    old, new, code, words = LACKING[what]
    data = MIXER.read_bytes().decode()
    start = data.index("{74f81948") if what == "a part of an archive" else 0
    assert old in data[start:]
    damaged = data[:start] + data[start:].replace(old, new, 1)
    project = sfc.loads(damaged.encode())
    found = [each for each in project.diagnostics if each.code == code and words in each.message]
    assert found, project.diagnostics
    assert all(each.severity is sfc.Severity.ERROR and each.location.line for each in found)
    with pytest.raises(sfc.DamagedSourceError):
        sfc.dumps(project, format="codesys", partial=True)
    assert sfc.dumps(project) == damaged.encode()


def test_it_comes_back_byte_for_byte_and_is_written_from_the_model_as_it_was() -> None:
    project = mixer()
    assert sfc.dumps(project) == MIXER.read_bytes()
    assert sfc.dumps(project, fresh=True) == MIXER.read_bytes()


def _condition(project: Project) -> None:
    chart_of(project).transitions[0].condition = 'Start AND "Wort" < 3'


def _step(project: Project) -> None:
    chart_of(project).rename_step("Pumpen", "Leeren")


def _variable(project: Project) -> None:
    project.pou("Ruehrwerk").variables()[0].comment = "läuft"


def _statement(project: Project) -> None:
    action = project.pou("Ruehrwerk").actions[0]
    action.body = StBody(text="Runden := Runden + 2;")


def _list(project: Project) -> None:
    project.global_variables[0].variables[0].comment = "Taster"


def _task(project: Project) -> None:
    project.applications[0].tasks[0].interval = "T#50ms"


def _priority(project: Project) -> None:
    project.applications[0].tasks[0].priority = 7


def _action(project: Project) -> None:
    project.pou("Ruehrwerk").actions[0].name = "Umdrehung"


@pytest.mark.parametrize("edit", [_condition, _step, _variable, _statement, _list, _task, _priority, _action])
def test_an_edit_changes_its_line(edit: Callable[[Project], None]) -> None:
    project = mixer()
    edit(project)
    data = sfc.dumps(project)
    assert len(changed(MIXER.read_bytes(), data)) in (0, 2)
    back = sfc.loads(data)
    assert [pou.model_dump() for pou in back.pous] == [pou.model_dump() for pou in project.pous]
    assert back.global_variables == project.global_variables


def test_a_line_that_is_put_in_gets_a_number_and_the_others_keep_theirs() -> None:
    project = mixer()
    body = project.pou("Ruehrwerk").body
    assert isinstance(body, StBody)
    body.text = f"// neu\n{body.text}"
    lines = changed(MIXER.read_bytes(), sfc.dumps(project))
    assert [line for line in lines if line[0] == "-"] in ([], [lines[0]])
    assert '+<Single Name="Text" Type="string">// neu</Single>' in lines
    assert sum('Name="Id"' in line for line in lines) == 1


def test_objects_are_put_in_and_taken_out_with_what_is_in_them() -> None:
    project = mixer()
    project.pous.append(Pou(name="Neu", kind=PouKind.FUNCTION_BLOCK))
    project.pou("Mischer").actions.append(Action(name="Spuelen", body=StBody(text="Ventil := TRUE;")))
    project.pou("Mischer").transitions.append(NamedTransition(name="Satt", body=StBody(text="Voll")))
    data = sfc.dumps(project)
    assert all(line.startswith("+") for line in changed(MIXER.read_bytes(), data))
    back = sfc.loads(data)
    assert [pou.name for pou in back.pous] == ["Ruehrwerk", "Mischer", "Neu"]
    assert [action.name for action in back.pou("Mischer").actions] == ["Zaehler", "Spuelen"]
    assert [each.name for each in back.pou("Mischer").transitions] == ["Abbruch", "Satt"]
    del back.pous[0]
    rest = sfc.dumps(back)
    assert b"Ruehrwerk</Single>" not in rest
    assert b"Laeuft" not in rest  # its property
    assert b"Library Manager" in rest


def test_a_property_that_is_gone_is_taken_out_with_its_accessors() -> None:
    project = mixer()
    data = project.pou("Ruehrwerk").extension_data
    assert data is not None
    data.data = [each for each in data.data if "Laeuft" not in each.content]
    saved = sfc.dumps(project)
    assert b"Laeuft" not in saved
    assert all(line.startswith("-") for line in changed(MIXER.read_bytes(), saved))


def test_a_rename_changes_the_code_of_properties() -> None:
    project = mixer()
    assert project.rename("Ruehrwerk.Motor", "Antrieb").undecided == ()
    lines = [line for line in changed(MIXER.read_bytes(), sfc.dumps(project)) if line.startswith("+")]
    assert '+<Single Name="TextBlobForSerialisation" Type="string">Laeuft := Antrieb;</Single>' in lines
    assert len(lines) == 3


def test_a_renamed_pou_is_renamed_in_the_paths_of_what_is_in_it() -> None:
    project = mixer()
    project.rename("Mischer", "Ansetzen")
    lines = [line for line in changed(MIXER.read_bytes(), sfc.dumps(project)) if line.startswith("+")]
    assert lines.count('+<Single Type="string">Ansetzen</Single>') == 2
    assert '+<Single Name="Name" Type="string">Ansetzen</Single>' in lines


def test_a_step_that_is_put_in_changes_no_other_element() -> None:
    project = mixer()
    chart = chart_of(project)
    transition = chart.transitions[0]
    chart.steps.append(Step(id=10_000, name="Spuelen"))
    chart.transitions.append(Transition(id=10_001, sources=[10_000], targets=transition.targets, condition="Voll"))
    transition.targets = [10_000]
    data = sfc.dumps(project)
    assert len([line for line in changed(MIXER.read_bytes(), data) if line.startswith("-")]) <= 1
    assert {step.name for step in chart_of(sfc.loads(data)).steps} == {step.name for step in chart.steps}


def test_the_same_chart_in_a_file_of_twincat_is_the_same_model() -> None:
    source = sfc.load(BELT)
    export = sfc.loads(sfc.dumps(source, format="codesys-export"))
    back = sfc.loads(sfc.dumps(export, format="twincat"))
    assert b"SFCMacro" in sfc.dumps(back)
    for other in (export, back):
        one, two = source.pous[0].chart, other.pous[0].chart
        assert one is not None
        assert two is not None
        assert one.model_dump(exclude={"drawing"}) == two.model_dump(exclude={"drawing"})


@pytest.mark.slow
def test_tasks_of_another_tool_are_not_executed_and_said_so(tmp_path: Path) -> None:
    project = sfc.load(FIXTURES / "codesys" / "distribution_belt.xml")
    report = sfc.save(project, tmp_path / "belt.export", format="codesys-export", partial=True)
    missing = report.with_outcome(Outcome.NOT_EXECUTED)
    assert {item.path for item in missing} == {"task MainTask", "task Visu"}
    written = (tmp_path / "belt.export").read_bytes()
    assert written.startswith(b'<ExportFile>\r\n  <StructuredView Guid="{21af')
    assert b"\n" not in written.replace(b"\r\n", b"")
    back = sfc.load(tmp_path / "belt.export")
    assert [pou.name for pou in back.pous] == [pou.name for pou in project.pous]
    with pytest.raises(SfcError, match="not be executed"):
        sfc.save(project, tmp_path / "again.export", format="codesys-export")


def test_charts_of_another_tool_are_told_once_to_be_unverified() -> None:
    program = "PROGRAM {}\nVAR go : BOOL; END_VAR\n{}END_PROGRAM\n"
    chart = "INITIAL_STEP A: END_STEP\nTRANSITION FROM A TO B := go; END_TRANSITION\nSTEP B: END_STEP\n"
    chart += "TRANSITION FROM B TO A := NOT go; END_TRANSITION\n"
    for bodies, told in (([chart, chart], 1), (["go := TRUE;\n"], 0)):
        text = "".join(program.format(f"P{number}", body) for number, body in enumerate(bodies))
        data, report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "codesys-export")
        found = [item for item in report.items if "unverified" in item.why]
        assert [(item.outcome, item.path) for item in found] == [(Outcome.TRANSLATED, "project")] * told
        written = sfc.loads(data)
        written.pous[0].comment = "new"
        assert "unverified" not in str(sfc.convert(written).report.items)  # an edit of a file is no conversion


def test_drawn_bodies_stay_as_they_are() -> None:
    data = MIXER.read_bytes()
    start = data.index(b"{3b83b776", data.index(b'Name="SpecialFunc"'))
    drawn = data[:start] + b"{25e509de-33d4-4447-93f8-c9e4ea381c8b}" + data[start + 38 :]
    project = sfc.loads(drawn)
    assert [found.code for found in project.diagnostics] == ["TWC104", "CEX103"]  # by line
    assert sfc.dumps(project) == drawn
    _condition(project)
    assert len(changed(drawn, sfc.dumps(project))) == 2


NUMBER = """"long">1</Single>\r
                  <Single Name="IdParent" Type="long">23<"""
DAMAGED = {
    "an element of an unknown type": ("{86ee92a2", "{06ee92a2", "TWC102", "06ee92a2"),
    "a number that two elements have": (NUMBER, NUMBER.replace(">1<", ">0<"), "SFC101", "number 0"),
    "an element without a type": (
        '<Single Type="{4ecb29e8-a90a-4646-84ac-2ff54215ab29}" Method',
        "<Single Method",
        "TWC102",
        "type nothing",
    ),
    "an attribute of the wrong type": (
        '"string">P</Single>',
        '"long">7</Single>',
        "TWC102",
        "no text in quotes, but 7",
    ),
    "an unknown attribute": ("38391c6d", "08391c6d", "TWC102", "08391c6d"),
    "a jump to nowhere": ("Bereit</Single>", "Nirgends</Single>", "SFC103", "Bereit"),
    "a declaration that does not parse": ("Wasser : REAL := 12.5;", "Wasser : REAL := ;", "IEC", ""),
    "an object without a declaration": (
        'Name="Interface" Type="{a9ed',
        'Name="Other" Type="{a9ed',
        "CEX102",
        "Ruehrwerk",
    ),
}


@pytest.mark.parametrize("damage", DAMAGED)
def test_damage_is_told_at_its_place_and_the_rest_is_read(damage: str) -> None:
    old, new, code, words = DAMAGED[damage]
    data = MIXER.read_bytes()
    assert old.encode() in data
    project = sfc.loads(data.replace(old.encode(), new.encode(), 1))
    found = [each for each in project.diagnostics if each.code.startswith(code) and words in each.message]
    assert found, project.diagnostics
    assert all(each.location.line for each in found)
    assert {pou.name for pou in project.pous} | {declared.name for declared in project.data_types} >= {"Mischer"}
    assert project.global_variables


def test_an_identity_that_two_objects_have_is_told() -> None:
    data = MIXER.read_bytes().decode()
    first, second = (part.split("<")[0] for part in data.split('Name="Guid" Type="System.Guid">')[1:3])
    project = sfc.loads(data.replace(second, first).encode())
    (found,) = [each for each in project.diagnostics if each.code == "CEX104"]
    assert found.location.line
    assert len(project.pous) == 2


def test_new_objects_have_no_identity_of_what_had_their_names() -> None:
    """The identity of a new object is made of its name, and stays with it when it is renamed."""
    project = sfc.load(MIXER)
    found = [each.code for each in project.diagnostics]
    for _ in range(2):
        code = "FUNCTION_BLOCK New VAR x : INT; END_VAR x := 1; ACTION A: x := 2; END_ACTION END_FUNCTION_BLOCK"
        made = sfc.loads(f"TYPE T : INT; END_TYPE VAR_GLOBAL g : T; END_VAR {code}".encode(), format="iec-text")
        made.global_variables[0].name = "Values"
        for pou in project.pous:
            pou.actions += [each for each in made.pous[0].model_copy(deep=True).actions if pou.name == "Old"]
        project.pous.append(made.pous[0])
        project.data_types += made.data_types
        project.global_variables += made.global_variables
        again = sfc.loads(sfc.dumps(project, partial=True))
        assert [each.code for each in again.diagnostics] == found
        assert str(sfc.diff(project, again)) == "no differences"
        project = again
        if not any(pou.name == "Old" for pou in project.pous):
            project.rename_many({"New": "Old", "New.A": "B", "T": "U", "Values": "Former", "Values.g": "h"})
    assert [action.name for pou in project.pous if pou.name == "Old" for action in pou.actions] == ["B", "A"]


ENTRY = b'    <Single Type="{6198ad31'
"""Start of each entry of the file."""
NAME = b'<Single Name="Name" Type="string">'


@pytest.mark.parametrize(("damage", "keeps_rest"), [(b"", False), (b"<x", True), (b"&", True), (b"\xff", True)])
@pytest.mark.parametrize("whole", [1, 3, 10])
def test_of_a_damaged_file_the_whole_objects_before_that_place_are_read(
    whole: int, damage: bytes, keeps_rest: bool
) -> None:
    """It was refused whole, where files in other formats break off and the rest of the project is loaded."""
    data = MIXER.read_bytes()
    parts = data.split(ENTRY)
    begin = ENTRY.join(parts[: whole + 1])
    place = data.index(NAME, len(begin)) + len(NAME)
    broken = data[:place] + damage + (data[place:] if keeps_rest else b"")
    project = sfc.loads(broken)
    (found,) = [each for each in project.diagnostics if each.severity is sfc.Severity.ERROR]
    assert (found.code, found.location.line) == ("CEX106", data[:place].count(b"\n") + 1)
    known = mixer()
    names = re.findall(NAME + rb"([^<]+)", begin)
    for got, all_of_them in ((project.pous, known.pous), (project.data_types, known.data_types)):
        assert [each.name for each in got] == [each.name for each in all_of_them if each.name.encode() in names]
    assert f"nothing behind {names[-1].decode()} is read" in found.message
    assert sfc.dumps(project) == broken
    with pytest.raises(sfc.DamagedSourceError, match="CEX106"):
        sfc.dumps(project, format="codesys", partial=True)
    with pytest.raises(SfcError, match="edits cannot be put into a file that is not read to its end") as refused:
        sfc.dumps(project, fresh=True, partial=True)
    assert refused.value.location.line == found.location.line
    project.pous[0].comment = "edited"
    with pytest.raises(SfcError, match="edits cannot be put into"):
        sfc.dumps(project, partial=True)
    project.accept_errors()
    converted = sfc.convert(project, "codesys", partial=True)
    assert [each.name for each in sfc.loads(converted.data).pous] == [each.name for each in project.pous]
    assert any("CEX106" in item.why for item in converted.report.items)


def test_a_file_without_a_whole_object_is_refused_with_its_place() -> None:
    data = MIXER.read_bytes()
    with pytest.raises(XmlSyntaxError) as refused:
        sfc.loads(data[: data.index(ENTRY) + 1000])
    assert refused.value.location.line
    with pytest.raises(StructureError, match="EntryList") as empty:
        sfc.loads(b"<ExportFile><StructuredView/></ExportFile>")
    assert "Project > Export" in empty.value.hint


ELEMENTS = list(etree.fromstring(MIXER.read_bytes()).iter("Single", "List2", "Dictionary2", "Null"))


@settings(max_examples=10, deadline=None)
@given(number=st.integers(0, len(ELEMENTS) - 1))
def test_a_file_without_one_of_its_elements_is_read_or_refused(number: int) -> None:
    root = etree.fromstring(MIXER.read_bytes())
    element = list(root.iter("Single", "List2", "Dictionary2", "Null"))[number]
    parent = element.getparent()
    assert parent is not None
    parent.remove(element)
    data = etree.tostring(root)
    try:
        project = sfc.loads(data)
    except SfcError as error:
        assert error.location.line  # noqa: PT017  # either is right
        return
    assert sfc.dumps(project) == data


@pytest.mark.slow
@settings(max_examples=3, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(project=projects())
def test_random_models_come_back(project: Project) -> None:
    written = sfc.dumps(project, format="codesys-export", partial=True)
    assert sfc.dumps(sfc.loads(written)) == written


def test_a_drawn_named_condition_without_a_text_is_told_once() -> None:
    text = b"""PROGRAM Main VAR_INPUT a : BOOL; END_VAR
    INITIAL_STEP S0: END_STEP
    TRANSITION FROM S0 TO S0 := a; END_TRANSITION
    END_PROGRAM"""
    project = sfc.loads(text, format="iec-text")
    project.dialect = m.Dialect.CODESYS
    wires = [{"input": {"connections": [{"source": number}]}} for number in (1, 2)]
    nodes = [
        {"id": 1, "kind": "leftPowerRail", "outputs": [{"name": ""}]},
        {"id": 2, "kind": "contact", "variable": "a", "edge": "rising", "output": {}, **wires[0]},
        {"id": 3, "kind": "coil", "variable": "Go", "output": {}, **wires[1]},
        {"id": 4, "kind": "rightPowerRail", "inputs": [{"connections": [{"source": 3}]}]},
    ]
    body = m.LdBody.model_validate({"networks": [{"nodes": nodes}]})
    project.pous[0].transitions.append(m.NamedTransition(name="Go", body=body))
    project.pous[0].body.chart.transitions[0].condition = m.NamedCondition(name="Go")
    report = sfc.convert(project, "codesys-export", partial=True).report
    (item,) = report.with_outcome(sfc.Outcome.NOT_EXECUTED)
    assert (item.what, item.path) == ("body", "POU Main / transition Go")
    assert "the undeclared name body_is_not_written is in its place" in item.why


def test_a_type_may_have_the_name_of_a_pou() -> None:
    """Both got one identity, and the file could not be read back."""
    text = b"TYPE A : STRUCT x : INT; END_STRUCT; END_TYPE\nPROGRAM A\nVAR a : BOOL; END_VAR\na := TRUE;\nEND_PROGRAM\n"
    data = sfc.dumps(sfc.loads(text, format="iec-text"), format="codesys-export")
    project = sfc.loads(data)
    assert not project.diagnostics
    assert sfc.dumps(project, format="codesys-export", fresh=True) == data


def test_a_pou_of_a_file_that_draws_loops_as_wires_is_copied() -> None:
    project = sfc.load(FIXTURES / "codesys-export" / "mixer.export")
    project.edit().copy_pou(sfc.load(FIXTURES / "plcopen" / "filling_station_2.01.xml"), "CapStation")
    assert not sfc.diff(project, sfc.loads(sfc.dumps(project))).changes
