"""Direct addresses (``%IX0.0``) and bits of words of one dialect in another."""

from __future__ import annotations

import re

from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.translation.translation_context import PartText

_ADDRESS = re.compile(r"%([IQMEA])([XBWD]?)(\d+(?:\.\d+)*)", re.IGNORECASE)
_ENGLISH = {"E": "I", "A": "Q"}
_BYTES = {"W": 2, "D": 4}
_WORDS = {2: "word", 4: "double word"}
_COUNTING = "the same bytes: S7 counts bytes, other tools count words or double words; S7 has the high byte first"


def translated_address(text: str, source: Dialect, target: Dialect) -> PartText:
    """A direct address of `source` in `target`, both families.

    S7 counts the bytes of words and double words, other tools count these (IEC 61131-3, 6.5.5, leaves it to them), so
    that ``%IW2`` of S7 is ``%IW1``. S7 has no letter for bits, and its German mnemonics have E for inputs and A for
    outputs.
    """
    if Dialect.SCL not in (source, target) or source is target:
        return PartText(text)
    found = _ADDRESS.fullmatch(text)
    if found is None or (target is Dialect.SCL and found[1].upper() in _ENGLISH):
        return PartText(text, Severity.ERROR, f"{text} has no counterpart; left as it stands")
    area = _ENGLISH.get(found[1].upper(), found[1])
    size, place = found[2], found[3]
    if size.upper() in ("", "X"):
        if not re.fullmatch(r"\d+\.[0-7]", place):
            return PartText(text, Severity.ERROR, f"{text} has no counterpart: S7 names bits by byte and bit")
        return PartText(f"%{area}{place}" if target is Dialect.SCL else f"%{area}X{place}")
    if "." in place:
        return PartText(text, Severity.ERROR, f"{text} has no counterpart; left as it stands")
    width = _BYTES.get(size.upper())
    if width is None:
        return PartText(f"%{area}{size}{place}")
    if target is Dialect.SCL:
        return PartText(f"%{area}{size}{int(place) * width}", Severity.INFO, _COUNTING)
    if int(place) % width:
        reason = f"{text} has no counterpart: there a {_WORDS[width]} begins at every {width} bytes"
        return PartText(text, Severity.ERROR, reason)
    return PartText(f"%{area}{size}{int(place) // width}", Severity.INFO, _COUNTING)


def translated_part(name: str, source: Dialect, target: Dialect) -> PartText | None:
    """The name of a bit or another part of a word: ``3`` and ``%X3`` (6.5.4.4). None: it names no part.

    SCL has only the second form for bits; the first is the one that all versions of other tools know.
    """
    if name.isdigit():
        return PartText(f"%X{name}" if target is Dialect.SCL else name)
    if not name.startswith("%"):
        return None
    if source is Dialect.SCL and target is not Dialect.SCL and name[1] in "Xx":
        return PartText(name[2:])
    if target is Dialect.CODESYS:
        return PartText(name, Severity.INFO, f"older versions of CODESYS do not know .{name}")
    return PartText(name)
