"""Brings a drawing up to date after edits of its chart, and leaves alone what the edits do not concern.

The chart is drawn anew beside its drawing, and both are cut into clusters of wires. A cluster in which a transition
leads from or to other steps than it did is *stale*, and with it every cluster of the one drawing that shares a step or
transition with a stale cluster of the other. Stale clusters are taken from the new drawing, all others stay as they
are, symbol by symbol. New steps, transitions, bars and jumps stand behind the symbol they follow in the new drawing.
"""

from __future__ import annotations

from plcopen_sfc.drawing.clusters import Clusters, entry, exit_
from plcopen_sfc.drawing.draw import draw, sketch
from plcopen_sfc.drawing.fits import fits, in_order, link_fits
from plcopen_sfc.drawing.layout import has_positions
from plcopen_sfc.drawing.nearby import place_nearby
from plcopen_sfc.drawing.parts import Parts, block_owner
from plcopen_sfc.drawing.reuse import rewired, take_over
from plcopen_sfc.drawing.style import BARS, STEPS, DrawingStyle
from plcopen_sfc.drawing.symbols import Pen, highest_id
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.drawing import Drawing, Symbol, SymbolKind
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.model.wiring import trace_drawing

_FLOW = BARS | {SymbolKind.JUMP}


def redraw(chart: SfcNetwork, style: DrawingStyle) -> None:
    """Make the drawing of `chart` fit it, changing as little as possible. A chart without a drawing gets one."""
    old = chart.drawing
    if old is None or len({symbol.id for symbol in old.symbols}) != len(old.symbols):
        chart.drawing = draw(chart, style)
    elif not fits(chart, style):
        _Redrawing(chart, old, style).run()
        if not fits(chart, style):  # ids that the chart and its drawing use for different things
            chart.drawing = draw(chart, style)


