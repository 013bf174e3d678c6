"""Sequencers of S7-GRAPH: actions and events, interlocks and supervisions, parameters and modes."""

from __future__ import annotations

from typing import Any

import pytest

from plcopen_sfc import loads
from plcopen_sfc.errors import UnknownBehaviourError
from plcopen_sfc.model import (
    ActionAssociation,
    ActionEvent,
    BodyCondition,
    Coil,
    Dialect,
    Expression,
    FbdBody,
    GraphSettings,
    InputPin,
    LogicNetwork,
    PermanentOperation,
    Qualifier,
    SfcNetwork,
    StBody,
    Supervised,
)
from plcopen_sfc.semantics.simulation import simulate
from tests.semantics.charts.rig import MS, Rig, chain


def rig(chart: SfcNetwork, variables: str = "", **options: Any) -> Rig:
    for number, step in enumerate(chart.steps, start=1):
        step.number = number
    return Rig(chart, "s7graph", variables=f"c1 c2 c3 {variables}", dialect=Dialect.SCL, **options)


def act(qualifier: str, target: str | None = "Q", event: str | None = None, **fields: Any) -> ActionAssociation:
    return ActionAssociation(
        id=1,
        qualifier=Qualifier(qualifier),
        target=f"#{target}" if target else None,
        event=ActionEvent(event) if event else None,
        **fields,
    )


def with_actions(*actions: ActionAssociation) -> SfcNetwork:
    """A ring of S1, S2 and S3; S2 has the actions."""
    chart = chain("S1", "S2", "S3", conditions="#c1 #c2 #c3")
    chart.step("S2").actions = list(actions)
    return chart


def log(bench: Rig, path: str = "Q") -> str:
    """`path` in the cycle that enters S2, two more, the one that leaves it, and two more."""
    bench.scan()
    return bench.log(path, 1, c1=True) + bench.log(path, 2, c1=False) + "|" + bench.log(path, 3, c2=True)


def test_the_first_call_activates_the_initial_step_without_a_look_at_conditions() -> None:
    chart = chain("S1", "S2", conditions="TRUE TRUE")
    bench = rig(chart)
    assert [bench.scan().active for _ in range(3)] == ["S1", "S2", "S1"]


@pytest.mark.parametrize(
    ("qualifier", "duration", "expected"),
    [
        ("N", None, "111|000"),
        ("S", None, "111|111"),
        ("R", None, "000|000"),
        ("D", "T#20ms", "001|000"),
        ("D", "T#30ms", "000|000"),
        ("L", "T#20ms", "110|000"),
        ("L", "T#40ms", "111|000"),
    ],
)
def test_standard_actions(qualifier: str, duration: str | None, expected: str) -> None:
    assert log(rig(with_actions(act(qualifier, duration=duration)), "Q")) == expected


def test_a_reset_clears_what_was_set() -> None:
    chart = with_actions(act("S"))
    chart.step("S3").actions = [act("R")]
    assert log(rig(chart, "Q")) == "111|000"


def test_neighbours_that_drive_one_operand_leave_no_gap() -> None:
    chart = with_actions(act("N"))
    chart.step("S1").actions = [act("N")]
    chart.step("S3").actions = [act("N")]
    assert log(rig(chart, "Q")) == "111|111"


def test_what_the_next_step_sets_is_not_undone_by_the_coil_of_the_step_before() -> None:
    chart = with_actions(act("N"))
    chart.step("S3").actions = [act("S", event="S1")]
    assert log(rig(chart, "Q")) == "111|111"


def test_a_trace_shows_the_steps() -> None:
    trace = simulate(rig(with_actions(act("N")), "Q").project, profile="s7graph", scans=2)
    assert trace.steps == ("S1", "S2", "S3")
    assert trace.active(1) == ("S1",)


def test_no_step_is_skipped_twice_in_one_cycle() -> None:
    chart = chain("S1", "S2", "S3", conditions="#c1 TRUE TRUE")
    chart.graph_settings = GraphSettings(skip_steps=True)
    assert rig(chart).scan().scan(c1=True).active == "S2"


def test_a_call_and_an_assignment_are_executed_in_every_cycle() -> None:
    call = ActionAssociation(id=2, qualifier=Qualifier.CALL, body=StBody(text="#m := #m + 1;"))
    bench = rig(with_actions(act("N", "n", value="#n + 1"), call), "Q n:INT m:INT")
    log(bench)
    assert (bench["n"], bench["m"]) == (3, 3)


