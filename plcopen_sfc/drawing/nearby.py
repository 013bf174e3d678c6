"""Places single new symbols in a drawing that has its places: near what they follow, where nothing stands."""

from __future__ import annotations

from collections.abc import Mapping

from plcopen_sfc.drawing.sizes import Sizes, node_size
from plcopen_sfc.drawing.wires import Wires
from plcopen_sfc.model.drawing import Symbol, SymbolKind
from plcopen_sfc.model.sfc import SfcNetwork

_GAP = 30
_Box = tuple[float, float, float, float]


def place_nearby(chart: SfcNetwork, followed: Mapping[int, int | None]) -> None:
    """Place the symbols that are keys of `followed`; what each follows is its value. Nothing else moves."""
    drawing = chart.drawing
    if drawing is None:
        return
    sizes = Sizes(chart)
    symbols = {symbol.id: symbol for symbol in drawing.symbols}
    boxes: dict[int, _Box] = {}
    for symbol in drawing.symbols:
        if symbol.id not in followed:
            width, height = sizes.of(symbol)
            boxes[symbol.id] = (*symbol.position, symbol.width or width, symbol.height or height)
    for node in chart.logic:
        width, height = node_size(node)
        boxes[node.id] = (*node.position, node.width or width, node.height or height)
    below = max((box[1] + box[3] for box in boxes.values()), default=0) + _GAP
    owners = {c.source: s.id for s in drawing.symbols if s.condition is not None for c in s.condition.connections}
    late = [i for i in followed if symbols[i].kind is SymbolKind.EXPRESSION]
    for number in (*(i for i in followed if i not in late), *late):
        symbol = symbols[number]
        width, height = sizes.of(symbol)
        symbol.width, symbol.height = width, height
        anchor = boxes.get(owners.get(number, -1)) or boxes.get(_or(followed[number], -1))
        x, y = _wish(symbol, width, anchor) if anchor is not None else (20, below)
        boxes[number] = _free((x, y, width, height), list(boxes.values()))
        symbol.position = boxes[number][:2]
    Wires(chart, only=frozenset(followed)).run()


def _or(number: int | None, default: int) -> int:
    return default if number is None else number


def _wish(symbol: Symbol, width: int, anchor: _Box) -> tuple[float, float]:
    x, y, anchor_width, anchor_height = anchor
    if symbol.kind is SymbolKind.ACTION_BLOCK:
        return (x + anchor_width + _GAP, y)
    if symbol.kind is SymbolKind.EXPRESSION:
        return (x - width - _GAP, y - 10)
    return (int(x + (anchor_width - width) // 2), y + anchor_height + _GAP)


def _free(box: _Box, taken: list[_Box]) -> _Box:
    """The first place to the right of the wish where nothing stands."""
    x, y, width, height = box
    for other in sorted(b for b in taken if b[1] < y + height and y < b[1] + b[3]):
        if other[0] < x + width and x < other[0] + other[2]:
            x = other[0] + other[2] + 10
    return (max(x, 0), y, width, height) if x >= 0 else _free((0, y, width, height), taken)
