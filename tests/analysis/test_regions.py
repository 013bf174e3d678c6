"""Regions: what they claim holds in every reachable marking, and what is in their way is named."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plcopen_sfc.analysis.marking import marking_graph
from plcopen_sfc.analysis.regions import Obstacle, Regions, Unstructured, find_regions
from plcopen_sfc.semantics.net import Net, mask
from tests.analysis.nets import Arcs, any_nets, block_chart, chart_of, chart_of_arcs
from tests.sweeps import examples


def check_claims(found: Regions, cap: int) -> None:
    """No step gets a second token, and in each marking exactly the regions that nest have their one step."""
    graph = marking_graph(found.net, cap=cap)
    if not graph.complete:
        return
    assert graph.safe
    bits = [mask(region.steps) for region in found.regions]
    for marking in graph:
        assert not marking & ~sum(bits)
        active = {r.index for r in found.regions if marking & bits[r.index]}
        assert all((marking & bits[i]).bit_count() == 1 for i in active)
        for block in found.blocks:
            running = active.intersection(block.branches)
            inside = {
                i for i in block.branches if i in active or any(_runs(found, b, active) for b in _blocks(found, i))
            }
            assert inside in (set(), set(block.branches))
            assert not running or block.parent not in active
        for region in found.regions:
            if region.block is None:
                assert region.index in active or any(_runs(found, b, active) for b in region.blocks)


def _blocks(found: Regions, region: int) -> tuple[int, ...]:
    return found.regions[region].blocks


def _runs(found: Regions, block: int, active: set[int]) -> bool:
    """True if a block is under way: one of its branches is active, or a block forked from it is."""
    branches = found.blocks[block].branches
    return any(i in active or any(_runs(found, b, active) for b in _blocks(found, i)) for i in branches)


@settings(deadline=None, max_examples=examples(150))
@given(any_nets(max_steps=7, max_transitions=9))
def test_what_regions_claim_of_any_net_holds(net: tuple[int, tuple[int, ...], Arcs]) -> None:
    found = find_regions(chart_of_arcs(*net))
    if isinstance(found, Regions):
        check_claims(found, 5000)
    else:
        assert found.message


@settings(deadline=None, max_examples=examples(60))
@given(st.integers(0, 10**9), st.integers(4, 40))
def test_nested_blocks_have_regions(seed: int, size: int) -> None:
    found = find_regions(block_chart(seed, size))
    assert isinstance(found, Regions)
    assert all(len(block.forks) == len(block.joins) == 1 for block in found.blocks)
    assert None not in found.region_of
    check_claims(found, 2000)


@settings(deadline=None, max_examples=examples(50))
@given(st.integers(0, 10**9), st.integers(4, 14), st.data())
def test_with_jumps_anywhere_the_claims_hold(seed: int, size: int, data: st.DataObject) -> None:
    chart = block_chart(seed, size)
    for _ in range(2):
        source, target = (data.draw(st.sampled_from(chart.steps)) for _ in range(2))
        chart.add_transition(source, target, "TRUE")
    found = find_regions(chart)
    if isinstance(found, Regions):
        check_claims(found, 1000)


def test_a_chart_with_one_token_is_one_region() -> None:
    found = find_regions(chart_of("1>2 1>3 2>4 3>4 4>1 4>2"))
    assert isinstance(found, Regions)
    assert len(found.regions) == 1
    assert found.regions[0].transitions == (0, 1, 2, 3, 4, 5)


def test_a_block_has_its_fork_and_join() -> None:
    chart = chart_of("1>2+3 2>4 3>5 4+5>6 6>1")
    found = find_regions(chart)
    assert isinstance(found, Regions)
    assert [found.net.names(mask(r.steps)) for r in found.regions] == [("1", "6"), ("2", "4"), ("3", "5")]
    (block,) = found.blocks
    assert (block.parent, block.branches, block.forks, block.joins) == (0, (1, 2), (0,), (3,))
    assert [r.block for r in found.regions] == [None, 0, 0]
    assert found.regions[0].initial == 0
    assert not found.exit_competitors(block)


def test_blocks_nest() -> None:
    found = find_regions(chart_of("1>2+3 2>4+5 4+5>6 3+6>1"))
    assert isinstance(found, Regions)
    outer, inner = sorted(found.blocks, key=lambda block: block.parent)
    assert outer.parent == 0
    assert inner.parent in outer.branches
    assert found.net.names(mask(found.regions[inner.parent].steps)) == ("2", "6")


def test_an_exit_besides_the_join_that_stays_in_the_branch_is_told() -> None:
    found = find_regions(chart_of("1>2+3 2>4 4>2 3+4>1"))
    assert isinstance(found, Regions)
    assert [found.net.transitions[i].path for i in found.exit_competitors(found.blocks[0])] == ["4 -> 2"]


def test_two_forks_may_start_the_same_branches() -> None:
    found = find_regions(chart_of("1>2+3 1>4+3 4>2 2+3>1"))
    assert isinstance(found, Regions)
    assert len(found.blocks[0].forks) == 2
    assert any(len(block.forks) > 1 for block in found.blocks)


def test_several_sequences_are_regions_beside_each_other() -> None:
    found = find_regions(chart_of("1>2 2>1 10>11 11>10", "1+10"))
    assert isinstance(found, Regions)
    assert [r.initial for r in found.regions] == [0, 2] or len(found.regions) == 2
    assert len(found.regions) > 1


def test_what_is_never_active_belongs_to_no_region() -> None:
    found = find_regions(chart_of("1>2 2>1 8>9 9>1"))
    assert isinstance(found, Regions)
    assert len(found.regions) == 1
    assert dict(zip((s.path for s in found.net.steps), found.region_of, strict=True))["9"] is None


@pytest.mark.parametrize(
    ("text", "initial", "obstacle", "words"),
    [
        ("1>2", "", Obstacle.NO_INITIAL_STEP, "no step is initial"),
        ("1>2 2>1", "1+2", Obstacle.SEVERAL_INITIAL_STEPS, "1 and 2 are both initial"),
        ("1>2+3 2+3>1", "1+2", Obstacle.INITIAL_STEP_IN_BRANCH, "2 is initial inside"),
        ("1>2 2>1 >1", "1", Obstacle.NO_SOURCE, "nowhere -> 1 has no source"),
        ("1>2 2>", "1", Obstacle.NO_TARGET, "2 -> nowhere has no target"),
        ("1>2+3 2+3>4+5 4+5>1", "1", Obstacle.FORK_AND_JOIN, "2+3 -> 4+5 ends"),
        ("1>2+3 2>4 3>5 4+5>1 4>1", "1", Obstacle.JUMP_ACROSS_BORDER, "the branch of step 2 at 1 -> 2+3 "),
        ("1>2+3 2>4 3>4 4>5", "1", Obstacle.BRANCHES_RUN_TOGETHER, "run together without a join: 2 -> 4, 3 -> 4"),
        ("1>2 1>3 2+3>4 4>1", "1", Obstacle.UNMATCHED_JOIN, "joins 2 and 3, of which only one can be active"),
        ("1>2+3+4 2+3>5 4+5>1", "1", Obstacle.UNMATCHED_JOIN, "2+3 -> 5 joins 2, 3, which were not forked"),
        ("1>2+3 1>3+4 2+3>5 3+4>5", "1", Obstacle.UNMATCHED_FORK, "forks some, too"),
        ("1>2 2+9>1", "1", Obstacle.LOCKED_JOIN, "2+9 -> 1 waits for step 9, which is never active"),
    ],
)
def test_obstacles_are_named(text: str, initial: str, obstacle: Obstacle, words: str) -> None:
    found = find_regions(chart_of(text, initial))
    assert isinstance(found, Unstructured)
    assert found.obstacle is obstacle, found.message
    assert words in found.message


def test_a_jump_across_a_border_is_named() -> None:
    found = find_regions(chart_of("1>2+3 2>4 3>5 4+5>1 4>1"))
    assert isinstance(found, Unstructured)
    assert [found.net.transitions[i].path for i in found.transitions] == ["2 -> 4", "4 -> 1"]


@pytest.mark.slow
def test_large_charts_have_regions_too() -> None:
    net = Net.of(block_chart(3, 8000))
    found = find_regions(net)
    assert isinstance(found, Regions)
    assert len(net.steps) > 4000
    assert len(found.blocks) > 50
