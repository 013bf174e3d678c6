"""Makes the symbols of a drawing in one style, with ids that nothing else in the chart has."""

from __future__ import annotations

from collections.abc import Iterable

from plcopen_sfc.drawing.style import DIVERGENCES, DrawingStyle
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.drawing import ActionEntry, Symbol, SymbolKind
from plcopen_sfc.model.network import Connection, InputPin, OutputPin
from plcopen_sfc.model.sfc import SfcNetwork, Step, Transition


def highest_id(chart: SfcNetwork, *, drawn: bool) -> int:
    """The highest id in a chart, in its drawing too where `drawn`; -1 where there is none."""
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
        """An id that no symbol has."""
        self.next_id += 1
        return self.next_id - 1

    def input(self, consumer: SymbolKind, source: int) -> InputPin:
        """An input of a symbol of kind `consumer`, wired to `source`."""
        return InputPin(connections=[Connection(source=source, pin=self.style.wire_name(consumer))])

    def inputs(self, consumer: SymbolKind, sources: Iterable[int]) -> list[InputPin]:
        """An input for each of `sources`; a step or bar that nothing leads to shows an empty one in STRUCTURED."""
        pins = [self.input(consumer, source) for source in sources]
        return pins or ([InputPin()] if self.style.structured else [])

    def step(self, step: Step, sources: Iterable[int]) -> list[Symbol]:
        """A step with its action block."""
        kind = SymbolKind.MACRO_STEP if step.macro is not None else SymbolKind.STEP
        symbol = Symbol(
            id=step.id,
            kind=kind,
            inputs=self.inputs(kind, sources),
            outputs=[OutputPin(name=None if step.macro is not None else self.style.output_name)],
        )
        if not step.actions:
            return [symbol]
        if kind is SymbolKind.STEP:
            symbol.action_output = OutputPin(name=self.style.action_output_name)
        return [symbol, self.action_block(step)]

    def action_block(self, step: Step) -> Symbol:
        """The action block of a step."""
        entries = [
            ActionEntry(association=a.id, output=OutputPin() if self.style.structured else None) for a in step.actions
        ]
        return Symbol(
            id=self.new_id(),
            kind=SymbolKind.ACTION_BLOCK,
            inputs=[self.input(SymbolKind.ACTION_BLOCK, step.id)],
            entries=entries,
        )

    def transition(self, number: int, members: list[Transition], sources: Iterable[int]) -> list[Symbol]:
        """A transition, below the symbol of its expression where that is drawn."""
        first = members[0]
        symbol = Symbol(
            id=number,
            kind=SymbolKind.TRANSITION,
            inputs=self.inputs(SymbolKind.TRANSITION, sources),
            outputs=[] if self.style.structured else [OutputPin()],
            transitions=[t.id for t in members] if len(members) > 1 else None,
        )
        if self.wired and isinstance(first.condition, Expression):
            expression = self.expression()
            symbol.condition = InputPin(connections=[Connection(source=expression.id)])
            return [expression, symbol]
        return [symbol]

    def expression(self) -> Symbol:
        """A drawn expression."""
        return Symbol(id=self.new_id(), kind=SymbolKind.EXPRESSION, outputs=[OutputPin()])

    def bar(self, kind: SymbolKind, sources: Iterable[int]) -> Symbol:
        """A divergence or convergence. `dress_divergences` gives a divergence its outputs."""
        symbol = Symbol(id=self.new_id(), kind=kind, inputs=self.inputs(kind, sources))
        if kind not in DIVERGENCES:
            symbol.outputs = [OutputPin()]
        return symbol

    def jump(self, target: int, sources: Iterable[int]) -> Symbol:
        """A jump to a step."""
        return Symbol(
            id=self.new_id(), kind=SymbolKind.JUMP, inputs=self.inputs(SymbolKind.JUMP, sources), target=target
        )

    def dress_divergences(self, symbols: list[Symbol], fresh: set[int], consumers: dict[int, int]) -> None:
        """Give each divergence in `fresh` an output for each consumer, and a name where the style has names."""
        if self.style.structured:
            taken = {symbol.name for symbol in symbols}
            number = 0
        for symbol in symbols:
            if symbol.id in fresh and symbol.kind in DIVERGENCES:
                count = max(consumers.get(symbol.id, 0), 1)
                symbol.outputs = [OutputPin(name=self.style.output_name) for _ in range(count)]
                if self.style.structured:
                    while f"Branch{number}" in taken:
                        number += 1
                    symbol.name = f"Branch{number}"
                    taken.add(symbol.name)


def consumers_of(symbols: Iterable[Symbol]) -> dict[int, int]:
    """How many inputs are wired to each symbol."""
    counts: dict[int, int] = {}
    for symbol in symbols:
        for pin in symbol.inputs:
            for connection in pin.connections:
                counts[connection.source] = counts.get(connection.source, 0) + 1
    return counts
