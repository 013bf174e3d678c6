"""How much of a long sweep is run: a sample as a rule, all of it where ``PLCOPEN_SFC_FULL`` is set.

A sample is the same in every run. It has every file, or every kind of place, or every kind of damage: what is left out
are more of the same.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Hashable, Iterable, Sequence
from typing import TypeVar

__all__ = ["FULL", "one_of_each", "some_of", "turn"]

FULL = bool(os.environ.get("PLCOPEN_SFC_FULL"))

T = TypeVar("T")


def some_of(items: Sequence[T], every: int) -> Sequence[T]:
    """Every nth."""
    return items if FULL else items[::every]


def turn(items: Sequence[T], number: int) -> Sequence[T]:
    """One of them: which, goes round with the number of whoever asks."""
    return items if FULL else [items[number % len(items)]]


def one_of_each(items: Iterable[T], kind: Callable[[T], Hashable]) -> list[T]:
    """The first of each kind."""
    if FULL:
        return list(items)
    first: dict[Hashable, T] = {}
    for item in items:
        first.setdefault(kind(item), item)
    return list(first.values())
