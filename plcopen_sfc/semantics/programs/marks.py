"""Which branches of program text were executed, the assignments in them, and the outcomes of comparisons."""

from __future__ import annotations

from dataclasses import dataclass, field

__all__ = ["Branch", "Marks"]


@dataclass(slots=True)
class Branch:
    """Statements that are executed together: whose text they are, what leads to them, and the assignments.

    Or an outcome of a comparison that is assigned: then `condition` is what is TRUE then, `outcome` the assignment and
    the value, and `inside` what leads to the assignment.
    """

    owner: str
    condition: str
    assignments: list[str] = field(default_factory=list)
    outcome: tuple[str, bool] | None = None
    inside: str = ""


class Marks:
    """The branches of all texts of a controller; `reached` tells by their numbers which were executed."""

    def __init__(self) -> None:
        self.branches: list[Branch] = []
        self.reached: list[bool] = []

    def branch(self, owner: str, condition: str) -> int:
        """Note a branch; its number."""
        return self._noted(Branch(owner, condition))

    def outcomes(self, branch: int, assignment: str, value: str) -> int:
        """Note that a branch assigns a comparison; the number of the outcome FALSE, which that of TRUE follows."""
        around = self.branches[branch]
        for outcome, condition in ((False, f"NOT ({value})"), (True, value)):
            last = self._noted(Branch(around.owner, condition, outcome=(assignment, outcome), inside=around.condition))
        return last - 1

    def _noted(self, branch: Branch) -> int:
        self.branches.append(branch)
        self.reached.append(False)
        return len(self.branches) - 1
