"""Lowered code holds nothing that only the chart had a use for: what an engineer would strike out is not there."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import VerdictKind
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.languages.networks import body_statements
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.model.dialect import Dialect
from tests.lowering.charts import act, pou_with

PRESS = b"""PROGRAM Press
  VAR_INPUT Start, Down : BOOL; END_VAR
  VAR_OUTPUT Even, Lamp : BOOL; END_VAR
  INITIAL_STEP Wait: END_STEP
  TRANSITION Go FROM Wait TO Work := Start; END_TRANSITION
  STEP Work: Counting(N); Lamp(N); END_STEP
  TRANSITION Back FROM Work TO Wait := Down; END_TRANSITION
  ACTION Counting: Even := NOT Even; END_ACTION
  ACTION Spare: Even := FALSE; END_ACTION
END_PROGRAM
"""


@pytest.mark.parametrize("construction", ["case", "bits", "flipflop"])
def test_textual_code_of_iec_61131_3_has_no_actions_that_only_the_chart_used(construction: str) -> None:
    lowered = sfc.lower(sfc.loads(PRESS, format="iec-text"), construction, target="iec-text")
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN
    assert [action.name for action in lowered.pou.actions] == ["Spare"]  # the chart did not use it
    text = sfc.dumps(lowered.project, format="iec-text").decode()
    assert "Even := NOT Even;" in text
    assert "ACTION Counting" not in text


RELAYED = PRESS.replace(b"STEP Work: Counting(N);", b"STEP Work: Relayed(N); Counting(N);").replace(
    b"END_PROGRAM", b"ACTION Relayed: Relay(); END_ACTION ACTION Relay: ; END_ACTION END_PROGRAM"
)


@pytest.mark.parametrize(
    ("instructions", "calls"),
    [
        ("LD Down\nCALC Counting", True),
        ("CAL Press.Counting", True),
        ("LD Down (* Counting(x) *)\nST Lamp", False),
        ("LD 'Counting()'\nST Text", False),
    ],
)
def test_actions_that_instruction_list_calls_stay(instructions: str, *, calls: bool) -> None:
    project = sfc.loads(RELAYED, format="iec-text")
    relay = project.pou("Press").action("Relay")
    assert relay is not None
    relay.body = m.IlBody(text=instructions)
    actions = [action.name for action in sfc.lower(project, "case", verify=False).pou.actions]
    assert actions == ["Counting", "Spare", "Relay"] if calls else ["Spare", "Relay"]


@pytest.mark.parametrize(("text", "calls"), [("CAL Inner", True), ("LD Even (* Inner *)\nST Lamp", False)])
def test_charts_of_actions_are_lowered_where_instruction_list_calls_them(text: str, *, calls: bool) -> None:
    project = sfc.loads(RELAYED, format="iec-text")
    project.dialect = Dialect.CODESYS
    pou = project.pou("Press")
    inner = sfc.SfcNetwork()
    first, second = inner.add_step("One", initial=True), inner.add_step("Two")
    inner.add_transition(first, second, "Down")
    pou.actions.append(m.Action(name="Inner", body=m.SfcBody(chart=inner)))
    relay = pou.action("Relay")
    assert relay is not None
    relay.body = m.IlBody(text=text)
    lowered = sfc.lower(project, "case", pou="Press", verify=False).pou.action("Inner")
    assert lowered is not None
    assert isinstance(lowered.body, m.StBody if calls else m.SfcBody)


def test_actions_of_codesys_stay_as_programs_call_them_from_anywhere() -> None:
    project = sfc.loads(PRESS, format="iec-text")
    project.dialect = Dialect.CODESYS
    assert [action.name for action in sfc.lower(project, "case").pou.actions] == ["Counting", "Spare"]


def test_transition_objects_go_with_the_chart() -> None:
    project = sfc.loads(PRESS, format="iec-text")
    pou = project.pou("Press")
    chart = pou.sfc
    assert chart is not None
    condition = chart.transitions[0].condition
    assert isinstance(condition, m.Expression)
    pou.transitions.append(m.NamedTransition(name="MayStart", body=m.StBody(text=f"MayStart := {condition.text};")))
    chart.transitions[0].condition = m.NamedCondition(name="MayStart")
    lowered = sfc.lower(project, "case")
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN
    assert lowered.pou.transitions == []


def test_a_chart_of_an_action_leaves_what_the_others_use() -> None:
    project = sfc.loads(PRESS, format="iec-text")
    pou = project.pou("Press")
    inner = sfc.SfcNetwork()
    first, second = inner.add_step("One", initial=True), inner.add_step("Two")
    inner.add_transition(first, second, "Down")
    pou.actions.append(m.Action(name="Inner", body=m.SfcBody(chart=inner)))
    assert [a.name for a in sfc.lower(project, "case", pou="Press.Inner", verify=False).pou.actions] == [
        "Counting",
        "Spare",
        "Inner",
    ]


def test_flip_flops_are_statements_in_textual_files_which_show_no_networks() -> None:
    project = sfc.loads(PRESS, format="iec-text")
    assert sfc.lower(project, "flipflop", target="iec-text", verify=False).language == "ST"
    assert sfc.lower(project, "flipflop", target="iec-text", language="FBD", verify=False).language == "FBD"


@pytest.mark.parametrize("qualifier", ["S", "SD", "DS", "SL"])
def test_a_stored_action_is_not_reset_a_second_time(qualifier: str) -> None:
    chart = m.SfcNetwork()
    on, off, end = chart.add_step("On", initial=True), chart.add_step("Off"), chart.add_step("End")
    chart.add_transition(on, off, "a")
    chart.add_transition(off, end, "b")
    chart.add_transition(end, on, "c")
    act(chart, on, "Fill", m.Qualifier(qualifier), duration=None if qualifier == "S" else "T#20ms")
    act(chart, off, "Fill", m.Qualifier.R)
    pou = pou_with(chart)
    pou.actions.append(m.Action(name="Fill", body=m.StBody(text="Level := NOT Level;")))
    assert pou.interface is not None
    level = m.Variable(name="Level", type=m.ElementaryType(name=m.Elementary.BOOL))
    pou.interface.sections.append(m.VariableSection(kind=m.SectionKind.LOCAL, variables=[level]))
    lowered = sfc.lower(pou, "bits", profile="iec")
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN
    body = lowered.pou.body
    assert isinstance(body, m.StBody)
    assert body.text.count("NOT X_Off") <= 1, body.text  # the flip-flop, where X_On does not exclude it already


def test_a_branch_knows_which_steps_of_its_part_are_active() -> None:
    chart = m.SfcNetwork()
    wait, work = chart.add_step("Wait", initial=True), chart.add_step("Work")
    chart.add_transition(wait, work, "a AND NOT Work.X AND Wait.X")
    chart.add_transition(wait, wait, "b AND Work.X")
    chart.add_transition(work, wait, "NOT (b = c)")
    pou = m.Pou(name="Ablauf", kind=m.PouKind.FUNCTION_BLOCK, bodies=[m.SfcBody(chart=chart)])
    body = sfc.lower(pou, "case", verify=False).pou.body
    assert isinstance(body, m.StBody)
    assert "        IF a THEN\n            step_number := 2;\n        END_IF;\n    2:" in body.text
    assert "NOT (b = c)" in body.text  # as it was written


def test_a_transition_that_always_fires_needs_no_question() -> None:
    chart = m.SfcNetwork()
    wait, work, end = chart.add_step("Wait", initial=True), chart.add_step("Work"), chart.add_step("End")
    chart.add_transition(wait, work, "TRUE")
    chart.add_transition(work, wait, "a")
    chart.add_transition(work, end, "TRUE")
    chart.add_transition(end, wait, "TRUE")
    chart.add_transition(end, work, "a")  # never
    lowered = sfc.lower(pou_with(chart), "case")
    assert lowered.proof is not None
    assert lowered.proof.kind is VerdictKind.PROVEN
    body = lowered.pou.body
    assert isinstance(body, m.StBody)
    assert body.text.splitlines() == [
        "// Step sequence",
        "CASE step_number OF",
        "    1: // Step Wait – initial step",
        "        step_number := 2;",
        "",
        "    2: // Step Work",
        "        IF a THEN",
        "            step_number := 1;",
        "        ELSE",
        "            step_number := 3;",
        "        END_IF;",
        "",
        "    3: // Step End",
        "        step_number := 1;",
        "END_CASE;",
    ]


def test_text_needs_no_pragma_for_its_end() -> None:
    lowered = sfc.lower(sfc.loads(PRESS, format="iec-text"), "case", verify=False)
    fresh = m.Project(pous=[lowered.pou.model_copy(update={"actions": []})])
    assert "layout" not in sfc.dumps(fresh, format="iec-text").decode()


PUMP = """FUNCTION_BLOCK Pump
VAR_INPUT Run : BOOL; END_VAR
VAR_OUTPUT Busy : BOOL; END_VAR
Busy := Run;
END_FUNCTION_BLOCK
PROGRAM Main
VAR_INPUT a : BOOL; b : BOOL; END_VAR
VAR p : Pump; END_VAR
INITIAL_STEP S1: Work(N); END_STEP
STEP S2: END_STEP
TRANSITION FROM S1 TO S2 := a AND p.Busy; END_TRANSITION
TRANSITION FROM S2 TO S1 := b; END_TRANSITION
ACTION Work:
 LD b
 ST p.Run
 CAL p
