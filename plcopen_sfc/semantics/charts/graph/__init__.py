"""Sequencers of S7-GRAPH: modes, interlocks, supervisions, and actions that depend on events.

`graph_program`: a cycle of a block. `graph_parameters`: its inputs, and the mode they put it into.
`interlock_conditions`: interlocks and supervisions. `step_data`: what programs read of steps and transitions.
"""
