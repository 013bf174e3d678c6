"""Queries and edits of a project that keep every reference right.

* `queries` finds steps, declarations and uses; `builder` adds charts that are written as they are read.
* `editor`: edits as transactions, with undo, clean-up and proof; `journal` keeps what they change. `chart_edits`
  and `name_edits` are the edits; `runs_of_steps` moves steps into macro-steps, `called_charts` into actions and blocks,
  in the form that `enclosed_charts` has; `surroundings` compares what a copied POU needs; `step_kinds` switches the
  charts of CoDeSys 2.3. `argument_checks` refuses arguments of other types.
* `rename` gives declarations other names, one or many in one pass, in their declarations and all uses (those that
  `languages.binding` finds), or tells why it does not.
* `dialect_translation` puts all program text into another dialect, `declaration_translation` what is declared,
  `direct_addresses` addresses into the numbers of another tool.
  `il_texts` and `step_kinds` prepare a project for tools without IL and without step flags.
"""
