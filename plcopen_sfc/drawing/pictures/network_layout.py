"""Layout of networks: boxes in columns, and the wires between them.

The layout is layered. Signals run from left to right: a symbol is in the column behind the last of those that feed it,
one that nothing feeds directly before the first that it feeds. A wire that passes a column has a place of its own
there, so no wire runs through a symbol. Upright parts of wires lie between the columns, each on a track of its own
where they would touch. Two wires of different sources never have parts on each other; where the network needs it they
cross.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

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
    """Box to be placed: its size and the levels of its pins. `first` and `last` put it into the outermost columns.

    A box that `joins` is an upright line whose pins are level with what leads to them.
    """

    width: int
    height: int
    inputs: list[int] = field(default_factory=list)
    outputs: list[int] = field(default_factory=list)
    first: bool = False
    last: bool = False
    joins: bool = False
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


class _Hop(NamedTuple):
    """A wire from one column to the next, and what its signal comes from: a box and the number of its output."""

    net: tuple[int, int]
    wire: Wire


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


def crossings(lines: Iterable[tuple[tuple[float, float], tuple[float, float]]]) -> int:
    """Return how many pairs of level and upright lines cross, each inside of the other."""
    across: dict[float, list[tuple[float, float]]] = {}
    upright: list[tuple[float, float, float]] = []
    for (x1, y1), (x2, y2) in lines:
        if x1 == x2:
            upright.append((x1, min(y1, y2), max(y1, y2)))
        else:
            across.setdefault(y1, []).append((min(x1, x2), max(x1, x2)))
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
        self._hops: list[_Hop] = []
        self._lay_lanes(together=together)
        self._levels: dict[int, dict[int, set[tuple[int, int]]]] = {}
        self._place()
        self.height = max((box.y + box.height for box in self.boxes), default=0)
        self.width = 0
        self.paths = list(self._route())

    def _choose_columns(self, *, together: bool) -> None:
        """Choose the columns; if not `together`, a branch leaves before the column of what else feeds a box."""
        boxes = self.boxes
        begin = 1 if any(box.first for box in boxes) else 0  # nothing is beside a rail
        for box in boxes:
            box.column = 0 if box.first else begin
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
                    self._hops.append(_Hop(net, Wire(source, pin, lanes[key], 0)))
                source, pin = lanes[key], 0
            self._hops.append(_Hop(net, Wire(source, pin, wire.target, wire.place)))

    # -- places

    def _place(self) -> None:
        boxes = self.boxes
        entering: list[list[_Hop]] = [[] for _ in boxes]
        leaving: list[list[_Hop]] = [[] for _ in boxes]
        for hop in self._hops:
            entering[hop.wire.target].append(hop)
            leaving[hop.wire.source].append(hop)
        for hops in entering:
            hops.sort(key=lambda each: each.wire.place)
        floors = [0] * (max((box.column for box in boxes), default=0) + 1)
        placed = [False] * len(boxes)
        for end in (number for number in range(self._real) if not leaving[number]):
            for number in _inputs_first(end, entering, placed):
                self._place_box(number, floors, entering, leaving)

    def _place_box(
        self, number: int, floors: list[int], hops_in: Sequence[list[_Hop]], hops_out: Sequence[list[_Hop]]
    ) -> None:
        box, entering, leaving = self.boxes[number], hops_in[number], hops_out[number]
        y = floors[box.column]
        if box.joins:
            y = self._stretch(box, y, entering)
        elif entering:
            y = max(y, self._level(entering[0]) - box.inputs[entering[0].wire.place])
        else:
            y = max(y, *self._straight(number, floors, hops_in, hops_out))
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
        floors[box.column] = y + box.height + (_GAP if box.width or box.joins else 0)

    def _level(self, hop: _Hop) -> int:
        """Return the level at which a wire comes from its source."""
        source = self.boxes[hop.wire.source]
        return source.y + source.outputs[hop.wire.pin]

    def _stretch(self, box: Box, floor: int, entering: Sequence[_Hop]) -> int:
        """Put the pins of a box that joins wires level with them where that can be; return where it begins."""
        levels: dict[int, int] = {}
        free = floor
        for hop in sorted(entering, key=self._level):
            levels[hop.wire.place] = max(free, self._level(hop))
            free = levels[hop.wire.place] + _LANE
        first = min(levels.values(), default=floor)
        for place in range(len(box.inputs)):
            box.inputs[place] = levels.get(place, free) - first
        box.height = max(box.inputs)
        return first

    def _straight(
        self, number: int, floors: Sequence[int], hops_in: Sequence[list[_Hop]], hops_out: Sequence[list[_Hop]]
    ) -> Iterator[int]:
        """Yield how low a box that nothing feeds is at least, for a straight line to what follows."""
        yield 0
        down = 0
        while hops_out[number]:
            hop = hops_out[number][0]
            down += self.boxes[number].outputs[hop.wire.pin]
            target = self.boxes[hop.wire.target]
            pin = 0 if target.joins else target.inputs[hop.wire.place]
            yield floors[target.column] + pin - down
            if hops_in[hop.wire.target][0] is not hop:
                return
            down -= pin
            number = hop.wire.target

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


def _inputs_first(end: int, entering: Sequence[list[_Hop]], placed: list[bool]) -> Iterator[int]:
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
        elif not placed[found.wire.source]:
            pending.append((found.wire.source, iter(entering[found.wire.source])))


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
