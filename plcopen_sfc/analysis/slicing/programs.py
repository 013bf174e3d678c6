"""Bodies of text, FBD and LD in parts: every statement is one, with the conditions around it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence, Set
from dataclasses import replace

from plcopen_sfc.analysis.slicing.parts import NOTHING, NotDivisibleError, Part, Uses
from plcopen_sfc.languages.binding import bind
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.printing import print_node
from plcopen_sfc.model.body import Body, StBody
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.semantics.programs.instances import Instance

__all__ = ["ProgramParts", "statements_of"]


class ProgramParts:
    """See `plcopen_sfc.analysis.slicing.parts.Parts`."""

    def __init__(self, instance: Instance) -> None:
        self._pou = instance.unit.pou
        self._dialect = instance.controller.project.dialect
        if self._pou.actions or self._pou.transitions:
            raise NotDivisibleError(f"{self._pou.name} is more than one body")
        self._uses = Uses(instance)
        self._statements = statements_of(self._pou.bodies[0], instance)
        self.parts: list[Part] = list(self._parts(self._statements, NOTHING))

    def taken(self, kept: Set[int]) -> Pou:
        """The body with these parts only."""
        statements = self._kept(self._statements, iter(number in kept for number in range(len(self.parts))))
        text = print_node(n.Statements(statements), self._dialect)
        return self._pou.model_copy(update={"bodies": [StBody(text=text)]})

    def _parts(self, statements: Sequence[n.Statement], around: Part) -> Iterator[Part]:
        for statement in statements:
            heads = _heads(statement)
            head = self._uses.of_all(heads)
            if not heads or head.always or head.writes:
                yield self._uses.of(statement) | around
                continue
            inside = Part(head.reads | around.reads, frozenset())
            for inner in _inner(statement):
                yield from self._parts(inner, inside)

    def _kept(self, statements: Sequence[n.Statement], wanted: Iterator[bool]) -> tuple[n.Statement, ...]:
        """The statements with the parts that are wanted, which come in the order of `_parts`."""
        found: list[n.Statement] = []
        for statement in statements:
            heads = _heads(statement)
            head = self._uses.of_all(heads)
            if not heads or head.always or head.writes:
                if next(wanted):
                    found.append(statement)
                continue
            inner = [self._kept(each, wanted) for each in _inner(statement)]
            if any(inner):
                found.append(_with_inner(statement, inner))
        return tuple(found)


def statements_of(body: Body, instance: Instance) -> Sequence[n.Statement]:
    """Return the statements of a body, whatever its language. Raises `NotDivisibleError`."""
    bound = bind(body, instance.controller.project.dialect)
    declared = all(instance.frame.layout.find(name) is not None for name in bound.instances)
    if bound.program is None or not declared:
        raise NotDivisibleError(f"a body in {body.language} cannot be divided, or needs variables of its own")
    return bound.program


def _heads(statement: n.Statement) -> Sequence[n.Expression]:
    """What decides which statements inside are executed; none: it is executed as a whole."""
    match statement:
        case n.If(branches=branches):
            return [branch.condition for branch in branches]
        case n.Case(selector=selector):
            return [selector]
    return []


def _inner(statement: n.Statement) -> list[Sequence[n.Statement]]:
    """The lists of statements inside."""
    assert isinstance(statement, n.If | n.Case)  # noqa: S101
    return [*(branch.statements for branch in statement.branches), statement.otherwise or ()]


def _with_inner(statement: n.Statement, inner: Sequence[tuple[n.Statement, ...]]) -> n.Statement:
    """The statement with other ones inside, as many lists as `_inner` gives."""
    filled = [statements or (n.Empty(),) for statements in inner]
    otherwise = inner[-1] or None
    if isinstance(statement, n.Case):
        cases = [replace(old, statements=new) for old, new in zip(statement.branches, filled, strict=False)]
        return replace(statement, branches=tuple(cases), otherwise=otherwise)
    assert isinstance(statement, n.If)  # noqa: S101
    ways = [replace(old, statements=new) for old, new in zip(statement.branches, filled, strict=False)]
    return replace(statement, branches=tuple(ways), otherwise=otherwise)
