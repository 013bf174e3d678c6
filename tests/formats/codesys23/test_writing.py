"""Projects of other tools as exports for CoDeSys 2.3, and back."""

from __future__ import annotations

import re

import pytest
from hypothesis import HealthCheck, Phase, given, settings

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.model.compare import differences
from plcopen_sfc.model.numbering import numbered_in_order
from plcopen_sfc.refactor.builder import jump, step
from plcopen_sfc.report import Outcome
from tests.corpus import ROOT
from tests.formats.codesys23.test_reading import BELT
from tests.strategies import projects

SOURCES = [
    "codesys/distribution_belt.xml",
    "iectext/mixing_plant.st",
    "scl/filling_line.scl",
    pytest.param("codesys/sorting_conveyor.xml", marks=pytest.mark.slow),
    pytest.param("plcopen/filling_station_2.01.xml", marks=pytest.mark.slow),
    pytest.param("simaticml/FB_Drill.xml", marks=pytest.mark.slow),
]


@pytest.mark.parametrize("name", SOURCES)
def test_projects_of_other_tools_come_back(name: str) -> None:
    project = sfc.load(ROOT / "fixtures" / name)
    data, report = sfc.convert(project, "codesys23", partial=True)
    assert report.with_outcome(Outcome.DROPPED) == []
    assert not [each for each in sfc.loads(data).diagnostics if each.severity == "error"]
    assert b"\n" not in data.replace(b"\r\n", b"")
    assert b"//" not in b"".join(line for line in data.splitlines() if not line.startswith(b"(* {plcopen_sfc"))
    # and once more, from what was read
    again = sfc.loads(data)
    assert sfc.dumps(again) == data
    fresh = sfc.dumps(again, format="codesys23", fresh=True, partial=True)
    assert not list(differences(numbered_in_order(again), numbered_in_order(sfc.loads(fresh))))


def test_steps_of_codesys_v3_as_its_predecessor_has_them() -> None:
    source = """
    {plcopen_sfc format := 1}
    {plcopen_sfc project.dialect := 'codesys'}
    PROGRAM Main
    VAR Ready, Pump : BOOL; END_VAR
    INITIAL_STEP Init: {plcopen_sfc main_action := 'Init_active'} {plcopen_sfc entry_action := 'Init_entry'} END_STEP
    TRANSITION FROM Init TO Run := Ready; END_TRANSITION
    STEP Run: {plcopen_sfc max_time := 'T#5s'} Pump(D, T#2s); END_STEP
    TRANSITION FROM Run TO Init := NOT Ready; END_TRANSITION
    ACTION Init_active: Ready := TRUE; END_ACTION
    ACTION Init_entry: Ready := FALSE; END_ACTION
    END_PROGRAM
    """
    data, report = sfc.convert(sfc.loads(source.encode()), "codesys23")
    text = data.decode("cp1252").replace("\r\n", "\n")
    assert "INITIAL_STEP Init:\nInit_active();\nEND_STEP\n(* @SFCMAXTIME := '' *)\n" in text
    assert "STEP Run:\nPump(D,T#2s);\nEND_STEP\n(* @SFCMAXTIME := 'T#5s' *)\n" in text
    assert "TRANSITION FROM Run TO Init:= \nNOT Ready\nEND_TRANSITION\n" in text
    assert "END_PROGRAM\n\nACTION Init_active:\nReady := TRUE;\nEND_ACTION\n" in text
    assert "{plcopen_sfc" not in text
    # what no export shows is told
    assert [item.what for item in report.with_outcome(Outcome.TRANSLATED)] == ["step action", "action associations"]


def test_characters_of_all_code_pages_come_back() -> None:
    source = "PROGRAM Main\nVAR\n x : INT; (* {} *)\nEND_VAR\nx := 1;\nEND_PROGRAM\n"
    comments = {"größer": "cp1252", "больше": "cp1251", "更大": "cp932", "größer → больше 😀": "cp1252"}
    for comment, page in comments.items():
        data, _ = sfc.convert(sfc.loads(source.format(comment).encode()), "codesys23")
        assert sfc.loads(data).pous[0].variables()[0].comment == comment
        assert data.decode(page)


