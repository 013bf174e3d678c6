"""Timers, counters and times of S5 in other tools: their types, and rows of steps that act on them."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.report import START_OF_CHART, Outcome
from tests.conversion.features import Feature, FeatureChart, feature_project, variable
from tests.conversion.matrix import converted, same_behaviour


def source(rows: list[tuple[str, str, str | None]], condition: str = '#b OR "S5"', **more: object) -> m.Project:
    """A chart whose rows act on a timer with a tag: the step, the qualifier and the event of each."""

    def build(rig: FeatureChart) -> None:
        rig.project.tag_tables.append(m.TagTable(name="Tags", tags=[m.Tag(name="S5", type="Timer", address="%T1")]))
        for step, qualifier, event in rows:
            row = rig.act(step, None, qualifier, event=event, duration="S5T#50ms")
            row.target = '"S5"'
        rig.chart.transitions[1].condition = m.Expression(text=condition)
        for step, target in more.items():
            rig.act(step, target, value="x").value = '"S5"'

    project = feature_project(Feature("timer", ("simaticml",), build), "simaticml")
    return sfc.loads(sfc.dumps(project, format="simaticml"), format="simaticml")


@pytest.mark.parametrize("target", ["codesys", "plcopen-2.01"])
def test_rows_start_one_timer_in_turn(target: str) -> None:
    project = source([("Idle", "TD", "S0"), ("Work", "TL", "S1"), ("Done", "TR", "S1")])
    result, report = converted(project, target)
    assert {item.what for item in report.losses} <= {START_OF_CHART}
    verdict = same_behaviour(project, result)
    assert verdict is not None
    assert verdict.proven


@pytest.mark.parametrize("target", ["codesys", "plcopen-2.01"])
def test_a_row_that_reads_the_output_in_the_same_scan_is_told_where_it_sees_another_one(target: str) -> None:
    project = source([("Work", "TL", "S1")], Work="q")
    result, report = converted(project, target)
    verdict = same_behaviour(project, result)
    assert verdict is not None
    told = [item.what for item in report.with_outcome(Outcome.APPROXIMATED)]
    assert verdict.equal is ("timers of steps" not in told)


@pytest.mark.parametrize("target", ["codesys", "plcopen-2.01", "codesys-export"])
def test_types_of_s5_become_those_of_the_target(target: str) -> None:
    project = sfc.loads(
        b"FUNCTION_BLOCK Main\nVAR_INPUT go : BOOL; t1 : TIMER; c1 : COUNTER; END_VAR\nVAR_OUTPUT d : TIME; END_VAR\n"
        b"VAR hold : S5TIME := S5T#1s55ms; END_VAR\nBEGIN\n#d := S5TIME_TO_TIME(#hold);\nEND_FUNCTION_BLOCK",
        format="scl",
    )
    data, report = sfc.convert(project, target)
    assert report.losses == []
    read = sfc.loads(data, format=target, as_tool=True).pou("Main")
    assert read.interface is not None
    found = {
        each.name: (section.kind, each.type.name.value)
        for section in read.interface.sections
        for each in section.variables
        if isinstance(each.type, m.ElementaryType)
    }
    assert found["t1"] == (m.SectionKind.IN_OUT, "BOOL")  # the caller has it, the block changes it
    assert found["c1"] == (m.SectionKind.IN_OUT, "INT")
    assert found["hold"] == (m.SectionKind.LOCAL, "TIME")
    (hold,) = (each for each in read.variables() if each.name == "hold")
    assert hold.initial == m.SimpleValue(text="T#1s50ms")


def test_rows_and_operands_come_back() -> None:
    def build(rig: FeatureChart) -> None:
        rig.declare(m.SectionKind.INPUT, variable("T1", "TIMER"), variable("C1", "COUNTER"))
        rig.act("Work", "T1", "TL", event="S1", duration="S5T#2s")
        rig.act("Work", "C1", "CU", event="S1")

    project = feature_project(Feature("both", ("simaticml",), build), "simaticml")
    for target in ("codesys", "plcopen-2.01"):
        data, _ = sfc.convert(project, target)
        again = sfc.loads(sfc.dumps(sfc.loads(data, format=target), format="simaticml"), format="simaticml").pou("Main")
        rows = [(row.qualifier.value, row.target, row.duration) for row in again.chart.step("Work").actions]
        assert rows == [("TL", "#T1", "T#2s"), ("CU", "#C1", None)]
        kinds = {each.name: str(each.type) for each in again.variables(m.SectionKind.INPUT)}
        assert "TIMER" in kinds["T1"]
        assert "COUNTER" in kinds["C1"]


def test_the_call_of_a_timer_of_s5_is_not_executed() -> None:
    text = (
        b"FUNCTION_BLOCK Main\nVAR_INPUT go : BOOL; t1 : TIMER; END_VAR\nVAR_OUTPUT q : BOOL; n : WORD; END_VAR\n"
        b"BEGIN\n#n := S_ODT(T_NO := #t1, S := #go, TV := S5T#2s, R := FALSE, Q => #q);\nEND_FUNCTION_BLOCK"
    )
    _, report = sfc.convert(sfc.loads(text, format="scl"), "codesys", partial=True)
    (item,) = report.with_outcome(Outcome.NOT_EXECUTED)
    assert "has no timers and counters of S5" in item.why


def test_two_tags_of_one_timer_would_be_two_variables() -> None:
    project = source([("Work", "TL", "S1"), ("Done", "TR", "S1")])
    project.tag_tables[0].tags.append(m.Tag(name="Same", type="Timer", address="%T1"))
    project.pou("Main").chart.step("Done").actions[0].target = '"Same"'
    _, report = converted(project, "codesys")
    assert [item.path for item in report.with_outcome(Outcome.NOT_EXECUTED) if item.what == "tag"] == [
        "tag table Tags / tag Same"
    ]
