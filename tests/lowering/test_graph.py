"""Sequencers of S7-GRAPH as structured text: proven to do the same."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given, settings

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import VerdictKind, equivalent
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering import Construction, Language
from plcopen_sfc.model.dialect import Dialect
from tests.languages.networks import build
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
from tests.sweeps import examples, in_turn


def proven(chart: m.SfcNetwork, inputs: str = "", outputs: str = "Q", cap: int = 3_000) -> None:
    project = block(chart, inputs, outputs)
    found = verdict(project, cap=cap)
    assert found.kind is VerdictKind.PROVEN, f"{found}\n{text(project)}"


def only_tested(chart: m.SfcNetwork, inputs: str = "", outputs: str = "Q") -> None:
    project = block(chart, inputs, outputs)
    found = verdict(project, cap=500)
    assert not found.different, f"{found}\n{text(project)}"
    assert not found.proven


@pytest.mark.parametrize(
    "action",
    [
        act("N"),
        act("S"),
        act("R"),
        act("D", duration="T#20ms"),
        act("L", duration="T#30ms"),
        act("N", event="S1"),
        act("N", event="S0"),
        act("S", event="S1"),
        act("S", event="S0"),
        act("R", event="S1"),
        act("N", value="NOT #Q"),
        act("N", event="S1", value="NOT #Q"),
        act("N", event="S0", value="NOT #Q"),
        act("CALL", None, body=m.StBody(text="#Q := NOT #Q;")),
    ],
    ids=lambda a: f"{a.qualifier}{a.event or ''}{a.value or ''}",
)
def test_one_action(action: m.ActionAssociation) -> None:
    proven(ring(action))


def test_what_is_set_is_reset() -> None:
    chart = ring(act("S"))
    chart.step("S3").actions = [act("R", event="S1"), act("N", "P")]
    proven(chart, outputs="Q P")


def test_several_steps_drive_one_coil() -> None:
    chart = ring(act("N"), act("L", duration="T#20ms"))
    chart.step("S1").actions = [act("D", duration="T#10ms")]
    chart.step("S3").actions = [act("N", event="S0")]
    proven(chart)


def test_a_coil_that_something_else_writes() -> None:
    chart = ring(act("N"))
    chart.step("S3").actions = [act("S", event="S1")]
    chart.permanent_post = [m.PermanentOperation(body=m.StBody(text="IF #c1 AND #c3 THEN #Q := TRUE; END_IF;"))]
    proven(chart)


@pytest.mark.parametrize("event", ["S1", "S0"])
@pytest.mark.parametrize("qualifier", ["CS", "CU", "CD", "CR"])
def test_counters(qualifier: str, event: str) -> None:
    value = "998" if qualifier == "CS" else None
    chart = ring(act(qualifier, "n", event, value=value))
    chart.step("S1").actions = [act("CU", "n", "S1")]
    chart.step("S3").actions = [act("CS", "n", "S0", value="2")]
    proven(chart, outputs="n:INT")


@pytest.mark.parametrize("event", ["S1", "S0"])
@pytest.mark.parametrize("qualifier", ["TL", "TD"])
def test_timers(qualifier: str, event: str) -> None:
    chart = ring(act(qualifier, "T1", event, duration="T#20ms"))
    chart.step("S3").actions = [act("TR", "T1", "S0"), act("N", "Q", value="#T1")]
    proven(chart, outputs="T1 Q")


def test_a_timer_that_runs_in_several_ways() -> None:
    chart = ring(act("TF", "T1", duration="T#20ms"))
    chart.step("S1").actions = [act("TL", "T1", "S0", duration="T#30ms")]
    chart.step("S3").actions = [act("TD", "T1", "S1", duration="T#10ms"), act("TF", "Q", duration="T#0ms")]
    proven(chart, outputs="T1 Q")


@pytest.mark.parametrize("qualifier", ["ON", "OFF"])
@pytest.mark.parametrize("target", ["S1", "S3", "S_ALL", "S2"])
def test_steps_are_switched(qualifier: str, target: str) -> None:
    chart = ring(act(qualifier, target, "S1"))
    chart.step("S3").actions = [act("ON", "S1", "S0")]
    proven(chart, outputs="")


def test_a_step_that_was_just_switched_on_is_not_supervised_yet() -> None:
    chart = ring(act("ON", "S1", "S1"), act("N"))
    chart.step("S1").supervision = m.Supervised(condition=m.Expression(text="#fault"))
    proven(chart, "fault")


EVENTS = ["L1", "L0", "V1", "V0", "S1", "S0"]


@pytest.mark.slow
@pytest.mark.parametrize("acknowledge", [False, True])
@pytest.mark.parametrize("event", EVENTS)
def test_events_of_interlock_and_supervision(event: str, acknowledge: bool) -> None:
    chart = guarded(act("N", value="NOT #Q", event=event), act("N", "P", interlock=True), acknowledge=acknowledge)
    proven(chart, "ok fault ACK_EF", "Q P")


@pytest.mark.slow
@pytest.mark.parametrize("acknowledge", [False, True])
def test_acknowledging(acknowledge: bool) -> None:
    chart = guarded(act("N", value="NOT #Q", event="A1"), act("S", "P", interlock=True), acknowledge=acknowledge)
    proven(chart, "ok fault ACK_EF", "Q P ERR_FLT")


def test_an_interlock_and_a_supervision_that_nobody_asks_for_are_short() -> None:
    project = block(guarded(act("N", interlock=True)), "ok fault", "Q")
    assert verdict(project).proven
    code = text(project)
    assert "#Q := #X2 AND #ok;" in code
    assert "#T2_3 := #X2 AND #c2 AND NOT #fault;" in code
    assert "_VA" not in code


@pytest.mark.parametrize("asked", ["LA", "LS", "VA", "VS", "L1", "V1", "S1", "S0"])
def test_data_of_a_step_in_conditions_of_others(asked: str) -> None:
    chart = guarded(act("N"))
    chart.step("S3").interlock = m.Supervised(condition=m.Expression(text=f"NOT #S2.{asked}"))
    chart.step("S3").actions = [act("N", "P", interlock=True)]
    chart.transitions[1].condition = m.Expression(text=f"#c2 OR #S2.{asked}")
    chart.permanent_pre = [m.PermanentOperation(body=m.StBody(text=f"#A := #S2.{asked};"))]
    chart.permanent_post = [m.PermanentOperation(body=m.StBody(text=f"#B := #S2.{asked} AND NOT #S2.X;"))]
    proven(chart, "ok fault", "Q P A B")


_STEP_DATA = {**dict.fromkeys("X S1 S0 L1 L0 V1 V0 A1 R1 LS LA VS VA".split(), "BOOL"), "SNO": "INT"}


def asking(asked: str, kind: str) -> m.Project:
    """Actions of the step itself and of others assign its data, in each cycle, at events and in calls."""
    chart = guarded(act("N", "a", value=f"#S2.{asked}"), acknowledge=True)
    chart.step("S2").max_time = "T#7s"
    chart.step("S1").actions = [act("N", "b", "S1", value=f"#S2.{asked}")]
    chart.step("S3").actions = [
        act("N", "c", "S0", value=f"#S2.{asked}"),
        act("CALL", None, body=m.StBody(text=f"IF #S2.{asked} = #c THEN #d := #S2.{asked}; END_IF;")),
    ]
    return block(chart, "ok fault ACK_EF REG_S", " ".join(f"{name}:{kind}" for name in "abcd"))


_OTHER_FORMS: list[dict[str, Any]] = [
    {"language": Language.FBD, "target": "simaticml"},
    {"language": Language.LD, "target": "plcopen"},
    {"construction": Construction.REGIONS},
]


@pytest.mark.slow
@pytest.mark.parametrize(("asked", "kind"), [*_STEP_DATA.items(), *((asked, "TIME") for asked in ("T", "U", "T_MAX"))])
def test_data_of_a_step_in_values_of_actions(asked: str, kind: str) -> None:
    project = asking(asked, kind)
    assert not verdict(project, cap=200, runs=5).different, text(project)
    for form in in_turn(_OTHER_FORMS, sum(map(ord, asked))):
        assert not verdict(project, cap=100, runs=5, **form).different


@pytest.mark.slow
def test_a_delay_that_is_the_time_of_a_step() -> None:
    chart = ring(act("N"))
    chart.step("S3").actions = [act("D", "P", duration="#S2.T"), act("L", "R", duration="#time")]
    chart.step("S1").actions = [act("N", "time", value="#time + T#10ms"), act("L", "R", duration="#time")]
    project = block(chart, "", "Q P R time:TIME")
    for language in (Language.ST, Language.FBD, Language.LD):  # SCL has no instruction list
        assert not verdict(project, language, cap=200, runs=20).different, language


@pytest.mark.parametrize("asked", ["T", "U"])
def test_step_times(asked: str) -> None:
    chart = guarded(act("N", value="NOT #Q"))
    chart.transitions[1].condition = m.Expression(text=f"#S2.{asked} >= T#20ms")
    # the time without disturbance is counted from the time of the step, which has no end then
    (proven if asked == "T" else only_tested)(chart, "ok fault")


@pytest.mark.parametrize("asked", ["T", "U"])
@pytest.mark.parametrize("checked", [False, True])
def test_step_times_stay_when_the_step_is_left(asked: str, checked: bool) -> None:
    chart = guarded() if checked else ring()
    chart.permanent_post = [m.PermanentOperation(body=m.StBody(text=f"#Q := #S2.{asked} >= T#20ms;"))]
    chart.permanent_pre = [m.PermanentOperation(body=m.StBody(text=f"#P := #S2.{asked} > T#10ms;"))]
    (only_tested if checked and asked == "U" else proven)(chart, "ok fault", "Q P")


def test_delays_and_times_of_one_step() -> None:
    chart = ring(act("D", duration="T#20ms"), act("L", "P", duration="T#30ms"), act("D", "R", duration="T#10ms"))
    chart.transitions[1].condition = m.Expression(text="#S2.T > T#20ms AND #c2")
    proven(chart, outputs="Q P R")


def test_start_and_end_of_the_sequence() -> None:
    proven(ring(act("N")), "INIT_SQ OFF_SQ")


@pytest.mark.parametrize("inputs", ["SW_TAP T_PUSH", "SW_TOP T_PUSH SW_AUTO", "SW_TAP SW_TOP T_PUSH", "SW_AUTO"])
def test_operating_modes(inputs: str) -> None:
    proven(ring(act("N")), inputs, "Q AUTO_ON MAN_ON TAP_ON TOP_ON")


@pytest.mark.slow
@pytest.mark.parametrize(
    "inputs", ["SW_MAN S_SEL:INT S_ON", "SW_MAN S_SEL:INT S_OFF", "SW_MAN S_ON S_OFF", "SW_MAN S_SEL:INT"]
)
def test_steps_are_switched_by_hand(inputs: str) -> None:
    # every number that S_SEL is compared with is tried in each of 140 states
    proven(chain("S1", "S2", conditions="#c1 #c2"), inputs, "S_NO:INT MAN_ON S_ACTIVE", cap=6_000)


@pytest.mark.parametrize("inputs", ["", "S_NEXT", "S_NEXT S_PREV"])
def test_the_step_displayed(inputs: str) -> None:
    chart = ring()
    b = chart.add_step("S4", initial=True)
    chart.add_transition(b, chart.step("S3"), "#c3")
    proven(chart, inputs, "S_NO:INT S_MORE S_ACTIVE")


@pytest.mark.slow
def test_the_step_displayed_of_many() -> None:
    chart = chain(*(f"S{number}" for number in range(1, 9)), conditions="#c1 #c2 #c1 #c2 #c1 #c2 #c1 #c2")
    other = chart.add_step("S9", initial=True)
    chart.add_transition(other, chart.step("S4"), "#c3")
    inputs = "S_NEXT SW_MAN S_SEL:INT S_ON"
    outputs = "S_NO:INT S_MORE S_ACTIVE"
    assert not verdict(block(chart, inputs, outputs), cap=100, runs=5).different
    assert not verdict(block(chart, inputs, outputs), Language.FBD, cap=100, runs=5).different
    proven(chart, "", outputs)


def test_parameters_that_the_profile_does_not_know_are_refused() -> None:
    chart = ring(act("N"))
    chart.graph_settings = m.GraphSettings()
    with pytest.raises(LoweringError, match="HALT_SQ"):
        lowered(block(chart, "HALT_SQ", "Q"))


def test_a_locked_mode() -> None:
    chart = ring(act("N"))
    chart.graph_settings = m.GraphSettings(lock_operating_mode=True)
    project = block(chart, "SW_MAN SW_TAP T_PUSH", "Q AUTO_ON MAN_ON")
    assert verdict(project).proven
    assert "SW_MAN" not in text(project)


def test_registering() -> None:
    chart = ring(act("N", "P", "R1"), act("S", event="R1"))
    proven(chart, "REG_EF REG_S", "Q P")


@pytest.mark.slow
def test_standard_parameters() -> None:
    chart = guarded(act("N", interlock=True), act("D", "P", duration="T#20ms"), acknowledge=True)
    project = block(chart, f"ok fault {STANDARD_INPUTS}", f"Q P {STANDARD_OUTPUTS}")
    found = verdict(project, cap=150, runs=15)
    assert not found.different, str(found)
    assert not found.proven
    at_rest = {name.partition(":")[0]: 0 for name in STANDARD_INPUTS.split() if name != "ACK_EF"}
    assert verdict(project, fixed=at_rest).proven


def test_what_is_not_there_makes_no_code() -> None:
    chart = ring(act("N"))
    chart.step("S3").actions = [act("S", "P")]
    assert text(block(chart, outputs="Q P")) == (
        """// Transitions
