"""Lowering what only GRAFCET (IEC 60848) has: the search for stability, edges and times, its actions, its hierarchy."""
