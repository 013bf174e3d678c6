"""Graph of a chart, ready to be cut into branches: which of its edges a drawing runs along.

A drawing runs downwards, so the edges of the chart are first told apart: *forward* edges are drawn as wires where they
fit, edges that close a loop or lead into what another start has drawn already become jumps. On the forward edges, which
have no loops, the immediate dominator of a node is the node above it at which all paths to it part: there the
divergence opens that has to be closed before the node. (Dominators after Cooper, Harvey, Kennedy: A Simple, Fast
Dominance Algorithm.)

A jump from outside into a simultaneous branch would take the double bar below the branches apart: the step that it
leads to is no longer below the divergence alone. So the simultaneous branches of every convergence are found first, and
what leads into them from outside is a jump.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

ROOT = -1
"""Node above all starts."""


class ForwardEdges:
    """Forward edges, ranks and dominators of a directed graph, from one depth-first walk.

    An edge is *forward* where it is not one of `jumps`, does not close a loop, and does not lead into what an earlier
    start has reached. `rank` numbers
    the nodes so that forward edges run upwards, `dominator` is the node through which all forward paths to a node pass
    last, `forward_inputs` counts the forward edges into a node, `merges` lists for a node what it dominates immediately
    and several forward edges lead to, by rank.
    """

    def __init__(
        self,
        successors: Mapping[int, Sequence[int]],
        candidates: Iterable[int],
        jumps: frozenset[tuple[int, int]] = frozenset(),
    ) -> None:
        self.successors = successors
        self.jumps = jumps
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
        tree, jumps = self._tree, self.jumps
        self.starts.append(start)
        tree[start] = start
        open_nodes = {start}
        self._inputs[start] = []
        stack = [(start, iter(self.successors[start]))]
        while stack:
            node, successors = stack[-1]
            for target in successors:
                if (node, target) in jumps:
                    continue
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


_ROUNDS = 12
"""Some jumps into branches are found only after others have been taken out; each time is a round."""

_SEARCHED = 40
"""How many times the nodes of a chart are looked at while the branches of its convergences are searched, at most."""


def without_entries(
    successors: Mapping[int, Sequence[int]],
    candidates: Sequence[int],
    waiting: Mapping[int, Sequence[int]],
    jumps: frozenset[tuple[int, int]],
) -> ForwardEdges:
    """Return the forward edges of a graph in which what leads into simultaneous branches from outside is a jump.

    `waiting`: the steps that each transition waits for. `jumps`: edges that are jumps in any case.
    """
    edges = ForwardEdges(successors, candidates, jumps)
    convergences = {node: steps for node, steps in waiting.items() if len(steps) > 1}
    for _ in range(_ROUNDS):
        apart = _taken_apart(edges, convergences, waiting) if convergences else []
        if not apart:
            break
        branches = _SimultaneousBranches(edges, waiting)
        searched = [branches.entries(node) for node in apart]
        found = [entries for entries in searched if entries is not None and entries.edges]
        # the clearest branches first: what leads into them is no doubt about others then
        lowest = min((each.rank for each in found), default=(0, 0))
        jumps = edges.jumps.union(*(each.edges for each in found if each.rank == lowest))
        if jumps == edges.jumps:
            break
        edges = ForwardEdges(successors, candidates, jumps)
    return edges


def _taken_apart(
    edges: ForwardEdges, convergences: Mapping[int, Sequence[int]], transitions: Mapping[int, Sequence[int]]
) -> list[int]:
    """Return the convergences whose steps are not each at the end of a simultaneous branch of its own."""
    divergences = {node for node in transitions if len(edges.successors[node]) > 1}
    branch: dict[int, int | None] = {}
    for node in edges.rank:
        above = edges.dominator[node]
        if above not in divergences:
            branch[node] = branch.get(above)
        elif node in transitions:
            branch[node] = branch[above]  # a convergence: what follows is in the branch around the divergence
        else:
            branch[node] = node if edges.forward_inputs[node] == 1 else None
    return [
        node
        for node, steps in convergences.items()
        if edges.dominator[node] not in divergences
        or None in (found := {branch[step] for step in steps})
        or len(found) < len(steps)
        or not all(edges.is_forward(step, node) for step in steps)
    ]


class _Entries(NamedTuple):
    """Edges from outside into the branches of a convergence.

    `odd`: the number of branches without a step, of steps without a branch, and of divergences in them from which a
    branch leads out.
    """

    odd: int
    edges: set[tuple[int, int]]

    @property
    def rank(self) -> tuple[int, int]:
        """The doubt that these are the branches."""
        return self.odd, len(self.edges)


class _SimultaneousBranches:
    """Search for the simultaneous branches above convergences."""

    def __init__(self, edges: ForwardEdges, waiting: Mapping[int, Sequence[int]]) -> None:
        self.edges = edges
        self.waiting = waiting
        self.targets: dict[int, list[int]] = {}
        self.sources: dict[int, list[int]] = {node: [] for node in edges.successors}
        for node, targets in edges.successors.items():
            self.targets[node] = [target for target in targets if (node, target) not in edges.jumps]
            for target in self.targets[node]:
                self.sources[target].append(node)
        self.budget = _SEARCHED * len(self.sources)

    def entries(self, convergence: int) -> _Entries | None:
        """Return the edges that lead into the branches of a convergence from outside of them; None without branches.

        The branches begin at a divergence that leads to all the steps that the convergence waits for, by a branch to
        each as far as there is such a one. Of several, it is the one with the fewest entries, and then the nearest.
        """
        above = [self._reach(step, self.sources, {convergence}) for step in self.waiting[convergence]]
        found = [
            entries
            for divergence in above[0]
            if divergence in self.waiting and len(self.targets[divergence]) > 1 and self.budget > 0
            if all(divergence in each for each in above)
            if (entries := self._between(divergence, convergence)) is not None
        ]
        return min(found, key=lambda entries: entries.rank, default=None)

    def _between(self, divergence: int, convergence: int) -> _Entries | None:
        """Return the edges that lead into the branches between a divergence and a convergence from outside of them.

        Returns None if these are no branches.
        """
        ends = {convergence}
        before = divergence
        while before != ROOT:  # jumps back to what is above the divergence leave the branches
            ends.add(before)
            before = self.edges.dominator[before]
        self.budget -= len(ends)
        steps, firsts = self.waiting[convergence], self.targets[divergence]
        if not ends.isdisjoint(steps):
            return None
        above = {step: self._reach(step, self.sources, ends) for step in steps}
        branches = _ends_of_branches(firsts, above)
        if len(branches) < 2:
            return None
        odd = len(steps) + len(firsts) - 2 * len(branches)
        # a node on the shortest way through a branch is in no other one, whatever leads there from that
        ways = {first: self._ways(first, last, ends) for first, last in branches.items()}
        found: set[tuple[int, int]] = set()
        for first, last in branches.items():
            others = ends.union(*(way for other, way in ways.items() if other != first))
            inside = self._reach(first, self.targets, others).keys() & {node for step in last for node in above[step]}
            if not inside.issuperset((first, *last)):
                return None
            for node in inside:
                if node in self.waiting:
                    if not inside.issuperset(self.waiting[node]):
                        return None  # a convergence with other branches: the divergence is inside of the right one
                    if len(self.targets[node]) > 1:
                        odd += not inside.issuperset(self.targets[node])
                else:
                    found.update((source, node) for source in self.sources[node] if source not in inside)
        found = {(source, node) for source, node in found if source != divergence}
        if any(len(self.targets[source]) > 1 for source, _ in found):
            return None
        return _Entries(odd, found)

    def _ways(self, first: int, last: Sequence[int], ends: set[int]) -> set[int]:
        """Return the nodes on the shortest ways from `first` to the steps `last`."""
        before = self._reach(first, self.targets, ends)
        found: set[int] = set()
        for step in last:
            node = step
            while node not in found:
                found.add(node)
                node = before[node]
        return found

    def _reach(self, start: int, edges: Mapping[int, Sequence[int]], ends: set[int]) -> dict[int, int]:
        """Return the nodes from `start` on, nearest first and not through `ends`, with the node before each."""
        found = {start: start}
        pending = [start]
        for node in pending:  # grows while it is walked
            for other in edges[node]:
                if other not in found and other not in ends:
                    found[other] = node
                    pending.append(other)
        self.budget -= len(pending)
        return found


def _ends_of_branches(firsts: Sequence[int], above: Mapping[int, Mapping[int, int]]) -> dict[int, list[int]]:
    """Return the steps at which the branches end that begin at `firsts`; a step that one branch leads to decides first.

    `above`: what leads to each of the steps.
    """
    leading = {step: [first for first in firsts if first in nodes] for step, nodes in above.items()}
    ends: dict[int, list[int]] = {}
    for step in sorted(leading, key=lambda step: len(leading[step])):
        free = [first for first in leading[step] if first not in ends]
        if leading[step]:
            ends.setdefault((free or leading[step])[0], []).append(step)
    return ends
