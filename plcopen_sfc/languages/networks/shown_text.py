"""Drawn conditions and bodies, FBD and LD, as structured text for formats that hold no drawings."""

from __future__ import annotations

from collections.abc import Iterable

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.networks.drawn_conditions import condition_expression
from plcopen_sfc.languages.networks.network_reading import body_statements
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.languages.st.nodes import Assignment, Name, Statements
from plcopen_sfc.languages.words import is_plain
from plcopen_sfc.model.body import FbdBody, LdBody
from plcopen_sfc.model.conditions import NamedCondition
from plcopen_sfc.model.pou import NamedTransition
from plcopen_sfc.model.sfc import SfcNetwork, Transition


def shown_condition(
    chart: SfcNetwork, transition: Transition, dialect: Dialect, objects: Iterable[NamedTransition]
) -> tuple[str, bool] | None:
    """Return the condition as an expression, or, where blocks are called before it, as statements (True).

    None where no text expresses it: it needs undeclared variables, such as for edges.
    """
    found = condition_expression(chart, transition, dialect, transitions=objects)
    if found.tree is None or found.helpers or found.obstacles:
        return None
    if not found.before:
        return print_node(found.tree, dialect), False
    if any(isinstance(statement, Assignment) for statement in found.before):
        return None  # the assignment that gives the condition could not be found among several
    name = transition.name if is_plain(transition.name) else "Condition"
    statements = Statements((*found.before, Assignment(Name(name), found.tree)))
    return print_node(statements, dialect), True


def shown_named_condition(transition: NamedTransition, dialect: Dialect) -> tuple[str, bool] | None:
    """Return the condition of a transition object that is drawn."""
    chart = SfcNetwork(transitions=[Transition(id=0, name=transition.name)])
    chart.transitions[0].condition = NamedCondition(name=transition.name)
    return shown_condition(chart, chart.transitions[0], dialect, [transition])


def shown_body(body: FbdBody | LdBody, dialect: Dialect) -> str | None:
    """Return the body as statements; None where they cannot express it, or need undeclared variables."""
    found = body_statements(body, dialect)
    if found.helpers or found.obstacles:
        return None
    return print_node(found.tree, dialect) or None
