"""Program text: structured text, instruction lists, networks, declarations, and the names in them.

* `st`: structured text. `il`, `il_printing` and `il_problems`: instruction lists. `networks`: FBD and LD.
* `declarations`: to the model and back.
* `binding`: name sites, scopes, and effects of bodies; `effects`: those of syntax trees.
* `pragmas`: the remainder of the model in texts.
* `translation`: between dialects, with `expression_types`, `standard_blocks`, `start_values` and `words` (keywords).
* S7 has its own `s7_actions`, `s7_boxes`, `s7_globals`, `s7_programs`, `s7_start_values` and `s7_types`; CODESYS
  `executed_names`, `library_blocks` and `sfc_flag_uses`; GRAFCET `grafcet_conditions`.
* `method_calls`: calls of methods as calls of functions.
* `task_schedules`: times of tasks.
* `memory_addresses`: direct addresses as bits.
* `text_edits`; `problems` of one, `syntax_problems` of those in a file.
"""

from plcopen_sfc.model.dialect import Dialect

__all__ = ["Dialect"]
