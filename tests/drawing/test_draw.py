"""Charts as PLC engineers draw them, in both styles."""

from __future__ import annotations

import pytest

from plcopen_sfc.drawing import DrawingStyle, draw, fits, limits, renumber
from plcopen_sfc.model.drawing import Drawing, SymbolKind
from plcopen_sfc.model.sfc import ActionAssociation, SfcNetwork
from tests.drawing.nets import links_of_chart, links_of_drawing, make

SHORT = {
    SymbolKind.STEP: "S",
    SymbolKind.TRANSITION: "t",
    SymbolKind.JUMP: "jump",
    SymbolKind.SELECTION_DIVERGENCE: "(",
    SymbolKind.SELECTION_CONVERGENCE: ")",
    SymbolKind.SIMULTANEOUS_DIVERGENCE: "[",
    SymbolKind.SIMULTANEOUS_CONVERGENCE: "]",
    SymbolKind.ACTION_BLOCK: "actions",
    SymbolKind.EXPRESSION: "=",
}


def text(drawing: Drawing) -> str:
    """The symbols in order: steps and transitions by id, jumps by target."""
    words = []
    for symbol in drawing.symbols:
        word = SHORT[symbol.kind]
        if symbol.kind in (SymbolKind.STEP, SymbolKind.TRANSITION):
            word += str(symbol.id)
        words.append(f"->{symbol.target}" if symbol.kind is SymbolKind.JUMP else word)
    return " ".join(words)


CHARTS: list[tuple[str, SfcNetwork, str, str]] = [
    (
        "linear loop",
        make(3, [([0], [1]), ([1], [2]), ([2], [0])]),
        "S0 t3 S1 t4 S2 t5 ->0",
        "S0 = t3 S1 = t4 S2 = t5 ->0",
    ),
    (
        "selection of three that meet",
        make(5, [([0], [1]), ([0], [2]), ([0], [3]), ([1], [4]), ([2], [4]), ([3], [4]), ([4], [0])]),
        "S0 ( t5 S1 t8 t6 S2 t9 t7 S3 t10 ) S4 t11 ->0",
        "S0 ( = t5 S1 = t8 = t6 S2 = t9 = t7 S3 = t10 ) S4 = t11 ->0",
    ),
    (
        "exit by a jump",
        make(3, [([0], [1]), ([1], [2]), ([1], [0]), ([2], [0])]),
        "S0 t3 S1 ( t4 t5 ->0 S2 t6 ->0",
        "S0 = t3 S1 ( = t4 = t5 ->0 ) S2 = t6 ->0",
    ),
    (
        "skip",
        make(3, [([0], [1]), ([0], [2]), ([1], [2]), ([2], [0])]),
        "S0 ( t3 S1 t5 t4 ) S2 t6 ->0",
        "S0 ( = t3 S1 = t5 = t4 ) S2 = t6 ->0",
    ),
    (
        "nested selection",
        make(6, [([0], [1]), ([0], [2]), ([1], [3]), ([1], [4]), ([3], [5]), ([4], [5]), ([2], [5]), ([5], [0])]),
        "S0 ( t6 S1 ( t8 S3 t10 t9 S4 t11 t7 S2 t12 ) S5 t13 ->0",
        "S0 ( = t6 S1 ( = t8 S3 = t10 = t9 S4 = t11 ) = t7 S2 = t12 ) S5 = t13 ->0",
    ),
    (
        "simultaneous sequences",
        make(4, [([0], [1, 2]), ([1, 2], [3]), ([3], [0])]),
        "S0 t4 [ S1 S2 ] t5 S3 t6 ->0",
        "S0 = t4 [ S1 S2 ] = t5 S3 = t6 ->0",
    ),
    (
        "competing transitions below simultaneous sequences",
        make(4, [([0], [1, 2]), ([1, 2], [3]), ([1, 2], [0]), ([3], [0])]),
        "",
        "",
    ),
    (
        "a jump out of simultaneous sequences",
        make(4, [([0], [1, 2]), ([1], [0]), ([1, 2], [3]), ([3], [0])]),
        "",
        "",
    ),
    ("self loop", make(1, [([0], [0])]), "S0 t1 ->0", "S0 = t1 ->0"),
    ("a step alone", make(1, []), "S0", "S0"),
    ("nothing", make(0, []), "", ""),
    ("two charts in one", make(2, [([0], [0]), ([1], [1])]), "S0 t2 ->0 S1 t3 ->1", "S0 = t2 ->0 S1 = t3 ->1"),
    ("a transition that leads nowhere", make(1, [([0], [])]), "S0 t1", "S0 = t1"),
    ("a transition from nowhere", make(1, [([], [0])]), "S0 t1 ->0", "S0 = t1 ->0"),
]


