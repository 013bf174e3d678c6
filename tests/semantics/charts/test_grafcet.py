"""GRAFCET: actions, edges and times, stability, forcing orders, enclosing steps (IEC 60848:2013)."""

from __future__ import annotations

from typing import Any

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.errors import SimulationError, UnknownBehaviourError
from plcopen_sfc.model import (
    ActionAssociation,
    ActionKind,
    Enclosure,
    Expression,
    ForcedSituation,
    ForcingOrder,
    Macro,
    PartialChart,
    PartialChartKind,
    SfcNetwork,
    Step,
)
from tests.semantics.charts.rig import Rig, chain


def rig(chart: SfcNetwork, variables: str = "", **options: Any) -> Rig:
    return Rig(chart, options.pop("profile", "grafcet"), variables=f"c1 c2 c3 {variables}", **options)


def action(kind: str, target: str = "Q", condition: str | None = None, **fields: Any) -> ActionAssociation:
    return ActionAssociation(
        id=fields.pop("id", 1),
        kind=ActionKind(kind),
        target=target,
        condition=Expression(text=condition) if condition is not None else None,
        **fields,
    )


def seed_chain() -> SfcNetwork:
    """The example of the text on programming a GRAFCET: Q1 continuous, Q2 stored, Q3 continuous with a condition."""
    chart = chain("1", "2", "3", "4", conditions="B1 B2 B3 B4")
    chart.step("1").actions = [action("continuous", "Q1")]
    chart.step("2").actions = [action("onActivation", "Q2", value="TRUE")]
    chart.step("3").actions = [action("conditional", "Q3", "B5")]
    chart.step("4").actions = [action("onActivation", "Q2", value="FALSE")]
    return chart


def test_the_example_of_the_seed() -> None:
    bench = Rig(seed_chain(), "grafcet", variables="B1 B2 B3 B4 B5 Q1 Q2 Q3")

    def outputs(**inputs: bool) -> tuple[str, str]:
        bench.scan(**{**dict.fromkeys(("B1", "B2", "B3", "B4"), False), **inputs})
        return bench.active, "".join(name for name in ("Q1", "Q2", "Q3") if bench[name])

    assert outputs() == ("1", "Q1")
    assert outputs(B1=True) == ("2", "Q2")
    assert outputs() == ("2", "Q2")
    assert outputs(B2=True) == ("3", "Q2")
    assert outputs(B5=True) == ("3", "Q2Q3")
    assert outputs(B5=False) == ("3", "Q2")
    assert outputs(B3=True) == ("4", "")
    assert outputs(B4=True) == ("1", "Q1")


def test_a_continuous_action_writes_in_every_scan_whatever_else_writes() -> None:
    chart = chain("1", "2")
    chart.step("2").actions = [action("continuous")]
    bench = rig(chart, "Q").scan(Q=True)
    assert bench["Q"] is False, "FALSE is written as well as TRUE"
    bench.scan(c1=True)
    assert bench["Q"] is True


def test_several_continuous_actions_on_one_output_are_ored() -> None:
    for order in (("1", "2"), ("2", "1")):
        chart = chain("1", "2", "3")
        for name in order:
            chart.step(name).actions = [action("continuous")]
        bench = rig(chart, "Q")
        assert bench.log("Q", 2) == "11"
        assert bench.log("Q", 2, c1=True) == "11"
        assert bench.log("Q", 2, c1=False, c2=True) == "00"


def test_a_stored_action_on_activation_writes_once() -> None:
    chart = chain("1", "2", "3")
    chart.step("2").actions = [action("onActivation", "n", value="n + 1")]
    bench = rig(chart, "n:INT").scan(3)
    assert bench["n"] == 0
    assert bench.scan(4, c1=True)["n"] == 1


def test_a_stored_action_of_an_initial_step_is_executed_at_the_start() -> None:
    chart = chain("1", "2")
    chart.step("1").actions = [action("onActivation", "n", value="n + 1")]
    assert rig(chart, "n:INT").scan(3)["n"] == 1


def test_a_stored_action_on_deactivation_writes_once() -> None:
    chart = chain("1", "2", "3")
    chart.step("2").actions = [action("onDeactivation", "n", value="n + 1")]
    bench = rig(chart, "n:INT").scan(c1=True).scan(3, c1=False)
    assert bench["n"] == 0
    assert bench.scan(3, c2=True)["n"] == 1


