"""Changes of a text: what stands at some places is replaced, all the rest stays as it is."""

from __future__ import annotations

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
