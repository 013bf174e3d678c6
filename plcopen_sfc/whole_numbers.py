"""Whole numbers in texts: those that come from files, and counts that people read."""

from __future__ import annotations

import re
from functools import lru_cache

_CANONICAL = re.compile(r"0|[1-9][0-9]{0,17}")


def whole_number(text: str | None) -> int | None:
    """Return a whole, non-negative number of at most 18 digits; None for any other text.

    `str.isdigit` alone accepts digits of other scripts and ², and `int` converts no more than 4300 digits.
    """
    return int(text) if text is not None and len(text) <= 18 and text.isascii() and text.isdigit() else None


@lru_cache(maxsize=4096)  # a chart has each of its ids several times
def xml_number(text: str | None) -> int | None:
    """Return a number as `whole_number` does; white space around it does not count, as in types of XML Schema."""
    if text is None or not text.isdigit():  # most numbers have no white space around them
        return whole_number(text.strip(" \t\r\n")) if text is not None else None
    return int(text) if len(text) <= 18 and text.isascii() else None


def canonical_number(text: str | None) -> int | None:
    """Return a number as `whole_number` does; None for leading zeros, which the number would not bring back."""
    return int(text) if text is not None and _CANONICAL.fullmatch(text) else None


def counted(count: int, noun: str) -> str:
    """Return how many there are of something, such as ``1 scan`` or ``2 scans``."""
    return f"{count} {noun}{'' if count == 1 else 's'}"