def test_deactivations_come_before_activations() -> None:
    chart = chain("1", "2")
    chart.step("2").actions = [action("onActivation", "n", value="n * 2")]
    chart.step("1").actions = [action("onDeactivation", "n", value="n + 1")]
    bench = rig(chart, "n:INT").scan(n=3)
    assert bench.scan(c1=True)["n"] == 8


def on_event(event: str) -> SfcNetwork:
    chart = chain("1", "2")
    chart.step("2").actions = [action("onEvent", "n", event, value="n + 1")]
    return chart


def test_an_action_on_an_event_is_executed_once_at_each_edge_while_the_step_is_active() -> None:
    bench = rig(on_event("↑I0"), "I0 n:INT").scan().scan(c1=True).scan(c1=False)
    assert bench["n"] == 0
    assert bench.scan(3, I0=True)["n"] == 1
    assert bench.scan(I0=False)["n"] == 1
    assert bench.scan(I0=True)["n"] == 2


def test_an_edge_before_the_activation_does_not_count() -> None:
    bench = rig(on_event("↑I0"), "I0 n:INT").scan().scan(I0=True).scan(c1=True).scan(3, c1=False)
    assert (bench.active, bench["n"]) == ("2", 0)


def test_an_edge_together_with_the_activation_does_not_count() -> None:
    bench = rig(on_event("↑I0"), "I0 n:INT").scan().scan(c1=True, I0=True).scan(3, c1=False)
    assert (bench.active, bench["n"]) == ("2", 0)


@pytest.mark.parametrize(("condition", "active"), [("↑a * Q", "2"), ("↑a * /Q", "1")])
def test_conditions_see_what_an_action_on_their_event_stores(condition: str, active: str) -> None:
    chart = chain("1", "2", conditions=f"{condition};FALSE")
    chart.step("1").actions = [action("onEvent", condition="↑a", value="TRUE")]
    assert rig(chart, "a Q").scan().scan(a=True).active == active


def test_an_edge_in_the_scan_that_leaves_the_step_counts() -> None:
    bench = rig(on_event("↑I0"), "I0 n:INT").scan().scan(c1=True).scan(c1=False)
    assert bench.scan(c2=True, I0=True)["n"] == 1


def test_a_falling_edge_and_a_term_of_edges() -> None:
    bench = rig(on_event("↓I0 OR ↑(I1 AND I2)"), "I0 I1 I2 n:INT").scan(I0=True).scan(c1=True).scan(c1=False)
    assert bench.scan(2, I0=False)["n"] == 1
    assert bench.scan(2, I1=True)["n"] == 1
    assert bench.scan(2, I2=True)["n"] == 2


def test_an_event_that_is_no_edge_counts_when_it_becomes_true() -> None:
    bench = rig(on_event("I0"), "I0 n:INT").scan().scan(c1=True).scan(c1=False)
    assert bench.scan(4, I0=True)["n"] == 1


def test_an_edge_clears_only_one_of_two_transitions_in_a_row() -> None:
    """Edges belong to the change of the inputs: in the second evolution of a scan they are over."""
    bench = rig(chain("1", "2", "3", conditions="↑a ↑a FALSE"), "a").scan()
    assert bench.scan(a=True).active == "2"
    assert bench.scan(2).active == "2"
    assert bench.scan(a=False).scan(a=True).active == "3"


def test_an_input_that_is_true_at_the_start_has_no_edge() -> None:
    bench = rig(chain("1", "2", conditions="↑a FALSE"), "a")
    assert bench.scan(2, a=True).active == "1"
    assert bench.scan(a=False).scan(a=True).active == "2"


def test_edges_of_steps_happen_in_the_evolution_after() -> None:
    chart = SfcNetwork()
    a, b, c, d = (chart.add_step(name, initial=name in ("1", "3")) for name in ("1", "2", "3", "4"))
    chart.add_transition(a, b, "c1")
    chart.add_transition(c, d, "↑X2")
    assert rig(chart).scan().scan(c1=True).active == "2 4"