@pytest.mark.parametrize(("event", "expected"), [("S1", "100|000"), ("S0", "000|100")])
def test_actions_on_the_activation_and_deactivation(event: str, expected: str) -> None:
    assert log(rig(with_actions(act("N", event=event)), "Q")) == expected
    bench = rig(with_actions(act("N", "n", event, value="#n + 1")), "Q n:INT")
    log(bench)
    assert bench["n"] == 1


def test_events_of_the_old_and_the_new_step_are_in_the_same_cycle() -> None:
    chart = with_actions(act("N", "text", "S0", value="CONCAT(IN1 := #text, IN2 := 'old ')"))
    chart.step("S3").actions = [act("N", "text", "S1", value="CONCAT(IN1 := #text, IN2 := 'new ')")]
    bench = rig(chart, "text:STRING").scan().scan(c1=True).scan(c1=False, c2=True)
    assert bench["text"] == "old new "


def test_a_counter_of_parts() -> None:
    chart = with_actions(act("CU", "parts", "S1"))
    chart.step("S1").actions = [act("CR", "parts", "S0")]
    chart.step("S3").actions = [act("CD", "parts", "S1"), act("CS", "parts", "S0", value="7")]
    bench = rig(chart, "parts:INT").scan(parts=5).scan(c1=True)
    assert bench["parts"] == 1, "reset by the old step, then counted by the new one"
    bench.scan(3, c1=False)
    assert bench["parts"] == 1
    assert bench.scan(c2=True)["parts"] == 0
    assert bench.scan(c2=False, c3=True)["parts"] == 7


def test_switching_steps_on_and_off() -> None:
    chart = with_actions(act("ON", "S1", "S1"))
    chart.step("S3").actions = [act("OFF", "S1", "S1")]
    bench = rig(chart).scan().scan(c1=True).scan(c1=False)
    assert bench.active == "S1 S2"
    bench.scan(c2=True).scan(c2=False)
    assert bench.active == "S3"


def test_switching_all_other_steps_off() -> None:
    chart = SfcNetwork()
    a, b, c = (chart.add_step(name, initial=name == "S1") for name in ("S1", "S2", "S3"))
    chart.add_transition(a, [b, c], "#c1")
    d = chart.add_step("S4")
    chart.add_transition(c, d, "#c2")
    d.actions = [act("OFF", "S_ALL", "S1")]
    bench = rig(chart).scan().scan(c1=True).scan(c2=True)
    assert bench.active == "S2 S4"
    assert bench.scan().active == "S4"


@pytest.mark.parametrize(("qualifier", "expected"), [("TL", "1110000"), ("TD", "0001111")])
def test_timers(qualifier: str, expected: str) -> None:
    bench = rig(with_actions(act(qualifier, "T1", "S1", duration="T#30ms")), "T1").scan()
    assert bench.log("T1", 1, c1=True) + bench.log("T1", 6, c2=True) == expected


def test_a_timer_is_stopped_by_its_reset() -> None:
    chart = with_actions(act("TL", "T1", "S1", duration="T#1s"))
    chart.step("S3").actions = [act("TR", "T1", "S1")]
    bench = rig(chart, "T1")
    assert log(bench, "T1") == "111|000"


def test_an_off_delay() -> None:
    bench = rig(with_actions(act("TF", "T1", duration="T#20ms")), "T1")
    assert log(bench, "T1") == "111|110"


# -- interlock and supervision


def guarded(*actions: ActionAssociation, acknowledge: bool | None = None) -> SfcNetwork:
    chart = with_actions(*actions)
    chart.step("S2").interlock = Supervised(condition=Expression(text="#ok"))
    chart.step("S2").supervision = Supervised(condition=Expression(text="#fault"))
    chart.graph_settings = GraphSettings(acknowledge_errors_required=acknowledge)
    return chart


GUARDS = "ok fault Q n:INT ACK_EF ERR_FLT"


def test_an_action_with_interlock_rests_while_its_condition_is_not_satisfied() -> None:
    bench = rig(guarded(act("N", interlock=True)), GUARDS).scan(ok=True).scan(c1=True)
    assert bench["Q"] is True
    assert bench.scan(ok=False)["Q"] is False
    assert bench.scan(ok=True)["Q"] is True


