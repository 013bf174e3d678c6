"""Steps that S7-GRAPH skips, as transitions of other tools that lead past them."""

from __future__ import annotations

from collections.abc import Callable

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.report import Outcome
from tests.conversion.features import Feature, FeatureChart, feature_project, variable
from tests.conversion.matrix import converted, same_behaviour


def skipping(build: Callable[[FeatureChart], None]) -> m.Project:
    """A ring of three steps and what `build` adds, as TIA Portal has written it."""

    def whole(rig: FeatureChart) -> None:
        rig.chart.graph_settings = m.GraphSettings(skip_steps=True)
        build(rig)
        rig.act("Work", "q")
        rig.act("Done", "r")

    project = feature_project(Feature("skipping", ("simaticml",), whole), "simaticml")
    return sfc.loads(sfc.dumps(project, format="simaticml"), format="simaticml")


def selection(rig: FeatureChart) -> None:
    rig.go("Idle", "Done", "g", priority=1)
    rig.go("Done", "Work", "b AND NOT g")


def supervised(rig: FeatureChart) -> None:
    rig.chart.step("Work").supervision = m.Supervised(condition=m.Expression(text="#g"))
    rig.declare(m.SectionKind.INPUT, variable("INIT_SQ"))


def simultaneous(rig: FeatureChart) -> None:
    rig.chart.add_step("Beside")
    rig.chart.transitions[0].targets.append(rig.chart.step("Beside").id)
    rig.chart.transitions[1].sources.append(rig.chart.step("Beside").id)


def timed(rig: FeatureChart) -> None:
    rig.chart.transitions[1].condition = m.Expression(text="#b AND #Work.T > T#20ms")


@pytest.mark.parametrize("target", ["codesys", "plcopen-2.01"])
@pytest.mark.parametrize("build", [selection, supervised])
def test_steps_are_passed(build: Callable[[FeatureChart], None], target: str) -> None:
    source = skipping(build)
    result, report = converted(source, target)
    assert report.losses == []
    verdict = same_behaviour(source, result)
    assert verdict is not None
    assert verdict.proven


@pytest.mark.parametrize("target", ["codesys", "plcopen-2.01"])
def test_the_setting_comes_back_without_the_transitions_for_it(target: str) -> None:
    source = skipping(selection)
    again = sfc.loads(sfc.dumps(source, format=target), format=target).pou("Main").chart
    assert again.graph_settings is not None
    assert again.graph_settings.skip_steps
    assert len(again.transitions) == len(source.pou("Main").chart.transitions)


@pytest.mark.parametrize(
    ("build", "target", "why"),
    [
        (timed, "codesys", "asks for the time of a step that is skipped"),
        (simultaneous, "codesys", "begins or ends with several steps"),
    ],
)
def test_the_reason_is_told_where_no_transitions_pass_steps(
    build: Callable[[FeatureChart], None], target: str, why: str
) -> None:
    _, report = converted(skipping(build), target)
    (item,) = report.with_outcome(Outcome.NOT_EXECUTED)
    assert item.what == "skip steps"
    assert why in item.why
