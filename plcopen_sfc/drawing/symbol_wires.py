"""Sizes of symbols, and where their pins sit and how the wires run between them.

Units are those of TC6 editors: about a pixel.
"""

from __future__ import annotations

from plcopen_sfc.drawing.document_order import input_pins_of
from plcopen_sfc.model.actions import ActionAssociation
from plcopen_sfc.model.conditions import BodyCondition, Expression, NamedCondition, WiredCondition
from plcopen_sfc.model.drawing import BARS, STEPS, ActionEntry, Symbol, SymbolKind
from plcopen_sfc.model.network import (
    Block,
    Connection,
    InOutVariable,
    InputPin,
    InputVariable,
    LeftPowerRail,
    Node,
    OutputPin,
    OutputVariable,
    Point,
)
from plcopen_sfc.model.sfc import SfcNetwork, Transition

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
        return condition_text(transition) if transition is not None else ""


def condition_text(transition: Transition) -> str:
    """Return the condition of a transition as an editor shows it beside the transition."""
    condition = transition.condition
    if isinstance(condition, Expression):
        return condition.text
    if isinstance(condition, NamedCondition | BodyCondition):
        return condition.name
    return ""


def _row_text(row: ActionAssociation) -> str:
    text = row.target or ""
    body = getattr(row.body, "text", "") if row.body is not None else ""
    longest = max((text, *str(body).splitlines()), key=len)
    return f"{row.qualifier.value} {row.duration or ''} {longest} {row.indicator or ''}"


def node_size(node: Node) -> tuple[int, int]:
    """Width and height of an element of logic: its own, or one that its texts and pins fit in."""
    if isinstance(node, Block):
        parameters = node.parameters
        left = [*parameters.inputs, *parameters.in_outs]
        rows = max(len(left), len(parameters.outputs), 1)
        names = max((len(v.name) for v in left), default=0) + max((len(v.name) for v in parameters.outputs), default=0)
        width = max(names * LETTER + 20, text_width(node.type_name) + 20, text_width(node.instance or ""), 60)
        size = (even(width), 20 * rows + 30)
    elif isinstance(node, InputVariable | OutputVariable | InOutVariable):
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
        self.nodes: dict[int, Node] = {node.id: node for node in chart.logic}
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
        """Return the x at which the flow runs through a symbol; of a bar, near its left end."""
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
        # a file may have no place for the pin: wires to it end where such pins usually are
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
