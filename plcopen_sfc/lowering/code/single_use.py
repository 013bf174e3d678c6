"""Helper variables that are read once: their value is written where it is read, and they are gone."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection
from dataclasses import replace

from plcopen_sfc.languages.effects import Path, is_impure, may_change, reads, writes
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import transform, walk
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.lowering.code.boolean_logic import simplified
from plcopen_sfc.lowering.code.lowered_code import BOOL, LoweredCode
from plcopen_sfc.model.types import DerivedType, ElementaryType

_TIMERS = ("TON", "TOF", "TON_TIME", "TOF_TIME")
"""Types of instances whose calls change nothing but themselves."""
_FARTHEST = 12
"""Number of statements that may be between a helper and its reader: what is farther away is read better by its name."""


def inline_single_uses(code: LoweredCode, kept: Collection[Expression]) -> None:
    """Replace helpers that one statement of their own network reads, where nothing changes their value in between.

    `kept` are expressions that others ask for: their variables stay.
    """
    helpers = {v.name.casefold() for v in code.variables if v.type == BOOL and v.initial is None}
    helpers -= {name for expression in kept for name in _names(expression)}
    found: Counter[str] = Counter()
    for network in code.networks:
        found.update(name for statement in network.statements for name in _names(statement))
    # once written and once read
    once = {name for name in helpers if found[name] == 2}
    private = code.own_names
    timers: set[Path] = {
        (v.name.casefold(),) for v in code.variables if isinstance(v.type, DerivedType) and v.type.name in _TIMERS
    }
    gone: set[str] = set()
    for place, network in enumerate(code.networks):
        inliner = _Inliner(network.statements, once, helpers, private, timers)
        code.networks[place] = replace(network, statements=tuple(inliner.statements))
        gone |= inliner.gone
    code.variables[:] = [variable for variable in code.variables if variable.name.casefold() not in gone]
    while _without_unread(code, kept):
        pass


def _without_unread(code: LoweredCode, kept: Collection[Expression]) -> bool:
    """Remove variables that nothing reads with what is assigned to them; False if there are none."""
    own_types = {each.name for each in code.data_types}
    unread = {
        v.name.casefold()
        for v in code.variables
        if isinstance(v.type, ElementaryType) or (isinstance(v.type, DerivedType) and v.type.name in own_types)
    }
    unread -= {name for expression in kept for name in _names(expression)}
    for network in code.networks:
        for statement in network.statements:
            target = _pure_target(statement)
            names = Counter(_names(statement))
            unread -= {name for name, count in names.items() if count > (name == target)}
    for place, network in enumerate(code.networks):
        statements = tuple(each for each in network.statements if _pure_target(each) not in unread)
        code.networks[place] = replace(network, statements=statements)
    code.networks[:] = [each for each in code.networks if each.statements]
    written = {name for each in code.networks for s in each.statements for name in _names(s)}
    gone = unread - written
    code.variables[:] = [variable for variable in code.variables if variable.name.casefold() not in gone]
    return bool(gone)


def _pure_target(statement: Statement) -> str | None:
    match statement:
        case n.Assignment(n.Name(identifier), value, n.AssignmentKind.ASSIGN) if not is_impure(value):
            return identifier.casefold()
    return None


def _names(tree: n.Node) -> list[str]:
    return [node.identifier.casefold() for node in walk(tree) if isinstance(node, n.Name)]


class _Inliner:
    """Statements of a network without the helpers `once`; `gone` are those that were replaced."""

    def __init__(
        self,
        statements: tuple[Statement, ...],
        once: Collection[str],
        helpers: Collection[str],
        private: set[str],
        timers: set[Path],
    ) -> None:
        self.statements, self.gone = list(statements), set[str]()
        self._private, self._helpers, self._timers = private, helpers, timers
        place = 0
        while place < len(self.statements):
            each = self.statements[place]
            if (
                isinstance(each, n.Assignment)
                and isinstance(each.target, n.Name)
                and each.target.identifier.casefold() in once
                and each.kind is n.AssignmentKind.ASSIGN
                and not is_impure(each.value)
                and self._inlined(place, each.target, each.value)
            ):
                self.gone.add(each.target.identifier.casefold())
            else:
                place += 1

    def _inlined(self, place: int, helper: n.Name, value: Expression) -> bool:
        """Put the value of the helper that is written at `place` where it is read; False if it must stay."""
        name = helper.identifier.casefold()
        behind = range(place + 1, min(place + 1 + _FARTHEST, len(self.statements)))
        reader = next((i for i in behind if name in _names(self.statements[i])), None)
        if reader is None:
            return False
        replaced = _replaced(self.statements[reader], name, value, self._helpers)
        if replaced is None:
            return False
        before: list[Statement] = []
        after: list[Statement] = []
        for each in self.statements[place + 1 : reader]:
            if self._changes(each, reads(value)):
                after.append(each)  # the last value of an edge, which the reader needs as it was
            elif any(self._depend(each, moved) for moved in after):
                return False
            else:
                before.append(each)
        if any(not _keeps_a_value(each) or self._depend(self.statements[reader], each) for each in after):
            return False
        if after and any(isinstance(node, n.ReturnStatement | n.Exit | n.Continue) for node in walk(replaced)):
            return False
        self.statements[place : reader + 1] = [*before, replaced, *after]
        return True

    def _changes(self, statement: Statement, read: frozenset[Path]) -> bool:
        return may_change(read, writes(statement, self._timers), self._private)

    def _depend(self, one: Statement, other: Statement) -> bool:
        """Return True if one of two statements changes what the other one reads or writes."""
        return self._changes(one, reads(other) | writes(other, self._timers)) or self._changes(other, reads(one))


def _keeps_a_value(statement: Statement) -> bool:
    return isinstance(statement, n.Assignment) and not is_impure(statement.value)


def _replaced(reader: Statement, name: str, value: Expression, helpers: Collection[str]) -> Statement | None:
    """Return a statement with a value instead of a name, if it evaluates that before it does anything."""

    def change(node: n.Node) -> n.Node:
        return n.Parenthesized(value) if isinstance(node, n.Name) and node.identifier.casefold() == name else node

    match reader:
        case n.If((first, *others), otherwise) if name in _names(first.condition) and not is_impure(first.condition):
            branch = n.Branch(simplified(transform(first.condition, change)), first.statements)
            return n.If((branch, *others), otherwise)
        # inside a longer expression the name tells more than its value
        case n.Assignment(target, n.Name(identifier), n.AssignmentKind.ASSIGN) if identifier.casefold() == name:
            return n.Assignment(target, value)
        # but a helper is a step on the way itself
        case n.Assignment(n.Name(target) as helper, whole, n.AssignmentKind.ASSIGN) if (
            target.casefold() in helpers and name in _names(whole) and not is_impure(whole)
        ):
            return n.Assignment(helper, simplified(transform(whole, change)))
    return None
