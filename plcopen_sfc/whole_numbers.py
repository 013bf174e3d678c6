"""Whole numbers in texts that come from files."""

from __future__ import annotations

import re

_WHOLE_NUMBER = re.compile(r"[0-9]{1,18}")


def whole_number(text: str | None) -> int | None:
    """Return a whole, non-negative number of at most 18 digits; None for any other text.

    `str.isdigit` accepts digits of other scripts and ², and `int` converts no more than 4300 digits.
    """
    return int(text) if text is not None and _WHOLE_NUMBER.fullmatch(text) else None
