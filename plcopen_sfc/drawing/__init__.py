"""Drawings of charts: derives them, keeps them up to date after edits, and places symbols."""

from plcopen_sfc.drawing.draw import draw, limits
from plcopen_sfc.drawing.fits import fits
from plcopen_sfc.drawing.layout import has_positions, layout
from plcopen_sfc.drawing.prepare import all_charts, prepare, prepare_body
from plcopen_sfc.drawing.redraw import redraw
from plcopen_sfc.drawing.renumber import renumber
from plcopen_sfc.drawing.style import DrawingStyle

__all__ = [
    "DrawingStyle",
    "all_charts",
    "draw",
    "fits",
    "has_positions",
    "layout",
    "limits",
    "prepare",
    "prepare_body",
    "redraw",
    "renumber",
]