class _Redrawing:
    def __init__(self, chart: SfcNetwork, old: Drawing, style: DrawingStyle) -> None:
        self.chart = chart
        self.drawing = old
        self.old = {symbol.id: symbol for symbol in old.symbols}
        self.wired = expressions_are_wired(old, chart, style)
        pen = Pen(style, highest_id(chart, drawn=True) + 1, wired=self.wired)
        together = {i: s.id for s in old.symbols if s.kind is SymbolKind.TRANSITION for i in s.transitions or ()}
        symbols = sketch(chart, pen, together)
        self.new = {symbol.id: symbol for symbol in symbols}
        self.reorder = style.structured and not in_order(chart, old)

    def run(self) -> None:
        """Put the drawing together from what stays and what is new."""
        stale = self.stale(Clusters(self.old.values()), Clusters(self.new.values()))
        kept = {i for i in self.old if self.keeps(i, stale)}
        gone = [s for i, s in self.old.items() if s.kind in _FLOW and i not in kept]
        fresh = [s for i, s in self.new.items() if s.kind in _FLOW and entry(i) in stale]
        unused = {i for i, s in self.new.items() if s.kind in _FLOW and entry(i) not in stale}
        take_over(gone, fresh, self.old, self.new)
        self.new = {symbol.id: symbol for i, symbol in self.new.items() if i not in unused}
        symbols = {i: self.old[i] for i in kept}
        for number, symbol in self.new.items():
            if symbol.kind in _FLOW:
                symbols[number] = symbol
            elif symbol.kind in STEPS or symbol.kind is SymbolKind.TRANSITION:
                if number in kept:
                    self.update(self.old[number], symbol, rewire=entry(number) in stale)
                else:
                    symbols[number] = symbol
        parts = Parts(self.chart, self.old, self.new, symbols, wired=self.wired)
        parts.settle()
        self.arrange(symbols, parts.stands_for)

    def update(self, present: Symbol, symbol: Symbol, *, rewire: bool) -> None:
        """Let a step or transition that stays follow its chart."""
        if present.kind is not symbol.kind:
            present.kind = symbol.kind
        if present.transitions != symbol.transitions:
            present.transitions = symbol.transitions
        if rewire:
            present.inputs = rewired(present.inputs, symbol.inputs)

    def keeps(self, number: int, stale: set[int]) -> bool:
        """Whether a symbol of the old drawing stays. Action blocks and expressions follow what they belong to."""
        symbol = self.old[number]
        if symbol.kind in _FLOW:
            return entry(number) not in stale
        if symbol.kind in STEPS:
            return number in self.new and self.new[number].kind in STEPS
        if symbol.kind is SymbolKind.TRANSITION:
            return number in self.new and self.new[number].kind is SymbolKind.TRANSITION
        return False

    def stale(self, old: Clusters, new: Clusters) -> set[int]:
        """The sides of symbols in all stale clusters of both drawings."""
        found: set[int] = set()
        pending = self.changed(old)
        while pending:
            side = pending.pop()
            if side not in found:
                found.add(side)
                pending += old.around(side)
                pending += new.around(side)
        return found

    def changed(self, old: Clusters) -> list[int]:
        """The sides of steps and transitions at which the chart says something else than the old drawing."""
        transitions = {t.id: t for t in self.chart.transitions}
        steps = {step.id for step in self.chart.steps}
        links = trace_drawing(self.drawing).links
        sides: list[int] = []
        for number, symbol in self.new.items():
            if symbol.kind in STEPS:
                before = self.old.get(number)
                if before is None or before.kind not in STEPS:
                    sides += (entry(number), exit_(number))
            elif symbol.kind is SymbolKind.TRANSITION:
                before = self.old.get(number)
                members = [transitions[i] for i in symbol.transitions or [number]]
                found = links.get(number, [])
                same = before is not None and (before.transitions or [number]) == [t.id for t in members]
                if not same or len(found) != len(members) or self.reorder:
                    sides += (entry(number), exit_(number))
                elif not all(link_fits(t, link, steps) for t, link in zip(members, found, strict=True)):
                    if any({*t.sources} & steps != set(f.sources) for t, f in zip(members, found, strict=True)):
                        sides.append(entry(number))
                    if any({*t.targets} & steps != set(f.targets) for t, f in zip(members, found, strict=True)):
                        sides.append(exit_(number))
        for number, symbol in self.old.items():
            if symbol.kind in STEPS or symbol.kind is SymbolKind.TRANSITION:
                if number not in self.new or (self.new[number].kind in STEPS) != (symbol.kind in STEPS):
                    sides += old.around(entry(number)) + old.around(exit_(number))
            elif symbol.kind is SymbolKind.JUMP and symbol.target is not None and symbol.target not in self.new:
                target = self.old.get(symbol.target)
                if target is None or target.kind in STEPS:
                    sides.append(entry(number))
        return sides

    def arrange(self, symbols: dict[int, Symbol], stands_for: dict[int, int]) -> None:
        """Put the symbols in order: old ones as they stood, each new one behind what it follows in the new drawing."""
        names = [stands_for.get(i, i) for i in self.new]
        sequence = [i for i in (names if self.reorder else self.old) if i in symbols]
        present = set(sequence)
        owners = {c.source: s.id for s in symbols.values() if s.condition is not None for c in s.condition.connections}
        before: dict[int, list[int]] = {}
        after: dict[int | None, list[int]] = {}
        followed: dict[int, int | None] = {}
        anchor: int | None = None
        for number in names:
            if number not in symbols:
                continue
            if number not in present:
                symbol, ahead = symbols[number], anchor
                if symbol.kind is SymbolKind.EXPRESSION and owners.get(number) in present:
                    before.setdefault(owners[number], []).append(number)
                elif symbol.kind is SymbolKind.ACTION_BLOCK:
                    ahead = block_owner(symbol, symbols)
                    after.setdefault(ahead, []).insert(0, number)
                else:
                    after.setdefault(ahead, []).append(number)
                followed[number] = ahead
            anchor = number
        order: dict[int, None] = {}
        pending: list[int | None] = [*reversed(sequence), None]
        while pending:
            one = pending.pop()
            if one is not None:
                order.update(dict.fromkeys(before.get(one, ())))
                order[one] = None
            pending += reversed(after.get(one, ()))
        order.update(dict.fromkeys(symbols))
        drawing = self.drawing
        placed = has_positions(drawing)
        drawing.symbols = [symbols[i] for i in order]
        if drawing.order is not None:
            nodes = {node.id for node in self.chart.logic}
            drawing.order = _merged(drawing.order, list(order), nodes)
        if placed:
            place_nearby(self.chart, {i: followed.get(i) for i in order if i not in self.old})


def expressions_are_wired(drawing: Drawing, chart: SfcNetwork, style: DrawingStyle) -> bool:
    """Whether the drawing shows expressions as symbols of their own: what most of its transitions do."""
    conditions = {t.id: t.condition for t in chart.transitions}
    votes = 0
    for symbol in drawing.symbols:
        if symbol.kind is SymbolKind.TRANSITION:
            condition = conditions.get(symbol.transitions[0] if symbol.transitions else symbol.id)
            if isinstance(condition, Expression):
                votes += 1 if symbol.condition is not None else -1
    return votes > 0 if votes else style.structured


def _merged(before: list[int], symbols: list[int], nodes: set[int]) -> list[int]:
    """The order of symbols and logic: logic stands behind the symbol that it stood behind."""
    place: dict[int | None, list[int]] = {}
    present = set(symbols)
    last: int | None = None
    for number in before:
        if number in present:
            last = number
        elif number in nodes:
            place.setdefault(last, []).append(number)
    order = list(place.get(None, ()))
    for number in symbols:
        order += (number, *place.get(number, ()))
    return order
