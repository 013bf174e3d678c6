"""The smallest replacements that turn one text into another, line by line and inside lines."""

from __future__ import annotations

from difflib import SequenceMatcher
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["Change", "apply", "changes"]


class Change(NamedTuple):
    """`old[start:end]` becomes `text`."""

    start: int
    end: int
    text: str


_MAX_LINE_PAIRS = 4_000_000


def changes(old: str, new: str) -> list[Change]:
    """Replacements in rising order that do not overlap; lines that are the same on both sides stay untouched."""
    if old == new:
        return []
    whole = _trim(old, new, 0)
    first, second = whole.text.splitlines(keepends=True), old[whole.start : whole.end].splitlines(keepends=True)
    if len(first) < 2 or len(second) < 2:
        return [whole]
    # Compare whole lines: the trimmed block begins and ends inside lines.
    begin = old.rfind("\n", 0, whole.start) + 1
    finish = len(old) if (stop := old.find("\n", whole.end)) < 0 else stop + 1
    left = old[begin:finish].splitlines(keepends=True)
    right = new[begin : finish + len(new) - len(old)].splitlines(keepends=True)
    if len(left) * len(right) > _MAX_LINE_PAIRS:
        return [whole]
    found: list[Change] = []
    position, line = begin, 0
    for operation, i1, i2, j1, j2 in SequenceMatcher(None, left, right, autojunk=False).get_opcodes():
        position += sum(map(len, left[line:i1]))
        line = i1
        if operation == "equal":
            continue
        if i2 - i1 == j2 - j1:
            for before, after in zip(left[i1:i2], right[j1:j2], strict=True):
                if before != after:
                    found.append(_trim(before, after, position))
                position += len(before)
            line = i2
        else:
            found.append(_trim("".join(left[i1:i2]), "".join(right[j1:j2]), position))
    return found


def _trim(old: str, new: str, offset: int) -> Change:
    """One replacement without what both begin and end with."""
    limit = min(len(old), len(new))
    head = _common(old, new, limit)
    tail = 0
    while tail < limit - head and old[-1 - tail] == new[-1 - tail]:
        tail += 1
    return Change(offset + head, offset + len(old) - tail, new[head : len(new) - tail])


def _common(old: str, new: str, limit: int) -> int:
    """Length of the common beginning; by halves, because texts may have megabytes."""
    if old[:limit] == new[:limit]:
        return limit
    low, high = 0, limit
    while high - low > 1:
        middle = (low + high) // 2
        if old[low:middle] == new[low:middle]:
            low = middle
        else:
            high = middle
    return low


def apply(text: str, edits: Iterable[Change], start: int = 0, end: int | None = None) -> str:
    """`text[start:end]` with all edits made; insertions at one place keep their order and come before replacements.

    Raises `ValueError` where two edits overlap.
    """
    parts: list[str] = []
    for edit in sorted(edits, key=lambda edit: (edit.start, edit.end)):
        if edit.start < start:
            raise ValueError(f"two edits overlap at position {edit.start}")
        parts += (text[start : edit.start], edit.text)
        start = edit.end
    parts.append(text[start:end])
    return "".join(parts)
