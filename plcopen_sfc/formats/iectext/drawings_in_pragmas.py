"""Conditions and bodies that are drawn, FBD and LD, beside structured text with the same meaning.

Other tools and people read the text; the drawing is in pragmas at the end of the unit, and counts as long as the
text is the one it was written with.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.networks import body_statements, condition_expression
from plcopen_sfc.languages.pragmas import Fields, RemainderEntry
from plcopen_sfc.languages.pragmas.remainder import Segment, additions
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.languages.st.nodes import Assignment, Name, Statements
from plcopen_sfc.languages.words import is_plain
from plcopen_sfc.model.body import FbdBody, LdBody
from plcopen_sfc.model.conditions import NamedCondition
from plcopen_sfc.model.pou import NamedTransition
from plcopen_sfc.model.sfc import SfcNetwork, Transition

DRAWN = "drawn"
_SHOWN = "shown"
_LONG = 80


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


def drawn_changes(intended: Fields, shown: str, place: tuple[Segment, ...]) -> list[RemainderEntry]:
    """Pragmas that hold the drawing `intended` of the text at `place`."""
    path = (*place, DRAWN)
    return [RemainderEntry((*path, _SHOWN), _mark(shown)), *additions(intended, path)]


def put_drawing(fields: Fields, field: str) -> bool:
    """Replace the text in `field` by its drawing. False: the text was changed, so the drawing is left out."""
    drawing = fields.pop(DRAWN, None)
    if not isinstance(drawing, dict):
        return True
    mark = drawing.pop(_SHOWN, None)
    found: Fields = fields.get(field) or {}
    read_back: Fields = found.get("body", found)  # a condition may be statements
    if _mark(str(read_back.get("text", read_back.get("name", "")))) != mark:
        return False
    fields[field] = drawing
    return True


def _mark(text: str) -> str:
    """Return the text, or of a long one a digest."""
    return text if len(text) <= _LONG else "#" + hashlib.sha256(text.encode()).hexdigest()[:12]
