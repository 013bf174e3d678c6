"""Pictures of networks: FBD as blocks with pins, LD as contacts and coils between rails.

The order from above to below is that of the file: of its positions if it has any, else of its elements. An operand of
one block is written at its pin. A signal that comes back to where it was is written at the pin, with a link
to its source, instead of a wire around everything. In LD branches join in a line, as the part ``O`` of SimaticML says.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

from plcopen_sfc.drawing.pictures.chart_picture import chosen_theme
from plcopen_sfc.drawing.pictures.network_layout import NetworkLayout, Wire, feedback_wires
from plcopen_sfc.drawing.pictures.network_symbols import PAD, NetworkPin, NetworkSymbol
from plcopen_sfc.drawing.pictures.svg_canvas import Canvas, Theme, widest, wrap
from plcopen_sfc.drawing.wording import Told, english
from plcopen_sfc.grouping import grouped
from plcopen_sfc.languages.standard_blocks import standard_block
from plcopen_sfc.model import network as n
from plcopen_sfc.model.body import FbdBody, LdBody
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.text import plain

_MARGIN = 24
_BETWEEN = 16
_TEXT = 360
_MODIFIERS = {n.Edge.RISING: "P", n.Edge.FALLING: "N", n.Storage.SET: "S", n.Storage.RESET: "R"}


def body_svg(body: FbdBody | LdBody, theme: str = Theme.LIGHT, name: str = "") -> str:
    """Return a picture of the networks of a body as the text of an SVG file, called `name`.

    `theme` is a `Theme`. Raises `ModelError` for one that does not exist.
    """
    return _picture(body, chosen_theme(theme), "", name)


def body_figure(body: FbdBody | LdBody, prefix: str, told: Told = english) -> str:
    """Return a picture of the networks of a body as a part of a page: all ids in it begin with `prefix`.

    `told` gives the words of the picture.
    """
    return _picture(body, None, prefix, "", told)


def _picture(body: FbdBody | LdBody, theme: Theme | None, prefix: str, name: str, told: Told = english) -> str:
    canvas = Canvas()
    y = right = _MARGIN
    is_s7 = body.project is not None and body.project.dialect is Dialect.SCL
    for number, network in enumerate(body.networks):
        title = plain(network.title)
        if len(body.networks) > 1 or title:
            lines = wrap(f"{number + 1}. {title}" if title else f"{number + 1}.", 13, 2 * _TEXT, bold=True)
            canvas.lines("name", _MARGIN, y + 10, lines, 16)
            right = max(right, _MARGIN + widest(lines, 13, bold=True))
            y += 16 * len(lines) + 10
        sheet = _Sheet(network, f"{prefix}network-{number}-", told, is_ladder=body.language == "LD", is_s7=is_s7)
        sheet.draw(canvas, _MARGIN, y)
        right = max(right, _MARGIN + sheet.width)
        y += sheet.height + 8
    kind = told("Ladder diagram" if body.language == "LD" else "Function block diagram")
    count = len(body.networks)
    size = f"{kind}: {count} {told('network' if count == 1 else 'networks')}"
    return canvas.document(right + _MARGIN, y + _MARGIN - 24, theme, name or kind, size)


class _Sheet:
    """A network: its symbols and their places."""

    def __init__(self, network: n.LogicNetwork, prefix: str, told: Told, *, is_ladder: bool, is_s7: bool) -> None:
        self._prefix = prefix
        self._told = told
        self._is_ladder = is_ladder
        self._is_s7 = is_s7
        self.symbols: list[NetworkSymbol] = []
        self._of: dict[int, tuple[int, dict[str, int]]] = {}
        self._rails: set[int] = set()
        nodes = list(network.nodes)
        if len({node.position for node in nodes}) > 1:
            nodes.sort(key=lambda node: (node.position[1], node.position[0]))
        for node in nodes:
            self._add(node)
        self._operands_to_pins(nodes)
        if is_ladder:
            self._join_branches()
            self._comparisons_to_contacts()
        wires = list(self._connect())
        for symbol in self.symbols:
            symbol.measure()
            symbol.box.first = symbol.look == "rail" and bool(symbol.outputs)
            symbol.box.last = symbol.look in ("coil", "rail") and is_ladder and not symbol.box.first
        # a rail that networks share is above the first one; what it is wired to tells the places of the others
        shown = sorted(
            (symbol for symbol in self.symbols if not symbol.is_at_pin), key=lambda each: each.look == "rail"
        )
        self._groups = list(_connected(shown, self.symbols, wires))
        self._indents = [self._indent(symbols) for symbols, _ in self._groups]
        widths = (indent + layout.width for indent, (_, layout) in zip(self._indents, self._groups, strict=True))
        self.width = max(widths, default=0)
        self.height = sum(layout.height + _BETWEEN for _, layout in self._groups)

    def draw(self, canvas: Canvas, x: int, y: int) -> None:
        """Draw the network with its upper left corner at `x`, `y`."""
        rails: list[tuple[int, int]] = []
        for indent, (symbols, layout) in zip(self._indents, self._groups, strict=True):
            left = x + indent
            for path in layout.paths:
                for line in path.lines:
                    if line[0] != line[1]:
                        canvas.wire(*((left + a, y + b) for a, b in line))
                for a, b in path.dots:
                    canvas.circle("head", left + a, y + b, 3)
            for symbol in symbols:
                symbol.draw(canvas, left + symbol.box.x, y + symbol.box.y)
                if symbol.box.first:
                    rails += [
                        (x + symbol.body, y + symbol.box.y),
                        (x + symbol.body, y + symbol.box.y + symbol.box.height),
                    ]
            y += layout.height + _BETWEEN
        if rails:
            canvas.wire(min(rails), max(rails), kind="bar")

    def _indent(self, symbols: Sequence[NetworkSymbol]) -> int:
        """Return the room that symbols keep from a left rail that goes past them."""
        is_apart = not any(symbol.box.first or symbol.look == "note" for symbol in symbols)
        return 2 * PAD if is_apart and self._rails else 0

    def _operands_to_pins(self, nodes: Sequence[n.Node]) -> None:
        """Write operands that feed one pin of a block at this pin: no wire is needed."""
        users: dict[int, list[NetworkPin]] = {}
        for symbol in self.symbols:
            for pin in symbol.inputs:
                for connection in pin.connections:
                    users.setdefault(connection.source, []).append(pin if symbol.look == "block" else NetworkPin(""))
        for node in nodes:
            pins = users.get(node.id, [])
            if not isinstance(node, n.InputVariable) or len(pins) != 1 or len(pins[0].connections) != 1:
                continue
            symbol = self.symbols[self._of[node.id][0]]
            if not symbol.outputs[0].modifier and not (node.negated and pins[0].negated) and len(symbol.lines) == 1:
                pins[0].text, pins[0].connections = node.expression, ()
                pins[0].negated = pins[0].negated or node.negated
                symbol.is_at_pin = True

    def _join_branches(self) -> None:
        """Let branches of a ladder meet in a line: at a pin with several wires, and in a part ``O`` of TIA Portal."""
        meant = (each.source for symbol in self.symbols for pin in symbol.inputs for each in pin.connections)
        free = max((*self._of, *self._rails, *meant), default=0)
        for symbol in list(self.symbols):
            if self._is_s7 and symbol.lines == ["OR"] and all(map(_is_wire, symbol.inputs)):
                symbol.look = "join"
                continue
            for pin in symbol.inputs:
                if len(pin.connections) > 1:
                    free += 1
                    self._of[free] = (len(self.symbols), {})
                    ends = [NetworkPin("", connections=[connection]) for connection in pin.connections]
                    self.symbols.append(NetworkSymbol("join", [], "OR", inputs=ends, outputs=[NetworkPin("")]))
                    pin.connections = [n.Connection(source=free)]

    def _comparisons_to_contacts(self) -> None:
        """Draw comparisons of TIA Portal as contacts: one operand above, one below."""
        for symbol in self.symbols:
            sign = _COMPARISONS.get("".join(symbol.lines)) if symbol.look == "block" else None
            pins = {pin.name.lower(): pin for pin in symbol.inputs}
            if sign is None or pins.keys() != {"pre", "in1", "in2"} or len(symbol.outputs) != 1:
                continue
            above, below = pins["in1"], pins["in2"]
            if all(pin.text and not pin.link and not pin.negated for pin in (above, below)):
                title = f"{self._told('contact')} {above.text} {sign} {below.text}"
                symbol.look, symbol.lines, symbol.title, symbol.sign = "contact", [], title, sign
                symbol.caption, symbol.below, symbol.inputs = above.text, below.text, [pins["pre"]]

    def _add(self, node: n.Node) -> None:
        if isinstance(node, n.LeftPowerRail):
            self._rails.add(node.id)
            return
        if isinstance(node, n.RightPowerRail):
            for connection in (each for pin in node.inputs for each in pin.connections):
                self.symbols.append(
                    NetworkSymbol(
                        "rail", [], self._told("Right power rail"), inputs=[NetworkPin("", connections=[connection])]
                    )
                )
            return
        symbol = self._symbol(node)
        if not symbol.lines and symbol.look == "note":
            return
        symbol.identifier = f"{self._prefix}{node.id}"
        names = {pin.name: number for number, pin in enumerate(symbol.outputs)}
        self._of.setdefault(node.id, (len(self.symbols), names))
        self.symbols.append(symbol)

    def _connect(self) -> Iterator[Wire]:
        """Yield the wires; a rail becomes a symbol for each wire, feedback a text at the pin."""
        ends = [
            (number, place, connection)
            for number, symbol in enumerate(self.symbols)
            for place, pin in enumerate(symbol.inputs)
            for connection in pin.connections
        ]
        wires: dict[Wire, None] = {}
        for number, place, connection in ends:
            source, names = self._of.get(connection.source, (-1, {}))
            if connection.source in self._rails:
                wires[Wire(len(self.symbols), 0, number, place)] = None
                self.symbols.append(NetworkSymbol("rail", [], self._told("Left power rail"), outputs=[NetworkPin("")]))
            elif source >= 0 and self.symbols[source].outputs:
                wires[Wire(source, names.get(connection.pin or "", 0), number, place)] = None
            else:
                self.symbols[number].inputs[place].text = "?"  # the wire of a broken file
        back = feedback_wires(len(self.symbols), list(wires))
        for wire in wires:
            start, pin = self.symbols[wire.source], self.symbols[wire.target].inputs[wire.place]
            if wire not in back:
                pin.wired = start.outputs[wire.pin].wired = True
                yield wire
                continue
            name = ".".join(filter(None, (start.caption or " ".join(start.lines), start.outputs[wire.pin].name)))
            pin.text, pin.link = f"\u2190 {name}", start.identifier

    def _symbol(self, node: n.Node) -> NetworkSymbol:
        match node:
            case n.Block():
                name, caption, (inputs, outputs) = node.type_name, node.instance or "", _pins(node.parameters)
                known = standard_block(name)
                if known is not None:
                    order = {pin.name: place for place, pin in enumerate(known.inputs)}
                    inputs.sort(key=lambda pin: order.get(known.input_name(pin.name) or "", len(order)))
                if self._is_s7 and name in _FLIP_FLOPS_OF_S7:
                    name = _FLIP_FLOPS_OF_S7[name]
                    inputs.sort(key=lambda pin: pin.name.endswith("1"))
                    outputs = [replace(pin, name="Q") for pin in outputs]
                if self._is_s7 and known is not None and not caption:
                    states = [pin for pin in inputs if pin.name in ("operand", "bit") and not pin.connections]
                    caption = states[0].text if states else ""
                    inputs = [pin for pin in inputs if pin not in states]
                lines = wrap(node.code or name, 13, _TEXT, bold=True)
                title = " ".join(filter(None, (name, caption)))
                return NetworkSymbol("block", lines, title, "", caption, inputs, outputs)
            case n.Contact() | n.Coil():
                kind = "contact" if isinstance(node, n.Contact) else "coil" if self._is_ladder else "assignment"
                symbol = NetworkSymbol(kind, [], f"{self._told(kind)} {node.variable}", caption=node.variable)
                symbol.negated, symbol.modifier = node.negated, _modifier(node.edge, node.storage)
                symbol.inputs, symbol.outputs = [_input(node.input)], [NetworkPin("")]
                return symbol
            case n.InputVariable():
                pin = NetworkPin("", negated=node.negated, modifier=_modifier(node.edge, node.storage))
                return self._text(node.expression, outputs=[pin])
            case n.OutputVariable():
                pin = _input(node.input)
                pin.negated, pin.modifier = node.negated, _modifier(node.edge, node.storage)
                return self._text(node.expression, inputs=[pin])
            case n.InOutVariable():
                pin = _input(node.input)
                pin.negated, pin.modifier = node.negated_in, _modifier(node.edge_in, node.storage_in)
                out = NetworkPin("", negated=node.negated_out, modifier=_modifier(node.edge_out, node.storage_out))
                return self._text(node.expression, inputs=[pin], outputs=[out])
            case n.Jump():
                return self._text(f">> {node.label}", inputs=[_input(node.input)])
            case n.Label():
                return self._text(f"{node.label}:")
            case n.Return():
                return self._text("RETURN", inputs=[_input(node.input)])
            case n.Connector():
                return self._text(f"{node.name} >", inputs=[_input(node.input)])
            case n.Continuation():
                return self._text(f"> {node.name}", outputs=[NetworkPin("")])
            case n.VendorElement() if node.parameters is not None:
                lines = wrap(plain(node.alternative_text) or node.element_type or "?", 13, _TEXT, bold=True)
                inputs, outputs = _pins(node.parameters)
                return NetworkSymbol("block", lines, " ".join(lines), inputs=inputs, outputs=outputs)
            case n.VendorElement():  # CODESYS keeps settings of the editor in those without a type
                text = plain(node.alternative_text) if node.element_type or not node.attributes else ""
            case _:
                text = plain(getattr(node, "content", ""))
        return NetworkSymbol("note", wrap(text, 12, 2 * _TEXT), text)

    def _text(
        self, text: str, *, inputs: Sequence[NetworkPin] = (), outputs: Sequence[NetworkPin] = ()
    ) -> NetworkSymbol:
        return NetworkSymbol("text", wrap(text, 12, _TEXT) or [""], text, inputs=list(inputs), outputs=list(outputs))


def _connected(
    shown: Sequence[NetworkSymbol], symbols: Sequence[NetworkSymbol], wires: Sequence[Wire]
) -> Iterator[tuple[list[NetworkSymbol], NetworkLayout]]:
    """Yield the symbols that wires connect with each other, in the order of `shown`, with their layout."""
    near: list[list[Wire]] = [[] for _ in symbols]
    for wire in wires:
        near[wire.source].append(wire)
        near[wire.target].append(wire)
    numbers = {id(symbol): number for number, symbol in enumerate(symbols)}
    seen: set[int] = set()
    for first in (numbers[id(symbol)] for symbol in shown):
        group = [] if first in seen else [first]
        seen.add(first)
        for number in group:  # grows
            for other in (end for wire in near[number] for end in (wire.source, wire.target)):
                if other not in seen:
                    seen.add(other)
                    group.append(other)
        if group:
            place = {number: position for position, number in enumerate(sorted(group))}
            own = [
                Wire(place[wire.source], wire.pin, place[wire.target], wire.place)
                for number in place
                for wire in near[number]
                if wire.target == number
            ]
            members = [symbols[number] for number in place]
            yield members, NetworkLayout([symbol.box for symbol in members], own)


def _pins(parameters: n.BlockParameters) -> tuple[list[NetworkPin], list[NetworkPin]]:
    """Return the pins on the left and on the right of a block; hidden ones without a use are left out."""
    left, right = [], []
    for variable in (*parameters.inputs, *parameters.in_outs):
        pin = _input(variable.input)
        if not variable.hidden or pin.connections or pin.text:
            pin.name, pin.negated, pin.modifier = (
                variable.name,
                variable.negated,
                _modifier(variable.edge, variable.storage),
            )
            left.append(pin)
    left = _in_order(left)
    for variable in (*parameters.in_outs, *parameters.outputs):
        text = (variable.output.expression if variable.output is not None else None) or ""
        pin = NetworkPin(variable.name, text)
        if variable in parameters.outputs:
            pin.negated, pin.modifier = variable.negated, _modifier(variable.edge, variable.storage)
        right.append(pin)
    return left, right


_COMPARISONS = {"EQ": "==", "NE": "<>", "GT": ">", "GE": ">=", "LT": "<", "LE": "<="}
_FLIP_FLOPS_OF_S7 = {"RS": "SR", "SR": "RS"}
"""What TIA Portal calls the flip-flops of IEC 61131-3: the dominant input is the last in the name and the lower one."""
_NUMBERED = re.compile(r"(\D*)(\d+)")


def _is_wire(pin: NetworkPin) -> bool:
    return len(pin.connections) == 1 and not pin.negated and not pin.modifier


def _in_order(pins: list[NetworkPin]) -> list[NetworkPin]:
    """Return pins with ``IN1`` above ``IN2``: SimaticML has them in the order of its wires."""
    numbered = [_NUMBERED.fullmatch(pin.name) for pin in pins]
    alike = grouped((found[1], (int(found[2]), place)) for place, found in enumerate(numbered) if found is not None)
    ordered = {name: iter(sorted(places)) for name, places in alike.items()}
    return [
        pin if found is None else pins[next(ordered[found[1]])[1]] for pin, found in zip(pins, numbered, strict=True)
    ]


def _input(pin: n.InputPin | None) -> NetworkPin:
    if pin is None:
        return NetworkPin("")
    return NetworkPin("", (pin.expression or "") if not pin.connections else "", connections=pin.connections)


def _modifier(edge: n.Edge, storage: n.Storage) -> str:
    return _MODIFIERS.get(storage, "") or _MODIFIERS.get(edge, "")
