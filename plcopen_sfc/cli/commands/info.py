"""``plcopen-sfc info``: what files hold."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from plcopen_sfc.cli.reading import error_data, exit_code_for, expand, finding_data, load_each
from plcopen_sfc.cli.screen import Screen, Table
from plcopen_sfc.cli.summary import FileSummary, all_charts, outline, summarise
from plcopen_sfc.model.project import Project

_FEW_CHARTS = 4


def run(screen: Screen, patterns: Sequence[str], *, outlines: bool | None) -> int:
    """Print a summary of every file. `outlines`: of every chart too; None: where there are few."""
    names = expand(patterns)
    results: list[dict[str, Any]] = []
    for loaded in load_each(screen, names):
        if loaded.project is None:
            if loaded.error is not None:
                results.append({"file": loaded.name, "error": error_data(loaded.error)})
            continue
        project, findings = loaded.project, loaded.findings
        summary = summarise(loaded.name, project)
        if not screen.as_json:
            if results:
                screen.line()
            _print_file(screen, summary)
            few = len(names) == 1 and len(summary.charts) <= _FEW_CHARTS
            if outlines or (outlines is None and few):
                _print_outlines(screen, project)
            screen.flush()
        results.append(summary.as_dict() | {"findings": [finding_data(finding) for finding in findings]})
        for finding in findings:
            screen.finding(finding, result=False)
        screen.exit_code = exit_code_for(screen, findings)
    screen.result({"files": results})
    return screen.exit_code


def _print_file(screen: Screen, summary: FileSummary) -> None:
    screen.line((summary.file, "bold"))
    kinds = {_KINDS.get(kind, kind): count for kind, count in summary.pous.items()}
    pous = ", ".join(f"{count} {kind}{'s' if count > 1 else ''}" for kind, count in kinds.items())
    bodies = ", ".join(f"{count} {language}" for language, count in summary.languages.items())
    facts = {
        "format": f"{summary.format} ({', '.join(filter(None, (summary.format_title, summary.dialect)))})",
        "tool": f"{summary.tool} {_without(summary.tool_version, summary.tool)}".strip(),
        "project": summary.project,
        "file": f"{_count(summary)}{summary.size:,} bytes, {summary.encoding}, {summary.line_ends}",
        "POUs": pous,
        "bodies": bodies,
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


def _without(version: str, tool: str) -> str:
    """The version alone, where the file repeats the tool's name in it."""
    return version.removeprefix(tool).strip() if tool else version


_KINDS = {"functionBlock": "function block", "organizationBlock": "organization block"}
