"""Which branches of program text were executed, the assignments in them, and the outcomes of comparisons."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from plcopen_sfc.errors import SfcError
from plcopen_sfc.languages.networks.values import inverted
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.languages.st.nodes import Expression, Parenthesized

__all__ = ["UNSEEN", "MarkedBranch", "Marks"]

UNSEEN = (SfcError, ArithmeticError, TypeError, AttributeError, IndexError, ValueError)
"""Errors of a condition that is evaluated once more to be looked at: nothing was seen then."""


@dataclass(slots=True)
class MarkedBranch:
    """Statements that are executed together: whose text they are, what leads to them, and the assignments.

    `guards` are conditions that are all TRUE at once when it is executed: that of the branch, and what is known from
    the branches around it and before it.

    Or an outcome of a comparison that is assigned: then `condition` is what is TRUE then, `outcome` the assignment and
    the value, and `inside` what leads to the assignment.

    Or an outcome of a condition, or a part of it that has decided it: then `decides` names it, with the value None for
    parts, and `around` is the number of the branch in which it is tested.
    """

    owner: str
    condition: str
    guards: tuple[Expression, ...] = ()
    assignments: list[str] = field(default_factory=list)
    outcome: tuple[str, bool] | None = None
    inside: str = ""
    decides: tuple[str, str, bool | None] | None = None
    around: int = -1

    @property
    def is_statement(self) -> bool:
        """Return True for statements, False for outcomes and parts of conditions."""
        return self.outcome is None and self.decides is None


class Marks:
    """The branches of all texts of a controller; `reached` tells by their numbers which were executed.

    `watched` tells by their numbers which groups of conditions are looked at, which costs time: none before `watch`.
    """

    def __init__(self) -> None:
        self.branches: list[MarkedBranch] = []
        self.reached: list[bool] = []
        self.watched: list[bool] = []
        self.is_watching = False

    def watch(self) -> None:
        """Look at conditions from now on."""
        self.is_watching = True
        self.watched[:] = [True] * len(self.watched)

    def group(self) -> int:
        """Return the number of a new group of conditions."""
        self.watched.append(self.is_watching)
        return len(self.watched) - 1

    def forget(self, first: int) -> None:
        """Take back what was noted from a number on."""
        del self.branches[first:], self.reached[first:]

    def branch(self, owner: str, condition: str, guards: Sequence[Expression]) -> int:
        """Note a branch; its number."""
        return self._noted(MarkedBranch(owner, condition, tuple(guards)))

    def outcomes(self, branch: int, assignment: str, value: Expression, guards: Sequence[Expression]) -> int:
        """Note that a branch assigns a comparison; the number of the outcome FALSE, which that of TRUE follows."""
        around = self.branches[branch]
        for outcome, condition in ((False, inverted(Parenthesized(value))), (True, value)):
            noted = MarkedBranch(around.owner, print_node(condition), (*guards, condition))
            noted.outcome, noted.inside = (assignment, outcome), around.condition
            last = self._noted(noted)
        return last - 1

    def decision(self, branch: int, condition: str, part: str, value: bool | None, guards: Sequence[Expression]) -> int:
        """Note an outcome of a condition, or without `value` that a part of it has decided it; its number."""
        around = self.branches[branch]
        noted = MarkedBranch(around.owner, print_node(guards[-1]), tuple(guards), decides=(condition, part, value))
        noted.inside, noted.around = around.condition, branch
        return self._noted(noted)

    def _noted(self, branch: MarkedBranch) -> int:
        self.branches.append(branch)
        self.reached.append(False)
        return len(self.branches) - 1
