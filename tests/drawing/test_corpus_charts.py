"""Real charts: drawn from the model they mean the same, and mostly look the same."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

import plcopen_sfc
from plcopen_sfc.drawing import DrawingStyle, all_charts, draw, fits, has_positions, layout, renumber
from plcopen_sfc.errors import SfcError
from plcopen_sfc.model.sfc import SfcNetwork
from tests.corpus import ROOT, corpus_files, require_corpus
from tests.drawing.test_layout import assert_apart

FIXTURES = [
    *sorted((ROOT / "fixtures" / "codesys").glob("*.xml")),
    *sorted((ROOT / "fixtures" / "twincat").glob("*.xml")),
]
PLAIN_FIXTURES = sorted((ROOT / "fixtures" / "plcopen").glob("*.xml"))


def charts_of(paths: list[Path]) -> Iterator[SfcNetwork]:
    for path in paths:
        try:
            project = plcopen_sfc.load(path)
        except SfcError:
            continue
        yield from all_charts(project)


def shape(chart: SfcNetwork) -> list[object]:
    """The whole drawing, whatever its ids are."""
    copy = chart.model_copy(deep=True)
    renumber(copy)
    assert copy.drawing is not None
    return [
        (s.kind, s.id, [(c.source, c.pin) for pin in s.inputs for c in pin.connections], s.target, len(s.outputs))
        for s in copy.drawing.symbols
    ]


@pytest.mark.slow
@pytest.mark.parametrize("path", [*FIXTURES, *PLAIN_FIXTURES], ids=lambda path: path.name)
def test_fixtures_fit_and_can_be_drawn_anew(path: Path) -> None:
    for chart in charts_of([path]):
        assert fits(chart)
        for style in DrawingStyle:
            other = chart.model_copy(deep=True)
            other.drawing = draw(chart, style)
            assert fits(other)
            layout(other)
            assert_apart(other)


@pytest.mark.slow
@pytest.mark.corpus
def test_real_charts_come_out_as_codesys_draws_them() -> None:
    require_corpus()
    seen: set[str] = set()
    same = total = 0
    for chart in charts_of([*FIXTURES, *corpus_files("codesys"), *corpus_files("twincat")]):
        if chart.drawing is None or not chart.drawing.symbols:
            continue
        before = shape(chart)
        if str(before) in seen:
            continue
        seen.add(str(before))
        assert fits(chart, DrawingStyle.STRUCTURED)
        assert not has_positions(chart.drawing)
        chart.drawing = draw(chart, DrawingStyle.STRUCTURED)
        assert fits(chart, DrawingStyle.STRUCTURED)
        total += 1
        same += shape(chart) == before
    assert total >= 80
    assert same / total >= 0.68, f"{same} of {total}"
