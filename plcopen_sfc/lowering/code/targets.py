"""For whose tools lowered code is: which blocks there are in networks, and what their pins are called."""

from __future__ import annotations

import re

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.standard_blocks import Tool

_FORMATS = {
    "simaticml": Tool.S7,
    "scl": Tool.S7,
    "codesys": Tool.CODESYS,
    "codesys23": Tool.CODESYS,
    "twincat": Tool.CODESYS,
}
_DIALECTS = {Dialect.SCL: Tool.S7, Dialect.CODESYS: Tool.CODESYS, Dialect.TWINCAT: Tool.CODESYS}


def tool_of(target: str | None, dialect: Dialect) -> Tool | None:
    """The tool that a format is for; without a format that of the dialect of the project. None: IEC 61131-3."""
    return _FORMATS.get(target) if target is not None else _DIALECTS.get(dialect)


def has_one_sheet(target: str | None) -> bool:
    """Whether a format has all networks of a body on one sheet, as TC6 does."""
    return target is not None and (target == "codesys" or target.startswith("plcopen"))


def has_networks(target: str | None) -> bool:
    """Whether a format can hold networks; in one that is text for another tool they would be comments only."""
    return target != "scl"


def shows_networks(target: str | None) -> bool:
    """Whether who opens a file of a format sees networks: textual IEC 61131-3 says them in statements of its own."""
    return has_networks(target) and target != "iec-text"


def without_version(target: str) -> str:
    """The name of a format: ``simaticml`` of ``simaticml-V17``."""
    return re.sub(r"-V?\d.*", "", target)
