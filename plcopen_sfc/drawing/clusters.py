"""The wires of a drawing fall into clusters that can be exchanged one by one.

Between steps and transitions stand bars and jumps. What hangs together by wires, without passing through a step or
transition, is a cluster: the outputs of some steps with the inputs of the transitions they lead to, or the outputs of
some transitions with the inputs of the steps they lead to. Where a transition leads from depends on one cluster only,
and where it leads to on one.
"""

from __future__ import annotations

from collections.abc import Iterable

from plcopen_sfc.drawing.style import BARS, STEPS
from plcopen_sfc.model.drawing import Symbol, SymbolKind


def entry(number: int) -> int:
    """The input side of a symbol. A bar or jump has no other."""
    return 2 * number


def exit_(number: int) -> int:
    """The output side of a step or transition."""
    return 2 * number + 1


class Clusters:
    """The clusters of a list of symbols. Sides of steps and transitions, bars and jumps are its members."""

    def __init__(self, symbols: Iterable[Symbol]) -> None:
        self.parent: dict[int, int] = {}
        symbols = list(symbols)
        kinds = {symbol.id: symbol.kind for symbol in symbols}
        for symbol in symbols:
            if symbol.kind in _TWO_SIDED:
                self.parent[entry(symbol.id)] = entry(symbol.id)
                self.parent[exit_(symbol.id)] = exit_(symbol.id)
            elif symbol.kind in BARS or symbol.kind is SymbolKind.JUMP:
                self.parent[entry(symbol.id)] = entry(symbol.id)
        for symbol in symbols:
            if entry(symbol.id) not in self.parent:
                continue
            for pin in symbol.inputs:
                for connection in pin.connections:
                    kind = kinds.get(connection.source)
                    side = exit_(connection.source) if kind in _TWO_SIDED else entry(connection.source)
                    if side in self.parent:
                        self._unite(side, entry(symbol.id))
            if symbol.kind is SymbolKind.JUMP and symbol.target is not None and kinds.get(symbol.target) in BARS:
                self._unite(entry(symbol.id), entry(symbol.target))
        self.members: dict[int, list[int]] = {}
        for side in self.parent:
            self.members.setdefault(self.root(side), []).append(side)

    def root(self, side: int) -> int:
        """The side that stands for the cluster of `side`."""
        parent = self.parent
        while parent[side] != side:
            parent[side] = side = parent[parent[side]]
        return side

    def around(self, side: int) -> list[int]:
        """The cluster of `side`; nothing where the drawing has no such side."""
        return self.members[self.root(side)] if side in self.parent else []

    def _unite(self, one: int, other: int) -> None:
        self.parent[self.root(one)] = self.root(other)


_TWO_SIDED = STEPS | {SymbolKind.TRANSITION}
