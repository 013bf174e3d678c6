"""Laws of drawing, over random charts."""

from __future__ import annotations

from copy import deepcopy

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from plcopen_sfc.drawing import DrawingStyle, draw, fits, limits, renumber
from plcopen_sfc.drawing.pictures import PairedChart, paired_figures
from plcopen_sfc.model.drawing import SymbolKind
from plcopen_sfc.model.sfc import SfcNetwork
from tests.drawing.nets import any_net, entered_net, links_of_chart, links_of_drawing, nested_net
from tests.drawing.pictures import area, assert_tidy, read_picture
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


@pytest.mark.slow
@SLOW
@given(chart=CHARTS, added=st.lists(st.integers(0, 5), max_size=3))
def test_charts_beside_each_other_stay_tidy_and_have_the_same_steps_at_one_height(
    chart: SfcNetwork, added: list[int]
) -> None:
    """The other chart has more text at some of its steps, so it would be longer there."""
    other = deepcopy(chart)
    for number in added if chart.steps else ():
        step = other.steps[number % len(other.steps)]
        step.comment = f"{step.comment or ''}\nmore\nand more"
    same = [(step.id, step.id) for step in chart.steps]
    pair = PairedChart(chart, "a-", {}), PairedChart(other, "b-", {})
    pictures = [read_picture(svg) for svg in paired_figures(pair, same, fresh=True)]
    tops = []
    for picture in pictures:
        assert_tidy(picture)
        tops.append({g.get("id")[2:]: area(g)[1] for g in picture.by_class("step")})
    assert tops[0] == tops[1]
