"""Networks as no tool should make them: read without an exception, and nothing in them is lost silently."""

from __future__ import annotations

import re
from typing import Any

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from plcopen_sfc.languages.networks.network_reading import network_statements
from plcopen_sfc.languages.st.printing import print_node
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.network import (
    Block,
    BlockCall,
    BlockParameters,
    BlockVariable,
    Coil,
    Connection,
    Connector,
    Contact,
    Continuation,
    Edge,
    InOutVariable,
    InputPin,
    InputVariable,
    Jump,
    Label,
    LeftPowerRail,
    LogicNetwork,
    Node,
    OutputPin,
    OutputVariable,
    Return,
    RightPowerRail,
    Storage,
)
from tests.sweeps import examples

TYPES = ["AND", "OR", "XOR", "NOT", "GT", "ADD", "MOVE", "SEL", "TON", "SR", "R_TRIG", "Mine", "EXECUTE"]
KINDS = [
    *("input", "output", "inOut", "contact", "coil", "block", "block", "left", "right"),
    *("jump", "return", "label", "connector", "continuation"),
]


@st.composite
def damaged(draw: Any) -> LogicNetwork:
    """Elements of every kind with wires from anywhere to anywhere. Each has a name of its own: ``n7``."""
    count = draw(st.integers(1, 9))
    ends = st.tuples(st.integers(0, count + 1), st.sampled_from([None, None, "OUT", "Q", "ENO", "Data"]))

    def pin() -> InputPin:
        wires = [Connection(source=source, pin=name) for source, name in draw(st.lists(ends, max_size=2))]
        return InputPin(connections=wires)

    def node(number: int) -> Node:
        kind = draw(st.sampled_from(KINDS))
        place: dict[str, Any] = {"id": number, "position": (draw(st.integers(0, 2)), draw(st.integers(0, 2)))}
        place["execution_order"] = draw(st.sampled_from([None, None, 0, 1, 2]))
        edge, storage = draw(st.sampled_from([Edge.NONE, *Edge])), draw(st.sampled_from([Storage.NONE, *Storage]))
        modified: dict[str, Any] = {"negated": draw(st.booleans()), "edge": edge, "storage": storage}
        name, out = f"n{number}", OutputPin()
        match kind:
            case "input":
                return InputVariable(**place, **modified, expression=name, output=out)
            case "output":
                return OutputVariable(**place, **modified, expression=name, input=pin())
            case "inOut":
                return InOutVariable(**place, expression=name, input=draw(st.none() | st.builds(pin)), output=out)
            case "contact":
                return Contact(**place, **modified, variable=name, input=pin(), output=out)
            case "coil":
                return Coil(**place, **modified, variable=name, input=pin(), output=out)
            case "left":
                return LeftPowerRail(**place, outputs=[out])
            case "right":
                return RightPowerRail(**place, inputs=[pin()])
            case "jump":
                return Jump(**place, label=name, input=pin())
            case "return":
                return Return(**place, input=pin())
            case "label":
                return Label(**place, label=name)
            case "connector":
                return Connector(**place, name=draw(st.sampled_from("AB")), input=pin())
            case "continuation":
                return Continuation(**place, name=draw(st.sampled_from("AB")), output=out)
        return block(place)

    def block(place: dict[str, Any]) -> Block:
        type_name = draw(st.sampled_from(TYPES))
        inputs = [
            BlockVariable(name=text, input=pin(), negated=draw(st.booleans()))
            for text in draw(
                st.sampled_from([[], ["IN"], ["IN1", "IN2"], ["EN", "IN1", "IN2"], ["S1", "R"], ["G", ""]])
            )
        ]
        in_outs = [BlockVariable(name="Data", input=pin(), output=OutputPin())] if draw(st.booleans()) else []
        outputs = [
            BlockVariable(name=text, output=OutputPin(expression=draw(st.sampled_from([None, None, "atPin"]))))
            for text in draw(st.sampled_from([[], ["OUT"], ["ENO", "OUT"], ["Q", "ET"]]))
        ]
        executes = type_name == "EXECUTE"
        return Block(
            **place,
            type_name=type_name,
            instance=f"n{place['id']}" if type_name in ("TON", "SR", "R_TRIG") and draw(st.booleans()) else None,
            call=BlockCall.EXECUTE if executes else None,
            code=f"n{place['id']} := TRUE;" if executes else None,
            parameters=BlockParameters(inputs=inputs, in_outs=in_outs, outputs=outputs),
        )

    return LogicNetwork(nodes=[node(number) for number in range(count)])


@settings(deadline=None, max_examples=examples(200), suppress_health_check=[HealthCheck.too_slow])
@given(damaged())
def test_nothing_is_lost_silently(network: LogicNetwork) -> None:
    read = network_statements([network], Dialect.CODESYS)
    told = {problem.node for problem in read.problems}
    text = print_node(read.tree)
    words = set(re.findall(r"\w+", text))
    excused: dict[int, bool] = {}

    def is_there(node: Node) -> bool:
        """True if the text names the element, a problem does, or one of all that take its value."""
        if node.id in told or f"n{node.id}" in words or isinstance(node, LeftPowerRail | RightPowerRail):
            return True
        if node.id not in excused:
            excused[node.id] = False
            taking = [other for other in network.nodes if node.id in _sources(other) or _continues(node, other)]
            excused[node.id] = bool(taking) and all(other.id in told or is_there(other) for other in taking)
        return excused[node.id]

    for node in network.nodes:
        if isinstance(node, InputVariable | OutputVariable | Contact | Coil | Jump | Label | Connector | Continuation):
            assert is_there(node), (node, text, read.problems)
        if isinstance(node, Block) and (node.instance or node.code):
            assert f"n{node.id}" in words
    assert text.count("RETURN") == sum(isinstance(node, Return) for node in network.nodes)
    again = network_statements([network], Dialect.CODESYS)
    assert again.tree == read.tree


def _continues(node: Node, other: Node) -> bool:
    return isinstance(node, Connector) and isinstance(other, Continuation) and node.name == other.name


def _sources(node: Node) -> set[int]:
    pins: list[InputPin | None] = [getattr(node, "input", None)]
    if isinstance(node, Block):
        parameters = node.parameters
        pins = [variable.input for variable in (*parameters.inputs, *parameters.in_outs)]
    return {wire.source for pin in pins if pin is not None for wire in pin.connections}
