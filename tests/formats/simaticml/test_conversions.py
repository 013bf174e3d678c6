"""Charts of other tools, from real exports, as S7-GRAPH blocks: legal or reported, and the same when they are read."""

from __future__ import annotations

import io
from collections import Counter
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.model import Project
from tests.corpus import corpus_files
from tests.formats.simaticml.documents import parsed
from tests.formats.simaticml.test_sequence_topology import assert_legal, links, refused
from tests.samples import accepting

SAMPLE = 8
LARGEST = 200_000
"""Bytes of a file; the whole corpus would take minutes."""


def sample(name: str) -> list[Path]:
    """Every nth of the smaller files with charts."""
    files = [p for p in corpus_files(name) if p.stat().st_size < LARGEST and b"<transition" in p.read_bytes()]
    return files[:: max(1, len(files) // SAMPLE)][:SAMPLE]


FILES = [*sample("plcopen"), *sample("codesys")]
PARAMS = [pytest.param(path, id=path.name[:40], marks=pytest.mark.corpus) for path in FILES] or [
    pytest.param(
        None, marks=[pytest.mark.corpus, pytest.mark.skip("no corpus beside the repository (see tests/corpus.py)")]
    )
]


def shapes(project: Project) -> list[Counter[tuple[frozenset[str], frozenset[str]]]]:
    """The behaviour of the charts of a project, by the names of steps."""
    return [links(chart.chart) for chart in project.charts() if chart.chart.steps]


@pytest.mark.parametrize("path", PARAMS)
def test_charts_of_other_tools_come_back(path: Path) -> None:
    project = accepting(sfc.load(path))
    stream = io.BytesIO()
    report = sfc.save(project, stream, format="simaticml", partial=True)
    again = sfc.loads(stream.getvalue())
    assert shapes(again) == shapes(project)
    if not refused(report):
        for sequence in parsed(stream.getvalue()).iter("{*}Sequence"):
            assert_legal(sequence)
