"""Qualifiers and conditions that no row of S7-GRAPH has: networks behind the sequence do what they mean."""

from __future__ import annotations

import difflib

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.report import Outcome
from tests.conversion.features import Feature, FeatureChart, feature_project
from tests.conversion.matrix import same_behaviour

T = "T#50ms"


def _chart(*rows: tuple[str, str, str, str | None], source: str = "plcopen") -> m.Project:
    """A ring of three steps with actions: step, target, qualifier, time."""

    def build(rig: FeatureChart) -> None:
        for step, target, qualifier, duration in rows:
            rig.act(step, target, qualifier, duration=duration)

    return _loaded(feature_project(Feature("control", (source,), build), source), source)


def _of_beremiz(*rows: tuple[str, str, str, str | None], code: bool = False) -> m.Project:
    """The same for Beremiz, whose compiler lets associations act one after the other; `q` is an action with `code`."""

    def build(rig: FeatureChart) -> None:
        if code:
            rig.action("Count", m.StBody(text="q := NOT q;"))
        for step, target, qualifier, duration in rows:
            rig.act(step, "Count" if code else target, qualifier, duration=duration)

    project = feature_project(Feature("control", ("plcopen",), build), "plcopen")
    project.header.product = "Beremiz"
    return _loaded(project, "plcopen-2.01")


def _loaded(project: m.Project, source: str) -> m.Project:
    return sfc.loads(sfc.dumps(project, format=source, partial=True), format=source)


SHARED = {
    "N beside SD": (("Idle", "q", "N", None), ("Work", "q", "SD", T), ("Done", "q", "R", None)),
    "L in two steps": (("Idle", "q", "L", T), ("Work", "q", "L", T)),
    "D in two steps": (("Idle", "q", "D", T), ("Work", "q", "D", T), ("Done", "q", "R", None)),
    "S, N and R": (("Idle", "q", "S", None), ("Work", "q", "N", None), ("Done", "q", "R", None)),
    "two resets": (("Idle", "q", "SL", T), ("Work", "q", "R", None), ("Done", "q", "R", None)),
    "SD with a time of each step": (("Idle", "q", "SD", T), ("Work", "q", "SD", "T#75ms"), ("Done", "q", "R", None)),
    "L with a time of each step": (("Idle", "q", "L", "T#75ms"), ("Work", "q", "L", T)),
    "two controls": (
        ("Idle", "q", "SD", T),
        ("Work", "r", "DS", T),
        ("Work", "q", "R", None),
        ("Done", "r", "R", None),
    ),
}


@pytest.mark.parametrize(
    ("name", "source"),
    [*((name, "plcopen") for name in SHARED), *((n, "codesys") for n in ("N beside SD", "L with a time of each step"))],
)
def test_associations_of_several_steps_have_one_control(name: str, source: str) -> None:
    """Source and result execute the same with all inputs, and no item is lost."""
    project = _chart(*SHARED[name], source=source)
    data, report = sfc.convert(project, "simaticml")
    assert not report.with_outcome(Outcome.NOT_EXECUTED)
    verdict = same_behaviour(project, sfc.loads(data, format="simaticml", as_tool=True))
    assert verdict is not None
    assert verdict.equal, verdict


IN_TURN = {
    **SHARED,
    "SD that begins again while it runs": (("Idle", "q", "SD", "T#100ms"), ("Work", "q", "SD", "T#100ms")),
    "SD that goes on after R": (("Idle", "q", "SD", T), ("Work", "q", "R", None)),
    "DS whose step is left too early": (("Work", "q", "DS", T), ("Done", "q", "R", None)),
    "N of a step that is left, and of an earlier one": (("Idle", "q", "N", None), ("Done", "q", "D", T)),
    "pulses, one when its step is left": (("Work", "q", "P0", None), ("Done", "q", "L", T)),
}


def _by_step_times(name: str) -> bool:
    return any(qualifier in ("L", "D") for _, _, qualifier, _ in IN_TURN[name])


@pytest.mark.parametrize("code", [False, True], ids=["variable", "statements"])
@pytest.mark.parametrize(
    # no proof follows the times of steps, and runs take long
    "name",
    [pytest.param(name, marks=[pytest.mark.slow] if _by_step_times(name) else []) for name in IN_TURN],
)
def test_associations_of_beremiz_act_one_after_the_other(name: str, code: bool) -> None:
    """As the C code of matiec does: SD goes on after R, and the last association that decides counts."""
    project = _of_beremiz(*IN_TURN[name], code=code)
    data, report = sfc.convert(project, "simaticml", limit=0)
    assert not report.with_outcome(Outcome.NOT_EXECUTED)
    verdict = same_behaviour(project, sfc.loads(data, format="simaticml", as_tool=True))
    assert verdict is not None
    assert verdict.equal, verdict


