"""Drawing step actions into action blocks, for formats that have no other place for them, and taking them out."""

from __future__ import annotations

from plcopen_sfc.drawing.style import DrawingStyle
from plcopen_sfc.model.drawing import ActionEntry, Drawing, Places, StepActionKind, Symbol, SymbolKind
from plcopen_sfc.model.network import Connection, InputPin, OutputPin
from plcopen_sfc.model.sfc import SfcNetwork, Step

ASIDE = 40
"""How far right of its step a new action block stands."""


def draw_step_actions(chart: SfcNetwork, style: DrawingStyle) -> None:
    """Give every step action a line in an action block of its step: entry, main and exit, in this order."""
    drawing = chart.drawing
    if drawing is None or not any(_missing(step, None) for step in chart.steps):
        return
    blocks = _blocks(drawing)
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
            lines.append(ActionEntry(association=new_id, step_action=kind))
            new_id += 1
        block.entries = lines


def erase_step_actions(chart: SfcNetwork) -> None:
    """Take the lines of step actions out of the drawing, and the blocks and pins that are there for them alone."""
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
    wired = {connection.source for node in chart.logic for connection in _wires(node)}
    wired.update(_blocks(drawing))
    for symbol in drawing.symbols:
        if symbol.kind is SymbolKind.STEP and symbol.id not in wired:
            symbol.action_output = None


def _wires(node: object) -> list[Connection]:
    pins = [getattr(node, "input", None), *getattr(node, "inputs", ())]
    parameters = getattr(node, "parameters", None)
    if parameters is not None:
        pins += [p.input for p in (*parameters.inputs, *parameters.in_outs, *parameters.outputs)]
    return [connection for pin in pins if pin is not None for connection in pin.connections]


def _blocks(drawing: Drawing) -> dict[int, Symbol]:
    """The last action block of each step."""
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
