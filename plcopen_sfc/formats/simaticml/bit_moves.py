"""Bits that other tools write on a condition: no box of TIA Portal that has EN writes bits, so logic keeps them."""

from __future__ import annotations

from collections.abc import Collection
from typing import TypeGuard

from plcopen_sfc.model.network import (
    Block,
    BlockParameters,
    BlockVariable,
    Connection,
    InputPin,
    InputVariable,
    LogicNetwork,
    Node,
    OutputPin,
    OutputVariable,
)

BOOLEAN = frozenset({"AND", "OR", "XOR", "NOT", "EQ", "NE", "GT", "GE", "LT", "LE"})
"""Operators whose result is of type BOOL; AND, OR, XOR and NOT of words are other boxes in TIA Portal."""


def keep_bits_by_logic(network: LogicNetwork, bits: Collection[str]) -> None:
    """Write ``bit := EN AND value OR NOT EN AND bit`` for each of the `bits` that a box with EN writes.

    Names of bits are in lower case. What other boxes read stays as it is.
    """
    for box in list(network.nodes):
        if not isinstance(box, Block) or box.type_name.upper() not in BOOLEAN | {"MOVE"}:
            continue
        enable, *values = box.parameters.inputs or [BlockVariable(name="")]
        readers = [node for node in network.nodes if any(_reads(pin, box) for pin in _inputs(node))]
        written = [node for node in readers if _is_bit(node, bits)]
        if enable.name.upper() != "EN" or not _wired(enable) or not readers or len(written) != len(readers):
            continue
        if box.type_name.upper() == "MOVE":
            if len(values) != 1 or not _wired(values[0]):
                continue
            network.nodes.remove(box)
            value = values[0]
        else:
            box.parameters.inputs = values
            value = _wire(box.id, "OUT")
        for node in written:
            node.input = InputPin(connections=[_logic(network, node, enable, value)])


def _is_bit(node: Node, bits: Collection[str]) -> TypeGuard[OutputVariable]:
    """Whether one of the bits is written, by nothing but one wire from an output that is no ENO."""
    if not isinstance(node, OutputVariable) or node.input is None or len(node.input.connections) != 1:
        return False
    of_value = (node.input.connections[0].pin or "").upper() != "ENO"
    return of_value and node.expression.removeprefix("#").strip('"').casefold() in bits


def _reads(pin: InputPin, box: Block) -> bool:
    return any(connection.source == box.id for connection in pin.connections)


def _wired(pin: BlockVariable) -> bool:
    return pin.input is not None and bool(pin.input.connections)


def _inputs(node: Node) -> list[InputPin]:
    """Where wires end at an element."""
    if isinstance(node, Block):
        pins = [variable.input for variable in (*node.parameters.inputs, *node.parameters.in_outs)]
        return [pin for pin in pins if pin is not None]
    pin = getattr(node, "input", None)
    return [pin] if isinstance(pin, InputPin) else []


def _logic(network: LogicNetwork, target: OutputVariable, enable: BlockVariable, value: BlockVariable) -> Connection:
    """Put three boxes in front of `target`, and give the wire from the last one."""
    free = max(node.id for node in network.nodes) + 1
    kept = InputVariable(id=free, expression=target.expression, output=OutputPin())
    passed = _box(free + 1, "AND", [_as_input(enable), _as_input(value)])
    held = _box(free + 2, "AND", [_as_input(enable, inverted=True), _wire(kept.id)])
    either = _box(free + 3, "OR", [_wire(passed.id, "OUT"), _wire(held.id, "OUT")])
    at = network.nodes.index(target)
    network.nodes[at:at] = [kept, passed, held, either]
    return Connection(source=either.id, pin="OUT")


def _as_input(pin: BlockVariable, *, inverted: bool = False) -> BlockVariable:
    copy = pin.model_copy(deep=True)
    copy.negated = pin.negated is not inverted
    return copy


def _wire(source: int, pin: str | None = None) -> BlockVariable:
    return BlockVariable(name="IN", input=InputPin(connections=[Connection(source=source, pin=pin)]))


def _box(number: int, kind: str, inputs: list[BlockVariable]) -> Block:
    for place, pin in enumerate(inputs, 1):
        pin.name = f"IN{place}"
    outputs = [BlockVariable(name="OUT", output=OutputPin())]
    return Block(id=number, type_name=kind, parameters=BlockParameters(inputs=inputs, outputs=outputs))
