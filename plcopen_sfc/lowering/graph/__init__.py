"""Lowering of sequencers of S7-GRAPH to plain structured text or networks; internal to `plcopen_sfc.lowering`.

`sequencer_source`    a sequencer as syntax trees, and the step data that texts ask for
`sequencer_reading`   reads it from the model
`sequencer_scan`      the schedule: one cycle in the order of S7-GRAPH, with any encoding
`skipped_steps`       steps that are skipped
`sequencer_actions`   the actions of steps, and their S5 timers
`step_supervision`    interlock, supervision and step times
`block_parameters`    commands, operating modes and reports of the block
"""
