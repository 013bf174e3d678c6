"""Lets new bars and jumps take over from old ones that did the same: their ids, places, comments and foreign data."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from plcopen_sfc.drawing.style import BARS, CONVERGENCES, DIVERGENCES
from plcopen_sfc.model.drawing import Symbol, SymbolKind
from plcopen_sfc.model.network import InputPin

_FIELDS = ("position", "width", "height", "execution_order", "exclude", "local_id", "comment", "global_id", "carried")


def take_over(
    gone: list[Symbol], fresh: list[Symbol], old: Mapping[int, Symbol], new: Mapping[int, Symbol]
) -> dict[int, int]:
    """Give each of `fresh` what one of `gone` with the same role had. Returns the ids that changed."""
    before, after = _Roles(old), _Roles(new)
    free: dict[object, list[Symbol]] = {}
    for symbol in gone:
        free.setdefault(before.role(symbol), []).append(symbol)
    pairs: list[tuple[Symbol, Symbol]] = []
    for symbol in fresh:
        candidates = free.get(after.role(symbol))
        if candidates:
            pairs.append((symbol, candidates.pop(0)))
    numbers = {symbol.id: other.id for symbol, other in pairs}
    for symbol, other in pairs:
        symbol.id = other.id
        for name in _FIELDS:
            setattr(symbol, name, getattr(other, name))
        if symbol.kind in BARS:
            symbol.name = other.name
            if len(symbol.outputs) == len(other.outputs):
                symbol.outputs = other.outputs
    for symbol in new.values():
        for pin in symbol.inputs:
            for connection in pin.connections:
                connection.source = numbers.get(connection.source, connection.source)
    for symbol, other in pairs:
        symbol.inputs = rewired(other.inputs, symbol.inputs)
    return numbers


def rewired(before: list[InputPin], after: list[InputPin]) -> list[InputPin]:
    """The pins `after`, but those of `before` that have the same wires. A pin that gets other wires keeps its place."""
    same = {_wires(pin): pin for pin in reversed(before)}
    pins: list[InputPin] = []
    for position, pin in enumerate(after):
        kept = same.get(_wires(pin))
        if kept is None and len(before) == len(after):
            kept = before[position].model_copy(update={"connections": pin.connections})
        pins.append(kept or pin)
    return pins


def _wires(pin: InputPin) -> tuple[int, ...]:
    return tuple(connection.source for connection in pin.connections)


class _Roles:
    """What bars and jumps of one drawing do: from where or to where they lead."""

    def __init__(self, symbols: Mapping[int, Symbol]) -> None:
        self.symbols = symbols
        self.producers = {i: [c.source for pin in s.inputs for c in pin.connections] for i, s in symbols.items()}
        self.consumers: dict[int, list[int]] = {}
        for consumer, sources in self.producers.items():
            for source in sources:
                self.consumers.setdefault(source, []).append(consumer)

    def role(self, symbol: Symbol) -> object:
        if symbol.kind is SymbolKind.JUMP:
            return symbol.kind, symbol.target, self.reach(symbol.id, self.producers)
        if symbol.kind in DIVERGENCES:
            return symbol.kind, self.reach(symbol.id, self.producers)
        return symbol.kind, self.reach(symbol.id, self.consumers)

    def reach(self, number: int, neighbours: Mapping[int, Iterable[int]]) -> frozenset[int]:
        """The steps and transitions next to a bar or jump in one direction; to jumps, what they lead to."""
        found: set[int] = set()
        seen = {number}
        pending = [number]
        while pending:
            for other in neighbours.get(pending.pop(), ()):
                symbol = self.symbols.get(other)
                if symbol is None or other in seen:
                    continue
                seen.add(other)
                if symbol.kind in DIVERGENCES or symbol.kind in CONVERGENCES:
                    pending.append(other)
                elif symbol.kind is SymbolKind.JUMP:
                    found.add(-1 if symbol.target is None else symbol.target)
                else:
                    found.add(other)
        return frozenset(found)
