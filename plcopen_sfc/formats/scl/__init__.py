"""External sources of Siemens SCL.

* `scl_codec`: the entry in the table of formats
* `scl_reader` and `scl_writer`: blocks, data blocks and data types; comments hold the rest of the model
* `scl_start_values`: assignments between BEGIN and END_DATA_BLOCK
"""
