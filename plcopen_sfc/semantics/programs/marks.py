"""Which branches of program text were executed, and the assignments in them."""

from __future__ import annotations

from dataclasses import dataclass, field

__all__ = ["Branch", "Marks"]


@dataclass(slots=True)
class Branch:
    """Statements that are executed together: whose text they are, what leads to them, and the assignments."""

    owner: str
    condition: str
    assignments: list[str] = field(default_factory=list)


class Marks:
    """The branches of all texts of a controller; `reached` tells by their numbers which were executed."""

    def __init__(self) -> None:
        self.branches: list[Branch] = []
        self.reached: list[bool] = []

    def branch(self, owner: str, condition: str) -> int:
        """Note a branch; its number."""
        self.branches.append(Branch(owner, condition))
        self.reached.append(False)
        return len(self.branches) - 1
