"""Reads the elements of FBD and LD bodies, and pins and wires. The writer is `logic_writer`."""

from __future__ import annotations

from collections.abc import Callable

from lxml import etree

from plcopen_sfc.formats.plcopen.reading import (
    Fields,
    ReadContext,
    attributes,
    carry_attributes,
    carry_element,
    read_common,
    read_foreign_data,
    read_point,
    read_text,
    take_choice,
    take_flag,
    take_integer,
    take_number,
    take_required,
)

EDGES = ("none", "rising", "falling")
STORAGES = ("none", "set", "reset")


def read_connection(ctx: ReadContext, element: etree._Element) -> Fields | None:
    """Read ``connection``; None where it does not say to what it leads."""
    left = attributes(element)
    source = take_integer(ctx, element, left, "refLocalId")
    if source is None:
        ctx.error("SFC102", "a connection does not say to which element it leads", element)
        return None
    fields: Fields = {"source": source}
    pin = left.pop("formalParameter", None)
    if pin is not None:
        fields["pin"] = pin
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "position" and (point := read_point(child)) is not None:
            fields.setdefault("points", []).append(point)
        elif local == "addData":
            read_foreign_data(ctx, fields, child, "connection")
        else:
            carry_element(ctx, fields, child)
    if left:
        carry_attributes(fields, left)
    return fields


def read_input(ctx: ReadContext, element: etree._Element) -> Fields:
    """Read ``connectionPointIn``."""
    fields: Fields = {}
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "connection":
            connection = read_connection(ctx, child)
            if connection is None:
                carry_element(ctx, fields, child)
            elif "connections" in fields:
                fields["connections"].append(connection)
            else:
                fields["connections"] = [connection]
        elif local == "relPosition":
            fields["position"] = read_point(child)
        elif local == "expression":
            fields["expression"] = child.text or ""
        elif local == "addData":
            read_foreign_data(ctx, fields, child, "connectionPointIn")
        else:
            carry_element(ctx, fields, child)
    if element.attrib:
        carry_attributes(fields, attributes(element))
    return fields


def read_output(ctx: ReadContext, element: etree._Element) -> Fields:
    """Read ``connectionPointOut`` or ``connectionPointOutAction``."""
    fields: Fields = {}
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "relPosition":
            fields["position"] = read_point(child)
        elif local == "expression":
            fields["expression"] = child.text or ""
        elif local == "addData":
            read_foreign_data(ctx, fields, child, "connectionPointOut")
        else:
            carry_element(ctx, fields, child)
    left = attributes(element)
    if left:
        fields["name"] = left.pop("formalParameter", None)
        if left:
            carry_attributes(fields, left)
    return fields


def read_geometry(ctx: ReadContext, element: etree._Element, left: dict[str, str], fields: Fields) -> None:
    """Take what every drawn element may have besides its id: size and execution order."""
    for name in ("width", "height"):
        if name in left:
            fields[name] = take_number(ctx, element, left, name)
    if "executionOrderId" in left:
        fields["execution_order"] = take_integer(ctx, element, left, "executionOrderId")


def read_node(ctx: ReadContext, element: etree._Element, local: str) -> Fields | None:
    """Read one FBD, LD or common element; None where `local` is none of them. The id is left to the caller."""
    entry = _NODES.get(local)
    if entry is None:
        return None
    kind, read_attributes = entry
    left = attributes(element)
    left.pop("localId", None)
    fields: Fields = {"kind": kind}
    read_attributes(ctx, element, left, fields)
    read_geometry(ctx, element, left, fields)
    for child in element:
        _node_child(ctx, child, local, fields)
    carry_attributes(fields, left)
    return fields


def _node_child(ctx: ReadContext, child: etree._Element, owner: str, fields: Fields) -> None:
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


def read_parameter(ctx: ReadContext, element: etree._Element) -> Fields:
    """Read ``variable`` of a block: a parameter with its pins."""
    left = attributes(element)
    fields: Fields = {"name": take_required(ctx, element, left, "formalParameter")}
    if left:
        _modifiers(ctx, element, left, fields)
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
    carry_attributes(fields, left)
    return fields


def _modifiers(ctx: ReadContext, element: etree._Element, left: dict[str, str], fields: Fields) -> None:
    if take_flag(ctx, element, left, "negated"):
        fields["negated"] = True
    fields["edge"] = take_choice(ctx, element, left, "edge", EDGES) or "none"
    fields["storage"] = take_choice(ctx, element, left, "storage", STORAGES) or "none"


