"""Elements of FBD and LD bodies of TC6 XML, read and written."""

from __future__ import annotations

from collections.abc import Callable

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
    attributes,
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
    boolean,
    decimal,
    finish_element,
    write_point,
    write_text,
)
from plcopen_sfc.model import network as logic
from plcopen_sfc.model.network import (
    BlockParameters,
    BlockVariable,
    Edge,
    InputPin,
    LogicNetwork,
    Node,
    NodeBase,
    OutputPin,
    Storage,
)
from plcopen_sfc.report import Outcome

EDGES = ("none", "rising", "falling")
STORAGES = ("none", "set", "reset")


def read_node(ctx: Tc6ReadContext, element: etree._Element, local: str) -> Fields | None:
    """Read one FBD, LD or common element; None where `local` is none of them. The id is left to the caller."""
    entry = _NODE_READERS.get(local)
    if entry is None:
        return None
    kind, read_attributes = entry
    left = attributes(element)
    left.pop("localId", None)
    fields: Fields = {"kind": kind}
    read_attributes(ctx, element, left, fields)
    read_geometry(ctx, element, left, fields)
    for child in element:
        _read_node_child(ctx, child, local, fields)
    keep_attributes(fields, left)
    if local == "comment" and fields["kind"] == "vendorElement":  # see `_write_title`
        fields["alternative_text"] = fields.pop("content")
    return fields


def _read_node_child(ctx: Tc6ReadContext, child: etree._Element, owner: str, fields: Fields) -> None:
    """Read a child of the drawn element `owner` into its fields.

    A child that TC6 has for other elements only is kept as extension data, as unknown ones are.
    """
    local = ctx.tags.get(child.tag)
    if local == "position":
        point = read_point(child)
        if point is not None:
            fields["position"] = point
    elif local == "connectionPointIn" and owner == "rightPowerRail":
        fields.setdefault("inputs", []).append(read_input(ctx, child))
    elif local == "connectionPointOut" and owner == "leftPowerRail":
        fields.setdefault("outputs", []).append(read_output(ctx, child))
    elif local == "connectionPointIn" and owner in _WITH_INPUT:
        fields["input"] = read_input(ctx, child)
    elif local == "connectionPointOut" and owner in _WITH_OUTPUT:
        fields["output"] = read_output(ctx, child)
    elif local in ("expression", "variable") and owner in _TEXT_CHILD and _TEXT_CHILD[owner] == local:
        fields[local] = child.text or ""
    elif local in ("content", "alternativeText") and owner in ("comment", "error", "vendorElement"):
        fields["content" if local == "content" else "alternative_text"] = read_text(ctx, child)
    elif local in _PARAMETERS and owner in ("block", "vendorElement"):
        if fields.get("parameters") is None:
            fields["parameters"] = {}
        fields["parameters"][_PARAMETERS[local]] = [
            read_parameter(ctx, v) for v in child if ctx.tags.get(v.tag) == "variable"
        ]
    else:
        read_common(ctx, fields, child, local, owner)


_PARAMETERS = {"inputVariables": "inputs", "inOutVariables": "in_outs", "outputVariables": "outputs"}
_WITH_INPUT = frozenset({"outVariable", "inOutVariable", "contact", "coil", "jump", "return", "connector"})
_WITH_OUTPUT = frozenset({"inVariable", "inOutVariable", "contact", "coil", "continuation"})
_TEXT_CHILD = {
    "inVariable": "expression",
    "outVariable": "expression",
    "inOutVariable": "expression",
    "contact": "variable",
    "coil": "variable",
}


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


def _read_modifiers(ctx: Tc6ReadContext, element: etree._Element, left: dict[str, str], fields: Fields) -> None:
    if take_flag(ctx, element, left, "negated"):
        fields["negated"] = True
    fields["edge"] = take_choice(ctx, element, left, "edge", EDGES) or "none"
    fields["storage"] = take_choice(ctx, element, left, "storage", STORAGES) or "none"


def _expression(ctx: Tc6ReadContext, element: etree._Element, left: dict[str, str], fields: Fields) -> None:
    fields["expression"] = ""
    _read_modifiers(ctx, element, left, fields)


def _in_out(ctx: Tc6ReadContext, element: etree._Element, left: dict[str, str], fields: Fields) -> None:
    fields["expression"] = ""
    for side in ("In", "Out"):
        suffix = f"_{side.lower()}"
        if take_flag(ctx, element, left, f"negated{side}"):
            fields[f"negated{suffix}"] = True
        fields[f"edge{suffix}"] = take_choice(ctx, element, left, f"edge{side}", EDGES) or "none"
        fields[f"storage{suffix}"] = take_choice(ctx, element, left, f"storage{side}", STORAGES) or "none"


def _ladder(ctx: Tc6ReadContext, element: etree._Element, left: dict[str, str], fields: Fields) -> None:
    fields["variable"] = ""
    _read_modifiers(ctx, element, left, fields)


