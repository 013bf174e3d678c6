"""A chart as a lowering sees it; internal to `plcopen_sfc.lowering`.

`chart_source`     net, conditions and actions as syntax trees
`chart_reading`    reads them from the model
`text_reading`     reads texts, drawings and names of actions
`step_variables`   flags and timers for ``S3.X`` and ``S3.T``
"""
