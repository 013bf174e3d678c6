"""Conditions in instruction list as expressions, for charts of tools that have no others."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.languages.binding.name_uses import dialect_of
from plcopen_sfc.languages.il_expressions import result_expression
from plcopen_sfc.languages.st import print_node
from plcopen_sfc.model.body import IlBody
from plcopen_sfc.model.conditions import BodyCondition, Expression
from plcopen_sfc.model.project import Project


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
                transition.condition = Expression(text=print_node(tree, dialect), negated=condition.negated)
                yield f"{chart.report_path} / transition {chart.chart.label(transition)}"
