"""Sources of SCL from projects of other tools: what is written compiles and does the same, or the report says so."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.api import convert
from plcopen_sfc.report import ConversionReport, Outcome
from plcopen_sfc.semantics.simulation import simulate

HEAD = """
FUNCTION ATAN2 : REAL
VAR_INPUT y, x : REAL; END_VAR
ATAN2 := y;
IF x < 0.0 THEN
  ATAN2 := ATAN2 + 3.0;
END_IF
END_FUNCTION
FUNCTION_BLOCK Main
VAR_INPUT a : REAL; n : INT; END_VAR
VAR_OUTPUT q : REAL; END_VAR
VAR i : INT; END_VAR
"""


def source(text: str, declarations: str = "") -> m.Project:
    """A block of CODESYS with the program `text`, and a function with the name of one of the standard functions."""
    project = sfc.loads(f"{HEAD}{declarations}\n{text}\nEND_FUNCTION_BLOCK\n".encode(), format="iec-text")
    project.dialect = m.Dialect.CODESYS
    return project


def written(project: m.Project) -> tuple[str, m.Project, ConversionReport]:
    """The text of SCL, what TIA Portal sees in it, and the report."""
    data, report = sfc.convert(project, "scl", partial=True)
    return data.decode("utf-8-sig"), sfc.loads(data, as_tool=True), report


def told(report: ConversionReport, what: str) -> list[str]:
    return [item.why for item in report.with_outcome(Outcome.NOT_EXECUTED) if item.what == what]


ENDS = """IF a > 1.0 THEN
  q := 1.0;
END_IF
FOR i := 0 TO 3 DO
  q := q + 1.0;
END_FOR
CASE n OF
  1: q := 2.0;
END_CASE
WHILE q > 9.0 DO
  q := q - 1.0;
END_WHILE
REPEAT
  q := q + 1.0;
UNTIL TRUE
END_REPEAT
"""


def test_statements_end_with_semicolons() -> None:
    text, seen, report = written(source(ENDS))
    for word in ("END_IF", "END_FOR", "END_CASE", "END_WHILE", "END_REPEAT"):
        assert f"{word};" in text
        assert f"{word}\n" not in text.partition("FUNCTION_BLOCK")[2]
    assert report.losses == []
    assert list(simulate(seen, pou="Main", scans=3)["q"]) == list(simulate(source(ENDS), pou="Main", scans=3)["q"])


def test_functions_with_names_of_standard_functions_return_their_value() -> None:
    project = source("q := ATAN2(2.0, -1.0);")
    text, seen, report = written(project)
    assert '#q := "ATAN2"(y := 2.0, x := -1.0);' in text
    assert report.losses == []
    assert list(simulate(seen, pou="Main", scans=1)["q"]) == [5.0]


@pytest.mark.parametrize("target", ["codesys", "plcopen"])
@pytest.mark.parametrize("own", ["#ATAN2", '"ATAN2"'])
def test_results_have_the_name_of_their_function_in_other_tools(own: str, target: str) -> None:
    text = f'FUNCTION "ATAN2" : Real\nVAR_INPUT\n  y : Real;\nEND_VAR\nBEGIN\n  {own} := #y + 1.0;\nEND_FUNCTION\n'
    text += 'FUNCTION_BLOCK "Main"\nVAR_OUTPUT\n  q : Real;\nEND_VAR\nBEGIN\n  #q := "ATAN2"(y := 1.0);\n'
    project = sfc.loads(f"{text}END_FUNCTION_BLOCK\n".encode())
    seen = sfc.loads(sfc.dumps(project, format=target), as_tool=True)
    function = seen.pous[0]
    assert isinstance(function.body, m.StBody)
    assert function.body.text.strip().startswith(f"{function.name} := ")
    assert list(simulate(seen, pou="Main", scans=1)["q"]) == [2.0]


def test_this_is_the_block_itself() -> None:
    text, _, report = written(source("THIS^.q := THIS^.a;"))
    assert "#q := #a;" in text
    assert report.losses == []


@pytest.mark.parametrize("text", ["SUPER^();", "Clear();", "Clear;", "THIS^.Home();", "Home();"])
def test_what_s7_cannot_call_is_not_executed(text: str) -> None:
    project = source(text)
    main = project.pou("Main")
    main.actions = [m.Action(name="Clear", body=m.StBody(text="q := 0.0;"))]
    main.methods = [m.Method(name="Home", body=m.StBody(text="q := 0.0;"))]
    _, _, report = written(project)
    assert told(report, "text") or any(i.outcome is Outcome.APPROXIMATED and i.what == "text" for i in report.items)
    assert [item.path for item in report.items if item.what in ("POU action", "method")] == [
        "POU Main / action Clear",
        "POU Main / method Home",
    ]


def test_declarations_keep_what_is_executed() -> None:
    declarations = """VAR RETAIN r : INT := 7; END_VAR
