"""The public functions: names that can be guessed, the same options everywhere, own errors for wrong arguments."""

from __future__ import annotations

import io
from pathlib import Path

import pytest

import plcopen_sfc as sfc

ROOT = Path(__file__).resolve().parents[1]
CONVEYOR = ROOT / "fixtures" / "codesys" / "sorting_conveyor.xml"
FILLING = ROOT / "fixtures" / "plcopen" / "filling_station_2.01.xml"


def test_a_first_chart_needs_no_other_module():
    chart = sfc.SfcNetwork()
    wait, fill = chart.add_step("Wait", initial=True), chart.add_step("Fill")
    fill.actions.append(sfc.ActionAssociation(id=chart.new_id(), qualifier=sfc.Qualifier.N, target="Valve"))
    chart.add_transition(wait, fill, "Start")
    chart.add_transition(fill, wait, "NOT Start")
    variables = [sfc.Variable(name="Start", type="BOOL"), sfc.Variable(name="Valve", type="BOOL")]
    inputs = sfc.VariableSection(kind=sfc.SectionKind.INPUT, variables=variables[:1])
    outputs = sfc.VariableSection(kind=sfc.SectionKind.OUTPUT, variables=variables[1:])
    interface = sfc.Interface(sections=[inputs, outputs])
    pou = sfc.Pou(name="Main", kind=sfc.PouKind.PROGRAM, interface=interface, bodies=[sfc.SfcBody(chart=chart)])
    project = sfc.Project(name="Plant", pous=[pou])
    again = sfc.loads(sfc.dumps(project, format="plcopen"))
    assert sfc.equivalent(again.pou("Main").chart, chart).equal
    assert isinstance(sfc.equivalent(again, project), sfc.Verdict)


def test_dir_lists_every_public_name_and_each_can_be_imported():
    names = dir(sfc)
    assert {"load", "equivalent", "Qualifier", "ActionAssociation", "LossError", "__version__"} <= set(names)
    assert names == sfc.__all__
    assert all(getattr(sfc, name) is not None for name in names)
    from plcopen_sfc import __all__ as starred  # noqa: PLC0415

    assert starred == names


def test_an_unknown_name_of_the_package_gets_the_nearest():
    with pytest.raises(AttributeError, match=r"no attribute 'laod' \(did you mean 'load'\?\)"):
        sfc.laod  # noqa: B018


@pytest.mark.slow
def test_save_dumps_and_convert_take_the_same_options_and_share_one_result(tmp_path):
    project = sfc.load(CONVEYOR)
    target = tmp_path / "out.xml"
    report = sfc.save(project, target, format="plcopen", partial=True)
    converted = sfc.convert(project, "plcopen", partial=True)
    assert converted.data == target.read_bytes() == sfc.dumps(project, format="plcopen", partial=True)
    assert converted.report.items == report.items
    data, found = converted
    assert (data, found) == (converted.data, converted.report)
    for function in (sfc.convert, sfc.dumps):
        with pytest.raises(sfc.LossError):
            function(project, format="plcopen", strict=True)


