"""The marking graph: against plain simulation by another model, and what is known of certain charts."""

from __future__ import annotations

from itertools import combinations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plcopen_sfc.analysis.marking import marking_graph
from plcopen_sfc.analysis.search_limits import Answer
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.semantics.net import Competing, Net
from tests.analysis.nets import Arcs, any_nets, chart_of, chart_of_arcs
from tests.semantics.firing import fire
from tests.sweeps import examples

Situation = frozenset[int]


def simulated(initial: tuple[int, ...], arcs: Arcs, *, together: bool) -> dict[Situation, set[Situation]]:
    """All situations with their successors, by trying every set of transitions: steps are sets of numbers."""
    found: dict[Situation, set[Situation]] = {}
    waiting = [frozenset(initial)]
    while waiting:
        active = waiting.pop()
        if active in found:
            continue
        found[active] = set()
        enabled = [arc for arc in arcs if set(arc[0]) <= active]
        for size in range(1, len(enabled) + 1):
            for firing in combinations(enabled, size):
                left = [s for sources, _ in firing for s in sources]
                if len(left) > len(set(left)) and not together:
                    continue
                found[active].add((active - set(left)) | {s for _, targets in firing for s in targets})
        waiting += found[active]
    return found


def as_set(marking: int) -> Situation:
    return frozenset(i for i in range(marking.bit_length()) if marking >> i & 1)


@settings(deadline=None, max_examples=examples(80))
@given(any_nets(), st.booleans())
def test_search_agrees_with_simulation(net: tuple[int, tuple[int, ...], Arcs], together: bool) -> None:
    steps, initial, arcs = net
    graph = marking_graph(chart_of_arcs(*net), competing=Competing.ALL if together else Competing.PRIORITY)
    expected = simulated(initial, arcs, together=together)
    assert graph.complete
    assert {as_set(m) for m in graph} == set(expected)
    assert len(graph) == len(expected)
    unsafe = any(set(pre) <= active and (active - set(pre)) & set(post) for active in expected for pre, post in arcs)
    assert graph.safe is (Answer.NO if unsafe else Answer.YES)
    dead = {i for i, (pre, _) in enumerate(arcs) if not any(set(pre) <= active for active in expected)}
    assert graph.dead_transitions is not None
    assert {t.index for t in graph.dead_transitions} == dead
    assert graph.unreachable_steps is not None
    assert {s.index for s in graph.unreachable_steps} == set(range(steps)) - {s for active in expected for s in active}
    assert {as_set(m) for m in graph.deadlocks} == {active for active, after in expected.items() if not after}
    start = frozenset(initial)
    recurrent = {start}
    while grown := {a for a, after in expected.items() if after & recurrent} - recurrent:
        recurrent |= grown
    assert graph.way_home is (Answer.YES if recurrent == set(expected) else Answer.NO)
    assert (graph.stranded is None) == (recurrent == set(expected))
    assert graph.concurrency is not None
    for a in range(steps):
        beside = {s for active in expected if a in active for s in active} - {a}
        assert as_set(graph.concurrency[a]) == beside


@pytest.mark.slow
@settings(deadline=None, max_examples=examples(80))
@given(any_nets(), st.booleans())
def test_traces_can_be_walked(net: tuple[int, tuple[int, ...], Arcs], together: bool) -> None:
    competing = Competing.ALL if together else Competing.PRIORITY
    graph = marking_graph(chart_of_arcs(*net), competing=competing)
    for goal in list(graph)[::5]:
        marking = graph.net.initial
        for firing in graph.trace(goal):
            wanted = sum(t.bit for t in firing.transitions)
            marking, fired = fire(graph.net, marking, wanted, competing)
            assert fired == wanted
            assert marking == firing.marking
        assert marking == goal
    if graph.unsafe is not None:
        found = graph.unsafe
        assert (found.trace[-1].marking if found.trace else graph.net.initial) == found.marking
        assert not found.transition.pre & ~found.marking
        assert found.step.bit & found.marking & found.transition.post & ~found.transition.pre


@settings(deadline=None, max_examples=examples(100))
@given(any_nets(), st.lists(st.integers(0, 127), max_size=30), st.sampled_from([Competing.PRIORITY, Competing.ALL]))
def test_every_run_stays_in_the_graph(
    net: tuple[int, tuple[int, ...], Arcs], inputs: list[int], competing: Competing
) -> None:
    graph = marking_graph(chart_of_arcs(*net), competing=competing)
    marking = graph.net.initial
    for true in inputs:
        marking, _ = fire(graph.net, marking, true, competing)
        assert marking in graph


def names(chart: SfcNetwork, marking: int) -> str:
    return "+".join(Net.of(chart).names(marking))


