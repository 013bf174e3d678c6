"""Draws a chart: nested branches become symbols and wires.

Both styles draw the same segments and branches. STRUCTURED closes every branch with a convergence that takes all its
legs, those that end in a jump too. PLAIN puts a bar only where several wires meet, and lets nested branches of one
kind share their bars.
"""

from __future__ import annotations

from collections.abc import Generator, Iterable, Mapping
from dataclasses import dataclass, field

from plcopen_sfc.drawing.branches import Branch, Leap, Place, Segment, nest
from plcopen_sfc.drawing.flow import Flow, alike
from plcopen_sfc.drawing.logic import logic_order
from plcopen_sfc.drawing.style import DrawingStyle
from plcopen_sfc.drawing.symbols import Pen, consumers_of, highest_id
from plcopen_sfc.model.drawing import Drawing, Symbol, SymbolKind
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.model.wiring import Problem

_DIVERGENCE = {False: SymbolKind.SELECTION_DIVERGENCE, True: SymbolKind.SIMULTANEOUS_DIVERGENCE}
_CONVERGENCE = {False: SymbolKind.SELECTION_CONVERGENCE, True: SymbolKind.SIMULTANEOUS_CONVERGENCE}


def draw(chart: SfcNetwork, style: DrawingStyle) -> Drawing:
    """A new drawing for the whole chart, without positions. The chart keeps the drawing it has."""
    pen = Pen(style, highest_id(chart, drawn=False) + 1)
    symbols = sketch(chart, pen, alike(chart) if style.structured else {})
    return Drawing(symbols=symbols, order=logic_order(chart, symbols))


def sketch(chart: SfcNetwork, pen: Pen, together: Mapping[int, int]) -> list[Symbol]:
    """The symbols of a new drawing. `together`: transitions that may share a symbol, as a group number for each."""
    flow, segments = nest(chart, together)
    return _Sketch(flow, pen).run(segments)


def limits(chart: SfcNetwork) -> list[Problem]:
    """What of a chart CODESYS and TwinCAT, which know nested branches only, cannot draw."""
    flow, segments = nest(chart, alike(chart))
    problems: list[Problem] = []
    pending = list(segments)
    while pending:
        for item in pending.pop().items:
            if isinstance(item, Branch):
                pending += item.legs
            elif isinstance(item, Place) and item.loose:
                problems.append(Problem("SFC130", item.node, "waits for steps of branches that do not end together"))
            elif isinstance(item, Place) and not flow.successors[item.node]:
                what = "nothing leads on from this step" if item.node in flow.steps else "this transition leads nowhere"
                problems.append(Problem("SFC131", item.node, what))
    for start in flow.survey.starts[1:]:
        problems.append(Problem("SFC132", start, "a chart has one start; this is another"))
    return sorted(problems, key=lambda problem: (problem.code, problem.symbol))


@dataclass(slots=True)
class _Tail:
    """Where the next symbol is wired to: `wires` that meet in a convergence if they are several.

    `dead`: jumps, which STRUCTURED wires into the convergence of their branch too.
    """

    wires: list[int] = field(default_factory=list)
    parallel: bool = False
    dead: list[int] = field(default_factory=list)
    bar: SymbolKind | None = None


_Drawn = Generator["_Drawn", None, None]


class _Sketch:
    """Draws segments. `tails` is where each segment ends."""

    def __init__(self, flow: Flow, pen: Pen) -> None:
        self.flow = flow
        self.pen = pen
        self.structured = pen.style.structured
        self.symbols: list[Symbol] = []
        self.outlets: dict[int, int] = {}
        self.loose: list[tuple[Symbol, int]] = []
        self.tail = _Tail()

    def run(self, segments: Iterable[Segment]) -> list[Symbol]:
        for segment in segments:
            self.tail = _Tail()
            stack = [self.segment(segment)]
            while stack:
                inner = next(stack[-1], None)
                if inner is None:
                    stack.pop()
                else:
                    stack.append(inner)
        for symbol, transition in self.loose:
            outlets = [self.outlets[step] for step in self.flow.joints[transition].sources]
            symbol.inputs = self.pen.inputs(symbol.kind, outlets)
        self.pen.dress_divergences(self.symbols, {s.id for s in self.symbols}, consumers_of(self.symbols))
        return self.symbols

    def segment(self, segment: Segment) -> _Drawn:
        for item in segment.items:
            if isinstance(item, Branch):
                yield self.branch(item)
            elif isinstance(item, Leap):
                jump = self.pen.jump(item.target, self.one_wire())
                self.symbols.append(jump)
                self.tail = _Tail(dead=[jump.id])
            elif item.node in self.flow.steps:
                self.symbols += self.pen.step(self.flow.steps[item.node], self.one_wire())
                self.outlets[item.node] = item.node
                self.tail = _Tail([item.node])
            else:
                self.transition(item)

    def transition(self, item: Place) -> None:
        joint = self.flow.joints[item.node]
        if item.loose:
            self.tail = _Tail()
            if len(joint.sources) > 1:
                bar = self.pen.bar(SymbolKind.SIMULTANEOUS_CONVERGENCE, [])
                self.symbols.append(bar)
                self.loose.append((bar, item.node))
                self.tail = _Tail([bar.id])
            drawn = self.pen.transition(item.node, joint.members, self.tail.wires)
            if len(joint.sources) == 1:
                self.loose.append((drawn[-1], item.node))
        else:
            drawn = self.pen.transition(item.node, joint.members, self.one_wire())
        self.symbols += drawn
        self.tail = _Tail([item.node])

    def one_wire(self) -> list[int]:
        """The wire into the next symbol, after the convergence of those that meet here."""
        wires = self.tail.wires
        if len(wires) > 1:
            bar = self.pen.bar(_CONVERGENCE[self.tail.parallel], wires)
            self.symbols.append(bar)
            return [bar.id]
        return wires[:1]

    def branch(self, branch: Branch) -> _Drawn:
        kind = _DIVERGENCE[branch.parallel]
        above = self.tail
        if self.structured or above.bar is not kind:
            owner = above.wires[0] if len(above.wires) == 1 else None
            bar = self.pen.bar(kind, self.one_wire())
            self.symbols.append(bar)
            top = bar.id
            if owner in self.outlets and above.bar is None:
                self.outlets[owner] = top
        else:
            top = above.wires[0]
        wires: list[int] = []
        dead: list[int] = []
        ends: list[int] = []
        for leg in branch.legs:
            if not leg.items:
                continue
            self.tail = _Tail([top], bar=kind)
            yield self.segment(leg)
            tail = self.tail
            if leg.joined and tail.wires:
                if not self.structured and len(tail.wires) > 1 and tail.parallel != branch.parallel:
                    tail = _Tail(self.one_wire_of(tail))
                wires += tail.wires
                ends += tail.wires
            else:
                dead += tail.dead
                ends += tail.dead
        if not self.structured:
            self.tail = _Tail(wires, branch.parallel)
        elif ends:
            bar = self.pen.bar(_CONVERGENCE[branch.parallel], ends)
            self.symbols.append(bar)
            self.tail = _Tail([bar.id]) if wires else _Tail(dead=[bar.id])
        else:
            self.tail = _Tail()

    def one_wire_of(self, tail: _Tail) -> list[int]:
        self.tail = tail
        return self.one_wire()