def test_tasks_are_not_executed() -> None:
    project = sfc.load(ROOT / "fixtures" / "codesys" / "distribution_belt.xml")
    with pytest.raises(sfc.LossError, match="task `MainTask` is NOT executed"):
        sfc.dumps(project, format="codesys23")


@pytest.mark.parametrize("to", ["codesys", "plcopen", "iec-text"])
def test_flags_of_simple_steps_are_members_elsewhere(to: str) -> None:
    text = (
        "PROGRAM Main\nVAR\nGo, Lamp, Out : BOOL;\nEND_VAR\n(* @END_DECLARATION := '0' *)\n"
        "INITIAL_STEP Idle:\nLamp := Idle;\nEND_STEP\nTRANSITION FROM Idle TO Run:=\nGo\nEND_TRANSITION\n"
        "STEP Run:\nLD Run\nAND Go\nST Out\nEND_STEP\nTRANSITION FROM Run TO Idle:=\nRun AND NOT Go\nEND_TRANSITION\n"
        "END_PROGRAM\nACTION Show:\nLamp := Main.Run;\nEND_ACTION\n"
    )
    project = sfc.loads(text.encode(), format="codesys23")
    data, report = sfc.convert(project, to, partial=True)
    assert report.with_outcome(Outcome.DROPPED) == []
    assert [item.path for item in report.items if item.what == "step flag"] == [
        "POU Main / action Show",
        "POU Main / step Idle",
        "POU Main / step Run",
        "POU Main / transition Run -> Idle",
    ]
    written = data.decode()
    assert all(each in written for each in ("Lamp := Idle.x;", "LD Run.x", "Run.x AND NOT Go", "Lamp := Main.Run.x;"))
    # and flags again on the way back
    back = sfc.dumps(sfc.loads(data), format="codesys23", partial=True).decode()
    assert all(each in back for each in ("Lamp := Idle;", "LD Run\r\n", "Run AND NOT Go", "Lamp := Main.Run;"))


def test_declarations_are_in_terms_of_codesys_2_3() -> None:
    source = """
    {plcopen_sfc project.dialect := 'codesys'}
    TYPE Pair : STRUCT a : ARRAY [0..1] OF INT := [1, 2]; // both
      b : BOOL; END_STRUCT; END_TYPE
    PROGRAM Main
    VAR
      x : ARRAY [1..5] OF INT := [1, 2, 3(7)]; // five
      y : ARRAY [1..1] OF INT := [4];
      z : ARRAY [0..1, 0..1] OF INT := [[1, 2], [3, 4]];
      p : Pair := (a := [1, 2], b := TRUE);
      l : ARRAY [0..1] OF Pair := [(b := TRUE, a := [2(7)]), (a := [3, 4])];
    END_VAR
    x[1] := 2; // two
    END_PROGRAM
    """
    project = sfc.loads(source.encode(), format="iec-text")
    data, report = sfc.convert(project, "codesys23")
    text = data.decode("cp1252").replace("\r\n", "\n")
    assert (
        "TYPE Pair :\nSTRUCT\n\ta : ARRAY [0..1] OF INT := 1, 2; (* both *)\n\tb : BOOL;\nEND_STRUCT\nEND_TYPE\n"
        in text
    )
    assert "\tx : ARRAY [1..5] OF INT := 1, 2, 3(7); (* five *)\n\ty : ARRAY [1..1] OF INT := [4];\n" in text
    assert "\tp : Pair := (a := 1, 2, b := TRUE);\n" in text
    assert "\tl : ARRAY [0..1] OF Pair := (b := TRUE, a := 2(7)), (a := 3, 4);\n" in text
    assert "x[1] := 2; (* two *)\n" in text
    assert [item.what for item in report.with_outcome(Outcome.TRANSLATED)] == ["comments"]
    assert sfc.loads(data).pous[0].variables() == project.pous[0].variables()


V3_ONLY = """{{plcopen_sfc project.dialect := 'codesys'}}
TYPE Color : (Red, Green := 5); END_TYPE
PROGRAM Main
VAR a : BOOL; q : BOOL; i : INT; t1 : TIME; col : Color; {variable} END_VAR
INITIAL_STEP Idle: END_STEP
STEP Work: Act(N); END_STEP
TRANSITION FROM Idle TO Work := {condition}; END_TRANSITION
TRANSITION FROM Work TO Idle := NOT a; END_TRANSITION
ACTION Act: {action} END_ACTION
END_PROGRAM"""


