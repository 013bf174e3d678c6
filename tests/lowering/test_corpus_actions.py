"""Charts of actions in real CODESYS projects, under their SFC flags: lowered, they do the same."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.analysis import equivalent
from plcopen_sfc.analysis.pairing import with_commands
from plcopen_sfc.lowering import lower
from plcopen_sfc.semantics.subjects import resolve
from tests.corpus import corpus_files, require_corpus

pytestmark = [pytest.mark.corpus, pytest.mark.slow]
FILES = ("Scenario_1.xml", "ppu.xml")
"""The smallest and the oldest of the versions of one plant."""


def charts_of_actions() -> Iterator[tuple[m.Project, str]]:
    """Those of two projects."""
    for path in corpus_files("codesys"):
        if path.name in FILES:
            project = sfc.load(path)
            yield from ((project, name) for name, pou, _ in project.charts() if name != pou.name)


def test_they_do_the_same() -> None:
    require_corpus()
    count = 0
    for project, name in [*charts_of_actions()][::9]:
        count += 1
        construction, language = ("bits", "ST") if count % 2 else ("flipflop", "FBD")
        lowered = lower(project, construction, pou=name, language=language, verify=False)
        chart, code = with_commands(resolve(project, name), resolve(lowered.project, name), lowered.profile)
        found = equivalent(chart, code, lowered.profile, cap=200, runs=4, scans=40)
        assert not found.different, f"{name} {construction}: {found}"
    assert count >= 4
