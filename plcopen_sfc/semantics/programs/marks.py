"""Which branches of program text were executed, the assignments in them, and the outcomes of comparisons."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from plcopen_sfc.languages.networks.values import inverted
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.languages.st.nodes import Expression, Parenthesized

__all__ = ["Branch", "Marks"]


@dataclass(slots=True)
class Branch:
    """Statements that are executed together: whose text they are, what leads to them, and the assignments.

    `guards` are conditions that are all TRUE at once when it is executed: that of the branch, and what is known from
    the branches around it and before it.

    Or an outcome of a comparison that is assigned: then `condition` is what is TRUE then, `outcome` the assignment and
    the value, and `inside` what leads to the assignment.
    """

    owner: str
    condition: str
    guards: tuple[Expression, ...] = ()
    assignments: list[str] = field(default_factory=list)
    outcome: tuple[str, bool] | None = None
    inside: str = ""


class Marks:
    """The branches of all texts of a controller; `reached` tells by their numbers which were executed."""

    def __init__(self) -> None:
        self.branches: list[Branch] = []
        self.reached: list[bool] = []

    def branch(self, owner: str, condition: str, guards: Sequence[Expression]) -> int:
        """Note a branch; its number."""
        return self._noted(Branch(owner, condition, tuple(guards)))

    def outcomes(self, branch: int, assignment: str, value: Expression, guards: Sequence[Expression]) -> int:
        """Note that a branch assigns a comparison; the number of the outcome FALSE, which that of TRUE follows."""
        around = self.branches[branch]
        for outcome, condition in ((False, inverted(Parenthesized(value))), (True, value)):
            noted = Branch(around.owner, print_node(condition), (*guards, condition))
            noted.outcome, noted.inside = (assignment, outcome), around.condition
            last = self._noted(noted)
        return last - 1

    def _noted(self, branch: Branch) -> int:
        self.branches.append(branch)
        self.reached.append(False)
        return len(self.branches) - 1
