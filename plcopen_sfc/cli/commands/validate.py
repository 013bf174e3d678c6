"""``plcopen-sfc validate``: findings of schema, reader and parser about files."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

from plcopen_sfc.api import check_import, check_syntax
from plcopen_sfc.cli.reading import LoadedFile, error_data, exit_code_for, expand, finding_data, load_each
from plcopen_sfc.cli.screen import Screen
from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.documents.sources import FileSource, documents_of
from plcopen_sfc.formats.registry import format_named


def run(screen: Screen, patterns: Sequence[str], tool: str = "") -> int:
    """Print all findings of all files. `tool`: also what this tool would not do of them, or may not read."""
    results: list[dict[str, Any]] = []
    for loaded in load_each(screen, expand(patterns), "Validating"):
        if loaded.project is None:
            if loaded.error is not None:
                results.append({"file": loaded.name, "valid": False, "error": error_data(loaded.error)})
            continue
        findings = _findings(loaded, tool)
        code = exit_code_for(screen, findings)
        valid = exit_code_for(Screen(), findings) == 0
        screen.exit_code = code
        results.append({"file": loaded.name, "valid": valid, "findings": [finding_data(f) for f in findings]})
        if not screen.as_json:
            _print(screen, loaded.name, findings, valid=valid)
    screen.result({"files": results})
    return screen.exit_code


def _findings(loaded: LoadedFile, tool: str) -> list[Diagnostic]:
    """Return the findings of schema (of formats that have one), reader and parser, by line."""
    found = list(loaded.findings)
    if loaded.project is None:
        return found
    found += check_syntax(loaded.project)
    for document in documents_of(loaded.project):
        source = document.source
        if not isinstance(source, FileSource):
            continue
        kind = format_named(source.format)[0]
        found += kind.codec().validate(source.content, file=source.path)
    if tool and not any(finding.severity is Severity.ERROR for finding in loaded.findings):
        found += check_import(loaded.project, tool)
    found.sort(key=lambda finding: (finding.location.file or "", finding.location.line is None, _line(finding)))
    return found


def _line(finding: Diagnostic) -> int:
    return finding.location.line or 0


def _print(screen: Screen, name: str, findings: list[Diagnostic], *, valid: bool) -> None:
    for finding in findings:
        screen.finding(finding, result=True)
    if screen.quiet:
        return
    counts = Counter(finding.severity.value for finding in findings)
    what = ", ".join(f"{count} {severity}{'s' if count > 1 else ''}" for severity, count in counts.items())
    verdict = ("valid", "green") if valid else ("not valid", "bold red")
    screen.line((f"{name}: ", "bold"), verdict, f" ({what})" if what else "")
