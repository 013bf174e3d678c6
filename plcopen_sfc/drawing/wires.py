"""Where pins sit on their symbols and how wires run between them."""

from __future__ import annotations

from plcopen_sfc.drawing.logic import node_inputs
from plcopen_sfc.drawing.sizes import ROW_HEIGHT, Sizes, node_size
from plcopen_sfc.drawing.style import BARS, STEPS
from plcopen_sfc.model.conditions import WiredCondition
from plcopen_sfc.model.drawing import Symbol, SymbolKind
from plcopen_sfc.model.network import Block, Connection, InputPin, LeftPowerRail, Node, OutputPin, Point
from plcopen_sfc.model.sfc import SfcNetwork


class Wires:
    """Places pins and wires of a chart whose symbols are placed.

    `only`: these symbols are new; pins and wires that do not touch them stay as they are.
    """

    def __init__(self, chart: SfcNetwork, *, only: frozenset[int] | None = None) -> None:
        self.chart = chart
        self.only = only
        drawing = chart.drawing
        self.symbols = {symbol.id: symbol for symbol in drawing.symbols} if drawing is not None else {}
        self.nodes: dict[int, Node] = {node.id: node for node in chart.logic}
        sizes = Sizes(chart)
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
            for row, pin in enumerate(node_inputs(node)):
                _, _, _, height = self.boxes[node.id]
                self._input(node.id, pin, (0, 30 + 20 * row if isinstance(node, Block) else height // 2))

    def _outputs(self, symbol: Symbol) -> None:
        x, _, width, height = self.boxes[symbol.id]
        if symbol.kind is SymbolKind.EXPRESSION:
            places: list[Point] = [(width, height // 2)]
        elif symbol.kind in BARS and len(symbol.outputs) > 1:
            below = [self._axis(i) for i in self._consumers().get(symbol.id, ())]
            places = [(min(max(axis - x, 0), width), height) for axis in below]
        else:
            places = [(width / 2 if symbol.kind not in BARS else self._axis(symbol.id) - x, height)]
        for position, pin in enumerate(symbol.outputs):
            self._output(pin, places[min(position, len(places) - 1)] if places else (0, height))
        if symbol.action_output is not None:
            self._output(symbol.action_output, (width, height // 2))

    def _node_outputs(self, node: Node) -> None:
        _, _, width, height = self.boxes[node.id]
        if isinstance(node, Block):
            for row, variable in enumerate((*node.parameters.in_outs, *node.parameters.outputs)):
                if variable.output is not None:
                    self._output(variable.output, (width, 30 + 20 * row))
        elif isinstance(node, LeftPowerRail):
            for pin in node.outputs:
                self._output(pin, (width, height // 2))
        else:
            pin_or_none = getattr(node, "output", None)
            if pin_or_none is not None:
                self._output(pin_or_none, (width, height // 2))

    def _output(self, pin: OutputPin, place: Point) -> None:
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
        """Where the flow runs through a symbol; through a bar, below what leads to it or above what it leads to."""
        x, _, width, _ = self.boxes[number]
        symbol = self.symbols.get(number)
        if symbol is None or symbol.kind not in BARS:
            return x + width / 2
        return x + 10

    def _entry(self, symbol: Symbol, pin: InputPin) -> Point:
        x, _, width, _ = self.boxes[symbol.id]
        if symbol.kind is SymbolKind.ACTION_BLOCK:
            return (0, ROW_HEIGHT // 2)
        if symbol.kind in BARS:
            axes = [self._axis(c.source) for c in pin.connections if c.source in self.boxes]
            return (min(max(axes[0] - x if axes else 10, 0), width), 0)
        return (width / 2, 0)

    def _input(self, owner: int, pin: InputPin, place: Point) -> None:
        if self._is_new(owner):
            pin.position = place
        elif not any(self._is_new(connection.source) for connection in pin.connections):
            return
        # where the file says nothing of the pin, wires to it end where such pins are
        end = pin.position or place
        x, y, _, _ = self.boxes[owner]
        start = (x + end[0], y + end[1])
        for connection in pin.connections:
            if connection.source in self.boxes and (self.only is None or not connection.points):
                sideways = end[0] == 0 and self._leaves_sideways(owner, connection)
                connection.points = _bends(start, self._start_of(connection, start, sideways), sideways=sideways)

    def _leaves_sideways(self, owner: int, connection: Connection) -> bool:
        symbol = self.symbols.get(connection.source)
        consumer = self.symbols.get(owner)
        if symbol is None or symbol.kind is SymbolKind.EXPRESSION:
            return True
        return consumer is None or consumer.kind is SymbolKind.ACTION_BLOCK

    def _start_of(self, connection: Connection, end: Point, sideways: bool) -> Point:
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


def _bends(end: Point, start: Point, *, sideways: bool) -> list[Point]:
    """A wire from its consumer to its producer, in right angles."""
    if sideways:
        if end[1] == start[1]:
            return [end, start]
        middle = end[0] - 10
        return [end, (middle, end[1]), (middle, start[1]), start]
    if end[0] == start[0]:
        return [end, start]
    middle = end[1] - 10
    return [end, (end[0], middle), (start[0], middle), start]
