"""Charts of CODESYS: the order within a scan, step actions, times, and the flags."""

from __future__ import annotations

from typing import Any

import pytest

from plcopen_sfc.model import (
    Action,
    ActionAssociation,
    Dialect,
    FlagUse,
    Pou,
    PouKind,
    Project,
    Qualifier,
    SfcBody,
    SfcFlag,
    SfcNetwork,
    SfcSettings,
    StBody,
)
from plcopen_sfc.semantics.simulation import simulate
from tests.semantics.charts.rig import MS, Rig, chain

COUNT = "n:INT"


def rig(chart: SfcNetwork, variables: str = "", **options: Any) -> Rig:
    profile = options.pop("profile", "codesys")
    return Rig(chart, profile, variables=f"c1 c2 c3 {variables}", dialect=Dialect.CODESYS, **options)


def body(text: str) -> StBody:
    return StBody(text=text)


def test_the_initial_step_is_executed_in_the_first_scan() -> None:
    chart = chain("A", "B", conditions="TRUE FALSE")
    chart.step("A").main_action = body("n := n + 1;")
    bench = rig(chart, COUNT).scan()
    assert (bench.active, bench["n"], bench["A.x"]) == ("A", 1, True)
    bench.scan()
    assert (bench.active, bench["n"], bench["B.x"]) == ("B", 1, True)


def test_entry_and_exit_actions_are_executed_once() -> None:
    chart = chain("A", "B", "C")
    chart.step("B").entry_action = body("e := e + 1;")
    chart.step("B").main_action = "Work"
    chart.step("B").exit_action = body("x := x + 1;")
    bench = rig(chart, "e:INT x:INT n:INT", actions={"Work": "n := n + 1;"})
    bench.scan(2).scan(c1=True)
    assert (bench["e"], bench["n"], bench["x"]) == (0, 0, 0), "the step becomes active in the next scan"
    bench.scan(4, c1=False)
    assert (bench["e"], bench["n"], bench["x"]) == (1, 4, 0)
    bench.scan(c2=True)
    assert (bench["e"], bench["n"], bench["x"]) == (1, 5, 0), "the exit action waits for the next scan"
    bench.scan(3, c2=False)
    assert (bench["e"], bench["n"], bench["x"]) == (1, 5, 1)


def test_the_order_within_a_scan() -> None:
    """Exit actions, entry actions, main actions, IEC actions that ended, IEC actions that are active, transitions."""
    chart = chain("A", "B", conditions="go FALSE")
    for name, step in (("A", chart.step("A")), ("B", chart.step("B"))):
        for when in ("entry", "main", "exit"):
            setattr(step, f"{when}_action", body(f"log := CONCAT(log, '{name}{when} ');"))
    chart.step("A").actions = [ActionAssociation(id=1, target="Zeta"), ActionAssociation(id=2, target="alpha")]
    chart.step("B").actions = [ActionAssociation(id=3, target="Beta")]
    actions = {name: f"log := CONCAT(log, '{name} ');" for name in ("Zeta", "alpha", "Beta")}
    bench = rig(chart, "go log:STRING", actions=actions).scan(go=True)
    assert bench["log"] == "Aentry Amain alpha Zeta "
    bench["log"] = ""
    assert bench.scan()["log"] == "Aexit Bentry Bmain alpha Zeta Beta "
    bench["log"] = ""
    assert bench.scan()["log"] == "Bmain Beta "


def test_the_next_step_is_announced() -> None:
    bench = rig(chain("A", "B")).scan(2)
    assert (bench["A._x"], bench["B._x"]) == (True, False)
    bench.scan(c1=True)
    assert (bench["A.x"], bench["A._x"], bench["B.x"], bench["B._x"]) == (True, False, False, True)
    bench.scan()
    assert (bench["A.x"], bench["A._x"], bench["B.x"], bench["B._x"]) == (False, False, True, True)


def test_a_loop_on_itself_lets_the_time_go_on() -> None:
    """Steps change between two scans: that one was left is not to be seen."""
    chart = SfcNetwork()
    step = chart.add_step("A", initial=True)
    chart.add_transition(step, step, "TRUE")
    assert rig(chart).scan(4)["A.t"] == 30 * MS


def test_a_pulse_action_runs_exactly_twice() -> None:
    chart = chain("A", "B")
    chart.step("B").actions = [ActionAssociation(id=1, qualifier=Qualifier.P, target="Count")]
    bench = rig(chart, COUNT, actions={"Count": "n := n + 1;"}).scan(c1=True).scan(6, c1=False)
    assert bench["n"] == 2


