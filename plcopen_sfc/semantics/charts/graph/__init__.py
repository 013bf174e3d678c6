"""Sequencers of S7-GRAPH: modes, interlocks, supervisions, and actions that depend on events."""
