"""Symbols of networks: blocks with pins, contacts, coils, rails, operands and notes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from plcopen_sfc.drawing.pictures.network_layout import Box
from plcopen_sfc.drawing.pictures.svg_canvas import Canvas, text_width, widest
from plcopen_sfc.model import network as n

_PITCH = 20
PAD = 7


@dataclass(slots=True)
class NetworkPin:
    """A pin of a symbol: its name, the text at it instead of a wire, and its effect on the signal."""

    name: str
    text: str = ""
    link: str = ""
    negated: bool = False
    modifier: str = ""
    connections: Sequence[n.Connection] = ()
    wired: bool = False

    @property
    def label(self) -> str:
        """The name as it is drawn: TIA Portal shows none at the power that enters a comparison."""
        return "" if self.name == "pre" else self.name


@dataclass(slots=True)
class NetworkSymbol:
    """An element of a network. `look` is block, text, contact, coil, rail, join or note.

    `caption` is above it; of a comparison in a ladder of TIA Portal `sign` is between the lines, and `below` below.
    """

    look: str
    lines: list[str]
    title: str
    identifier: str = ""
    caption: str = ""
    inputs: list[NetworkPin] = field(default_factory=list)
    outputs: list[NetworkPin] = field(default_factory=list)
    sign: str = ""
    below: str = ""
    negated: bool = False
    modifier: str = ""
    before: int = 0
    body: int = 0
    is_at_pin: bool = False
    box: Box = field(default_factory=lambda: Box(0, 0))

    def measure(self) -> None:
        """Set the size; the texts at the pins are known."""
        self.before = max((text_width(pin.text, 12) + 12 for pin in self.inputs if pin.text), default=0)
        behind = max((text_width(pin.text, 12) + 12 for pin in self.outputs if pin.text), default=0)
        rows = max(len(self.inputs), len(self.outputs), 1)
        inner = widest(self.lines, 13 if self.look == "block" else 12, bold=self.look == "block")
        above = 17 if self.caption else 0
        levels: list[int]
        if self.look == "block":
            sides = self.inputs, self.outputs
            names = [max((text_width(pin.label, 11) for pin in pins), default=0) for pins in sides]
            self.body = max(inner + 2 * PAD, sum(names) + 4 * PAD, text_width(self.caption, 12), 46)
            head = 18 * len(self.lines)
            height = above + head + rows * _PITCH + 4
            levels = [above + head + _PITCH * row + 10 for row in range(rows)]
        elif self.look in ("contact", "coil", "assignment"):
            self.body = max(widest([self.caption, self.below], 12) + 8, 52)
            height, levels = above + 23 + (15 if self.below else 0), [above + 11] * rows
        elif self.look == "rail":
            self.body, height, levels = 6, 26, [13] * rows
        elif self.look == "join":  # the layout knows the levels
            self.body, height, levels = 0, 0, [0] * rows
        else:
            self.body = inner + 3 * PAD
            height = max(len(self.lines), 1) * 15 + 6
            levels = [height // 2] * rows
        count = (len(self.inputs), len(self.outputs))
        self.box = Box(self.before + self.body + behind, height, levels[: count[0]], levels[: count[1]])
        self.box.joins = self.look == "join"

    def draw(self, canvas: Canvas, x: int, y: int) -> None:
        """Draw the symbol with its upper left corner at `x`, `y`."""
        left, right = x + self.before, x + self.before + self.body
        area = (x, y, self.box.width, self.box.height)
        kind = {"text": "operand", "note": "comment"}.get(self.look, self.look)
        with canvas.element(kind, self.identifier, self.title, area):
            if self.caption:
                canvas.text("plain", (left + right) // 2, y + 12, self.caption, anchor="middle")
            draw = {
                "block": self._draw_block,
                "rail": self._draw_rail,
                "join": self._draw_join,
                "text": self._draw_text,
                "note": self._draw_note,
            }
            draw.get(self.look, self._draw_switch)(canvas, left, right, y)
            for pins, levels, edge, side in (
                (self.inputs, self.box.inputs, left, -1),
                (self.outputs, self.box.outputs, right, 1),
            ):
                for pin, down in zip(pins, levels, strict=True):
                    self._draw_pin(canvas, pin, edge, y + down, side)

    def _draw_pin(self, canvas: Canvas, pin: NetworkPin, edge: int, level: int, side: int) -> None:
        outer = edge + side * (self.before if side < 0 else self.box.width - self.before - self.body)
        if pin.text:
            canvas.line("thin", (edge, level), (edge + side * 8, level))
            canvas.text(
                "link" if pin.link else "plain",
                edge + side * 11,
                level + 4,
                pin.text,
                anchor="end" if side < 0 else "start",
                link=pin.link,
            )
        elif outer != edge and pin.wired:
            canvas.line("wire", (outer, level), (edge, level))
        if self.look == "block" and pin.label:
            canvas.text("small", edge - side * (PAD + 1), level + 4, pin.label, anchor="start" if side < 0 else "end")
        if pin.negated:
            canvas.circle("mark", edge + side * 4, level, 4)
        if pin.modifier:
            canvas.text("quiet", edge + side * 6, level - 4, pin.modifier, anchor="end" if side < 0 else "start")

    def _draw_block(self, canvas: Canvas, left: int, right: int, y: int) -> None:
        top = y + (17 if self.caption else 0)
        canvas.box("box", left, top, right - left, y + self.box.height - top)
        canvas.lines("name", (left + right) // 2, top + 14, self.lines, 16, anchor="middle")

    def _draw_rail(self, canvas: Canvas, left: int, right: int, y: int) -> None:  # noqa: ARG002
        if not self.outputs:
            canvas.line("bar", (left, y), (left, y + self.box.height))

    def _draw_join(self, canvas: Canvas, left: int, right: int, y: int) -> None:  # noqa: ARG002
        *meeting, last = sorted(y + level for level in self.box.inputs)
        canvas.line("wire", (left, y), (left, last))
        for level in meeting:
            canvas.circle("head", left, level, 3)

    def _draw_text(self, canvas: Canvas, left: int, right: int, y: int) -> None:
        canvas.box("row", left, y, right - left, self.box.height)
        canvas.lines("plain", left + PAD, y + 14, self.lines, 15)

    def _draw_note(self, canvas: Canvas, left: int, right: int, y: int) -> None:  # noqa: ARG002
        canvas.lines("remark", left + 2 * PAD, y + 14, self.lines, 15)

    def _draw_switch(self, canvas: Canvas, left: int, right: int, y: int) -> None:
        level, middle = y + self.box.inputs[0], (left + right) // 2
        sign = self.sign or "".join(("/" if self.negated else "", self.modifier))
        half = max(9, text_width(sign, 12) // 2 + 4)
        for pin, begin, end in ((self.inputs[0], left, middle - half), (self.outputs[0], middle + half, right)):
            if pin.wired or pin.text:
                canvas.line("wire", (begin, level), (end, level))
        if self.look == "contact":
            for x in (middle - half, middle + half):
                canvas.line("bar", (x, level - 9), (x, level + 9))
        elif self.look == "coil":
            canvas.circle("mark", middle, level, 10)
        else:
            canvas.box("box", middle - 13, level - 11, 26, 22)
            sign = sign or "="
        canvas.text("plain", middle, level + 4, sign, anchor="middle")
        if self.below:
            canvas.text("plain", middle, level + 24, self.below, anchor="middle")
