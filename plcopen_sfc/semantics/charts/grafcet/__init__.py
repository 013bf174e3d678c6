"""GRAFCET (IEC 60848) beyond steps and transitions: its actions, its terms, and its hierarchy of charts."""
