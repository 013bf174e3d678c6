"""Reads ``FlgNet``, the LAD and FBD networks of TIA Portal, into logic elements. The writer is `lad_fbd_networks`.

A wire of ``FlgNet`` leads from its first end to all others; in the model it is at its consumers. Operands have no
element of their own in the model: they are expressions at pins, and the variable of contacts and coils.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from plcopen_sfc.formats.simaticml.element_reader import Fields, NotUnderstoodError, XmlNode, children, local
from plcopen_sfc.formats.simaticml.network_boxes import (
    CALL_MARKS,
    CALLS,
    COILS,
    CONVERT,
    COUNTED,
    INVERTED,
    LISTS,
    PART_NAME,
    RAIL,
    RESULTS,
    converting_block,
    model_pin,
    part_block,
    template_type,
)
from plcopen_sfc.formats.simaticml.network_operands import read_operand, read_path
from plcopen_sfc.formats.xml.extension_data import attributes
from plcopen_sfc.languages.standard_blocks import StandardBlock, standard_block
from plcopen_sfc.whole_numbers import whole_number

_LADDER = frozenset({"Contact", *COILS, *RESULTS})
_PARAMETER_SECTIONS = {"Input": "inputs", "InOut": "in_outs", "Output": "outputs", "Return": "outputs"}


class DamagedError(NotUnderstoodError):
    """A network contradicts itself: something is named that is not there."""


@dataclass(slots=True)
class _Pin:
    """Content of a pin: wires into it, an operand, or nothing. `is_output`: a wire starts there."""

    is_output: bool
    connections: list[Fields] = field(default_factory=list)
    operand: str | None = None


@dataclass(slots=True)
class _Part:
    element: XmlNode
    pins: dict[str, _Pin] = field(default_factory=dict)
    label: str | None = None

    def take(self, name: str) -> _Pin | None:
        """Return a pin, and mark it as read."""
        return self.pins.pop(name, None)


def read_flgnet(element: XmlNode, texts: dict[str, str] | None = None) -> list[Fields]:
    """Return the nodes of a network. Raises `NotUnderstoodError` where the model cannot express all of it.

    `texts` gets the texts of the operands by their numbers.
    """
    found = _Network()
    for child in children(element):
        kind = local(child)
        if kind == "Wires":
            found.wires = children(child)
        elif kind == "Labels":
            found.labels = [_label(one) for one in children(child)]
        elif kind != "Parts":
            raise NotUnderstoodError(f"an element {kind}")
        for one in children(child) if kind == "Parts" else ():
            found.add(one)
    if texts is not None:
        texts |= found.operands
    has_rail = False
    for wire in found.wires:
        has_rail |= _wire(wire, found)
    rail: list[Fields] = [{"kind": "leftPowerRail", "id": RAIL}] if has_rail else []
    if found.operands or found.targets:
        raise DamagedError("no wire leads to an operand")
    free = max(map(int, found.parts), default=0) + 1  # for inverters, which are no parts in the file
    nodes = [_node(number, part) for number, part in found.parts.items()]
    for place, node in reversed(list(enumerate(nodes))):
        if node.pop(INVERTED, False):
            nodes.insert(place, _inverter(free, node))
            free += 1
    return [*found.labels, *rail, *nodes]


@dataclass
class _Network:
    """Elements of a network by their numbers; operands and targets of jumps are taken as wires name them."""

    operands: dict[str, str] = field(default_factory=dict)
    targets: dict[str, str] = field(default_factory=dict)
    parts: dict[str, _Part] = field(default_factory=dict)
    labels: list[Fields] = field(default_factory=list)
    wires: list[XmlNode] = field(default_factory=list)

    def add(self, element: XmlNode) -> None:
        """Add a child of ``Parts``."""
        if local(element) not in ("Access", "Part", "Call"):
            raise NotUnderstoodError(f"an element {local(element)}")
        number = element.get("UId", "")
        known = number in self.operands or number in self.targets or number in self.parts
        if known or whole_number(number) is None:
            raise DamagedError(f"two elements have the number {number!r}, or one has none")
        if local(element) == "Access" and element.get("Scope") == "Label":
            self.targets[number] = _label_name(element)
        elif local(element) == "Access":
            self.operands[number] = read_operand(element)
        else:
            self.parts[number] = _Part(element)


def _label(element: XmlNode) -> Fields:
    """Read ``LabelDeclaration``: the label of a network, to which jumps of the same block lead."""
    number = element.get("UId", "")
    if local(element) != "LabelDeclaration" or len(element.attrib) != 1 or whole_number(number) is None:
        raise NotUnderstoodError("a label")
    return {"kind": "label", "id": int(number), "label": _label_name(element)}


def _label_name(owner: XmlNode) -> str:
    inner = children(owner)
    if len(inner) != 1 or local(inner[0]) != "Label" or set(inner[0].attrib) != {"Name"} or len(inner[0]):
        raise NotUnderstoodError("a label")
    return inner[0].get("Name", "")


def _inverter(number: int, coil: Fields) -> Fields:
    """Return a NOT before a coil whose input is negated; the coil is wired to it."""
    variable = {"name": "IN", "input": coil["input"]}
    coil["input"] = {"connections": [{"source": number, "pin": "OUT"}]}
    return {
        "kind": "block",
        "id": number,
        "type_name": "NOT",
        "parameters": {"inputs": [variable], "outputs": [{"name": "OUT", "output": {}}]},
        "extension_data": {"attributes": {INVERTED: "in"}},
    }


def _wire(wire: XmlNode, net: _Network) -> bool:
    """Note a wire at the pins that it connects. Returns True if it starts at the power rail."""
    parts = net.parts
    ends = [(local(end), end.get("UId", ""), end.get("Name", "")) for end in children(wire)]
    if len(ends) < _TWO or local(wire) != "Wire":
        raise DamagedError("a wire has one end only")
    (kind, number, name), sinks = ends[0], ends[1:]
    if kind == "NameCon":
        source = _pin(parts, number, name, is_output=True)
        for sink, target, pin in sinks:
            if sink == "IdentCon" and source.operand is None:
                source.operand = _taken(net, target)
            elif sink == "NameCon":
                _pin(parts, target, pin).connections.append(_connection(parts, number, name))
            elif sink != "OpenCon":
                raise NotUnderstoodError(f"a wire to {sink}")
        return False
    if any(sink != "NameCon" for sink, _, _ in sinks) or (kind != "Powerrail" and len(sinks) > 1):
        raise NotUnderstoodError("a wire of another form")
    if kind == "IdentCon" and number in net.targets:
        _, target, pin = sinks[0]
        if target not in parts or parts[target].label is not None or pin != JUMP_PIN:
            raise NotUnderstoodError("a label at no jump")
        parts[target].label = net.targets.pop(number)
        return False
    for _, target, pin in sinks:
        found = _pin(parts, target, pin)
        if kind == "Powerrail":
            found.connections.append({"source": RAIL})
        elif kind == "IdentCon" and found.operand is None:
            found.operand = _taken(net, number)
        elif kind != "OpenCon":
            raise NotUnderstoodError(f"a wire from {kind}")
    return kind == "Powerrail"


_TWO = 2
JUMP_PIN = "label"
"""Pin of a jump that has its target."""


def _taken(net: _Network, number: str) -> str:
    if number not in net.operands:
        raise DamagedError(f"a wire leads to the operand {number}, which is not there, or is used twice")
    return net.operands.pop(number)


def _pin(parts: dict[str, _Part], number: str, name: str, *, is_output: bool = False) -> _Pin:
    part = parts.get(number)
    if part is None:
        raise DamagedError(f"a wire leads to the element {number}, which is not there")
    pin = part.pins.get(name)
    if pin is None:
        pin = part.pins[name] = _Pin(is_output)
        return pin
    if pin.is_output != is_output or (is_output and pin.operand is not None):
        raise NotUnderstoodError("a pin that is input and output")
    return pin


def _connection(parts: dict[str, _Part], number: str, pin: str) -> Fields:
    element = parts[number].element
    name = element.get("Name", "")
    if local(element) == "Part" and name in _LADDER:
        if pin != "out":
            raise NotUnderstoodError("an output that a contact or coil does not have")
        return {"source": int(number)}
    return {"source": int(number), "pin": model_pin(known_part(element), pin)}


def known_part(element: XmlNode) -> StandardBlock | None:
    """Return the standard block that a ``Part`` is; None for others and for calls."""
    if local(element) != "Part":
        return None
    name = element.get("Name", "")
    if name != CONVERT:
        return part_block(name)
    types = {child.get("Name", ""): child.text or "" for child in children(element) if local(child) == "TemplateValue"}
    return converting_block(types.get("SrcType", ""), types.get("DestType", ""))


def _node(number: str, part: _Part) -> Fields:
    element = part.element
    if local(element) == "Call":
        return _call(number, part)
    name = element.get("Name", "")
    if not name:
        raise DamagedError("a part has no name")
    if part.label is not None or (name == "Return" and set(part.pins) == {"in"}):
        return _leaving(number, part, name)
    if set(element.attrib) == {"Name", "UId"}:
        if name == "Contact":
            return _ladder(number, part, {"kind": "contact"})
        if name in COILS:
            return _ladder(number, part, {"kind": "coil", "storage": COILS[name]})
        if name in RESULTS:
            return _result(number, part, name)
    return _block(number, part, name)


def _ladder(number: str, part: _Part, fields: Fields) -> Fields:
    operand, inlet = part.take("operand"), part.take("in")
    part.take("out")
    if operand is None or operand.operand is None or operand.connections or part.pins or inlet is None:
        raise NotUnderstoodError("a contact or coil without an operand or input")
    fields.update(id=int(number), variable=operand.operand, input=_input(inlet))
    _negations(part, fields, {"operand": "negated"} | ({"in": INVERTED} if fields["kind"] == "coil" else {}))
    return fields


def _negations(part: _Part, fields: Fields, known: dict[str, str]) -> None:
    """Read the ``Negated`` children of a contact or coil into the fields for that."""
    for child in children(part.element):
        name = known.get(child.get("Name", "")) if local(child) == "Negated" and len(child.attrib) == 1 else None
        if name is None or name in fields:
            raise NotUnderstoodError("a contact or coil with more than a negation")
        fields[name] = True


def _result(number: str, part: _Part, name: str) -> Fields:
    inlet = part.take("in")
    if part.pins or inlet is None:
        raise NotUnderstoodError(f"a {name} without an input, or with other pins")
    fields: Fields = {"kind": "coil", "id": int(number), "variable": name, "input": _input(inlet)}
    _negations(part, fields, {"in": INVERTED})
    return fields


def _leaving(number: str, part: _Part, name: str) -> Fields:
    """Return a jump or return."""
    inlet = part.take("in")
    if name not in ("Jump", "Return") or len(part.element.attrib) > _TWO or len(part.element) or part.pins:
        raise NotUnderstoodError("a jump or return of another form")
    fields: Fields = {"kind": name.lower(), "id": int(number)}
    if inlet is not None:
        fields["input"] = _input(inlet)
    return fields | ({"label": part.label} if name == "Jump" else {})


def _input(pin: _Pin) -> Fields:
    fields: Fields = {}
    if pin.connections:
        fields["connections"] = pin.connections
    if pin.operand is not None:
        fields["expression"] = pin.operand
    return fields


def _block(number: str, part: _Part, name: str) -> Fields:
    block = known_part(part.element)
    left = attributes(part.element)
    del left["Name"], left["UId"]
    fields: Fields = {"kind": "block", "id": int(number), "type_name": block.name if block is not None else name}
    negated: list[str] = []
    for child in children(part.element):
        kind, key = local(child), child.get("Name", "")
        if kind == "TemplateValue" and key not in left and child.get("Type") == template_type(key):
            left[key] = child.text or ""
        elif kind in LISTS and set(child.attrib) == {"Name"}:
            left[kind] = ",".join([*filter(None, left.get(kind, "").split(",")), key])
        elif kind == "Equation" and not child.attrib and kind not in left:
            left[kind] = child.text or ""
        elif kind == "Negated":
            negated.append(key)
        elif kind == "Instance" and "instance" not in fields:
            fields["instance"] = _instance(child)
        else:
            raise NotUnderstoodError(f"a part with {kind}")
    _parameters(fields, part, block, negated)
    if name in COUNTED and left == {"Card": str(len(fields["parameters"]["inputs"]))}:
        left = {}
    if block is None and (taken := standard_block(name)) is not None and taken.name == name:
        left[PART_NAME] = name
    if left:
        fields["extension_data"] = {"attributes": left}
    return fields


def _instance(element: XmlNode) -> str:
    scope = element.get("Scope")
    if scope == "LocalVariable":
        return "#" + read_path(element, globally=False)
    if scope == "GlobalVariable":
        return read_path(element, globally=True)
    raise NotUnderstoodError("an instance of another scope")


def _parameters(fields: Fields, part: _Part, block: StandardBlock | None, negated: list[str]) -> None:
    parameters: Fields = {"inputs": [], "outputs": []}
    for name, pin in part.pins.items():
        variable = _variable(model_pin(block, name), pin, is_output=pin.is_output)
        if name in negated:
            variable["negated"] = True
            negated.remove(name)
        parameters["outputs" if pin.is_output else "inputs"].append(variable)
    if negated:
        raise NotUnderstoodError("a negated pin without a wire")
    fields["parameters"] = parameters


def _variable(name: str, pin: _Pin, *, is_output: bool) -> Fields:
    if is_output:
        return {"name": name, "output": {"expression": pin.operand} if pin.operand is not None else {}}
    return {"name": name, "input": _input(pin)}


def _call(number: str, part: _Part) -> Fields:
    info = next((child for child in children(part.element) if local(child) == "CallInfo"), None)
    if info is None or set(info.attrib) != {"Name", "BlockType"} or info.get("BlockType") not in CALLS:
        raise NotUnderstoodError("a call of another form")
    fields: Fields = {
        "kind": "block",
        "id": int(number),
        "type_name": info.get("Name", ""),
        "call": CALLS[info.get("BlockType", "")],
    }
    negated = {child.get("Name", "") for child in children(part.element) if local(child) == "Negated"}
    if len(negated) + 1 != len(children(part.element)):
        raise NotUnderstoodError("a call of another form")
    parameters: Fields = {"inputs": [], "in_outs": [], "outputs": []}
    for name in ("en", "eno"):
        if pin := part.take(name):
            group = "outputs" if pin.is_output else "inputs"
            parameters[group].append(_variable(name.upper(), pin, is_output=pin.is_output))
    for child in children(info):
        if local(child) == "Instance" and "instance" not in fields:
            fields["instance"] = _instance(child)
        elif local(child) == "Parameter" and set(child.attrib) == {"Name", "Section", "Type"}:
            _parameter(part, child, parameters, negated)
        elif child.get("Name") in CALL_MARKS and child.get("Informative") == "true" and not len(child):
            marks = fields.setdefault("extension_data", {"attributes": {}})["attributes"]
            marks[child.get("Name", "")] = child.text or ""
        elif child.get("Informative") != "true":
            raise NotUnderstoodError("a call with an unknown part")
    if part.pins or negated:
        raise NotUnderstoodError("a pin that the call does not have")
    fields["parameters"] = parameters
    return fields


def _parameter(part: _Part, element: XmlNode, parameters: Fields, negated: set[str]) -> None:
    name, section = element.get("Name", ""), element.get("Section", "")
    group = _PARAMETER_SECTIONS.get(section)
    if group is None or any(child.get("Informative") != "true" for child in children(element)):
        raise NotUnderstoodError("a parameter of another form")
    variable: Fields = {"name": name, "extension_data": {"attributes": {"Type": element.get("Type", "")}}}
    if section == "Return":
        variable["extension_data"]["attributes"]["Section"] = section
    for child in children(element):
        if child.get("Name") == "InterfaceFlags":
            variable["extension_data"]["attributes"]["InterfaceFlags"] = child.text or ""
    if pin := part.take(name):
        variable.update(_variable(name, pin, is_output=pin.is_output))
        if pin.is_output != (group == "outputs"):
            raise NotUnderstoodError("a parameter of another form")
    if name in negated:
        negated.remove(name)
        variable["negated"] = True
    parameters[group].append(variable)
