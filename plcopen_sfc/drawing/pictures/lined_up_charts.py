"""Two charts beside each other, with the steps that are the same at one height.

Wires above steps are made longer, and nothing else: so what holds for one picture (nothing overlaps, no line crosses
another) holds for both. A step moves all that is below it in its branch; so a step only needs the difference that the
step above it does not have already. Where both charts have the same branches, one round does; else some more.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence

from plcopen_sfc.drawing.pictures.chart_arrangement import Arrangement, StepLevel

_ROUNDS = 6
_MOST_STEPS = 400
"""Charts with more steps get one round: each costs as much as a layout of both."""
_LONGEST = 2
"""Pictures do not become longer than so many times the longer one; else the steps stay where they are."""


def lined_up(one: Arrangement, other: Arrangement, same: Sequence[tuple[int, int]]) -> tuple[Arrangement, Arrangement]:
    """Return both charts with the steps that are the `same` at one height, as far as their order is the same."""
    pairs = _in_order(one.levels, other.levels, same)
    back = {b: a for a, b in pairs.items()}
    rooms: tuple[dict[int, int], dict[int, int]] = ({}, {})
    as_they_are, limit = (one, other), _LONGEST * max(one.height, other.height)
    for _ in range(_ROUNDS if len(pairs) <= _MOST_STEPS else 1):
        levels, others = one.levels, other.levels
        missing = _missing(levels, pairs, others), _missing(others, back, levels)
        if not any(missing):
            break
        for room, more in zip(rooms, missing, strict=True):
            for step, length in more.items():
                room[step] = room.get(step, 0) + length
        for a, b in pairs.items():
            common = min(rooms[0].get(a, 0), rooms[1].get(b, 0))
            if common:
                rooms[0][a] -= common
                rooms[1][b] -= common
        one, other = (each.with_room(room) for each, room in zip((one, other), rooms, strict=True))
        if max(one.height, other.height) > limit:
            return as_they_are
    return one, other


def _in_order(
    one: dict[int, StepLevel], other: dict[int, StepLevel], same: Sequence[tuple[int, int]]
) -> dict[int, int]:
    """Return the most of the pairs of steps that are below each other in the same order in both charts."""
    pairs = sorted((one[a].top, other[b].top, a, b) for a, b in same if a in one and b in other)
    ends: list[int] = []
    chosen: list[int] = []
    before: list[int | None] = []
    for number, (_, level, _, _) in enumerate(pairs):
        at = bisect_right(ends, level)
        before.append(chosen[at - 1] if at else None)
        ends[at : at + 1], chosen[at : at + 1] = [level], [number]
    found: dict[int, int] = {}
    at_last: int | None = chosen[-1] if chosen else None
    while at_last is not None:
        _, _, a, b = pairs[at_last]
        found[a] = b
        at_last = before[at_last]
    return found


def _missing(levels: dict[int, StepLevel], pairs: dict[int, int], others: dict[int, StepLevel]) -> dict[int, int]:
    """Return how far steps are above those of the other chart, but for what the step above them has to move already."""
    apart = {step: others[other].top - levels[step].top for step, other in pairs.items()}
    found: dict[int, int] = {}
    for step, distance in apart.items():
        above = levels[step].before
        while above is not None and above not in apart:
            above = levels[above].before
        length = distance - (apart[above] if above is not None else 0)
        if length > 0:
            found[step] = length
    return found
