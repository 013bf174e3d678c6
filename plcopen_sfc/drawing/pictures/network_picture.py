"""Pictures of networks: FBD as blocks with pins, LD as contacts and coils between rails.

The order from above to below is that of the file: of its positions if it has any, else of its elements. An operand of
one block is written at its pin. A signal that comes back to where it was is written at the pin, with a link
to its source, instead of a wire around everything.

The layout is layered. Signals run from left to right: a symbol is in the column behind the last of those that feed it,
one that nothing feeds directly before the first that it feeds. A wire that passes a column has a place of its own
there, so no wire runs through a symbol. Upright parts of wires lie between the columns, each on a track of its own
where they would touch. Two wires of different sources never have parts on each other; where the network needs it they
cross.
"""

from __future__ import annotations

import re
from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from plcopen_sfc.drawing.pictures.chart_picture import chosen_theme
from plcopen_sfc.drawing.pictures.svg_canvas import Canvas, Theme, text_width, widest, wrap
from plcopen_sfc.drawing.wording import Told, english
from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.model import network as n
from plcopen_sfc.model.body import FbdBody, LdBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.text import plain

_GAP = 14
_LANE = 12
_TRACK = 8
_CHANNEL = 12
_NUDGE = 5
"""Distance by which a symbol moves down whose pin would be level with a wire of another source."""


class Wire(NamedTuple):
    """A wire from the output `pin` of box `source` to the input `place` of box `target`: indices."""

    source: int
    pin: int
    target: int
    place: int


@dataclass(slots=True)
class Box:
    """Box to be placed: its size and the levels of its pins. `first` and `last` put it into the outermost columns."""

    width: int
    height: int
    inputs: list[int] = field(default_factory=list)
    outputs: list[int] = field(default_factory=list)
    first: bool = False
    last: bool = False
    column: int = 0
    x: int = 0
    y: int = 0


class Path(NamedTuple):
    """Wires of one source between two columns: lines, and the points where three of them meet.

    `net` is the source: a box and the number of its output.
    """

    net: tuple[int, int]
    lines: list[tuple[tuple[int, int], tuple[int, int]]]
    dots: list[tuple[int, int]]


def feedback_wires(count: int, wires: Sequence[Wire]) -> set[Wire]:
    """Return wires without which no signal of `count` boxes comes back to where it was."""
    leaving: list[list[Wire]] = [[] for _ in range(count)]
    for wire in wires:
        leaving[wire.source].append(wire)
    found: set[Wire] = set()
    state = [0] * count  # 1: on the way, 2: done
    for start in range(count):
        pending = [] if state[start] else [(start, iter(leaving[start]))]
        state[start] = state[start] or 1
        while pending:
            box, rest = pending[-1]
            following = next(rest, None)
            if following is None:
                state[box] = 2
                pending.pop()
            elif state[following.target] == 1:
                found.add(following)
            elif not state[following.target]:
                state[following.target] = 1
                pending.append((following.target, iter(leaving[following.target])))
    return found


def crossings(lines: Iterable[tuple[tuple[int, int], tuple[int, int]]]) -> int:
    """Return how many pairs of level and upright lines cross, each inside of the other."""
    across: dict[int, list[tuple[int, int]]] = {}
    upright: list[tuple[int, int, int]] = []
    for (x1, y1), (x2, y2) in lines:
        if y1 == y2:
            across.setdefault(y1, []).append((min(x1, x2), max(x1, x2)))
        else:
            upright.append((x1, min(y1, y2), max(y1, y2)))
    levels = sorted(across)
    return sum(
        left < x < right
        for x, top, bottom in upright
        for level in levels[bisect_right(levels, top) : bisect_left(levels, bottom)]
        for left, right in across[level]
    )


