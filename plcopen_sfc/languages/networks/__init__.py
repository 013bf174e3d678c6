"""FBD and LD networks: to structured text and back.

`body_statements` and `network_statements` read networks, `condition_expression` the condition of a transition and
`chart_statements` the rest of the logic drawn in a chart. `draw_fbd` and `draw_ld` draw statements,
`draw_fbd_expression` and `draw_ld_expression` an expression. `normal_form` is what stays the same there and back.

`network_reading`     from `network_graph` (elements), `wires` (values) and `blocks` (what a box does) to `results`
`condition_reading`   conditions of every kind as expressions
`exported_networks`   networks of exports of CoDeSys 2.3 as structured text
`box_trees`           networks of TwinCAT 3 (NWL) as structured text
`network_drawing`     LD, and both as bodies; `fbd_drafting`: FBD; `element_places`: positions
`drawing_rules`       how a tool draws
"""

from plcopen_sfc.languages.networks.condition_reading import (
    chart_statements as chart_statements,
    condition_expression as condition_expression,
    condition_reader as condition_reader,
    feeding_nodes as feeding_nodes,
    is_empty_network as is_empty_network,
    kept_conditions as kept_conditions,
    shown_body as shown_body,
    shown_condition as shown_condition,
    shown_named_condition as shown_named_condition,
    wired_steps as wired_steps,
)
from plcopen_sfc.languages.networks.drawing_rules import DrawingRules as DrawingRules, declared_rules as declared_rules
from plcopen_sfc.languages.networks.network_drawing import (
    DrawnBody as DrawnBody,
    DrawnExpression as DrawnExpression,
    draw_fbd as draw_fbd,
    draw_fbd_expression as draw_fbd_expression,
    draw_ld as draw_ld,
    draw_ld_expression as draw_ld_expression,
)
from plcopen_sfc.languages.networks.network_reading import (
    body_statements as body_statements,
    network_statements as network_statements,
)
from plcopen_sfc.languages.networks.results import (
    Helper as Helper,
    NetworkExpression as NetworkExpression,
    NetworkProblem as NetworkProblem,
    NetworkStatements as NetworkStatements,
    NetworkText as NetworkText,
)
from plcopen_sfc.languages.networks.wires import normal_form as normal_form
