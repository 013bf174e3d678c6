"""``SFC`` bodies, read element by element; `tc6_chart_writer` writes them.

`tc6_chart_meaning` makes a chart of the elements that were read.
"""

from __future__ import annotations

from collections.abc import Callable

from lxml import etree

from plcopen_sfc.formats.plcopen.tc6_chart_meaning import UNREAD, DrawnChart, Line
from plcopen_sfc.formats.plcopen.tc6_networks import read_node
from plcopen_sfc.formats.plcopen.tc6_pins import (
    read_connection,
    read_geometry,
    read_input,
    read_output,
)
from plcopen_sfc.formats.plcopen.tc6_reading import (
    SHARED_FIELD,
    Fields,
    Tc6ReadContext,
    keep_attributes,
    keep_element,
    read_common,
    read_point,
    take_choice,
    take_flag,
    take_integer,
    take_required,
)
from plcopen_sfc.formats.xml.extension_data import attributes
from plcopen_sfc.model.drawing import CONVERGENCES, DIVERGENCES, Places, SymbolKind
from plcopen_sfc.model.text import is_direct
from plcopen_sfc.whole_numbers import xml_number

QUALIFIERS = ("P1", "N", "P0", "R", "S", "L", "D", "P", "DS", "DL", "SD", "SL")

BARS = frozenset(kind.value for kind in DIVERGENCES | CONVERGENCES)

BodyReader = Callable[[Tc6ReadContext, etree._Element], "Fields | None"]


