"""Charts of actions: a target that has no charts has none inside others either."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from plcopen_sfc.languages.binding import called_actions
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.lowering.constructing import Constructed, construct
from plcopen_sfc.lowering.forms import Construction, Language
from plcopen_sfc.lowering.placing import errors_of
from plcopen_sfc.lowering.rules import LoweringRules
from plcopen_sfc.lowering.step_data import with_step_data
from plcopen_sfc.model.body import SfcBody
from plcopen_sfc.model.pou import Action, Pou
from plcopen_sfc.model.project import Project


def with_actions(
    made: Constructed, dialect: Dialect, rules: LoweringRules, language: Language | None, project: Project
) -> Constructed:
    """The same with code instead of the charts of those actions that its code calls, and that these call.

    They have the construction of the chart where it can hold them. What starts a chain anew and operates it concerns
    the chart itself. What other bodies ask of steps is told by the code of their charts.
    """
    inner = replace(rules, init=None, stop=None, reset_actions=False, flags="local", modes=frozenset())
    pou, data_types, body = made.pou, list(made.data_types), made.pou.body
    parts = made.construction in (Construction.CASE, Construction.REGIONS)
    construction = Construction.AUTO if parts else made.construction
    flags = _by_name(made.step_flags)
    done: set[str] = set()
    calling = [body]
    while calling:
        called = called_actions(calling.pop(), pou, dialect)
        for action in list(pou.actions):
            key = action.name.casefold()
            if key in done or key not in called:
                continue
            done.add(key)
            if isinstance(action.body, SfcBody):
                alone = pou.model_copy(update={"bodies": [action.body]})  # as if it were the body
                chart = action.body.chart
                # types that are new have their names already
                around = project.model_copy(update={"data_types": [*project.data_types, *data_types]})
                with errors_of(project, pou, f"{pou.name}.{action.name}"):
                    found = construct(
                        alone, chart, dialect, inner, construction=construction, language=language, project=around
                    )
                data_types += found.data_types
                pou = found.pou.model_copy(update={"bodies": pou.bodies})
                _named(pou, action.name).body = found.pou.body
                for step, flag in _by_name(found.step_flags).items():
                    flags.setdefault(step, flag)
            calling.append(_named(pou, action.name).body)
    if not rules.profile.graph_parameters:  # blocks of S7-GRAPH have one body
        pou = with_step_data(pou, flags, dialect)
    return replace(made, pou=pou, data_types=tuple(data_types))


def _by_name(flags: Mapping[str, str]) -> dict[str, str]:
    """What tells of steps, by their names instead of their paths."""
    return {path.rpartition(".")[2].casefold(): flag for path, flag in flags.items()}


def _named(pou: Pou, name: str) -> Action:
    return next(action for action in pou.actions if action.name == name)
