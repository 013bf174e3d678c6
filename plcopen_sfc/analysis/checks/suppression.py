"""Findings that somebody has looked at and lets be: ``plcopen-sfc: ignore STR09`` in a comment."""

from __future__ import annotations

import re
from collections.abc import Iterator

from plcopen_sfc.analysis.checks.charts import Place
from plcopen_sfc.model.base import Element
from plcopen_sfc.model.network import CommentBox
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.model.text import MarkupText, MultilingualText, Text

_MARK = re.compile(r"\bplcopen-sfc:\s*ignore\b[ \t]*([^\r\n]*)", re.IGNORECASE)
_CODES = re.compile(r"[ \t]*([A-Za-z]{2,4}\d{0,2})\b[ \t]*,?")


def suppressed(place: Place, code: str) -> bool:
    """Whether a comment at `place`, or at something that it stands in, lets findings of this code be."""
    return any(code.startswith(listed) for element in place.elements for listed in codes_in(element))


def marks_in(element: Element) -> bool:
    """Whether a comment of an object wants to let something be."""
    return any(_MARK.search(text) for text in comments_of(element))


def codes_in(element: Element) -> Iterator[str]:
    """The codes, or starts of codes, that the comments of an object list, in capitals."""
    for text in comments_of(element):
        for mark in _MARK.finditer(text):
            position = 0
            rest = mark[1]
            while (code := _CODES.match(rest, position)) is not None:
                yield code[1].upper()
                position = code.end()


def comments_of(element: Element) -> Iterator[str]:
    """The comments of an object as plain text; of a chart also those that stand in its drawing."""
    yield from _plain(element.comment)
    if isinstance(element, SfcNetwork):
        for node in element.logic:
            if isinstance(node, CommentBox):
                yield from _plain(node.content)


def _plain(text: Text | None) -> Iterator[str]:
    if isinstance(text, MultilingualText):
        yield from text.texts.values()
    elif isinstance(text, MarkupText):
        yield text.text
    elif text is not None:
        yield text
