"""What a rule is, and how bad its breach is for whom."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field

from plcopen_sfc.analysis.checks.checked_chart import CheckedChart, FindingPlace
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.semantics.profile import PROFILES

FAMILIES = tuple(PROFILES)
"""The profiles that severities are given for."""


@dataclass(frozen=True, slots=True)
class Finding:
    """A breach of a rule: where, and what is wrong there. `hint` replaces that of the rule where more can be said."""

    place: FindingPlace
    message: str
    hint: str = ""


@dataclass(frozen=True)
class Rule:
    """A numbered rule on charts.

    `why` says what goes wrong with charts that break it, and where that is known from; `hint` what to do. `severity` is
    that of a breach, but for the profiles in `severities`; None: the rule is not for them. `example` is a chart that
    breaks it, in textual SFC where that can say it.
    """

    code: str
    title: str
    why: str
    hint: str
    example: str
    check: Callable[[CheckedChart], Iterator[Finding]]
    severity: Severity | None
    severities: Mapping[str, Severity | None] = field(default_factory=dict)

    def severity_for(self, family: str) -> Severity | None:
        """How bad a breach is under a profile of `FAMILIES`; None: the rule does not apply."""
        return self.severities.get(family, self.severity)
