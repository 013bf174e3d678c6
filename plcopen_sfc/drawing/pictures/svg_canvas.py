"""SVG: shapes and texts collected layer by layer, and the themes that colour them.

What comes from a file is escaped here and nowhere else. The result is plain ASCII: every other character is a character
reference, so the picture survives any encoding, and characters that XML forbids become U+FFFD.

Widths of texts, estimated without a font, and texts wrapped into lines of a width.

The widths are those of Arial, which Helvetica and Liberation Sans share. A picture names these fonts; with another font
a text may be a little wider than its place, so places have some room to spare.
"""

from __future__ import annotations

import re
import unicodedata
from bisect import bisect_left
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from enum import StrEnum
from functools import lru_cache
from math import ceil
from types import MappingProxyType

_GROUPS = {
    191: "'",
    222: "ijl",
    260: "|",
    278: " !,./:;I[\\]ft",
    333: "()-`r",
    334: "{}",
    355: '"',
    389: "*",
    469: "^",
    500: "Jcksvxyz",
    556: "#$0123456789?L_abdeghnopqu",
    584: "+<=>~",
    611: "FTZ",
    667: "&ABEKPSVXY",
    722: "CDHNRUw",
    778: "GOQ",
    833: "Mm",
    889: "%",
    944: "W\u00e6\u0153",
    1000: "\u2026\u2014\u2192\u00c6\u0152",
    1015: "@",
}
_BOLD_GROUPS = {
    238: "'",
    278: "ijl",
    280: "|",
    333: "!:;[]ft",
    389: "r{}",
    474: '"',
    556: "Jcksvxy",
    584: "^",
    611: "?Lbdghnopqu",
    722: "&ABK",
    778: "w",
    889: "m",
    975: "@",
}
"""The letters that are wider in bold type, or narrower."""
_WIDTHS = {letter: width for width, letters in _GROUPS.items() for letter in letters}
_BOLD_WIDTHS = _WIDTHS | {letter: width for width, letters in _BOLD_GROUPS.items() for letter in letters}
_WIDE = 1000
_OTHER = 833
_ROOM = 1.03
"""Fonts that stand in for Arial are this much wider at most."""

_JOINING = re.compile(r"\s+(?=(?:AND|OR|XOR|AND_THEN|OR_ELSE|[&*\u00b7+])(?:\s|$))", re.IGNORECASE)
"""Blanks before what joins the operands of a long condition."""
_OPERATORS = frozenset(
    {"AND", "OR", "XOR", "AND_THEN", "OR_ELSE", "NOT", "&", "*", "\u00b7", "+", "=", "<>", "<", ">", "<=", ">=", ":="}
)
_PARTS = re.compile(r".+?(?:[._,()\[\]]|(?<=[a-z])(?=[A-Z])|$)")
"""Parts of a long name, where it may be broken: ``Check_``, ``Stamp_``, ``Automatic``, ``Execute``."""


class _LetterWidths(dict[str, float]):
    """Widths of letters in the unit of their font size, found as they are asked for.

    Screens with whole pixels round each letter: an asterisk of 4.7 pixels is 5 wide, and lines of them are common.
    """

    def __init__(self, size: int, *, bold: bool) -> None:
        super().__init__()
        self._size = size
        self._known = _BOLD_WIDTHS if bold else _WIDTHS

    def __missing__(self, letter: str) -> float:
        exact = self._thousandths(letter) * self._size / 1000
        width = self[letter] = max(exact * _ROOM, int(exact + 0.5))
        return width

    def _thousandths(self, letter: str) -> int:
        if letter in self._known:
            return self._known[letter]
        if unicodedata.combining(letter):
            return 0
        if unicodedata.east_asian_width(letter) in "WF":
            return _WIDE
        base = unicodedata.normalize("NFD", letter)[0]
        return self._known.get(base, _OTHER)


@lru_cache
def _letter_widths(size: int, bold: bool) -> _LetterWidths:
    return _LetterWidths(size, bold=bold)


@lru_cache(maxsize=8192)
def text_width(text: str, size: int, *, bold: bool = False) -> int:
    """Return the width of one line of text, in the unit of its font `size`."""
    return ceil(sum(map(_letter_widths(size, bold).__getitem__, text)))


def widest(lines: list[str], size: int, *, bold: bool = False) -> int:
    """Return the width of the widest of `lines`; 0 without any."""
    return max((text_width(line, size, bold=bold) for line in lines), default=0)


def wrap(text: str, size: int, width: int, *, bold: bool = False) -> list[str]:
    """Return the lines of `text`, none of them wider than `width` where a letter fits.

    An operator begins a line and does not end it: so a long condition reads as a column of operands. Line ends of the
    text stay, and so does its indentation.
    """
    if not text:
        return []
    lines: list[str] = []
    for line in text.expandtabs(4).splitlines():
        lines += _wrap_line(line.rstrip(), size, width, bold)
    while lines and not lines[-1]:
        lines.pop()
    while lines and not lines[0]:
        del lines[0]
    return lines