def test_an_action_without_interlock_does_not_care() -> None:
    bench = rig(guarded(act("N")), GUARDS).scan(c1=True).scan()
    assert (bench["ok"], bench["Q"]) == (False, True)


def test_the_interlock_does_not_stop_the_sequence() -> None:
    bench = rig(guarded(act("N", interlock=True)), GUARDS).scan(c1=True).scan()
    assert (bench.active, bench["S2.LA"], bench["ERR_FLT"]) == ("S2", True, True)
    assert bench.scan(c2=True, c1=False).active == "S3"
    assert (bench["S2.LA"], bench["ERR_FLT"]) == (False, False)


@pytest.mark.parametrize(("event", "counts"), [("L1", [0, 1, 1, 1, 2]), ("L0", [0, 0, 0, 1, 1])])
def test_events_of_the_interlock(event: str, counts: list[int]) -> None:
    bench = rig(guarded(act("N", "n", event, value="#n + 1")), GUARDS).scan(ok=True).scan(c1=True)
    seen = [bench["n"]]
    for ok in (False, False, True, False):
        seen.append(bench.scan(ok=ok)["n"])
    assert seen == counts


@pytest.mark.parametrize(("event", "counts"), [("V1", [0, 1, 1, 1, 2]), ("V0", [0, 0, 0, 1, 1])])
def test_events_of_the_supervision(event: str, counts: list[int]) -> None:
    bench = rig(guarded(act("N", "n", event, value="#n + 1")), GUARDS).scan(ok=True).scan(c1=True)
    seen = [bench["n"]]
    for fault in (True, True, False, True):
        seen.append(bench.scan(fault=fault)["n"])
    assert seen == counts


def test_a_supervision_error_holds_the_step_until_it_is_gone() -> None:
    bench = rig(guarded(), GUARDS).scan(ok=True).scan(c1=True).scan(c2=True, fault=True)
    assert (bench.active, bench["S2.VA"], bench["ERR_FLT"]) == ("S2", True, True)
    assert bench.scan(3).active == "S2"
    assert bench.scan(fault=False).active == "S3"
    assert bench["ERR_FLT"] is False


def test_an_error_that_must_be_acknowledged_holds_the_step_until_it_is() -> None:
    chart = guarded(act("N", "n", "A1", value="#n + 1"), acknowledge=True)
    bench = rig(chart, GUARDS).scan(ok=True).scan(c1=True).scan(c2=True, fault=True)
    assert bench.scan(3, fault=False).active == "S2"
    assert (bench["S2.VA"], bench["n"]) == (True, 0)
    bench.scan(ACK_EF=True)
    assert (bench["S2.VA"], bench.active) == (False, "S3")


def test_an_acknowledged_error_that_is_still_there_holds_the_step() -> None:
    chart = guarded(act("N", "n", "A1", value="#n + 1"), acknowledge=True)
    bench = rig(chart, GUARDS).scan(ok=True).scan(c1=True).scan(c2=True, fault=True).scan(ACK_EF=True)
    assert (bench.active, bench["n"]) == ("S2", 1)
    assert bench.scan(fault=False).active == "S3"


def test_time_without_disturbance() -> None:
    bench = rig(guarded(), GUARDS).scan(ok=True).scan(c1=True).scan(2)
    assert (bench["S2.T"], bench["S2.U"]) == (20 * MS, 20 * MS)
    bench.scan(2, fault=True).scan(fault=False)
    assert (bench["S2.T"], bench["S2.U"]) == (50 * MS, 30 * MS)


# -- parameters


def test_init_starts_the_sequence_anew() -> None:
    bench = rig(with_actions(act("N")), "Q INIT_SQ").scan().scan(c1=True)
    bench.scan(INIT_SQ=True)
    assert (bench.active, bench["Q"]) == ("S1", False)
    assert bench.scan().active == "S2", "only the edge of INIT_SQ counts"


def test_off_deactivates_all_steps_until_the_sequence_is_started_again() -> None:
    bench = rig(with_actions(act("N")), "Q OFF_SQ INIT_SQ").scan().scan(c1=True)
    bench.scan(OFF_SQ=True)
    assert (bench.active, bench["Q"]) == ("", False)
    assert bench.scan(3, OFF_SQ=False).active == ""
    assert bench.scan(INIT_SQ=True).active == "S1"


