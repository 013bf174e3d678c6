"""Types that S7 does not have, and the initial values that variables have by them."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import equivalent
from plcopen_sfc.api import convert
from plcopen_sfc.report import Outcome

TYPES = """TYPE
  Color : (red, green, blue) := green;
  Level : INT := 7;
  Box : STRUCT c : Color; l : Level; e : Color := blue; END_STRUCT;
  Deep : STRUCT b : Box; a : ARRAY[1..2] OF Level; END_STRUCT;
END_TYPE
FUNCTION_BLOCK Main
VAR_OUTPUT n : INT; END_VAR
VAR
  c : Color; l : Level; colors : ARRAY[1..3] OF Color; mine : ARRAY[1..3] OF Color := [red, 2(blue)];
  levels : ARRAY[0..1, 1..2] OF Level; box : Box; deep : Deep; here : STRUCT c : Color; l : Level; END_STRUCT;
END_VAR
n := l + levels[1, 2] + box.l + deep.a[2] + here.l;
END_FUNCTION_BLOCK
"""


@pytest.mark.parametrize("target", ["simaticml", "scl", "codesys", "plcopen"])
def test_initial_values_of_types_are_those_of_arrays_and_members(target: str) -> None:
    project = sfc.loads(TYPES.encode(), format="iec-text")
    data, report = sfc.convert(project, target)
    assert report.losses == []
    result = sfc.loads(data, format=target, as_tool=True)
    variables = {variable.name: variable for variable in result.pou("Main").variables()}
    if target in ("simaticml", "scl"):
        assert variables["levels"].initial == m.ArrayValue(
            items=[m.RepeatedValue(value=m.SimpleValue(text="7"), repetitions="4")]
        )
    assert sfc.simulate(result, pou="Main", scans=1)["n"] == [35]


EXTENDED = """{plcopen_sfc project.dialect := 'codesys'}
TYPE Third EXTENDS second : STRUCT c : INT := 3; END_STRUCT; END_TYPE
TYPE Second EXTENDS First : STRUCT b : INT := 2; END_STRUCT; END_TYPE
TYPE First : STRUCT a : INT := 1; END_STRUCT; END_TYPE
FUNCTION_BLOCK Main
VAR_OUTPUT n : INT; END_VAR
VAR x : Third := (c := 5, a := 7); y : Second; END_VAR
n := n + x.a * 1000 + x.b * 100 + x.c * 10 + y.a;
END_FUNCTION_BLOCK
"""


@pytest.mark.parametrize("target", ["simaticml", "scl", "codesys", "plcopen", "codesys23"])
def test_structures_have_the_members_of_those_that_they_extend(target: str) -> None:
    data, report = sfc.convert(sfc.loads(EXTENDED.encode(), format="iec-text"), target)
    assert report.losses == []
    result = sfc.loads(data, format=target, as_tool=True)
    assert sfc.simulate(result, pou="Main", scans=2)["n"] == [7251, 14502]


FUNCTION = """FUNCTION F : INT
VAR_INPUT x : INT := 5; y : INT; END_VAR
VAR CONSTANT k : INT := 2; END_VAR
VAR t : Level; END_VAR
F := x + y + k;
END_FUNCTION
TYPE Level : INT := 7; END_TYPE
"""


@pytest.mark.parametrize("target", ["simaticml", "scl"])
def test_start_values_that_functions_of_s7_do_not_have_are_told_and_not_written(target: str) -> None:
    data, report = sfc.convert(sfc.loads(FUNCTION.encode(), format="iec-text"), target, partial=True)
    why = "parameters of functions and temporary variables have no start value in S7"
    assert {(item.outcome, item.path, item.why) for item in report.losses} == {
        (Outcome.NOT_EXECUTED, "POU F / x", why),
        (Outcome.NOT_EXECUTED, "POU F / t", why),
    }
    result = sfc.loads(data, format=target, as_tool=True).pou("F")
    starts = {variable.name: variable.initial for variable in result.variables() if variable.initial is not None}
    assert starts == {"k": m.SimpleValue(text="2")}


BEGUN = """FUNCTION F : INT
VAR_INPUT x : INT; END_VAR
VAR k : INT := 2; r : REAL := 1.5; END_VAR
k := k + x; F := k + REAL_TO_INT(r * 2.0);
END_FUNCTION
FUNCTION_BLOCK Main
VAR_INPUT a : INT; END_VAR
VAR_OUTPUT n : INT; END_VAR
VAR_TEMP t : INT := 4; END_VAR
t := t + F(a); n := t;
END_FUNCTION_BLOCK
"""


@pytest.mark.parametrize("target", ["simaticml", "scl"])
def test_start_values_that_s7_does_not_have_are_statements(target: str) -> None:
    project = sfc.loads(BEGUN.encode(), format="iec-text")
    data, report = sfc.convert(project, target)
    assert {item.what for item in report.losses} <= {"text"}  # REAL_TO_INT rounds otherwise
    paths = [item.path for item in report.items if item.what == "initial value"]
    assert paths == ["POU F / variable k", "POU F / variable r", "POU Main / variable t"]
    result = sfc.loads(data, format=target, as_tool=True)
    assert sfc.simulate(result, pou="Main", scans=2)["n"] == sfc.simulate(project, pou="Main", scans=2)["n"] == [9, 9]


@pytest.mark.parametrize(("source", "target", "length"), [("scl", "codesys", "254"), ("codesys", "scl", "80")])
def test_strings_keep_the_length_that_their_tool_gives_them(source: str, target: str, length: str) -> None:
    section = m.VariableSection(variables=[m.Variable(name="s", type="STRING")])
    pou = m.Pou(
        name="Main",
        kind=m.PouKind.FUNCTION_BLOCK,
        interface=m.Interface(sections=[section]),
        bodies=[m.StBody(text=";")],
    )
    data, report = convert(m.Project(pous=[pou], dialect=m.Dialect(source)), target)
    assert not report.losses
    found = sfc.loads(data, as_tool=True).pous[0].variables()[0].type
    assert found == m.StringType(length=length)


@pytest.mark.parametrize("call", ["REAL_TO_INT(r)", "INT_TO_STRING(i)"])
@pytest.mark.parametrize(("source", "target"), [("scl", "codesys"), ("codesys", "scl"), ("codesys", "simaticml")])
def test_conversions_with_other_results_are_approximated(source: str, target: str, call: str) -> None:
    result = "INT" if call.endswith("(r)") else "STRING"
    variables = [m.Variable(name=name, type=kind) for name, kind in (("r", "REAL"), ("i", "INT"), ("o", result))]
    local = "#" if source == "scl" else ""
    text = f"{local}o := {call.replace('(', '(' + local)};"
    pou = m.Pou(
        name="Main",
        kind=m.PouKind.FUNCTION_BLOCK,
        interface=m.Interface(sections=[m.VariableSection(variables=variables)]),
        bodies=[m.StBody(text=text)],
    )
    report = convert(m.Project(pous=[pou], dialect=m.Dialect(source)), target)[1]
    assert [item.outcome for item in report.losses] == [Outcome.APPROXIMATED]


@pytest.mark.parametrize("target", ["simaticml", "scl"])
@pytest.mark.parametrize("declared", ["INT (0..10)", "Percent", "ARRAY [1..2] OF Percent"])
def test_bounds_of_subranges_are_told_where_nothing_checks_them(declared: str, target: str) -> None:
    text = f"""TYPE Percent : INT (0..10); END_TYPE
