"""Branches of charts of TwinCAT 3: what an edit leaves as it is, and what is excluded with a branch."""

from __future__ import annotations

from pathlib import Path

import pytest
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc.model import Project
from plcopen_sfc.model.drawing import Symbol, SymbolKind
from plcopen_sfc.model.sfc import SfcNetwork
from plcopen_sfc.model.wiring import Branches
from plcopen_sfc.refactor.builder import jump, selection, step
from plcopen_sfc.report import Outcome
from tests.corpus import corpus_files
from tests.samples import FIXTURES
from tests.sweeps import some_of

CHART = FIXTURES / "twincat-belt" / "POUs" / "Ablauf_Band.TcPOU"
REAL = [path for path in corpus_files("twincat") if path.suffix == ".TcPOU"]
EXCLUDE = "{01580b27"


def chart_of(project: Project) -> SfcNetwork:
    return next(iter(project.charts())).chart


def parents(data: bytes) -> dict[str, str]:
    """The elements and segments of a chart, each with the one around it."""
    found = {}
    for each in etree.fromstring(data).iter("o"):
        number, around = (each.findtext(f"v[@n='{name}']") for name in ("Id", "IdParent"))
        if number is not None and around is not None and each.find("v[@n='AttributeId']") is None:
            found[number] = around
    return found


def branched(tool: str = "twincat") -> tuple[Project, bytes]:
    """A chart with a branch that has a name and a comment, and holds the steps Wait, Check and Look."""
    project = Project(dialect="codesys")
    project.add_program(
        "Main",
        *(step("Init", initial=True), "TRUE", step("Work")),
        selection(
            ["d", step("Wait", actions=["N q"]), "e", jump("Work")],
            ["f", step("Check"), "g"],
            ["i", step("Look"), selection(["k"], ["l", jump("Work")])],
        ),
        *(step("Leave"), "h", jump("Init")),
    )
    project = sfc.loads(sfc.dumps(project, format=tool))
    bar = holding(chart_of(project), "Wait")
    bar.name, bar.comment = "Wichtig", "wichtiger Zweig"
    data = sfc.dumps(project)
    return sfc.loads(data), data


def holding(chart: SfcNetwork, name: str) -> Symbol:
    """The outermost branch in which a step is."""
    assert chart.drawing is not None
    branches = Branches.of(chart.drawing)
    bars = [each for each in chart.drawing.symbols if each.kind is SymbolKind.SELECTION_DIVERGENCE]
    return next(each for each in bars if chart.step(name).id in branches.held_by(each.id))


def excluded(tool: str = "twincat") -> bytes:
    """The file of `branched` with the branch excluded, as the tool does it: at the branch alone."""
    project, _ = branched(tool)
    chart = chart_of(project)
    bar = holding(chart, "Wait")
    bar.exclude = True
    assert chart.drawing is not None
    held = Branches.of(chart.drawing).held_by(bar.id)
    for each in chart.steps:
        each.exclude = each.id in held
    for each in chart.transitions:
        each.exclude = each.id in held
    return sfc.dumps(project)


def exclusions(data: bytes) -> int:
    """How many elements of a file have Exclude."""
    values = (each.getnext() for each in etree.fromstring(data).iter("v") if EXCLUDE in (each.text or ""))
    return sum(value is not None and value.findtext("v[@n='Value']") == '"TRUE"' for value in values)


def test_a_transition_that_is_added_is_one_segment_more_and_other_branches_keep_what_they_have() -> None:
    project, data = branched()
    names = [each.name for each in chart_of(project).steps]
    for source in names:
        for target in ("Init", "Check", "Look", "Leave"):
            project = sfc.loads(data)
            chart_of(project).add_transition(source, target, "zz")
            after = sfc.dumps(project)
            places = parents(after)
            moved = [each for each, around in parents(data).items() if places.get(each) != around]
            assert len(moved) <= 1, (source, target, moved)  # the transition that gets a branch beside it
            bar = holding(chart_of(sfc.loads(after)), "Wait")
            assert (bar.name, bar.comment) == ("Wichtig", "wichtiger Zweig")


