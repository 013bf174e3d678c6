"""The constructions: what keeps the situation of a chart and how that changes."""
