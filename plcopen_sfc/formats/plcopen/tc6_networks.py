"""Elements of FBD and LD bodies of TC6 XML, read and written."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

from lxml import etree

from plcopen_sfc.formats.plcopen.tc6_pins import (
    IdKeeper,
    geometry,
    read_geometry,
    read_input,
    read_output,
    write_input,
    write_output,
)
from plcopen_sfc.formats.plcopen.tc6_reading import (
    Fields,
    Tc6ReadContext,
    keep_attributes,
    keep_element,
    read_common,
    read_point,
    read_text,
    take_choice,
    take_flag,
    take_required,
)
from plcopen_sfc.formats.plcopen.tc6_writing import (
    Tc6WriteContext,
    add_child,
    add_unknown,
    finish_element,
    write_point,
    write_text,
)
from plcopen_sfc.formats.xml.extension_data import attributes, boolean
from plcopen_sfc.model import network as logic
from plcopen_sfc.model import network as net
from plcopen_sfc.model.base import Model
from plcopen_sfc.report import Outcome

EDGES = ("none", "rising", "falling")
STORAGES = ("none", "set", "reset")


@dataclass(frozen=True)
class NodeElement:
    """Element of a kind of node.

    `attributes` are its own ones by the fields that have them, `text` is the field and the name of a child with a plain
    text, `content` the field of a child with a formatted one. `sides`: what follows the names of its modifiers. `pins`
    are the fields with its pins; those of the power rails are lists.
    """

    kind: str
    attributes: Mapping[str, str] = field(default_factory=dict)
    text: str = ""
    content: str = ""
    sides: tuple[str, ...] = ()
    pins: frozenset[str] = frozenset()

    @cached_property
    def native(self) -> frozenset[str]:
        """The fields that the element, its attributes and its pins have."""
        modifiers = {f"{name}{_suffix(side)}" for side in self.sides for name in _MODIFIERS}
        return _GEOMETRY | {*self.attributes, self.text, self.content} | modifiers | self.pins


def _suffix(side: str) -> str:
    return f"_{side.lower()}" if side else ""


_GEOMETRY = frozenset({"kind", "id", "local_id", "position", "width", "height", "execution_order"})
_INPUT = frozenset({"input"})
_OUTPUT = frozenset({"output"})
_BOX = frozenset({"parameters"})
_MODIFIERS = frozenset({"negated", "edge", "storage"})
_PARAMETERS = {"inputVariables": "inputs", "inOutVariables": "in_outs", "outputVariables": "outputs"}
_CONTENT = {"content": "content", "alternativeText": "alternative_text"}

_ELEMENTS = {
    "block": NodeElement(
        "block", {"type_name": "typeName", "instance": "instanceName"}, pins=frozenset({"parameters"})
    ),
    "inVariable": NodeElement("input", text="expression", sides=("",), pins=_OUTPUT),
    "outVariable": NodeElement("output", text="expression", sides=("",), pins=_INPUT),
    "inOutVariable": NodeElement("inOut", text="expression", sides=("In", "Out"), pins=_INPUT | _OUTPUT),
    "contact": NodeElement("contact", text="variable", sides=("",), pins=_INPUT | _OUTPUT),
    "coil": NodeElement("coil", text="variable", sides=("",), pins=_INPUT | _OUTPUT),
    "leftPowerRail": NodeElement("leftPowerRail", pins=frozenset({"outputs"})),
    "rightPowerRail": NodeElement("rightPowerRail", pins=frozenset({"inputs"})),
    "jump": NodeElement("jump", {"label": "label"}, pins=_INPUT),
    "label": NodeElement("label", {"label": "label"}),
    "return": NodeElement("return", pins=_INPUT),
    "connector": NodeElement("connector", {"name": "name"}, pins=_INPUT),
    "continuation": NodeElement("continuation", {"name": "name"}, pins=_OUTPUT),
    "comment": NodeElement("comment", content="content"),
    "error": NodeElement("error", content="content"),
    "vendorElement": NodeElement("vendorElement", content="alternative_text", pins=_BOX),
}
TAGS = {shape.kind: tag for tag, shape in _ELEMENTS.items()}
"""The element of each kind of node."""


def read_node(ctx: Tc6ReadContext, element: etree._Element, local: str) -> Fields | None:
    """Read one FBD, LD or common element; None where `local` is none of them. The id is left to the caller."""
    shape = _ELEMENTS.get(local)
    if shape is None:
        return None
    left = attributes(element)
    left.pop("localId", None)
    fields: Fields = {"kind": shape.kind}
    for name, attribute in shape.attributes.items():
        optional = name == "instance"
        fields[name] = left.pop(attribute, None) if optional else take_required(ctx, element, left, attribute)
    for name in (shape.text, shape.content):
        if name:
            fields[name] = ""
    for side in shape.sides:
        _read_modifiers(ctx, element, left, fields, side)
    read_geometry(ctx, element, left, fields)
    for child in element:
        _read_node_child(ctx, child, local, shape, fields)
    keep_attributes(fields, left)
    if local == "comment" and fields["kind"] == "vendorElement":  # see `_write_title`
        fields["alternative_text"] = fields.pop("content")
    return fields


def _read_node_child(
    ctx: Tc6ReadContext, child: etree._Element, owner: str, shape: NodeElement, fields: Fields
) -> None:
    """Read a child of the drawn element `owner` into its fields.

    A child that TC6 has for other elements only is kept as extension data, as unknown ones are.
    """
    local = ctx.tags.get(child.tag)
    if local == "position":
        point = read_point(child)
        if point is not None:
            fields["position"] = point
    elif local == "connectionPointIn" and "inputs" in shape.pins:
        fields.setdefault("inputs", []).append(read_input(ctx, child))
    elif local == "connectionPointOut" and "outputs" in shape.pins:
        fields.setdefault("outputs", []).append(read_output(ctx, child))
    elif local == "connectionPointIn" and "input" in shape.pins:
        fields["input"] = read_input(ctx, child)
    elif local == "connectionPointOut" and "output" in shape.pins:
        fields["output"] = read_output(ctx, child)
    elif local == shape.text and local:
        fields[local] = child.text or ""
    elif local in _CONTENT and shape.content:
        fields[_CONTENT[local]] = read_text(ctx, child)
    elif local in _PARAMETERS and "parameters" in shape.pins:
        if fields.get("parameters") is None:
            fields["parameters"] = {}
        fields["parameters"][_PARAMETERS[local]] = [
            read_parameter(ctx, v) for v in child if ctx.tags.get(v.tag) == "variable"
        ]
    else:
        read_common(ctx, fields, child, local, owner)


def read_parameter(ctx: Tc6ReadContext, element: etree._Element) -> Fields:
    """Read ``variable`` of a block: a parameter with its pins."""
    left = attributes(element)
    fields: Fields = {"name": take_required(ctx, element, left, "formalParameter")}
    if left:
        _read_modifiers(ctx, element, left, fields)
        if take_flag(ctx, element, left, "hidden"):
            fields["hidden"] = True
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "connectionPointIn":
            fields["input"] = read_input(ctx, child)
        elif local == "connectionPointOut":
            fields["output"] = read_output(ctx, child)
        else:
            read_common(ctx, fields, child, local, "parameter")
    keep_attributes(fields, left)
    return fields


def _read_modifiers(
    ctx: Tc6ReadContext, element: etree._Element, left: dict[str, str], fields: Fields, side: str = ""
) -> None:
    suffix = _suffix(side)
    if take_flag(ctx, element, left, f"negated{side}"):
        fields[f"negated{suffix}"] = True
    fields[f"edge{suffix}"] = take_choice(ctx, element, left, f"edge{side}", EDGES) or "none"
    fields[f"storage{suffix}"] = take_choice(ctx, element, left, f"storage{side}", STORAGES) or "none"


def read_logic_body(ctx: Tc6ReadContext, element: etree._Element) -> list[Fields]:
    """Read ``FBD`` or ``LD``: one network, since TC6 does not divide the sheet."""
    network: Fields = {"nodes": []}
    ids = IdKeeper(ctx)
    for child in element:
        local = ctx.tags.get(child.tag)
        node = read_node(ctx, child, local) if local else None
        if node is None:
            keep_element(ctx, network, child)
        else:
            ids.claim(child, node, child.get("localId"))
            network["nodes"].append(node)
    ids.settle()
    return [network]


def _written_modifiers(thing: Model, side: str = "", *, stated: bool = False) -> dict[str, str]:
    """Return the attributes for the modifiers of a node or parameter; `stated`: even where they say nothing."""
    negated, edge, storage = (getattr(thing, f"{name}{_suffix(side)}") for name in ("negated", "edge", "storage"))
    attributes = {}
    if negated or stated:
        attributes[f"negated{side}"] = boolean(negated)
    if storage is not net.Storage.NONE or stated:
        attributes[f"storage{side}"] = storage.value
    if edge is not net.Edge.NONE:
        attributes[f"edge{side}"] = edge.value
    return attributes


def write_node(ctx: Tc6WriteContext, parent: etree._Element, node: net.Node, *features: str) -> None:
    """Write one FBD, LD or common element. `features`: what it asks of a reader by its place."""
    if isinstance(node, logic.VendorElement) and _is_title(ctx, node):
        _write_title(ctx, parent, node)
        return
    tag = TAGS[node.kind]
    shape = _ELEMENTS[tag]
    order = node.execution_order
    native = shape.native
    if ctx.version.first_generation and isinstance(node, logic.LeftPowerRail | logic.RightPowerRail):
        order = None
        native = native - {"execution_order"}
    size = geometry(node.width, node.height, order)
    if isinstance(node, logic.CommentBox | logic.ErrorBox):  # TC6 requires a size here
        size |= geometry(node.width or 0, node.height or 0, None)
    element = add_child(ctx, parent, tag, {"localId": _local_id(node)} | size)
    for name, attribute in shape.attributes.items():
        value = getattr(node, name)
        if value is not None:
            element.set(attribute, value)
    for side in shape.sides:
        stated = ctx.dialect.states_actions and isinstance(node, logic.Contact | logic.Coil)
        for name, value in _written_modifiers(node, side, stated=stated).items():
            element.set(name, value)
    write_point(ctx, element, "position", node.position)
    _write_content(ctx, element, node, shape)
    ctx.keep("graphical element", f"{tag} {node.id}", *features)
    finish_element(ctx, element, node, tag, native)


def _local_id(node: net.Node) -> str:
    return str(node.id if node.local_id is None else node.local_id)


def is_known(ctx: Tc6WriteContext, node: net.Node) -> bool:
    """True if the version has this kind of element, and other tools than CODESYS a use for it."""
    if not isinstance(node, logic.VendorElement) or _is_title(ctx, node):
        return True
    is_setting = node.parameters is None and node.attributes.keys() == {"BoxInputFlagsSupported"}
    return not (ctx.version.first_generation or (is_setting and not ctx.dialect.states_actions))


def _is_title(ctx: Tc6WriteContext, node: logic.VendorElement) -> bool:
    """True for the title of a network, for which only CODESYS has an element: for other tools it is a comment."""
    return node.element_type == "networktitle" and not ctx.dialect.states_actions


def _write_title(ctx: Tc6WriteContext, parent: etree._Element, node: logic.VendorElement) -> None:
    """Write the title of a network as a comment, which comes back as the element that it was."""
    size = geometry(node.width or 0, node.height or 0, None)
    element = add_child(ctx, parent, "comment", {"localId": _local_id(node)} | size)
    write_point(ctx, element, "position", node.position)
    write_text(ctx, element, "content", node.alternative_text)
    ctx.note(Outcome.TRANSLATED, "graphical element", f"comment {node.id}", "the title of a network is a comment")
    native = (_GEOMETRY - {"execution_order", "width", "height"}) | {"alternative_text"}
    finish_element(ctx, element, node, "comment", native, also={"kind": node.kind})


def _write_content(ctx: Tc6WriteContext, element: etree._Element, node: net.Node, shape: NodeElement) -> None:
    for name, field_ in _CONTENT.items():
        if field_ == shape.content:
            write_text(ctx, element, name, getattr(node, field_))
    if isinstance(node, logic.Block | logic.VendorElement) and node.parameters is not None:
        _write_parameters(ctx, element, node.parameters, always=isinstance(node, logic.Block))
    for pin in getattr(node, "inputs", ()) if "inputs" in shape.pins else ():
        write_input(ctx, element, pin)
    for output in getattr(node, "outputs", ()) if "outputs" in shape.pins else ():
        write_output(ctx, element, output)
    pin_in: net.InputPin | None = getattr(node, "input", None)
    pin_out: net.OutputPin | None = getattr(node, "output", None)
    if pin_in is not None:
        write_input(ctx, element, pin_in)
    if pin_out is not None:
        write_output(ctx, element, pin_out)
    if shape.text:
        add_child(ctx, element, shape.text).text = getattr(node, shape.text)


def _write_parameters(
    ctx: Tc6WriteContext, element: etree._Element, parameters: net.BlockParameters, *, always: bool
) -> None:
    for name, group in _PARAMETERS.items():
        variables: list[net.BlockVariable] = getattr(parameters, group)
        if variables or always:
            holder = add_child(ctx, element, name)
            for parameter in variables:
                write_parameter(ctx, holder, parameter)


def write_parameter(ctx: Tc6WriteContext, parent: etree._Element, parameter: net.BlockVariable) -> None:
    """Write ``variable`` of a block."""
    attributes = {"formalParameter": parameter.name}
    attributes |= _written_modifiers(parameter)
    if parameter.hidden:
        attributes["hidden"] = "true"
    element = add_child(ctx, parent, "variable", attributes)
    if parameter.input is not None:
        write_input(ctx, element, parameter.input)
    if parameter.output is not None:
        write_output(ctx, element, parameter.output)
    finish_element(ctx, element, parameter, "parameter", _INPUT | _OUTPUT | _MODIFIERS | {"name", "hidden"})


def write_network(ctx: Tc6WriteContext, element: etree._Element, network: net.LogicNetwork) -> None:
    """Write the elements of a network onto the one sheet that a TC6 body has."""
    for node in network.nodes:
        if is_known(ctx, node):
            write_node(ctx, element, node)
    if ctx.takes_markup:
        add_unknown(ctx, element, network.extension_data)
