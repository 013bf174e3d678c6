"""Lists of statements, also inside of IF, CASE and loops: changed, divided into paragraphs, joined."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from typing import TypeAlias, TypeVar

from plcopen_sfc.languages.effects import Path, is_impure, may_change, reads, writes
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import walk
from plcopen_sfc.languages.st.nodes import Statement
from plcopen_sfc.languages.st.walking import with_children, with_statements
from plcopen_sfc.lowering.code.lowered_code import LoweredCode
from plcopen_sfc.model.types import DerivedType

N = TypeVar("N", bound=n.Node)
Body: TypeAlias = "tuple[Statement, ...]"
_TIMERS = ("TON", "TOF", "TON_TIME", "TOF_TIME")


def timers_of(code: LoweredCode) -> set[Path]:
    """Return the instances in `code` whose calls change nothing but themselves."""
    kinds = ((v.name.casefold(), v.type.name) for v in code.variables if isinstance(v.type, DerivedType))
    return {(name,) for name, kind in kinds if kind in _TIMERS}


def with_bodies(node: N, change: Callable[[Body], Body]) -> N:
    """Return a statement with `change` applied to all statements directly inside it; itself where none is another."""

    def in_branches(each: n.Node) -> n.Node:
        return with_statements(each, change) if isinstance(each, n.Branch | n.CaseBranch) else each

    return with_statements(with_children(node, in_branches), change)


def does_something(statement: Statement) -> bool:
    """Return False for a comment."""
    return not isinstance(statement, n.Remark)


def paragraphs(body: Body) -> list[Body]:
    """Return the statements between empty lines."""
    empty = [i for i, each in enumerate(body) if each == n.Remark("")]
    return [body[start:end] for start, end in zip([0, *(i + 1 for i in empty)], [*empty, len(body)], strict=True)]


def together(parts: Sequence[Body]) -> Body:
    """Return statements with an empty line between two of `parts`."""
    found = [each for part in parts for each in (n.Remark(""), *part)]
    return tuple(found[1:])


def join_conditionals(code: LoweredCode) -> None:
    """Write IFs under one condition that follow each other as one; a restart also with the network behind it."""
    timers, private = timers_of(code), code.own_names

    def joined(one: Statement, other: Statement) -> n.If | None:
        match one, other:
            case n.If((n.Branch(condition, first),), None), n.If((n.Branch(same, second),), None) if condition == same:
                leaves = any(isinstance(node, n.ReturnStatement | n.Exit | n.Continue) for node in walk(one))
                changes = (may_change(reads(condition), writes(each, timers), private) for each in first)
                if not (is_impure(condition) or leaves or any(changes)):
                    return n.If((n.Branch(condition, (*first, *second)),))
        return None

    def inside(body: Body) -> Body:
        found: list[Statement] = []
        for each in body:
            last = joined(found[-1], each) if found and _asks_only_for(private, each) else None
            found[-1:] = [last or found[-1], *([each] if last is None else [])] if found else [each]
        return tuple(with_bodies(each, inside) for each in found)

    found = code.networks[:1]
    for network in code.networks[1:]:
        # a restart is one paragraph; others are told apart by their titles
        alone = found[-1].title == code.texts.init and len(found[-1].statements) == len(network.statements) == 1
        last = joined(found[-1].statements[0], network.statements[0]) if alone else None
        if last is None:
            found.append(network)
        else:
            found[-1] = replace(found[-1], statements=(last,))
    code.networks[:] = [replace(each, statements=inside(each.statements)) for each in found]


def _asks_only_for(private: Collection[str], statement: Statement) -> bool:
    """Return True if the condition of an IF has names of the lowered code alone: others are as the user wrote them."""
    match statement:
        case n.If((n.Branch(condition, _),), None):
            return all(path[:1] and path[0] in private for path in reads(condition))
    return False
