"""Statements as networks can have them: one assignment under one condition, instead of IF with several."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node, walk
from plcopen_sfc.languages.st.nodes import Expression, Operator, Statement
from plcopen_sfc.lowering.code import BOOL, Code, CodeNetwork
from plcopen_sfc.lowering.graph.texts import GraphTexts
from plcopen_sfc.lowering.logic import FALSE, TRUE, assignment, conjunction, is_constant, negation, when
from plcopen_sfc.model.types import Variable

_BOOLEAN = frozenset(
    {
        Operator.AND,
        Operator.OR,
        Operator.XOR,
        Operator.LESS,
        Operator.GREATER,
        Operator.LESS_OR_EQUAL,
        Operator.GREATER_OR_EQUAL,
        Operator.EQUAL,
        Operator.UNEQUAL,
    }
)


def make_drawable(code: Code, texts: GraphTexts, declared: Iterable[Variable]) -> None:
    """Take the IF statements of all networks apart. `declared` are the variables of the block."""
    maker = _Maker(code, texts, declared)
    networks = code.networks[:]
    code.networks.clear()
    for network in networks:
        if isinstance(network, CodeNetwork):
            code.add(network.title, list(maker.apart(network.statements)), network.comment)
        else:
            code.networks.append(network)


class _Maker:
    def __init__(self, code: Code, texts: GraphTexts, declared: Iterable[Variable]) -> None:
        self._code, self._texts = code, texts
        self._flags = {v.name.casefold() for v in (*declared, *code.variables, *code.inputs) if v.type == BOOL}

    def apart(self, statements: Iterable[Statement], condition: Expression = TRUE) -> Iterator[Statement]:
        """The statements, each under its own condition."""
        for statement in statements:
            if isinstance(statement, n.If):
                yield from self._branches(statement, condition)
            elif is_constant(condition, TRUE):
                yield statement
            elif isinstance(statement, n.Assignment) and self._is_switched(statement):
                yield from self._switched(statement, condition)
            else:
                yield when(condition, statement)

    def _is_switched(self, statement: n.Assignment) -> bool:
        """Whether it gives a Boolean value that is no constant."""
        value = n.bare(statement.value)
        match value:
            case n.Operation(operator):
                return operator in _BOOLEAN
            case n.Unary(operator):
                return operator is Operator.NOT
            case n.Name(name):
                return name.casefold() in self._flags
            case n.Member(_, n.Name(name)):
                return name.upper() in ("Q", "Q1")
        return False

    def _switched(self, statement: n.Assignment, condition: Expression) -> Iterator[Statement]:
        """Set it where the value is TRUE, reset it where it is FALSE: no box writes Boolean values on a condition."""
        value = statement.value
        target = print_node(statement.target)
        if any(print_node(node) == target for node in walk(value) if isinstance(node, n.Name | n.Member)):
            value = self._code.declare(self._texts.condition)
            yield assignment(value, statement.value)
        yield when(conjunction([condition, value]), assignment(statement.target, TRUE))
        yield when(conjunction([condition, negation(value)]), assignment(statement.target, FALSE))

    def _branches(self, statement: n.If, condition: Expression) -> Iterator[Statement]:
        branches: list[tuple[Expression, Sequence[Statement]]] = []
        before: list[Expression] = []
        for branch in statement.branches:
            branches.append((conjunction([condition, branch.condition, *before]), branch.statements))
            before.append(negation(branch.condition))
        if statement.otherwise:
            branches.append((conjunction([condition, *before]), statement.otherwise))
        pieces = sum(len(each) for _, each in branches)
        if pieces > 1 and _changes(branches):
            kept: list[tuple[Expression, Sequence[Statement]]] = []
            for guard, each in branches:
                name = self._code.declare(self._texts.condition)
                yield assignment(name, guard)
                kept.append((name, each))
            branches = kept
        for guard, each in branches:
            yield from self.apart(each, guard)


def _changes(branches: Sequence[tuple[Expression, Sequence[Statement]]]) -> bool:
    """Whether a branch could change what a condition depends on; not by its last statement."""
    read = {print_node(node) for guard, _ in branches for node in walk(guard) if isinstance(node, n.Name | n.Member)}
    statements = [statement for _, each in branches for statement in each]
    changing = statements if isinstance(statements[-1], n.If) else statements[:-1]
    written = [
        node for statement in changing for node in walk(statement) if isinstance(node, n.Assignment | n.CallStatement)
    ]
    return any(isinstance(node, n.CallStatement) or print_node(node.target) in read for node in written)
