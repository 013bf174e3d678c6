"""Renaming: what changes, what is refused, and what is left."""

from __future__ import annotations

import copy
import gc
import pickle
from weakref import ref

import pytest

import plcopen_sfc
import plcopen_sfc.model as m
from plcopen_sfc.errors import ModelError
from plcopen_sfc.refactor.rename import rename
from tests.languages.binding.projects import block, chart, enum, global_list, interface, pou, project, sfc, struct
from tests.samples import FIXTURES


def text_of(made: m.Project, name: str) -> str:
    bodies = {where: body for where, _, body in made.bodies()}
    return bodies[name].text  # type: ignore[union-attr]


def condition(of: m.Pou, number: int = 0) -> str:
    assert of.sfc is not None
    return of.sfc.transitions[number].condition.text  # type: ignore[union-attr]


# -- what changes -----------------------------------------------------------------------------------------------------


def test_only_the_name_changes() -> None:
    text = "IF  s1 . X (* S1 *)\n\tAND S1.t>T#5s // S1\nTHEN y:='S1'; END_IF"
    main = sfc("Main", "S1 S2", "S1.x  AND(S1.T<T#1s)", actions={"Act": text})
    made = project(main)
    assert main.sfc is not None
    result = main.sfc.rename_step("s1", "Warten")
    assert main.sfc.steps[0].name == "Warten"
    assert condition(main) == "Warten.x  AND(Warten.T<T#1s)"
    assert text_of(made, "Main.Act") == text.replace("s1 .", "Warten .").replace("AND S1", "AND Warten")
    assert (result.path, result.old, result.new, len(result.changed), result.undecided) == (
        "Main.S1",
        "S1",
        "Warten",
        4,
        (),
    )


def test_every_body_of_the_project_follows() -> None:
    main = sfc("Main", "S1 S2")
    other = pou("Other", "y := Main.S1.x AND S1.x;")
    made = project(main, other)
    assert main.sfc is not None
    main.sfc.rename_step("S1", "Neu")
    assert text_of(made, "Other") == "y := Main.Neu.x AND S1.x;"


def test_calls_in_instruction_list_call_the_action_and_not_the_step_of_its_name() -> None:
    main = sfc("Main", "S1 Fill", actions={"Fill": "y := TRUE;", "Work": ""})
    work = main.action("Work")
    assert work is not None
    work.body = m.IlBody(text="LD Fill.X\nCALC Fill")
    made = project(main)
    assert main.sfc is not None
    main.sfc.rename_step("Fill", "Filling")
    assert text_of(made, "Main.Work") == "LD Filling.X\nCALC Fill"


def test_an_action_is_the_variable_and_not_the_step_of_its_name() -> None:
    """Steps are named after what they drive; the variable stays, so the action must name it still."""
    main = sfc("Main", "Wait Fill", "Fill.X AND NOT Fill", declared="Fill:BOOL")
    made = project(main)
    assert main.sfc is not None
    main.sfc.step("Fill").actions.append(m.ActionAssociation(id=77, qualifier="S", target="Fill"))
    main.sfc.rename_step("Fill", "Filling")
    assert main.sfc.step("Filling").actions[0].target == "Fill"
    assert condition(main) == "Filling.X AND NOT Fill"
    rename(made, next(iter(main.variables())), "Valve")
    assert main.sfc.step("Filling").actions[0].target == "Valve"


def test_what_nobody_can_tell_is_listed_and_left() -> None:
    main = sfc("Main", "S1 S2")
    made = project(main, pou("Other", "y := somewhere.S1.x;"))
    result = made.rename("Main.S1", "Neu")
    assert text_of(made, "Other") == "y := somewhere.S1.x;"
    assert [(u.use.path, u.use.line, u.use.column) for u in result.undecided] == [("Other", 1, 16)]
    assert "type" in result.undecided[0].reason
    assert "somewhere.S1.x" in str(result.undecided[0])