def _block(ctx: Tc6ReadContext, element: etree._Element, left: dict[str, str], fields: Fields) -> None:
    fields["type_name"] = take_required(ctx, element, left, "typeName")
    fields["instance"] = left.pop("instanceName", None)


def _label(ctx: Tc6ReadContext, element: etree._Element, left: dict[str, str], fields: Fields) -> None:
    fields["label"] = take_required(ctx, element, left, "label")


def _name(ctx: Tc6ReadContext, element: etree._Element, left: dict[str, str], fields: Fields) -> None:
    fields["name"] = take_required(ctx, element, left, "name")


def _content(_ctx: Tc6ReadContext, _element: etree._Element, _left: dict[str, str], fields: Fields) -> None:
    fields["content"] = ""


def _vendor(_ctx: Tc6ReadContext, _element: etree._Element, _left: dict[str, str], fields: Fields) -> None:
    fields["alternative_text"] = ""


def _nothing(_ctx: Tc6ReadContext, _element: etree._Element, _left: dict[str, str], _fields: Fields) -> None:
    """For elements without attributes of their own."""


_NODE_READERS: dict[str, tuple[str, Callable[[Tc6ReadContext, etree._Element, dict[str, str], Fields], None]]] = {
    "block": ("block", _block),
    "inVariable": ("input", _expression),
    "outVariable": ("output", _expression),
    "inOutVariable": ("inOut", _in_out),
    "contact": ("contact", _ladder),
    "coil": ("coil", _ladder),
    "leftPowerRail": ("leftPowerRail", _nothing),
    "rightPowerRail": ("rightPowerRail", _nothing),
    "jump": ("jump", _label),
    "label": ("label", _label),
    "return": ("return", _nothing),
    "connector": ("connector", _name),
    "continuation": ("continuation", _name),
    "comment": ("comment", _content),
    "error": ("error", _content),
    "vendorElement": ("vendorElement", _vendor),
}


TAGS = {kind: tag for tag, (kind, _) in _NODE_READERS.items()}
"""The element of each kind of node."""


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


_GEOMETRY = frozenset({"kind", "id", "local_id", "position", "width", "height", "execution_order"})
_INPUT = frozenset({"input"})
_OUTPUT = frozenset({"output"})
_MODIFIERS = frozenset({"negated", "edge", "storage"})


def _written_modifiers(
    negated: bool, edge: Edge, storage: Storage, suffix: str = "", *, stated: bool = False
) -> dict[str, str]:
    attributes = {}
    if negated or stated:
        attributes[f"negated{suffix}"] = boolean(negated)
    if storage is not Storage.NONE or stated:
        attributes[f"storage{suffix}"] = storage.value
    if edge is not Edge.NONE:
        attributes[f"edge{suffix}"] = edge.value
    return attributes


def write_node(ctx: Tc6WriteContext, parent: etree._Element, node: Node, *features: str) -> None:
    """Write one FBD, LD or common element. `features`: what it asks of a reader by its place."""
    if isinstance(node, logic.VendorElement) and _is_title(ctx, node):
        _write_title(ctx, parent, node)
        return
    tag, attributes = _tag_and_attributes(ctx, node)
    local_id = node.id if node.local_id is None else node.local_id
    order = node.execution_order
    native = _GEOMETRY
    if ctx.version.first_generation and isinstance(node, logic.LeftPowerRail | logic.RightPowerRail):
        order = None
        native = native - {"execution_order"}
    element = add_child(ctx, parent, tag, {"localId": str(local_id)} | geometry(node.width, node.height, order))
    for name, value in attributes.items():
        element.set(name, value)
    write_point(ctx, element, "position", node.position)
    native = native | _write_content(ctx, element, node)
    ctx.keep("graphical element", f"{tag} {node.id}", *features)
    finish_element(ctx, element, node, tag, native)


def is_known(ctx: Tc6WriteContext, node: Node) -> bool:
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
    size = {"height": decimal(node.height or 0), "width": decimal(node.width or 0)}
    element = add_child(
        ctx, parent, "comment", {"localId": str(node.id if node.local_id is None else node.local_id)} | size
    )
    write_point(ctx, element, "position", node.position)
    write_text(ctx, element, "content", node.alternative_text)
    ctx.note(Outcome.TRANSLATED, "graphical element", f"comment {node.id}", "the title of a network is a comment")
    native = (_GEOMETRY - {"execution_order", "width", "height"}) | {"alternative_text"}
    finish_element(ctx, element, node, "comment", native, also={"kind": node.kind})


