"""Projects as matiec compiles them, for its text and for the TC6 of the tools that stand on it (Beremiz, OpenPLC).

`fitting` changes a copy of a project, `charts` the charts in it, `statements` its texts, `naming`, `globals` and
`undeclared` look after what they refer to.
"""
