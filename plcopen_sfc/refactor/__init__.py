"""Edits of a project that keep every reference right.

`rename` gives a declaration another name, `clashes` are the reasons to refuse it. `dialect` puts all program text into
another dialect.
"""
