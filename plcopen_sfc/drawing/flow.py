"""A chart as a graph of steps and transitions, ready to be cut into branches.

A drawing runs downwards, so the edges of the chart are first told apart: *forward* edges are drawn as wires where they
fit, edges that close a loop or lead into what another start has drawn already become jumps. On the forward edges, which
have no loops, the immediate dominator of a node is the place above it where all ways to it part: there the branch
opens that has to be closed before the node. (Cooper, Harvey, Kennedy: A Simple, Fast Dominance Algorithm.)
"""

from __future__ import annotations

from dataclasses import dataclass, field

from plcopen_sfc.model.sfc import SfcNetwork, Step, Transition

ROOT = -1
"""The node above all starts."""


@dataclass(slots=True)
class Joint:
    """A transition as it is drawn: one symbol for each of `members`, which differ in nothing but their source step."""

    members: list[Transition]
    alternatives: list[tuple[int, ...]]
    targets: tuple[int, ...]

    @property
    def sources(self) -> tuple[int, ...]:
        """The steps of all alternatives."""
        return tuple(dict.fromkeys(step for alternative in self.alternatives for step in alternative))

    @property
    def synchronizing(self) -> bool:
        """Whether several steps have to be active."""
        return len(self.alternatives[0]) > 1


@dataclass(slots=True)
class Flow:
    """The graph: `successors` of every node in the order in which they are drawn, and what is known of its forward edges."""

    steps: dict[int, Step]
    joints: dict[int, Joint]
    successors: dict[int, list[int]]
    starts: list[int] = field(default_factory=list)
    rank: dict[int, int] = field(default_factory=dict)
    dominator: dict[int, int] = field(default_factory=dict)
    forward_inputs: dict[int, int] = field(default_factory=dict)
    merges: dict[int, list[int]] = field(default_factory=dict)


def flow_of(chart: SfcNetwork, *, merge: bool, split: frozenset[int] = frozenset()) -> Flow:
    """The graph of `chart`. `merge`: transitions that differ only in their source are one node, but those in `split`."""
    steps = {step.id: step for step in chart.steps}
    joints: dict[int, Joint] = {}
    for group in _groups(chart, merge, split):
        first = group[0]
        alternatives = [tuple(dict.fromkeys(i for i in t.sources if i in steps)) for t in group]
        joints[first.id] = Joint(group, alternatives, tuple(dict.fromkeys(i for i in first.targets if i in steps)))
    successors: dict[int, list[int]] = {i: [] for i in steps}
    priorities = {i: joint.members[0].priority for i, joint in joints.items()}
    for number, joint in sorted(joints.items(), key=lambda item: _urgency(priorities[item[0]])):
        for source in joint.sources:
            successors[source].append(number)
        successors[number] = list(joint.targets)
    flow = Flow(steps, joints, successors)
    _Survey(flow).run()
    return flow


def _urgency(priority: int | None) -> tuple[bool, int]:
    return (priority is None, priority or 0)


def _groups(chart: SfcNetwork, merge: bool, split: frozenset[int]) -> list[list[Transition]]:
    """The transitions, those together that can be one symbol below a convergence of their steps."""
    leaving: dict[int, int] = {}
    for transition in chart.transitions:
        for source in dict.fromkeys(transition.sources):
            leaving[source] = leaving.get(source, 0) + 1
    groups: list[list[Transition]] = []
    for transition in chart.transitions:
        if merge and groups and groups[-1][0].id not in split and same_but_source(groups[-1][-1], transition):
            group = groups[-1]
            taken = {t.sources[0] for t in group}
            lone = all(leaving[t.sources[0]] == 1 for t in (*group, transition))
            if lone and transition.sources[0] not in taken:
                group.append(transition)
                continue
        groups.append([transition])
    return groups


def same_but_source(one: Transition, other: Transition) -> bool:
    """Whether two transitions with one source each differ in nothing else, so that one symbol can stand for both."""
    if len(one.sources) != 1 or len(other.sources) != 1 or one.targets != other.targets:
        return False
    same = {"id": 0, "sources": []}
    return one.model_copy(update=same) == other.model_copy(update=same)


class _Survey:
    """Finds starts, forward edges, ranks and dominators."""

    def __init__(self, flow: Flow) -> None:
        self.flow = flow
        self.tree: dict[int, int] = {}
        self.finished: list[int] = []
        self.inputs: dict[int, list[int]] = {}

    def run(self) -> None:
        flow = self.flow
        entered = {target for targets in flow.successors.values() for target in targets}
        candidates = [i for i, step in flow.steps.items() if step.initial]
        candidates += [i for i in flow.steps if i not in entered]
        candidates += [i for i in flow.joints if i not in entered]
        for start in (*candidates, *flow.steps, *flow.joints):
            if start not in self.tree:
                self._visit(start)
        for rank, node in enumerate(reversed(self.finished)):
            flow.rank[node] = rank
        for node in reversed(self.finished):
            self._dominate(node)

    def _visit(self, start: int) -> None:
        """Depth first from `start`; later starts get smaller ranks, which does no harm: no forward edge joins them."""
        flow, tree = self.flow, self.tree
        flow.starts.append(start)
        tree[start] = start
        open_nodes = {start}
        self.inputs[start] = []
        stack = [(start, iter(flow.successors[start]))]
        while stack:
            node, successors = stack[-1]
            for target in successors:
                if target not in tree:
                    tree[target] = start
                    self.inputs[target] = [node]
                    open_nodes.add(target)
                    stack.append((target, iter(flow.successors[target])))
                    break
                if tree[target] == start and target not in open_nodes:
                    self.inputs[target].append(node)
            else:
                open_nodes.discard(node)
                self.finished.append(node)
                stack.pop()

    def _dominate(self, node: int) -> None:
        flow, rank = self.flow, self.flow.rank
        inputs = self.inputs[node]
        flow.forward_inputs[node] = len(inputs)
        if not inputs:
            flow.dominator[node] = ROOT
            return
        found = inputs[0]
        for other in inputs[1:]:
            one = other
            while one != found:
                if rank[one] > rank[found]:
                    one = flow.dominator[one]
                else:
                    found = flow.dominator[found]
        flow.dominator[node] = found
        if len(inputs) > 1:
            flow.merges.setdefault(found, []).append(node)