def test_simultaneous_branches_that_are_joined_by_a_selection_are_unsafe() -> None:
    chart = chart_of("1>2+3 2>4 3>4 4>1")
    graph = marking_graph(chart)
    assert graph.safe is Answer.NO
    assert graph.unsafe is not None
    assert graph.unsafe.step.path == "4"
    assert [names(chart, firing.marking) for firing in graph.unsafe.trace] == ["2+3", "2+4"]
    assert graph.unsafe.transition.path == "2 -> 4"


def test_a_jump_out_of_a_simultaneous_branch_is_unsafe() -> None:
    graph = marking_graph(chart_of("1>2+3 2>1 2>4 3>5 4+5>1"))
    assert graph.safe is Answer.NO
    assert graph.unsafe is not None
    assert graph.unsafe.transition.path in ("1 -> 2+3", "2 -> 1")


def test_alternatives_that_are_joined_as_simultaneous_branches_lock() -> None:
    chart = chart_of("1>2 1>3 2+3>4 4>1")
    graph = marking_graph(chart)
    assert graph.safe is Answer.YES
    assert {names(chart, m) for m in graph.deadlocks} == {"2", "3"}
    assert graph.dead_transitions is not None
    assert [t.path for t in graph.dead_transitions] == ["2+3 -> 4", "4 -> 1"]
    assert graph.unreachable_steps is not None
    assert [s.path for s in graph.unreachable_steps] == ["4"]
    assert graph.way_home is Answer.NO


def test_a_branch_with_an_exit_besides_its_join_can_lock() -> None:
    chart = chart_of("1>2+3 2+3>1 2>4 4>5")
    graph = marking_graph(chart)
    assert graph.safe is Answer.YES
    assert {names(chart, m) for m in graph.deadlocks} == {"3+5"}


def test_a_dead_end_is_a_deadlock_with_a_way_to_it() -> None:
    chart = chart_of("1>2 2>3")
    graph = marking_graph(chart)
    assert graph.deadlock_free is Answer.NO
    assert [names(chart, f.marking) for f in graph.trace(graph.deadlocks[0])] == ["2", "3"]
    assert names(chart, graph.stranded or 0) == "2"


def test_competing_transitions_that_fire_together_double_the_token() -> None:
    chart = chart_of("1>2 1>3 2>4 3>4 4>1")
    assert marking_graph(chart).safe is Answer.YES
    both = marking_graph(chart, competing=Competing.ALL)
    assert both.safe is Answer.NO
    assert Net.of(chart).marking(["2", "3"]) in both


def test_steps_of_simultaneous_branches_are_concurrent() -> None:
    chart = chart_of("1>2+3 2>4 3>5 4+5>1")
    graph = marking_graph(chart)
    step = {s.path: s for s in graph.net.steps}
    assert graph.concurrent(step["2"], step["5"]) is Answer.YES
    assert graph.concurrent(step["2"], step["4"]) is Answer.NO
    assert graph.concurrent(step["2"], step["2"]) is Answer.NO


def test_behind_the_cap_nothing_is_claimed() -> None:
    branches = [f"{b}{i}>{b}{i + 1}" for b in "abcd" for i in range(9)]
    chart = chart_of("1>a0+b0+c0+d0 a9+b9+c9+d9>2 2>1 " + " ".join(branches))
    graph = marking_graph(chart, cap=500)
    assert not graph.complete
    assert graph.safe is Answer.UNKNOWN
    assert graph.deadlock_free is Answer.UNKNOWN
    assert graph.way_home is Answer.UNKNOWN
    assert graph.dead_transitions is None
    assert graph.unreachable_steps is None
    assert graph.concurrency is None
    step = {s.path: s for s in graph.net.steps}
    assert graph.concurrent(step["a0"], step["b1"]) is Answer.YES
    assert graph.concurrent(step["a0"], step["1"]) is Answer.UNKNOWN
    assert marking_graph(chart, cap=10_002).complete


def test_a_cap_holds_where_transitions_fire_in_sets() -> None:
    wide = "1>" + "+".join(f"a{i}" for i in range(30)) + " " + " ".join(f"a{i}>b{i}" for i in range(30))
    graph = marking_graph(chart_of(f"{wide} b0>b1"), cap=1000)
    assert not graph.complete
    assert len(graph) <= 1001


def test_a_net_that_stops_with_no_step_active_is_blocked() -> None:
    graph = marking_graph(chart_of("1>2 2>"))
    assert graph.deadlocks == (0,)
    assert graph.way_home is Answer.NO


def test_a_source_transition_is_always_enabled() -> None:
    graph = marking_graph(chart_of("1>2 2>1 >1"))
    assert graph.safe is Answer.NO
    assert graph.deadlock_free is Answer.YES


def test_an_answer_is_true_only_if_it_is_yes() -> None:
    assert [bool(answer) for answer in Answer] == [True, False, False]


def test_a_marking_that_is_not_reached_has_no_trace() -> None:
    graph = marking_graph(chart_of("1>2 2>1"))
    with pytest.raises(KeyError):
        graph.trace(3)
