"""Places of the symbols of a drawing: of all of them, or of single new ones near what they follow.

The wires of a drawing are taken as a graph again, and its dominator tree as a nest of boxes. The box of a symbol holds
the symbol with what belongs to it on top; below, side by side, the boxes of what only this symbol leads to; below
those, one under the other, the boxes of what several of them lead to. Boxes lie inside boxes and beside boxes and never
overlap, the flow runs down, and each branch is as wide as its symbols. One pass up for the sizes and one down for
the places.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from plcopen_sfc.drawing.attached_symbols import block_owner
from plcopen_sfc.drawing.chart_graph import ROOT, ForwardEdges
from plcopen_sfc.drawing.document_order import feeding, input_pins_of
from plcopen_sfc.drawing.symbol_wires import SymbolSizes, WireRouting, node_size, text_width
from plcopen_sfc.model.conditions import WiredCondition
from plcopen_sfc.model.drawing import BARS, Drawing, Symbol, SymbolKind
from plcopen_sfc.model.network import Node
from plcopen_sfc.model.sfc import SfcNetwork

_MARGIN = 20
_DOWN = 30
_ASIDE = 40
_GAP = 30  # between a new symbol and the one it follows

_Area = tuple[float, float, float, float]
"""Left, top, width and height."""


def has_positions(drawing: Drawing) -> bool:
    """True if the drawing has places for its symbols: some position is not 0, 0."""
    return any(symbol.position != (0, 0) for symbol in drawing.symbols)


def layout(chart: SfcNetwork) -> None:
    """Give every symbol and element of logic in the chart a place and a size, and every pin and wire its points."""
    if chart.drawing is not None:
        _Layout(chart, chart.drawing).run()


@dataclass(slots=True)
class _Box:
    """A symbol with everything below it. `left` and `right` are counted from the axis that the flow runs along."""

    left: int
    right: int
    own_height: int
    height: int
    branches: list[int] = field(default_factory=list)
    merges: list[int] = field(default_factory=list)


class _Layout:
    def __init__(self, chart: SfcNetwork, drawing: Drawing) -> None:
        self.chart = chart
        self.sizes = SymbolSizes(chart)
        self.symbols = {symbol.id: symbol for symbol in drawing.symbols}
        self.nodes: dict[int, Node] = {node.id: node for node in chart.logic}
        self.blocks: dict[int, list[Symbol]] = {}
        self.expressions: dict[int, list[int]] = {}
        self.logic: dict[int, list[int]] = {}
        self.boxes: dict[int, _Box] = {}
        self.axes: dict[int, int] = {}

    def run(self) -> None:
        self.assign()
        flow = [s for s in self.symbols.values() if s.kind not in (SymbolKind.ACTION_BLOCK, SymbolKind.EXPRESSION)]
        self.edges = ForwardEdges(
            {s.id: targets for s, targets in zip(flow, self.targets(flow), strict=True)}, self.starts(flow)
        )
        order = sorted(self.edges.rank, key=self.edges.rank.__getitem__)
        self.boxes = {number: self.own_box(self.symbols[number]) for number in order}
        self.boxes[ROOT] = _Box(0, 0, 0, 0)
        for number in order:
            parent = self.boxes[self.edges.dominator[number]]
            (parent.branches if self.edges.forward_inputs[number] < 2 else parent.merges).append(number)
        for box in self.boxes.values():
            box.branches.sort(key=self.branch_key)
        for number in reversed(order):
            self.measure(self.boxes[number])
        self.measure(self.boxes[ROOT])
        root = self.boxes[ROOT]
        self.place_below(ROOT, _MARGIN + root.left, _MARGIN)
        for number in order:
            self.place(number)
        self.stretch_bars()
        self.place_rest(_MARGIN + root.height + _DOWN)
        WireRouting(self.chart).run()

    def assign(self) -> None:
        """Find out which blocks, expressions and elements of logic belong beside which symbol."""
        for symbol in self.symbols.values():
            owner = block_owner(symbol, self.symbols)
            if owner is not None:
                self.blocks.setdefault(owner, []).append(symbol)
        conditions = {t.id: t.condition for t in self.chart.transitions}
        taken: set[int] = set()
        for symbol in self.symbols.values():
            if symbol.kind is not SymbolKind.TRANSITION:
                continue
            condition = conditions.get(symbol.transitions[0] if symbol.transitions else symbol.id)
            pin = condition.input if isinstance(condition, WiredCondition) else symbol.condition
            if pin is None:
                continue
            drawn = [c.source for c in pin.connections if c.source in self.symbols and c.source not in taken]
            drawn = [i for i in drawn if self.symbols[i].kind is SymbolKind.EXPRESSION]
            nodes = [i for i in feeding([pin], self.nodes) if i not in taken]
            self.expressions[symbol.id], self.logic[symbol.id] = drawn, nodes
            taken.update(drawn, nodes)
        self.taken = taken

    def starts(self, flow: list[Symbol]) -> list[int]:
        initial = {step.id for step in self.chart.steps if step.initial}
        return [s.id for s in flow if s.id in initial] + [
            s.id for s in flow if not any(c.source in self.symbols for pin in s.inputs for c in pin.connections)
        ]

    def targets(self, flow: list[Symbol]) -> list[list[int]]:
        consumers: dict[int, list[int]] = {}
        for symbol in flow:
            for source in dict.fromkeys(c.source for pin in symbol.inputs for c in pin.connections):
                consumers.setdefault(source, []).append(symbol.id)
        self.consumers = consumers
        return [consumers.get(symbol.id, []) for symbol in flow]

    def branch_key(self, number: int) -> tuple[bool, int, int]:
        """Order competing transitions from left to right as they are tried, other branches as they are drawn."""
        priority = self.priority(number)
        return (priority is None, priority or 0, self.position(number))

    def position(self, number: int) -> int:
        if not hasattr(self, "_positions"):
            self._positions = {i: position for position, i in enumerate(self.symbols)}
        return self._positions[number]

    def priority(self, number: int) -> int | None:
        if not hasattr(self, "_priorities"):
            self._priorities = {t.id: t.priority for t in self.chart.transitions}
        # a divergence in a divergence has the priority of its first transition; drawings from files may have loops here
        seen = {number}
        while self.symbols[number].kind is SymbolKind.SELECTION_DIVERGENCE and self.consumers.get(number):
            number = self.consumers[number][0]
            if number in seen:
                break
            seen.add(number)
        return self._priorities.get(number) if self.symbols[number].kind is SymbolKind.TRANSITION else None

    def own_box(self, symbol: Symbol) -> _Box:
        """Return the room for a symbol and the blocks, expressions and logic beside it."""
        width, height = self.sizes.of(symbol)
        left = right = width // 2
        row = max(height, 10)
        blocks = [self.sizes.of(block) for block in self.blocks.get(symbol.id, ())]
        if blocks:
            right += _ASIDE + max(block[0] for block in blocks)
            row = max(row, sum(block[1] + 10 for block in blocks) - 10)
        if symbol.kind is SymbolKind.TRANSITION:
            expressions = [self.sizes.of(self.symbols[i]) for i in self.expressions.get(symbol.id, ())]
            row = max(20, sum(size[1] + 10 for size in expressions))
            left += max((size[0] + _ASIDE for size in expressions), default=0)
            columns = self.columns(self.logic.get(symbol.id, []))
            for column in columns:
                left += max(node_size(self.nodes[i])[0] for i in column) + _ASIDE
                row = max(row, sum(node_size(self.nodes[i])[1] + 10 for i in column))
            if not expressions and not columns:
                right += text_width(self.sizes.condition_text(symbol)) + 10
        return _Box(left + 10, right + 10, row, 0)

    def columns(self, numbers: list[int]) -> list[list[int]]:
        """Elements of logic in columns, the nearest to the transition first."""
        if not numbers:
            return []
        inside = set(numbers)
        # logic may have loops (a feedback), so no column is further left than there are elements
        depth = dict.fromkeys(numbers, 0)
        for number in reversed(numbers):
            for pin in input_pins_of(self.nodes[number]):
                for connection in pin.connections:
                    if connection.source in inside and connection.source != number:
                        depth[connection.source] = min(max(depth[connection.source], depth[number] + 1), len(numbers))
        columns: dict[int, list[int]] = {}
        for number in numbers:
            columns.setdefault(depth[number], []).append(number)
        return [columns[i] for i in sorted(columns)]

    def measure(self, box: _Box) -> None:
        """Set the size of a box from its own row and the boxes inside it, which are measured already."""
        height = box.own_height + _DOWN
        if box.branches:
            branches = [self.boxes[i] for i in box.branches]
            box.left = max(box.left, branches[0].left)
            box.right = max(box.right, sum(branch.left + branch.right for branch in branches) - branches[0].left)
            height += max(branch.height for branch in branches)
        for number in box.merges:
            merge = self.boxes[number]
            box.left, box.right = max(box.left, merge.left), max(box.right, merge.right)
            height += merge.height
        box.height = height

    def place(self, number: int) -> None:
        """Place a symbol whose box has its place, with the symbols beside it, and the boxes inside."""
        symbol, box = self.symbols[number], self.boxes[number]
        axis, top = self.axes[number], self.tops[number]
        width, height = self.sizes.of(symbol)
        down = (box.own_height - height) // 2 if symbol.kind is SymbolKind.TRANSITION else 0
        symbol.position, symbol.width, symbol.height = (axis - width // 2, top + down), width, height
        y = top
        for block in self.blocks.get(number, ()):
            block_width, block_height = self.sizes.of(block)
            block.position = (axis + width // 2 + _ASIDE, y)
            block.width, block.height = block_width, block_height
            y += block_height + 10
        x, y = axis - width // 2, top
        for other in (self.symbols[i] for i in self.expressions.get(number, ())):
            other_width, other_height = self.sizes.of(other)
            other.position = (x - _ASIDE + 10 - other_width, y)
            other.width, other.height = other_width, other_height
            y += other_height + 10
        x -= max((self.sizes.of(self.symbols[i])[0] + _ASIDE for i in self.expressions.get(number, ())), default=0)
        for column in self.columns(self.logic.get(number, [])):
            x -= max(node_size(self.nodes[i])[0] for i in column) + _ASIDE
            y = top
            for node in (self.nodes[i] for i in column):
                node_width, node_height = node_size(node)
                node.position, node.width, node.height = (x + 10, y), node_width, node_height
                y += node_height + 10
        self.place_below(number, axis, top + box.own_height + _DOWN)

    def place_below(self, number: int, axis: int, top: int) -> None:
        """Give the boxes inside a box their places."""
        if number == ROOT:
            self.tops: dict[int, int] = {}
        box = self.boxes[number]
        x = axis
        for position, branch in enumerate(box.branches):
            inside = self.boxes[branch]
            if position:
                x += inside.left
            self.axes[branch], self.tops[branch] = x, top
            x += inside.right
        y = top + max((self.boxes[branch].height for branch in box.branches), default=0)
        for merge in box.merges:
            self.axes[merge], self.tops[merge] = axis, y
            y += self.boxes[merge].height

    def stretch_bars(self) -> None:
        """Let each bar reach over everything that it joins or parts."""
        for number, symbol in self.symbols.items():
            if symbol.kind not in BARS:
                continue
            rank = self.edges.rank
            axes = [self.axes[number]]
            axes += [self.axes[i] for i in self.boxes[number].branches]
            if self.edges.forward_inputs[number] > 1:
                sources = [c.source for pin in symbol.inputs for c in pin.connections if c.source in self.axes]
                axes += [self.axes[i] for i in sources if rank[i] < rank[number] and self.edges.is_forward(i, number)]
            start, end = min(axes), max(axes)
            symbol.position = (start - 10, symbol.position[1])
            symbol.width = end - start + 20

    def place_rest(self, top: int) -> None:
        """Place what belongs to no symbol of the flow below everything."""
        x = _MARGIN
        loose: list[Symbol | Node] = [
            s
            for s in self.symbols.values()
            if s.id not in self.axes
            and s.id not in self.taken
            and not (s.kind is SymbolKind.ACTION_BLOCK and block_owner(s, self.symbols) is not None)
        ]
        loose += [node for node in self.chart.logic if node.id not in self.taken]
        for one in loose:
            width, height = self.sizes.of(one) if isinstance(one, Symbol) else node_size(one)
            one.position, one.width, one.height = (x, top), width, height
            x += width + _ASIDE


def place_nearby(chart: SfcNetwork, followed: Mapping[int, int | None]) -> None:
    """Place the symbols that are keys of `followed`; the value is the symbol that each follows. Nothing else moves."""
    drawing = chart.drawing
    if drawing is None:
        return
    sizes = SymbolSizes(chart)
    symbols = {symbol.id: symbol for symbol in drawing.symbols}
    boxes: dict[int, _Area] = {}
    for symbol in drawing.symbols:
        if symbol.id not in followed:
            width, height = sizes.of(symbol)
            boxes[symbol.id] = (*symbol.position, symbol.width or width, symbol.height or height)
    for node in chart.logic:
        width, height = node_size(node)
        boxes[node.id] = (*node.position, node.width or width, node.height or height)
    below = max((box[1] + box[3] for box in boxes.values()), default=0) + _GAP
    owners = {c.source: s.id for s in drawing.symbols if s.condition is not None for c in s.condition.connections}
    late = [i for i in followed if symbols[i].kind is SymbolKind.EXPRESSION]
    for number in (*(i for i in followed if i not in late), *late):
        symbol = symbols[number]
        width, height = sizes.of(symbol)
        symbol.width, symbol.height = width, height
        anchor = boxes.get(owners.get(number, -1)) or boxes.get(_or(followed[number], -1))
        x, y = _wish(symbol, width, anchor) if anchor is not None else (20, below)
        boxes[number] = _next_free_place((x, y, width, height), list(boxes.values()))
        symbol.position = boxes[number][:2]
    WireRouting(chart, only=frozenset(followed)).run()


def _or(number: int | None, default: int) -> int:
    return default if number is None else number


def _wish(symbol: Symbol, width: int, anchor: _Area) -> tuple[float, float]:
    x, y, anchor_width, anchor_height = anchor
    if symbol.kind is SymbolKind.ACTION_BLOCK:
        return (x + anchor_width + _GAP, y)
    if symbol.kind is SymbolKind.EXPRESSION:
        return (x - width - _GAP, y - 10)
    return (int(x + (anchor_width - width) // 2), y + anchor_height + _GAP)


def _next_free_place(box: _Area, taken: list[_Area]) -> _Area:
    """Return the first free area at the wished one or to the right of it."""
    x, y, width, height = box
    for other in sorted(b for b in taken if b[1] < y + height and y < b[1] + b[3]):
        if other[0] < x + width and x < other[0] + other[2]:
            x = other[0] + other[2] + 10
    return (max(x, 0), y, width, height) if x >= 0 else _next_free_place((0, y, width, height), taken)
