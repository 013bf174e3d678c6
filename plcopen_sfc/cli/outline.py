"""A chart as indented text."""

from __future__ import annotations

from plcopen_sfc.cli.screen import Line
from plcopen_sfc.model.sfc import SfcNetwork


def outline(chart: SfcNetwork, *, unicode: bool = False) -> list[Line]:
    """The lines of the outline of `chart`."""
    mark = "\u25c9" if unicode else "*"
    return [[(f"  {mark} " if step.initial else "    ", ""), (step.name, "bold")] for step in chart.steps]
