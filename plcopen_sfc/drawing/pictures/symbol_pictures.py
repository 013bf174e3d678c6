"""Symbols of a chart in pictures: steps, transitions and jumps, each with what is written beside it.

A symbol knows how far it reaches to the `left` and `right` of the axis that the flow runs along, and its `height`; then
it is drawn at a place. Texts about a symbol are to its right (actions, condition, comment), its name and the references
of jumps to its left.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import NamedTuple

from plcopen_sfc.drawing.pictures.action_blocks import ActionBlock
from plcopen_sfc.drawing.pictures.svg_canvas import Canvas, text_width, widest, wrap
from plcopen_sfc.drawing.pictures.symbol_facts import NAME_WIDTH, LinkEnd, PictureSheet, PictureStyle
from plcopen_sfc.drawing.wording import EXCLUDED, enclosure_words
from plcopen_sfc.model.sfc import Step
from plcopen_sfc.model.text import plain

_REMARK_WIDTH = 200
_ARM = 24
_MOST_REFERENCES = 4


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
        # what is about the step alone is above the actions: below them, it would be taken for that of the last action
        self._above = [each for each in lines if not each.below and self._block.width]
        self._about = [each for each in lines if each.below or not self._block.width]
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
        name = self.sheet.name_inside(step)
        if style is not PictureStyle.GRAFCET and step.number is not None:
            self._above_name = f"S{step.number}" if style is PictureStyle.S7GRAPH else str(step.number)
        self._lines = wrap(name, 13, NAME_WIDTH, bold=True) or [""]
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
        for texts, down in ((self._above, self._block_down - self._head), (self._about, self._text_down)):
            for number, each in enumerate(texts):
                kind = "back" if each.link else each.kind
                canvas.text(kind, column, top + down + 11 + 14 * number, each.text, link=each.link)

    def _title(self) -> str:
        step = self.step
        kind = "Macro-step" if step.macro is not None else "Enclosing step" if step.encloses else "Step"
        if step.initial:
            kind = f"Initial {kind.lower()}"
        told = self.sheet.words.told
        name = self.sheet.name_inside(step)
        name = f"{name} {told(EXCLUDED)}" if step.exclude else name
        parts = [f"{told(kind)} {name}", *(each.text for each in self._texts)]
        return ". ".join(parts)


class _About(NamedTuple):
    """A text about a step with its class, a ``remark`` where it is a comment, and the id of what it leads to.

    `below`: it is below the actions.
    """

    kind: str
    text: str
    link: str = ""
    below: bool = False


def _about_step(sheet: PictureSheet, step: Step) -> Iterator[_About]:
    """Yield the texts about a step."""
    if step.name != sheet.name_inside(step):
        yield _About("quiet", step.name)
    if step.macro is not None and step.macro.expansion != step.name:
        yield _About("quiet", step.macro.expansion or "", sheet.frame(step.macro.expansion))
    for enclosure in step.encloses or ():
        yield _About("quiet", enclosure_words(enclosure), sheet.frame(enclosure.chart))
    for mark, part in (("C", step.interlock), ("V", step.supervision)):
        if part is not None and part.condition is not None:
            title = plain(part.title)
            told = f" ({title})" if title else ""
            yield _About("quiet", f"{mark}: {sheet.words.condition(part.condition)}{told}", below=True)
    warning = sheet.words.told("warning")
    times = (("min", step.min_time), ("max", step.max_time), (warning, step.warning_time))
    if tuple((time or "").upper() for _, time in times) != _USUAL_TIMES:
        yield _About("quiet", ", ".join(f"{label} {time}" for label, time in times if time), below=True)
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
        self._title = sheet.words.told("Jump to {}", sheet.name_inside(sheet.steps[target]))
        self._lines = wrap(self.reference.name, 12, NAME_WIDTH)
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