def test_an_action_that_a_step_has_twice_is_executed_once_in_a_scan() -> None:
    def build(rig: FeatureChart) -> None:
        rig.action("Count", m.StBody(text="q := NOT q;"))
        for step in ("Work", "Work", "Done"):
            rig.act(step, "Count")

    project = _loaded(feature_project(Feature("twice", ("codesys",), build), "codesys"), "codesys")
    data, report = sfc.convert(project, "simaticml")
    assert not report.losses
    verdict = same_behaviour(project, sfc.loads(data, format="simaticml", as_tool=True))
    assert verdict is not None
    assert verdict.equal, verdict


def test_conditions_of_associations_are_contacts() -> None:
    project = _chart(("Work", "q", "N", None), ("Done", "r", "D", T))
    rows = [row for _, row in next(iter(project.charts())).chart.associations()]
    for row, text in zip(rows, ("a AND NOT c", "c"), strict=True):
        row.condition = m.Expression(text=text)
    data, report = sfc.convert(project, "simaticml")
    assert not report.losses
    seen = sfc.loads(data, format="simaticml", as_tool=True)
    assert [body.body.language for body in seen.pou("Main").chart.permanent_post if body.body] == ["LD"] * 4
    verdict = same_behaviour(project, seen)
    assert verdict is not None
    assert verdict.equal, verdict


def test_there_and_back_the_associations_are_those_of_the_source() -> None:
    project = _chart(*SHARED["N beside SD"])
    data, _ = sfc.convert(project, "simaticml")
    back = sfc.loads(data, format="simaticml").pou("Main")
    assert not back.chart.permanent_post
    assert not [variable for variable in back.variables() if variable.name.startswith("q_")]
    of_source, of_back = (
        [(step.name, row.qualifier, row.duration) for step, row in each.associations()]
        for each in (project.pou("Main").chart, back.chart)
    )
    assert of_back == of_source


def test_a_renamed_step_changes_its_contacts_too() -> None:
    data, _ = sfc.convert(_chart(*SHARED["N beside SD"]), "simaticml")
    project = sfc.loads(data, format="simaticml")
    project.pou("Main").chart.rename_step("Done", "Ready")
    lines = difflib.unified_diff(
        data.decode().splitlines(), sfc.dumps(project, format="simaticml").decode().splitlines()
    )
    added = [line.strip("+ ") for line in lines if line.startswith("+ ")]
    seals = [line for line in added if line.startswith("<!--")]
    assert {"Ready" in line for line in added if line not in seals} == {True}
    assert 2 <= len(added) - len(seals) <= 6, added


def test_networks_that_were_edited_count() -> None:
    """An edit in TIA Portal that keeps the comments is not lost: no association acts beside the network."""
    data, _ = sfc.convert(_chart(*SHARED["N beside SD"]), "simaticml")
    text = data.decode("utf-8-sig")
    networks = text.index("<PostOperations>")
    edited = text[:networks] + text[networks:].replace('<Component Name="Idle" />', '<Component Name="Work" />')
    project = sfc.loads(edited.encode(), format="simaticml")
    main = project.pou("Main")
    assert not [row for _, row in main.chart.associations()]
    assert len(main.chart.permanent_post) > 1
    assert "q_waits" in {variable.name for variable in main.variables()}
    assert [each.code for each in project.diagnostics] == ["XML214"]


@pytest.mark.slow
def test_a_variable_that_others_write_keeps_what_they_write() -> None:
    project = _chart(("Work", "q", "SD", T), ("Done", "q", "R", None), source="codesys")
    main = project.pou("Main")
    main.actions.append(m.Action(name="First", body=m.StBody(text="q := a;")))
    main.chart.step("Idle").entry_action = "First"
    data, _ = sfc.convert(project, "simaticml")
    verdict = same_behaviour(project, sfc.loads(data, format="simaticml", as_tool=True), later_inputs=True)
    assert verdict is not None
    assert verdict.equal, verdict


@pytest.mark.parametrize("text", ["// q is the lamp\nr := a;", "r := q;", "r := sq;"])
def test_a_variable_that_others_only_name_needs_no_memory(text: str) -> None:
    """Two variables hold what an association does beside others that write; one that they read is assigned."""
    project = _chart(("Work", "q", "SD", T), ("Done", "q", "R", None), source="codesys")
    main = project.pou("Main")
    main.actions.append(m.Action(name="First", body=m.StBody(text=text)))
    main.chart.step("Idle").entry_action = "First"
    data, _ = sfc.convert(project, "simaticml", partial=True)
    assert b"q_waits" in data
    assert b"q_active" not in data
