"""Effects of syntax trees as far as names tell: the variables they read and write, and what they call."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Set
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.nodes import AssignmentKind, Expression, Statement
from plcopen_sfc.languages.st.walking import children, walk
from plcopen_sfc.languages.standard_blocks import BOUND_FUNCTIONS, standard_block

Path = tuple[str, ...]
"""A variable and the members that lead to a part of it, in lower case; indices are left out, which means any."""

ANYTHING: Path = ()
"""Reaches every variable: what a pointer leads to, or what a call of unknown code may write."""


def path_of(expression: Expression) -> Path:
    """Return the path of a variable; `ANYTHING` for what is no variable."""
    names: list[str] = []
    at: Expression = n.bare(expression)
    while True:
        if isinstance(at, n.Name):
            names.append(at.identifier.casefold())
            return tuple(reversed(names))
        if isinstance(at, n.Address):
            return (at.text.casefold(),)
        if isinstance(at, n.Member):
            names.append(at.name.identifier.casefold())
        elif isinstance(at, n.Index | n.Peripheral):
            names.clear()
        else:
            return ANYTHING
        at = n.bare(at.base)


def plain_path(node: n.Node) -> Path | None:
    """Return the path of a variable that is given by names alone; None for anything else."""
    names: list[str] = []
    while isinstance(node, n.Member):
        names.append(node.name.identifier.casefold())
        node = node.base
    return (node.identifier.casefold(), *reversed(names)) if isinstance(node, n.Name) else None


def is_variable(expression: Expression) -> bool:
    """True if it names a variable or a part of one."""
    return isinstance(expression, _VARIABLES)


_VARIABLES = (n.Name, n.Member, n.Index, n.Dereference, n.Peripheral, n.Address)


_SETTING = {AssignmentKind.SET: "TRUE", AssignmentKind.RESET: "FALSE"}


def conditional_assignment(node: n.Assignment) -> n.If | None:
    """Return ``IF a THEN q := TRUE; END_IF`` for ``q S= a``, FALSE for ``R=``; None for other assignments."""
    if node.kind not in _SETTING or isinstance(node.value, n.AssignmentExpression):
        return None
    done = n.Assignment(node.target, n.Literal(_SETTING[node.kind]))
    return n.If((n.Branch(node.value, (done,)),), span=node.span)


@dataclass(frozen=True, slots=True)
class Effects:
    """The variables that are read and written, and the names by which something is called (see `calls`)."""

    reads: frozenset[Path] = frozenset()
    writes: frozenset[Path] = frozenset()
    calls: frozenset[Path] = frozenset()

    @classmethod
    def all(cls, found: Iterable[Effects]) -> Effects:
        """Return several effects as one."""
        reading, writing, calling = set[Path](), set[Path](), set[Path]()
        for each in found:
            reading |= each.reads
            writing |= each.writes
            calling |= each.calls
        return cls(frozenset(reading), frozenset(writing), frozenset(calling))


def effects(nodes: Iterable[Expression | Statement], standard_instances: Set[Path] = frozenset()) -> Effects:
    """Return the effects of expressions and statements together. `standard_instances` as in `writes`."""
    return Effects.all(Effects(reads(node), writes(node, standard_instances), calls(node)) for node in nodes)


@lru_cache(maxsize=4096)
def reads(node: Expression | Statement) -> frozenset[Path]:
    """Return the variables that an expression or a statement reads."""
    found: set[Path] = set()
    waiting: list[Any] = [node]
    while waiting:
        item = waiting.pop()
        if isinstance(item, tuple):
            waiting.extend(item)
        elif isinstance(item, n.Assignment | n.AssignmentExpression):
            waiting += [item.value, *_read_to_find(item.target)]
        elif isinstance(item, n.Index):
            found.add(path_of(item))  # that of the array: which element it is, only a run tells
            waiting += [item.base, item.indices]
        elif isinstance(item, n.Name | n.Member | n.Address | n.Dereference | n.Peripheral):
            found.add(path_of(item))
            if not isinstance(item, n.Name | n.Address):
                waiting += [at for at in walk(item) if isinstance(at, n.Index | n.Call)]
        elif isinstance(item, n.Call):
            waiting.append(item.arguments)
            if not isinstance(item.callee, n.Name):  # a method or an action: the instance before it is read
                found.add(path_of(item.callee))
        elif isinstance(item, n.CallStatement) and isinstance(item.call, n.Name):
            pass  # an action
        elif isinstance(item, n.Argument):
            waiting.extend(_read_to_find(item.value) if item.output and item.value is not None else (item.value,))
        elif isinstance(item, n.Node):
            waiting.extend(children(item))
    return frozenset(found)


def _read_to_find(target: Expression) -> list[Expression]:
    """Return the names that are read to find the variable that is written: indices, pointers."""
    found: list[Expression] = []
    at = n.bare(target)
    while isinstance(at, n.Member | n.Index):
        if isinstance(at, n.Index):
            found += at.indices
        at = n.bare(at.base)
    return found if isinstance(at, n.Name | n.Address) else [*found, at]


@lru_cache(maxsize=4096)
def calls(node: Expression | Statement) -> frozenset[Path]:
    """Return the names by which functions, instances, methods and actions are called.

    Indices are left out, and what is in front of a pointer or of a call: ``THIS^.Fill()`` calls ``Fill`` of something.
    """
    found: set[Path] = set()
    for each in walk(node):
        if isinstance(each, n.Call):
            found.add(_called(each.callee))
        elif isinstance(each, n.CallStatement) and not isinstance(each.call, n.Call):
            found.add(_called(each.call))
    return frozenset(found - {ANYTHING})


def _called(callee: Expression) -> Path:
    names: list[str] = []
    at = n.bare(callee)
    while isinstance(at, n.Member | n.Index):
        if isinstance(at, n.Member):
            names.append(at.name.identifier.casefold())
        at = n.bare(at.base)
    if isinstance(at, n.Name):
        names.append(at.identifier.casefold())
    return tuple(reversed(names))


@lru_cache(maxsize=4096)
def is_impure(expression: Expression) -> bool:
    """True if evaluating it twice may differ from once: it calls what is no standard function, or assigns."""
    return any(
        isinstance(node, n.AssignmentExpression | n.EmbeddedCode | n.Unreadable)
        or (isinstance(node, n.Call) and not is_standard_call(node))
        for node in walk(expression)
    )


@lru_cache(maxsize=4096)
def is_repeatable(expression: Expression) -> bool:
    """True if it may be written more than once: evaluating it again is the same, and it is short."""
    # whether arguments have names makes no difference
    size = sum(-(node.name is not None) if isinstance(node, n.Argument) else 1 for node in walk(expression))
    return not is_impure(expression) and size <= _MAX_REPEATED


_MAX_REPEATED = 30
"""Number of nodes that an expression may have that is written more than once."""


def is_standard_call(call: n.Call) -> bool:
    """True if it calls a standard function, and has no output parameters."""
    if any(argument.output for argument in call.arguments):
        return False
    block = standard_block(call.called)
    return call.called.upper() in BOUND_FUNCTIONS or (block is not None and not block.stateful)


def writes(tree: Expression | Statement, standard_instances: Set[Path]) -> frozenset[Path]:
    """Return the variables that a statement or expression writes.

    `standard_instances`: those of standard function blocks.
    """
    found: set[Path] = set()
    for node in walk(tree):
        target = target_of(node)
        if target is not None:
            found.add(path_of(target))
        if isinstance(node, n.Call) and not is_standard_call(node):
            path = path_of(node.callee)
            found.update((path,) if path in standard_instances else (path, ANYTHING))
        elif isinstance(node, n.Unreadable) or (
            isinstance(node, n.CallStatement) and not isinstance(node.call, n.Call)
        ):
            found.add(ANYTHING)
    return frozenset(found)


def targets(tree: n.Node) -> Iterator[Expression]:
    """Yield the variables that a tree names as written: by assignments, loops and outputs of calls."""
    yield from (target for target in map(target_of, walk(tree)) if target is not None)


def target_of(node: n.Node) -> Expression | None:
    """Return the variable that a node itself writes: an assignment, a loop, an output of a call."""
    if isinstance(node, n.Assignment | n.AssignmentExpression):
        return node.target
    if isinstance(node, n.For):
        return node.variable
    return node.value if isinstance(node, n.Argument) and node.output else None


def may_change(read: frozenset[Path], written: frozenset[Path], private: Set[str]) -> bool:
    """True if one of the variables `read` may be one of those `written`, or a part of it or around it.

    `private` are variables that only a statement that names them can read and write: helpers and instances.
    """

    def unknown(one: Path, other: Path) -> bool:
        return one == ANYTHING and other[:1] != () and other[0] in private

    return any(_overlap(a, b) for a in read for b in written if not (unknown(a, b) or unknown(b, a)))


def _overlap(a: Path, b: Path) -> bool:
    # a global variable may be named with or without its list: GVL.x, x
    starts = [(a, b)] + ([(a[1:], b)] if len(a) > 1 else []) + ([(a, b[1:])] if len(b) > 1 else [])
    return any(all(x == y for x, y in zip(one, other, strict=False)) for one, other in starts)
