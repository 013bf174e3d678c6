"""The report names what the target executes otherwise."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.report import Outcome

SHARED = """FUNCTION_BLOCK Main
VAR_INPUT a, b, c : BOOL; END_VAR
VAR_OUTPUT n : INT; END_VAR
INITIAL_STEP S0: END_STEP
TRANSITION FROM S0 TO S1 := a; END_TRANSITION
STEP S1: {first} END_STEP
TRANSITION FROM S1 TO S2 := b; END_TRANSITION
STEP S2: {second} END_STEP
TRANSITION FROM S2 TO S0 := c; END_TRANSITION
ACTION Act: n := n + 1; END_ACTION
END_FUNCTION_BLOCK
"""


@pytest.mark.parametrize(
    ("first", "second"),
    [("Act(P1); Act(S);", "Act(R);"), ("Act(P1);", "Act(P1);"), ("Act(P0);", "Act(N);")],
)
def test_an_action_of_several_steps_has_one_control_that_step_actions_do_not_have(first: str, second: str) -> None:
    project = sfc.loads(SHARED.format(first=first, second=second).encode(), format="iec-text")
    _, report = sfc.convert(project, "codesys")
    assert any(item.path.startswith("POU Main / step S") for item in report.losses)


def test_an_action_of_one_step_is_the_same_as_an_entry_action() -> None:
    project = sfc.loads(SHARED.format(first="Act(P1);", second="").encode(), format="iec-text")
    _, report = sfc.convert(project, "codesys")
    assert report.with_outcome(Outcome.NOT_EXECUTED) == []
