"""Every chart of the corpus lowered in every form for every target: written, validated, read back, and compared.

What is read back is the same program for several targets; it is compared with its chart once (`program_of`).
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.api import convert
from plcopen_sfc.errors import LoweringError, ModelError, OldVersionError, SfcError
from plcopen_sfc.formats.plcopen.tc6_versions import version_of
from plcopen_sfc.formats.registry import format_named
from plcopen_sfc.lowering import LoweredPou, lower
from plcopen_sfc.lowering.chart_lowering import next_chart
from plcopen_sfc.lowering.proof import prove
from plcopen_sfc.lowering.written_code import refuse_comments
from plcopen_sfc.report import ConversionReport
from plcopen_sfc.semantics.subjects import Subject, resolve
from tests.corpus import corpus_files, require_official_schema
from tests.formats.plcopen.test_schema_agreement import hoist
from tests.formats.simaticml.official import PUBLISHED, official, outer_parts, without_namespace
from tests.samples import accepting

FAMILIES = ("plcopen", "iectext", "simaticml", "codesys")
"""The folders of the corpus that have charts which can be loaded; the one that takes longest is the last."""
FORMS = (
    ("auto", "ST"),
    ("case", "ST"),
    ("regions", "ST"),
    ("bits", "ST"),
    ("flipflop", "ST"),
    ("flipflop", "FBD"),
    ("flipflop", "LD"),
)
TARGETS = (
    "plcopen-2.01",
    "plcopen-2.0",
    "plcopen-1.01",
    "iec-text",
    "json",
    "codesys",
    "scl",
    "simaticml",
    "simaticml-V14 SP1",
)
LARGE = (
    "Export__plcBlock_GRAPH_FB_R134a_GRAPH.xml",
    "PLCOpenXML_Scenario_13.xml",
    "PLCOpenXML_Scenario_24.xml",
    "Scenario_1.xml",
    "ppu.xml",
)
"""Files whose charts take minutes each in all forms for all targets, and are much alike: no part of a sample."""
REASONS = {
    "fires together with competing": "competing transitions that fire together",
    "one CASE cannot hold": "several steps at a time",
    "no CASEs can hold": "no regions",
    "this cannot be drawn": "text that cannot be drawn",
    "a condition is of type BOOL": "condition that is no BOOL",
    "needs a time": "action without its time",
    "found '": "text that does not parse",
    "was not read completely": "broken connections",
    "cannot be read": "drawing that cannot be read",
    "would only be in a comment": "code only in a comment",
    "has no networks of": "text without networks",
    "only a Boolean variable can be an action": "action that is no BOOL",
    "is not known to the simulator": "calls what the simulator does not know",
    "only the first fails": "chart that fails when it runs",
    "nothing in common that could be compared": "nothing to compare",
    "RETURN and jumps are not lowered": "RETURN in an action",
}
"""Words in messages, and their names here."""


@dataclass(frozen=True)
class SweepResult:
    """The outcome of a chart in a form for a target.

    `outcome`: ``proven``, ``tested``, ``refused``, ``incomparable``, or ``along`` (lowered with the chart that calls
    it); ``different``, ``invalid`` and ``error`` are faults. `why`: in few words for what is refused or incomparable.
    """

    family: str
    file: str
    chart: str
    form: str
    target: str
    outcome: str
    why: str = ""

    @property
    def is_fault(self) -> bool:
        """True if the package did something wrong."""
        return self.outcome in ("different", "invalid", "error")


@dataclass(frozen=True)
class Charts:
    """The charts of a file that no file before it has, also those of actions."""

    family: str
    path: Path
    project: m.Project
    names: tuple[str, ...]

    @property
    def file(self) -> str:
        """The name of the file."""
        return self.path.name


@dataclass(frozen=True)
class SweepEffort:
    """How much is done to compare a program with its chart: at most `cap` states, then `runs` of `scans` scans."""

    cap: int
    runs: int
    scans: int


def corpus_charts(families: Iterable[str] = FAMILIES) -> Iterator[Charts]:
    """The distinct charts of each of the `families`, file by file."""
    for family in families:
        seen: set[str] = set()
        for path in corpus_files(family):
            try:
                project = accepting(sfc.load(path))
            except SfcError:
                continue  # tests of the formats say which files must be read
            names = []
            for chart in project.charts():
                key = chart.chart.model_dump_json(exclude={"drawing"})
                if key not in seen:
                    seen.add(key)
                    names.append(chart.name)
            if names:
                yield Charts(family, path, project, tuple(names))


def name_of(target: str) -> str:
    """The format of a target, without its version."""
    return format_named(target)[0].name


class Sweep:
    """Lowers the charts of one file; what has been compared is not compared again."""

    def __init__(self, charts: Charts, effort: SweepEffort) -> None:
        self.charts = charts
        self.effort = effort
        self._verdicts: dict[tuple[str, str], tuple[str, str]] = {}
        self._wrong_before = frozenset(what_is_invalid(charts.path.read_bytes()))

    def results(
        self,
        forms: Sequence[tuple[str, str]] = FORMS,
        targets: Sequence[str] = TARGETS,
        names: Sequence[str] | None = None,
    ) -> Iterator[SweepResult]:
        """Yield the outcome of each chart, or those of these names, in each form for each target.

        All charts of a form stand in one written file.
        """
        wanted = self.charts.names if names is None else names
        for construction, language in forms:
            for tool in dict.fromkeys(map(name_of, targets)):
                lowered, refused = self._lowered(wanted, construction, language, tool)
                for target in (each for each in targets if name_of(each) == tool):
                    found = refused | self._written(lowered, construction, language, target)
                    for name in wanted:
                        outcome, why = found[name]
                        place = (self.charts.family, self.charts.file, name, f"{construction} {language}", target)
                        yield SweepResult(*place, outcome, why)

    def _lowered(
        self, names: Sequence[str], construction: str, language: str, tool: str
    ) -> tuple[list[LoweredPou], dict[str, tuple[str, str]]]:
        """The charts lowered one after the other, each in the project that the one before it has left."""
        project = self.charts.project
        lowered: list[LoweredPou] = []
        left = set(names)
        refused = {}
        while (name := next_chart(chart for chart in project.charts() if chart.name in left)) is not None:
            left.remove(name)
            try:
                made = lower(project, construction, pou=name, language=language, target=tool, verify=False)
            except LoweringError as error:
                refused[name] = ("refused", reason(error))
            except Exception as error:
                refused[name] = _fault(error)
            else:
                lowered.append(made)
                project = made.project
        return lowered, refused | dict.fromkeys(left, ("along", ""))

    def _written(
        self, lowered: list[LoweredPou], construction: str, language: str, target: str
    ) -> dict[str, tuple[str, str]]:
        """Write what was lowered and compare what is read back; one by one where not all can be written together."""
        if not lowered:
            return {}
        try:
            content, report = convert(lowered[-1].project, target, partial=True)
            wrong = [text for text in what_is_invalid(content) if text not in self._wrong_before]
            seen = sfc.loads(content, format=name_of(target), as_tool=True)
        except OldVersionError:  # of the rest of the project too
            return dict.fromkeys((each.name for each in lowered), ("refused", "older TIA Portal"))
        except Exception as error:
            outcome = _fault(error)
        else:
            if not wrong:
                return {each.name: self._compared(each, report, seen, content, target) for each in lowered}
            outcome = ("invalid", "; ".join(wrong[:3]))
        if len(lowered) == 1:
            return {lowered[0].name: outcome}
        found: dict[str, tuple[str, str]] = {}
        for each in lowered:
            alone, _ = self._lowered([each.name], construction, language, name_of(target))
            found |= self._written(alone, construction, language, target)
        return found

    def _compared(
        self, lowered: LoweredPou, report: ConversionReport, seen: m.Project, content: bytes, target: str
    ) -> tuple[str, str]:
        try:
            refuse_comments(report, lowered.name)
            outcome = self._verdict(lowered, seen)
            if outcome[0] not in ("different", "incomparable"):
                return outcome
            whole = sfc.loads(content, format=name_of(target))
            equal = self._verdict(lowered, whole)[0] in ("proven", "tested")
        except LoweringError as error:
            return "refused", reason(error)
        except Exception as error:
            return _fault(error)
        return ("refused", "code only in a comment") if equal else outcome

    def _verdict(self, lowered: LoweredPou, written: m.Project) -> tuple[str, str]:
        """The verdict of the comparison, that of the same program if there was one."""
        try:
            code = resolve(written, lowered.name)
        except ModelError as error:
            return "incomparable", error.message
        key = (lowered.name, program_of(code, lowered))
        if key not in self._verdicts:
            self._verdicts[key] = self._proved(lowered, code)
        return self._verdicts[key]

    def _proved(self, lowered: LoweredPou, code: Subject) -> tuple[str, str]:
        try:
            found = prove(
                resolve(self.charts.project, lowered.name),
                code,
                lowered.profile,
                fixed=lowered.at_rest,
                left_out=lowered.left_out,
                step_flags=lowered.step_flags or None,
                cap=self.effort.cap,
                runs=self.effort.runs,
                scans=self.effort.scans,
            )
        except LoweringError as error:
            fault = "only the second fails" in error.message
            return ("different", error.message) if fault else ("incomparable", reason(error))
        if found.different:
            return "different", str(found)
        return "proven" if found.proven else "tested", found.reason


def reason(error: SfcError) -> str:
    """Why a chart is refused, in few words; the message itself where that is a new one."""
    return next((words for part, words in REASONS.items() if part in error.message), error.message)


def _fault(error: Exception) -> tuple[str, str]:
    return "error", f"{type(error).__name__}: {error}"


# -- the same program

_NOT_EXECUTED = frozenset({"comment", "global_id", "header", "object_id", "organization", "points", "title", "version"})
"""Fields that no simulator reads. All others count, places of drawn elements too: they can order what is executed."""


def program_of(code: Subject, lowered: LoweredPou) -> str:
    """A digest of all that the verdict on lowered code depends on, beside the chart.

    That is the profile, what is compared and when, the dialect, the POU with its declarations and bodies, the POUs
    whose names stand anywhere in these, and all data types and global data.
    """
    project = code.project
    content = {name: _executed(getattr(project, name)) for name in type(project).model_fields if name != "pous"}
    compared = [code.name, lowered.profile.name, lowered.at_rest, lowered.left_out, lowered.step_flags]
    used = [_text(content), _text(_executed(code.pou)), _text([repr(each) for each in compared])]
    waiting = {pou.name.casefold(): pou for pou in project.pous if pou.name != code.pou.name}
    found = [""]
    while found:
        words = {word for text in used for word in re.findall(r"\w+", text.casefold())}
        found = sorted(words & waiting.keys())
        used += [_text(_executed(waiting.pop(name))) for name in found]
    return hashlib.blake2b("\n".join(used).encode()).hexdigest()


def _executed(value: Any) -> Any:
    if isinstance(value, m.Model):
        fields = ((name, getattr(value, name)) for name in type(value).model_fields if name not in _NOT_EXECUTED)
        return {name: _executed(each) for name, each in fields if each}
    if isinstance(value, list):
        return [_executed(each) for each in value]
    return value


def _text(value: Any) -> str:
    return json.dumps(value, default=str, ensure_ascii=False, sort_keys=True)


# -- the official schemas


def what_is_invalid(content: bytes) -> list[str]:
    """Errors of a file by the official schemas; none where it is valid, or is no XML."""
    try:
        root = etree.fromstring(content)
    except etree.XMLSyntaxError:
        return []
    version = version_of(etree.QName(root).namespace or "")
    if version is not None:
        return _errors(_tc6(version.name), hoist(root))
    parts = [part for part in outer_parts(root) if part[1] in PUBLISHED[part[0]]]
    return [text for kind, number, part in parts for text in _errors(official(kind, number), without_namespace(part))]


def _errors(schema: etree.XMLSchema, element: etree._Element) -> list[str]:
    if schema.validate(element):
        return []
    return [line.partition("ERROR:")[2] for line in str(schema.error_log).splitlines()]  # without their places


@cache
def _tc6(version: str) -> etree.XMLSchema:
    return etree.XMLSchema(etree.parse(require_official_schema(version)))
