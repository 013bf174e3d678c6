"""What a chart used and nothing asks for behind it: actions and transition objects whose code is in its own."""

from __future__ import annotations

from plcopen_sfc.languages.binding import called_actions
from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.model.body import Body, SfcBody
from plcopen_sfc.model.conditions import NamedCondition
from plcopen_sfc.model.pou import Pou


def without_leftovers(original: Pou, lowered: Pou, dialect: Dialect) -> Pou:
    """`lowered` without the actions and transitions that the charts of `original` used and its code does not call.

    In IEC 61131-3 they are a part of a chart (6.7.4.2, 6.7.3): nothing else can call them, and textual declarations
    with a body of statements have no place for them. In other dialects an action is called from anywhere, and stays.
    """
    called = _called(lowered, dialect)
    charts = [body for body in (*lowered.bodies, *(called.values())) if isinstance(body, SfcBody)]
    if dialect is not Dialect.IEC or charts:
        return lowered
    actions, transitions = _used(original)
    lowered.actions = [
        each for each in lowered.actions if each.name.casefold() in called or each.name.casefold() not in actions
    ]
    lowered.transitions = [each for each in lowered.transitions if each.name.casefold() not in transitions]
    return lowered


def _used(pou: Pou) -> tuple[set[str], set[str]]:
    """The names of actions and of transition objects in the charts of a POU."""
    actions: set[str] = set()
    transitions: set[str] = set()
    for body in (*pou.bodies, *(action.body for action in pou.actions)):
        if isinstance(body, SfcBody):
            actions |= {each.target.casefold() for _, each in body.chart.associations() if each.target is not None}
            conditions = (transition.condition for transition in body.chart.transitions)
            transitions |= {each.name.casefold() for each in conditions if isinstance(each, NamedCondition)}
    return actions, transitions


def _called(pou: Pou, dialect: Dialect) -> dict[str, Body | None]:
    """The actions that the code calls, and those that these call: their bodies by name."""
    by_name = {action.name.casefold(): action.body for action in pou.actions}
    called: dict[str, Body | None] = {}
    bodies: list[Body | None] = [*pou.bodies]
    while bodies:
        for name in sorted(called_actions(bodies.pop(), pou, dialect) - called.keys()):
            called[name] = by_name[name]
            bodies.append(by_name[name])
    return called
