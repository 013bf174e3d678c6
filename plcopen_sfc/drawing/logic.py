"""Graphical logic in charts: which FBD and LD elements feed which condition, and where they stand among the symbols."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from plcopen_sfc.model.conditions import WiredCondition
from plcopen_sfc.model.drawing import Symbol, SymbolKind
from plcopen_sfc.model.network import Block, InputPin, Node, RightPowerRail
from plcopen_sfc.model.sfc import SfcNetwork


def node_inputs(node: Node) -> Iterator[InputPin]:
    """The input pins of an element of logic."""
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


def feeding(pins: Iterable[InputPin], nodes: dict[int, Node]) -> list[int]:
    """The elements of logic that the `pins` depend on, producers first."""
    found: list[int] = []
    seen: set[int] = set()
    stack = [(c.source, False) for pin in pins for c in reversed(pin.connections)]
    while stack:
        number, done = stack.pop()
        if done:
            found.append(number)
        elif number in nodes and number not in seen:
            seen.add(number)
            stack.append((number, True))
            for pin in node_inputs(nodes[number]):
                stack += [(c.source, False) for c in pin.connections]
    return found


def logic_order(chart: SfcNetwork, symbols: list[Symbol]) -> list[int] | None:
    """The order of symbols and logic: what feeds a condition stands before its transition, the rest at the end."""
    if not chart.logic:
        return None
    nodes: dict[int, Node] = {node.id: node for node in chart.logic}
    conditions = {t.id: t.condition for t in chart.transitions}
    order: dict[int, None] = {}
    for symbol in symbols:
        condition = conditions.get(symbol.id) if symbol.kind is SymbolKind.TRANSITION else None
        if isinstance(condition, WiredCondition):
            order.update(dict.fromkeys(feeding([condition.input], nodes)))
        order[symbol.id] = None
    order.update(dict.fromkeys(nodes))
    return list(order)
