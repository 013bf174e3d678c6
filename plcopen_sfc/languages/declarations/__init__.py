"""Declarations: from text to the model and back, in every dialect.

`declaration_reading` and `declaration_writing`, with `declaration_comments` and `type_names` (which words are names);
`kept_texts`: what one dialect alone has, and EXTENDS and IMPLEMENTS; `attributes`: ``{attribute 'no_init'}``.
"""

from plcopen_sfc.languages.declarations.declaration_reading import (
    Declared,
    DeclaredUnit,
    Found,
    Head,
    Units,
    read_declarations,
    read_interface,
    split_units,
)
from plcopen_sfc.languages.declarations.declaration_writing import (
    write_data_type,
    write_listing,
    write_section,
    write_type,
    write_value,
    write_variable,
)

__all__ = [
    "Declared",
    "DeclaredUnit",
    "Found",
    "Head",
    "Units",
    "read_declarations",
    "read_interface",
    "split_units",
    "write_data_type",
    "write_listing",
    "write_section",
    "write_type",
    "write_value",
    "write_variable",
]
