"""Sequencers of S7-GRAPH with a CASE for each sequence: proven to do the same."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, settings

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.errors import LoweringError, ModelError
from plcopen_sfc.lowering import Construction, LoweredPou
from plcopen_sfc.lowering.proof import prove
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.semantics.subjects import resolve
from tests.lowering.random_sequencers import sequencers
from tests.lowering.sequencers import (
    STANDARD_INPUTS,
    STANDARD_OUTPUTS,
    act,
    block,
    guarded,
    lowered,
    ring,
    text,
    verdict,
)
from tests.semantics.charts.rig import chain
from tests.sweeps import examples

CASE, REGIONS = Construction.CASE, Construction.REGIONS


def proven(chart: m.SfcNetwork, inputs: str = "", outputs: str = "Q", construction: Construction = CASE) -> None:
    project = block(chart, inputs, outputs)
    found = verdict(project, construction=construction)
    # the number that S_SEL puts out stands for any: runs compare it, no proof does
    is_settled = found.equal if "S_SEL" in inputs else found.proven
    assert is_settled, f"{found}\n{text(project, construction)}"


def code(chart: m.SfcNetwork, inputs: str = "", outputs: str = "Q", construction: Construction = CASE) -> str:
    return text(block(chart, inputs, outputs), construction)


def test_a_ring_is_one_case_that_starts_with_no_step() -> None:
    chart = ring(act("N"))
    chart.step("S3").actions = [act("S", "P", "S1")]
    assert code(chart, outputs="Q P") == (
        """// Steps as they were before
#step_number_old := #step_number;

// Step sequence
CASE #step_number OF
    #STEP_1: // Step 1 – initial step
        IF #c1 THEN
            #step_number := #STEP_2;
        END_IF;
    #STEP_2: // Step 2
        IF #c2 THEN
            #step_number := #STEP_3;
        END_IF;
    #STEP_3: // Step 3
        IF #c3 THEN
            #step_number := #STEP_1;
        END_IF;
END_CASE;

// Start of the sequence
IF #FirstScan THEN
    #step_number := #STEP_1;
    #FirstScan := FALSE;
END_IF;

// Action #Q
#Q := #step_number = #STEP_2;

// Step S3: actions
IF #step_number = #STEP_3 AND #step_number_old <> #STEP_3 THEN
    #P := TRUE;
