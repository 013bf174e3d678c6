"""Translation of structured text between dialects.

`text_translation`      a text with its layout and comments, by `tree_translation`, its syntax tree
`translation_context`   names, types and steps beside the text; `renames`: names that one dialect alone has
`call_translation`      calls, with `arithmetic_translation`, `literal_translation` and `name_translation` for the rest
"""

from plcopen_sfc.languages.translation.renames import NameScope as NameScope, Rename as Rename, Renames as Renames
from plcopen_sfc.languages.translation.text_translation import (
    TextKind as TextKind,
    Translated as Translated,
    is_foreign as is_foreign,
    translate as translate,
    translate_text as translate_text,
)
from plcopen_sfc.languages.translation.translation_context import (
    Note as Note,
    StepNotation as StepNotation,
    StepReferences as StepReferences,
    TranslationContext as TranslationContext,
)
