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
    BoundBody as BoundBody,
    BoundText as BoundText,
    UnknownPart as UnknownPart,
    actions_by_name as actions_by_name,
    bind as bind,
    called_actions as called_actions,
    is_named_elsewhere as is_named_elsewhere,
    names_in as names_in,
    step_effects as step_effects,
    texts_in as texts_in,
    uncalled_actions as uncalled_actions,
    with_called as with_called,
)
from plcopen_sfc.languages.binding.name_uses import Names as Names, find_uses as find_uses
from plcopen_sfc.languages.binding.shared_scans import (
    STORING as STORING,
    Row as Row,
    SharedScans as SharedScans,
    told_orders as told_orders,
    told_step_actions as told_step_actions,
)
from plcopen_sfc.languages.effects import ANYTHING as ANYTHING, Effects as Effects, Path as Path
from plcopen_sfc.model.declaration import Declaration as Declaration, Kind as Kind
from plcopen_sfc.report import Use as Use
