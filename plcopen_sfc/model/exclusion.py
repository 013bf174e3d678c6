"""Branches and jumps that are excluded from the program, and with them what they hold.

TwinCAT 3 and CODESYS exclude a branch at its divergence. Its steps and transitions then are excluded in the model, each
for itself, so that whatever looks at one of them sees it. A jump executes nothing by itself: the transitions that end
at an excluded one are excluded (assumed: no description tells).
"""

from __future__ import annotations

from plcopen_sfc.model.drawing import DIVERGENCES, SymbolKind
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.model.wiring import Branches

HOLDERS = frozenset({*DIVERGENCES, SymbolKind.JUMP})
"""Kinds of symbols whose exclusion is that of steps and transitions."""

IS_EXECUTED = "a step or transition of it is not excluded, so it is not either: exclude these"
"""What reports tell of a branch or jump that is excluded by itself alone."""


def told_by_others(chart: SfcNetwork) -> frozenset[int]:
    """Return the ids of elements whose `exclude` a file does not repeat.

    These are the steps and transitions of an excluded branch or before an excluded jump; and such branches and jumps
    themselves where an edit took one of these into the program again.
    """
    symbols = chart.drawing.symbols if chart.drawing is not None else []
    holders = [symbol for symbol in symbols if symbol.kind in HOLDERS and symbol.exclude]
    if not holders or chart.drawing is None:
        return frozenset()
    excluded = {step.id for step in chart.steps if step.exclude}
    excluded |= {transition.id for transition in chart.transitions if transition.exclude}
    branches = Branches.of(chart.drawing)
    told: set[int] = set()
    for holder in holders:
        held = branches.held_by(holder.id)
        told |= held if held <= excluded else {holder.id}
    return frozenset(told)
