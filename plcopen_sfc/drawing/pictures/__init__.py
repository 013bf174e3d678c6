"""Pictures of charts as SVG, and as texts for programs that draw graphs.

* `chart_picture`: a chart with the charts inside it, as the text of an SVG file
* `chart_arrangement`: the nested branches of a chart on the page
* `lined_up_charts`: two charts with the same steps at one height
* `file_arrangement`: a chart as its file draws it
* `symbol_pictures`: steps, transitions, jumps and action blocks
* `network_picture`: networks of FBD and LD; `network_layout`: their boxes in columns, and the wires between them
* `picture_sheets`: large pictures on several sheets of paper
* `graph_texts`: Mermaid and Graphviz
* `svg_canvas`: shapes, texts and themes, widths of texts
"""

from plcopen_sfc.drawing.pictures.chart_picture import (
    ChartPart,
    PairedChart,
    chart_figure,
    chart_svg,
    charts_in,
    chosen_theme,
    paired_figures,
    part_prefix,
)
from plcopen_sfc.drawing.pictures.graph_texts import dot_text, mermaid_text
from plcopen_sfc.drawing.pictures.network_picture import body_figure, body_svg
from plcopen_sfc.drawing.pictures.picture_sheets import sheets
from plcopen_sfc.drawing.pictures.svg_canvas import Canvas, Theme, escape, style_rules
from plcopen_sfc.drawing.pictures.symbol_pictures import PictureStyle

__all__ = [
    "Canvas",
    "ChartPart",
    "PairedChart",
    "PictureStyle",
    "Theme",
    "body_figure",
    "body_svg",
    "chart_figure",
    "chart_svg",
    "charts_in",
    "chosen_theme",
    "dot_text",
    "escape",
    "mermaid_text",
    "paired_figures",
    "part_prefix",
    "sheets",
    "style_rules",
]
