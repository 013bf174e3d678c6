"""Bits that other tools write on a condition: no box of TIA Portal that has EN writes bits, so logic keeps them."""

from __future__ import annotations

from collections.abc import Collection
from typing import TypeGuard

from plcopen_sfc.model.network import (
    Block,
    BlockParameters,
    BlockVariable,
    Coil,
    Connection,
    Contact,
    Edge,
    InputPin,
    InputVariable,
    LogicNetwork,
    Node,
    OutputPin,
    OutputVariable,
    Storage,
)

BOOLEAN = frozenset({"AND", "OR", "XOR", "NOT", "EQ", "NE", "GT", "GE", "LT", "LE"})
"""Operators whose result is of type BOOL; AND, OR, XOR and NOT of words are other boxes in TIA Portal."""


_OF_WORDS = frozenset({"And", "Or", "Xor"})
"""Names of TIA Portal for its boxes for words, which have EN."""
_COMPARISONS = frozenset({"EQ", "NE", "GT", "GE", "LT", "LE"})
_CONSTANTS = {"TRUE": True, "1": True, "FALSE": False, "0": False}


def keep_bits_by_logic(network: LogicNetwork, bits: Collection[str]) -> None:
    """Write ``bit := EN AND value OR NOT EN AND bit`` for each of the `bits` that a box with EN writes.

    Names of bits are in lower case. The inputs of other boxes stay as they are.
    """
    for box, written in _boxes(network, bits):
        enable, *values = box.parameters.inputs
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


def keep_bits_by_contacts(network: LogicNetwork, bits: Collection[str]) -> None:
    """Do the same in a ladder: a branch of contacts behind the condition at EN, and one of the bit behind its NOT.

    Values that contacts cannot express stay as they are, see `writes_bits_on_a_condition`.
    """
    for box, written in _boxes(network, bits):
        enable, *values = box.parameters.inputs
        passed = _branches(network, box, enable, values)
        if passed is None or len(written) != 1 or enable.input is None or enable.negated:
            continue
        target = written[0]
        free = max(node.id for node in network.nodes) + 1
        inverse = _box(free, "NOT", [enable.model_copy(deep=True)])
        wire = InputPin(connections=[Connection(source=free, pin="OUT")])
        kept = Contact(id=free + 1, variable=target.expression, input=wire, output=OutputPin())
        at = network.nodes.index(target)
        network.nodes[at:at] = [inverse, kept]
        target.input = InputPin(connections=[*passed, Connection(source=kept.id)])


def writes_bits_on_a_condition(network: LogicNetwork) -> bool:
    """True if boxes with EN write bits in a ladder: TIA Portal has no such boxes."""
    moves = {node.id for node in network.nodes if isinstance(node, Block) and node.type_name.upper() == "MOVE"}
    for node in network.nodes:
        if isinstance(node, Block) and node.type_name not in _OF_WORDS:
            is_logic = node.type_name.upper() in BOOLEAN - _COMPARISONS
            if is_logic and any(pin.name.upper() == "EN" for pin in node.parameters.inputs):
                return True
        if isinstance(node, Coil | Contact) and node.input is not None:
            wires = node.input.connections
            if any(wire.source in moves and (wire.pin or "").upper() != "ENO" for wire in wires):
                return True
    return False


def _boxes(network: LogicNetwork, bits: Collection[str]) -> list[tuple[Block, list[OutputVariable]]]:
    """Return the boxes with a wired EN that do nothing but write bits, and the bits that each of them writes."""
    found = []
    for box in network.nodes:
        if not isinstance(box, Block) or box.type_name.upper() not in BOOLEAN | {"MOVE"}:
            continue
        readers = [node for node in network.nodes if any(_reads(pin, box) for pin in _inputs(node))]
        written = [node for node in readers if _is_bit(node, bits)]
        enable = next(iter(box.parameters.inputs), None)
        has_enable = enable is not None and enable.name.upper() == "EN" and _wired(enable)
        if has_enable and readers and len(written) == len(readers):
            found.append((box, written))
    return found


def _branches(
    network: LogicNetwork, box: Block, enable: BlockVariable, values: list[BlockVariable]
) -> list[Connection] | None:
    """Contacts instead of `box`: where power comes out if its value is TRUE; None where contacts cannot express it."""
    kind = box.type_name.upper()
    power = enable.input.connections if enable.input is not None else []
    if kind in _COMPARISONS:  # in LAD a comparison is a contact: power comes in at `pre`, and it has no ENO
        box.parameters.inputs = [enable.model_copy(update={"name": "pre"}), *values]
        box.parameters.outputs = [pin for pin in box.parameters.outputs if pin.name.upper() != "ENO"]
        return [Connection(source=box.id, pin="OUT")]
    operands = [_operand(network, value) for value in values]
    plain = [operand for operand in operands if operand is not None]
    if kind == "XOR" or len(plain) != len(operands) or not plain:
        return None
    constant = _CONSTANTS.get(plain[0].expression.upper())
    if constant is not None and kind == "MOVE" and not values[0].negated:  # TRUE: the power itself; FALSE: nothing
        contacts, branches = [], power if constant else []
    elif any(operand.expression.upper() in _CONSTANTS for operand in plain):
        return None
    else:
        contacts = [
            Contact(id=operand.id, variable=operand.expression, negated=value.negated != (kind == "NOT"))
            for operand, value in zip(plain, values, strict=True)
        ]
        branches = [Connection(source=contact.id) for contact in (contacts if kind == "OR" else contacts[-1:])]
        for number, contact in enumerate(contacts):
            before = [Connection(source=contacts[number - 1].id)] if number and kind == "AND" else power
            contact.input = InputPin(connections=[wire.model_copy(deep=True) for wire in before])
            contact.output = OutputPin()
    at = network.nodes.index(box)
    network.nodes[at : at + 1] = contacts
    network.nodes = [node for node in network.nodes if not any(node is operand for operand in plain)]
    return [wire.model_copy(deep=True) for wire in branches]


def _operand(network: LogicNetwork, pin: BlockVariable) -> InputVariable | None:
    """Return the variable at an input, if it is there for that alone."""
    wires = pin.input.connections if pin.input is not None else []
    found = [node for node in network.nodes if any(node.id == wire.source for wire in wires)]
    if len(wires) != 1 or len(found) != 1 or pin.edge is not Edge.NONE or pin.storage is not Storage.NONE:
        return None
    node = found[0]
    readers = sum(
        wire.source == node.id for other in network.nodes for each in _inputs(other) for wire in each.connections
    )
    return node if isinstance(node, InputVariable) and not node.negated and readers == 1 else None


def _is_bit(node: Node, bits: Collection[str]) -> TypeGuard[OutputVariable]:
    """True if one of the bits is written, by nothing but one wire from an output that is no ENO."""
    if not isinstance(node, OutputVariable) or node.input is None or len(node.input.connections) != 1:
        return False
    of_value = (node.input.connections[0].pin or "").upper() != "ENO"
    return of_value and node.expression.removeprefix("#").strip('"').casefold() in bits


def _reads(pin: InputPin, box: Block) -> bool:
    return any(connection.source == box.id for connection in pin.connections)


def _wired(pin: BlockVariable) -> bool:
    return pin.input is not None and bool(pin.input.connections)


def _inputs(node: Node) -> list[InputPin]:
    """Return the pins at which wires end at an element."""
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