@pytest.mark.parametrize(
    ("part", "text", "word"),
    [
        ("condition", "a AND_THEN q", "AND_THEN"),
        ("action", "t1 := TO_TIME(i);", "TO_TIME"),
        ("action", "FOR i := 0 TO 3 DO CONTINUE; END_FOR;", "CONTINUE"),
        ("action", "JMP last; i := 0; last: i := 1;", "jump JMP"),
        ("action", "i += 2;", "+="),
        ("action", "t1 := LTIME_TO_TIME(LTIME#5us);", "LTIME#5us"),
        ("action", "i := XSIZEOF(i);", "function XSIZEOF"),
        ("action", "q := __ISVALIDREF(i);", "function __ISVALIDREF"),
        ("variable", "r : REFERENCE TO INT;", "REFERENCE TO"),
        ("variable", "w : WSTRING;", "WSTRING"),
        ("variable", "k : ARRAY[0..3] OF LINT;", "LINT"),
    ],
)
def test_what_only_the_later_codesys_has_is_refused(part: str, text: str, word: str) -> None:
    parts = {"condition": "a", "action": "q := a;", "variable": "", part: text}
    project = sfc.loads(V3_ONLY.format(**parts).encode(), format="iec-text")
    with pytest.raises(
        sfc.LossError,
        match=re.escape(f"CoDeSys 2.3 has no {word}") + r"|literal " + re.escape(word) + "|function " + word,
    ):
        sfc.dumps(project, format="codesys23")


def test_set_statements_become_conditions() -> None:
    text = V3_ONLY.format(condition="a", action="q S= a; q R= NOT a OR i > 3;", variable="")
    data = sfc.dumps(sfc.loads(text.encode(), format="iec-text"), format="codesys23", strict=True)
    assert b"S=" not in data
    statements = " ".join(data.decode("cp1252").split())
    assert "IF a THEN q := TRUE; END_IF" in statements
    assert "IF NOT a OR i > 3 THEN q := FALSE; END_IF" in statements


FUNCTION = """{plcopen_sfc project.dialect := 'codesys'}
FUNCTION F : INT
VAR_INPUT x : INT; y : INT := 2; z : INT := 3; END_VAR
%s
F := x * 100 + y * 10 + z;
END_FUNCTION
"""


@pytest.mark.parametrize(
    ("call", "written"),
    [
        ("F(1)", b"F(1, 2, 3)"),
        ("F(1, 5)", b"F(1, 5, 3)"),
        ("F(x := 1, z := 7)", b"F(x := 1, z := 7, y := 2)"),
        ("F(1, 2, 4)", b"F(1, 2, 4)"),
    ],
)
def test_calls_of_functions_pass_the_start_values_of_inputs_that_they_leave_out(call: str, written: bytes) -> None:
    text = FUNCTION % "" + V3_ONLY.format(condition="a", action=f"i := {call};", variable="").partition("\n")[2]
    data, report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "codesys23", limit=0)
    assert written in data
    assert [item.path for item in report.items if "pass all inputs" in item.why] == (
        [] if call.encode() == written else ["POU Main / action Act"]
    )


def test_outputs_of_functions_are_told() -> None:
    text = FUNCTION % "VAR_OUTPUT o : BOOL; END_VAR"
    _, report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "codesys23")
    assert [(item.outcome, item.path) for item in report.losses] == [(Outcome.APPROXIMATED, "POU F / o")]


def test_static_variables_are_told() -> None:
    """They were kept without a word: no export of CoDeSys 2.3 has any."""
    text = FUNCTION % "" + "FUNCTION_BLOCK B VAR_STAT s : INT; END_VAR s := s + 1; END_FUNCTION_BLOCK"
    data, report = sfc.convert(sfc.loads(text.encode(), format="iec-text"), "codesys23")
    assert b"VAR_STAT" in data
    assert [(item.outcome, item.path) for item in report.losses] == [(Outcome.APPROXIMATED, "POU B / s")]


def test_values_of_enumerations_have_no_type_before_them() -> None:
    text = V3_ONLY.format(condition="col = Color.Green", action="col := Color.Red;", variable="")
    project = sfc.loads(text.encode(), format="iec-text")
    data = sfc.dumps(project, format="codesys23", strict=True)
    assert b"col = Green" in data
    assert b"col := Red;" in data
    project.pou("Main").chart.step("Work").name = "Red"
    with pytest.raises(sfc.LossError, match=r"Color\.Red"):
        sfc.dumps(project, format="codesys23")


