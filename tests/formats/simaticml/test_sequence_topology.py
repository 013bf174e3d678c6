"""Charts of every shape become branches and connections that S7-GRAPH allows, and come back as they were."""

from __future__ import annotations

import io
from collections import Counter
from pathlib import Path

import pytest
from hypothesis import given, settings
from lxml import etree

import plcopen_sfc as sfc
from plcopen_sfc.formats.simaticml.element_reader import NotUnderstoodError
from plcopen_sfc.formats.simaticml.openness_schemas import validate
from plcopen_sfc.formats.simaticml.sequence_rules import ElementRef, SequenceLink, connection_problems, read_link
from plcopen_sfc.model import Pou, Project, SfcBody, SfcNetwork
from plcopen_sfc.model.pou import PouKind
from plcopen_sfc.report import ConversionReport, Outcome
from tests.drawing.nets import any_net, make, nested_net
from tests.formats.simaticml.documents import GRAPH_PARAMS, parsed
from tests.sweeps import examples

LEGAL = {
    ("Step", "Transition"),
    ("Step", "AltBegin"),
    ("Step", "SimEnd"),
    ("Transition", "Step"),
    ("Transition", "AltEnd"),
    ("Transition", "SimBegin"),
    ("Transition", "End"),
    ("AltBegin", "Transition"),
    ("AltEnd", "Step"),
    ("SimBegin", "Step"),
    ("SimEnd", "Transition"),
}
"""The direct connections that TIA Portal was seen to write or take; jumps lead from a transition to a step."""


def written(chart: SfcNetwork) -> tuple[etree._Element, ConversionReport, SfcNetwork]:
    """The document of a block with this chart, the report of writing it, and the chart as it is read from it."""
    project = Project(pous=[Pou(name="Chart", kind=PouKind.FUNCTION_BLOCK, bodies=[SfcBody(chart=chart)])])
    stream = io.BytesIO()
    report = sfc.save(project, stream, format="simaticml", partial=True)
    assert validate(stream.getvalue()) == []
    again = sfc.loads(stream.getvalue())
    (read,) = again.charts()
    return parsed(stream.getvalue()), report, read.chart


def links(chart: SfcNetwork) -> Counter[tuple[frozenset[str], frozenset[str]]]:
    """Which steps lead to which, by name."""
    names = {step.id: step.name for step in chart.steps}
    return Counter(
        (frozenset(names[i] for i in t.sources if i in names), frozenset(names[i] for i in t.targets if i in names))
        for t in chart.transitions
    )


def connections(root: etree._Element) -> list[tuple[str, str, bool]]:
    """The kinds of what is connected, and whether it is a jump."""
    types = {branch.get("Number"): branch.get("Type", "") for branch in root.iter("{*}Branch")}
    found = []
    for connection in root.iter("{*}Connection"):
        ends = [next(iter(node)) for node in list(connection)[:2]]
        kinds = [etree.QName(end).localname.removesuffix("Ref").removesuffix("Connection") for end in ends]
        kinds = [types[end.get("Number")] if kind == "Branch" else kind for kind, end in zip(kinds, ends, strict=True)]
        found.append((kinds[0], kinds[1], connection[2].text == "Jump"))
    return found


def assert_legal(root: etree._Element) -> None:
    """Each connection is one that TIA Portal takes; steps and transitions have one way out and one direct way in."""
    for source, target, is_jump in connections(root):
        assert (source, target) == ("Transition", "Step") if is_jump else (source, target) in LEGAL
    left: Counter[str] = Counter()
    entered: Counter[str] = Counter()
    for connection in root.iter("{*}Connection"):
        begin, end = (next(iter(node)) for node in list(connection)[:2])
        left[f"{begin.tag} {begin.get('Number')} {begin.get('Out')}"] += 1
        if connection[2].text == "Direct":
            entered[f"{end.tag} {end.get('Number')} {end.get('In')}"] += 1
    assert set(left.values()) <= {1}
    assert {count for key, count in entered.items() if "EndConnection" not in key} <= {1}
    for kind in ("Step", "Transition"):
        for element in root.iter(f"{{*}}{kind}"):
            assert any(f"{kind}Ref {element.get('Number')} " in key for key in left)


@pytest.mark.slow
@settings(deadline=None, max_examples=8)
@given(chart=nested_net(jumps=False))
def test_nested_charts_are_legal_and_come_back(chart: SfcNetwork) -> None:
    root, report, again = written(chart.model_copy(deep=True))
    assert links(again) == links(chart)
    assert_legal(root)
    assert not refused(report)
    assert len(list(root.iter("{*}Step"))) == len(chart.steps)


@pytest.mark.slow
@settings(deadline=None, max_examples=examples(25))
@given(chart=any_net(max_steps=5).filter(lambda chart: bool(chart.steps)))
def test_any_chart_comes_back(chart: SfcNetwork) -> None:
    wanted = links(chart)
    root, report, again = written(chart.model_copy(deep=True))
    assert links(again) == wanted
    initial = {(step.name, step.initial) for step in again.steps}
    assert initial == {(step.name, step.initial) for step in chart.steps}
    if not refused(report):
        assert_legal(root)


def refused(report: ConversionReport) -> list[str]:
    """Topologies that TIA Portal may refuse."""
    return [item.why for item in report.items if "refuse" in item.why]


