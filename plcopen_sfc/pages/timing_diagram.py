"""Timing diagrams of traces, active steps, inputs and outputs over time; and traces in pages, to play on the chart."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isfinite
from typing import NamedTuple

from plcopen_sfc.drawing.pictures import Canvas, Theme, chart_figure, chosen_theme
from plcopen_sfc.drawing.pictures.svg_canvas import text_width
from plcopen_sfc.languages.st.literals import time_literal
from plcopen_sfc.pages.html_text import Html, data_element, element, joined, picture_figure
from plcopen_sfc.pages.page_index import PageIndex
from plcopen_sfc.pages.page_words import Words
from plcopen_sfc.semantics.signals import SignalKind
from plcopen_sfc.semantics.trace import Column, Trace

_MARGIN = 16
_PITCH = 26
_HIGH, _LOW = 6, 20
_AXIS = 24
_SCAN = 24
_LONGEST = 1200
_TICKS = 80
_UNREAD = 4
"""Numbers are a curve where their texts have no room in this part of the time."""
_NUMBERS = frozenset({SignalKind.INTEGER, SignalKind.REAL, SignalKind.DURATION})
_SHOWN = frozenset({"input", "output", "in_out", "external"})
"""Directions of what is seen from outside; globals that a program declares as external are such."""


class _Row(NamedTuple):
    """A line of the diagram: its values as texts, each with the scan in which it begins.

    `numbers` are the same values where they are numbers or times: those that change too often to be read are a curve.
    """

    name: str
    kind: str
    is_level: bool
    runs: list[tuple[int, str]]
    numbers: Sequence[float] = ()


def trace_svg(trace: Trace, theme: str = Theme.LIGHT) -> str:
    """Return the timing diagram of a trace as the text of an SVG file.

    It has the steps that become active, and inputs and outputs; where there are none, all variables. `theme` as in
    `SfcNetwork.to_svg`. Raises `ModelError` for a theme that does not exist.
    """
    return TimingDiagram(trace).svg(chosen_theme(theme), Words("en"))


def trace_section(trace: Trace, index: PageIndex, words: Words) -> Html:
    """Return the section of a page that plays a trace: the diagram, the values, and what the script needs for both."""
    diagram = TimingDiagram(trace)
    figure = element(
        "figure", element("div", Html(diagram.svg(None, words)), class_="scroll", tabindex="0", id="timing")
    )
    rows = [
        element("tr", element("th", name), element("td", words(way) if way else ""), element("td", class_="value"))
        for name, way in ((column.name, column.direction) for column in trace.columns)
    ]
    values = element(
        "details", element("summary", words("Values")), element("table", element("tbody", *rows)), open=True
    )
    named = {name: index.step_anchor(trace.name, name) for name in trace.steps}
    drawn = [prefix for anchor in named.values() for prefix in index.parts if anchor.startswith(prefix)]
    picture = Html("")
    if drawn:
        names = {f"trace-{anchor}": found for anchor, found in index.names(drawn[0]).items()}
        # beside the diagram too: the section of the chart may be far below
        picture = picture_figure(
            chart_figure(index.parts[drawn[0]][0].chart, f"trace-{drawn[0]}", {}, names, words), words
        )
    anchors = {name: index.step_anchor(trace.name, name) for name in trace.macros} | named
    events = trace.eventful_scans()
    data = {
        "scans": len(trace),
        "events": events,
        "times": [time_literal(trace.time(scan)).removeprefix("T#") for scan in events],
        "situations": [
            [scan, [[name, anchors[name]] for name in _with_macros(active, trace)]]
            for scan, active in trace.situations()
        ],
        "columns": [[[scan, column.signal.text(value)] for scan, value in column.runs()] for column in trace.columns],
        "left": diagram.left,
        "width": diagram.width,
        "top": diagram.top,
    }
    player = element(
        "div",
        *(
            element("button", sign, type="button", data_move=move, aria_label=words(told), title=words(told))
            for sign, move, told in (
                ("\u2759\u25c0", "-1", "one change back"),
                ("\u25b6", "0", "play"),
                ("\u25b6\u2759", "1", "one change on"),
            )
        ),
        element("input", type="range", min="0", max=str(max(len(events) - 1, 0)), value="0", id="scan"),
        element("output"),
        id="player",
        hidden=True,
    )
    told = words(
        "{} scans of {}, under the execution profile {}",
        len(trace),
        time_literal(trace.scan_time),
        trace.profile or "-",
    )
    heading = element("h2", element("small", words("Simulation")), " ", trace.name)
    reason = words.message(trace.ended)
    ended = element("p", words("The run ended with an error: {}", reason), class_="ended") if reason else ""
    section = element("section", heading, element("p", told), ended, figure, picture, values, id="trace")
    return joined(section, player, data_element("trace-data", data))  # outside: what contains a section fixes in it


def _with_macros(active: Sequence[str], trace: Trace) -> list[str]:
    """Return active steps behind the macro-steps around them, which are active with them (IEC 60848:2013, 7.4)."""
    around = ([each for each in trace.macros if name.startswith(f"{each}.")] for name in active)
    return list(dict.fromkeys(each for name, outer in zip(active, around, strict=True) for each in (*outer, name)))


class TimingDiagram:
    """The timing diagram of a trace.

    Scan 0 begins at `left`, all scans together are `width` pixels wide; `top` is below the times over the diagram.
    """

    top = _MARGIN + 16

    def __init__(self, trace: Trace) -> None:
        self.trace = trace
        self.width = max(min(len(trace) * _SCAN, _LONGEST), 60)
        self._rows = [*_step_rows(trace), *map(self._readable, _variable_rows(trace))] if len(trace) else []
        labels = [text_width(row.name, 12) for row in self._rows]
        self.left = _MARGIN + max(labels, default=0) + 12

    def _readable(self, row: _Row) -> _Row:
        """Return a row whose numbers are a curve, with their range, where too many have no room for their texts."""
        ends = [*(start for start, _ in row.runs[1:]), len(self.trace)]
        scan = self.width / max(len(self.trace), 1)
        lengths = [(end - start) * scan for (start, _), end in zip(row.runs, ends, strict=True)]
        hidden = sum(w for w, (_, text) in zip(lengths, row.runs, strict=True) if text_width(text, 11) + 6 > w)
        if not row.numbers or hidden * _UNREAD < self.width or not all(map(isfinite, row.numbers)):
            return row._replace(numbers=())
        shown = [
            f"{n:.4g}" if isinstance(n, float) else text for n, (_, text) in zip(row.numbers, row.runs, strict=True)
        ]
        texts = dict(zip(row.numbers, shown, strict=True))
        return row._replace(name=f"{row.name} ({texts[min(texts)]} .. {texts[max(texts)]})")

    def svg(self, theme: Theme | None, words: Words) -> str:
        """Return the picture; without a `theme` as a part of a page."""
        canvas = Canvas()
        bottom = _MARGIN + _AXIS + len(self._rows) * _PITCH
        self._draw_axis(canvas, bottom)
        for number, row in enumerate(self._rows):
            self._draw_row(canvas, row, _MARGIN + _AXIS + number * _PITCH)
        told = words("Timing diagram: {} scans of {}", len(self.trace), time_literal(self.trace.scan_time))
        return canvas.document(self.left + self.width + _MARGIN, bottom + _MARGIN, theme, self.trace.name, told)

    def _x(self, scan: int) -> int:
        return self.left + scan * self.width // max(len(self.trace), 1)

    def _draw_axis(self, canvas: Canvas, bottom: int) -> None:
        trace, scans = self.trace, len(self.trace)
        step = next(each for each in _round_numbers() if each * self.width >= _TICKS * scans)
        for scan in range(0, scans + 1, step):
            x = self._x(scan)
            canvas.wire((x, self.top), (x, bottom), kind="thin")
            label = time_literal(scan * trace.scan_time).removeprefix("T#")
            if x + text_width(label, 11) <= self.left + self.width:
                canvas.text("quiet", x + 3, _MARGIN + 12, label)

    def _draw_row(self, canvas: Canvas, row: _Row, top: int) -> None:
        with canvas.element(f"signal {row.kind}", "", row.name, (0, top, self.left + self.width, _PITCH)):
            canvas.text("plain", self.left - 10, top + 17, row.name, anchor="end")
            ends = [*(start for start, _ in row.runs[1:]), len(self.trace)]
            levels: list[tuple[int, int]] = []
            low, high = min(row.numbers, default=0), max(row.numbers, default=0)
            for number, ((start, value), end) in enumerate(zip(row.runs, ends, strict=True)):
                left, right = self._x(start), self._x(end)
                if row.numbers:
                    share = (row.numbers[number] - low) / (high - low)
                    level = top + _LOW + 2 - round(share * (_LOW - _HIGH + 4))
                    levels += [(left, level), (right, level)]
                    continue
                if row.is_level:
                    level = top + (_HIGH if value == "1" else _LOW)
                    levels += [(left, level), (right, level)]
                    if value == "1" and row.kind == "step":
                        canvas.box("box", left, top + _HIGH, right - left, _LOW - _HIGH)
                    continue
                canvas.box("row", left, top + _HIGH - 2, right - left, _LOW - _HIGH + 4)
                if text_width(value, 11) + 6 <= right - left:
                    canvas.text("small", left + 4, top + 17, value)
            if levels:
                canvas.line("wire", *levels)


def _step_rows(trace: Trace) -> Iterator[_Row]:
    """Yield the steps and macro-steps that are active at some time, in the order in which they become so."""
    runs: dict[str, list[tuple[int, str]]] = {}
    before: frozenset[str] = frozenset()
    for scan, situation in trace.situations():
        names = _with_macros(situation, trace)
        active = frozenset(names)
        for name in (*names, *sorted(before - active)):
            told = runs.setdefault(name, [] if scan == 0 else [(0, "0")])
            value = "1" if name in active else "0"
            if not told or told[-1][1] != value:
                told.append((scan, value))
        before = active
    for name, told in runs.items():
        yield _Row(name, "step", is_level=True, runs=told)


def _variable_rows(trace: Trace) -> Iterator[_Row]:
    shown: list[Column] = [column for column in trace.columns if column.direction in _SHOWN] or list(trace.columns)
    for column in shown:
        is_level = column.signal.kind is SignalKind.BOOL
        values = list(column.runs())
        runs = [(scan, str(int(bool(value))) if is_level else column.signal.text(value)) for scan, value in values]
        numbers = (
            [value for _, value in values if isinstance(value, int | float)] if column.signal.kind in _NUMBERS else []
        )
        is_known = len(numbers) == len(runs)
        kind = column.direction or "variable"
        yield _Row(column.name, kind, is_level=is_level, runs=runs, numbers=numbers if is_known else ())


def _round_numbers() -> Iterator[int]:
    power = 1
    while True:
        yield from (power, 2 * power, 5 * power)
        power *= 10