def test_an_action_of_several_steps_runs_once_in_a_scan() -> None:
    chart = SfcNetwork()
    a, b, c = (chart.add_step(name, initial=name == "A") for name in "ABC")
    chart.add_transition(a, [b, c], "c1")
    for index, step in enumerate((b, c)):
        step.actions = [ActionAssociation(id=index, target="Count")]
    bench = rig(chart, COUNT, actions={"Count": "n := n + 1;"}).scan(c1=True).scan(3)
    assert bench["n"] == 3


def test_a_boolean_action_is_written_while_it_is_executed_only() -> None:
    chart = chain("A", "B")
    chart.step("B").actions = [ActionAssociation(id=1, target="Q")]
    bench = rig(chart, "Q").scan(2, Q=True)
    assert bench["Q"] is True, "nothing writes it while B is not active"
    assert bench.scan(c1=True).scan(c1=False, Q=False)["Q"] is True
    assert bench.scan(c2=True).scan()["Q"] is False
    assert bench.scan(Q=True)["Q"] is True


@pytest.mark.parametrize(("time", "scans"), [("T#0ms", 1), ("T#19ms", 3), ("T#20ms", 3), ("T#21ms", 4), ("T#30ms", 4)])
def test_the_minimum_time_holds_a_step(time: str, scans: int) -> None:
    """B is active for `scans` scans although its transition is true; a scan takes 10 ms."""
    chart = chain("A", "B", "C", conditions="TRUE TRUE FALSE")
    chart.step("B").min_time = time
    bench = rig(chart).scan()
    assert [bench.scan().active for _ in range(scans + 1)] == ["B"] * scans + ["C"]


def test_other_profiles_do_not_know_minimum_times() -> None:
    chart = chain("A", "B", "C", conditions="TRUE TRUE FALSE")
    chart.step("B").min_time = "T#1h"
    assert rig(chart, profile="iec").scan(3).active == "C"


# -- flags


def test_init_resets_to_the_initial_step_which_is_not_executed() -> None:
    chart = chain("A", "B", conditions="c1 c2")
    chart.step("A").main_action = body("n := n + 1;")
    chart.step("B").actions = [ActionAssociation(id=1, target="Q")]
    bench = rig(chart, "n:INT Q SFCInit").scan(c1=True).scan(c1=False)
    assert (bench.active, bench["n"], bench["Q"]) == ("B", 1, True)
    bench.scan(3, SFCInit=True, c1=True)
    assert (bench.active, bench["n"], bench["Q"], bench["A.x"], bench["B.x"]) == ("A", 1, False, True, False)
    bench.scan(SFCInit=False)
    assert (bench.active, bench["n"], bench["A.t"]) == ("A", 2, 0)
    assert bench.scan().active == "B"


def test_reset_goes_on_executing_the_initial_step() -> None:
    chart = chain("A", "B", conditions="c1 c2")
    chart.step("A").main_action = body("n := n + 1;")
    bench = rig(chart, "n:INT SFCReset").scan(c1=True).scan(c1=False)
    assert (bench.active, bench["n"]) == ("B", 1)
    bench.scan(3, SFCReset=True, c1=True)
    assert (bench.active, bench["n"]) == ("A", 4), "held there, but executed"
    assert bench.scan(SFCReset=False).scan().active == "B"


def test_the_initial_step_may_end_the_reset_itself() -> None:
    chart = chain("A", "B", conditions="c1 c2")
    chart.step("A").main_action = body("SFCReset := FALSE;")
    bench = rig(chart, "SFCReset").scan(c1=True).scan().scan(SFCReset=True)
    assert (bench.active, bench["SFCReset"]) == ("A", False)
    assert bench.scan().active == "B"


@pytest.mark.parametrize("flag", ["SFCInit", "SFCReset"])
def test_init_and_reset_end_stored_actions(flag: str) -> None:
    chart = chain("A", "B", conditions="c1 c2")
    chart.step("B").actions = [
        ActionAssociation(id=1, qualifier=Qualifier.S, target="Q"),
        ActionAssociation(id=2, qualifier=Qualifier.SD, target="late", duration="T#50ms"),
    ]
    bench = rig(chart, f"Q late {flag}").scan(c1=True).scan(2, c1=False)
    assert bench["Q"] is True
    bench.scan(**{flag: True})
    assert bench["Q"] is False
    bench.scan(10, **{flag: False})
    assert (bench["Q"], bench["late"]) == (False, False)


