"""Transitions that were added to a chart, drawn as branches of their own: all that is drawn already stays where it is.

A new drawing of the whole chart nests its branches as the new transition wants it, which moves branches that have
nothing to do with it. So a way from a step to a step is first drawn as an engineer does: as one more branch of the
selection below the step, or beside the one transition that is there; it ends in a jump, or in nothing where the
selection leads to the same step.
"""

from __future__ import annotations

from dataclasses import dataclass

from plcopen_sfc.drawing.drawing_style import DrawingStyle, expressions_are_wired, fits, is_structured
from plcopen_sfc.drawing.new_drawing import Pen, consumers_of, highest_id
from plcopen_sfc.drawing.symbol_layout import has_positions, place_nearby
from plcopen_sfc.model.drawing import Drawing, Symbol, SymbolKind
from plcopen_sfc.model.network import OutputPin
from plcopen_sfc.model.sfc import SfcNetwork, Step, Transition
from plcopen_sfc.model.wiring import Branches


@dataclass
class _Way:
    """A way that was added: from the step `source` through `parts` to the step `target`."""

    source: int
    parts: list[Step | Transition]
    target: int


def with_added_branches(chart: SfcNetwork, drawing: Drawing, style: DrawingStyle) -> Drawing | None:
    """Return a drawing with a branch for each way that was added; None where something else was edited."""
    ways = _added_ways(chart, drawing) if style.structured and is_structured(chart) else None
    if not ways or drawing.order is not None:
        return None
    before = chart.drawing
    chart.drawing = drawing.model_copy(deep=True)
    added = _AddedBranches(chart, chart.drawing, style)
    if all(added.draw(way) for way in ways):
        added.finish()
        if fits(chart, style):
            return chart.drawing
    chart.drawing = before
    return None


def _added_ways(chart: SfcNetwork, drawing: Drawing) -> list[_Way] | None:
    """Return the ways that a chart has and its drawing has not; None where more differs."""
    drawn = {number for symbol in drawing.symbols for number in symbol.transitions or [symbol.id]}
    transitions = [each for each in chart.transitions if each.id not in drawn]
    steps = {step.id: step for step in chart.steps if step.id not in drawn}
    ways: list[_Way] = []
    for first in transitions:
        if len(first.sources) != 1 or first.sources[0] not in drawn:
            continue
        way = _Way(first.sources[0], [first], -1)
        last = first
        while len(last.targets) == 1 and last.targets[0] in steps:
            step = steps.pop(last.targets[0])
            following = [each for each in transitions if step.id in each.sources]
            if len(following) != 1 or len(following[0].sources) != 1:
                return None
            last = following[0]
            way.parts += [step, last]
        if len(last.targets) != 1 or last.targets[0] not in drawn:
            return None
        way.target = last.targets[0]
        ways.append(way)
    drawn_ways = sum(isinstance(part, Transition) for way in ways for part in way.parts)
    return ways if not steps and drawn_ways == len(transitions) else None


class _AddedBranches:
    def __init__(self, chart: SfcNetwork, drawing: Drawing, style: DrawingStyle) -> None:
        self._chart = chart
        self._drawing = drawing
        self._placed = has_positions(drawing)
        self._pen = Pen(style, highest_id(chart, drawn=True) + 1, wired=expressions_are_wired(drawing, chart, style))
        self._new: dict[int, int] = {}
        """The new symbols, each with the one that it follows."""
        self._bars: set[int] = set()

    def draw(self, way: _Way) -> bool:
        """Draw a way; False where the step that it leaves ends in no selection that can take it."""
        branches, symbols = Branches.of(self._drawing), {symbol.id: symbol for symbol in self._drawing.symbols}
        below = self._below(way.source, branches, symbols)
        if below is None:
            return False
        if below.kind is SymbolKind.SELECTION_DIVERGENCE:
            end = branches.end(below.id)
            if end is None:
                return False
            self._add(way, below, symbols[end])
            below.outputs.append(OutputPin(name=self._pen.style.output_name))
            return True
        alone = below.kind is SymbolKind.TRANSITION and not below.transitions
        if not alone or not branches.followers(below.id):
            return False
        self._add(way, *self._selection_around(below, symbols))
        return True

    def _selection_around(self, transition: Symbol, symbols: dict[int, Symbol]) -> tuple[Symbol, Symbol]:
        """Draw a selection with one branch, that of a transition; return its divergence and its convergence."""
        wires = [connection for pin in transition.inputs for connection in pin.connections]
        divergence = self._pen.bar(SymbolKind.SELECTION_DIVERGENCE, [each.source for each in wires])
        convergence = self._pen.bar(SymbolKind.SELECTION_CONVERGENCE, [transition.id])
        for connection in (each for symbol in symbols.values() for pin in symbol.inputs for each in pin.connections):
            if connection.source == transition.id:
                connection.source = convergence.id
        for connection in wires:
            connection.source = divergence.id
        self._bars.add(divergence.id)
        conditions = transition.condition.connections if transition.condition is not None else []
        self._put(divergence, before=next((symbols[each.source] for each in conditions), transition))
        place = next(place for place, each in enumerate(self._drawing.symbols) if each is transition)
        self._drawing.symbols.insert(place + 1, convergence)
        self._new[convergence.id] = transition.id
        return divergence, convergence

    def _add(self, way: _Way, divergence: Symbol, convergence: Symbol) -> None:
        """Draw a way between the bars of a selection."""
        last = divergence.id
        for part in way.parts:
            if isinstance(part, Step):
                drawn = self._pen.step(part, [last])
            else:
                drawn = self._pen.transition(part.id, [part], [last])
            for symbol in drawn:
                self._put(symbol, before=convergence)
            last = part.id
        if self._leads_to(convergence.id) != way.target:
            jump = self._pen.jump(way.target, [last])
            self._put(jump, before=convergence)
            last = jump.id
        convergence.inputs.append(self._pen.input(convergence.kind, last))

    def _below(self, symbol: int, branches: Branches, symbols: dict[int, Symbol]) -> Symbol | None:
        """Return what follows a symbol, below the convergences of selections at whose ends it is."""
        followers = branches.followers(symbol)
        while len(followers) == 1 and symbols[followers[0]].kind is SymbolKind.SELECTION_CONVERGENCE:
            followers = branches.followers(followers[0])
        return symbols[followers[0]] if len(followers) == 1 else None

    def _leads_to(self, convergence: int) -> int | None:
        """Return the step that the branches which end at a convergence lead to, if it is one."""
        symbols = {symbol.id: symbol for symbol in self._drawing.symbols}
        below = self._below(convergence, Branches.of(self._drawing), symbols)
        return None if below is None else below.target if below.kind is SymbolKind.JUMP else below.id

    def _put(self, symbol: Symbol, *, before: Symbol) -> None:
        place = next(place for place, each in enumerate(self._drawing.symbols) if each is before)
        self._new[symbol.id] = self._drawing.symbols[place - 1].id
        self._drawing.symbols.insert(place, symbol)

    def finish(self) -> None:
        """Name new selections, and give new symbols places in a drawing that has places."""
        self._pen.dress_divergences(self._drawing.symbols, self._bars, consumers_of(self._drawing.symbols))
        if self._placed:
            place_nearby(self._chart, dict(self._new))