def _tag_and_attributes(ctx: Tc6WriteContext, node: NodeBase) -> tuple[str, dict[str, str]]:
    stated = ctx.dialect.states_actions
    if isinstance(node, logic.Block):
        attributes = {"typeName": node.type_name}
        if node.instance is not None:
            attributes["instanceName"] = node.instance
        return "block", attributes
    if isinstance(node, logic.InputVariable):
        return "inVariable", _written_modifiers(node.negated, node.edge, node.storage)
    if isinstance(node, logic.OutputVariable):
        return "outVariable", _written_modifiers(node.negated, node.edge, node.storage)
    if isinstance(node, logic.InOutVariable):
        return "inOutVariable", _written_modifiers(
            node.negated_in, node.edge_in, node.storage_in, "In"
        ) | _written_modifiers(node.negated_out, node.edge_out, node.storage_out, "Out")
    if isinstance(node, logic.Contact | logic.Coil):
        return node.kind, _written_modifiers(node.negated, node.edge, node.storage, stated=stated)
    if isinstance(node, logic.Jump | logic.Label):
        return node.kind, {"label": node.label}
    if isinstance(node, logic.Connector | logic.Continuation):
        return node.kind, {"name": node.name}
    if isinstance(node, logic.CommentBox | logic.ErrorBox):
        # TC6 requires a size here
        size = {"height": decimal(node.height or 0), "width": decimal(node.width or 0)}
        return node.kind, size
    kind: str = getattr(node, "kind", "")
    return kind, {}


def _write_content(ctx: Tc6WriteContext, element: etree._Element, node: Node) -> frozenset[str]:
    """Write the content; return the fields that are written, be it here or as attributes."""
    if isinstance(node, logic.Block):
        _write_parameters(ctx, element, node.parameters, always=True)
        return frozenset({"type_name", "instance", "parameters"})
    if isinstance(node, logic.VendorElement):
        write_text(ctx, element, "alternativeText", node.alternative_text)
        if node.parameters is not None:
            _write_parameters(ctx, element, node.parameters, always=False)
        return frozenset({"alternative_text", "parameters"})
    if isinstance(node, logic.CommentBox | logic.ErrorBox):
        write_text(ctx, element, "content", node.content)
        return frozenset({"content"})
    if isinstance(node, logic.LeftPowerRail):
        for output in node.outputs:
            write_output(ctx, element, output)
        return frozenset({"outputs"})
    if isinstance(node, logic.RightPowerRail):
        for pin in node.inputs:
            write_input(ctx, element, pin)
        return frozenset({"inputs"})
    pin_in: InputPin | None = getattr(node, "input", None)
    pin_out: OutputPin | None = getattr(node, "output", None)
    if pin_in is not None:
        write_input(ctx, element, pin_in)
    if pin_out is not None:
        write_output(ctx, element, pin_out)
    if isinstance(node, logic.Contact | logic.Coil):
        add_child(ctx, element, "variable").text = node.variable
        return _INPUT | _OUTPUT | _MODIFIERS | {"variable"}
    if isinstance(node, logic.InputVariable | logic.OutputVariable):
        add_child(ctx, element, "expression").text = node.expression
        return _INPUT | _OUTPUT | _MODIFIERS | {"expression"}
    if isinstance(node, logic.InOutVariable):
        add_child(ctx, element, "expression").text = node.expression
        sides = {f"{name}_{side}" for name in _MODIFIERS for side in ("in", "out")}
        return _INPUT | _OUTPUT | sides | {"expression"}
    return _INPUT | _OUTPUT | {"label", "name"}


def _write_parameters(
    ctx: Tc6WriteContext, element: etree._Element, parameters: BlockParameters, *, always: bool
) -> None:
    for name, group in (
        ("inputVariables", parameters.inputs),
        ("inOutVariables", parameters.in_outs),
        ("outputVariables", parameters.outputs),
    ):
        if group or always:
            holder = add_child(ctx, element, name)
            for parameter in group:
                write_parameter(ctx, holder, parameter)


def write_parameter(ctx: Tc6WriteContext, parent: etree._Element, parameter: BlockVariable) -> None:
    """Write ``variable`` of a block."""
    attributes = {"formalParameter": parameter.name}
    attributes |= _written_modifiers(parameter.negated, parameter.edge, parameter.storage)
    if parameter.hidden:
        attributes["hidden"] = "true"
    element = add_child(ctx, parent, "variable", attributes)
    if parameter.input is not None:
        write_input(ctx, element, parameter.input)
    if parameter.output is not None:
        write_output(ctx, element, parameter.output)
    finish_element(ctx, element, parameter, "parameter", _INPUT | _OUTPUT | _MODIFIERS | {"name", "hidden"})


def write_network(ctx: Tc6WriteContext, element: etree._Element, network: LogicNetwork) -> None:
    """Write the elements of a network onto the one sheet that a TC6 body has."""
    for node in network.nodes:
        if is_known(ctx, node):
            write_node(ctx, element, node)
    if ctx.takes_markup:
        add_unknown(ctx, element, network.extension_data)
