"""What a GRAFCET does within one scan and a tool that fires transitions once in a scan does not.

A GRAFCET fires transitions until none can fire with the same inputs, and all that leave a step together. It stores on
deactivation first, then on activation; a tool that fires transitions first executes actions in the order in which its
chart first uses them: that of a step behind the one that is activated comes last. The conditions are in structured text
by now, the actions as they were.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, product

from plcopen_sfc.analysis.exclusivity import exclusive
from plcopen_sfc.languages.binding.name_sites import in_tree
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, parse_statements, print_node, transform, walk
from plcopen_sfc.lowering.code.boolean_logic import FALSE
from plcopen_sfc.model.actions import ActionKind
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.sfc import ActionAssociation, Condition, SfcNetwork, Step, Transition, connected_parts

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


def written_in_place(chart: SfcNetwork) -> set[str]:
    """Return the variables that statements in steps write, in lower case."""
    bodies = (each.body.text for _, each in chart.associations() if isinstance(each.body, StBody))
    return {name for text in bodies for name in _touched(text)[1]}


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


class Evolutions:
    """The transitions of a chart, and what can happen in the second evolution of a scan.

    `over`: what variables that are edges of inputs are in that evolution. `lately`: the variables, in lower case, that
    actions store, and edges of these and of flags.
    """

    def __init__(self, chart: SfcNetwork, over: Mapping[str, n.Expression], lately: Collection[str]) -> None:
        self._chart, self._over, self._lately = chart, over, lately
        self._trees = {each.id: _tree(each.condition) for each in chart.transitions}
        self._steps = {step.name.casefold() for step in chart.steps}

    def passed(self, also: Mapping[int, Sequence[Transition]]) -> Iterator[Step]:
        """Yield the steps that can be left with the inputs with which they are entered: a GRAFCET only passes them.

        `also`: transitions that let steps (ids) evolve beside those that lead to them. An enclosing step enters those
        with a link, the end of a forcing order frees those of its chart.
        """
        for step in self._chart.steps:
            entering = [*self._chart.incoming(step), *also.get(step.id, ())]
            before = [print_node(tree) for t in entering if (tree := self._trees[t.id]) is not None]
            leaving = [tree for t in self._chart.outgoing(step) if (tree := self._trees[t.id]) is not None]
            after = [print_node(self._without_edges(_with_no_time_in(tree, step))) for tree in leaving]
            if any(not exclusive(one, other).answer for one in before for other in after):
                yield step

    def late(self) -> Iterator[Transition]:
        """Yield the transitions whose conditions may become TRUE in the second evolution of a scan.

        By the flag of a step, by what an action stores, or because an edge is over.
        """
        return (each for each in self._chart.transitions if self._is_late(each))

    def _is_late(self, transition: Transition) -> bool:
        tree = self._trees[transition.id]
        if tree is None:
            return False
        left = {step.name.casefold() for step in self._chart.steps if step.id in transition.sources}
        for node in walk(tree):
            if isinstance(node, n.Member) and isinstance(node.base, n.Name) and node.name.identifier.upper() == "X":
                name = node.base.identifier.casefold()
                if name in self._steps and name not in left:
                    return True
            if isinstance(node, n.Name) and node.identifier.casefold() in self._lately:
                return True
        behind = self._without_edges(tree)
        return behind != tree and not exclusive(print_node(behind), f"NOT ({print_node(tree)})").answer

    def left_together(self) -> Iterator[Step]:
        """Yield the steps that several transitions can leave together, of which a tool fires the first."""
        for step in self._chart.steps:
            leaving = [print_node(tree) for t in self._chart.outgoing(step) if (tree := self._trees[t.id]) is not None]
            if any(not exclusive(one, other).answer for one, other in combinations(leaving, 2)):
                yield step

    def _without_edges(self, tree: n.Expression) -> n.Expression:
        """Return a condition as it is in the evolution behind that which edges of inputs are in."""
        return transform(tree, lambda node: self._over.get(node.identifier, node) if isinstance(node, n.Name) else node)


def _tree(condition: Condition | None) -> n.Expression | None:
    return parse_expression(condition.text).tree if isinstance(condition, Expression) else None


def _with_no_time_in(tree: n.Expression, step: Step) -> n.Expression:
    """Return a condition that waits for a time of a step as it is when the step was just entered."""
    own = f"{step.name}.T".casefold()

    def passed(node: n.Node) -> n.Node:
        times = isinstance(node, n.Operation) and isinstance(node.operands[0], n.Member)
        return FALSE if times and print_node(node).partition(" ")[0].casefold() == own else node

    return transform(tree, passed)
