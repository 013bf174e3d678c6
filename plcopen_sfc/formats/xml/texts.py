"""Changing text in place: inside the CDATA section that it stands in, with the references that its author wrote."""

from __future__ import annotations

from typing import TYPE_CHECKING

from plcopen_sfc.formats.xml.escaping import Habits, RawText, escape_attribute, escape_text
from plcopen_sfc.formats.xml.textdiff import Change, apply, changes

if TYPE_CHECKING:
    from collections.abc import Iterator

    from plcopen_sfc.formats.xml.fragments import Handwriting
    from plcopen_sfc.formats.xml.tokens import Attribute, Segment

__all__ = ["attribute_changes", "text_changes", "with_source_blanks"]


def attribute_changes(writing: Handwriting, attribute: Attribute, value: str) -> Iterator[Change]:
    """Edits of the source that give an attribute another value."""
    text = writing.tree.text
    start = attribute.value_start
    raw = RawText(text[start : attribute.value_end], attribute=True)
    habits = Habits(raw.raw, newline=writing.newline)
    quote = text[attribute.value_end]
    for change in changes(raw.value, value):
        yield Change(
            start + raw.raw_position(change.start),
            start + raw.raw_position(change.end),
            escape_attribute(change.text, quote, habits),
        )


def with_source_blanks(current: str, old: str, new: str) -> str:
    """`new` with the blanks that the source has around the text, if the writer does not keep them.

    `current` is the text in the source, `old` what the writer made of it: a difference in the blanks at both ends is
    not part of the edit.
    """
    if current == old or current.strip() != old.strip() or not old.strip():
        return new
    return current[: len(current) - len(current.lstrip())] + new.strip() + current[len(current.rstrip()) :]


def text_changes(writing: Handwriting, segments: list[Segment], current: str, new: str) -> Iterator[Change]:
    """Edits of the source that turn the text `current`, which `segments` hold together, into `new`."""
    waiting = changes(current, new)
    begin = 0
    for index, segment in enumerate(segments):
        raw = writing.tree.raw(segment)
        end = begin + len(raw.value)
        last = index == len(segments) - 1
        mine: list[Change] = []
        rest: list[Change] = []
        for change in waiting:
            # An insertion between two segments goes to the first of them, unless the second is the CDATA section.
            between = change.start == end and not last
            if change.start > end or (between and (change.end > end or segments[index + 1].cdata > segment.cdata)):
                rest.append(change)
                continue
            mine.append(Change(change.start - begin, min(change.end, end) - begin, change.text))
            if change.end > end:
                rest.append(Change(end, change.end, ""))
        waiting = rest
        begin = end
        if mine:
            yield from _segment_changes(writing, segment, raw, mine)


def _segment_changes(writing: Handwriting, segment: Segment, raw: RawText, mine: list[Change]) -> Iterator[Change]:
    value = apply(raw.value, mine)
    newline = writing.newline
    if "\n" in raw.value:
        newline = "\r\n" if "\r\n" in raw.raw else "\n"
    if segment.cdata:
        habits = Habits("", newline=newline)
        if not value:
            yield Change(segment.outer_start, segment.outer_end, "")
            return
        if "]]>" in value or "\r" in value or not writing.encodable(value):
            yield Change(segment.outer_start, segment.outer_end, escape_text(value, habits))
            return
    else:
        habits = Habits(raw.raw, newline=newline)
        if "]]>" in value and not habits.greater:
            # The three characters may come together from old and new ones; text must not contain them.
            yield Change(segment.start, segment.end, escape_text(value, habits))
            return
    for change in mine:
        text = change.text.replace("\n", newline) if segment.cdata else escape_text(change.text, habits)
        yield Change(segment.start + raw.raw_position(change.start), segment.start + raw.raw_position(change.end), text)
