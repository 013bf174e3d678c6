"""SimaticML, the XML of TIA Portal Openness.

The frame of a document:

* `simaticml_codec`: the entry in the table of formats; `tia_versions` and `openness_schemas`: versions and validation
* `document_reader`: a document, its objects and their ids, which `simaticml_codec` writes; `element_reader` and
  `element_writer`: texts, attributes and comments, as all the others use them
* `tia_adaptation`: what a project of another tool needs before it is written
* `added_elements`: elements for TIA Portal alone; `replaced_elements`: elements in place of what a source contains

Blocks and what they declare:

* `openness_objects`: blocks, data blocks, data types, tag tables; `compile_units`: their programs
* `block_interfaces`, `declaration_spelling`: declarations; `nested_start_values`: those of arrays and structures

Programs:

* `graph_reader`, `graph_writer`: S7-GRAPH, with `sequence_topology` and `sequence_rules` (branches and connections),
  `action_rows` and `row_tokens` (actions), and `graph_conditions`
* `action_functions`, `action_controls`, `control_statements`: functions and permanent instructions for
  actions that no row expresses
* `lad_fbd_networks` with `flgnet_reader`: LAD and FBD, with `network_operands`, `network_boxes`, `box_types` and
  `coils_and_contacts`
* `scl_tokens`: SCL
* `program_comparison`: equal meaning of two programs, and the numbers of their elements
"""
