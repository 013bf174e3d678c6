"""Findings: what a reader, a schema or a check has to say about a file, with a stable code each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum

from plcopen_sfc.errors import Location, SfcError


class Severity(StrEnum):
    """Severity of a finding."""

    ERROR = "error"
    WARNING = "warning"
    INFO = "info"


OUTDATED = "XML214"
"""Code of what a file keeps of its source, and its tool has edited since."""


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One finding. `code` is stable (``SFC101``) and documented in docs/diagnostics.md, or docs/checks.md (``STR01``).

    `hint` tells how to mend it; it may be empty.
    """

    code: str
    severity: Severity
    message: str
    location: Location = field(default_factory=Location)
    hint: str = ""

    def __str__(self) -> str:
        place = str(self.location)
        return f"{place}: {self.severity} {self.code}: {self.message}" if place else f"{self.code}: {self.message}"


class DamagedSourceError(SfcError):
    """A project whose reading found errors was to be written in another format. Nothing was written.

    `findings` are the errors. See `Project.accept_errors`.
    """

    def __init__(self, findings: Sequence[Diagnostic]) -> None:
        self.findings = tuple(findings)
        listed = "; ".join(f"{each.code}: {each.message}" for each in self.findings[:_NAMED])
        more = f"; and {len(self.findings) - _NAMED} more" if len(self.findings) > _NAMED else ""
        count = f"{len(self.findings)} errors were" if len(self.findings) > 1 else "an error was"
        super().__init__(
            f"{count} found in reading, so that what is written might do something else: {listed}{more}",
            location=self.findings[0].location,
            hint="Nothing was written. Mend the file in its tool; saving it in its own format keeps everything. "
            "--accept-errors (Project.accept_errors) writes what could be read.",
        )


_NAMED = 3
