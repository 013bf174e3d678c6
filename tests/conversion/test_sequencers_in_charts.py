"""What surrounds a sequencer of S7-GRAPH, executed by charts of CODESYS and TC6, or reported."""

from __future__ import annotations

from typing import Any

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.model.compare import differences
from plcopen_sfc.report import Outcome
from tests.conversion.features import Feature, Rig, drawn, feature_project
from tests.conversion.matrix import same_behaviour

TARGETS = ("codesys", "plcopen-2.01")


def sequencer(
    *,
    before: str | None = None,
    after: str | None = None,
    rows: tuple[dict[str, Any], ...] = (),
    condition: str | None = None,
) -> m.Project:
    """A sequencer whose step Work drives `q`, as TIA Portal would read it."""

    def build(rig: Rig) -> None:
        for text, operations in ((before, rig.chart.permanent_pre), (after, rig.chart.permanent_post)):
            if text is not None:
                operations.append(m.PermanentOperation(body=drawn(text, "LD", m.Dialect.SCL)))
        rig.act("Work", "q")
        for row in rows:
            rig.act(**row)
        if condition is not None:
            rig.chart.transitions[1].condition = m.Expression(text=condition)

    return as_file(feature_project(Feature("sequencer", ("simaticml",), build), "simaticml"))


def as_file(project: m.Project) -> m.Project:
    return sfc.loads(sfc.dumps(project, format="simaticml", partial=True), format="simaticml")


COUNTED: tuple[dict[str, Any], ...] = ({"step": "Done", "target": "n", "value": "n + 1"},)
PERMANENT: dict[str, tuple[dict[str, Any], tuple[str, ...]]] = {
    "for actions": ({"before": "#n := 3;", "rows": COUNTED}, TARGETS),
    "of actions": ({"after": "#r := #q;"}, ("codesys",)),
    "of the new situation": ({"after": "#r := #Work.X;", "condition": "#r"}, TARGETS),
    "for conditions": ({"before": "#r := #g;", "condition": "#r AND #b"}, ()),
    "of the situation before": ({"before": "#r := #Work.X;"}, ()),
}
"""Permanent instructions, and the targets in which they do exactly the same."""


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize(("fields", "exact"), PERMANENT.values(), ids=PERMANENT.keys())
def test_permanent_instructions_run_as_reported(fields: dict[str, Any], exact: tuple[str, ...], target: str) -> None:
    source = sequencer(**fields)
    data, report = sfc.convert(source, target)
    [told] = [item for item in report.items if item.what.startswith("permanent instruction")]
    verdict = same_behaviour(source, sfc.loads(data, format=target, as_tool=True))
    assert verdict is not None
    assert verdict.equal is (target in exact), verdict
    assert told.outcome is (Outcome.TRANSLATED if target in exact else Outcome.APPROXIMATED)
    assert report.losses == [each for each in (told,) if target not in exact]
    assert list(differences(source, as_file(sfc.loads(data, format=target)))) == []


@pytest.mark.parametrize("target", TARGETS)
def test_permanent_instructions_are_executed_once_after_an_edit_of_the_actions(target: str) -> None:
    data, _ = sfc.convert(sequencer(before="#r := #g;", after="#n := #n + 1;"), target)
    edited = data.replace(b"n + 1", b"n + 2")  # by a tool that keeps the extension data
    chart = sfc.loads(edited, format=target).pou("Main").chart
    assert chart is not None
    assert (chart.permanent_pre, chart.permanent_post) == ([], [])
    assert [row.qualifier for row in chart.step("Idle").actions] == [m.Qualifier.S, m.Qualifier.S]
