"""Edits of a project that keep every reference right.

`rename` gives declarations other names, one or many in one pass, or tells why not. `dialect` puts all program text into
another dialect.
"""
