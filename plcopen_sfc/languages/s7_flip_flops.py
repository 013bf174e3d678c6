"""Flip-flops of S7, whose state is the variable at the box, in tools whose flip-flops are instances.

The box becomes logic that assigns the variable: whatever else sets or reads it sees the same as before. SR of IEC
61131-3 is dominated by its set input S1, RS by its reset input R1. The logic carries the box, which comes back as long
as the logic is as it was written.
"""

from __future__ import annotations

import json

from plcopen_sfc.languages.networks.network_graph import MEMORY_PINS, is_memory_pin, wires_of
from plcopen_sfc.model.base import Carried
from plcopen_sfc.model.body import FbdBody, LdBody
from plcopen_sfc.model.network import (
    Block,
    BlockParameters,
    BlockVariable,
    Coil,
    Connection,
    InputPin,
    LogicNetwork,
    Node,
    OutputPin,
    OutputVariable,
)
from plcopen_sfc.model.project import Project
from plcopen_sfc.report import ConversionReport, Outcome

BOX = "flip-flop"
"""Carried attribute of logic in place of a flip-flop: the box, as JSON."""
_PINS = {"RS": ("s", "r1"), "SR": ("s1", "r")}
"""The set and the reset input of each."""
_INNER = {"RS": "OR", "SR": "AND"}
_OUTER = {"RS": "AND", "SR": "OR"}


def put_logic(project: Project, report: ConversionReport) -> None:
    """Write the flip-flops with an operand in bodies of POUs as logic that assigns the operand."""
    for name, pou, body in project.bodies():
        networks = body.networks if isinstance(body, FbdBody | LdBody) else []
        for network in networks:
            for box in [node for node in network.nodes if isinstance(node, Block) and _operand(node)]:
                _replace(network, box, max(node.id for other in networks for node in other.nodes) + 1)
                why = f"AND and OR that assign {_operand(box)}: flip-flops of other tools keep no state in a variable"
                report.add(Outcome.TRANSLATED, "box", pou.report_path_of(name), why)


def put_boxes(project: Project) -> None:
    """Put the flip-flops back that `put_logic` has written otherwise, where the logic was not changed."""
    for _, _, body in project.bodies():
        for network in body.networks if isinstance(body, FbdBody | LdBody) else ():
            for node in list(network.nodes):
                if isinstance(node, Block) and node.carried is not None and BOX in node.carried.attributes:
                    _put_back(network, node, node.carried.attributes.pop(BOX))


def _operand(box: Block) -> str:
    """The variable of a flip-flop of S7; empty for another box."""
    if box.type_name.upper() not in _PINS:
        return ""
    pins = (pin.input for pin in box.parameters.inputs if is_memory_pin(box, pin) and pin.input is not None)
    return next((pin.expression or "" for pin in pins), "")


def _replace(network: LogicNetwork, box: Block, number: int) -> None:
    kind = box.type_name.upper()
    sets, reset = (_pin(box, name) for name in _PINS[kind])
    reset.negated = not reset.negated
    state = BlockVariable(name="", input=InputPin(expression=_operand(box)))
    if kind == "RS":
        inner, outer = _box(number, "OR", sets, state), _box(box.id, "AND", _wired(number), reset)
    else:
        inner, outer = _box(number, "AND", state, reset), _box(box.id, "OR", sets, _wired(number))
    outer.carried = Carried(attributes={BOX: json.dumps(box.model_dump(mode="json", exclude_none=True))})
    wire = InputPin(connections=[Connection(source=box.id, pin="OUT")])
    nodes: list[Node] = [inner, outer, OutputVariable(id=number + 1, expression=_operand(box), input=wire)]
    _rename_wires(network, box.id, "OUT")
    place = network.nodes.index(box)
    network.nodes[place : place + 1] = nodes


def _pin(box: Block, name: str) -> BlockVariable:
    """A copy of a pin of a box; one that is FALSE where the box has none."""
    found = next((pin for pin in box.parameters.inputs if pin.name.casefold() == name), None)
    if found is None or found.input is None:
        return BlockVariable(name="", input=InputPin(expression="FALSE"))
    return found.model_copy(update={"carried": None}, deep=True)


def _wired(source: int) -> BlockVariable:
    return BlockVariable(name="", input=InputPin(connections=[Connection(source=source, pin="OUT")]))


def _box(number: int, operator: str, *pins: BlockVariable) -> Block:
    inputs = [pin.model_copy(update={"name": f"IN{place}"}) for place, pin in enumerate(pins, 1)]
    outputs = [BlockVariable(name="OUT", output=OutputPin())]
    return Block(id=number, type_name=operator, parameters=BlockParameters(inputs=inputs, outputs=outputs))


def _rename_wires(network: LogicNetwork, source: int, pin: str | None) -> None:
    for wire in (wire for node in network.nodes for wire in wires_of(node)):
        if wire.source == source:
            wire.pin = pin


def _assigns(node: Node) -> str | None:
    return node.variable if isinstance(node, Coil) else node.expression if isinstance(node, OutputVariable) else None


def _put_back(network: LogicNetwork, outer: Block, kept: str) -> None:
    try:
        box = Block.model_validate_json(kept)
    except ValueError:
        return
    kind = box.type_name.upper()
    if outer.type_name != _OUTER.get(kind) or len(outer.parameters.inputs) != len(_PINS[kind]):
        return
    wired = outer.parameters.inputs[0 if kind == "RS" else 1].input
    sources = {wire.source for wire in wired.connections} if wired is not None else set()
    inner = next((node for node in network.nodes if isinstance(node, Block) and node.id in sources), None)
    if inner is None or inner.type_name != _INNER[kind] or len(inner.parameters.inputs) != len(_PINS[kind]):
        return
    pins = inner.parameters.inputs, outer.parameters.inputs
    state = pins[0][1 if kind == "RS" else 0].input
    operand = state.expression if state is not None else None
    fed = (node for node in network.nodes if any(wire.source == outer.id for wire in wires_of(node)))
    assigned = next((node for node in fed if operand and _assigns(node) == operand), None)
    if assigned is None:
        return
    now = (pins[0][0], pins[1][1]) if kind == "RS" else (pins[1][0], pins[0][1])
    for name, pin in zip(_PINS[kind], now, strict=True):
        own = next((each for each in box.parameters.inputs if each.name.casefold() == name), None)
        if own is not None:
            own.input, own.negated = pin.input, pin.negated is (name == _PINS[kind][0])
    for own in box.parameters.inputs:
        if own.name.casefold() == MEMORY_PINS[kind]:
            own.input = InputPin(expression=operand)
    box.id = outer.id
    network.nodes = [box if n is outer else n for n in network.nodes if n is not inner and n is not assigned]
    _rename_wires(network, box.id, box.parameters.outputs[0].name if box.parameters.outputs else None)
