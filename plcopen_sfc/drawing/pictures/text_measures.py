"""Widths of texts, estimated without a font, and texts wrapped into lines of a width.

The widths are those of Arial, which Helvetica and Liberation Sans share. A picture names these fonts; with another
font a text may be a little wider than its place, so places have some room to spare.
"""

from __future__ import annotations

import re
import unicodedata
from functools import lru_cache
from math import ceil

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
    944: "W",
    1015: "@",
}
_WIDTHS = {letter: width for width, letters in _GROUPS.items() for letter in letters}
_WIDE = 1000
_OTHER = 700
_BOLD = 1.07
_ROOM = 1.03
"""Fonts that stand in for Arial are this much wider at most; those of screens round each letter."""

_JOINING = re.compile(r"\s+(?=(?:AND|OR|XOR|AND_THEN|OR_ELSE|&)(?:\s|$))", re.IGNORECASE)
"""Blanks before what joins the operands of a long condition."""
_OPERATORS = frozenset({"AND", "OR", "XOR", "AND_THEN", "OR_ELSE", "NOT", "&", "=", "<>", "<", ">", "<=", ">=", ":="})
_PARTS = re.compile(r".+?(?:[._,()\[\]]|(?<=[a-z])(?=[A-Z])|$)")
"""Parts of a long name, where it may be broken: ``Check_``, ``Stamp_``, ``Automatic``, ``Execute``."""


@lru_cache(maxsize=1024)
def _letter(letter: str) -> int:
    if letter in _WIDTHS:
        return _WIDTHS[letter]
    if unicodedata.combining(letter):
        return 0
    if unicodedata.east_asian_width(letter) in "WF":
        return _WIDE
    base = unicodedata.normalize("NFD", letter)[0]
    return _WIDTHS.get(base, _OTHER)


@lru_cache(maxsize=8192)
def text_width(text: str, size: int, *, bold: bool = False) -> int:
    """Return the width of one line of text, in the unit of its font `size`."""
    return ceil(sum(map(_letter, text)) * size * (_BOLD if bold else 1) * _ROOM / 1000)


def widest(lines: list[str], size: int, *, bold: bool = False) -> int:
    """Return the width of the widest of `lines`; 0 without any."""
    return max((text_width(line, size, bold=bold) for line in lines), default=0)


def wrap(text: str, size: int, width: int, *, bold: bool = False) -> list[str]:
    """Return the lines of `text`, none of them wider than `width` where a letter fits.

    An operator begins a line and does not end it: so a long condition reads as a column of operands. Line ends of the
    text stay, and so does its indentation.
    """
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
        while text_width(longer, size, bold=bold) > width and len(longer) > 1:
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
    fitting = 1
    while fitting < len(word) and text_width(word[: fitting + 1], size, bold=bold) <= width:
        fitting += 1
    end = 0
    for part in _PARTS.finditer(word):
        if part.end() > fitting:
            break
        end = part.end()
    space = word.rfind(" ", 0, fitting) + 1
    return word[: max(end, space)] if max(end, space) > fitting // 2 else word[:fitting]
