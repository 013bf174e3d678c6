"""Declarations: from text to the model and back, in every dialect.

`declaration_reading` and `declaration_writing`, with `declaration_comments` and `type_names` (which words are names);
`kept_texts`: what one dialect alone has, and EXTENDS and IMPLEMENTS; `attributes`: ``{attribute 'no_init'}``;
`conditional_declarations`: ``{IF defined (X)} .. {END_IF}``.
"""

from plcopen_sfc.languages.declarations.declaration_reading import (
    Declared as Declared,
    DeclaredUnit as DeclaredUnit,
    Found as Found,
    Head as Head,
    Units as Units,
    read_declarations as read_declarations,
    read_interface as read_interface,
    split_units as split_units,
)
from plcopen_sfc.languages.declarations.declaration_writing import (
    write_data_type as write_data_type,
    write_listing as write_listing,
    write_section as write_section,
    write_type as write_type,
    write_value as write_value,
    write_variable as write_variable,
)
