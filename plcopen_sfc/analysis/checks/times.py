"""Minimum, warning and maximum times of steps."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.analysis.checks.charts import CheckedChart
from plcopen_sfc.analysis.checks.rules import Finding, Rule
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.languages.st.literals import LiteralError, LiteralKind, literal_value


def _nanoseconds(text: str | None) -> int | None:
    """A time literal; None for anything else, and for 0, which tools write for no time."""
    if not text:
        return None
    try:
        found = literal_value(text)
    except LiteralError:
        return None
    return found.value if found.kind is LiteralKind.DURATION and isinstance(found.value, int) and found.value else None


def _order(chart: CheckedChart) -> Iterator[Finding]:
    for sheet in chart.sheets:
        for step in sheet.steps:
            greatest = _nanoseconds(step.max_time)
            for what, time in (("minimum", step.min_time), ("warning", step.warning_time)):
                given = _nanoseconds(time)
                if greatest is not None and given is not None and given > greatest:
                    message = f"the {what} time {time} is longer than the maximum time {step.max_time}"
                    yield Finding(sheet.at(step), message)


TIM01 = Rule(
    code="TIM01",
    title="The maximum time of a step is its longest",
    why="A step that must stay active longer than it may reports an error in every round (CODESYS, minimum and "
    "maximum time); a warning after the error warns of nothing (S7-GRAPH, warning time).",
    hint="Correct one of the times.",
    example="a step with the minimum time T#5s and the maximum time T#3s",
    check=_order,
    severity=Severity.WARNING,
)
