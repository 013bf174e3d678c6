"""Behaviour of charts and programs: execution profiles, nets, the interpreters and the simulation.

* `profile`: the choices in which tools differ. `net`: steps and transitions as bits and indexes.
* `charts`: the interpreter of charts, with `drawn_charts` for logic drawn in them. `programs`: that of programs.
* `simulation` of `subjects`, with `inputs`; `signals` are what it records.
* `trace`: a record of it, also as a file for wave viewers.
"""
