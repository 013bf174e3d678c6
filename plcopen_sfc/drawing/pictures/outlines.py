"""Outlines of columns: how far they reach to one side of their axis, from the top to the bottom.

Columns are set beside each other as close as their outlines allow, not their bounding boxes: a short branch needs no
room beside the lower part of a long one.
"""

from __future__ import annotations

from collections.abc import Iterable

Outline = list[tuple[int, int]]
"""Bands from the top down, each as the level of its lower edge and how far it reaches."""

_MOST_BANDS = 96
"""Outlines are kept this short, so that deeply nested charts are placed in linear time."""


def shifted(outline: Outline, down: int, aside: int) -> Outline:
    """Return an outline moved down and to its side."""
    return [(level + down, reach + aside) for level, reach in outline]


def over(one: Outline, other: Outline) -> Outline:
    """Return the outline around two things with the same axis and top."""
    found: Outline = []
    i = j = 0
    while i < len(one) and j < len(other):
        (upper, near), (lower, far) = one[i], other[j]
        # without min and max: these steps are a fifth of the time of a picture
        found.append((upper if upper < lower else lower, near if near > far else far))
        i += upper <= lower
        j += lower <= upper
    return _short([*found, *one[i:], *other[j:]])


def stacked(outlines: Iterable[tuple[Outline, int]]) -> Outline:
    """Return the outline of things below each other, each given with its height."""
    found: Outline = []
    top = 0
    for outline, height in outlines:
        found += shifted(outline, top, 0)
        top += height
        if outline and outline[-1][0] < height:
            found.append((top, outline[-1][1]))
    return _short(found)


def distance(right: Outline, left: Outline) -> int:
    """Return how far apart two axes have to be at least, for the right side of one thing and the left of the next."""
    nearest = 0
    i = j = 0
    while i < len(right) and j < len(left):
        (upper, near), (lower, far) = right[i], left[j]
        nearest = max(nearest, near + far)
        i += upper <= lower
        j += lower <= upper
    return nearest


def reach(outline: Outline) -> int:
    """Return how far an outline reaches at all."""
    return max((each for _, each in outline), default=0)


def _short(outline: Outline) -> Outline:
    while len(outline) > _MOST_BANDS:
        pairs = zip(outline[::2], outline[1::2], strict=False)
        rest = [outline[-1]] if len(outline) % 2 else []
        outline = [(lower, one if one > other else other) for (_, one), (lower, other) in pairs] + rest
    return outline