class NetworkLayout:
    """The layout of boxes that wires without feedback connect. Where boxes could change places, the first is above.

    Wires of one source run together as far as they can; where wires cross, they part at once if that helps.
    """

    def __init__(self, boxes: Sequence[Box], wires: Sequence[Wire]) -> None:
        self._real = len(boxes)
        self.wires = list(dict.fromkeys(wires))
        self._lay(boxes, together=True)
        crossed = self._crossings()
        if crossed:
            self._lay(boxes, together=False)
            if self._crossings() >= crossed:
                self._lay(boxes, together=True)

    def _lay(self, boxes: Sequence[Box], *, together: bool) -> None:
        self.boxes = list(boxes)
        self._choose_columns(together=together)
        self._hops: list[tuple[tuple[int, int], Wire]] = []
        self._lay_lanes(together=together)
        self._levels: dict[int, dict[int, set[tuple[int, int]]]] = {}
        self._place()
        self.height = max((box.y + box.height for box in self.boxes), default=0)
        self.width = 0
        self.paths = list(self._route())

    def _choose_columns(self, *, together: bool) -> None:
        """Choose the columns; if not `together`, a branch leaves before the column of what else feeds a box."""
        boxes = self.boxes
        for box in boxes:
            box.column = 0
        waiting = [0] * len(boxes)
        leaving: list[list[int]] = [[] for _ in boxes]
        for wire in self.wires:
            waiting[wire.target] += 1
            leaving[wire.source].append(wire.target)
        ready = [number for number, count in enumerate(waiting) if not count]
        fed = [bool(count) for count in waiting]
        aside = {wire.target for wire in self.wires if not fed[wire.source] and not boxes[wire.source].first}
        for number in ready:  # grows
            for target in leaving[number]:
                step = 2 if not together and fed[number] and len(leaving[number]) > 1 and target in aside else 1
                boxes[target].column = max(boxes[target].column, boxes[number].column + step)
                waiting[target] -= 1
                if not waiting[target]:
                    ready.append(target)
        outermost = max((box.column for box in boxes), default=0)
        for number, box in enumerate(boxes):
            if box.last and not leaving[number]:
                box.column = outermost
        for number in reversed(ready):
            if not fed[number] and not boxes[number].first and leaving[number]:
                boxes[number].column = min(boxes[target].column for target in leaving[number]) - 1

    def _lay_lanes(self, *, together: bool) -> None:
        """Put a lane into each column that a wire passes; wires of one source share it if `together`."""
        lanes: dict[tuple[int, int, int], int] = {}
        for wire in self.wires:
            net = (wire.source, wire.pin)
            if not together:
                lanes = {}
            source, pin = wire.source, wire.pin
            for column in range(self.boxes[wire.source].column + 1, self.boxes[wire.target].column):
                key = (*net, column)
                if key not in lanes:
                    lanes[key] = len(self.boxes)
                    self.boxes.append(Box(0, _LANE, [_LANE // 2], [_LANE // 2], column=column))
                    self._hops.append((net, Wire(source, pin, lanes[key], 0)))
                source, pin = lanes[key], 0
            self._hops.append((net, Wire(source, pin, wire.target, wire.place)))

    # -- places

    def _place(self) -> None:
        boxes = self.boxes
        entering: list[list[tuple[tuple[int, int], Wire]]] = [[] for _ in boxes]
        leaving: list[list[tuple[tuple[int, int], Wire]]] = [[] for _ in boxes]
        for net, hop in self._hops:
            entering[hop.target].append((net, hop))
            leaving[hop.source].append((net, hop))
        for hops in entering:
            hops.sort(key=lambda each: each[1].place)
        floors = [0] * (max((box.column for box in boxes), default=0) + 1)
        placed = [False] * len(boxes)
        for end in (number for number in range(self._real) if not leaving[number]):
            for number in _inputs_first(end, entering, placed):
                self._place_box(number, floors, entering[number], leaving[number])

    def _place_box(
        self,
        number: int,
        floors: list[int],
        entering: Sequence[tuple[tuple[int, int], Wire]],
        leaving: Sequence[tuple[tuple[int, int], Wire]],
    ) -> None:
        box = self.boxes[number]
        y = floors[box.column]
        if entering:
            hop = entering[0][1]
            source = self.boxes[hop.source]
            y = max(y, source.y + source.outputs[hop.pin] - box.inputs[hop.place])
        elif leaving:
            hop = leaving[0][1]
            target = self.boxes[hop.target]
            y = max(y, floors[target.column] + target.inputs[hop.place] - box.outputs[hop.pin])
        pins: dict[tuple[int, int], set[tuple[int, int]]] = {}
        for net, hop in entering:
            pins.setdefault((box.column - 1, box.inputs[hop.place]), set()).add(net)
        for net, hop in leaving:
            pins.setdefault((box.column, box.outputs[hop.pin]), set()).add(net)
        while any(self._levels.get(channel, {}).get(y + down, own) - own for (channel, down), own in pins.items()):
            y += _NUDGE
        for (channel, down), own in pins.items():
            self._levels.setdefault(channel, {}).setdefault(y + down, set()).update(own)
        box.y = y
        floors[box.column] = y + box.height + (_GAP if box.width else 0)

    # -- wires

    def _route(self) -> Iterator[Path]:
        channels: dict[int, dict[tuple[int, int], list[Wire]]] = {}
        net_of: dict[tuple[int, int], tuple[int, int]] = {}
        for net, hop in self._hops:
            start = (hop.source, hop.pin)
            net_of[start] = net
            channels.setdefault(self.boxes[hop.source].column, {}).setdefault(start, []).append(hop)
        columns: dict[int, int] = {}
        for box in self.boxes:
            columns[box.column] = max(columns.get(box.column, 0), box.width)
        x = 0
        starts: dict[int, int] = {}
        tracks: dict[int, dict[tuple[int, int], int]] = {}
        for column, width in sorted(columns.items()):
            starts[column] = x
            tracks[column] = _tracks(
                {start: (self._ends(hops)[0][1], *self._span(hops)) for start, hops in channels.get(column, {}).items()}
            )
            x += width + 2 * _CHANNEL + _TRACK * max(tracks[column].values(), default=0)
            self.width = x
        fed = {wire.target for wire in self.wires}
        for number, box in enumerate(self.boxes):
            box.x = starts[box.column]
            if number >= self._real:
                box.width = columns[box.column]
            elif number not in fed:  # what only feeds is beside what it feeds
                box.x += columns[box.column] - box.width
        lanes = {hop.target: (net, hop) for net, hop in self._hops if hop.target >= self._real}
        for column, beginnings in channels.items():
            for start, hops in beginnings.items():
                track = starts[column] + columns[column] + _CHANNEL + _TRACK * tracks[column].get(start, 0)
                yield self._path(net_of[start], hops, track)
        for number, (net, _) in lanes.items():
            box = self.boxes[number]
            level = box.y + box.inputs[0]
            yield Path(net, [((box.x, level), (box.x + box.width, level))], [])

    def _crossings(self) -> int:
        """Return how many pairs of wires cross."""
        return crossings(line for path in self.paths for line in path.lines)

    def _ends(self, hops: Sequence[Wire]) -> tuple[tuple[int, int], list[tuple[int, int]]]:
        source = self.boxes[hops[0].source]
        targets = [
            (self.boxes[hop.target].x, self.boxes[hop.target].y + self.boxes[hop.target].inputs[hop.place])
            for hop in hops
        ]
        return (source.x + source.width, source.y + source.outputs[hops[0].pin]), targets

    def _span(self, hops: Sequence[Wire]) -> tuple[int, int]:
        (_, level), targets = self._ends(hops)
        levels = [level, *(y for _, y in targets)]
        return min(levels), max(levels)

    def _path(self, net: tuple[int, int], hops: Sequence[Wire], track: int) -> Path:
        (x, level), targets = self._ends(hops)
        top, bottom = self._span(hops)
        lines = [((x, level), (track, level))]
        if top < bottom:
            lines.append(((track, top), (track, bottom)))
        lines += [((track, y), (end, y)) for end, y in targets]
        dots = []
        for y in dict.fromkeys([level, *(y for _, y in targets)]):
            meeting = (y == level) + any(y == each for _, each in targets) + (y > top) + (y < bottom)
            if meeting > 2:
                dots.append((track, y))
        return Path(net, lines, dots)


def _inputs_first(
    end: int, entering: Sequence[list[tuple[tuple[int, int], Wire]]], placed: list[bool]
) -> Iterator[int]:
    """Yield the boxes before a box and the box itself, in the order of inputs; nothing twice."""
    pending = [(end, iter(entering[end]))]
    while pending:
        number, rest = pending[-1]
        found = next(rest, None)
        if found is None:
            pending.pop()
            if not placed[number]:
                placed[number] = True
                yield number
        elif not placed[found[1].source]:
            pending.append((found[1].source, iter(entering[found[1].source])))


def _tracks(spans: dict[tuple[int, int], tuple[int, int, int]]) -> dict[tuple[int, int], int]:
    """Return a track for each wire between two columns; those on one track do not touch each other.

    `spans` are the level of the source, the highest and the lowest level. Of wires that lead down beside each other
    the upper one is on the right, of those that lead up on the left: so they do not cross.
    """
    used: list[list[tuple[int, int]]] = []
    found: dict[tuple[int, int], int] = {}
    up = [net for net, (level, top, bottom) in spans.items() if top < bottom and level - top > bottom - level]
    down = [net for net, (level, top, bottom) in spans.items() if top < bottom and level - top <= bottom - level]
    up.sort(key=lambda net: spans[net])
    down.sort(key=lambda net: spans[net], reverse=True)
    for net in (*up, *down):
        _, top, bottom = spans[net]
        track = len(used)
        while track and all(end < top or begin > bottom for begin, end in used[track - 1]):
            track -= 1
        if track == len(used):
            used.append([])
        used[track].append((top, bottom))
        found[net] = track
    return found


_MARGIN = 24
_PITCH = 20
_BETWEEN = 16
_PAD = 7
_TEXT = 360
_MODIFIERS = {n.Edge.RISING: "P", n.Edge.FALLING: "N", n.Storage.SET: "S", n.Storage.RESET: "R"}


def body_svg(body: FbdBody | LdBody, theme: str = Theme.LIGHT, name: str = "") -> str:
    """Return a picture of the networks of a body as the text of an SVG file, called `name`.

    `theme` is a `Theme`. Raises `ModelError` for one that does not exist.
    """
    return _picture(body, chosen_theme(theme), "", name)


def body_figure(body: FbdBody | LdBody, prefix: str, told: Told = english) -> str:
    """Return a picture of the networks of a body as a part of a page: all ids in it begin with `prefix`.

    `told` gives the words of the picture.
    """
    return _picture(body, None, prefix, "", told)


def _picture(body: FbdBody | LdBody, theme: Theme | None, prefix: str, name: str, told: Told = english) -> str:
    canvas = Canvas()
    y = right = _MARGIN
    is_s7 = body.project is not None and body.project.dialect is Dialect.SCL
    for number, network in enumerate(body.networks):
        title = plain(network.title)
        if len(body.networks) > 1 or title:
            lines = wrap(f"{number + 1}. {title}" if title else f"{number + 1}.", 13, 2 * _TEXT, bold=True)
            canvas.lines("name", _MARGIN, y + 10, lines, 16)
            right = max(right, _MARGIN + widest(lines, 13, bold=True))
            y += 16 * len(lines) + 10
        sheet = _Sheet(network, f"{prefix}network-{number}-", told, is_ladder=body.language == "LD", is_s7=is_s7)
        sheet.draw(canvas, _MARGIN, y)
        right = max(right, _MARGIN + sheet.width)
        y += sheet.height + 8
    kind = told("Ladder diagram" if body.language == "LD" else "Function block diagram")
    count = len(body.networks)
    size = f"{kind}: {count} {told('network' if count == 1 else 'networks')}"
    return canvas.document(right + _MARGIN, y + _MARGIN - 24, theme, name or kind, size)


@dataclass(slots=True)
class _Pin:
    """A pin of a symbol: its name, the text at it instead of a wire, and its effect on the signal."""

    name: str
    text: str = ""
    link: str = ""
    negated: bool = False
    modifier: str = ""
    connections: Sequence[n.Connection] = ()
    wired: bool = False


@dataclass(slots=True)
class _Symbol:
    """An element of a network. `look` is block, text, contact, coil, rail or note; `caption` is above it."""

    look: str
    lines: list[str]
    title: str
    identifier: str = ""
    caption: str = ""
    inputs: list[_Pin] = field(default_factory=list)
    outputs: list[_Pin] = field(default_factory=list)
    negated: bool = False
    modifier: str = ""
    before: int = 0
    body: int = 0
    is_at_pin: bool = False
    box: Box = field(default_factory=lambda: Box(0, 0))

    def measure(self) -> None:
        """Set the size; the texts at the pins are known."""
        self.before = max((text_width(pin.text, 12) + 12 for pin in self.inputs if pin.text), default=0)
        behind = max((text_width(pin.text, 12) + 12 for pin in self.outputs if pin.text), default=0)
        rows = max(len(self.inputs), len(self.outputs), 1)
        inner = widest(self.lines, 13 if self.look == "block" else 12, bold=self.look == "block")
        above = 17 if self.caption else 0
        levels: list[int]
        if self.look == "block":
            names = [max((text_width(pin.name, 11) for pin in pins), default=0) for pins in (self.inputs, self.outputs)]
            self.body = max(inner + 2 * _PAD, sum(names) + 4 * _PAD, text_width(self.caption, 12), 46)
            head = 18 * len(self.lines)
            height = above + head + rows * _PITCH + 4
            levels = [above + head + _PITCH * row + 10 for row in range(rows)]
        elif self.look in ("contact", "coil", "assignment"):
            self.body = max(text_width(self.caption, 12) + 8, 52)
            height, levels = above + 23, [above + 11] * rows
        elif self.look == "rail":
            self.body, height, levels = 6, 26, [13] * rows
        else:
            self.body = inner + 3 * _PAD
            height = max(len(self.lines), 1) * 15 + 6
            levels = [height // 2] * rows
        count = (len(self.inputs), len(self.outputs))
        self.box = Box(self.before + self.body + behind, height, levels[: count[0]], levels[: count[1]])

    def draw(self, canvas: Canvas, x: int, y: int) -> None:
        """Draw the symbol with its upper left corner at `x`, `y`."""
        left, right = x + self.before, x + self.before + self.body
        area = (x, y, self.box.width, self.box.height)
        kind = {"text": "operand", "note": "comment"}.get(self.look, self.look)
        with canvas.element(kind, self.identifier, self.title, area):
            if self.caption:
                canvas.text("plain", (left + right) // 2, y + 12, self.caption, anchor="middle")
            draw = {
                "block": self._draw_block,
                "rail": self._draw_rail,
                "text": self._draw_text,
                "note": self._draw_note,
            }
            draw.get(self.look, self._draw_switch)(canvas, left, right, y)
            for pins, levels, edge, side in (
                (self.inputs, self.box.inputs, left, -1),
                (self.outputs, self.box.outputs, right, 1),
            ):
                for pin, down in zip(pins, levels, strict=True):
                    self._draw_pin(canvas, pin, edge, y + down, side)

    def _draw_pin(self, canvas: Canvas, pin: _Pin, edge: int, level: int, side: int) -> None:
        outer = edge + side * (self.before if side < 0 else self.box.width - self.before - self.body)
        if pin.text:
            canvas.line("thin", (edge, level), (edge + side * 8, level))
            canvas.text(
                "link" if pin.link else "plain",
                edge + side * 11,
                level + 4,
                pin.text,
                anchor="end" if side < 0 else "start",
                link=pin.link,
            )
        elif outer != edge and pin.wired:
            canvas.line("wire", (outer, level), (edge, level))
        if self.look == "block":
            canvas.text("small", edge - side * (_PAD + 1), level + 4, pin.name, anchor="start" if side < 0 else "end")
        if pin.negated:
            canvas.circle("mark", edge + side * 4, level, 4)
        if pin.modifier:
            canvas.text("quiet", edge + side * 6, level - 4, pin.modifier, anchor="end" if side < 0 else "start")

    def _draw_block(self, canvas: Canvas, left: int, right: int, y: int) -> None:
        top = y + (17 if self.caption else 0)
        canvas.box("box", left, top, right - left, y + self.box.height - top)
        canvas.lines("name", (left + right) // 2, top + 14, self.lines, 16, anchor="middle")

    def _draw_rail(self, canvas: Canvas, left: int, right: int, y: int) -> None:  # noqa: ARG002
        if not self.outputs:
            canvas.line("bar", (left, y), (left, y + self.box.height))

    def _draw_text(self, canvas: Canvas, left: int, right: int, y: int) -> None:
        canvas.box("row", left, y, right - left, self.box.height)
        canvas.lines("plain", left + _PAD, y + 14, self.lines, 15)

    def _draw_note(self, canvas: Canvas, left: int, right: int, y: int) -> None:  # noqa: ARG002
        canvas.lines("remark", left + 2 * _PAD, y + 14, self.lines, 15)

    def _draw_switch(self, canvas: Canvas, left: int, right: int, y: int) -> None:
        level, middle = y + self.box.height - 12, (left + right) // 2
        sign = "".join(("/" if self.negated else "", self.modifier))
        for pin, begin, end in ((self.inputs[0], left, middle - 9), (self.outputs[0], middle + 9, right)):
            if pin.wired or pin.text:
                canvas.line("wire", (begin, level), (end, level))
        if self.look == "contact":
            for x in (middle - 9, middle + 9):
                canvas.line("bar", (x, level - 9), (x, level + 9))
        elif self.look == "coil":
            canvas.circle("mark", middle, level, 10)
        else:
            canvas.box("box", middle - 13, level - 11, 26, 22)
            sign = sign or "="
        canvas.text("plain", middle, level + 4, sign, anchor="middle")


class _Sheet:
    """A network: its symbols and their places."""

    def __init__(self, network: n.LogicNetwork, prefix: str, told: Told, *, is_ladder: bool, is_s7: bool) -> None:
        self._prefix = prefix
        self._told = told
        self._is_ladder = is_ladder
        self._is_s7 = is_s7
        self.symbols: list[_Symbol] = []
        self._of: dict[int, tuple[int, dict[str, int]]] = {}
        self._rails: set[int] = set()
        nodes = list(network.nodes)
        if len({node.position for node in nodes}) > 1:
            nodes.sort(key=lambda node: (node.position[1], node.position[0]))
        for node in nodes:
            self._add(node)
        self._operands_to_pins(nodes)
        wires = list(self._connect())
        for symbol in self.symbols:
            symbol.measure()
            symbol.box.first = symbol.look == "rail" and bool(symbol.outputs)
            symbol.box.last = symbol.look in ("coil", "rail") and is_ladder and not symbol.box.first
        # a rail that networks share is above the first one; what it is wired to tells the places of the others
        shown = sorted(
            (symbol for symbol in self.symbols if not symbol.is_at_pin), key=lambda each: each.look == "rail"
        )
        self._groups = list(_connected(shown, self.symbols, wires))
        self._indents = [self._indent(symbols) for symbols, _ in self._groups]
        widths = (indent + layout.width for indent, (_, layout) in zip(self._indents, self._groups, strict=True))
        self.width = max(widths, default=0)
        self.height = sum(layout.height + _BETWEEN for _, layout in self._groups)

    def draw(self, canvas: Canvas, x: int, y: int) -> None:
        """Draw the network with its upper left corner at `x`, `y`."""
        rails: list[tuple[int, int]] = []
        for indent, (symbols, layout) in zip(self._indents, self._groups, strict=True):
            left = x + indent
            for path in layout.paths:
                for line in path.lines:
                    if line[0] != line[1]:
                        canvas.wire(*((left + a, y + b) for a, b in line))
                for a, b in path.dots:
                    canvas.circle("head", left + a, y + b, 3)
            for symbol in symbols:
                symbol.draw(canvas, left + symbol.box.x, y + symbol.box.y)
                if symbol.box.first:
                    rails += [
                        (x + symbol.body, y + symbol.box.y),
                        (x + symbol.body, y + symbol.box.y + symbol.box.height),
                    ]
            y += layout.height + _BETWEEN
        if rails:
            canvas.wire(min(rails), max(rails), kind="bar")

    def _indent(self, symbols: Sequence[_Symbol]) -> int:
        """Return the room that symbols keep from a left rail that goes past them."""
        is_apart = not any(symbol.box.first or symbol.look == "note" for symbol in symbols)
        return 2 * _PAD if is_apart and self._rails else 0

    def _operands_to_pins(self, nodes: Sequence[n.Node]) -> None:
        """Write operands that feed one pin of a block at this pin: no wire is needed."""
        users: dict[int, list[_Pin]] = {}
        for symbol in self.symbols:
            for pin in symbol.inputs:
                for connection in pin.connections:
                    users.setdefault(connection.source, []).append(pin if symbol.look == "block" else _Pin(""))
        for node in nodes:
            pins = users.get(node.id, [])
            if not isinstance(node, n.InputVariable) or len(pins) != 1 or len(pins[0].connections) != 1:
                continue
            symbol = self.symbols[self._of[node.id][0]]
            if not symbol.outputs[0].modifier and not (node.negated and pins[0].negated) and len(symbol.lines) == 1:
                pins[0].text, pins[0].connections = node.expression, ()
                pins[0].negated = pins[0].negated or node.negated
                symbol.is_at_pin = True

    def _add(self, node: n.Node) -> None:
        if isinstance(node, n.LeftPowerRail):
            self._rails.add(node.id)
            return
        if isinstance(node, n.RightPowerRail):
            for connection in (each for pin in node.inputs for each in pin.connections):
                self.symbols.append(
                    _Symbol("rail", [], self._told("Right power rail"), inputs=[_Pin("", connections=[connection])])
                )
            return
        symbol = self._symbol(node)
        if not symbol.lines and symbol.look == "note":
            return
        symbol.identifier = f"{self._prefix}{node.id}"
        names = {pin.name: number for number, pin in enumerate(symbol.outputs)}
        self._of.setdefault(node.id, (len(self.symbols), names))
        self.symbols.append(symbol)

    def _connect(self) -> Iterator[Wire]:
        """Yield the wires; a rail becomes a symbol for each wire, feedback a text at the pin."""
        ends = [
            (number, place, connection)
            for number, symbol in enumerate(self.symbols)
            for place, pin in enumerate(symbol.inputs)
            for connection in pin.connections
        ]
        wires: dict[Wire, None] = {}
        for number, place, connection in ends:
            source, names = self._of.get(connection.source, (-1, {}))
            if connection.source in self._rails:
                wires[Wire(len(self.symbols), 0, number, place)] = None
                self.symbols.append(_Symbol("rail", [], self._told("Left power rail"), outputs=[_Pin("")]))
            elif source >= 0 and self.symbols[source].outputs:
                wires[Wire(source, names.get(connection.pin or "", 0), number, place)] = None
            else:
                self.symbols[number].inputs[place].text = "?"  # the wire of a broken file
        back = feedback_wires(len(self.symbols), list(wires))
        for wire in wires:
            start, pin = self.symbols[wire.source], self.symbols[wire.target].inputs[wire.place]
            if wire not in back:
                pin.wired = start.outputs[wire.pin].wired = True
                yield wire
                continue
            name = ".".join(filter(None, (start.caption or " ".join(start.lines), start.outputs[wire.pin].name)))
            pin.text, pin.link = f"\u2190 {name}", start.identifier

    def _symbol(self, node: n.Node) -> _Symbol:
        match node:
            case n.Block():
                name, caption, (inputs, outputs) = node.type_name, node.instance or "", _pins(node.parameters)
                known = standard_block(name)
                if known is not None:
                    order = {pin.name: place for place, pin in enumerate(known.inputs)}
                    inputs.sort(key=lambda pin: order.get(known.input_name(pin.name) or "", len(order)))
                if self._is_s7 and name in _FLIP_FLOPS_OF_S7:
                    name = _FLIP_FLOPS_OF_S7[name]
                    inputs.sort(key=lambda pin: pin.name.endswith("1"))
                    outputs = [replace(pin, name="Q") for pin in outputs]
                if self._is_s7 and known is not None and not caption:
                    states = [pin for pin in inputs if pin.name in ("operand", "bit") and not pin.connections]
                    caption = states[0].text if states else ""
                    inputs = [pin for pin in inputs if pin not in states]
                lines = wrap(node.code or name, 13, _TEXT, bold=True)
                title = " ".join(filter(None, (name, caption)))
                return _Symbol("block", lines, title, "", caption, inputs, outputs)
            case n.Contact() | n.Coil():
                kind = "contact" if isinstance(node, n.Contact) else "coil" if self._is_ladder else "assignment"
                symbol = _Symbol(kind, [], f"{self._told(kind)} {node.variable}", caption=node.variable)
                symbol.negated, symbol.modifier = node.negated, _modifier(node.edge, node.storage)
                symbol.inputs, symbol.outputs = [_input(node.input)], [_Pin("")]
                return symbol
            case n.InputVariable():
                pin = _Pin("", negated=node.negated, modifier=_modifier(node.edge, node.storage))
                return self._text(node.expression, outputs=[pin])
            case n.OutputVariable():
                pin = _input(node.input)
                pin.negated, pin.modifier = node.negated, _modifier(node.edge, node.storage)
                return self._text(node.expression, inputs=[pin])
            case n.InOutVariable():
                pin = _input(node.input)
                pin.negated, pin.modifier = node.negated_in, _modifier(node.edge_in, node.storage_in)
                out = _Pin("", negated=node.negated_out, modifier=_modifier(node.edge_out, node.storage_out))
                return self._text(node.expression, inputs=[pin], outputs=[out])
            case n.Jump():
                return self._text(f">> {node.label}", inputs=[_input(node.input)])
            case n.Label():
                return self._text(f"{node.label}:")
            case n.Return():
                return self._text("RETURN", inputs=[_input(node.input)])
            case n.Connector():
                return self._text(f"{node.name} >", inputs=[_input(node.input)])
            case n.Continuation():
                return self._text(f"> {node.name}", outputs=[_Pin("")])
            case n.VendorElement() if node.parameters is not None:
                lines = wrap(plain(node.alternative_text) or node.element_type or "?", 13, _TEXT, bold=True)
                inputs, outputs = _pins(node.parameters)
                return _Symbol("block", lines, " ".join(lines), inputs=inputs, outputs=outputs)
            case n.VendorElement():  # CODESYS keeps settings of the editor in those without a type
                text = plain(node.alternative_text) if node.element_type or not node.attributes else ""
            case _:
                text = plain(getattr(node, "content", ""))
        return _Symbol("note", wrap(text, 12, 2 * _TEXT), text)

    def _text(self, text: str, *, inputs: Sequence[_Pin] = (), outputs: Sequence[_Pin] = ()) -> _Symbol:
        return _Symbol("text", wrap(text, 12, _TEXT) or [""], text, inputs=list(inputs), outputs=list(outputs))


def _connected(
    shown: Sequence[_Symbol], symbols: Sequence[_Symbol], wires: Sequence[Wire]
) -> Iterator[tuple[list[_Symbol], NetworkLayout]]:
    """Yield the symbols that wires connect with each other, in the order of `shown`, with their layout."""
    near: list[list[Wire]] = [[] for _ in symbols]
    for wire in wires:
        near[wire.source].append(wire)
        near[wire.target].append(wire)
    numbers = {id(symbol): number for number, symbol in enumerate(symbols)}
    seen: set[int] = set()
    for first in (numbers[id(symbol)] for symbol in shown):
        group = [] if first in seen else [first]
        seen.add(first)
        for number in group:  # grows
            for other in (end for wire in near[number] for end in (wire.source, wire.target)):
                if other not in seen:
                    seen.add(other)
                    group.append(other)
        if group:
            place = {number: position for position, number in enumerate(sorted(group))}
            own = [
                Wire(place[wire.source], wire.pin, place[wire.target], wire.place)
                for number in place
                for wire in near[number]
                if wire.target == number
            ]
            members = [symbols[number] for number in place]
            yield members, NetworkLayout([symbol.box for symbol in members], own)


def _pins(parameters: n.BlockParameters) -> tuple[list[_Pin], list[_Pin]]:
    """Return the pins on the left and on the right of a block; hidden ones without a use are left out."""
    left, right = [], []
    for variable in (*parameters.inputs, *parameters.in_outs):
        pin = _input(variable.input)
        if not variable.hidden or pin.connections or pin.text:
            pin.name, pin.negated, pin.modifier = (
                variable.name,
                variable.negated,
                _modifier(variable.edge, variable.storage),
            )
            left.append(pin)
    left = _in_order(left)
    for variable in (*parameters.in_outs, *parameters.outputs):
        text = (variable.output.expression if variable.output is not None else None) or ""
        pin = _Pin(variable.name, text)
        if variable in parameters.outputs:
            pin.negated, pin.modifier = variable.negated, _modifier(variable.edge, variable.storage)
        right.append(pin)
    return left, right


_FLIP_FLOPS_OF_S7 = {"RS": "SR", "SR": "RS"}
"""What TIA Portal calls the flip-flops of IEC 61131-3: the dominant input is the last in the name and the lower one."""
_NUMBERED = re.compile(r"(\D*)(\d+)")


def _in_order(pins: list[_Pin]) -> list[_Pin]:
    """Return pins with ``IN1`` above ``IN2``: SimaticML has them in the order of its wires."""
    numbered = [_NUMBERED.fullmatch(pin.name) for pin in pins]
    alike: dict[str, list[tuple[int, int]]] = {}
    for place, found in enumerate(numbered):
        if found is not None:
            alike.setdefault(found[1], []).append((int(found[2]), place))
    ordered = {name: iter(sorted(places)) for name, places in alike.items()}
    return [
        pin if found is None else pins[next(ordered[found[1]])[1]] for pin, found in zip(pins, numbered, strict=True)
    ]


def _input(pin: n.InputPin | None) -> _Pin:
    if pin is None:
        return _Pin("")
    return _Pin("", (pin.expression or "") if not pin.connections else "", connections=pin.connections)


def _modifier(edge: n.Edge, storage: n.Storage) -> str:
    return _MODIFIERS.get(storage, "") or _MODIFIERS.get(edge, "")
