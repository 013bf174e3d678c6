"""Problems of a text, and their places."""

from __future__ import annotations

import re
from bisect import bisect_right
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Problem:
    """A problem at `span`, offsets into a text."""

    message: str
    span: tuple[int, int]


class Lines:
    """Line and column of offsets into a text, both counted from 1. Lines end with LF, CRLF or CR."""

    def __init__(self, text: str) -> None:
        self._starts = [0, *(end.end() for end in _LINE_END.finditer(text))]

    def place(self, offset: int) -> tuple[int, int]:
        """Return the line and column of the character at `offset`."""
        line = bisect_right(self._starts, offset)
        return line, offset - self._starts[line - 1] + 1


_LINE_END = re.compile(r"\r\n|\r|\n")
