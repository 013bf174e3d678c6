"""Translation of structured text between dialects."""

from plcopen_sfc.languages.translation.context import StepNotation, StepReferences, TranslationContext
from plcopen_sfc.languages.translation.notes import Note
from plcopen_sfc.languages.translation.renames import NameScope, Rename, Renames
from plcopen_sfc.languages.translation.translate import (
    TextKind,
    Translated,
    is_foreign,
    translate,
    translate_text,
    translate_tree,
)

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
