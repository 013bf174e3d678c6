"""``plcopen-sfc info``: what files hold."""

from __future__ import annotations

from functools import partial
from typing import Any

from plcopen_sfc.cli.command_files import exit_code_for, finding_data, load_input
from plcopen_sfc.cli.many_files import ManyFiles, for_each
from plcopen_sfc.cli.screen import Screen, Table
from plcopen_sfc.cli.summary import FileSummary, all_charts, outline, summarise
from plcopen_sfc.formats.registry import format_named
from plcopen_sfc.model.project import FileHeader, Project
from plcopen_sfc.whole_numbers import counted

_FEW_CHARTS = 4


def run(screen: Screen, files: ManyFiles, *, charts: bool | None) -> int:
    """Print a summary of every file. `charts`: an outline of every one too; None: where there are few, of one file."""
    several = len(files.found) > 1
    work = partial(_inform, not several if charts is None else charts, charts is None, several)
    outcomes = for_each(screen, [*files.found], work, "Reading", jobs=files.jobs)
    screen.result({"files": [each.as_dict() for each in outcomes]})
    return screen.exit_code


def _inform(outlines: bool, few_only: bool, several: bool, screen: Screen, name: str) -> dict[str, Any]:
    project = load_input(screen, name)
    findings = project.diagnostics  # reads the charts, too, before anything is printed of them
    summary = summarise(name, project)
    if not screen.as_json:
        _print_file(screen, summary)
        if outlines and not (few_only and len(summary.charts) > _FEW_CHARTS):
            _print_outlines(screen, project)
        if several:
            screen.line()
        screen.flush()
    for finding in findings:
        screen.finding(finding, result=False)
    screen.exit_code = exit_code_for(screen, findings)
    return summary.as_dict() | {"findings": [finding_data(finding) for finding in findings]}


def _print_file(screen: Screen, summary: FileSummary) -> None:
    screen.line((summary.file, "bold"))
    kinds = {_KINDS.get(kind, kind): count for kind, count in summary.pous.items()}
    pous = ", ".join(counted(count, kind) for kind, count in kinds.items())
    bodies = ", ".join(f"{count} {language}" for language, count in summary.languages.items())
    facts = {
        "format": f"{summary.format} ({', '.join(filter(None, (summary.format_title, summary.dialect)))})",
        "tool": FileHeader(product=summary.tool, version=summary.tool_version).tool,
        "project": summary.project,
        "file": f"{_count(summary)}{summary.size:,} bytes, {summary.encoding}, {summary.line_ends}",
        "POUs": pous,
        "bodies": bodies,
        "rules": _rules(summary),
        "blocks": _first(summary.blocks or []),
        "texts": ", ".join(summary.cultures or []),
        "GRAPH": ", ".join(dict.fromkeys(chart.graph_version for chart in summary.charts if chart.graph_version)),
    }
    for label, value in facts.items():
        if value:
            screen.line((f"  {label:<9}", "dim"), value)
    if not summary.charts:
        screen.line(("  charts   ", "dim"), "none")
        return
    screen.line()
    screen.table(_chart_table(summary))


def _rules(summary: FileSummary) -> str:
    if not summary.rules:
        return ""
    kind = format_named(summary.kept_of)[0] if summary.kept_of else None
    kept = f" ({f'charts of {kind.tool}' if kind.tool else kind.title}, which the file keeps)" if kind else ""
    return f"execution profile {summary.rules}{kept}"


def _first(names: list[str]) -> str:
    more = f" and {len(names) - _FEW_BLOCKS} more" if len(names) > _FEW_BLOCKS else ""
    return ", ".join(names[:_FEW_BLOCKS]) + more


_FEW_BLOCKS = 12


def _count(summary: FileSummary) -> str:
    return f"{summary.documents} documents, " if summary.documents is not None else ""


def _chart_table(summary: FileSummary) -> Table:
    columns = {
        "steps": ("steps", "steps"),
        "transitions": ("trans.", "transitions"),
        "selections": ("sel.", "selections"),
        "simultaneous": ("sim.", "simultaneous_branches"),
        "jumps": ("jumps", "jumps"),
        "actions": ("act.", "action_associations"),
        "step actions": ("st.act.", "step_actions"),
        "named conditions": ("named", "named_conditions"),
        "macro-steps": ("macro", "macro_steps"),
    }
    if any(chart.sequences for chart in summary.charts):
        columns |= {
            "sequences": ("seq.", "sequences"),
            "interlocks": ("interl.", "interlocks"),
            "supervisions": ("superv.", "supervisions"),
        }
    names = [name for _, name in columns.values()]
    totals = summary.totals()
    table = Table(["chart", "initial step", *columns], ["chart", "initial", *(short for short, _ in columns.values())])
    for chart in summary.charts:
        numbers = [getattr(chart, name) for name in names]
        initial = ", ".join(chart.initial_steps) or "none"
        table.rows.append([chart.name, initial, *("-" if number is None else number for number in numbers)])
    if len(summary.charts) > 1:
        table.total = True
        table.rows.append([f"{len(summary.charts)} charts", "", *(totals.get(name, 0) for name in names)])
    return table


def _print_outlines(screen: Screen, project: Project) -> None:
    for name, _, chart in all_charts(project):
        screen.line()
        screen.line((name, "bold underline"))
        screen.lines(outline(chart, unicode=screen.unicode, dialect=project.dialect))


_KINDS = {"functionBlock": "function block", "organizationBlock": "organization block"}
