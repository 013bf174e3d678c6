"""A project as a tree of what a controller executes: parts, each with what is told of it.

Parts are found again by what they are called and where they stand: steps by name, transitions by the steps that they
connect, actions by what they execute, variables by name.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import NamedTuple

from plcopen_sfc.conversion.meaning import (
    Meaning,
    value_meaning,
)
from plcopen_sfc.model.types import (
    SimpleValue,
)

__all__ = ["UNDECLARED", "Key", "Part", "duration_meaning", "plain_name"]

UNDECLARED = "undeclared name"
"""The kind of parts that are names which nothing declares."""


class Key(NamedTuple):
    """What a part is found by among its neighbours: its kind and its name, and which of several that are alike."""

    kind: str
    name: str
    number: int = 0


@dataclass(slots=True)
class Part:
    """A part of a project that is executed. `path` is the place in the words of reports (``POU Main / step Fill``).

    Of a transition, `leaves` are the names of the steps that it leaves, as in their keys, and `waiting` is its
    condition together with their minimum times. Of a project, `lists` are the names of its lists of global variables,
    and `boxes` those of what its networks draw.
    """

    path: str
    aspects: dict[str, Meaning] = field(default_factory=dict)
    parts: dict[Key, Part] = field(default_factory=dict)
    leaves: tuple[str, ...] = ()
    waiting: Meaning | None = None
    lists: frozenset[str] = frozenset()
    boxes: frozenset[str] = frozenset()

    def tell(self, aspect: str, meaning: Meaning | None) -> None:
        """Note an aspect; None is nothing to note."""
        if meaning is not None:
            self.aspects[aspect] = meaning

    def add(self, kind: str, name: str, path: str) -> Part:
        """A new part inside this one; the name of a transition is made of plain names of steps."""
        number, plain = 0, name if kind == "transition" else plain_name(name)
        while Key(kind, plain, number) in self.parts:
            number += 1
        part = self.parts[Key(kind, plain, number)] = Part(path)
        return part


def plain_name(name: str) -> str:
    """A name as all tools could spell it: they know different quotes and signs in names."""
    return _SIGNS.sub("_", name.replace('"', "").removeprefix("#")).casefold()


_SIGNS = re.compile(r"(?:[^\w.]|_)+")


def duration_meaning(text: str | None) -> Meaning | None:
    """A time as it is compared; None where there is none."""
    return value_meaning(SimpleValue(text=text), None) if text and text.strip() else None
