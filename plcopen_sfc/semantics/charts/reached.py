"""What a chart has done since it was prepared: how much of it a comparison or a simulation has really executed."""

from __future__ import annotations

__all__ = ["Reached"]


class Reached:
    """Steps entered, transitions fired and actions executed, as bits; `labels` names the actions.

    All instances of a chart count together.
    """

    __slots__ = ("actions", "labels", "steps", "transitions")

    def __init__(self) -> None:
        self.steps = 0
        self.transitions = 0
        self.actions = 0
        self.labels: list[str] = []

    def action(self, label: str) -> int:
        """Note that there is an action; the bit that stands for it."""
        self.labels.append(label)
        return 1 << len(self.labels) - 1
