"""Findings that somebody has looked at and lets be: ``plcopen-sfc: ignore STR09`` in a comment."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from plcopen_sfc.analysis.checks.checked_chart import CheckedChart, FindingPlace
from plcopen_sfc.analysis.checks.rule import Finding, Rule
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.model.base import Element
from plcopen_sfc.model.network import CommentBox
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.model.text import MarkupText, MultilingualText, Text

_MARK = re.compile(r"\bplcopen-sfc:\s*ignore\b[ \t]*([^\r\n]*)", re.IGNORECASE)
_CODES = re.compile(r"[ \t]*([A-Za-z]{2,4}\d{0,2})\b[ \t]*,?")


def suppressed(place: FindingPlace, code: str) -> bool:
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


def _places(chart: CheckedChart) -> Iterator[FindingPlace]:
    for sheet in chart.sheets:
        yield sheet.place
        for step in sheet.steps:
            yield sheet.at(step)
        for transition in sheet.transitions:
            yield sheet.at(transition)
        for step, association in sheet.actions():
            yield sheet.at(step, association)


def rule_on(codes: Iterable[str]) -> Rule:
    """The rule that comments name codes, of these."""
    known = tuple(codes)

    def check(chart: CheckedChart) -> Iterator[Finding]:
        for place in _places(chart):
            element = place.elements[0]
            listed = list(codes_in(element))
            for code in listed:
                if not any(each.startswith(code) for each in known):
                    yield Finding(place, f"the comment lets {code} be, and there is no such rule")
            if marks_in(element) and not listed:
                yield Finding(place, "the comment lets nothing be: it names no rule")

    return Rule(
        code="CHK01",
        title="Comments that let findings be name rules",
        why="A misspelt code lets nothing be.",
        hint="Write plcopen-sfc: ignore and the codes behind it, with commas between.",
        example="the comment plcopen-sfc: ignore STR99",
        check=check,
        severity=Severity.WARNING,
    )
