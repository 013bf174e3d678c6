"""Projects as matiec compiles them, for its text and for the TC6 XML of the tools that use it (Beremiz, OpenPLC).

* `matiec_project`: `fit_project` changes a copy of a project, with its configuration and tasks; `pous_in_order`.
* `matiec_pou`: one POU while it is adapted, its bodies and its drawn logic.
* `matiec_charts`, `matiec_actions`: the chart of a POU, and the actions that it executes.
* `action_charts`: charts in actions as function blocks.
* `matiec_statements`: texts of statements and instructions; `matiec_expressions`: their operands and calls.
* `matiec_functions`: global variables as parameters of functions, and calls that are not made.
* `matiec_library`: calls of standard functions that its library has otherwise.
* `matiec_declarations`: types, values, global variables, and names.
"""
