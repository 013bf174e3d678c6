"""Start values and retention of data blocks in other tools: those of every element, wherever the source says them."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.api import convert
from plcopen_sfc.conversion import compare, executed
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.report import START_OF_CHART, Outcome

TARGETS = ("codesys", "plcopen-2.01", "plcopen-1.01", "scl", "simaticml")
BLOCK = """
FUNCTION_BLOCK "Counter"
   VAR_OUTPUT
      o : Int;
   END_VAR
   VAR
      n : Int := 5;
      row : Array[1..3] of Int;
   END_VAR
BEGIN
   #o := #n;
END_FUNCTION_BLOCK
"""
SOURCES = {
    "BEGIN counts, not the declaration": """
DATA_BLOCK "Recipe"
   STRUCT
      limit : Int := 100;
      time : Time;
   END_STRUCT;
BEGIN
   limit := 2000;
   time := T#5s;
END_DATA_BLOCK
""",
    "RETAIN": """
DATA_BLOCK "Recipe"
RETAIN
   STRUCT
      limit : Int;
   END_STRUCT;
BEGIN
   limit := 2000; // litres
END_DATA_BLOCK
""",
    "elements": """
TYPE "Entry"
   STRUCT
      x : Int := 3;
      y : Array[0..2] of Real;
   END_STRUCT;
END_TYPE
DATA_BLOCK "Recipe"
   VAR
      u : "Entry";
      v : Array[1..2] of "Entry";
      s : Struct
         z : Array[0..1] of Struct
            k : Int;
         END_STRUCT;
      END_STRUCT;
   END_VAR
BEGIN
   u.x := 9;
   u.y[1] := 2.5;
   v[2].y[0] := 4.5;
   s.z[1].k := 31;
END_DATA_BLOCK
""",
    "instance": BLOCK
    + """
DATA_BLOCK "Counter_1"
"Counter"
BEGIN
   n := 11;
   row[2] := 7;
END_DATA_BLOCK
""",
    "retained instance": BLOCK
    + """
DATA_BLOCK "Counter_1"
RETAIN
"Counter"
BEGIN
   n := 11;
END_DATA_BLOCK
""",
    "of a data type": """
TYPE "Entry"
   STRUCT
      x : Int := 3;
      y : Array[0..2] of Real;
   END_STRUCT;
END_TYPE
DATA_BLOCK "Recipe"
"Entry"
BEGIN
   x := 9;
   y[1] := 2.5;