class Tc6ChartReader:
    """Reads one chart. `read_body` reads the bodies inside it (inline actions and conditions, macro-steps)."""

    def __init__(self, ctx: Tc6ReadContext, read_body: BodyReader) -> None:
        self.ctx = ctx
        self.read_body = read_body
        self.drawn = DrawnChart(ctx)
        self.place = 0
        """Number of the element that is read, among those of the chart."""

    def read(self, element: etree._Element) -> Fields:
        """Read ``SFC``."""
        tags = self.ctx.tags
        for self.place, child in enumerate(element):
            local = tags.get(child.tag)
            if (read := _SYMBOLS.get(local)) is not None:
                read(self, child)
            elif local in BARS:
                self.read_bar(child, local)
            elif local and (node := read_node(self.ctx, child, local)) is not None:
                self.drawn.place(child, node, child.get("localId"))
                self.drawn.nodes.append(node)
            else:
                keep_element(self.ctx, self.drawn.chart, child)
        return self.drawn.interpret()

    def _symbol(self, element: etree._Element, kind: str, left: dict[str, str]) -> Fields:
        # the collector of garbage has nothing to look through in dictionaries of texts and numbers alone, which live
        # on: a member of the enumeration or a list in it would make it look
        symbol: Fields = {"kind": kind, UNREAD: self.place}
        self.drawn.place(element, symbol, left.pop("localId", None))
        if left:
            read_geometry(self.ctx, element, left, symbol)
        self.drawn.symbols.append(symbol)
        return symbol

    def _children(self, element: etree._Element, symbol: Fields) -> list[tuple[etree._Element, str | None]]:
        """Return the children of an element, with their names, but for its position and the pins of the flow.

        Of these only the sources of wires are read; `read_drawing` reads the rest when a script looks at the drawing.
        """
        tag_of, is_jump = self.ctx.tags.get, symbol["kind"] == _JUMP
        wires: list[int] = []
        self.drawn.wires[id(symbol)] = wires
        found: list[tuple[etree._Element, str | None]] = []
        for child in element:
            local = tag_of(child.tag)
            if local == "connectionPointIn":
                for wire in child:
                    source = xml_number(wire.get("refLocalId")) if tag_of(wire.tag) == "connection" else None
                    if source is not None:
                        wires.append(source)
            # TC6 gives a jump no output: one in a file is kept as extension data
            elif local not in _PLACE or (is_jump and local == "connectionPointOut"):
                found.append((child, local))
        return found

    def read_step(self, element: etree._Element) -> None:
        """Read ``step``."""
        ctx = self.ctx
        left = attributes(element)
        step: Fields = {"name": take_required(ctx, element, left, "name"), "actions": []}
        if "initialStep" in left:
            step["initial"] = take_flag(ctx, element, left, "initialStep")
        if "negated" in left:
            step["negated"] = take_flag(ctx, element, left, "negated")
        symbol = self._symbol(element, "step", left)
        step["symbol_fields"] = symbol
        for child, local in self._children(element, symbol):
            if local != "connectionPointOutAction":
                read_common(ctx, step, child, local, "step")
        if left:
            keep_attributes(step, left)
        _hand_over(step, symbol)
        self.drawn.steps.append(step)

    def read_macro_step(self, element: etree._Element) -> None:
        """Read ``macroStep``."""
        ctx = self.ctx
        left = attributes(element)
        macro: Fields = {}
        step: Fields = {"name": left.pop("name", ""), "actions": [], "macro": macro}
        symbol = self._symbol(element, "macroStep", left)
        step["symbol_fields"] = symbol
        for child, local in self._children(element, symbol):
            if local == "body":
                macro["body"] = self.read_body(ctx, child)
            else:
                read_common(ctx, step, child, local, "macroStep")
        keep_attributes(step, left)
        _hand_over(step, symbol)
        self.drawn.steps.append(step)

    def read_transition(self, element: etree._Element) -> None:
        """Read ``transition``."""
        ctx = self.ctx
        left = attributes(element)
        transition: Fields = {}
        if "priority" in left:
            transition["priority"] = take_integer(ctx, element, left, "priority")
        symbol = self._symbol(element, "transition", left)
        transition["symbol_fields"] = symbol
        for child, local in self._children(element, symbol):
            if local == "condition":
                self.read_condition(child, transition, symbol)
            else:
                read_common(ctx, transition, child, local, "transition")
        if left:
            keep_attributes(transition, left)
        _hand_over(transition, symbol)
        self._reserve(transition, symbol)
        self.drawn.transitions.append(transition)

    def _reserve(self, transition: Fields, symbol: Fields) -> None:
        """Reserve the ids that extension data have for the other transitions of a shared symbol."""
        shared = transition.pop(SHARED_FIELD, None)
        if not isinstance(shared, list) or not all(isinstance(number, int) for number in shared):
            return
        if shared[:1] == [symbol.get("id")] and self.drawn.ids.used.isdisjoint(shared[1:]):
            self.drawn.ids.used.update(shared[1:])
            symbol["transitions"] = shared

    def read_condition(self, element: etree._Element, transition: Fields, symbol: Fields) -> None:
        """Read ``condition``. A wired one is looked at again when all elements are known."""
        ctx = self.ctx
        left = attributes(element)
        negated = take_flag(ctx, element, left, "negated")
        condition: Fields | None = None
        for child in element:
            local = ctx.tags.get(child.tag)
            if local == "reference" and condition is None:
                condition = {"kind": "named", "name": child.get("name", "")}
            elif local == "inline" and condition is None:
                condition = self._inline_condition(child, symbol)
            elif local == "connectionPointIn" and condition is None:
                condition = {"kind": "wired", "input": read_input(ctx, child)}
            elif local == "connection" and (connection := read_connection(ctx, child)) is not None:
                # TC6 1.01 has the wires directly below the condition
                if condition is None:
                    condition = {"kind": "wired", "input": {"connections": []}}
                condition["input"]["connections"].append(connection)
            else:
                keep_element(ctx, transition, child)
        if condition is not None:
            condition["negated"] = negated
            transition["condition"] = condition
        if left:
            keep_attributes(transition, left)

    def _inline_condition(self, element: etree._Element, symbol: Fields) -> Fields:
        body = self.read_body(self.ctx, element) or {"language": "ST", "text": ""}
        name = element.get("name", "")
        markup = body.get("markup")
        plain = set(body) <= {"language", "text", "markup"} and (markup is None or is_direct(markup))
        if body["language"] == "ST" and plain:
            if name:
                symbol["name"] = name
            return {"kind": "expression", "text": body["text"], "markup": markup}
        return {"kind": "body", "body": body, "name": name}

    def read_jump(self, element: etree._Element) -> None:
        """Read ``jumpStep``."""
        left = attributes(element)
        target = take_required(self.ctx, element, left, "targetName")
        symbol = self._symbol(element, _JUMP, left)
        symbol["name"] = target
        self._read_flow(element, symbol, "jumpStep")
        if left:
            keep_attributes(symbol, left)

    def read_bar(self, element: etree._Element, kind: str) -> None:
        """Read one of the four kinds of divergences and convergences."""
        left = attributes(element)
        name = left.pop("name", None) if kind == SymbolKind.SIMULTANEOUS_DIVERGENCE else None
        symbol = self._symbol(element, kind, left)
        if name is not None:
            symbol["name"] = name
        self._read_flow(element, symbol, kind)
        if left:
            keep_attributes(symbol, left)

    def _read_flow(self, element: etree._Element, symbol: Fields, owner: str) -> None:
        for child, local in self._children(element, symbol):
            read_common(self.ctx, symbol, child, local, owner)

    def read_action_block(self, element: etree._Element) -> None:
        """Read ``actionBlock``. Its associations go to their step when all elements are known."""
        ctx = self.ctx
        left = attributes(element)
        negated = take_flag(ctx, element, left, "negated")
        symbol = self._symbol(element, "actionBlock", left)
        entries: list[Line] = []
        for child, local in self._children(element, symbol):
            if local == "action":
                entries.append(self.read_action(child, len(entries)))
            else:
                read_common(ctx, symbol, child, local, "actionBlock")
        if left:
            keep_attributes(symbol, left)
        if negated:
            for association, _, _ in entries:
                association["negated"] = True
        self.drawn.blocks.append((symbol, element, entries))

    def read_action(self, element: etree._Element, place: int) -> Line:
        """Read the action `place` of a block: the association, where it is drawn, and its ``localId``."""
        ctx = self.ctx
        left = attributes(element)
        association: Fields = {}
        entry: Fields = {UNREAD: place}
        local_id = left.pop("localId", None)
        qualifier = take_choice(ctx, element, left, "qualifier", QUALIFIERS)
        if qualifier is not None:
            association["qualifier"] = qualifier
        duration = left.pop("duration", None)
        if duration:
            association["duration"] = duration
        indicator = left.pop("indicator", None)
        if indicator:
            association["indicator"] = indicator
        if left:
            read_geometry(ctx, element, left, entry)
        for child in element:
            local = ctx.tags.get(child.tag)
            if local == "reference":
                association["target"] = child.get("name", "")
            elif local == "inline":
                association["body"] = self.read_body(ctx, child)
            elif local not in _LINE_PLACE:
                read_common(ctx, association, child, local, "action")
        if left:
            keep_attributes(association, left)
        return association, entry, local_id


