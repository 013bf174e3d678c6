"""Places of the symbols of a chart in a picture, and the wires between them.

The chart comes as nested branches (`chart_nesting`). A segment is a column of symbols around an axis, a divergence sets
columns side by side; columns lie beside each other and never overlap, so nothing in them does. The line through a
divergence is straight: the axis of the first branch that goes on is that of the divergence. Links that do not nest are
no wires across the picture but references: arrows with the name of the other end, as in IEC 60848 and TIA Portal. No
wire crosses another. One pass up for the sizes and one down for the places, in time linear in the size of the chart.

Columns are set beside each other as close as their outlines allow, not their bounding boxes: a short branch needs no
room beside the lower part of a long one.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from plcopen_sfc.drawing.chart_nesting import ChartGraph, ChartSegment, NestedDivergence, NestedJump, NestedNode, nest
from plcopen_sfc.drawing.pictures.svg_canvas import DOUBLE, Canvas
from plcopen_sfc.drawing.pictures.symbol_facts import PictureSheet
from plcopen_sfc.drawing.pictures.symbol_pictures import JumpSymbol, StepSymbol, Symbol, TransitionSymbol

Outline = list[tuple[int, int]]
"""Bands from the top down, each as the level of its lower edge and how far it reaches."""

_MOST_BANDS = 96
"""Outlines are kept this short, so that deeply nested charts are placed in linear time."""


def shifted(outline: Outline, down: int, aside: int) -> Outline:
    """Return an outline moved down and to its side."""
    return [(level + down, reach + aside) for level, reach in outline]


def over(one: Outline, other: Outline) -> Outline:
    """Return the outline around two things with the same axis and top."""
    found: Outline = []
    i = j = 0
    while i < len(one) and j < len(other):
        (upper, near), (lower, far) = one[i], other[j]
        # without min and max: these steps are a fifth of the time of a picture
        found.append((upper if upper < lower else lower, near if near > far else far))
        i += upper <= lower
        j += lower <= upper
    return _short([*found, *one[i:], *other[j:]])


def stacked(outlines: Iterable[tuple[Outline, int]]) -> Outline:
    """Return the outline of things below each other, each given with its height."""
    found: Outline = []
    top = 0
    for outline, height in outlines:
        found += shifted(outline, top, 0)
        top += height
        if outline and outline[-1][0] < height:
            found.append((top, outline[-1][1]))
    return _short(found)


def distance(right: Outline, left: Outline) -> int:
    """Return how far apart two axes have to be at least, for the right side of one thing and the left of the next."""
    nearest = 0
    i = j = 0
    while i < len(right) and j < len(left):
        (upper, near), (lower, far) = right[i], left[j]
        nearest = max(nearest, near + far)
        i += upper <= lower
        j += lower <= upper
    return nearest


def reach(outline: Outline) -> int:
    """Return how far an outline reaches at all."""
    return max((each for _, each in outline), default=0)


def _short(outline: Outline) -> Outline:
    while len(outline) > _MOST_BANDS:
        pairs = zip(outline[::2], outline[1::2], strict=False)
        rest = [outline[-1]] if len(outline) % 2 else []
        outline = [(lower, one if one > other else other) for (_, one), (lower, other) in pairs] + rest
    return outline


_BETWEEN_BRANCHES = 26
_BETWEEN_SEGMENTS = 48
_BAR_LEAD = 12
_OVERHANG = 16
_WIRE = 12
_LONG_LINE = 240


@dataclass(slots=True)
class _Fan:
    """A divergence: `columns` side by side, their axes at `offsets` from its own.

    `joined`: columns that go on below. `shares_bottom`: its last bar is that of the divergence around it. `ends`: the
    axes of the lines that lead down from it. `last`: the last step of its longest column, by its id.
    """

    parallel: bool
    columns: list[_Column]
    joined: list[bool]
    lead: int = 0
    star: bool = False
    shares_bottom: bool = False
    offsets: list[int] = field(default_factory=list)
    left: Outline = field(default_factory=list)
    right: Outline = field(default_factory=list)
    ends: list[int] = field(default_factory=list)
    inner: int = 0
    height: int = 0
    last: int | None = None

    def measure(self) -> None:
        """Set the size from the columns, which are measured already."""
        self.last = max(self.columns, key=lambda column: column.height).last
        if len(self.columns) == 1:
            self.lead = 0
        self.inner = max(column.height for column in self.columns) + (8 if self.converges else 0)
        self.height = self.top + self.inner + self.bottom
        places: list[int] = []
        sides = [
            column.sides(self.inner, joined=joined) for column, joined in zip(self.columns, self.joined, strict=True)
        ]
        edge: Outline = []
        for left, right in sides:
            places.append(distance(edge, left) + _BETWEEN_BRANCHES if places else 0)
            edge = over(edge, shifted(right, 0, places[-1]))
        trunk = places[next((i for i, joined in enumerate(self.joined) if joined), 0)]
        self.offsets = [place - trunk for place in places]
        overhang = _OVERHANG if self.parallel else 2
        self.ends = [0]
        for column, offset, joined in zip(self.columns, self.offsets, self.joined, strict=True):
            if joined:
                self.ends += (offset + end for end in column.ends)
        self.left, self.right = [], []
        for (left, right), offset in zip(sides, self.offsets, strict=True):
            self.left = over(self.left, shifted(left, self.top, -offset))
            self.right = over(self.right, shifted(right, self.top, offset))
        self.left = over(self.left, [(self.top, overhang - self.offsets[0])])
        self.right = over(self.right, [(self.top, overhang + self.offsets[-1])])
        if self.bottom:
            self.left.append((self.height, overhang - min(self.ends)))
            self.right.append((self.height, overhang + max(self.ends)))

    @property
    def trunk(self) -> _Column:
        """The column in which the line through the divergence runs."""
        return self.columns[next((i for i, joined in enumerate(self.joined) if joined), 0)]

    @property
    def top(self) -> int:
        """Height of the bar above the columns with the wire to it."""
        return 0 if len(self.columns) == 1 else self.lead + (DOUBLE if self.parallel else 0)

    @property
    def bottom(self) -> int:
        """Height of the bar below the columns with the wire from it."""
        return 8 + (DOUBLE if self.parallel else 0) if self.converges else 0

    @property
    def converges(self) -> bool:
        """True if a bar of its own joins the columns."""
        return sum(self.joined) > 1 and not self.shares_bottom

    def draw(self, canvas: Canvas, x: int, y: int, *, leaves: bool, floor: int) -> Iterator[_PlacedColumn]:
        """Draw bars and wires; yield the columns with their places. `floor`: the level of the bar that is shared."""
        axes = [x + offset for offset in self.offsets]
        top = y + self.top
        if len(self.columns) > 1:
            if self.lead > 0:
                canvas.wire((x, y), (x, y + self.lead))
            _bar(canvas, axes, y + self.lead, parallel=self.parallel)
            if self.star:
                canvas.star(x + 6, y + self.lead + 1)
        bottom = floor if self.shares_bottom else top + self.inner
        ends = []
        for column, axis, joined in zip(self.columns, axes, self.joined, strict=True):
            yield _PlacedColumn(column, axis, top, joined and leaves, bottom)
            if joined and leaves:
                ends.append(axis)
                canvas.wire((axis, top + column.height), (axis, bottom))
        if len(ends) > 1:
            _bar(canvas, ends, bottom, parallel=self.parallel)
        if ends and not self.shares_bottom:
            canvas.wire((x, bottom + (DOUBLE if self.parallel and len(ends) > 1 else 0)), (x, y + self.height))


class _PlacedColumn(NamedTuple):
    """A column with its axis and top. `leaves`: the line goes on below it, to a bar at the level `floor`."""

    column: _Column
    axis: int
    top: int
    leaves: bool
    floor: int


def _bar(canvas: Canvas, axes: Sequence[int], y: int, *, parallel: bool) -> None:
    overhang = _OVERHANG if parallel else 0
    canvas.bar(min(axes) - overhang, max(axes) + overhang, y, parallel=parallel)


@dataclass(slots=True)
class _Column:
    """Symbols and divergences below each other.

    `enters[i]`: a wire leads from above into item i. `ends`: the axes of the lines that lead down from it. `last`: its
    last step, by its id.
    """

    items: list[Symbol | _Fan] = field(default_factory=list)
    enters: list[bool] = field(default_factory=list)
    left: Outline = field(default_factory=list)
    right: Outline = field(default_factory=list)
    ends: list[int] = field(default_factory=list)
    height: int = 0
    last: int | None = None

    def measure(self) -> None:
        """Set the size from the items, which are measured already."""
        lasts = (
            each.last if isinstance(each, _Fan) else each.step.id
            for each in reversed(self.items)
            if isinstance(each, _Fan | StepSymbol)
        )
        self.last = next((each for each in lasts if each is not None), None)
        self.left = stacked((_outline(item.left, item.height), item.height) for item in self.items)
        self.right = stacked((_outline(item.right, item.height), item.height) for item in self.items)
        self.height = sum(item.height for item in self.items)
        last = self.items[-1] if self.items else None
        self.ends = last.ends if isinstance(last, _Fan) and last.shares_bottom else [0]

    def sides(self, height: int, *, joined: bool) -> tuple[Outline, Outline]:
        """Return its outlines; of a column that is `joined` with the lines below it, down to `height`."""
        if not joined:
            return self.left, self.right
        below = height - self.height
        return (
            stacked([(self.left, self.height), ([(below, _WIRE - min(self.ends))], below)]),
            stacked([(self.right, self.height), ([(below, _WIRE + max(self.ends))], below)]),
        )

    def go_on(self) -> None:
        """Prepare the column for items below its last one: that has a bar of its own now."""
        last = self.items[-1] if self.items else None
        if isinstance(last, _Fan) and last.shares_bottom:
            last.shares_bottom = False
            last.measure()


def _outline(side: int | Outline, height: int) -> Outline:
    return [(height, side)] if isinstance(side, int) else side


class StepLevel(NamedTuple):
    """The level of the box of a step, and the id of the step above that moves it down when it is moved."""

    top: int
    before: int | None


class Arrangement:
    """A chart with the size of its picture, ready to be drawn."""

    def __init__(self, sheet: PictureSheet) -> None:
        self._sheet = sheet
        self._graph, segments = nest(sheet.chart, {}, lines=True)
        self._links = _Links(self._graph, segments)
        made: dict[int, _Column] = {}
        for segment in reversed(self._links.order):
            made[id(segment)] = self._column(segment, made)
        self._columns = [made[id(segment)] for segment in segments]
        corners = list(self._corners())
        self.width = max((x + reach(each.left) + reach(each.right) for each, x, _ in corners), default=0)
        self.height = max((y + each.height for each, _, y in corners), default=0)

    def with_room(self, room: Mapping[int, int]) -> Arrangement:
        """Return the chart with longer wires above steps: how much longer, by their ids."""
        return Arrangement(replace(self._sheet, room=room))

    @property
    def levels(self) -> dict[int, StepLevel]:
        """The level of each step by its id, and the step above that moves it down when it is moved."""
        found: dict[int, StepLevel] = {}
        walk: list[tuple[_Column, int, int | None]] = [(column, y, None) for column, _, y in self._corners()]
        while walk:
            column, y, before = walk.pop()
            for item in column.items:
                if isinstance(item, _Fan):
                    walk += ((inner, y + item.top, before) for inner in item.columns)
                    before = item.last if item.last is not None else before
                elif isinstance(item, StepSymbol):
                    found[item.step.id] = StepLevel(y + item.lead, before)
                    before = item.step.id
                y += item.height
        return found

    def _corners(self) -> Iterator[tuple[_Column, int, int]]:
        """Yield the columns of the chart with their upper left corners: side by side, or below each other."""
        x = y = 0
        for column in self._columns:
            yield column, x, y
            if self._sheet.narrow:
                y += column.height + _BETWEEN_SEGMENTS
            else:
                x += reach(column.left) + reach(column.right) + _BETWEEN_SEGMENTS

    def draw(self, canvas: Canvas, left: int, top: int) -> None:
        """Draw the chart with its upper left corner at `left`, `top`."""
        corners = self._corners()
        pending = [_PlacedColumn(each, left + x + reach(each.left), top + y, False, 0) for each, x, y in corners]
        pending.reverse()
        while pending:
            column, axis, y, goes_on, floor = pending.pop()
            inner: list[_PlacedColumn] = []
            for number, item in enumerate(column.items):
                leaves = column.enters[number + 1] if number + 1 < len(column.items) else goes_on
                if isinstance(item, _Fan):
                    inner += item.draw(canvas, axis, y, leaves=leaves, floor=floor)
                else:
                    item.draw(canvas, axis, y, enters=column.enters[number], leaves=leaves)
                y += item.height
            pending += reversed(inner)

    def _column(self, segment: ChartSegment, made: dict[int, _Column]) -> _Column:
        """Return the column of a segment.

        Where one branch of a divergence goes on, what follows is drawn in the column of this branch: so the other
        branches do not push it down.
        """
        column = _Column()
        opened: list[tuple[_Column, _Fan]] = []
        above = self._links.above.get(id(segment))
        for position, item in enumerate(segment.items):
            here = opened[-1][1].trunk if opened else column
            enters = above is not None if position == 0 else True
            if isinstance(item, NestedDivergence):
                following = segment.items[position + 1] if position + 1 < len(segment.items) else None
                alike = above is not None and above.parallel is item.parallel
                fan = self._fan(item, made, flush=position == 0 and alike)
                if not fan.columns:
                    continue
                if isinstance(following, NestedJump):
                    self._jump_early(fan, following.target)
                single = sum(fan.joined) == 1
                fan.shares_bottom = segment.joined and (single or (alike and following is None))
                here.items.append(fan)
                if single:
                    fan.trunk.go_on()
                    opened.append((here, fan))
                else:
                    fan.measure()
            elif isinstance(item, NestedJump):
                here.items.append(JumpSymbol(self._sheet, item.target))
            else:
                enters = enters and (not item.loose or self._links.wired(segment, position))
                here.items.append(self._node(item.node))
            here.enters.append(enters)
        for around, fan in reversed(opened):
            fan.trunk.measure()
            fan.measure()
            around.measure()
        column.measure()
        return column

    def _node(self, number: int) -> Symbol:
        sheet, links = self._sheet, self._links
        if number in sheet.steps:
            entries = [sheet.transition_reference(i) for i in links.jumps.get(number, ())]
            exits = [sheet.transition_reference(i) for i in links.exits.get(number, ())]
            return StepSymbol(sheet, number, entries, exits)
        joint = self._graph.joints[number]
        competing = any(len(self._graph.successors[source]) > 1 for source in joint.sources)
        waits = [sheet.step_reference(i) for i in links.waits.get(number, ())]
        return TransitionSymbol(sheet, number, waits, competing=competing)

    def _jump_early(self, fan: _Fan, target: int) -> None:
        """Let short branches before a jump have jumps of their own, instead of long lines to the common one.

        One branch keeps the common jump.
        """
        going = [column.height for column, joined in zip(fan.columns, fan.joined, strict=True) if joined]
        longest = max(going, default=0)
        for number, column in enumerate(fan.columns):
            if fan.joined[number] and longest - column.height > _LONG_LINE:
                fan.joined[number] = False
                column.go_on()
                column.items.append(JumpSymbol(self._sheet, target))
                column.enters.append(True)
                column.measure()

    def _fan(self, divergence: NestedDivergence, made: dict[int, _Column], *, flush: bool) -> _Fan:
        columns = [made[id(branch)] for branch in divergence.branches]
        kept = [i for i, column in enumerate(columns) if column.items or divergence.branches[i].joined]
        fan = _Fan(divergence.parallel, [columns[i] for i in kept], [divergence.branches[i].joined for i in kept])
        fan.lead = _BAR_LEAD if not flush else -DOUBLE if divergence.parallel else 0  # flush: one bar with that above
        fan.star = self._sheet.stars and not flush and self._links.is_unnumbered(divergence)
        return fan


@dataclass(frozen=True, slots=True)
class _Above:
    """Surroundings above a branch: its segment, the place of the divergence in it, and whether that is simultaneous."""

    segment: ChartSegment
    position: int
    parallel: bool


class _Links:
    """Links of a chart: those that are wires and those that are references.

    `jumps`: transitions that jump to a step; `waits`: steps that a transition waits for without a wire; `exits`: such
    transitions by their steps. `order`: all segments, outer ones first. `above`: what branches hang on, by their ids.
    """

    def __init__(self, graph: ChartGraph, segments: Sequence[ChartSegment]) -> None:
        self.graph = graph
        self.order: list[ChartSegment] = list(segments)
        self.above: dict[int, _Above] = {}
        self.jumps: dict[int, list[int]] = {}
        self.waits: dict[int, list[int]] = {}
        self.exits: dict[int, list[int]] = {}
        for segment in self.order:  # grows while it is walked
            for position, item in enumerate(segment.items):
                if isinstance(item, NestedDivergence):
                    self.order += item.branches
                    for branch in item.branches:
                        self.above[id(branch)] = _Above(segment, position, item.parallel)
        for segment in self.order:
            for position, item in enumerate(segment.items):
                if isinstance(item, NestedJump):
                    self.jumps.setdefault(item.target, []).extend(self._flowing_into(segment, position))
                elif isinstance(item, NestedNode) and item.loose:
                    self._wait(segment, position, item.node)

    def wired(self, segment: ChartSegment, position: int) -> bool:
        """True if the item before a loose transition is wired to it: all that flows out of it is waited for."""
        flowing = self._flowing_into(segment, position)
        sources = self.graph.joints[_node_at(segment, position)].sources
        before = segment.items[position - 1] if position else None
        together = not isinstance(before, NestedDivergence) or before.parallel
        return bool(flowing) and together and set(flowing) <= set(sources)

    def is_unnumbered(self, divergence: NestedDivergence) -> bool:
        """True if competing transitions of a selection have no priorities: they are tried from left to right."""
        if divergence.parallel:
            return False
        first = [branch.items[0] for branch in divergence.branches if branch.items]
        joints = [self.graph.joints.get(item.node) for item in first if isinstance(item, NestedNode)]
        return all(joint is not None and joint.members[0].priority is None for joint in joints)

    def _wait(self, segment: ChartSegment, position: int, transition: int) -> None:
        wired = self._flowing_into(segment, position) if self.wired(segment, position) else []
        for step in self.graph.joints[transition].sources:
            if step not in wired:
                self.waits.setdefault(transition, []).append(step)
                self.exits.setdefault(step, []).append(transition)

    def _flowing_into(self, segment: ChartSegment, position: int) -> list[int]:
        """Steps or transitions from which the line comes into an item of a segment, through divergences."""
        found: list[int] = []
        pending = [(segment, position)]
        while pending:
            here, at = pending.pop()
            if at == 0:
                above = self.above.get(id(here))
                if above is not None:
                    pending.append((above.segment, above.position))
                continue
            before = here.items[at - 1]
            if isinstance(before, NestedNode):
                found.append(before.node)
            elif isinstance(before, NestedDivergence):
                pending += [(b, len(b.items)) for b in reversed(before.branches) if b.joined]
        return found


def _node_at(segment: ChartSegment, position: int) -> int:
    item = segment.items[position]
    return item.node if isinstance(item, NestedNode) else -1
