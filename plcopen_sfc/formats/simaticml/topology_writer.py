"""Writes the drawing of a chart as branches and connections of GRAPH. The reader is `topology_reader`."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.formats.simaticml.topology import Link, Ref
from plcopen_sfc.formats.simaticml.topology_reader import BRANCHES, CARDINALITY
from plcopen_sfc.model.drawing import Drawing, Symbol, SymbolKind
from plcopen_sfc.model.sfc import SfcNetwork

_TYPES = {kind: name for name, kind in BRANCHES.items()}
_CONVERGENCES = frozenset({SymbolKind.SELECTION_CONVERGENCE, SymbolKind.SIMULTANEOUS_CONVERGENCE})
_STEPS = frozenset({SymbolKind.STEP, SymbolKind.MACRO_STEP})


class TopologyWriter:
    """The branches and connections of a chart."""

    def __init__(self, chart: SfcNetwork, drawing: Drawing, steps: dict[int, int], transitions: dict[int, int]) -> None:
        self.symbols = {symbol.id: symbol for symbol in drawing.symbols}
        self.priorities = {t.id: t.priority for t in chart.transitions}
        self.numbers = self._branch_numbers()
        self.steps, self.transitions = steps, transitions
        self.legs: dict[int, dict[int, int]] = {}
        """Of each divergence the index of the leg to each consumer."""
        self._owners: dict[int, tuple[str, int]] = {}
        for symbol in self.symbols.values():
            if symbol.kind in _TYPES and symbol.kind not in _CONVERGENCES:
                self.legs[symbol.id] = self._legs(symbol)

    def _branch_numbers(self) -> dict[int, int]:
        branches = [symbol for symbol in self.symbols.values() if symbol.kind in _TYPES]
        given = [int(symbol.name) for symbol in branches if symbol.name and symbol.name.isdigit()]
        unique = len(set(given)) == len(given)
        numbers: dict[int, int] = {}
        following = max(given, default=0) + 1 if unique else 1
        for symbol in branches:
            if unique and symbol.name and symbol.name.isdigit():
                numbers[symbol.id] = int(symbol.name)
            else:
                numbers[symbol.id] = following
                following += 1
        return numbers

    def _legs(self, branch: Symbol) -> dict[int, int]:
        """The legs of a divergence: in the order of their priority, then as drawn."""
        found: list[tuple[int, int, int, int]] = []
        for place, symbol in enumerate(self.symbols.values()):
            for pin in symbol.inputs:
                for wire in pin.connections:
                    if wire.source == branch.id:
                        drawn = int(wire.pin) if wire.pin is not None and wire.pin.isdigit() else place
                        priority = self.priorities.get(symbol.id)
                        found.append((priority is None, priority or 0, drawn, symbol.id))
        if branch.kind is SymbolKind.SIMULTANEOUS_DIVERGENCE:
            found.sort(key=lambda leg: leg[2])
        else:
            found.sort()
        return {number: index for index, (*_, number) in enumerate(found)}

    def branches(self) -> Iterator[tuple[Symbol, dict[str, str]]]:
        """Every branch with the attributes of its element."""
        for symbol in self.symbols.values():
            if symbol.kind in _TYPES:
                count = str(len(self.legs[symbol.id]) if symbol.id in self.legs else len(symbol.inputs))
                kept = symbol.carried.attributes if symbol.carried is not None else {}
                count = kept.get(f"{CARDINALITY} of {count}", count)
                attributes = {"Number": str(self.numbers[symbol.id]), "Type": _TYPES[symbol.kind], "Cardinality": count}
                yield symbol, attributes

    def types(self) -> dict[int, str]:
        """The type of each branch by its number."""
        return {
            self.numbers[symbol.id]: _TYPES[symbol.kind] for symbol in self.symbols.values() if symbol.kind in _TYPES
        }

    def links(self) -> list[Link]:
        """Every connection, in the order of the symbols that they lead to."""
        found: list[Link] = []
        leaving: set[int] = set()
        for symbol in self.symbols.values():
            if symbol.kind in (SymbolKind.ACTION_BLOCK, SymbolKind.EXPRESSION):
                continue
            for index, pin in enumerate(symbol.inputs):
                for wire in pin.connections:
                    link = self._link(symbol, index, wire.source)
                    if link is not None:
                        found.append(link)
                        leaving.add(wire.source)
        for symbol in self.symbols.values():
            if symbol.kind is SymbolKind.TRANSITION and symbol.id not in leaving and symbol.id in self.transitions:
                found.append(Link(Ref("T", self.transitions[symbol.id]), None))
        return found

    def leads_from(self, branch: int, members: set[tuple[str, int]]) -> bool:
        """Whether a branch belongs to a sequence: whether one of `members` is connected with it."""
        if not self._owners:
            for link in self.links():
                for one, other in ((link.source, link.target), (link.target, link.source)):
                    if one is not None and other is not None and one.kind == "B" and other.kind != "B":
                        self._owners.setdefault(one.number, (other.kind, other.number))
        return self._owners.get(branch) in members

    def _link(self, symbol: Symbol, index: int, source: int) -> Link | None:
        origin = self._ref(source)
        if origin is None:
            return None
        if source in self.legs:
            origin = Ref(origin.kind, origin.number, self.legs[source][symbol.id])
        elif origin.kind == "B":
            origin = Ref(origin.kind, origin.number, 0)
        is_jump = symbol.kind is SymbolKind.JUMP
        target = self._ref(symbol.target if is_jump else symbol.id)
        if target is None:
            return Link(origin, None)
        if target.kind == "B":
            target = Ref(target.kind, target.number, index if symbol.kind in _CONVERGENCES else 0)
        return Link(origin, target, is_jump)

    def _ref(self, number: int | None) -> Ref | None:
        symbol = self.symbols.get(number) if number is not None else None
        if symbol is None:
            return None
        if symbol.kind in _STEPS:
            return Ref("S", self.steps[symbol.id]) if symbol.id in self.steps else None
        if symbol.kind is SymbolKind.TRANSITION:
            return Ref("T", self.transitions[symbol.id]) if symbol.id in self.transitions else None
        return Ref("B", self.numbers[symbol.id]) if symbol.id in self.numbers else None