END_ACTION
END_PROGRAM"""


@pytest.mark.parametrize("format", ["simaticml", "plcopen-2.01", "codesys"])
def test_a_call_without_inputs_in_instruction_list_is_a_box_with_en(format: str) -> None:
    made = sfc.lower(sfc.loads(PUMP.encode(), format="iec-text"), "flipflop", target=format, language="FBD")
    assert made.proof is not None
    assert made.proof.proven, str(made.proof)
    assert isinstance(made.pou.body, m.FbdBody)
    boxes = [node for network in made.pou.body.networks for node in network.nodes if isinstance(node, m.Block)]
    calls = [box for box in boxes if box.type_name == "Pump"]
    assert calls
    assert all("EN" in [pin.name for pin in box.parameters.inputs] for box in calls)


CALLS = """{function}PROGRAM Main
VAR_INPUT a : BOOL; b : BOOL; raw : INT; END_VAR
VAR_OUTPUT lamp : BOOL; END_VAR
VAR bl : BLINK; END_VAR
INITIAL_STEP S1: END_STEP
STEP S2: Work(N); END_STEP
TRANSITION FROM S1 TO S2 := {condition}; END_TRANSITION
TRANSITION FROM S2 TO S1 := b; END_TRANSITION
ACTION Work: {work} END_ACTION
END_PROGRAM"""
TWICE = "FUNCTION Twice : INT\nVAR_INPUT x : INT; END_VAR\nTwice := x * 2;\nEND_FUNCTION\n"


def calling(path: Path, function: str = "", condition: str = "a", work: str = "lamp := a;") -> str:
    """The code of such a chart in FBD as it is in a file of TIA Portal, as structured text."""
    text = CALLS.format(function=function, condition=condition, work=work)
    made = sfc.lower(sfc.loads(text.encode(), format="iec-text"), "flipflop", target="simaticml", verify=False)
    sfc.save(made, path, format="simaticml")
    back = sfc.load(path)
    body = next(pou for pou in back.pous if pou.name == "Main").body
    assert isinstance(body, m.FbdBody)
    return print_node(body_statements(body, m.Dialect.SCL).tree)


def test_functions_of_the_project_are_boxes_with_named_inputs_in_tia_portal(tmp_path: Path) -> None:
    text = calling(tmp_path / "Main.xml", TWICE, "a AND Twice(raw) > 10")
    assert "Twice(x := #raw) > 10" in text


def test_a_function_that_nothing_declares_has_no_box_in_tia_portal(tmp_path: Path) -> None:
    with pytest.raises(LoweringError, match="the inputs of Twice have no names"):
        calling(tmp_path / "Main.xml", condition="a AND Twice(raw) > 10")


def test_a_boolean_output_of_an_unknown_block_is_set_and_reset_in_tia_portal(tmp_path: Path) -> None:
    text = calling(tmp_path / "Main.xml", work="bl(ENABLE := a); lamp := bl.OUT;")
    assert "IF #Work_A AND #bl.OUT THEN\n    #lamp := TRUE;\nEND_IF;" in text
    assert "IF #Work_A AND NOT #bl.OUT THEN\n    #lamp := FALSE;\nEND_IF;" in text
