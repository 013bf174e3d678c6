"""The behaviour matrix: one feature of each tool, converted to each format, judged by running both."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.conversion.features import FEATURES, Feature
from tests.conversion.matrix import TARGETS, Cell, is_other, judge, reason, reasons_table, table
from tests.sweeps import WHOLE, in_turn, some_of

PAGE = Path(__file__).parents[2] / "docs" / "conversion.md"
PAIRS = {f.name: [(s, t) for s in f.sources for t in TARGETS if is_other(s, t)] for f in FEATURES}


def documented() -> dict[tuple[str, str, str], str]:
    """The outcomes in the table of the page."""
    rows = [line.strip("| ").split(" | ") for line in PAGE.read_text("utf-8").splitlines() if line.startswith("| ")]
    body = [row for row in rows if len(row) == len(TARGETS) + 2 and row[0] in PAIRS]
    return {(row[0], row[1], target): cell for row in body for target, cell in zip(TARGETS, row[2:], strict=True)}


def test_every_cell_that_is_not_executed_has_its_reason_on_the_page() -> None:
    lost = [(feature, target) for (feature, _, target), cell in documented().items() if cell == "not executed"]
    assert [cell for cell in lost if reason(*cell) is None] == []
    assert reasons_table() in PAGE.read_text("utf-8")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "feature"), some_of([*enumerate(FEATURES)], 2), ids=lambda value: getattr(value, "name", "")
)
def test_the_report_agrees_with_what_runs(number: int, feature: Feature) -> None:
    """One pair of formats for every second feature, all with PLCOPEN_SFC_FULL: what is converted where goes round."""
    page = documented()
    for source, target in in_turn(PAIRS[feature.name], number):
        cell: Cell = judge(feature, source, target)
        assert cell.agrees, cell
        assert page[feature.name, source, target] == cell.outcome


@pytest.mark.skipif(not WHOLE, reason="the whole matrix takes minutes; PLCOPEN_SFC_FULL=1 runs it")
def test_the_page_has_the_whole_table() -> None:
    every = [judge(feature, source, target) for feature in FEATURES for source, target in PAIRS[feature.name]]
    assert table(every) in PAGE.read_text("utf-8")