FUNCTION_BLOCK Main
VAR_INPUT x : INT; END_VAR
VAR r : {declared}; END_VAR
x := x + 1;
END_FUNCTION_BLOCK
"""
    _, report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), target, partial=True)
    assert [item.outcome for item in report.losses if item.path == "POU Main / r"] == [Outcome.APPROXIMATED]


@pytest.mark.parametrize("target", ["simaticml", "scl"])
def test_a_parameter_of_a_function_does_not_start_as_its_type(target: str) -> None:
    """Each call passes it."""
    text = """TYPE Mode : (Off := 1, On); END_TYPE
FUNCTION Next : INT
VAR_INPUT given : Mode; k : INT := 3; END_VAR
VAR_IN_OUT kept : Mode; END_VAR
kept := given;
END_FUNCTION
"""
    _, report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), target, partial=True)
    assert [item.path for item in report.losses if item.what == "initial"] == ["POU Next / k"]


NUMBERED = """TYPE
  Level : (Low := 1, Mid := 5, High := 9) := Mid;
  Plain : (One, Two);
  Tank : STRUCT lvl : Level := Level#High; END_STRUCT;
END_TYPE
FUNCTION_BLOCK Main
VAR_INPUT go : BOOL; Low : INT; END_VAR
VAR l : Level; k : Level := High; p : Plain; tank : Tank; END_VAR
VAR_OUTPUT q, n : INT; END_VAR
CASE l OF Level#Low: l := Level#Mid; Mid, High: l := Level#Low; q := SEL(Low = 2, 0, 1); END_CASE;
IF go AND k = Level#High AND tank.lvl = k THEN p := Two; k := Level#Mid; END_IF;
n := SEL(k = High, 0, 1);
END_FUNCTION_BLOCK
"""


def test_enumerations_that_do_not_count_from_0_are_numbers_for_matiec() -> None:
    """The input `Low` hides the value of its name."""
    source = sfc.loads(NUMBERED.encode(), format="iec-text")
    data, report = sfc.convert(source, "iec-text", flavour="matiec")
    assert [item.place for item in report.items if item.what == "enumeration"] == ["enumeration data type Level"]
    assert report.losses == []
    written = sfc.loads(data, format="iec-text", as_tool=True)
    assert "CASE l OF 1: l := 5; 5, 9: l := 1; q := SEL(Low = 2, 0, 1); END_CASE;" in data.decode()
    assert equivalent(source.pou("Main"), written.pou("Main"), outputs=["q", "n"]).equal


@pytest.mark.parametrize("target", ["codesys", "twincat", "codesys23"])
@pytest.mark.parametrize("place", ["PROGRAM Main VAR c : {}; END_VAR END_PROGRAM", "TAG"])
def test_characters_are_told_where_no_type_has_them(place: str, target: str) -> None:
    """CHAR went to CODESYS as kept, where no declaration with it compiles."""
    if place == "TAG":
        tags = [m.Tag(name="c", type="Char", address="%MB3"), m.Tag(name="t", type="Time_Of_Day", address="%MD4")]
        project = m.Project(tag_tables=[m.TagTable(name="Tags", tags=tags)], dialect=m.Dialect.SCL)
    else:
        project = sfc.loads(place.format("ARRAY[0..3] OF CHAR").encode(), format="iec-text")
    report = sfc.convert(project, target, partial=True)[1]
    (told,) = report.with_outcome(Outcome.NOT_EXECUTED)
    assert "has no type C" in told.why


@pytest.mark.parametrize(
    ("declared", "fits"), [("STRING[254]", True), ("ARRAY[0..1] OF STRING[255]", False), ("WSTRING[300]", True)]
)
@pytest.mark.parametrize("target", ["simaticml", "scl"])
def test_strings_that_are_longer_than_those_of_s7_are_told(declared: str, fits: bool, target: str) -> None:
    text = f"FUNCTION_BLOCK Main VAR s : {declared}; END_VAR END_FUNCTION_BLOCK"
    report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), target, partial=True)[1]
    told = [item.path for item in report.with_outcome(Outcome.NOT_EXECUTED) if "TIA Portal has no type" in item.why]
    assert len(told) == (not fits)
    assert all(path.endswith(" s") for path in told)
