"""Lowering of what only GRAFCET (IEC 60848) has; internal to `plcopen_sfc.lowering`.

`grafcet_reading`     terms, actions and forcing orders read from the model
`grafcet_actions`     stored, continuous, delayed and limited actions; situations that charts above impose on others
`grafcet_evolutions`  edges and times in conditions, and the most evolutions that a scan can have
`grafcet_scan`        the schedule: evolutions up to a stable situation, then outputs, with an encoding
"""
