"""Bodies that alone see the variables of their POU: what their statements do to these is all that is done to them.

`sole_statements` are those of a single body in their order, `all_nodes` what stands in any body of a POU, in no order.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache

from plcopen_sfc.languages.dialects import Dialect
from plcopen_sfc.languages.networks import body_statements, chart_statements, condition_reader
from plcopen_sfc.languages.st import nodes as n
from plcopen_sfc.languages.st import parse_expression, parse_statements
from plcopen_sfc.languages.st.walking import walk
from plcopen_sfc.model.body import Body, FbdBody, LdBody, SfcBody, StBody
from plcopen_sfc.model.pou import Pou, PouKind
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.semantics.programs.instances import Instance

__all__ = ["all_nodes", "path_names", "sole_statements"]

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
    if pou.kind is PouKind.PROGRAM and _seen_by_others(pou, project.pous):
        return None
    statements = _of_body(pou.bodies[0], project.dialect)
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


def _seen_by_others(pou: Pou, others: Iterable[Pou]) -> bool:
    """Whether another POU of the project names this one, as in ``Main.x``."""
    name = re.compile(rf"\b{re.escape(pou.name)}\b", re.IGNORECASE)
    return any(name.search(each.model_dump_json()) for each in others if each.name != pou.name)


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
    if pou.kind is PouKind.PROGRAM and _seen_by_others(pou, project.pous):
        return None
    found: list[n.Node] = []
    for body in [*pou.bodies, *(action.body for action in pou.actions)]:
        inside: Sequence[n.Node] | None = (
            _of_chart(body.chart, pou, project.dialect)
            if isinstance(body, SfcBody)
            else _of_body(body, project.dialect)
        )
        if inside is None:
            return None
        found += inside
    return found


def _of_body(body: Body | None, dialect: Dialect) -> Sequence[n.Statement] | None:
    """The statements of a body of text, FBD or LD; None for any other, or one that is not read completely."""
    if isinstance(body, StBody):
        parsed = parse_statements(body.text, dialect)
        return None if parsed.problems else parsed.tree.statements
    if not isinstance(body, FbdBody | LdBody):
        return None
    read = body_statements(body, dialect)
    return None if read.obstacles or read.helpers else read.tree.statements


def _of_chart(chart: SfcNetwork, pou: Pou, dialect: Dialect) -> list[n.Node] | None:
    """What stands in conditions, actions and the logic of a chart, and what actions name."""
    if chart.partial_charts or chart.permanent_pre or chart.permanent_post or any(step.macro for step in chart.steps):
        return None
    logic = chart_statements(chart, dialect)
    if logic.obstacles or logic.helpers:
        return None
    found: list[n.Node] = [*logic.tree.statements]
    reader = condition_reader(chart, dialect, transitions=pou.transitions)
    associations = [association for _, association in chart.associations()]
    supervised = [each for step in chart.steps for each in (step.interlock, step.supervision) if each is not None]
    conditions = [each.condition for each in chart.transitions] + [each.condition for each in associations]
    for condition in conditions + [each.condition for each in supervised]:
        if condition is not None:
            read = reader(condition)
            if read.tree is None or read.obstacles or read.helpers:
                return None
            found += [*read.before, read.tree]
    acting = [getattr(step, kind) for step in chart.steps for kind in ("entry_action", "main_action", "exit_action")]
    for body in [*(each.body for each in associations), *acting]:
        if body is None or body == "":
            continue
        inside = [*_expressions([body], dialect)] if isinstance(body, str) else _of_body(body, dialect)
        if inside is None:
            return None
        found += inside
    texts = [text for each in associations for text in (each.target, each.value, each.duration) if text]
    return [*found, *_expressions(texts, dialect)]


def _expressions(texts: Iterable[str], dialect: Dialect) -> Iterator[n.Node]:
    """Expressions; of a text that is none, whatever was understood of it."""
    for text in texts:
        yield parse_expression(text, dialect).tree


def path_names(node: n.Node) -> list[str] | None:
    """The names of a path in lower case; None: that is none."""
    parts: list[str] = []
    while isinstance(node, n.Member):
        parts.append(node.name.identifier.casefold())
        node = node.base
    return [node.identifier.casefold(), *reversed(parts)] if isinstance(node, n.Name) else None