def test_kinds_of_things() -> None:
    main = sfc("Main", "S1 S2", "fb.run AND kind = Kind.Fast AND g", declared="fb: FB; kind: Kind; p: Point; g2: BOOL")
    fb = block("FB", "run := Scale(raw := 1) > 2; Stop();", input="run: BOOL", actions={"Stop": "run := FALSE;"})
    scale = pou("Scale", "Scale := raw;", kind=m.PouKind.FUNCTION, input="raw: INT")
    made = project(main, fb, scale, enum("Kind", "Fast Slow"), struct("Point", "a: INT"), global_list("", "g: BOOL"))
    made.pous.append(pou("More", "Main.p.a := 1; Main.fb.Stop();"))
    for path, new in (
        ("FB.run", "go"),
        ("FB", "FB_Motor"),
        ("Main.fb", "motor"),
        ("Kind.Fast", "Quick"),
        ("Kind", "Speed"),
        ("g", "go_on"),
        ("Point.a", "x"),
        ("Scale.raw", "value"),
        ("Scale", "Convert"),
        ("FB_Motor.Stop", "Halt"),
        ("Main", "Program1"),
    ):
        made.rename(path, new)
    assert condition(made.pous[0]) == "motor.go AND kind = Speed.Quick AND go_on"
    assert text_of(made, "FB_Motor") == "go := Convert(value := 1) > 2; Halt();"
    assert text_of(made, "FB_Motor.Halt") == "go := FALSE;"
    assert text_of(made, "Convert") == "Convert := value;"
    assert text_of(made, "More") == "Program1.p.x := 1; Program1.motor.Halt();"
    declared = {v.name: v.type for v in main.interface.variables()}  # type: ignore[union-attr]
    assert declared["motor"] == m.DerivedType(name="FB_Motor")
    assert declared["kind"] == m.DerivedType(name="Speed")


def test_a_global_variable_and_those_that_are_it() -> None:
    main = pou("Main", "x := 1;", external="x: INT")
    made = project(main, global_list("", "x: INT"))
    made.rename("x", "count")
    assert text_of(made, "Main") == "count := 1;"
    assert main.interface is not None
    assert main.interface.variables()[0].name == "count"


def test_the_variable_in_var_external_is_no_thing_of_its_own() -> None:
    made = project(pou("Main", "x := 1;", external="x: INT"), global_list("", "x: INT"))
    made.rename("Main.x", "count")
    assert made.global_variables[0].variables[0].name == "count"
    assert text_of(made, "Main") == "count := 1;"


def test_parts_of_a_list_of_global_variables() -> None:
    made = project(pou("A", "GVL.x := GVL.y;"), global_list("GVL", "x: INT"), global_list("GVL", "y: INT"))
    made.rename("GVL", "Globals")
    assert [section.name for section in made.global_variables] == ["Globals", "Globals"]
    assert text_of(made, "A") == "Globals.x := Globals.y;"


def test_variables_that_an_instance_data_block_repeats() -> None:
    motor = block("Motor", "#run := TRUE;", input="run: BOOL")
    made = project(motor, block("Main", '"DB".run := TRUE; #run := FALSE;'))
    made.dialect = m.Dialect.SCL
    data = m.DataBlock(name="DB", kind=m.DataBlockKind.INSTANCE, type_name="Motor", interface=interface("run: BOOL"))
    made.data_blocks = [data]
    made.rename("Motor.run", "go")
    assert data.interface is not None
    assert data.interface.variables()[0].name == "go"
    assert text_of(made, "Motor") == "#go := TRUE;"
    assert text_of(made, "Main") == '"DB".go := TRUE; #run := FALSE;'


