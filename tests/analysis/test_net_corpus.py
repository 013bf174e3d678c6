"""Every chart of the corpus is analysed: nothing crashes, and what the analyses say fits together."""

from __future__ import annotations

from collections import Counter
from functools import cache

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.analysis.marking import marking_graph
from plcopen_sfc.analysis.regions import Regions, find_regions
from plcopen_sfc.analysis.search_limits import Answer
from plcopen_sfc.analysis.soundness import SoundnessProof, soundness
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.semantics.net import Net
from tests.corpus import corpus_files, require_corpus

pytestmark = pytest.mark.corpus


@cache
def charts() -> list[tuple[str, SfcNetwork]]:
    found: list[tuple[str, SfcNetwork]] = []
    for kind in ("plcopen", "codesys", "twincat", "simaticml"):
        for path in corpus_files(kind):
            try:
                project = sfc.load(path)
            except sfc.SfcError:
                continue  # tests of the formats say which files must be read
            found += [(f"{path.name}: {chart.name}", chart.chart) for chart in project.charts()]
    return found


@pytest.mark.slow
def test_every_chart_is_analysed_and_the_answers_agree() -> None:
    require_corpus()
    counts: Counter[str] = Counter()
    for name, chart in charts():
        net = Net.of(chart)
        graph = marking_graph(net, cap=5000)
        found = soundness(net, cap=5000)
        regions = find_regions(net)
        counts["charts"] += 1
        counts["safe" if graph.safe else "unsafe" if graph.safe is Answer.NO else "unknown"] += 1
        counts["deadlock"] += bool(graph.safe and graph.deadlocks)
        counts["regions"] += isinstance(regions, Regions)
        counts["sound"] += bool(found)
        if found.proof is not SoundnessProof.NONE and graph.safe is not Answer.UNKNOWN:
            assert found.safe is graph.safe, name
            if graph.safe:
                assert found.live is graph.live, name
        if isinstance(regions, Regions):
            assert graph.safe is not Answer.NO, name
    print(dict(counts))  # noqa: T201  # shown with -rP
    assert counts["charts"] > 200
    assert counts["unknown"] == 0
    assert counts["sound"] > 0
    assert counts["safe"] > counts["unsafe"]
