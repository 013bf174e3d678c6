"""Large pictures on several sheets of paper: each element is whole on one of them, wires go on from sheet to sheet."""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate

from plcopen_sfc.drawing.pictures.svg_canvas import DOUBLE
from plcopen_sfc.errors import ModelError, check_argument, nearest

_MARGIN = 38
"""The margin of a sheet, 10 mm at 96 pixels an inch."""
PAPERS = {"A4": (794, 1123), "A3": (1123, 1587), "letter": (816, 1056)}
"""Papers, upright, in pixels. They lie where a picture needs fewer sheets so."""
_SCALES = (1.0, 0.95, 0.9, 0.85)
"""Scales that are tried, the largest that needs the fewest sheets is taken."""
_FEW = 4
"""The most sheets that a picture may need in its own size for smaller scales to be tried."""
_LEAST = 0.5
"""The part of a sheet that is filled at least."""
_REPEATED = 0.4
"""The part of a sheet that the next one shows again at most."""
_EDGE = 2
"""Lines around an element are drawn on its edge, half of them outside: a border there would cut them."""
_HEAD = re.compile(r'<svg xmlns="[^"]*" (class="[^"]*" role="[^"]*") width="(\d+)" height="(\d+)"')
_AREA = re.compile(r'<g [^>]*data-area="(-?\d+) (-?\d+) (\d+) (\d+)"')
_LINE = re.compile(r'<(?:path|text|circle) class="[^"]*" (d="[^"]*"|c?x="-?\d+" c?y="-?\d+")')
_FRAME = re.compile(r'<g [^>]*class="part[ "]')
_NUMBER = re.compile(r"-?\d+")

Span = tuple[int, int]


@dataclass(frozen=True)
class _Part:
    """A thing drawn at one place: an element of the picture, or a wire. `across` and `down` are from where to where."""

    shape: str
    across: Span
    down: Span
    divisible: bool


@dataclass(frozen=True)
class _Sheet:
    """The part of a picture that a sheet shows."""

    across: Span
    down: Span
    parts: list[_Part]

    def holds(self, part: _Part) -> bool:
        """True if a part is whole on the sheet."""
        (left, right), (top, bottom) = part.across, part.down
        return self.across[0] <= left and right <= self.across[1] and self.down[0] <= top and bottom <= self.down[1]

    def shows(self, part: _Part) -> bool:
        """True if more than a line of a part is on the sheet: of a frame its corner with the heading."""
        at_corner = self.across[0] <= part.across[0] <= self.across[1] and self.down[0] <= part.down[0] <= self.down[1]
        return at_corner or not _FRAME.match(part.shape)


@dataclass(frozen=True)
class _Plan:
    """Rows of sheets of a paper that is turned so that its size is `page`."""

    page: tuple[int, int]
    scale: float
    rows: list[list[_Sheet]]

    @property
    def count(self) -> int:
        """The number of sheets."""
        return sum(map(len, self.rows))


def sheets(svg: str, paper: str) -> list[str]:
    """Return a picture in its size on sheets of `paper`, from left to right and then down.

    It is a little smaller where a few sheets are fewer so: the last one would hold no more than an arrow.
    An element that a border would divide is whole on the next sheet, which begins before it; a large one is divided.
    The margins of several have the number of the sheet and of those beside it. Raises `ModelError` for a paper that
    does not exist.
    """
    check_argument(paper, str, "the paper of a picture is a text")
    known = {name.casefold(): size for name, size in PAPERS.items()}
    if paper.casefold() not in known:
        hint = "There are: " + ", ".join(PAPERS)
        raise ModelError(f"there is no paper {paper!r}{nearest(paper, PAPERS)}", hint=hint)
    shapes = list(_shapes(svg))
    head = _HEAD.match(svg)
    assert head is not None  # noqa: S101  # every picture of this package has a size
    width, height = int(head[2]), int(head[3])
    size = known[paper.casefold()]
    parts = _parts(shapes)
    pages = (size, size[::-1]) if height >= width else (size[::-1], size)

    def plans(scale: float) -> list[_Plan]:
        rooms = [(int((page[0] - 2 * _MARGIN) / scale), int((page[1] - 2 * _MARGIN) / scale)) for page in pages]
        return [
            _Plan(page, scale, _divided(parts, (width, height), room)) for page, room in zip(pages, rooms, strict=True)
        ]

    found = plans(_SCALES[0])
    if 1 < min(plan.count for plan in found) <= _FEW:
        found += [plan for scale in _SCALES[1:] for plan in plans(scale)]
    plan = min(found, key=lambda each: each.count)
    page, rows = plan.page, plan.rows
    title = re.sub("<[^>]*>", "", shapes[1].partition("<desc>")[0])
    kept = [shape for shape in shapes[1:3] if shape.startswith(("<title>", "<style>"))]
    first = list(accumulate(map(len, rows), initial=1))
    made = [(row, number, sheet) for row, sheets in enumerate(rows) for number, sheet in enumerate(sheets, first[row])]
    if len(made) == 1:
        return [_document(made[0][2], plan, head[1], kept)]
    return [
        _document(
            sheet,
            plan,
            head[1],
            [*kept, *_marks(f"{title} {number}/{len(made)}", page, rows, first, (row, number))],
        )
        for row, number, sheet in made
    ]


