"""Adaptation of a project to what the target executes, before it is drawn and written.

`project_rewriting`   the rules for projects
`chart_rules`         the rules for charts, and conditions
`step_rewriting`      rows and step actions as statements, with `step_checks` for interlocks, supervisions and events
`special_rows`        rows and step actions that not all tools execute alike; `row_orders`: their order in S7-GRAPH
`s5_operands`         timers, counters and times of S5
`sequencer_rewriting` what a block of S7-GRAPH does beside its steps; `operating_inputs`: INIT_SQ and OFF_SQ
`sequence_loops`      sequences that a chart of the target cannot hold, as a loop of each step
`passed_steps`        steps that S7-GRAPH skips
`global_variables`    tags, data blocks and lists of global variables
`called_methods`      methods as functions, before texts are translated; `called_programs`: programs that others call
`main_programs`       tasks in CoDeSys 2.3, whose controller executes PLC_PRG without one
`extended_types`      structures that extend others
`chart_rewriting`     a chart that is being rewritten
`flag_transitions`    SFC flags of CODESYS as conditions; `flags_in_graph`, `flags_in_tc6`: what else they need there
`boxes_before_conditions`  timers and edges before conditions of S7-GRAPH
`grafcet_charts`      GRAFCETs in the words of sequential function charts; `grafcet_terms`: their flags, times, edges;
                      `grafcet_variables`: their declarations
`grafcet_hierarchy`   partial charts, forcing orders, enclosing steps and macro-steps as one chart
`grafcet_scans`       what several evolutions in a scan do, and in which order actions store

The abilities of the target are those of its record (`formats.format_interface.ChartHost`); what was written keeps the
source beside it (`formats.plcopen.source_marks`).
"""

from plcopen_sfc.conversion.adaptation.chart_rules import needs_rewriting
from plcopen_sfc.conversion.adaptation.project_rewriting import (
    has_rewritten_charts,
    is_rewritten_throughout,
    rewrite_project,
    rule_tables,
)

__all__ = ["has_rewritten_charts", "is_rewritten_throughout", "needs_rewriting", "rewrite_project", "rule_tables"]
