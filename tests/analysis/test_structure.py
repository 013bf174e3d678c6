"""State machines: in every reachable marking each has its one active step."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from plcopen_sfc.analysis.marking import marking_graph
from plcopen_sfc.analysis.structure import state_machines
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.semantics.net import Net, indexes
from tests.analysis.nets import Arcs, any_nets, block_chart, chart_of, chart_of_arcs


@settings(deadline=None, max_examples=100)
@given(any_nets())
def test_one_step_of_each_is_active_in_every_marking(net: tuple[int, tuple[int, ...], Arcs]) -> None:
    chart = chart_of_arcs(*net)
    found = state_machines(chart)
    graph = marking_graph(chart, cap=500)
    if found.safe:
        assert graph.safe
    if graph.safe:
        for marking in graph:
            assert all((marking & component).bit_count() == 1 for component in found.components)


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 10**9), st.integers(4, 60))
def test_blocks_are_covered(seed: int, size: int) -> None:
    assert state_machines(block_chart(seed, size)).safe


def names(chart: SfcNetwork) -> list[tuple[str, ...]]:
    net = Net.of(chart)
    return sorted(tuple(net.steps[i].path for i in indexes(c)) for c in state_machines(chart).components)


def test_each_branch_makes_one() -> None:
    assert names(chart_of("1>2+3 2>4 3>5 4+5>1")) == [("1", "2", "4"), ("1", "3", "5")]


def test_a_chart_that_is_not_built_of_blocks_can_be_covered() -> None:
    # two machines of two steps each, which wait for each other without a fork
    chart = chart_of("1>2 2+3>1+4 4>3", "1+3")
    assert state_machines(chart).safe


def test_an_unsafe_chart_is_not_covered() -> None:
    found = state_machines(chart_of("1>2+3 2>4 3>4 4>1"))
    assert [step.path for step in found.uncovered] == ["1", "2", "3", "4"]
    assert not found.safe


def test_a_chart_without_initial_step_has_none() -> None:
    assert state_machines(chart_of("1>2 2>1", "")).components == ()
