"""Edits of a project that keep every reference right.

`rename` gives a declaration another name, or tells why not. `dialect` puts all program text into
another dialect.
"""
