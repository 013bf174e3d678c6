"""Marks of executed branches of program text, the assignments in them, and the outcomes of comparisons.

Parts of Boolean expressions are marked when they decide. A part of OR decides while it is TRUE and all others are
FALSE, a part of AND while it is FALSE and all others are TRUE, and nothing outside of that operation decides already
(masking MC/DC).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from plcopen_sfc.errors import SfcError
from plcopen_sfc.languages.networks import normal_form
from plcopen_sfc.languages.networks.wires import inverted, joined
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node, walk
from plcopen_sfc.languages.st.nodes import Expression, Operator, Parenthesized
from plcopen_sfc.languages.standard_blocks import standard_block

Decision = tuple[str, bool | None, n.Expression]
"""A part of a condition, or empty the whole; the value it is to have, None: it is to decide; and what is TRUE then."""

_AND = (Operator.AND, Operator.AND_THEN)
_OR = (Operator.OR, Operator.OR_ELSE)


def deciding_parts(
    tree: Expression | None, around: tuple[Expression, ...] = ()
) -> Iterator[tuple[Expression, Expression]]:
    """Yield the parts of a condition that compare, and when they decide it.

    `around` is what must hold for the condition to matter.
    """
    match tree:
        case n.Parenthesized(inner):
            yield from deciding_parts(inner, around)
        case n.Unary(Operator.NOT, operand):
            yield from deciding_parts(operand, around)
        case n.Operation(operator, operands) if operator in _AND or operator in _OR:
            is_or = operator in _OR
            for number, operand in enumerate(operands):
                others = [*operands[:number], *operands[number + 1 :]]
                visible = (*around, *(map(inverted, others) if is_or else others))
                if any(map(compares, walk(operand))):
                    yield operand, joined(Operator.AND, [*visible, operand if is_or else inverted(operand)])
                yield from deciding_parts(operand, visible)


def bounds(tree: Expression | None, around: tuple[Expression, ...] = ()) -> Iterator[tuple[n.Operation, Expression]]:
    """Yield the comparisons by size in a condition, and what must hold for each of them to matter; TRUE: nothing."""
    match tree:
        case n.Parenthesized(inner) | n.Unary(Operator.NOT, inner):
            yield from bounds(inner, around)
        case n.Operation(operator, operands) if operator in _AND or operator in _OR:
            for number, operand in enumerate(operands):
                others = [*operands[:number], *operands[number + 1 :]]
                yield from bounds(operand, (*around, *(map(inverted, others) if operator in _OR else others)))
        case n.Operation(operator) if operator in n.COMPARISONS and operator is not Operator.UNEQUAL:
            yield tree, joined(Operator.AND, around) if around else n.Literal("TRUE")


def deciding_booleans(tree: Expression | None) -> Iterator[Expression]:
    """Yield the Booleans that a condition joins, each once."""
    found: dict[str, Expression] = {}
    waiting = list(_operands(tree))
    while waiting:
        node = waiting.pop(0)
        inner = list(_operands(node))
        waiting += inner
        if not inner and not isinstance(node, n.Literal) and not any(map(compares, walk(node))):
            found.setdefault(print_node(node).casefold(), node)
    return iter(found.values())


def decisions(condition: n.Expression, before: Sequence[n.Expression] = ()) -> Iterator[Decision]:
    """Yield the outcomes and parts of a condition; `before` are conditions that must be TRUE for it to be tested."""
    tree = normal_form(condition)
    yield "", True, joined(Operator.AND, [*before, tree])
    yield "", False, joined(Operator.AND, [*before, inverted(tree)])
    for part, value, deciding in parts_that_decide(tree):
        yield part, value, joined(Operator.AND, [*before, deciding])
    for leaf in deciding_booleans(tree):
        for value in (True, False):
            yield print_node(leaf), value, joined(Operator.AND, [*before, leaf if value else inverted(leaf)])


def parts_that_decide(condition: n.Expression) -> Iterator[Decision]:
    """Yield the parts of a condition that decide it."""
    for part, deciding in deciding_parts(normal_form(condition)):
        yield print_node(part), None, deciding


def decided_arguments(node: n.Node) -> Iterator[Expression]:
    """Yield the arguments of calls in a statement or expression that compare: ``SEL(n > 5, a, b)``."""
    for each in walk(node):
        if isinstance(each, n.Argument) and not each.output and each.value is not None and _is_decision(each.value):
            yield each.value


def _is_decision(tree: Expression) -> bool:
    """Return True for a comparison, and for Booleans joined with one."""
    tree = _bare(tree)
    return compares(tree) or any(map(_is_decision, _operands(tree)))


def _operands(tree: Expression | None) -> Sequence[Expression]:
    """Operands that an operation joins; none for a condition that joins nothing."""
    tree = _bare(tree) if tree is not None else None
    if isinstance(tree, n.Operation) and tree.operator in (*_AND, *_OR, Operator.XOR):
        return [_bare(each) for each in tree.operands]
    return ()


def _bare(tree: Expression) -> Expression:
    """Return an operand without parentheses and NOT."""
    while isinstance(tree, n.Parenthesized) or (isinstance(tree, n.Unary) and tree.operator is Operator.NOT):
        tree = tree.inner if isinstance(tree, n.Parenthesized) else tree.operand
    return tree


def divisors(node: n.Node) -> Iterator[Expression]:
    """Yield the divisors in a statement or expression that are no literals."""
    for each in walk(node):
        if isinstance(each, n.Operation) and each.operator in (Operator.DIVIDE, Operator.MODULO):
            yield from (operand for operand in each.operands[1:] if not isinstance(_bare(operand), n.Literal))


def compares(node: n.Node) -> bool:
    """Return True for comparisons of numbers and times, or of what may be some."""
    if not isinstance(node, n.Operation) or node.operator not in n.COMPARISONS:
        return False
    return not any(isinstance(each, n.Literal) and each.text in ("TRUE", "FALSE") for each in node.operands)


def may_act(node: n.Node) -> bool:
    """Return True for calls that may do more than give a value."""
    if isinstance(node, n.AssignmentExpression):
        return True
    if not isinstance(node, n.Call):
        return False
    block = standard_block(node.called)
    return block is None or block.stateful


UNSEEN = (SfcError, ArithmeticError, TypeError, AttributeError, IndexError, ValueError)
"""Errors of a condition that is evaluated once more to be looked at: nothing was seen then."""


@dataclass(slots=True)
class MarkedBranch:
    """Statements that are executed together: whose text they are, what leads to them, and the assignments.

    `guards` are conditions that are all TRUE at once when it is executed: that of the branch, and what is known from
    the branches around it and before it.

    Or an outcome of a comparison that is assigned: then the last guard is what is TRUE then, `outcome` the assignment
    and the value, and `inside` what leads to the assignment.

    Or an outcome of a condition, or a part of it that has decided it: then `decides` names it, with the value None for
    parts, and `around` is the number of the branch in which it is tested.
    """

    owner: str
    text: str | None = None
    guards: tuple[Expression, ...] = ()
    assignments: list[str] = field(default_factory=list)
    outcome: tuple[str, bool] | None = None
    inside: str = ""
    decides: tuple[str, str, bool | None] | None = None
    around: int = -1

    @property
    def condition(self) -> str:
        """The `text` of the condition; without one that of the last guard, for which few ask."""
        return self.text if self.text is not None else print_node(self.guards[-1])

    @property
    def is_statement(self) -> bool:
        """Return True for statements, False for outcomes and parts of conditions."""
        return self.outcome is None and self.decides is None


class Marks:
    """The branches of all texts of a controller; `reached` tells by their numbers which were executed.

    `watched` tells by their numbers which groups of conditions are looked at, which costs time: none before `watch`.
    `zeros`: what is TRUE where a divisor is 0, and the branch that divides.
    """

    def __init__(self) -> None:
        self.branches: list[MarkedBranch] = []
        self.reached: list[bool] = []
        self.watched: list[bool] = []
        self.zeros: list[tuple[int, tuple[Expression, ...]]] = []
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
            noted = MarkedBranch(around.owner, guards=(*guards, condition))
            noted.outcome, noted.inside = (assignment, outcome), around.condition
            last = self._noted(noted)
        return last - 1

    def divides(self, branch: int, node: n.Node, guards: Sequence[Expression]) -> None:
        """Note the divisors in a statement or condition of a branch."""
        for divisor in divisors(node):
            is_zero = n.Operation(Operator.EQUAL, (Parenthesized(divisor), n.Literal("0")))
            self.zeros.append((branch, (*guards, is_zero)))

    def decision(self, branch: int, condition: str, part: str, value: bool | None, guards: Sequence[Expression]) -> int:
        """Note an outcome of a condition, or without `value` that a part of it has decided it; its number."""
        around = self.branches[branch]
        noted = MarkedBranch(around.owner, guards=tuple(guards), decides=(condition, part, value))
        noted.inside, noted.around = around.condition, branch
        return self._noted(noted)

    def _noted(self, branch: MarkedBranch) -> int:
        self.branches.append(branch)
        self.reached.append(False)
        return len(self.branches) - 1
