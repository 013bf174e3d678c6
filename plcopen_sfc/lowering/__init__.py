"""Lowering: a chart as program code for controllers and tools that have no SFC."""