def test_values_in_values() -> None:
    main = pou("Main", "", "v: Outer")
    assert main.interface is not None
    inner = m.StructValue(members=[m.MemberValue(member="a", value="1")])
    main.interface.variables()[0].initial = m.StructValue(members=[m.MemberValue(member="a", value=inner)])
    made = project(main, struct("Outer", "a: Inner"), struct("Inner", "a: INT"))
    made.rename("Outer.a", "b")
    initial = main.interface.variables()[0].initial
    assert isinstance(initial, m.StructValue)
    assert (initial.members[0].member, inner.members[0].member) == ("b", "a")
    made.rename("Inner.a", "c")
    assert (initial.members[0].member, inner.members[0].member) == ("b", "c")


@pytest.mark.parametrize(("new", "written"), [("Neu", "Neu"), ("neu 2", '"neu 2"'), ("IF", '"IF"'), ("7", '"7"')])
def test_names_of_scl_stand_in_quotes_where_they_must(new: str, written: str) -> None:
    text = '#x := #"x"; "DB".x := #p.y.x;'
    made = project(block("Motor", text, "x: INT; p: Outer"), struct("Outer", "y: Inner"), struct("Inner", "x: INT"))
    made.dialect = m.Dialect.SCL
    made.rename("Motor.x", new)
    assert text_of(made, "Motor") == f'#{written} := #"{new}"; "DB".x := #p.y.x;'
    made.rename("Inner.x", new)
    made.rename("Inner", "Type 2")
    assert text_of(made, "Motor") == f'#{written} := #"{new}"; "DB".x := #p.y.{written};'
    outer = made.data_types[0].type
    assert isinstance(outer, m.StructType)
    assert outer.members[0].type == m.DerivedType(name="Type 2")
    assert "cannot be a name" in refused(made, "Motor.p", 'a"b')


def test_tokens_of_tia_follow_the_text() -> None:
    made = project(block("Motor", "#x := #p.x; // x", "x: INT; p: Point"), struct("Point", "x: INT"))
    made.dialect = m.Dialect.SCL
    body = made.pous[0].bodies[0]
    assert isinstance(body, m.StBody)
    tokens = (
        '<StructuredText><Access Scope="LocalVariable"><Symbol><Component Name="x" UId="3"/></Symbol></Access>'
        '<Token Text=":="/><Access><Symbol><Component Name="p"/><Token Text="."/><Component Name="x"/></Symbol>'
        "</Access><LineComment><Text> x</Text></LineComment></StructuredText>"
    )
    body.markup = tokens
    made.rename("Point.x", "y")
    assert body.markup == tokens.replace('<Token Text="."/><Component Name="x"', '<Token Text="."/><Component Name="y"')
    made.rename("Motor.x", "Ende & Aus")
    assert body.markup.count('Name="Ende &amp; Aus" UId="3"') == 1
    body.markup = "<StructuredText/>"
    made.rename("Motor.p", "q")
    assert body.markup is None


def test_the_variable_of_a_step_that_codesys_declares_on_demand() -> None:
    main = sfc("Main", "S1 S2", "S1.x AND S1._x", declared="S1: SFCStepType")
    assert main.interface is not None
    assert main.sfc is not None
    main.interface.declaration = "PROGRAM Main\nVAR\n  S1 : SFCStepType; // S1\nEND_VAR"
    made = project(main, pou("Other", "y := Main.S1.x;"))
    main.sfc.rename_step("S1", "Neu")
    assert main.interface.declaration == "PROGRAM Main\nVAR\n  Neu : SFCStepType; // S1\nEND_VAR"
    assert main.interface.variables()[0].name == "Neu"
    assert condition(main) == "Neu.x AND Neu._x"
    assert text_of(made, "Other") == "y := Main.Neu.x;"


def test_markup_follows_the_text() -> None:
    made = project(pou("Main", "x := 1;", "x: INT"))
    body = made.pous[0].bodies[0]
    assert isinstance(body, m.StBody)
    body.markup = "<p><b>x</b> := 1;</p>"
    made.rename("Main.x", "y")
    assert (body.text, body.markup) == ("y := 1;", "<p><b>y</b> := 1;</p>")


