"""Reads ``FlgNet``, the LAD and FBD networks of TIA Portal, into logic elements. The writer is `networks_writer`.

A wire of ``FlgNet`` leads from its first end to all others; in the model it stands at its consumers. Operands have no
element of their own in the model: they are expressions at pins, and the variable of contacts and coils.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from lxml import etree

from plcopen_sfc.formats.simaticml.operands import read_operand, read_path
from plcopen_sfc.formats.simaticml.parts import (
    CALLS,
    COILS,
    COUNTED,
    HINT,
    RAIL,
    RESULTS,
    model_pin,
    part_block,
    template_type,
)
from plcopen_sfc.formats.simaticml.reading import Fields, NotUnderstoodError, attributes, children, local
from plcopen_sfc.languages.standard_blocks import StandardBlock

_PARAMETER_SECTIONS = {"Input": "inputs", "InOut": "in_outs", "Output": "outputs", "Return": "outputs"}


@dataclass
class _Pin:
    """What stands at a pin: wires into it, an operand, or nothing. `is_output`: a wire starts there."""

    is_output: bool
    connections: list[Fields] = field(default_factory=list)
    operand: str | None = None


@dataclass
class _Part:
    element: etree._Element
    pins: dict[str, _Pin] = field(default_factory=dict)

    def take(self, name: str) -> _Pin | None:
        """A pin, which is read with that."""
        return self.pins.pop(name, None)


def read_flgnet(element: etree._Element) -> list[Fields]:
    """The nodes of a network. Raises `NotUnderstoodError` where the model cannot say all of it."""
    operands: dict[str, str] = {}
    parts: dict[str, _Part] = {}
    wires: list[etree._Element] = []
    for child in children(element):
        kind = local(child)
        if kind == "Wires":
            wires = children(child)
        elif kind != "Parts":
            raise NotUnderstoodError(kind)
        for one in children(child) if kind == "Parts" else ():
            number = one.get("UId", "")
            if local(one) == "Access":
                operands[number] = read_operand(one)
            elif local(one) in ("Part", "Call") and number.isdigit():
                parts[number] = _Part(one)
            else:
                raise NotUnderstoodError(local(one))
    has_rail = False
    for wire in wires:
        has_rail |= _wire(wire, operands, parts)
    rail: list[Fields] = [{"kind": "leftPowerRail", "id": RAIL}] if has_rail else []
    if operands:
        raise NotUnderstoodError("an operand at no pin")
    return rail + [_node(number, part) for number, part in parts.items()]


def operand_hints(element: etree._Element) -> dict[str, str]:
    """What the operands of a network are, as far as their texts do not say: carried attributes of the network."""
    hints: dict[str, str] = {}
    for access in element.iter("{*}Access"):
        scope = access.get("Scope", "")
        kind = next((e.text or "" for e in access.iterfind("{*}Constant/{*}ConstantType")), "")
        if scope in ("GlobalConstant", "LocalConstant") or kind:
            hints[HINT + read_operand(access)] = kind or scope
    return hints


def _wire(wire: etree._Element, operands: dict[str, str], parts: dict[str, _Part]) -> bool:
    """Note a wire at the pins that it connects; whether it starts at the power rail."""
    ends = [(local(end), end.get("UId", ""), end.get("Name", "")) for end in children(wire)]
    if len(ends) < _TWO or local(wire) != "Wire":
        raise NotUnderstoodError("wire")
    (kind, number, name), sinks = ends[0], ends[1:]
    if kind == "NameCon":
        source = _pin(parts, number, name, is_output=True)
        for sink, target, pin in sinks:
            if sink == "IdentCon" and source.operand is None:
                source.operand = _taken(operands, target)
            elif sink == "NameCon":
                _pin(parts, target, pin).connections.append(_connection(parts, number, name))
            elif sink != "OpenCon":
                raise NotUnderstoodError(sink)
        return False
    if any(sink != "NameCon" for sink, _, _ in sinks) or (kind != "Powerrail" and len(sinks) > 1):
        raise NotUnderstoodError("wire")
    for _, target, pin in sinks:
        found = _pin(parts, target, pin)
        if kind == "Powerrail":
            found.connections.append({"source": RAIL})
        elif kind == "IdentCon" and found.operand is None:
            found.operand = _taken(operands, number)
        elif kind != "OpenCon":
            raise NotUnderstoodError(kind)
    return kind == "Powerrail"


_TWO = 2


def _taken(operands: dict[str, str], number: str) -> str:
    if number not in operands:
        raise NotUnderstoodError("an operand that is not there, or is used twice")
    return operands.pop(number)


def _pin(parts: dict[str, _Part], number: str, name: str, *, is_output: bool = False) -> _Pin:
    part = parts.get(number)
    if part is None:
        raise NotUnderstoodError("a wire to nothing")
    pin = part.pins.setdefault(name, _Pin(is_output))
    if pin.is_output != is_output or (is_output and pin.operand is not None):
        raise NotUnderstoodError("a pin that is input and output")
    return pin


def _connection(parts: dict[str, _Part], number: str, pin: str) -> Fields:
    element = parts[number].element
    name = element.get("Name", "")
    if local(element) == "Part" and (name in ("Contact", *COILS, *RESULTS)):
        if pin != "out":
            raise NotUnderstoodError(pin)
        return {"source": int(number)}
    return {"source": int(number), "pin": model_pin(known_part(element), pin)}


def known_part(element: etree._Element) -> StandardBlock | None:
    """The standard block that a ``Part`` is; None for others and for calls."""
    return part_block(element.get("Name", "")) if local(element) == "Part" else None


def _node(number: str, part: _Part) -> Fields:
    element = part.element
    if local(element) == "Call":
        return _call(number, part)
    name = element.get("Name", "")
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
    negated = [child.get("Name") for child in children(part.element)]
    if operand is None or operand.operand is None or operand.connections or part.pins or inlet is None:
        raise NotUnderstoodError("contact or coil")
    if negated not in ([], ["operand"]) or any(local(child) != "Negated" for child in children(part.element)):
        raise NotUnderstoodError("contact or coil")
    fields.update(id=int(number), variable=operand.operand, input=_input(inlet))
    if negated:
        fields["negated"] = True
    return fields


def _result(number: str, part: _Part, name: str) -> Fields:
    inlet = part.take("in")
    if part.pins or len(part.element) or inlet is None:
        raise NotUnderstoodError(name)
    return {"kind": "coil", "id": int(number), "variable": name, "input": _input(inlet)}


def _input(pin: _Pin) -> Fields:
    fields: Fields = {}
    if pin.connections:
        fields["connections"] = pin.connections
    if pin.operand is not None:
        fields["expression"] = pin.operand
    return fields


def _block(number: str, part: _Part, name: str) -> Fields:
    block = part_block(name)
    left = attributes(part.element)
    del left["Name"], left["UId"]
    fields: Fields = {"kind": "block", "id": int(number), "type_name": block.name if block is not None else name}
    negated: list[str] = []
    for child in children(part.element):
        kind, key = local(child), child.get("Name", "")
        if kind == "TemplateValue" and key not in left and child.get("Type") == template_type(key):
            left[key] = child.text or ""
        elif kind == "Negated":
            negated.append(key)
        elif kind == "Instance" and "instance" not in fields:
            fields["instance"] = _instance(child)
        else:
            raise NotUnderstoodError(kind)
    _parameters(fields, part, block, negated)
    if name in COUNTED and left == {"Card": str(len(fields["parameters"]["inputs"]))}:
        left = {}
    if left:
        fields["carried"] = {"attributes": left}
    return fields


def _instance(element: etree._Element) -> str:
    scope = element.get("Scope")
    if scope == "LocalVariable":
        return "#" + read_path(element, globally=False)
    if scope == "GlobalVariable":
        return read_path(element, globally=True)
    raise NotUnderstoodError("instance")


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
        raise NotUnderstoodError("call")
    fields: Fields = {
        "kind": "block",
        "id": int(number),
        "type_name": info.get("Name", ""),
        "call": CALLS[info.get("BlockType", "")],
    }
    negated = {child.get("Name", "") for child in children(part.element) if local(child) == "Negated"}
    if len(negated) + 1 != len(children(part.element)):
        raise NotUnderstoodError("call")
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
        elif child.get("Informative") != "true":
            raise NotUnderstoodError("call")
    if part.pins or negated:
        raise NotUnderstoodError("a pin that the call does not have")
    fields["parameters"] = parameters
    return fields


def _parameter(part: _Part, element: etree._Element, parameters: Fields, negated: set[str]) -> None:
    name, section = element.get("Name", ""), element.get("Section", "")
    group = _PARAMETER_SECTIONS.get(section)
    if group is None or any(child.get("Informative") != "true" for child in children(element)):
        raise NotUnderstoodError("parameter")
    variable: Fields = {"name": name, "carried": {"attributes": {"Type": element.get("Type", "")}}}
    if section == "Return":
        variable["carried"]["attributes"]["Section"] = section
    if pin := part.take(name):
        variable.update(_variable(name, pin, is_output=pin.is_output))
        if pin.is_output != (group == "outputs"):
            raise NotUnderstoodError("parameter")
    if name in negated:
        negated.remove(name)
        variable["negated"] = True
    parameters[group].append(variable)
