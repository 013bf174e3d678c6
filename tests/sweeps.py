"""How much of a long sweep is run: a sample as a rule, all of it where ``PLCOPEN_SFC_FULL`` is set.

A sample is the same in every run. It has every file, or every kind of place, or every kind of damage: what is left out
are more of the same.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Hashable, Iterable, Sequence
from typing import TypeVar

__all__ = ["WHOLE", "in_turn", "one_of_each", "some_of"]

WHOLE = bool(os.environ.get("PLCOPEN_SFC_FULL"))

T = TypeVar("T")


def some_of(items: Sequence[T], every: int) -> Sequence[T]:
    """Every nth."""
    return items if WHOLE else items[::every]


def in_turn(items: Sequence[T], number: int, count: int = 1) -> Sequence[T]:
    """`count` of them: which, goes round with the number of whoever asks."""
    return items if WHOLE else [items[(number + k * len(items) // count) % len(items)] for k in range(count)]


def one_of_each(items: Iterable[T], kind: Callable[[T], Hashable]) -> list[T]:
    """The first of each kind."""
    if WHOLE:
        return list(items)
    first: dict[Hashable, T] = {}
    for item in items:
        first.setdefault(kind(item), item)
    return list(first.values())