@pytest.mark.slow
def test_an_extension_of_another_format_chooses_it_or_is_refused(tmp_path):
    project = sfc.load(FILLING)
    sfc.save(project, tmp_path / "out.st", partial=True)
    assert sfc.load(tmp_path / "out.st").source.format == "iec-text"
    with pytest.raises(sfc.LossError):  # SCL has no charts
        sfc.save(project, tmp_path / "out.scl")
    assert not (tmp_path / "out.scl").exists()
    text = sfc.load(tmp_path / "out.st")
    with pytest.raises(sfc.FormatError, match=r"extension \.xml are of several formats: codesys, plcopen, simaticml"):
        sfc.save(text, tmp_path / "out.xml")
    assert not (tmp_path / "out.xml").exists()
    sfc.save(project, tmp_path / "out.bak")  # no format has it: a copy
    assert (tmp_path / "out.bak").read_bytes() == FILLING.read_bytes()


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("codesy", "did you mean 'codesys'"),
        ("simaticml-V22", "did you mean 'simaticml-V2"),
        ("tia", "TIA Portal uses simaticml"),
        ("TwinCAT", "TwinCAT 3 uses twincat"),
        ("beckhoff", "TwinCAT 3 uses twincat"),
        ("TwinCAT2", "CoDeSys 2.3 uses codesys23"),
        ("beremiz", "Beremiz uses plcopen, written with --for beremiz"),
        ("beremis", "did you mean 'beremiz'"),
    ],
)
def test_unknown_formats_get_the_nearest_name_and_tools_their_format(name, message):
    with pytest.raises(sfc.FormatError, match=f"there is no format '{name}'.*{message}"):
        sfc.convert(sfc.Project(), name)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: sfc.load(None), "load needs a path or a binary file, not None"),
        (lambda: sfc.load(b"<project>"), "loads takes bytes"),
        (lambda: sfc.load(io.StringIO("text")), 'open(path, "rb")'),
        (lambda: sfc.loads("text"), "loads needs bytes, not 'text' (str)"),
        (lambda: sfc.save(None, "x.xml"), "a project, or what lower returned, is needed"),
        (lambda: sfc.save(sfc.SfcNetwork(), "x.xml"), "Put it into a project"),
        (lambda: sfc.save(sfc.Project(), 3, format="json"), "save needs a path or a binary file, not 3"),
        (lambda: sfc.dumps(sfc.Project(), format=3), "format is the name of one, not 3"),
        (lambda: sfc.simulate(sfc.SfcNetwork(), inputs=[{}]), "inputs are a CSV file, a function"),
        (lambda: sfc.simulate("Main"), "a chart, a POU or a project is needed, not 'Main' (str)"),
        (lambda: sfc.lower("Main"), "a chart, a POU or a project is needed"),
        (lambda: sfc.equivalent("Main", "Main"), "a chart, a POU or a project is needed"),
        (lambda: sfc.check("line24.xml"), "check needs a chart, a POU or a project"),
        (lambda: sfc.convert("line24.xml", "json"), "Load the file first: load(path)."),
        (lambda: sfc.lower_to_file(None, "x.xml"), "lower_to_file needs a project, not None"),
        (lambda: sfc.lower_to_file(sfc.Project(), None), "lower_to_file needs the path to write to, not None"),
        (lambda: sfc.merge_list(None, None), "merge_list needs a project and a step list, not None"),
        (lambda: one_step().add_transition(None, "Wait"), "from steps to steps, or their names, not None"),
        (lambda: one_step().steps.append("Fill"), "`steps` of SfcNetwork is a list of Step, not 'Fill' (str)"),
        (lambda: one_step().transitions.append("A -> B"), "`transitions` of SfcNetwork is a list of Transition, not"),
        (lambda: one_step().steps[0].actions.append("N q"), "`actions` of Step is a list of ActionAssociation, not"),
        (lambda: sfc.Project().pous.extend([one_step()]), "`pous` of Project is a list of Pou, not"),
        (lambda: one_step().steps.__setitem__(0, None), "`steps` of SfcNetwork is a list of Step, not None"),
        (lambda: sfc.Project().edit().renumber("A"), "renumber needs as start: int, not 'A' (str)"),
        (lambda: sfc.simulate(one_step(), scans=-1), "there are no -1 scans"),
        (lambda: sfc.simulate(one_step(), scans=-(10**5000)), "there are no <int> scans"),
        (lambda: sfc.simulate(one_step(), scans=10**5000), "<int> scans are more than a simulation can run"),
        (lambda: sfc.simulate(one_step(), scans=10**12), "1000000000000 scans are more than a simulation can run"),
        (lambda: sfc.ActionAssociation.parse(None, 1), 'an action is a text: "N Valve", not None'),
        (lambda: one_step().add_step("Fill", actions="N Valve"), "`actions` is a list of texts"),
        (lambda: sfc.save(one_step(), "x.xml", partail=True), "save has no option 'partail' (did you mean 'partial'?)"),
        (lambda: sfc.dumps(one_step(), partail=True), "save has no option 'partail' (did you mean 'partial'?)"),
        (lambda: sfc.convert(one_step(), strcit=True), "save has no option 'strcit' (did you mean 'strict'?)"),
        (lambda: sfc.lower(one_step(), verfy=False), "lower has no option 'verfy' (did you mean 'verify'?)"),
        (
            lambda: sfc.simulate(one_step(), inputs=lambda *_: ["a"]),
            "the function for inputs returns a dictionary, not",
        ),
        (lambda: one_step().find(drives=3), 'drives, reads and calls are patterns: "*Valve*", not 3'),
        (
            lambda: one_step().find_transitions(reads=3),
            'reads, calls, condition, leaving and entering are patterns: "*Valve*", not 3',
        ),
        (lambda: sfc.Project().uses(None), 'uses needs a path ("Main.S3") or an object of the model, not None'),
    ],
)
def test_a_wrong_argument_is_an_error_of_ours(call, message):
    with pytest.raises(sfc.ArgumentError) as caught:
        call()
    assert message in str(caught.value)
    assert isinstance(caught.value, TypeError)


