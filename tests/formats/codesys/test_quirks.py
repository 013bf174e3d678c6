"""Drawings of CODESYS and TwinCAT and their meaning, wires included that no textbook has."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from tests.samples import FIXTURES
from tests.snippets import bar, chart, codes, codesys, jump, links, round_trip, step
from tests.snippets import drawn_transition as transition

FAMILY = ("codesys/sorting_conveyor.xml", "codesys/distribution_belt.xml", "codesys/device_export.xml")
ALL = (*FAMILY, "twincat/press_station.xml")


def network(*elements: str) -> tuple[m.SfcNetwork, list[str]]:
    loaded = round_trip(codesys(chart(*elements)))
    assert loaded.source is not None
    assert loaded.source.format == "codesys"
    found = loaded.pou("Main").sfc
    assert found is not None
    return found, codes(loaded)


def test_1_legs_that_end_in_a_jump_are_wired_into_the_convergence_and_end_there() -> None:
    found, codes = network(
        step(0, "A", initial=True),
        bar("selectionDivergence", 1, 0, outputs=2),
        transition(2, 1, condition="x"),
        step(3, "B", 2),
        transition(4, 3),
        transition(5, 1, condition="y"),
        jump(6, "A", 5),
        bar("selectionConvergence", 7, 4, 6),
        step(8, "C", 7),
        transition(9, 8),
        jump(10, "A", 9),
    )
    assert links(found) == [(["A"], ["B"]), (["B"], ["C"]), (["A"], ["A"]), (["C"], ["A"])]
    assert codes == []


def test_2_what_follows_a_convergence_of_jumps_only_is_never_reached() -> None:
    found, codes = network(
        step(0, "A", initial=True),
        bar("selectionDivergence", 1, 0, outputs=2),
        transition(2, 1, condition="x"),
        jump(3, "A", 2),
        transition(4, 1, condition="y"),
        jump(5, "A", 4),
        bar("selectionConvergence", 6, 3, 5),
        step(7, "Dead", 6),
        transition(8, 7),
        jump(9, "A", 8),
    )
    assert links(found) == [(["A"], ["A"]), (["A"], ["A"]), (["Dead"], ["A"])]
    assert found.incoming(found.step("Dead")) == []
    assert codes == []


def test_3_simultaneous_leg_that_ends_in_a_jump_is_not_waited_for() -> None:
    found, _ = network(
        step(0, "A", initial=True),
        transition(1, 0),
        bar("simultaneousDivergence", 2, 1, outputs=2),
        step(3, "B", 2),
        step(4, "C", 2),
        transition(5, 4),
        jump(6, "A", 5),
        bar("simultaneousConvergence", 7, 3, 6),
        transition(8, 7),
        step(9, "D", 8),
        transition(10, 9),
        jump(11, "A", 10),
    )
    assert links(found) == [(["A"], ["B", "C"]), (["C"], ["A"]), (["B"], ["D"]), (["D"], ["A"])]


def test_4_nested_branches_are_flattened() -> None:
    found, _ = network(
        step(0, "A", initial=True),
        bar("selectionDivergence", 1, 0, outputs=2),
        bar("selectionDivergence", 2, 1, outputs=2),
        transition(3, 2, condition="x"),
        transition(4, 2, condition="y"),
        bar("selectionConvergence", 5, 3, 4),
        transition(6, 1, condition="z"),
        bar("selectionConvergence", 7, 5, 6),
        step(8, "B", 7),
        transition(9, 8),
        jump(10, "A", 9),
    )
    assert links(found) == [(["A"], ["B"])] * 3 + [(["B"], ["A"])]
    assert [t.id for t in found.outgoing(found.step("A"))] == [3, 4, 6]


def test_5_legs_that_end_with_steps_share_one_transition_symbol() -> None:
    found, codes = network(
        step(0, "A", initial=True),
        bar("selectionDivergence", 1, 0, outputs=2),
        transition(2, 1, condition="x"),
        step(3, "B", 2),
        transition(4, 1, condition="y"),
        step(5, "C", 4),
        bar("selectionConvergence", 6, 3, 5),
        transition(7, 6, condition="ready"),
        jump(8, "A", 7),
    )
    assert links(found) == [(["A"], ["B"]), (["A"], ["C"]), (["B"], ["A"]), (["C"], ["A"])]
    assert {str(t.condition) for t in found.transitions[2:]} == {str(m.Expression(text="ready"))}
    assert found.drawing is not None
    symbol = next(s for s in found.drawing.symbols if s.id == 7)
    assert symbol.transitions == [t.id for t in found.transitions[2:]]
    assert codes == []


def test_5_an_edit_of_the_shared_condition_is_one_edit_in_the_file() -> None:
    elements = (
        *(step(0, "A", initial=True), bar("selectionDivergence", 1, 0, outputs=2)),
        *(transition(2, 1, condition="x"), step(3, "B", 2), transition(4, 1, condition="y"), step(5, "C", 4)),
        *(bar("selectionConvergence", 6, 3, 5), transition(7, 6, condition="ready"), jump(8, "A", 7)),
    )
    data = codesys(chart(*elements))
    loaded = sfc.loads(data)
    found = loaded.pou("Main").sfc
    assert found is not None
    for shared in found.transitions[2:]:
        shared.condition = "done"  # type: ignore[assignment]
    assert sfc.dumps(loaded) == data.replace(b"ready", b"done")


def test_6_jump_behind_a_step_is_an_error_that_can_be_looked_at() -> None:
    found, codes = network(step(0, "A", initial=True), transition(1, 0), step(2, "B", 1), jump(3, "A", 2))
    assert links(found) == [(["A"], ["B"])]
    assert codes == ["SFC106"]


def test_7_jump_behind_a_convergence() -> None:
    found, codes = network(
        step(0, "A", initial=True),
        bar("selectionDivergence", 1, 0, outputs=2),
        transition(2, 1, condition="x"),
        transition(3, 1, condition="y"),
        bar("selectionConvergence", 4, 2, 3),
        jump(5, "A", 4),
    )
    assert links(found) == [(["A"], ["A"])] * 2
    assert codes == []


@pytest.mark.parametrize("name", ALL)
def test_8_charts_in_actions_have_steps_with_names_of_their_own(name: str) -> None:
    project_ = sfc.load(FIXTURES / name)
    for pou in project_.pous:
        names = [s.name.casefold() for c in project_.charts() if c.pou is pou for s in c.chart.steps]
        assert len(set(names)) == len(names)


def test_9_times_and_keywords_keep_the_users_spelling() -> None:
    found, _ = network(step(0, "A", initial=True), transition(1, 0, condition="T1 &gt; t#7S Or True"), jump(2, "A", 1))
    assert found.transitions[0].condition == m.Expression(text="T1 > t#7S Or True")


def test_conditions_are_the_expressions_and_not_logic() -> None:
    for name in ALL:
        for one in sfc.load(FIXTURES / name).charts():
            assert one.chart.logic == []
            assert all(isinstance(t.condition, m.Expression) for t in one.chart.transitions)


@pytest.mark.parametrize("name", ALL)
def test_fixtures_run_round(name: str) -> None:
    """Every transition leads from a step to a step, and every step that is not dead is reached."""
    loaded = sfc.load(FIXTURES / name)
    for one in loaded.charts():
        assert len(one.chart.initial_steps) == 1
        for transition_ in one.chart.transitions:
            assert transition_.sources or "SFC104" in codes(loaded)


def test_press_station_has_each_quirk() -> None:
    loaded = sfc.load(FIXTURES / "twincat/press_station.xml")
    networks = [c.chart for c in loaded.charts()]
    shared = [s for n in networks for s in n.drawing.symbols if s.transitions]  # type: ignore[union-attr]
    assert shared
    bars = [[n.step(i).name for i in t.targets] for n in networks for t in n.transitions if len(t.targets) > 1]
    assert bars
    actions = [a for n in networks for s in n.steps for a in (s.entry_action, s.main_action, s.exit_action)]
    assert [a for a in actions if isinstance(a, str) and "." in a]
