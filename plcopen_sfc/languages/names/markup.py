"""Edits of program text that a file holds with markup."""

from __future__ import annotations

import html
import re
from collections.abc import Iterable

from plcopen_sfc.languages.edits import Edit, apply_edits

_MARKUP = re.compile(
    r"<!\[CDATA\[(?P<raw>.*?)\]\]>|<!--.*?-->|<[^>]*>|(?P<reference>&[^;]*;)|(?P<plain>[^<&])", re.DOTALL
)


def edit_markup(markup: str, text: str, edits: Iterable[Edit]) -> str | None:
    """`markup` with the edits of `text`, which is what a person reads of it; None if it is not.

    Blanks at both ends do not count. An edit that reaches over a tag goes to what stands before it.
    """
    characters: list[str] = []
    places: list[tuple[int, int]] = []
    for found in _MARKUP.finditer(markup):
        if found["raw"] is not None:
            characters += found["raw"]
            places += [(i, i + 1) for i in range(*found.span("raw"))]
        elif found["reference"] is not None or found["plain"] is not None:
            character = html.unescape(found.group())
            characters += character
            places += [found.span()] * len(character)
    shown = "".join(characters)
    if shown.strip() != text.strip():
        return None
    shift = len(shown) - len(shown.lstrip()) - (len(text) - len(text.lstrip()))
    moved = [Edit(places[start + shift][0], places[end + shift - 1][1], new) for start, end, new in edits]
    return apply_edits(markup, moved)
