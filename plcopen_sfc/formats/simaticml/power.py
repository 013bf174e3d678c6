"""How power flows in LAD of TIA Portal: comparisons are contacts, and what is joined by AND stands in series.

Ladders of other tools, and those that are drawn here, have comparisons and AND as boxes, as FBD has them.
"""

from __future__ import annotations

from plcopen_sfc.languages.networks.graph import wires_of
from plcopen_sfc.model.network import (
    Block,
    BlockVariable,
    Connection,
    Contact,
    Edge,
    InputPin,
    InputVariable,
    LeftPowerRail,
    LogicNetwork,
    Storage,
)

_OPPOSITE = {"EQ": "NE", "NE": "EQ", "GT": "LE", "LE": "GT", "LT": "GE", "GE": "LT"}
_POWER = "pre"
"""The pin of a comparison at which power comes in."""


def lacks_power(network: LogicNetwork) -> bool:
    """Whether a ladder has comparisons without power, or AND boxes: TIA Portal draws none."""
    boxes = [node for node in network.nodes if isinstance(node, Block)]
    return any(box.type_name == "AND" or _is_at_no_power(box) for box in boxes)


def _is_at_no_power(box: Block) -> bool:
    return box.type_name in _OPPOSITE and not any(pin.name in (_POWER, "EN") for pin in box.parameters.inputs)


def put_in_series(network: LogicNetwork) -> None:
    """Give comparisons their power, and make series of AND boxes, as far as contacts and comparisons go."""
    rail = next((node for node in network.nodes if isinstance(node, LeftPowerRail)), None)
    if rail is None:
        return
    boxes = [node for node in network.nodes if isinstance(node, Block)]
    for box in boxes:
        if _is_at_no_power(box):
            power = InputPin(connections=[Connection(source=rail.id)])
            box.parameters.inputs.insert(0, BlockVariable(name=_POWER, input=power))
    for box in boxes:
        pins = box.parameters.inputs
        if box.type_name != "AND" or len(pins) < 2 or any(not _is_plain(pin) for pin in pins):
            continue
        parts = [_in_series(network, rail, pin) for pin in pins]
        first, *others = parts
        if all(part is not None for part in others) and (first is not None or _carries_power(network, pins[0])):
            _unfold(network, rail, box, parts)


def _is_plain(pin: BlockVariable) -> bool:
    is_wired = pin.input is not None and bool(pin.input.connections)
    return is_wired and pin.name != "EN" and pin.edge is Edge.NONE and pin.storage is Storage.NONE


def _carries_power(network: LogicNetwork, pin: BlockVariable) -> bool:
    """Whether what comes to a pin comes from contacts and boxes only."""
    wires = pin.input.connections if pin.input is not None else []
    sources = {wire.source for wire in wires}
    return not pin.negated and not any(isinstance(n, InputVariable) for n in network.nodes if n.id in sources)


def _in_series(network: LogicNetwork, rail: LeftPowerRail, pin: BlockVariable) -> InputVariable | Block | None:
    """What is at a pin, if it can stand in a series: a variable, or a comparison at the rail that nothing else asks."""
    wires = pin.input.connections if pin.input is not None else []
    node = next((node for node in network.nodes if len(wires) == 1 and node.id == wires[0].source), None)
    readers = sum(wire.source == node.id for other in network.nodes for wire in wires_of(other)) if node else 0
    if isinstance(node, InputVariable) and not node.negated and readers == 1:
        return node
    if not isinstance(node, Block) or node.type_name not in _OPPOSITE or readers != 1:
        return None
    power = node.parameters.inputs[0]
    at_rail = power.input is not None and [wire.source for wire in power.input.connections] == [rail.id]
    return node if power.name == _POWER and at_rail else None


def _unfold(network: LogicNetwork, rail: LeftPowerRail, box: Block, parts: list[InputVariable | Block | None]) -> None:
    """A series instead of an AND box."""
    power = [Connection(source=rail.id)]
    for pin, part in zip(box.parameters.inputs, parts, strict=True):
        wires = pin.input.connections if pin.input is not None else []
        if isinstance(part, InputVariable):
            index = network.nodes.index(part)
            place = {"id": part.id, "position": part.position, "width": part.width, "height": part.height}
            marks = {"variable": part.expression, "negated": pin.negated, "input": InputPin(connections=power)}
            network.nodes[index] = Contact.model_validate({**place, **marks, "kind": "contact"})
            power = [Connection(source=part.id)]
        elif part is not None:
            part.parameters.inputs[0].input = InputPin(connections=power)
            part.type_name = _OPPOSITE[part.type_name] if pin.negated else part.type_name
            power = wires
        else:
            power = wires
    for node in network.nodes:
        for holder in _pins(node):
            if any(wire.source == box.id for wire in holder.connections):
                kept = [wire for wire in holder.connections if wire.source != box.id]
                holder.connections = [*kept, *(wire.model_copy(deep=True) for wire in power)]
    network.nodes.remove(box)


def _pins(node: object) -> list[InputPin]:
    if isinstance(node, Block):
        pins = [variable.input for variable in (*node.parameters.inputs, *node.parameters.in_outs)]
        return [pin for pin in pins if pin is not None]
    pin = getattr(node, "input", None)
    return [pin] if isinstance(pin, InputPin) else []
