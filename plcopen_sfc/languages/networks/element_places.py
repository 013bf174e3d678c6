"""Places of the elements of a network and of their wires, and networks below each other on one sheet.

TC6 has sheets: it does not divide a body into networks. Everything flows from left to right. An element that feeds
another is left of it, one feeding element below the other; so the row of each is free up to the fed element, and
wires run in the gap before that. Units are those of TC6 editors: about a pixel.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import count
from typing import NamedTuple

from plcopen_sfc.languages.networks.network_graph import apart, wires_of
from plcopen_sfc.languages.standard_blocks import Tool
from plcopen_sfc.model import network as net
from plcopen_sfc.model.checked import unchecked
from plcopen_sfc.model.text import plain

GRID = 10
ROW = 20
"""Height of what has one line of text, and the distance of the pins of a block."""
FIRST_PIN = 30
"""Distance of the first pin of a block from its top."""
_LETTER = 8


@lru_cache(maxsize=4096)  # names of variables are at many elements
def text_width(text: str, least: int = 40) -> int:
    """Return how wide an element is that shows a text."""
    longest = max((len(line) for line in text.splitlines()), default=0)
    return -(-max(longest * _LETTER + GRID, least) // ROW) * ROW


class WireStart(NamedTuple):
    """Start of a wire: an output and its place.

    `route`: the wire runs from `at` back to its output over these points, the last of which is the place of that.
    """

    source: int
    pin: str | None
    at: net.Point
    route: tuple[net.Point, ...] = ()


class Area(NamedTuple):
    """Placed elements: where wires go on from it, and how far it reaches to the right and down."""

    ends: tuple[WireStart, ...]
    right: float
    bottom: float


class DrawnItem(NamedTuple):
    """Something to be placed: `place` puts its top left corner somewhere.

    `line` is how far below its top its output is. `negated`: whoever takes its value must invert it.
    """

    line: float
    place: Callable[[float, float], Area]
    negated: bool = False


class Slot(NamedTuple):
    """An input of an element that is to be placed: its pin, how far below the top it is, and what feeds it."""

    pin: net.InputPin
    row: float
    item: DrawnItem


def input_pin(row: float) -> net.InputPin:
    """Return an input at the left side of an element, `row` below its top."""
    return unchecked(net.InputPin, connections=[], position=(0.0, float(row)))


def output_pin(width: float, row: float) -> net.OutputPin:
    """Return an output at the right side of an element."""
    return unchecked(net.OutputPin, position=(float(width), float(row)))


def give_place(node: net.Node, left: float, top: float, size: tuple[float, float]) -> None:
    """Set the place and size of an element, unchecked: three checks take a tenth of the time of drawing."""
    vars(node).update(position=(float(left), float(top)), width=float(size[0]), height=float(size[1]))
    node.__pydantic_fields_set__.update(("position", "width", "height"))


def connect(pin: net.InputPin, at: net.Point, ends: Sequence[WireStart], channel: float) -> None:
    """Draw wires from `ends` to the input `pin` at `at`; where they must go up or down they do it at x = `channel`."""
    for end in ends:
        bend = [(channel, at[1]), (channel, end.at[1])] if end.at[1] != at[1] else []
        points = [(float(x), float(y)) for x, y in dict.fromkeys([at, *bend, end.at, *end.route])]
        pin.connections.append(unchecked(net.Connection, source=end.source, pin=end.pin, points=points))


def placed(
    node: net.Node, size: tuple[int, int], slots: Sequence[Slot], outputs: Sequence[WireStart], line: float
) -> DrawnItem:
    """Return the item of an element and of all that feeds it. The places of `outputs` are relative to the element.

    The element is as low as its first input needs to be level with the element that feeds it.
    """
    drop = max(0, slots[0].item.line - slots[0].row) if slots else 0

    def place(x: float, y: float) -> Area:
        areas = []
        top = y + drop
        right, below = x, y
        for slot in slots:
            area = slot.item.place(x, max(below, top + slot.row - slot.item.line))
            areas.append(area)
            right, below = max(right, area.right), area.bottom + GRID
        left = right + GRID * (len(slots) + 1) if slots else x
        give_place(node, left, top, size)
        for number, (slot, area) in enumerate(zip(slots, areas, strict=True), 1):
            connect(slot.pin, (left, top + slot.row), area.ends, right + GRID * number)
        ends = tuple(end._replace(at=(left + end.at[0], top + end.at[1])) for end in outputs)
        return Area(ends, left + size[0], max(top + size[1], below - GRID if slots else 0))

    return DrawnItem(line + drop, place)


@dataclass(slots=True)
class BlockDraft:
    """A block while its pins are collected. Inputs without an item are drawn and lead nowhere.

    `operand`: a pin below all others, and the variable at it.
    """

    type_name: str
    instance: str | None = None
    call: net.BlockCall | None = None
    code: str | None = None
    inputs: list[tuple[str, DrawnItem | None]] = field(default_factory=list)
    outputs: list[str] = field(default_factory=list)
    operand: tuple[str, str] | None = None

    def draw(self, number: int, order: int | None, value: str | None) -> tuple[net.Block, DrawnItem]:
        """Return the block, and it as an item whose value is the output `value`."""
        inputs: list[net.BlockVariable] = []
        slots: list[Slot] = []
        for row, (name, item) in enumerate(self.inputs):
            pin = input_pin(FIRST_PIN + ROW * row)
            negated = item is not None and item.negated
            variable = unchecked(net.BlockVariable, name=name, input=pin, negated=negated)
            inputs.append(variable)
            if item is not None:
                slots.append(Slot(pin, FIRST_PIN + ROW * row, item))
        if self.operand is not None:
            name, text = self.operand
            place = (0, FIRST_PIN + ROW * len(inputs))
            inputs.append(net.BlockVariable(name=name, input=net.InputPin(position=place, expression=text)))
        longest = max((len(name) for name, _ in self.inputs), default=0) + max(map(len, self.outputs), default=0)
        texts = ["-" * (longest + 2), self.type_name, self.instance or "", self.code or ""]
        width = max(60, *map(text_width, texts))
        lines = len((self.code or "").splitlines())
        height = FIRST_PIN + ROW * max(len(inputs), len(self.outputs), lines, 1)
        rows = {name: FIRST_PIN + ROW * row for row, name in enumerate(self.outputs)}
        outputs = [unchecked(net.BlockVariable, name=name, output=output_pin(width, row)) for name, row in rows.items()]
        node = unchecked(
            net.Block,
            id=number,
            type_name=self.type_name,
            instance=self.instance,
            call=self.call,
            code=self.code,
            execution_order=order,
            parameters=unchecked(net.BlockParameters, inputs=inputs, in_outs=[], outputs=outputs),
        )
        ends = [WireStart(number, value, (width, rows[value]))] if value is not None else []
        line = rows[value] if value is not None else FIRST_PIN
        return node, placed(node, (width, height), slots, ends, line)


_MARGIN = 20
_GAP = 20
_NETWORK_IDS = 10**10
"""CODESYS counts the elements of each network of FBD on from a multiple of this."""
_RIGHT_RAIL_ID = 2**31 - 2
"""The id of the right power rail in CODESYS; that of the left one is 0, and there are no others in a body."""


def on_one_sheet(networks: Sequence[net.LogicNetwork], tool: Tool | None = None) -> net.LogicNetwork:
    """Return the same networks as one: each below the one before, executed in this order.

    Titles and comments are boxes above them. For CODESYS the ids tell where a network of FBD begins; in LD a comment
    and a title do, and all networks share their power rails.
    """
    copies = [network.model_copy(deep=True) for network in apart(networks)[0]]
    is_ladder = any(isinstance(node, net.LeftPowerRail) for copy in copies for node in copy.nodes)
    used = [number for copy in copies for node in copy.nodes for number in (node.id, *_starts(node))]
    order, top, free = 0, float(_MARGIN), max(used, default=0) + 1
    for copy in copies:
        heads = list(_heads(copy, free, titled=tool is Tool.CODESYS and is_ladder))
        free += len(heads)
        for head in heads:
            head.position = (_MARGIN, top)
            top += (head.height or 0) + _GAP / 2
        top = _moved(copy.nodes, top) + _GAP
        # each network has counted its execution order from 1; on one sheet the count goes on
        for node in sorted(copy.nodes, key=lambda each: each.execution_order or 0):
            if node.execution_order:
                order += 1
                node.execution_order = order
        copy.nodes = [*heads, *copy.nodes]
    if tool is Tool.CODESYS and not is_ladder:
        _number_by_network(copies)
    nodes = [node for copy in copies for node in copy.nodes]
    return net.LogicNetwork(nodes=_with_common_rails(nodes) if tool is Tool.CODESYS and is_ladder else nodes)


def _starts(node: net.Node) -> Iterator[int]:
    """Yield the ids of the elements at which the wires to an element start."""
    return (wire.source for wire in wires_of(node))


def _heads(network: net.LogicNetwork, free: int, *, titled: bool) -> Iterator[net.Node]:
    title, comment = plain(network.title), plain(network.comment)
    text = comment if titled else "\n".join(part for part in (title, comment) if part)
    if text or titled:
        lines = len(text.splitlines())
        yield net.CommentBox(id=free, content=text, width=text_width(text), height=ROW * lines)
    if titled:
        yield net.VendorElement(id=free + 1, alternative_text=title, element_type="networktitle")


def _moved(nodes: Sequence[net.Node], top: float) -> float:
    """Move elements and their wires to below `top`; how far down they reach then."""
    down = top - min((node.position[1] for node in nodes), default=0)
    bottom = top
    for node in nodes:
        node.position = (node.position[0], node.position[1] + down)
        bottom = max(bottom, node.position[1] + (node.height or 0))
        for wire in wires_of(node):
            wire.points = [(x, y + down) for x, y in wire.points]
    return bottom


def _number_by_network(networks: Sequence[net.LogicNetwork]) -> None:
    new = {
        node.id: _NETWORK_IDS * number + place
        for number, network in enumerate(networks, 1)
        for place, node in enumerate(network.nodes)
    }
    _renumber([node for network in networks for node in network.nodes], new)


def _with_common_rails(nodes: Sequence[net.Node]) -> list[net.Node]:
    """Return the elements of all networks between one left and one right power rail, counted from 0."""
    lefts = [node for node in nodes if isinstance(node, net.LeftPowerRail)]
    rights = [node for node in nodes if isinstance(node, net.RightPowerRail)]
    others = [node for node in nodes if not isinstance(node, net.LeftPowerRail | net.RightPowerRail)]
    left, *_ = lefts
    bottom = max(node.position[1] + (node.height or 0) for node in nodes)
    for rail in lefts[1:]:
        down = rail.position[1] - left.position[1]
        for pin in rail.outputs:
            pin.position = (pin.position[0], pin.position[1] + down) if pin.position is not None else None
        left.outputs += rail.outputs
    found: list[net.Node] = [left, *others]
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
    _renumber(found, new)
    return found


def _renumber(nodes: Sequence[net.Node], new: dict[int, int]) -> None:
    """Give elements their `new` ids. A wire that starts at no element starts at none afterwards."""
    free = count(max(new.values(), default=0) + 1)
    for node in nodes:
        node.id = new[node.id]
        for wire in wires_of(node):
            if wire.source not in new:
                new[wire.source] = next(free)
            wire.source = new[wire.source]
