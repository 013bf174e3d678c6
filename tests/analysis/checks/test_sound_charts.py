"""Charts of nested branches are sound: nothing is found in their structure, in their conditions or in their drawing."""

from __future__ import annotations

from random import Random
from unittest.mock import patch

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import plcopen_sfc as sfc
from plcopen_sfc.diagnostics import Severity
from plcopen_sfc.drawing import DrawingStyle, prepare
from plcopen_sfc.model import Pou, PouKind, Project, SfcBody, SfcNetwork
from plcopen_sfc.semantics.profile import PROFILES
from tests.drawing.nets import any_net, make, nested_net
from tests.sweeps import examples


@st.composite
def blocks(draw: st.DrawFn) -> SfcNetwork:
    """Steps in a row, selections and simultaneous branches, nested, with a way back to the start."""
    steps: list[int] = []
    edges: list[tuple[list[int], list[int]]] = []

    def new() -> int:
        steps.append(len(steps))
        return steps[-1]

    def sequence(start: int, depth: int) -> int:
        now = start
        for _ in range(draw(st.integers(0, 2))):
            kind = draw(st.sampled_from(["step", "selection", "simultaneous"])) if depth else "step"
            after = new()
            if kind == "step":
                edges.append(([now], [after]))
                now = after
                continue
            firsts = [new() for _ in range(draw(st.integers(2, 3)))]
            if kind == "selection":
                edges.extend(([now], [first]) for first in firsts)
                edges.extend(([end], [after]) for end in [sequence(first, depth - 1) for first in firsts])
            else:
                edges.append(([now], firsts))
                edges.append(([sequence(first, depth - 1) for first in firsts], [after]))
            now = after
        return now

    first = new()
    edges.append(([sequence(first, 3)], [first]))
    return make(len(steps), edges)


@settings(max_examples=examples(60), deadline=None)
@given(blocks(), st.sampled_from(sorted(PROFILES)))
def test_nothing_is_wrong_with_the_structure_of_nested_branches(chart: SfcNetwork, profile: str) -> None:
    project = Project(pous=[Pou(name="P", kind=PouKind.PROGRAM, bodies=[SfcBody(chart=chart)])])
    structure = [str(f) for f in sfc.check(project, profile=profile, select=["STR", "NAM", "HIE", "CND", "ACT", "TIM"])]
    assert structure == []
    prepare(project, DrawingStyle.PLAIN, positions=False)
    assert [str(f) for f in sfc.check(project, profile=profile, select=["STR"])] == []


@settings(max_examples=examples(60), deadline=None)
@given(blocks(), st.integers(1, 10))
def test_nothing_is_made_up_where_there_are_too_many_situations(chart: SfcNetwork, most: int) -> None:
    with patch("plcopen_sfc.analysis.checks.checked_chart.MOST_MARKINGS", most):
        assert [str(f) for f in sfc.check(chart, profile="iec", select=["STR"])] == []


@pytest.mark.slow
@settings(max_examples=examples(40), deadline=None)
@given(nested_net(), st.randoms(use_true_random=False))
def test_the_order_in_a_file_does_not_matter_for_the_structure(chart: SfcNetwork, chance: Random) -> None:
    def found() -> set[str]:
        return {finding.code for finding in sfc.check(chart, profile="iec", select=["STR", "LOW", "NAM"])}

    before = found()
    chance.shuffle(chart.steps)
    chance.shuffle(chart.transitions)
    assert found() == before


@pytest.mark.slow
@settings(max_examples=examples(150), deadline=None)
@given(any_net(), st.sampled_from(sorted(PROFILES)))
def test_whatever_a_chart_is_like_it_can_be_checked(chart: SfcNetwork, profile: str) -> None:
    for finding in sfc.check(chart, profile=profile):
        assert finding.message
        assert isinstance(finding.severity, Severity)


@settings(max_examples=examples(60), deadline=None)
@given(any_net())
def test_a_net_without_findings_on_its_structure_has_none_in_its_drawing(chart: SfcNetwork) -> None:
    """The drawings that we make say what the chart says, so that no rule on drawings is broken by them."""
    project = Project(pous=[Pou(name="P", kind=PouKind.PROGRAM, bodies=[SfcBody(chart=chart)])])
    if sfc.check(project, profile="iec", select=["STR05", "STR09", "STR11", "STR14"]):
        return
    prepare(project, DrawingStyle.PLAIN, positions=False)
    assert [str(f) for f in sfc.check(project, profile="iec", select=["STR01", "STR04", "STR05"])] == []
