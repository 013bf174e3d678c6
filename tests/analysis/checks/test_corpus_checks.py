"""Real files are checked without an internal error, and what is found stays the same."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.analysis.checks import all_rules
from plcopen_sfc.errors import SfcError
from tests.corpus import corpus_files, require_corpus

EXPECTED: dict[str, dict[str, int]] = {
    "plcopen": {
        "CND05": 4,
        "CND10": 2,  # NOT of a DINT
        "EVO02": 3,
        "LOW01": 16,
        "SEL01": 19,
        "SEL02": 4,
        "STR02": 1,
        "STR06": 2,
        "STR09": 2,
        "STR14": 1,
        "VAR01": 9,
        "VAR02": 5,
        "VAR03": 7,
        "VAR04": 1,
    },
    "codesys": {
        "ACT01": 2,
        "ACT02": 7,
        "ACT03": 3,
        "ACT04": 1,
        "ACT06": 6,
        "ACT13": 1,
        "CND02": 75,
        "CND03": 2,
        "EVO01": 11,
        "EVO02": 6,
        "LOW01": 36,
        "LOW02": 13,
        "STR07": 1,
        "STR13": 1,
        "STR15": 10,
        "VAR01": 1,
        "VAR03": 106,
    },
    "simaticml": {
        "ACT10": 2,
        "CND02": 29,
        "EVO01": 4,
        "EVO02": 3,
        "LOW01": 3,
        "SEL03": 5,
        "STR11": 1,
        "VAR02": 41,  # a document holds one block, without the types of its project
        "VAR03": 45,
    },
    "iectext": {
        "ACT04": 2,
        "ACT21": 2,
        "CND02": 37,
        "EVO01": 4,
        "LOW01": 11,
        "LOW02": 3,
        "NAM01": 1,
        "NAM03": 2,
        "SEL01": 22,
        "SEL03": 5,
        "STR06": 8,
        "STR07": 1,
        "STR09": 29,
        "STR11": 5,
        "STR13": 1,
        "STR14": 4,
        "VAR01": 2,
        "VAR03": 49,
    },
}
"""How many findings of each rule there are in the files of each format. A change here is a change of what people see:
look at the findings before it is made."""


def projects(kind: str) -> list[tuple[Path, sfc.Project]]:
    """The files of a format that can be loaded."""
    found: list[tuple[Path, sfc.Project]] = []
    for path in corpus_files(kind):
        try:
            found.append((path, sfc.load(path)))
        except SfcError:
            continue
    return found


@pytest.mark.slow
@pytest.mark.corpus
@pytest.mark.parametrize("kind", ["plcopen", "codesys", "simaticml", "iectext"])
def test_what_is_found_in_real_files(kind: str) -> None:
    require_corpus()
    known = {rule.code for rule in all_rules()}
    counts: Counter[str] = Counter()
    for path, project in projects(kind):
        for finding in sfc.check(project):
            assert finding.code in known
            assert finding.location.file == str(path)
            assert finding.location.path
            counts[finding.code] += 1
    assert dict(sorted(counts.items())) == EXPECTED[kind]
