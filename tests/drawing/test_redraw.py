"""Redrawing after edits: the drawing fits again, and what the edit does not concern stays as it was."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from plcopen_sfc.drawing import DrawingStyle, draw, fits, layout, redraw
from plcopen_sfc.model.conditions import Expression, NamedCondition
from plcopen_sfc.model.drawing import Symbol, SymbolKind
from plcopen_sfc.model.sfc import ActionAssociation, SfcNetwork
from tests.drawing.nets import any_net, links_of_chart, links_of_drawing, make, nested_net
from tests.sweeps import examples

STYLES = list(DrawingStyle)
SLOW = settings(max_examples=examples(40), deadline=None, suppress_health_check=[HealthCheck.too_slow])


def edit(data: st.DataObject, chart: SfcNetwork) -> None:
    """One random edit."""
    kind = data.draw(st.sampled_from(["step", "transition", "remove step", "remove", "sources", "targets", "else"]))
    steps, transitions = chart.steps, chart.transitions
    ids = st.lists(st.sampled_from([s.id for s in steps]), max_size=2, unique=True) if steps else st.just([])
    if kind == "step":
        step = chart.add_step(f"N{chart.new_id()}")
        step.actions.append(ActionAssociation(id=chart.new_id(), target="Lamp"))
    elif kind == "transition" and steps:
        transition = chart.add_transition([], [], data.draw(st.sampled_from(["a", "b"])))
        transition.sources, transition.targets = data.draw(ids), data.draw(ids)
    elif kind == "remove step" and steps:
        gone = data.draw(st.sampled_from(steps))
        steps.remove(gone)
        for transition in transitions:
            transition.sources = [i for i in transition.sources if i != gone.id]
            transition.targets = [i for i in transition.targets if i != gone.id]
    elif transitions:
        transition = data.draw(st.sampled_from(transitions))
        if kind == "remove":
            transitions.remove(transition)
        elif kind == "sources":
            transition.sources = data.draw(ids)
        elif kind == "targets":
            transition.targets = data.draw(ids)
        else:
            transition.condition = data.draw(
                st.sampled_from([None, NamedCondition(name="N"), Expression(text="x"), Expression(text="a")])
            )


@pytest.mark.slow
@pytest.mark.parametrize("placed", [False, True])
@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize("other", STYLES)
@SLOW
@given(data=st.data())
def test_a_redrawn_chart_fits(other: DrawingStyle, style: DrawingStyle, placed: bool, data: st.DataObject) -> None:
    chart = data.draw(st.one_of(any_net(), nested_net()))
    chart.drawing = draw(chart, other)
    if placed:
        layout(chart)
    for _ in range(data.draw(st.integers(1, 4))):
        edit(data, chart)
    before = chart.drawing.model_copy(deep=True)
    drawn_before = fits(chart, style)
    redraw(chart, style)
    assert fits(chart, style)
    assert links_of_drawing(chart.drawing) == links_of_chart(chart)
    if drawn_before:
        assert chart.drawing == before
    again = chart.drawing.model_copy(deep=True)
    redraw(chart, style)
    assert chart.drawing == again


def long_chart(style: DrawingStyle) -> SfcNetwork:
    """Three selections one below the other, and a loop."""
    edges: list[tuple[list[int], list[int]]] = []
    for base in (0, 4, 8):
        edges += [([base], [base + 1]), ([base], [base + 2]), ([base + 1], [base + 3]), ([base + 2], [base + 3])]
        edges.append(([base + 3], [(base + 4) % 12]))
    chart = make(12, edges)
    chart.step("S6").actions.append(ActionAssociation(id=chart.new_id(), target="Lamp"))
    chart.drawing = draw(chart, style)
    return chart


def difference(before: list[Symbol], after: list[Symbol]) -> tuple[list[Symbol], list[Symbol]]:
    old = {symbol.id: symbol for symbol in before}
    new = {symbol.id: symbol for symbol in after}
    gone = [symbol for symbol in before if new.get(symbol.id) != symbol]
    come = [symbol for symbol in after if old.get(symbol.id) != symbol]
    assert [s.id for s in before if s.id in new] == [s.id for s in after if s.id in old]
    return gone, come


@pytest.mark.parametrize("placed", [False, True])
@pytest.mark.parametrize("style", STYLES)
def test_a_new_exit_changes_the_symbols_around_it(style: DrawingStyle, placed: bool) -> None:
    chart = long_chart(style)
    if placed:
        layout(chart)
    before = chart.drawing.model_copy(deep=True).symbols
    chart.add_transition(chart.step("S6"), chart.step("S0"), "Stop")
    redraw(chart, style)
    gone, come = difference(before, chart.drawing.symbols)
    touched = {s.id for s in (*gone, *come) if s.kind in (SymbolKind.STEP, SymbolKind.TRANSITION)}
    assert touched <= {6, 7, *(t.id for t in chart.transitions if {6, 7} & {*t.sources, *t.targets})}
    jumps = [s for s in come if s.kind is SymbolKind.JUMP]
    assert [jump.target for jump in jumps] == [0]
    assert len(come) <= len(gone) + 5


@pytest.mark.parametrize("style", STYLES)
def test_a_step_put_into_a_wire_changes_the_wire(style: DrawingStyle) -> None:
    chart = long_chart(style)
    before = chart.drawing.model_copy(deep=True).symbols
    transition = next(t for t in chart.transitions if t.targets == [5])
    step = chart.add_step("New")
    chart.add_transition(step, chart.step("S5"), "x")
    transition.targets = [step.id]
    redraw(chart, style)
    gone, come = difference(before, chart.drawing.symbols)
    assert [s.id for s in gone] == [5]
    kinds = [SymbolKind.STEP, SymbolKind.EXPRESSION, SymbolKind.TRANSITION, SymbolKind.STEP]
    assert [s.kind for s in come] == [k for k in kinds if style.structured or k is not SymbolKind.EXPRESSION]


@pytest.mark.parametrize("style", STYLES)
def test_actions_come_and_go_in_their_block(style: DrawingStyle) -> None:
    chart = long_chart(style)
    before = chart.drawing.model_copy(deep=True).symbols
    step = chart.step("S6")
    step.actions.insert(0, ActionAssociation(id=chart.new_id(), target="Horn"))
    chart.step("S1").actions.append(ActionAssociation(id=chart.new_id(), target="Lamp"))
    redraw(chart, style)
    gone, come = difference(before, chart.drawing.symbols)
    assert [s.kind for s in gone] == [SymbolKind.STEP, SymbolKind.ACTION_BLOCK]
    assert [s.kind for s in come] == [SymbolKind.STEP, SymbolKind.ACTION_BLOCK, SymbolKind.ACTION_BLOCK]
    block = next(s for s in come if s.inputs[0].connections[0].source == step.id)
    assert [e.association for e in block.entries or ()] == [a.id for a in step.actions]
    step.actions.clear()
    redraw(chart, style)
    assert fits(chart)
    assert all(s.id != block.id for s in chart.drawing.symbols)


def test_a_condition_that_gets_a_name_loses_its_expression() -> None:
    chart = long_chart(DrawingStyle.STRUCTURED)
    count = len(chart.drawing.symbols)
    transition = chart.transitions[3]
    transition.condition = NamedCondition(name="Ready")
    redraw(chart, DrawingStyle.STRUCTURED)
    assert len(chart.drawing.symbols) == count - 1
    transition.condition = "Ready"
    assert not fits(chart)
    redraw(chart, DrawingStyle.STRUCTURED)
    symbols = chart.drawing.symbols
    position = next(i for i, s in enumerate(symbols) if s.id == transition.id)
    assert symbols[position - 1].kind is SymbolKind.EXPRESSION
    assert len(symbols) == count


def test_competing_transitions_that_change_places_do_so_in_the_drawing() -> None:
    chart = long_chart(DrawingStyle.STRUCTURED)
    competing = chart.outgoing(chart.step("S4"))
    competing[1].priority = 1
    assert fits(chart)
    assert not fits(chart, DrawingStyle.STRUCTURED)
    redraw(chart, DrawingStyle.STRUCTURED)
    order = [s.id for s in chart.drawing.symbols]
    assert order.index(competing[1].id) < order.index(competing[0].id)


def test_transitions_that_share_a_symbol_are_split_when_they_differ() -> None:
    chart = make(4, [([0], [1]), ([0], [2]), ([1], [3]), ([2], [3]), ([3], [0])])
    chart.transitions[2].condition = chart.transitions[3].condition = Expression(text="done")
    chart.drawing = draw(chart, DrawingStyle.STRUCTURED)
    shared = [s for s in chart.drawing.symbols if s.transitions]
    assert [s.transitions for s in shared] == [[6, 7]]
    chart.transitions[3].condition = "other"
    assert not fits(chart)
    redraw(chart, DrawingStyle.STRUCTURED)
    assert fits(chart)
    assert not [s for s in chart.drawing.symbols if s.transitions]


def test_a_jump_keeps_its_comment_when_its_branch_changes() -> None:
    chart = make(3, [([0], [1]), ([0], [0]), ([1], [2]), ([2], [0])])
    chart.drawing = draw(chart, DrawingStyle.STRUCTURED)
    jump = next(s for s in chart.drawing.symbols if s.kind is SymbolKind.JUMP)
    jump.comment = "again"
    chart.add_transition(chart.step("S0"), chart.step("S2"), "skip")
    redraw(chart, DrawingStyle.STRUCTURED)
    assert "again" in [s.comment for s in chart.drawing.symbols if s.id == jump.id]


@pytest.mark.parametrize("source", range(12))
def test_a_new_transition_is_one_branch_more_and_all_else_stays(source: int) -> None:
    """Also where the drawing is not as a new one would be: that one moved branches that nobody had edited."""
    for target in range(12):
        chart = long_chart(DrawingStyle.STRUCTURED)
        for number, (start, end) in enumerate([(1, 7), (source, target)]):
            before = chart.drawing.model_copy(deep=True).symbols
            chart.add_transition(chart.step(f"S{start}"), chart.step(f"S{end}"), f"way{number}")
            redraw(chart, DrawingStyle.STRUCTURED)
            gone, come = difference(before, chart.drawing.symbols)
            assert {symbol.id for symbol in before} <= {symbol.id for symbol in chart.drawing.symbols}
            assert len(gone) <= 2, (source, target, [(each.kind, each.id) for each in gone])
            assert len(come) <= len(gone) + 5


def test_a_new_sequence_is_one_branch_more_and_all_else_stays() -> None:
    chart = long_chart(DrawingStyle.STRUCTURED)
    chart.add_transition("S1", "S7", "way")
    redraw(chart, DrawingStyle.STRUCTURED)
    before = chart.drawing.model_copy(deep=True).symbols
    first, second = chart.add_step("New1", actions=["N Lamp"]), chart.add_step("New2")
    for source, target in (("S6", first), (first, second), (second, "S3")):
        chart.add_transition(source, target, "on")
    redraw(chart, DrawingStyle.STRUCTURED)
    gone, come = difference(before, chart.drawing.symbols)
    assert {symbol.id for symbol in before} <= {symbol.id for symbol in chart.drawing.symbols}
    assert len(gone) <= 2
    new = [symbol.kind for symbol in come if symbol.id not in {each.id for each in before}]
    assert new.count(SymbolKind.STEP) == 2
    assert new.count(SymbolKind.TRANSITION) == 3
    assert new.count(SymbolKind.JUMP) == 1
    assert new.count(SymbolKind.ACTION_BLOCK) == 1


def test_a_branch_that_is_drawn_elsewhere_is_the_same_branch() -> None:
    chart = make(5, [([0], [1]), ([1], [2]), ([1], [3]), ([2], [4]), ([3], [4]), ([4], [0])])
    chart.drawing = draw(chart, DrawingStyle.STRUCTURED)
    bar = next(s for s in chart.drawing.symbols if s.kind is SymbolKind.SELECTION_DIVERGENCE)
    bar.comment, bar.name = "by weight", "Weight"
    chart.add_transition(chart.step("S4"), chart.step("S1"), "again")
    chart.transitions[1].sources = [chart.step("S4").id]  # and that one no longer begins in it
    chart.add_transition(chart.step("S1"), chart.step("S2"), "other")
    redraw(chart, DrawingStyle.STRUCTURED)
    assert [(s.id, s.name) for s in chart.drawing.symbols if s.comment == "by weight"] == [(bar.id, "Weight")]
