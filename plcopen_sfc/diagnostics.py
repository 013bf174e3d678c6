"""Findings: what a reader, a schema or a check has to say about a file, with a stable code each."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum

from plcopen_sfc.errors import Location


class Severity(StrEnum):
    """How bad a finding is."""

    ERROR = "error"
    WARNING = "warning"
    INFO = "info"


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One finding. `code` is stable (``SFC101``) and documented in docs/diagnostics.md, or docs/checks.md (``STR01``).

    `hint` says what to do about it; it may be empty.
    """

    code: str
    severity: Severity
    message: str
    location: Location = field(default_factory=Location)
    hint: str = ""

    def __str__(self) -> str:
        place = str(self.location)
        return f"{place}: {self.severity} {self.code}: {self.message}" if place else f"{self.code}: {self.message}"
