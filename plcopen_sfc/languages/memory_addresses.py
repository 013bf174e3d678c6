"""Direct addresses as bits of memory (IEC 61131-3 ed. 3, 6.5.5)."""

from __future__ import annotations

import re
from typing import NamedTuple

_ADDRESS = re.compile(
    r"%?(?P<area>[A-Z]|DB\d+\.DB)(?P<size>[XBWDL]?)(?P<numbers>\d{1,9}(?:\.\d{1,9})*)(?::P)?", re.IGNORECASE
)
_WIDTHS = {"": 1, "X": 1, "B": 8, "W": 16, "D": 32, "L": 64}
INTERNATIONAL = {"E": "I", "A": "Q"}
"""The areas of inputs and outputs by the letters of German S7."""


class MemoryAddress(NamedTuple):
    """Bits of a memory area: the first one, and how many."""

    area: str
    start: int
    width: int

    def overlaps(self, other: MemoryAddress) -> bool:
        """True if the two have bits in common, and are not the same."""
        within = self.start < other.start + other.width and other.start < self.start + self.width
        return self.area == other.area and within and self != other


def memory_address(text: str, *, by_bytes: bool) -> MemoryAddress | None:
    """Return the bits that an address names; None for a text that is no address.

    `by_bytes`: the tool numbers its words as bytes.
    """
    found = _ADDRESS.fullmatch(text.strip())
    if found is None:
        return None
    area = INTERNATIONAL.get(found["area"].upper(), found["area"].upper())
    size = found["size"].upper()
    numbers = [int(part) for part in found["numbers"].split(".")]
    width = _WIDTHS[size]
    if width == 1:
        if len(numbers) == 1:
            return MemoryAddress(area, numbers[0] * (1 if size == "X" else 8), 1)
        head = area + "".join(f".{part}" for part in numbers[:-2])
        return MemoryAddress(head, numbers[-2] * 8 + numbers[-1], 1)
    head = area + "".join(f".{part}" for part in numbers[:-1])
    return MemoryAddress(head, numbers[-1] * (8 if by_bytes else width), width)
