"""Programs in ST, FBD, LD and IL, translated to Python once and executed scan by scan.

`Controller` runs the POUs of a project, `Instance` is one of them.
"""

from plcopen_sfc.semantics.programs import types
from plcopen_sfc.semantics.programs.controller import Controller, Instance, Variable
from plcopen_sfc.semantics.programs.library import ChartCompiler, CompiledChart
from plcopen_sfc.semantics.programs.runtime import Processor
from plcopen_sfc.semantics.programs.scopes import Scope
from plcopen_sfc.semantics.programs.types import Direction, Field, Frame, Layout, Type

__all__ = [
    "ChartCompiler",
    "CompiledChart",
    "Controller",
    "Direction",
    "Field",
    "Frame",
    "Instance",
    "Layout",
    "Processor",
    "Scope",
    "Type",
    "Variable",
    "types",
]