def one_step() -> sfc.SfcNetwork:
    chart = sfc.SfcNetwork()
    chart.add_step("Wait", initial=True)
    return chart


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: sfc.lower(one_step(), "flipflip"), "no construction 'flipflip' (did you mean 'flipflop'?)"),
        (lambda: sfc.check(one_step(), profile="codesis"), "no profile 'codesis' (did you mean 'codesys'?)"),
        (lambda: sfc.simulate(one_step(), profile="s7grap"), "no profile 's7grap' (did you mean 's7graph'?)"),
        (lambda: sfc.check(one_step(), select=["STR9"]), "no rule 'STR9' (did you mean 'STR"),
        (lambda: sfc.dumps(sfc.Project(), format="plcopen", flavour="berimiz"), "(did you mean 'beremiz'?)"),
        (lambda: sfc.Project().rename("Main.S3", "Wait"), "the project declares no 'Main.S3'"),
        (lambda: sfc.Project().steps(drivs="q*"), "steps have no field 'drivs' (did you mean 'drives'?)"),
        (lambda: one_step().add_transition("Wait", "Wait", 5), "condition of Transition is no object of the model: 5"),
        (lambda: sfc.Step(id=1, name="A", title=5), "title of Step is none of a text, MarkupText, MultilingualText: 5"),
        (lambda: sfc.Step(id=1, name="A", entry_action=5), "entry_action of Step is none of a text, StBody, IlBody, "),
        (
            lambda: sfc.Step(id=1, name="A", entry_action={"language": "ST", "text": 5, "markup": 6}),
            "entry_action.ST.text of Step is not a text: 5 (int); entry_action.ST.markup of Step is not a text: 6",
        ),
        (lambda: sfc.SfcNetwork(steps=["Wait"]), "steps.0 of SfcNetwork is no Step: 'Wait' (str)"),
        (lambda: sfc.save(sfc.Project(), "x.xml", format="plcopen", limit="soon"), "'soon' is no time limit"),
        (lambda: sfc.Project().add_program("Main").add_variable("x", "INT", "inputs"), "(did you mean 'input'?)"),
        (lambda: sfc.Project().find("*", "steps"), "no kind of declaration (did you mean 'step'?)"),
    ],
)
def test_an_unknown_name_gets_the_nearest(call, message):
    with pytest.raises(sfc.SfcError) as caught:
        call()
    assert message in str(caught.value)


def test_a_profile_of_a_wrong_type_is_an_error_of_ours():
    with pytest.raises(sfc.ArgumentError, match="a profile is a Profile or the name of one, not 3"):
        sfc.simulate(one_step(), profile=3)


def imported(project: sfc.Project, tool: str) -> list[tuple[str, str]]:
    return [(each.code, each.severity.value) for each in sfc.check_import(project, tool)]


@pytest.mark.slow
def test_what_a_tool_would_not_do_of_a_file_is_told_before_the_import():
    drill = sfc.load(ROOT / "fixtures" / "simaticml" / "FB_Drill.xml")
    assert imported(drill, "tia") == imported(drill, "tia-V16") == []
    assert imported(sfc.load(CONVEYOR), "codesys") == imported(sfc.load(CONVEYOR), "twincat") == []
    found = {each.message.partition(": several of ")[0]: each for each in sfc.check_import(sfc.load(CONVEYOR), "tia")}
    assert found["operating input: S7-GRAPH has no SFCReset"].code == "IMP001"
    assert found["operating input: S7-GRAPH has no SFCReset"].location.line == 152
    assert ("IMP002", "warning") in imported(drill, "codesys")  # a tag that is in no file
    assert ("IMP004", "error") in imported(drill, "codesys")
    assert ("IMP003", "info") in imported(sfc.load(FILLING), "beremiz")
    with pytest.raises(sfc.SfcError, match="did you mean 'codesys'"):
        sfc.check_import(drill, "codesis")


