"""Whatever a project holds, it can be checked: texts of any kind, broken hierarchies, charts in charts."""

from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import plcopen_sfc as sfc
from plcopen_sfc.cli.commands.check import sarif
from plcopen_sfc.model import (
    ActionAssociation,
    ActionEvent,
    ActionKind,
    Enclosure,
    Expression,
    ForcedSituation,
    ForcingOrder,
    Macro,
    PartialChart,
    PartialChartKind,
    Project,
    Qualifier,
    SfcBody,
    SfcNetwork,
)
from plcopen_sfc.semantics.profile import PROFILES
from tests.drawing.nets import any_net
from tests.strategies import projects
from tests.sweeps import examples

profiles = st.sampled_from(sorted(PROFILES))


@pytest.mark.slow
@settings(max_examples=examples(25), deadline=None)
@given(projects(), profiles)
def test_any_project(project: Project, profile: str) -> None:
    found = sfc.check(project, profile=profile)
    log = json.loads(json.dumps(sarif(found)))
    assert len(log["runs"][0]["results"]) == len(found)


CHARTS = ["G1", "G2", "g3", "M1", ""]
NAMES = ["S0", "S1", "s2", "S_ALL", "X9"]
TEXTS = ["a", "↑a", "a AND", "RE(b)", "TRUE", "x := 1", "", "3s/X1"]


@st.composite
def associations(draw: st.DrawFn) -> ActionAssociation:
    forcing = st.builds(
        ForcingOrder,
        chart=st.sampled_from(CHARTS),
        situation=st.sampled_from(ForcedSituation),
        steps=st.lists(st.sampled_from(NAMES), max_size=2),
    )
    fields: dict[str, Any] = {
        "id": 1000 + draw(st.integers(0, 99)),
        "qualifier": draw(st.sampled_from(Qualifier)),
        "target": draw(st.none() | st.sampled_from(["Q1", "q1", *TEXTS, *NAMES])),
        "value": draw(st.none() | st.sampled_from(TEXTS)),
        "duration": draw(st.none() | st.sampled_from(["T#5s", "t", "T#0s", "", "later"])),
        "kind": draw(st.none() | st.sampled_from(ActionKind)),
        "event": draw(st.none() | st.sampled_from(ActionEvent)),
        "interlock": draw(st.booleans()),
        "condition": draw(st.none() | st.builds(Expression, text=st.sampled_from(TEXTS))),
        "forcing": draw(st.none() | forcing),
    }
    return ActionAssociation(**fields)


@st.composite
def hierarchies(draw: st.DrawFn, depth: int = 1) -> SfcNetwork:
    """Partial charts, macro-steps, enclosing steps and forcing orders, most of them wrong."""
    chart = draw(any_net(max_steps=4))
    for transition in chart.transitions:
        transition.condition = draw(st.sampled_from(TEXTS))
    for step in chart.steps:
        step.actions = draw(st.lists(associations(), max_size=2))
        if draw(st.integers(0, 4)) == 0:
            links = draw(st.lists(st.sampled_from(NAMES), max_size=2))
            step.encloses = [Enclosure(chart=draw(st.sampled_from(CHARTS)), activated_steps=links)]
        if draw(st.integers(0, 4)) == 0:
            inside = SfcBody(chart=draw(hierarchies(depth=depth - 1))) if depth and draw(st.booleans()) else None
            step.macro = Macro(expansion=draw(st.none() | st.sampled_from(CHARTS)), body=inside)
    for _ in range(draw(st.integers(0, 3)) if depth else 0):
        inner = draw(hierarchies(depth=depth - 1))
        name, kind = draw(st.sampled_from(CHARTS)), draw(st.sampled_from(PartialChartKind))
        ends = draw(st.none() | st.sampled_from(NAMES)), draw(st.none() | st.sampled_from(NAMES))
        chart.partial_charts.append(
            PartialChart(name=name, kind=kind, chart=inner, entry_step=ends[0], exit_step=ends[1])
        )
    return chart


@pytest.mark.slow
@settings(max_examples=examples(40), deadline=None)
@given(hierarchies(), profiles)
def test_any_hierarchy(chart: SfcNetwork, profile: str) -> None:
    for finding in sfc.check(chart, profile=profile):
        assert finding.message
        assert finding.hint


@pytest.mark.slow
@settings(max_examples=10, deadline=None)
@given(hierarchies(), profiles)
def test_what_is_selected_is_what_is_found_without_a_selection(chart: SfcNetwork, profile: str) -> None:
    everything = sfc.check(chart, profile=profile)
    for group in {finding.code[:3] for finding in everything}:
        alone = sfc.check(chart, profile=profile, select=[group])
        assert alone == [finding for finding in everything if finding.code.startswith(group)]
        assert [f for f in sfc.check(chart, profile=profile, ignore=[group]) if f.code.startswith(group)] == []
