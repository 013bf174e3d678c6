"""The check of the comments that let findings be."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from plcopen_sfc.analysis.checks.charts import CheckedChart, Place
from plcopen_sfc.analysis.checks.rules import Finding, Rule
from plcopen_sfc.analysis.checks.suppression import codes_in, marks_in
from plcopen_sfc.diagnostics import Severity


def _places(chart: CheckedChart) -> Iterator[Place]:
    for sheet in chart.sheets:
        yield sheet.place
        for step in sheet.steps:
            yield sheet.at(step)
        for transition in sheet.transitions:
            yield sheet.at(transition)
        for step, association in sheet.actions():
            yield sheet.at(step, association)


def rule_on(codes: Iterable[str]) -> Rule:
    """The rule that comments name codes, of these."""
    known = tuple(codes)

    def check(chart: CheckedChart) -> Iterator[Finding]:
        for place in _places(chart):
            element = place.elements[0]
            listed = list(codes_in(element))
            for code in listed:
                if not any(each.startswith(code) for each in known):
                    yield Finding(place, f"the comment lets {code} be, and there is no such rule")
            if marks_in(element) and not listed:
                yield Finding(place, "the comment lets nothing be: it names no rule")

    return Rule(
        code="CHK01",
        title="Comments that let findings be name rules",
        why="A misspelt code lets nothing be.",
        hint="Write plcopen-sfc: ignore and the codes behind it, with commas between.",
        example="the comment plcopen-sfc: ignore STR99",
        check=check,
        severity=Severity.WARNING,
    )
