"""Pictures of charts: the chart, and in frames beside it the charts that are inside it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from types import MappingProxyType
from typing import NamedTuple, TypeVar

from plcopen_sfc.collector import collecting_rarely
from plcopen_sfc.drawing.pictures.chart_arrangement import Arrangement
from plcopen_sfc.drawing.pictures.file_arrangement import FileArrangement
from plcopen_sfc.drawing.pictures.lined_up_charts import lined_up
from plcopen_sfc.drawing.pictures.svg_canvas import Canvas, Theme, text_width, widest, wrap
from plcopen_sfc.drawing.pictures.symbol_facts import PictureSheet, PictureStyle
from plcopen_sfc.drawing.wording import KINDS, Told, Wording, english
from plcopen_sfc.errors import ModelError, check_argument, nearest
from plcopen_sfc.languages.grafcet_conditions import is_grafcet
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.owners import Owned
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import Body, PartialChart, PartialChartKind, SfcBody, SfcNetwork, Step
from plcopen_sfc.model.text import plain
from plcopen_sfc.object_path import ObjectPath

_MARGIN = 24
_GAP = 40
_FRAME = 18
_HEADING = 30
_REMARK_WIDTH = 320
_REMARK_PITCH = 14
_LONGEST_ROW = 1600
_NO_NAMES: Mapping[str, Mapping[str, str]] = MappingProxyType({})

Choice = TypeVar("Choice", bound=StrEnum)


def chart_svg(chart: SfcNetwork, style: str | None = None, theme: str = Theme.LIGHT, *, fresh: bool = False) -> str:
    """Return a picture of `chart` as the text of an SVG file.

    `style` is a `PictureStyle`; None: that of the standard or tool that the chart is of. `theme` is a `Theme`. A chart
    that its file draws is shown as there; if `fresh`, it is laid out like charts of files without positions. The text
    is the same for the same chart in every run. Raises `ModelError` for a style or theme that does not exist.
    """
    colours = chosen_theme(theme)
    look = _choice(PictureStyle, style, "style") if style is not None else usual_style(chart)
    return _picture(chart, _Look(look, fresh=fresh), colours, "", Canvas())


def chart_figure(
    chart: SfcNetwork,
    prefix: str,
    marks: Mapping[str, str],
    names: Mapping[str, Mapping[str, str]] = _NO_NAMES,
    told: Told = english,
) -> str:
    """Return a picture of `chart` as a part of a page with several: all ids in it begin with `prefix`.

    It has no colours of its own, see `Canvas.document`. `marks` and `names` are those of `Canvas`, `told`
    gives the words of the picture.
    """
    return _picture(chart, _Look(usual_style(chart)), None, prefix, Canvas(marks, names), told=told)


class PairedChart(NamedTuple):
    """A chart that is shown beside another one: the prefix of its ids, marks and names of its elements (`Canvas`)."""

    chart: SfcNetwork
    prefix: str
    marks: Mapping[str, str]
    names: Mapping[str, Mapping[str, str]] = _NO_NAMES


def paired_figures(
    pair: tuple[PairedChart, PairedChart], same: Sequence[tuple[int, int]], told: Told = english, *, fresh: bool = False
) -> tuple[str, str]:
    """Return pictures of two charts that are set beside each other: they are narrow, as parts of a page.

    Steps that are the `same`, ids of steps of the first chart with those of the second, are at the same height where
    both charts get a new layout; `fresh`: they do, even if their files draw them.
    """
    with collecting_rarely():
        one, other = (
            _arranged(each.chart, _Look(usual_style(each.chart), fresh=fresh, narrow=True), each.prefix, told)
            for each in pair
        )
        first, second = one[0].arrangement, other[0].arrangement
        if isinstance(first, Arrangement) and isinstance(second, Arrangement):
            one[0].arrangement, other[0].arrangement = lined_up(first, second, same)
        left, right = (
            _drawn(each.chart, parts, each.prefix, Canvas(each.marks, each.names), theme=None, told=told, narrow=True)
            for each, parts in zip(pair, (one, other), strict=True)
        )
    return left, right


class _Look(NamedTuple):
    """Look of charts in pictures. `fresh`: not as in their files; `narrow`: beside others."""

    style: PictureStyle
    fresh: bool = False
    narrow: bool = False


def _picture(
    chart: SfcNetwork, look: _Look, theme: Theme | None, prefix: str, canvas: Canvas, *, told: Told = english
) -> str:
    with collecting_rarely():
        return _drawn(chart, _arranged(chart, look, prefix, told), prefix, canvas, theme=theme, told=told)


def _arranged(chart: SfcNetwork, look: _Look, prefix: str, told: Told) -> list[ChartPart]:
    """Return the charts of a picture with the places of their symbols."""
    parts = list(charts_in(chart, told))
    activated = {
        enclosure.chart: frozenset(enclosure.activated_steps)
        for part in parts
        for step in part.chart.steps
        for enclosure in step.encloses or ()
    }
    dialect = chart.project.dialect if chart.project is not None else Dialect.IEC
    in_turn = _tries_in_turn(chart)
    frames = {part.name.casefold(): f"{prefix}part-{number}" for number, part in enumerate(parts) if part.name}
    for number, part in enumerate(parts):
        starred = activated.get(part.name, frozenset()) if number else frozenset()
        wording = Wording(part.chart, dialect, told)
        start = prefix + part_prefix(number)
        sheet = PictureSheet(
            part.chart, look.style, wording, start, starred, narrow=look.narrow, in_turn=in_turn, frames=frames
        )
        drawn = None if look.fresh else FileArrangement.of(sheet)
        part.arrangement = drawn or Arrangement(sheet)
    return parts


def _drawn(
    chart: SfcNetwork,
    parts: list[ChartPart],
    prefix: str,
    canvas: Canvas,
    *,
    theme: Theme | None,
    told: Told,
    narrow: bool = False,
) -> str:
    width, height = _place(canvas, parts, prefix, _LONGEST_ROW // 2 if narrow else _LONGEST_ROW)
    return canvas.document(width, height, theme, _name_of(chart), _description(parts, told))


def part_prefix(number: int) -> str:
    """Return the prefix of ids in the chart of this number in `charts_in`."""
    return f"part-{number}-" if number else ""


def usual_style(chart: SfcNetwork) -> PictureStyle:
    """Return the style of the standard or tool that a chart is of, as far as its content tells."""
    if chart.graph_settings is not None or chart.sequences:
        return PictureStyle.S7GRAPH
    project = chart.project
    is_of_tool = project is not None and project.dialect is not Dialect.IEC
    if (project is not None and project.tool_format.startswith("grafcet")) or (not is_of_tool and is_grafcet(chart)):
        return PictureStyle.GRAFCET
    return PictureStyle.S7GRAPH if project is not None and project.dialect is Dialect.SCL else PictureStyle.IEC


def _tries_in_turn(chart: SfcNetwork) -> bool:
    """False where all competing transitions that are true fire: in GRAFCET, and in the charts of Beremiz (matiec)."""
    project = chart.project
    is_of_beremiz = project is not None and project.tool_format.startswith("plcopen") and project.header.is_of_beremiz
    return not is_of_beremiz and usual_style(chart) is not PictureStyle.GRAFCET


def chosen_theme(theme: str) -> Theme:
    """Return the theme of this name. Raises `ModelError`."""
    return _choice(Theme, theme, "theme")


def _choice(kind: type[Choice], value: str, what: str) -> Choice:
    check_argument(value, str, f"the {what} of a picture is a text")
    try:
        return kind(value.casefold())
    except ValueError:
        known = [str(each) for each in kind]
        hint = "There are: " + ", ".join(known)
        raise ModelError(f"there is no {what} {value!r} of pictures{nearest(value, known)}", hint=hint) from None


@dataclass(slots=True)
class ChartPart:
    """A chart in the picture.

    `place` is its object path as seen from the whole chart, `heading` the text of its frame; both are empty for the
    whole chart. `partial` is the partial chart that it is of, `around` the step that it is inside of.
    """

    chart: SfcNetwork
    place: ObjectPath
    heading: str = ""
    partial: PartialChart | None = None
    around: Step | None = None
    arrangement: Arrangement | FileArrangement | None = None

    @property
    def name(self) -> str:
        """The name of the partial chart; empty for others."""
        return self.partial.name if self.partial is not None else ""

    @property
    def comment(self) -> str:
        """The comment of the partial chart."""
        return plain(self.partial.comment) if self.partial is not None else ""


def charts_in(chart: SfcNetwork, told: Told = english) -> Iterator[ChartPart]:
    """Yield a chart and the charts inside it: partial charts, contents of macro-steps, charts as actions.

    `told` gives the words of the headings.
    """
    pending = [ChartPart(chart, ObjectPath())]
    while pending:
        part = pending.pop()
        yield part
        inner = [
            ChartPart(each.chart, part.place / each.name, _heading_of(each, told), each)
            for each in part.chart.partial_charts
        ]
        for step in part.chart.steps:
            place = part.place / f"step {step.name}"
            inner += [
                ChartPart(body.chart, place / below, f"{step.name} ({what})", around=step)
                for what, below, body in _inner_bodies(step, told)
            ]
        pending += reversed(inner)


def _heading_of(part: PartialChart, told: Told) -> str:
    """Return the name of a partial chart; of one inside a step also what it is there."""
    return part.name if part.kind is PartialChartKind.GLOBAL else f"{part.name} ({told(part.kind.value)})"


def _inner_bodies(step: Step, told: Told) -> Iterator[tuple[str, str, SfcBody]]:
    """Yield the charts inside a step: what they are, what their path has below that of the step, and their bodies."""
    bodies: list[tuple[str, str, str | Body | None]] = [
        (told("expansion"), "", step.macro.body if step.macro is not None else None),
        *((told(kind), "", action) for kind, action in step.step_actions.items()),
    ]
    for each in step.actions:
        what = told(KINDS[each.kind]) if each.kind is not None else each.qualifier.value
        told_of = f"{what} {each.target or ''}".strip()
        bodies.append((told_of, f"action {each.target or 'inline'}", each.body))
    yield from ((what, below, body) for what, below, body in bodies if isinstance(body, SfcBody))


def _place(canvas: Canvas, parts: list[ChartPart], prefix: str, longest: int) -> tuple[int, int]:
    """Draw the parts in rows from left to right, none of them longer than `longest` but for a part that is itself.

    Returns the size of the picture.
    """
    x = y = _MARGIN
    right = row = 0
    for number, part in enumerate(parts):
        arrangement = part.arrangement
        if arrangement is None:
            continue
        framed = bool(number)
        width, height = arrangement.width, arrangement.height
        remark = wrap(part.comment, 11, max(width, _REMARK_WIDTH))
        heading = _HEADING + _REMARK_PITCH * len(remark)
        if framed:
            width = max(width, text_width(part.heading, 13, bold=True), widest(remark, 11)) + 2 * _FRAME
            height += heading + _FRAME
        if x > _MARGIN and x + width > max(longest, right):
            x, y, row = _MARGIN, y + row + _GAP, 0
        if framed:
            title = ". ".join(filter(None, (part.heading, part.comment)))
            with canvas.element("part", f"{prefix}part-{number}", title, (x, y, width, height)):
                canvas.box("frame", x, y, width, height)
                canvas.text("name", x + 10, y + 20, part.heading, named=True)
                canvas.lines("remark", x + 10, y + 20 + _REMARK_PITCH, remark, _REMARK_PITCH)
            arrangement.draw(canvas, x + _FRAME, y + heading)
        else:
            arrangement.draw(canvas, x, y)
        right, row = max(right, x + width), max(row, height)
        x += width + _GAP
    return max(right, _MARGIN) + _MARGIN, y + row + _MARGIN


def _name_of(chart: SfcNetwork) -> str:
    """Return the name of the chart: that of its POU, with that of its action."""
    names: list[str] = []
    thing: Owned | None = chart.owner
    while thing is not None and not isinstance(thing, Project):
        name = getattr(thing, "name", None)
        if isinstance(name, str):
            names.append(name)
        thing = thing.owner
    return ".".join(reversed(names)) or "Chart"


def _description(parts: list[ChartPart], told: Told) -> str:
    """Return how much is in a picture, with the charts in frames."""
    counts = [
        (sum(len(part.chart.steps) for part in parts), "step"),
        (sum(len(part.chart.transitions) for part in parts), "transition"),
    ]
    if len(parts) > 1:
        counts.append((sum(1 for part in parts if part.chart.steps or part.chart.transitions), "chart"))
    sizes = ", ".join(f"{n} {told(what if n == 1 else f'{what}s')}" for n, what in counts)
    return f"{told('Sequential function chart')}: {sizes}"
