"""Paths of objects in the words of messages and reports."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Self

_BETWEEN = " / "


class ObjectPath(str):
    """Path of an object in the words of messages and reports: ``POU Main / step S3``.

    It is made of its parts, from the outermost object inwards, and is their text; empty parts are left out.
    `ObjectPath.of` takes a text that is printed already.
    """

    parts: tuple[str, ...]

    def __new__(cls, *parts: str) -> Self:
        """Join the parts once; they stay known, whatever is in them."""
        kept = tuple(filter(None, parts))
        path = super().__new__(cls, _BETWEEN.join(kept))
        path.parts = kept
        return path

    def __getnewargs__(self) -> tuple[str, ...]:  # type: ignore[override]  # of str: the text
        return self.parts

    @classmethod
    def of(cls, path: str | None) -> Self:
        """Return a path from its text; one that is a path already as it is."""
        return path if isinstance(path, cls) else cls(*(path or "").split(_BETWEEN))

    def __truediv__(self, part: str) -> ObjectPath:
        return ObjectPath(*self.parts, part)

    @property
    def owner(self) -> str:
        """The outermost object: ``POU Main``."""
        return self.parts[0] if self.parts else ""

    @property
    def last(self) -> str:
        """The object itself: ``step S3``."""
        return self.parts[-1] if self.parts else ""

    @property
    def around(self) -> ObjectPath:
        """The object that it is in; empty for an outermost one."""
        return ObjectPath(*self.parts[:-1])

    def outwards(self) -> Iterator[ObjectPath]:
        """Yield the path itself, then those of the objects around it."""
        for end in range(len(self.parts), 0, -1):
            yield ObjectPath(*self.parts[:end])

    def is_in(self, other: str) -> bool:
        """True if it is the object at another path, or in it."""
        around = ObjectPath.of(other).parts
        return self.parts[: len(around)] == around

    def inside(self, other: str) -> ObjectPath:
        """Return the path as seen from an object that it is in."""
        return ObjectPath(*self.parts[len(ObjectPath.of(other).parts) :])
