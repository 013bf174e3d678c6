"""Conditions and bodies that are drawn, FBD and LD, beside structured text with the same meaning.

Other tools and people read the text; the drawing is in pragmas at the end of the unit, and counts as long as the
text is the one it was written with.
"""

from __future__ import annotations

import hashlib

from plcopen_sfc.languages.pragmas import Fields, RemainderEntry
from plcopen_sfc.languages.pragmas.remainder import Segment, additions

DRAWN = "drawn"
_SHOWN = "shown"
_LONG = 80


def drawn_changes(intended: Fields, shown: str, place: tuple[Segment, ...]) -> list[RemainderEntry]:
    """Pragmas that hold the drawing `intended` of the text at `place`."""
    path = (*place, DRAWN)
    return [RemainderEntry((*path, _SHOWN), _mark(shown)), *additions(intended, path)]


def put_drawing(fields: Fields, field: str) -> bool:
    """Replace the text in `field` by its drawing. False: the text was changed, so the drawing is left out."""
    drawing = fields.pop(DRAWN, None)
    if not isinstance(drawing, dict):
        return True
    mark = drawing.pop(_SHOWN, None)
    found: Fields = fields.get(field) or {}
    read_back: Fields = found.get("body", found)  # a condition may be statements
    if _mark(str(read_back.get("text", read_back.get("name", "")))) != mark:
        return False
    fields[field] = drawing
    return True


def _mark(text: str) -> str:
    """Return the text, or of a long one a digest."""
    return text if len(text) <= _LONG else "#" + hashlib.sha256(text.encode()).hexdigest()[:12]
