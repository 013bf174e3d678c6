"""What a GRAFCET does within one scan and a tool that fires transitions once in a scan does not.

A GRAFCET fires transitions until none can fire with the same inputs, and all that leave a step together. The conditions
are in structured text by now, the actions as they were.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import combinations

from plcopen_sfc.analysis.exclusivity import exclusive
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, print_node, transform, walk
from plcopen_sfc.lowering.code.boolean_logic import FALSE
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.sfc import Condition, SfcNetwork, Step, Transition


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