@pytest.mark.parametrize(("chart", "plain", "structured"), [c[1:] for c in CHARTS], ids=[c[0] for c in CHARTS])
def test_usual_charts(chart: SfcNetwork, plain: str, structured: str) -> None:
    for style, expected in ((DrawingStyle.PLAIN, plain), (DrawingStyle.STRUCTURED, structured)):
        drawing = draw(chart, style)
        assert links_of_drawing(drawing) == links_of_chart(chart)
        if expected:
            assert text(drawing) == expected


def test_competing_transitions_stand_in_the_order_of_their_priorities() -> None:
    chart = make(4, [([0], [1]), ([0], [2]), ([0], [3])])
    for transition, priority in zip(chart.transitions, (3, 1, 2), strict=True):
        transition.priority = priority
    for style in DrawingStyle:
        order = [s.id for s in draw(chart, style).symbols if s.kind is SymbolKind.TRANSITION]
        assert order == [5, 6, 4]


def test_alternatives_that_end_with_steps_share_their_transition() -> None:
    chart = make(4, [([0], [1]), ([0], [2]), ([1], [3]), ([2], [3]), ([3], [0])])
    chart.transitions[2].condition = chart.transitions[3].condition
    structured = draw(chart, DrawingStyle.STRUCTURED)
    assert text(structured) == "S0 ( = t4 S1 = t5 S2 ) = t6 S3 = t8 ->0"
    assert text(draw(chart, DrawingStyle.PLAIN)) == "S0 ( t4 S1 t6 t5 S2 t7 ) S3 t8 ->0"


def test_pins_are_those_of_codesys() -> None:
    chart = make(3, [([0], [1]), ([0], [2]), ([1], [2]), ([2], [0])])
    chart.steps[0].actions.append(ActionAssociation(id=20, target="Motor"))
    chart.drawing = draw(chart, DrawingStyle.STRUCTURED)
    renumber(chart)
    assert fits(chart)
    step, block, divergence, expression, transition = chart.drawing.symbols[:5]
    convergence = next(s for s in chart.drawing.symbols if s.kind is SymbolKind.SELECTION_CONVERGENCE)
    assert [s.id for s in (step, block, divergence, expression, transition)] == [0, 2, 3, 4, 5]
    assert [pin.connections for pin in step.inputs] == [[]]
    assert [pin.name for pin in step.outputs] == ["sfc"]
    assert step.action_output is not None
    assert step.action_output.name == "x"
    assert [e.association for e in block.entries or ()] == [1]
    assert block.inputs[0].connections[0].pin is None
    assert [pin.name for pin in divergence.outputs] == ["sfc", "sfc"]
    assert divergence.inputs[0].connections[0].pin is None
    assert divergence.name == "Branch0"
    assert transition.inputs[0].connections[0].pin == "sfc"
    assert transition.condition is not None
    assert transition.condition.connections[0].pin is None
    assert [c.pin for pin in convergence.inputs for c in pin.connections] == ["sfc", "sfc"]
    assert [pin.name for pin in convergence.outputs] == [None]


def test_limits_name_what_codesys_cannot_draw() -> None:
    assert limits(make(2, [([0], [1]), ([1], [0])])) == []
    crossed = make(6, [([0], [1, 2, 3]), ([1, 2], [4]), ([2, 3], [5])])
    assert "SFC130" in {problem.code for problem in limits(crossed)}
    assert {problem.code for problem in limits(make(2, [([0], [0])]))} == {"SFC131", "SFC132"}
