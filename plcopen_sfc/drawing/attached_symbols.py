"""Action blocks and drawn expressions: symbols that follow the step or transition they belong to."""

from __future__ import annotations

from plcopen_sfc.drawing.document_order import input_pins_of
from plcopen_sfc.drawing.drawing_style import DrawingStyle
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.drawing import ActionEntry, Drawing, Places, StepActionKind, Symbol, SymbolKind
from plcopen_sfc.model.network import Connection, InputPin, OutputPin
from plcopen_sfc.model.sfc import SfcNetwork, Step


class AttachedSymbols:
    """Adds action blocks and expressions to `symbols`, which holds the flow already.

    `old` and `new` are the symbols of the drawing as it was and of a new one. `wired`: expressions are symbols.
    `kept_for` maps a new symbol to the old one that stays in its place.
    """

    def __init__(
        self,
        chart: SfcNetwork,
        old: dict[int, Symbol],
        new: dict[int, Symbol],
        symbols: dict[int, Symbol],
        *,
        wired: bool,
    ) -> None:
        self.chart = chart
        self.old = old
        self.new = new
        self.symbols = symbols
        self.wired = wired
        self.kept_for: dict[int, int] = {}
        self.new_blocks = {owner: s for s in new.values() if (owner := block_owner(s, new)) is not None}
        self.transitions = {t.id: t for t in chart.transitions}

    def settle(self) -> None:
        """Settle blocks and expressions."""
        blocks: dict[int, list[Symbol]] = {}
        for symbol in self.old.values():
            owner = block_owner(symbol, self.old)
            if owner is not None and owner in self.symbols:
                blocks.setdefault(owner, []).append(symbol)
        for step in self.chart.steps:
            if step.id in self.symbols:
                self._settle_blocks(step, blocks.get(step.id, []))
        used = {c.source for s in self.old.values() if s.condition is not None for c in s.condition.connections}
        for symbol in self.old.values():
            if symbol.kind is SymbolKind.EXPRESSION and symbol.id not in used:
                self.symbols[symbol.id] = symbol
        for symbol in list(self.symbols.values()):
            if symbol.kind is SymbolKind.TRANSITION:
                self._settle_condition(symbol)

    def _settle_blocks(self, step: Step, blocks: list[Symbol]) -> None:
        wanted = [association.id for association in step.actions]
        before = [len(block.entries or ()) for block in blocks]
        for block in blocks:
            kept = [entry for entry in block.entries or () if _belongs(entry, step, wanted)]
            if len(kept) != len(block.entries or ()):
                block.entries = kept
        fresh = self.new_blocks.get(step.id)
        if fresh is not None and blocks:
            self.kept_for[fresh.id] = blocks[-1].id
        drawn = [entry.association for block in blocks for entry in block.entries or () if entry.step_action is None]
        if drawn != wanted:
            if not blocks and fresh is not None:
                blocks, before = [fresh], [0]
            elif blocks and fresh is not None:
                self._complete(blocks, fresh, wanted)
        # a block that has lost its last line goes; one that the file has drawn empty stays
        for block, lines in zip(blocks, before, strict=True):
            if block.entries or not lines:
                self.symbols[block.id] = block
        symbol = self.symbols[step.id]
        if any(block.id in self.symbols for block in blocks):
            if symbol.action_output is None and step.id in self.new:
                symbol.action_output = self.new[step.id].action_output
        elif blocks and not self._feeds_logic(step.id):
            symbol.action_output = None

    def _complete(self, blocks: list[Symbol], fresh: Symbol, wanted: list[int]) -> None:
        """Bring the lines of a step into its order; what is new goes into the last block."""
        lines = {entry.association: entry for entry in fresh.entries or ()}
        for block in blocks:
            lines |= {entry.association: entry for entry in block.entries or () if entry.step_action is None}
        last = blocks[-1]
        elsewhere = [e.association for block in blocks[:-1] for e in block.entries or () if e.step_action is None]
        if elsewhere != wanted[: len(elsewhere)]:
            for block in blocks[:-1]:
                block.entries = [entry for entry in block.entries or () if entry.step_action is not None]
            elsewhere = []
        steps_own = [entry for entry in last.entries or () if entry.step_action is not None]
        first = [entry for entry in steps_own if entry.step_action is StepActionKind.ENTRY]
        behind = [entry for entry in steps_own if entry.step_action is not StepActionKind.ENTRY]
        last.entries = [*first, *(lines[number] for number in wanted[len(elsewhere) :]), *behind]

    def _feeds_logic(self, step: int) -> bool:
        pins = [pin for node in self.chart.logic for pin in input_pins_of(node)]
        return any(connection.source == step for pin in pins for connection in pin.connections)

    def _settle_condition(self, symbol: Symbol) -> None:
        condition = self.transitions[symbol.transitions[0] if symbol.transitions else symbol.id].condition
        fresh = self.new[symbol.id]
        fresh_source = fresh.condition.connections[0].source if fresh.condition is not None else None
        if not isinstance(condition, Expression):
            symbol.condition = None
            return
        if symbol is not fresh:
            sources = [c.source for c in symbol.condition.connections] if symbol.condition is not None else []
            drawn = [i for i in sources if i in self.old and self.old[i].kind is SymbolKind.EXPRESSION]
            if sources and drawn == sources and not any(i in self.symbols for i in drawn):
                for number in drawn:
                    self.symbols[number] = self.old[number]
                if fresh_source is not None:
                    self.kept_for[fresh_source] = drawn[0]
                return
            symbol.condition = fresh.condition if self.wired else None
        if symbol.condition is not None and fresh_source is not None:
            self.symbols[fresh_source] = self.new[fresh_source]


