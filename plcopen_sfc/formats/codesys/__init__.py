"""CODESYS V3 and TwinCAT 3 PLCopenXML: TC6 2.0 and the data that these tools add to it.

Public: `codesys_codec.CODEC` and `validate_codesys`.

* `codesys_codec`: the entry in the table of formats, with the fields, the order and the schema of the data of these
  tools.
* `element_data`: these data of charts and of elements (entry, main and exit actions of steps, times, settings), read
  and written; `object_data`: those of projects and POUs. `codesys_names`: their names.
* `declaration_texts`: declarations as text, which say what the elements say.
"""
