"""Outcomes of conversions, and of simulated charts, by pair of formats: tables in docs/conversion-counts.md."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from functools import cache
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from benchmarks.conversions import CHARTS, COUNTED, FIXTURES, TARGETS, Judged, files, judged, source_of
from plcopen_sfc.errors import SfcError
from tests.corpus import require_corpus
from tests.sweeps import WHOLE, in_turn

PAGE = Path(__file__).resolve().parents[2] / "docs" / "conversion-counts.md"


def documented() -> dict[str, dict[str, int]]:
    """The counts of the page by pair."""
    lines = PAGE.read_text(encoding="utf-8").splitlines()
    first = next(number for number, line in enumerate(lines) if line.startswith("| pair | files |"))
    head = [cell.strip() for cell in lines[first].strip("|").split("|")]
    assert head == ["pair", *COUNTED]
    rows = {}
    for line in lines[first + 2 :]:
        if not line.startswith("|"):
            break
        pair, *counts = (cell.strip() for cell in line.strip("|").split("|"))
        rows[pair] = dict(zip(COUNTED, map(int, counts), strict=True))
    return rows


@cache
def sources() -> dict[str, list[Path]]:
    """The fixtures that can be read, by their formats."""
    found: dict[str, list[Path]] = defaultdict(list)
    for path in files([FIXTURES], ""):
        try:
            found[source_of(sfc.load(path))].append(path)
        except SfcError:
            continue
    return dict(found)


@pytest.mark.slow
def test_the_page_has_all_pairs_and_their_sum() -> None:
    rows = documented()
    total = rows.pop("all")
    assert rows.keys() == {f"{source} -> {target}" for source in sources() for target in TARGETS if target != source}
    assert total == {name: sum(row[name] for row in rows.values()) for name in COUNTED}
    assert total["unsaid"] == total["failed"] == 0


@pytest.mark.slow
def test_conversions_come_to_what_the_page_counts() -> None:
    """One target of each source format, in turn; all with PLCOPEN_SFC_FULL."""
    rows = documented()
    for number, source in enumerate(sorted(sources())):
        others = [target for target in TARGETS if target != source]
        for target in in_turn(others, number):
            results = [judged(path, target, limit=0) for path in sources()[source]]
            counts = sum((each.counts for each in results if each is not None), Counter())
            notes = [f"{each.file}: {note}" for each in results if each is not None for note in each.notes]
            pair = f"{source} -> {target}"
            assert {name: counts[name] for name in COUNTED} == rows[pair], "\n".join([pair, *notes])


PAIRED = re.compile(r"\| (\S+ -> \S+|all) \| (.*) \|")
TOOLS = ("codesys", "plcopen-2.01", "beremiz", "simaticml")


def charts_documented() -> dict[str, dict[str, int]]:
    """The charts that were run, as the page counts them by pair."""
    _, _, text = PAGE.read_text(encoding="utf-8").partition("## Charts in both tools")
    head = next(line for line in text.splitlines() if line.startswith("| pair |"))
    assert tuple(cell.strip() for cell in head.strip("|").split("|")) == ("pair", *CHARTS)
    found = {pair: [int(cell) for cell in cells.split("|")] for pair, cells in PAIRED.findall(text)}
    return {pair: dict(zip(CHARTS, cells, strict=True)) for pair, cells in found.items()}


def test_charts_of_the_page_are_those_of_its_outcomes() -> None:
    rows = charts_documented()
    total = rows.pop("all")
    assert {pair.partition(" -> ")[2] for pair in rows} == set(TOOLS)
    for pair, row in rows.items():
        assert row["charts"] == sum(row.values()) - row["charts"] - row["proven"], pair
    assert total == {name: sum(row[name] for row in rows.values()) for name in CHARTS}


@pytest.mark.slow
@pytest.mark.corpus
def test_charts_that_are_run_come_to_what_the_page_counts() -> None:
    """Formats with few charts; all with PLCOPEN_SFC_FULL. How many a time limit reaches depends on the machine."""
    corpus = require_corpus()
    rows = charts_documented()
    found: dict[str, list[Judged]] = defaultdict(list)
    for path in files([FIXTURES, corpus], ""):
        if not WHOLE and path.suffix.casefold() not in (".csv", ".xlsx", ".exp"):
            continue
        for target in TOOLS:
            each = judged(path, target, limit=4 if WHOLE else 0.3)
            if each is not None:
                found[each.pair].append(each)
    for pair, results in found.items():
        counts = sum((each.counts for each in results), Counter())
        notes = "\n".join([pair, *(f"{each.file}: {note}" for each in results for note in each.notes)])
        if WHOLE or pair.startswith(("csv", "xlsx", "codesys23")):
            for name in ("charts", "not executed", "refused", "left out"):
                assert counts[name] == rows[pair][name], notes
            # to find a cause takes longer than to find a difference
            most = rows[pair]["differs"] + (0 if WHOLE else rows[pair]["differs as named"])
            assert counts["differs"] <= most, notes
        assert not counts["failed"], notes
    assert found
