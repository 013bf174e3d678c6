"""Conditions that are TRUE where a statement stands, because of the branches around it and before it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from plcopen_sfc.errors import SimulationError
from plcopen_sfc.languages.networks.values import inverted, joined
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import walk
from plcopen_sfc.languages.st.nodes import AssignmentKind, Expression, Operator
from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.semantics.programs.expressions import Translator
from plcopen_sfc.semantics.programs.places import Place
from plcopen_sfc.semantics.programs.types import Direction, StructureType

__all__ = ["Guards", "case_condition"]

_LEAVING = (n.Return, n.Exit, n.Continue, n.Goto)


class Guards:
    """The conditions that hold at the statement which is being translated.

    A condition is forgotten behind a statement that may write one of its variables. What a statement may write is
    known of assignments and of calls of standard blocks; any other call may write everything. Where they are not
    `wanted`, there are none.
    """

    def __init__(self, translator: Translator, *, wanted: bool) -> None:
        self._translator = translator
        self._wanted = wanted
        self.holding: tuple[Expression, ...] = ()

    def enter(self, conditions: Sequence[Expression]) -> tuple[Expression, ...]:
        """Have conditions hold from here on, evaluated in this order. What is TRUE at first.

        A condition that may write something is TRUE at first, but may be FALSE as soon as it is evaluated again.
        """
        found = self.holding
        for condition in conditions if self._wanted else ():
            self.forget(condition)
            found = (*self.holding, condition)
            if self._written(condition) == frozenset():
                self.holding = found
        return found

    def forget(self, node: n.Node) -> None:
        """Forget what a statement may change."""
        if not self.holding:
            return
        written = self._written(node)
        if written is None:
            self.holding = ()
        elif written:
            roots = [self._roots(each) for each in self.holding]
            kept = [known is not None and not known & written for known in roots]
            self.holding = tuple(each for each, stays in zip(self.holding, kept, strict=True) if stays)

    def pass_by(self, statement: n.Statement) -> None:
        """Go on behind a statement: a branch that does not come back leaves the opposite of its condition."""
        self.forget(statement)
        if isinstance(statement, n.If):
            for branch in statement.branches:
                if not branch.statements or not isinstance(branch.statements[-1], _LEAVING):
                    break
                self.enter([inverted(branch.condition)])

    def _written(self, node: n.Node) -> frozenset[str] | None:
        """The roots of the variables that something writes; None: it may write any."""
        found: set[str] = set()
        for target in self._targets(node):
            root = self._root(target) if target is not None else ""
            if not root:
                return None
            found.add(root)
        return frozenset(found)

    def _roots(self, condition: Expression) -> frozenset[str] | None:
        """The roots of the variables in a condition; None: not all of them are known."""
        members = {id(node.name) for node in walk(condition) if isinstance(node, n.Member)}
        callees = {id(node.callee) for node in walk(condition) if isinstance(node, n.Call)}
        found: set[str] = set()
        for node in walk(condition):
            if isinstance(node, n.Address | n.Dereference):
                return None
            if isinstance(node, n.Name) and id(node) not in members | callees:
                root = self._root(node)
                if root is None:
                    continue
                if not root:
                    return None
                found.add(root)
        return frozenset(found)

    def _root(self, target: Expression) -> str | None:
        """Key of the variable at the beginning of a path; empty: it may be several; None: it is no variable."""
        while isinstance(target, n.Member | n.Index | n.Parenthesized):
            target = target.inner if isinstance(target, n.Parenthesized) else target.base
        if not isinstance(target, n.Name):
            return ""
        try:
            found = self._translator.meaning(target)
        except SimulationError:
            return ""
        if not isinstance(found, Place):
            return None
        if found.field is not None and found.field.direction is Direction.IN_OUT:
            return ""
        return "g" if found.root.startswith("g") else found.root  # addresses of global variables may overlap

    def _targets(self, node: n.Node) -> Iterator[Expression | None]:
        """Keys of the variables that something writes; None: it may write anything."""
        for each in walk(node):
            match each:
                case n.Assignment(kind=AssignmentKind.REFERENCE | AssignmentKind.ATTEMPT):
                    yield None
                case n.Assignment(target=target) | n.AssignmentExpression(target=target) | n.For(variable=target):
                    yield target
                case n.Call():
                    yield from self._written_by_call(each)
                case n.EmbeddedCode() | n.Try():
                    yield None
                case n.CallStatement(call=call) if not isinstance(call, n.Call):
                    yield None

    def _written_by_call(self, call: n.Call) -> Iterator[Expression | None]:
        yield from (each.value for each in call.arguments if each.output and each.value is not None)
        block = standard_block(call.callee.identifier) if isinstance(call.callee, n.Name) else None
        if block is not None and not block.stateful:
            return
        try:
            called = self._translator.meaning(call.callee, called=True)
        except SimulationError:
            called = None
        is_timer = isinstance(called, Place) and isinstance(called.type, StructureType)
        if is_timer and self._translator.library.block_of(called.type.layout) is not None:
            yield call.callee
        else:
            yield None


def case_condition(selector: Expression, branch: n.CaseBranch) -> Expression:
    """Conditions that are TRUE in a branch of CASE."""
    selector = n.Parenthesized(selector)
    labels: list[Expression] = []
    for label in branch.labels:
        if isinstance(label, n.Range):
            lower = n.Operation(Operator.GREATER_OR_EQUAL, (selector, label.lower))
            upper = n.Operation(Operator.LESS_OR_EQUAL, (selector, label.upper))
            labels.append(n.Operation(Operator.AND, (lower, upper)))
        else:
            labels.append(n.Operation(Operator.EQUAL, (selector, label)))
    return joined(Operator.OR, labels)
