"""Translation of structured text between dialects.

`text_translation`      a text with its layout and comments, by `tree_translation`, its syntax tree
`translation_context`   names, types and steps beside the text; `renames`: names that one dialect alone has
`call_translation`      calls, with `arithmetic_translation`, `literal_translation` and `name_translation` for the rest
"""

from plcopen_sfc.languages.translation.renames import NameScope, Rename, Renames
from plcopen_sfc.languages.translation.text_translation import (
    TextKind,
    Translated,
    is_foreign,
    translate,
    translate_text,
)
from plcopen_sfc.languages.translation.translation_context import Note, StepNotation, StepReferences, TranslationContext

__all__ = [
    "NameScope",
    "Note",
    "Rename",
    "Renames",
    "StepNotation",
    "StepReferences",
    "TextKind",
    "Translated",
    "TranslationContext",
    "is_foreign",
    "translate",
    "translate_text",
]
