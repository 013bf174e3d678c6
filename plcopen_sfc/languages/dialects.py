"""The dialects of structured text that the library reads and writes. The model names them; this is their home here."""

from __future__ import annotations

from plcopen_sfc.model.dialect import Dialect

__all__ = ["Dialect"]
