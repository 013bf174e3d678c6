"""Laws of drawing, over random charts."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from plcopen_sfc.drawing import DrawingStyle, draw, fits, limits, renumber
from plcopen_sfc.model.drawing import SymbolKind
from plcopen_sfc.model.sfc import SfcNetwork
from tests.drawing.nets import any_net, entered_net, links_of_chart, links_of_drawing, nested_net
from tests.sweeps import examples

STYLES = list(DrawingStyle)
CHARTS = st.one_of(any_net(), nested_net())
SLOW = settings(max_examples=examples(100), deadline=None, suppress_health_check=[HealthCheck.too_slow])


@pytest.mark.slow
@pytest.mark.parametrize("style", STYLES)
@SLOW
@given(chart=CHARTS)
def test_a_drawing_means_its_chart(style: DrawingStyle, chart: SfcNetwork) -> None:
    assert links_of_drawing(draw(chart, style)) == links_of_chart(chart)


@pytest.mark.slow
@pytest.mark.parametrize("style", STYLES)
@SLOW
@given(chart=CHARTS)
def test_drawing_is_deterministic_and_leaves_the_chart_alone(style: DrawingStyle, chart: SfcNetwork) -> None:
    before = chart.model_copy(deep=True)
    one = draw(chart, style)
    assert chart == before
    assert draw(before, style) == one


@pytest.mark.slow
@pytest.mark.parametrize("style", STYLES)
@SLOW
@given(chart=CHARTS)
def test_a_new_drawing_fits_and_can_be_numbered(style: DrawingStyle, chart: SfcNetwork) -> None:
    chart.drawing = draw(chart, style)
    assert fits(chart)
    renumber(chart)
    assert fits(chart)
    assert [s.id for s in chart.drawing.symbols] == list(range(len(chart.drawing.symbols)))


@SLOW
@given(chart=entered_net())
def test_a_simultaneous_convergence_is_one_bar_whatever_jumps_into_its_branches(chart: SfcNetwork) -> None:
    assert not [problem for problem in limits(chart) if problem.code == "SFC130"]
    chart.drawing = draw(chart, DrawingStyle.STRUCTURED)
    bars = [symbol for symbol in chart.drawing.symbols if symbol.kind is SymbolKind.SIMULTANEOUS_CONVERGENCE]
    waiting = [transition for transition in chart.transitions if len(transition.sources) > 1]
    assert len(bars) == len(waiting)
