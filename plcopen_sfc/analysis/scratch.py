"""Variables that a program writes in every scan before it reads them: their old values are no part of its state.

Lowered charts compute transition bits anew in every scan. Without this a search would tell states apart that differ in
such bits only.
"""

from __future__ import annotations

from collections.abc import Iterable

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_statements
from plcopen_sfc.languages.st.walking import walk
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.pou import Pou

__all__ = ["scratch_variables"]


def scratch_variables(pou: Pou, dialect: Dialect) -> frozenset[str]:
    """The names (lower case) that the body of a POU assigns on its top level before anything else could use them.

    Empty for what is not one body of structured text without actions and methods, which see the variables too.
    """
    body = pou.body
    if len(pou.bodies) != 1 or not isinstance(body, StBody) or pou.actions or pou.methods or pou.transitions:
        return frozenset()
    parsed = parse_statements(body.text, dialect)
    if parsed.problems:
        return frozenset()
    found: set[str] = set()
    used: set[str] = set()
    for statement in parsed.tree.statements:
        nodes = list(walk(statement))
        if any(isinstance(node, n.Return | n.Goto | n.Label | n.Unreadable) for node in nodes):
            break
        if isinstance(statement, n.Assignment) and isinstance(statement.target, n.Name):
            used.update(_names(walk(statement.value)))
            target = statement.target.identifier.casefold()
            if statement.kind is n.AssignmentKind.ASSIGN and target not in used:
                found.add(target)
            used.add(target)
        else:
            used.update(_names(nodes))
    return frozenset(found)


def _names(nodes: Iterable[object]) -> Iterable[str]:
    return (node.identifier.casefold() for node in nodes if isinstance(node, n.Name))