def test_iec_steps_need_a_library_and_take_nine_associations() -> None:
    names = [f"v{number}" for number in range(10)]
    declared = "".join(f"{name}, " for name in names[:-1]) + names[-1]
    lines = "\n".join(f"{name}(N);" for name in names)
    text = f"PROGRAM Main\nVAR {declared} : BOOL; END_VAR\nSTEP A:\n{lines}\nEND_STEP\nEND_PROGRAM\n"
    nine = text.replace("v9(N);\n", "")
    for source, lost in ((text, ["CoDeSys 2.3 takes 9 associations at a step, and this one has 10"]), (nine, [])):
        _, report = sfc.convert(sfc.loads(source.encode(), format="iec-text"), "codesys23", partial=True)
        why = [item.why for item in report.items if item.what == "action associations"]
        assert "Iecsfc.lib" in why[0]
        assert why[1:] == lost


@pytest.mark.parametrize("call", ["Zaehlen();", "zaehlen();", " Zaehlen();\n", "Zaehlen() ;"])
@pytest.mark.parametrize("kind", ["entry_action", "main_action", "exit_action"])
def test_code_in_place_that_is_one_call_of_an_action_is_saved(kind: str, call: str) -> None:
    project = sfc.load(BELT)
    setattr(next(project.charts()).chart.step("Pruefen"), kind, m.StBody(text=call))
    data, report = sfc.convert(project)
    assert not report.losses
    assert "please report" not in str(report.items)
    back = sfc.loads(data)
    assert getattr(next(back.charts()).chart.step("Pruefen"), kind) is not None
    assert sfc.dumps(back) == data


def test_p1_with_a_variable_is_p() -> None:
    text = "PROGRAM Main\nVAR_INPUT go: BOOL; END_VAR\nVAR v: BOOL; n: INT; END_VAR\nINITIAL_STEP A:\nEND_STEP\n"
    text += "TRANSITION FROM A TO B := go; END_TRANSITION\nSTEP B:\nv(P1);\nCount(P1);\nEND_STEP\n"
    text += "TRANSITION FROM B TO A := NOT go; END_TRANSITION\nACTION Count: n := n + 1; END_ACTION\nEND_PROGRAM\n"
    source = sfc.loads(text.encode(), format="iec-text")
    data, report = sfc.convert(source, "codesys23")
    assert "STEP B:\r\nv(P);\r\nEND_STEP" in data.decode()
    assert "ACTION B_entry:\r\nCount();" in data.decode()
    assert [item.why for item in report.items if item.what == "qualifier P1"] == [
        "P, which is the same with a variable"
    ]
    back = next(sfc.loads(data).charts()).chart
    assert [each.qualifier for _, each in back.associations()] == ["P1", "P1"]


def test_p0_with_a_variable_is_a_pulse_after_the_step() -> None:
    text = "PROGRAM Main\nVAR_INPUT go: BOOL; END_VAR\nVAR v, w: BOOL; END_VAR\nINITIAL_STEP A:\nEND_STEP\n"
    text += "TRANSITION FROM A TO B := go; END_TRANSITION\nSTEP B:\nv(P0);\nEnd(P0);\nEND_STEP\n"
    text += "TRANSITION FROM B TO A := NOT go; END_TRANSITION\nACTION End: w := NOT w; END_ACTION\nEND_PROGRAM\n"
    source = sfc.loads(text.encode(), format="iec-text")
    data, report = sfc.convert(source, "codesys23", limit=60)
    assert report.losses == []
    assert "POU Main" in report.compared
    assert "ACTION pulses:\r\nv := v_pulse;\r\nv_pulse := FALSE;" in data.decode()
    back = next(sfc.loads(data).charts()).chart
    assert [(each.qualifier, each.target) for _, each in back.associations()] == [("P0", "v"), ("P0", "End")]


