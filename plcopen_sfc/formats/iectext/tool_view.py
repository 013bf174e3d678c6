"""A text as other tools see it: without the pragmas of ours."""

from __future__ import annotations

import re

from plcopen_sfc.formats.iectext.outline import outline
from plcopen_sfc.formats.iectext.project_reader import dialect_of
from plcopen_sfc.formats.iectext.source import OWN_PRAGMA, is_own
from plcopen_sfc.formats.text import decode
from plcopen_sfc.languages.edits import without

_ABOUT_THE_FILE = re.compile(r"\{\s*plcopen_sfc\s+(?:format\b|project\.dialect\b)")
"""What the file is, which its tool knows: they stay."""


def without_own_pragmas(data: bytes) -> bytes:
    """The file `data` without them; `data` itself where there are none."""
    source = decode(data)
    if OWN_PRAGMA.search(source.text) is None:
        return data
    comments = outline(source.text, dialect_of(source.text)).found.comments
    own = [c.span for c in comments if is_own(c) and _ABOUT_THE_FILE.match(c.text) is None]
    return source.encode(without(source.text, own))[0]
