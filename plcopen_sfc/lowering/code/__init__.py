"""Lowered code before it is a body of the model; internal to `plcopen_sfc.lowering`.

`boolean_logic`       expressions and statements without needless operands
`lowered_code`        names and types, the places of step flags, networks of statements
`single_use`          helpers that are read once, written where they are read
`statement_lists`     statements inside of others, and IFs joined that follow each other
`code_memory`         flip-flops and edges, in networks and in text
`flat_statements`     IF and CASE for networks that have none
`code_bodies`         the body in ST, FBD or LD, and the interface
"""
