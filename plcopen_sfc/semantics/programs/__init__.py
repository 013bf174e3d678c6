"""Programs in ST, FBD, LD and IL, translated to Python once and executed scan by scan.

`Controller` runs the POUs of a project, `Instance` is one of them. The modules, each using only those before it:

* values: `runtime_types` (types and frames), `runtime`, `function_runtime`, `matiec_runtime`,
  `block_execution` (what runs),
  `code_generation` (lines of Python, compiled and linked), `value_code` (values as Python), `places` (variables),
  `addresses`
* notes about texts: `variable_use` (reads and writes), `marks` (what directed runs look at), `unknown_calls`
* names: `scopes` (`TranslatedProject`, `Scope`, `Unit`)
* translation: `paths`, `operators`, `standard_functions`, `calls`, `expressions`; `statements`, `instruction_list`;
  `routines` (any text as a function, POUs)
* the whole: `project_library` (POUs and types), `controller`
"""

from plcopen_sfc.semantics.programs import runtime_types
from plcopen_sfc.semantics.programs.controller import Controller, Instance, InstanceVariable
from plcopen_sfc.semantics.programs.routines import ChartCompiler, Routines
from plcopen_sfc.semantics.programs.runtime import Processor
from plcopen_sfc.semantics.programs.runtime_types import Direction, Field, Frame, Layout, Type
from plcopen_sfc.semantics.programs.scopes import CompiledChart, Scope

__all__ = [
    "ChartCompiler",
    "CompiledChart",
    "Controller",
    "Direction",
    "Field",
    "Frame",
    "Instance",
    "InstanceVariable",
    "Layout",
    "Processor",
    "Routines",
    "Scope",
    "Type",
    "runtime_types",
]
