"""Bodies that alone see the variables of their POU: what their statements do to these is all that is done to them.

`sole_statements` are those of a single body in their order, `all_nodes` what stands in any body of a POU, in no order.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

from plcopen_sfc.languages.binding import bind, is_named_elsewhere
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st.walking import walk
from plcopen_sfc.model.body import IlBody
from plcopen_sfc.model.pou import PouKind
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.semantics.programs.controller import Instance

__all__ = ["all_nodes", "sole_statements"]

_ALIASES = (n.Dereference, n.Peripheral)
_JUMPS = (n.Goto, n.Label, n.Try, n.EmbeddedCode, n.Unreadable)


@lru_cache(maxsize=2)  # both sides of a comparison ask more than once
def sole_statements(instance: Instance) -> Sequence[n.Statement] | None:
    """The statements of the only body of a POU, if it alone sees the variables, and by their names only.

    None for what is not one body of text, FBD or LD without actions and methods, which see the variables too, or where
    references or jumps are used.
    """
    pou, project = instance.unit.pou, instance.controller.project
    if len(pou.bodies) != 1 or pou.actions or pou.methods or pou.transitions or instance.unit.base is not None:
        return None
    if pou.kind is PouKind.PROGRAM and is_named_elsewhere(pou, project):
        return None
    statements = bind(pou.bodies[0], project.dialect).program
    if statements is None:
        return None
    for node in (node for statement in statements for node in walk(statement)):
        if isinstance(node, _ALIASES + _JUMPS):
            return None
        if isinstance(node, n.Assignment) and node.kind in (n.AssignmentKind.REFERENCE, n.AssignmentKind.ATTEMPT):
            return None
        if isinstance(node, n.Call) and isinstance(node.callee, n.Name) and node.callee.identifier.upper() == "ADR":
            return None
    return statements


@lru_cache(maxsize=2)
def all_nodes(instance: Instance) -> list[n.Node] | None:
    """The statements and expressions of all bodies of a POU, its actions and charts, if they alone see the variables.

    Variables may also be reached by references. None where not all is known.
    """
    sole = sole_statements(instance)
    if sole is not None:
        return [*sole]
    pou, project = instance.unit.pou, instance.controller.project
    if pou.methods or instance.unit.base is not None:
        return None
    if pou.kind is PouKind.PROGRAM and is_named_elsewhere(pou, project):
        return None
    named = [*(action.body for action in pou.actions), *(transition.body for transition in pou.transitions)]
    bodies = [*pou.bodies, *(body for body in named if body is not None)]
    found: list[n.Node] = []
    while bodies:
        bound = bind(bodies.pop(), project.dialect)
        if isinstance(bound.body, IlBody) or bound.unknown or bound.helpers:
            return None
        if any(_is_divided(texts.chart) for texts in bound.charts):
            return None
        found += bound.trees
        bodies += [body for texts in bound.charts for body in texts.bodies]
    return found


def _is_divided(chart: SfcNetwork) -> bool:
    """True if a chart has parts that are executed in another way than its steps."""
    operations = chart.permanent_pre or chart.permanent_post
    return bool(chart.partial_charts or operations or any(step.macro for step in chart.steps))
