"""Writes headers, variable sections and types. The reader is `declarations_reader`."""

from __future__ import annotations

from plcopen_sfc.formats.iectext.printing import Printer
from plcopen_sfc.languages.pragmas import Fields, plain_fields
from plcopen_sfc.model.variables import Interface


def write_header_type(interface: Interface | None) -> str:
    return ""


def write_interface(
    printer: Printer, keyword: str, name: str, interface: Interface | None, indent: str, meant: Fields, said: Fields
) -> str:
    """The header of a unit and its sections."""
    if interface is not None:
        meant["interface"] = plain_fields(interface)
    colon = ":" if keyword == "ACTION" else ""
    return f"{indent}{keyword} {name}{colon}\n"
