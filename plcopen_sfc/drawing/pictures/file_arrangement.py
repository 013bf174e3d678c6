"""Symbols of a chart in a picture where its file has them, and the wires as the file draws them.

A picture shows more at a symbol than an editor does: conditions and comments beside it, whole action blocks. So
the columns and rows of the file keep their order and are spread until everything has room. All that matters is that
the new places grow with those of the file: what is beside or below each other there, is so here, and what does not
overlap there, does not overlap here. Empty room is drawn together. The time is that of sorting the places.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple

from plcopen_sfc.drawing.drawing_style import fits
from plcopen_sfc.drawing.pictures.network_layout import crossings
from plcopen_sfc.drawing.pictures.svg_canvas import DOUBLE, Canvas
from plcopen_sfc.drawing.pictures.symbol_facts import PictureSheet
from plcopen_sfc.drawing.pictures.symbol_pictures import JumpSymbol, StepSymbol, Symbol, TransitionSymbol
from plcopen_sfc.drawing.symbol_layout import SymbolSizes
from plcopen_sfc.grouping import grouped
from plcopen_sfc.model.drawing import BARS, STEPS, Drawing, Places, SymbolKind
from plcopen_sfc.model.drawing import Symbol as DrawnSymbol
from plcopen_sfc.model.network import Point
from plcopen_sfc.model.sfc import SfcNetwork, Transition

_WIDEST_GAP = 36
"""Room between symbols and wires of the file is kept up to here."""
_BEND = 8
_NEAR = 12
"""So far a wire of the file may end beside its symbol, and symbols may be out of line with each other."""
_DRAWN = STEPS | BARS | {SymbolKind.TRANSITION, SymbolKind.JUMP}
_SIMULTANEOUS = frozenset({SymbolKind.SIMULTANEOUS_DIVERGENCE, SymbolKind.SIMULTANEOUS_CONVERGENCE})

Wire = list[Point]
"""Points of a wire in the file, from its consumer to its producer."""


class _Box(NamedTuple):
    """The place of a symbol in the file. `axis`: where the flow runs through it; on a bar it may run anywhere."""

    left: float
    axis: float
    right: float
    top: float
    bottom: float


class _Scale:
    """Places of the file in one direction and, after `spread`, those in the picture."""

    def __init__(self) -> None:
        self._distances: dict[float, dict[float, int]] = {}
        self._places: dict[float, int] = {}

    def apart(self, low: float, high: float, distance: int) -> None:
        """Demand that two places are at least this far apart in the picture."""
        self._distances.setdefault(low, {})
        before = self._distances.setdefault(high, {})
        before[low] = max(before.get(low, 0), distance)

    def add(self, place: float) -> None:
        """Keep a place apart from those beside it."""
        self._distances.setdefault(place, {})

    def spread(self) -> None:
        """Choose the places in the picture: the nearest that are as far apart as demanded."""
        last, at = 0.0, 0
        for number, place in enumerate(sorted(self._distances)):
            at += round(min(place - last, _WIDEST_GAP)) if number else 0
            for low, distance in self._distances[place].items():
                at = max(at, self._places[low] + distance)
            self._places[place] = at
            last = place

    def __getitem__(self, place: float) -> int:
        return self._places[place]

    @property
    def length(self) -> int:
        """The distance from the first place to the last."""
        return max(self._places.values(), default=0)


@dataclass(slots=True)
class _Placed:
    """A symbol with its place. `shown`: what is drawn for it; None for a bar. `axes`: where wires meet a bar."""

    kind: SymbolKind
    box: _Box
    shown: Symbol | None
    enters: bool = False
    leaves: bool = False
    starred: bool = False
    axes: list[float] = field(default_factory=list)


@dataclass(slots=True)
class _Link:
    """A wire of the flow from `source` to `user`; its points lead from the user to the source."""

    user: _Placed
    source: _Placed
    points: Wire


class FileArrangement:
    """A chart as its file draws it, with the size of its picture. `of` returns None where that cannot be shown."""

    def __init__(self, sheet: PictureSheet, symbols: Sequence[_Placed], links: Sequence[_Link]) -> None:
        self._sheet, self._symbols, self._links = sheet, symbols, links
        self._x, self._y = _Scale(), _Scale()
        for placed in symbols:
            self._demand(placed)
        for link in links:
            link.user.enters = link.source.leaves = True
            link.user.axes.append(link.points[0][0])
            link.source.axes.append(link.points[-1][0])
            for x, y in link.points:
                self._x.add(x)
                self._y.add(y)
        self._x.spread()
        self._y.spread()
        self.width, self.height = self._x.length, self._y.length

    @classmethod
    def of(cls, sheet: PictureSheet) -> FileArrangement | None:
        """Return the arrangement of a chart in its file.

        None: the file has no places, the drawing no longer means the chart, symbols or wires lie on each other, or a
        jump leads to no step.
        """
        drawing = sheet.chart.drawing
        if drawing is None or drawing.places is not Places.GIVEN or not fits(sheet.chart):
            return None
        if any(symbol.kind is SymbolKind.JUMP and symbol.target not in sheet.steps for symbol in drawing.symbols):
            return None
        symbols = _symbols(sheet, drawing)
        links = list(_links(drawing, symbols))
        boxes = _Boxes([placed.box for placed in symbols.values()])
        if boxes.overlap() or any(
            link.source.box.bottom > link.user.box.top and len(link.points) < 5 for link in links
        ):
            return None
        lines = (line for link in links for line in pairwise(link.points))
        # a line across that crosses one that leads down: a reader could not tell that from a branch
        if any(boxes.on_way(link.points) for link in links) or crossings(lines):
            return None
        if sheet.stars:
            for link in links:
                shown = link.user.shown
                if link.source.kind is SymbolKind.SELECTION_DIVERGENCE and isinstance(shown, TransitionSymbol):
                    link.source.starred |= shown.turn is None
        return cls(sheet, list(symbols.values()), links)

    def draw(self, canvas: Canvas, left: int, top: int) -> None:
        """Draw the chart with its upper left corner at `left`, `top`."""
        for link in self._links:
            self._draw_wire(canvas, link, left, top)
        for placed in self._symbols:
            box, shown = placed.box, placed.shown
            y, bottom = top + self._y[box.top], top + self._y[box.bottom]
            if shown is None:
                self._draw_bar(canvas, placed, left, y)
                continue
            x = left + self._x[box.axis]
            shown.draw(canvas, x, y, enters=placed.enters, leaves=placed.leaves)
            if placed.leaves and y + shown.height < bottom:
                canvas.wire((x, y + shown.height), (x, bottom))

    def _demand(self, placed: _Placed) -> None:
        box, shown = placed.box, placed.shown
        if shown is None:
            self._x.apart(box.left, box.right, 0)
            self._y.apart(box.top, box.bottom, DOUBLE + 2 if placed.kind in _SIMULTANEOUS else 2)
        else:
            self._x.apart(box.left, box.axis, shown.left)
            self._x.apart(box.axis, box.right, shown.right)
            self._y.apart(box.top, box.bottom, shown.height)

    def _draw_wire(self, canvas: Canvas, link: _Link, left: int, top: int) -> None:
        told = self._sheet.words.told("Leads up")
        path = [(left + self._x[x], top + self._y[y]) for x, y in link.points]
        source = link.source
        if source.kind in BARS:
            path[-1] = (path[-1][0], top + self._y[source.box.top] + (DOUBLE if source.kind in _SIMULTANEOUS else 0))
        path = [point for point, after in pairwise([*path, (-1, -1)]) if point != after]
        if len(path) > 1:
            canvas.wire(*path)
        for (x, end), (_, start) in pairwise(path):
            if start > end + 24:  # up is no way that a reader expects
                middle = (start + end) // 2
                with canvas.element("arrow", self._sheet.next_id("arrow"), told, (x - 6, middle - 6, 12, 12)):
                    canvas.line("head", (x, middle - 5), (x - 5, middle + 5), (x + 5, middle + 5), closed=True)

    def _draw_bar(self, canvas: Canvas, placed: _Placed, left: int, y: int) -> None:
        parallel = placed.kind in _SIMULTANEOUS
        edges = [placed.box.left, placed.box.right] if parallel or not placed.axes else []
        ends = [left + self._x[x] for x in (*placed.axes, *edges)]
        canvas.bar(min(ends), max(ends), y, parallel=parallel)
        if placed.starred:
            canvas.star(min(ends) + 6, y + 1)


def _competing(chart: SfcNetwork) -> list[list[Transition]]:
    """Return the transitions that have a step above them in common, in the order in which they are tried."""
    below = grouped((step, transition) for transition in chart.transitions for step in transition.sources)
    return [transitions for transitions in below.values() if len(transitions) > 1]


def _turns(sheet: PictureSheet, drawing: Drawing) -> dict[int, int | None]:
    """Return the competing transitions, with their turn where the file does not draw them from left to right so.

    That is where they have no priorities, and the file has them in another order than it draws them.
    """
    competing = _competing(sheet.chart)
    turns: dict[int, int | None] = {each.id: None for row in competing for each in row}
    if not sheet.in_turn:
        return turns
    places = {symbol.id: symbol.position[0] for symbol in drawing.symbols if symbol.kind is SymbolKind.TRANSITION}
    for row in competing:
        drawn = [places[each.id] for each in row if each.priority is None and each.id in places]
        if len(drawn) == len(row) and drawn != sorted(drawn):
            turns |= {each.id: number for number, each in enumerate(row, 1)}
    return turns


def _jumping(symbols: Sequence[DrawnSymbol]) -> dict[int, list[int]]:
    """Return the transitions whose jumps lead to each step, through the bars between them."""
    drawn = {symbol.id: symbol for symbol in symbols}
    found: dict[int, list[int]] = {}
    for jump in symbols:
        if jump.kind is not SymbolKind.JUMP or jump.target is None:
            continue
        pending = list(_sources(jump, drawn))
        for number in pending:  # grows while it is walked
            above = drawn[number]
            if above.kind is SymbolKind.TRANSITION:
                found.setdefault(jump.target, []).extend(above.transitions or [above.id])
            elif above.kind in BARS:
                pending += [source for source in _sources(above, drawn) if source not in pending]
    return found


def _shown(
    sheet: PictureSheet, symbol: DrawnSymbol, turns: Mapping[int, int | None], jumping: Mapping[int, Sequence[int]]
) -> Symbol | None:
    if symbol.kind in STEPS:
        entries = [sheet.transition_reference(number) for number in jumping.get(symbol.id, ())]
        return StepSymbol(sheet, symbol.id, entries, [])
    if symbol.kind is SymbolKind.TRANSITION:
        number = symbol.transitions[0] if symbol.transitions else symbol.id
        return TransitionSymbol(sheet, number, [], competing=number in turns, turn=turns.get(number))
    if symbol.kind is SymbolKind.JUMP and symbol.target is not None:
        return JumpSymbol(sheet, symbol.target)
    return None


def _symbols(sheet: PictureSheet, drawing: Drawing) -> dict[int, _Placed]:
    """Return the symbols that are drawn, in line with each other where the file has them nearly so."""
    sizes = SymbolSizes(sheet.chart)
    drawn = [symbol for symbol in drawing.symbols if symbol.kind in _DRAWN]
    turns, jumping = _turns(sheet, drawing), _jumping(drawn)
    symbols = {each.id: _Placed(each.kind, _box(each, sizes), _shown(sheet, each, turns, jumping)) for each in drawn}
    for symbol in drawn:
        placed = symbols[symbol.id]
        for source in _sources(symbol, symbols):
            axis = symbols[source].box.axis
            if placed.shown is not None and symbols[source].shown is not None and abs(placed.box.axis - axis) <= _NEAR:
                box = placed.box
                placed.box = box._replace(left=min(box.left, axis - 1), axis=axis, right=max(box.right, axis + 1))
    return symbols


def _box(symbol: DrawnSymbol, sizes: SymbolSizes) -> _Box:
    (x, y), size = symbol.position, sizes.of(symbol)
    width, height = symbol.width or size[0], symbol.height or size[1]
    return _Box(x, x + width / 2, x + width, y, y + max(height, 1))


class _Boxes:
    """Places of symbols in the file."""

    def __init__(self, boxes: Sequence[_Box]) -> None:
        self._boxes = sorted(boxes, key=lambda each: each.top)
        self._tops = [box.top for box in self._boxes]
        self._highest = max((box.bottom - box.top for box in boxes), default=0)

    def overlap(self) -> bool:
        """True if two symbols have more in common than their edges."""
        beside: list[_Box] = []
        for box in self._boxes:
            beside = [each for each in beside if each.bottom > box.top]
            if any(each.left < box.right and box.left < each.right for each in beside):
                return True
            beside.append(box)
        return False

    def on_way(self, wire: Wire) -> bool:
        """True if a wire leads through a symbol."""
        return any(self._on_line(one, other) for one, other in pairwise(wire))

    def _on_line(self, one: Point, other: Point) -> bool:
        (left, right), (top, bottom) = sorted((one[0], other[0])), sorted((one[1], other[1]))
        first = bisect_right(self._tops, top - self._highest)
        last = bisect_left(self._tops, bottom if bottom > top else top + 1)
        return any(
            box.left < right + (left == right)
            and left < box.right
            and box.top < bottom + (top == bottom)
            and top < box.bottom
            for box in self._boxes[first:last]
        )


def _sources(symbol: DrawnSymbol, symbols: Mapping[int, object]) -> Iterator[int]:
    """Yield the sources of the wires into a symbol."""
    yield from (c.source for pin in symbol.inputs for c in pin.connections if c.source in symbols)


def _links(drawing: Drawing, symbols: Mapping[int, _Placed]) -> Iterator[_Link]:
    """Yield the wires of the flow."""
    for symbol in drawing.symbols:
        for pin in symbol.inputs if symbol.id in symbols else ():
            for connection in pin.connections:
                if connection.source in symbols:
                    user, source = symbols[symbol.id], symbols[connection.source]
                    yield _Link(user, source, _routed(list(connection.points or ()), user, source))


def _routed(points: Wire, user: _Placed, source: _Placed) -> Wire:
    """Return a wire in right angles that ends at the symbols as they are drawn here.

    Its bends are those of the file, if there it ends at these symbols too.
    """
    into, out = (user.box.axis, user.box.top), (source.box.axis, source.box.bottom)
    inner: Wire = []
    if len(points) > 1 and _meets(points[0], user.box, user.box.top) and _meets(points[-1], source.box, out[1]):
        inner = points[1:-1]
        into, out = (_within(points[0][0], user), into[1]), (_within(points[-1][0], source), out[1])
        if inner and inner[0][0] == points[0][0]:
            inner[0] = (into[0], inner[0][1])
        if inner and inner[-1][0] == points[-1][0]:
            inner[-1] = (out[0], inner[-1][1])
    elif user.shown is None:
        into = (_within(out[0], user), into[1])
    elif source.shown is None:
        out = (_within(into[0], source), out[1])
    path = [into]
    for point in [*inner, out]:
        before = path[-1]
        if before[0] != point[0] and before[1] != point[1]:
            level = before[1] - _BEND if before == into else point[1] + _BEND if point == out else before[1]
            path += [(before[0], level), (point[0], level)]
        path.append(point)
    return _without_spurs(path)


def _without_spurs(path: Wire) -> Wire:
    """Return a wire without ends that lead back on themselves: editors leave such as a bend is moved."""
    found: Wire = []
    for point in path:
        while len(found) > 1 and _turns_back(found[-2], found[-1], point):
            found.pop()
        found.append(point)
    return found


def _turns_back(before: Point, at: Point, after: Point) -> bool:
    return any(
        before[other] == at[other] == after[other] and (at[way] - before[way]) * (after[way] - at[way]) < 0
        for way, other in ((0, 1), (1, 0))
    )


def _meets(end: Point, box: _Box, level: float) -> bool:
    return abs(end[1] - level) <= _NEAR and box.left - _NEAR <= end[0] <= box.right + _NEAR


def _within(x: float, placed: _Placed) -> float:
    """Return where a wire meets a symbol: at its axis, or on a bar where the file has it."""
    box = placed.box
    return min(max(x, box.left), box.right) if placed.shown is None else box.axis
