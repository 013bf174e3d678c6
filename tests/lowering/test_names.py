"""Names that lowered code declares tell what they stand for, and stay when the chart is edited elsewhere."""

from __future__ import annotations

import difflib
import re

import pytest

import plcopen_sfc as sfc
from plcopen_sfc import model as m
from plcopen_sfc.lowering import lower
from plcopen_sfc.lowering.code.lowered_code import Naming
from plcopen_sfc.model.dialect import Dialect
from tests.analysis.nets import chart_of
from tests.lowering.charts import act, pou_with
from tests.lowering.random_charts import Shape, random_chart


def code_of(chart: m.SfcNetwork, construction: str = "bits") -> str:
    body = lower(pou_with(chart), construction, language="ST", verify=False).pou.body
    assert isinstance(body, m.StBody)
    return body.text


def declared(chart: m.SfcNetwork) -> list[str]:
    interface = lower(pou_with(chart), "bits", verify=False).pou.interface
    assert interface is not None
    return [variable.name for variable in interface.variables()]


def changed_lines(before: str, after: str) -> list[str]:
    """The lines added and removed, as a review of the edit shows them."""
    lines = difflib.ndiff(before.splitlines(), after.splitlines())
    return [line for line in lines if line.startswith(("+ ", "- "))]


def test_transitions_are_named_after_the_steps_that_they_join() -> None:
    names = declared(chart_of("1>2+3 2>Fill 3>S4 Fill+S4>1 1>Fill 1>2 >2 1>"))
    assert [name for name in names if name.startswith("T")] == [
        "T1_2",
        "T2_Fill",
        "T3_4",
        "T_Fill_1",
        "T1_Fill",
        "T1_2_2",
        "T_2",
        "T1_end",
    ]


def test_transitions_with_a_name_or_a_number_keep_it() -> None:
    chart = chart_of("1>2 2>3 3>1")
    chart.transitions[0].name = "Trans7"
    chart.transitions[1].name = "Full"
    chart.transitions[2].number = 12
    assert [name for name in declared(chart) if name.startswith("T")] == ["T7", "T_Full", "T12"]


@pytest.mark.parametrize("construction", ["bits", "flipflop"])
def test_a_step_that_is_added_leaves_the_names_of_all_others(construction: str) -> None:
    chart = chart_of(" ".join(f"{i}>{i % 12 + 1}" for i in range(1, 13)))
    for step in chart.steps:
        act(chart, step, f"q{step.name}")
    before = code_of(chart, construction)
    after = chart.steps[4]
    new = chart.add_step("Wait")
    transition = chart.transitions[4]
    transition.sources = [new.id]
    chart.add_transition(after, new, "ready")
    chart.transitions.insert(4, chart.transitions.pop())
    changed = changed_lines(before, code_of(chart, construction))
    assert len(changed) <= 16
    assert all(re.search("Wait|[56]", line) for line in changed if line[2:] not in {"", "END_IF;"}), changed


@pytest.mark.parametrize("construction", ["bits", "flipflop"])
def test_a_step_that_is_renamed_changes_the_lines_that_name_it(construction: str) -> None:
    chart = chart_of(" ".join(f"{i}>{i % 12 + 1}" for i in range(1, 13)))
    before = code_of(chart, construction)
    chart.steps[4].name = "Wait"
    changed = changed_lines(before, code_of(chart, construction))
    assert changed
    assert all(re.search("Wait|5", line) for line in changed), changed


def test_wanted_names_that_are_taken_get_numbers_whatever_their_case() -> None:
    naming = Naming(Dialect.IEC, ["Motor", "motor_3"])
    assert [naming.fresh(name) for name in ("MOTOR", "Motor", "motor", "Motor_2")] == [
        "MOTOR_2",
        "Motor_4",
        "motor_5",
        "Motor_2_2",
    ]


@pytest.mark.parametrize("construction", ["case", "regions", "bits", "flipflop"])
def test_a_chart_is_always_lowered_to_the_same_project(construction: str) -> None:
    for seed in (2, 5, 7):
        pou = random_chart(seed, shape=Shape.NESTED if construction != "case" else Shape.SELECTIONS)
        first, second = (lower(pou.model_copy(deep=True), construction, verify=False).project for _ in range(2))
        assert first == second


@pytest.mark.parametrize("construction", ["case", "regions"])
def test_a_step_that_is_added_leaves_the_numbers_of_all_others(construction: str) -> None:
    chart = chart_of(" ".join(f"{i}>{i % 12 + 1}" for i in range(1, 13)))
    for step in chart.steps:
        step.name = f"S{step.name}"
    before = code_of(chart, construction)
    new = chart.add_step("S99")
    chart.transitions[4].sources = [new.id]
    chart.add_transition(chart.steps[4], new, "ready")
    changed = changed_lines(before, code_of(chart, construction))
    assert len(changed) <= 8, changed


def test_the_state_of_a_chart_is_in_no_section_that_instances_share() -> None:
    text = """FUNCTION_BLOCK Axis
VAR_INPUT go : BOOL; END_VAR
VAR_STAT shared : INT; END_VAR
INITIAL_STEP Wait: END_STEP
TRANSITION FROM Wait TO Move := go; END_TRANSITION
STEP Move: END_STEP
TRANSITION FROM Move TO Wait := NOT go; END_TRANSITION
END_FUNCTION_BLOCK
"""
    project = sfc.loads(text.encode(), format="iec-text")
    project.dialect = Dialect.CODESYS
    lowered = sfc.lower(project.pou("Axis"), target="iec-text")
    written = sfc.dumps(lowered.project, format="iec-text").decode()
    assert "VAR_STAT shared : INT; END_VAR" in written
