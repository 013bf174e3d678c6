"""Helper variables that are read once: their value is written where it is read, and they are gone.

Readers are also inside of IF and CASE, and in other networks.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import NamedTuple

from plcopen_sfc.languages.effects import Path, is_impure, may_change, reads, writes
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node, transform, walk
from plcopen_sfc.languages.st.nodes import Expression, Operator, Statement
from plcopen_sfc.lowering.code.boolean_logic import FALSE, TRUE, names_in, simplified, without_constant
from plcopen_sfc.lowering.code.lowered_code import BOOL, CodeNetwork, LoweredCode
from plcopen_sfc.model.types import DerivedType, ElementaryType

_TIMERS = ("TON", "TOF", "TON_TIME", "TOF_TIME")
"""Types of instances whose calls change nothing but themselves."""
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
    timers: set[Path] = {
        (v.name.casefold(),) for v in code.variables if isinstance(v.type, DerivedType) and v.type.name in _TIMERS
    }
    inliner = _Inliner(code.networks, once, helpers, others, private=code.own_names, timers=timers)
    left: list[list[Statement]] = [[] for _ in code.networks]
    for at, statement in inliner.placed:
        left[at].append(statement)
    networks = zip(code.networks, left, strict=True)
    code.networks[:] = [replace(network, statements=tuple(own)) for network, own in networks if own]
    code.variables[:] = [variable for variable in code.variables if variable.name.casefold() not in inliner.gone]


def remove_unread(code: LoweredCode, kept: Collection[Expression]) -> None:
    """Remove variables that nothing reads, with what is assigned to them; those of `kept` stay."""
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
    unread -= set(names_in(*kept))
    for network in code.networks:
        for statement in network.statements:
            target = _pure_target(statement)
            names = Counter(names_in(statement))
            unread -= {name for name, count in names.items() if count > (name == target)}
    if not unread:
        return False
    for place, network in enumerate(code.networks):
        statements = tuple(each for each in network.statements if _pure_target(each) not in unread)
        code.networks[place] = replace(network, statements=statements)
    code.networks[:] = [each for each in code.networks if each.statements]
    written = {name for each in code.networks for name in names_in(*each.statements)}
    gone = unread - written
    code.variables[:] = [variable for variable in code.variables if variable.name.casefold() not in gone]
    return bool(gone)


def _pure_target(statement: Statement) -> str | None:
    match statement:
        case n.Assignment(n.Name(identifier), value, n.AssignmentKind.ASSIGN) if not is_impure(value):
            return identifier.casefold()
    return None


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
    labels = [branch.labels for branch in case.branches]

    def known(node: n.Node) -> n.Node:
        match node:
            case n.Operation(Operator.EQUAL | Operator.UNEQUAL as operator, (compared, label)):
                if compared == case.selector and (label,) in labels:
                    return TRUE if ((label,) == labels[place]) is (operator is Operator.EQUAL) else FALSE
        return node

    return simplified(transform(value, known))
