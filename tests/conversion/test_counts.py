"""Outcomes of conversions of the fixtures, by pair of formats: the table in docs/benchmarks.md."""

from __future__ import annotations

from collections import Counter, defaultdict
from functools import cache
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from benchmarks.conversions import COUNTED, FIXTURES, TARGETS, files, judged, source_of
from plcopen_sfc.errors import SfcError
from tests.sweeps import in_turn

PAGE = Path(__file__).resolve().parents[2] / "docs" / "benchmarks.md"


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
