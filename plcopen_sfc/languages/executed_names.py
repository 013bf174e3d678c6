"""Names that are executed: CODESYS shows the name of a step in a flag, and executes actions in the order of names.

Another name of such a step or action is another behaviour (CODESYS V3 online help, "Processing order of elements",
step 5; "SFC flags": SFCCurrentStep, SFCErrorStep).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from plcopen_sfc.languages.binding import Names
from plcopen_sfc.languages.binding.name_scopes import every_chart
from plcopen_sfc.languages.effects import Effects, effects, may_change
from plcopen_sfc.languages.st import parse_statements
from plcopen_sfc.languages.translation.translation_context import family
from plcopen_sfc.model.body import StBody
from plcopen_sfc.model.chart_settings import SfcFlag
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Action, Pou
from plcopen_sfc.report import Use

SHOWING_FLAGS = (SfcFlag.CURRENT_STEP.variable, SfcFlag.ERROR_STEP.variable)
"""The SFC flags that hold the name of a step."""


def shows_names_of_steps(names: Names) -> bool:
    """True if a text of the project reads the name of a step in an SFC flag."""
    found = names.occurrences(*SHOWING_FLAGS)
    return any(not each.reference.declares for each in found)


def texts_with_name(names: Names, name: str) -> Iterator[Use]:
    """Yield the places of program text that have the name of a step as a string: ``SFCCurrentStep = 'Fill'``."""
    for text_site in names.text_sites():
        text = text_site.text
        start = text.casefold().find(f"'{name.casefold()}'")
        if start >= 0:
            span = start + 1, start + 1 + len(name)
            line = text.count("\n", 0, start) + 1
            column = start + 2 - (text.rfind("\n", 0, start) + 1)
            yield Use(text_site.path, text_site.language, span, line, column, text.splitlines()[line - 1].strip())


def reordered(pou: Pou, new: Mapping[str, str], dialect: Dialect) -> dict[str, list[str]]:
    """Return the actions that share variables and change places as they get `new` names, each with those it passes.

    `new` has the other names of some actions of `pou`, by those that it has, as do the keys of the result.
    """
    found: dict[str, list[str]] = {}
    for own in (each for each in pou.actions if each.name in new):
        for other in sharing(pou, own, dialect):
            before = own.name.casefold() < other.name.casefold()
            after = new[own.name].casefold() < new.get(other.name, other.name).casefold()
            if before is not after:
                found.setdefault(own.name, []).append(other.name)
    return found


def sharing(pou: Pou, action: Action, dialect: Dialect) -> list[Action]:
    """Return the actions that share variables with one, and that a tool executes with it in the order of names.

    None where no association names it: entry, main and exit actions are executed with their steps.
    """
    if family(dialect) is not Dialect.CODESYS:
        return []
    ordered = {(row.target or "").casefold() for chart in every_chart(pou) for _, row in chart.associations()}
    if action.name.casefold() not in ordered:
        return []
    others = [each for each in pou.actions if each is not action and each.name.casefold() in ordered]
    return [each for each in others if _share(action, each, dialect)]


def _share(one: Action, other: Action, dialect: Dialect) -> bool:
    """True if it may matter which of two actions is executed first."""
    first, second = (_effects_of(each, dialect) for each in (one, other))
    if first is None or second is None:
        return True
    pairs = (first, second), (second, first)
    return any(may_change(a.reads | a.writes, b.writes, frozenset()) for a, b in pairs)


def _effects_of(action: Action, dialect: Dialect) -> Effects | None:
    if not isinstance(action.body, StBody):
        return None
    return effects(parse_statements(action.body.text, dialect).tree.statements)
