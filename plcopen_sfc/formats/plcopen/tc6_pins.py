"""Pins, wires, sizes and ids of drawn elements of TC6 XML, read and written."""

from __future__ import annotations

from lxml import etree

from plcopen_sfc.formats.plcopen.tc6_reading import (
    Fields,
    Tc6ReadContext,
    keep_attributes,
    keep_element,
    read_foreign_data,
    read_point,
    take_integer,
    take_number,
)
from plcopen_sfc.formats.plcopen.tc6_writing import Tc6WriteContext, add_child, decimal, finish_element, write_point
from plcopen_sfc.formats.xml.extension_data import attributes
from plcopen_sfc.model.network import Connection, InputPin, OutputPin
from plcopen_sfc.whole_numbers import xml_number


def read_connection(ctx: Tc6ReadContext, element: etree._Element) -> Fields | None:
    """Read ``connection``; None where it leads to no element."""
    left = attributes(element)
    source = take_integer(ctx, element, left, "refLocalId")
    if source is None:
        ctx.error("SFC102", "a connection has no id of the element that it leads to", element)
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
            keep_element(ctx, fields, child)
    if left:
        keep_attributes(fields, left)
    return fields


def write_connection(ctx: Tc6WriteContext, parent: etree._Element, connection: Connection) -> None:
    """Write ``connection``."""
    marks = {"refLocalId": str(connection.source), "formalParameter": connection.pin}
    element = add_child(ctx, parent, "connection", marks)
    for point in connection.points:
        write_point(ctx, element, "position", point)
    if connection.extension_data is not None or connection.global_id is not None:
        finish_element(ctx, element, connection, "connection", _CONNECTION, documents=False)


def _read_pin(ctx: Tc6ReadContext, element: etree._Element, local_name: str) -> Fields:
    """Read what is in an input or an output; only an input has connections."""
    fields: Fields = {}
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "connection" and local_name == "connectionPointIn":
            connection = read_connection(ctx, child)
            if connection is None:
                keep_element(ctx, fields, child)
            elif "connections" in fields:
                fields["connections"].append(connection)
            else:
                fields["connections"] = [connection]
        elif local == "relPosition":
            fields["position"] = read_point(child)
        elif local == "expression":
            fields["expression"] = child.text or ""
        elif local == "addData":
            read_foreign_data(ctx, fields, child, local_name)
        else:
            keep_element(ctx, fields, child)
    return fields


def read_input(ctx: Tc6ReadContext, element: etree._Element) -> Fields:
    """Read ``connectionPointIn``."""
    fields = _read_pin(ctx, element, "connectionPointIn")
    if element.attrib:
        keep_attributes(fields, attributes(element))
    return fields


def write_input(ctx: Tc6WriteContext, parent: etree._Element, pin: InputPin) -> None:
    """Write ``connectionPointIn``."""
    element = add_child(ctx, parent, "connectionPointIn")
    if pin.position is not None:
        write_point(ctx, element, "relPosition", pin.position)
    for connection in pin.connections:
        write_connection(ctx, element, connection)
    if pin.expression is not None:
        add_child(ctx, element, "expression").text = pin.expression
    if pin.extension_data is not None or pin.global_id is not None:
        finish_element(ctx, element, pin, "connectionPointIn", _INPUT, documents=False)


def read_output(ctx: Tc6ReadContext, element: etree._Element) -> Fields:
    """Read ``connectionPointOut`` or ``connectionPointOutAction``."""
    fields = _read_pin(ctx, element, "connectionPointOut")
    left = attributes(element)
    if left:
        fields["name"] = left.pop("formalParameter", None)
        if left:
            keep_attributes(fields, left)
    return fields


def write_output(
    ctx: Tc6WriteContext, parent: etree._Element, pin: OutputPin, name: str = "connectionPointOut"
) -> None:
    """Write ``connectionPointOut`` or ``connectionPointOutAction``."""
    element = add_child(ctx, parent, name, {"formalParameter": pin.name})
    if pin.position is not None:
        write_point(ctx, element, "relPosition", pin.position)
    if pin.expression is not None:
        add_child(ctx, element, "expression").text = pin.expression
    if pin.extension_data is not None or pin.global_id is not None:
        finish_element(ctx, element, pin, "connectionPointOut", _OUTPUT, documents=False)


_CONNECTION = frozenset({"source", "pin", "points"})
_INPUT = frozenset({"position", "connections", "expression"})
_OUTPUT = frozenset({"name", "position", "expression"})
"""The fields of wires and pins that are written where they are; few have any other."""


def read_geometry(ctx: Tc6ReadContext, element: etree._Element, left: dict[str, str], fields: Fields) -> None:
    """Take what every drawn element may have besides its id: size and execution order."""
    for name in _SIZES:
        text = left.get(name)
        if text is not None and (value := _WHOLE.get(text)) is not None:  # nearly all sizes
            fields[name] = value
            del left[name]
        elif text is not None:
            fields[name] = take_number(ctx, element, left, name)
    if "executionOrderId" in left:
        fields["execution_order"] = take_integer(ctx, element, left, "executionOrderId")


_SIZES = ("width", "height")
_WHOLE = {str(number): number for number in range(1000)}


def geometry(width: float | None, height: float | None, execution_order: int | None) -> dict[str, str]:
    """Return the attributes for size and execution order."""
    sizes = {"height": height, "width": width}
    order = {} if execution_order is None else {"executionOrderId": str(execution_order)}
    return {name: decimal(size) for name, size in sizes.items() if size is not None} | order


class IdKeeper:
    """Gives every element of a body an id of its own: its ``localId``, or a new one where that is taken or missing."""

    def __init__(self, ctx: Tc6ReadContext) -> None:
        self.ctx = ctx
        self.used: set[int] = set()
        self.late: list[Fields] = []
        self.last: int | None = None

    def claim(self, element: etree._Element, fields: Fields, text: str | None) -> None:
        """Set ``id`` from `text`, the ``localId`` of `element`; remember it for `settle` where that cannot be."""
        local_id = xml_number(text)
        if local_id is None:
            self.ctx.error("SFC107", f"<{etree.QName(element).localname}> has no usable localId", element)
            self.late.append(fields)
            return
        if local_id in self.used:
            self.ctx.error("SFC101", f"localId {local_id} is used twice in one body", element)
            fields["local_id"] = local_id
            self.late.append(fields)
            return
        self.used.add(local_id)
        fields["id"] = local_id

    def new(self) -> int:
        """Return an id that nothing has. Only after all elements have claimed theirs."""
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
