"""Lowering sequencers of S7-GRAPH: their semantics in plain structured text, which any controller can hold."""