def _wrap_line(line: str, size: int, width: int, bold: bool) -> list[str]:
    if text_width(line, size, bold=bold) <= width:
        return [line]
    indent = line[: len(line) - len(line.lstrip())]
    lines: list[str] = []
    for operand in _JOINING.split(line.strip()):
        longer = f"{lines[-1]} {operand}" if lines else indent + operand
        if lines and text_width(longer, size, bold=bold) <= width:
            lines[-1] = longer
        else:
            lines += _wrap_words(operand, indent, size, width, bold)
    return lines


def _wrap_words(text: str, indent: str, size: int, width: int, bold: bool) -> list[str]:
    lines: list[str] = []
    current = ""
    for word in _units(text.split()):
        longer = f"{current} {word}" if current else indent + word
        if current and text_width(longer, size, bold=bold) > width:
            lines.append(current)
            longer = indent + word
        # more letters than units never fit; so the rest of an endless word is not measured at each of its lines
        while len(longer) > 1 and (len(longer) > width or text_width(longer, size, bold=bold) > width):
            head = _head(longer, size, width, bold)
            lines.append(head)
            longer = longer[len(head) :]
        current = longer
    return [*lines, current] if current else lines


def _units(words: list[str]) -> list[str]:
    """Return words with the operators before them."""
    units: list[str] = []
    for word in words:
        if units and units[-1].rsplit(" ", 1)[-1].lstrip("(").upper() in _OPERATORS:
            units[-1] += f" {word}"
        else:
            units.append(word)
    return units


def _head(word: str, size: int, width: int, bold: bool) -> str:
    """Return as much of a word as fits, up to a point, an underscore or the like if one is in its second half."""
    fitting = 1  # letters are counted on from word to word: a line of a thousand would be measured a thousand times
    widths = _letter_widths(size, bold)
    wide = widths[word[0]]
    while fitting < len(word):
        wide += widths[word[fitting]]
        if wide > width:
            break
        fitting += 1
    end = 0
    for part in _PARTS.finditer(word, 0, fitting + 1):  # of an endless word no more than is looked at
        if part.end() > fitting:
            break
        end = part.end()
    space = word.rfind(" ", 0, fitting) + 1
    return word[: max(end, space)] if max(end, space) > fitting // 2 else word[:fitting]