@pytest.mark.parametrize(
    ("markup", "expected"),
    [
        ("<p>Ma<b>x</b> := 1;</p>", "<p>Most<b></b> := 1;</p>"),
        ("<p><i>M</i><b>ax</b> := 1;</p>", "<p><i>Most</i><b></b> := 1;</p>"),
        ("<p>Ma<!-- no -->x := 1;</p>", "<p>Most<!-- no --> := 1;</p>"),
        ("<p>Ma<![CDATA[x := ]]>1;</p>", "<p>Most<![CDATA[ := ]]>1;</p>"),
    ],
)
def test_markup_inside_of_a_name_stays(markup: str, expected: str) -> None:
    """A tag that was cut off with the end of the name left a file that could not be saved."""
    made = project(pou("Main", "Max := 1;", "Max: INT"))
    body = made.pous[0].bodies[0]
    assert isinstance(body, m.StBody)
    body.markup = markup
    made.rename("Main.Max", "Most")
    assert (body.text, body.markup) == ("Most := 1;", expected)


def test_another_case() -> None:
    main = sfc("Main", "eins zwei", "EINS.x")
    assert main.sfc is not None
    main.sfc.rename_step("eins", "Eins")
    assert condition(main) == "Eins.x"


def test_a_name_that_it_has_already() -> None:
    main = sfc("Main", "S1 S2")
    assert main.sfc is not None
    assert main.sfc.rename_step("S1", "S1").changed == ()


# -- what is refused --------------------------------------------------------------------------------------------------


def refused(made: m.Project, path: str, new: str) -> str:
    before = made.model_copy(deep=True)
    with pytest.raises(ModelError) as error:
        made.rename(path, new)
    assert made == before
    return str(error.value)


@pytest.mark.parametrize("new", ["", "1a", "a b", "a-b", "a.b", "IF", "end_if", "Bool", "TIME", "x#y", '"x"', "%IX0.0"])
def test_what_is_no_name(new: str) -> None:
    assert "cannot be a name" in refused(project(sfc("Main", "S1 S2")), "Main.S1", new)


@pytest.mark.parametrize("new", ["JMP", "Property", "max"])
@pytest.mark.parametrize("file", ["codesys23/distribution_belt.EXP", "twincat-belt/POUs/Ablauf_Band.TcPOU"])
def test_keywords_of_codesys_are_no_new_names_in_its_files(file: str, new: str) -> None:
    made = plcopen_sfc.load(FIXTURES / file)
    pou = next(made.charts()).pou.name
    assert "it is a keyword" in refused(made, f"{pou}.Warten", new)


@pytest.mark.parametrize("new", ["Füllen", "ä", "_x", "S1_2", "Schritt", "x1", "Größe"])
def test_what_is_a_name(new: str) -> None:
    made = project(sfc("Main", "S1 S2", "S1.x"))
    made.rename("Main.S1", new)
    assert condition(made.pous[0]) == f"{new}.x"


@pytest.mark.parametrize("new", ["S2", "s2", "v", "Act", "In1"])
def test_names_that_the_pou_has(new: str) -> None:
    main = sfc("Main", "S1 S2", declared="v: INT")
    main.actions = [m.Action(name="Act", body=m.SfcBody(chart=chart("In1")))]
    assert "already" in refused(project(main), "Main.S1", new)


def test_names_that_mean_something_else_where_the_old_one_is() -> None:
    made = project(pou("Main", "x := 1;", "x: INT"), global_list("", "g: INT"))
    message = refused(made, "Main.x", "g")
    assert "Main:1:1: x := 1; would mean the variable g" in message


def test_a_new_name_that_an_inner_scope_would_take() -> None:
    fb = block("FB", "", "x: INT")
    fb.methods = [m.Method(name="Do", interface=interface("y: INT"), body=m.StBody(text="x := 1;"))]
    assert "FB.Do:1:1" in refused(project(fb), "FB.x", "y")
    fb.methods[0].body = m.StBody(text="z := 1;")
    project(fb).rename("FB.x", "y")  # nobody uses it in there


