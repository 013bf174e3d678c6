"""Order of symbols and logic in a document, and new ids in that order."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from plcopen_sfc.errors import ModelError
from plcopen_sfc.model.conditions import WiredCondition
from plcopen_sfc.model.drawing import Symbol, SymbolKind
from plcopen_sfc.model.network import Block, InputPin, Node, RightPowerRail
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.reachability import needed_first


def input_pins_of(node: Node) -> Iterator[InputPin]:
    """Yield the input pins of an element of logic."""
    if isinstance(node, Block):
        parameters = node.parameters
        for variable in (*parameters.inputs, *parameters.in_outs, *parameters.outputs):
            if variable.input is not None:
                yield variable.input
    elif isinstance(node, RightPowerRail):
        yield from node.inputs
    else:
        pin = getattr(node, "input", None)
        if pin is not None:
            yield pin


def feeding(pin: InputPin, nodes: dict[int, Node]) -> list[int]:
    """Return the elements of logic that a pin depends on, producers first."""

    def before(number: int) -> Iterable[int]:
        pins = input_pins_of(nodes[number])
        return reversed([c.source for each in pins for c in each.connections if c.source in nodes])

    return [*needed_first((c.source for c in pin.connections if c.source in nodes), before)]


def logic_order(chart: SfcNetwork, symbols: list[Symbol]) -> list[int] | None:
    """Order of symbols and logic: logic that feeds a condition is before its transition, the rest at the end."""
    if not chart.logic:
        return None
    nodes: dict[int, Node] = {node.id: node for node in chart.logic}
    conditions = {t.id: t.condition for t in chart.transitions}
    order: dict[int, None] = {}
    for symbol in symbols:
        condition = conditions.get(symbol.id) if symbol.kind is SymbolKind.TRANSITION else None
        if isinstance(condition, WiredCondition):
            order.update(dict.fromkeys(feeding(condition.input, nodes)))
        order[symbol.id] = None
    order.update(dict.fromkeys(nodes))
    return list(order)


def renumber(chart: SfcNetwork) -> dict[int, int]:
    """Number everything from 0 in document order: steps, transitions, associations before their block, bars, logic.

    Every reference follows. Transitions that share a symbol get ids above all others. Returns the new id of each old
    one. Raises `ModelError` where the chart is not drawn.
    """
    drawing = chart.drawing
    if drawing is None:
        raise ModelError("a chart has to be drawn before it can be numbered in the order of its drawing")
    symbols = {symbol.id: symbol for symbol in drawing.symbols}
    drawn = symbols.keys() | {node.id for node in chart.logic}
    order = [i for i in dict.fromkeys((*(drawing.order or ()), *symbols, *(n.id for n in chart.logic))) if i in drawn]
    numbers: dict[int, int] = {}
    for number in order:
        if number in symbols:
            for entry in symbols[number].entries or ():
                numbers.setdefault(entry.association, len(numbers))
        numbers.setdefault(number, len(numbers))
    undrawn = [step.id for step in chart.steps] + [transition.id for transition in chart.transitions]
    for number in undrawn + [association.id for _, association in chart.associations()]:
        numbers.setdefault(number, len(numbers))
    _give_numbers(chart, list(symbols.values()), numbers)
    if drawing.order is not None:
        drawing.order = [numbers[i] for i in order]
    return numbers


def _give_numbers(chart: SfcNetwork, symbols: list[Symbol], numbers: dict[int, int]) -> None:
    for pin in _input_pins(chart, symbols):
        for connection in pin.connections:
            connection.source = numbers.get(connection.source, connection.source)
    for step in chart.steps:
        step.id = numbers[step.id]
        for association in step.actions:
            association.id = numbers[association.id]
    for transition in chart.transitions:
        transition.id = numbers[transition.id]
        transition.sources = [numbers.get(i, i) for i in transition.sources]
        transition.targets = [numbers.get(i, i) for i in transition.targets]
    for node in chart.logic:
        node.id = numbers[node.id]
        node.local_id = None
    for sequence in chart.sequences:
        sequence.steps = [numbers.get(i, i) for i in sequence.steps]
    for symbol in symbols:
        symbol.id = numbers[symbol.id]
        symbol.local_id = None
        if symbol.target is not None:
            symbol.target = numbers.get(symbol.target, symbol.target)
        if symbol.transitions is not None:
            symbol.transitions = [numbers.get(i, i) for i in symbol.transitions]
        for entry in symbol.entries or ():
            entry.association = numbers.get(entry.association, entry.association)
            entry.local_id = None


def _input_pins(chart: SfcNetwork, symbols: Iterable[Symbol]) -> Iterator[InputPin]:
    """Yield every input pin once: symbol and condition may share theirs."""
    seen: set[int] = set()
    pins = [condition.input for condition in chart.conditions() if isinstance(condition, WiredCondition)]
    for symbol in symbols:
        pins += symbol.inputs
        if symbol.condition is not None:
            pins.append(symbol.condition)
    for node in chart.logic:
        pins += input_pins_of(node)
    for pin in pins:
        if id(pin) not in seen:
            seen.add(id(pin))
            yield pin
