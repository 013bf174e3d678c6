"""Brings a drawing up to date after edits of its chart."""

from __future__ import annotations

from plcopen_sfc.drawing.draw import draw
from plcopen_sfc.drawing.fits import fits
from plcopen_sfc.drawing.style import DrawingStyle
from plcopen_sfc.model.sfc import SfcNetwork


def redraw(chart: SfcNetwork, style: DrawingStyle) -> None:
    """Make the drawing fit its chart."""
    if not fits(chart):
        chart.drawing = draw(chart, style)
