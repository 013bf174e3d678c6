"""What a chart used and nothing asks for behind it: actions and transition objects whose code is in its own."""

from __future__ import annotations

import re

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.model.body import Body, SfcBody
from plcopen_sfc.model.conditions import NamedCondition
from plcopen_sfc.model.pou import Pou


def without_leftovers(original: Pou, lowered: Pou, dialect: Dialect) -> Pou:
    """`lowered` without the actions and transitions that the charts of `original` used and its code does not call.

    In IEC 61131-3 they are a part of a chart (6.7.4.2, 6.7.3): nothing else can call them, and textual declarations
    with a body of statements have no place for them. In other dialects an action is called from anywhere, and stays.
    """
    called = _called(lowered)
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


def _called(pou: Pou) -> dict[str, Body | None]:
    """The actions whose names the code says, and those that these name: their bodies by name."""
    by_name = {action.name.casefold(): action.body for action in pou.actions}
    called: dict[str, Body | None] = {}
    bodies: list[Body | None] = [*pou.bodies]
    while bodies:
        for name in sorted(_named(bodies.pop()) & by_name.keys() - called.keys()):
            called[name] = by_name[name]
            bodies.append(by_name[name])
    return called


def _named(body: Body | None) -> set[str]:
    """What a body calls, or a box of it is: titles and comments say the names of actions too, in sentences."""
    text = body.model_dump_json().casefold() if body is not None else ""
    return {called or alone for called, alone in re.findall(r'(\w+)\s*\(|"(\w+)"', text)}
