"""Charts of actions in real CODESYS projects, under their SFC flags: lowered, they do the same."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis.equivalence import equivalent
from plcopen_sfc.lowering.lower import lower
from plcopen_sfc.lowering.proving import compared_subjects
from plcopen_sfc.semantics.subjects import resolve
from tests.corpus import corpus_files, require_corpus

pytestmark = [pytest.mark.corpus, pytest.mark.slow]
CHARTS = 118
NO_TEXT = "WPWeight_Heavy=Main.Stack_WPWeight_Heavy;"
"""A condition that does not parse, in two charts of actions."""


def charts_of_actions() -> Iterator[tuple[m.Project, str]]:
    """Each once: the corpus has many in several versions of a project."""
    seen: set[str] = set()
    for path in corpus_files("codesys"):
        try:
            project = sfc.load(path)
        except sfc.SfcError:
            continue  # tests of the formats say which files must be read
        for name, pou, chart in project.charts():
            text = chart.model_dump_json()
            if name != pou.name and text not in seen:
                seen.add(text)
                yield project, name


def test_they_do_the_same() -> None:
    require_corpus()
    count = 0
    for number, (project, name) in enumerate(charts_of_actions()):
        count += 1
        if number % 30 or NO_TEXT in resolve(project, name).pou.model_dump_json():
            continue
        for construction, language in (("bits", "ST"), ("flipflop", "FBD")):
            lowered = lower(project, construction, pou=name, language=language, verify=False)
            chart, code = compared_subjects(resolve(project, name), resolve(lowered.project, name), lowered.profile)
            found = equivalent(chart, code, lowered.profile, cap=300, runs=4, scans=40)
            assert found.equal, f"{name} {construction}: {found}"
    assert count == CHARTS