def test_a_new_name_that_would_take_what_is_there() -> None:
    made = project(pou("Main", "g := 1;", "x: INT"), global_list("", "g: INT"))
    assert "means the variable g now" in refused(made, "Main.x", "g")
    unknown = project(pou("Main", "library := 1;", "x: INT"))
    assert "does not declare" in refused(unknown, "Main.x", "library")


def test_members_that_would_be_taken() -> None:
    made = project(pou("Main", "p.b := p.a;", "p: Point"), struct("Point", "a: INT"))
    assert "Main:1:3" in refused(made, "Point.a", "b")


def test_a_step_may_be_called_after_an_enumeration_value() -> None:
    main = sfc("Main", "S1 S2", "S1.x AND s = State.Idle", declared="s: State")
    made = project(main, enum("State", "Idle Busy"))
    made.rename("Main.S1", "Idle")
    assert condition(main) == "Idle.x AND s = State.Idle"
    assert "State.Idle" in refused(project(sfc("M", "S1 S2", "Idle = s"), enum("State", "Idle Busy")), "M.S1", "Idle")


def test_what_there_is_not() -> None:
    made = project(sfc("Main", "S1 S2"))
    assert "There is: Main.S1" in refused(made, "S1", "x")
    assert "declares no" in refused(made, "Main.S9", "x")


def test_applications_keep_their_name() -> None:
    made = project(pou("Main"))
    made.applications = [m.Resource(name="App")]
    assert "cannot be renamed" in refused(made, "App", "Other")


def test_two_things_of_one_path() -> None:
    main = sfc("Main", "S1 S2", "S1", declared="S1: BOOL")
    made = project(main)
    assert "several things" in refused(made, "Main.S1", "x")
    assert main.interface is not None
    rename(made, main.interface.variables()[0], "bFirst")
    assert condition(main) == "bFirst"


# -- charts and their projects ----------------------------------------------------------------------------------------


def test_a_chart_in_no_project() -> None:
    alone = chart("S1 S2", "S1.x AND S1.t > T#1s")
    result = alone.rename_step("S1", "Neu")
    assert alone.transitions[0].condition.text == "Neu.x AND Neu.t > T#1s"  # type: ignore[union-attr]
    assert len(result.changed) == 2


@pytest.mark.parametrize(
    "again",
    [
        lambda made: made.model_copy(deep=True),
        copy.deepcopy,
        lambda made: pickle.loads(pickle.dumps(made)),  # noqa: S301
        lambda made: m.Project.model_validate(made.model_dump()),
        lambda made: plcopen_sfc.loads(plcopen_sfc.dumps(made, format="json")),
    ],
)
def test_copies_are_projects_of_their_own(again: object) -> None:
    made = project(sfc("Main", "S1 S2"), pou("Other", "y := Main.S1.x;"))
    other = again(made)  # type: ignore[operator]
    other.pou("Main").sfc.rename_step("S1", "Neu")
    assert text_of(other, "Other") == "y := Main.Neu.x;"
    assert text_of(made, "Other") == "y := Main.S1.x;"
    made.pou("Main").sfc.rename_step("S1", "Alt")  # type: ignore[union-attr]
    assert text_of(made, "Other") == "y := Main.Alt.x;"


def test_a_shallow_copy_has_the_same_pous() -> None:
    made = project(sfc("Main", "S1 S2"), pou("Other", "y := Main.S1.x;"))
    shallow = copy.copy(made)
    shallow.pou("Main").sfc.rename_step("S1", "Neu")  # type: ignore[union-attr]
    assert text_of(made, "Other") == text_of(shallow, "Other") == "y := Main.Neu.x;"


