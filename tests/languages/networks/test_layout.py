"""Drawn networks are readable: nothing overlaps, everything flows from left to right, wires end at pins."""

from __future__ import annotations

from itertools import combinations, pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plcopen_sfc.languages.networks.drawing_rules import DrawingRules
from plcopen_sfc.languages.networks.network_drawing import draw_fbd, draw_ld
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import (
    Block,
    Connection,
    InputPin,
    LeftPowerRail,
    LogicNetwork,
    Node,
    OutputPin,
    Point,
    RightPowerRail,
)
from tests.languages.networks.programs import INSTANCES, programs

Box = tuple[float, float, float, float]


def box(node: Node) -> Box:
    assert node.width is not None
    assert node.height is not None
    return *node.position, node.position[0] + node.width, node.position[1] + node.height


def inputs(node: Node) -> list[InputPin]:
    if isinstance(node, Block):
        return [v.input for v in node.parameters.inputs if v.input is not None]
    if isinstance(node, RightPowerRail):
        return node.inputs
    pin = getattr(node, "input", None)
    return [pin] if pin is not None else []


def outputs(node: Node) -> dict[str | None, list[OutputPin]]:
    if isinstance(node, Block):
        return {v.name: [v.output] for v in node.parameters.outputs if v.output is not None}
    if isinstance(node, LeftPowerRail):
        return {None: node.outputs}
    pin = getattr(node, "output", None)
    return {None: [pin]} if pin is not None else {}


def absolute(node: Node, pin: InputPin | OutputPin) -> Point:
    assert pin.position is not None
    return node.position[0] + pin.position[0], node.position[1] + pin.position[1]


def crosses(a: Point, b: Point, area: Box) -> bool:
    """True if a level or upright line goes through the inside of a box."""
    left, right = sorted((a[0], b[0]))
    top, bottom = sorted((a[1], b[1]))
    return left < area[2] and right > area[0] and top < area[3] and bottom > area[1]


def check(network: LogicNetwork) -> None:
    nodes = {node.id: node for node in network.nodes}
    assert len(nodes) == len(network.nodes)
    for one, other in combinations([box(node) for node in network.nodes], 2):
        apart = one[2] <= other[0] or other[2] <= one[0] or one[3] <= other[1] or other[3] <= one[1]
        assert apart, (one, other)
    for node in network.nodes:
        for pin in inputs(node):
            for wire in pin.connections:
                check_wire(nodes, node, pin, wire)


def check_wire(nodes: dict[int, Node], node: Node, pin: InputPin, wire: Connection) -> None:
    source = nodes[wire.source]
    assert wire.points[0] == absolute(node, pin)
    assert wire.points[-1] in [absolute(source, output) for output in outputs(source)[wire.pin]]
    for a, b in pairwise(wire.points):
        assert a != b
        assert a[0] == b[0] or a[1] == b[1]
        assert b[0] <= a[0], "wires run from left to right"
        through = [other.id for other in nodes.values() if crosses(a, b, box(other))]
        assert not through, (node.id, wire, through)


@pytest.mark.slow
@settings(deadline=None)
@given(programs, st.sampled_from(["FBD", "LD"]), st.booleans())
def test_nothing_overlaps(program: n.Statements, language: str, divided: bool) -> None:
    draw = draw_fbd if language == "FBD" else draw_ld
    rules = DrawingRules(Dialect.CODESYS, instances=INSTANCES)
    networks = draw(program.statements, rules, divided=divided).body.networks
    for network in networks:
        check(network)
    numbers = [node.id for network in networks for node in network.nodes]
    assert len(set(numbers)) == len(numbers)
    if divided:
        rails = [sum(isinstance(node, LeftPowerRail) for node in network.nodes) for network in networks]
        assert set(rails) <= ({1} if language == "LD" else {0})


@pytest.mark.slow
@settings(deadline=None)
@given(programs, st.sampled_from(["FBD", "LD"]))
def test_rungs_stand_below_each_other(program: n.Statements, language: str) -> None:
    """Who goes by the places alone executes in the same order as who goes by the order that is written down."""
    draw = draw_fbd if language == "FBD" else draw_ld
    (network,) = draw(program.statements, DrawingRules(Dialect.CODESYS, instances=INSTANCES)).body.networks
    ordered = [node for node in network.nodes if node.execution_order]
    assert [node.execution_order for node in ordered] == list(range(1, len(ordered) + 1))
    sinks = [node for node in ordered if node.kind in ("output", "coil", "jump", "return", "label")]
    assert [sink.position[1] for sink in sinks] == sorted({sink.position[1] for sink in sinks})


def test_ladders_have_contacts_in_a_row_and_branches_below_each_other() -> None:
    statement = n.Assignment(
        n.Name("Motor"),
        n.Operation(
            n.Operator.AND,
            (
                n.Operation(n.Operator.OR, (n.Name("Start"), n.Name("Motor"))),
                n.Unary(n.Operator.NOT, n.Name("Stop")),
            ),
        ),
    )
    (network,) = draw_ld([statement]).body.networks
    rail, start, latch, stop, coil, right = network.nodes
    assert [node.kind for node in network.nodes] == [
        "leftPowerRail",
        "contact",
        "contact",
        "contact",
        "coil",
        "rightPowerRail",
    ]
    assert start.position[1] == stop.position[1] == coil.position[1]
    assert latch.position == (start.position[0], start.position[1] + 30)
    assert rail.position[0] < start.position[0] < stop.position[0] < coil.position[0] < right.position[0]
    assert getattr(stop, "negated", False)
