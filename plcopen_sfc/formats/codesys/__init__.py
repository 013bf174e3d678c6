"""CODESYS V3 and TwinCAT 3 PLCopenXML: TC6 2.0 and the data that these tools add to it.

Public: `codesys_codec.CODEC` and `validate_codesys`.

* `codesys_codec`: the entry in the table of formats, with the fields, the order and the schema of the data of these
  tools.
* `element_data`, `object_data`: these data, read and written. `codesys_names`: their names.
"""
