"""``plcopen-sfc validate``: findings of schema, reader and parser about files."""

from __future__ import annotations

from collections import Counter
from functools import partial
from typing import Any

from plcopen_sfc.api import check_import, check_syntax
from plcopen_sfc.cli.command_files import exit_code_for, finding_data, load_input
from plcopen_sfc.cli.many_files import ManyFiles, for_each
from plcopen_sfc.cli.screen import Screen
from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.documents.sources import FileSource, documents_of
from plcopen_sfc.formats.registry import format_named
from plcopen_sfc.model.project import Project
from plcopen_sfc.whole_numbers import counted


def run(screen: Screen, files: ManyFiles, tool: str) -> int:
    """Print all findings of all files. `tool`: also what this tool would not do of them, or may not read."""
    outcomes = for_each(screen, [*files.found], partial(_validate, tool), "Validating", jobs=files.jobs)
    failed = {"valid": False}
    screen.result({"files": [each.as_dict() | (failed if each.error is not None else {}) for each in outcomes]})
    return screen.exit_code


def _validate(tool: str, screen: Screen, name: str) -> dict[str, Any]:
    findings = _findings(load_input(screen, name), tool)
    valid = exit_code_for(Screen(), findings) == 0
    screen.exit_code = exit_code_for(screen, findings)
    if not screen.as_json:
        _print(screen, name, findings, valid=valid)
    return {"file": name, "valid": valid, "findings": [finding_data(finding) for finding in findings]}


def _findings(project: Project, tool: str) -> list[Diagnostic]:
    """Return the findings of schema (of formats that have one), reader and parser, by line."""
    read = project.diagnostics
    found = [*read, *check_syntax(project)]
    for document in documents_of(project):
        source = document.source
        if not isinstance(source, FileSource):
            continue
        kind = format_named(source.format)[0]
        found += kind.codec().validate(source.content, file=source.path)
    if tool and not any(finding.severity is Severity.ERROR for finding in read):
        found += check_import(project, tool)
    found.sort(key=lambda each: (each.location.file or "", each.location.line is None, each.location.line or 0))
    return found


def _print(screen: Screen, name: str, findings: list[Diagnostic], *, valid: bool) -> None:
    for finding in findings:
        screen.finding(finding, result=True)
    if screen.quiet:
        return
    counts = Counter(finding.severity.value for finding in findings)
    what = ", ".join(counted(count, severity) for severity, count in counts.items())
    verdict = ("valid", "green") if valid else ("not valid", "bold red")
    screen.line((f"{name}: ", "bold"), verdict, f" ({what})" if what else "")
