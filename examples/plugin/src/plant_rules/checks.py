"""A rule of the plant for `plcopen-sfc check`."""

from __future__ import annotations

from collections.abc import Iterator

from plcopen_sfc.analysis.checks import Finding, Rule
from plcopen_sfc.analysis.checks.checked_chart import CheckedChart
from plcopen_sfc.diagnostics import Severity


def _names(chart: CheckedChart) -> Iterator[Finding]:
    for sheet in chart.sheets:
        for step in sheet.steps:
            if not step.name.startswith("S_"):
                yield Finding(sheet.at(step), f"the name of step {step.name} does not begin with S_")


PLT01 = Rule(
    code="PLT01",
    title="Names of steps begin with S_",
    why="The visualisation of the plant finds steps by that.",
    hint="plcopen-sfc apply plant-names FILE --write",
    example="a step Fill",
    check=_names,
    severity=Severity.WARNING,
)
