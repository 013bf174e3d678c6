"""Every chart of the corpus is lowered, or refused for a reason that is known and counted here."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

import pytest
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis.equivalence import equivalent
from plcopen_sfc.errors import LoweringError
from plcopen_sfc.lowering.lower import lower
from plcopen_sfc.semantics.subjects import resolve
from tests.corpus import corpus_files, require_corpus, require_official_schema

pytestmark = [pytest.mark.corpus, pytest.mark.slow]

FORMS = (("bits", "ST"), ("case", "ST"), ("regions", "ST"), ("flipflop", "FBD"), ("flipflop", "LD"))
TARGETS = (
    ("auto", "ST", "plcopen-2.01"),
    ("auto", "ST", "scl"),
    ("flipflop", "FBD", "plcopen-2.01"),
    ("auto", "ST", "codesys"),
    ("flipflop", "FBD", "simaticml"),
    ("auto", "ST", "iec-text"),
    ("flipflop", "LD", "codesys"),
)
REASONS = {
    "cannot hold the chart": "several steps at a time",
    "not built of parts": "no regions",
    "no CASE can hold": "no regions",
    "this cannot be drawn": "text that cannot be drawn",
    "S_ON can switch on": "S7-GRAPH by hand",
    "no step is initial": "no initial step",
    "a condition is of type BOOL": "condition that is no BOOL",
    "only a Boolean variable": "action that is no BOOL",
    "needs a time": "action without its time",
    "found '": "text that does not parse",
    "was not read completely": "broken connections",
    "cannot be read": "drawing that cannot be read",
}
"""What messages contain, and what that is called here."""
CHARTS = 66
_BROKEN = {
    "condition that is no BOOL": 1,
    "action that is no BOOL": 1,
    "action without its time": 1,
    "text that does not parse": 2,
    "broken connections": 2,
}
REFUSED = {
    "bits ST": _BROKEN,
    "case ST": {**_BROKEN, "several steps at a time": 14, "S7-GRAPH by hand": 9, "no initial step": 1},
    "regions ST": {**_BROKEN, "no regions": 5, "S7-GRAPH by hand": 9, "no initial step": 1},
    "flipflop FBD": {**_BROKEN, "text that cannot be drawn": 1},
    "flipflop LD": {**_BROKEN, "text that cannot be drawn": 1},
}
"""How many charts each form refuses. Seven cannot be executed as they stand, or were not read completely."""


def charts(*kinds: str) -> Iterator[tuple[m.Project, m.Pou]]:
    """The POUs with a chart, those with the same chart once."""
    seen: set[str] = set()
    for kind in kinds:
        for path in corpus_files(kind):
            try:
                project = sfc.load(path)
            except sfc.SfcError:
                continue  # tests of the formats say which files must be read
            for pou in project.pous:
                chart = pou.sfc
                key = chart.model_dump_json(exclude={"drawing"}) if chart is not None else ""
                if key and key not in seen:
                    seen.add(key)
                    yield project, pou


def reason(error: LoweringError) -> str:
    """Why a chart is refused, in few words; the message itself where that is a new one."""
    return next((words for part, words in REASONS.items() if part in error.message), error.message)


def test_refusals_are_few_and_known() -> None:
    require_corpus()
    refused: dict[str, Counter[str]] = {f"{construction} {language}": Counter() for construction, language in FORMS}
    count = 0
    for project, pou in charts("codesys", "codesys23", "plcopen", "iectext", "simaticml"):
        count += 1
        for construction, language in FORMS:
            try:
                lower(project, construction, pou=pou.name, language=language, verify=False)
            except LoweringError as error:
                refused[f"{construction} {language}"][reason(error)] += 1
    assert count == CHARTS
    assert {form: dict(counts) for form, counts in refused.items()} == REFUSED


def test_what_is_written_is_valid_and_does_the_same() -> None:
    require_corpus()
    official = etree.XMLSchema(etree.parse(str(require_official_schema("2.01"))))
    outcomes: Counter[str] = Counter()
    for number, (project, pou) in enumerate(charts("codesys", "plcopen", "iectext")):
        if number % 3:
            continue
        construction, language, target = TARGETS[number // 3 % len(TARGETS)]
        try:
            lowered = lower(project, construction, pou=pou.name, language=language, target=target, verify=False)
        except LoweringError:
            continue  # counted above
        content = sfc.dumps(lowered.project, format=target)
        if target == "plcopen-2.01":
            assert official.validate(etree.fromstring(content)), f"{pou.name}: {official.error_log}"
        found = equivalent(
            resolve(project, pou.name),
            resolve(sfc.loads(content, format=target), pou.name),
            lowered.profile,
            fixed=lowered.at_rest,
            left_out=lowered.left_out,
            step_flags=lowered.step_flags or None,
            cap=200,
            runs=2,
            scans=50,
        )
        assert found.equal, f"{pou.name} {construction} {language} {target}: {found}"
        outcomes[found.outcome] += 1
    assert outcomes["equal (proof)"] > 10
