"""Soundness: what reduction says is what the markings say, for nets that are sound and nets that are not."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plcopen_sfc.analysis.marking import marking_graph
from plcopen_sfc.analysis.search_limits import Answer
from plcopen_sfc.analysis.soundness import SoundnessProof, soundness
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.semantics.net import Net
from tests.analysis.nets import Arcs, any_nets, block_chart, chart_of, chart_of_arcs
from tests.sweeps import examples


def agree(chart: SfcNetwork, cap: int = 20_000) -> bool:
    """Compare both ways; whether both could tell."""
    found, graph = soundness(chart, cap=cap), marking_graph(chart, cap=cap)
    if found.proof is SoundnessProof.NONE or not graph.complete:
        return False
    assert found.safe is graph.safe
    if graph.safe:
        assert found.live is graph.live
        assert found.way_home in (graph.way_home, Answer.UNKNOWN)
    return True


@settings(deadline=None, max_examples=examples(200))
@given(any_nets(max_steps=7, max_transitions=9))
def test_reduction_never_disagrees_with_the_markings(net: tuple[int, tuple[int, ...], Arcs]) -> None:
    assert agree(chart_of_arcs(*net))


@settings(deadline=None, max_examples=examples(60))
@given(st.integers(0, 10**9), st.integers(4, 40))
def test_blocks_are_proven_without_markings(seed: int, size: int) -> None:
    chart = block_chart(seed, size)
    found = soundness(chart)
    assert found
    assert found.way_home is Answer.YES
    assert found.proof is SoundnessProof.REDUCTION
    assert not found.remaining
    agree(chart)


@settings(deadline=None, max_examples=examples(80))
@given(st.integers(0, 10**9), st.integers(4, 14), st.integers(1, 3), st.data())
def test_spoiled_blocks_are_judged_as_by_their_markings(seed: int, size: int, jumps: int, data: st.DataObject) -> None:
    chart = block_chart(seed, size)
    for _ in range(jumps):
        source, target = (data.draw(st.sampled_from(chart.steps)) for _ in range(2))
        chart.add_transition(source, target, "TRUE")
    if data.draw(st.booleans()):
        del chart.transitions[data.draw(st.integers(0, len(chart.transitions) - 1))]
    agree(chart, cap=200)  # unsafe nets cost much for each marking


@pytest.mark.slow
def test_a_large_chart_of_blocks_is_sound() -> None:
    net = Net.of(block_chart(1, 8000))
    assert len(net.steps) > 3000
    found = soundness(net)
    assert found.safe
    assert found.live
    assert found.proof is SoundnessProof.REDUCTION


def test_twenty_branches_of_ten_steps_need_no_markings() -> None:
    branches = [f"b{b}s{i}>b{b}s{i + 1}" for b in range(20) for i in range(9)]
    starts, ends = ("+".join(f"b{b}s{i}" for b in range(20)) for i in (0, 9))
    assert soundness(chart_of(f"1>{starts} {ends}>1 " + " ".join(branches))).proof is SoundnessProof.REDUCTION


def test_any_jumps_in_a_chart_with_one_token_are_sound() -> None:
    assert soundness(chart_of("1>2 1>3 2>4 3>5 2>5 3>4 4>1 5>1 4>3 5>2")).proof is SoundnessProof.REDUCTION


def test_a_chart_that_ends_is_sound_if_it_may_start_anew() -> None:
    chart = chart_of("1>2+3 2>4 3>5 4+5>6")
    assert soundness(chart).live is Answer.NO
    assert soundness(chart, restart=True)
    locked = chart_of("1>2 1>3 2+3>4")
    assert soundness(locked, restart=True).live is Answer.NO


def test_an_end_in_a_simultaneous_branch_is_not_sound() -> None:
    assert not soundness(chart_of("1>2+3 2>4 3>5"), restart=True)


def test_a_broken_chart_says_where_it_is_not_built_of_blocks() -> None:
    found = soundness(chart_of("1>2+3 2>4 4>2 3>5 2+5>6 6>1 4>6"))
    assert not found
    assert found.remaining


def test_what_is_too_large_after_reduction_is_unknown() -> None:
    # each branch has an exit besides its join: no rule fits
    branches = [f"a{b}>b{b} b{b}>c{b} c{b}>a{b} b{b}+d{b}>a{b}+d{b}" for b in range(8)]
    starts = "+".join(f"a{b}+d{b}" for b in range(8))
    chart = chart_of(f"1>{starts} {starts}>1 " + " ".join(branches))
    found = soundness(chart, cap=50)
    assert found.proof is SoundnessProof.NONE
    assert found.safe is Answer.UNKNOWN
    assert not found


def test_a_step_that_nothing_leads_to_is_not_sound() -> None:
    assert soundness(chart_of("1>2 2>1 3>2")).live is Answer.NO


def test_an_unsafe_chart_is_found_unsafe() -> None:
    assert soundness(chart_of("1>2+3 2>4 3>4 4>1")).safe is Answer.NO
    assert soundness(chart_of("1>2 2>1", "1+2")).safe is Answer.NO
