"""Behaviour of charts and programs: execution profiles, nets, the interpreters and the simulation."""