def test_a_project_is_forgotten_with_the_last_of_its_parts() -> None:
    gc.freeze()  # a collection looks through all that other tests have left, which takes seconds
    made = project(sfc("Main", "S1 S2"))
    own, seen = made.pou("Main").sfc, ref(made)
    del made
    assert own is not None
    assert own.project is seen()
    del own
    gc.collect()
    assert seen() is None


def test_looking_for_the_project_reads_no_chart() -> None:
    made = plcopen_sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml")
    bodies = [body for _, _, body in made.bodies() if isinstance(body, m.SfcBody)]
    assert all(body.chart.project is made for body in bodies)
    assert all(body.chart.is_unread for body in bodies)


def test_charts_inside_charts() -> None:
    inner = chart("In1 In2", "S1.x AND In1.x")
    main = sfc("Main", "S1 S2", "In1.x")
    assert main.sfc is not None
    main.sfc.steps[1].macro = m.Macro(body=m.SfcBody(chart=inner))
    made = project(main, pou("Other", "y := Main.In1.x;"))
    inner.rename_step("In1", "Innen")
    assert condition(main) == "Innen.x"
    assert text_of(made, "Other") == "y := Main.Innen.x;"
    assert inner.transitions[0].condition.text == "S1.x AND Innen.x"  # type: ignore[union-attr]


# -- files ------------------------------------------------------------------------------------------------------------


def lines_changed(name: str, *renames: tuple[str, str]) -> list[tuple[str, str]]:
    """The lines of a fixture that renames change, old and new."""
    path = FIXTURES / name
    made = plcopen_sfc.load(path)
    for old, new in renames:
        made.rename(old, new)
    before, after = path.read_bytes().decode().splitlines(), plcopen_sfc.dumps(made).decode().splitlines()
    return [(a.strip(), b.strip()) for a, b in zip(before, after, strict=True) if a != b]


def test_a_declaration_as_text_is_changed_in_place() -> None:
    changed = lines_changed("codesys/device_export.xml", ("FB_Runtime.udiSeconds", "udiTime"))
    assert ("udiSeconds : UDINT; // Hours counted" in changed[0][0]) or len(changed) >= 3
    assert all(new == old.replace("udiSeconds", "udiTime") for old, new in changed)


def test_no_declaration_is_left_out() -> None:
    made = plcopen_sfc.load(FIXTURES / "twincat" / "press_station.xml")
    made.rename("GVL.bEmergencyOk", "bSafe")
    made.rename("ST_PressRecipe.fForce", "fPower")
    made.rename("FB_Motor", "FB_Drive")
    _, report = plcopen_sfc.convert(made, "codesys")
    assert [item for item in report.losses if "declaration" in item.what] == []
    text = plcopen_sfc.dumps(made).decode("utf-8-sig")
    assert "bSafe : BOOL; // safety PLC healthy" in text
    assert "fPower : REAL; // kN" in text
    assert "FB_Motor" not in text
    assert "FUNCTION_BLOCK FB_Drive" in text


def test_a_list_that_the_tool_writes_twice() -> None:
    changed = lines_changed("codesys/sorting_conveyor.xml", ("GVL_HMI.udiTotal", "udiSum"))
    assert len([line for line, _ in changed if line == '<variable name="udiTotal">']) == 2
    made = plcopen_sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml")
    made.rename("GVL_HMI", "GVL_Panel")
    made.rename("GVL_Panel.SLIDE_CAPACITY", "CAPACITY")
    text = plcopen_sfc.dumps(made).decode("utf-8-sig")
    assert "GVL_HMI" not in text
    assert "SLIDE_CAPACITY" not in text


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "path"),
    [
        ("codesys/sorting_conveyor.xml", "FB_Pusher"),
        ("codesys/sorting_conveyor.xml", "GVL_IO"),
        ("twincat/press_station.xml", "FB_Press.Ram"),
        ("twincat/press_station.xml", "MAIN.Motor"),
        ("plcopen/filling_station_2.01.xml", "FillingStation.Fill"),
        ("plcopen/every_element_2.01.xml", "Mixer"),
    ],
)
def test_lines_that_do_not_name_it_stay(name: str, path: str) -> None:
    old = path.rpartition(".")[2]
    changed = lines_changed(name, (path, "Zz9_Neu"))
    assert changed
    assert all(old.casefold() in a.casefold() and "Zz9_Neu" in b for a, b in changed)


