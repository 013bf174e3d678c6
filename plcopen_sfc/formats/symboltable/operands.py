"""Addresses in symbol tables of STEP 7 V5, ``E 0.0`` or ``I 0.0``, and those of TIA tags, ``%I0.0``."""

from __future__ import annotations

import re

_GERMAN = {"I": "E", "Q": "A", "C": "Z"}
_INTERNATIONAL = {german: area for area, german in _GERMAN.items()}
_BIT_OR_WORD = r"([EAIQM])[ \t]*(?:([BWD])[ \t]*(\d+)|X?[ \t]*(\d+)\.([0-7]))"
_OPERAND = re.compile(rf"{_BIT_OR_WORD}|([TZC])[ \t]*(\d+)", re.IGNORECASE)
_OTHER = re.compile(
    r"(?:FB|FC|OB|DB|SFB|SFC|UDT|VAT)[ \t]*\d+|P[EAIQ][BWD]?[ \t]*\d+(?:\.[0-7])?",
    re.IGNORECASE,
)


def is_operand(text: str) -> bool:
    """Return True if a text is an address of a symbol: also that of a block, or of the periphery."""
    return _OPERAND.fullmatch(text) is not None or _OTHER.fullmatch(text) is not None


def is_german(text: str) -> bool:
    """Return True if an address is in German mnemonics (E, A, Z)."""
    return re.match(r"P?[EAZ]", text, re.IGNORECASE) is not None


def tag_address(text: str) -> str | None:
    """Return the address of a TIA tag; None for what is none, such as a block."""
    found = _OPERAND.fullmatch(text)
    if found is None:
        return None
    area, width, first, byte, bit, block, number = found.groups()
    area = (area or block).upper()
    area = _INTERNATIONAL.get(area, area)
    if block:
        return f"%{area}{number}"
    return f"%{area}{width.upper()}{first}" if width else f"%{area}{byte}.{bit}"


def with_mnemonics(text: str, *, german: bool) -> str:
    """Return the address of a symbol of the periphery in these mnemonics; any other one as it is."""
    found = re.match(r"(P)([EAIQ])", text, re.IGNORECASE)
    if found is None or _OTHER.fullmatch(text.rstrip()) is None:
        return text
    area = _INTERNATIONAL.get(found[2].upper(), found[2].upper())
    return f"P{_GERMAN[area] if german else area}{text[found.end() :]}"


def operand(address: str, *, german: bool) -> str | None:
    """Return the address of a symbol; None where STEP 7 V5 has none for that of a tag, such as ``%IW4:P``."""
    known = tag_address(address.strip().removeprefix("%"))
    if known is None:
        return None
    area, rest = known[1], known[2:]
    width = rest[0] if rest[0] in "BWD" else ""
    return f"{_GERMAN.get(area, area) if german else area}{width} {rest.removeprefix(width)}"
