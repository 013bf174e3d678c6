"""A GRAFCET against the test sequence that another tool derived from its stable-location automaton."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from tests.corpus import require_corpus
from tests.semantics.charts.rig import Rig

FOLDER = "grafcet/ocanis__Grafcet_to_Automaton/Grafcet_to_automaton"
CHART = f"{FOLDER}/Examples/aSimpleGrafcet1.txt"
SEQUENCE = f"{FOLDER}/Output/aSimpleGrafcet_sequence.txt"


def section(text: str, name: str) -> list[list[str]]:
    """The entries of a section, each divided at its colons."""
    found = re.search(rf"<{name}>(.*?)</", re.sub(r"#.*|\(\*.*?\*\)", "", text), re.DOTALL)
    assert found is not None
    return [[part.strip() for part in entry.split(":")] for entry in found[1].split(";") if entry.strip()]


def read(path: Path) -> str:
    if not path.is_file():
        pytest.skip(f"the corpus has no {path}")
    return path.read_text(encoding="utf-8")


@pytest.mark.corpus
def test_a_chart_passes_the_test_sequence_of_its_automaton() -> None:
    corpus = require_corpus()
    text = read(corpus / CHART)
    inputs = [entry[0] for entry in section(text, "INPUTS")]
    outputs = [entry[0] for entry in section(text, "OUTPUTS")]
    chart = sfc.load(corpus / CHART).pous[0].chart
    assert chart is not None
    rig = Rig(chart, "grafcet", variables=" ".join(inputs + outputs))
    rows = section(read(corpus / SEQUENCE), "TRANSITIONS")
    assert len(rows) == 43
    for number, _, _, given, expected in rows:
        rig.scan(**{name: bool(int(given) >> bit & 1) for bit, name in enumerate(inputs)})
        code = sum(bool(rig[name]) << bit for bit, name in enumerate(outputs))
        assert code == int(expected), f"row {number}"