def test_flags_of_charts_keep_their_names_in_codesys() -> None:
    made = plcopen_sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml")
    variables = made.pou("PLC_PRG").interface.variables()  # type: ignore[union-attr]
    variables[0].name = "SFCInit"
    with pytest.raises(ModelError, match="charts know SFCInit as their flag"):
        made.rename("PLC_PRG.SFCInit", "Start")
    with pytest.raises(ModelError, match="charts know SFCPause as their flag"):
        made.rename(f"PLC_PRG.{variables[1].name}", "SFCPause")


@pytest.mark.parametrize(
    ("name", "new", "known"), [("OFF_SQ", "Off", "OFF_SQ"), ("S_NO", "Number", "S_NO"), ("B1", "HALT_SQ", "HALT_SQ")]
)
def test_parameters_that_every_block_of_graph_has_keep_their_names(name: str, new: str, known: str) -> None:
    made = plcopen_sfc.load(FIXTURES / "simaticml-training-chain" / "Ablauf.xml")
    before = plcopen_sfc.dumps(made)
    with pytest.raises(ModelError, match=f"charts know {known} as their parameter"):
        made.rename(f"Ablauf.{name}", new)
    assert plcopen_sfc.dumps(made) == before
    made.rename("Ablauf.S2", "Fault")  # the maximum parameter set has such an output, but a step is none
    made.rename("Ablauf.Fault", "S2")
    assert plcopen_sfc.dumps(made) == before


# -- what extends something -------------------------------------------------------------------------------------------

EXTENDING = b"""{plcopen_sfc format := 1}
{plcopen_sfc project.dialect := 'codesys'}

TYPE Part : STRUCT
  nr : INT;
END_STRUCT END_TYPE
TYPE Big EXTENDS Part : STRUCT
  weight : REAL;
END_STRUCT END_TYPE

FUNCTION_BLOCK Base
VAR cnt : INT; END_VAR
METHOD Inc : INT
VAR_INPUT n : INT; END_VAR
cnt := cnt + n;
Inc := cnt;
END_METHOD
ACTION Clear:
cnt := 0;
END_ACTION
END_FUNCTION_BLOCK

FUNCTION_BLOCK Middle EXTENDS Base
END_FUNCTION_BLOCK

FUNCTION_BLOCK Derived EXTENDS Middle
METHOD Inc : INT
VAR_INPUT n : INT; END_VAR
Inc := SUPER^.Inc(n := n) + 1;
END_METHOD
ACTION Clear:
cnt := 1;
END_ACTION
END_FUNCTION_BLOCK

FUNCTION_BLOCK Other
METHOD Inc : INT
VAR_INPUT n : INT; END_VAR
Inc := n;
END_METHOD
END_FUNCTION_BLOCK

PROGRAM Main
VAR
  big : Big := (nr := 8, weight := 1.0);
  d : Derived;
  o : Other;
  p : POINTER TO Base;
  k : INT;
END_VAR
big.nr := big.nr + 1;
k := p^.Inc(n := 2) + d.Inc(n := 1) + o.Inc(n := 3);
d.Clear();
END_PROGRAM
"""


def test_members_of_a_structure_are_found_in_those_that_extend_it() -> None:
    made = plcopen_sfc.loads(EXTENDING, format="iec-text")
    assert not rename(made, "Part.nr", "number").undecided
    text = plcopen_sfc.dumps(made).decode()
    assert "big : Big := (number := 8, weight := 1.0);" in text
    assert "big.number := big.number + 1;" in text


