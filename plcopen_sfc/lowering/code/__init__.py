"""Lowered code: what it is made of, how it remembers, and how it becomes a body."""
