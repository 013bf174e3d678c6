"""Networks and the text they become do the same, whatever the values of the variables."""

from __future__ import annotations

from itertools import product
from typing import Any

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.networks.network_drawing import draw_fbd, draw_ld
from plcopen_sfc.languages.networks.network_reading import network_statements
from plcopen_sfc.languages.networks.wires import normal_form
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.model.network import (
    Block,
    BlockParameters,
    BlockVariable,
    Coil,
    Connection,
    Contact,
    InputPin,
    InputVariable,
    LeftPowerRail,
    LogicNetwork,
    Node,
    OutputPin,
    OutputVariable,
    Storage,
)
from tests.languages.networks.machine import evaluate, execute, run
from tests.languages.networks.programs import pure_booleans

VARIABLES = "abcde"


def states() -> list[dict[str, bool]]:
    return [dict(zip(VARIABLES, values, strict=True)) for values in product([False, True], repeat=len(VARIABLES))]


@settings(deadline=None)
@given(pure_booleans)
def test_the_normal_form_means_the_same(expression: n.Expression) -> None:
    normal = normal_form(expression)
    assert all(evaluate(normal, state) == evaluate(expression, state) for state in states())


@settings(deadline=None)
@given(pure_booleans, st.booleans())
def test_what_is_drawn_means_the_same(expression: n.Expression, ladder: bool) -> None:
    statement = n.Assignment(n.Name("a"), expression)
    (network,) = (draw_ld if ladder else draw_fbd)([statement]).body.networks
    order = [node.id for node in network.nodes if node.kind != "rightPowerRail"]
    for state in states():
        literals = {"TRUE": True, "FALSE": False, "true": True}
        assert run(network, order, state | literals)["a"] == evaluate(expression, state)


@st.composite
def networks(draw: Any) -> LogicNetwork:
    """Logic with fan-out, written variables that are read again, wired OR, and coils behind coils."""
    nodes: list[Node] = [LeftPowerRail(id=0, outputs=[OutputPin()])]
    ends: list[tuple[int, str | None]] = [(0, None)]
    ladder: list[tuple[int, str | None]] = [(0, None)]
    names = st.sampled_from(VARIABLES)

    def pin(candidates: list[tuple[int, str | None]], most: int) -> InputPin:
        chosen = draw(st.lists(st.sampled_from(candidates), min_size=1, max_size=most, unique=True))
        return InputPin(connections=[Connection(source=source, pin=name) for source, name in chosen])

    for number in range(1, draw(st.integers(3, 14))):
        kind = draw(st.sampled_from(["input", "contact", "contact", "block", "block", "output", "coil"]))
        negated = draw(st.booleans())
        storage = draw(st.sampled_from([Storage.NONE, Storage.NONE, *Storage]))
        if kind == "input":
            nodes.append(InputVariable(id=number, expression=draw(names), negated=negated, output=OutputPin()))
            ends.append((number, None))
        elif kind == "contact":
            nodes.append(
                Contact(id=number, variable=draw(names), negated=negated, input=pin(ladder, 3), output=OutputPin())
            )
            ends.append((number, None))
            ladder.append((number, None))
        elif kind == "block":
            operation = draw(st.sampled_from(["AND", "OR", "XOR", "NOT"]))
            count = 1 if operation == "NOT" else draw(st.integers(2, 3))
            inputs = [
                BlockVariable(name=f"IN{i + 1}", input=pin(ends, 1), negated=draw(st.booleans())) for i in range(count)
            ]
            output = BlockVariable(name="OUT", output=OutputPin(), negated=negated)
            nodes.append(
                Block(id=number, type_name=operation, parameters=BlockParameters(inputs=inputs, outputs=[output]))
            )
            ends.append((number, "OUT"))
            ladder.append((number, "OUT"))
        elif kind == "output":
            nodes.append(
                OutputVariable(id=number, expression=draw(names), negated=negated, storage=storage, input=pin(ends, 1))
            )
        else:
            nodes.append(
                Coil(
                    id=number,
                    variable=draw(names),
                    negated=negated,
                    storage=storage,
                    input=pin(ladder, 3),
                    output=OutputPin(),
                )
            )
            ladder.append((number, None))
    return LogicNetwork(nodes=nodes)


@pytest.mark.slow
@settings(deadline=None)
@given(networks())
def test_what_is_read_does_the_same(network: LogicNetwork) -> None:
    written = [node for node in network.nodes if isinstance(node, OutputVariable | Coil)]
    assume(written)
    read = network_statements([network])
    assert {p.message for p in read.problems if p.severity is Severity.ERROR} <= {"its value leads nowhere"}
    for state in states():
        after = execute(read.tree.statements, state)
        expected = run(network, _order(network), state)
        assert {name: after[name] for name in VARIABLES} == {name: expected[name] for name in VARIABLES}


def _order(network: LogicNetwork) -> list[int]:
    """Execution order of the elements of a file without places: each sink in turn, after what feeds it.

    An input is read when it is first used.
    """
    nodes = {node.id: node for node in network.nodes}
    order: dict[int, None] = {}

    def visit(number: int) -> None:
        node = nodes[number]
        pins = [v.input for v in node.parameters.inputs] if isinstance(node, Block) else [getattr(node, "input", None)]
        wires = [c.source for pin in pins if pin is not None for c in pin.connections if c.source not in order]
        for source in wires:
            if not isinstance(nodes[source], InputVariable):
                visit(source)
        order.update(dict.fromkeys(source for source in wires if isinstance(nodes[source], InputVariable)))
        order[number] = None

    for node in network.nodes:
        if isinstance(node, OutputVariable | Coil):
            visit(node.id)
    return list(order)
