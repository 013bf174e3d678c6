"""Which words can be names."""

from __future__ import annotations

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.words import IEC_KEYWORDS, is_plain


def objection(name: str, dialect: Dialect) -> str:
    """Why `name` cannot be a name in `dialect` (IEC 61131-3 ed. 3, 6.1.2); empty if it can.

    Letters of any alphabet are taken, as tools do. In SCL a name can be anything, in quotes; it is given without.
    """
    if dialect is Dialect.SCL:
        printable = bool(name.strip()) and name.isprintable() and '"' not in name
        return "" if printable else "a name has no quotes and no control characters in it"
    if not is_plain(name):
        return "a name consists of letters, digits and underscores, and starts with no digit"
    if name.upper() in IEC_KEYWORDS:
        return "it is a keyword"
    if "__" in name or name.endswith("_"):
        # tools take them, the standard does not: those that exist already stay as they are
        return "" if dialect is not Dialect.IEC else "underscores stand alone and not at the end of a name"
    return ""