def test_what_extends_a_type_names_it() -> None:
    made = plcopen_sfc.loads(EXTENDING, format="iec-text")
    result = rename(made, "Part", "Item")
    assert ([use.text for use in result.changed], result.undecided) == (["Part"], ())
    assert "TYPE Big EXTENDS Item :" in plcopen_sfc.dumps(made).decode()
    assert not rename(made, "Base", "Root").undecided
    assert "FUNCTION_BLOCK Middle EXTENDS Root" in plcopen_sfc.dumps(made).decode()


@pytest.mark.parametrize("of", ["Base", "Derived"])
def test_what_overrides_a_method_gets_its_name(of: str) -> None:
    made = plcopen_sfc.loads(EXTENDING, format="iec-text")
    result = rename(made, f"{of}.Inc", "Plus")
    text = plcopen_sfc.dumps(made).decode()
    assert (text.count("METHOD Plus"), text.count("METHOD Inc")) == (2, 1)
    assert "Plus := SUPER^.Plus(n := n) + 1;" in text
    assert "k := p^.Plus(n := 2) + d.Plus(n := 1) + o.Inc(n := 3);" in text
    assert {"Base": "Derived", "Derived": "Base"}[of] in {use.path for use in result.changed}
    rename(made, f"{of}.Plus.n", "steps")
    text = plcopen_sfc.dumps(made).decode()
    assert "k := p^.Plus(steps := 2) + d.Plus(steps := 1) + o.Inc(n := 3);" in text
    assert text.count("steps : INT;") == 2
    rename(made, f"{of}.Clear", "Reset")
    assert plcopen_sfc.dumps(made).decode().count("ACTION Reset:") == 2


def test_what_overrides_a_method_gets_no_other_name_in_one_pass() -> None:
    made = plcopen_sfc.loads(EXTENDING, format="iec-text")
    with pytest.raises(ModelError, match="overrides it"):
        made.rename_many({"Base.Inc": "Plus", "Derived.Inc": "More"})
    assert plcopen_sfc.dumps(made) == EXTENDING


@pytest.mark.parametrize(
    ("what", "new"), [("Main.Wait", "GVL"), ("Main.i", "Mode"), ("Main.Wait", "Mode"), ("Main.Wait", "SFCInit")]
)
def test_what_is_named_before_a_dot_is_not_hidden(what: str, new: str) -> None:
    text = b"""{plcopen_sfc format := 1}
{plcopen_sfc project.dialect := 'codesys'}

TYPE Mode : (Idle, Run); END_TYPE

{plcopen_sfc name := 'GVL'}
VAR_GLOBAL
  n : INT;
END_VAR

PROGRAM Main
VAR i : INT; m : Mode; END_VAR
INITIAL_STEP Wait: END_STEP
TRANSITION FROM Wait TO Wait := GVL.n = 3 AND m = Mode.Run AND i = 1; END_TRANSITION
END_PROGRAM
"""
    made = plcopen_sfc.loads(text, format="iec-text")
    with pytest.raises(ModelError, match=r"before a dot|as their flag"):
        made.rename(what, new)
    assert plcopen_sfc.dumps(made) == text


def test_a_step_with_the_name_of_a_function_is_not_what_a_call_names() -> None:
    """`MAX(k, 2)` became `Top(k, 2)`, and the result told of no doubt."""
    main = sfc(
        "Main", "MAX S2", "MAX(k, 2) > 1 AND MAX.X", actions={"Act": "x := MAX(k, 2); IF MAX.X THEN x := 1; END_IF"}
    )
    made = project(main)
    assert main.sfc is not None
    main.sfc.rename_step("MAX", "Top")
    assert condition(main) == "MAX(k, 2) > 1 AND Top.X"
    assert text_of(made, "Main.Act") == "x := MAX(k, 2); IF Top.X THEN x := 1; END_IF"