@pytest.mark.parametrize(("time", "scans"), [("20ms", 2), ("21ms", 3), ("30ms", 3), ("0s", 0)])
def test_a_transition_that_waits_for_the_time_of_its_step(time: str, scans: int) -> None:
    bench = rig(chain("1", "2", "3", conditions=f"c1;{time}/X2;FALSE")).scan().scan(c1=True)
    for _ in range(scans):
        assert bench.active == "2"
        bench.scan()
    assert bench.active == "3"


def test_times_of_other_terms_run_whatever_steps_are_active() -> None:
    """The condition is evaluated always: a time may be over before its transition is enabled."""
    bench = rig(chain("1", "2", "3", conditions="c1;50ms/a;FALSE"), "a").scan(a=True).scan(6)
    assert bench.scan(c1=True).active == "3"


def test_a_delay_at_both_ends() -> None:
    chart = chain("1", "2")
    chart.step("1").actions = [action("conditional", condition="20ms/a/30ms")]
    bench = rig(chart, "a Q").scan(2)
    assert bench.log("Q", 5, a=True) == "00111"
    assert bench.log("Q", 5, a=False) == "11100"
    assert bench.log("Q", 2, a=True) + bench.log("Q", 3, a=False) == "00000"


def test_a_delay_at_the_end_goes_on_while_the_one_at_the_beginning_starts_again() -> None:
    """It ends the time after the falling edge that the standard gives, though the operand is TRUE again by then."""
    chart = chain("1", "2")
    chart.step("1").actions = [action("conditional", condition="50ms/a/20ms")]
    bench = rig(chart, "a Q").scan()
    assert bench.log("Q", 6, a=True) == "000001"
    assert bench.log("Q", 1, a=False) + bench.log("Q", 6, a=True) == "1" + "100001"


def test_an_edge_is_over_when_a_delay_that_is_as_short_as_a_scan_is_tested() -> None:
    chart = chain("1", "2", conditions="10ms/↑a;FALSE")
    assert rig(chart, "a").scan().scan(5, a=True).active == "1"
    chart = chain("1", "2", "3", conditions="↑a/20ms;/(↑a/20ms);FALSE")
    bench = rig(chart, "a").scan().scan(a=True)
    assert [bench.active, *(bench.scan().active for _ in range(2))] == ["2", "2", "3"]


@pytest.mark.parametrize(("kind", "log"), [("delayed", "0001|00"), ("limited", "1110|00"), ("continuous", "1111|00")])
def test_delayed_and_limited_actions(kind: str, log: str) -> None:
    chart = chain("1", "2", "3")
    chart.step("2").actions = [action(kind, duration="T#30ms")]
    bench = rig(chart, "Q").scan()
    assert bench.log("Q", 4, c1=True) + "|" + bench.log("Q", 2, c2=True) == log


def test_each_delay_has_its_own_time() -> None:
    """Not one timer for the output: the delay of step 3 begins when step 3 does."""
    chart = chain("1", "2", "3")
    for name in ("2", "3"):
        chart.step(name).actions = [action("delayed", duration="T#20ms")]
    bench = rig(chart, "Q").scan().scan(c1=True).scan(c1=False)
    assert bench.log("Q", 4, c2=True) == "0011"


def test_transient_steps_store_but_do_not_show() -> None:
    chart = chain("1", "2", "3", conditions="c1 TRUE FALSE")
    chart.step("2").actions = [
        action("onActivation", "n", value="n + 1"),
        action("onDeactivation", "m", value="m + 1", id=2),
        action("continuous", id=3),
    ]
    bench = rig(chart, "n:INT m:INT Q").scan()
    bench.scan(c1=True)
    assert (bench.active, bench["n"], bench["m"], bench["Q"]) == ("3", 1, 1, False)


def test_a_stored_value_is_seen_by_the_next_evolution() -> None:
    chart = chain("1", "2", "3", conditions="c1;n=1;FALSE")
    chart.step("2").actions = [action("onActivation", "n", value="1")]
    assert rig(chart, "n:INT").scan().scan(c1=True).active == "3"


# -- hierarchy


def emergency_stop(situation: str, steps: list[str] | None = None) -> SfcNetwork:
    """A chain G1 and above it a chart whose step 11 forces it while the emergency stop is pressed."""
    above = chain("10", "11", conditions="stop;NOT stop")
    order = ForcingOrder(chart="G1", situation=ForcedSituation(situation), steps=steps or [])
    above.step("11").actions = [ActionAssociation(id=9, kind=ActionKind.FORCING, forcing=order)]
    below = chain("1", "2", "3")
    below.step("2").actions = [action("continuous")]
    below.step("1").actions = [action("onActivation", "n", value="n + 1")]
    return SfcNetwork(partial_charts=[PartialChart(name="G2", chart=above), PartialChart(name="G1", chart=below)])