def _shapes(svg: str) -> Iterator[str]:
    """Yield the parts of a picture of this package: its head, and the lines of each wire and element."""
    lines: list[str] = []
    depth = 0
    for line in svg.split("\n"):
        lines.append(line)
        depth += line.count("<g ") - line.count("</g>")  # texts have no brackets of their own
        if not depth:
            yield "\n".join(lines)
            lines = []


def _parts(shapes: Sequence[str]) -> list[_Part]:
    """Return the elements of a picture in the order in which they are drawn, without its head and its background."""
    found = []
    for shape in shapes:
        if area := _AREA.match(shape):
            x, y, width, height = map(int, area.groups())
            across, down = ((start - _EDGE, start + length + _EDGE) for start, length in ((x, width), (y, height)))
            found.append(_Part(shape, across, down, divisible=False))
        elif line := _LINE.match(shape):
            numbers = list(map(int, _NUMBER.findall(line[1])))
            xs, ys = numbers[::2], numbers[1::2]
            found.append(_Part(shape, (min(xs), max(xs)), (min(ys), max(ys)), divisible=True))
    return found


def _divided(parts: Sequence[_Part], size: tuple[int, int], room: tuple[int, int]) -> list[list[_Sheet]]:
    """Return the sheets, row by row, each with what it shows."""
    bars = [(part.down[0], part.down[0] + DOUBLE) for part in parts if part.down[0] == part.down[1]]
    rows = list(_pieces(size[1], room[1], bars + [part.down for part in parts if not part.divisible]))
    inside: list[list[_Part]] = [[] for _ in rows]
    for part in parts:
        for number in _meeting(rows, part.down):
            inside[number].append(part)
    grid = []
    for row, found in zip(rows, inside, strict=True):
        # the lines of a frame around it tell nothing of where the chart is: the sheets begin with what is inside
        content = [part for part in found if not _FRAME.match(part.shape) or row[0] <= part.down[0]] or found
        width = min(size[0], max((part.across[1] for part in content), default=0) + 2)
        begin = max(0, min((part.across[0] for part in content), default=0) - 2) if width > room[0] else 0
        spans = [part.across for part in found if not part.divisible]
        grid.append([_Sheet(across, row, []) for across in _pieces(width, room[0], spans, begin)])
    for part in parts:
        met = [
            sheet
            for number in _meeting(rows, part.down)
            for sheet in grid[number]
            if part.across[0] <= sheet.across[1] and part.across[1] >= sheet.across[0]
        ]
        whole = [sheet for sheet in met if sheet.holds(part)]
        for sheet in met if part.divisible else whole or met:
            sheet.parts.append(part)
    filled = [[sheet for sheet in row if any(map(sheet.shows, sheet.parts))] for row in grid]
    return [row for row in filled if row] or grid[:1]


def _meeting(pieces: Sequence[Span], span: Span) -> Iterator[int]:
    """Yield the numbers of the pieces, which are in order, that a span reaches into: at a border the one before it."""
    number = bisect_left(pieces, span[0], key=lambda piece: piece[1])
    while number < len(pieces) and (not number or pieces[number][0] < span[1]):
        yield number
        number += 1


