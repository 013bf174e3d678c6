"""Coverage of a chart since it was prepared: how much of it a comparison or a simulation has really executed."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from plcopen_sfc.model.actions import ActionAssociation

__all__ = ["Origin", "Reached"]


class Origin(NamedTuple):
    """Origin of an action: steps as bits, and the association; None for a step action."""

    steps: int
    association: ActionAssociation | None


class Reached:
    """Steps entered, transitions fired and actions executed, as bits.

    `labels` names the actions, `origins` tells for each of them what executes it. All instances of a chart count
    together.
    """

    __slots__ = ("actions", "labels", "origins", "steps", "transitions")

    def __init__(self) -> None:
        self.steps = 0
        self.transitions = 0
        self.actions = 0
        self.labels: list[str] = []
        self.origins: list[tuple[Origin, ...]] = []

    def action(self, label: str, origins: Iterable[Origin]) -> int:
        """Note that there is an action; the bit that stands for it."""
        self.labels.append(label)
        self.origins.append(tuple(origins))
        return 1 << len(self.labels) - 1
