"""Bodies that alone see the variables of their POU: what their statements do to these is all that is done to them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence

from plcopen_sfc.languages.networks import body_statements
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_statements
from plcopen_sfc.languages.st.walking import children
from plcopen_sfc.model.body import FbdBody, LdBody, StBody
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.semantics.programs.instances import Instance

__all__ = ["path_names", "sole_statements"]

_ALIASES = (n.Dereference, n.Peripheral)
_JUMPS = (n.Goto, n.Label, n.Try, n.Unreadable)


def sole_statements(instance: Instance) -> Sequence[n.Statement] | None:
    """The statements of the only body of a POU, if it alone sees the variables, and by their names only.

    None for what is not one body of text, FBD or LD without actions and methods, which see the variables too, or where
    references or jumps are used.
    """
    pou, project = instance.unit.pou, instance.controller.project
    if len(pou.bodies) != 1 or pou.actions or pou.methods or pou.transitions or instance.unit.base is not None:
        return None
    if pou.kind is PouKind.PROGRAM and _seen_by_others(pou, project.pous):
        return None
    body = pou.body
    statements: Sequence[n.Statement]
    if isinstance(body, StBody):
        parsed = parse_statements(body.text, project.dialect)
        if parsed.problems:
            return None
        statements = parsed.tree.statements
    elif isinstance(body, FbdBody | LdBody):
        read = body_statements(body, project.dialect)
        if read.obstacles or read.helpers:
            return None
        statements = read.tree.statements
    else:
        return None
    for node in _all_nodes(statements):
        if isinstance(node, _ALIASES + _JUMPS):
            return None
        if isinstance(node, n.Assignment) and node.kind in (n.AssignmentKind.REFERENCE, n.AssignmentKind.ATTEMPT):
            return None
        if isinstance(node, n.Call) and isinstance(node.callee, n.Name) and node.callee.identifier.upper() == "ADR":
            return None
    return statements


def _seen_by_others(pou: Pou, others: Iterable[Pou]) -> bool:
    """Whether another POU of the project names this one, as in ``Main.x``."""
    name = re.compile(rf"\b{re.escape(pou.name)}\b", re.IGNORECASE)
    return any(name.search(each.model_dump_json()) for each in others if each.name != pou.name)


def _all_nodes(statements: Sequence[n.Statement]) -> Iterator[n.Node]:
    """All nodes of statements."""
    waiting: list[n.Node] = list(statements)
    while waiting:
        node = waiting.pop()
        yield node
        waiting += children(node)


def path_names(node: n.Node) -> list[str] | None:
    """The names of a path in lower case; None: that is none."""
    parts: list[str] = []
    while isinstance(node, n.Member):
        parts.append(node.name.identifier.casefold())
        node = node.base
    return [node.identifier.casefold(), *reversed(parts)] if isinstance(node, n.Name) else None
