"""Writes the elements of FBD and LD bodies, and pins and wires. The reader is `logic_reader`."""

from __future__ import annotations

from lxml import etree

from plcopen_sfc.formats.plcopen.writing import (
    WriteContext,
    add_unknown,
    boolean,
    decimal,
    finish,
    sub,
    write_point,
    write_text,
)
from plcopen_sfc.model import network as logic
from plcopen_sfc.model.network import (
    BlockParameters,
    BlockVariable,
    Connection,
    Edge,
    InputPin,
    LogicNetwork,
    Node,
    NodeBase,
    OutputPin,
    Storage,
)


def write_connection(ctx: WriteContext, parent: etree._Element, connection: Connection) -> None:
    """Write ``connection``."""
    attributes = {"refLocalId": str(connection.source)}
    if connection.pin is not None:
        attributes["formalParameter"] = connection.pin
    element = sub(ctx, parent, "connection", attributes)
    for point in connection.points:
        write_point(ctx, element, "position", point)
    finish(ctx, element, connection, "connection", frozenset({"source", "pin", "points"}), documents=False)


def write_input(ctx: WriteContext, parent: etree._Element, pin: InputPin) -> None:
    """Write ``connectionPointIn``."""
    element = sub(ctx, parent, "connectionPointIn")
    if pin.position is not None:
        write_point(ctx, element, "relPosition", pin.position)
    for connection in pin.connections:
        write_connection(ctx, element, connection)
    if pin.expression is not None:
        sub(ctx, element, "expression").text = pin.expression
    native = frozenset({"position", "connections", "expression"})
    finish(ctx, element, pin, "connectionPointIn", native, documents=False)


def write_output(ctx: WriteContext, parent: etree._Element, pin: OutputPin, name: str = "connectionPointOut") -> None:
    """Write ``connectionPointOut`` or ``connectionPointOutAction``."""
    attributes = {"formalParameter": pin.name} if pin.name is not None else {}
    element = sub(ctx, parent, name, attributes)
    if pin.position is not None:
        write_point(ctx, element, "relPosition", pin.position)
    if pin.expression is not None:
        sub(ctx, element, "expression").text = pin.expression
    native = frozenset({"name", "position", "expression"})
    finish(ctx, element, pin, "connectionPointOut", native, documents=False)


_GEOMETRY = frozenset({"kind", "id", "local_id", "position", "width", "height", "execution_order"})
_INPUT = frozenset({"input"})
_OUTPUT = frozenset({"output"})
_MODIFIERS = frozenset({"negated", "edge", "storage"})


def geometry(width: float | None, height: float | None, execution_order: int | None) -> dict[str, str]:
    """The attributes for size and execution order."""
    attributes = {}
    if height is not None:
        attributes["height"] = decimal(height)
    if width is not None:
        attributes["width"] = decimal(width)
    if execution_order is not None:
        attributes["executionOrderId"] = str(execution_order)
    return attributes


def _modifiers(
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


def write_node(ctx: WriteContext, parent: etree._Element, node: Node, *features: str) -> None:
    """Write one FBD, LD or common element. `features`: what it asks of a reader by where it stands."""
    tag, attributes = _head(ctx, node)
    local_id = node.id if node.local_id is None else node.local_id
    order = node.execution_order
    native = _GEOMETRY
    if ctx.version.first_generation and isinstance(node, logic.LeftPowerRail | logic.RightPowerRail):
        order = None
        native = native - {"execution_order"}
    element = sub(ctx, parent, tag, {"localId": str(local_id)} | geometry(node.width, node.height, order))
    for name, value in attributes.items():
        element.set(name, value)
    write_point(ctx, element, "position", node.position)
    native = native | _write_content(ctx, element, node)
    ctx.keep("graphical element", f"{tag} {node.id}", *features)
    finish(ctx, element, node, tag, native)


def is_known(ctx: WriteContext, node: Node) -> bool:
    """Whether the version has this kind of element."""
    return not (ctx.version.first_generation and isinstance(node, logic.VendorElement))


def _head(ctx: WriteContext, node: NodeBase) -> tuple[str, dict[str, str]]:
    stated = ctx.dialect.states_actions
    if isinstance(node, logic.Block):
        attributes = {"typeName": node.type_name}
        if node.instance is not None:
            attributes["instanceName"] = node.instance
        return "block", attributes
    if isinstance(node, logic.InputVariable):
        return "inVariable", _modifiers(node.negated, node.edge, node.storage)
    if isinstance(node, logic.OutputVariable):
        return "outVariable", _modifiers(node.negated, node.edge, node.storage)
    if isinstance(node, logic.InOutVariable):
        return "inOutVariable", _modifiers(node.negated_in, node.edge_in, node.storage_in, "In") | _modifiers(
            node.negated_out, node.edge_out, node.storage_out, "Out"
        )
    if isinstance(node, logic.Contact | logic.Coil):
        return node.kind, _modifiers(node.negated, node.edge, node.storage, stated=stated)
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


def _write_content(ctx: WriteContext, element: etree._Element, node: Node) -> frozenset[str]:
    """Write what stands inside; returns the fields that are written, be it here or as attributes."""
    if isinstance(node, logic.Block):
        _parameters(ctx, element, node.parameters, always=True)
        return frozenset({"type_name", "instance", "parameters"})
    if isinstance(node, logic.VendorElement):
        write_text(ctx, element, "alternativeText", node.alternative_text)
        if node.parameters is not None:
            _parameters(ctx, element, node.parameters, always=False)
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
        sub(ctx, element, "variable").text = node.variable
        return _INPUT | _OUTPUT | _MODIFIERS | {"variable"}
    if isinstance(node, logic.InputVariable | logic.OutputVariable):
        sub(ctx, element, "expression").text = node.expression
        return _INPUT | _OUTPUT | _MODIFIERS | {"expression"}
    if isinstance(node, logic.InOutVariable):
        sub(ctx, element, "expression").text = node.expression
        sides = {f"{name}_{side}" for name in _MODIFIERS for side in ("in", "out")}
        return _INPUT | _OUTPUT | sides | {"expression"}
    return _INPUT | _OUTPUT | {"label", "name"}


def _parameters(ctx: WriteContext, element: etree._Element, parameters: BlockParameters, *, always: bool) -> None:
    for name, group in (
        ("inputVariables", parameters.inputs),
        ("inOutVariables", parameters.in_outs),
        ("outputVariables", parameters.outputs),
    ):
        if group or always:
            holder = sub(ctx, element, name)
            for parameter in group:
                write_parameter(ctx, holder, parameter)


def write_parameter(ctx: WriteContext, parent: etree._Element, parameter: BlockVariable) -> None:
    """Write ``variable`` of a block."""
    attributes = {"formalParameter": parameter.name}
    attributes |= _modifiers(parameter.negated, parameter.edge, parameter.storage)
    if parameter.hidden:
        attributes["hidden"] = "true"
    element = sub(ctx, parent, "variable", attributes)
    if parameter.input is not None:
        write_input(ctx, element, parameter.input)
    if parameter.output is not None:
        write_output(ctx, element, parameter.output)
    finish(ctx, element, parameter, "parameter", _INPUT | _OUTPUT | _MODIFIERS | {"name", "hidden"})


def write_network(ctx: WriteContext, element: etree._Element, network: LogicNetwork) -> None:
    """Write the elements of a network onto the one sheet that a TC6 body has."""
    for node in network.nodes:
        if is_known(ctx, node):
            write_node(ctx, element, node)
    if ctx.takes_markup:
        add_unknown(ctx, element, network.carried)
