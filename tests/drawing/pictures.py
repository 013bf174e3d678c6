"""Measures of pictures of charts: areas of elements, wires, texts."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise

from lxml import etree

SVG = "{http://www.w3.org/2000/svg}"
SIZES = {"name": 13, "plain": 12, "link": 12, "warn": 12, "small": 11, "quiet": 11, "remark": 11, "back": 11}

Area = tuple[int, int, int, int]
"""Left, top, right and bottom."""
Segment = tuple[int, int, int, int]
"""From x, y to x, y."""


@dataclass
class Picture:
    """A picture as its reader sees it."""

    root: etree._Element
    areas: list[tuple[etree._Element, Area]] = field(default_factory=list)
    wires: list[Segment] = field(default_factory=list)

    def by_class(self, kind: str) -> list[etree._Element]:
        """All groups of a class."""
        return [g for g in self.root.iter(f"{SVG}g") if kind in (g.get("class") or "").split()]

    def texts(self, element: etree._Element | None = None) -> list[str]:
        """All texts of the picture, or of one element."""
        return [text.text or "" for text in (self.root if element is None else element).iter(f"{SVG}text")]


def area(element: etree._Element) -> Area:
    left, top, width, height = map(int, element.get("data-area").split())
    return left, top, left + width, top + height


def points(path: etree._Element) -> list[tuple[int, int]]:
    pairs = path.get("d").strip("MZ").split("L")
    return [tuple(map(int, pair.split())) for pair in pairs]  # type: ignore[misc]


def read_picture(svg: str) -> Picture:
    """Parse a picture; only well-formed ASCII is one."""
    picture = Picture(etree.fromstring(svg.encode("ascii")))
    for element in picture.root.iterfind(f"{SVG}g"):
        if element.get("class") != "part":
            picture.areas.append((element, area(element)))
    for path in picture.root.iterfind(f"{SVG}path"):
        assert path.get("class") == "wire"
        line = points(path)
        for (x, y), (at_x, at_y), (to_x, to_y) in zip(line, line[1:], line[2:], strict=False):
            turns = (at_x - x) * (to_x - at_x) < 0 or (at_y - y) * (to_y - at_y) < 0
            assert not turns, f"a wire leads back on itself: {line}"
        picture.wires += [(*one, *other) for one, other in pairwise(line)]
    return picture


def assert_tidy(picture: Picture) -> None:
    """Nothing overlaps, no wire runs through an element, across another or on one, no bar has three lines."""
    width, height = int(picture.root.get("width")), int(picture.root.get("height"))
    ordered = sorted(picture.areas, key=lambda item: item[1])
    for position, (one, a) in enumerate(ordered):
        assert a[0] >= 0, (one.get("id"), a)
        assert a[1] >= 0, (one.get("id"), a)
        assert a[2] <= width, (one.get("id"), a, width)
        assert a[3] <= height, (one.get("id"), a, height)
        for other, b in ordered[position + 1 :]:
            if b[0] >= a[2]:
                break
            assert b[1] >= a[3] or a[1] >= b[3], (one.get("id"), a, other.get("id"), b)
    for element, box in picture.areas:
        axis = _axis(element)
        for wire in picture.wires:
            assert not _runs_through(wire, box, axis), (element.get("id"), box, wire)
    for one in picture.wires:
        for other in picture.wires:
            assert not _cross(one, other), (one, other)
    level = {(y, min(x, end), max(x, end)) for x, y, end, below in picture.wires if y == below}
    for top, left, right in level:
        below = [{at for at, a, b in level if at == top + down and a < right and b > left} for down in (4, 8)]
        assert not all(below), (top, left, right)
    spans: dict[tuple[bool, int], list[tuple[int, int]]] = {}
    for x, y, end, below in picture.wires:
        spans.setdefault((x == end, x if x == end else y), []).append(
            tuple(sorted((y, below) if x == end else (x, end)))
        )  # type: ignore[arg-type]
    for line, each in spans.items():
        assert all(one[1] <= other[0] for one, other in pairwise(sorted(each))), (line, sorted(each))


def _axis(element: etree._Element) -> float:
    for kind, tag in (("box", "rect"), ("bar", "path"), ("head", "path")):
        for shape in element.iterfind(f"{SVG}{tag}"):
            if shape.get("class") == kind:
                if tag == "rect":
                    return float(shape.get("x")) + float(shape.get("width")) / 2
                across = [x for x, _ in points(shape)]
                return (min(across) + max(across)) / 2
    raise AssertionError(f"no axis in {etree.tostring(element)!r}")


def _runs_through(wire: Segment, box: Area, axis: float) -> bool:
    left, right = sorted((wire[0], wire[2]))
    top, bottom = sorted((wire[1], wire[3]))
    if right <= box[0] + 1 or left >= box[2] - 1 or bottom <= box[1] + 1 or top >= box[3] - 1:
        return False
    inside = box[0] <= left and right <= box[2] and box[1] <= top and bottom <= box[3]
    return not inside and not (left == right == axis)


def _cross(one: Segment, other: Segment) -> bool:
    """True if a horizontal wire and a vertical one cross; those that end at each other only touch."""
    if one[1] != one[3] or other[0] != other[2]:
        return False
    left, right = sorted((one[0], one[2]))
    top, bottom = sorted((other[1], other[3]))
    return left < other[0] < right and top < one[1] < bottom


Point = tuple[int, int]


def links_in(picture: Picture) -> set[tuple[str, str]]:
    """Connections that the wires, bars, jumps and references of a picture show: from step to transition, and back.

    A person reads it so: down along the wires that touch, from the upper line of a double bar to the lower one.
    """
    above: dict[str, Point] = {}
    below: dict[str, Point] = {}
    for g in picture.root.iterfind(f"{SVG}g[@id]"):
        if "step" in g.get("class").split():
            box = g.find(f"{SVG}rect[@class='box']")
            x, y, width, height = (int(box.get(name)) for name in ("x", "y", "width", "height"))
            above[g.get("id")], below[g.get("id")] = (x + width // 2, y), (x + width // 2, y + height)
        elif "transition" in g.get("class").split():
            ends = points(g.find(f"{SVG}path[@class='bar']"))
            middle = ((ends[0][0] + ends[1][0]) // 2, ends[0][1])
            above[g.get("id")] = below[g.get("id")] = middle
    arrows = [area(g) for g in picture.by_class("arrow")]
    upwards = {((left + right) // 2, (top + bottom) // 2) for left, top, right, bottom in arrows}
    net = _Net(picture.wires, set(below.values()), upwards)
    found: dict[int, set[str]] = {}
    for name, place in above.items():
        found.setdefault(net.at(place, upper=True), set()).add(name)
    origins = [(name, net.at(place, upper=False)) for name, place in below.items()]
    entered = {place: name for name, place in above.items()}
    direct: set[tuple[str, str]] = set()
    for g in picture.by_class("jump") + picture.by_class("reference"):
        left, top, right, _ = area(g)
        link = next((a.get("href").removeprefix("#") for a in g.iter(f"{SVG}a")), "")
        if not link:  # how many more there are
            continue
        if g.get("class") == "jump":
            found.setdefault(net.at(((left + right) // 2, top + 4), upper=True), set()).add(link)
        elif g.findtext(f"{SVG}title").startswith("From"):
            # the arrow leads down along its wire only, not along a bar from which this wire comes
            ends = [(x2, y2) for x1, y1, x2, y2 in net.pieces if x1 == x2 and _on((right, top + 7), (x1, y1, x2, y2))]
            steps = [entered[end] for end in ends if end in entered]
            direct |= {(link, step) for step in steps}
            origins += [(link, net.below_bar(end)) for end in ends if end not in entered]
        else:
            found.setdefault(net.at((right, top + 7), upper=True), set()).add(link)
    reached = {each for _, start in origins for each in net.down(start)}
    for g in picture.by_class("jump"):
        left, top, right, _ = area(g)
        assert net.at(((left + right) // 2, top + 4), upper=True) in reached, g.findtext(f"{SVG}title")
    return direct | {(name, end) for name, start in origins for each in net.down(start) for end in found.get(each, ())}


class _Net:
    """Wires that lead down and along bars, cut at transitions and where they meet, and the double bars between them.

    Those with a point in `upwards` lead up.
    """

    def __init__(self, wires: list[Segment], cuts: set[Point], upwards: set[Point]) -> None:
        self.pieces: list[Segment] = []
        bars = [wire for wire in wires if wire[1] == wire[3]]
        for x1, y1, x2, y2 in wires:
            if x1 != x2:
                self.pieces.append((x1, y1, x2, y2))
                continue
            top, bottom = sorted((y1, y2))
            inner = {y for x, y in cuts if x == x1 and top < y < bottom}
            inner |= {bar[1] for bar in bars if top < bar[1] < bottom and _on((x1, bar[1]), bar)}
            for a, b in pairwise([top, *sorted(inner), bottom]):
                leads_up = any(x == x1 and top < y < bottom for x, y in upwards)
                self.pieces.append((x1, b, x1, a) if leads_up else (x1, a, x1, b))
        self.cuts = cuts
        self.lines = {(x1, y1, x2): i for i, (x1, y1, x2, y2) in enumerate(self.pieces) if y1 == y2}
        self.lower: dict[int, set[int]] = {
            i: {j for j, other in enumerate(self.pieces) if i != j and self._leads(one, other)}
            for i, one in enumerate(self.pieces)
        }
        for (x1, y, x2), i in self.lines.items():
            if (x1, y + 4, x2) in self.lines:
                self.lower[i].add(self.lines[x1, y + 4, x2])

    def _leads(self, one: Segment, other: Segment) -> bool:
        """True if what comes down along one wire, or along a bar, goes on along another."""
        ends = [(a, b) for a, b in ((one, other), (other, one))]
        touching = {
            point
            for part, whole in ends
            for point in (part[:2], part[2:])
            if _on(point, whole) and point not in self.cuts
        }
        below = (one[1] == one[3] or point == one[2:] for point in touching)
        above = (other[1] == other[3] or point == other[:2] for point in touching)
        return any(leaves and enters for leaves, enters in zip(below, above, strict=True))

    def at(self, place: Point, *, upper: bool) -> int:
        """The wires at a place; those that end there from above, or that begin there, where it is a symbol."""
        for i, (x1, y1, x2, y2) in enumerate(self.pieces):
            if not _on(place, (x1, y1, x2, y2)) or (place in self.cuts and place != ((x2, y2) if upper else (x1, y1))):
                continue
            return i
        return -1 if upper else -2

    def below_bar(self, place: Point) -> int:
        """The wires below the double bar on whose upper line a place is."""
        x, y = place
        return next(i for (x1, level, x2), i in self.lines.items() if level == y + 4 and x1 <= x <= x2)

    def down(self, start: int) -> set[int]:
        """These wires and all that they lead to through double bars."""
        found, pending = {start}, [start]
        while pending:
            new = self.lower.get(pending.pop(), set()) - found
            found |= new
            pending += new
        return found


def _on(point: Point, wire: Segment) -> bool:
    left, right = sorted((wire[0], wire[2]))
    top, bottom = sorted((wire[1], wire[3]))
    return left <= point[0] <= right and top <= point[1] <= bottom
