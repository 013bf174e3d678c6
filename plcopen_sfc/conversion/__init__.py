"""Conversion between tools: what the target executes of the source, and the report on it.

`meaning`      program text, conditions and values in a form that can be compared
`execution`    everything in a project that a controller executes, as a tree of parts and aspects
`comparison`   what differs between two such trees
`reporting`    the differences as items of a `ConversionReport`, in an engineer's words
"""

from plcopen_sfc.conversion.comparison import Difference, compare
from plcopen_sfc.conversion.execution import Part, executed
from plcopen_sfc.conversion.reporting import report_execution

__all__ = ["Difference", "Part", "compare", "executed", "report_execution"]
