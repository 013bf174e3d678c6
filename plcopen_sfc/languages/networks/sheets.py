"""Networks below each other on one sheet, as TC6 has them: it does not divide a body into networks."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from plcopen_sfc.languages.networks.network_graph import apart, wires_of
from plcopen_sfc.languages.networks.pictures import ROW, text_width
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.model.network import (
    CommentBox,
    LeftPowerRail,
    LogicNetwork,
    Node,
    RightPowerRail,
    VendorElement,
)
from plcopen_sfc.model.text import plain

_MARGIN = 20
_GAP = 20
_NETWORK_IDS = 10**10
"""CODESYS counts the elements of each network of FBD on from a multiple of this."""
_RIGHT_RAIL_ID = 2**31 - 2
"""The id of the right power rail in CODESYS; that of the left one is 0, and there are no others in a body."""


def on_one_sheet(networks: Sequence[LogicNetwork], tool: Tool | None = None) -> LogicNetwork:
    """The same networks as one: each below the one before, executed in this order.

    Titles and comments are boxes above them. For CODESYS the ids tell where a network of FBD begins; in LD a comment
    and a title do, and all networks share their power rails.
    """
    copies = [network.model_copy(deep=True) for network in apart(networks)[0]]
    is_ladder = any(isinstance(node, LeftPowerRail) for copy in copies for node in copy.nodes)
    order, top, free = 0, float(_MARGIN), max((node.id for copy in copies for node in copy.nodes), default=0) + 1
    for copy in copies:
        heads = list(_heads(copy, free, titled=tool is Tool.CODESYS and is_ladder))
        free += len(heads)
        for head in heads:
            head.position = (_MARGIN, top)
            top += (head.height or 0) + _GAP / 2
        top = _moved(copy.nodes, top) + _GAP
        for node in sorted(copy.nodes, key=lambda each: each.execution_order or 0):
            if node.execution_order:
                order += 1
                node.execution_order = order
        copy.nodes = [*heads, *copy.nodes]
    if tool is Tool.CODESYS and not is_ladder:
        _number_by_network(copies)
    nodes = [node for copy in copies for node in copy.nodes]
    return LogicNetwork(nodes=_with_common_rails(nodes) if tool is Tool.CODESYS and is_ladder else nodes)


def _heads(network: LogicNetwork, free: int, *, titled: bool) -> Iterator[Node]:
    title, comment = plain(network.title), plain(network.comment)
    text = comment if titled else "\n".join(part for part in (title, comment) if part)
    if text or titled:
        lines = len(text.splitlines())
        yield CommentBox(id=free, content=text, width=text_width(text), height=ROW * lines)
    if titled:
        yield VendorElement(id=free + 1, alternative_text=title, element_type="networktitle")


def _moved(nodes: Sequence[Node], top: float) -> float:
    """Move elements and their wires to below `top`; how far down they reach then."""
    down = top - min((node.position[1] for node in nodes), default=0)
    bottom = top
    for node in nodes:
        node.position = (node.position[0], node.position[1] + down)
        bottom = max(bottom, node.position[1] + (node.height or 0))
        for wire in wires_of(node):
            wire.points = [(x, y + down) for x, y in wire.points]
    return bottom


def _number_by_network(networks: Sequence[LogicNetwork]) -> None:
    new = {
        node.id: _NETWORK_IDS * number + place
        for number, network in enumerate(networks, 1)
        for place, node in enumerate(network.nodes)
    }
    for node in (node for network in networks for node in network.nodes):
        node.id = new[node.id]
        for wire in wires_of(node):
            wire.source = new[wire.source]


def _with_common_rails(nodes: Sequence[Node]) -> list[Node]:
    """The elements of all networks between one left and one right power rail, counted from 0."""
    lefts = [node for node in nodes if isinstance(node, LeftPowerRail)]
    rights = [node for node in nodes if isinstance(node, RightPowerRail)]
    others = [node for node in nodes if not isinstance(node, LeftPowerRail | RightPowerRail)]
    left, *_ = lefts
    bottom = max(node.position[1] + (node.height or 0) for node in nodes)
    for rail in lefts[1:]:
        down = rail.position[1] - left.position[1]
        for pin in rail.outputs:
            pin.position = (pin.position[0], pin.position[1] + down) if pin.position is not None else None
        left.outputs += rail.outputs
    found: list[Node] = [left, *others]
    if rights:
        right = rights[0]
        for other in rights[1:]:
            down = other.position[1] - right.position[1]
            for inlet in other.inputs:
                inlet.position = (inlet.position[0], inlet.position[1] + down) if inlet.position is not None else None
            right.inputs += other.inputs
        right.height = bottom - right.position[1]
        found.append(right)
    left.height = bottom - left.position[1]
    new = {node.id: place for place, node in enumerate(found)} | {rail.id: 0 for rail in lefts}
    if rights:
        new[rights[0].id] = _RIGHT_RAIL_ID
    for node in found:
        node.id = new[node.id]
        for wire in wires_of(node):
            wire.source = new[wire.source]
    return found
