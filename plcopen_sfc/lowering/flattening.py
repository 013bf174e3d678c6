"""IF and CASE for networks: what must be decided is decided first, as bits; then each statement waits for its bit."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from plcopen_sfc.languages.networks.effects import is_impure
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import walk
from plcopen_sfc.languages.st.nodes import Expression, Operator, Statement
from plcopen_sfc.lowering.code import Code, CodeNetwork
from plcopen_sfc.lowering.logic import TRUE, assignment, conjunction, disjunction, is_constant, negation, when

_RISKY = frozenset({Operator.DIVIDE, Operator.MODULO, Operator.POWER})


def flatten(code: Code) -> None:
    """Make statements of each network that a network can hold. What it cannot make flat is left as it is."""
    for place, network in enumerate(code.networks):
        if isinstance(network, CodeNetwork):
            flat = _Flattener(lambda: code.declare("Condition")).statements(network.statements, TRUE)
            code.networks[place] = CodeNetwork(network.title, tuple(flat), network.comment)


class _Flattener:
    def __init__(self, declare: Callable[[], n.Name]) -> None:
        self._declare = declare

    def statements(self, statements: Iterable[Statement], guard: Expression) -> Iterator[Statement]:
        """Statements that are executed while `guard` is TRUE."""
        for statement in statements:
            if isinstance(statement, n.Empty):
                continue
            branches = _branches(statement)
            if branches is None or (is_constant(guard, TRUE) and _is_simple(statement)):
                yield statement if is_constant(guard, TRUE) else when(guard, statement)
                continue
            # all is decided on before anything is done, which could change what is asked
            bits: list[n.Name] = []
            for branch in branches:
                bit = self._declare()
                yield assignment(bit, conjunction([guard, *map(negation, bits), branch.condition]))
                bits.append(bit)
            for bit, branch in zip(bits, branches, strict=True):
                yield from self.statements(branch.statements, bit)


def _branches(statement: Statement) -> list[n.Branch] | None:
    """The branches of an IF or CASE, the last one for ELSE; None for what is no such statement, or cannot be asked."""
    found: list[n.Branch]
    if isinstance(statement, n.If):
        found = list(statement.branches)
        otherwise = statement.otherwise
    elif isinstance(statement, n.Case):
        conditions = [_chosen(statement.selector, branch) for branch in statement.branches]
        found = [
            n.Branch(condition, branch.statements)
            for condition, branch in zip(conditions, statement.branches, strict=True)
        ]
        otherwise = statement.otherwise
    else:
        return None
    if otherwise:
        found.append(n.Branch(TRUE, otherwise))
    return found if all(_may_be_asked(branch.condition) for branch in found) else None


def _is_simple(statement: Statement) -> bool:
    """An IF that is drawn as it is: of one statement that is none."""
    if not isinstance(statement, n.If) or len(statement.branches) != 1 or statement.otherwise:
        return False
    inner = statement.branches[0].statements
    return len(inner) == 1 and not isinstance(inner[0], n.If | n.Case | n.Empty)


def _chosen(selector: Expression, branch: n.CaseBranch) -> Expression:
    """That the value of a CASE is one of the labels of a branch."""
    found: list[Expression] = []
    for label in branch.labels:
        if isinstance(label, n.Range):
            lower = n.Operation(Operator.GREATER_OR_EQUAL, (selector, label.lower))
            found.append(conjunction([lower, n.Operation(Operator.LESS_OR_EQUAL, (selector, label.upper))]))
        else:
            found.append(n.Operation(Operator.EQUAL, (selector, label)))
    return disjunction(found)


def _may_be_asked(condition: Expression) -> bool:
    """Whether it does no harm to evaluate it also where the text would not."""
    return not is_impure(condition) and not any(
        isinstance(node, n.Index | n.Dereference) or (isinstance(node, n.Operation) and node.operator in _RISKY)
        for node in walk(condition)
    )
