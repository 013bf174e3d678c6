"""Findings as SARIF 2.1.0 (OASIS, 2020): what code-scanning pages read."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from hashlib import sha256
from pathlib import PurePath, PurePosixPath
from typing import Any
from urllib.parse import quote

from plcopen_sfc.analysis.checks import RULES, Rule
from plcopen_sfc.diagnostics import Diagnostic, Severity
from plcopen_sfc.errors import Location, SfcError
from plcopen_sfc.version import __version__

__all__ = ["sarif"]

_SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"
_LEVELS = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.INFO: "note"}


def sarif(findings: Sequence[Diagnostic], errors: Iterable[SfcError] = ()) -> dict[str, Any]:
    """One run of `check` as a SARIF log. `errors` are those of files that could not be read."""
    places = {rule.code: index for index, rule in enumerate(RULES)}
    notifications = [_notification(error) for error in errors]
    invocation: dict[str, Any] = {"executionSuccessful": not notifications}
    if notifications:
        invocation["toolExecutionNotifications"] = notifications
    run = {
        "tool": {
            "driver": {
                "name": "plcopen-sfc",
                "version": __version__,
                "rules": [_rule(rule) for rule in RULES],
            }
        },
        "invocations": [invocation],
        "columnKind": "unicodeCodePoints",
        "results": [_result(finding, places) for finding in findings],
    }
    return {"$schema": _SCHEMA, "version": "2.1.0", "runs": [run]}


def _rule(rule: Rule) -> dict[str, Any]:
    level = _LEVELS[rule.severity] if rule.severity is not None else "none"
    return {
        "id": rule.code,
        "shortDescription": {"text": rule.title},
        "fullDescription": {"text": rule.why},
        "help": {"text": rule.hint},
        "defaultConfiguration": {"level": level},
    }


def _result(finding: Diagnostic, places: dict[str, int]) -> dict[str, Any]:
    text = f"{finding.message}. {finding.hint}".strip() if finding.hint else finding.message
    result: dict[str, Any] = {
        "ruleId": finding.code,
        "ruleIndex": places[finding.code],
        "level": _LEVELS[finding.severity],
        "message": {"text": text},
    }
    locations = _locations(finding.location)
    if finding.location.path:  # the same finding after an edit that moves it to another line
        what = f"{finding.code} {finding.location.path}"
        result["partialFingerprints"] = {"objectPath/v1": sha256(what.encode()).hexdigest()}
    return result | ({"locations": locations} if locations else {})


def _notification(error: SfcError) -> dict[str, Any]:
    notification: dict[str, Any] = {"level": "error", "message": {"text": error.message}}
    locations = _locations(error.location)
    return notification | ({"locations": locations} if locations else {})


def _locations(location: Location) -> list[dict[str, Any]]:
    found: dict[str, Any] = {}
    if location.file:
        physical: dict[str, Any] = {"artifactLocation": {"uri": _uri(location.file)}}
        if location.line is not None:
            region = {"startLine": location.line}
            if location.column is not None:
                region["startColumn"] = location.column
            physical["region"] = region
        found["physicalLocation"] = physical
    if location.path:
        found["logicalLocations"] = [{"fullyQualifiedName": location.path}]
    return [found] if found else []


def _uri(file: str) -> str:
    """A relative path as a relative reference, an absolute one as a file URI (RFC 3986)."""
    path = PurePath(file)
    if path.is_absolute():
        return path.as_uri()
    return quote(str(PurePosixPath(*path.parts)))
