"""Binding of program text: the names that a body in any language uses, and its effects.

`bind` gives the view of a body that checks, analysis and lowering ask: its statements, its name sites
(`BoundBody.uses`), what it reads, writes and calls (`BoundBody.effects`), and what of it is not known. `texts_in` gives
the texts of any other object of the model.
"""

from plcopen_sfc.languages.binding.bodies import BoundBody, Unknown, bind, called_actions
from plcopen_sfc.languages.binding.texts import BoundText, is_named_elsewhere, names_in, texts_in
from plcopen_sfc.languages.st.effects import ANYTHING, Effects, Path

__all__ = [
    "ANYTHING",
    "BoundBody",
    "BoundText",
    "Effects",
    "Path",
    "Unknown",
    "bind",
    "called_actions",
    "is_named_elsewhere",
    "names_in",
    "texts_in",
]
