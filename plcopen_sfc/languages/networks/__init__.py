"""FBD and LD networks: to structured text and back.

`body_statements`, `network_statements` and `network_expression` read networks, `condition_expression` the condition of
a transition and `chart_statements` the rest of the logic drawn in a chart. `draw_fbd` and `draw_ld` draw statements,
`draw_fbd_expression` and `draw_ld_expression` an expression. `normal_form` is what stays the same there and back.

`network_reading`     from `network_graph` (elements), `wires` (values) and `blocks` (what a box does) to `results`
`condition_reading`   conditions of every kind as expressions
`exported_networks`   networks of exports of CoDeSys 2.3 as structured text
`box_trees`           networks of TwinCAT 3 (NWL) as structured text
`network_drawing`     LD, and both as bodies; `fbd_drafting`: FBD; `element_places`: positions
`drawing_rules`       how a tool draws
"""

from plcopen_sfc.languages.networks.condition_reading import (
    chart_statements,
    condition_expression,
    condition_reader,
    feeding_nodes,
    is_empty_network,
    kept_conditions,
    shown_body,
    shown_condition,
    shown_named_condition,
    wired_steps,
)
from plcopen_sfc.languages.networks.drawing_rules import DrawingRules, declared_rules
from plcopen_sfc.languages.networks.network_drawing import (
    DrawnBody,
    DrawnExpression,
    draw_fbd,
    draw_fbd_expression,
    draw_ld,
    draw_ld_expression,
)
from plcopen_sfc.languages.networks.network_reading import body_statements, network_expression, network_statements
from plcopen_sfc.languages.networks.results import (
    Helper,
    NetworkExpression,
    NetworkProblem,
    NetworkStatements,
    NetworkText,
)
from plcopen_sfc.languages.networks.wires import normal_form

__all__ = [
    "DrawingRules",
    "DrawnBody",
    "DrawnExpression",
    "Helper",
    "NetworkExpression",
    "NetworkProblem",
    "NetworkStatements",
    "NetworkText",
    "body_statements",
    "chart_statements",
    "condition_expression",
    "condition_reader",
    "declared_rules",
    "draw_fbd",
    "draw_fbd_expression",
    "draw_ld",
    "draw_ld_expression",
    "feeding_nodes",
    "is_empty_network",
    "kept_conditions",
    "network_expression",
    "network_statements",
    "normal_form",
    "shown_body",
    "shown_condition",
    "shown_named_condition",
    "wired_steps",
]
