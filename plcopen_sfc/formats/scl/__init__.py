"""External sources of Siemens SCL.

* `scl_codec`: the entry in the table of formats, and the writer; comments hold the rest of the model
* `scl_reader`: blocks, data blocks with their start values, and data types
"""
