"""Declarations: from text to the model and back, in every dialect."""

from plcopen_sfc.languages.declarations.declaration_reading import (
    Declared,
    Found,
    Head,
    read_declarations,
    read_interface,
)
from plcopen_sfc.languages.declarations.declaration_writing import (
    write_access_section,
    write_config_section,
    write_data_type,
    write_interface,
    write_section,
    write_type,
    write_value,
    write_variable,
)
from plcopen_sfc.languages.declarations.declared_units import DeclaredUnit, Units, split_units

__all__ = [
    "Declared",
    "DeclaredUnit",
    "Found",
    "Head",
    "Units",
    "read_declarations",
    "read_interface",
    "split_units",
    "write_access_section",
    "write_config_section",
    "write_data_type",
    "write_interface",
    "write_section",
    "write_type",
    "write_value",
    "write_variable",
]
