"""Changes of a text: what is at some places is replaced, all the rest stays as it is."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import NamedTuple


class Edit(NamedTuple):
    """Replaces what is from `start` to `end` (not included)."""

    start: int
    end: int
    text: str


def apply_edits(text: str, edits: Iterable[Edit], start: int = 0, end: int | None = None) -> str:
    """Return `text[start:end]` with the edits made, which may be given in any order.

    Insertions at one place keep their order and come before replacements. Raises `ValueError` where edits overlap.
    """
    parts: list[str] = []
    for edit in sorted(edits, key=lambda edit: (edit.start, edit.end)):
        if edit.start < start:
            raise ValueError(f"edits overlap at position {edit.start}")
        parts += (text[start : edit.start], edit.text)
        start = edit.end
    return "".join(parts) + text[start:end]


def without(text: str, spans: Iterable[tuple[int, int]]) -> str:
    """`text` without what is at `spans`; all the rest stays in its line, and words stay apart."""
    return apply_edits(text, [Edit(start, end, _left_of(text, start, end)) for start, end in spans])


def _left_of(text: str, start: int, end: int) -> str:
    line_ends = "".join(_LINE_END.findall(text, start, end))
    between_words = text[start - 1 : start].strip() and text[end : end + 1].strip()
    return line_ends or (" " if between_words else "")


_LINE_END = re.compile(r"\r\n|\r|\n")
