"""Nets of charts: what becomes of steps, transitions, macro-steps and partial charts, and how a net fires."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plcopen_sfc.errors import CompetingTransitionsError
from plcopen_sfc.model.actions import ForcedSituation, ForcingOrder
from plcopen_sfc.model.sfc import (
    ActionAssociation,
    Enclosure,
    Macro,
    PartialChart,
    PartialChartKind,
    SfcBody,
    SfcNetwork,
    Transition,
)
from plcopen_sfc.semantics.net import Competing, Net, NetProblemKind
from tests.analysis.nets import Arcs, any_nets, chart_of, chart_of_arcs
from tests.semantics.firing import fire
from tests.sweeps import examples

ALL_TRUE = -1


def runs(chart: SfcNetwork, scans: int, competing: Competing = Competing.PRIORITY) -> list[str]:
    net = Net.of(chart)
    marking = net.initial
    seen = ["+".join(net.names(marking))]
    for _ in range(scans):
        marking, _ = fire(net, marking, ALL_TRUE, competing)
        seen.append("+".join(net.names(marking)))
    return seen


def test_one_step_further_in_every_scan() -> None:
    assert runs(chart_of("1>2 2>3 3>4 4>1"), 5) == ["1", "2", "3", "4", "1", "2"]


def test_all_transitions_see_the_old_marking_and_entering_wins() -> None:
    net = Net.of(chart_of("1>2 2>3", "1+2"))
    marking, fired = fire(net, net.initial, ALL_TRUE)
    assert net.names(marking) == ("2", "3")
    assert fired == 0b11


def test_a_self_loop_keeps_its_step() -> None:
    assert runs(chart_of("1>1"), 1) == ["1", "1"]


def test_the_first_of_competing_transitions_fires() -> None:
    assert runs(chart_of("1>2 1>3"), 1) == ["1", "2"]


def test_priority_goes_before_the_place_in_the_chart() -> None:
    chart = chart_of("1>2 1>3 1>4")
    chart.transitions[2].priority = 1
    chart.transitions[1].priority = 2
    net = Net.of(chart)
    assert [t.path for t in net.transitions] == ["1 -> 4", "1 -> 3", "1 -> 2"]
    assert [t.competing for t in net.transitions] == [(), (0,), (0, 1)]
    assert runs(chart, 1) == ["1", "4"]


def test_a_competing_transition_that_did_not_fire_excludes_none() -> None:
    net = Net.of(chart_of("1>4 1+2>5 2>6", "1+2"))
    marking, fired = fire(net, net.initial, ALL_TRUE)
    assert net.names(marking) == ("4", "6")
    assert fired == 0b101


def test_competing_transitions_in_a_grafcet_all_fire() -> None:
    assert runs(chart_of("1>2 1>3"), 1, Competing.ALL) == ["1", "2+3"]


def test_competing_transitions_may_be_an_error() -> None:
    net = Net.of(chart_of("1>2 1>3"))
    assert net.names(fire(net, net.initial, 0b10, Competing.ERROR)[0]) == ("3",)
    with pytest.raises(CompetingTransitionsError, match="1 -> 2 and 1 -> 3 leave the same step") as caught:
        fire(net, net.initial, ALL_TRUE, Competing.ERROR)
    assert caught.value.transitions == ("1 -> 2", "1 -> 3")


def test_fork_and_join() -> None:
    assert runs(chart_of("1>2+3 3>4 2+4>1"), 3) == ["1", "2+3", "2+4", "1"]


def test_source_and_sink_transitions() -> None:
    net = Net.of(chart_of(">2 2>", "1"))
    marking, _ = fire(net, net.initial, 0b1)
    assert net.names(marking) == ("1", "2")
    assert net.names(fire(net, marking, 0b10)[0]) == ("1",)


def test_a_macro_step_with_a_body_is_replaced_by_it() -> None:
    chart = chart_of("1>M M>1")
    inner = chart_of("E>F F>X", "E")
    chart.step("M").macro = Macro(body=SfcBody(chart=inner))
    assert runs(chart, 4) == ["1", "M.E", "M.F", "M.X", "1"]
    net = Net.of(chart)
    assert [m.path for m in net.macros] == ["M"]
    assert net.macros[0].steps == net.marking(["M.E", "M.F", "M.X"])
    assert net.steps[net.macros[0].entry or 0].path == "M.E"
    assert not net.problems


def test_a_macro_step_may_name_its_expansion_and_that_its_ends() -> None:
    chart = chart_of("1>M M>1")
    chart.step("M").macro = Macro(expansion="M_exp")
    inner = chart_of("A>B B>A B>C C>B", "")
    chart.partial_charts.append(
        PartialChart(name="m_EXP", kind=PartialChartKind.EXPANSION, chart=inner, entry_step="B", exit_step="C")
    )
    assert runs(chart, 3)[:2] == ["1", "M.B"]
    net = Net.of(chart)
    assert net.names(fire(net, net.marking(["m.c"]), ALL_TRUE)[0]) == ("M.B",)
    leaving = next(t for t in net.transitions if t.path == "M -> 1")
    assert net.names(fire(net, net.marking(["m.c"]), leaving.bit)[0]) == ("1",)


def test_macro_steps_stand_in_macro_steps() -> None:
    chart, middle = chart_of("M>1", "M"), chart_of("E>N N>X", "E")
    middle.step("N").macro = Macro(body=SfcBody(chart=chart_of("E>X", "E")))
    chart.step("M").macro = Macro(body=SfcBody(chart=middle))
    assert runs(chart, 4) == ["M.E", "M.N.E", "M.N.X", "M.X", "1"]


def test_a_macro_step_in_itself_is_a_step() -> None:
    chart = chart_of("1>M M>1")
    chart.step("M").macro = Macro(expansion="X")
    inner = chart_of("E>N N>S", "E")
    inner.step("N").macro = Macro(expansion="X")
    chart.partial_charts.append(PartialChart(name="X", kind=PartialChartKind.EXPANSION, chart=inner))
    assert runs(chart, 4) == ["1", "M.E", "M.N", "M.S", "1"]
    assert [p.kind for p in Net.of(chart).problems] == [NetProblemKind.RECURSIVE_MACRO]


def test_a_macro_step_without_expansion_is_a_step() -> None:
    chart = chart_of("1>M M>1")
    chart.step("M").macro = Macro(expansion="nowhere")
    assert runs(chart, 2) == ["1", "M", "1"]
    assert [p.kind for p in Net.of(chart).problems] == [NetProblemKind.NO_EXPANSION]


def test_an_expansion_without_end_is_never_left() -> None:
    chart = chart_of("1>M M>1")
    chart.step("M").macro = Macro(body=SfcBody(chart=chart_of("E>F F>E", "E")))
    assert runs(chart, 3) == ["1", "M.E", "M.F", "M.E"]
    assert [p.kind for p in Net.of(chart).problems] == [NetProblemKind.NO_EXIT]


def test_several_ends_are_reported() -> None:
    chart = chart_of("1>M M>1")
    chart.step("M").macro = Macro(body=SfcBody(chart=chart_of("E>F E>G", "E")))
    problem = Net.of(chart).problems[0]
    assert problem.kind is NetProblemKind.SEVERAL_EXITS
    assert problem.message == "M: expansion with several exit steps; of F, G, G is taken"


def test_partial_charts_evolve_together() -> None:
    chart = chart_of("1>2 2>1")
    chart.partial_charts.append(PartialChart(name="G2", chart=chart_of("10>11 11>10", "10")))
    assert runs(chart, 2) == ["1+G2.10", "2+G2.11", "1+G2.10"]
    assert not Net.of(chart).hierarchy


@pytest.mark.parametrize("starts", [True, False])
def test_an_enclosed_chart_starts_with_its_enclosing_step(starts: bool) -> None:
    chart = chart_of("1>2 2>1", "1" if starts else "2")
    chart.step("1").encloses = [Enclosure(chart="Inner")]
    enclosed = PartialChart(name="Inner", kind=PartialChartKind.ENCLOSED, chart=chart_of("10>11", "10"))
    chart.partial_charts.append(enclosed)
    net = Net.of(chart)
    assert net.hierarchy
    assert net.names(net.initial) == (("1", "Inner.10") if starts else ("2",))


def test_a_forcing_order_is_hierarchy() -> None:
    chart = chart_of("1>2 2>1")
    order = ForcingOrder(chart="G2", situation=ForcedSituation.EMPTY)
    chart.step("1").actions.append(ActionAssociation(id=99, forcing=order))
    assert Net.of(chart).hierarchy


def test_what_is_excluded_is_not_there() -> None:
    chart = chart_of("1>2 2>1 1>3 3>1")
    chart.transitions[0].exclude = True
    chart.step("3").exclude = True
    net = Net.of(chart)
    assert [s.path for s in net.steps] == ["1", "2"]
    assert [t.path for t in net.transitions] == ["2 -> 1", "1 -> 3"]
    assert not net.problems
    assert runs(chart, 1) == ["1", ""]


def test_broken_references_are_told_and_crash_nothing() -> None:
    chart = chart_of("1>2")
    chart.transitions[0].targets.append(77)
    chart.transitions.append(Transition(id=50, sources=[88], targets=[chart.step("1").id], condition=None))
    net = Net.of(chart)
    assert [(p.kind, p.path) for p in net.problems] == [
        (NetProblemKind.MISSING_TARGET, "1 -> 2+?"),
        (NetProblemKind.MISSING_SOURCE, "? -> 1"),
    ]
    assert [t.path for t in net.transitions] == ["1 -> 2+?"]
    assert runs(chart, 1) == ["1", "2"]


def test_an_empty_chart_has_an_empty_net() -> None:
    net = Net.of(SfcNetwork())
    assert (net.steps, net.transitions, net.initial, fire(net, 0, ALL_TRUE)) == ((), (), 0, (0, 0))


def test_unknown_names_of_steps() -> None:
    with pytest.raises(KeyError):
        Net.of(chart_of("1>2")).marking(["3"])


@settings(deadline=None, max_examples=examples(100))
@given(any_nets(max_transitions=9), st.integers(0, 511), st.integers(0, 63))
def test_firing_follows_the_definition(net: tuple[int, tuple[int, ...], Arcs], true: int, marking: int) -> None:
    """Written down as the standards have it, with sets: t fires if enabled, true, and none before it competes."""
    steps, _, arcs = net
    marking &= (1 << steps) - 1
    made = Net.of(chart_of_arcs(*net))
    active = {i for i in range(steps) if marking >> i & 1}
    for competing in (Competing.PRIORITY, Competing.ALL):
        firing: list[int] = []
        for index, (sources, _) in enumerate(arcs):
            competitor = any(set(arcs[f][0]) & set(sources) for f in firing)
            if set(sources) <= active and true >> index & 1 and not (competitor and competing is Competing.PRIORITY):
                firing.append(index)
        left = {s for f in firing for s in arcs[f][0]}
        entered = {s for f in firing for s in arcs[f][1]}
        after, fired = fire(made, marking, true, competing)
        assert fired == sum(1 << f for f in firing)
        assert {i for i in range(steps) if after >> i & 1} == (active - left) | entered
