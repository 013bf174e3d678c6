"""Binding of program text: the names that a body in any language uses, and its effects.

`bind` gives the view of a body that checks, analysis and lowering ask: its statements, its name sites
(`BoundBody.uses`), what it reads, writes and calls (`BoundBody.effects`), and what of it is not known. `texts_in` gives
the texts of any other object of the model. `Names` tells what a project declares and where it is used.

`text_sites` has the places of the model that hold text, `name_sites` the names in them; `bound_bodies` has the
views. `symbols` are declarations, `name_scopes` where they are visible,
`name_resolution` which of them a name means, `name_uses` (`Names`) where each is used; `constant_values` calculates.
`shared_scans` finds the actions of a chart whose order counts.
`reached_pous` are those that another one may call, and what the rest of a project writes.
`compile_mistakes` are the types and parameters that no compiler takes.
"""

from plcopen_sfc.languages.binding.bound_bodies import (
    BoundBody,
    BoundText,
    UnknownPart,
    actions_by_name,
    bind,
    called_actions,
    is_named_elsewhere,
    names_in,
    step_effects,
    texts_in,
    uncalled_actions,
    with_called,
)
from plcopen_sfc.languages.binding.name_uses import Names, find_uses
from plcopen_sfc.languages.binding.shared_scans import STORING, Row, SharedScans, told_orders, told_step_actions
from plcopen_sfc.languages.effects import ANYTHING, Effects, Path
from plcopen_sfc.model.declaration import Declaration, Kind
from plcopen_sfc.report import Use

__all__ = [
    "ANYTHING",
    "STORING",
    "BoundBody",
    "BoundText",
    "Declaration",
    "Effects",
    "Kind",
    "Names",
    "Path",
    "Row",
    "SharedScans",
    "UnknownPart",
    "Use",
    "actions_by_name",
    "bind",
    "called_actions",
    "find_uses",
    "is_named_elsewhere",
    "names_in",
    "step_effects",
    "texts_in",
    "told_orders",
    "told_step_actions",
    "uncalled_actions",
    "with_called",
]
