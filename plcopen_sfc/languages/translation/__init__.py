"""Translation of structured text between dialects."""

from plcopen_sfc.languages.translation.renames import NameScope, Rename, Renames
from plcopen_sfc.languages.translation.text_translation import (
    TextKind,
    Translated,
    is_foreign,
    translate,
    translate_text,
    translate_tree,
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
    "translate_tree",
]
