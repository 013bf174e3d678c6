"""Queries and edits of a project that keep every reference right.

`queries` finds steps, declarations and uses; `builder` adds charts that are written as they are read. `rename` gives
declarations other names, one or many in one pass, or tells why not. `dialect` puts all program text into another
dialect.
"""
