"""The harness for matiec itself: it sets and reads what a text has, by its names."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.judges.matiec import MatiecError, require_matiec

TEXT = """TYPE Colour : (red, green); END_TYPE
FUNCTION_BLOCK Counter
VAR_INPUT up : BOOL; END_VAR
VAR_OUTPUT number : INT; END_VAR
VAR edge : R_TRIG; END_VAR
edge(CLK := up);
IF edge.Q THEN number := number + 1; END_IF;
END_FUNCTION_BLOCK
PROGRAM Plant
VAR start AT %IX0.1 : BOOL; lamp AT %QX0.2 : BOOL; END_VAR
VAR count : Counter; ratio : REAL; lasted : TIME; shade : Colour; label : STRING; END_VAR
VAR_EXTERNAL ready : BOOL; END_VAR
INITIAL_STEP Idle: ready(S); END_STEP
STEP Run: lamp(N); Work(N); END_STEP
TRANSITION FROM Idle TO Run := start; END_TRANSITION
TRANSITION FROM Run TO Idle := NOT start; END_TRANSITION
ACTION Work:
  count(up := start); ratio := INT_TO_REAL(count.number) / 4.0; lasted := Run.T; shade := green; label := 'on';
END_ACTION
END_PROGRAM
CONFIGURATION Config
VAR_GLOBAL ready : BOOL; END_VAR
RESOURCE Cpu ON PLC
  TASK Fast(INTERVAL := T#20ms, PRIORITY := 0);
  PROGRAM Line WITH Fast : Plant;
END_RESOURCE
END_CONFIGURATION
"""


def test_variables_of_every_kind_are_set_and_read(tmp_path: Path) -> None:
    machine = require_matiec().build(TEXT, tmp_path)
    assert machine.period == 20_000_000
    watch = ["lamp", "ready", "count.number", "ratio", "lasted", "shade", "label", "Run.X", "Run.T", "Work.Q"]
    trace = machine.run([{}, {"Start": True}, {}, {"start": False}], watch)
    assert [list(row.values()) for row in trace] == [
        [False, True, 0, 0.0, 0, 0, "", False, 0, False],
        [True, True, 1, 0.25, 0, 1, "on", True, 0, True],
        [True, True, 1, 0.25, 20_000_000, 1, "on", True, 20_000_000, True],
        [False, True, 1, 0.25, 20_000_000, 1, "on", False, 40_000_000, False],
    ]
    assert machine.run([{"ratio": 1.5, "count.number": -3}], ["ratio", "count.number"]) == [
        {"ratio": 1.5, "count.number": -3}
    ]
    with pytest.raises(KeyError, match="no variable nothing"):
        machine.run([{}], ["nothing"])


def test_what_the_compiler_says_is_the_error(tmp_path: Path) -> None:
    text = "PROGRAM Plant\nVAR a : BOOL; END_VAR\na := 3 +;\nEND_PROGRAM\n"
    with pytest.raises(MatiecError, match=r"program\.st:3"):
        require_matiec().build(text, tmp_path)


def test_a_text_without_configuration_gets_one(tmp_path: Path) -> None:
    text = "PROGRAM Plant\nVAR n : INT; END_VAR\nn := n + 1;\nEND_PROGRAM\n"
    machine = require_matiec().build(text, tmp_path, period_ms=5)
    assert machine.period == 5_000_000
    assert machine.run([{}] * 3, ["n"])[-1] == {"n": 3}