@pytest.mark.parametrize("again", [True, False])
def test_branches_that_do_not_nest_are_told_in_a_file_of_the_tool_too(*, again: bool) -> None:
    """Loops replace them in a converted file, but not where a step is left and entered `again` at once."""
    text = b"""PROGRAM Main VAR_INPUT a : BOOL; END_VAR
    INITIAL_STEP S0: END_STEP STEP A1: END_STEP STEP B1: END_STEP STEP C1: END_STEP STEP A2: END_STEP STEP B2: END_STEP
    TRANSITION FROM S0 TO (A1, B1, C1) := a; END_TRANSITION
    TRANSITION FROM (A1, B1) TO A2 := a; END_TRANSITION
    TRANSITION FROM B1 TO B2 := a; END_TRANSITION
    TRANSITION FROM (A2, B2, C1) TO S0 := a; END_TRANSITION
    END_PROGRAM"""
    loop = b"TRANSITION FROM C1 TO C1 := NOT a; END_TRANSITION END_PROGRAM"
    text = text.replace(b"END_PROGRAM", loop) if again else text
    written, _ = sfc.convert(sfc.loads(text, format="iec-text"), "codesys", partial=True)
    found = [each for each in sfc.check_import(sfc.loads(written), "codesys") if each.severity.value == "error"]
    assert bool(found) is again, "CODESYS would refuse it"
    assert all(each.code == "IMP001" and "are nested branches: restructure it" in each.message for each in found)


@pytest.mark.parametrize(
    ("format", "tool", "name", "why"),
    [
        ("codesys", "codesys", "Füllen", "takes letters without accents"),
        ("codesys", "twincat", "1 Fill", "takes letters without accents"),
        ("codesys", "codesys", "Fill__Up", ""),
        ("codesys", "codesys", "IF", "is a keyword"),
        ("codesys", "codesys", "a", "a variable of the POU has its name"),
        ("simaticml", "tia", "a", "a variable of the POU has its name"),
        ("simaticml", "tia", "S" * 130, "takes names of 125 characters"),
        ("codesys", "codesys", "Fill", ""),
        ("simaticml", "tia", "1 Füllen", ""),
    ],
)
def test_names_that_a_tool_does_not_compile_are_told_in_its_own_files(format: str, tool: str, name: str, why: str):
    text = b"""FUNCTION_BLOCK Main VAR_INPUT a : BOOL; END_VAR
    INITIAL_STEP S0: END_STEP STEP Other: END_STEP
    TRANSITION FROM S0 TO Other := a; END_TRANSITION TRANSITION FROM Other TO S0 := NOT a; END_TRANSITION
    END_FUNCTION_BLOCK"""
    written = sfc.convert(sfc.loads(text, format="iec-text"), format)[0]
    own = sfc.loads(written.replace(b'"Other"', f'"{name}"'.encode()), format=format)
    found = [each for each in sfc.check_import(own, tool) if each.code == "IMP001"]
    assert [why in each.message for each in found] == [True] * bool(why), found


@pytest.mark.parametrize(
    ("format", "name", "tool"),
    [("simaticml", "out/", "tia-V16"), ("simaticml", "out.xml", "tia"), ("codesys", "out.xml", "codesys")],
)
def test_what_convert_has_written_for_a_tool_is_valid_for_it(tmp_path: Path, format: str, name: str, tool: str):
    """The source that a file keeps was judged, and not what the tool reads."""
    text = b"""FUNCTION_BLOCK Motor VAR_INPUT a : INT; END_VAR VAR_OUTPUT n : INT; END_VAR
    METHOD Half : INT VAR_INPUT x : INT; END_VAR Half := x / 2; END_METHOD n := Half(x := a); END_FUNCTION_BLOCK
    FUNCTION_BLOCK Main VAR_INPUT a : BOOL; END_VAR VAR n, k : INT; END_VAR
    INITIAL_STEP S0: END_STEP TRANSITION FROM S0 TO S1 := a; END_TRANSITION
    STEP S1: Go(P1); END_STEP TRANSITION FROM S1 TO S0 := NOT a; END_TRANSITION
    ACTION Go: n := n + 1; IF a THEN k := n * 2; END_IF; END_ACTION END_FUNCTION_BLOCK"""
    source = sfc.loads(sfc.dumps(sfc.loads(text, format="iec-text"), format="codesys"))
    sfc.save(source, f"{tmp_path}/{name}", format=format, strict=format != "codesys")
    assert [each for each in sfc.check_import(sfc.load(tmp_path / name), tool) if each.severity.value != "info"] == []


def test_variables_of_codesys_have_single_underscores():
    text = b"PROGRAM Main VAR Fill__Up : BOOL; END_VAR Fill__Up := TRUE; END_PROGRAM"
    own = sfc.loads(sfc.convert(sfc.loads(text, format="iec-text"), "codesys")[0], as_tool=True)
    assert [each.name for each in own.pou("Main").variables()] == ["Fill_Up"]


def test_a_file_made_in_python_is_of_the_format_of_its_tool():
    project = sfc.Project(pous=[sfc.Pou(name="Main", kind="program", bodies=[sfc.StBody(text=";")])])
    assert imported(project, "codesys") == []