def test_pause_stops_the_chart() -> None:
    chart = chain("A", "B", conditions="c1 c2")
    chart.step("A").main_action = body("n := n + 1;")
    bench = rig(chart, "n:INT SFCPause").scan(2)
    bench.scan(3, SFCPause=True, c1=True)
    assert (bench.active, bench["n"]) == ("A", 2)
    bench.scan(SFCPause=False)
    assert bench["A.t"] == 50 * MS, "the time went on"
    assert bench.scan().active == "B"


def test_a_flag_that_the_settings_do_not_use_has_no_effect() -> None:
    chart = chain("A", "B", conditions="c1 c2")
    chart.settings = SfcSettings(flags={SfcFlag.PAUSE: FlagUse(use=False)})
    assert rig(chart, "SFCPause").scan(SFCPause=True, c1=True).scan().active == "B"
    chart.settings = SfcSettings(flags={SfcFlag.PAUSE: FlagUse(use=True)})
    bench = rig(chart)
    bench.scan()
    assert bench.scan(3, SFCPause=True, c1=True).active == "A", "declared by the settings"


def timed(limit: str = "T#30ms") -> SfcNetwork:
    chart = chain("A", "B", conditions="c1 AND (c2 OR NOT c3);FALSE")
    chart.step("A").max_time = limit
    return chart


def test_a_step_that_is_active_too_long_raises_the_error() -> None:
    bench = rig(timed(), "SFCError SFCErrorStep:STRING SFCErrorPOU:STRING SFCErrorAnalyzation:STRING", actions={})
    bench.scan(4, c1=False, c3=True)
    assert bench["A.t"] == 30 * MS
    assert bench["SFCError"] is False, "as long as it may"
    bench.scan()
    assert (bench["SFCError"], bench["SFCErrorStep"], bench["SFCErrorPOU"]) == (True, "A", "Main")
    assert bench["SFCErrorAnalyzation"] == "c1|c2|c3"


def test_the_analysis_names_only_what_is_in_the_way() -> None:
    bench = rig(timed(), "SFCError SFCErrorAnalyzation:STRING").scan(5, c1=False, c2=True)
    assert bench["SFCErrorAnalyzation"] == "c1"
    bench = rig(timed(), "SFCError SFCErrorAnalyzation:STRING").scan(5, c1=True, c3=True)
    assert bench["SFCErrorAnalyzation"] == "c2|c3"


def test_the_table_of_the_analysis() -> None:
    chart = timed()
    names = (SfcFlag.ERROR, SfcFlag.ERROR_ANALYZATION_TABLE)
    chart.settings = SfcSettings(flags={flag: FlagUse(use=True) for flag in names})
    bench = rig(chart).scan(5, c1=True, c3=True)
    rows = [
        (bench[f"SFCErrorAnalyzationTable[{i}].name"], bench[f"SFCErrorAnalyzationTable[{i}].value"]) for i in (0, 1)
    ]
    assert rows == [("c2", False), ("c3", True)]
    assert bench["SFCErrorAnalyzationTable[2].name"] == ""


def test_the_limit_must_be_enabled_where_its_flag_is_in_use() -> None:
    bench = rig(timed(), "SFCError SFCEnableLimit").scan(10)
    assert bench["SFCError"] is False
    assert bench.scan(SFCEnableLimit=True)["SFCError"] is True


def test_a_second_timeout_waits_until_the_first_is_quitted() -> None:
    chart = SfcNetwork()
    a, b, c = (chart.add_step(name, initial=name == "A") for name in "ABC")
    chart.add_transition(a, [b, c], "TRUE")
    b.max_time, c.max_time = "T#10ms", "T#30ms"
    bench = rig(chart, "SFCError SFCErrorStep:STRING SFCQuitError").scan(8)
    assert (bench["SFCError"], bench["SFCErrorStep"]) == (True, "B")
    bench.scan(3, SFCQuitError=True)
    assert (bench["SFCError"], bench["SFCErrorStep"]) == (False, "")
    bench.scan(SFCQuitError=False)
    assert bench["B.t"] == 0, "the times of active steps start again"
    assert bench["SFCError"] is False
    assert bench.scan(2)["SFCError"] is True


def test_nothing_runs_while_an_error_is_quitted() -> None:
    chart = timed()
    chart.step("A").main_action = body("n := n + 1;")
    bench = rig(chart, "n:INT SFCError SFCQuitError").scan(5)
    bench.scan(4, SFCQuitError=True, c1=True, c2=True)
    assert (bench.active, bench["n"]) == ("A", 5)