END_DATA_BLOCK
""",
}


def load(text: str) -> sfc.Project:
    return sfc.loads(text.encode(), format="scl")


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("what", SOURCES)
def test_start_values_arrive(what: str, target: str) -> None:
    project = load(SOURCES[what])
    data, report = convert(project, target)
    assert not report.losses, report.losses
    assert b"16#0" not in data


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("what", SOURCES)
def test_start_values_come_back(what: str, target: str) -> None:
    project = load(SOURCES[what])
    back = sfc.loads(convert(project, target)[0])
    again = sfc.loads(convert(back, "scl")[0], as_tool=True)
    assert not list(compare(executed(load(SOURCES[what])), executed(again)))


LOST = {
    "initial value": "   limit := 2000;\n",
    "one element": "   row[2] := 7;\n",
    "one member": "   u.x := 9;\n",
    "retain": "RETAIN\n",
    "instance": "   n := 11;\n",
}


@pytest.mark.parametrize("what", LOST)
def test_the_comparison_sees_each_start_value(what: str) -> None:
    for text in (text for text in SOURCES.values() if LOST[what] in text):
        found = list(compare(executed(load(text)), executed(load(text.replace(LOST[what], "")))))
        assert found, text


def test_the_simulation_starts_with_the_values_of_an_instance() -> None:
    text = BLOCK + 'DATA_BLOCK "Counter_1"\n"Counter"\nBEGIN\n   n := 11;\nEND_DATA_BLOCK\n'
    text += 'FUNCTION_BLOCK "Main"\nVAR_OUTPUT\n  q : Int;\nEND_VAR\nBEGIN\n  "Counter_1"();\n'
    text += '  #q := "Counter_1".o;\nEND_FUNCTION_BLOCK\n'
    trace = sfc.simulate(load(text), pou="Main", scans=1)
    assert trace["q"][0] == 11


def test_start_values_that_are_not_read_are_not_lost_without_a_word() -> None:
    text = 'DATA_BLOCK "Recipe"\n   STRUCT\n      a : Int;\n   END_STRUCT;\nBEGIN\n   b := 1;\nEND_DATA_BLOCK\n'
    report = convert(load(text), "codesys", partial=True)[1]
    assert any(item.what == "start values" for item in report.with_outcome(Outcome.NOT_EXECUTED))


NESTED = """<?xml version="1.0" encoding="utf-8"?>
<Document><Engineering version="V20" /><SW.Blocks.GlobalDB ID="0"><AttributeList><Interface><Sections
xmlns="http://www.siemens.com/automation/Openness/SW/Interface/v5"><Section Name="Static">
<Member Name="u" Datatype="Array[1..2] of &quot;Entry&quot;"><Sections><Section Name="None">
<Member Name="x" Datatype="Int"><Subelement Path="2"><StartValue>9</StartValue></Subelement></Member>
<Member Name="y" Datatype="Array[0..2] of Real"><Subelement Path="1,2"><StartValue>2.5</StartValue></Subelement>
</Member>
</Section></Sections></Member></Section></Sections></Interface><Name>Recipe</Name><Number>5</Number>
<ProgrammingLanguage>DB</ProgrammingLanguage></AttributeList></SW.Blocks.GlobalDB></Document>
"""


def test_start_values_in_members_of_simaticml_are_edited() -> None:
    project = sfc.loads(NESTED.encode())
    interface = project.data_blocks[0].interface
    assert interface is not None
    variable = interface.variables()[0]
    assert isinstance(variable.initial, m.ArrayValue)
    second = variable.initial.items[1].value
    assert isinstance(second, m.StructValue)
    assert [(each.member, each.value) for each in second.members] == [("x", m.SimpleValue(text="9"))]
    second.members[0].value = m.SimpleValue(text="10")
    data = sfc.dumps(project)
    assert data.decode() == NESTED.replace(">9<", ">10<")


INSTANCE = """
FUNCTION_BLOCK Main
  VAR_INPUT a : BOOL; END_VAR
  VAR_OUTPUT q : BOOL; END_VAR
  VAR t : TON := (PT := T#100ms); last : TIME; END_VAR
  {body}
END_FUNCTION_BLOCK
"""
CHART = """INITIAL_STEP S: Act(N); END_STEP
TRANSITION FROM S TO Z := {condition}; END_TRANSITION
STEP Z: END_STEP
TRANSITION FROM Z TO S := NOT a; END_TRANSITION
ACTION Act: t(IN := a{passed}); q := t.Q; END_ACTION"""


@pytest.mark.parametrize(
    ("body", "becomes"),
    [
        ("t(IN := a); q := t.Q;", "calls pass it"),
        ("IF a THEN t(IN := a); ELSE t(IN := FALSE); END_IF; q := t.Q;", "calls pass it"),
        ("t(IN := a, PT := T#50ms); q := t.Q;", "without effect: all calls pass these inputs"),
        (CHART.format(condition="t.Q", passed=""), "calls pass it"),
        (CHART.format(condition="t.Q", passed=", PT := T#50ms"), "without effect: all calls pass these inputs"),
        ("t(IN := a); t(IN := a, PT := T#50ms); q := t.Q;", ""),
        ("t.PT := T#50ms; t(IN := a); q := t.Q;", ""),
        ("t(IN := a); last := t.PT; q := t.Q;", ""),
        ("t(a); q := t.Q;", ""),
    ],
)
def test_calls_pass_start_values_of_timers_to_tia_portal(body: str, becomes: str) -> None:
    project = sfc.loads(INSTANCE.format(body=body).encode(), format="iec-text")
    data, report = convert(project, "simaticml", partial=True, limit=3)
    lost = [item.what for item in report.with_outcome(Outcome.NOT_EXECUTED)]
    assert lost == ([] if becomes else ["initial"])
    assert next(item.why for item in report.items if item.what == "initial").startswith(becomes)
    assert not any(verdict.startswith("different") for verdict in report.compared.values())
    back = sfc.loads(convert(sfc.loads(data), "codesys")[0])
    assert not list(compare(executed(project), executed(back)))


def test_functions_of_actions_pass_start_values_in_folders(tmp_path: Path) -> None:
    body = CHART.format(condition="t.Q", passed="")
    project = sfc.loads(INSTANCE.format(body=body).encode(), format="iec-text")
    report = sfc.save(project, f"{tmp_path / 'out'}/", format="simaticml")
    assert [item.what for item in report.losses] == [START_OF_CHART]
    texts = {path.stem: path.read_text("utf-8") for path in (tmp_path / "out").rglob("*.xml")}
    assert "Main_Act" in texts
    assert "Main_Act_2" not in "".join(texts.values())
    assert texts["Main_Act"].count('Parameter Name="PT"') == 1


CALCULATED = """
{plcopen_sfc format := 1}
{plcopen_sfc project.dialect := '%s'}
{plcopen_sfc name := 'GVL'}
VAR_GLOBAL CONSTANT
  K1 : INT := 3;
  K2 : INT := K1 * 2 + 1;
  K3 : INT := K2;
END_VAR
FUNCTION_BLOCK FB_A
VAR CONSTANT
  L1 : INT := 4;
  L2 : INT := L1 + %sK2;
END_VAR
VAR_OUTPUT q : BOOL; END_VAR
VAR x : %s; END_VAR
q := TRUE;
END_FUNCTION_BLOCK
"""


@pytest.mark.parametrize(
    ("declared", "written"),
    [
        ("INT := L2", "<StartValue>#L2</StartValue>"),
        ("INT := -5", "<StartValue>-5</StartValue>"),
        ("INT := -L2 * (K3 - 1)", "<StartValue>-66</StartValue>"),
        ("INT := -7 / 2 + L1 MOD K1", "<StartValue>-2</StartValue>"),
        ("WORD := K2 * 2", "<StartValue>16#E</StartValue>"),
        ("REAL := K1 / 4.0", "<StartValue>0.75</StartValue>"),
        ("BOOL := NOT FALSE AND TRUE", "<StartValue>TRUE</StartValue>"),
        ("TIME := T#1s * L1 + T#500ms", "<StartValue>T#4s500ms</StartValue>"),
        ("ARRAY[0..1] OF INT := [L2 * 2, K1]", "<StartValue>22</StartValue>"),
        ("ARRAY[0..L1 - 1, 1..K1*2] OF INT", "Array[0..3, 1..6] of Int"),
        ("STRING(K1 + 4)", "String[7]"),
        ("SINT := K2 * 100", ""),
        ("INT := K1 / (L1 - 4)", ""),
        ("INT := INT#32767 * 100000 * 100000", ""),
        ("REAL := SQRT(4.0)", ""),
        ("INT := L1 + 1 - UINT#6", ""),
    ],
)
def test_calculated_constants_are_values_in_tia_portal(declared: str, written: str) -> None:
    for dialect, list_ in (("codesys", "GVL."), ("iec", "")):
        project = sfc.loads((CALCULATED % (dialect, list_, declared)).encode(), format="iec-text")
        data, report = convert(project, "simaticml", partial=True, limit=3)
        text = data.decode()
        assert "<StartValue>11</StartValue>" in text
        assert text.count("<Value>7</Value>") == 2
        lost = [item.what for item in report.with_outcome(Outcome.NOT_EXECUTED)]
        assert (written in text) if written else "constant expression" in lost, (dialect, lost)
        assert not written or not lost, report.losses
        assert not any(verdict.startswith("different") for verdict in report.compared.values())


def test_calculations_in_files_of_tia_portal_are_errors_before_an_import() -> None:
    project = sfc.loads((CALCULATED % ("codesys", "GVL.", "INT := L2")).encode(), format="iec-text")
    good = convert(project, "simaticml", limit=3)[0].replace(b' encoding="utf-8"', b"")
    assert not [each for each in sfc.check_import(sfc.loads(good), "tia") if each.message.startswith("constant expr")]
    bad = good.replace(b"<StartValue>11</StartValue>", b'<StartValue>#L1 + "K2"</StartValue>')
    bad = bad.replace(b"<StartValue>#L2</StartValue>", b"<StartValue>#L2 * 2</StartValue>")
    found = [each for each in sfc.check_import(sfc.loads(bad), "tia") if each.message.startswith("constant expr")]
    assert [(each.code, each.severity) for each in found] == [("IMP001", Severity.ERROR)] * 2


def test_calculations_in_scl_are_values_in_simaticml() -> None:
    text = BLOCK.replace("n : Int := 5;", "n : Int := 2 * 3 + 1;").replace("1..3", "1..2 + 1")
    data, report = convert(load(text), "simaticml")
    assert not report.losses
    assert b"<StartValue>7</StartValue>" in data
    assert b"Array[1..3] of Int" in data


ENDLESS = """
TYPE A : STRUCT
%s
END_STRUCT; END_TYPE
TYPE B : STRUCT
%s
END_STRUCT; END_TYPE
PROGRAM Main
VAR a : A; While1 : BOOL; END_VAR
While1 := a.b1.a1.on;
END_PROGRAM
"""


def test_types_that_contain_themselves_are_looked_through_once() -> None:
    of_a = "\n".join(f"b{number} : B := (on := TRUE);" for number in range(12)) + "on : BOOL;"
    source = sfc.loads((ENDLESS % (of_a, of_a.replace("b", "a").replace(": B", ": A"))).encode(), format="iec-text")
    in_s7 = sfc.loads(convert(source, "scl", partial=True)[0], format="scl")
    in_s7.rename("Main.While1", "Ein Taster")  # a name that other tools do not take
    for project in (source, in_s7):
        there = sfc.loads(convert(project, "codesys", partial=True)[0])
        assert {each.name for each in there.data_types} == {"A", "B"}


@pytest.mark.parametrize(
    ("value", "last"),
    [
        ("[(a := 3), (a := 3), 1((a := 5))]", 5),
        ("[1((a := 1, b := TRUE)), (a := 2), 1((a := 4))]", 4),
        ("[(a := 3), 1((b := TRUE)), (a := 6)]", 6),
        ("[1((a := 3)), ()]", 0),
        ("[2((a := 7)), (a := 7)]", 7),
    ],
)
@pytest.mark.parametrize("target", ["simaticml", "scl", "codesys", "plcopen-2.01"])
def test_elements_that_are_structures_start_with_their_values_however_they_are_repeated(
    target: str, value: str, last: int
) -> None:
    source = sfc.loads(
        f"""TYPE Pair : STRUCT a : INT; b : BOOL; END_STRUCT END_TYPE
FUNCTION_BLOCK Main
VAR x : ARRAY[1..3] OF Pair := {value}; END_VAR
VAR_OUTPUT y, z : INT; END_VAR
y := x[3].a; z := x[1].a;
END_FUNCTION_BLOCK
""".encode(),
        format="iec-text",
    )
    data, report = convert(source, target)
    assert report.losses == []
    seen = sfc.loads(data, format=target, as_tool=True)
    outputs = [sfc.simulate(each, pou="Main", scans=1, record=["y", "z"]) for each in (source, seen)]
    assert [trace["y"][0] for trace in outputs] == [last] * 2
    assert outputs[0]["z"] == outputs[1]["z"]
    back = sfc.loads(data, format=target).pou("Main")
    assert next(v.initial for v in back.variables() if v.name == "x") == source.pou("Main").variables()[0].initial
