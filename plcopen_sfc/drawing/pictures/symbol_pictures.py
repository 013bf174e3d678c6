"""Symbols of a chart in pictures: steps, transitions and jumps, each with what is written beside it.

A symbol knows how far it reaches to the `left` and `right` of the axis that the flow runs along, and its `height`; then
it is drawn at a place. Texts about a symbol are to its right (actions, condition, comment), its name and the references
of jumps to its left.

Action blocks in pictures: a table with a row for each action.

The columns are those of IEC 61131-3 (qualifier with time, action, indicator variable); before them the marks of
S7-GRAPH (event, interlock). A column without content is left out. Actions of GRAFCET show their kind as IEC 60848 draws
it: an arrow up or down for stored actions, the condition above the action, two frames around a forcing order.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import NamedTuple

from plcopen_sfc.drawing.pictures.svg_canvas import Canvas, text_width, widest, wrap
from plcopen_sfc.drawing.wording import EXCLUDED, ActionLine, Wording, enclosure_words
from plcopen_sfc.languages.grafcet_conditions import is_operand
from plcopen_sfc.model.actions import ActionKind, Qualifier
from plcopen_sfc.model.body import IlBody, StBody
from plcopen_sfc.model.sfc import ActionAssociation, Body, SfcNetwork, Step, Transition
from plcopen_sfc.model.text import plain

SIZE = 12
PITCH = 15
_TEXT_WIDTH, _NARROW = 230, 170
"""Texts of actions and conditions are wrapped at this width; in a narrow picture at the second."""
_PAD = 6
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
        return max(1, *map(len, self.cells)) * PITCH + 2 * _PAD - 3

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
        middle = y + (row.height - (len(row.remark) - 1) * 13) // 2 + 4
        canvas.lines("remark", x + self._table + 8, middle, row.remark, 13)


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


_NAME_WIDTH = 210
_REMARK_WIDTH = 200
_ARM = 24
_MOST_REFERENCES = 4


class PictureStyle(StrEnum):
    """Style of symbols: as in IEC 61131-3, as in IEC 60848 (GRAFCET), or as in TIA Portal (S7-GRAPH)."""

    IEC = "iec"
    GRAFCET = "grafcet"
    S7GRAPH = "s7graph"


@dataclass(frozen=True, slots=True)
class LinkEnd:
    """The other end of a link that is not drawn as a wire: its name, and the id of its element in the picture."""

    name: str
    element: str

    @property
    def lines(self) -> list[str]:
        """Its name, wrapped."""
        return wrap(self.name, 11, _NAME_WIDTH) or [""]


@dataclass(slots=True)
class PictureSheet:
    """Common facts of symbols of one chart.

    `prefix` begins the ids of its elements, `activated` are starred steps. `narrow`: the picture is set beside another
    one. `in_turn`: competing transitions are tried one after the other. `room`: how much longer the wire above a step
    is, by its id. `frames` are the ids of the frames of partial charts, by their names in lower case.
    """

    chart: SfcNetwork
    style: PictureStyle
    words: Wording
    prefix: str = ""
    activated: frozenset[str] = frozenset()
    narrow: bool = False
    in_turn: bool = False
    room: Mapping[int, int] = field(default_factory=dict)
    frames: Mapping[str, str] = field(default_factory=dict)
    _drawn: Counter[str] = field(default_factory=Counter, init=False)
    steps: dict[int, Step] = field(init=False)
    transitions: dict[int, Transition] = field(init=False)
    labels: dict[int, str] = field(init=False)

    def __post_init__(self) -> None:
        self.steps = {step.id: step for step in self.chart.steps}
        self.transitions = {transition.id: transition for transition in self.chart.transitions}
        self.labels = self.chart.labels()

    def next_id(self, kind: str) -> str:
        """Return the id of an element that the model does not number: a jump, or a reference of one."""
        self._drawn[kind] += 1
        return f"{self.prefix}{kind}-{self._drawn[kind]}"

    @property
    def stars(self) -> bool:
        """True if an asterisk tells that competing transitions without priorities are tried from left to right."""
        return self.in_turn and self.style is not PictureStyle.S7GRAPH

    @property
    def text_width(self) -> int:
        """The width at which texts of actions and conditions are wrapped."""
        return _NARROW if self.narrow else _TEXT_WIDTH

    def frame(self, name: str | None) -> str:
        """Return the id of the frame of a partial chart; empty where the picture has none."""
        return self.frames.get((name or "").casefold(), "")

    def step_reference(self, number: int) -> LinkEnd:
        """Return the reference to a step: its name, in GRAFCET and S7-GRAPH its number."""
        step = self.steps[number]
        name = step.name
        if step.number is not None and self.style is PictureStyle.GRAFCET:
            name = str(step.number)
        elif step.number is not None and self.style is PictureStyle.S7GRAPH:
            name = f"S{step.number} {step.name}"
        return LinkEnd(name, f"{self.prefix}step-{number}")

    def transition_reference(self, number: int) -> LinkEnd:
        """Return the reference to a transition: its name or number, else the names of the steps before it."""
        transition = self.transitions[number]
        name = transition.name
        if transition.number is not None and (self.style is PictureStyle.S7GRAPH or not name):
            name = f"({transition.number})" if self.style is PictureStyle.GRAFCET else f"T{transition.number}"
        elif name and self.style is PictureStyle.GRAFCET:
            name = f"({name})"
        elif not name:
            name = " & ".join(self.step_reference(i).name for i in transition.sources if i in self.steps)
            name = name or self.words.label(self.labels[number])  # a source transition
        return LinkEnd(name, f"{self.prefix}transition-{number}")


class StepSymbol:
    """A step with its action block, comment and marks.

    `entries` are the transitions that jump here, `exits` those elsewhere that wait for this step.
    """

    def __init__(self, sheet: PictureSheet, number: int, entries: Sequence[LinkEnd], exits: Sequence[LinkEnd]) -> None:
        self.step = sheet.steps[number]
        self.sheet = sheet
        self.entries = _shown(entries)
        self.exits = _shown(exits)
        self._label()
        self._block = ActionBlock(self.step, sheet)
        self._texts = [each for each in _about_step(sheet, self.step) if each.text]
        lines = [each._replace(text=line) for each in self._texts for line in wrap(each.text, 11, _REMARK_WIDTH)]
        # comments are above the actions: below them, they would be taken for those of the last action
        self._above = [each.text for each in lines if each.kind == "remark" and self._block.width]
        self._about = [each for each in lines if each.kind != "remark" or not self._block.width]
        about = max((text_width(each.text, 11) for each in lines), default=0)
        half = self._width // 2
        arm = _ARM if self._block.width else 10
        beside = max(self._block.width, about)
        self.left = max(half + 22, _reference_width([*self.entries, *self.exits]))
        self.right = half + (arm + beside if beside else 0) + 6
        self._room = sheet.room.get(number, 0)
        self._lead = self._room + 8 + _references_height(self.entries) + (4 if self.entries else 0)
        self._tail = 4 + _references_height(self.exits)
        middle = max(0, (self._box - self._block.height) // 2)
        self._head = 14 * len(self._above) + 4 if self._above else 0
        self._box_down = max(0, self._head - middle)
        self._block_down = self._box_down + middle
        text = 14 * len(self._about)
        self._text_down = self._block_down + self._block.height + 4
        if not self._block.width:
            self._text_down = max(0, (self._box - text) // 2)
        column = self._text_down + text if text else self._block_down + self._block.height
        self._body = max(self._box_down + self._box, column)
        self.height = self._lead + self._body + self._tail

    def _label(self) -> None:
        step, style = self.step, self.sheet.style
        self._above_name = ""
        name = step.name
        if style is PictureStyle.GRAFCET:
            name = str(step.number) if step.number is not None else step.name
        elif step.number is not None:
            self._above_name = f"S{step.number}" if style is PictureStyle.S7GRAPH else str(step.number)
        self._lines = wrap(name, 13, _NAME_WIDTH, bold=True) or [""]
        inside = max(widest(self._lines, 13, bold=True), text_width(self._above_name, 11)) + 28
        least = 44 if style is PictureStyle.GRAFCET else 92
        self._width = max(least, inside + inside % 2)
        self._box = max(44 if style is PictureStyle.GRAFCET else 38, 18 + 16 * len(self._lines))
        if self._above_name:
            self._box += 12

    @property
    def lead(self) -> int:
        """The distance of its box below the top of the symbol."""
        return self._lead + self._box_down

    def draw(self, canvas: Canvas, x: int, y: int, *, enters: bool, leaves: bool) -> None:
        """Draw the step on the axis `x` below `y`; `enters` and `leaves`: wires above and below belong to it."""
        top = y + self._lead
        box = top + self._box_down
        bottom = box + self._box
        first = y + self._room + 6
        _draw_entries(canvas, self.entries, x, first, box, enters=y if enters else None, sheet=self.sheet)
        below = top + self._body
        exits = list(zip(self.exits, _levels(self.exits, below + 8), strict=True))
        if leaves or exits:
            canvas.wire((x, bottom), (x, y + self.height if leaves else exits[-1][1]))
        for reference, level in exits:
            canvas.wire((x, level), (x - 14, level))
            told = self.sheet.words.told("Continues at {}", reference.name)
            with _reference(canvas, self.sheet, told, reference, (x, level)):
                canvas.line("head", (x - 18, level), (x - 11, level - 4), (x - 11, level + 4), closed=True)
        kind = "step" + " initial" * self.step.initial + " excluded" * self.step.exclude
        area = (x - self._width // 2 - 20, top, self._width // 2 + 20 + self.right - 6, self._body)
        with canvas.element(kind, f"{self.sheet.prefix}step-{self.step.id}", self._title(), area):
            self._draw_box(canvas, x, box)
            self._draw_marks(canvas, x, box)
            self._draw_beside(canvas, x, top)

    def _draw_box(self, canvas: Canvas, x: int, top: int) -> None:
        step, left, width, box = self.step, x - self._width // 2, self._width, self._box
        canvas.box("box", left, top, width, box)
        if step.initial:
            canvas.box("inner", left + 4, top + 4, width - 8, box - 8)
        inset = 8 if step.initial else 5
        if step.macro is not None:
            for level in (top + inset, top + box - inset):
                canvas.line("inner", (left, level), (left + width, level))
        if step.encloses:
            right, bottom, cut = left + width, top + box, 11
            canvas.line("inner", (left, top + cut), (left + cut, top))
            canvas.line("inner", (right - cut, top), (right, top + cut))
            canvas.line("inner", (left, bottom - cut), (left + cut, bottom))
            canvas.line("inner", (right - cut, bottom), (right, bottom - cut))
        first = top + (box - 16 * (len(self._lines) - 1)) // 2 + 5
        if self._above_name:
            first += 6
            canvas.text("quiet", x, first - 16, self._above_name, anchor="middle", named=True)
        inside = self.sheet.frame(step.macro.expansion) if step.macro is not None else ""
        canvas.lines("name", x, first, self._lines, 16, anchor="middle", link=inside, named=True)

    def _draw_marks(self, canvas: Canvas, x: int, top: int) -> None:
        step, left, box = self.step, x - self._width // 2, self._box
        inset = 7 if step.initial else 3
        if step.entry_action is not None:
            canvas.text("small", left + inset + 1, top + box - inset - 1, "E")
        if step.exit_action is not None:
            canvas.text("small", left + self._width - inset - 1, top + box - inset - 1, "X", anchor="end")
        if step.main_action is not None:
            edge = left + self._width - inset
            canvas.line("head", (edge - 8, top + inset), (edge, top + inset), (edge, top + inset + 8), closed=True)
        for mark, part, level in (("C", step.interlock, top), ("V", step.supervision, top + box - 16)):
            if part is not None and part.condition is not None:
                canvas.box("mark", left - 16, level, 16, 16)
                canvas.text("small", left - 8, level + 12, mark, anchor="middle")
        if step.name in self.sheet.activated:
            canvas.text("name", left - 10, top + box - 4, "*", anchor="middle")

    def _draw_beside(self, canvas: Canvas, x: int, top: int) -> None:
        edge = x + self._width // 2
        column = edge + (_ARM if self._block.width else 10)
        if self._block.width:
            box = top + self._box_down
            level = self._block.entry(top + self._block_down, box + min(self._box // 2, 22))
            if level <= box + self._box - 4:
                canvas.wire((edge, level), (column, level))
            else:  # the condition over the first action reaches below the box
                middle = box + self._box // 2
                canvas.wire((edge, middle), (edge + 10, middle), (edge + 10, level), (column, level))
            self._block.draw(canvas, column, top + self._block_down)
        canvas.lines("remark", column, top + self._block_down - self._head + 11, self._above, 14)
        for number, each in enumerate(self._about):
            kind = "back" if each.link else each.kind
            canvas.text(kind, column, top + self._text_down + 11 + 14 * number, each.text, link=each.link)

    def _title(self) -> str:
        step = self.step
        kind = "Macro-step" if step.macro is not None else "Enclosing step" if step.encloses else "Step"
        if step.initial:
            kind = f"Initial {kind.lower()}"
        told = self.sheet.words.told
        name = f"{step.name} {told(EXCLUDED)}" if step.exclude else step.name
        parts = [f"{told(kind)} {name}", *(each.text for each in self._texts)]
        return ". ".join(parts)


class _About(NamedTuple):
    """A text about a step with its class, a ``remark`` where it is a comment, and the id of what it leads to."""

    kind: str
    text: str
    link: str = ""


def _about_step(sheet: PictureSheet, step: Step) -> Iterator[_About]:
    """Yield the texts about a step."""
    if sheet.style is PictureStyle.GRAFCET and step.number is not None and step.name != str(step.number):
        yield _About("quiet", step.name)
    if step.macro is not None and step.macro.expansion != step.name:
        yield _About("quiet", step.macro.expansion or "", sheet.frame(step.macro.expansion))
    for enclosure in step.encloses or ():
        yield _About("quiet", enclosure_words(enclosure), sheet.frame(enclosure.chart))
    for mark, part in (("C", step.interlock), ("V", step.supervision)):
        if part is not None and part.condition is not None:
            title = plain(part.title)
            told = f" ({title})" if title else ""
            yield _About("quiet", f"{mark}: {sheet.words.condition(part.condition)}{told}")
    warning = sheet.words.told("warning")
    times = (("min", step.min_time), ("max", step.max_time), (warning, step.warning_time))
    if tuple((time or "").upper() for _, time in times) != _USUAL_TIMES:
        yield _About("quiet", ", ".join(f"{label} {time}" for label, time in times if time))
    yield _About("remark", plain(step.title))
    yield _About("remark", plain(step.comment))


_USUAL_TIMES = ("", "T#10S", "T#7S")
"""Title that TIA Portal gives every new step: it would be beside all of them."""


class TransitionSymbol:
    """A transition: bar, name, priority, condition and comment.

    `competing`: it is one of several below a step; `turn`: in which order they are tried, for one without a priority.
    `waits` are steps elsewhere that it waits for too.
    """

    def __init__(
        self, sheet: PictureSheet, number: int, waits: Sequence[LinkEnd], *, competing: bool, turn: int | None = None
    ) -> None:
        self.transition = sheet.transitions[number]
        self.sheet = sheet
        self.waits = _shown(waits)
        transition = self.transition
        self.turn = turn if transition.priority is None else transition.priority
        self._priority = str(self.turn) if competing and self.turn is not None else ""
        self._names = self._name_lines()
        condition = sheet.words.condition(transition.condition)
        told, label = sheet.words.told, sheet.words.label(sheet.labels[transition.id])
        name = f"{label} {told(EXCLUDED)}" if transition.exclude else label
        self._title = f"{told('Transition {}', name)}: {condition or told('(no condition)')}"
        width = sheet.text_width
        widest_line = min(max(width, text_width(condition, 12) // 4), 2 * width)
        self._condition = wrap(condition, 12, widest_line)
        about = [plain(transition.title), plain(transition.comment)]
        self._about = [line for text in about for line in wrap(text, 11, _REMARK_WIDTH)]
        self._missing = not self._condition
        if self._missing:
            self._condition = [told("(no condition)")]
        self.left = max(20 + widest(self._names, 11), 20 + text_width(self._priority, 11))
        if self.waits:
            self.left = max(self.left, 14 + _reference_width(self.waits))
        self.right = 22 + max(widest(self._condition, 12), widest(self._about, 11))
        self._text = 15 * len(self._condition) + 13 * len(self._about)
        self._lead = _references_height(self.waits) + 16 if self.waits else 0
        names = 13 * len(self._names) // 2 + (13 if self._priority and self._names else 0)
        self._above = max(15, self._text // 2 + 5, names + 4)
        self.height = self._lead + self._above + max(15, (self._text + 1) // 2 + 5, names + 4)

    def _name_lines(self) -> list[str]:
        transition, style = self.transition, self.sheet.style
        number = str(transition.number) if transition.number is not None else ""
        if style is PictureStyle.S7GRAPH and number:
            return [f"T{number}", *wrap(transition.name, 11, 120)]
        names = [name for name in (transition.name, number) if name]
        if style is PictureStyle.GRAFCET:  # as IEC 60848 has them
            names = [f"({name})" for name in names]
        return [line for name in names for line in wrap(name, 11, 120)]

    def draw(self, canvas: Canvas, x: int, y: int, *, enters: bool, leaves: bool) -> None:
        """Draw the transition on the axis `x` below `y`."""
        bar = y + self._lead + self._above
        bottom = y + self.height
        start = y if enters else bar - 12
        if self.waits:
            double = y + self._lead - 6
            _draw_entries(canvas, self.waits, x - 12, y + 4, double, enters=None, sheet=self.sheet)
            canvas.wire((x - 26, double), (x + 26, double))
            canvas.wire((x - 26, double + 4), (x + 26, double + 4))
            if enters:
                canvas.wire((x, y), (x, double))
            start = double + 4
        canvas.wire((x, start), (x, bottom if leaves else bar + 14))
        if not leaves:
            canvas.wire((x - 8, bar + 14), (x + 8, bar + 14))
        kind = "transition excluded" if self.transition.exclude else "transition"
        names = 20 + max(widest(self._names, 11), text_width(self._priority, 11)) if self._names else 15
        area = (x - names, bar - self._above, names + self.right, self._above + bottom - bar)
        with canvas.element(kind, f"{self.sheet.prefix}transition-{self.transition.id}", self._title, area):
            canvas.line("bar", (x - 13, bar), (x + 13, bar))
            first = bar - self._text // 2 + 12
            canvas.lines("warn" if self._missing else "plain", x + 20, first, self._condition, 15)
            canvas.lines("remark", x + 20, first + 15 * len(self._condition) - 1, self._about, 13)
            top = bar - 13 * len(self._names) // 2 + 10
            canvas.lines("quiet", x - 19, top, self._names, 13, anchor="end", named=True)
            if self._priority:
                level = top - 12 if self._names else bar - 5
                canvas.text("quiet", x - 5 if not self._names else x - 19, level, self._priority, anchor="end")


class JumpSymbol:
    """A jump: an arrow and the name of the step that it leads to."""

    def __init__(self, sheet: PictureSheet, target: int) -> None:
        self.sheet = sheet
        self.reference = sheet.step_reference(target)
        self._title = sheet.words.told("Jump to {}", sheet.steps[target].name)
        self._lines = wrap(self.reference.name, 12, _NAME_WIDTH)
        half = widest(self._lines, 12) // 2 + 8
        self.left = self.right = max(half, 14)
        self.height = 28 + 15 * len(self._lines) + 6

    def draw(self, canvas: Canvas, x: int, y: int, *, enters: bool, leaves: bool) -> None:  # noqa: ARG002
        """Draw the jump on the axis `x` below `y`; nothing leaves it."""
        canvas.wire((x, y), (x, y + 18))
        area = (x - self.left, y + 14, self.left + self.right, self.height - 16)
        with canvas.element("jump", self.sheet.next_id("jump"), self._title, area):
            canvas.line("head", (x, y + 25), (x - 5, y + 14), (x + 5, y + 14), closed=True)
            for number, line in enumerate(self._lines):
                canvas.text("link", x, y + 39 + 15 * number, line, anchor="middle", link=self.reference.element)


Symbol = StepSymbol | TransitionSymbol | JumpSymbol


def _shown(references: Sequence[LinkEnd]) -> list[LinkEnd]:
    """Return references for a picture, no name twice: of many the first ones, and how many more there are."""
    named: dict[str, LinkEnd] = {}
    for reference in references:
        named.setdefault(reference.name, reference)
    found = list(named.values())
    if len(found) <= _MOST_REFERENCES:
        return found
    more = LinkEnd(f"+{len(found) - _MOST_REFERENCES + 1}", "")
    return [*found[: _MOST_REFERENCES - 1], more]


_REFERENCE_PITCH = 14


def _reference_width(references: Sequence[LinkEnd]) -> int:
    return max((widest(reference.lines, 11) + 28 for reference in references), default=0)


def _references_height(references: Sequence[LinkEnd]) -> int:
    return _REFERENCE_PITCH * sum(len(reference.lines) for reference in references)


def _levels(references: Sequence[LinkEnd], first: int) -> Iterator[int]:
    """Yield the levels of references below each other: of the first lines of their names."""
    for reference in references:
        yield first
        first += _REFERENCE_PITCH * len(reference.lines)


def _draw_entries(
    canvas: Canvas,
    references: Sequence[LinkEnd],
    x: int,
    first: int,
    bottom: int,
    *,
    enters: int | None,
    sheet: PictureSheet,
) -> None:
    """Draw arrows from the left into the wire above a symbol, from `first` down, and the wire down to `bottom`.

    `enters`: where a wire from above begins; None: the wire begins at the first arrow.
    """
    if enters is not None or references:
        canvas.wire((x, first + 5 if enters is None else enters), (x, bottom))
    for reference, level in zip(references, _levels(references, first + 5), strict=True):
        canvas.wire((x - 18, level), (x - 6, level))
        with _reference(canvas, sheet, sheet.words.told("From {}", reference.name), reference, (x, level)):
            canvas.line("head", (x - 1, level), (x - 9, level - 4), (x - 9, level + 4), closed=True)


@contextmanager
def _reference(
    canvas: Canvas, sheet: PictureSheet, title: str, reference: LinkEnd, place: tuple[int, int]
) -> Iterator[None]:
    """Write the name of a reference to the left of its `place` on a wire; its arrow is drawn inside."""
    x, level = place
    width, height = widest(reference.lines, 11), _REFERENCE_PITCH * len(reference.lines)
    with canvas.element(
        "reference", sheet.next_id("reference"), title, (x - 22 - width, level - 7, width + 22, height)
    ):
        yield
        for number, line in enumerate(reference.lines):
            below = level + 4 + _REFERENCE_PITCH * number
            canvas.text("back", x - 22, below, line, anchor="end", link=reference.element)
