"""Conversion between tools: what the target executes of the source, and the report on it.

`meaning`      program text, conditions and values in a form that can be compared
`parts`        a project as a tree of what a controller executes
`execution`    reads that tree: declarations, types, tasks, bodies; `charts` reads the charts
`comparison`   what differs between two such trees
`reporting`    the differences as items of a `ConversionReport`, in an engineer's words
`running`      source and result run against each other
"""

from plcopen_sfc.conversion.comparison import Difference, compare
from plcopen_sfc.conversion.executed_parts import Part
from plcopen_sfc.conversion.executed_projects import executed
from plcopen_sfc.conversion.reporting import report_execution

__all__ = ["Difference", "Part", "compare", "executed", "report_execution"]
