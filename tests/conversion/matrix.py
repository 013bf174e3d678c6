"""Outcome of each feature in each target, judged by running the source and what the target tool reads of it.

``python -m tests.conversion.matrix`` prints the table of docs/conversion.md.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from tempfile import TemporaryDirectory

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import Verdict, equivalent
from plcopen_sfc.analysis.pairing import Delay
from plcopen_sfc.conversion import executed
from plcopen_sfc.conversion.assumed_types import with_inputs
from plcopen_sfc.conversion.scan_order import reads_inputs
from plcopen_sfc.formats.registry import format_named
from plcopen_sfc.report import START_OF_CHART, ConversionReport, Outcome
from plcopen_sfc.semantics.profile import default_profile
from tests.conversion.features import FEATURES, Feature, feature_project

_IMPORT = "no export of CODESYS has it, so its importer may not read it"
_START = "the first scan passes with the step `Start`, which a constant delay makes up for here"
_AT_ONCE = "no acknowledgement is required: the scan that sees the error is no other one"
_FINAL = "the final scan of the source makes no difference in this chart"


CAUTIOUS = {
    ("qualifier P1", "codesys"): _IMPORT,
    ("qualifier P0", "codesys"): _IMPORT,
    ("qualifier P1", "twincat"): _IMPORT,
    ("qualifier P0", "twincat"): _IMPORT,
    ("qualifier P1", "codesys-export"): _IMPORT,
    ("qualifier P0", "codesys-export"): _IMPORT,
    ("retain", "codesys"): _IMPORT,
    ("macro-step", "codesys"): _IMPORT,
    ("negated action", "codesys"): _IMPORT,
    ("action that is a chart", "simaticml"): "the chart in the action does not go on as the action ends",
    ("address", "simaticml"): "the simulation has no inputs and outputs at addresses",
    ("enumeration", "simaticml"): _FINAL,
    **{
        (feature, target): _START
        for feature in ("several initial steps", "priority of a convergence")
        for target in ("codesys", "twincat", "codesys-export", "codesys23")
    },
    **{("event A1", target): _AT_ONCE for target in ("codesys", "twincat", "codesys-export", "codesys23")},
}
"""Where the report says less than that all is executed although both run the same here, and why."""
REASONS = {
    "scl": {"": "a source in SCL holds no charts; `lower` writes their code"},
    "iec-text": {
        "ON|event|interlock|supervision|value:|permanent|SkipSteps|counter|timer of S5|retained member|initial value": (
            "the rules that write statements in place of what S7-GRAPH has are not applied to text yet: nothing there "
            "would keep the source for the way back"
        ),
        "global variable|address": "tags, data blocks and lists are not written as VAR_GLOBAL of a text yet",
        "minimum time|maximum time|SFCQuitError": "textual SFC has no minimum and maximum times",
        "negated action|macro-step|drawn logic": "textual SFC has no such element",
        "exit action of two": "P0 has one control for both steps, and a text gets no statements in its place yet",
    },
    "simaticml": {
        "priority of a convergence": "a branch of S7-GRAPH cannot begin where a simultaneous one ends",
        "macro-step": "S7-GRAPH has no such element",
        "SFCCurrentStep": "`S_NO` has the number of the step, and no network the name",
    },
    "codesys|twincat|codesys-export": {
        "negated action|macro-step": "charts of CODESYS have no such element",
    },
    "codesys23": {
        "negated action|macro-step|action that calls a method": "CoDeSys 2.3 has no such element",
    },
}
"""Why cells are not executed, by targets and features (alternatives)."""


def reason(feature: str, target: str) -> str | None:
    """The reason why a feature is not executed in a target."""
    for targets, reasons in REASONS.items():
        for features, why in reasons.items() if target in targets.split("|") else ():
            if any(feature.startswith(each) for each in features.split("|")):
                return why
    return None


def reasons_table() -> str:
    """The reasons as a table in Markdown."""
    rows = ["| in | not executed | because |", "|---|---|---|"]
    for targets, reasons in REASONS.items():
        for features, why in reasons.items():
            what = features.replace(":", "").replace("|", ", ") or "all"
            rows.append(f"| {targets.replace('|', ', ')} | {what} | {why} |")
    return "\n".join(rows)


TARGETS = ("codesys", "twincat", "codesys-export", "plcopen-2.01", "iec-text", "simaticml", "scl", "codesys23")


@dataclass(frozen=True)
class Cell:
    """A feature in a target: what running both shows, and what the report says."""

    feature: str
    source: str
    target: str
    runs_the_same: bool
    verdict: str
    reported: str
    why: str

    @property
    def agrees(self) -> bool:
        """True if the report says that all is executed exactly where both run the same."""
        if self.reported == "refused" or self.runs_the_same == (self.reported == "executed"):
            return True
        return self.runs_the_same and (self.feature, format_named(self.target)[0].name) in CAUTIOUS

    @property
    def outcome(self) -> str:
        """The word of the table."""
        if self.reported == "refused":
            return "refused"
        if self.runs_the_same and self.reported != Outcome.NOT_EXECUTED:
            return "executed"
        return self.reported


def is_other(source: str, target: str) -> bool:
    """True if the two are not versions of one format."""
    return format_named(target)[0] is not format_named(source)[0]


def cells(features: Sequence[Feature] = FEATURES) -> Iterator[Cell]:
    """Every cell of the matrix."""
    for feature in features:
        for source in feature.sources:
            for target in TARGETS:
                if is_other(source, target):
                    yield judge(feature, source, target)


def judge(feature: Feature, source: str, target: str) -> Cell:
    """Convert the chart of a feature and run both."""
    original = sfc.loads(sfc.dumps(feature_project(feature, source), format=source, partial=True), format=source)
    try:
        result, report = converted(original, target)
    except sfc.SfcError as error:
        return Cell(feature.name, source, target, False, "", "refused", error.message)
    losses = [item for item in report.losses if item.what != START_OF_CHART]  # of first scans, which delays allow for
    reported = losses[0].outcome.value if losses else "executed"
    verdict = same_behaviour(original, result) if not undeclared(original, result) else None
    why = "; ".join(dict.fromkeys(item.why for item in losses))
    same = verdict is not None and verdict.equal
    return Cell(feature.name, source, target, same, str(verdict), reported, why)


def converted(original: m.Project, target: str) -> tuple[m.Project, ConversionReport]:
    """Return what the target tool reads of the converted project, and the report."""
    if target != "twincat":
        data, report = sfc.convert(original, target, partial=True)
        return sfc.loads(data, format=target, as_tool=True), report
    with TemporaryDirectory() as folder:  # a file holds one object
        report = sfc.save(original, folder, format=target, partial=True)
        return sfc.load(folder, format=target, as_tool=True), report


def same_behaviour(
    source: m.Project,
    result: m.Project,
    *,
    operated: Sequence[str] = (),
    outputs: Sequence[str] = (),
    later_inputs: bool = False,
) -> Verdict | None:
    """The comparison of both under the rules of their tools; None if the result cannot run.

    `operated`: inputs that only one of the tools knows and that do not rest, besides `OPERATED`. `outputs` are compared
    besides `OUTPUTS`. `later_inputs`: actions of the later side may see those of a scan later.
    """
    profiles = (default_profile(source), default_profile(result))
    inputs = {n: n for n in (*OPERATED, *operated) if any(v.name == n for v in source.pou("Main").variables())}
    outputs = [name for name in (*OUTPUTS, *outputs) if any(v.name == name for v in source.pou("Main").variables())]
    # inputs that the source writes are static variables in TIA Portal, which others write between its scans too
    written = {v.name for v in source.pou("Main").variables(m.SectionKind.INPUT)}
    inside = {pou.name: {v.name for v in pou.variables(m.SectionKind.LOCAL)} & written for pou in result.pous}
    asked = with_inputs(result, {name: found for name, found in inside.items() if found})
    chart = next(each for each in source.charts() if each.name == "Main")
    compared = partial(equivalent, source.pou("Main"), asked.pou("Main"), outputs=outputs, inputs=inputs, cap=2000)
    try:
        verdict = compared(profiles, delay="auto")
        if not verdict.equal or not verdict.delay.retimed or later_inputs:
            return verdict
        if profiles[0].order is profiles[1].order:
            return verdict
        # the machine gives both the same inputs at one time, which matters where actions read some, and the same times
        is_read = reads_inputs(chart, source, verdict.inputs)
        strict = compared(profiles, delay=Delay(verdict.delay.scans, in_sequence=not is_read))
        return strict if strict.different else verdict
    except sfc.SfcError:
        return None


def undeclared(source: m.Project, result: m.Project) -> set[str]:
    """Names that the result uses and only the source declares: its tool does not compile it."""
    kinds = [{key.name for key in executed(each).parts if key.kind == "undeclared name"} for each in (source, result)]
    return kinds[1] - kinds[0]


OPERATED = ("INIT_SQ", "OFF_SQ", "SFCInit", "SFCReset", "SFCPause", "SFCQuitError", "SFCTip", "SFCTipMode")
OUTPUTS = ("q", "r", "n", "SFCError")


def table(found: Sequence[Cell]) -> str:
    """The matrix as a table in Markdown."""
    rows = ["| feature | of | " + " | ".join(TARGETS) + " |", "|---|---|" + "---|" * len(TARGETS)]
    by_row: dict[tuple[str, str], dict[str, str]] = {}
    for cell in found:
        by_row.setdefault((cell.feature, cell.source), {})[cell.target] = cell.outcome
    for (feature, source), row in by_row.items():
        rows.append(f"| {feature} | {source} | " + " | ".join(row.get(target, "") for target in TARGETS) + " |")
    return "\n".join(rows)


if __name__ == "__main__":
    import sys

    every = list(cells())
    wrong = [cell for cell in every if not cell.agrees]
    sys.stdout.write("\n".join([table(every), *map(str, wrong), ""]))