#T1_2 := #X1 AND #c1;
#T2_3 := #X2 AND #c2;
#T3_1 := #X3 AND #c3;

// Steps that become active
#X1 := #T3_1 OR #X1 AND NOT #T1_2;
#X2 := #T1_2 OR #X2 AND NOT #T2_3;
#X3 := #T2_3 OR #X3 AND NOT #T3_1;

// Start of the sequence
IF #FirstScan THEN
    #X1 := TRUE;
    #X2 := FALSE;
    #X3 := FALSE;
    #FirstScan := FALSE;
END_IF;

// Action #Q
#Q := #X2;

// Step S3: actions
IF #X3 THEN
    #P := TRUE;
END_IF;"""
    )


@pytest.mark.parametrize("asked", ["V1", "V0", "A1", "R1", "S1", "S0"])
def test_an_interlock_that_asks_for_an_event_which_is_found_later_in_the_cycle(asked: str) -> None:
    chart = guarded(act("N", interlock=True))
    chart.step("S2").interlock = m.Supervised(condition=m.Expression(text=f"#S2.{asked} OR #S3.{asked}"))
    proven(chart, "fault ACK_EF REG_S")


def test_steps_are_skipped() -> None:
    chart = ring(act("N"), act("N", "P", "S1", value="NOT #P"))
    fourth = chart.add_step("S4")
    chart.add_transition(chart.step("S2"), fourth, "#c1 AND #c3")
    chart.add_transition(fourth, chart.step("S3"), "#S1.X")
    chart.graph_settings = m.GraphSettings(skip_steps=True)
    proven(chart, "INIT_SQ", "Q P")


def test_a_block_without_steps() -> None:
    assert not verdict(block(m.SfcNetwork(), STANDARD_INPUTS, STANDARD_OUTPUTS), cap=100, runs=3).different


# -- flip-flops


@pytest.mark.slow
@pytest.mark.parametrize("target", ["simaticml", "plcopen"])
@pytest.mark.parametrize("language", [Language.FBD, Language.LD])
@pytest.mark.parametrize(
    ("actions", "inputs"),
    [
        ([act("N"), act("S", "P", interlock=True)], "ok fault INIT_SQ OFF_SQ"),
        ([act("D", duration="T#20ms"), act("N", "P", "S0")], "ok fault"),
        ([act("N", value="NOT #Q"), act("R", "P", "V0")], "ok fault ACK_EF"),
        ([act("ON", "S1", "S1"), act("OFF", "S_ALL", "V1")], "ok fault"),
        ([act("CS", "n", "S1", value="3"), act("CD", "n", "L1")], "ok fault"),
        ([act("N")], "ok fault SW_MAN S_SEL:INT S_ON"),
        ([act("N")], "SW_MAN S_SEL:INT S_OFF"),
    ],
    ids=["set", "delayed", "toggled", "switched", "counted", "on by hand", "off by hand"],
)
def test_flip_flops(language: Language, target: str, actions: list[m.ActionAssociation], inputs: str) -> None:
    chart = guarded(*actions, acknowledge="ACK_EF" in inputs)
    found = verdict(block(chart, inputs, "Q P n:INT"), language, target=target, cap=1_500, runs=5)
    assert not found.different, str(found)


def test_networks_have_no_loops() -> None:
    chart = ring(act("N"))
    chart.graph_settings = m.GraphSettings(skip_steps=True)
    with pytest.raises(LoweringError, match="skipped"):
        lowered(block(chart, outputs="Q"), Language.FBD)


# -- what sequencers cannot be lowered to


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"modes": ("enable",)}, "operating modes of their own"),
        ({"actions": "block"}, "cannot be in a block of their own"),
        ({"reset_actions": True}, "only R of the chart ends it"),
        ({"style": "classic"}, "no classic style"),
    ],
)
def test_options_that_sequencers_do_not_have_are_refused(options: dict[str, Any], message: str) -> None:
    with pytest.raises(LoweringError, match=message):
        sfc.lower(block(ring()), profile="s7graph", verify=False, **options)


@pytest.mark.parametrize(
    ("action", "message"),
    [
        (act("P"), "has no rule for the qualifier P"),
        (act("ON", "S9", "S1"), "no step"),
        (act("CU", "n"), "needs an event"),
        (act("D"), "needs a time"),
        (act("D", event="S1", duration="T#1s"), "has no event"),
        (act("N", value="#S1.TV"), "not lowered yet"),
        (act("CALL", None, body=m.StBody(text="#S1.T := T#0s;")), "data of steps are written"),
        (act("CALL", None, body=m.StBody(text="F(#S1);")), "in a way that is not lowered"),
        (act("N", "n"), "no Boolean variable"),
        (act("S", "S1.X"), "data of steps are written"),
    ],
    ids=str,
)
def test_what_is_refused(action: m.ActionAssociation, message: str) -> None:
    with pytest.raises(LoweringError, match=message):
        lowered(block(ring(action), outputs="Q n:INT"))


def test_an_input_that_starts_the_sequence_anew() -> None:
    project = block(ring(act("N")), outputs="Q")
    lowered_block = sfc.lower(project, "bits", profile="s7graph", init="Restart")
    assert lowered_block.proof is not None
    assert lowered_block.proof.proven
    body = lowered_block.pou.body
    assert isinstance(body, m.StBody)
    assert "IF #FirstScan OR #Restart THEN" in body.text


# -- charts at random


@pytest.mark.slow
@settings(deadline=None, max_examples=examples(60), derandomize=True)
@given(sequencers())
def test_any_sequencer(drawn: tuple[m.SfcNetwork, str, str]) -> None:
    chart, inputs, outputs = drawn
    project = block(chart, inputs, outputs)
    found = verdict(project, cap=300, runs=4)
    assert not found.different, f"{found}\n{text(project)}"
    try:
        drawn_code = verdict(project, Language.FBD, cap=100, runs=2)
    except LoweringError:
        return  # a loop, or a call on a condition
    assert not drawn_code.different, str(drawn_code)


def test_a_chart_of_another_tool_as_a_sequencer() -> None:
    """Texts of IEC 61131-3 with the semantics and parameters of S7-GRAPH."""
    chart = m.SfcNetwork()
    wait, fill = chart.add_step("Wait", initial=True), chart.add_step("Fill")
    chart.add_transition(wait, fill, "c1")
    chart.add_transition(fill, wait, "Fill.T >= T#20ms")
    fill.actions = [m.ActionAssociation(id=1, target="Q"), m.ActionAssociation(id=2, target="P")]
    fill.actions[1].qualifier, fill.actions[1].duration = m.Qualifier.D, "T#10ms"
    project = block(chart, "INIT_SQ OFF_SQ", "P Q S_NO:INT ERR_FLT")
    project.dialect = Dialect.IEC
    for construction in (Construction.BITS, Construction.FLIPFLOP):
        made = sfc.lower(project, construction, profile="s7graph", verify=False)
        assert equivalent(project, made.project, "s7graph", step_flags=made.step_flags).proven


# -- permanent operations drawn with global variables


def _operand(text: str) -> m.InputPin:
    return m.InputPin(expression=text)


RUNGS = {
    "timer": [
        build.block(2, "TON", {"IN": 1, "PT": _operand("T#20ms")}, "Q", "ET", instance='"T_DB"'),
        build.coil(3, '"Lamp"', (2, "Q")),
    ],
    "counter": [
        build.block(2, "CTU", {"CU": 1, "R": _operand('"Stop"'), "PV": _operand("3")}, "Q", "CV", instance='"C_DB"'),
        build.coil(3, '"Lamp"', (2, "Q")),
    ],
    "edge with an instance": [
        build.block(2, "R_TRIG", {"CLK": 1}, "Q", instance='"R_DB"'),
        build.coil(3, '"Lamp"', (2, "Q")),
    ],
    "edge contact": [
        build.block(2, "PContact", {"pre": 1, "operand": _operand('"Tag"'), "bit": _operand('"Bit"')}, "out"),
        build.coil(3, '"Lamp"', (2, "out")),
    ],
    "edge coil": [build.block(2, "NCoil", {"in": 1, "operand": _operand('"Lamp"'), "bit": _operand('"Bit"')}, "out")],
    "flip-flop": [
        build.block(2, "RS", {"S": 1, "R1": _operand('"Stop"'), "operand": _operand('"Bit"')}, "Q1"),
        build.coil(3, '"Lamp"', (2, "Q1")),
    ],
    "set": [build.coil(3, '"Lamp"', 1, storage="set"), build.coil(4, "#Q", 1, storage="reset")],
}


@pytest.mark.slow
@pytest.mark.parametrize("place", ["permanent_pre", "permanent_post"])
@pytest.mark.parametrize("name", RUNGS)
def test_permanent_rungs_with_global_variables(name: str, place: str) -> None:
    rung = m.LogicNetwork(nodes=[build.rail(), build.contact(1, "#c1", 0), *RUNGS[name]])
    chart = ring(act("N", value='NOT "Lamp"' if name != "timer" else '"T_DB".Q'))
    setattr(chart, place, [m.PermanentOperation(body=m.LdBody(networks=[rung]))])
    project = block(chart, "", "Q")
    assert len(sfc.simulate(project, profile="s7graph", scans=5)) == 5
    for language, target in ((Language.FBD, "simaticml"), (Language.LD, "simaticml"), (Language.LD, "plcopen")):
        found = verdict(project, language, target=target, cap=200, runs=5)
        assert not found.different, f"{language} {target}: {found}"


def test_the_instance_that_a_rung_calls_is_that_which_actions_and_conditions_read() -> None:
    rung = m.LogicNetwork(nodes=[build.rail(), build.contact(1, "#c1", 0), *RUNGS["timer"]])
    chart = ring(act("N", value='"T_DB".Q'))
    chart.transitions[1].condition = m.Expression(text='"T_DB".ET >= T#20ms AND #c2')
    chart.permanent_pre = [m.PermanentOperation(body=m.LdBody(networks=[rung]))]
    inputs = [{"c1": True}, {}, {}, {}, {"c2": True}]
    trace = sfc.simulate(block(chart, "", "Q"), profile="s7graph", scans=5, inputs=lambda scan, _: inputs[scan])
    assert list(trace["Q"]) == [False, False, True, True, True]
    assert trace.active(4) == ("S3",)