VAR CONSTANT k : INT := 5; END_VAR
VAR s : STRING[20] := 'it$'s'; b AT %IX0.3 : BOOL; END_VAR"""
    text, seen, report = written(source("q := 1.0;", declarations))
    sections = seen.pou("Main").interface.sections  # type: ignore[union-attr]
    assert [(s.retain, s.constant) for s in sections[3:5]] == [(True, False), (False, True)]
    initial = {v.name: v.initial for v in seen.pou("Main").variables()}
    assert initial["r"] == m.SimpleValue(text="7")
    assert initial["s"] == m.SimpleValue(text="'it$'s'")
    assert " AT " not in text.partition("// {plcopen_sfc")[0], "AT names another variable in SCL"
    assert "b" not in initial
    assert told(report, "global variable") == [
        "a source declares no tags and user constants: it must be in the project already",
    ]
    back = sfc.loads(sfc.convert(source("q := 1.0;", declarations), "scl", partial=True)[0])
    assert next(v.address for v in back.pou("Main").variables() if v.name == "b") == "%I0.3"


def test_blocks_that_do_nothing_are_told() -> None:
    project = source("q := 1.0;")
    chart = m.SfcNetwork()
    chart.add_step("S1", initial=True)
    project.pous.append(m.Pou(name="Chart", kind=m.PouKind.PROGRAM, bodies=[m.SfcBody(chart=chart)]))
    _, _, report = written(project)
    assert told(report, "chart") == [
        "the block is empty and does nothing: SCL has no charts; `plcopen-sfc lower --to scl` makes code of them"
    ]
    assert {item.path for item in report.with_outcome(Outcome.NOT_EXECUTED)} == {"POU Chart"}


def test_steps_are_named_in_the_actions_of_their_block() -> None:
    project = source("q := 1.0;")
    chart = m.SfcNetwork()
    chart.add_step("Fill", initial=True)
    action = m.Action(name="Look", body=m.StBody(text="IF Fill.x THEN q := 1.0; END_IF;"))
    project.pous[1].bodies, project.pous[1].actions = [m.SfcBody(chart=chart)], [action]
    back = sfc.loads(sfc.convert(project, "scl", partial=True)[0])
    assert back.pous[1].actions[0].body == m.StBody(text="IF #Fill.X THEN #q := 1.0; END_IF;")


@pytest.mark.parametrize("name", ["sfc1", "Counter", "Timer", "TON_TIME", "DTL", "FB1", "Main"])
def test_a_block_that_is_called_like_a_type_of_the_system_is_read_again(name: str) -> None:
    project = sfc.loads(f"FUNCTION_BLOCK {name} VAR a : BOOL; END_VAR a := TRUE; END_FUNCTION_BLOCK".encode())
    back = sfc.loads(sfc.dumps(project, format="scl"))
    assert back.diagnostics == ()
    assert [pou.name for pou in back.pous] == [name]


def test_sections_without_variables_and_results_are_no_loss() -> None:
    sections = [
        m.VariableSection(kind=m.SectionKind.INPUT, variables=[m.Variable(name="x", type="INT")]),
        m.VariableSection(kind=m.SectionKind.CONSTANT),
        m.VariableSection(kind=m.SectionKind.RETURN, variables=[m.Variable(name="Ret_Val", type="Void")]),
    ]
    body = m.StBody(text=";")
    function = m.Pou(name="F", kind=m.PouKind.FUNCTION, interface=m.Interface(sections=sections), bodies=[body])
    data, report = convert(m.Project(pous=[function], dialect=m.Dialect.SCL), "scl")
    assert not report.losses
    assert b'FUNCTION "F" : Void' in data
    assert b"Ret_Val : " not in data


def test_a_program_is_a_block_whose_comment_tells_nothing_but_that() -> None:
    project = sfc.loads(b"PROGRAM Main VAR n : INT; END_VAR n := n + 1; END_PROGRAM", format="iec-text")
    data, _ = sfc.convert(project, "scl")
    remarks = [line for line in data.decode("utf-8-sig").splitlines() if "{plcopen_sfc" in line]
    assert remarks[0] == "// {plcopen_sfc pous[Main].kind := 'program' FOR 'functionBlock'}"
    assert not any("n := n + 1" in line for line in remarks), "the text of the block once more"
    assert sfc.loads(data).pou("Main").kind is m.PouKind.PROGRAM


@pytest.mark.parametrize("kind", [m.PouKind.PROGRAM, m.PouKind.FUNCTION_BLOCK])
def test_a_block_without_variables_lacks_none(kind: m.PouKind) -> None:
    project = m.Project(pous=[m.Pou(name="Main", kind=kind, bodies=[m.StBody(text=";")])])
    _, report = sfc.convert(project, "scl")
    assert not report.with_outcome(Outcome.NOT_EXECUTED)


@pytest.mark.parametrize("target", ["scl", "simaticml"])
def test_arrays_of_arrays_are_told(target: str) -> None:
    text = b"PROGRAM Main VAR q : ARRAY[0..3] OF ARRAY[0..2] OF BOOL; END_VAR q[1][2] := TRUE; END_PROGRAM"
    _, report = sfc.convert(sfc.loads(text, format="iec-text"), target, partial=True)
    (item,) = report.with_outcome(sfc.Outcome.NOT_EXECUTED)
    assert item.path == "POU Main / q"
    assert item.why.startswith("TIA Portal has no type")
