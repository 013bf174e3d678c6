"""Places the symbols of a drawing."""

from __future__ import annotations

from plcopen_sfc.model.drawing import Drawing
from plcopen_sfc.model.sfc import SfcNetwork


def has_positions(drawing: Drawing) -> bool:
    """Whether the drawing says where its symbols stand: some position is not 0, 0."""
    return any(symbol.position != (0, 0) for symbol in drawing.symbols)


def layout(chart: SfcNetwork) -> None:
    """Place every symbol (first version: one column)."""
    drawing = chart.drawing
    if drawing is None:
        return
    for row, symbol in enumerate(drawing.symbols):
        symbol.position = (100, 20 + 80 * row)
