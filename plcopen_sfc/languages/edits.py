"""Changes of a text: what stands at some places is replaced, all the rest stays as it is."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import NamedTuple


class Edit(NamedTuple):
    """Replaces what stands from `start` to `end` (not included)."""

    start: int
    end: int
    text: str


def apply_edits(text: str, edits: Iterable[Edit]) -> str:
    """`text` with the edits made. They may stand in any order but must not overlap (`ValueError`)."""
    pieces: list[str] = []
    position = 0
    for start, end, new in sorted(edits):
        if start < position:
            raise ValueError(f"edits overlap at {start}")
        pieces += text[position:start], new
        position = end
    return "".join(pieces) + text[position:]


def without(text: str, spans: Iterable[tuple[int, int]]) -> str:
    """`text` without what stands at `spans`; all the rest stays in its line, and words stay apart."""
    return apply_edits(text, [Edit(start, end, _left_of(text, start, end)) for start, end in spans])


def _left_of(text: str, start: int, end: int) -> str:
    line_ends = "".join(_LINE_END.findall(text, start, end))
    between_words = text[start - 1 : start].strip() and text[end : end + 1].strip()
    return line_ends or (" " if between_words else "")


_LINE_END = re.compile(r"\r\n|\r|\n")
