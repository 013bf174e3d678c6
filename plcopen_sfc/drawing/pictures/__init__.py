"""Pictures of charts as SVG, and as texts for programs that draw graphs.

* `chart_picture`: a chart with the charts inside it, as the text of an SVG file
* `chart_arrangement`: the nested branches of a chart on the page
* `lined_up_charts`: two charts with the same steps at one height
* `file_arrangement`: a chart as its file draws it
* `symbol_pictures`: steps, transitions and jumps
* `action_blocks`: the tables beside steps
* `symbol_facts`: what the symbols of a chart have in common
* `network_picture`: networks of FBD and LD; `network_symbols`: their blocks, contacts and operands
* `network_layout`: boxes in columns, and the wires between them
* `picture_sheets`: large pictures on several sheets of paper
* `graph_texts`: Mermaid and Graphviz
* `svg_canvas`: shapes, texts and themes, widths of texts
"""

from plcopen_sfc.drawing.pictures.chart_picture import (
    ChartPart as ChartPart,
    PairedChart as PairedChart,
    chart_figure as chart_figure,
    chart_svg as chart_svg,
    charts_in as charts_in,
    chosen_theme as chosen_theme,
    paired_figures as paired_figures,
    part_prefix as part_prefix,
)
from plcopen_sfc.drawing.pictures.graph_texts import dot_text as dot_text, mermaid_text as mermaid_text
from plcopen_sfc.drawing.pictures.network_picture import body_figure as body_figure, body_svg as body_svg
from plcopen_sfc.drawing.pictures.picture_sheets import sheets as sheets
from plcopen_sfc.drawing.pictures.svg_canvas import (
    Canvas as Canvas,
    Theme as Theme,
    escape as escape,
    style_rules as style_rules,
)
from plcopen_sfc.drawing.pictures.symbol_facts import PictureStyle as PictureStyle
