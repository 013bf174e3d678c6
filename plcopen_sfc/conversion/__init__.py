"""Conversion between tools: what the target executes of the source, and the report on it.

`executed_parts`          a project as a tree of what a controller executes, or of all that people look at
`executed_projects`       reads that tree: declarations, types, bodies
`executed_charts`         reads the charts in it
`executed_tasks`          reads the tasks in it
`declared_values`         start values of elementary members, and declarations that the model keeps as text
`meaning`                 program text, conditions and values in a form that can be compared
`execution_differences`   differences between two such trees
`adaptation`              a project in terms that the target executes
`reporting`               differences as items of a `ConversionReport`
`running`                 source and result run against each other
`assumed_types`           structures in the place of types that no file declares, for these runs
`chart_runs`              a single chart in these runs
`compared_names`          what has other names on both sides
`callers`                 what calls charts, run as a whole
`causes`                  differences that a run has shown, in words, with their causes
`scan_order`              charts whose actions see other inputs, as they are executed before the transitions
"""

from plcopen_sfc.conversion.executed_parts import Detail as Detail, Part as Part
from plcopen_sfc.conversion.executed_projects import executed as executed
from plcopen_sfc.conversion.execution_differences import ExecutionDifference as ExecutionDifference, compare as compare
from plcopen_sfc.conversion.reporting import report_errors as report_errors, report_execution as report_execution
from plcopen_sfc.conversion.scan_order import report_scan_order as report_scan_order