def _pieces(length: int, room: int, spans: Sequence[Span], start: int = 0) -> Iterator[Span]:
    """Yield the parts of a length from `start` that fit into `room`. A span that a cut divides is whole in the next."""
    ordered = sorted(spans)
    first = 0
    while length - start > room:
        end, least = start + room, start + int(room * _LEAST)
        while first < len(ordered) and ordered[first][1] <= start:  # one that is longer only keeps more in sight
            first += 1
        last = bisect_left(ordered, end, key=lambda span: span[0])
        near = ordered[first:last]
        places = {end, *(edge for span in near for edge in span if least < edge < end)}
        cut = min(places, key=lambda place: (_spoilt(place, near, room), -place))
        yield start, cut
        start = _before(cut, near, room)
    yield start, length


def _before(cut: int, spans: Sequence[Span], room: int) -> int:
    """Return where the part after a cut begins: before what the cut divides, unless that would repeat too much."""
    return min([cut, *(low for low, high in spans if low < cut < high and cut - low < room * _REPEATED)])


def _spoilt(cut: int, spans: Sequence[Span], room: int) -> int:
    """Return how bad a cut is: what the next part repeats, and more for each span that stays divided."""
    start = _before(cut, spans, room)
    return cut - start + room * sum(low < start and high > cut for low, high in spans)


def _document(sheet: _Sheet, plan: _Plan, classes: str, shapes: Sequence[str]) -> str:
    """Return one sheet as a picture of the size of the paper: `shapes` beside its part of the whole."""
    (left, right), (top, bottom) = sheet.across, sheet.down
    width, height, page, scale = right - left, bottom - top, plan.page, plan.scale
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" {classes} width="{page[0]}" height="{page[1]}" '
        f'viewBox="{-_MARGIN} {-_MARGIN} {page[0]} {page[1]}">',
        f'<rect class="paper" x="{-_MARGIN}" y="{-_MARGIN}" width="{page[0]}" height="{page[1]}"/>',
        *shapes,
        f'<svg width="{width * scale:g}" height="{height * scale:g}" viewBox="{left} {top} {width} {height}">',
        *(part.shape for part in sheet.parts),
        "</svg></svg>",
    ]
    return "\n".join(lines) + "\n"


def _marks(
    title: str,
    page: tuple[int, int],
    rows: Sequence[Sequence[_Sheet]],
    first: Sequence[int],
    place: tuple[int, int],
) -> Iterator[str]:
    """Yield the texts in the margins of a sheet: its title, which is escaped, and the numbers of the sheets beside it.

    `first` are the numbers of the first sheets of the rows; `place` is the row and the number of the sheet.
    """
    row, number = place
    sheet = rows[row][number - first[row]]
    width, height = (length - 2 * _MARGIN for length in page)

    def at(x: int, y: int, text: str, anchor: str = "middle") -> str:
        return f'<text class="quiet" x="{x}" y="{y}" text-anchor="{anchor}">{text}</text>'

    def numbers(beside: int) -> str:
        """Return the sheets of another row that show something above or below this one."""
        others = rows[beside] if 0 <= beside < len(rows) else ()
        return ", ".join(str(first[beside] + at) for at, other in enumerate(others) if _overlap(other, sheet))

    yield at(width, height + _MARGIN * 2 // 3, title, "end")
    here = number - first[row]
    if here and rows[row][here - 1].across[1] >= sheet.across[0]:
        yield at(-_MARGIN // 2, height // 2, f"&#8592; {number - 1}")
    if here + 1 < len(rows[row]) and rows[row][here + 1].across[0] <= sheet.across[1]:
        yield at(width + _MARGIN // 2, height // 2, f"&#8594; {number + 1}")
    if above := numbers(row - 1):
        yield at(width // 2, -_MARGIN // 3, f"&#8593; {above}")
    if below := numbers(row + 1):
        yield at(width // 2, height + _MARGIN * 2 // 3, f"&#8595; {below}")


def _overlap(one: _Sheet, other: _Sheet) -> bool:
    """True if a sheet shows something above or below another one."""
    return one.across[0] < other.across[1] and other.across[0] < one.across[1]
