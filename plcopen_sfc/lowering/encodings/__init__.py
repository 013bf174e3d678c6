"""Encodings: what holds the situation of a chart in lowered code; internal to `plcopen_sfc.lowering`.

`step_flags`       a flag for each step, changed as bits or by flip-flops
`case_states`      state variables and the text of their CASEs
`step_branches`    what a step does, moved into its branch
`case_encodings`   a CASE for the chart, or for each part with one active step at a time
"""
