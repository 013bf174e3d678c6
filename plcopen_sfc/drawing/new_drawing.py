"""New drawings of charts: nested branches become symbols and wires.

Both styles draw the same segments and divergences. STRUCTURED closes every divergence with a convergence that takes all
its branches, those that end in a jump too. PLAIN puts a bar only where several wires meet, and lets nested divergences
of one kind share their bars.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from plcopen_sfc.drawing.chart_nesting import (
    ChartGraph,
    ChartSegment,
    NestedDivergence,
    NestedJump,
    NestedNode,
    Walk,
    alike,
    nest,
    run_walk,
)
from plcopen_sfc.drawing.document_order import logic_order
from plcopen_sfc.drawing.drawing_style import DrawingStyle
from plcopen_sfc.model.checked import unchecked
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.drawing import DIVERGENCES, ActionEntry, Drawing, Symbol, SymbolKind
from plcopen_sfc.model.network import Connection, InputPin, OutputPin
from plcopen_sfc.model.sfc import SfcNetwork, Step, Transition
from plcopen_sfc.model.wiring import WiringProblem


def highest_id(chart: SfcNetwork, *, drawn: bool) -> int:
    """Return the highest id in a chart, in its drawing too where `drawn`; -1 without any."""
    used = [s.id for s in chart.steps] + [t.id for t in chart.transitions] + [n.id for n in chart.logic]
    used += [a.id for _, a in chart.associations()]
    if drawn and chart.drawing is not None:
        used += [s.id for s in chart.drawing.symbols]
        used += [e.local_id or 0 for s in chart.drawing.symbols for e in s.entries or ()]
    return max(used, default=-1)


class Pen:
    """Draws single symbols in `style`. `wired`: expressions are symbols of their own."""

    def __init__(self, style: DrawingStyle, first_id: int, *, wired: bool | None = None) -> None:
        self.style = style
        self.wired = style.structured if wired is None else wired
        self.next_id = first_id

    def new_id(self) -> int:
        """Return an id that no symbol has."""
        self.next_id += 1
        return self.next_id - 1

    def input(self, consumer: SymbolKind, source: int) -> InputPin:
        """Return an input of a symbol of kind `consumer`, wired to `source`."""
        return _input_pin(source, self.style.wire_name(consumer))

    def inputs(self, consumer: SymbolKind, sources: Iterable[int]) -> list[InputPin]:
        """Input for each of `sources`; a step or bar that nothing leads to shows an empty one in STRUCTURED."""
        pins = [self.input(consumer, source) for source in sources]
        return pins or ([unchecked(InputPin, connections=[])] if self.style.structured else [])

    def step(self, step: Step, sources: Iterable[int]) -> list[Symbol]:
        """Return a step with its action block."""
        kind = SymbolKind.MACRO_STEP if step.macro is not None else SymbolKind.STEP
        symbol = unchecked(
            Symbol,
            id=step.id,
            kind=kind,
            inputs=self.inputs(kind, sources),
            outputs=[unchecked(OutputPin, name=None if step.macro is not None else self.style.output_name)],
        )
        if not step.actions:
            return [symbol]
        if kind is SymbolKind.STEP:
            symbol.action_output = unchecked(OutputPin, name=self.style.action_output_name)
        return [symbol, self.action_block(step)]

    def action_block(self, step: Step) -> Symbol:
        """Return the action block of a step."""
        entries = [
            unchecked(ActionEntry, association=a.id, output=unchecked(OutputPin) if self.style.structured else None)
            for a in step.actions
        ]
        return unchecked(
            Symbol,
            id=self.new_id(),
            kind=SymbolKind.ACTION_BLOCK,
            inputs=[self.input(SymbolKind.ACTION_BLOCK, step.id)],
            outputs=[],
            entries=entries,
        )

    def transition(self, number: int, members: list[Transition], sources: Iterable[int]) -> list[Symbol]:
        """Return a transition, below the symbol of its expression where that is drawn."""
        first = members[0]
        symbol = unchecked(
            Symbol,
            id=number,
            kind=SymbolKind.TRANSITION,
            inputs=self.inputs(SymbolKind.TRANSITION, sources),
            outputs=[] if self.style.structured else [unchecked(OutputPin)],
            transitions=[t.id for t in members] if len(members) > 1 else None,
        )
        if self.wired and isinstance(first.condition, Expression):
            expression = self.expression()
            symbol.condition = _input_pin(expression.id)
            return [expression, symbol]
        return [symbol]

    def expression(self) -> Symbol:
        """Return a drawn expression."""
        outputs = [unchecked(OutputPin)]
        return unchecked(Symbol, id=self.new_id(), kind=SymbolKind.EXPRESSION, inputs=[], outputs=outputs)

    def bar(self, kind: SymbolKind, sources: Iterable[int]) -> Symbol:
        """Return a divergence or convergence. `dress_divergences` gives a divergence its outputs."""
        outputs = [unchecked(OutputPin)] if kind not in DIVERGENCES else []
        return unchecked(Symbol, id=self.new_id(), kind=kind, inputs=self.inputs(kind, sources), outputs=outputs)

    def jump(self, target: int, sources: Iterable[int]) -> Symbol:
        """Return a jump to a step."""
        inputs = self.inputs(SymbolKind.JUMP, sources)
        return unchecked(Symbol, id=self.new_id(), kind=SymbolKind.JUMP, inputs=inputs, outputs=[], target=target)

    def dress_divergences(self, symbols: list[Symbol], fresh: set[int], consumers: dict[int, int]) -> None:
        """Give each divergence in `fresh` an output for each consumer, and a name where the style has names."""
        if self.style.structured:
            taken = {symbol.name for symbol in symbols}
            number = 0
        for symbol in symbols:
            if symbol.id in fresh and symbol.kind in DIVERGENCES:
                count = max(consumers.get(symbol.id, 0), 1)
                symbol.outputs = [unchecked(OutputPin, name=self.style.output_name) for _ in range(count)]
                if self.style.structured:
                    while f"Branch{number}" in taken:
                        number += 1
                    symbol.name = f"Branch{number}"
                    taken.add(symbol.name)


def _input_pin(source: int, pin: str | None = None) -> InputPin:
    return unchecked(InputPin, connections=[unchecked(Connection, source=source, pin=pin, points=[])])


def consumers_of(symbols: Iterable[Symbol]) -> dict[int, int]:
    """Return the number of inputs that are wired to each symbol."""
    counts: dict[int, int] = {}
    for symbol in symbols:
        for pin in symbol.inputs:
            for connection in pin.connections:
                counts[connection.source] = counts.get(connection.source, 0) + 1
    return counts


_DIVERGENCE = {False: SymbolKind.SELECTION_DIVERGENCE, True: SymbolKind.SIMULTANEOUS_DIVERGENCE}
_CONVERGENCE = {False: SymbolKind.SELECTION_CONVERGENCE, True: SymbolKind.SIMULTANEOUS_CONVERGENCE}


def draw(chart: SfcNetwork, style: DrawingStyle) -> Drawing:
    """Return a new drawing for the whole chart, without positions. The chart keeps the drawing it has."""
    pen = Pen(style, highest_id(chart, drawn=False) + 1)
    symbols = sketch(chart, pen, alike(chart) if style.structured else {})
    return Drawing(symbols=symbols, order=logic_order(chart, symbols))


def sketch(chart: SfcNetwork, pen: Pen, together: Mapping[int, int]) -> list[Symbol]:
    """Symbols of a new drawing. `together`: transitions that may share a symbol, as a group number for each."""
    flow, segments = nest(chart, together)
    return _Sketch(flow, pen).run(segments)


def limits(chart: SfcNetwork) -> list[WiringProblem]:
    """Problems of a chart for CODESYS and TwinCAT, which draw nested branches only."""
    flow, segments = nest(chart, alike(chart))
    problems: list[WiringProblem] = []
    pending = list(segments)
    while pending:
        for item in pending.pop().items:
            if isinstance(item, NestedDivergence):
                pending += item.branches
            elif isinstance(item, NestedNode) and item.loose:
                problems.append(
                    WiringProblem("SFC130", item.node, "waits for steps of branches that do not end together")
                )
            elif isinstance(item, NestedNode) and not flow.successors[item.node]:
                what = "nothing leads on from this step" if item.node in flow.steps else "this transition leads nowhere"
                problems.append(WiringProblem("SFC131", item.node, what))
    for start in flow.edges.starts[1:]:
        problems.append(WiringProblem("SFC132", start, "a chart has one start; this is another"))
    return sorted(problems, key=lambda problem: (problem.code, problem.symbol))


@dataclass(slots=True)
class _Tail:
    """End of a segment so far: `wires` into the next symbol, which meet in a convergence if they are several.

    `dead`: jumps, which STRUCTURED wires into the convergence of their branch too.
    """

    wires: list[int] = field(default_factory=list)
    parallel: bool = False
    dead: list[int] = field(default_factory=list)
    bar: SymbolKind | None = None


class _Sketch:
    """Draws segments. `tail` is the end of the segment that is being drawn."""

    def __init__(self, flow: ChartGraph, pen: Pen) -> None:
        self.flow = flow
        self.pen = pen
        self.structured = pen.style.structured
        self.symbols: list[Symbol] = []
        self.outlets: dict[int, int] = {}
        self.loose: list[tuple[Symbol, int]] = []
        self.tail = _Tail()

    def run(self, segments: Iterable[ChartSegment]) -> list[Symbol]:
        for segment in segments:
            self.tail = _Tail()
            run_walk(self.segment(segment))
        # at the end, as the steps of a loose transition may be drawn after it
        for symbol, transition in self.loose:
            outlets = [self.outlets[step] for step in self.flow.joints[transition].sources]
            symbol.inputs = self.pen.inputs(symbol.kind, outlets)
        self.pen.dress_divergences(self.symbols, {s.id for s in self.symbols}, consumers_of(self.symbols))
        return self.symbols

    def segment(self, segment: ChartSegment) -> Walk:
        for item in segment.items:
            if isinstance(item, NestedDivergence):
                yield self.divergence(item)
            elif isinstance(item, NestedJump):
                jump = self.pen.jump(item.target, self.one_wire())
                self.symbols.append(jump)
                self.tail = _Tail(dead=[jump.id])
            elif item.node in self.flow.steps:
                self.symbols += self.pen.step(self.flow.steps[item.node], self.one_wire())
                self.outlets[item.node] = item.node
                self.tail = _Tail([item.node])
            else:
                self.transition(item)

    def transition(self, item: NestedNode) -> None:
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
        """Return the wire into the next symbol, after the convergence of those that meet here."""
        wires = self.tail.wires
        if len(wires) > 1:
            bar = self.pen.bar(_CONVERGENCE[self.tail.parallel], wires)
            self.symbols.append(bar)
            return [bar.id]
        return wires[:1]

    def divergence(self, divergence: NestedDivergence) -> Walk:
        kind = _DIVERGENCE[divergence.parallel]
        above = self.tail
        if self.structured or above.bar is not kind:
            owner = above.wires[0] if len(above.wires) == 1 else None
            bar = self.pen.bar(kind, self.one_wire())
            self.symbols.append(bar)
            top = bar.id
            # a step has one outlet: loose transitions are wired to the bar below it
            if owner in self.outlets and above.bar is None:
                self.outlets[owner] = top
        else:
            top = above.wires[0]
        wires: list[int] = []
        dead: list[int] = []
        ends: list[int] = []
        for branch in divergence.branches:
            if not branch.items:
                continue
            self.tail = _Tail([top], bar=kind)
            yield self.segment(branch)
            tail = self.tail
            if branch.joined and tail.wires:
                # wires of the same kind share the bar below this divergence, others need one of their own
                if not self.structured and len(tail.wires) > 1 and tail.parallel != divergence.parallel:
                    tail = _Tail(self.one_wire_of(tail))
                wires += tail.wires
                ends += tail.wires
            else:
                dead += tail.dead
                ends += tail.dead
        if not self.structured:
            self.tail = _Tail(wires, divergence.parallel)
        elif ends:
            bar = self.pen.bar(_CONVERGENCE[divergence.parallel], ends)
            self.symbols.append(bar)
            self.tail = _Tail([bar.id]) if wires else _Tail(dead=[bar.id])
        else:
            self.tail = _Tail()

    def one_wire_of(self, tail: _Tail) -> list[int]:
        self.tail = tail
        return self.one_wire()
