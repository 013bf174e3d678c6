"""Action blocks in pictures: a table with a row for each action.

The columns are those of IEC 61131-3 (qualifier with time, action, indicator variable); before them the marks of
S7-GRAPH (event, interlock). A column without content is left out. Actions of GRAFCET show their kind as IEC 60848 draws
it: an arrow up or down for stored actions, the condition above the action, two frames around a forcing order.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from plcopen_sfc.drawing.pictures.svg_canvas import Canvas, widest, wrap
from plcopen_sfc.drawing.pictures.symbol_facts import PictureSheet, PictureStyle
from plcopen_sfc.drawing.wording import ActionLine, Wording
from plcopen_sfc.languages.grafcet_conditions import is_operand
from plcopen_sfc.model.actions import ActionKind, Qualifier
from plcopen_sfc.model.body import IlBody, StBody
from plcopen_sfc.model.sfc import ActionAssociation, Body, Step
from plcopen_sfc.model.text import plain

SIZE = 12
PITCH = 15
_PAD = 6
_REMARK_PITCH = 13
_MOST_LINES = 12
"""Program text in an action is cut off after so many lines; its tooltip has all of it."""
_TIMED_KINDS = {ActionKind.DELAYED: "{}/X{}", ActionKind.LIMITED: "/({}/X{})"}
_LITERAL = re.compile(r"^(?:L?T(?:IME)?)#", re.IGNORECASE)
"""The beginning of a time in IEC 61131-3, which IEC 60848 does not have."""
_STORED = {ActionKind.ON_ACTIVATION: True, ActionKind.ON_DEACTIVATION: False}


@dataclass(slots=True)
class _Row:
    """`cells`: lines of mark, qualifier, action and indicator. `above`: what is written over it: its condition.

    `link`: the id of the frame of the chart that it forces.
    """

    title: str
    cells: tuple[list[str], list[str], list[str], list[str]]
    identifier: str = ""
    above: list[str] = field(default_factory=list)
    kind: ActionKind | None = None
    link: str = ""
    excluded: bool = False
    remark: list[str] = field(default_factory=list)

    @property
    def height(self) -> int:
        cells = max(1, *map(len, self.cells)) * PITCH + 2 * _PAD - 3
        return max(cells, len(self.remark) * _REMARK_PITCH + 4)

    @property
    def lead(self) -> int:
        return len(self.above) * PITCH + 6 if self.above else 0


class ActionBlock:
    """The action block of a step. Its `width` is 0 where the step has no actions."""

    def __init__(self, step: Step, sheet: PictureSheet) -> None:
        self._rows = list(_rows(step, sheet))
        columns = zip(*(row.cells for row in self._rows), strict=True)
        widths = [max((widest(cell, SIZE) for cell in column), default=0) for column in columns]
        self._widths = [width + 2 * _PAD if width else 0 for width in widths]
        self._spread = any(row.kind is not None or row.above for row in self._rows)
        above = max((widest(row.above, SIZE) + 12 for row in self._rows), default=0)
        remark = max((widest(row.remark, SIZE) for row in self._rows), default=0)
        self._inset = 12 if any(row.kind in _STORED for row in self._rows) else 0
        self._table = max(sum(self._widths) + self._inset, 40, above) if self._rows else 0
        self.width = self._table + (remark + 8 if remark else 0)
        gaps = 6 * (len(self._rows) - 1) if self._spread else 0
        self.height = sum(row.lead + row.height for row in self._rows) + max(gaps, 0)

    def entry(self, top: int, level: int) -> int:
        """Return where the line from the step meets the block that begins at `top`: at `level` if it can."""
        first = self._rows[0]
        return top + first.lead + first.height // 2 if self._spread else min(max(level, top + 8), top + self.height - 8)

    def draw(self, canvas: Canvas, x: int, y: int) -> None:
        """Draw the block with its upper left corner at `x`, `y`."""
        top = y
        for number, row in enumerate(self._rows):
            if number and self._spread:
                canvas.wire((x, top), (x, top + 6 + row.lead))
                top += 6
            kind = "action excluded" if row.excluded else "action"
            with canvas.element(kind, row.identifier, row.title, (x, top, self.width, row.lead + row.height)):
                self._draw_row(canvas, row, x, top + row.lead)
            top += row.lead + row.height

    def _draw_row(self, canvas: Canvas, row: _Row, x: int, y: int) -> None:
        if row.above:
            canvas.line("thin", (x + 8, y - row.lead + 2), (x + 8, y))
            canvas.lines("plain", x + 14, y - row.lead + 12, row.above, PITCH)
        canvas.box("row", x, y, self._table, row.height)
        if row.kind is ActionKind.FORCING:
            canvas.box("inner", x + 3, y + 3, self._table - 6, row.height - 6)
        left = x
        for column, (lines, width) in enumerate(zip(row.cells, self._widths, strict=True)):
            if not width or (self._spread and not lines):
                continue
            if column != _ACTION:
                if column == _INDICATOR:
                    left = x + self._table - width
                canvas.box("cell", left, y, width, row.height)
            first = y + (row.height - (len(lines) - 1) * PITCH) // 2 + 4
            begin = left + _PAD + (self._inset if column == _ACTION else 0)
            canvas.lines("link" if row.link else "plain", begin, first, lines, PITCH, link=row.link)
            left += width
        if row.kind in _STORED:
            tip, end = (y + 4, y + row.height - 4) if _STORED[row.kind] else (y + row.height - 4, y + 4)
            back = 7 if tip < end else -7
            canvas.line("thin", (x + 9, tip), (x + 9, end))
            canvas.line("head", (x + 9, tip), (x + 5, tip + back), (x + 13, tip + back), closed=True)
        if row.kind is ActionKind.ON_EVENT:
            canvas.line("head", (x + 8, y - 1), (x + 4, y - 8), (x + 12, y - 8), closed=True)
        middle = y + (row.height - (len(row.remark) - 1) * _REMARK_PITCH) // 2 + 4
        canvas.lines("remark", x + self._table + 8, middle, row.remark, _REMARK_PITCH)


_ACTION, _INDICATOR = 2, 3


def _rows(step: Step, sheet: PictureSheet) -> Iterator[_Row]:
    words, width = sheet.words, sheet.text_width
    for number, (line, action) in enumerate(words.step_actions(step), 1):
        row = _row(line, action, width)
        row.identifier = f"{sheet.prefix}step-{step.id}-action-{number}"
        yield row
    for association in step.actions:
        line = words.association(association)
        row = _row(line, None if association.target else association.body, width)
        row.identifier = f"{sheet.prefix}action-{association.id}"
        row.excluded = association.exclude
        row.link = sheet.frame(association.forcing.chart) if association.forcing is not None else ""
        row.remark = wrap(plain(association.comment), 11, 160)
        mark, qualifier, _, indicator = row.cells
        indicator += wrap(association.indicator or "", SIZE, width // 2)
        mark += filter(None, [line.interlock])
        row.above = wrap(_above(step, association, words), SIZE, width)
        if association.kind is not None:
            row.kind = association.kind
            qualifier.clear()
        elif sheet.style is PictureStyle.GRAFCET and association.qualifier is Qualifier.N and not association.duration:
            qualifier.clear()
        yield row


def _row(line: ActionLine, body: str | Body | None, width: int) -> _Row:
    """Return a row for `line`; program text that is the `body` of its action is shown line by line."""
    what = body.text if isinstance(body, StBody | IlBody) else line.what
    lines = wrap(what, SIZE, width)
    if len(lines) > _MOST_LINES:
        lines = [*lines[: _MOST_LINES - 1], "\u2026"]
    when = " ".join(filter(None, (line.qualifier, line.duration)))
    return _Row(str(replace(line, what=what)), (wrap(line.event, SIZE, width), wrap(when, SIZE, 110), lines, []))


def _above(step: Step, association: ActionAssociation, words: Wording) -> str:
    """Return the text over an action: its condition, with the time of delayed and limited ones of GRAFCET."""
    condition = words.condition(association.condition)
    if association.kind in _TIMED_KINDS and association.duration:
        time = _LITERAL.sub("", association.duration)
        timed = _TIMED_KINDS[association.kind].format(time, step.name if step.number is None else step.number)
        return f"{timed} * {condition if is_operand(condition) else f'({condition})'}" if condition else timed
    return condition