FORCED = "stop Q n:INT"


def test_an_emergency_stop_forces_the_chain_into_its_initial_situation() -> None:
    bench = rig(emergency_stop("INIT"), FORCED).scan(c1=True)
    assert (bench.active, bench["Q"], bench["n"]) == ("G2.10 G1.2", True, 1)
    bench.scan(stop=True)
    assert (bench.active, bench["Q"]) == ("G2.11 G1.1", False), "in the same scan"
    assert bench["n"] == 2, "actions follow the steps, however these became active"
    assert bench.scan(3).active == "G2.11 G1.1", "held there although its transition is true"
    assert bench.scan(c1=False, stop=False).active == "G2.10 G1.1"
    assert bench.scan(c1=True).active == "G2.10 G1.2"


@pytest.mark.parametrize(
    ("situation", "steps", "held"),
    [("{}", None, "G2.11"), ("*", None, "G2.11 G1.2"), ("explicit", ["1", "3"], "G2.11 G1.1 G1.3")],
)
def test_forced_situations(situation: str, steps: list[str] | None, held: str) -> None:
    bench = rig(emergency_stop(situation, steps), FORCED).scan(c1=True)
    assert bench.scan(3, stop=True, c2=True).active == held


def test_a_frozen_chart_goes_on_from_where_it_was() -> None:
    bench = rig(emergency_stop("*"), FORCED).scan(c1=True).scan(3, stop=True, c2=True)
    assert bench.scan(stop=False).active == "G2.10 G1.3"


def test_two_orders_that_contradict_each_other_are_an_error() -> None:
    chart = emergency_stop("INIT")
    order = ForcingOrder(chart="G1", situation=ForcedSituation.EMPTY)
    chart.partial_charts[0].chart.step("11").actions.append(
        ActionAssociation(id=8, kind=ActionKind.FORCING, forcing=order)
    )
    with pytest.raises(SimulationError, match="force G1 into different situations"):
        rig(chart, FORCED).scan(stop=True)


def test_charts_that_force_each_other_are_refused() -> None:
    chart = emergency_stop("INIT")
    order = ForcingOrder(chart="G2", situation=ForcedSituation.INITIAL)
    chart.partial_charts[1].chart.step("1").actions.append(
        ActionAssociation(id=8, kind=ActionKind.FORCING, forcing=order)
    )
    with pytest.raises(UnknownBehaviourError, match="rule each other"):
        rig(chart, FORCED).scan()


def test_an_order_on_a_chart_that_does_not_exist_is_refused() -> None:
    chart = emergency_stop("INIT")
    chart.partial_charts.pop()
    with pytest.raises(UnknownBehaviourError, match="no partial chart G1"):
        rig(chart, FORCED).scan()


def test_forcing_reaches_through_the_hierarchy_in_one_evolution() -> None:
    """G3 forces G2, and the step of G2 that this activates forces G1, all in the same scan."""
    chart = emergency_stop("{}")
    above = chain("20", "21", conditions="c3;FALSE")
    order = ForcingOrder(chart="G2", situation=ForcedSituation.EXPLICIT, steps=["11"])
    above.step("21").actions = [ActionAssociation(id=8, kind=ActionKind.FORCING, forcing=order)]
    chart.partial_charts.append(PartialChart(name="G3", chart=above))
    bench = rig(chart, FORCED).scan()
    assert bench.active == "G2.10 G1.1 G3.20"
    assert bench.scan(c3=True).active == "G2.11 G3.21"


def enclosing(*, initial: bool = False) -> SfcNetwork:
    outer = chain("1", "2", "3")
    outer.step("1").initial, outer.step("2").initial = not initial, initial
    outer.step("2").encloses = [Enclosure(chart="G1", activated_steps=["10"])]
    inner = chain("10", "11", "12", conditions="c3 c3 FALSE")
    inner.step("10").initial = False
    inner.step("11").initial = initial
    inner.step("10").actions = [action("continuous")]
    outer.partial_charts = [PartialChart(name="G1", chart=inner, kind=PartialChartKind.ENCLOSED)]
    return outer