@pytest.mark.slow
@pytest.mark.corpus
@pytest.mark.parametrize("path", REAL, ids=lambda path: path.stem)
def test_a_transition_that_is_added_to_a_real_chart_moves_no_other_element(path: Path) -> None:
    names = [each.name for each in chart_of(sfc.load(path)).steps]
    before = parents(path.read_bytes())
    for source, target in some_of([(one, other) for one in names for other in names], max(1, len(names) // 2)):
        project = sfc.load(path)
        chart_of(project).add_transition(source, target, "zz")
        after = parents(sfc.dumps(project))
        moved = [each for each, around in before.items() if after.get(each) != around]
        assert len(moved) <= 1, (source, target, moved)


@pytest.mark.parametrize("tool", ["twincat", "codesys", "codesys-export"])
def test_nothing_of_an_excluded_branch_is_executed(tool: str) -> None:
    data = excluded(tool)
    project = sfc.loads(data)
    chart = chart_of(project)
    assert [each.name for each in chart.steps if each.exclude] == ["Wait", "Check", "Look"]
    assert sum(each.exclude for each in chart.transitions) == 7
    for first in "dfi":
        trace = sfc.simulate(project, initial={f"Main.{first}": True}, scans=8)
        assert trace.situations()[-1][1] == ("Work",)
    assert sfc.dumps(project) == data


@pytest.mark.parametrize("target", ["codesys23", "plcopen-2.01", "iec-text", "simaticml", "codesys", "grafcet-text"])
def test_a_report_tells_what_becomes_of_an_excluded_branch(target: str) -> None:
    data, report = sfc.convert(sfc.loads(excluded()), target, partial=True)
    told = [
        each for each in report.items if "xclude" in each.what + each.why and each.outcome is not Outcome.EXTENSION_DATA
    ]
    if target == "codesys":
        assert not told
        chart = chart_of(sfc.loads(data))
        assert [each.name for each in chart.steps if each.exclude] == ["Wait", "Check", "Look"]
        return
    expected = {"iec-text": Outcome.APPROXIMATED, "grafcet-text": Outcome.NOT_EXECUTED}
    assert {each.outcome for each in told} == {expected.get(target, Outcome.TRANSLATED)}
    places = " ".join(each.path for each in told)
    assert all(f"transition {way}" in places for way in ("Work -> Wait", "Wait -> Work", "Check -> Leave"))


def test_a_branch_stays_excluded_and_is_executed_again_when_the_edit_says_so() -> None:
    data = excluded()
    assert exclusions(data) == 1
    project = sfc.loads(data)
    chart_of(project).add_transition("Leave", "Init", "zz")
    assert exclusions(sfc.dumps(project)) == 1
    chart_of(project).step("Check").exclude = False
    back = chart_of(sfc.loads(sfc.dumps(project)))
    assert [each.name for each in back.steps if each.exclude] == ["Wait", "Look"]
    assert not holding(back, "Wait").exclude


@pytest.mark.parametrize("tool", ["twincat", "codesys"])
def test_a_branch_that_is_excluded_alone_is_told(tool: str) -> None:
    project, _ = branched(tool)
    holding(chart_of(project), "Wait").exclude = True
    data, report = sfc.convert(project, tool)
    assert ["not excluded" in each.why for each in report.items if each.what == "exclude"] == [True]
    assert not holding(chart_of(sfc.loads(data)), "Wait").exclude


def test_a_transition_before_an_excluded_jump_is_excluded_with_it() -> None:
    project, _ = branched()
    chart = chart_of(project)
    assert chart.drawing is not None
    ends = chart.transition("Wait -> Work")
    branches = Branches.of(chart.drawing)
    (jumps,) = ([each for each in chart.drawing.symbols if each.id in branches.followers(ends.id)],)
    jumps[0].exclude = ends.exclude = True
    data = sfc.dumps(project)
    assert exclusions(data) == 1
    assert chart_of(sfc.loads(data)).transition("Wait -> Work").exclude


def test_nothing_of_an_excluded_macro_is_executed() -> None:
    """It was an error, and executed all the same."""
    data = CHART.read_bytes()
    place = data.index(b'"FALSE"', data.index(EXCLUDE.encode(), data.index(b'"Hinweg"')))
    data = data[:place] + b'"TRUE"' + data[place + 7 :]
    project = sfc.loads(data)
    assert [each.code for each in project.diagnostics if each.severity.value == "error"] == []
    chart = chart_of(project)
    left_out = [each.name for each in chart.steps if each.exclude]
    assert left_out
    assert len(left_out) < len(chart.steps)
    assert sfc.dumps(project) == data
    chart.add_transition(chart.steps[-1].name, chart.steps[0].name, "zz")
    edited = sfc.dumps(project)
    away = sfc.loads(sfc.dumps(sfc.loads(edited), format="codesys"))
    for back in (edited, sfc.dumps(away, format="twincat")):
        assert exclusions(back) == 1
        assert [each.name for each in chart_of(sfc.loads(back)).steps if each.exclude] == left_out
    chart.step(left_out[0]).exclude = False
    assert exclusions(sfc.dumps(project)) > 1
    assert [each.name for each in chart_of(sfc.loads(sfc.dumps(project))).steps if each.exclude] == left_out[1:]
