"""The dialects of structured text that the library reads and writes. The model names them; this is their home here."""

from __future__ import annotations

from plcopen_sfc.model.dialect import Dialect

__all__ = ["STRING_LENGTHS", "Dialect"]

STRING_LENGTHS = {Dialect.SCL: "254", Dialect.CODESYS: "80"}
"""How many characters a string has whose declaration does not say it; IEC 61131-3 leaves that to the tool."""
