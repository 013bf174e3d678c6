"""Actions of a step in the CASE branch of the step: under profiles with actions before transitions."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import VerdictKind
from plcopen_sfc.lowering import LoweredPou
from plcopen_sfc.model.dialect import Dialect
from tests.lowering.charts import act, boolean, pou_with


def clamp() -> m.Pou:
    """Three steps with all that CODESYS executes for a step."""
    chart = m.SfcNetwork()
    steps = [chart.add_step(name, initial=name == "Wait") for name in ("Wait", "Clamp", "Release")]
    for step, following, condition in zip(steps, [*steps[1:], steps[0]], ("Start", "Closed", "Opened"), strict=True):
        chart.add_transition(step, following, condition)
    act(chart, steps[1], "Valve")
    act(chart, steps[2], "Ready", condition="Opened")
    pou = pou_with(chart)
    assert pou.interface is not None
    pou.interface.sections.append(m.VariableSection(variables=[boolean("Odd"), boolean("Even")]))
    steps[1].entry_action = m.StBody(text="Odd := NOT Odd;")
    steps[1].main_action = m.StBody(text="Even := NOT Even;")
    return pou


def lowered(pou: m.Pou, *, verify: bool = True) -> LoweredPou:
    return sfc.lower(m.Project(dialect=Dialect.CODESYS, pous=[pou]), "case", verify=verify)


def text_of(made: LoweredPou) -> str:
    assert isinstance(made.code, m.StBody)
    return made.code.text


def helpers(made: LoweredPou, pou: m.Pou) -> list[str]:
    own = {variable.name for variable in pou.variables()}
    interface = made.pou.interface
    assert interface is not None
    return [v.name for s in interface.sections if not s.constant for v in s.variables if v.name not in own]


def test_entry_main_and_continuous_actions_stand_in_the_branch_of_their_step() -> None:
    pou = clamp()
    made = lowered(pou)
    assert made.proof is not None
    assert made.proof.kind is VerdictKind.PROVEN
    branch = text_of(made).partition("STEP_Clamp: // Step Clamp\n")[2].partition("    STEP_Release")[0]
    assert [line.strip() for line in branch.splitlines() if line] == [
        "IF step_entered THEN",
        "Odd := NOT Odd;",
        "END_IF;",
        "Even := NOT Even;",
        "Valve := TRUE;",
        "IF Closed THEN",
        "step_number := STEP_Release;",
        "END_IF;",
    ]
    assert helpers(made, pou) == ["step_number", "last_step_number", "step_entered"]


def test_what_another_statement_sees_stays_in_front_of_the_case() -> None:
    pou = clamp()
    chart = pou.sfc
    assert chart is not None
    # it asks for an output that is written behind it, and so as it was in the last scan
    chart.step("Wait").main_action = m.StBody(text="Ready := Valve;")
    made = lowered(pou)
    assert made.proof is not None
    assert made.proof.kind is VerdictKind.PROVEN
    assert "Ready := Valve;" in text_of(made).partition("// Step sequence")[0]


@pytest.mark.parametrize("asking", ["Odd := Clamp.x;", "Odd := FALSE;"])
def test_the_state_of_the_next_scan_is_kept_apart_only_where_something_asks_for_steps(asking: str) -> None:
    pou = clamp()
    pou.actions = [m.Action(name="Look", body=m.StBody(text=asking))]
    made = lowered(pou, verify=False)
    assert ("next_step_number" in helpers(made, pou)) == ("Clamp" in asking)


def test_an_output_that_others_write_too_needs_no_variable_of_its_own() -> None:
    pou = clamp()
    chart = pou.sfc
    assert chart is not None
    chart.step("Wait").exit_action = m.StBody(text="Valve := FALSE;")
    made = lowered(pou)
    assert made.proof is not None
    assert made.proof.kind is VerdictKind.PROVEN
    assert "Valve_Q" not in helpers(made, pou)


BRANCHES = """PROGRAM Main
VAR_INPUT a, b, SFCReset : BOOL; END_VAR
VAR_OUTPUT p, q : BOOL; k : INT; END_VAR
INITIAL_STEP Init: END_STEP
STEP P1: p(N); END_STEP
STEP P2: END_STEP
STEP R1: q(N); Last(N); END_STEP
STEP R2: First(N); END_STEP
TRANSITION FROM Init TO (P1, R1) := a; END_TRANSITION
TRANSITION FROM P1 TO P2 := b; END_TRANSITION
TRANSITION FROM R1 TO R2 := {leaving}; END_TRANSITION
TRANSITION FROM R2 TO R1 := NOT a; END_TRANSITION
TRANSITION FROM (P2, R2) TO Init := a AND b; END_TRANSITION
ACTION First: k := 0; END_ACTION
ACTION Last: k := 1; END_ACTION
END_PROGRAM"""


def of_branches(leaving: str) -> str:
    text = BRANCHES.format(leaving=leaving)
    made = sfc.lower(sfc.loads(text.encode(), format="iec-text"), "regions", profile="codesys")
    assert made.proof is not None
    assert made.proof.proven, str(made.proof)
    return text_of(made)


def test_actions_of_simultaneous_branches_are_in_these_and_a_reset_is_behind_them_once() -> None:
    text = of_branches("a")
    before, _, cases = text.partition("// Step sequence")
    for output, step in (("p", "P1"), ("q", "R1")):
        branch = cases.partition(f": // Step {step}\n")[2].partition("END_IF")[0]
        assert branch.strip().startswith(f"{output} := TRUE;"), step
        assert f"{output} := FALSE;" in before
    assert text.count("IF SFCReset THEN // no transition fires meanwhile") == 1
    assert "IF NOT SFCReset" not in text
    # what the steps of one region do in the scan after their last one is one CASE
    assert before.count("CASE last_step_number_R1 OF") == 1
    assert "IF last_step_number_R1 = " not in before


def test_what_another_branch_asks_for_is_in_front_of_all() -> None:
    before, _, cases = of_branches("p").partition("// Step sequence")
    assert "p := step_number_P1 = " in before
    assert "q := TRUE;" in cases


def test_timers_of_the_code_keep_no_action_out_of_its_branch() -> None:
    """A timed action behind it is called; the call changes nothing but its timer."""
    pou = clamp()
    chart = pou.sfc
    assert chart is not None
    assert pou.interface is not None
    pou.interface.sections.append(m.VariableSection(kind=m.SectionKind.EXTERNAL, variables=[boolean("Lamp")]))
    act(chart, chart.step("Wait"), "Lamp")
    act(chart, chart.step("Release"), "Zeit", m.Qualifier.L, duration="T#20ms")
    pou.interface.sections[-2].variables.append(boolean("Zeit"))
    made = lowered(pou)
    assert made.proof is not None
    assert made.proof.kind is VerdictKind.PROVEN
    assert "Lamp := TRUE;" in text_of(made).partition("// Step sequence")[2]
