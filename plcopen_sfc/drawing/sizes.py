"""How large symbols are drawn. Units are those of TC6 editors: about a pixel."""

from __future__ import annotations

from plcopen_sfc.model.actions import ActionAssociation
from plcopen_sfc.model.conditions import BodyCondition, Expression, NamedCondition
from plcopen_sfc.model.drawing import ActionEntry, Symbol, SymbolKind
from plcopen_sfc.model.network import Block, InOutVariable, InputVariable, Node, OutputVariable
from plcopen_sfc.model.sfc import SfcNetwork, Transition

LETTER = 8
"""How wide a letter is at most, on average."""
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
    """The next multiple of 20, so that the middle of every symbol is on the grid."""
    return int(-(-size // 20)) * 20


def text_width(text: str) -> int:
    """How much room a text takes."""
    longest = max((len(line) for line in text.splitlines()), default=0)
    return longest * LETTER


class Sizes:
    """The sizes of the symbols of one chart."""

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
        """What stands in a line of an action block."""
        if entry.step_action is None:
            association = self.associations.get(entry.association)
            return _row_text(association) if association is not None else ""
        owners = [self.steps.get(c.source) for pin in block.inputs for c in pin.connections]
        actions = [getattr(step, f"{entry.step_action.value}_action") for step in owners if step is not None]
        return f"P1 {actions[0]}" if actions and isinstance(actions[0], str) else "P1"

    def condition_text(self, symbol: Symbol) -> str:
        """What stands beside a transition."""
        transition = self.transitions.get(symbol.transitions[0] if symbol.transitions else symbol.id)
        return condition_text(transition) if transition is not None else ""


def condition_text(transition: Transition) -> str:
    """The condition of a transition as an editor shows it beside the transition."""
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
