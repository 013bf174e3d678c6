"""Drawings of charts: derived from a chart, kept up to date after its edits, placed on the page.

* `drawing_upkeep`: a drawing that fits its chart before a writer needs it: an old drawing follows the edits, with
  `attached_symbols`, action blocks and expressions, and `added_branches`, new ways beside those that are drawn
* `drawing_style`: the two styles, and whether a drawing fits its chart
* `new_drawing` from `chart_nesting` (a chart as nested branches) and `forward_edges` (those that a drawing runs along)
* `symbol_layout`: places and sizes of symbols, pins and wires
* `wording`: conditions and actions in one line of text; `pictures`: charts as SVG pictures
* `document_order`: symbols and logic in document order, and new ids in that order
"""

from plcopen_sfc.drawing.document_order import renumber as renumber
from plcopen_sfc.drawing.drawing_style import DrawingStyle as DrawingStyle, fits as fits
from plcopen_sfc.drawing.drawing_upkeep import (
    all_charts as all_charts,
    prepare as prepare,
    prepare_body as prepare_body,
    redraw as redraw,
)
from plcopen_sfc.drawing.new_drawing import draw as draw, limits as limits
from plcopen_sfc.drawing.symbol_layout import has_positions as has_positions, layout as layout
