"""Names that a chart of S7-GRAPH has of itself, and names that nothing declares, in conversions to and from it."""

from __future__ import annotations

from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.report import LOSSES, Item, Outcome
from tests.conversion.features import Feature, FeatureChart, feature_project, variable

OUTPUT, LOCAL = m.SectionKind.OUTPUT, m.SectionKind.LOCAL


def converted(rig_of: object, source: str, target: str) -> tuple[bytes, list[Item]]:
    """The chart of a feature in another format, and what is lost there."""
    project = feature_project(Feature("", (source,), rig_of), source)  # type: ignore[arg-type]
    original = sfc.loads(sfc.dumps(project, format=source, partial=True), format=source)
    data, report = sfc.convert(original, target, partial=True)
    return data, [item for item in report.items if item.outcome in LOSSES]


@pytest.mark.parametrize("target", ["codesys", "plcopen"])
@pytest.mark.parametrize(("name", "kind"), [("S_STATE", "WORD"), ("S_CRITLOC", "BOOL")])
def test_outputs_that_show_the_state_of_a_sequence_are_not_set_elsewhere(name: str, kind: str, target: str) -> None:
    _, losses = converted(lambda rig: rig.declare(OUTPUT, variable(name, kind)), "simaticml", target)
    (item,) = losses
    assert (item.outcome, item.path) == (Outcome.NOT_EXECUTED, "POU Main")
    assert item.why.startswith("nothing sets these outputs in ")
    assert item.why.endswith(f": {name}")


def test_an_output_that_the_chart_sets_itself_shows_no_state() -> None:
    def build(rig: FeatureChart) -> None:
        rig.declare(OUTPUT, variable("ERROR"))
        rig.act("Work", "ERROR")

    assert not converted(build, "simaticml", "codesys")[1]


@pytest.mark.parametrize(
    ("condition", "name"),
    [("#S_NO = 2", "S_NO"), ("#RT_DATA.MOP.AUTO", "RT_DATA"), ("#Trans1.TT", "Trans1"), ('"DB".x', "DB"), ('"T"', "T")],
)
@pytest.mark.parametrize("target", ["codesys", "plcopen", "iec-text"])
def test_a_variable_that_nothing_declares_is_told_in_another_tool(condition: str, name: str, target: str) -> None:
    def build(rig: FeatureChart) -> None:
        rig.chart.transitions[1].condition = m.Expression(text=condition)

    _, losses = converted(build, "simaticml", target)
    found = [item for item in losses if item.what == "undeclared name"]
    assert [(item.outcome, item.path.partition(" / ")[0]) for item in found] == (
        [] if target == "iec-text" else [(Outcome.APPROXIMATED, "POU Main")]
    )
    assert all(item.why.startswith(f"the name `{name}` is declared neither in the source nor in ") for item in found)


def test_strict_refuses_a_name_that_nothing_declares() -> None:
    project = feature_project(Feature("", ("simaticml",), lambda rig: rig.act("Work", "q", value='"Tag"')), "simaticml")
    with pytest.raises(sfc.SfcError, match="Tag"):
        sfc.convert(project, "codesys", strict=True)


@pytest.mark.parametrize(("name", "section"), [("RT_DATA", LOCAL), ("S_NO", LOCAL), ("S_CRITLOC", OUTPUT)])
@pytest.mark.parametrize("source", ["codesys", "plcopen", "iec-text"])
def test_variables_with_names_of_a_sequence_are_told(source: str, name: str, section: m.SectionKind) -> None:
    def build(rig: FeatureChart) -> None:
        rig.declare(section, variable(name))
        rig.act("Work", name)

    (item,) = converted(build, source, "simaticml")[1]
    assert item.outcome is Outcome.NOT_EXECUTED
    assert item.why.endswith(f"in TIA Portal: {name}")


@pytest.mark.parametrize("name", ["RT_DATA", "T_PUSH"])
@pytest.mark.parametrize("source", ["codesys", "plcopen", "iec-text"])
def test_steps_with_names_of_members_of_the_block_are_told(source: str, name: str) -> None:
    _, losses = converted(lambda rig: rig.chart.rename_step("Work", name), source, "simaticml")
    assert [(item.outcome, item.path) for item in losses] == [(Outcome.NOT_EXECUTED, f"POU Main / step {name}")]


def test_transitions_with_the_names_of_steps_and_of_transitions_get_others() -> None:
    def build(rig: FeatureChart) -> None:
        first, second, third = rig.chart.transitions
        first.name, second.name, third.name = "Ready", "Done", "ready"

    data, losses = converted(build, "iec-text", "simaticml")
    assert losses == []
    chart = sfc.loads(data).pous[0].chart
    assert chart is not None
    assert [transition.name for transition in chart.transitions] == ["Ready", "Done_2", "ready_2"]


@pytest.mark.parametrize("target", ["codesys", "plcopen"])
def test_several_initial_steps_of_one_chart_get_a_step_before_them(target: str) -> None:
    """A second initial step of one chart; it gets a step before both, and loops in S7-GRAPH."""

    def build(rig: FeatureChart) -> None:
        rig.chart.step("Done").initial = True

    assert not converted(build, "simaticml", target)[1]
    (item,) = converted(build, "iec-text", target)[1]
    assert (item.outcome, item.path) == (Outcome.APPROXIMATED, "POU Main / step Start")
    assert "it leads to all initial steps" in item.why


@pytest.mark.parametrize("version", ["1.01", "2.0", "2.01"])
def test_several_initial_steps_of_one_chart_stay_in_tc6(version: str) -> None:
    """A new version of TC6 got a step before them."""
    project = feature_project(Feature("", ("plcopen",), lambda _: None), "plcopen")
    data = sfc.dumps(project, format="plcopen-1.01").replace(b'name="Done"', b'name="Done" initialStep="true"')
    source = sfc.loads(data, format="plcopen-1.01")
    source.accept_errors()
    written = sfc.loads(sfc.dumps(source, format=f"plcopen-{version}", partial=True), as_tool=True)
    assert [(s.name, s.initial) for s in written.pou("Main").chart.steps] == [
        (s.name, s.initial) for s in source.pou("Main").chart.steps
    ]


@pytest.mark.parametrize("place", ["out.xml", "out/"])
def test_types_and_names_that_nothing_declares_are_told_in_files_and_folders(place: str, tmp_path: Path) -> None:
    def build(rig: FeatureChart) -> None:
        rig.declare(LOCAL, variable("timer", "LibraryType"))
        rig.chart.transitions[1].condition = m.Expression(text="b AND Mystery")

    project = feature_project(Feature("", ("codesys",), build), "codesys")
    original = sfc.loads(sfc.dumps(project, format="codesys", partial=True), format="codesys")
    report = sfc.save(original, f"{tmp_path}/{place}", format="simaticml", partial=True)
    whys = [item.why for item in report.items if item.outcome in LOSSES]
    assert any("`LibraryType` is declared neither" in why for why in whys)
    assert any("`Mystery` is declared neither" in why for why in whys)
