"""The two ways to draw a chart, and what they write at pins."""

from __future__ import annotations

from enum import StrEnum

from plcopen_sfc.model.drawing import SymbolKind

STEPS = frozenset({SymbolKind.STEP, SymbolKind.MACRO_STEP})
DIVERGENCES = frozenset({SymbolKind.SELECTION_DIVERGENCE, SymbolKind.SIMULTANEOUS_DIVERGENCE})
CONVERGENCES = frozenset({SymbolKind.SELECTION_CONVERGENCE, SymbolKind.SIMULTANEOUS_CONVERGENCE})
BARS = DIVERGENCES | CONVERGENCES


class DrawingStyle(StrEnum):
    """How charts are drawn.

    PLAIN is what TC6 editors take: bars only where wires meet or part, bars of one kind not nested, conditions
    written at their transition. STRUCTURED is what CODESYS and TwinCAT export and import: every divergence has its
    convergence, legs that end in a jump are wired into it too, conditions are symbols of their own, and the order of
    the symbols is a depth-first walk through the nested branches.
    """

    PLAIN = "plain"
    STRUCTURED = "structured"

    @property
    def structured(self) -> bool:
        """Whether every divergence has its convergence."""
        return self is DrawingStyle.STRUCTURED

    @property
    def output_name(self) -> str:
        """The name of the flow outputs of steps and divergences (TC6 requires the attribute)."""
        return "sfc" if self.structured else ""

    @property
    def action_output_name(self) -> str:
        """The name of the output of a step to its action block."""
        return "x" if self.structured else ""

    def wire_name(self, consumer: SymbolKind) -> str | None:
        """What a wire into a symbol of this kind says about the output where it starts."""
        if self.structured and (consumer is SymbolKind.TRANSITION or consumer in CONVERGENCES):
            return "sfc"
        return None
