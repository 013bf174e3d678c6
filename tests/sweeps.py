"""How much of a long sweep is run: a sample as a rule, all of it where ``PLCOPEN_SFC_FULL`` is set.

A sample is the same in every run. It has every file, or every kind of place, or every kind of damage: what is left out
are more of the same.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Hashable, Iterable, Sequence
from pathlib import Path
from typing import TypeVar

WHOLE = bool(os.environ.get("PLCOPEN_SFC_FULL"))

T = TypeVar("T")


def examples(count: int) -> int:
    """A sixth of the examples of a property: these are the same in every run of `.ci/run`."""
    return count if WHOLE else max(count // 6, 5)


def some_of(items: Sequence[T], every: int) -> Sequence[T]:
    """Every nth."""
    return items if WHOLE else items[::every]


def in_turn(items: Sequence[T], number: int, count: int = 1) -> Sequence[T]:
    """`count` of them: which, goes round with the number of whoever asks."""
    return items if WHOLE else [items[(number + k * len(items) // count) % len(items)] for k in range(count)]


def some_files(paths: Sequence[Path], number: int, count: int = 1) -> list[Path]:
    """Half of the small files and `count` of the large, which are variants of one project; each sweep has others."""
    if WHOLE:
        return list(paths)
    large = [path for path in paths if path.stat().st_size > _LARGE]
    small = [path for path in paths if path not in large]
    chosen = {*small[number % 2 :: 2], *(in_turn(large, number, count) if large else [])}
    return [path for path in paths if path in chosen]


_LARGE = 300_000


def one_of_each(items: Iterable[T], kind: Callable[[T], Hashable]) -> list[T]:
    """The first of each kind."""
    if WHOLE:
        return list(items)
    first: dict[Hashable, T] = {}
    for item in items:
        first.setdefault(kind(item), item)
    return list(first.values())
