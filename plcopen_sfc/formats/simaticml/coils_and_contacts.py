"""Coils, contacts and boxes where TIA Portal wants them.

Other tools, and code that was drawn here, have output variables; TIA Portal has coils for bits, ``Move`` for the rest.
In LAD of TIA Portal comparisons are contacts, and AND is a series of contacts; ladders of other tools have boxes for
both, as FBD has them.

Where other tools write bits on a condition, logic keeps them: no box of TIA Portal that has EN writes bits.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import TypeGuard

from plcopen_sfc.formats.simaticml.box_types import give_types
from plcopen_sfc.formats.simaticml.declaration_spelling import write_type
from plcopen_sfc.formats.simaticml.network_boxes import RESULTS
from plcopen_sfc.formats.simaticml.network_operands import literal_type, parse_operand
from plcopen_sfc.languages.networks.network_graph import function_box, wires_from, written_by
from plcopen_sfc.languages.s7_types import s7_types
from plcopen_sfc.model import network as net
from plcopen_sfc.model.body import FbdBody, LdBody, networks_of
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import BodyCondition, placed_conditions
from plcopen_sfc.model.text import without_signs

BOOLEAN = frozenset({"AND", "OR", "XOR", "NOT", "EQ", "NE", "GT", "GE", "LT", "LE"})
"""Operators whose result is of type BOOL; AND, OR, XOR and NOT of words are other boxes in TIA Portal."""


_OF_WORDS = frozenset({"And", "Or", "Xor"})
"""Names of TIA Portal for its boxes for words, which have EN."""
_COMPARISONS = frozenset({"EQ", "NE", "GT", "GE", "LT", "LE"})
_CONSTANTS = {"TRUE": True, "1": True, "FALSE": False, "0": False}


def keep_bits_by_logic(network: net.LogicNetwork, bits: Collection[str]) -> None:
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
            node.input = net.InputPin(connections=[_logic(network, node, enable, value)])


def keep_bits_by_contacts(network: net.LogicNetwork, bits: Collection[str]) -> None:
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
        inverse = function_box(free, "NOT", [enable.model_copy(deep=True)])
        wire = net.InputPin(connections=[net.Connection(source=free, pin="OUT")])
        kept = net.Contact(id=free + 1, variable=target.expression, input=wire, output=net.OutputPin())
        at = network.nodes.index(target)
        network.nodes[at:at] = [inverse, kept]
        target.input = net.InputPin(connections=[*passed, net.Connection(source=kept.id)])


def writes_bits_on_a_condition(network: net.LogicNetwork) -> bool:
    """True if boxes with EN write bits in a ladder: TIA Portal has no such boxes."""
    moves = {node.id for node in network.nodes if isinstance(node, net.Block) and node.type_name.upper() == "MOVE"}
    for node in network.nodes:
        if isinstance(node, net.Block) and node.type_name not in _OF_WORDS:
            is_logic = node.type_name.upper() in BOOLEAN - _COMPARISONS
            if is_logic and any(pin.name.upper() == "EN" for pin in node.parameters.inputs):
                return True
        if isinstance(node, net.Coil | net.Contact) and node.input is not None:
            wires = node.input.connections
            if any(wire.source in moves and (wire.pin or "").upper() != "ENO" for wire in wires):
                return True
    return False


def _boxes(network: net.LogicNetwork, bits: Collection[str]) -> list[tuple[net.Block, list[net.OutputVariable]]]:
    """Return the boxes with a wired EN that do nothing but write bits, and the bits that each of them writes."""
    found = []
    for box in network.nodes:
        if not isinstance(box, net.Block) or box.type_name.upper() not in BOOLEAN | {"MOVE"}:
            continue
        readers = [
            node for node in network.nodes if any(c.source == box.id for pin in _inputs(node) for c in pin.connections)
        ]
        written = [node for node in readers if _is_bit(node, bits)]
        enable = next(iter(box.parameters.inputs), None)
        has_enable = enable is not None and enable.name.upper() == "EN" and _wired(enable)
        if has_enable and readers and len(written) == len(readers):
            found.append((box, written))
    return found


def _branches(
    network: net.LogicNetwork, box: net.Block, enable: net.BlockVariable, values: list[net.BlockVariable]
) -> list[net.Connection] | None:
    """Contacts instead of `box`: where power comes out if its value is TRUE; None where contacts cannot express it."""
    kind = box.type_name.upper()
    power = enable.input.connections if enable.input is not None else []
    if kind in _COMPARISONS:  # in LAD a comparison is a contact: power comes in at `pre`, and it has no ENO
        box.parameters.inputs = [enable.model_copy(update={"name": "pre"}), *values]
        box.parameters.outputs = [pin for pin in box.parameters.outputs if pin.name.upper() != "ENO"]
        return [net.Connection(source=box.id, pin="OUT")]
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
            net.Contact(id=operand.id, variable=operand.expression, negated=value.negated != (kind == "NOT"))
            for operand, value in zip(plain, values, strict=True)
        ]
        branches = [net.Connection(source=contact.id) for contact in (contacts if kind == "OR" else contacts[-1:])]
        for number, contact in enumerate(contacts):
            before = [net.Connection(source=contacts[number - 1].id)] if number and kind == "AND" else power
            contact.input = net.InputPin(connections=[wire.model_copy(deep=True) for wire in before])
            contact.output = net.OutputPin()
    at = network.nodes.index(box)
    network.nodes[at : at + 1] = contacts
    network.nodes = [node for node in network.nodes if not any(node is operand for operand in plain)]
    return [wire.model_copy(deep=True) for wire in branches]


def _operand(network: net.LogicNetwork, pin: net.BlockVariable) -> net.InputVariable | None:
    """Return the variable at an input, if it is there for that alone."""
    wires = pin.input.connections if pin.input is not None else []
    found = [node for node in network.nodes if any(node.id == wire.source for wire in wires)]
    if len(wires) != 1 or len(found) != 1 or pin.edge is not net.Edge.NONE or pin.storage is not net.Storage.NONE:
        return None
    node = found[0]
    readers = sum(
        wire.source == node.id for other in network.nodes for each in _inputs(other) for wire in each.connections
    )
    return node if isinstance(node, net.InputVariable) and not node.negated and readers == 1 else None


def _is_bit(node: net.Node, bits: Collection[str]) -> TypeGuard[net.OutputVariable]:
    """True if one of the bits is written, by nothing but one wire from an output that is no ENO."""
    if not isinstance(node, net.OutputVariable) or node.input is None or len(node.input.connections) != 1:
        return False
    of_value = (node.input.connections[0].pin or "").upper() != "ENO"
    return of_value and without_signs(node.expression).casefold() in bits


def _wired(pin: net.BlockVariable) -> bool:
    return pin.input is not None and bool(pin.input.connections)


def _inputs(node: net.Node) -> list[net.InputPin]:
    """Return the pins at which wires end at an element."""
    if isinstance(node, net.Block):
        pins = [variable.input for variable in (*node.parameters.inputs, *node.parameters.in_outs)]
        return [pin for pin in pins if pin is not None]
    pin = getattr(node, "input", None)
    return [pin] if isinstance(pin, net.InputPin) else []


def _logic(
    network: net.LogicNetwork, target: net.OutputVariable, enable: net.BlockVariable, value: net.BlockVariable
) -> net.Connection:
    """Put three boxes in front of `target`, and give the wire from the last one."""
    free = max(node.id for node in network.nodes) + 1
    kept = net.InputVariable(id=free, expression=target.expression, output=net.OutputPin())
    passed = function_box(free + 1, "AND", [_as_input(enable), _as_input(value)])
    held = function_box(free + 2, "AND", [_as_input(enable, inverted=True), _wire(kept.id)])
    either = function_box(free + 3, "OR", [_wire(passed.id, "OUT"), _wire(held.id, "OUT")])
    at = network.nodes.index(target)
    network.nodes[at:at] = [kept, passed, held, either]
    return net.Connection(source=either.id, pin="OUT")


def _as_input(pin: net.BlockVariable, *, inverted: bool = False) -> net.BlockVariable:
    copy = pin.model_copy(deep=True)
    copy.negated = pin.negated is not inverted
    return copy


def _wire(source: int, pin: str | None = None) -> net.BlockVariable:
    return net.BlockVariable(name="IN", input=net.InputPin(connections=[net.Connection(source=source, pin=pin)]))


_OPPOSITE = {"EQ": "NE", "NE": "EQ", "GT": "LE", "LE": "GT", "LT": "GE", "GE": "LT"}
_POWER = "pre"
"""Pin of a comparison at which power comes in."""


def lacks_power(network: net.LogicNetwork) -> bool:
    """True if a ladder has comparisons without power, or AND boxes: TIA Portal draws none."""
    boxes = [node for node in network.nodes if isinstance(node, net.Block)]
    return any(box.type_name == "AND" or _is_at_no_power(box) for box in boxes)


def _is_at_no_power(box: net.Block) -> bool:
    return box.type_name in _OPPOSITE and not any(pin.name in (_POWER, "EN") for pin in box.parameters.inputs)


def put_in_series(network: net.LogicNetwork) -> None:
    """Give comparisons their power, and make series of AND boxes, as far as contacts and comparisons go."""
    rail = next((node for node in network.nodes if isinstance(node, net.LeftPowerRail)), None)
    if rail is None:
        return
    boxes = [node for node in network.nodes if isinstance(node, net.Block)]
    for box in boxes:
        if _is_at_no_power(box):
            power = net.InputPin(connections=[net.Connection(source=rail.id)])
            box.parameters.inputs.insert(0, net.BlockVariable(name=_POWER, input=power))
    for box in boxes:
        pins = box.parameters.inputs
        if box.type_name != "AND" or len(pins) < 2 or any(not _is_plain(pin) for pin in pins):
            continue
        parts = [_in_series(network, rail, pin) for pin in pins]
        first, *others = parts
        if all(part is not None for part in others) and (first is not None or _carries_power(network, pins[0])):
            _unfold(network, rail, box, parts)


def _is_plain(pin: net.BlockVariable) -> bool:
    is_wired = pin.input is not None and bool(pin.input.connections)
    return is_wired and pin.name != "EN" and pin.edge is net.Edge.NONE and pin.storage is net.Storage.NONE


def _carries_power(network: net.LogicNetwork, pin: net.BlockVariable) -> bool:
    """True if a pin gets its value from contacts and boxes only."""
    wires = pin.input.connections if pin.input is not None else []
    sources = {wire.source for wire in wires}
    return not pin.negated and not any(isinstance(n, net.InputVariable) for n in network.nodes if n.id in sources)


def _in_series(
    network: net.LogicNetwork, rail: net.LeftPowerRail, pin: net.BlockVariable
) -> net.InputVariable | net.Block | None:
    """Element at a pin that can be in a series: a variable, or a comparison at the rail without other consumers."""
    wires = pin.input.connections if pin.input is not None else []
    node = next((node for node in network.nodes if len(wires) == 1 and node.id == wires[0].source), None)
    readers = len([*wires_from(network, node.id)]) if node else 0
    if isinstance(node, net.InputVariable) and not node.negated and readers == 1:
        return node
    if not isinstance(node, net.Block) or node.type_name not in _OPPOSITE or readers != 1:
        return None
    power = node.parameters.inputs[0]
    at_rail = power.input is not None and [wire.source for wire in power.input.connections] == [rail.id]
    return node if power.name == _POWER and at_rail else None


def _unfold(
    network: net.LogicNetwork,
    rail: net.LeftPowerRail,
    box: net.Block,
    parts: list[net.InputVariable | net.Block | None],
) -> None:
    """Replace an AND box by a series."""
    power = [net.Connection(source=rail.id)]
    for pin, part in zip(box.parameters.inputs, parts, strict=True):
        wires = pin.input.connections if pin.input is not None else []
        if isinstance(part, net.InputVariable):
            index = network.nodes.index(part)
            place = {"id": part.id, "position": part.position, "width": part.width, "height": part.height}
            marks = {"variable": part.expression, "negated": pin.negated, "input": net.InputPin(connections=power)}
            network.nodes[index] = net.Contact.model_validate({**place, **marks, "kind": "contact"})
            power = [net.Connection(source=part.id)]
        elif part is not None:
            part.parameters.inputs[0].input = net.InputPin(connections=power)
            part.type_name = _OPPOSITE[part.type_name] if pin.negated else part.type_name
            power = wires
        else:
            power = wires
    for node in network.nodes:
        for holder in _inputs(node):
            if any(wire.source == box.id for wire in holder.connections):
                kept = [wire for wire in holder.connections if wire.source != box.id]
                holder.connections = [*kept, *(wire.model_copy(deep=True) for wire in power)]
    network.nodes.remove(box)


_BITS = BOOLEAN | {"R_TRIG", "F_TRIG"}
"""Boxes whose result is a bit. Edges with an instance of their own are others."""
_CALLS = (net.BlockCall.FUNCTION, net.BlockCall.FUNCTION_BLOCK)


def types_of(project: Project, pou: Pou) -> dict[str, str]:
    """Return the types of the variables of a block (``#name``) and of the tags (``"name"``), as TIA Portal spells them.

    Names are in lower case.
    """
    tags = {f'"{tag.name.lower()}"': tag.type for table in project.tag_tables for tag in table.tags}
    types = s7_types(project)
    return tags | {f"#{variable.name.lower()}": write_type(types.type(variable.type)) for variable in pou.variables()}


def put_coils(project: Project) -> None:
    """Make coils of the output variables that other tools write instead.

    The results of conditions (``TrCoil``, ``IlCoil``, ``SvCoil``) are no variables, whatever a translation of names has
    made of them.
    """
    for chart in project.charts():
        for _, condition in placed_conditions(chart.chart):
            if isinstance(condition, BodyCondition):
                for network in networks_of(condition.body):
                    network.nodes = [_result(node) for node in network.nodes]
    blocks = {pou.name.casefold() for pou in project.pous}
    for _, pou, body in project.bodies():
        if isinstance(body, FbdBody | LdBody):
            types = types_of(project, pou)
            bits = {_plain(name) for name, kind in types.items() if name.startswith("#") and kind == "Bool"}
            keep_bits = keep_bits_by_logic if isinstance(body, FbdBody) else keep_bits_by_contacts
            for network in body.networks:
                give_types(network, types)  # boxes of words are no bits then; `write_network` tells what has no type
                keep_bits(network, bits)
                put_assignments(network, types, blocks)
                if isinstance(body, LdBody):
                    put_in_series(network)


def _result(node: net.Node) -> net.Node:
    name = without_signs(written_by(node) or "")
    return _coil(node, name) if name in RESULTS else node


def put_assignments(network: net.LogicNetwork, types: Mapping[str, str], blocks: Iterable[str] = ()) -> None:
    """Make coils and ``Move`` boxes of the output variables of a network; `types` are those of `types_of`.

    The output of a box that calls one of the `blocks` of the project (lower case), or from any other box that does
    not give a bit, stays at its pin.
    """
    if not any(isinstance(node, net.OutputVariable) for node in network.nodes):
        return
    own = frozenset(blocks)
    sources = {node.id: node for node in network.nodes}
    for index, node in enumerate(network.nodes):
        if not isinstance(node, net.OutputVariable) or node.input is None or not node.input.connections:
            continue
        givers = [sources.get(connection.source) for connection in node.input.connections]
        if _takes_bit(node, givers, types, own):
            network.nodes[index] = _coil(node, node.expression)
        elif (
            len(givers) == 1
            and isinstance(givers[0], net.InputVariable)
            and not node.negated
            and _is_value(node, givers[0], types)
        ):
            network.nodes[index] = _move(node)
    _put_contacts(network)


def _put_contacts(network: net.LogicNetwork) -> None:
    """Contacts of variables at coils, in a network with a power rail: LAD has no operands there."""
    rail = next((node for node in network.nodes if isinstance(node, net.LeftPowerRail)), None)
    coils = [node.input for node in network.nodes if isinstance(node, net.Coil) and node.input is not None]
    fed = {connection.source for pin in coils for connection in pin.connections}
    for index, node in enumerate(network.nodes):
        if rail is not None and isinstance(node, net.InputVariable) and node.id in fed:
            shared = {
                field: getattr(node, field)
                for field in net.InputVariable.model_fields
                if field in net.Contact.model_fields
            }
            power = net.InputPin(connections=[net.Connection(source=rail.id)])
            marks = {"kind": "contact", "variable": node.expression, "input": power}
            network.nodes[index] = net.Contact.model_validate(shared | marks)


def _takes_bit(
    node: net.OutputVariable, givers: list[net.Node | None], types: Mapping[str, str], blocks: frozenset[str]
) -> bool:
    if node.storage is not net.Storage.NONE:
        return True  # only bits are set and reset
    if all(_gives_bit(giver, types) for giver in givers):
        return True
    called = any(isinstance(g, net.Block) and (g.call in _CALLS or g.type_name.casefold() in blocks) for g in givers)
    return _type(node.expression, types) == "Bool" and not called


def _gives_bit(giver: net.Node | None, types: Mapping[str, str]) -> bool:
    if isinstance(giver, net.Block):
        return giver.type_name.upper() in _BITS and giver.type_name not in _OF_WORDS
    return isinstance(giver, net.InputVariable) and _type(giver.expression, types) == "Bool"


def _is_value(node: net.OutputVariable, giver: net.InputVariable, types: Mapping[str, str]) -> bool:
    """True if something else than a bit is assigned; False if the type is not known."""
    return bool(_type(node.expression, types) or _type(giver.expression, types))


def _type(text: str, types: Mapping[str, str]) -> str:
    """Return the type of an operand; empty where it is not known."""
    name = f"#{_plain(text)}" if text.startswith("#") else text.lower()
    known = types.get(name) or types.get(f"#{name}", "")
    if known or text.startswith(("#", '"', "%")) or parse_operand(text) is None:
        return known
    return "Bool" if text.upper() in ("TRUE", "FALSE") else literal_type(text, "")


def _plain(text: str) -> str:
    return without_signs(text).lower()


def _coil(node: net.Node, variable: str) -> net.Node:
    shared = {
        field: getattr(node, field) for field in net.OutputVariable.model_fields if field in net.Coil.model_fields
    }
    return net.Coil.model_validate({**shared, "kind": "coil", "variable": variable})


def _move(node: net.OutputVariable) -> net.Node:
    shared = {
        field: getattr(node, field) for field in net.OutputVariable.model_fields if field in net.Block.model_fields
    }
    parameters = net.BlockParameters(
        inputs=[net.BlockVariable(name="IN", input=node.input)],
        outputs=[net.BlockVariable(name="OUT", output=net.OutputPin(expression=node.expression))],
    )
    return net.Block.model_validate({**shared, "kind": "block", "type_name": "MOVE", "parameters": parameters})
