"""Finds texts of a project in the file that it was read from."""

from __future__ import annotations

import re
from collections.abc import Sequence

from plcopen_sfc.languages.problems import Lines

_ESCAPED = {
    "<": "(?:&lt;|<)",
    ">": "(?:&gt;|>)",
    "&": "(?:&amp;|&)",
    '"': '(?:&quot;|"|&#34;)',
    "'": "(?:&apos;|'|&#39;)",
    "\t": "(?:\t|&#x?9;)",
    "\n": "(?:\r\n|\r|\n|&#10;|&#x[Aa];)",
    "\r": "(?:\r|&#13;|&#x[Dd];|)",
}


class TextFinder:
    """Finds texts in `content`, the text of a file: XML, or one in which they stand as they are.

    In XML a text fills an element or an attribute; elsewhere it may be a part of anything.

    The same text asked for again is looked for behind the place where it was found before, so that asking in the order
    of the file finds each where it stands.
    """

    def __init__(self, content: str, *, xml: bool) -> None:
        self._content = content
        self._around = (r"""(?<=[>"'\[])\s*""", r"""(?=\s*[<"'\]])""") if xml else ("", "")
        self._lines = Lines(content)
        self._found: dict[str, int] = {}

    def places(self, text: str, offsets: Sequence[int]) -> list[tuple[int, int]] | None:
        """Line and column in the file of what stands at each of `offsets` in `text`; None if the text is not found."""
        before, after = self._around
        found = re.compile(f"{before}({_pattern(text)}){after}").search(self._content, self._found.get(text, 0))
        if found is None:
            return None
        self._found[text] = found.end()
        return [self._lines.place(self._end_of(text[:offset], found.start(1))) for offset in offsets]

    def _end_of(self, part: str, start: int) -> int:
        found = re.compile(_pattern(part)).match(self._content, start)
        return found.end() if found is not None else start


def _pattern(text: str) -> str:
    return "".join(_ESCAPED.get(character) or re.escape(character) for character in text.replace("\r\n", "\n"))