def test_permanent_operations_are_executed_in_every_cycle() -> None:
    chart = with_actions()
    chart.permanent_pre = [PermanentOperation(body=StBody(text="#n := #n + 1;"))]
    chart.permanent_post = [PermanentOperation(body=StBody(text="#n := #n + 10;"))]
    bench = rig(chart, "n:INT OFF_SQ").scan(2)
    assert bench["n"] == 22
    assert bench.scan(OFF_SQ=True).scan()["n"] == 44, "also while the sequence is off"


MODES = "SW_AUTO SW_MAN SW_TAP SW_TOP T_PUSH S_SEL:INT S_ON S_OFF AUTO_ON MAN_ON TAP_ON TOP_ON S_NO:INT S_MORE S_ACTIVE"


def test_modes_are_switched_by_edges_and_shown() -> None:
    bench = rig(with_actions(), MODES).scan()
    assert (bench["AUTO_ON"], bench["MAN_ON"]) == (True, False)
    bench.scan(2, SW_MAN=True)
    assert (bench["AUTO_ON"], bench["MAN_ON"]) == (False, True)
    assert bench.scan(SW_MAN=False)["MAN_ON"] is True
    assert bench.scan(SW_AUTO=True)["AUTO_ON"] is True


def test_a_locked_mode_stays() -> None:
    chart = with_actions()
    chart.graph_settings = GraphSettings(lock_operating_mode=True)
    assert rig(chart, MODES).scan().scan(SW_MAN=True)["AUTO_ON"] is True


def test_inching_needs_the_condition_and_the_push() -> None:
    bench = rig(with_actions(), MODES).scan(SW_TAP=True)
    assert bench.scan(3, c1=True, c2=True).active == "S1"
    assert bench.scan(T_PUSH=True).active == "S2"
    assert bench.scan(3).active == "S2", "one push, one step"
    assert bench.scan(T_PUSH=False, c2=False).scan(T_PUSH=True).active == "S2"


def test_automatic_or_step_by_step_takes_either() -> None:
    bench = rig(with_actions(), MODES).scan(SW_TOP=True)
    assert bench.scan(c1=True).active == "S2"
    assert bench.scan(c1=False, T_PUSH=True).active == "S3"
    assert bench.scan(3).active == "S3"


def test_by_hand_steps_are_selected_and_switched() -> None:
    bench = rig(with_actions(), MODES).scan(SW_MAN=True)
    assert bench.scan(3, c1=True).active == "S1", "no transition switches"
    bench.scan(S_SEL=3, S_ON=True)
    assert (bench.active, bench["S_NO"], bench["S_MORE"], bench["S_ACTIVE"]) == ("S1 S3", 3, True, True)
    bench.scan(S_SEL=1, S_ON=False, S_OFF=True)
    assert (bench.active, bench["S_NO"], bench["S_ACTIVE"]) == ("S3", 1, False)


def test_the_outputs_tell_the_active_step() -> None:
    bench = rig(with_actions(), MODES).scan()
    assert (bench["S_NO"], bench["S_MORE"], bench["S_ACTIVE"]) == (1, False, True)
    assert bench.scan(c1=True)["S_NO"] == 2


def test_several_sequences_in_one_block() -> None:
    chart = SfcNetwork()
    a, b, c, d = (chart.add_step(name, initial=name in ("A", "C")) for name in "ABCD")
    chart.add_transition(a, b, "#c1")
    chart.add_transition(c, d, "#c2")
    bench = rig(chart, "S_MORE").scan()
    assert (bench.active, bench["S_MORE"]) == ("A C", True)
    assert bench.scan(c2=True).active == "A D"


@pytest.mark.parametrize(("skips", "reached"), [(False, "S2"), (True, "S3"), (None, "S2")])
def test_steps_may_be_skipped(skips: bool | None, reached: str) -> None:
    chart = with_actions(act("N", "n", "S1", value="#n + 1"))
    chart.graph_settings = GraphSettings(skip_steps=skips)
    bench = rig(chart, "n:INT").scan().scan(c1=True, c2=True)
    assert (bench.active, bench["n"]) == (reached, 0 if skips else 1)


def test_the_leftmost_of_alternative_branches_wins() -> None:
    chart = SfcNetwork()
    a, b, c = (chart.add_step(name, initial=name == "S1") for name in ("S1", "S2", "S3"))
    chart.add_transition(a, b, "#c1")
    chart.add_transition(a, c, "#c2")
    assert rig(chart).scan().scan(c1=True, c2=True).active == "S2"