_FONTS = "Arial, Helvetica, 'Liberation Sans', sans-serif"
_FORBIDDEN = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_HARMLESS = re.compile(r"[\w .,:;()\[\]{}/*+=-]*", re.ASCII)
_ESCAPES = {"&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "'": "&#39;", "\n": "&#10;", "\r": "&#13;"}
"""No text has brackets or line ends of its own: each line of a picture begins with markup, see `picture_sheets`."""


class Theme(StrEnum):
    """Colours of a picture. PRINT is black on white, without any fill."""

    LIGHT = "light"
    DARK = "dark"
    PRINT = "print"


_COLOURS = {
    Theme.LIGHT: {
        "paper": "#ffffff",
        "ink": "#1c2733",
        "muted": "#5b6b7b",
        "step": "#eaf1f8",
        "initial": "#dcefe3",
        "cell": "#f3f5f7",
        "action": "#ffffff",
        "rule": "#8695a4",
        "link": "#0b5cad",
        "frame": "#a9b5c0",
        "warn": "#a4420b",
    },
    Theme.DARK: {
        "paper": "#15191e",
        "ink": "#dfe6ed",
        "muted": "#98a6b4",
        "step": "#223041",
        "initial": "#1f3b2c",
        "cell": "#252c34",
        "action": "#1a2027",
        "rule": "#5d6b79",
        "link": "#79b8ff",
        "frame": "#48545f",
        "warn": "#f0a36b",
    },
    Theme.PRINT: {
        "paper": "#ffffff",
        "ink": "#000000",
        "muted": "#333333",
        "step": "#ffffff",
        "initial": "#ffffff",
        "cell": "#ffffff",
        "action": "#ffffff",
        "rule": "#000000",
        "link": "#000000",
        "frame": "#777777",
        "warn": "#000000",
    },
}
_RULES = {
    "text": f"font-family:{_FONTS};fill:{{ink}}",
    "a:hover text": "text-decoration:underline",
    "text a:hover": "text-decoration:underline",
    ".paper": "fill:{paper}",
    ".wire": "fill:none;stroke:{ink};stroke-width:1.5",
    ".thin": "fill:none;stroke:{rule};stroke-width:1",
    ".bar": "fill:none;stroke:{ink};stroke-width:3.5",
    ".head": "fill:{ink}",
    ".box": "fill:{step};stroke:{ink};stroke-width:1.5",
    ".initial>.box": "fill:{initial}",
    ".inner": "fill:none;stroke:{ink};stroke-width:1.2",
    ".row": "fill:{action};stroke:{rule};stroke-width:1",
    ".cell": "fill:{cell};stroke:{rule};stroke-width:1",
    ".frame": "fill:none;stroke:{frame};stroke-width:1.5;stroke-dasharray:7 4",
    ".mark": "fill:{action};stroke:{ink};stroke-width:1",
    ".excluded": "opacity:.45",
    ".name": "font-size:13px;font-weight:bold",
    ".star": "font-size:18px",
    ".plain": "font-size:12px",
    ".small": "font-size:11px",
    ".quiet": "font-size:11px;fill:{muted}",
    ".remark": "font-size:11px;fill:{muted};font-style:italic",
    ".link": "font-size:12px;fill:{link}",
    ".back": "font-size:11px;fill:{link}",
    ".warn": "font-size:12px;fill:{warn};font-style:italic",
}


DOUBLE = 4
"""The distance between the two lines of the bar of simultaneous branches."""
_PROGRAM = frozenset({"plain", "small"})
"""Kinds of texts that are program text."""
_WORD = re.compile(r"\w+")
_BLANKS = re.compile("^ +| {2,}")


def escape(text: str) -> str:
    """Return `text` as characters that mean themselves in XML, in content and in attributes."""
    if _HARMLESS.fullmatch(text):  # most texts, and pictures have many
        return text
    clean = _FORBIDDEN.sub("\ufffd", text)
    for letter, written in _ESCAPES.items():
        clean = clean.replace(letter, written)
    return clean if clean.isascii() else clean.encode("ascii", "xmlcharrefreplace").decode("ascii")


@lru_cache
def style_rules(theme: Theme, scope: str) -> str:
    """Return the style sheet of a theme for pictures inside of what the selector `scope` chooses."""
    colours = _COLOURS[theme]
    return "".join(f"{scope} {name}{{{rule.format_map(colours)}}}" for name, rule in _RULES.items())


class Canvas:
    """Shapes of a picture. Wires lie below the elements, so that an element covers what ends behind it.

    `marks` are further classes of elements, by their ids. `names` are the names in the texts of an element that are
    links, in lower case, with the ids that they lead to; by the id of the element. Under the empty name is where
    the name of the element itself leads to.
    """

    def __init__(
        self,
        marks: Mapping[str, str] = MappingProxyType({}),
        names: Mapping[str, Mapping[str, str]] = MappingProxyType({}),
    ) -> None:
        self._marks, self._names = marks, names
        self._linked: Mapping[str, str] = {}
        self._wires: list[str] = []
        self._spans: dict[tuple[str, int], list[tuple[int, int]]] = {}
        self._paths: set[str] = set()
        self._elements: list[str] = []

    def wire(self, *points: tuple[int, int], kind: str = "wire") -> None:
        """Draw a wire in right angles, or straight; a line of another `kind` too.

        Of a straight one only what no other covers is drawn: twice, it would look thicker.
        """
        if kind == "wire" and len(points) == 2:
            (x, y), (end, below) = points
            if x == end:
                pieces = [((x, low), (x, high)) for low, high in self._uncovered(("x", x), y, below)]
            else:
                pieces = [((low, y), (high, y)) for low, high in self._uncovered(("y", y), x, end)]
            self._wires += [f'<path class="wire" d="M{a} {b}L{c} {d}"/>' for (a, b), (c, d) in pieces]
            return
        path = "L".join([f"{x} {y}" for x, y in points])
        drawn = f'<path class="{kind}" d="M{path}"/>'
        if drawn not in self._paths:
            self._paths.add(drawn)
            self._wires.append(drawn)

    def _uncovered(self, line: tuple[str, int], one: int, other: int) -> list[tuple[int, int]]:
        """Return the parts between two places on a line that no wire is on yet, and take them."""
        low, high = (one, other) if one <= other else (other, one)
        spans = self._spans.setdefault(line, [])  # in order, none on another
        first = bisect_left(spans, (low, low))
        first -= first > 0 and spans[first - 1][1] > low
        last, at, found = first, low, []
        while last < len(spans) and spans[last][0] < high:
            if spans[last][0] > at:
                found.append((at, spans[last][0]))
            at = max(at, spans[last][1])
            last += 1
        if at < high:
            found.append((at, high))
        covered = spans[first:last]
        spans[first:last] = [(min(low, *(each[0] for each in covered)), max(high, at))] if covered else [(low, high)]
        return found

    def bar(self, left: int, right: int, y: int, *, parallel: bool) -> None:
        """Draw the bar of a selection, or the double one of simultaneous branches, which goes down by `DOUBLE`."""
        for level in (y, y + DOUBLE) if parallel else (y,):
            self.wire((left, level), (right, level))

    @contextmanager
    def element(self, kind: str, identifier: str, title: str, area: tuple[int, int, int, int]) -> Iterator[None]:
        """Group what is drawn as one element.

        `title` is what screen readers and tooltips have, `area` its left, top, width and height, which the picture
        states as ``data-area``.
        """
        place = " ".join(map(str, area))
        label = f' id="{escape(identifier)}"' if identifier else ""
        if identifier in self._marks:
            kind = f"{kind} {self._marks[identifier]}"
        self._elements.append(f'<g{label} class="{escape(kind)}" data-area="{place}"><title>{escape(title)}</title>')
        around = self._linked
        self._linked = self._names.get(identifier, around)  # rows of a table are inside of their step
        yield
        self._linked = around
        self._elements.append("</g>")

    def star(self, x: int, y: int) -> None:
        """Draw the asterisk of IEC 61131-3 beside the bar of a selection: the branches are tried from left to right."""
        self._wires.append(f'<text class="star" x="{x}" y="{y}">*</text>')

    def box(self, kind: str, x: int, y: int, width: int, height: int) -> None:
        """Draw a rectangle."""
        self._elements.append(f'<rect class="{kind}" x="{x}" y="{y}" width="{width}" height="{height}"/>')

    def line(self, kind: str, *points: tuple[int, int], closed: bool = False) -> None:
        """Draw a line that belongs to an element; `closed`: an area."""
        path = "L".join([f"{x} {y}" for x, y in points])
        self._elements.append(f'<path class="{kind}" d="M{path}{"Z" if closed else ""}"/>')

    def circle(self, kind: str, x: int, y: int, radius: int) -> None:
        """Draw a circle around a point."""
        self._elements.append(f'<circle class="{kind}" cx="{x}" cy="{y}" r="{radius}"/>')

    def text(
        self, kind: str, x: int, y: int, text: str, *, anchor: str = "start", link: str = "", named: bool = False
    ) -> None:
        """Write one line of text with its base line at `y`; `link` is the id of an element of the same picture.

        `named`: it is the name of its element.
        """
        link = self._linked.get("", link) if named else link
        placed = "" if anchor == "start" else f' text-anchor="{anchor}"'
        # leading and repeated blanks, which XML readers join, are kept as no-break spaces
        blank = text.startswith(" ") or "  " in text
        shown = _BLANKS.sub(lambda blanks: "\u00a0" * len(blanks[0]), text) if blank else text
        content = self._with_links(shown) if self._linked and kind in _PROGRAM and not link else escape(shown)
        written = f'<text class="{kind}" x="{x}" y="{y}"{placed}>{content}</text>'
        self._elements.append(f'<a href="#{escape(link)}">{written}</a>' if link else written)

    def _with_links(self, text: str) -> str:
        """Return a text in which the names that are known are links."""
        parts, done = [], 0
        for word in _WORD.finditer(text):
            target = self._linked.get(word[0].casefold())
            if target is not None:
                parts += [escape(text[done : word.start()]), f'<a href="#{escape(target)}">{escape(word[0])}</a>']
                done = word.end()
        return "".join([*parts, escape(text[done:])])

    def lines(
        self,
        kind: str,
        x: int,
        y: int,
        lines: Sequence[str],
        pitch: int,
        *,
        anchor: str = "start",
        link: str = "",
        named: bool = False,
    ) -> None:
        """Write lines of text below each other, the first with its base line at `y`; the rest as in `text`."""
        for number, line in enumerate(lines):
            if line:  # blank lines of program text
                self.text(kind, x, y + number * pitch, line, anchor=anchor, link=link, named=named)

    def document(self, width: int, height: int, theme: Theme | None, title: str, description: str) -> str:
        """Return the whole picture as an SVG document of `width` and `height` pixels.

        Without a `theme` it is a part of a page, whose style sheet has `style_rules` for ``.sfc-picture``.
        """
        scope = f"sfc-{theme}" if theme is not None else "sfc-picture"
        head = (
            f'<svg xmlns="http://www.w3.org/2000/svg" class="{scope}" role="graphics-document" '
            f'width="{width}" height="{height}" viewBox="0 0 {width} {height}">'
        )
        parts = [
            head,
            f"<title>{escape(title)}</title><desc>{escape(description)}</desc>",
            *([f"<style>{style_rules(theme, f'.{scope}')}</style>"] if theme is not None else ()),
            f'<rect class="paper" width="{width}" height="{height}"/>',
            *self._wires,
            *self._elements,
            "</svg>",
        ]
        return "\n".join(parts) + "\n"
