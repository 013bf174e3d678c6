"""Charts as texts for Mermaid and Graphviz: all nodes and edges, and no text that is taken for markup."""

from __future__ import annotations

import re
import shutil
import subprocess

import pytest
from hypothesis import given

import plcopen_sfc as sfc
from plcopen_sfc.drawing.pictures import dot_text, mermaid_text
from plcopen_sfc.model import SfcNetwork
from plcopen_sfc.model.sfc import PartialChart
from tests.drawing.nets import any_net, make
from tests.drawing.test_pictures import TestSafety, fixture_charts, links_of

EDGE = {
    "mermaid": re.compile(r"^ +(\w+) --> (\w+)$", re.MULTILINE),
    "dot": re.compile(r"^ +(\w+) -> (\w+)$", re.MULTILINE),
}
TEXTS = {"mermaid": mermaid_text, "dot": dot_text}


@pytest.mark.parametrize("kind", TEXTS)
@given(chart=any_net())
def test_edges_are_the_links_of_the_chart(kind: str, chart: SfcNetwork) -> None:
    edges = {(one, other) for one, other in EDGE[kind].findall(TEXTS[kind](chart))}
    assert edges == {tuple(name.replace("-", "") for name in link) for link in links_of(chart)}


def test_labels_have_what_a_step_does_and_a_transition_waits_for() -> None:
    chart = make(2, [([0], [1])])
    chart.steps[0].actions = [
        sfc.ActionAssociation(id=9, qualifier="D", duration="T#2s", target="Motor", indicator="Runs")
    ]
    chart.transitions[0].condition, chart.transitions[0].priority = "a > b", 1
    assert mermaid_text(chart).splitlines()[1:4] == [
        '    step0[["S0<br>D T#35;2s Motor (Runs)"]]',
        '    step1["S1"]',
        '    transition2(["1: a #62; b"])',
    ]
    assert 'step0 [label="S0\\nD T#2s Motor (Runs)", shape=box, peripheries=2]' in dot_text(chart)
    assert 'transition2 [label="1: a > b", shape=plaintext]' in dot_text(chart)


def test_excluded_elements_are_dashed_and_say_so() -> None:
    chart = make(2, [([0], [1])])
    chart.steps[1].exclude = chart.transitions[0].exclude = True
    chart.steps[0].actions = [sfc.ActionAssociation(id=9, target="Motor", exclude=True)]
    assert mermaid_text(chart).splitlines()[1:6] == [
        '    step0[["S0<br>N Motor (excluded)"]]',
        '    step1["S1 (excluded)"]',
        "    style step1 stroke-dasharray:4",
        '    transition2(["c0<br>(excluded)"])',
        "    style transition2 stroke-dasharray:4",
    ]
    assert 'step1 [label="S1 (excluded)", shape=box, style=dashed]' in dot_text(chart)


def test_nothing_from_a_file_is_markup() -> None:
    chart = make(1, [])
    chart.steps[0].name = TestSafety.NASTY + ']; end \\" %% `x`'
    (label,) = re.findall(r'^    step0\[\["(.*)"\]\]$', mermaid_text(chart), re.MULTILINE)
    assert re.fullmatch(r"(?:[\w :=(),]|#\d+;)*", label, re.ASCII)
    (label,) = re.findall(r'^    step0 \[label="(.*)", shape=box, peripheries=2\]$', dot_text(chart), re.MULTILINE)
    assert not re.search(r'(?<!\\)(?:\\\\)*"', label)


def test_partial_charts_are_groups() -> None:
    chart = make(1, [])
    chart.partial_charts = [PartialChart(name="G2", chart=make(2, [([0], [1])]), comment="main chart")]
    assert 'subgraph part1_chart["G2<br>main chart"]' in mermaid_text(chart)
    assert "part1_step0 --> part1_transition2" in mermaid_text(chart)
    assert "subgraph cluster_part1_" in dot_text(chart)


def test_graphviz_reads_them() -> None:
    program = shutil.which("dot")
    if program is None:
        pytest.skip("no Graphviz (apt-get install graphviz)")
    nasty = make(1, [])
    nasty.steps[0].name = TestSafety.NASTY + '\\"\\'
    for chart in (nasty, *(chart.chart for _, chart in fixture_charts())):
        subprocess.run([program, "-Tdot"], input=dot_text(chart).encode(), capture_output=True, check=True)