def test_an_enclosing_step_activates_its_chart_and_takes_it_along_when_it_is_left() -> None:
    bench = rig(enclosing(), "Q").scan()
    assert bench.active == "1"
    bench.scan(c1=True)
    assert (bench.active, bench["Q"]) == ("2 G1.10", True)
    bench.scan(c1=False)
    assert bench.active == "2 G1.10", "activated once, not again and again"
    bench.scan(c2=True)
    assert (bench.active, bench["Q"]) == ("3", False)


def test_the_enclosed_chart_evolves_while_its_enclosing_step_is_active() -> None:
    bench = Rig(enclosing(), "iec", variables="c1 c2 c3 Q").scan(c1=True).scan(c1=False, c3=True)
    assert bench.active == "2 G1.11"
    assert bench.scan().active == "2 G1.12"
    assert bench.scan(c2=True).active == "3"


def test_an_initial_enclosing_step_starts_with_the_initial_steps_of_its_chart() -> None:
    assert rig(enclosing(initial=True), "Q").scan().active == "2 G1.11"


def test_enclosing_steps_in_enclosed_charts() -> None:
    chart = enclosing()
    chart.partial_charts[0].chart.step("10").encloses = [Enclosure(chart="G0", activated_steps=["30"])]
    deepest = chain("30", "31", conditions="FALSE FALSE")
    deepest.step("30").initial = False
    chart.partial_charts.append(PartialChart(name="G0", chart=deepest, kind=PartialChartKind.ENCLOSED))
    bench = rig(chart, "Q").scan(c1=True)
    assert bench.active == "2 G1.10 G0.30"
    assert bench.scan(c1=False, c2=True).active == "3"


@pytest.mark.parametrize(
    ("order", "active"),
    [("G2{}", "G1.1"), ("G2{INIT}", "G1.1 G2.20 G3.30"), ("G2{21}", "G1.1 G2.21 G3.31"), ("G2{*}", "G1.1 G2.20 G3.30")],
)
def test_an_order_of_the_start_rules_what_the_forced_steps_enclose(order: str, active: str) -> None:
    text = f"""GRAFCET G
CHART G1
    INITIAL STEP 1
        FORCE {order}
CHART G2
    INITIAL STEP 20 ENCLOSES G3{{30}}
    STEP 21 ENCLOSES G3{{31}}
ENCLOSED G3
    INITIAL STEP 30
    STEP 31
"""
    project = sfc.loads(text.encode())
    assert f"  {active}  " in str(sfc.simulate(project, scans=1))
    proof = sfc.lower(project, accept_untested=True).proof
    assert proof is not None
    assert proof.counterexample is None


def test_macro_steps_of_expansions() -> None:
    expansion = chain("E1", "S1", conditions="c2;FALSE", ring=False)
    chart = SfcNetwork(
        steps=[Step(id=0, name="1", initial=True), Step(id=1, name="M1", macro=Macro(expansion="M1"))],
        partial_charts=[
            PartialChart(name="M1", chart=expansion, kind=PartialChartKind.EXPANSION, entry_step="E1", exit_step="S1")
        ],
    )
    expansion.step("E1").initial = False
    chart.add_transition(chart.step("1"), chart.step("M1"), "c1")
    chart.add_transition(chart.step("M1"), chart.step("1"), "c3")
    chart.step("M1").actions = [action("continuous")]
    bench = rig(chart, "Q").scan(c1=True)
    assert (bench.active, bench["Q"], bench["M1.X"]) == ("M1.E1", True, True)
    assert (bench["XM1"], bench["XE1"], bench["X1"]) == (True, True, False)
    assert bench.scan(c3=True, c1=False).active == "M1.E1", "left through its exit step only"
    assert bench.scan(c2=True).active == "1"
    assert (bench["Q"], bench["XM1"]) == (False, False)


def test_the_flag_of_a_chart_without_steps_is_false() -> None:
    result = sfc.simulate(sfc.loads(b"GRAFCET L\nCHART G1\n", format="grafcet-text"), scans=3)
    assert result["XG1"] == [False] * 3


