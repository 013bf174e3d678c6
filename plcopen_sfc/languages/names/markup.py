"""Edits of program text that a file holds with markup, or as the tokens of TIA Portal."""

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


def edit_tokens(markup: str, name: str, new: list[str | None]) -> str | None:
    """The ``StructuredText`` of TIA Portal with another name at some of the places that have `name`.

    `new` has an item for each place of the text that has it, in their order: None where it stays. Gives None if the
    tokens do not have as many.
    """
    places = [found for found in _NAME.finditer(markup) if html.unescape(found[1]).casefold() == name.casefold()]
    if len(places) != len(new):
        return None
    edits = [
        Edit(*place.span(1), html.escape(text)) for place, text in zip(places, new, strict=True) if text is not None
    ]
    return apply_edits(markup, edits)


_NAME = re.compile(r'<(?!BooleanAttribute)\w+\b[^<>]*?\bName="([^"]*)"')


def is_tokens(markup: str) -> bool:
    """Whether a markup is the ``StructuredText`` of TIA Portal."""
    return markup.lstrip().startswith("<StructuredText")
