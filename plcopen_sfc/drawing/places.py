"""Computed places: a layout that no person made may be forgotten where a format has no places."""

from __future__ import annotations

from plcopen_sfc.drawing.style import STEPS
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.drawing import Places, SymbolKind
from plcopen_sfc.model.network import InputPin, OutputPin
from plcopen_sfc.model.sfc import SfcNetwork


def forget_places(chart: SfcNetwork) -> None:
    """Put everything in a drawing with computed places back to where CODESYS exports have it: at 0, 0, without size."""
    drawing = chart.drawing
    if drawing is None or drawing.places is not Places.COMPUTED:
        return
    drawing.places = Places.NONE
    for symbol in drawing.symbols:
        symbol.position = (0, 0)
        symbol.width = symbol.height = None
        _forget_pins([*symbol.inputs, symbol.condition], [*symbol.outputs, symbol.action_output])
        for entry in symbol.entries or ():
            entry.position = None
            entry.width = entry.height = None
            _forget_pins([], [entry.output])


def _forget_pins(inputs: list[InputPin | None], outputs: list[OutputPin | None]) -> None:
    for pin in inputs:
        if pin is not None:
            pin.position = None
            for connection in pin.connections:
                connection.points = []
    for output in outputs:
        if output is not None:
            output.position = None


def is_structured(chart: SfcNetwork) -> bool:
    """Whether a chart is drawn as CODESYS draws: wires lead back to earlier symbols, conditions are symbols."""
    drawing = chart.drawing
    if drawing is None:
        return False
    seen: set[int] = {node.id for node in chart.logic}
    conditions = {transition.id: transition.condition for transition in chart.transitions}
    for symbol in drawing.symbols:
        wires = [connection.source for pin in symbol.inputs for connection in pin.connections]
        if symbol.kind is SymbolKind.TRANSITION:
            condition = conditions.get(symbol.transitions[0] if symbol.transitions else symbol.id)
            if isinstance(condition, Expression) and symbol.condition is None:
                return False
        if symbol.kind in STEPS and any(output.name == "" for output in symbol.outputs):
            return False
        if any(source not in seen for source in wires):
            return False
        seen.add(symbol.id)
    return True
