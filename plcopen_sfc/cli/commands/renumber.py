"""``plcopen-sfc renumber``: number the steps of charts along the flow, and name them by their numbers."""

from __future__ import annotations

from dataclasses import dataclass

from plcopen_sfc.cli.editing import finish
from plcopen_sfc.cli.reading import load_input
from plcopen_sfc.cli.screen import Screen
from plcopen_sfc.errors import ModelError


@dataclass(frozen=True)
class Numbering:
    """Arguments of `Editor.renumber`, and the POU whose charts are numbered (empty: all)."""

    start: int
    increment: int
    names: str
    pou: str


def run(screen: Screen, file: str, how: Numbering, *, dry_run: bool) -> int:
    """Renumber the charts in `file` (``-``: from standard input to standard output)."""
    project = load_input(screen, file)
    found, wanted = [*project.charts()], how.pou.casefold()
    charts = [each.chart for each in found if wanted in ("", each.name.casefold(), each.pou.name.casefold())]
    if not charts:
        known = ", ".join(each.name for each in found)
        raise ModelError(f"{file} has no chart {how.pou!r}", hint=f"It has: {known}" if known else "It has none.")
    if not how.names:
        charts = [each for each in charts if any(step.number is not None for step in each.steps)]
    if not charts:
        raise ModelError(f"{file} has no chart with numbers", hint='Give names: --names "S{number}".')
    before = [(step, step.name, step.number) for chart in charts for step in chart.steps]
    project.edit().renumber(how.start, how.increment, charts=charts, names=how.names)
    changed = [(step, name) for step, name, number in before if (step.name, step.number) != (name, number)]

    def tell() -> None:
        screen.line(f"{len(changed)} of {len(before)} steps have other numbers or names")
        for step, name in changed if screen.verbose else ():
            screen.line(f"  {name} -> {step.name}" + (f", number {step.number}" if step.number is not None else ""))

    steps = [{"old": name, "name": step.name, "number": step.number} for step, name in changed]
    finish(screen, file, project, {"file": file, "changed": steps}, tell, dry_run=dry_run)
    return 0
