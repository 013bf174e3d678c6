"""Layout: nothing overlaps, the flow runs down, competing transitions stand in order."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from plcopen_sfc.drawing import DrawingStyle, draw, fits, has_positions, layout, limits
from plcopen_sfc.model.conditions import WiredCondition
from plcopen_sfc.model.drawing import Symbol, SymbolKind
from plcopen_sfc.model.network import Connection, Contact, InputPin, LeftPowerRail, OutputPin
from plcopen_sfc.model.sfc import ActionAssociation, SfcNetwork
from tests.drawing.nets import any_net, make, nested_net
from tests.sweeps import examples

STYLES = list(DrawingStyle)
SLOW = settings(max_examples=examples(60), deadline=None, suppress_health_check=[HealthCheck.too_slow])


def boxes(chart: SfcNetwork) -> dict[int, tuple[float, float, float, float]]:
    things = [*chart.drawing.symbols, *chart.logic]
    return {t.id: (*t.position, t.position[0] + t.width, t.position[1] + t.height) for t in things}


def assert_apart(chart: SfcNetwork) -> None:
    placed = sorted(boxes(chart).items(), key=lambda item: item[1])
    for position, (one, a) in enumerate(placed):
        for other, b in placed[position + 1 :]:
            if b[0] >= a[2]:
                break
            assert b[1] >= a[3] or a[1] >= b[3], (one, a, other, b)


@pytest.mark.slow
@pytest.mark.parametrize("style", STYLES)
@SLOW
@given(chart=st.one_of(any_net(), nested_net()), actions=st.integers(0, 3))
def test_nothing_overlaps(style: DrawingStyle, chart: SfcNetwork, actions: int) -> None:
    for step in chart.steps[::2]:
        for _ in range(actions):
            step.actions.append(ActionAssociation(id=chart.new_id(), target="ConveyorMotorForward"))
    chart.drawing = draw(chart, style)
    layout(chart)
    assert_apart(chart)
    assert all(x == int(x) >= 0 and y == int(y) >= 0 for x, y, *_ in boxes(chart).values())
    assert fits(chart)
    again = chart.model_copy(deep=True)
    layout(again)
    assert again == chart


def leads_to(symbols: list[Symbol], start: int, end: int) -> bool:
    """True if wires lead from one symbol to another."""
    sources = {symbol.id: {c.source for pin in symbol.inputs for c in pin.connections} for symbol in symbols}
    seen, pending = {end}, [end]
    while pending:
        found = sources[pending.pop()] - seen
        seen |= found
        pending += found
    return start in seen


@pytest.mark.slow
@pytest.mark.parametrize("style", STYLES)
@SLOW
@given(chart=nested_net())
def test_the_flow_runs_down_and_competing_transitions_stand_in_order(style: DrawingStyle, chart: SfcNetwork) -> None:
    chart.drawing = draw(chart, style)
    layout(chart)
    place = boxes(chart)
    waiting = {problem.symbol for problem in limits(chart) if problem.code == "SFC130"}
    loose = {c.source for s in chart.drawing.symbols if s.id in waiting for pin in s.inputs for c in pin.connections}
    for symbol in chart.drawing.symbols:
        if symbol.kind in (SymbolKind.ACTION_BLOCK, SymbolKind.EXPRESSION):
            continue
        for pin in symbol.inputs:
            for connection in pin.connections:
                # a circle of wires has one that leads up; only charts that cannot be nested have them
                if symbol.id not in loose and not (
                    waiting and leads_to(chart.drawing.symbols, symbol.id, connection.source)
                ):
                    assert place[connection.source][3] < place[symbol.id][1]
                assert connection.points
    for step in chart.steps:
        competing = chart.outgoing(step)
        middles = [place[t.id][0] for t in competing if t.id in place]
        assert middles == sorted(middles)


def test_what_belongs_together_stands_together() -> None:
    chart = make(2, [([0], [1]), ([1], [0])])
    chart.steps[0].actions.append(ActionAssociation(id=10, target="Motor"))
    chart.drawing = draw(chart, DrawingStyle.STRUCTURED)
    assert not has_positions(chart.drawing)
    layout(chart)
    assert has_positions(chart.drawing)
    place = boxes(chart)
    symbols = {s.kind: s for s in chart.drawing.symbols}
    block, jump, expression = (symbols[k] for k in (SymbolKind.ACTION_BLOCK, SymbolKind.JUMP, SymbolKind.EXPRESSION))
    assert place[block.id][0] > place[0][2]
    assert place[block.id][1] == place[0][1]
    assert place[expression.id][2] < place[3][0]
    assert place[jump.id][1] > place[3][3]


def test_logic_stands_left_of_its_transition() -> None:
    chart = make(2, [([0], [1]), ([1], [0])])
    chart.logic = [
        LeftPowerRail(id=20, outputs=[OutputPin()]),
        Contact(id=21, variable="Start", input=InputPin(connections=[Connection(source=20)]), output=OutputPin()),
    ]
    wire = InputPin(connections=[Connection(source=21)])
    chart.transitions[0].condition = WiredCondition(input=wire)
    chart.drawing = draw(chart, DrawingStyle.PLAIN)
    assert chart.drawing.order is not None
    assert chart.drawing.order.index(21) < chart.drawing.order.index(2)
    layout(chart)
    assert_apart(chart)
    place = boxes(chart)
    assert place[20][2] < place[21][0]
    assert place[21][2] < place[2][0]


@pytest.mark.slow
@pytest.mark.parametrize("style", STYLES)
def test_long_and_deep_charts(style: DrawingStyle) -> None:
    long = make(1000, [([i], [(i + 1) % 1000]) for i in range(1000)])
    deep = make(
        201,
        [([i], [i + 1]) for i in range(100)]
        + [([i], [200 - i]) for i in range(100)]
        + [([i], [i + 1]) for i in range(100, 200)],
    )
    comb = make(600, [e for i in range(599) for e in (([i], [i + 1]), ([i], [i]), ([i], [0]))])
    for chart in (long, deep, comb):
        chart.drawing = draw(chart, style)
        assert fits(chart)
        layout(chart)
    assert_apart(deep)
