"""Dialects that are one language for a translation."""

from __future__ import annotations

from plcopen_sfc.languages.dialects import Dialect


def family(dialect: Dialect) -> Dialect:
    """The dialect itself, but CODESYS for TwinCAT, which is the same language."""
    return Dialect.CODESYS if dialect is Dialect.TWINCAT else dialect


TITLES = {
    Dialect.IEC: "IEC 61131-3",
    Dialect.CODESYS: "CODESYS",
    Dialect.TWINCAT: "TwinCAT",
    Dialect.SCL: "SCL",
}
"""How messages call a dialect."""
