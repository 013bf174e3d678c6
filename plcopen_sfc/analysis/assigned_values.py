"""Variables of a POU that one statement assigns and nothing else writes: their values are those of its expression."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from itertools import chain, islice
from typing import NamedTuple, cast

from plcopen_sfc.languages.binding import bind
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import print_node, walk
from plcopen_sfc.languages.st.nodes import Expression
from plcopen_sfc.languages.st.walking import with_children
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Pou
from plcopen_sfc.semantics.programs.marks import may_act

_MOST_INLINED = 2_000
"""Nodes of the expressions that are put in the places of variables of one."""


class AssigningText(NamedTuple):
    """Text of a POU: the expressions that it assigns to variables, by their names (lower case).

    `inlined`: with those of variables that are assigned further up in their places.
    """

    inlined: Mapping[str, Expression]
    statements: tuple[n.Statement, ...]

    @property
    def computed(self) -> Mapping[str, Expression]:
        """The variables whose expressions hold whenever the text was executed.

        None where it does anything but assign, each variable once, and none of which an expression reads a variable of
        before: then nothing that they are computed of changes on the way.
        """
        written: set[str] = set()
        for statement in self.statements:
            match statement:
                case n.Assignment(n.Name(name), value, n.AssignmentKind.ASSIGN) if not any(map(may_act, walk(value))):
                    written.add(name.casefold())
                case _:
                    return {}
        return {
            name: value
            for name, value in self.inlined.items()
            if not any(isinstance(node, n.Name) and node.identifier.casefold() in written for node in walk(value))
        }


def assigning_texts(pou: Pou, dialect: Dialect) -> Iterator[AssigningText]:
    """Yield the texts of a POU, with the variables that one statement of it assigns and nothing else writes."""
    texts = [bind(body, dialect) for _, _, body in pou.named_bodies()]
    written = Counter(print_node(target).casefold() for text in texts for target in text.targets())
    acting = {".".join(path) for text in texts for chart in text.charts for path in chart.acting.writes}
    for text in texts:
        inside: dict[str, Expression] = {}
        for statement in text.statements:
            match statement:
                case n.Assignment(n.Name(name), value, n.AssignmentKind.ASSIGN):
                    key = name.casefold()
                    if written[key] == 1 and key not in acting:
                        inside[key] = with_values(value, inside)
        yield AssigningText(inside, tuple(text.statements))


def with_values(tree: Expression, assigned: Mapping[str, Expression]) -> Expression:
    """Return an expression with those that are assigned to its variables in their places.

    It stays as it is where it would become too long: one that names the one before it twice doubles with each.
    """
    names = (node.identifier.casefold() for node in walk(tree) if isinstance(node, n.Name))
    put_in = chain.from_iterable(walk(assigned[name]) for name in names if name in assigned)
    if next(islice(put_in, _MOST_INLINED, None), None) is not None:
        return tree

    def changed(node: n.Node) -> n.Node:
        if isinstance(node, n.Name):
            found = assigned.get(node.identifier.casefold())
            return node if found is None else n.Parenthesized(found)
        return node if isinstance(node, n.Member | n.Index | n.Call) else with_children(node, changed)

    return cast("Expression", changed(tree))
