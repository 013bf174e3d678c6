"""Where the elements of a network stand, and how their wires run.

Everything flows from left to right. What feeds an element stands left of it, one feeding element below the other; so
the row of each is free up to the element that it feeds, and wires run in the gap before that. Units are those of TC6
editors: about a pixel.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from plcopen_sfc.model.network import (
    Block,
    BlockCall,
    BlockParameters,
    BlockVariable,
    Connection,
    InputPin,
    Node,
    OutputPin,
    Point,
)

GRID = 10
ROW = 20
"""Height of what has one line of text, and the distance of the pins of a block."""
FIRST_PIN = 30
"""How far below the top of a block its first pin is."""
_LETTER = 8


def text_width(text: str, least: int = 40) -> int:
    """How wide an element is that shows a text."""
    longest = max((len(line) for line in text.splitlines()), default=0)
    return -(-max(longest * _LETTER + GRID, least) // ROW) * ROW


class WireStart(NamedTuple):
    """Where a wire starts: an output and its place.

    `route`: the wire runs from `at` back to its output over these points, the last of which is the place of that.
    """

    source: int
    pin: str | None
    at: Point
    route: tuple[Point, ...] = ()


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

    pin: InputPin
    row: float
    item: DrawnItem


def connect(pin: InputPin, at: Point, ends: Sequence[WireStart], channel: float) -> None:
    """Draw wires from `ends` to the input `pin` at `at`; where they must go up or down they do it at x = `channel`."""
    for end in ends:
        bend = [(channel, at[1]), (channel, end.at[1])] if end.at[1] != at[1] else []
        points = list(dict.fromkeys([at, *bend, end.at, *end.route]))
        pin.connections.append(Connection(source=end.source, pin=end.pin, points=points))


def placed(
    node: Node, size: tuple[int, int], slots: Sequence[Slot], outputs: Sequence[WireStart], line: float
) -> DrawnItem:
    """The item of an element and of all that feeds it. The places of `outputs` are relative to the element.

    The element stands as low as its first input needs to be on the line of what feeds it.
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
        node.position, node.width, node.height = (left, top), size[0], size[1]
        for number, (slot, area) in enumerate(zip(slots, areas, strict=True), 1):
            connect(slot.pin, (left, top + slot.row), area.ends, right + GRID * number)
        ends = tuple(end._replace(at=(left + end.at[0], top + end.at[1])) for end in outputs)
        return Area(ends, left + size[0], max(top + size[1], below - GRID if slots else 0))

    return DrawnItem(line + drop, place)


@dataclass(slots=True)
class BlockDraft:
    """A block while its pins are collected. Inputs without an item are drawn and lead nowhere.

    `operand`: a pin below all others, and the variable that stands at it.
    """

    type_name: str
    instance: str | None = None
    call: BlockCall | None = None
    code: str | None = None
    inputs: list[tuple[str, DrawnItem | None]] = field(default_factory=list)
    outputs: list[str] = field(default_factory=list)
    operand: tuple[str, str] | None = None

    def draw(self, number: int, order: int | None, value: str | None) -> tuple[Block, DrawnItem]:
        """The block, and it as an item whose value is the output `value`."""
        inputs: list[BlockVariable] = []
        slots: list[Slot] = []
        for row, (name, item) in enumerate(self.inputs):
            pin = InputPin(position=(0, FIRST_PIN + ROW * row))
            variable = BlockVariable(name=name, input=pin, negated=item is not None and item.negated)
            inputs.append(variable)
            if item is not None:
                slots.append(Slot(pin, FIRST_PIN + ROW * row, item))
        if self.operand is not None:
            name, text = self.operand
            place = (0, FIRST_PIN + ROW * len(inputs))
            inputs.append(BlockVariable(name=name, input=InputPin(position=place, expression=text)))
        longest = max((len(name) for name, _ in self.inputs), default=0) + max(map(len, self.outputs), default=0)
        texts = ["-" * (longest + 2), self.type_name, self.instance or "", self.code or ""]
        width = max(60, *map(text_width, texts))
        lines = len((self.code or "").splitlines())
        height = FIRST_PIN + ROW * max(len(inputs), len(self.outputs), lines, 1)
        rows = {name: FIRST_PIN + ROW * row for row, name in enumerate(self.outputs)}
        outputs = [BlockVariable(name=name, output=OutputPin(position=(width, row))) for name, row in rows.items()]
        node = Block(
            id=number,
            type_name=self.type_name,
            instance=self.instance,
            call=self.call,
            code=self.code,
            execution_order=order,
            parameters=BlockParameters(inputs=inputs, outputs=outputs),
        )
        ends = [WireStart(number, value, (width, rows[value]))] if value is not None else []
        line = rows[value] if value is not None else FIRST_PIN
        return node, placed(node, (width, height), slots, ends, line)
