"""A chart as a graph of steps and transitions, ready to be cut into branches.

A drawing runs downwards, so the edges of the chart are first told apart: *forward* edges are drawn as wires where they
fit, edges that close a loop or lead into what another start has drawn already become jumps. On the forward edges, which
have no loops, the immediate dominator of a node is the node above it at which all paths to it part: there the
divergence opens that has to be closed before the node. (Dominators after Cooper, Harvey, Kennedy: A Simple, Fast
Dominance Algorithm.)
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from plcopen_sfc.drawing.drawing_style import same_drawn
from plcopen_sfc.model.sfc import SfcNetwork, Step, Transition

ROOT = -1
"""Node above all starts."""


class ForwardEdges:
    """Forward edges, ranks and dominators of a directed graph, from one depth-first walk.

    An edge is *forward* where it neither closes a loop nor leads into what an earlier start has reached. `rank` numbers
    the nodes so that forward edges run upwards, `dominator` is the node through which all forward paths to a node pass
    last, `forward_inputs` counts the forward edges into a node, `merges` lists for a node what it dominates immediately
    and several forward edges lead to, by rank.
    """

    def __init__(self, successors: Mapping[int, Sequence[int]], candidates: Iterable[int]) -> None:
        self.successors = successors
        self.starts: list[int] = []
        self.rank: dict[int, int] = {}
        self.dominator: dict[int, int] = {}
        self.forward_inputs: dict[int, int] = {}
        self.merges: dict[int, list[int]] = {}
        self._tree: dict[int, int] = {}
        self._finished: list[int] = []
        self._inputs: dict[int, list[int]] = {}
        for start in (*candidates, *successors):
            if start not in self._tree:
                self._visit(start)
        nodes = self._finished[::-1]
        self.rank = {node: rank for rank, node in enumerate(nodes)}
        for node in nodes:
            self._dominate(node)

    def is_forward(self, source: int, target: int) -> bool:
        """True if there is a forward edge between two nodes."""
        return source in self._inputs[target]

    def _visit(self, start: int) -> None:
        """Depth first from `start`. Later starts get smaller ranks, which does no harm: no forward edge joins them."""
        tree = self._tree
        self.starts.append(start)
        tree[start] = start
        open_nodes = {start}
        self._inputs[start] = []
        stack = [(start, iter(self.successors[start]))]
        while stack:
            node, successors = stack[-1]
            for target in successors:
                if target not in tree:
                    tree[target] = start
                    self._inputs[target] = [node]
                    open_nodes.add(target)
                    stack.append((target, iter(self.successors[target])))
                    break
                if tree[target] == start and target not in open_nodes:
                    self._inputs[target].append(node)
            else:
                open_nodes.discard(node)
                self._finished.append(node)
                stack.pop()

    def _dominate(self, node: int) -> None:
        rank, inputs = self.rank, self._inputs[node]
        self.forward_inputs[node] = len(inputs)
        if not inputs:
            self.dominator[node] = ROOT
            return
        found = inputs[0]
        for other in inputs[1:]:
            one = other
            while one != found:
                if rank[one] > rank[found]:
                    one = self.dominator[one]
                else:
                    found = self.dominator[found]
        self.dominator[node] = found
        if len(inputs) > 1:
            self.merges.setdefault(found, []).append(node)


@dataclass(slots=True)
class DrawnTransition:
    """A transition as it is drawn: one symbol for all `members`, which differ in nothing but their source step."""

    members: list[Transition]
    alternatives: list[tuple[int, ...]]
    targets: tuple[int, ...]

    @property
    def sources(self) -> tuple[int, ...]:
        """Steps of all alternatives."""
        return tuple(dict.fromkeys(step for alternative in self.alternatives for step in alternative))

    @property
    def synchronizing(self) -> bool:
        """True if several steps have to be active."""
        return len(self.alternatives[0]) > 1


@dataclass(slots=True)
class ChartGraph:
    """Graph: `successors` of every node in the order in which they are drawn, and its forward `edges`."""

    steps: dict[int, Step]
    joints: dict[int, DrawnTransition]
    successors: dict[int, list[int]]
    edges: ForwardEdges


def flow_of(chart: SfcNetwork, together: Mapping[int, int], *, split: frozenset[int] = frozenset()) -> ChartGraph:
    """Return the graph of `chart`.

    `together`: which transitions may share a node, as a group number for each; those in `split` may not.
    """
    steps = {step.id: step for step in chart.steps}
    joints: dict[int, DrawnTransition] = {}
    for group in _groups(chart, together, split):
        first = group[0]
        alternatives = [tuple(dict.fromkeys(i for i in t.sources if i in steps)) for t in group]
        joints[first.id] = DrawnTransition(
            group, alternatives, tuple(dict.fromkeys(i for i in first.targets if i in steps))
        )
    successors: dict[int, list[int]] = {i: [] for i in steps}
    priorities = {i: joint.members[0].priority for i, joint in joints.items()}
    for number, joint in sorted(joints.items(), key=lambda item: _urgency(priorities[item[0]])):
        for source in joint.sources:
            successors[source].append(number)
        successors[number] = list(joint.targets)
    entered = {target for targets in successors.values() for target in targets}
    candidates = [i for i, step in steps.items() if step.initial]
    candidates += [i for i in (*steps, *joints) if i not in entered]
    return ChartGraph(steps, joints, successors, ForwardEdges(successors, candidates))


def alike(chart: SfcNetwork) -> dict[int, int]:
    """Neighbours among the transitions that differ in nothing but their source step, as a group number for each."""
    groups: dict[int, int] = {}
    last: Transition | None = None
    for transition in chart.transitions:
        if last is not None and same_but_source(last, transition):
            groups[transition.id] = groups.setdefault(last.id, last.id)
        last = transition
    return groups


def _urgency(priority: int | None) -> tuple[bool, int]:
    return (priority is None, priority or 0)


def _groups(chart: SfcNetwork, together: Mapping[int, int], split: frozenset[int]) -> list[list[Transition]]:
    """Return the transitions, those together that can be one symbol below a convergence of their steps."""
    leaving: dict[int, int] = {}
    for transition in chart.transitions:
        for source in dict.fromkeys(transition.sources):
            leaving[source] = leaving.get(source, 0) + 1
    groups: dict[int, list[Transition]] = {}
    found: list[list[Transition]] = []
    for transition in chart.transitions:
        number = together.get(transition.id)
        group = groups.get(number) if number is not None else None
        if group is not None and group[0].id not in split and same_but_source(group[0], transition):
            taken = {t.sources[0] for t in group}
            lone = all(leaving[t.sources[0]] == 1 for t in (*group, transition))
            if lone and transition.sources[0] not in taken:
                group.append(transition)
                continue
        found.append([transition])
        if number is not None:
            groups.setdefault(number, found[-1])
    return found


def same_but_source(one: Transition, other: Transition) -> bool:
    """True if two transitions with one source each differ in nothing else, so that one symbol can show both."""
    return len(one.sources) == len(other.sources) == 1 and one.targets == other.targets and same_drawn(one, other)
