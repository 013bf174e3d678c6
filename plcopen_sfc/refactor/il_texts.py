"""Bodies in instruction list, drawn ones, and networks of exports as structured text, for tools that have no others."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import TypeGuard

from plcopen_sfc.languages.binding.name_uses import dialect_of
from plcopen_sfc.languages.il import result_expression, statements
from plcopen_sfc.languages.networks import shown_body, shown_named_condition
from plcopen_sfc.languages.networks.exported_networks import network_statements
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.model.body import FbdBody, IlBody, LdBody, OpaqueBody, StBody
from plcopen_sfc.model.conditions import Expression
from plcopen_sfc.model.dialect import Dialect
from plcopen_sfc.model.pou import Action, Method
from plcopen_sfc.model.project import Project
from plcopen_sfc.model.sfc import Body, BodyCondition


def write_conditions_as_expressions(project: Project) -> Iterator[str]:
    """Write the conditions in IL that only compute a value as expressions, and yield the paths of the transitions."""
    dialect = dialect_of(project)
    for chart in project.charts():
        for transition in chart.chart.transitions:
            condition = transition.condition
            if not isinstance(condition, BodyCondition) or not isinstance(condition.body, IlBody):
                continue
            tree = result_expression(condition.body.text, dialect, stored_in=condition.name)
            if tree is not None:
                transition.condition = Expression(text=print_node(tree), negated=condition.negated)
                yield f"{chart.report_path} / transition {chart.chart.label(transition)}"


def write_bodies_as_statements(project: Project) -> Iterator[str]:
    """Write the bodies in IL without jumps as structured text, and yield the paths of what they are the bodies of."""
    return _written(project, _of_instructions)


def write_exported_networks_as_statements(project: Project, source: str) -> Iterator[str]:
    """Write the networks in the form of files of a format as structured text, and yield the paths of their owners."""
    yield from _written(project, partial(_of_exported_networks, source=source))
    dialect = dialect_of(project)
    for pou in project.pous:
        for part in pou.transitions:
            shown = shown_named_condition(part, dialect) if _is_of(part.body, source) else None
            if shown is not None and not shown[1]:
                part.body = StBody(text=shown[0])
                yield pou.report_path_of(f"{pou.name}.{part.name}")


def _written(project: Project, as_statements: Callable[[Body | str | None, Dialect], StBody | None]) -> Iterator[str]:
    """Replace the bodies for which there are statements, and yield the paths of what they are the bodies of."""
    dialect = dialect_of(project)
    for pou in project.pous:
        for place, body in enumerate(pou.bodies):
            if (found := as_statements(body, dialect)) is not None:
                pou.bodies[place] = found
                yield pou.report_path
        parts: list[Action | Method] = [*pou.actions, *pou.methods]
        for part in parts:
            if (found := as_statements(part.body, dialect)) is not None:
                part.body = found
                yield pou.report_path_of(f"{pou.name}.{part.name}")
    for chart in project.charts():
        for step, association in chart.chart.associations():
            if (found := as_statements(association.body, dialect)) is not None:
                association.body = found
                yield f"{chart.report_path} / step {step.name}"
        for step in chart.chart.steps:
            for name in ("entry_action", "main_action", "exit_action"):
                if (found := as_statements(getattr(step, name), dialect)) is not None:
                    setattr(step, name, found)
                    yield f"{chart.report_path} / step {step.name}"


def write_drawn_pous_as_statements(project: Project) -> Iterator[str]:
    """Write the drawn bodies of POUs as structured text, where it needs no more variables, and yield their paths."""
    dialect = dialect_of(project)
    for pou in project.pous:
        for place, body in enumerate(pou.bodies):
            text = shown_body(body, dialect) if isinstance(body, FbdBody | LdBody) else None
            if text is not None:
                pou.bodies[place] = StBody(text=text, worksheet=body.worksheet)
                yield pou.report_path


def _is_of(body: Body | str | None, source: str) -> TypeGuard[OpaqueBody]:
    return isinstance(body, OpaqueBody) and body.source == source


def _of_exported_networks(body: Body | str | None, _: Dialect, *, source: str) -> StBody | None:
    text = network_statements(body.content) if _is_of(body, source) else None
    return StBody(text=text) if text is not None else None


def _of_instructions(body: Body | str | None, dialect: Dialect) -> StBody | None:
    if not isinstance(body, IlBody) or (tree := statements(body.text, dialect)) is None:
        return None
    return StBody(text=print_node(tree), worksheet=body.worksheet)