def block_owner(symbol: Symbol, symbols: dict[int, Symbol]) -> int | None:
    """Return the step of an action block; None of other symbols."""
    if symbol.kind is not SymbolKind.ACTION_BLOCK:
        return None
    sources = (connection.source for pin in symbol.inputs for connection in pin.connections)
    steps = (SymbolKind.STEP, SymbolKind.MACRO_STEP)
    return next((i for i in sources if i in symbols and symbols[i].kind in steps), None)


def _belongs(entry: ActionEntry, step: Step, wanted: list[int]) -> bool:
    if entry.step_action is not None:
        return getattr(step, f"{entry.step_action.value}_action") is not None
    return entry.association in wanted


ASIDE = 40
"""Distance of a new action block from its step."""


def draw_step_actions(chart: SfcNetwork, style: DrawingStyle) -> None:
    """Give every step action a line in an action block of its step.

    The entry action comes first, as it is executed first; main and exit actions come behind all others, in this order.
    """
    drawing = chart.drawing
    if drawing is None or not any(_missing(step, None) for step in chart.steps):
        return
    blocks = _blocks_of_steps(drawing)
    steps = {step.id: step for step in chart.steps}
    new_id = chart.new_id()
    for position, symbol in reversed(list(enumerate(drawing.symbols))):
        step = steps.get(symbol.id) if symbol.kind is SymbolKind.STEP else None
        if step is None:
            continue
        block = blocks.get(step.id)
        missing = _missing(step, block)
        if not missing:
            continue
        if block is None:
            if symbol.action_output is None:
                symbol.action_output = OutputPin(name=style.action_output_name)
            wire = Connection(source=step.id)
            block = Symbol(id=new_id, kind=SymbolKind.ACTION_BLOCK, inputs=[InputPin(connections=[wire])], entries=[])
            if drawing.places is not Places.NONE:
                block.position = (symbol.position[0] + (symbol.width or 0) + ASIDE, symbol.position[1])
            new_id += 1
            drawing.symbols.insert(position + 1, block)
            if drawing.order is not None and step.id in drawing.order:
                drawing.order.insert(drawing.order.index(step.id) + 1, block.id)
        lines = list(block.entries or ())
        for kind in missing:
            place = 0 if kind is StepActionKind.ENTRY else len(lines)
            lines.insert(place, ActionEntry(association=new_id, step_action=kind))
            new_id += 1
        block.entries = lines


def erase_step_actions(chart: SfcNetwork) -> None:
    """Take the lines of step actions out of the drawing, and the blocks and pins that served them alone."""
    drawing = chart.drawing
    if drawing is None:
        return
    gone: set[int] = set()
    for block in drawing.symbols:
        lines = block.entries
        if not lines or all(entry.step_action is None for entry in lines):
            continue
        block.entries = [entry for entry in lines if entry.step_action is None]
        if not block.entries:
            gone.add(block.id)
    if not gone:
        return
    drawing.symbols = [symbol for symbol in drawing.symbols if symbol.id not in gone]
    if drawing.order is not None:
        drawing.order = [number for number in drawing.order if number not in gone]
    wired = {connection.source for node in chart.logic for connection in _logic_wires(node)}
    wired.update(_blocks_of_steps(drawing))
    for symbol in drawing.symbols:
        if symbol.kind is SymbolKind.STEP and symbol.id not in wired:
            symbol.action_output = None


def _logic_wires(node: object) -> list[Connection]:
    pins = [getattr(node, "input", None), *getattr(node, "inputs", ())]
    parameters = getattr(node, "parameters", None)
    if parameters is not None:
        pins += [p.input for p in (*parameters.inputs, *parameters.in_outs, *parameters.outputs)]
    return [connection for pin in pins if pin is not None for connection in pin.connections]


def _blocks_of_steps(drawing: Drawing) -> dict[int, Symbol]:
    """Return the last action block of each step."""
    blocks: dict[int, Symbol] = {}
    for symbol in drawing.symbols:
        if symbol.kind is SymbolKind.ACTION_BLOCK:
            for pin in symbol.inputs:
                for connection in pin.connections:
                    blocks[connection.source] = symbol
    return blocks


def _missing(step: Step, block: Symbol | None) -> list[StepActionKind]:
    drawn = {entry.step_action for entry in block.entries or ()} if block is not None else set()
    return [k for k in StepActionKind if getattr(step, f"{k.value}_action") is not None and k not in drawn]
