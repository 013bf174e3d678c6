"""Schedules: what lowered code does in a scan, and in which order; internal to `plcopen_sfc.lowering`.

`scan_schedule`   the parts of a scan in the order of the execution profile, whatever the encoding
`sfc_flag_code`   the SFC flags of CODESYS
`added_inputs`    operating modes, restart and emergency stop
"""
