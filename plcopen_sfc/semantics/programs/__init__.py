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

from plcopen_sfc.semantics.programs import runtime_types as runtime_types
from plcopen_sfc.semantics.programs.controller import (
    Controller as Controller,
    Instance as Instance,
    InstanceVariable as InstanceVariable,
)
from plcopen_sfc.semantics.programs.routines import Routines as Routines
from plcopen_sfc.semantics.programs.scopes import ChartCompiler as ChartCompiler
from plcopen_sfc.semantics.programs.runtime import Processor as Processor
from plcopen_sfc.semantics.programs.runtime_types import (
    Direction as Direction,
    Field as Field,
    Frame as Frame,
    Layout as Layout,
    Type as Type,
)
from plcopen_sfc.semantics.programs.scopes import CompiledChart as CompiledChart, Scope as Scope