_JUMP = "jumpStep"

_SYMBOLS: dict[str | None, Callable[[Tc6ChartReader, etree._Element], None]] = {
    "step": Tc6ChartReader.read_step,
    "macroStep": Tc6ChartReader.read_macro_step,
    "transition": Tc6ChartReader.read_transition,
    "jumpStep": Tc6ChartReader.read_jump,
    "actionBlock": Tc6ChartReader.read_action_block,
}


def _hand_over(thing: Fields, symbol: Fields) -> None:
    """Give the symbol the field that TC6 1.01 keeps at its step or transition."""
    if "execution_order" in thing:
        symbol["execution_order"] = thing.pop("execution_order")


_PLACE = frozenset({"position", "connectionPointOut"})
_LINE_PLACE = frozenset({"relPosition", "connectionPointOut"})


def read_drawing(ctx: Tc6ReadContext, chart: etree._Element, drawing: Fields) -> None:
    """Read what `Tc6ChartReader` left unread in ``SFC``. Fields of the drawing may be any value from extension data."""
    elements = list(chart)
    symbols = [symbol for symbol in drawing["symbols"] if isinstance(symbol, dict)]
    for symbol in symbols:
        if UNREAD in symbol:
            _read_symbol(ctx, symbol, elements[symbol.pop(UNREAD)])
    if drawing["places"] is Places.NONE and any(any(symbol.get("position", ())) for symbol in symbols):
        drawing["places"] = Places.GIVEN


def _read_symbol(ctx: Tc6ReadContext, symbol: Fields, element: etree._Element) -> None:
    pins: dict[str, list[Fields]] = {}
    lines: list[etree._Element] = []
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "position":
            point = read_point(child)
            if point is not None:
                symbol["position"] = point
        elif local == "connectionPointIn":
            pins.setdefault("inputs", []).append(read_input(ctx, child))
        elif local == "connectionPointOut" and symbol["kind"] != _JUMP:
            pins.setdefault("outputs", []).append(read_output(ctx, child))
        elif local == "connectionPointOutAction" and symbol["kind"] == SymbolKind.STEP:
            symbol["action_output"] = read_output(ctx, child)
        elif local == "action":
            lines.append(child)
    symbol.update(pins)
    entries = symbol.get("entries")
    for entry in entries if lines and isinstance(entries, list) else ():
        if isinstance(entry, dict) and UNREAD in entry:
            _read_line(ctx, entry, lines[entry.pop(UNREAD)])


def _read_line(ctx: Tc6ReadContext, entry: Fields, element: etree._Element) -> None:
    """Read where a line of an action block is, and its output. At 0, 0 it has no place of its own."""
    for child in element:
        local = ctx.tags.get(child.tag)
        if local == "relPosition":
            point = read_point(child)
            if point is not None and any(point):
                entry["position"] = point
        elif local == "connectionPointOut":
            entry["output"] = read_output(ctx, child)
