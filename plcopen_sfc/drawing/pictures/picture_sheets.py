"""Large pictures on several sheets of paper, which are cut between their elements where that is possible."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from plcopen_sfc.errors import ModelError, check_argument, nearest

_MARGIN = 38
"""The margin of a sheet, 10 mm at 96 pixels an inch."""
PAPERS = {"A4": (794, 1123), "A3": (1123, 1587), "letter": (816, 1056)}
"""Papers, upright, in pixels. A picture that is wider than high is on sheets that are, too."""
_AREA = re.compile(r'data-area="(-?\d+) (-?\d+) (\d+) (\d+)"')
_HEAD = re.compile(r' width="(\d+)" height="(\d+)" viewBox="0 0 \d+ \d+"')
_LEAST = 0.5
"""The part of a sheet that is filled at least: elements that are in the way of every later cut are divided."""


def sheets(svg: str, paper: str) -> list[str]:
    """Return a picture in its size on sheets of `paper`, from left to right and then down; one if it fits.

    Wires go on at the same height of the next sheet in a row. Raises `ModelError` for a paper that does not exist.
    """
    check_argument(paper, str, "the paper of a picture is a text")
    known = {name.casefold(): size for name, size in PAPERS.items()}
    if paper.casefold() not in known:
        hint = "There are: " + ", ".join(PAPERS)
        raise ModelError(f"there is no paper {paper!r}{nearest(paper, PAPERS)}", hint=hint)
    head = _HEAD.search(svg)
    assert head is not None  # noqa: S101  # every picture of this package has a size
    width, height = int(head[1]), int(head[2])
    size = known[paper.casefold()]
    across, down = size if height >= width else (size[1], size[0])
    inner = across - 2 * _MARGIN, down - 2 * _MARGIN
    areas = [tuple(map(int, found.groups())) for found in _AREA.finditer(svg)]
    made = []
    for y, bottom in _pieces(height, inner[1], [(top, top + h) for _, top, _, h in areas]):
        beside = [(left, left + w) for left, top, w, h in areas if top < bottom and top + h > y]
        made += [_sheet(svg, head, (x, y), (right - x, bottom - y)) for x, right in _pieces(width, inner[0], beside)]
    return made


def _pieces(length: int, room: int, spans: Sequence[tuple[int, int]]) -> Iterator[tuple[int, int]]:
    """Yield the parts of a length that fit into `room`, divided where the least of spans is cut off, but late."""
    start = 0
    while length - start > room:
        end, least = start + room, start + int(room * _LEAST)
        places = {end, *(edge for span in spans for edge in span if least < edge < end)}
        cut = min(places, key=lambda place: (_cut_off(place, spans), -place))
        yield start, cut
        start = cut
    yield start, length


def _cut_off(place: int, spans: Sequence[tuple[int, int]]) -> int:
    """Return how much of spans a cut at a place separates: of each the smaller part."""
    return sum(min(place - low, high - place) for low, high in spans if low < place < high)


def _sheet(svg: str, head: re.Match[str], place: tuple[int, int], size: tuple[int, int]) -> str:
    """Return the part of a picture on one sheet, with its margin."""
    (x, y), (width, height) = place, size
    outer = f' width="{width + 2 * _MARGIN}" height="{height + 2 * _MARGIN}"'
    box = f' viewBox="{-_MARGIN} {-_MARGIN} {width + 2 * _MARGIN} {height + 2 * _MARGIN}"'
    inner = f'<svg width="{width}" height="{height}" viewBox="{x} {y} {width} {height}">'
    opening = svg.index(">", head.end()) + 1
    body = svg[opening:].replace("</svg>\n", "</svg></svg>\n")
    return f"{svg[: head.start()]}{outer}{box}{svg[head.end() : opening]}\n{inner}{body}"