def test_a_partial_chart_has_a_flag_that_tells_if_a_step_in_it_is_active() -> None:
    text = """GRAFCET C
INPUTS
    a
    b
OUTPUTS
    Q
CHART G1
    INITIAL STEP 1
    1 -> 2 : a
    STEP 2
    2 -> : /a * b
CHART G2
    INITIAL STEP 10
        Q IF XG1
    10 -> 11 : /XG1
    STEP 11
    11 -> 10 : XG1 * b
"""
    project = sfc.loads(text.encode(), format="grafcet-text")
    assert not [found for found in sfc.check(project) if found.code == "VAR01"]
    given = sfc.simulate(project, inputs=lambda scan, values: {"a": scan == 1, "b": scan == 3}, scans=4)
    assert [row["Q"] for row in given.to_records()] == [True, True, True, False]
    assert [row["XG1"] for row in given.to_records()] == [True, True, True, False]
    lowered = sfc.lower(project.pou("C"))
    assert sfc.equivalent(project.pou("C"), lowered).proven


def test_steps_have_their_number_as_a_variable() -> None:
    chart = chain("Start", "2", conditions="X5 FALSE")
    chart.step("Start").number = 5
    bench = rig(chart).scan()
    assert bench.active == "2"
    assert sorted(name for name in bench.instance.variables() if name.startswith("X")) == ["X2", "X5", "XStart"]


def test_actions_of_grafcet_are_refused_where_actions_come_first() -> None:
    with pytest.raises(UnknownBehaviourError, match="codesys does not have"):
        rig(seed_chain(), "B1 B2 B3 B4 B5 Q1 Q2 Q3", profile="codesys").scan()


def test_actions_of_grafcet_under_a_profile_with_one_evolution() -> None:
    bench = Rig(seed_chain(), "iec", variables="B1 B2 B3 B4 B5 Q1 Q2 Q3").scan()
    assert bench["Q1"] is True
    bench.scan(B1=True, B2=True)
    assert (bench.active, bench["Q1"], bench["Q2"]) == ("2", False, True)


AGAIN = """GRAFCET N
INPUTS
    a
OUTPUTS
    Q
    R
    S
    T
CHART G1
    INITIAL STEP 1
        Q AFTER 30ms
        R IF 30ms/X1
        S FOR 30ms
        T IF /30ms/X1
    1 -> 1 : ↑a
CHART G2
    INITIAL STEP 10 ENCLOSES G3{22}
    10 -> 10 : ↑a
    -> 10 : ↓a
ENCLOSED G3
    INITIAL STEP 20
    STEP 22
    20 -> 22 : 0
"""


def test_a_step_that_is_left_and_entered_at_once_stays_active() -> None:
    """Delayed and limited actions began their time again, times of the flag did not; what it encloses began again."""
    inputs = [0, 0, 1, 0, 0, 0, 0, 1, 0, 0]
    trace = sfc.simulate(sfc.loads(AGAIN.encode()), inputs=lambda scan, _: {"a": bool(inputs[scan])}, scans=10)
    assert trace["Q"] == trace["R"]
    assert trace["S"] == trace["T"]
    assert [bool(each) for each in trace["Q"]] == [False] * 3 + [True] * 7
    assert trace.active(9) == ("G1.1", "G2.10", "G3.20")


def test_the_flag_of_a_chart_tells_of_the_steps_in_its_macro_steps() -> None:
    """A macro-step is a step of its chart, and active while its expansion is."""
    text = """GRAFCET C
INPUTS
    a
    b
CHART G1
    INITIAL STEP 1
    1 -> M2 : ↑a
    MACRO M2
    M2 -> 1 : ↑b
CHART G2
    INITIAL STEP 10
    10 -> 11 : /XG1
    STEP 11
EXPANSION M2
    STEP E2
    MACRO M3
    STEP S2
    E2 -> M3 : ↑b
    M3 -> S2 : ↑b
EXPANSION M3
    STEP E3
    STEP S3
    E3 -> S3 : 1
"""
    project = sfc.loads(text.encode(), format="grafcet-text")
    trace = sfc.simulate(project, inputs=lambda scan, _: {"a": scan == 1, "b": scan % 2 == 0}, scans=12)
    entered = {step for scan in range(12) for step in trace.active(scan)}
    assert {"G1.M2.E2", "G1.M2.M3.S3", "G1.M2.S2", "G1.1"} <= entered
    assert "G2.11" not in entered
    assert set(trace["XG1"]) == {True}