def _expression(ctx: ReadContext, element: etree._Element, left: dict[str, str], fields: Fields) -> None:
    fields["expression"] = ""
    _modifiers(ctx, element, left, fields)


def _in_out(ctx: ReadContext, element: etree._Element, left: dict[str, str], fields: Fields) -> None:
    fields["expression"] = ""
    for side in ("In", "Out"):
        suffix = f"_{side.lower()}"
        if take_flag(ctx, element, left, f"negated{side}"):
            fields[f"negated{suffix}"] = True
        fields[f"edge{suffix}"] = take_choice(ctx, element, left, f"edge{side}", EDGES) or "none"
        fields[f"storage{suffix}"] = take_choice(ctx, element, left, f"storage{side}", STORAGES) or "none"


def _ladder(ctx: ReadContext, element: etree._Element, left: dict[str, str], fields: Fields) -> None:
    fields["variable"] = ""
    _modifiers(ctx, element, left, fields)


def _block(ctx: ReadContext, element: etree._Element, left: dict[str, str], fields: Fields) -> None:
    fields["type_name"] = take_required(ctx, element, left, "typeName")
    fields["instance"] = left.pop("instanceName", None)


def _label(ctx: ReadContext, element: etree._Element, left: dict[str, str], fields: Fields) -> None:
    fields["label"] = take_required(ctx, element, left, "label")


def _name(ctx: ReadContext, element: etree._Element, left: dict[str, str], fields: Fields) -> None:
    fields["name"] = take_required(ctx, element, left, "name")


def _content(_ctx: ReadContext, _element: etree._Element, _left: dict[str, str], fields: Fields) -> None:
    fields["content"] = ""


def _vendor(_ctx: ReadContext, _element: etree._Element, _left: dict[str, str], fields: Fields) -> None:
    fields["alternative_text"] = ""


def _nothing(_ctx: ReadContext, _element: etree._Element, _left: dict[str, str], _fields: Fields) -> None:
    """For elements without attributes of their own."""


_NODES: dict[str, tuple[str, Callable[[ReadContext, etree._Element, dict[str, str], Fields], None]]] = {
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


TAGS = {kind: tag for tag, (kind, _) in _NODES.items()}
"""The element of each kind of node."""


def read_logic_body(ctx: ReadContext, element: etree._Element) -> list[Fields]:
    """Read ``FBD`` or ``LD``: one network, since TC6 does not divide the sheet."""
    network: Fields = {"nodes": []}
    ids = IdKeeper(ctx)
    for child in element:
        local = ctx.tags.get(child.tag)
        node = read_node(ctx, child, local) if local else None
        if node is None:
            carry_element(ctx, network, child)
        else:
            ids.claim(child, node)
            network["nodes"].append(node)
    ids.settle()
    return [network]


class IdKeeper:
    """Gives every element of a body an id of its own: its ``localId``, or a new one where that is taken or missing."""

    def __init__(self, ctx: ReadContext) -> None:
        self.ctx = ctx
        self.used: set[int] = set()
        self.late: list[Fields] = []
        self.last: int | None = None

    def claim(self, element: etree._Element, fields: Fields) -> None:
        """Set ``id`` from the ``localId`` of `element`; remember the object for `settle` where that cannot be."""
        text = (element.get("localId") or "").strip()
        if not (text.isascii() and text.isdigit()):
            self.ctx.error("SFC107", f"<{etree.QName(element).localname}> has no usable localId", element)
            self.late.append(fields)
            return
        local_id = int(text)
        if local_id in self.used:
            self.ctx.error("SFC101", f"localId {local_id} is used twice in one body", element)
            fields["local_id"] = local_id
            self.late.append(fields)
            return
        self.used.add(local_id)
        fields["id"] = local_id

    def new(self) -> int:
        """An id that nothing has. Only after all elements have claimed theirs."""
        # ids are only added, so the next one is never below the last
        number = max(self.used, default=-1) + 1 if self.last is None else self.last + 1
        while number in self.used:
            number += 1
        self.used.add(number)
        self.last = number
        return number

    def settle(self) -> None:
        """Give new ids to the objects that could not get the one they wanted."""
        for fields in self.late:
            fields["id"] = self.new()