def test_flags_of_errors_need_the_error_flag() -> None:
    bench = rig(timed(), "SFCErrorStep:STRING SFCQuitError").scan(5)
    assert bench["SFCErrorStep"] == ""
    assert bench.scan(SFCQuitError=True, c1=True, c2=True).scan().active == "B"


def test_transition_and_current_step_flags() -> None:
    chart = SfcNetwork()
    a, b, c = (chart.add_step(name, initial=name == "A") for name in "ABC")
    chart.add_transition(a, [b, c], "c1")
    bench = rig(chart, "SFCTrans SFCCurrentStep:STRING").scan()
    assert (bench["SFCTrans"], bench["SFCCurrentStep"]) == (False, "A")
    bench.scan(c1=True)
    assert (bench["SFCTrans"], bench["SFCCurrentStep"]) == (True, "A")
    bench.scan()
    assert (bench["SFCTrans"], bench["SFCCurrentStep"]) == (False, "C"), "the rightmost of parallel steps"


def test_tip_mode_moves_one_step_with_each_push() -> None:
    bench = rig(chain("A", "B", "C"), "SFCTip SFCTipMode").scan(c1=True, SFCTipMode=True)
    assert bench.scan(2).active == "A", "conditions alone do nothing"
    bench.scan(c1=False, SFCTip=True)
    assert bench.scan(3).active == "B", "one push, one step"
    assert bench.scan(SFCTip=False).scan(SFCTip=True).scan().active == "C"


def test_tip_without_its_mode_forces_a_transition() -> None:
    bench = rig(chain("A", "B", "C"), "SFCTip SFCTipMode").scan()
    assert bench.scan(SFCTip=True).scan(2).active == "B"
    assert bench.scan(c2=True).scan().active == "C", "conditions count as well"


def test_simple_steps_of_codesys_23_are_flags() -> None:
    chart = chain("A", "B", conditions="c1 A")
    bench = rig(chart, profile="codesys23").scan()
    assert (bench["A"], bench["B"]) == (True, False)
    bench.scan(c1=True).scan()
    assert (bench["A"], bench["B"]) == (False, True)


def test_iec_steps_of_codesys_23_are_structures() -> None:
    chart = chain("A", "B", conditions="c1 A.x")
    chart.step("B").actions = [ActionAssociation(id=1, target="c3")]
    bench = rig(chart, profile="codesys23").scan(2)
    assert (bench["A.x"], bench["A.t"]) == (True, 10 * MS)


def test_init_after_reset_ends_what_the_initial_step_does() -> None:
    chart = chain("A", "B", conditions="c1 c2")
    chart.step("A").actions = [ActionAssociation(id=1, target="Q")]
    bench = rig(chart, "Q SFCInit SFCReset").scan(c1=True).scan(c1=False)
    assert bench.scan(SFCReset=True)["Q"] is True
    assert bench.scan(SFCInit=True)["Q"] is False


def test_a_chart_that_is_stopped_from_the_start_stands_at_its_initial_step() -> None:
    bench = rig(chain("A", "B", conditions="c1 c2"), "SFCPause").scan(SFCPause=True, c1=True)
    assert (bench.active, bench["A.x"]) == ("A", True)
    assert bench.scan(SFCPause=False).scan().active == "B"


def test_times_start_anew_after_an_error_was_quitted_in_a_pause() -> None:
    bench = rig(timed(), "SFCError SFCQuitError SFCPause").scan(5)
    assert bench["SFCError"] is True
    bench.scan(SFCQuitError=True).scan(3, SFCQuitError=False, SFCPause=True)
    assert bench.scan(SFCPause=False)["SFCError"] is False


def test_a_push_of_tip_during_a_reset_is_lost() -> None:
    bench = rig(chain("A", "B"), "SFCTip SFCReset").scan(SFCReset=True).scan(SFCTip=True)
    assert bench.scan(SFCReset=False).scan(2).active == "A"


def test_the_chart_of_an_action_runs_as_the_body_of_its_block() -> None:
    action = Action(name="Fill", body=SfcBody(chart=chain("A", "B", conditions="TRUE FALSE")))
    project = Project(pous=[Pou(name="Main", kind=PouKind.PROGRAM, actions=[action])], dialect=Dialect.CODESYS)
    trace = simulate(project, pou="Main.Fill", scans=3)
    assert [trace.active(scan) for scan in range(3)] == [("A",), ("B",), ("B",)]
