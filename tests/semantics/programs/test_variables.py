"""Declarations: structures, arrays, enumerations, strings, constants, global variables, addresses, data blocks."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.errors import ModelError, SimulationError
from plcopen_sfc.model import DataBlock, Interface, MemberValue, StructValue, Tag, TagTable, Variable, VariableSection
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.semantics.programs import Controller
from tests.semantics.programs.running import main, project_of, start

TYPES = """
TYPE
  Colour : (Red, Green := 5, Blue);
  Percent : INT (0..100) := 50;
  Point : STRUCT x : INT := 1; y : INT; END_STRUCT;
  Line : STRUCT a : Point := (x := 7); b : Point; tags : ARRAY[1..2] OF BOOL := [TRUE, FALSE]; END_STRUCT;
END_TYPE
"""


def test_initial_values() -> None:
    instance = main(
        "line : Line := (b := (y := 9)); p : Point; percent : Percent; c : Colour; d : Colour := Blue; "
        "grid : ARRAY[0..1, 1..3] OF INT := [1, 2, 2(3), 5]; words : ARRAY[1..2] OF STRING := ['a', 'b']; "
        "points : ARRAY[1..2] OF Point := [(x := 3), (y := 4)]; "
        "t : TIME := T#1s500ms; r : REAL := 1; w : WORD := 16#FF;",
        "",
        more=TYPES,
    )
    shown = {
        path: instance[path]
        for path in (
            "line.a.x line.a.y line.b.x line.b.y line.tags[1] line.tags[2] p.x percent c d grid[0,1] grid[0, 3]"
            " grid[1,1] grid[1, 2] grid[1,3] words[2] points[1].x points[2].x points[2].y t r w"
        )
        .replace(", ", ",")
        .split()
    }
    assert list(shown.values()) == [
        7, 0, 1, 9, True, False, 1, 50, 0, 6, 1, 3, 3, 5, 0, "b", 3, 1, 4, 1_500_000_000, 1.0, 255,
    ]  # fmt: skip


def test_structures_and_arrays_are_copied() -> None:
    instance = main(
        "a, b : Line; one, two : ARRAY[1..2] OF Point; i : INT := 2;",
        "a.a.x := 42; b := a; a.a.x := 1; one[i].y := 5; two := one; one[2].y := 6; b.b := two[2];",
        more=TYPES,
    )
    assert (instance["b.a.x"], instance["a.a.x"], instance["two[2].y"], instance["b.b.y"]) == (42, 1, 5, 5)


def test_arrays_have_any_lower_bound_and_more_dimensions() -> None:
    instance = main(
        "a : ARRAY[-2..2] OF INT; g : ARRAY[1..2, 0..2] OF INT; n : ARRAY[1..2] OF ARRAY[5..6] OF INT; "
        "i, j, sum : INT;",
        """FOR i := -2 TO 2 DO a[i] := i * 10; END_FOR
        FOR i := 1 TO 2 DO FOR j := 0 TO 2 DO g[i, j] := i * 100 + j; END_FOR END_FOR
        n[2][6] := 3; n[1, 5] := 4; sum := g[1, 2] + g[2, 1];""",
    )
    assert [instance[f"a[{i}]"] for i in range(-2, 3)] == [-20, -10, 0, 10, 20]
    assert (instance["sum"], instance["n[2][6]"], instance["n[1,5]"]) == (102 + 201, 3, 4)


@pytest.mark.parametrize("index", [-1, 0, 4, 32767])
def test_an_index_out_of_bounds_is_an_error(index: int) -> None:
    with pytest.raises(SimulationError, match=rf"the index {index} is outside of 1\.\.3"):
        main(f"a : ARRAY[1..3] OF INT; i : INT := {index};", "a[i] := 1;")


def test_enumerations_are_numbers_with_names() -> None:
    instance = main(
        "c : Colour; n : INT; is : BOOL; local : (One, Two, Three);",
        "c := Green; is := c = Colour#Green; n := Blue; local := Three;",
        more=TYPES,
    )
    assert (instance["c"], instance["is"], instance["n"], instance["local"]) == (5, True, 6, 2)
    instance["c"] = "Red"
    assert instance["c"] == 0


def test_the_initial_value_of_an_enumeration_is_one_of_its_own_names() -> None:
    more = "TYPE Mode : (Idle := 3, Busy := 10) UINT := Busy; END_TYPE"
    instance = main("mode : Mode; n : INT; own : Mode := Idle;", "n := UINT_TO_INT(mode);", more=more)
    assert (instance["mode"], instance["n"], instance["own"]) == (10, 10, 3)


def test_values_of_enumerations_are_shown_as_they_are_declared() -> None:
    """Also those of members and elements, of a start value of their own, and of an enumeration in place."""
    project = project_of(
        "TYPE Mode : (Idle, Busy); Settings : STRUCT m, other : Mode; END_STRUCT; END_TYPE\nPROGRAM Main\n"
        "VAR mode : Mode; s : Settings := (m := Busy); all : ARRAY[1..2] OF Mode; here : (One, Two); END_VAR\n"
        "mode := Busy; here := Two;\nEND_PROGRAM"
    )
    names = ["mode", "s.m", "s.other", "all[2]", "here"]
    trace = sfc.simulate(project, pou="Main", scans=1, record=names)
    shown = str(trace).splitlines()[-1].split()
    assert shown[-5:] == ["Busy", "Busy", "Idle", "Idle", "Two"]


def test_enumerations_of_codesys_are_named_with_their_type() -> None:
    assert main("n : INT;", "n := Colour.Green;", Dialect.CODESYS, more=TYPES)["n"] == 5


def test_strings_are_cut_to_their_length() -> None:
    instance = main("s : STRING[5] := 'abc'; l : INT;", "s := CONCAT(s, 'defg'); l := LEN(s);")
    assert (instance["s"], instance["l"]) == ("abcde", 5)
    assert (
        main("s : STRING; i : INT;", "FOR i := 1 TO 50 DO s := CONCAT(s, 'xx'); END_FOR", Dialect.CODESYS)["s"]
        == 80 * "x"
    )


def test_constants() -> None:
    text = """
    PROGRAM Main
    VAR CONSTANT last : INT := 3; size : INT := last * 2; END_VAR
    VAR a : ARRAY[1..size] OF INT; n : INT; END_VAR
    a[size] := last; n := a[6];
    END_PROGRAM"""
    instance = start(text)
    instance.scan()
    assert instance["n"] == 3
    with pytest.raises(SimulationError, match="last is a constant"):
        Controller(project_of(text.replace("n := a[6];", "last := 4;"))).instance("Main").scan()


def test_initial_values_may_use_other_variables() -> None:
    assert main("a : INT := 4; b : INT := a * 2;", "")["b"] == 8


GLOBALS = """
CONFIGURATION C
VAR_GLOBAL counter : INT := 10; flag : BOOL; point : Point; END_VAR
RESOURCE R ON PLC
END_RESOURCE
END_CONFIGURATION
FUNCTION_BLOCK Other
VAR_EXTERNAL counter : INT; END_VAR
counter := counter + 1;
END_FUNCTION_BLOCK
"""


def test_global_variables_are_shared() -> None:
    text = f"{TYPES}{GLOBALS}PROGRAM Main\nVAR_EXTERNAL counter : INT; END_VAR\nVAR o : Other; END_VAR\n"
    instance = start(text + "o(); counter := counter + 100; point.x := counter;\nEND_PROGRAM")
    instance.scan()
    assert (instance["counter"], instance["point.x"], instance["o.counter"]) == (111, 111, 111)


def test_lists_of_global_variables_are_named() -> None:
    project = project_of("PROGRAM Main\nVAR x : INT; END_VAR\nGVL.a := GVL.a + 1; x := a + OTHER.a;\nEND_PROGRAM")
    project.dialect = Dialect.CODESYS
    project.global_variables += [
        VariableSection(name="GVL", variables=[Variable(name="a", type="INT", initial="5")]),
        VariableSection(name="OTHER", variables=[Variable(name="b", type="INT", initial="9")]),
    ]
    project.pous[0].bodies[0].text = "GVL.a := GVL.a + 1; x := a + OTHER.b;"  # type: ignore[union-attr]
    instance = Controller(project).instance("Main")
    instance.scan()
    assert (instance["x"], instance["GVL.a"]) == (15, 6)


def test_data_blocks_and_tags_of_s7() -> None:
    project = project_of(f"{TYPES}PROGRAM Main\nVAR x : INT; END_VAR\nx := 1;\nEND_PROGRAM")
    project.dialect = Dialect.SCL
    project.data_blocks.append(
        DataBlock(name="Recipe", interface=Interface(sections=[VariableSection(variables=[
            Variable(name="level", type="INT", initial="7"), Variable(name="p", type="Point")])]))
    )  # fmt: skip
    project.tag_tables.append(TagTable(name="T", tags=[Tag(name="Start", type="Bool", address="%I0.0")]))
    project.pous[0].bodies[0].text = (  # type: ignore[union-attr]
        'IF "Start" THEN "Recipe".level := "Recipe".level + 1; END_IF; '
        '#x := "Recipe".level + "Recipe".p.x; %Q0.1 := %I0.0;'
    )
    instance = Controller(project).instance("Main")
    instance["Start"] = True
    instance.scan()
    assert (instance["x"], instance["Recipe.level"], instance["%Q0.1"], instance["%I0.0"]) == (9, 8, True, True)


def test_members_of_data_blocks_are_inputs_where_they_have_no_start_value() -> None:
    """As variables of global lists: else the same chart gets other inputs as a block of TIA Portal."""
    project = project_of(f"{TYPES}PROGRAM Main\nVAR x : INT; END_VAR\nx := 1;\nEND_PROGRAM")
    project.dialect = Dialect.SCL
    variables = [
        Variable(name="level", type="INT", initial="7"),
        Variable(name="p", type="Point", initial=StructValue(members=[MemberValue(member="y", value="3")])),
        Variable(name="free", type="INT"),
    ]
    project.data_blocks.append(
        DataBlock(name="Recipe", interface=Interface(sections=[VariableSection(variables=variables)]))
    )
    project.pous[0].bodies[0].text = '#x := "Recipe".level + "Recipe".p.y + "Recipe".free;'  # type: ignore[union-attr]
    instance = Controller(project).instance("Main")
    instance.scan()
    assert [*instance.inputs()] == ["Recipe.free"]


def test_addresses_are_variables() -> None:
    instance = main("a AT %IX0.0 : BOOL; b AT %QW2 : INT;", "%MW4 := 7; b := %MW4; %QX0.1 := a;")
    assert (instance["b"], instance["%QW2"], instance["%QX0.1"]) == (7, 7, False)
    instance["a"] = True
    instance.scan()
    assert instance["%QX0.1"] is True


def test_addresses_that_overlap_are_refused() -> None:
    with pytest.raises(SimulationError, match=r"%MX0\.1 overlaps %MW0"):
        Controller(project_of("PROGRAM Main\n%MW0 := 3; %MX0.1 := TRUE;\nEND_PROGRAM")).instance("Main").scan()


def test_bits_of_words() -> None:
    instance = main(
        "w : WORD; i : INT; b : BOOL; d : DWORD := 16#12345678; x : BYTE;",
        "w.3 := TRUE; i.15 := TRUE; b := w.3 AND NOT w.2; d.%B1 := 16#FF; x := d.%B3; w.0 := w.3;",
    )
    assert [instance[name] for name in ("w", "i", "b", "d", "x")] == [9, -32768, True, 0x1234FF78, 0x12]
    instance["w.1"] = True
    assert (instance["w"], instance["w.1"], instance["w.%X2"]) == (11, True, False)


def test_constants_name_bits_in_codesys() -> None:
    declared = "w : WORD; b : BOOL; END_VAR VAR CONSTANT B1 : INT := 2; BB : INT := B1 + 1;"
    instance = main(declared, "w.BB := TRUE; b := w.bb AND NOT w.B1;", Dialect.CODESYS)
    assert (instance["w"], instance["b"]) == (8, True)
    project = project_of(f"PROGRAM Main\nVAR {declared} END_VAR\nw.BB := TRUE;\nEND_PROGRAM")
    controller = Controller(project)
    controller.instance("Main")
    assert [problem.message for problem in controller.problems] == ["w is a WORD: it has no BB"]


def test_names_that_nobody_declares_are_external_variables() -> None:
    project = project_of(
        "PROGRAM Main\nVAR x : INT; t : TIME; END_VAR\nStart := Motor.Ready AND (Level > 3.5);\nEND_PROGRAM"
    )
    project.pous[0].bodies[0].text = (  # type: ignore[union-attr]
        "Lamp := Motor.Ready AND Level > 3.5; x := Offset + 1; IF Delay > t THEN Total := x; END_IF; Text := 'a';"
    )
    controller = Controller(project)
    instance = controller.instance("Main")
    types = {name: type_.name for name, type_ in controller.undeclared.items()}
    assert types == {
        "Lamp": "BOOL", "Motor.Ready": "BOOL", "Level": "LREAL", "Offset": "INT", "Delay": "TIME", "Total": "INT",
        "Text": "STRING",
    }  # fmt: skip
    instance["Motor.Ready"] = True
    instance["level"] = 4.0
    instance["Offset"] = 41
    instance.scan()
    assert (instance["Lamp"], instance["x"], instance["Total"]) == (True, 42, 0)


def test_paths_that_lead_nowhere_are_errors_of_the_model() -> None:
    instance = main("counter : INT; a : ARRAY[1..3] OF INT;", "")
    with pytest.raises(ModelError, match=r"there is no variable countr\n.*counter"):
        instance["countr"]
    with pytest.raises(ModelError, match=r"outside of 1\.\.3"):
        instance["a[4]"]
    with pytest.raises(ModelError, match="no path"):
        instance["a["]
    with pytest.raises(SimulationError, match="'x' is no INT"):
        instance["counter"] = "x"
    instance["counter"] = 40000
    assert instance["counter"] == 40000 - 65536


def test_temporary_variables_start_anew() -> None:
    text = "PROGRAM Main\nVAR_TEMP t : INT := 5; END_VAR\nVAR n : INT; END_VAR\nt := t + 1; n := n + t;\nEND_PROGRAM"
    instance = start(text)
    instance.scan()
    instance.scan()
    assert instance["n"] == 12


def test_arrays_of_any_length() -> None:
    more = """FUNCTION Total : DINT
    VAR_IN_OUT a : ARRAY[*] OF INT; END_VAR
    VAR i : DINT; END_VAR
    FOR i := LOWER_BOUND(a, 1) TO UPPER_BOUND(a, 1) DO Total := Total + a[i]; a[i] := 0; END_FOR
    END_FUNCTION
    FUNCTION Both : DINT
    VAR_IN_OUT a : ARRAY[*] OF INT; END_VAR
    Both := Total(a) + a[7];
    END_FUNCTION"""
    declared = "x : ARRAY[-1..1] OF INT := [1, 2, 3]; y : ARRAY[5..7] OF INT := [10, 20, 30]; n, m : DINT;"
    instance = main(declared, "n := Total(x); m := Both(y);", more=more)
    assert (instance["n"], instance["m"], instance["x[0]"], instance["y[5]"]) == (6, 60, 0, 0)
    with pytest.raises(SimulationError, match=r"the index 7 is outside of -1\.\.1"):
        main(declared, "m := Both(x);", more=more)


def test_characters_of_strings() -> None:
    declared = "s : STRING := 'abc'; c : CHAR; b : BYTE; i : INT := 1;"
    assert main(declared, "#c := #s[#i];", Dialect.SCL)["c"] == "a"
    assert main(declared, "b := s[i];", Dialect.CODESYS)["b"] == ord("b")


def test_a_comparison_tells_a_start_value_of_a_member_that_is_not_there() -> None:
    text = """
        TYPE Part : STRUCT a : INT; END_STRUCT; END_TYPE
        PROGRAM Main
        VAR_OUTPUT n : INT; END_VAR
        VAR p : Part := (%s := 1); END_VAR
        n := p.a;
        END_PROGRAM"""
    right, wrong = (project_of(text % member) for member in "ab")
    verdict = sfc.equivalent(right.pou("Main"), wrong.pou("Main"))
    assert not verdict.equal
    assert "Part has no member b" in str(verdict)
