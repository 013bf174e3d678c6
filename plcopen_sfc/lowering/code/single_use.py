"""Helper variables that are read once: their value is written where it is read, and they are gone.

Readers are also inside of IF and CASE, and in other networks.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from plcopen_sfc.languages.effects import Path, is_impure, may_change, reads, writes
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node, transform, walk
from plcopen_sfc.languages.st.nodes import Expression, Statement
from plcopen_sfc.languages.st.walking import children
from plcopen_sfc.lowering.code.boolean_logic import (
    conjunction,
    names_in,
    negation,
    simplified,
    with_known,
    without_constant,
)
from plcopen_sfc.lowering.code.lowered_code import BOOL, CodeNetwork, LoweredCode
from plcopen_sfc.lowering.code.statement_lists import (
    Body,
    does_something,
    paragraphs,
    timers_of,
    together,
    with_bodies,
)
from plcopen_sfc.model.types import DerivedType, ElementaryType
from plcopen_sfc.reachability import reached

_FARTHEST = 12
"""Number of statements that may be between a helper and its reader: what is farther away is read better by its name."""
_LONGEST = 100
"""Characters of a line in which the value of a helper is read as well as its name."""


def inline_single_uses(code: LoweredCode, kept: Collection[Expression]) -> None:
    """Replace helpers that are read once, where nothing changes their value in between.

    `kept` are expressions that others ask for: their variables stay.
    """
    others = set(names_in(*kept))
    helpers = {v.name.casefold() for v in code.variables if v.type == BOOL and v.initial is None} - others
    found: Counter[str] = Counter()
    for network in code.networks:
        found.update(names_in(*network.statements))
    # once written and once read
    once = {name for name in helpers if found[name] == 2}
    timers = timers_of(code)
    gone: set[str] = set()

    def inlined(networks: Sequence[CodeNetwork]) -> list[CodeNetwork]:
        inliner = _Inliner(networks, once, helpers, others, private=code.own_names, timers=timers)
        gone.update(inliner.gone)
        left: list[list[Statement]] = [[] for _ in networks]
        for at, statement in inliner.placed:
            left[at].append(with_bodies(statement, inside))
        parts = zip(networks, left, strict=True)
        kept = ((network, own) for network, own in parts if not _is_emptied(network.statements, own))
        return [replace(network, statements=tuple(own)) for network, own in kept]

    def inside(body: Body) -> Body:
        if once.isdisjoint(names_in(*body)):
            return body
        parts = [CodeNetwork("", part) for part in paragraphs(body)]
        return together([network.statements for network in inlined(parts)])

    code.networks[:] = inlined(code.networks)
    code.change(lambda statement: _with_short_end(statement, once, gone))
    code.variables[:] = [variable for variable in code.variables if variable.name.casefold() not in gone]


def _with_short_end(statement: Statement, once: Collection[str], gone: set[str]) -> Statement:
    """Return a loop that asks in its end for what its last statement assigns to a helper of `once`."""
    match statement:
        case n.Repeat((*others, n.Assignment(n.Name(identifier), value)), condition) if (
            identifier.casefold() in once and names_in(condition).count(identifier.casefold()) == 1
        ):
            shorter = _with(condition, identifier.casefold(), value)
            if len(print_node(shorter)) <= _LONGEST:
                gone.add(identifier.casefold())
                *first, last = paragraphs(tuple(others))
                return n.Repeat(together([*first, *([last] if last else [])]), shorter)
    return statement


def remove_unread(code: LoweredCode, kept: Collection[Expression]) -> None:
    """Remove variables that nothing reads but what is assigned to such ones, with these assignments.

    Those of `kept` stay.
    """
    own_types = {each.name for each in code.data_types}
    unread = {
        v.name.casefold()
        for v in code.variables
        if isinstance(v.type, ElementaryType) or (isinstance(v.type, DerivedType) and v.type.name in own_types)
    }
    unread -= set(names_in(*kept))
    written: dict[str, set[str]] = {name: set() for name in unread}
    read = [name for network in code.networks for each in network.statements for name in _read(each, written)]
    needed = reached(read, lambda name: written.get(name, ()))
    unread -= needed
    if unread:
        networks = (replace(each, statements=_without(each.statements, unread)) for each in code.networks)
        code.networks[:] = [each for each in networks if each.statements]
        code.variables[:] = [variable for variable in code.variables if variable.name.casefold() not in unread]


def _read(node: n.Node, written: Mapping[str, set[str]]) -> Iterator[str]:
    """Yield the names that a statement reads; what is assigned to one of `written` alone is added to that."""
    target = _pure_target(node)
    if target in written and isinstance(node, n.Assignment):
        written[target].update(names_in(node.value))
    elif isinstance(node, n.Name):
        yield node.identifier.casefold()
    else:
        for each in children(node):
            yield from _read(each, written)


def _pure_target(node: n.Node) -> str:
    """Return the variable to which a statement assigns, in lower case, if that is all it does; else nothing."""
    match node:
        case n.Assignment(n.Name(identifier), value, n.AssignmentKind.ASSIGN) if not is_impure(value):
            return identifier.casefold()
    return ""


def _without(body: Body, unread: set[str]) -> Body:
    """Return statements without assignments to `unread`; what stays whole is the same object, with its text."""
    if unread.isdisjoint(names_in(*body)):
        return body
    parts: list[Body] = []
    for part in paragraphs(body):
        whole = (with_bodies(each, lambda inner: _without(inner, unread)) for each in part)
        left = tuple(rest for each in whole if _pure_target(each) not in unread for rest in _not_empty(each))
        if not _is_emptied(part, left):
            parts.append(left)
    return together(parts)


def _is_emptied(before: Sequence[Statement], after: Sequence[Statement]) -> bool:
    """Return True if nothing but comments is left of statements: their title goes too. Comments alone stay."""
    return any(map(does_something, before)) and not any(map(does_something, after))


def _not_empty(statement: Statement) -> Sequence[Statement]:
    """Return a statement without branches from which everything was removed."""
    match statement:
        case n.If(branches, otherwise) if not any(is_impure(each.condition) for each in branches):
            excluded: list[Expression] = []
            kept: list[n.Branch] = []
            for each in branches:
                if not each.statements:
                    excluded.append(negation(each.condition))
                else:
                    condition = conjunction([*excluded, each.condition]) if excluded else each.condition
                    kept.append(n.Branch(condition, each.statements) if excluded else each)
            if excluded and otherwise:
                kept.append(n.Branch(conjunction(excluded), otherwise))
                otherwise = None
            if not kept:
                return ()
            return (n.If(tuple(kept), otherwise) if len(kept) < len(branches) or excluded else statement,)
        case n.Case(selector, branches, None) if not is_impure(selector):
            left = tuple(each for each in branches if any(map(does_something, each.statements)))
            if len(left) < len(branches):
                return (n.Case(selector, left),) if left else ()
        case n.RegionBlock(_, inner) if not any(map(does_something, inner)):
            return ()
    return (statement,)


class _Placed(NamedTuple):
    """Statement, and the place of its network."""

    network: int
    statement: Statement


class _Inliner:
    """Statements of all networks without the helpers `once`; `gone` are those that were replaced.

    `steps` are the variables of the situation: what sets and resets them is read better by its name.
    """

    def __init__(
        self,
        networks: Sequence[CodeNetwork],
        once: Collection[str],
        helpers: Collection[str],
        steps: Collection[str],
        *,
        private: set[str],
        timers: set[Path],
    ) -> None:
        self.placed = [_Placed(at, each) for at, network in enumerate(networks) for each in network.statements]
        self.gone: set[str] = set()
        self._helpers, self._steps, self._private, self._timers = helpers, steps, private, timers
        place = 0
        while place < len(self.placed):
            match self.placed[place].statement:
                case n.Assignment(n.Name(identifier), value, n.AssignmentKind.ASSIGN) if (
                    identifier.casefold() in once
                    and not is_impure(value)
                    and self._inlined(place, identifier.casefold(), value)
                ):
                    self.gone.add(identifier.casefold())
                case _:
                    place += 1

    def _inlined(self, place: int, name: str, value: Expression) -> bool:
        """Put the value of the helper that is written at `place` where it is read; False if it must stay."""
        behind = range(place + 1, min(place + 1 + _FARTHEST, len(self.placed)))
        reader = next((i for i in behind if name in names_in(self.placed[i].statement)), None)
        if reader is None:
            return False
        before: list[_Placed] = []
        after: list[_Placed] = []
        for each in self.placed[place + 1 : reader]:
            if self._changes(each.statement, reads(value)):
                after.append(each)  # the last value of an edge, which the reader needs as it was
            elif any(self._depend(each.statement, moved.statement) for moved in after):
                return False
            else:
                before.append(each)
        network, statement = self.placed[reader]
        replaced = self._replaced(statement, name, value)
        if replaced is None and not after:
            replaced = self._inside(statement, name, value)
        if replaced is None or not all(self._may_follow(each, self.placed[reader], replaced) for each in after):
            return False
        self.placed[place : reader + 1] = [*before, _Placed(network, replaced), *after]
        return True

    def _may_follow(self, moved: _Placed, reader: _Placed, replaced: Statement) -> bool:
        """Return True if a statement may come behind the one that reads the helper."""
        keeps = isinstance(moved.statement, n.Assignment) and not is_impure(moved.statement.value)
        leaves = any(isinstance(node, n.ReturnStatement | n.Exit | n.Continue) for node in walk(replaced))
        together = moved.network == reader.network
        return keeps and together and not leaves and not self._depend(reader.statement, moved.statement)

    def _changes(self, statement: Statement, read: frozenset[Path]) -> bool:
        return may_change(read, writes(statement, self._timers), self._private)

    def _depend(self, one: Statement, other: Statement) -> bool:
        """Return True if one of two statements changes what the other one reads or writes."""
        return self._changes(one, reads(other) | writes(other, self._timers)) or self._changes(other, reads(one))

    def _replaced(self, reader: Statement, name: str, value: Expression) -> Statement | None:
        """Return a statement with a value instead of a name, if it evaluates that before it does anything."""
        match reader:
            case n.If((first, *others), otherwise) if name in names_in(first.condition):
                if is_impure(first.condition):
                    return None
                return n.If((n.Branch(_with(first.condition, name, value), first.statements), *others), otherwise)
            case n.Assignment(target, n.Name(identifier), n.AssignmentKind.ASSIGN) if identifier.casefold() == name:
                return n.Assignment(target, value)
            case n.Assignment(target, whole, n.AssignmentKind.ASSIGN) if name in names_in(whole) and not is_impure(
                whole
            ):
                longer = n.Assignment(target, _with(whole, name, value))
                written = target.identifier.casefold() if isinstance(target, n.Name) else ""
                # a helper is a step on the way itself; in long lines a name tells more than its value
                shown = written not in self._steps and len(print_node(longer)) <= _LONGEST
                return longer if written in self._helpers or shown else None
        return None

    def _inside(self, reader: Statement, name: str, value: Expression) -> Statement | None:
        """Return the same where statements inside of another one read the name."""
        match reader:
            case n.RegionBlock(title, statements):
                inside = self._among(statements, name, value)
                return n.RegionBlock(title, inside) if inside is not None else None
            case n.Case(selector, branches, None) if name not in names_in(selector) and not is_impure(selector):
                place = next(i for i, branch in enumerate(branches) if name in names_in(branch))
                inside = self._among(branches[place].statements, name, _in_branch(value, reader, place))
                changed = replace(branches[place], statements=inside or ())
                return n.Case(selector, (*branches[:place], changed, *branches[place + 1 :])) if inside else None
            case n.If(branches, otherwise):
                for place, branch in enumerate(branches):
                    if is_impure(branch.condition):
                        return None
                    if name in names_in(branch.condition):
                        new = n.Branch(_with(branch.condition, name, value), branch.statements)
                    elif name in names_in(branch):
                        inside = self._among(branch.statements, name, value)
                        if inside is None:
                            return None
                        new = n.Branch(branch.condition, inside)
                    else:
                        continue
                    return n.If((*branches[:place], new, *branches[place + 1 :]), otherwise)
                inside = self._among(otherwise or (), name, value)
                return n.If(branches, inside) if inside is not None else None
        return None

    def _among(self, statements: tuple[Statement, ...], name: str, value: Expression) -> tuple[Statement, ...] | None:
        place = next(i for i, each in enumerate(statements) if name in names_in(each))
        if any(self._changes(each, reads(value)) for each in statements[:place]):
            return None
        reader = statements[place]
        found = self._replaced(reader, name, value) or self._inside(reader, name, value)
        return (*statements[:place], *without_constant(found), *statements[place + 1 :]) if found is not None else None


def _with(tree: Expression, name: str, value: Expression) -> Expression:
    def change(node: n.Node) -> n.Node:
        return n.Parenthesized(value) if isinstance(node, n.Name) and node.identifier.casefold() == name else node

    return simplified(transform(tree, change))


def _in_branch(value: Expression, case: n.Case, place: int) -> Expression:
    """Return a value without what is known in a branch of a CASE: which of its labels the selector is."""
    single = {branch.labels[0] for branch in case.branches if len(branch.labels) == 1}
    own = case.branches[place].labels
    # where there are several the selector is one of them, and no other single one
    return simplified(with_known(value, case.selector, own[0] if len(own) == 1 else None, single))
