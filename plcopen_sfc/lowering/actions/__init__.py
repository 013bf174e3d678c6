"""Actions in lowered code; internal to `plcopen_sfc.lowering`.

`action_control`     the expression that tells when an action is executed
`action_execution`   the decision on all actions, and their statements
`variable_access`    the variables that texts of the chart read and write
`drive_block`        actions in a function block of their own
"""
