"""Sizes and places of the symbols of a drawing, of all of them or of new ones, and the wires between their pins.

The wires of a drawing are taken as a graph again, and its dominator tree as a nest of boxes. The box of a symbol holds
the symbol with what belongs to it on top; below, side by side, the boxes of what only this symbol leads to; below
those, one under the other, the boxes of what several of them lead to. Boxes lie inside boxes and beside boxes and never
overlap, the flow runs down, and each branch is as wide as its symbols. One pass up for the sizes and one down for the
places.

Units are those of TC6 editors: about a pixel.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from plcopen_sfc.drawing.attached_symbols import block_owner
from plcopen_sfc.drawing.document_order import feeding, input_pins_of
from plcopen_sfc.drawing.forward_edges import ROOT, ForwardEdges
from plcopen_sfc.grouping import grouped
from plcopen_sfc.model import network as net
from plcopen_sfc.model.conditions import WiredCondition
from plcopen_sfc.model.drawing import BARS, STEPS, ActionEntry, Drawing, Symbol, SymbolKind
from plcopen_sfc.model.sfc import ActionAssociation, SfcNetwork

LETTER = 8
"""Upper bound of the mean width of a letter."""
STEP_HEIGHT = 40
TRANSITION_SIZE = (20, 2)
ROW_HEIGHT = 30
BAR_HEIGHT = {
    SymbolKind.SELECTION_DIVERGENCE: 1,
    SymbolKind.SELECTION_CONVERGENCE: 1,
    SymbolKind.SIMULTANEOUS_DIVERGENCE: 3,
    SymbolKind.SIMULTANEOUS_CONVERGENCE: 3,
}


def even(size: float) -> int:
    """Return the next multiple of 20, so that the middle of every symbol is on the grid."""
    return int(-(-size // 20)) * 20


def text_width(text: str) -> int:
    """Width of the longest line of a text."""
    longest = max((len(line) for line in text.splitlines()), default=0)
    return longest * LETTER


class SymbolSizes:
    """Sizes of the symbols of one chart."""

    def __init__(self, chart: SfcNetwork) -> None:
        self.steps = {step.id: step for step in chart.steps}
        self.transitions = {t.id: t for t in chart.transitions}
        self.associations = {a.id: a for _, a in chart.associations()}
        self.conditions: dict[int, str] = {}
        for symbol in chart.drawing.symbols if chart.drawing is not None else ():
            if symbol.kind is SymbolKind.TRANSITION and symbol.condition is not None:
                for connection in symbol.condition.connections:
                    self.conditions[connection.source] = self.condition_text(symbol)

    def of(self, symbol: Symbol) -> tuple[int, int]:
        """Width and height of a symbol; of a bar the least width."""
        kind = symbol.kind
        if kind is SymbolKind.STEP or kind is SymbolKind.MACRO_STEP:
            step = self.steps.get(symbol.id)
            return even(max(100, text_width(step.name if step is not None else "") + 20)), STEP_HEIGHT
        if kind is SymbolKind.TRANSITION:
            return TRANSITION_SIZE
        if kind is SymbolKind.JUMP:
            target = self.steps.get(symbol.target) if symbol.target is not None else None
            return even(max(40, text_width(target.name if target is not None else symbol.name or "") + 20)), 20
        if kind is SymbolKind.ACTION_BLOCK:
            rows = [self.row_text(symbol, entry) for entry in symbol.entries or ()]
            width = max((text_width(row) for row in rows), default=0)
            return even(max(100, width + 60)), ROW_HEIGHT * max(len(rows), 1)
        if kind is SymbolKind.EXPRESSION:
            return even(max(40, text_width(self.conditions.get(symbol.id, symbol.name or "")) + 10)), 20
        return 20, BAR_HEIGHT[kind]

    def row_text(self, block: Symbol, entry: ActionEntry) -> str:
        """Return the text in a line of an action block."""
        if entry.step_action is None:
            association = self.associations.get(entry.association)
            return _row_text(association) if association is not None else ""
        owners = [self.steps.get(c.source) for pin in block.inputs for c in pin.connections]
        actions = [getattr(step, f"{entry.step_action.value}_action") for step in owners if step is not None]
        return f"P1 {actions[0]}" if actions and isinstance(actions[0], str) else "P1"

    def condition_text(self, symbol: Symbol) -> str:
        """Return the text beside a transition."""
        transition = self.transitions.get(symbol.transitions[0] if symbol.transitions else symbol.id)
        return transition.shown_condition if transition is not None else ""


def _row_text(row: ActionAssociation) -> str:
    text = row.target or ""
    body = getattr(row.body, "text", "") if row.body is not None else ""
    longest = max((text, *str(body).splitlines()), key=len)
    return f"{row.qualifier.value} {row.duration or ''} {longest} {row.indicator or ''}"


def node_size(node: net.Node) -> tuple[int, int]:
    """Width and height of an element of logic: its own, or one that its texts and pins fit in."""
    if isinstance(node, net.Block):
        parameters = node.parameters
        left = [*parameters.inputs, *parameters.in_outs]
        rows = max(len(left), len(parameters.outputs), 1)
        names = max((len(v.name) for v in left), default=0) + max((len(v.name) for v in parameters.outputs), default=0)
        width = max(names * LETTER + 20, text_width(node.type_name) + 20, text_width(node.instance or ""), 60)
        size = (even(width), 20 * rows + 30)
    elif isinstance(node, net.InputVariable | net.OutputVariable | net.InOutVariable):
        size = (even(max(40, text_width(node.expression) + 10)), 20)
    else:
        texts = [getattr(node, name, None) for name in ("variable", "label", "name", "content", "alternative_text")]
        content = next((t if isinstance(t, str) else t.text for t in texts if t is not None), "")
        size = (even(max(20, text_width(content))), 20 * max(1, content.count("\n") + 1))
    return int(max(node.width or 0, size[0])), int(max(node.height or 0, size[1]))


class WireRouting:
    """Places pins and wires of a chart whose symbols are placed.

    `only`: these symbols are new; pins and wires that do not touch them stay as they are.
    """

    def __init__(self, chart: SfcNetwork, *, only: frozenset[int] | None = None) -> None:
        self.chart = chart
        self.only = only
        drawing = chart.drawing
        self.symbols = {symbol.id: symbol for symbol in drawing.symbols} if drawing is not None else {}
        self.nodes: dict[int, net.Node] = {node.id: node for node in chart.logic}
        sizes = SymbolSizes(chart)
        self.boxes: dict[int, tuple[float, float, float, float]] = {}
        for symbol in self.symbols.values():
            width, height = sizes.of(symbol)
            own = (symbol.width or width, symbol.height or height)
            self.boxes[symbol.id] = (*symbol.position, *own)
        for node in chart.logic:
            width, height = node_size(node)
            self.boxes[node.id] = (*node.position, node.width or width, node.height or height)

    def run(self) -> None:
        """Place everything."""
        for symbol in self.symbols.values():
            if self._is_new(symbol.id):
                self._outputs(symbol)
        for node in self.nodes.values() if self.only is None else ():
            self._node_outputs(node)
        conditions = {t.id: t.condition for t in self.chart.transitions}
        for symbol in self.symbols.values():
            for pin in symbol.inputs:
                self._input(symbol.id, pin, self._entry(symbol, pin))
            if symbol.condition is not None:
                self._input(symbol.id, symbol.condition, (0, self.boxes[symbol.id][3] / 2))
            condition = conditions.get(symbol.id) if symbol.kind is SymbolKind.TRANSITION else None
            if isinstance(condition, WiredCondition):
                self._input(symbol.id, condition.input, (0, self.boxes[symbol.id][3] / 2))
            for row, line in enumerate(symbol.entries or ()):
                if self._is_new(symbol.id):
                    line.position = (0, ROW_HEIGHT * row)
        for node in self.nodes.values():
            for row, pin in enumerate(input_pins_of(node)):
                _, _, _, height = self.boxes[node.id]
                self._input(node.id, pin, (0, 30 + 20 * row if isinstance(node, net.Block) else height // 2))

    def _outputs(self, symbol: Symbol) -> None:
        x, _, width, height = self.boxes[symbol.id]
        if symbol.kind is SymbolKind.EXPRESSION:
            places: list[net.Point] = [(width, height // 2)]
        elif symbol.kind in BARS and len(symbol.outputs) > 1:
            below = [self._axis(i) for i in self._consumers().get(symbol.id, ())]
            places = [(min(max(axis - x, 0), width), height) for axis in below]
        else:
            places = [(width / 2 if symbol.kind not in BARS else self._axis(symbol.id) - x, height)]
        for position, pin in enumerate(symbol.outputs):
            self._output(pin, places[min(position, len(places) - 1)] if places else (0, height))
        if symbol.action_output is not None:
            self._output(symbol.action_output, (width, height // 2))

    def _node_outputs(self, node: net.Node) -> None:
        _, _, width, height = self.boxes[node.id]
        if isinstance(node, net.Block):
            for row, variable in enumerate((*node.parameters.in_outs, *node.parameters.outputs)):
                if variable.output is not None:
                    self._output(variable.output, (width, 30 + 20 * row))
        elif isinstance(node, net.LeftPowerRail):
            for pin in node.outputs:
                self._output(pin, (width, height // 2))
        else:
            pin_or_none = getattr(node, "output", None)
            if pin_or_none is not None:
                self._output(pin_or_none, (width, height // 2))

    def _output(self, pin: net.OutputPin, place: net.Point) -> None:
        pin.position = place

    def _is_new(self, number: int) -> bool:
        return self.only is None or number in self.only

    def _consumers(self) -> dict[int, list[int]]:
        if not hasattr(self, "_consumer_lists"):
            self._consumer_lists: dict[int, list[int]] = {}
            for symbol in self.symbols.values():
                for pin in symbol.inputs:
                    for connection in pin.connections:
                        self._consumer_lists.setdefault(connection.source, []).append(symbol.id)
        return self._consumer_lists

    def _axis(self, number: int) -> float:
        """Return the x at which the flow runs through a symbol; of a bar, near its left end."""
        x, _, width, _ = self.boxes[number]
        symbol = self.symbols.get(number)
        if symbol is None or symbol.kind not in BARS:
            return x + width / 2
        return x + 10

    def _entry(self, symbol: Symbol, pin: net.InputPin) -> net.Point:
        x, _, width, _ = self.boxes[symbol.id]
        if symbol.kind is SymbolKind.ACTION_BLOCK:
            return (0, ROW_HEIGHT // 2)
        if symbol.kind in BARS:
            axes = [self._axis(c.source) for c in pin.connections if c.source in self.boxes]
            return (min(max(axes[0] - x if axes else 10, 0), width), 0)
        return (width / 2, 0)

    def _input(self, owner: int, pin: net.InputPin, place: net.Point) -> None:
        if self._is_new(owner):
            pin.position = place
        elif not any(self._is_new(connection.source) for connection in pin.connections):
            return
        # a file may have no place for the pin: wires to it end where such pins usually are
        end = pin.position or place
        x, y, _, _ = self.boxes[owner]
        start = (x + end[0], y + end[1])
        for connection in pin.connections:
            if connection.source in self.boxes and (self.only is None or not connection.points):
                sideways = end[0] == 0 and self._leaves_sideways(owner, connection)
                connection.points = _bends(start, self._start_of(connection, start, sideways), sideways=sideways)

    def _leaves_sideways(self, owner: int, connection: net.Connection) -> bool:
        symbol = self.symbols.get(connection.source)
        consumer = self.symbols.get(owner)
        if symbol is None or symbol.kind is SymbolKind.EXPRESSION:
            return True
        return consumer is None or consumer.kind is SymbolKind.ACTION_BLOCK

    def _start_of(self, connection: net.Connection, end: net.Point, sideways: bool) -> net.Point:
        x, y, width, height = self.boxes[connection.source]
        symbol = self.symbols.get(connection.source)
        if sideways and symbol is not None and symbol.kind in STEPS:
            own = symbol.action_output.position if symbol.action_output is not None else None
            return (x + own[0], y + own[1]) if own is not None else (x + width, y + height // 2)
        if symbol is not None and symbol.kind in BARS:
            inside = x <= end[0] <= x + width
            return (end[0] if inside else self._axis(symbol.id), y + height)
        if sideways:
            return (x + width, y + height // 2)
        return (x + width / 2, y + height)


def _bends(end: net.Point, start: net.Point, *, sideways: bool) -> list[net.Point]:
    """Return a wire from its consumer to its producer, in right angles."""
    if sideways:
        if end[1] == start[1]:
            return [end, start]
        middle = end[0] - 10
        return [end, (middle, end[1]), (middle, start[1]), start]
    if end[0] == start[0]:
        return [end, start]
    middle = end[1] - 10
    return [end, (end[0], middle), (start[0], middle), start]


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
        self.nodes: dict[int, net.Node] = {node.id: node for node in chart.logic}
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
            # what one way leads to is a column below the symbol before it; where ways meet, the symbol is below all of
            # their columns: it belongs to the last symbol that all ways have passed
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
            nodes = [i for i in feeding(pin, self.nodes) if i not in taken]
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
        """Return elements of logic in columns, the nearest to the transition first."""
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
        columns = grouped((depth[number], number) for number in numbers)
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
        loose: list[Symbol | net.Node] = [
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
