"""Values that no file can have are refused when they are assigned, or at the latest when they are saved."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model
from plcopen_sfc.errors import LossError

FIXTURES = Path(__file__).resolve().parents[2] / "fixtures"
CONVEYOR = FIXTURES / "codesys" / "sorting_conveyor.xml"


def project(change: Callable[[sfc.SfcNetwork], object] = lambda chart: None) -> sfc.Project:
    chart = sfc.SfcNetwork()
    chart.add_step("Wait", initial=True)
    chart.add_step("Fill")
    chart.add_transition("Wait", "Fill", "x")
    chart.add_transition("Fill", "Wait", "NOT x")
    change(chart)
    return sfc.Project(pous=[sfc.Pou(name="Main", kind="program", bodies=[sfc.SfcBody(chart=chart)])])


@pytest.mark.parametrize("time", [
        "5 s", "5s", "5", "", "T#5", "soon enough", "T#5s later",
        "nope+", "* 2", "tMax *", "tMax * / 2", "(tMax", "tMax)", "t[1", "NOT", "tMax AND", "()", "MAX(a,", "t.",
    ],
)  # fmt: skip
def test_a_time_that_is_none_is_refused_where_it_is_assigned(time):
    step = project().pou("Main").chart.step("Fill")
    step.max_time = "T#1s"
    for name in ("min_time", "max_time", "warning_time"):
        with pytest.raises(sfc.ModelError, match=re.escape(f"{name} of Step 'Fill' cannot be '{time}'")):
            setattr(step, name, time)
    assert step.max_time == "T#1s"
    action = sfc.ActionAssociation(id=7, qualifier="L", target="Valve")
    with pytest.raises(sfc.ModelError, match="duration"):
        action.duration = time


@pytest.mark.parametrize(
    "time",
    ["T#5s", "t#1h2m3s4ms", "TIME#2.5s", "LTIME#1us", "S5T#10s", "T#-1s", "tMax", "#tMax", '"DB".tMax', "a.b[3].t",
     "tMax * 2", "MAX(a, T#1s)", "-tMax", "(a + b) * -2", "a ** 2", "p^.t", "f()", "SEL(G := NOT x, IN0 := a)",
     "DINT_TO_TIME(n)", "T#1s (* set *)", "%MD10", None],
)  # fmt: skip
def test_durations_and_expressions_are_times(time):
    step = project().pou("Main").chart.step("Fill")
    step.max_time = time
    assert step.max_time == time


@pytest.mark.parametrize("format", ["plcopen", "codesys", "simaticml", "iec-text", "json"])
@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda c: c.steps.append(sfc.Step(id=0, name="Drain")), "the id 0 belongs to another object"),
        (lambda c: c.transitions.append(sfc.Transition(id=1)), "the id 1 belongs to another object"),
        (lambda c: c.steps.append(sfc.Step(id=9, name="Drain", max_time="5 s")), "step Drain: the max time '5 s'"),
        (
            lambda c: c.steps[0].actions.append(sfc.ActionAssociation(id=9, target="x", duration="a b")),
            "step Wait: the duration 'a b' cannot be saved",
        ),
        (lambda c: setattr(c.steps[0], "name", "FILL"), "step FILL: another step of the chart is called FILL too"),
    ],
)  # fmt: skip
def test_what_a_script_built_wrong_is_refused_when_it_is_saved(tmp_path, format, change, message):
    with pytest.raises(sfc.ModelError, match=message):
        sfc.save(project(change), tmp_path / "out.xml", format=format, partial=True)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("format", ["plcopen", "codesys"])
@pytest.mark.parametrize("name", ["Fill 2", "2Fill", "IF", "Fill-2", ""])
def test_a_name_that_the_target_cannot_have_is_refused(format, name):
    with pytest.raises(sfc.ModelError, match=r"is no name|is a keyword") as caught:
        sfc.dumps(project(lambda chart: setattr(chart.steps[1], "name", name)), format=format)
    assert caught.value.location.path == f"POU Main / step {name}"
    other = project()
    other.pous[0].name = name
    with pytest.raises(sfc.ModelError, match=r"is no name|is a keyword"):
        sfc.dumps(other, format=format)


def declared(kind: str, name: str) -> sfc.Project:
    """A project that declares one more thing with a name."""
    made = project()
    flag = model.Variable(name="x" if kind in ("type", "data block") else name, type=model.ElementaryType(name="BOOL"))
    section = model.VariableSection(kind="global", name="GVL", variables=[flag])
    match kind:
        case "type":
            made.data_types.append(model.DataTypeDeclaration(name=name, type=model.StructType(members=[flag])))
        case "member":
            made.data_types.append(model.DataTypeDeclaration(name="T_Set", type=model.StructType(members=[flag])))
        case "value":
            enumeration = model.EnumType(values=[model.EnumValue(name=name)])
            made.data_types.append(model.DataTypeDeclaration(name="T_Mode", type=enumeration))
        case "global variable":
            made.global_variables.append(section)
        case "data block":
            made.data_blocks.append(model.DataBlock(name=name))
        case "variable":
            made.pous[0].interface = model.Interface(sections=[model.VariableSection(kind="local", variables=[flag])])
    return made


@pytest.mark.parametrize("kind", ["type", "member", "value", "global variable", "variable"])
@pytest.mark.parametrize("format", ["plcopen", "codesys"])
@pytest.mark.parametrize("name", ["Fill 2", "IF", ""])
def test_every_declared_name_is_checked(kind, format, name):
    with pytest.raises(sfc.ModelError, match=r"is no name|is a keyword") as caught:
        sfc.dumps(declared(kind, name), format=format, partial=True)
    assert caught.value.location.path.endswith(f"{kind} {name}")


@pytest.mark.parametrize("kind", ["type", "member", "value", "global variable", "data block", "variable"])
@pytest.mark.parametrize("name", ["", 'Fill "2"', "Fill\n2"])
def test_a_name_that_tia_portal_cannot_have_is_refused(kind, name):
    with pytest.raises(sfc.ModelError, match=r"is no name|is empty") as caught:
        sfc.dumps(declared(kind, name), format="simaticml", partial=True)
    assert caught.value.location.path.endswith(f"{kind} {name}")


def test_the_interval_of_a_task_is_a_duration_or_an_expression():
    task = model.Task(name="Fast", interval="T#10ms")
    for wrong in ("10 ms", "", "soon enough"):
        with pytest.raises(sfc.ModelError, match="interval of Task 'Fast' cannot be"):
            task.interval = wrong
    for right in ("PT0.01S", "10ms", "00:00:01", "T#1h", "tSlow"):
        task.interval = right
    made = project()
    made.applications = [model.Resource(name="App", tasks=[task, model.Task(name="Slow", interval="10 ms")])]
    with pytest.raises(sfc.ModelError, match="task Slow: the interval '10 ms' cannot be saved"):
        sfc.dumps(made, format="plcopen", partial=True)


def test_names_in_quotes_are_names_of_tia_portal_and_get_others_elsewhere():
    data = sfc.dumps(project(lambda chart: setattr(chart.steps[1], "name", "Fill 2")), format="simaticml", partial=True)
    there = sfc.loads(data)
    assert there.pous[0].chart.step("Fill 2")
    assert sfc.loads(sfc.dumps(there, format="codesys")).pous[0].chart.step("Fill_2")


def test_what_the_file_had_already_does_not_keep_an_edit_from_being_saved():
    data = CONVEYOR.read_bytes().replace(b">T#3s<", b">3 s<")
    loaded = sfc.loads(data)
    chart = loaded.pou("PLC_PRG").chart
    assert chart.step("Measure").max_time == "3 s"
    chart.step("Idle").max_time = "T#7s"
    again = sfc.loads(sfc.dumps(loaded)).pou("PLC_PRG").chart
    assert (again.step("Measure").max_time, again.step("Idle").max_time) == ("3 s", "T#7s")
    chart.steps.append(sfc.Step(id=chart.new_id(), name="New", max_time="4 s"))
    with pytest.raises(sfc.ModelError, match="step New: the max time '4 s'"):
        sfc.dumps(loaded)


def test_steps_of_one_name_that_the_file_had_do_not_keep_their_program_from_being_renamed():
    data = sfc.dumps(project(), format="plcopen").replace(b'name="Fill"', b'name="Wait"')
    loaded = sfc.loads(data)
    loaded.edit().rename("Main", "Other")
    again = sfc.loads(sfc.dumps(loaded)).pou("Other").chart
    assert [step.name for step in again.steps] == ["Wait", "Wait"]
    loaded.pou("Other").chart.add_step("New").name = "Wait"
    loaded.pous.append(sfc.Pou(name="More", kind="program", bodies=[sfc.SfcBody(chart=sfc.SfcNetwork())]))
    loaded.pou("More").chart.steps = [sfc.Step(id=number, name="Twice") for number in range(2)]
    with pytest.raises(sfc.ModelError, match="POU More / step Twice: another step"):
        sfc.dumps(loaded)


@pytest.mark.parametrize("kind", ["type", "member", "value", "global variable", "variable"])
@pytest.mark.parametrize(
    ("format", "odd"), [("plcopen", b"Odd Name"), ("codesys", b"Odd Name"), ("simaticml", b"Odd &quot;Name")]
)
def test_names_that_the_file_had_already_do_not_keep_an_edit_from_being_saved(kind, format, odd):
    data = sfc.dumps(declared(kind, "Odd_Name"), format=format, partial=True).replace(b"Odd_Name", odd)
    loaded = sfc.loads(data)
    loaded.read_all()
    loaded.pou("Main").chart.step("Fill").name = "Empty"
    again = sfc.loads(sfc.dumps(loaded))
    assert again.pou("Main").chart.step("Empty")
    assert again == loaded


def _of_project(made, text):
    made.comment = text


def _of_pou(made, text):
    made.pou("Main").comment = text


def _of_condition(made, text):
    made.pou("Main").chart.transitions[0].condition = sfc.Expression(text=text)


@pytest.mark.parametrize("put", [_of_project, _of_pou, _of_condition])
@pytest.mark.parametrize("character", ["\x00", "\x0b", "\x1f", "\ufffe", "\ud800"])
def test_a_character_that_no_file_of_the_target_can_hold_is_refused(put, character):
    """It was left out of XML without a word, and lone surrogates ended with an error of Python."""
    made = project()
    put(made, f"a{character}b")
    for format in ("plcopen", "codesys", "simaticml", "xlsx"):
        with pytest.raises(sfc.ModelError, match=f"the character U\\+{ord(character):04X}, which XML cannot hold"):
            sfc.dumps(made, format=format)
    for format in ("iec-text", "scl", "json"):
        if character == "\ud800":
            with pytest.raises(sfc.ModelError, match=r"the character U\+D800, which a file cannot hold"):
                sfc.dumps(made, format=format)
    if character != "\ud800":
        assert sfc.loads(sfc.dumps(made, format="json")) == made


@pytest.mark.parametrize("put", [_of_project, _of_pou, _of_condition])
def test_a_surrogate_that_an_edit_puts_in_is_refused(put):
    loaded = sfc.loads(sfc.dumps(project(), format="iec-text"))
    put(loaded, "a\ud800b")
    for format in ("iec-text", "json", "codesys"):
        with pytest.raises(sfc.ModelError, match=r"the character U\+D800"):
            sfc.dumps(loaded, format=format)


def test_a_control_character_of_a_text_file_is_not_left_out_of_xml():
    text = b"PROGRAM Main\nVAR x : BOOL; END_VAR\n(* page \x0c two *)\nx := TRUE;\nEND_PROGRAM\n"
    loaded = sfc.loads(text, format="iec-text")
    assert sfc.dumps(loaded) == text
    with pytest.raises(sfc.ModelError, match=r"POU Main: .* the character U\+000C, which XML cannot hold"):
        sfc.convert(loaded, "codesys")


LONG = "1" * 5000


@pytest.mark.parametrize("place", ["localId", "refLocalId", "executionOrderId"])
def test_a_number_of_thousands_of_digits_is_no_number_of_a_file(place):
    data = (FIXTURES / "plcopen" / "filling_station_2.01.xml").read_bytes()
    edited = re.sub(rf'\b{place}="\d+"'.encode(), f'{place}="{LONG}"'.encode(), data, count=1)
    loaded = sfc.loads(edited)
    assert sfc.dumps(loaded) == edited


@pytest.mark.slow
@pytest.mark.parametrize("text", [LONG, f"16#{LONG}", f"T#{LONG}s", f"TOD#{LONG}:00", f"%IW{LONG}", "1.0E400"])
def test_a_number_that_no_type_can_have_is_named(text):
    made = project()
    made.pou("Main").chart.transitions[0].condition = sfc.Expression(text=f"x > {text}")
    assert sfc.convert(made, "simaticml", partial=True).data
    with pytest.raises(sfc.SimulationError):
        sfc.simulate(made, scans=2)
    with pytest.raises(sfc.SfcError):
        sfc.lower(made)


def test_json_that_python_cannot_read_is_no_model():
    data = sfc.dumps(project(), format="json")
    with pytest.raises(sfc.FormatError, match="digits"):
        sfc.loads(data.replace(b'"version": 1', b'"version": ' + LONG.encode()), format="json")
    with pytest.raises(sfc.FormatError, match=r"U\+D800 alone is no character"):
        sfc.loads(data.replace(b'"Fill"', b'"Fill\\ud800"'), format="json")


def test_a_source_whose_name_is_followed_by_anything_is_an_error_at_its_place():
    loaded = sfc.loads(b"FUNCTION_BLOCK FB10 VERSION : TASK\nEND_FUNCTION_BLOCK\n", format="scl")
    assert loaded.diagnostics
    with pytest.raises(sfc.SfcError):
        sfc.convert(loaded, "codesys")


@pytest.mark.slow
def test_a_file_that_was_changed_since_it_was_read_is_not_overwritten(tmp_path):
    path = tmp_path / "conveyor.xml"
    path.write_bytes(CONVEYOR.read_bytes())
    loaded = sfc.load(path)
    loaded.pou("PLC_PRG").chart.steps[0].comment = "first"
    sfc.save(loaded, path)
    loaded.pou("PLC_PRG").chart.steps[0].comment = "second"
    sfc.save(loaded, path)  # what it has written itself is its own
    by_another = path.read_bytes() + b"\n"
    path.write_bytes(by_another)
    with pytest.raises(sfc.FileAccessError, match="was changed since the project was read"):
        sfc.save(loaded, path)
    assert path.read_bytes() == by_another
    sfc.save(loaded, tmp_path / "other.xml")
    path.unlink()
    sfc.save(loaded, path)
    assert sfc.load(path).pou("PLC_PRG").chart.steps[0].comment == "second"


def test_an_edit_that_the_tool_does_not_execute_is_refused_in_its_own_format() -> None:
    """The writer keeps the negation beside, and this package reads it again: TIA Portal would run the plain action."""
    edited = sfc.load(FIXTURES / "simaticml" / "FB_Drill.xml")
    assert sfc.convert(edited, "simaticml").report.unchanged
    next(step for step in next(edited.charts()).chart.steps if step.actions).negated = True
    with pytest.raises(sfc.LossError) as raised:
        sfc.convert(edited, "simaticml")
    assert {(item.outcome, item.what) for item in raised.value.report.losses} == {
        (sfc.Outcome.NOT_EXECUTED, "action"),
        (sfc.Outcome.NOT_EXECUTED, "negation"),
    }


@pytest.mark.parametrize(
    "name",
    ["simaticml/FB_Drill.xml", "codesys-export/mixer.export", "codesys23/distribution_belt.EXP", "scl/filling_line.scl",
     "twincat-belt/POUs/PLC_PRG.TcPOU", "twincat/press_station.xml", "grafcet/belt.gct", "iectext/mixing_plant.st"],
)  # fmt: skip
def test_an_edit_beside_the_objects_comes_back_or_is_told(name: str) -> None:
    """The header and the data of a project itself: files of single objects have no place for them."""
    for change in ("header", "data"):
        project = sfc.load(FIXTURES / name)
        if change == "header":
            project.header.company = "ACME"
        else:
            project.extension_data = model.ExtensionData(data=[model.ForeignData(name="urn:of-a-script", content="")])
        assert project.source is not None
        data, report = sfc.convert(project, project.source.format, partial=True)
        back = sfc.loads(data, format=project.source.format)
        comes_back = (back.header.company, back.extension_data) == (project.header.company, project.extension_data)
        assert comes_back != any(item.outcome == "dropped" for item in report.items)


@pytest.mark.parametrize("name", ["simaticml-plc", "twincat-belt"])
def test_an_edit_beside_the_objects_of_a_folder_comes_back_or_is_told(name: str, tmp_path: Path) -> None:
    for change in ("header", "data"):
        folder = tmp_path / change
        shutil.copytree(FIXTURES / name, folder)
        edited = sfc.load(folder)
        if change == "header":
            edited.header.created = "2031-05-06T07:08:09Z"
        else:
            edited.extension_data = model.ExtensionData(data=[model.ForeignData(name="urn:of-a-script", content="")])
        report = sfc.save(edited, folder)
        back = sfc.load(folder)
        comes_back = (back.header.created, back.extension_data) == (edited.header.created, edited.extension_data)
        assert comes_back != any(item.outcome == "dropped" for item in report.items)


@pytest.mark.slow
def test_an_edit_says_nothing_of_what_the_file_kept_beside_before() -> None:
    graph = sfc.load(FIXTURES / "simaticml" / "FB_Drill.xml")
    kept = sfc.loads(sfc.convert(graph, "codesys", partial=True).data)
    kept.rename("FB_Drill", "FB_Drills")
    assert sfc.convert(kept, "codesys").report.losses == []


@pytest.mark.slow
@pytest.mark.parametrize("name", ["codesys/sorting_conveyor.xml", "plcopen/filling_station_2.01.xml"])
@pytest.mark.parametrize(
    ("edit", "why"),
    [
        (lambda chart: setattr(chart.steps[3], "initial", True), "a second initial step in one connected chart"),
        (lambda chart: setattr(chart.transitions[1], "condition", None), "the transition has no condition"),
    ],
    ids=["second initial step", "no condition"],
)
def test_an_edit_that_no_tool_compiles_is_refused(name: str, edit: Callable[[Any], None], why: str) -> None:
    project = sfc.load(FIXTURES / name)
    chart = next(each for each in project.charts() if len(each.chart.steps) > 4)
    edit(chart.chart)
    with pytest.raises(LossError, match=why):
        sfc.dumps(project)
    _, report = sfc.convert(project, project.source.format, partial=True)
    (item,) = [each for each in report.losses if each.what == "chart"]
    assert item.path.startswith(chart.report_path)
    edited = sfc.loads(sfc.dumps(project, partial=True))
    edited.pous[0].comment = "another edit"
    assert not any("does not compile" in each.why for each in sfc.convert(edited, edited.source.format)[1].losses)


@pytest.mark.parametrize("name", ["entry_action", "main_action", "exit_action"])
@pytest.mark.parametrize("path", ["codesys23/distribution_belt.EXP", "codesys/sorting_conveyor.xml"])
def test_a_step_action_without_code_is_no_loss(path, name):
    """A main action that was emptied was "not executed", and the message asked to report that as a mistake."""
    project = sfc.load(FIXTURES / path)
    first, *_ = project.charts()
    setattr(first.chart.steps[1], name, sfc.StBody(text=""))
    assert sfc.convert(project, project.source.format).report.with_outcome(sfc.Outcome.NOT_EXECUTED) == []