END_IF;"""
    )
    proven(chart, outputs="Q P")


@pytest.mark.parametrize(
    "inputs",
    [
        "INIT_SQ OFF_SQ",
        "SW_TAP SW_TOP T_PUSH",
        "SW_MAN S_SEL:INT S_OFF",
        "SW_MAN S_ON",  # nothing selects a step
    ],
)
def test_parameters(inputs: str) -> None:
    chart = chain("S1", "S2", conditions="#c1 #c2")
    chart.step("S2").actions = [act("N")]
    proven(chart, inputs, "Q MAN_ON S_NO:INT S_MORE S_ACTIVE")


@pytest.mark.slow
@pytest.mark.parametrize("acknowledge", [False, True])
@pytest.mark.parametrize("event", ["L1", "V0", "A1", "S1", "S0"])
def test_interlocks_supervisions_and_events(event: str, acknowledge: bool) -> None:
    chart = guarded(act("N", value="NOT #Q", event=event), act("N", "P", interlock=True), acknowledge=acknowledge)
    proven(chart, "ok fault ACK_EF", "Q P ERR_FLT")


def test_a_supervision_has_three_variables_and_is_short_when_its_step_begins() -> None:
    """An event has a variable where something asks for it only."""
    chart = guarded(act("N"), acknowledge=True)
    made = code(chart, "fault ACK_EF ok")
    begins = made.partition("IF #step_number = #STEP_2 AND #step_number_old <> #STEP_2 THEN\n")[2]
    assert begins.startswith("    #X2_VS := #fault;\n    #X2_VA := #X2_VS;\nEND_IF;")
    assert "#X2_fault" not in made
    assert "#X2_V1" not in made
    proven(chart, "ok fault ACK_EF")


def test_a_coil_that_something_else_writes_is_left_alone() -> None:
    chart = ring(act("N"), act("N", event="S0"))
    chart.permanent_post = [m.PermanentOperation(body=m.StBody(text="IF #c1 AND #c3 THEN #Q := TRUE; END_IF;"))]
    assert "IF #step_number = #STEP_2 OR #step_number_old = #STEP_2 OR #X2_S0_old THEN" in code(chart)
    proven(chart)


def test_times_counters_timers_and_calls() -> None:
    chart = ring(act("D", duration="T#20ms"), act("CU", "n", "S1"), act("TL", "t", "S0", duration="T#20ms"))
    chart.step("S3").actions = [act("CALL", None, body=m.StBody(text="#P := #t AND #n > 998;"))]
    chart.step("S1").actions = [act("CS", "n", "S1", value="998")]
    chart.transitions[1].condition = m.Expression(text="#c2 AND #S2.T > T#10ms AND NOT #S1.X")
    proven(chart, outputs="Q P t n:INT")


@pytest.mark.slow
def test_what_steps_do_stands_in_the_branches_of_a_case_by_their_numbers() -> None:
    chart = guarded(act("S"), act("CU", "n", "S1"), act("N", "P", "S0", value="TRUE"), act("R", "P", "V1"))
    third = chart.step("S3")
    third.supervision = m.Supervised(condition=m.Expression(text="#fault"))
    third.actions = [act("R"), act("TF", "t", duration="T#20ms"), act("N", "P", "V1", value="FALSE")]
    chart.steps.reverse()
    chart.graph_settings = m.GraphSettings(acknowledge_errors_required=True)
    project = block(chart, "ok fault ACK_EF", "Q P t n:INT")
    assert not verdict(project, construction=CASE, cap=500, runs=30).different
    made = text(project, CASE)
    assert "IF #step_number <> #step_number_old THEN\n    CASE #step_number_old OF" in made
    assert "// Actions of the step that was left" in made
    acting = made.partition("// Actions of the active step\n")[2].partition("\nEND_CASE;")[0]
    assert acting.splitlines()[:5] == [
        "CASE #step_number OF",
        "    #STEP_S3: // Step 1 S3",
        "        #Q := FALSE;",
        "        #t_mode := 3;",
        "        #t_time := T#20ms;",
    ]
    assert "        IF #step_number_old <> #STEP_2 THEN" in acting


def counting(number: int) -> m.BodyCondition:
    """A condition that counts whenever it is evaluated."""
    return m.BodyCondition(
        body=m.StBody(text=f"#n := (#n * 2 + {number}) MOD 7; #ready := #c{number} AND #n > 1;"), name="ready"
    )


@pytest.mark.slow
@pytest.mark.parametrize("inputs", ["INIT_SQ OFF_SQ", "SW_TAP T_PUSH", "SW_MAN SW_AUTO"])
@pytest.mark.parametrize("construction", [Construction.BITS, CASE])
def test_all_conditions_of_the_active_step_are_evaluated(construction: Construction, inputs: str) -> None:
    chart = ring(act("N"))
    chart.add_transition(chart.step("S1"), chart.step("S3"), counting(3))
    chart.transitions[1].condition = counting(2)
    proven(chart, inputs, "Q n:INT ready", construction)


@pytest.mark.slow
@pytest.mark.parametrize("check", ["interlock", "supervision"])
@pytest.mark.parametrize("construction", [Construction.BITS, CASE])
def test_checks_are_made_before_conditions_count(construction: Construction, check: str) -> None:
    chart = ring(act("N", interlock=True))
    chart.transitions[1].condition = counting(2)
    setattr(chart.step("S2"), check, m.Supervised(condition=m.Expression(text="#n > 3")))
    proven(chart, "", "Q n:INT ready", construction)


def test_conditions_of_several_sequences_are_evaluated_in_their_order() -> None:
    chart = m.SfcNetwork()
    steps = [chart.add_step(f"S{number}", initial=number in (1, 3)) for number in range(1, 5)]
    for source, target, number in ((0, 1, 1), (2, 3, 2), (1, 0, 3), (3, 2, 1)):
        chart.add_transition(steps[source], steps[target], counting(number))
    proven(chart, "", "n:INT ready", REGIONS)


def test_a_selection_and_an_end() -> None:
    chart = ring(act("N"))
    chart.add_transition(chart.step("S1"), chart.step("S3"), "#c2")
    end = chart.add_transition(chart.step("S2"), [], "#c3")
    end.priority = 1
    proven(chart, "INIT_SQ", "Q S_NO:INT S_ACTIVE")


@pytest.mark.slow
def test_several_sequences() -> None:
    chart = ring(act("N"))
    tenth, eleventh, last = (chart.add_step(name, initial=name == "S10") for name in ("S10", "S11", "S12"))
    chart.add_transition(tenth, eleventh, "#c1 AND #S2.X")
    chart.add_transition(eleventh, last, "#c2")
    chart.add_transition(last, [], "#c3")
    last.actions = [act("N", "P", "S1")]
    with pytest.raises(LoweringError, match="2 initial steps"):
        code(chart)
    made = code(chart, construction=REGIONS)
    assert "#step_number := #STEP_2;" in made  # behind the other one, which asks for step 2
    assert made.index("#STEP_S11: ") < made.index("#STEP_2: ")
    assert "#step_number_S10 := #STEP_S11;" in made
    proven(chart, "OFF_SQ INIT_SQ", "Q P S_NO:INT S_MORE", REGIONS)


@pytest.mark.slow
@pytest.mark.parametrize("inputs", ["INIT_SQ OFF_SQ", "SW_MAN S_SEL:INT S_OFF", "SW_TOP T_PUSH"])
def test_simultaneous_branches(inputs: str) -> None:
    project = block(branches(), inputs, "Q P")
    found = verdict(project, construction=REGIONS, cap=500, runs=20)
    assert not found.different, str(found)


def test_simultaneous_branches_are_proven() -> None:
    proven(branches(), "", "Q P", REGIONS)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("inputs", "own"), [("OFF_SQ INIT_SQ ACK_EF", False), ("SW_AUTO SW_MAN S_SEL:INT S_OFF", True)]
)
def test_a_branch_of_one_step_has_a_state_of_its_own_where_it_can_end_alone(inputs: str, own: bool) -> None:
    chart = m.SfcNetwork()
    start, one, other = (chart.add_step(f"S{number}", initial=number == 1) for number in (1, 2, 3))
    chart.add_transition(start, [one, other], "#c1")
    chart.add_transition([one, other], start, "#c2")
    one.actions, other.actions = [act("N"), act("S", "P", "V1")], [act("S", "R", "S0")]
    one.supervision = m.Supervised(condition=m.Expression(text="#c3"))
    chart.graph_settings = m.GraphSettings(acknowledge_errors_required="ACK_EF" in inputs)
    names = {variable.name for variable in lowered(block(chart, inputs, "Q P R"), construction=REGIONS).pou.variables()}
    assert ("step_number_S2" in names) is own
    proven(chart, inputs, "Q P R", REGIONS)


def branches() -> m.SfcNetwork:
    chart = chain("S1", "S2", conditions="#c1")
    left, right = chart.add_step("S3"), chart.add_step("S4")
    chart.add_transition(chart.step("S2"), [left, right], "#c2")
    chart.add_transition([left, right], chart.step("S1"), "#c3")
    left.actions, right.actions = [act("N")], [act("N", "P", interlock=True)]
    right.interlock = m.Supervised(condition=m.Expression(text="#c1"))
    right.supervision = m.Supervised(condition=m.Expression(text="#c2"))
    return chart


def test_a_branch_that_ends() -> None:
    chart = branches()
    end = chart.add_transition(chart.step("S4"), [], "#c1")
    end.priority = 9
    proven(chart, "INIT_SQ", "Q P", REGIONS)


def test_steps_are_skipped() -> None:
    chart = ring(act("N"), act("N", "P", "S1", value="NOT #P"))
    fourth = chart.add_step("S4")
    chart.add_transition(chart.step("S2"), fourth, "#c1 AND #c3")
    chart.add_transition(fourth, chart.step("S3"), "#S1.X")
    chart.graph_settings = m.GraphSettings(skip_steps=True)
    proven(chart, "INIT_SQ", "Q P")


@pytest.mark.parametrize("states", ["constants", "enumeration"])
def test_names_of_states(states: str) -> None:
    chart = m.SfcNetwork()
    wait, fill = chart.add_step("Wait", initial=True), chart.add_step("Fill")
    chart.add_transition(wait, fill, "c1")
    chart.add_transition(fill, wait, "c2")
    fill.actions = [m.ActionAssociation(id=1, target="Q", event=m.ActionEvent.S0)]
    project = block(chart, "INIT_SQ", "Q S_NO:INT S_ACTIVE")
    project.dialect = Dialect.IEC
    lowered = sfc.lower(project, profile="s7graph", states=states)
    assert lowered.construction is CASE
    assert lowered.why == "at most one step is active at a time"
    assert ("STEP_Fill" if states == "constants" else "Sequence_Step#Fill") in _text(lowered)


@pytest.mark.parametrize(
    ("chart", "inputs", "message"),
    [
        (ring(act("ON", "S1", "S1")), "", "step S2 switches steps on: #S1"),
        (ring(act("OFF", "S_ALL", "S1")), "", "step S2 switches steps off: #S_ALL"),
        (ring(), "SW_MAN S_SEL:INT S_ON", "S_ON can switch on a step"),
        (m.SfcNetwork(), "", "no step is initial"),
    ],
    ids=["on", "off", "by hand", "empty"],
)
@pytest.mark.parametrize("construction", [CASE, REGIONS])
def test_what_leaves_several_steps_active_is_refused(
    chart: m.SfcNetwork, inputs: str, message: str, construction: Construction
) -> None:
    project = block(chart, inputs)
    with pytest.raises(LoweringError, match=message) as caught:
        sfc.lower(project, construction, profile="s7graph", verify=False)
    assert "Step bits can hold every chart" in str(caught.value)
    lowered = sfc.lower(project, profile="s7graph", verify=False)
    assert lowered.construction is Construction.BITS
    assert message in lowered.why


@pytest.mark.slow
def test_switching_on_by_hand_that_nobody_operates() -> None:
    project = block(ring(act("N")), "INIT_SQ SW_MAN SW_TAP S_SEL:INT S_ON T_PUSH", "Q S_NO:INT")
    operated = sfc.lower(project, profile="s7graph", verify=False)
    assert operated.construction is Construction.BITS
    assert operated.why.endswith("with S_ON inactive one could")
    with pytest.raises(LoweringError, match="S_ON can switch on") as caught:
        sfc.lower(project, "case", profile="s7graph")
    assert "at_rest=['S_ON']" in str(caught.value)
    lowered = sfc.lower(project, "case", profile="s7graph", at_rest=["s_on"])
    assert lowered.at_rest == lowered.as_dict()["at_rest"] == {"S_ON": False}
    assert "\nat rest, without code: S_ON\n" in str(lowered)
    assert lowered.proof is not None
    assert not lowered.proof.different
    assert "S_ON" not in _text(lowered)
    assert "SW_MAN" in _text(lowered)
    assert {v.name for v in lowered.pou.variables()} >= {"S_ON", "SW_MAN"}  # who calls the block still can


def test_no_command_is_operated() -> None:
    project = block(ring(act("N")), f"OWN {STANDARD_INPUTS}", f"Q {STANDARD_OUTPUTS}")
    lowered = sfc.lower(project, profile="s7graph", at_rest="all")
    assert lowered.construction is CASE
    assert lowered.proof is not None
    assert lowered.proof.proven
    assert set(lowered.at_rest) == {name for name in STANDARD_INPUTS.split() if name != "S_SEL:INT"}
    assert "edge" not in _text(lowered)
    bits = sfc.lower(project, "bits", profile="s7graph", at_rest="all")
    assert bits.proof is not None
    assert bits.proof.proven
    assert "edge" not in _text(bits)


@pytest.mark.slow
def test_inputs_that_act_together_are_proven_together() -> None:
    chart = chain("S1", "S2", conditions="#c1 #c2")
    lowered = sfc.lower(block(chart, STANDARD_INPUTS, "S_NO:INT"), "bits", profile="s7graph")
    assert lowered.proof is not None
    reason = lowered.proof.reason
    assert "S_OFF, T_PUSH are FALSE it is proven: " in reason
    assert "only these of them are operated: OFF_SQ and INIT_SQ (" in reason
    assert "; ACK_EF (" in reason
    assert "; SW_AUTO and SW_TAP and T_PUSH (" in reason
    alone = sfc.lower(block(chart, "INIT_SQ OFF_SQ", "S_NO:INT"), profile="s7graph")
    assert alone.proof is not None
    assert alone.proof.proven


def test_what_only_one_command_shows_is_found() -> None:
    """The comparison with a block that forgets OFF_SQ, which is different only while that is operated."""
    chart = ring(act("N"))
    project = block(chart, STANDARD_INPUTS, "Q")
    lowered = sfc.lower(project, "bits", profile="s7graph", at_rest=["OFF_SQ"], verify=False)
    found = prove(
        resolve(project, "Sequence"),
        resolve(lowered.project, "Sequence"),
        lowered.profile,
        fixed={},
        left_out=None,
        step_flags=lowered.step_flags,
        cap=200,
        runs=0,
    )
    assert found.counterexample is not None
    assert found.counterexample.shortest
    assert any(row["OFF_SQ"] for row in found.counterexample.inputs)


def test_only_what_operates_a_sequencer_can_be_at_rest() -> None:
    with pytest.raises(ModelError, match="C1 does not operate sequencers"):
        sfc.lower(block(ring()), profile="s7graph", at_rest=["c1"])
    with pytest.raises(LoweringError, match="only blocks of S7-GRAPH"):
        sfc.lower(block(ring()), profile="codesys", at_rest=["INIT_SQ"])


def _text(lowered: LoweredPou) -> str:
    body = lowered.pou.body
    assert isinstance(body, m.StBody)
    return body.text


@pytest.mark.slow
@settings(deadline=None, max_examples=examples(40), derandomize=True, suppress_health_check=[HealthCheck.too_slow])
@given(sequencers(switching=False))
def test_any_sequencer(drawn: tuple[m.SfcNetwork, str, str]) -> None:
    project = block(*drawn)
    for construction in (CASE, REGIONS):
        try:
            made = text(project, construction)
        except LoweringError:
            continue
        found = verdict(project, construction=construction, cap=150, runs=3)
        assert not found.different, f"{found}\n{made}"
