"""The order in which a tool that fires transitions first executes the stored actions of a GRAFCET.

A GRAFCET stores on deactivation first, then on activation. The tool executes actions in the order in which its chart
first uses them: that of a step behind the one that is activated comes last.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from itertools import product

from plcopen_sfc.languages.binding.name_sites import in_tree
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_statements, walk
from plcopen_sfc.model.actions import ActionKind
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.sfc import ActionAssociation, SfcNetwork, Step, connected_parts

STORED = frozenset({ActionKind.ON_ACTIVATION, ActionKind.ON_DEACTIVATION, ActionKind.ON_EVENT})
"""The kinds of actions that are executed once."""


@dataclass(frozen=True, eq=False)
class _Store:
    """A stored action of a step: the names in it, in lower case, and those that it writes."""

    step: Step
    action: ActionAssociation
    names: frozenset[str]
    written: frozenset[str]

    def depends_on(self, other: _Store) -> bool:
        """True if it matters which of both is executed first."""
        return not (self.names.isdisjoint(other.written) and self.written.isdisjoint(other.names))


def in_one_action(
    chart: SfcNetwork, by_rules: Collection[int], coils: Collection[str]
) -> tuple[list[ActionAssociation], bool]:
    """Return the stored actions that one action must execute, for the order of a GRAFCET; and if that is possible.

    Those of two steps of which the first is left when the second is activated, where the tool would execute them the
    other way round; and all that depend on these. `by_rules`: the ids of steps that orders and enclosing steps
    activate. `coils`: variables, in lower case, which are set and reset by qualifiers, in an order of their own.
    """
    numbers = {step.id: number for number, step in enumerate(chart.steps)}
    stores = [
        _Store(step, each, *_touched(stored_text(each)))
        for step, each in chart.associations()
        if each.kind in STORED - {ActionKind.ON_EVENT}
        and (each.body is not None or (each.target or "").casefold() not in coils)
    ]
    follow = {(s, t) for each in chart.transitions for s in each.sources for t in each.targets}
    parts = connected_parts(chart.steps, chart.transitions)
    sequence = {step.id: number for number, part in enumerate(parts) for step in part}
    forked = {sequence[i] for t in chart.transitions if len(t.targets) > 1 for i in t.targets}

    def at_once(left: Step, entered: Step) -> bool:
        one, other = sequence[left.id], sequence[entered.id]
        return entered.id in by_rules or (left.id, entered.id) in follow or one != other or one in forked

    found: list[_Store] = []
    for one, other in product(stores, stores):
        is_pair = (one.action.kind, other.action.kind) == (ActionKind.ON_DEACTIVATION, ActionKind.ON_ACTIVATION)
        is_later = numbers[one.step.id] > numbers[other.step.id]
        if is_pair and is_later and one.depends_on(other) and at_once(one.step, other.step):
            found += [one, other]
    waiting = list(found)
    while waiting:
        here = waiting.pop()
        more = [each for each in stores if each not in found and each.depends_on(here)]
        found += more
        waiting += more
    return [each.action for each in dict.fromkeys(found)], all(each.names.isdisjoint(coils) for each in found)


def stored_names(chart: SfcNetwork) -> set[str]:
    """Return the variables that stored actions write, in lower case."""
    stored = (each for _, each in chart.associations() if each.kind in STORED)
    return {name for each in stored for name in _touched(stored_text(each))[1]}


def stored_text(each: ActionAssociation) -> str:
    """Return what a stored action executes, as statements."""
    return each.body.text if isinstance(each.body, StBody) else f"{each.target} := {each.value or 'TRUE'};"


def first_names(tree: n.Node) -> list[str]:
    """Return the names in a tree, but for those of members and parameters."""
    return [each.name for each in in_tree(tree, Dialect.IEC) if each.base is None and each.callee is None]


def _touched(text: str) -> tuple[frozenset[str], frozenset[str]]:
    """Return the names in statements, in lower case, and those that they write: all where they call something."""
    tree = parse_statements(text).tree
    names = frozenset(name.casefold() for name in first_names(tree))
    if any(isinstance(node, n.CallStatement) for node in walk(tree)):
        return names, names
    targets = [node.target for node in walk(tree) if isinstance(node, n.Assignment)]
    return names, frozenset(name.casefold() for each in targets for name in first_names(each))