@pytest.mark.slow
def test_a_selection_behind_a_simultaneous_branch_waits_in_a_step() -> None:
    """TIA Portal has no branch directly behind a branch: a step is between, and is none of the chart."""
    chart = make(5, [([0], [1, 2]), ([1, 2], [3]), ([1, 2], [4]), ([3], [0]), ([4], [0])])
    root, report, again = written(chart)
    assert_legal(root)
    assert [step.get("Name") for step in root.iter("{*}Step")] == ["S0", "S1", "S2", "S3", "S4", "Wait6"]
    assert [step.name for step in again.steps] == ["S0", "S1", "S2", "S3", "S4"]
    assert len(again.transitions) == 5
    assert any(item.outcome is Outcome.APPROXIMATED and "one cycle later" in item.why for item in report.items)


def test_a_leg_that_jumps_gets_a_step() -> None:
    """Both transitions lead into the same simultaneous steps: only one of them can do that directly."""
    chart = make(4, [([0], [1, 2]), ([3], [1, 2]), ([1, 2], [3])])
    root, _, again = written(chart)
    assert_legal(root)
    assert links(again) == links(chart)
    assert len(list(root.iter("{*}Step"))) == 6


def test_a_step_that_nothing_follows_gets_a_transition_that_is_never_true() -> None:
    chart = make(2, [([0], [1])])
    root, report, again = written(chart)
    assert_legal(root)
    assert [t.get("Name") for t in root.iter("{*}Transition")] == ["Trans1", "Trans2"]
    assert len(again.transitions) == 1
    assert any(item.outcome is Outcome.TRANSLATED and "never TRUE" in item.why for item in report.items)


def test_steps_that_were_put_in_and_that_somebody_uses_are_steps_of_the_chart() -> None:
    """As TIA Portal forgets comments, and as somebody programs an action there."""
    chart = make(5, [([0], [1, 2]), ([1, 2], [3]), ([1, 2], [4]), ([3], [0]), ([4], [0])])
    root, _, _ = written(chart)
    for step in root.iter("{*}Step"):
        if step.get("Name") == "Wait6":
            action = step.find("{*}Actions/{*}Action")
            assert action is not None
            action.set("Qualifier", "N")
    (again,) = sfc.loads(etree.tostring(root)).charts()
    assert "Wait6" in [step.name for step in again.chart.steps]
    assert len(again.chart.transitions) == 6


def test_charts_that_are_not_connected_are_sequences() -> None:
    chart = make(4, [([0], [1]), ([1], [0]), ([2], [3]), ([3], [2])])
    chart.steps[2].initial = True
    root, _, again = written(chart)
    assert len(list(root.iter("{*}Sequence"))) == 2
    assert [len(sequence.steps) for sequence in again.sequences] == [2, 2]
    assert links(again) == links(chart)


def test_too_many_sequences_are_reported() -> None:
    chart = make(9, [([i], [i]) for i in range(9)])
    _, report, again = written(chart)
    assert links(again) == links(chart)
    assert any("8 sequences" in item.why for item in report.items)


@pytest.mark.parametrize("path", GRAPH_PARAMS)
def test_real_charts_are_legal_by_our_rules(path: Path) -> None:
    root = parsed(path.read_bytes())
    for sequence in root.iter("{*}Sequence"):
        branches = sequence.iterfind("{*}Branches/{*}Branch")
        types = {int(branch.get("Number", "")): branch.get("Type", "") for branch in branches}
        try:
            found = [read_link(link) for link in sequence.iterfind("{*}Connections/{*}Connection")]
        except NotUnderstoodError:
            pytest.skip("a template with a connection to nothing")
        assert connection_problems(found, types) == []


@pytest.mark.slow
def test_edits_of_a_document_with_steps_put_in() -> None:
    chart = make(5, [([0], [1, 2]), ([1, 2], [3]), ([1, 2], [4]), ([3], [0]), ([4], [0])])
    root, _, _ = written(chart)
    data = etree.tostring(root)
    project = sfc.loads(data, format="simaticml")
    assert sfc.dumps(project) == data
    (found,) = project.charts()
    network = found.chart
    network.step("S3").name = "Renamed"
    edited = sfc.dumps(project)
    assert edited == data.replace(b'Name="S3"', b'Name="Renamed"')
    # a new step takes the number of the one that was put in, which gets another
    new = network.add_step("New")
    network.transitions[-1].targets = [new.id]
    network.add_transition(new, network.step("S0"), "TRUE")
    (again,) = sfc.loads(sfc.dumps(project)).charts()
    assert links(again.chart) == links(network)
    assert [step.name for step in again.chart.steps] == ["S0", "S1", "S2", "Renamed", "S4", "New"]


@pytest.mark.parametrize(
    ("found", "problem"),
    [
        ([("S1", "S2", False)], "S7-GRAPH has no connection from a step to a step (S1"),
        ([("S1", "S2", True)], "S7-GRAPH has no jump from a step to a step (S1"),
        ([("T1", "S1", False), ("T2", "S1", False)], "S7-GRAPH has one connection to a step (S1)"),
        ([("S1", "B1", False), ("B1", "S2", False)], "no connection from the begin of an alternative branch to a step"),
    ],
)
def test_a_refused_connection_is_named_in_words(found: list[tuple[str, str, bool]], problem: str) -> None:
    refs = [(ElementRef(a[0], int(a[1:])), ElementRef(b[0], int(b[1:])), jump) for a, b, jump in found]
    refused = connection_problems([SequenceLink(*ref) for ref in refs], {1: "AltBegin"})
    assert any(problem in each for each in refused), refused