@pytest.mark.parametrize("text", ["(* to do *)", "(* a *)\n(* b *)", "LD x", "no operator", ""])
def test_a_body_in_instruction_list_stays_one(text: str) -> None:
    project = sfc.loads(b"PROGRAM Main\nVAR x: BOOL; END_VAR\nEND_PROGRAM\n", format="iec-text")
    project.pous[0].bodies = [m.IlBody(text=text)]
    again = sfc.loads(sfc.dumps(project, format="codesys23", partial=True))
    assert again.pous[0].bodies == [m.IlBody(text=text)]


def test_a_declaration_that_cannot_be_read_keeps_its_line_ends() -> None:
    data = b"PROGRAM Main\r\nVAR\r\nx : STRUCT\r\ny : BOOL;\r\nEND_STRUCT := ?;\r\nEND_VAR\r\nEND_PROGRAM\r\n"
    project = sfc.loads(data, format="codesys23")
    project.accept_errors()
    assert b"\r\r" not in sfc.dumps(project, format="codesys23", fresh=True, partial=True)


@pytest.mark.slow
@settings(
    max_examples=20, phases=[Phase.generate], deadline=None, derandomize=True, suppress_health_check=[*HealthCheck]
)
@given(projects())
def test_what_was_read_is_written_as_it_was(project: m.Project) -> None:
    """Charts with something that CoDeSys 2.3 has no words for were written in terms of their source the second time."""
    data = sfc.dumps(project, format="codesys23", partial=True)
    again = sfc.loads(data)
    again.accept_errors()
    assert sfc.dumps(again, format="codesys23", fresh=True, partial=True) == data


def test_a_text_that_would_be_taken_for_another_code_page_names_its_own() -> None:
    text = "PROGRAM Main VAR a : INT; END_VAR (* CB\xb3a, X\xb9y *) a := 1; END_PROGRAM"
    data = sfc.dumps(sfc.loads(text.encode(), format="iec-text"), format="codesys23", partial=True)
    again = sfc.loads(data)
    assert "CB\xb3a" in sfc.dumps(again, format="codesys23", fresh=True, partial=True).decode("cp1252")
    assert again.pou("Main").bodies == sfc.loads(text.encode(), format="iec-text").pou("Main").bodies


def test_a_drawn_condition_with_a_timer_does_not_compile_there() -> None:
    """An empty condition might be always TRUE."""
    source = """
    {plcopen_sfc format := 1}
    {plcopen_sfc project.dialect := 'codesys'}
    PROGRAM Main
    VAR a : BOOL; t : TON; END_VAR
    INITIAL_STEP S: END_STEP
    TRANSITION FROM S TO S := a; END_TRANSITION
    END_PROGRAM
    """
    project = sfc.loads(source.encode())
    wires = [m.InputPin(connections=[m.Connection(source=number)]) for number in (1, 2)]
    inputs = [m.BlockVariable(name=name, input=wire) for name, wire in zip(("IN", "PT"), wires, strict=True)]
    parameters = m.BlockParameters(inputs=inputs, outputs=[m.BlockVariable(name="Q", output=m.OutputPin())])
    timer = m.Block(id=3, type_name="TON", instance="t", parameters=parameters)
    end = m.OutputVariable(id=4, expression="T1", input=m.InputPin(connections=[m.Connection(source=3, pin="Q")]))
    given = [m.InputVariable(id=1, expression="a"), m.InputVariable(id=2, expression="T#1s")]
    body = m.FbdBody(networks=[m.LogicNetwork(nodes=[*given, timer, end])])
    pou = project.pou("Main")
    pou.transitions.append(m.NamedTransition(name="T1", body=body))
    pou.chart.transitions[0].condition = m.NamedCondition(name="T1")
    data, report = sfc.convert(project, "codesys23", partial=True)
    assert b":= \r\nNOT_EXECUTED_S_S\r\nEND_TRANSITION" in data
    assert [(item.what, item.path) for item in report.with_outcome(Outcome.NOT_EXECUTED)] == [
        ("condition", "POU Main / transition S -> S")
    ]


@pytest.mark.parametrize(("associations", "told"), [(["N q"], True), ([], False)])
def test_a_report_names_an_initial_step_with_associations(associations: list[str], told: bool) -> None:
    project = m.Project(dialect="codesys")
    project.add_program("Main", step("Wait", initial=True, actions=associations), "go", jump("Wait"))
    items = sfc.convert(project, "codesys23").report.items
    assert (
        any(item.path == "POU Main / step Wait" and "takes none, says a textbook" in item.why for item in items) is told
    )
