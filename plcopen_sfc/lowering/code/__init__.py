"""Lowered code before it is a body of the model; internal to `plcopen_sfc.lowering`.

`boolean_logic`       expressions and statements without needless operands
`code_declarations`   names and types, and the places of step flags
`lowered_code`        networks of statements, and the variables that they need
`code_memory`         flip-flops and edges, in networks and in text
`flat_statements`     IF and CASE for networks that have none
`code_bodies`         the body in ST, FBD or LD, and the interface
"""
