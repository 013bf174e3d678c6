"""GRAFCET (IEC 60848) beyond steps and transitions: its actions, its terms, and its hierarchy of charts.

`grafcet_program`: evolutions and actions. `term_evaluation`: edges and times in conditions. `partial_charts`: forcing
orders and enclosing steps.
"""
