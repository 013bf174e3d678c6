"""Forward edges, ranks and dominators of any directed graph.

(Cooper, Harvey, Kennedy: A Simple, Fast Dominance Algorithm.)
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

ROOT = -1
"""The node above all starts."""


class Survey:
    """What is known of a graph after one depth-first walk.

    An edge is *forward* where it neither closes a loop nor leads into what an earlier start has reached. `rank` numbers
    the nodes so that forward edges run upwards, `dominator` is the node through which all forward ways to a node pass
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
        """Whether there is a forward edge between two nodes."""
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