def test_data_of_steps_and_transitions() -> None:
    chart = with_actions()
    chart.transitions[0].name, chart.transitions[0].number = "T1", 1
    chart.step("S2").max_time = "T#7s"
    bench = rig(chart).scan()
    assert (bench["S1.X"], bench["S1.S1"], bench["S1.SNO"], bench["T1.TNO"]) == (True, True, 1, 1)
    bench.scan()
    assert (bench["S1.S1"], bench["T1.TV"], bench["T1.TT"], bench["T1.TS"]) == (False, True, False, False)
    bench.scan(c1=True)
    assert (bench["T1.TV"], bench["T1.TT"], bench["T1.TS"]) == (True, True, True)
    assert (bench["S1.S0"], bench["S2.S1"], bench["S2.T_MAX"]) == (True, True, 7000 * MS)
    bench.scan()
    assert (bench["S1.S0"], bench["S2.S1"], bench["T1.TV"]) == (False, False, False)


def test_an_empty_condition_is_always_satisfied() -> None:
    chart = with_actions()
    chart.transitions[0].condition = None
    assert rig(chart).scan(2).active == "S2"


def test_networks_with_nothing_but_their_coil_are_empty() -> None:
    """A condition without a program, as the FBD editor shows it."""

    def empty(name: str) -> BodyCondition:
        coil = Coil(id=1, variable=name, input=InputPin())
        return BodyCondition(name=name, body=FbdBody(networks=[LogicNetwork(nodes=[coil])]))

    chart = with_actions(act("N", interlock=True))
    chart.step("S2").interlock = Supervised(condition=empty("IlCoil"))
    chart.step("S2").supervision = Supervised(condition=empty("SvCoil"))
    chart.transitions[0].condition = empty("TrCoil")
    bench = rig(chart, "Q").scan(2)
    assert (bench.active, bench["Q"]) == ("S2", True)
    assert bench.scan(c2=True).active == "S3"


@pytest.mark.parametrize("qualifier", ["P", "P0", "P1", "SD", "DS", "SL"])
def test_qualifiers_of_iec_are_refused(qualifier: str) -> None:
    with pytest.raises(UnknownBehaviourError, match=qualifier):
        rig(with_actions(act(qualifier, duration="T#1s")), "Q").scan()


@pytest.mark.parametrize("qualifier", ["ON", "CU", "TL"])
def test_actions_that_need_an_event_are_refused_without_one(qualifier: str) -> None:
    with pytest.raises(UnknownBehaviourError, match="needs an event"):
        rig(with_actions(act(qualifier, "S1")), "Q").scan()


def test_supervisions_and_permanent_operations_are_refused_in_other_profiles() -> None:
    chart = guarded()
    with pytest.raises(UnknownBehaviourError, match="S2 has a supervision"):
        Rig(chart, "iec", variables="c1 c2 c3 ok fault", dialect=Dialect.SCL).scan()
    chart = with_actions()
    chart.permanent_post = [PermanentOperation(body=StBody(text=";"))]
    with pytest.raises(UnknownBehaviourError, match="permanent operations"):
        Rig(chart, "iec", variables="c1 c2 c3", dialect=Dialect.SCL).scan()


def test_step_actions_of_codesys_are_refused() -> None:
    chart = with_actions()
    chart.step("S2").entry_action = StBody(text=";")
    with pytest.raises(UnknownBehaviourError, match="entry, main or exit"):
        rig(chart).scan()


def test_events_are_refused_in_other_profiles() -> None:
    with pytest.raises(UnknownBehaviourError, match="S7-GRAPH"):
        Rig(with_actions(act("N", event="S1")), "iec", variables="c1 c2 c3 Q", dialect=Dialect.SCL).scan()


def test_a_step_with_the_name_of_a_bool_is_refused() -> None:
    text = """FUNCTION_BLOCK Main VAR Fault : BOOL; END_VAR INITIAL_STEP A: END_STEP STEP Fault: END_STEP
        TRANSITION FROM A TO Fault := TRUE; END_TRANSITION TRANSITION FROM Fault TO A := TRUE; END_TRANSITION
        END_FUNCTION_BLOCK"""
    with pytest.raises(UnknownBehaviourError, match="step Fault has the name of a BOOL variable"):
        simulate(loads(text.encode(), format="iec-text"), profile="s7graph")
